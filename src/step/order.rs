//! The orders in which a step can go through its stages.

use crate::choice::choices;

choices! {
    /// Where in a step the stress is updated.
    pub enum StepOrder: "order" {
        /// Order of a step: update stress last. The particles get their new velocities, then
        /// velocity gradients and stresses come from the grid as it moved. With linear shapes, this
        /// order and APIC are prone to blow up when a stressed particle barely touches a cell: the
        /// nodes there are so light that force over mass grows as 1/w with the small weight w.
        /// Linear shapes want FLIP (`pic_rate` 0) with LAHAR_ORDER_MUSL; B-splines have no such
        /// trouble.
        Usl = 0, "usl", LAHAR_ORDER_USL, "USL";
        /// Order of a step: modified update stress last (default). The new velocities of the
        /// particles are mapped to the grid a second time, with the same weights, and velocity
        /// gradients and stresses come from those.
        Musl = 1, "musl", LAHAR_ORDER_MUSL, "MUSL";
        /// Order of a step: update stress first, from the velocities at the start of the step.
        Usf = 2, "usf", LAHAR_ORDER_USF, "USF";
        /// Order of a step: half of the stress update first, half last; keeps energy best, for
        /// twice the calls of the material.
        Usavg = 3, "usavg", LAHAR_ORDER_USAVG, "USAVG";
    }
}

//! Options of a world, their defaults and their rules.

use super::order::StepOrder;
use crate::background::space::FARTHEST;
use crate::background::{EDGE, GridPolicy, Space, bytes_of_block};
use crate::boundary::Table;
use crate::error::{Error, Result, Status};
use crate::memory::ensure_free;
use crate::shape::{ShapeKind, WallTreatment};
use crate::transfer::{TransferKind, filter};
use std::fmt::Display;

/// Options of a world, as a host gives them; [`Options::normalised`] makes of them what the engine
/// uses.
#[derive(Clone, Debug)]
pub struct Options {
    /// Number of axes: 2 (plane strain, 1 m thick) or 3.
    pub dimension: usize,
    /// Distance h of grid nodes [m]; must be given.
    pub spacing: f64,
    /// Position of grid node 0 [m]; in two dimensions the third component is ignored, as in all
    /// vectors here.
    pub origin: [f64; 3],
    /// Shape function.
    pub shape: ShapeKind,
    /// Transfer scheme.
    pub transfer: TransferKind,
    /// Rate at which PIC damps FLIP [1/s]: 0 is FLIP, infinity is PIC. Used by
    /// [`TransferKind::PicFlip`].
    pub pic_rate: f64,
    /// Order of the stages.
    pub order: StepOrder,
    /// Courant number of the stable time step, in (0, 1].
    pub cfl: f64,
    /// Gravity [m/s²].
    pub gravity: [f64; 3],
    /// Local non-viscous damping α, in [0, 1).
    pub damping: f64,
    /// How blocks come and go.
    pub grid_policy: GridPolicy,
    /// Lower corner of the box of a static grid [m].
    pub box_min: [f64; 3],
    /// Upper corner of the box of a static grid [m].
    pub box_max: [f64; 3],
    /// What shape functions do next to walls.
    pub wall_treatment: WallTreatment,
    /// Whether x is a radius and y the axis of rotational symmetry; volumes, masses and forces are
    /// then per radian.
    pub axisymmetric: bool,
    /// Terms of the filter of [`TransferKind::Xpic`] and [`TransferKind::Fmpm`]; 0: the default, 2.
    pub filter_order: i32,
    /// Whether particles carry a body force.
    pub body_force: bool,
    /// How often a step is repeated smaller if a material fails or requests that; 0: never, a
    /// failure poisons the world.
    pub retries: i32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            dimension: 3,
            spacing: 0.0,
            origin: [0.0; 3],
            shape: ShapeKind::QuadraticBspline,
            transfer: TransferKind::Apic,
            pic_rate: 0.0,
            order: StepOrder::Musl,
            cfl: 0.4,
            gravity: [0.0; 3],
            damping: 0.0,
            grid_policy: GridPolicy::Dynamic,
            box_min: [0.0; 3],
            box_max: [0.0; 3],
            wall_treatment: WallTreatment::Modified,
            axisymmetric: false,
            filter_order: FILTER_ORDER,
            body_force: false,
            retries: 0,
        }
    }
}

/// Terms of a filter if the host does not care.
const FILTER_ORDER: i32 = 2;

/// Most retries of a step; each at least halves it or takes what the material requests.
const MOST_RETRIES: i32 = 20;

/// How far outside the box of a static grid a particle counts as on its face, in cells.
const FACE: f64 = 1e-9;

/// Most blocks of a static grid.
const MOST_BLOCKS: f64 = 1e8;

impl Options {
    /// The options as the engine uses them, if a world can be made of them: vectors are zero along
    /// axes that the world does not have, and a filter of order 0 is the default one.
    pub fn normalised(&self) -> Result<Options> {
        if self.dimension != 2 && self.dimension != 3 {
            return Err(wrong_dimension(self.dimension));
        }
        let options = Options {
            origin: self.vector(self.origin),
            gravity: self.vector(self.gravity),
            box_min: self.vector(self.box_min),
            box_max: self.vector(self.box_max),
            filter_order: if self.filter_order == 0 { FILTER_ORDER } else { self.filter_order },
            ..self.clone()
        };
        options.check_values()?;
        Ok(options)
    }

    /// Whether a world can be made of these options.
    pub fn check(&self) -> Result<()> {
        self.normalised().map(drop)
    }

    /// Gravity [m/s²] as the engine uses it, if it can: normalised as that of the options.
    pub fn normalised_gravity(&self, gravity: [f64; 3]) -> Result<[f64; 3]> {
        let gravity = self.vector(gravity);
        self.check_gravity(gravity)?;
        Ok(gravity)
    }

    /// The same for gravity by a table.
    pub fn normalised_gravity_table(&self, table: Table) -> Result<Table> {
        let table = table.keeping(|axis| axis < self.dimension);
        table.rows().iter().try_for_each(|row| self.check_gravity(*row))?;
        Ok(table)
    }

    /// A vector with zeros along the axes that the world does not have.
    fn vector(&self, mut vector: [f64; 3]) -> [f64; 3] {
        vector[self.dimension..].fill(0.0);
        vector
    }

    /// Checks normalised options, one by one and together.
    fn check_values(&self) -> Result<()> {
        if !(self.spacing > 0.0 && self.spacing.is_finite()) {
            return Err(Error::invalid(format!(
                "spacing must be positive and finite [m], got {}",
                self.spacing
            )));
        }
        if !self.origin.iter().all(|x| (x / self.spacing).abs() < FARTHEST) {
            return Err(Error::invalid(format!(
                "origin must be finite and within 1e8 cells of x = 0 [m], got {:?}",
                self.origin
            )));
        }
        if !(self.pic_rate >= 0.0) {
            return Err(Error::invalid(format!(
                "pic_rate must be 0 (FLIP) or positive, infinity for PIC [1/s], got {}",
                self.pic_rate
            )));
        }
        if !(self.cfl > 0.0 && self.cfl <= 1.0) {
            return Err(Error::invalid(format!("cfl must lie in (0, 1], got {}", self.cfl)));
        }
        if !(1..=filter::MOST).contains(&self.filter_order) {
            return Err(Error::invalid(format!(
                "filter_order must be 1 (PIC) to {}, or 0 for the default, got {}",
                filter::MOST,
                self.filter_order
            )));
        }
        if !(0..=MOST_RETRIES).contains(&self.retries) {
            return Err(Error::invalid(format!(
                "retries must be 0 (none) to {MOST_RETRIES}, got {}",
                self.retries
            )));
        }
        self.check_gravity(self.gravity)?;
        check_damping(self.damping)?;
        self.check_combination()?;
        if self.grid_policy == GridPolicy::Static { self.check_box() } else { Ok(()) }
    }

    /// Where the grid stands in space, without walls.
    pub fn space<const D: usize>(&self) -> Space<D> {
        let reach = match self.wall_treatment {
            WallTreatment::Plain => self.shape.wall_reach(),
            WallTreatment::Modified => 0.0,
        };
        let origin = std::array::from_fn(|d| self.origin[d]);
        Space::new(self.spacing, origin, self.shape.first_offset(), reach)
    }

    /// Corners of the box of a static grid [m], moved out by round-off: particles on its faces are
    /// inside, on whichever side of a face a step puts them.
    pub fn limits(&self) -> Option<[[f64; 3]; 2]> {
        let out = |x: f64| FACE * self.spacing + 4.0 * f64::EPSILON * x.abs();
        (self.grid_policy == GridPolicy::Static)
            .then(|| [self.box_min.map(|x| x - out(x)), self.box_max.map(|x| x + out(x))])
    }

    /// Whether a position lies in the box of a static grid; true for other grids.
    pub fn holds<const D: usize>(&self, x: &[f64; D]) -> bool {
        let inside = |[min, max]: [[f64; 3]; 2]| (0..D).all(|d| min[d] <= x[d] && x[d] <= max[d]);
        self.limits().is_none_or(inside)
    }

    /// Gravity must be finite, and along the axis in axial symmetry.
    fn check_gravity(&self, gravity: [f64; 3]) -> Result<()> {
        if !gravity.iter().all(|g| g.is_finite()) {
            return Err(Error::invalid(format!("gravity must be finite [m/s^2], got {gravity:?}")));
        }
        if self.axisymmetric && gravity[0] != 0.0 {
            return Err(Error::new(
                Status::Unsupported,
                format!(
                    "in axial symmetry gravity acts along the axis y alone, got {} m/s^2 along the radius x: set it to 0",
                    gravity[0]
                ),
            ));
        }
        Ok(())
    }

    /// Refuses what does not go together, with the nearest combination that does.
    fn check_combination(&self) -> Result<()> {
        let unsupported = |text: String| Err(Error::new(Status::Unsupported, text));
        if self.transfer == TransferKind::Mls && self.shape.moment().is_none() {
            return unsupported(format!(
                "transfer MLS divides by Σ w r², which is not the same everywhere, or vanishes, for {} shape functions: use a \
                 quadratic or cubic B-spline, or transfer TPIC with this shape",
                self.shape.name()
            ));
        }
        if self.axisymmetric && self.dimension != 2 {
            return unsupported(format!(
                "axial symmetry needs dimension 2 (x is the radius, y the axis), got dimension {}",
                self.dimension
            ));
        }
        Ok(())
    }

    fn check_box(&self) -> Result<()> {
        let mut blocks = 1.0;
        for d in 0..self.dimension {
            let (min, max) = (self.box_min[d], self.box_max[d]);
            let far = |x: f64| !(((x - self.origin[d]) / self.spacing).abs() < FARTHEST);
            if far(min) || far(max) || min >= max {
                return Err(Error::invalid(format!(
                    "a static grid needs box_min < box_max, finite and within 1e8 cells of the origin; \
                     along {} they are {min} and {max}",
                    ["x", "y", "z"][d]
                )));
            }
            blocks *= (max - min) / (EDGE as f64 * self.spacing) + 2.0;
        }
        if blocks > MOST_BLOCKS {
            return Err(Error::invalid(format!(
                "the static box would need {blocks:.2e} blocks, more than {MOST_BLOCKS:.0e}: use grid_policy dynamic"
            )));
        }
        // before hours are spent on a part of it
        let bytes = blocks * bytes_of_block(self.dimension) as f64;
        ensure_free(bytes as usize, "the blocks of a static grid")
    }
}

/// A world has two or three dimensions.
pub fn wrong_dimension(got: impl Display) -> Error {
    Error::invalid(format!("dimension must be 2 or 3, got {got}"))
}

/// Damping must lie in [0, 1).
pub fn check_damping(damping: f64) -> Result<()> {
    if (0.0..1.0).contains(&damping) {
        return Ok(());
    }
    Err(Error::invalid(format!("damping must lie in [0, 1), got {damping}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane world with something in each component that two dimensions ignore.
    fn careless() -> Options {
        Options {
            dimension: 2,
            spacing: 0.1,
            origin: [0.1, 0.2, f64::NAN],
            transfer: TransferKind::Xpic,
            gravity: [1.0, -9.81, f64::INFINITY],
            grid_policy: GridPolicy::Static,
            box_min: [0.0, 0.0, 1.0],
            box_max: [1.0, 1.0, -1.0],
            filter_order: 0,
            ..Options::default()
        }
    }

    #[test]
    fn what_two_dimensions_do_not_have_is_zero_and_no_filter_the_default_one() {
        let options = careless().normalised().expect("good options");
        assert_eq!(options.origin, [0.1, 0.2, 0.0]);
        assert_eq!(options.gravity, [1.0, -9.81, 0.0]);
        assert_eq!((options.box_min, options.box_max), ([0.0; 3], [1.0, 1.0, 0.0]));
        assert_eq!(options.filter_order, 2);
    }

    #[test]
    fn what_three_dimensions_need_is_not_ignored_there() {
        let refused = |options: Options, part: &str| {
            let error = options.normalised().expect_err(part);
            assert!(error.message.contains(part), "{error}");
        };
        let solid = Options { dimension: 3, ..careless() };
        refused(solid.clone(), "origin must be finite");
        let solid = Options { origin: [0.0; 3], ..solid };
        refused(solid.clone(), "gravity must be finite");
        let solid = Options { gravity: [0.0, 0.0, -9.81], ..solid };
        refused(solid.clone(), "along z they are 1 and -1");
        let solid = Options { box_max: [1.0, 1.0, 2.0], ..solid };
        let normalised = solid.normalised().expect("good options");
        assert_eq!(normalised.gravity, solid.gravity);
        assert_eq!((normalised.box_min, normalised.box_max), (solid.box_min, solid.box_max));
        refused(Options { dimension: 1, ..solid.clone() }, "dimension must be 2 or 3, got 1");
        refused(Options { filter_order: -1, ..solid }, "or 0 for the default, got -1");
    }
}

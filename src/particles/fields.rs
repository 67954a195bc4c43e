//! The registry of particle fields: name, unit and shape of everything a particle carries.
//!
//! Writers, views, copies and documentation iterate it; the state variables of a body's model follow behind.

use std::ffi::CStr;

/// What hosts may know of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Name.
    pub name: &'static CStr,
    /// SI unit.
    pub unit: &'static CStr,
    /// One sentence.
    pub description: &'static CStr,
    /// Number of components.
    pub components: usize,
    /// Whether hosts may write it.
    pub writable: bool,
}

/// Where each field starts among the columns of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Position [m], D components.
    pub position: usize,
    /// Velocity [m/s], D components.
    pub velocity: usize,
    /// Mass [kg].
    pub mass: usize,
    /// Current volume [m³].
    pub volume: usize,
    /// Cauchy stress [Pa], 6 components.
    pub stress: usize,
    /// Strain energy [J].
    pub strain_energy: usize,
    /// Temperature [K]; none unless the model wants it.
    pub temperature: usize,
    /// Pore pressure, compression positive [Pa]; none unless the model wants it.
    pub pore_pressure: usize,
    /// Rate of growth that F-bar averages [1/s]; none unless the body has F-bar.
    pub dilation: usize,
    /// Edge lengths of the domain [m], D components; none unless the shape function is sized.
    pub size: usize,
    /// Body force per mass [N/kg], D components; none unless the world has it.
    pub body_force: usize,
    /// Affine velocity matrix [1/s], D·D components, row-major; none unless the transfer is affine.
    pub affine: usize,
    /// Velocity on its way through a filter [m/s], D components; none unless the transfer is filtered.
    pub filtered: usize,
    /// Deformation gradient [–], 9 components, row-major; none unless the model asks for it.
    pub deformation_gradient: usize,
    /// State variables of the model.
    pub state: usize,
    end: usize,
}

/// What a body carries beside what all have.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// Temperature.
    pub temperature: bool,
    /// Pore pressure.
    pub pore_pressure: bool,
    /// Rate of growth.
    pub dilation: bool,
    /// Edge lengths of the domain.
    pub size: bool,
    /// Body force.
    pub body_force: bool,
    /// Affine matrix.
    pub affine: bool,
    /// Filtered velocity.
    pub filtered: bool,
    /// Deformation gradient.
    pub gradient: bool,
    /// Components of the model's state.
    pub state: usize,
}

impl Layout {
    /// Columns of a body in `dimension` axes.
    pub fn new(dimension: usize, extras: &Extras) -> Self {
        let Extras { temperature, pore_pressure, dilation, size, body_force, .. } = *extras;
        let Extras { affine, filtered, gradient, state, .. } = *extras;
        let mut end = 0;
        let mut take = |components: usize| {
            end += components;
            end - components
        };
        let mut layout = Self {
            position: take(dimension),
            velocity: take(dimension),
            mass: take(1),
            volume: take(1),
            stress: take(6),
            strain_energy: take(1),
            temperature: take(usize::from(temperature)),
            pore_pressure: take(usize::from(pore_pressure)),
            dilation: take(usize::from(dilation)),
            size: take(if size { dimension } else { 0 }),
            body_force: take(if body_force { dimension } else { 0 }),
            affine: take(if affine { dimension * dimension } else { 0 }),
            filtered: take(if filtered { dimension } else { 0 }),
            deformation_gradient: take(if gradient { 9 } else { 0 }),
            state: take(state),
            end: 0,
        };
        layout.end = end;
        layout
    }

    /// Whether the body has F-bar.
    pub fn has_dilation(&self) -> bool {
        self.size > self.dilation
    }

    /// Number of columns.
    pub fn components(&self) -> usize {
        self.end
    }

    /// Number of columns of the model's state.
    pub fn state_components(&self) -> usize {
        self.end - self.state
    }

    /// The engine's fields with their first columns, in the order of enumeration.
    pub fn fields(&self, dimension: usize) -> Vec<(FieldInfo, usize)> {
        let field = |name, unit, description, first, components, writable| {
            (FieldInfo { name, unit, description, components, writable }, first)
        };
        let mut list = vec![
            field(c"position", c"m", c"Position", self.position, dimension, true),
            field(c"velocity", c"m/s", c"Velocity", self.velocity, dimension, true),
            field(c"mass", c"kg", c"Mass", self.mass, 1, true),
            field(c"volume", c"m^3", c"Current volume", self.volume, 1, true),
            field(
                c"stress",
                c"Pa",
                c"Cauchy stress xx, yy, zz, xy, yz, zx, tension positive",
                self.stress,
                6,
                true,
            ),
            field(
                c"strain_energy",
                c"J",
                c"Work of the stress on the strain since the start, or the model's own energy",
                self.strain_energy,
                1,
                true,
            ),
        ];
        if self.pore_pressure > self.temperature {
            let text = c"Temperature, 293.15 until the host writes it";
            list.push(field(c"temperature", c"K", text, self.temperature, 1, true));
        }
        if self.dilation > self.pore_pressure {
            let text = c"Pore pressure, compression positive";
            list.push(field(c"pore_pressure", c"Pa", text, self.pore_pressure, 1, true));
        }
        if self.body_force > self.size {
            let text = c"Edge lengths of the particle's domain";
            list.push(field(c"size", c"m", text, self.size, dimension, true));
        }
        if self.affine > self.body_force {
            let text = c"Body force per mass, added to gravity";
            list.push(field(c"body_force", c"N/kg", text, self.body_force, dimension, true));
        }
        let affine = self.filtered - self.affine;
        if affine > 0 {
            let text = c"Affine velocity matrix, row-major";
            list.push(field(c"affine", c"1/s", text, self.affine, affine, true));
        }
        if self.state > self.deformation_gradient {
            let (text, first) = (c"Deformation gradient, row-major", self.deformation_gradient);
            list.push(field(c"deformation_gradient", c"-", text, first, 9, true));
        }
        list
    }
}

/// Fields of a node of the grid after a step.
pub const NODE_FIELDS: fn(usize) -> [FieldInfo; 4] = |dimension| {
    let field = |name, unit, description, components| FieldInfo {
        name,
        unit,
        description,
        components,
        writable: false,
    };
    [
        field(c"mass", c"kg", c"Mass", 1),
        field(c"velocity", c"m/s", c"Velocity at the end of the step", dimension),
        field(c"momentum", c"kg*m/s", c"Momentum at the end of the step", dimension),
        field(c"force", c"N", c"Force of the particles' stresses on the node", dimension),
    ]
};

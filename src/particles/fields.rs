//! The table of particle fields: name, shape, unit and writer of everything a particle carries, and
//! which bodies carry it. A new field is a line of [`Layout`].
//!
//! Writers, views, copies and documentation iterate it; the state variables of a body's model
//! follow behind.

use std::ffi::CStr;

use crate::material::{Input, Model};
use crate::shape::ShapeKind;
use crate::transfer::TransferKind;

/// What hosts can query about a field.
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

/// Columns that follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    /// The first.
    pub first: usize,
    /// How many.
    pub count: usize,
}

impl Columns {
    /// Whether a column is one of them.
    pub fn contains(&self, column: usize) -> bool {
        (self.first..self.first + self.count).contains(&column)
    }
}

/// What decides which fields a body carries.
#[derive(Clone, Copy)]
pub struct Carrier<'a> {
    /// Number of axes.
    pub dimension: usize,
    /// Shape function of the world.
    pub shape: ShapeKind,
    /// Transfer scheme of the world.
    pub transfer: TransferKind,
    /// Whether the world has body forces.
    pub body_force: bool,
    /// Whether the body has F-bar.
    pub f_bar: bool,
    /// The body's model.
    pub model: &'a Model,
}

impl Carrier<'_> {
    fn wants(&self, input: Input) -> bool {
        self.model.input(input).is_some()
    }

    fn carries_deformation_gradient(&self) -> bool {
        let stretches = self.shape == ShapeKind::ContiguousGimp;
        self.model.kinematics.carries_deformation_gradient() || stretches
    }
}

/// Shape of a field: how many components it has.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Scalar,
    /// Along the axes of the world.
    Vector,
    /// xx, yy, zz, xy, yz, zx.
    Symmetric,
    /// Along the axes of the world, row-major.
    Matrix,
    /// Along three axes, row-major.
    Tensor,
}

impl Shape {
    const fn components(self, dimension: usize) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector => dimension,
            Self::Symmetric => 6,
            Self::Matrix => dimension * dimension,
            Self::Tensor => 9,
        }
    }
}

/// Who writes a field.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writer {
    /// The engine, and hosts, who see it too.
    Host,
    /// The engine alone; hosts do not see it.
    Engine,
}

/// What the columns of a body must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Any number that is finite.
    Finite,
    /// A number above zero that is finite.
    Positive,
}

impl Rule {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Positive => "positive and finite",
        }
    }
}

/// The table. A line has name, shape, unit, writer, rule and a sentence; what some bodies lack also
/// has the condition under which a body carries it.
macro_rules! fields {
    (
        always { $($name:ident: $shape:ident [$unit:literal], $writer:ident, $rule:ident, $text:literal;)+ }
        sometimes {
            $($some:ident: $some_shape:ident [$some_unit:literal], $some_writer:ident, $some_rule:ident,
                $some_text:literal, $when:expr;)+
        }
    ) => {
        /// Where the fields of a body stand among its columns.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct Layout {
            $(#[doc = concat!($text, " [", $unit, "]: its first column.")] pub $name: usize,)+
            $(#[doc = concat!($some_text, " [", $some_unit, "], if the body carries it.")]
            pub $some: Option<Columns>,)+
            /// State variables of the model.
            pub state: Columns,
            /// Number of axes of the world.
            pub dimension: usize,
        }

        impl Layout {
            /// Columns of a body.
            pub fn new(carrier: &Carrier<'_>) -> Self {
                let mut end = 0;
                let mut take = |count: usize| {
                    end += count;
                    Columns { first: end - count, count }
                };
                let dimension = carrier.dimension;
                Self {
                    $($name: take(Shape::$shape.components(dimension)).first,)+
                    $($some: {
                        let when: fn(&Carrier<'_>) -> bool = $when;
                        when(carrier).then(|| take(Shape::$some_shape.components(dimension)))
                    },)+
                    state: take(carrier.model.state_components()),
                    dimension,
                }
            }

            /// A layout with every field; where its columns stand does not matter.
            #[cfg(test)]
            fn with_everything() -> Self {
                let columns = Columns { first: 0, count: 1 };
                Self { $($name: 0,)+ $($some: Some(columns),)+ state: columns, dimension: 2 }
            }

            /// All fields of the engine: columns, whether hosts see them, rule, and what hosts may
            /// know.
            fn all(&self, dimension: usize) -> Vec<(Columns, Writer, Rule, FieldInfo)> {
                let mut list = Vec::new();
                $(list.push({
                    let count = Shape::$shape.components(dimension);
                    let columns = Columns { first: self.$name, count };
                    let (name, unit) = (name!($name), name!($unit));
                    (columns, Writer::$writer, Rule::$rule, info(name, unit, name!($text), count))
                });)+
                $(if let Some(columns) = self.$some {
                    let (name, unit) = (name!($some), name!($some_unit));
                    let info = info(name, unit, name!($some_text), columns.count);
                    list.push((columns, Writer::$some_writer, Rule::$some_rule, info));
                })+
                list
            }

            /// The columns of what some bodies lack, as far as the body carries it.
            #[inline(always)]
            pub fn optional(&self) -> impl Iterator<Item = Columns> {
                [$(self.$some),+].into_iter().flatten()
            }

            /// Every field that both layouts have, as pairs of columns in this one and in the
            /// other.
            pub fn shared_with(
                &self,
                other: &Self,
                dimension: usize,
            ) -> impl Iterator<Item = (usize, usize)> {
                let all = [
                    $((self.$name, other.$name, Shape::$shape.components(dimension)),)+
                    $(match (self.$some, other.$some) {
                        (Some(from), Some(to)) => (from.first, to.first, from.count),
                        _ => (0, 0, 0),
                    },)+
                    (self.state.first, other.state.first, self.state.count),
                ];
                all.into_iter()
                    .flat_map(|(from, to, count)| (0..count).map(move |c| (from + c, to + c)))
            }
        }
    };
}

/// A text of the table for C.
macro_rules! name {
    ($text:ident) => {
        name!(stringify!($text))
    };
    ($text:expr) => {
        const {
            match CStr::from_bytes_with_nul(concat!($text, "\0").as_bytes()) {
                Ok(text) => text,
                Err(_) => panic!("a text of the table of fields has a zero inside"),
            }
        }
    };
}

const fn info(
    name: &'static CStr,
    unit: &'static CStr,
    description: &'static CStr,
    components: usize,
) -> FieldInfo {
    FieldInfo { name, unit, description, components, writable: true }
}

fields! {
    always {
        position: Vector ["m"], Host, Finite, "Position";
        velocity: Vector ["m/s"], Host, Finite, "Velocity";
        mass: Scalar ["kg"], Host, Positive, "Mass";
        volume: Scalar ["m^3"], Host, Positive, "Current volume";
        stress: Symmetric ["Pa"], Host, Finite,
            "Cauchy stress xx, yy, zz, xy, yz, zx, tension positive";
        strain_energy: Scalar ["J"], Host, Finite,
            "Work of the stress on the strain since the start, or the model's own energy";
    }
    sometimes {
        temperature: Scalar ["K"], Host, Finite, "Temperature, 293.15 until the host writes it",
            |body| body.wants(Input::Temperature);
        pore_pressure: Scalar ["Pa"], Host, Finite, "Pore pressure, compression positive",
            |body| body.wants(Input::PorePressure);
        dilation: Scalar ["1/s"], Engine, Finite, "Rate of growth that F-bar averages",
            |body| body.f_bar;
        size: Vector ["m"], Host, Positive, "Edge lengths of the particle's domain",
            |body| body.shape.is_sized();
        body_force: Vector ["N/kg"], Host, Finite, "Body force per mass, added to gravity",
            |body| body.body_force;
        affine: Matrix ["1/s"], Host, Finite, "Affine velocity matrix, row-major",
            |body| body.transfer.is_affine();
        filtered: Vector ["m/s"], Engine, Finite, "Velocity on its way through a filter",
            |body| body.transfer.is_filtered();
        deformation_gradient: Tensor ["-"], Host, Finite, "Deformation gradient, row-major",
            |body| body.carries_deformation_gradient();
    }
}

impl Layout {
    /// Number of columns.
    pub fn components(&self) -> usize {
        self.state.first + self.state.count
    }

    /// The engine's fields that hosts see, with their first columns, in the order of enumeration.
    pub fn fields(&self, dimension: usize) -> Vec<(FieldInfo, usize)> {
        let all = self.all(dimension).into_iter();
        let seen = all.filter(|(_, writer, ..)| *writer == Writer::Host);
        seen.map(|(columns, _, _, info)| (info, columns.first)).collect()
    }

    /// What columns must hold, and the names of their fields; state variables come last.
    pub fn rules(&self, dimension: usize) -> Vec<(Columns, Rule, &'static CStr)> {
        let all = self.all(dimension).into_iter();
        let engine = all.map(|(columns, _, rule, info)| (columns, rule, info.name));
        engine.chain([(self.state, Rule::Finite, c"a state variable")]).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plugin::RESERVED;

    #[test]
    fn models_may_not_take_the_names_of_fields() {
        let fields = Layout::with_everything().fields(2);
        for (info, _) in &fields {
            let name = info.name.to_str().expect("ASCII");
            assert!(RESERVED.contains(&name), "add `{name}` to the reserved names of states");
        }
        assert_eq!(RESERVED.len(), fields.len() + 2, "`id` and `body`, and every field");
    }
}

//! Options of a world, their defaults and their rules.

use super::order::StepOrder;
use crate::background::space::FARTHEST;
use crate::background::{GridPolicy, Space};
use crate::error::{Error, Result, Status};
use crate::shape::{ShapeKind, WallTreatment};
use crate::transfer::{TransferKind, filter};

/// Options of a world.
#[derive(Clone, Debug)]
pub struct Options {
    /// Number of axes: 2 (plane strain, 1 m thick) or 3.
    pub dimension: usize,
    /// Distance h of grid nodes [m]; must be given.
    pub spacing: f64,
    /// Position of grid node 0 [m].
    pub origin: [f64; 3],
    /// Shape function.
    pub shape: ShapeKind,
    /// Transfer scheme.
    pub transfer: TransferKind,
    /// Rate at which PIC damps FLIP [1/s]: 0 is FLIP, infinity is PIC. Used by [`TransferKind::PicFlip`].
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
    /// Whether x is a radius and y the axis of rotational symmetry; volumes, masses and forces are then per radian.
    pub axisymmetric: bool,
    /// Terms of the filter of [`TransferKind::Xpic`] and [`TransferKind::Fmpm`].
    pub filter_order: i32,
    /// Whether particles carry a body force.
    pub body_force: bool,
    /// How often a step is repeated smaller if a material fails or asks for that; 0: never, a failure poisons the world.
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
            wall_treatment: WallTreatment::Plain,
            axisymmetric: false,
            filter_order: 2,
            body_force: false,
            retries: 0,
        }
    }
}

/// Most retries of a step; each at least halves it or does what the material asks for.
const MOST_RETRIES: i32 = 20;

/// Most blocks of a static grid.
const MOST_BLOCKS: f64 = 1e8;

impl Options {
    /// Whether a world can be made of these options.
    pub fn check(&self) -> Result<()> {
        if self.dimension != 2 && self.dimension != 3 {
            return Err(Error::invalid(format!(
                "dimension must be 2 or 3, got {}",
                self.dimension
            )));
        }
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
                "filter_order must be 1 (PIC) to {}, got {}",
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

    /// Whether shape functions are modified next to walls; linear ones have nothing to modify.
    pub fn modifies_shapes(&self) -> bool {
        self.wall_treatment == WallTreatment::Modified && self.shape != ShapeKind::Linear
    }

    /// The place of the grid, without walls.
    pub fn space<const D: usize>(&self) -> Space<D> {
        let reach = match self.wall_treatment {
            WallTreatment::Plain => self.shape.wall_reach(),
            WallTreatment::Modified => 0.0,
        };
        let origin = std::array::from_fn(|d| self.origin[d]);
        Space::new(self.spacing, origin, self.shape.first_offset(), reach)
    }

    /// Whether a position lies in the box of a static grid; true for other grids.
    pub fn holds<const D: usize>(&self, x: &[f64; D]) -> bool {
        let (min, max) = (&self.box_min, &self.box_max);
        self.grid_policy != GridPolicy::Static || (0..D).all(|d| min[d] <= x[d] && x[d] <= max[d])
    }

    /// Gravity must be finite, and along the axis in axial symmetry.
    pub fn check_gravity(&self, gravity: [f64; 3]) -> Result<()> {
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
        let moment = matches!(self.shape, ShapeKind::QuadraticBspline | ShapeKind::CubicBspline);
        if self.transfer == TransferKind::Mls && !moment {
            return unsupported(format!(
                "transfer MLS divides by Σ w r², which is not the same everywhere, or vanishes, for {} shape functions: use a \
                 quadratic or cubic B-spline, or transfer TPIC with this shape",
                self.shape.name()
            ));
        }
        if self.transfer == TransferKind::Mls && self.wall_treatment == WallTreatment::Modified {
            return unsupported(
                "transfer MLS does not go with shape functions modified at walls, where Σ w r² vanishes: use APIC with \
                 wall_treatment modified, or MLS with wall_treatment plain"
                    .into(),
            );
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
            blocks *= (max - min) / (4.0 * self.spacing) + 2.0;
        }
        if blocks > MOST_BLOCKS {
            return Err(Error::invalid(format!(
                "the static box would need {blocks:.2e} blocks, more than {MOST_BLOCKS:.0e}: use grid_policy dynamic"
            )));
        }
        Ok(())
    }
}

/// Damping must lie in [0, 1).
pub fn check_damping(damping: f64) -> Result<()> {
    if (0.0..1.0).contains(&damping) {
        return Ok(());
    }
    Err(Error::invalid(format!("damping must lie in [0, 1), got {damping}")))
}

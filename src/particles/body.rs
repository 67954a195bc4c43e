//! A body: particles of one material, and the blocks in which they stand.

use std::sync::Arc;

use super::Particles;
use crate::background::Run;
use crate::material::Material;

/// Edge lengths of the domains of a body's particles when it was added [m]; in two dimensions the
/// third is 1.
#[derive(Clone, Debug)]
pub enum Sizes {
    /// The host gave none.
    Unknown,
    /// The same for all.
    Uniform([f64; 3]),
    /// By id.
    Each(Vec<[f64; 3]>),
}

impl Sizes {
    /// Edge lengths of the particle with this id [m]; None if they are not known.
    pub fn of(&self, id: i64) -> Option<[f64; 3]> {
        match self {
            Self::Unknown => None,
            Self::Uniform(size) => Some(*size),
            Self::Each(sizes) => sizes.get(usize::try_from(id).ok()?).copied(),
        }
    }
}

/// A body: particles of one material.
pub struct Body {
    /// Id, never reused.
    pub id: i64,
    /// The velocity field that moves it, a layer of the grid.
    pub layer: u32,
    /// The material.
    pub material: Arc<Material>,
    /// The particles, sorted by block.
    pub particles: Particles,
    /// Particles of each block.
    pub runs: Vec<Run>,
    /// Edge lengths of the particles at first.
    pub sizes: Sizes,
    /// Whether the host gave stresses that have not been checked.
    pub stress_given: bool,
}

impl Body {
    /// Whether the body has F-bar.
    pub fn has_f_bar(&self) -> bool {
        self.particles.layout.dilation.is_some()
    }
}

//! Transfer schemes: what a particle gives to the grid and what it keeps of what comes back.
//!
//! Every scheme shares one scatter, `w m (v + A r)`, and one gather; it differs in two per-particle formulas.

pub mod apic;
pub mod pic_flip;

use crate::error::{Error, Result};

/// The transfer schemes that a world can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum TransferKind {
    /// Blend of PIC and FLIP, see [`pic_flip`].
    PicFlip = 0,
    /// Affine particle-in-cell, see [`apic`].
    Apic = 1,
}

impl TransferKind {
    /// The kind with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::PicFlip),
            1 => Ok(Self::Apic),
            _ => Err(Error::invalid(format!(
                "transfer must be 0 (PIC/FLIP) or 1 (APIC), got {value}"
            ))),
        }
    }
}

/// What the gather brings to a particle.
#[derive(Clone, Copy, Debug)]
pub struct Received<const D: usize> {
    /// Σ w v.
    pub velocity: [f64; D],
    /// Σ w Δv.
    pub increment: [f64; D],
    /// Σ w v ⊗ (x_i − x_p); zero unless asked for.
    pub moment: [[f64; D]; D],
    /// Σ v ⊗ ∇w [1/s].
    pub gradient: [[f64; D]; D],
}

impl<const D: usize> Default for Received<D> {
    fn default() -> Self {
        Self {
            velocity: [0.0; D],
            increment: [0.0; D],
            moment: [[0.0; D]; D],
            gradient: [[0.0; D]; D],
        }
    }
}

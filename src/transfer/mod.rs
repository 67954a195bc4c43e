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

impl TransferKind {
    /// Whether particles carry an affine matrix.
    pub fn is_affine(self) -> bool {
        self == Self::Apic
    }
}

/// What the gather brings to a particle, or to eight.
#[derive(Clone, Copy, Debug)]
pub struct Received<R, const D: usize> {
    /// Σ w v.
    pub velocity: [R; D],
    /// Σ w Δv; not meaningful if the transfer is affine.
    pub increment: [R; D],
    /// Σ w v ⊗ (x_i − x_p); only meaningful if the transfer is affine.
    pub moment: [[R; D]; D],
    /// Σ v ⊗ ∇w [1/s].
    pub gradient: [[R; D]; D],
}

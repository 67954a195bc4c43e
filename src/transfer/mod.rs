//! Transfer schemes: what a particle gives to the grid and what it keeps of what comes back.
//!
//! Every scheme shares one scatter, `w m (v + A r)`, and one gather; it differs in two per-particle formulas.

pub mod apic;
pub mod filter;
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
    /// Taylor particle-in-cell, see [`apic`].
    Tpic = 2,
    /// Affine particle-in-cell with the forces and gradients of moving least squares, see [`apic`].
    Mls = 3,
    /// Extended particle-in-cell, see [`filter`].
    Xpic = 4,
    /// Full-mass-matrix method, see [`filter`].
    Fmpm = 5,
}

impl TransferKind {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::PicFlip, Self::Apic, Self::Tpic, Self::Mls, Self::Xpic, Self::Fmpm];

    /// The kind with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        Self::ALL.into_iter().find(|kind| *kind as i32 == value).ok_or_else(|| {
            Error::invalid(format!(
                "transfer must be 0 (PIC/FLIP), 1 (APIC), 2 (TPIC), 3 (MLS), 4 (XPIC) or 5 (FMPM), got {value}"
            ))
        })
    }

    /// Whether particles carry an affine matrix.
    pub const fn is_affine(self) -> bool {
        matches!(self, Self::Apic | Self::Tpic | Self::Mls)
    }

    /// Whether particles take a filtered velocity.
    pub const fn is_filtered(self) -> bool {
        matches!(self, Self::Xpic | Self::Fmpm)
    }
}

/// What the gather brings to a particle, or to eight.
#[derive(Clone, Copy, Debug)]
pub struct Received<R, const D: usize> {
    /// Σ w v.
    pub velocity: [R; D],
    /// Σ w Δv, or what else stands in R1; Σ w v again if the transfer is affine and R1 is not asked for.
    pub increment: [R; D],
    /// Σ w v ⊗ (x_i − x_p); only meaningful if the transfer is affine.
    pub moment: [[R; D]; D],
    /// Σ v ⊗ ∇w [1/s].
    pub gradient: [[R; D]; D],
}

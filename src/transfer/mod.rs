//! Transfer schemes: what a particle adds to the grid and what it takes from it.
//!
//! Every scheme shares one scatter, `w m (v + A r)`, and one gather; it differs in two per-particle
//! formulas.

pub mod apic;
pub mod filter;
pub mod pic_flip;

use crate::choice::choices;

choices! {
    /// The transfer schemes that a world can use: [`pic_flip`], [`apic`] with its Taylor and moving
    /// least squares variants, and those of [`filter`].
    pub enum TransferKind: "transfer" {
        /// Transfer between particles and grid: a blend of PIC and FLIP, see `pic_rate`.
        PicFlip = 0, "pic_flip", LAHAR_TRANSFER_PIC_FLIP, "PIC/FLIP";
        /// Transfer between particles and grid: affine (APIC), which keeps angular momentum
        /// (default).
        Apic = 1, "apic", LAHAR_TRANSFER_APIC, "APIC";
        /// Transfer between particles and grid: Taylor (TPIC), affine with the velocity gradient;
        /// any shape function.
        Tpic = 2, "tpic", LAHAR_TRANSFER_TPIC, "TPIC";
        /// Transfer between particles and grid: APIC with the forces and gradients of moving least
        /// squares (MLS-MPM); B-splines.
        Mls = 3, "mls", LAHAR_TRANSFER_MLS, "MLS";
        /// Transfer between particles and grid: extended (XPIC) of order `filter_order`.
        Xpic = 4, "xpic", LAHAR_TRANSFER_XPIC, "XPIC";
        /// Transfer between particles and grid: full-mass-matrix (FMPM) of order `filter_order`.
        Fmpm = 5, "fmpm", LAHAR_TRANSFER_FMPM, "FMPM";
    }
}

impl TransferKind {
    /// Whether particles carry an affine matrix.
    pub const fn is_affine(self) -> bool {
        matches!(self, Self::Apic | Self::Tpic | Self::Mls)
    }

    /// Whether particles take a filtered velocity.
    pub const fn is_filtered(self) -> bool {
        matches!(self, Self::Xpic | Self::Fmpm)
    }
}

/// What a particle, or eight, take from the grid in a gather.
#[derive(Clone, Copy, Debug)]
pub struct Received<R, const D: usize> {
    /// Σ w v.
    pub velocity: [R; D],
    /// Σ w Δv, or what else stands in R1; Σ w v again if the transfer is affine and R1 is not
    /// needed.
    pub increment: [R; D],
    /// Σ w v ⊗ (x_i − x_p); only meaningful if the transfer is affine.
    pub moment: [[R; D]; D],
    /// Σ v ⊗ ∇w [1/s].
    pub gradient: [[R; D]; D],
}

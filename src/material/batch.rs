//! The view that a material has of points: three-dimensional tensors, component by component.

/// Safe counterpart of `lahar_stress_batch`: one call for `n` points.
///
/// Component `c` of point `k` stands at `array[c * stride + k]`, so that an array of `C` components
/// has `C * stride` elements; `stride` is a multiple of 8 and at least `n`, and bases are 64-byte
/// aligned. An empty slice stands for an array that was not asked for. Symmetric tensors are xx,
/// yy, zz, xy, yz, zx, gradients row-major, tension positive.
pub struct StressBatch<'a> {
    /// Number of points.
    pub n: usize,
    /// Distance of components; a multiple of 8, at least `n`.
    pub stride: usize,
    /// Length of the step [s].
    pub dt: f64,
    /// Time at the start of the step [s].
    pub time: f64,
    /// Number of steps before this one; -1 if there is no such count.
    pub step: i64,
    /// dt sym L, 6 components [-].
    pub strain_increment: &'a [f64],
    /// L, 9 components [1/s].
    pub velocity_gradient: &'a [f64],
    /// F at the end of the step, 9 components [-].
    pub deformation_gradient: &'a [f64],
    /// Cauchy stress at the start, 6 components [Pa].
    pub stress0: &'a [f64],
    /// State at the start, [`Model::state_components`](super::Model::state_components) components.
    pub state0: &'a [f64],
    /// Cauchy stress at the end, 6 components [Pa]; written by `update`.
    pub stress1: &'a mut [f64],
    /// State at the end; written by `update` and by `init_state`.
    pub state1: &'a mut [f64],
    /// The inputs that the model wants, one component each.
    pub inputs: &'a [f64],
    /// Speed of the fastest wave [m/s].
    pub wave_speed: &'a mut [f64],
    /// Kinematic diffusivity [m^2/s].
    pub diffusivity: &'a mut [f64],
    /// Stored energy per current volume [J/m^3].
    pub energy: &'a mut [f64],
    /// Wanted factor on the next time step [-].
    pub dt_factor: &'a mut [f64],
    /// One of `LAHAR_POINT_*` per point; the caller sets it to 0 before.
    pub status: &'a mut [i32],
}

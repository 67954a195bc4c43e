//! Calls a VUMAT, block by block.
//!
//! Its tensors are components along axes that turn with the material: with R of F = R U, the stress is Rᵀ σ R, the strain increment R₁ᵀ Δε R₁. The
//! order is 11, 22, 33, 12, 23, 31 with tensor shears; a block has component c of point k of n at `base[c * n + k]`.

use crate::calls::{Instance, Points, store};
use crate::describe::{
    Adapted, DENSITY, ELEMENT_LENGTH, INTERNAL_ENERGY, PARTICLE_ID, POSITION, TEMPERATURE,
};
use crate::fpenv;
use crate::host::log;
use crate::kinematics::{
    IDENTITY, LANES, Lane, components, deformed, lane, lanes, polar_rotations, product, rotated,
    rotation_vector, spin, strain_increment, transposed, zero,
};
use crate::library::Functions;
use crate::modulus::wave_modulus;
use crate::sidecar::HiddenLength;
use crate::umat::{BEHIND, BEYOND, UNTOUCHED};
use lahar_plugin_abi::*;
use std::cell::RefCell;
use std::ffi::{c_char, c_int, c_void};

macro_rules! vumat_type {
    ($($length:ty)?) => {
        unsafe extern "C" fn(
            *mut i32, *mut i32, *mut i32, *mut i32, *mut i32, *mut i32, *mut i32, *mut f64, *mut f64, *mut f64,
            *mut c_char, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64,
            *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64,
            *mut f64, *mut f64, *mut f64 $(, $length)?
        )
    };
}

/// Most points of a call: VUMATs have arrays of `maxblk` = 136 of their own.
const BLOCK: usize = 128;

/// Components of the deformation gradient, row-major, in the order F11, F22, F33, F12, F23, F31, F21, F32, F13; in the plane the first four and F21.
const GENERAL: [usize; 9] = [0, 4, 8, 1, 5, 6, 3, 7, 2];
const GENERAL_PLANE: [usize; 5] = [0, 4, 8, 1, 3];

/// The arguments of a call.
struct Block {
    routine: *const c_void,
    hidden_length: HiddenLength,
    /// Number of points, then number of the integration point, layer, section point, and the elements: scalar for most, an array for some.
    jblock: Vec<i32>,
    ndir: i32,
    nshr: i32,
    nstatev: i32,
    nfieldv: i32,
    nprops: i32,
    lanneal: i32,
    step_time: f64,
    total_time: f64,
    dt: f64,
    cmname: [u8; 80],
    coord_mp: Vec<f64>,
    char_length: Vec<f64>,
    props: Vec<f64>,
    density: Vec<f64>,
    strain_inc: Vec<f64>,
    rel_spin_inc: Vec<f64>,
    temp: [Vec<f64>; 2],
    stretch: [Vec<f64>; 2],
    defgrad: [Vec<f64>; 2],
    field: [Vec<f64>; 2],
    stress: [Vec<f64>; 2],
    state: [Vec<f64>; 2],
    ener_intern: [Vec<f64>; 2],
    ener_inelas: [Vec<f64>; 2],
    /// R at the end.
    rotation: Vec<[Lane; 9]>,
    /// F at the end.
    new: Vec<[Lane; 9]>,
}

thread_local! {
    static SPACE: RefCell<Block> = const { RefCell::new(Block::NEW) };
}

/// Calls the routine with the arguments at `data`.
///
/// # Safety
///
/// `data` points to a `Block` whose routine is a VUMAT with the hidden length that it says. No destructor may stand in here: XPLB_EXIT of the
/// utility routines jumps out of the routine over this function.
unsafe extern "C" fn call(data: *mut c_void) {
    // SAFETY: guaranteed by the caller.
    let b = unsafe { &mut *data.cast::<Block>() };
    let ([t0, t1], [u0, u1], [f0, f1]) = (&mut b.temp, &mut b.stretch, &mut b.defgrad);
    let ([v0, v1], [s0, s1], [q0, q1]) = (&mut b.field, &mut b.stress, &mut b.state);
    let ([e0, e1], [d0, d1]) = (&mut b.ener_intern, &mut b.ener_inelas);
    macro_rules! call {
        ($kind:ty $(, $length:expr)?) => {{
            // SAFETY: the caller says that the routine is a VUMAT; the pointers are to places as long as it expects.
            unsafe {
                let routine: $kind = std::mem::transmute(b.routine);
                routine(
                    b.jblock.as_mut_ptr(), &mut b.ndir, &mut b.nshr, &mut b.nstatev, &mut b.nfieldv, &mut b.nprops,
                    &mut b.lanneal, &mut b.step_time, &mut b.total_time, &mut b.dt, b.cmname.as_mut_ptr().cast(),
                    b.coord_mp.as_mut_ptr(), b.char_length.as_mut_ptr(), b.props.as_mut_ptr(), b.density.as_mut_ptr(),
                    b.strain_inc.as_mut_ptr(), b.rel_spin_inc.as_mut_ptr(), t0.as_mut_ptr(), u0.as_mut_ptr(),
                    f0.as_mut_ptr(), v0.as_mut_ptr(), s0.as_mut_ptr(), q0.as_mut_ptr(), e0.as_mut_ptr(), d0.as_mut_ptr(),
                    t1.as_mut_ptr(), u1.as_mut_ptr(), f1.as_mut_ptr(), v1.as_mut_ptr(), s1.as_mut_ptr(), q1.as_mut_ptr(),
                    e1.as_mut_ptr(), d1.as_mut_ptr() $(, $length)?
                )
            }
        }};
    }
    match b.hidden_length {
        HiddenLength::SizeT => call!(vumat_type!(usize), 80),
        HiddenLength::Int => call!(vumat_type!(c_int), 80),
        HiddenLength::None => call!(vumat_type!()),
    }
}

/// One step.
pub fn update(instance: &Instance, p: &mut Points<'_>) -> Result<(), String> {
    let functions = instance.adapted.library.functions()?;
    if instance.adapted.ntens == 4 {
        crate::umat::in_plane(p)?;
    }
    SPACE.with_borrow_mut(|b| {
        for first in (0..p.n).step_by(BLOCK) {
            let m = BLOCK.min(p.n - first);
            b.begin(instance, &functions, m);
            (b.step_time, b.total_time) = (p.time + p.dt, p.time + p.dt);
            b.dt = p.dt;
            b.fill_scalars(instance.adapted, p, first, m);
            #[cfg(target_arch = "x86_64")]
            match is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has the instructions.
                true => unsafe { b.fill_tensors_avx2(instance.adapted, p, first, m) },
                false => b.fill_tensors(instance.adapted, p, first, m),
            }
            #[cfg(not(target_arch = "x86_64"))]
            b.fill_tensors(instance.adapted, p, first, m);
            let done = b.call(instance, &functions)?;
            if !done {
                log(
                    LAHAR_PLUGIN_LOG_WARNING,
                    &format!("the VUMAT ended its call with XPLB_EXIT at time {}", p.time),
                );
            }
            b.give(instance, p, (first, m), done);
        }
        Ok(())
    })
}

/// Wave speeds of the elastic response at the very beginning, as Abaqus takes them.
pub fn wave_speed(instance: &Instance, p: &mut Points<'_>) -> Result<(), String> {
    for (speed, density) in p.wave_speed.iter_mut().zip(p.inputs[DENSITY]) {
        *speed = (instance.floor / density).sqrt();
    }
    Ok(())
}

/// The modulus of waves [Pa] from small strains of one component each at time zero, to which a VUMAT answers elastically (Abaqus asks it so too).
pub fn first_modulus(instance: &Instance) -> Result<f64, String> {
    const STRAIN: f64 = 1e-6;
    let (adapted, ntens) = (instance.adapted, instance.adapted.ntens);
    let functions = adapted.library.functions()?;
    SPACE.with_borrow_mut(|b| {
        b.begin(instance, &functions, ntens);
        (b.step_time, b.total_time, b.dt) = (0.0, 0.0, STRAIN);
        b.density.fill(1000.0);
        b.char_length.fill(1.0);
        for temp in &mut b.temp {
            temp.fill(293.15);
        }
        for k in 0..ntens {
            b.jblock[4 + k] = k as i32 + 1;
            b.strain_inc[k * ntens + k] = STRAIN;
            let mut f = IDENTITY;
            for (old_or_new, strain) in [(0, 0.0), (1, STRAIN)] {
                let (i, j) = crate::kinematics::SYMMETRIC[k];
                f[3 * i + j] = IDENTITY[3 * i + j] + strain;
                f[3 * j + i] = f[3 * i + j];
                let stretch = crate::kinematics::SYMMETRIC.map(|(i, j)| f[3 * i + j]);
                put(&mut b.stretch[old_or_new], ntens, k, &stretch[..ntens]);
                put_general(&mut b.defgrad[old_or_new], ntens, k, adapted, &f);
            }
            for (i, value) in adapted.initial.iter().enumerate() {
                b.state[0][i * ntens + k] = *value;
                b.state[1][i * ntens + k] = *value;
            }
        }
        let done = b.call(instance, &functions)?;
        // A tensor shear strain stands for two places: half of it is the component of the engineering shear.
        let mut tangent = [0.0; 36];
        for i in 0..ntens {
            for j in 0..ntens {
                let half = if j < 3 { 1.0 } else { 0.5 };
                tangent[i + ntens * j] = half * b.stress[1][i * ntens + j] / STRAIN;
            }
        }
        let modulus = wave_modulus(ntens, &tangent);
        match done && modulus > 0.0 && modulus.is_finite() {
            true => Ok(modulus),
            false if instance.floor > 0.0 => Ok(0.0),
            false => Err("the VUMAT gave no stress for small strains at time zero, from which the speed of waves comes; give \
                          `modulus`, a number [Pa] or the key of a parameter, in the sidecar"
                .into()),
        }
    })
}

/// Writes the components of point `k` of a block of `m`.
fn put(to: &mut [f64], m: usize, k: usize, components: &[f64]) {
    for (c, value) in components.iter().enumerate() {
        to[c * m + k] = *value;
    }
}

fn put_general(to: &mut [f64], m: usize, k: usize, adapted: &Adapted, f: &[f64; 9]) {
    let order = if adapted.ntens == 6 { &GENERAL[..] } else { &GENERAL_PLANE };
    for (c, from) in order.iter().enumerate() {
        to[c * m + k] = f[*from];
    }
}

impl Block {
    const NEW: Self = Self {
        routine: std::ptr::null(),
        hidden_length: HiddenLength::SizeT,
        jblock: Vec::new(),
        ndir: 3,
        nshr: 3,
        nstatev: 0,
        nfieldv: 0,
        nprops: 0,
        lanneal: 0,
        step_time: 0.0,
        total_time: 0.0,
        dt: 0.0,
        cmname: [b' '; 80],
        coord_mp: Vec::new(),
        char_length: Vec::new(),
        props: Vec::new(),
        density: Vec::new(),
        strain_inc: Vec::new(),
        rel_spin_inc: Vec::new(),
        temp: [Vec::new(), Vec::new()],
        stretch: [Vec::new(), Vec::new()],
        defgrad: [Vec::new(), Vec::new()],
        field: [Vec::new(), Vec::new()],
        stress: [Vec::new(), Vec::new()],
        state: [Vec::new(), Vec::new()],
        ener_intern: [Vec::new(), Vec::new()],
        ener_inelas: [Vec::new(), Vec::new()],
        rotation: Vec::new(),
        new: Vec::new(),
    };

    /// Room for `m` points, all zero.
    fn begin(&mut self, instance: &Instance, functions: &Functions, m: usize) {
        let adapted = instance.adapted;
        let (ntens, nstatev, nfield) = (adapted.ntens, adapted.states.len(), adapted.predef.len());
        self.routine = functions.routine;
        self.hidden_length = adapted.hidden_length;
        (self.nshr, self.ndir, self.lanneal) = (ntens as i32 - 3, 3, 0);
        (self.nstatev, self.nfieldv) = (nstatev as i32, nfield as i32);
        self.nprops = instance.props.len() as i32;
        self.cmname = adapted.cmname;
        self.jblock.clear();
        self.jblock.extend([m as i32, 1, 1, 1]);
        self.jblock.resize(4 + m, 0);
        let room = |array: &mut Vec<f64>, components: usize| {
            array.clear();
            array.resize((components * m).max(1), 0.0);
        };
        self.props.clone_from(&instance.props);
        self.props.resize(instance.props.len() + BEYOND, f64::NAN);
        room(&mut self.coord_mp, 3);
        for scalar in [&mut self.char_length, &mut self.density] {
            room(scalar, 1);
        }
        room(&mut self.strain_inc, ntens);
        room(&mut self.rel_spin_inc, ntens - 3);
        for i in 0..2 {
            for scalar in [&mut self.temp[i], &mut self.ener_intern[i], &mut self.ener_inelas[i]] {
                room(scalar, 1);
            }
            room(&mut self.stretch[i], ntens);
            room(&mut self.stress[i], ntens);
            room(&mut self.defgrad[i], 2 * ntens - 3);
            room(&mut self.field[i], nfield);
            room(&mut self.state[i], nstatev);
            self.state[i].truncate(nstatev * m);
            self.state[i].resize(nstatev * m + BEHIND, UNTOUCHED);
        }
        self.rotation.clear();
        self.new.clear();
    }

    /// What is one value per point, and the state.
    fn fill_scalars(&mut self, adapted: &Adapted, p: &Points<'_>, first: usize, m: usize) {
        let points = first..first + m;
        for (k, id) in p.inputs[PARTICLE_ID][points.clone()].iter().enumerate() {
            self.jblock[4 + k] = (*id as i32).saturating_add(1);
        }
        for axis in 0..3 {
            self.coord_mp[axis * m..][..m]
                .copy_from_slice(&p.inputs[POSITION + axis][points.clone()]);
        }
        self.char_length.copy_from_slice(&p.inputs[ELEMENT_LENGTH][points.clone()]);
        self.density.copy_from_slice(&p.inputs[DENSITY][points.clone()]);
        for i in 0..2 {
            self.temp[i].copy_from_slice(&p.inputs[TEMPERATURE][points.clone()]);
            self.ener_intern[i].copy_from_slice(&p.inputs[INTERNAL_ENERGY][points.clone()]);
            for (f, input) in adapted.predef.iter().enumerate() {
                self.field[i][f * m..][..m].copy_from_slice(&p.inputs[*input][points.clone()]);
            }
            for (c, place) in adapted.states.iter().enumerate() {
                let from = &p.state0[place.component * p.stride..][points.clone()];
                for (to, value) in self.state[i][c * m..][..m].iter_mut().zip(from) {
                    *to = place.factor * value;
                }
            }
            if let Some(energies) = adapted.energies {
                let from = &p.state0[(energies + 1) * p.stride..][points.clone()];
                self.ener_inelas[i].copy_from_slice(from);
            }
        }
    }

    /// Stress, strain, stretch and spin along the axes that turn with the material.
    #[inline(always)]
    fn fill_tensors(&mut self, adapted: &Adapted, p: &Points<'_>, first: usize, m: usize) {
        let ntens = adapted.ntens;
        for k in (0..m).step_by(LANES) {
            let at = first + k;
            let (mut h, mut l, mut stress): ([Lane; 9], [Lane; 9], [Lane; 6]) =
                (zero(), zero(), zero());
            p.load_all(p.state0, adapted.displacement_gradient, at, &mut h);
            p.load_all(p.gradient, 0, at, &mut l);
            p.load_all(p.stress0, 0, at, &mut stress);
            let (mut old, mut new, mut r0, mut r1) = (zero(), zero(), zero(), zero());
            lanes(&mut old, |k| components(|c| h[c][k] + IDENTITY[c]));
            lanes(&mut new, |k| deformed(lane(&old, k), lane(&l, k), p.dt));
            polar_rotations(&old, &mut r0);
            polar_rotations(&new, &mut r1);
            for i in 0..LANES.min(m - k) {
                let (k, back0, back1) = (k + i, transposed(lane(&r0, i)), transposed(lane(&r1, i)));
                let l = lane(&l, i);
                let corotational = rotated(back0, lane(&stress, i));
                put(&mut self.stress[0], m, k, &corotational[..ntens]);
                put(&mut self.stress[1], m, k, &corotational[..ntens]);
                let increment = rotated(back1, strain_increment(l, p.dt));
                put(&mut self.strain_inc, m, k, &increment[..ntens]);
                let turn = rotation_vector(product(lane(&r1, i), back0));
                let [w01, w12, w02] = spin(l, p.dt);
                let relative = [-w12 - turn[0], w02 - turn[1], -w01 - turn[2]];
                let relative: [f64; 3] =
                    components(|a| (0..3).map(|b| back1[3 * a + b] * relative[b]).sum());
                put(
                    &mut self.rel_spin_inc,
                    m,
                    k,
                    if ntens == 6 { &relative } else { &relative[2..] },
                );
                for (end, (back, f)) in [(back0, &old), (back1, &new)].into_iter().enumerate() {
                    let u = product(back, lane(f, i));
                    let u = crate::kinematics::SYMMETRIC.map(|(a, b)| u[3 * a + b]);
                    put(&mut self.stretch[end], m, k, &u[..ntens]);
                    put_general(&mut self.defgrad[end], m, k, adapted, &lane(f, i));
                }
            }
            self.rotation.push(r1);
            self.new.push(new);
        }
    }

    /// The same with wider instructions: no product is fused with a sum, so the numbers are the same.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn fill_tensors_avx2(&mut self, adapted: &Adapted, p: &Points<'_>, first: usize, m: usize) {
        self.fill_tensors(adapted, p, first, m);
    }

    /// Calls the routine; false if it ended itself.
    fn call(&mut self, instance: &Instance, functions: &Functions) -> Result<bool, String> {
        let control = fpenv::control();
        let data = std::ptr::from_mut(self).cast();
        // SAFETY: the arguments are set for this routine. The guard of the utility routines calls `call(data)`, or jumps out of it.
        let left = unsafe {
            match functions.guard {
                Some(guard) => guard(call, data),
                None => {
                    call(data);
                    0
                }
            }
        };
        fpenv::set_back(control);
        let nstatev = instance.adapted.states.len();
        let values = self.state[1].len() - BEHIND;
        if self.state[1][values..].iter().any(|x| x.to_bits() != UNTOUCHED.to_bits()) {
            return Err(format!(
                "the VUMAT wrote behind stateNew(nblock, {nstatev}); give the number of state variables as `states` in the sidecar {}",
                instance.adapted.library.path().with_extension("json").display()
            ));
        }
        Ok(left == 0)
    }

    /// Writes what the routine gave to the points from `first` on.
    fn give(
        &mut self,
        instance: &Instance,
        p: &mut Points<'_>,
        (first, m): (usize, usize),
        done: bool,
    ) {
        let (adapted, shape) = (instance.adapted, (p.n, p.stride));
        for k in 0..m {
            let at = first + k;
            let (modulus, sane) = self.modulus(adapted, k, m);
            let deformation = lane(&self.new[k / LANES], k % LANES);
            let speed = (modulus.max(instance.floor) / p.inputs[DENSITY][at]).sqrt();
            let sum: f64 = deformation.iter().map(|x| 0.0 * x).sum();
            let sane = sane && done && sum + 0.0 * speed == 0.0;
            p.wave_speed[at] = if sane { speed } else { 0.0 };
            if let Some(status) = p.status.get_mut(at) {
                *status = if sane { LAHAR_POINT_OK } else { LAHAR_POINT_FAILED };
            }
            let end = usize::from(sane);
            for (c, place) in adapted.states.iter().enumerate() {
                p.state1[place.component * p.stride + at] =
                    self.state[end][c * m + k] * place.inverse;
            }
            for c in &adapted.unused {
                p.state1[c * p.stride + at] = p.state0[c * p.stride + at];
            }
            if let Some(energies) = adapted.energies {
                let all = [self.ener_intern[end][k], self.ener_inelas[end][k], 0.0];
                for (e, value) in all.iter().enumerate() {
                    p.state1[(energies + e) * p.stride + at] = *value;
                }
                if let Some(energy) = p.energy.get_mut(at) {
                    *energy = all[0] * p.inputs[DENSITY][at];
                }
            }
        }
        for (block, r1) in self.rotation.iter().enumerate() {
            let k = block * LANES;
            let mut here = zero();
            lanes(&mut here, |i| {
                let k = (k + i).min(m - 1);
                let stress = std::array::from_fn(|c| {
                    if c < adapted.ntens { self.stress[1][c * m + k] } else { 0.0 }
                });
                rotated(lane(r1, i), stress)
            });
            for (c, lane) in here.iter().enumerate() {
                store(p.stress1, shape, c, first + k, lane);
            }
            for c in 0..9 {
                let lane = std::array::from_fn(|i| self.new[block][c][i] - IDENTITY[c]);
                store(p.state1, shape, adapted.displacement_gradient + c, first + k, &lane);
            }
        }
    }

    /// K + 4/3 G of the step just made, from how pressure and deviator follow their strains, where those are large enough (as Abaqus
    /// does); and whether stress and state are finite.
    fn modulus(&self, adapted: &Adapted, k: usize, m: usize) -> (f64, bool) {
        let ntens = adapted.ntens;
        let part = |array: &Vec<f64>, c: usize| array[c * m + k];
        let change: [f64; 6] = std::array::from_fn(|c| {
            if c < ntens { part(&self.stress[1], c) - part(&self.stress[0], c) } else { 0.0 }
        });
        let strain: [f64; 6] =
            std::array::from_fn(|c| if c < ntens { part(&self.strain_inc, c) } else { 0.0 });
        let states = (0..adapted.states.len()).map(|c| 0.0 * part(&self.state[1], c)).sum::<f64>();
        let sane = change.iter().map(|x| 0.0 * x).sum::<f64>() + states == 0.0;
        let mean = |a: &[f64; 6]| (a[0] + a[1] + a[2]) / 3.0;
        let (volume, pressure) = (mean(&strain), mean(&change));
        let (mut along, mut size) = (0.0, 0.0);
        for c in 0..6 {
            let weight = if c < 3 { 1.0 } else { 2.0 };
            let from = |a: &[f64; 6], mean: f64| if c < 3 { a[c] - mean } else { a[c] };
            let (e, s) = (from(&strain, volume), from(&change, pressure));
            along += weight * e * s;
            size += weight * e * e;
        }
        const LEAST: f64 = 1e-12;
        let bulk = if volume.abs() > LEAST { pressure / (3.0 * volume) } else { 0.0 };
        let shear = if size > LEAST * LEAST { 0.5 * along / size } else { 0.0 };
        let modulus = bulk.max(0.0) + 4.0 / 3.0 * shear.max(0.0);
        (if modulus.is_finite() { modulus } else { 0.0 }, sane)
    }
}

//! Calls a UMAT, point by point.
//!
//! A UMAT may write into its inputs, so every argument is set before every call. The order of components is 11, 22, 33, 12, 13, 23, strains
//! have engineering shears, tensors of two places are stored by columns.

use crate::calls::{Call, Instance, Points, store};
use crate::describe::{
    Adapted, DENSITY, ELEMENT_LENGTH, ORDER, PARTICLE_ID, POSITION, TEMPERATURE,
};
use crate::fpenv;
use crate::host::log;
use crate::kinematics::{
    IDENTITY, LANES, Lane, components, deformed, lane, lanes, rotated, step_rotations,
    strain_increment, transposed, zero,
};
use crate::library::Functions;
use crate::modulus::wave_modulus;
use crate::sidecar::HiddenLength;
use lahar_plugin_abi::*;
use std::cell::RefCell;
use std::ffi::{c_char, c_int, c_void};

macro_rules! umat_type {
    ($($length:ty)?) => {
        unsafe extern "C" fn(
            *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64,
            *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut f64, *mut c_char,
            *mut i32, *mut i32, *mut i32, *mut i32, *mut f64, *mut i32, *mut f64, *mut f64, *mut f64, *mut f64,
            *mut f64, *mut f64, *mut i32, *mut i32, *mut i32, *mut i32, *mut i32, *mut i32 $(, $length)?
        )
    };
}

/// STATEV(NSTATV + 1) and what follows: a routine that writes there was built for more state variables.
pub const BEHIND: usize = 1024;
/// How many of them are looked at after each call; all are after each batch.
const LOOKED_AT: usize = 4;
/// What stands there.
pub const UNTOUCHED: f64 = f64::from_bits(0x7ff8_1a4a_0000_beef);

/// Values behind PROPS(NPROPS), which are no numbers: a routine that reads there fails.
pub const BEYOND: usize = 64;

/// DTIME where no step is known yet, as in `wave_speed`.
const SOME_STEP: f64 = 1e-6;

/// The arguments of a call.
#[repr(C, align(64))]
struct Arguments {
    /// One of each of eight points, looked at together afterwards.
    ddsdde: [[f64; 36]; LANES],
    routine: *const c_void,
    hidden_length: HiddenLength,
    stress: [f64; 6],
    /// Which of them is called.
    lane: usize,
    energies: [f64; 3],
    rpl: f64,
    ddsddt: [f64; 6],
    drplde: [f64; 6],
    drpldt: f64,
    stran: [f64; 6],
    dstran: [f64; 6],
    time: [f64; 2],
    dtime: f64,
    temp: f64,
    dtemp: f64,
    predef: [f64; 8],
    dpred: [f64; 8],
    cmname: [u8; 80],
    ndi: i32,
    nshr: i32,
    ntens: i32,
    nstatv: i32,
    nprops: i32,
    coords: [f64; 3],
    drot: [f64; 9],
    pnewdt: f64,
    celent: f64,
    dfgrd0: [f64; 9],
    dfgrd1: [f64; 9],
    noel: i32,
    npt: i32,
    layer: i32,
    kspt: i32,
    kstep: [i32; 4],
    kinc: i32,
    statev: Vec<f64>,
    props: Vec<f64>,
    /// How vector arithmetic is to be after every eight calls.
    control: u32,
}

thread_local! {
    static ARGUMENTS: RefCell<Arguments> = const { RefCell::new(Arguments::NEW) };
}

/// Calls the routine with the arguments at `data`.
///
/// # Safety
///
/// `data` points to `Arguments` whose routine is a UMAT with the hidden length that they say. No destructor may stand in here: XIT of the
/// utility routines jumps out of the routine over this function.
unsafe extern "C" fn call(data: *mut c_void) {
    // SAFETY: guaranteed by the caller.
    let a = unsafe { &mut *data.cast::<Arguments>() };
    let [sse, spd, scd] = &mut a.energies;
    let ddsdde = a.ddsdde[a.lane & (LANES - 1)].as_mut_ptr();
    macro_rules! call {
        ($kind:ty $(, $length:expr)?) => {{
            // SAFETY: the caller says that the routine is a UMAT; the pointers are to places as long as it expects.
            unsafe {
                let routine: $kind = std::mem::transmute(a.routine);
                routine(
                    a.stress.as_mut_ptr(), a.statev.as_mut_ptr(), ddsdde, sse, spd, scd, &mut a.rpl,
                    a.ddsddt.as_mut_ptr(), a.drplde.as_mut_ptr(), &mut a.drpldt, a.stran.as_mut_ptr(),
                    a.dstran.as_mut_ptr(), a.time.as_mut_ptr(), &mut a.dtime, &mut a.temp, &mut a.dtemp,
                    a.predef.as_mut_ptr(), a.dpred.as_mut_ptr(), a.cmname.as_mut_ptr().cast(), &mut a.ndi, &mut a.nshr,
                    &mut a.ntens, &mut a.nstatv, a.props.as_mut_ptr(), &mut a.nprops, a.coords.as_mut_ptr(),
                    a.drot.as_mut_ptr(), &mut a.pnewdt, &mut a.celent, a.dfgrd0.as_mut_ptr(), a.dfgrd1.as_mut_ptr(),
                    &mut a.noel, &mut a.npt, &mut a.layer, &mut a.kspt, a.kstep.as_mut_ptr(), &mut a.kinc $(, $length)?
                )
            }
        }};
    }
    match a.hidden_length {
        HiddenLength::SizeT => call!(umat_type!(usize), 80),
        HiddenLength::Int => call!(umat_type!(c_int), 80),
        HiddenLength::None => call!(umat_type!()),
    }
}

/// The kinematics of eight points.
struct Start {
    stress: [Lane; 6],
    strain: [Lane; 6],
    increment: [Lane; 6],
    rotation: [Lane; 9],
    old: [Lane; 9],
    new: [Lane; 9],
    /// 0, or not a number where strain or deformation are not.
    doubt: Lane,
}

/// What a call left, before its numbers are looked at.
#[derive(Clone, Copy)]
struct Outcome {
    /// XIT ended it.
    left: bool,
    /// Stress and state are finite.
    finite: bool,
    pnewdt: f64,
}

/// Runs `update`, or `wave_speed`: a step without strain of which only the tangent counts.
pub fn run(instance: &Instance, p: &mut Points<'_>, call: Call) -> Result<(), String> {
    let functions = instance.adapted.library.functions()?;
    if instance.adapted.ntens == 4 && call == Call::Update {
        in_plane(p)?;
    }
    ARGUMENTS.with_borrow_mut(|a| {
        a.begin(instance, &functions);
        #[cfg(target_arch = "x86_64")]
        let left = match is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the instructions.
            true => unsafe { all_avx2(instance, &functions, a, p, call) },
            false => all(instance, &functions, a, p, call),
        };
        #[cfg(not(target_arch = "x86_64"))]
        let left = all(instance, &functions, a, p, call);
        let left = left?;
        if let Some(id) = left {
            log(
                LAHAR_PLUGIN_LOG_WARNING,
                &format!("the UMAT ended its call with XIT at particle {id}, time {}", p.time),
            );
        }
        Ok(())
    })
}

/// NTENS = 4 leaves no room for shears out of the plane.
pub fn in_plane(p: &Points<'_>) -> Result<(), String> {
    let out = [2, 5, 6, 7].iter().flat_map(|c| &p.gradient[c * p.stride..][..p.n]);
    if out.into_iter().any(|x| *x != 0.0) {
        return Err("the sidecar says `ntens` 4, which is for plane strain, but the points shear out of the plane; set `ntens` to 6 for \
                    three dimensions"
            .into());
    }
    Ok(())
}

impl Start {
    const STILL: Self = Self {
        stress: [[0.0; LANES]; 6],
        strain: [[0.0; LANES]; 6],
        increment: [[0.0; LANES]; 6],
        rotation: [[0.0; LANES]; 9],
        old: [[0.0; LANES]; 9],
        new: [[0.0; LANES]; 9],
        doubt: [0.0; LANES],
    };

    /// The points from `k` on: the start stress is turned with the material, as Abaqus does before it calls.
    #[inline(always)]
    fn fill(&mut self, adapted: &Adapted, p: &Points<'_>, call: Call, k: usize) {
        let mut stress = zero();
        p.load_all(p.stress0, 0, k, &mut stress);
        p.load_all(p.state0, adapted.total_strain, k, &mut self.strain);
        p.load_all(p.state0, adapted.displacement_gradient, k, &mut self.old);
        for c in 0..9 {
            for i in 0..LANES {
                self.old[c][i] += IDENTITY[c];
            }
        }
        if call == Call::WaveSpeed {
            self.stress = stress;
            self.rotation = IDENTITY.map(|x| [x; LANES]);
            self.new = self.old;
            self.look();
            return;
        }
        let mut l = zero();
        p.load_all(p.gradient, 0, k, &mut l);
        step_rotations(&l, p.dt, &mut self.rotation);
        let (r, f) = (&self.rotation, &self.old);
        lanes(&mut self.stress, |k| rotated(lane(r, k), lane(&stress, k)));
        lanes(&mut self.increment, |k| strain_increment(lane(&l, k), p.dt));
        lanes(&mut self.new, |k| deformed(lane(f, k), lane(&l, k), p.dt));
        self.look();
    }

    /// What is not finite in F or strain stays so in these sums.
    #[inline(always)]
    fn look(&mut self) {
        self.doubt = [0.0; LANES];
        for component in self.new.iter().chain(&self.strain) {
            for i in 0..LANES {
                self.doubt[i] += 0.0 * component[i];
            }
        }
    }
}

/// Calls the routine for all points; the id of the first that ended by XIT.
#[inline(always)]
fn all(
    instance: &Instance,
    functions: &Functions,
    a: &mut Arguments,
    p: &mut Points<'_>,
    call: Call,
) -> Result<Option<f64>, String> {
    let (mut start, mut left) = (Start::STILL, None);
    for k in (0..p.n).step_by(LANES) {
        start.fill(instance.adapted, p, call, k);
        left = left.or(eight(instance, functions, a, p, (call, k), &start)?);
    }
    a.look_behind(instance, BEHIND)?;
    Ok(left)
}

/// The same with wider instructions: no product is fused with a sum, so the numbers are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn all_avx2(
    instance: &Instance,
    functions: &Functions,
    a: &mut Arguments,
    p: &mut Points<'_>,
    call: Call,
) -> Result<Option<f64>, String> {
    all(instance, functions, a, p, call)
}

/// Calls the routine for the points from `k` on and writes what they gave; the id of the first that ended by XIT.
#[inline(always)]
fn eight(
    instance: &Instance,
    functions: &Functions,
    a: &mut Arguments,
    p: &mut Points<'_>,
    (call, k): (Call, usize),
    start: &Start,
) -> Result<Option<f64>, String> {
    let adapted = instance.adapted;
    let (shape, update) = ((p.n, p.stride), call == Call::Update);
    let (m, mut left) = (LANES.min(p.n - k), None);
    let mut outcomes = [Outcome { left: false, finite: true, pnewdt: 0.0 }; LANES];
    let mut stress = start.stress;
    for (i, outcome) in outcomes[..m].iter_mut().enumerate() {
        a.set(instance, p, start, (k, i));
        *outcome = a.call(instance, functions)?;
        if update {
            a.keep_state(adapted, p, k + i);
            for c in 0..adapted.ntens {
                stress[ORDER[c]][i] = a.stress[c];
            }
        }
    }
    // Not after each call: to read the bits is to wait for all arithmetic before.
    fpenv::set_back(a.control);
    let mut density = [[1.0; LANES]];
    p.load_all(p.inputs[DENSITY], 0, k, &mut density);
    let mut moduli = [0.0; LANES];
    for (i, outcome) in outcomes[..m].iter().enumerate() {
        let (at, modulus) = (k + i, wave_modulus(adapted.ntens, &a.ddsdde[i]));
        let sane = start.doubt[i] == 0.0 && density[0][i] > 0.0 && density[0][i] < f64::INFINITY;
        let done = sane && outcome.finite && outcome.pnewdt > 0.0 && modulus < f64::INFINITY;
        if outcome.left || !done {
            left = left.or(outcome.left.then_some(p.inputs[PARTICLE_ID][at]));
            fail(adapted, p, at, update);
            continue;
        }
        moduli[i] = modulus.max(instance.floor);
        if !(moduli[i] > 0.0) {
            return Err(no_tangent());
        }
        if update {
            judge(p, at, outcome.pnewdt);
        }
    }
    let speed = components(|i| (moduli[i] / density[0][i]).sqrt());
    store(p.wave_speed, shape, 0, k, &speed);
    if update {
        for c in 0..6 {
            store(p.stress1, shape, c, k, &stress[c]);
            let strain = components(|i| start.strain[c][i] + start.increment[c][i]);
            store(p.state1, shape, adapted.total_strain + c, k, &strain);
        }
        for c in 0..9 {
            let h = components(|i| start.new[c][i] - IDENTITY[c]);
            store(p.state1, shape, adapted.displacement_gradient + c, k, &h);
        }
    }
    Ok(left)
}

impl Arguments {
    const NEW: Self = Self {
        routine: std::ptr::null(),
        hidden_length: HiddenLength::SizeT,
        stress: [0.0; 6],
        ddsdde: [[0.0; 36]; LANES],
        lane: 0,
        energies: [0.0; 3],
        rpl: 0.0,
        ddsddt: [0.0; 6],
        drplde: [0.0; 6],
        drpldt: 0.0,
        stran: [0.0; 6],
        dstran: [0.0; 6],
        time: [0.0; 2],
        dtime: 0.0,
        temp: 0.0,
        dtemp: 0.0,
        predef: [0.0; 8],
        dpred: [0.0; 8],
        cmname: [b' '; 80],
        ndi: 3,
        nshr: 3,
        ntens: 6,
        nstatv: 0,
        nprops: 0,
        coords: [0.0; 3],
        drot: [0.0; 9],
        pnewdt: 0.0,
        celent: 0.0,
        dfgrd0: [0.0; 9],
        dfgrd1: [0.0; 9],
        noel: 1,
        npt: 1,
        layer: 1,
        kspt: 1,
        kstep: [1, 0, 1, 0],
        kinc: 1,
        statev: Vec::new(),
        props: Vec::new(),
        control: 0,
    };

    /// Room for this material.
    fn begin(&mut self, instance: &Instance, functions: &Functions) {
        self.routine = functions.routine;
        self.control = fpenv::control();
        self.hidden_length = instance.adapted.hidden_length;
        self.statev.clear();
        self.statev.resize(instance.adapted.states.len() + BEHIND, UNTOUCHED);
        self.props.clone_from(&instance.props);
        self.props.resize(instance.props.len() + BEYOND, f64::NAN);
    }

    /// Sets every argument for point `k + i`, lane i of `start`.
    #[inline(always)]
    fn set(&mut self, instance: &Instance, p: &Points<'_>, start: &Start, (k, i): (usize, usize)) {
        let (adapted, at) = (instance.adapted, k + i);
        for c in 0..6 {
            let (from, factor) = (ORDER[c], if c < 3 { 1.0 } else { 2.0 });
            self.stress[c] = start.stress[from][i];
            self.stran[c] = factor * start.strain[from][i];
            self.dstran[c] = factor * start.increment[from][i];
        }
        self.drot = transposed(lane(&start.rotation, i));
        self.dfgrd0 = transposed(lane(&start.old, i));
        self.dfgrd1 = transposed(lane(&start.new, i));
        (self.lane, self.ddsdde[i]) = (i, [0.0; 36]);
        (self.ddsddt, self.drplde) = ([0.0; 6], [0.0; 6]);
        (self.rpl, self.drpldt) = (0.0, 0.0);
        self.time = [p.time; 2];
        self.dtime = if p.dt > 0.0 { p.dt } else { SOME_STEP };
        (self.temp, self.dtemp) = (p.inputs[TEMPERATURE][at], 0.0);
        (self.predef, self.dpred) = ([0.0; 8], [0.0; 8]);
        for (to, from) in self.predef.iter_mut().zip(&adapted.predef) {
            *to = p.inputs[*from][at];
        }
        self.cmname = adapted.cmname;
        let ntens = adapted.ntens as i32;
        (self.ndi, self.nshr, self.ntens) = (3, ntens - 3, ntens);
        (self.nstatv, self.nprops) = (adapted.states.len() as i32, instance.props.len() as i32);
        self.props[..instance.props.len()].copy_from_slice(&instance.props);
        for axis in 0..3 {
            self.coords[axis] = p.inputs[POSITION + axis][at];
        }
        (self.pnewdt, self.celent) = (1e36, p.inputs[ELEMENT_LENGTH][at]);
        self.noel = (p.inputs[PARTICLE_ID][at] as i32).saturating_add(1);
        (self.npt, self.layer, self.kspt) = (1, 1, 1);
        self.kstep = [1, 0, 1, 0]; // of NLGEOM
        self.kinc = i32::try_from(p.step.max(0).saturating_add(1)).unwrap_or(i32::MAX);
        for (to, place) in self.statev.iter_mut().zip(&adapted.states) {
            *to = place.factor * p.state0[place.component * p.stride + at];
        }
        self.energies = match adapted.energies {
            None => [0.0; 3],
            Some(first) => components(|e| p.state0[(first + e) * p.stride + at]),
        };
    }

    /// Calls the routine and looks at what it gave.
    #[inline(always)]
    fn call(&mut self, instance: &Instance, functions: &Functions) -> Result<Outcome, String> {
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
        self.look_behind(instance, LOOKED_AT)?;
        let states = &self.statev[..instance.adapted.states.len()];
        // By their bits: arithmetic on the results would wait for the routine.
        const INFINITE: u64 = f64::INFINITY.to_bits();
        let finite = |all, x: &f64| all & (x.to_bits() & INFINITE != INFINITE);
        let finite = self.stress.iter().fold(true, finite) & states.iter().fold(true, finite);
        Ok(Outcome { left: left != 0, finite, pnewdt: self.pnewdt })
    }

    /// An error if the routine wrote into the first `count` values behind its state variables.
    #[inline(always)]
    fn look_behind(&mut self, instance: &Instance, count: usize) -> Result<(), String> {
        let behind = &self.statev[instance.adapted.states.len()..][..count];
        if behind.iter().fold(0, |all, x| all | (x.to_bits() ^ UNTOUCHED.to_bits())) != 0 {
            return Err(self.wrote_behind(instance));
        }
        Ok(())
    }

    #[cold]
    fn wrote_behind(&mut self, instance: &Instance) -> String {
        let nstatv = instance.adapted.states.len();
        self.statev[nstatv..].fill(UNTOUCHED);
        format!(
            "the UMAT wrote behind STATEV({nstatv}), the last of its state variables; give their number as `states` in the \
             sidecar {}",
            instance.adapted.library.path().with_extension("json").display()
        )
    }

    /// Writes the state at the end.
    #[inline(always)]
    fn keep_state(&mut self, adapted: &Adapted, p: &mut Points<'_>, at: usize) {
        for (value, place) in self.statev.iter().zip(&adapted.states) {
            p.state1[place.component * p.stride + at] = value * place.inverse;
        }
        for c in &adapted.unused {
            p.state1[c * p.stride + at] = p.state0[c * p.stride + at];
        }
        if let Some(first) = adapted.energies {
            for e in 0..3 {
                p.state1[(first + e) * p.stride + at] = self.energies[e];
            }
            if let Some(energy) = p.energy.get_mut(at) {
                *energy = self.energies[0];
            }
        }
    }
}

/// Writes status and wanted step of a point that is updated.
#[inline(always)]
fn judge(p: &mut Points<'_>, at: usize, pnewdt: f64) {
    let smaller = pnewdt < 1.0;
    if let Some(factor) = p.dt_factor.get_mut(at) {
        *factor = if smaller { pnewdt } else { 1.0 };
    }
    if let Some(status) = p.status.get_mut(at) {
        *status = if smaller { LAHAR_POINT_SMALLER_STEP } else { LAHAR_POINT_OK };
    }
}

/// A point that failed ends with the state of its start.
#[cold]
fn fail(adapted: &Adapted, p: &mut Points<'_>, at: usize, update: bool) {
    if let Some(status) = p.status.get_mut(at) {
        *status = LAHAR_POINT_FAILED;
    }
    if !update {
        return;
    }
    let own = [adapted.total_strain, adapted.displacement_gradient];
    for c in 0..adapted.components {
        let kept = c < own[0] || c >= own[1] + 9;
        if kept {
            p.state1[c * p.stride + at] = p.state0[c * p.stride + at];
        }
    }
    if let Some(energy) = p.energy.get_mut(at) {
        *energy = 0.0;
    }
    if let Some(factor) = p.dt_factor.get_mut(at) {
        *factor = 1.0;
    }
}

#[cold]
fn no_tangent() -> String {
    "the UMAT left DDSDDE zero, from which the speed of waves comes; give `modulus`, a number [Pa] or the key of a parameter, in the \
     sidecar"
        .into()
}

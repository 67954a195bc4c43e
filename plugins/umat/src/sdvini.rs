//! First states by SDVINI, where the library exports it.

use crate::calls::{Instance, Points};
use crate::describe::{PARTICLE_ID, POSITION};
use crate::kinematics::components;
use crate::umat::{BEHIND, UNTOUCHED};
use std::ffi::c_void;

type Sdvini = unsafe extern "C" fn(
    *mut f64,
    *mut f64,
    *mut i32,
    *mut i32,
    *mut i32,
    *mut i32,
    *mut i32,
    *mut i32,
);

struct FirstState {
    routine: *const c_void,
    statev: Vec<f64>,
    coords: [f64; 3],
    numbers: [i32; 6],
}

/// # Safety
///
/// `data` points to a `FirstState` whose routine is an SDVINI. No destructor may stand in here: XIT of the utility routines jumps over this
/// function.
unsafe extern "C" fn call_sdvini(data: *mut c_void) {
    // SAFETY: guaranteed by the caller.
    let a = unsafe { &mut *data.cast::<FirstState>() };
    let [nstatv, ncrds, noel, npt, layer, kspt] = &mut a.numbers;
    // SAFETY: guaranteed by the caller; STATEV and COORDS are as long as the numbers say.
    unsafe {
        let routine: Sdvini = std::mem::transmute(a.routine);
        routine(
            a.statev.as_mut_ptr(),
            a.coords.as_mut_ptr(),
            nstatv,
            ncrds,
            noel,
            npt,
            layer,
            kspt,
        );
    }
}

/// First states by SDVINI.
pub fn init_state(instance: &Instance, p: &mut Points<'_>) -> Result<(), String> {
    let functions = instance.adapted.library.functions()?;
    let Some(routine) = functions.sdvini else { return Ok(()) };
    let states = &instance.adapted.states;
    let n = states.len();
    for k in 0..p.n {
        let mut data = FirstState {
            routine,
            statev: vec![UNTOUCHED; n + BEHIND],
            coords: components(|axis| p.inputs[POSITION + axis][k]),
            numbers: [n as i32, 3, (p.inputs[PARTICLE_ID][k] as i32).saturating_add(1), 1, 1, 1],
        };
        for (value, place) in data.statev.iter_mut().zip(states) {
            *value = place.factor * p.state1[place.component * p.stride + k];
        }
        let pointer = (&raw mut data).cast();
        // SAFETY: the data are those of an SDVINI; the guard calls `call_sdvini(data)`, or jumps out of it.
        let left = unsafe {
            match functions.guard {
                Some(guard) => guard(call_sdvini, pointer),
                None => {
                    call_sdvini(pointer);
                    0
                }
            }
        };
        let id = p.inputs[PARTICLE_ID][k];
        if left != 0 {
            return Err(format!("SDVINI ended its call with XIT at particle {id}"));
        }
        if data.statev[n..].iter().any(|x| x.to_bits() != UNTOUCHED.to_bits()) {
            return Err(format!(
                "SDVINI wrote behind STATEV({n}); give their number as `states` in the sidecar"
            ));
        }
        for (value, place) in data.statev.iter().zip(states) {
            if !value.is_finite() {
                return Err(format!("SDVINI gave {value} at particle {id}"));
            }
            p.state1[place.component * p.stride + k] = value * place.inverse;
        }
    }
    Ok(())
}

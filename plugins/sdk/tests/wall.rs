//! What the wall between C and a model holds back.

use lahar_plugin::abi::{LAHAR_PLUGIN_ERROR, lahar_stress_batch};
use lahar_plugin::{
    Batch, Columns, Driver, Kinematics, Model, ModelTable, Output, Parameter, State,
};
use std::ffi::{CStr, c_void};
use std::ptr;

/// Panics where its parameter says; otherwise stress1 = stress0 + strain increment, and counts its steps.
struct Panicking {
    place: f64,
}

impl Panicking {
    fn panic_at(&self, place: f64) {
        assert!(self.place != place, "a slip at place {place}");
    }
}

impl Model for Panicking {
    const NAME: &'static CStr = c"panicking";
    const SUMMARY: &'static CStr = c"A model for tests";
    const REFERENCE: &'static CStr = c"";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[Parameter::real(c"place", c"", c"-", c"Where")];
    const STATES: &'static [State] = &[
        State::scalar(c"steps", c"-", c"Number of steps").initial(3.0),
        State::symmetric(c"back_stress", c"Pa", c"Unused"),
    ];
    const OUTPUTS: Output = Output::WAVE_SPEED;

    fn new(values: &[f64]) -> Result<Self, String> {
        assert!(values[0] != 1.0, "a slip in new");
        Ok(Self { place: values[0] })
    }

    fn check(values: &[f64]) -> Result<(), String> {
        if values[0] == 2.0 { Err("two is refused".repeat(100)) } else { Ok(()) }
    }

    fn init_state(&self, _batch: &mut Batch<'_>) -> Result<(), String> {
        self.panic_at(3.0);
        Ok(())
    }

    fn update(&self, batch: &mut Batch<'_>) {
        self.panic_at(4.0);
        let Columns { strain_increment, stress0, stress1, state0, state1, status, .. } =
            batch.columns::<7>();
        assert!(status.is_empty(), "the model does not declare the status");
        for c in 0..6 {
            for k in 0..stress0[c].len() {
                stress1[c][k] = stress0[c][k] + strain_increment[c][k];
            }
        }
        for c in 0..7 {
            state1[c].copy_from_slice(state0[c]);
        }
        for k in 0..batch.n() {
            let [steps, rest @ ..] = batch.state0::<7>(k);
            batch.set_state1(k, [steps + 1.0, rest[0], 0.0, 0.0, 0.0, 0.0, 0.0]);
            let stress = batch.stress0_matrix(k);
            assert_eq!(stress, stress.transpose());
        }
    }

    fn wave_speed(&self, batch: &mut Batch<'_>) {
        self.panic_at(5.0);
        // An array that this call does not have: reading it is a mistake of the model.
        let _ = batch.velocity_gradient(0);
    }
}

fn driver(place: f64) -> Result<Driver, String> {
    Driver::new(ModelTable::of::<Panicking>().desc(), &[("place", place)], 3)
}

#[test]
fn a_panic_becomes_an_error_with_its_text() {
    assert_eq!(driver(1.0).err().unwrap(), "panic: a slip in new");
    assert_eq!(driver(3.0).unwrap().init_state().unwrap_err(), "panic: a slip at place 3");
    assert_eq!(driver(4.0).unwrap().update(1.0).unwrap_err(), "panic: a slip at place 4");
    assert_eq!(driver(5.0).unwrap().wave_speed().unwrap_err(), "panic: a slip at place 5");
    let absent = driver(0.0).unwrap().wave_speed().unwrap_err();
    assert!(absent.contains("out of bounds"), "{absent}");
}

#[test]
fn a_long_refusal_is_cut_to_the_hosts_buffer() {
    let text = driver(2.0).err().unwrap();
    assert!(text.starts_with("two is refused") && text.len() == 511);
}

#[test]
fn points_see_their_own_values() {
    let mut d = driver(0.0).unwrap();
    for k in 0..3 {
        let at = |c: usize| (10 * k + c) as f64;
        d.set_stress(k, std::array::from_fn(at));
        d.set_strain_increment(k, [0.5; 6]);
    }
    d.update(1.0).unwrap();
    for k in 0..3 {
        assert_eq!(d.stress1(k), std::array::from_fn(|c| (10 * k + c) as f64 + 0.5));
        assert_eq!((d.state1(k, 0), d.state1(k, 6)), (4.0, 0.0));
    }
}

#[test]
fn what_a_c_caller_must_not_pass_is_refused() {
    let model = ModelTable::of::<Panicking>().desc();
    let (create, update) = (model.create.unwrap(), model.update.unwrap());
    let mut instance: *mut c_void = ptr::null_mut();
    // SAFETY: NULL and a wrong count are what the function must refuse; the other arguments are valid.
    unsafe {
        assert_eq!(create(model, ptr::null(), 1, &mut instance), LAHAR_PLUGIN_ERROR);
        assert_eq!(create(model, [0.0, 0.0].as_ptr(), 2, &mut instance), LAHAR_PLUGIN_ERROR);
        assert_eq!(create(model, [0.0].as_ptr(), 1, ptr::null_mut()), LAHAR_PLUGIN_ERROR);
        assert!(instance.is_null());
        assert_eq!(create(model, [0.0].as_ptr(), 1, &mut instance), 0);
        assert_eq!(update(instance, ptr::null()), LAHAR_PLUGIN_ERROR);
    }
    let good = lahar_stress_batch {
        struct_size: size_of::<lahar_stress_batch>() as u32,
        flags: 0,
        n: 1,
        stride: 8,
        dt: 1.0,
        time: 0.0,
        step: -1,
        strain_increment: ptr::null(),
        velocity_gradient: ptr::null(),
        deformation_gradient: ptr::null(),
        stress0: ptr::null(),
        state0: ptr::null(),
        stress1: ptr::null_mut(),
        state1: ptr::null_mut(),
        inputs: ptr::null(),
        wave_speed: ptr::null_mut(),
        diffusivity: ptr::null_mut(),
        energy: ptr::null_mut(),
        dt_factor: ptr::null_mut(),
        status: ptr::null_mut(),
    };
    let bad = [
        good, // without arrays
        lahar_stress_batch { struct_size: 8, ..good },
        lahar_stress_batch { n: -1, ..good },
        lahar_stress_batch { n: 9, ..good },
        lahar_stress_batch { stride: i64::MAX, ..good },
    ];
    for batch in &bad {
        // SAFETY: every array is NULL, which the function must see before it touches one.
        assert_eq!(unsafe { update(instance, batch) }, LAHAR_PLUGIN_ERROR);
    }
    // SAFETY: an empty batch needs no arrays; the instance is destroyed once.
    unsafe {
        assert_eq!(update(instance, &lahar_stress_batch { n: 0, ..good }), 0);
        assert_eq!(update(ptr::null(), &lahar_stress_batch { n: 0, ..good }), LAHAR_PLUGIN_ERROR);
        model.destroy.unwrap()(instance);
        model.destroy.unwrap()(ptr::null_mut());
    }
}

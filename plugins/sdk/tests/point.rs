//! Laws of one point: every point gets its own values, at every level of instructions and for every number of points.
#![forbid(unsafe_code)]

use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK};
use lahar_plugin::simd::{self, Level};
use lahar_plugin::{
    Batch, Driver, Input, Kinematics, Model, ModelTable, Output, Point, PointLaw, PointStatus,
    State, Updated, math,
};
use std::ffi::CStr;

/// Uses all that a point has, in formulas without meaning.
struct Everything;

impl Model for Everything {
    const NAME: &'static CStr = c"everything";
    const SUMMARY: &'static CStr = c"A model for tests";
    const REFERENCE: &'static CStr = c"";
    const KINEMATICS: Kinematics = Kinematics::DeformationGradient;
    const PARAMETERS: &'static [lahar_plugin::Parameter] = &[];
    const STATES: &'static [State] =
        &[State::symmetric(c"a", c"-", c""), State::scalar(c"b", c"-", c"")];
    const INPUTS: &'static [Input] = &[Input::ElementLength, Input::Density];
    const OUTPUTS: Output =
        Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::ENERGY).and(Output::STATUS);

    fn new(_values: &[f64]) -> Result<Self, String> {
        Ok(Self)
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    fn wave_speed(&self, _batch: &mut Batch<'_>) {}
}

impl PointLaw<7> for Everything {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<7>) -> Updated<7> {
        let [length, density, ..] = point.inputs;
        let gradient = point.gradient.iter().sum::<f64>();
        let closes = gradient < 0.0;
        Updated {
            stress1: point.stress0.map(|s| s + if closes { math::exp(gradient) } else { gradient }),
            state1: point.state0.map(|s| 2.0 * s + length),
            wave_speed: density.sqrt(),
            diffusivity: math::ln(density) / 3.0,
            energy: density - length,
            status: if closes { PointStatus::Failed } else { PointStatus::Ok },
        }
    }
}

#[test]
fn a_law_sees_and_sets_the_values_of_its_point_bit_for_bit_at_every_level() {
    for n in [0, 1, 7, 15, 16, 17, 31, 32, 100, 256] {
        for level in Level::ALL.into_iter().filter(|level| simd::force(*level)) {
            let mut d = Driver::new(ModelTable::of::<Everything>().desc(), &[], n).unwrap();
            let value = |k: usize, c: usize| ((17 * k + 5 * c + 1) as f64).sin();
            for k in 0..n {
                d.set_gradient(k, std::array::from_fn(|c| value(k, c)));
                d.set_stress(k, std::array::from_fn(|c| value(k, 10 + c)));
                (0..7).for_each(|c| d.set_state(k, c, value(k, 20 + c)));
                d.set_input(0, k, value(k, 30));
                d.set_input(1, k, 2.0 + value(k, 31));
            }
            d.update(1.0).unwrap();
            for k in 0..n {
                let gradient = (0..9).map(|c| value(k, c)).sum::<f64>();
                let added = if gradient < 0.0 { math::exp(gradient) } else { gradient };
                let status = if gradient < 0.0 { LAHAR_POINT_FAILED } else { LAHAR_POINT_OK };
                assert_eq!(d.stress1(k), std::array::from_fn(|c| value(k, 10 + c) + added));
                for c in 0..7 {
                    assert_eq!(d.state1(k, c), 2.0 * value(k, 20 + c) + value(k, 30));
                }
                let density = 2.0 + value(k, 31);
                assert_eq!(d.wave_speed_of(k), density.sqrt());
                assert_eq!(d.diffusivity_of(k), math::ln(density) / 3.0);
                assert_eq!(d.energy_of(k), density - value(k, 30));
                assert_eq!(d.status_of(k), status, "point {k} of {n}, {level:?}");
            }
        }
    }
}

#[test]
fn a_checked_point_fails_if_a_value_is_not_finite_or_the_law_says_so() {
    let status = |stress: f64, state: f64, speed: f64, sane: bool| {
        Updated::checked([0.0, 0.0, 0.0, 0.0, 0.0, stress], [1.0, state], speed, sane).status
    };
    assert_eq!(status(-1.0, 2.0, 3.0, true), PointStatus::Ok);
    assert_eq!(status(-1.0, 2.0, 3.0, false), PointStatus::Failed);
    for bad in [f64::NAN, f64::INFINITY] {
        for values in [[bad, 2.0, 3.0], [-1.0, bad, 3.0], [-1.0, 2.0, bad]] {
            let [stress, state, speed] = values;
            assert_eq!(status(stress, state, speed, true), PointStatus::Failed);
        }
    }
}

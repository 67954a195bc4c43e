//! Free vibration of an elastic bar, fixed at one end (verification case D2): L = 25 m, E = 100 Pa, ρ = 1 kg/m³, ν = 0,
//! v = 0.1 sin(π x / 50): period 10 s.

use lahar::boundary::{Wall, WallKind};
use lahar::shape::ShapeKind;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::options::Options;

use crate::setup::{a_box, context, elastic, fill, read, world, write};

/// A way to run the bar.
#[derive(Clone, Copy)]
struct Bar {
    cells: usize,
    shape: ShapeKind,
    transfer: TransferKind,
    order: StepOrder,
    pic_rate: f64,
}

/// Relative error of the period; drift of the mean energy from the first to the last of ten periods.
struct Vibration {
    period: f64,
    drift: f64,
}

const FLIP: Bar = Bar {
    cells: 25,
    shape: ShapeKind::Linear,
    transfer: TransferKind::PicFlip,
    order: StepOrder::Musl,
    pic_rate: 0.0,
};

fn vibrate(bar: Bar) -> Vibration {
    let context = context(1);
    let material = elastic(&context, 100.0, 0.0);
    let h = 25.0 / bar.cells as f64;
    let Bar { shape, transfer, order, pic_rate, .. } = bar;
    let options = Options {
        dimension: 2,
        spacing: h,
        shape,
        transfer,
        order,
        pic_rate,
        cfl: 0.1,
        ..Options::default()
    };
    // the walls stand on node planes for linear and on half-cell planes for quadratic shapes
    let shift = if shape == ShapeKind::Linear { 0.0 } else { 0.5 * h };
    let options = Options { origin: [shift, shift, 0.0], ..options };
    let mut world = world(&context, &options);
    for (axis, side, position) in [(0, 1, 0.0), (1, 1, 0.0), (1, -1, h)] {
        let wall = Wall { axis, side, position, kind: WallKind::Slip, friction: 0.0 };
        world.add_wall(&wall).expect("a good wall");
    }
    let body = fill(&mut world, &material, &a_box([0.0; 3], [25.0, h, 0.0]), 1.0, [0.0; 3]);
    let beta = std::f64::consts::PI / 50.0;
    let x = read(&world, body, "position");
    let v: Vec<f64> = x.chunks(2).flat_map(|x| [0.1 * (beta * x[0]).sin(), 0.0]).collect();
    write(&mut world, body, "velocity", &v);
    let dt = 0.1 * h / 10.2;
    let mut crossings = Vec::new();
    let mut energy = [(0.0, 0.0); 10];
    let mut before = world.totals(None).expect("totals").momentum[0];
    while world.time() < 100.0 {
        world.step(Some(dt)).expect("a vibration");
        let totals = world.totals(None).expect("totals");
        let (now, t) = (totals.momentum[0], world.time());
        if before * now < 0.0 {
            crossings.push(t - dt * now.abs() / (now - before).abs());
        }
        before = now;
        if let Some((sum, count)) = energy.get_mut((t / 10.0) as usize) {
            *sum += totals.kinetic_energy + totals.strain_energy;
            *count += 1.0;
        }
    }
    let mean = |n: usize| energy[n].0 / energy[n].1;
    Vibration { period: 2.0 * slope(&crossings) / 10.0 - 1.0, drift: mean(9) / mean(0) - 1.0 }
}

/// Slope of a line through (n, y_n).
fn slope(y: &[f64]) -> f64 {
    let n = y.len() as f64;
    let (mean_x, mean_y) = ((n - 1.0) / 2.0, y.iter().sum::<f64>() / n);
    let dx = |k: usize| k as f64 - mean_x;
    let covariance: f64 = y.iter().enumerate().map(|(k, y)| dx(k) * (y - mean_y)).sum();
    covariance / (0..y.len()).map(|k| dx(k).powi(2)).sum::<f64>()
}

#[test]
fn a_linear_flip_bar_vibrates_with_the_right_period_and_keeps_its_energy() {
    for (order, drift) in [(StepOrder::Musl, 1e-4), (StepOrder::Usl, 1e-3)] {
        let v = vibrate(Bar { order, ..FLIP });
        println!("linear FLIP {order:?}: period {:+e}, drift {:+e}", v.period, v.drift);
        assert!(v.period.abs() <= 1e-3, "{order:?}: period {:+e}", v.period);
        assert!(v.drift.abs() <= drift, "{order:?}: drift {:+e}", v.drift);
    }
}

#[test]
fn a_quadratic_bar_with_walls_on_half_cell_planes_has_the_period_within_1_5_percent() {
    let shape = ShapeKind::QuadraticBspline;
    let errors = [13, 25, 50].map(|cells| vibrate(Bar { cells, shape, ..FLIP }).period);
    println!("quadratic FLIP, 13, 25, 50 cells: period {errors:?}");
    assert!(errors[1].abs() <= 0.015, "period {:+e} at 25 cells", errors[1]);
    assert!(errors[2].abs() < errors[1].abs() && errors[1].abs() < errors[0].abs(), "{errors:?}");
}

#[test]
fn pic_loses_the_energy_of_the_bar_and_apic_some() {
    let pic = vibrate(Bar { pic_rate: f64::INFINITY, ..FLIP });
    assert!(pic.drift < -0.95, "PIC must lose more than 95 %: {:+e}", pic.drift);
    let apic =
        vibrate(Bar { transfer: TransferKind::Apic, shape: ShapeKind::QuadraticBspline, ..FLIP });
    println!("drift of PIC {:+e}, of quadratic APIC {:+e}", pic.drift, apic.drift);
    assert!((-0.3..-0.01).contains(&apic.drift), "APIC loses some: {:+e}", apic.drift);
}

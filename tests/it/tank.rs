//! Fluid at rest in a tank (verification case F1): ρ = 1800 kg/m³, K = 1 MPa, no viscosity, depth H = 0.1 m; p = ρ g z.

use std::sync::Arc;

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::material::Material;
use lahar::shape::ShapeKind;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;

use crate::setup::{a_box, context, fill, read, world, write};

const DEPTH: f64 = 0.1;
const WIDTH: f64 = 0.2;
const DENSITY: f64 = 1800.0;
const BULK: f64 = 1e6;
const GRAVITY: f64 = 9.81;

fn water(context: &Context) -> Arc<Material> {
    let values = [("bulk_modulus", BULK), ("viscosity", 0.0), ("equation_of_state", 1.0)];
    Material::new(context, "newtonian", &values).expect("a material")
}

/// A full tank with slip walls, which stand on half-cell planes of the grid or on node planes.
fn tank(cells: usize, shape: ShapeKind, gravity: f64, half_cell: bool) -> (World, i64) {
    let context = context(1);
    let h = DEPTH / cells as f64;
    let shift = if half_cell { 0.5 * h } else { 0.0 };
    let options = Options {
        dimension: 2,
        spacing: h,
        origin: [shift, shift, 0.0],
        shape,
        transfer: TransferKind::PicFlip,
        gravity: [0.0, -gravity, 0.0],
        ..Options::default()
    };
    let mut world = world(&context, &options);
    for (axis, side, position) in [(0, 1, 0.0), (0, -1, WIDTH), (1, 1, 0.0)] {
        let wall = Wall { axis, side, position, kind: WallKind::Slip, friction: 0.0 };
        world.add_wall(&wall).expect("a good wall");
    }
    let region = a_box([0.0; 3], [WIDTH, DEPTH, 0.0]);
    let body = fill(&mut world, &water(&context), &region, DENSITY, [0.0; 3]);
    (world, body)
}

/// First period of the tank's depth.
fn period() -> f64 {
    4.0 * DEPTH / (BULK / DENSITY).sqrt()
}

/// Largest error of the mean pressure of the rows of cells, over ρ g H, and the largest difference of horizontal and vertical stress.
fn cell_mean_error(world: &World, body: i64, cells: usize) -> (f64, f64) {
    let (x, s) = (read(world, body, "position"), read(world, body, "stress"));
    let h = DEPTH / cells as f64;
    let mut sums = vec![(0.0, 0.0, 0.0); cells];
    let mut anisotropy = 0.0;
    for (x, s) in x.chunks(2).zip(s.chunks(6)) {
        let row = &mut sums[((x[1] / h) as usize).min(cells - 1)];
        *row = (row.0 - s[1], row.1 + (DEPTH - x[1]), row.2 + 1.0);
        anisotropy = f64::max(anisotropy, (s[0] - s[1]).abs());
    }
    let scale = DENSITY * GRAVITY * DEPTH;
    let error = |(p, z, n): &(f64, f64, f64)| ((p - DENSITY * GRAVITY * z) / n).abs() / scale;
    (sums.iter().map(error).fold(0.0, f64::max), anisotropy / scale)
}

/// Linear shapes: gravity grows over 5 periods, local damping until 12.
fn ramped(cells: usize, damping: f64) -> (f64, f64) {
    let (mut world, body) = tank(cells, ShapeKind::Linear, 0.0, false);
    world.set_damping(damping).expect("good damping");
    let t1 = period();
    while world.time() < 12.0 * t1 {
        let ramp = (world.time() / (5.0 * t1)).min(1.0);
        world.set_gravity([0.0, -ramp * GRAVITY, 0.0]).expect("good gravity");
        world.advance(12.0 * t1, 1).1.expect("a calm tank");
    }
    cell_mean_error(&world, body, cells)
}

#[test]
fn a_linear_tank_filled_by_a_ramp_has_the_hydrostatic_pressure() {
    for cells in [10, 20] {
        let (error, anisotropy) = ramped(cells, 0.2);
        println!(
            "linear, H = {cells} h: cell mean off by {error:e}, horizontal - vertical {anisotropy:e}"
        );
        assert!(error <= 3e-3, "{cells} cells: {error:e}");
        assert!(anisotropy <= 1e-12, "{anisotropy:e}");
    }
}

#[test]
fn a_tank_without_damping_fails_the_gate_of_a_ramp() {
    let (error, _) = ramped_at_once(20);
    assert!(error > 3e-3, "an undamped step load must not pass: {error:e}");
}

/// Full gravity from the start, no damping: the stress swings about twice the static value.
fn ramped_at_once(cells: usize) -> (f64, f64) {
    let (mut world, body) = tank(cells, ShapeKind::Linear, GRAVITY, false);
    world.advance(6.5 * period(), i64::MAX).1.expect("a swinging tank");
    cell_mean_error(&world, body, cells)
}

/// What a tank does that starts in hydrostatic stress.
struct Rest {
    /// Largest error of the pressure two cells and more from walls and surface, over ρ g H.
    error: f64,
    /// Kinetic energy over ρ g H times the volume.
    kinetic: f64,
    /// Largest difference of horizontal and vertical stress, over ρ g H.
    anisotropy: f64,
}

/// Quadratic shapes; with `half_cell` the walls stand on half-cell planes, else on node planes.
fn rest(cells: usize, periods: f64, half_cell: bool) -> Rest {
    let (mut world, body) = tank(cells, ShapeKind::QuadraticBspline, GRAVITY, half_cell);
    let x = read(&world, body, "position");
    let pressure = |y: f64| DENSITY * GRAVITY * (DEPTH - y);
    let isotropic = |p: f64| [-p, -p, -p, 0.0, 0.0, 0.0];
    let stress: Vec<f64> = x.chunks(2).flat_map(|x| isotropic(pressure(x[1]))).collect();
    // the pressure of the fluid is a function of its volume ratio: V = V0 / (1 + p / K)
    let v0 = read(&world, body, "volume");
    let ratio = |k: usize| 1.0 / (1.0 + pressure(x[2 * k + 1]) / BULK);
    let volume: Vec<f64> = v0.iter().enumerate().map(|(k, v)| v * ratio(k)).collect();
    let ratios: Vec<f64> = (0..v0.len()).map(ratio).collect();
    write(&mut world, body, "stress", &stress);
    write(&mut world, body, "volume", &volume);
    write(&mut world, body, "volume_ratio", &ratios);
    world.advance(periods * period(), i64::MAX).1.expect("a calm tank");
    let far = 2.0 * DEPTH / cells as f64;
    let (x, s) = (read(&world, body, "position"), read(&world, body, "stress"));
    let (mut error, mut anisotropy) = (0.0, 0.0);
    for (x, s) in x.chunks(2).zip(s.chunks(6)) {
        if x[1] > far && x[1] < DEPTH - far && x[0] > far && x[0] < WIDTH - far {
            error = f64::max(error, (-s[1] - pressure(x[1])).abs());
        }
        anisotropy = f64::max(anisotropy, (s[0] - s[1]).abs());
    }
    let scale = DENSITY * GRAVITY * DEPTH;
    let kinetic = world.totals(None).expect("totals").kinetic_energy / (scale * DEPTH * WIDTH);
    Rest { error: error / scale, kinetic, anisotropy: anisotropy / scale }
}

#[test]
fn a_quadratic_tank_in_hydrostatic_stress_stays_at_rest() {
    for (cells, periods) in [(10, 200.0), (20, 200.0), (40, 20.0)] {
        let Rest { error, kinetic, anisotropy } = rest(cells, periods, true);
        println!(
            "quadratic, H = {cells} h, {periods} periods: off by {error:e}, kinetic energy {kinetic:e}, \
             horizontal - vertical {anisotropy:e}"
        );
        assert!(error <= 5e-3, "{cells} cells: {error:e}");
        assert!(anisotropy <= 1e-12, "{anisotropy:e}");
        assert!(kinetic <= 1e-8, "{kinetic:e}");
    }
}

#[test]
fn a_quadratic_tank_with_walls_on_node_planes_drains_into_them() {
    let Rest { error, kinetic, .. } = rest(10, 20.0, false);
    println!("walls on node planes: off by {error:e}, kinetic energy {kinetic:e}");
    assert!(error > 5e-3, "the fluid must leak into the walls: {error:e}");
}

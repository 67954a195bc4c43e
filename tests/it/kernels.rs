//! Every kernel equals the textbook: instruction set × dimension × shape × transfer × order, random
//! particles, walls, damping and gravity.

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::scratch::with_scratch;
use lahar::material::{Input, Material, StressBatch};
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::simd::Isa;
use lahar::step::StepOrder;
use lahar::step::naive;
use lahar::step::naive::nodes::{Matrix, Particle};
use lahar::tensor::{Mat3, rotate, step_rotation, symmetric, symmetric_part};
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided};
use lahar::world::options::Options;
use nalgebra::{SMatrix, SVector};
use std::sync::Arc;

use crate::setup::{Random, context_with, elastic, read, world, write};
use crate::support::in_child;

const H: f64 = 0.3;

/// The world's particles as the textbook has them.
fn copy_of<const D: usize>(world: &World, body: i64) -> (Vec<Particle<D>>, Vec<[f64; 6]>) {
    let (x, v) = (read(world, body, "position"), read(world, body, "velocity"));
    let (m, vol) = (read(world, body, "mass"), read(world, body, "volume"));
    let stress = read(world, body, "stress");
    let field = |name| world.field_info(body, name).map(|_| read(world, body, name));
    let (affine, size, force) = (field("affine"), field("size"), field("body_force"));
    let full = |k: usize| -> [f64; 6] { std::array::from_fn(|c| stress[6 * k + c]) };
    let particle = |k: usize| Particle {
        x: SVector::from_fn(|d, _| x[D * k + d]),
        v: SVector::from_fn(|d, _| v[D * k + d]),
        c: SMatrix::from_fn(|a, b| affine.as_ref().map_or(0.0, |c| c[D * D * k + D * a + b])),
        mass: m[k],
        volume: vol[k],
        stress: SMatrix::from_fn(|a, b| symmetric(full(k))[(a, b)]),
        hoop_stress: full(k)[2],
        size: SVector::from_fn(|d, _| size.as_ref().map_or(0.0, |s| s[D * k + d])),
        body_force: SVector::from_fn(|d, _| force.as_ref().map_or(0.0, |f| f[D * k + d])),
        f: Mat3::identity(),
    };
    ((0..m.len()).map(particle).collect(), (0..m.len()).map(full).collect())
}

/// Stress of one point after a step with the velocity gradient `l`: rotation, then the material.
fn updated_stress(
    material: &Material,
    stress: [f64; 6],
    l: &Mat3,
    dt: f64,
    density: f64,
) -> [f64; 6] {
    with_scratch(material, 1, |s| {
        let (rotated, strain) = (rotate(&step_rotation(l, dt), stress), symmetric_part(&(l * dt)));
        for c in 0..6 {
            s.stress0[c * s.stride] = rotated[c];
            s.strain_increment[c * s.stride] = strain[c];
        }
        s.input(Input::Density).expect("the model wants it")[0] = density;
        material.update(&mut StressBatch { dt, ..s.batch() }).expect("the model works");
        Ok(std::array::from_fn(|c| s.stress1[c * s.stride]))
    })
    .expect("scratch")
}

/// Largest difference of two lists over the largest value of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().fold(0.0, |m, v| f64::max(m, v.abs()));
    a.iter().zip(b).fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs())) / largest
}

/// Friction and slip below, separating and sticky above, off the node planes; where they modify the
/// shape functions and the order is USL, on them.
fn walls(options: &Options) -> Vec<Wall> {
    let kinds = [WallKind::Friction, WallKind::Slip, WallKind::Separating, WallKind::Sticky];
    let (modified, d) = (options.wall_treatment == WallTreatment::Modified, options.dimension);
    let on_nodes = modified && options.order == StepOrder::Usl;
    let wall = |n: usize| {
        let (axis, side) = (n % d, if n < 2 { 1 } else { -1 });
        let node = if side > 0 { -3.0 } else { 4.0 };
        let position = match (modified, on_nodes) {
            (true, true) => options.origin[axis] + node * H,
            (true, false) => [-0.79, 1.21][usize::from(side < 0)],
            _ => [-0.71, 1.13][usize::from(side < 0)],
        };
        Wall { axis, side, position, kind: kinds[n], friction: 0.3 }
    };
    (0..4).map(wall).filter(|w| !options.axisymmetric || w.axis == 1).collect()
}

/// The world of a test, its body, the particles of the textbook, and their whole stresses.
type Start<const D: usize> = (World, i64, Vec<Particle<D>>, Vec<[f64; 6]>);

fn start<const D: usize>(
    options: &Options,
    context: &Arc<Context>,
    material: &Arc<Material>,
    n: usize,
) -> Start<D> {
    let mut random = Random::new(7);
    let mut world = world(context, options);
    let mut x = random.many(n * D, -0.75, 1.05);
    if options.axisymmetric {
        x.chunks_mut(D).for_each(|x| x[0] += 0.8);
    }
    let v = random.many(n * D, -1.0, 1.0);
    let size = random.many(n * D, 0.05, 0.25);
    let volumes = vec![0.004; n];
    let arrays = ParticleArrays {
        position: Strided::interleaved(&x, D).expect("whole points"),
        volume: Strided::interleaved(&volumes, 1).expect("whole points"),
        mass: None,
        density: 1000.0,
        velocity: Some(Strided::interleaved(&v, D).expect("whole points")),
        stress: None,
        size: Some(Strided::interleaved(&size, D).expect("whole points")),
    };
    let body = world.add_particles(material, &arrays).expect("good particles");
    write(&mut world, body, "stress", &random.many(n * 6, -800.0, 900.0));
    if options.transfer.is_affine() {
        write(&mut world, body, "affine", &random.many(n * D * D, -2.0, 2.0));
    }
    if options.body_force {
        write(&mut world, body, "body_force", &random.many(n * D, -5.0, 5.0));
    }
    for wall in &walls(options) {
        world.add_wall(wall).expect("a good wall");
    }
    let (textbook, stresses) = copy_of::<D>(&world, body);
    (world, body, textbook, stresses)
}

fn one_step_agrees<const D: usize>(options: &Options, isa: Isa, threads: usize, particles: usize) {
    let context = context_with(threads, isa);
    let material = elastic(&context, 1e4, 0.3);
    let (mut world, body, mut textbook, mut stresses) =
        start::<D>(options, &context, &material, particles);
    let dt = 0.5 * world.stable_dt().expect("a stable step");
    world.step(Some(dt)).expect("a good step");
    let mut k = 0;
    let mut update = |p: &mut Particle<D>, l: &Matrix<D>, hoop: f64, dt: f64| {
        let of = |a: usize, b: usize| match (a < D && b < D, (a, b)) {
            (true, _) => l[(a, b)],
            (_, (2, 2)) => hoop,
            _ => 0.0,
        };
        let n = k % particles;
        stresses[n] =
            updated_stress(&material, stresses[n], &Mat3::from_fn(of), dt, p.mass / p.volume);
        p.stress = SMatrix::from_fn(|a, b| symmetric(stresses[n])[(a, b)]);
        p.hoop_stress = stresses[n][2];
        k += 1;
    };
    naive::step((options, &walls(options)), &mut textbook, dt, &mut update);
    let flat =
        |f: &dyn Fn(&Particle<D>) -> Vec<f64>| textbook.iter().flat_map(f).collect::<Vec<_>>();
    let c_of = |p: &Particle<D>| p.c.transpose().iter().copied().collect();
    let mut pairs = vec![
        ("position", flat(&|p| p.x.iter().copied().collect())),
        ("velocity", flat(&|p| p.v.iter().copied().collect())),
        ("volume", flat(&|p| vec![p.volume])),
        ("stress", stresses.concat()),
    ];
    if options.transfer.is_affine() {
        pairs.push(("affine", flat(&c_of)));
    }
    if options.shape == ShapeKind::ContiguousGimp {
        pairs.push(("size", flat(&|p| p.size.iter().copied().collect())));
    }
    for (field, expected) in pairs {
        let d = difference(&read(&world, body, field), &expected);
        assert!(
            d <= 1e-12,
            "{field} differs by {d:e} of its largest value for {isa:?}, {options:?}"
        );
    }
}

/// Calls `run` for every dimension (axial symmetry included) × shape × treatment of walls ×
/// transfer × order that goes together.
fn table_of(orders: &[StepOrder], run: &dyn Fn(&Options)) {
    use {ShapeKind as S, TransferKind as T, WallTreatment as W};
    for (dimension, axisymmetric) in [(2, false), (3, false), (2, true)] {
        let mut runs = 0;
        for (shape, wall_treatment) in S::ALL.into_iter().flat_map(|s| W::ALL.map(|w| (s, w))) {
            for (transfer, order) in
                T::ALL.into_iter().flat_map(|t| orders.iter().map(move |o| (t, *o)))
            {
                let options = Options {
                    dimension,
                    axisymmetric,
                    spacing: H,
                    origin: [0.11, -0.07, 0.2],
                    shape,
                    wall_treatment,
                    transfer,
                    filter_order: 3,
                    pic_rate: 40.0,
                    order,
                    gravity: [if axisymmetric { 0.0 } else { 0.3 }, -9.81, 1.2],
                    damping: 0.1,
                    body_force: shape == S::QuadraticBspline,
                    ..Options::default()
                };
                if options.check().is_ok() {
                    run(&options);
                    runs += 1;
                }
            }
        }
        assert!(runs > 30, "only {runs} combinations were run for axisymmetric = {axisymmetric}");
    }
}

#[test]
fn every_kernel_equals_the_textbook_after_one_step() {
    Isa::all().for_each(|isa| {
        table_of(&StepOrder::ALL, &|options| match options.dimension {
            2 => one_step_agrees::<2>(options, isa, 1, 300),
            _ => one_step_agrees::<3>(options, isa, 1, 300),
        });
    });
}

#[test]
fn every_kernel_equals_the_textbook_on_two_threads() {
    use {ShapeKind as S, TransferKind as T};
    Isa::all().for_each(|isa| {
        table_of(&[StepOrder::Usl, StepOrder::Musl], &|options| {
            let shapes = [S::Linear, S::QuadraticBspline, S::CubicBspline];
            let transfers = [T::PicFlip, T::Apic, T::Xpic];
            if !shapes.contains(&options.shape)
                || !transfers.contains(&options.transfer)
                || options.axisymmetric
                || options.wall_treatment == WallTreatment::Modified
            {
                return;
            }
            match options.dimension {
                2 => one_step_agrees::<2>(options, isa, 2, 5000),
                _ => one_step_agrees::<3>(options, isa, 2, 5000),
            }
        });
    });
}

#[test]
fn the_environment_forces_an_instruction_set() {
    let name = "kernels::the_environment_forces_an_instruction_set";
    if in_child(name, &[("LAHAR_SIMD", "scalar")]) {
        assert_eq!(Context::new(None).expect("a context").isa().name(), "scalar");
    }
}

#[test]
fn an_unknown_instruction_set_is_refused() {
    let name = "kernels::an_unknown_instruction_set_is_refused";
    if in_child(name, &[("LAHAR_SIMD", "avx1024")]) {
        let error = Context::new(None).err().expect("no such instruction set");
        assert_eq!(error.status, Status::InvalidArgument);
        assert!(error.message.contains("avx1024") && error.message.contains("scalar"), "{error}");
    }
}

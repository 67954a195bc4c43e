//! Every kernel equals the textbook: instruction set × dimension × shape × transfer × order, random particles, walls, damping and gravity.

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::{Material, StressBatch};
use lahar::shape::ShapeKind;
use lahar::simd::Isa;
use lahar::step::StepOrder;
use lahar::step::naive::{self, Particle};
use lahar::tensor::{Mat3, rotate, step_rotation, symmetric, symmetric_part};
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;
use lahar::world::scratch::with_scratch;
use nalgebra::{SMatrix, SVector};

use crate::setup::{Random, add_points, context_with, elastic, read, world, write};
use crate::support::in_child;

const H: f64 = 0.3;

/// The world's particles as the textbook has them.
fn copy_of<const D: usize>(world: &World, body: i64) -> (Vec<Particle<D>>, Vec<[f64; 6]>) {
    let (x, v) = (read(world, body, "position"), read(world, body, "velocity"));
    let (m, vol) = (read(world, body, "mass"), read(world, body, "volume"));
    let stress = read(world, body, "stress");
    let affine = world.field_info(body, "affine").map(|_| read(world, body, "affine"));
    let full = |k: usize| -> [f64; 6] { std::array::from_fn(|c| stress[6 * k + c]) };
    let particle = |k: usize| Particle {
        x: SVector::from_fn(|d, _| x[D * k + d]),
        v: SVector::from_fn(|d, _| v[D * k + d]),
        c: SMatrix::from_fn(|a, b| affine.as_ref().map_or(0.0, |c| c[D * D * k + D * a + b])),
        mass: m[k],
        volume: vol[k],
        stress: SMatrix::from_fn(|a, b| symmetric(full(k))[(a, b)]),
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
        s.set_inputs(0, density, H);
        material.update(&mut StressBatch { dt, ..s.batch() }).expect("the model works");
        std::array::from_fn(|c| s.stress1[c * s.stride])
    })
}

/// Largest difference of two lists over the largest value of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().fold(0.0, |m, v| f64::max(m, v.abs()));
    a.iter().zip(b).fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs())) / largest
}

fn walls(dimension: usize) -> Vec<Wall> {
    let kinds = [WallKind::Friction, WallKind::Slip, WallKind::Separating, WallKind::Sticky];
    let wall = |n: usize| Wall {
        axis: n % dimension,
        side: if n < 2 { 1 } else { -1 },
        position: if n < 2 { -0.71 } else { 1.13 },
        kind: kinds[n],
        friction: 0.3,
    };
    (0..4).map(wall).collect()
}

fn one_step_agrees<const D: usize>(options: &Options, isa: Isa, threads: usize, particles: usize) {
    let context = context_with(threads, isa);
    let material = elastic(&context, 1e4, 0.3);
    let mut random = Random::new(7);
    let mut world = world(&context, options);
    let x = random.many(particles * D, -1.0, 1.3);
    let v = random.many(particles * D, -1.0, 1.0);
    let body = add_points(&mut world, &material, (&x, &v), 0.004, 1000.0);
    write(&mut world, body, "stress", &random.many(particles * 6, -800.0, 900.0));
    if options.transfer == TransferKind::Apic {
        write(&mut world, body, "affine", &random.many(particles * D * D, -2.0, 2.0));
    }
    let walls = walls(D);
    for wall in &walls {
        world.add_wall(wall).expect("a good wall");
    }
    let (mut textbook, mut stresses) = copy_of::<D>(&world, body);
    let dt = 0.5 * world.stable_dt().expect("a stable step");
    world.step(Some(dt)).expect("a good step");
    let mut k = 0;
    naive::step((options, &walls), &mut textbook, dt, |p, l| {
        let l = Mat3::from_fn(|a, b| if a < D && b < D { l[(a, b)] } else { 0.0 });
        stresses[k] = updated_stress(&material, stresses[k], &l, dt, p.mass / p.volume);
        k += 1;
    });
    let flat =
        |f: &dyn Fn(&Particle<D>) -> Vec<f64>| textbook.iter().flat_map(f).collect::<Vec<_>>();
    let c_of = |p: &Particle<D>| p.c.transpose().iter().copied().collect();
    let mut pairs = vec![
        ("position", flat(&|p| p.x.iter().copied().collect())),
        ("velocity", flat(&|p| p.v.iter().copied().collect())),
        ("volume", flat(&|p| vec![p.volume])),
        ("stress", stresses.concat()),
    ];
    if options.transfer == TransferKind::Apic {
        pairs.push(("affine", flat(&c_of)));
    }
    for (field, expected) in pairs {
        let d = difference(&read(&world, body, field), &expected);
        assert!(
            d <= 1e-12,
            "{field} differs by {d:e} of its largest value for {isa:?}, {options:?}"
        );
    }
}

/// Calls `run` for every instruction set × dimension × shape × transfer × order.
fn table(run: impl Fn(Isa, &Options)) {
    Isa::all().for_each(|isa| table_of(&|options| run(isa, options)));
}

fn table_of(run: &dyn Fn(&Options)) {
    for dimension in [2, 3] {
        for shape in [ShapeKind::Linear, ShapeKind::QuadraticBspline] {
            for transfer in [TransferKind::PicFlip, TransferKind::Apic] {
                for order in [StepOrder::Usl, StepOrder::Musl] {
                    let options = Options {
                        dimension,
                        spacing: H,
                        origin: [0.11, -0.07, 0.2],
                        shape,
                        transfer,
                        pic_rate: 40.0,
                        order,
                        gravity: [0.3, -9.81, 1.2],
                        damping: 0.1,
                        ..Options::default()
                    };
                    run(&options);
                }
            }
        }
    }
}

#[test]
fn every_kernel_equals_the_textbook_after_one_step() {
    table(|isa, options| match options.dimension {
        2 => one_step_agrees::<2>(options, isa, 1, 300),
        _ => one_step_agrees::<3>(options, isa, 1, 300),
    });
}

#[test]
fn every_kernel_equals_the_textbook_on_two_threads() {
    table(|isa, options| match options.dimension {
        2 => one_step_agrees::<2>(options, isa, 2, 6000),
        _ => one_step_agrees::<3>(options, isa, 2, 6000),
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

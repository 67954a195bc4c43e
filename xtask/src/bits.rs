//! `cargo xtask bits`: whether a step still gives the same bits, against committed sums.
//!
//! For every instruction set × dimension × shape × treatment of walls × transfer × order that goes
//! together, two small bodies between walls go 100 steps under every kind of condition; one sum
//! covers all fields, ids, reactions, totals and the nodes of the grid. A change that is meant to
//! leave results alone is held to that; one that changes them says so and runs `--write`.
//!
//! The sums depend on the processor only through its instruction sets: those that it lacks are
//! passed over.

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, Traction, Wall, WallKind};
use lahar::context::Context;
use lahar::error::Result;
use lahar::material::Material;
use lahar::particles::seeding::{Fill, Region};
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::simd::Isa;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use xtask_front::{process, setup};

const FILE: &str = "benches/bits.json";
const STEPS: usize = 100;
const H: f64 = 0.1;

/// Sums by case: instruction set, dimension, shape and treatment of walls; then by transfer; in it
/// those of the orders, "-" where the combination is refused.
type Sums = BTreeMap<String, BTreeMap<String, String>>;

/// Computes the sums, and compares with the file or writes it; builds what is needed unless
/// `built`.
pub fn run(write: bool, built: bool) -> std::result::Result<(), String> {
    if !built {
        setup::run(setup::Need::Tests)?;
        process::cargo(&["build", "--release", "--workspace"])?;
    }
    let found = all_sums()?;
    let path = process::root().join(FILE);
    if write {
        let text = serde_json::to_string_pretty(&found).map_err(|e| e.to_string())? + "\n";
        std::fs::write(path, text).map_err(|e| format!("{FILE}: {e}"))?;
        println!("wrote {FILE}");
        return Ok(());
    }
    let text = std::fs::read_to_string(path)
        .map_err(|e| format!("{FILE}: {e}; make it with `cargo xtask bits --write`"))?;
    let known: Sums = serde_json::from_str(&text).map_err(|e| format!("{FILE}: {e}"))?;
    let mut other = Vec::new();
    let mut same = 0;
    for (case, transfers) in &found {
        for (transfer, sums) in transfers {
            match known.get(case).and_then(|known| known.get(transfer)) {
                Some(known) if known == sums => same += 1,
                Some(known) => other.push(format!("{case} {transfer}: {sums}, not {known}")),
                None => other.push(format!("{case} {transfer}: not in the file")),
            }
        }
    }
    println!("{same} groups of sums are those of {FILE}, {} are not", other.len());
    if other.is_empty() {
        return Ok(());
    }
    Err(format!(
        "other bits than {FILE} says:\n{}\nif results were meant to change, run `cargo xtask bits --write`",
        other.join("\n")
    ))
}

/// The sums of all cases on all instruction sets of this processor, on as many threads as it has.
fn all_sums() -> std::result::Result<Sums, String> {
    let jobs: Vec<(Isa, Options)> =
        Isa::all().flat_map(|isa| groups().into_iter().map(move |o| (isa, o))).collect();
    let next = AtomicUsize::new(0);
    let work = || -> std::result::Result<Vec<_>, String> {
        let mut done = Vec::new();
        while let Some((isa, options)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let sums = of_group(*isa, options).map_err(|e| format!("{isa:?}: {e}"))?;
            done.push((case_of(*isa, options), format!("{:?}", options.transfer), sums));
        }
        Ok(done)
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts: Vec<_> = std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        running.into_iter().map(|t| t.join().unwrap_or(Err("a panic".into()))).collect()
    });
    let mut all = Sums::new();
    for part in parts {
        for (case, transfer, sums) in part? {
            all.entry(case).or_default().insert(transfer, sums);
        }
    }
    Ok(all)
}

/// The options of every group of sums; the order is left to choose.
fn groups() -> Vec<Options> {
    let mut groups = Vec::new();
    for (dimension, axisymmetric) in [(2, false), (3, false), (2, true)] {
        for shape in ShapeKind::ALL {
            for wall_treatment in [WallTreatment::Plain, WallTreatment::Modified] {
                for transfer in TransferKind::ALL {
                    groups.push(Options {
                        dimension,
                        axisymmetric,
                        shape,
                        wall_treatment,
                        transfer,
                        spacing: H,
                        filter_order: 3,
                        pic_rate: 4.0,
                        cfl: 0.3,
                        damping: 0.05,
                        body_force: shape == ShapeKind::QuadraticBspline,
                        ..Options::default()
                    });
                }
            }
        }
    }
    groups
}

fn case_of(isa: Isa, options: &Options) -> String {
    let dimension = if options.axisymmetric {
        "axisymmetric".into()
    } else {
        options.dimension.to_string() + "d"
    };
    format!("{} {dimension} {:?} {:?}", isa.name(), options.shape, options.wall_treatment)
}

/// The sums of the orders, one after the other.
fn of_group(isa: Isa, options: &Options) -> Result<String> {
    let mut sums = Vec::new();
    for order in StepOrder::ALL {
        let options = Options { order, ..options.clone() };
        sums.push(match options.check() {
            Ok(()) => format!("{:08x}", sum_of(isa, &options)?),
            Err(_) => "-".into(),
        });
    }
    Ok(sums.join(" "))
}

/// The sum after [`STEPS`] steps. Of a run that fails it is that of the message: what a broken
/// world holds is not promised.
fn sum_of(isa: Isa, options: &Options) -> Result<u32> {
    let mut world = build(isa, options)?;
    let mut sum = crc32fast::Hasher::new();
    for _ in 0..STEPS {
        if let Err(error) = world.step(None) {
            sum.update(error.message.as_bytes());
            return Ok(sum.finalize());
        }
    }
    let mut add = |values: &[f64]| values.iter().for_each(|v| sum.update(&v.to_le_bytes()));
    for body in world.bodies() {
        for info in world.fields(body)? {
            let field = world.field_data(body, &info.name.to_string_lossy())?;
            field.data.chunks(field.stride).for_each(|column| add(&column[..field.count]));
        }
        add(&world.ids(body)?.iter().map(|id| *id as f64).collect::<Vec<_>>());
    }
    for wall in 0..options.dimension as i64 {
        add(&world.wall_reaction(wall)?);
    }
    add(&world.prescribed_velocity_reaction(0)?);
    add(&world.traction_force(0)?.2);
    let totals = world.totals(None)?;
    add(&totals.angular_momentum);
    add(&[totals.kinetic_energy, totals.strain_energy, totals.potential_energy, world.time()]);
    add(&[world.stable_dt()?, world.equilibrium()?.unbalanced_force]);
    for node in 0..world.grid_stats().active_nodes {
        for info in world.node_fields() {
            let mut value = [0.0; 3];
            let value = &mut value[..info.components];
            world.node_value(&info.name.to_string_lossy(), node, value)?;
            add(value);
        }
    }
    Ok(sum.finalize())
}

/// A model: its plugin, its name, and parameters beside the elastic ones.
type Model = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Two bodies, one on a floor with friction and beside a wall, the other falls on it. The models go
/// by the transfer and the order, so that each kind of kinematics meets each kernel of a group.
fn build(isa: Isa, options: &Options) -> Result<World> {
    let context = Context::with_isa(Some(1), isa)?;
    let folder = process::release_folder().unwrap_or_default();
    let models: [Model; 5] = [
        ("linear_elastic", "linear_elastic", &[]),
        (
            "drucker_prager",
            "drucker_prager",
            &[("friction_angle", 30.0), ("cohesion", 10.0), ("cone", 0.0)], // compression
        ),
        ("linear_elastic", "linear_elastic_green_naghdi", &[]),
        ("von_mises", "von_mises", &[("yield_stress", 500.0)]),
        ("neo_hookean", "neo_hookean", &[]),
    ];
    let material = |n: usize| {
        let (plugin, model, values) = models[n % 5];
        let library = folder.join(format!("liblahar_{plugin}.so"));
        context.load_plugin(&library.to_string_lossy())?;
        let mut named = vec![("youngs_modulus", 2e4), ("poissons_ratio", 0.3)];
        named.extend(values);
        Material::new(&context, model, &named)
    };
    let mut world = World::new(&context, options)?;
    for (axis, kind) in [(1, WallKind::Friction), (0, WallKind::Slip), (2, WallKind::Separating)] {
        if axis < options.dimension {
            world.add_wall(&Wall { axis, side: 1, position: 0.0, kind, friction: 0.3 })?;
        }
    }
    let n = options.transfer as usize + options.order as usize;
    let boxes = [([0.0, 0.0, 0.0], [0.25, 0.2, 0.2]), ([0.05, 0.2, 0.05], [0.3, 0.35, 0.3])];
    for (b, (min, max)) in boxes.into_iter().enumerate() {
        let sign = b as f64;
        let velocity = [0.4 - sign, -0.5 * sign, 0.2];
        let fill = Fill { density: 1000.0, velocity, ..Fill::default() };
        let body = world.add_shape(&material(n + 3 * b)?, &Region::Box { min, max }, &fill)?;
        world.set_f_bar(body, b == 1)?;
    }
    add_conditions(&mut world, options)?;
    Ok(world)
}

/// Gravity by a table, a load on top of the upper body, and a current at one side of the lower one.
fn add_conditions(world: &mut World, options: &Options) -> Result<()> {
    let table = |a, b| Table::new("a table", &[0.0, 0.05], &[a, b]);
    let side = if options.axisymmetric { 0.0 } else { 2.0 };
    world.set_gravity_table(Some(table([0.0, -9.81, 0.0], [side, -8.0, 0.0])?))?;
    let region = BoxRegion { min: [0.0, 0.3, 0.0], max: [0.4, 0.35, 0.4] };
    let traction = table([0.0, -100.0, 0.0], [50.0, -50.0, 0.0])?;
    world.add_traction(Traction { body: 1, region, axis: 1, side: 1, traction })?;
    let region = BoxRegion { min: [0.15, 0.05, 0.0], max: [0.25, 0.2, 0.1] };
    let velocity = table([0.1, 0.0, 0.0], [-0.1, 0.0, 0.0])?;
    world.add_prescribed_velocity(PrescribedVelocity { region, components: 1, velocity })?;
    Ok(())
}

//! Contexts, materials, batches, threads.

use crate::support::{bad_plugin, in_child, plugin_path, shipped};
use lahar::context::{self, Context, LogLevel};
use lahar::error::{Error, Status};
use lahar::material::{Input, Kinematics, Material, StressBatch};
use std::cell::RefCell;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Barrier, Mutex};
use std::thread;

const SHIPPED: [&str; 5] =
    ["linear_elastic", "drucker_prager", "newtonian", "neo_hookean", "hencky"];

pub fn context() -> Arc<Context> {
    Context::new(Some(1)).unwrap()
}

/// The status, and every one of the texts in the message.
#[track_caller]
pub fn expect<T>(result: Result<T, Error>, status: Status, texts: &[&str]) {
    let Err(error) = result else { panic!("expected {status:?}, got success") };
    assert_eq!(error.status, status, "{error}");
    for text in texts {
        assert!(error.message.contains(text), "`{text}` is not in: {error}");
    }
}

#[test]
fn shipped_plugins_load_and_describe_their_models() {
    let context = context();
    for (i, name) in SHIPPED.iter().enumerate() {
        assert_eq!(context.load_plugin(&plugin_path(name)).unwrap(), i);
        let plugin = context.plugins()[i];
        assert_eq!(plugin.id, format!("org.lahar.{name}"));
        assert_eq!(plugin.version, env!("CARGO_PKG_VERSION"));
        assert_eq!(plugin.licence_c.to_str().unwrap(), "MIT OR Apache-2.0");
        let model = context.model(name).unwrap();
        assert_eq!(model.name_c.to_str().unwrap(), *name);
        let expected =
            if i < 3 { Kinematics::StrainIncrement } else { Kinematics::DeformationGradient };
        assert_eq!(model.kinematics, expected);
        assert_eq!(model.inputs, [Input::Density]);
    }
    assert_eq!(context.models().len(), 7); // two libraries have two
    let second = context.model("linear_elastic_green_naghdi").unwrap();
    assert_eq!(second.kinematics, Kinematics::GreenNaghdi);
    let model = context.model("drucker_prager").unwrap();
    let keys: Vec<&str> = model.parameters.iter().map(|p| p.key).collect();
    assert_eq!(keys[..4], ["youngs_modulus", "poissons_ratio", "friction_angle", "cohesion"]);
    assert_eq!(model.parameters[5].choices, ["compression", "extension", "plane_strain"]);
    assert_eq!((model.state_components(), model.states[1].key), (2, "opened_volumetric_strain"));
    assert_eq!(context.model("newtonian").unwrap().states[0].initial, 1.0);
    expect(
        context.model("druker_prager").map(|_| ()),
        Status::UnknownName,
        &["did you mean `drucker_prager`?"],
    );
}

#[test]
fn a_shipped_model_that_is_not_loaded_is_answered_with_its_plugin() {
    let names: Vec<String> = context::SHIPPED.iter().map(|(name, _)| name[6..].into()).collect();
    assert_eq!(names, shipped());
    for (plugin, models) in context::SHIPPED {
        let (empty, full) = (context(), context());
        full.load_plugin(&plugin_path(&plugin["lahar_".len()..])).unwrap();
        let offered: Vec<&str> = full.models().iter().map(|m| m.name).collect();
        assert_eq!(offered, models);
        for model in models {
            let text = format!("; it comes with the plugin {plugin}: load that first");
            expect(empty.model(model).map(drop), Status::UnknownName, &[model, &text]);
        }
    }
}

#[test]
fn a_shipped_plugin_exports_its_entry_and_nothing_else() {
    for name in shipped() {
        let output = Command::new("nm")
            .args(["-D", "--defined-only", &plugin_path(&name)])
            .output()
            .expect("nm runs");
        let text = String::from_utf8_lossy(&output.stdout);
        let symbols: Vec<&str> =
            text.lines().filter_map(|line| line.split_whitespace().last()).collect();
        assert_eq!(symbols, ["lahar_plugin_entry_v1"]);
    }
}

#[test]
fn two_models_of_one_name_do_not_go_into_one_context() {
    let context = context();
    let first = bad_plugin("nothing_wrong");
    context.load_plugin(&first).unwrap();
    let result = context.load_plugin(&bad_plugin("failing_update"));
    expect(result, Status::PluginInvalid, &["`minimal`", "already offered", &first]);
    assert_eq!(context.plugins().len(), 1);
}

pub fn with_plugin(path: &str) -> Arc<Context> {
    let context = context();
    context.load_plugin(path).unwrap();
    context
}

#[test]
fn a_material_is_made_of_named_values() {
    let context = with_plugin(&plugin_path("drucker_prager"));
    let good = [
        ("cohesion", 1.0e3),
        ("youngs_modulus", 1.0e7),
        ("poissons_ratio", 0.3),
        ("friction_angle", 30.0),
        ("cone", 0.0),
    ];
    let material = Material::new(&context, "drucker_prager", &good).unwrap();
    assert_eq!(material.value("cohesion").unwrap(), 1.0e3);
    assert_eq!(material.value("dilation_angle").unwrap(), 0.0);
    assert_eq!(material.model().name, "drucker_prager");
    expect(material.value("cohesio"), Status::UnknownName, &["did you mean `cohesion`?"]);

    let with = |name: &'static str, value: f64| {
        let mut named = good.to_vec();
        named.retain(|(n, _)| *n != name);
        named.push((name, value));
        Material::new(&context, "drucker_prager", &named).map(|_| ())
    };
    with("cone", 2.0).unwrap();
    expect(with("friction_angel", 30.0), Status::UnknownName, &["did you mean `friction_angle`?"]);
    expect(with("poissons_ratio", 0.5), Status::OutOfBounds, &["poissons_ratio", "got 0.5"]);
    expect(with("youngs_modulus", 0.0), Status::OutOfBounds, &["youngs_modulus", "[Pa]"]);
    expect(with("cohesion", f64::NAN), Status::InvalidArgument, &["cohesion", "finite"]);
    expect(with("cohesion", f64::INFINITY), Status::InvalidArgument, &["cohesion", "finite"]);
    for value in [-1.0, 0.5, 3.0] {
        expect(with("cone", value), Status::OutOfBounds, &["2 (plane_strain)"]);
    }
    expect(with("dilation_angle", 40.0), Status::OutOfBounds, &["must not exceed friction_angle"]);
    let missing = Material::new(&context, "drucker_prager", &good[..2]).map(|_| ());
    expect(missing, Status::MissingParameter, &["`poissons_ratio` [-]", "`friction_angle` [deg]"]);
    // Which cone is right depends on the world, which a model does not know: the error says when.
    let coneless = Material::new(&context, "drucker_prager", &good[..4]).map(|_| ());
    let choices = "`cone`, one of 0 (compression), 1 (extension), 2 (plane_strain): ";
    let when = ["triaxial compression (3D", "triaxial extension", "plane strain (2D"];
    expect(coneless, Status::MissingParameter, &[&[choices], &when[..]].concat());
    let twice = Material::new(&context, "drucker_prager", &[good[0], good[0]]).map(|_| ());
    expect(twice, Status::InvalidArgument, &["given twice"]);
    let unknown = Material::new(&context, "clay", &good).map(|_| ());
    expect(unknown, Status::UnknownName, &["clay"]);
    let none = Material::new(&self::context(), "clay", &good).map(|_| ());
    expect(none, Status::UnknownName, &["load a plugin first"]);
}

#[test]
fn a_value_outside_the_advised_bounds_is_logged_once_flushed() {
    let context = with_plugin(&plugin_path("linear_elastic"));
    let lines = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&lines);
    context.set_log(Some(Arc::new(move |l, t| sink.lock().unwrap().push((l, t.to_string())))), 1);
    let named = [("youngs_modulus", 1.0), ("poissons_ratio", 0.499)];
    Material::new(&context, "linear_elastic", &named).unwrap();
    context.log(LogLevel::Information, "too detailed");
    assert!(lines.lock().unwrap().is_empty());
    context.flush_log();
    let lines = lines.lock().unwrap();
    assert_eq!(lines.len(), 1);
    assert!(lines[0].0 == 1 && lines[0].1.contains("poissons_ratio"), "{lines:?}");
}

/// Rows of eight values on a 64-byte boundary, as the engine's scratch has them.
#[derive(Clone)]
struct Rows {
    data: Vec<f64>,
    start: usize,
    count: usize,
}

impl Rows {
    fn new(count: usize, value: f64) -> Self {
        let data = vec![value; 8 * count + 8];
        let start = data.as_ptr().align_offset(64);
        Self { data, start, count }
    }

    fn flat(&self) -> &[f64] {
        &self.data[self.start..self.start + 8 * self.count]
    }

    fn flat_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + 8 * self.count]
    }

    fn row(&self, c: usize) -> &[f64] {
        &self.flat()[8 * c..8 * c + 8]
    }

    fn row_mut(&mut self, c: usize) -> &mut [f64] {
        &mut self.flat_mut()[8 * c..8 * c + 8]
    }
}

/// Scratch for eight points.
struct Scratch {
    strain: Rows,
    stress0: Rows,
    state0: Rows,
    stress1: Rows,
    state1: Rows,
    density: Rows,
    wave_speed: Rows,
    diffusivity: Rows,
    status: [i32; 8],
}

impl Scratch {
    fn new(material: &Material) -> Self {
        let states = material.model().state_components();
        let mut state0 = Rows::new(states, 0.0);
        let mut next = 0;
        for s in &material.model().states {
            for c in next..next + s.components() {
                state0.row_mut(c).fill(s.initial);
            }
            next += s.components();
        }
        Self {
            strain: Rows::new(6, 0.0),
            stress0: Rows::new(6, 0.0),
            state1: Rows::new(states, 1.0),
            state0,
            stress1: Rows::new(6, f64::NAN),
            density: Rows::new(1, 1000.0),
            wave_speed: Rows::new(1, f64::NAN),
            diffusivity: Rows::new(1, f64::NAN),
            status: [0; 8],
        }
    }

    fn batch(&mut self, n: usize) -> StressBatch<'_> {
        StressBatch {
            n,
            stride: 8,
            dt: 1e-3,
            time: 0.0,
            step: -1,
            strain_increment: self.strain.flat(),
            velocity_gradient: &[],
            deformation_gradient: &[],
            stress0: self.stress0.flat(),
            state0: self.state0.flat(),
            stress1: self.stress1.flat_mut(),
            state1: self.state1.flat_mut(),
            inputs: self.density.flat(),
            wave_speed: self.wave_speed.flat_mut(),
            diffusivity: self.diffusivity.flat_mut(),
            energy: &mut [],
            dt_factor: &mut [],
            status: &mut self.status,
        }
    }
}

#[test]
fn a_material_updates_a_batch_through_the_library() {
    let context = with_plugin(&plugin_path("linear_elastic"));
    let named = [("youngs_modulus", 2.0e6), ("poissons_ratio", 0.25)];
    let material = Material::new(&context, "linear_elastic", &named).unwrap();
    let mut scratch = Scratch::new(&material);
    for k in 0..8 {
        scratch.strain.row_mut(0)[k] = 1e-4 * k as f64;
    }
    material.update(&mut scratch.batch(5)).unwrap();
    for k in 0..5 {
        let expected = 2.4e6 * 1e-4 * k as f64; // λ + 2 G = 1.2 E
        assert!((scratch.stress1.row(0)[k] - expected).abs() < 1e-9);
        assert!((scratch.wave_speed.row(0)[k] / 2400.0_f64.sqrt() - 1.0).abs() < 1e-14);
    }
    assert!(scratch.stress1.row(0)[5].is_nan(), "a point beyond the batch was written");
    assert!(scratch.diffusivity.row(0)[0].is_nan(), "an output was written that is not declared");
    scratch.wave_speed = Rows::new(1, f64::NAN);
    material.wave_speed(&mut scratch.batch(8)).unwrap();
    assert!((scratch.wave_speed.row(0)[7] / 2400.0_f64.sqrt() - 1.0).abs() < 1e-14);
    material.init_state(&mut scratch.batch(8)).unwrap();
}

#[test]
fn a_batch_that_is_not_well_formed_is_refused() {
    let context = with_plugin(&plugin_path("newtonian"));
    let material = Material::new(&context, "newtonian", &[("bulk_modulus", 1e6)]).unwrap();
    let mut scratch = Scratch::new(&material);
    type Change = fn(&mut StressBatch<'_>);
    let changes: [(Change, &str); 10] = [
        (|b| b.strain_increment = &[], "strain_increment is missing"),
        (|b| b.stress0 = &b.stress0[..47], "stress0 has 47 values, needs 48"),
        (|b| b.stress1 = &mut [], "stress1 is missing"),
        (|b| b.state0 = &[], "state0 is missing"),
        (|b| b.state1 = &mut [], "state1 is missing"),
        (|b| b.inputs = &[], "inputs is missing"),
        (|b| b.inputs = &b.inputs[..7], "inputs has 7 values, needs 8"),
        (|b| b.diffusivity = &mut [], "diffusivity is missing"),
        (|b| b.status = &mut [], "status is missing"),
        (|b| b.stride = 9, "stride 9"),
    ];
    for (change, text) in changes {
        let mut batch = scratch.batch(8);
        change(&mut batch);
        expect(material.update(&mut batch), Status::InvalidArgument, &[text]);
    }
    material.update(&mut scratch.batch(8)).unwrap();
}

#[test]
fn what_a_model_says_of_its_failure_reaches_the_error_and_its_lines_the_log() {
    let context = with_plugin(&plugin_path("newtonian"));
    let material = Material::new(&context, "newtonian", &[("bulk_modulus", 1e6)]).unwrap();
    let mut scratch = Scratch::new(&material);
    scratch.stress0.flat_mut()[..24].fill(1e6);
    expect(
        material.init_state(&mut scratch.batch(8)),
        Status::MaterialFailed,
        &["`init_state` of the model `newtonian`", "equation of state"],
    );

    let context = with_plugin(&bad_plugin("failing_update"));
    let seen = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&seen);
    context.set_log(Some(Arc::new(move |_, text| sink.lock().unwrap().push_str(text))), 3);
    let material = Material::new(&context, "minimal", &[]).unwrap();
    let mut scratch = Scratch::new(&material);
    let result = material.update(&mut scratch.batch(8));
    expect(result, Status::MaterialFailed, &["the clay is not in the mood"]);
    assert_eq!(*seen.lock().unwrap(), "");
    context.flush_log();
    assert_eq!(*seen.lock().unwrap(), "about to fail");
    // The text of one failure does not stick to the next.
    material.wave_speed(&mut scratch.batch(8)).unwrap();
}

#[test]
fn a_model_that_is_not_thread_safe_is_entered_once_at_a_time() {
    let context = with_plugin(&bad_plugin("not_thread_safe"));
    let materials: Vec<_> =
        (0..2).map(|_| Material::new(&context, "minimal", &[]).unwrap()).collect();
    let start = Barrier::new(4);
    thread::scope(|scope| {
        for t in 0..4 {
            let (material, start) = (&materials[t % 2], &start);
            scope.spawn(move || {
                let mut scratch = Scratch::new(material);
                start.wait();
                for _ in 0..200 {
                    material.update(&mut scratch.batch(8)).unwrap();
                }
            });
        }
    });
}

#[test]
fn the_thread_count_is_checked() {
    for threads in [0, 1025, usize::MAX] {
        let result = Context::new(Some(threads)).map(|_| ());
        expect(result, Status::InvalidArgument, &["from 1 to 1024"]);
    }
    assert_eq!(Context::new(Some(3)).unwrap().threads(), 3);
}

#[test]
fn the_environment_gives_the_thread_count_where_the_host_does_not() {
    let name = "plugins::the_environment_gives_the_thread_count_where_the_host_does_not";
    for value in ["2", "0", "many", "-1", "1e1", ""] {
        if in_child(name, &[("LAHAR_NUM_THREADS", value)]) {
            let value = std::env::var("LAHAR_NUM_THREADS").unwrap();
            assert_eq!(Context::new(Some(1)).unwrap().threads(), 1);
            if value == "2" {
                assert_eq!(Context::new(None).unwrap().threads(), 2);
            } else {
                let result = Context::new(None).map(|_| ());
                expect(result, Status::InvalidArgument, &["LAHAR_NUM_THREADS", &value]);
            }
            return;
        }
    }
}

/// Splits the work until each of `leaves` pieces marks its worker and waits a moment.
fn spread(context: &Context, leaves: usize) {
    if leaves > 1 {
        context.join(|| spread(context, leaves / 2), || spread(context, leaves - leaves / 2));
        return;
    }
    context.mark_worker();
    thread::sleep(std::time::Duration::from_millis(1));
}

#[test]
fn the_pool_counts_the_threads_that_worked() {
    let context = Context::new(Some(3)).unwrap();
    assert_eq!(context.threads_used(), 0);
    context.install(|| spread(&context, 200));
    assert_eq!(context.threads_used(), 3);
    context.check_process().unwrap();
    // One thread: everything runs here.
    let context = self::context();
    let here = thread::current().id();
    let there = context.install(|| {
        spread(&context, 8);
        thread::current().id()
    });
    assert_eq!((here, context.threads_used()), (there, 1));
}

#[test]
fn dropping_a_context_ends_its_threads() {
    static ENDED: AtomicUsize = AtomicUsize::new(0);
    struct Last;
    impl Drop for Last {
        fn drop(&mut self) {
            thread::sleep(std::time::Duration::from_millis(20));
            ENDED.fetch_add(1, Ordering::SeqCst);
        }
    }
    thread_local! {
        static LAST: RefCell<Option<Last>> = const { RefCell::new(None) };
    }
    fn plant(context: &Context, all: &Barrier, left: usize) {
        if left > 1 {
            context.join(|| plant(context, all, left / 2), || plant(context, all, left - left / 2));
            return;
        }
        LAST.set(Some(Last));
        all.wait(); // holds every piece until each has a thread of its own
    }
    let context = Context::new(Some(4)).unwrap();
    let all = Barrier::new(4);
    context.install(|| plant(&context, &all, 4));
    drop(context);
    assert_eq!(ENDED.load(Ordering::SeqCst), 4);
}

#[test]
fn lines_of_workers_are_delivered_on_the_thread_that_flushes() {
    let context = Context::new(Some(2)).unwrap();
    let plugin = bad_plugin("failing_update");
    context.load_plugin(&plugin).unwrap();
    let material = Material::new(&context, "minimal", &[]).unwrap();
    let lines = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&lines);
    let push = move |level: i32, text: &str| {
        sink.lock().unwrap().push((thread::current().id(), level, text.to_string()));
    };
    context.set_log(Some(Arc::new(push)), LogLevel::Detail as i32);
    let worker = context.install(|| {
        let mut scratch = Scratch::new(&material);
        material.update(&mut scratch.batch(8)).unwrap_err();
        thread::current().id()
    });
    assert_ne!(worker, thread::current().id());
    assert!(lines.lock().unwrap().is_empty());
    context.flush_log();
    let expected = (thread::current().id(), LogLevel::Warning as i32, "about to fail".to_string());
    assert_eq!(*lines.lock().unwrap(), [expected]);
    context.set_log(None, 3);
    context.log(LogLevel::Error, "nobody listens");
    context.flush_log();
    assert_eq!(lines.lock().unwrap().len(), 1);
}

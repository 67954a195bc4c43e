//! Plugins that are linked into the program: `Context::register_plugin`.

use crate::support::plugin_path;
use lahar::context::{Context, RustEntry};
use lahar::error::Status;
use lahar::material::{Material, StressBatch};
use lahar_plugin::abi::{LinkedPlugin, lahar_model_desc, lahar_plugin_desc};
use std::ptr;
use std::sync::{Arc, Mutex};

fn context() -> Arc<Context> {
    Context::new(Some(1)).unwrap()
}

/// A copy of linear elasticity's tables, with its first model only, spoiled.
pub fn spoiled(
    spoil: impl FnOnce(&mut lahar_plugin_desc, &mut lahar_model_desc),
) -> &'static lahar_plugin_desc {
    let mut plugin = *lahar_model_linear_elastic::PLUGIN.desc();
    // SAFETY: the table of a plugin that the SDK made holds a pointer to the table of each of its
    // models.
    let mut model = unsafe { **plugin.models };
    (plugin.model_count, plugin.models) = (1, ptr::null());
    spoil(&mut plugin, &mut model);
    if plugin.models.is_null() {
        let model: &'static lahar_model_desc = Box::leak(Box::new(model));
        plugin.models = Box::leak(Box::new(ptr::from_ref(model)));
    }
    Box::leak(Box::new(plugin))
}

/// A table as a linked plugin has it.
pub fn linked(table: &'static lahar_plugin_desc) -> LinkedPlugin {
    // SAFETY: the table and what it points to live on, and what is spoiled in it is refused before
    // it is used.
    unsafe { LinkedPlugin::new(table) }
}

#[test]
fn a_linked_plugin_is_registered_once_and_described_like_a_loaded_one() {
    let (a, b) = (context(), context());
    assert_eq!(a.register_plugin(lahar_model_newtonian::plugin).unwrap(), 0);
    assert_eq!(a.register_plugin(lahar_model_linear_elastic::plugin).unwrap(), 1);
    assert_eq!(a.register_plugin(lahar_model_newtonian::plugin).unwrap(), 0);
    assert_eq!(b.register_plugin(lahar_model_linear_elastic::plugin).unwrap(), 0);
    let plugin = b.plugins()[0];
    assert!(ptr::eq(plugin, a.plugins()[1]));
    assert_eq!(plugin.id, "org.lahar.linear_elastic");
    assert_eq!(plugin.path.to_str(), Some("[org.lahar.linear_elastic]"));
    assert_eq!(plugin.path_c.to_str(), Ok("[org.lahar.linear_elastic]"));
    assert_eq!(a.model("linear_elastic").unwrap().parameters.len(), 2);
}

#[test]
fn a_registered_and_a_loaded_plugin_may_not_offer_the_same_model() {
    let context = context();
    context.load_plugin(&plugin_path("linear_elastic")).unwrap();
    let error = context.register_plugin(lahar_model_linear_elastic::plugin).unwrap_err();
    assert_eq!(error.status, Status::PluginInvalid);
    assert!(error.message.contains("[org.lahar.linear_elastic]"), "{error}");
    assert!(error.message.contains("already offered by"), "{error}");
    assert_eq!(context.plugins().len(), 1);
}

#[test]
fn broken_tables_are_refused_with_their_reason() {
    let tables = [
        (spoiled(|p, _| p.abi_major = 2), Status::PluginAbi, "found major 2"),
        (spoiled(|p, _| p.struct_size = 16), Status::PluginInvalid, "got 16"),
        (spoiled(|p, _| p.model_count = 0), Status::PluginInvalid, "at least one model"),
        (spoiled(|p, _| p.id = ptr::null()), Status::PluginInvalid, "`id`, got NULL"),
        (spoiled(|_, m| m.update = None), Status::PluginInvalid, "function `update`, got NULL"),
        (spoiled(|_, m| m.outputs = 0), Status::PluginInvalid, "LAHAR_OUTPUT_WAVE_SPEED"),
    ];
    // An entry that was refused may be called again.
    static TABLE: Mutex<Option<&'static lahar_plugin_desc>> = Mutex::new(None);
    let entry: RustEntry = |_| linked(TABLE.lock().unwrap().unwrap());
    for (table, status, text) in tables {
        let context = context();
        *TABLE.lock().unwrap() = Some(table);
        let error = context.register_plugin(entry).unwrap_err();
        assert_eq!(error.status, status, "{error}");
        assert!(error.message.contains(text), "{error}");
        assert!(context.plugins().is_empty());
    }
}

#[test]
fn a_registered_model_gives_the_results_of_the_loaded_one_bit_for_bit() {
    let stress = |context: Arc<Context>| {
        let values = [("youngs_modulus", 1e7), ("poissons_ratio", 0.3)];
        let material = Material::new(&context, "linear_elastic", &values).unwrap();
        let strain: Vec<f64> = (0..48).map(|i| 1e-3 * f64::from(i).sin()).collect();
        let start = vec![-1e3; 48];
        let mut end = vec![0.0; 48];
        let (mut wave_speed, mut status) = (vec![0.0; 8], vec![0; 8]);
        let density = vec![1000.0; 8];
        let mut batch = StressBatch {
            n: 5,
            stride: 8,
            dt: 1e-3,
            time: 0.0,
            step: -1,
            strain_increment: &strain,
            stress0: &start,
            stress1: &mut end,
            inputs: &density,
            wave_speed: &mut wave_speed,
            status: &mut status,
            velocity_gradient: &[],
            deformation_gradient: &[],
            state0: &[],
            state1: &mut [],
            diffusivity: &mut [],
            energy: &mut [],
            dt_factor: &mut [],
        };
        material.update(&mut batch).unwrap();
        end
    };
    let (loaded, registered) = (context(), context());
    loaded.load_plugin(&plugin_path("linear_elastic")).unwrap();
    registered.register_plugin(lahar_model_linear_elastic::plugin).unwrap();
    assert_eq!(stress(loaded), stress(registered));
}

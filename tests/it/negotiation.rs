//! The negotiation when a plugin is loaded: a table for each of its rules, right but for one thing,
//! and the words that say so.

use crate::plugins::{context, expect};
use crate::register::{linked, spoiled};
use crate::support::bad_plugin;
use lahar::context::RustEntry;
use lahar::error::Status;
use lahar_plugin::abi::*;
use std::ffi::CStr;
use std::ptr;
use std::sync::Mutex;

type Case = (&'static lahar_plugin_desc, &'static [&'static str]);

const PARAMETER: lahar_parameter_desc = lahar_parameter_desc {
    key: c"first".as_ptr(),
    symbol: c"a".as_ptr(),
    unit: c"-".as_ptr(),
    description: c"A number".as_ptr(),
    kind: LAHAR_PARAMETER_REAL,
    required: 0,
    default_value: 1.0,
    hard_min: -9.0,
    hard_max: 9.0,
    advised_min: -5.0,
    advised_max: 5.0,
    choices: ptr::null(),
};

const STATE: lahar_state_desc = lahar_state_desc {
    key: c"first".as_ptr(),
    unit: c"-".as_ptr(),
    description: c"A number".as_ptr(),
    kind: LAHAR_STATE_SCALAR,
    rotation: LAHAR_ROTATION_NONE,
    initial: 0.0,
};

fn plugin(spoil: impl FnOnce(&mut lahar_plugin_desc)) -> &'static lahar_plugin_desc {
    spoiled(|p, _| spoil(p))
}

fn model(spoil: impl FnOnce(&mut lahar_model_desc)) -> &'static lahar_plugin_desc {
    spoiled(|_, m| spoil(m))
}

/// Two parameters; the second is spoiled.
fn parameter(spoil: impl FnOnce(&mut lahar_parameter_desc)) -> &'static lahar_plugin_desc {
    let mut all = [PARAMETER; 2];
    all[1].key = c"second".as_ptr();
    spoil(&mut all[1]);
    let all = Box::leak(Box::new(all));
    model(|m| (m.parameter_count, m.parameters) = (2, all.as_ptr()))
}

/// A parameter that is a choice.
fn choice(labels: &'static CStr, default: f64) -> &'static lahar_plugin_desc {
    parameter(|p| {
        (p.kind, p.choices, p.default_value) = (LAHAR_PARAMETER_CHOICE, labels.as_ptr(), default);
    })
}

/// Two state variables; the second is spoiled.
fn state(spoil: impl FnOnce(&mut lahar_state_desc)) -> &'static lahar_plugin_desc {
    let mut all = [STATE; 2];
    all[1].key = c"second".as_ptr();
    spoil(&mut all[1]);
    let all = Box::leak(Box::new(all));
    model(|m| {
        (m.state_count, m.state_size, m.states) = (2, size_of_val(&all[0]) as u32, all.as_ptr());
    })
}

fn inputs(wanted: &'static [i32]) -> &'static lahar_plugin_desc {
    model(|m| (m.input_count, m.inputs) = (wanted.len() as u32, wanted.as_ptr()))
}

/// Each table of the cases is refused with the words of its own.
fn refuse(cases: &[Case]) {
    // An entry that was refused may be called again.
    static TABLE: Mutex<Option<&'static lahar_plugin_desc>> = Mutex::new(None);
    static TURN: Mutex<()> = Mutex::new(());
    let entry: RustEntry = |_| linked(TABLE.lock().unwrap().unwrap());
    let _turn = TURN.lock();
    for (table, texts) in cases {
        let context = context();
        *TABLE.lock().unwrap() = Some(table);
        expect(context.register_plugin(entry), Status::PluginInvalid, texts);
        assert!(context.plugins().is_empty());
    }
}

const NULL: *const std::ffi::c_char = ptr::null();
const NOT_UTF8: &CStr = c"a\xff";

#[test]
fn texts_that_are_missing_or_not_utf8_are_refused() {
    refuse(&[
        (plugin(|p| p.id = NULL), &["plugin table", "a text for `id`, got NULL"]),
        (plugin(|p| p.version = NULL), &["plugin table", "a text for `version`, got NULL"]),
        (plugin(|p| p.author = NULL), &["plugin table", "a text for `author`, got NULL"]),
        (plugin(|p| p.licence = NULL), &["plugin table", "a text for `licence`, got NULL"]),
        (plugin(|p| p.url = NULL), &["plugin table", "a text for `url`, got NULL"]),
        (plugin(|p| p.author = NOT_UTF8.as_ptr()), &["plugin table", "`author` is not UTF-8"]),
        (model(|m| m.name = NULL), &["model 0", "a text for `name`, got NULL"]),
        (model(|m| m.summary = NULL), &["model `linear_elastic`", "`summary`, got NULL"]),
        (model(|m| m.reference = NULL), &["model `linear_elastic`", "`reference`, got NULL"]),
        (parameter(|p| p.key = NULL), &["parameter 1", "a text for `key`, got NULL"]),
        (parameter(|p| p.symbol = NULL), &["parameter `second`", "`symbol`, got NULL"]),
        (parameter(|p| p.unit = NULL), &["parameter `second`", "`unit`, got NULL"]),
        (parameter(|p| p.description = NULL), &["parameter `second`", "`description`, got NULL"]),
        (parameter(|p| p.unit = NOT_UTF8.as_ptr()), &["parameter `second`", "`unit` is not UTF-8"]),
        (state(|s| s.key = NULL), &["state variable 1", "a text for `key`, got NULL"]),
        (state(|s| s.unit = NULL), &["state variable `second`", "`unit`, got NULL"]),
        (state(|s| s.description = NULL), &["state variable `second`", "`description`, got NULL"]),
    ]);
}

#[test]
fn names_with_other_characters_and_names_given_twice_are_refused() {
    refuse(&[
        (plugin(|p| p.id = c"org/lahar".as_ptr()), &["any of `_.-`", "`id`, got `org/lahar`"]),
        (model(|m| m.name = c"a-b".as_ptr()), &["model 0", "any of `_`", "`name`, got `a-b`"]),
        (parameter(|p| p.key = c"2nd".as_ptr()), &["parameter 1", "a letter first", "got `2nd`"]),
        (parameter(|p| p.key = c"".as_ptr()), &["parameter 1", "a letter first", "got ``"]),
        (state(|s| s.key = c"a b".as_ptr()), &["state variable 1", "for `key`, got `a b`"]),
        (state(|s| s.key = c"\xc3\xa9".as_ptr()), &["state variable 1", "ASCII", "got `é`"]),
        (parameter(|p| p.key = PARAMETER.key), &["two parameters are named `first`"]),
        (state(|s| s.key = STATE.key), &["two state variables are named `first`"]),
        (choice(c"a|b|a", 0.0), &["parameter `second`", "two choices are named `a`"]),
        (inputs(&[1, 2, 1]), &["model `linear_elastic`", "it wants Density twice"]),
    ]);
}

#[test]
fn tables_that_cannot_be_read_are_refused() {
    let off = 4; // every table has pointers, which stand on eight bytes
    // A list of one model whose table begins between two words.
    let between = |p: &mut lahar_plugin_desc| {
        let table: &'static [lahar_model_desc; 2] =
            Box::leak(Box::new([*registered_model(), *registered_model()]));
        p.models = Box::leak(Box::new(table.as_ptr().wrapping_byte_add(off)));
    };
    let nowhere = |p: &mut lahar_plugin_desc| p.models = Box::leak(Box::new(ptr::null()));
    refuse(&[
        (plugin(between), &["model 0", "the table is not aligned"]),
        (plugin(nowhere), &["model 0", "expected a table, got NULL"]),
        (plugin(|p| p.struct_size = 8), &["plugin table", "struct_size", "got 8"]),
        (model(|m| m.struct_size = 8), &["model 0", "struct_size", "got 8"]),
        (plugin(|p| p.model_count = 4097), &["4097 models are more than 4096"]),
        (model(|m| m.parameter_count = 4097), &["4097 parameters are more than 4096"]),
        (model(|m| m.state_count = 4097), &["4097 states are more than 4096"]),
        (model(|m| m.input_count = 4097), &["4097 inputs are more than 4096"]),
        (model(|m| m.parameters = ptr::null()), &["expected 2 parameters, got NULL"]),
        (model(|m| m.state_count = 1), &["expected 1 states, got NULL"]),
        (model(|m| m.inputs = ptr::null()), &["expected 1 inputs, got NULL"]),
        (
            model(|m| m.parameters = m.parameters.wrapping_byte_add(off)),
            &["array of parameters is not aligned"],
        ),
        (model(|m| m.parameter_size += off as u32), &["array of parameters is not aligned"]),
        (model(|m| m.parameter_size = 16), &["expected parameters of at least", "got 16"]),
        (
            model(|m| {
                (m.state_count, m.state_size) = (1, 16);
                m.states = Box::leak(Box::new(STATE));
            }),
            &["expected states of at least", "got 16"],
        ),
    ]);
}

fn registered_model() -> &'static lahar_model_desc {
    lahar_plugin::ModelTable::of::<lahar_model_linear_elastic::LinearElastic>().desc()
}

#[test]
fn functions_that_are_missing_and_offers_that_are_not_declared_are_refused() {
    refuse(&[
        (model(|m| m.create = None), &["model `linear_elastic`", "function `create`, got NULL"]),
        (model(|m| m.destroy = None), &["function `destroy`, got NULL"]),
        (model(|m| m.update = None), &["function `update`, got NULL"]),
        (model(|m| m.wave_speed = None), &["function `wave_speed`, got NULL"]),
        (
            model(|m| m.capabilities &= !LAHAR_CAPABILITY_TANGENT),
            &["LAHAR_CAPABILITY_TANGENT is not declared, but `lahar.tangent` is offered"],
        ),
    ]);
    for (name, text) in [
        ("null_energy", "expected a function in `lahar.energy`, got NULL"),
        ("unknown_rule", "expected transfer rules 0 to 2, got 3"),
    ] {
        let refused = context().load_plugin(&bad_plugin(name));
        expect(refused, Status::PluginInvalid, &["model `minimal`", text]);
    }
}

#[test]
fn values_out_of_their_range_are_refused() {
    let whole =
        |default| parameter(|p| (p.kind, p.default_value) = (LAHAR_PARAMETER_INTEGER, default));
    refuse(&[
        (model(|m| m.kinematics = 4), &["expected kinematics 0, 1, 2 or 3, got 4"]),
        (model(|m| m.kinematics = -1), &["expected kinematics 0, 1, 2 or 3, got -1"]),
        (inputs(&[1, 0]), &["it wants input 0", "1 (density) to 9 (particle id)"]),
        (inputs(&[10]), &["it wants input 10"]),
        (parameter(|p| p.kind = 3), &["parameter `second`", "expected kind 0, 1 or 2, got 3"]),
        (parameter(|p| p.required = 2), &["expected 0 or 1 for `required`, got 2"]),
        (parameter(|p| p.required = -1), &["expected 0 or 1 for `required`, got -1"]),
        (parameter(|p| p.hard_min = 10.0), &["expected hard_min <= hard_max, got 10 and 9"]),
        (parameter(|p| p.advised_min = 6.0), &["expected advised_min <= advised_max, got 6 and 5"]),
        (parameter(|p| p.advised_max = f64::NAN), &["advised_min <= advised_max", "-5 and NaN"]),
        (parameter(|p| p.default_value = 9.5), &["its default 9.5", "from -9 to 9"]),
        (parameter(|p| p.default_value = f64::NAN), &["its default NaN is not a value"]),
        (whole(1.5), &["parameter `second`", "its default 1.5 is not a value that it accepts"]),
        (choice(c"a||b", 0.0), &["labels separated by `|`, got an empty label"]),
        (choice(c"", 0.0), &["labels separated by `|`, got an empty label"]),
        (choice(c"a|b", 2.0), &["parameter `second`", "its default 2 is not a value"]),
        (choice(c"a|b", -1.0), &["its default -1 is not a value"]),
        (choice(c"a|b", 0.5), &["its default 0.5 is not a value"]),
        (parameter(|p| p.kind = LAHAR_PARAMETER_CHOICE), &["a text for `choices`, got NULL"]),
        (state(|s| s.kind = 4), &["state variable `second`", "expected kind 0 to 3, got 4"]),
        (state(|s| s.kind = -1), &["expected kind 0 to 3, got -1"]),
        (state(|s| s.rotation = 2), &["state variable `second`", "rotation 0 or 1, got 2"]),
        (state(|s| s.initial = f64::INFINITY), &["a finite initial value, got inf"]),
        (state(|s| s.initial = f64::NAN), &["a finite initial value, got NaN"]),
    ]);
}

/// The control: what the cases spoil is accepted as it stands.
#[test]
fn the_same_tables_are_accepted_when_nothing_is_spoiled() {
    fn accept(entry: RustEntry) {
        assert_eq!(context().register_plugin(entry).unwrap(), 0);
    }
    accept(|_| linked(plugin(|_| {})));
    accept(|_| linked(parameter(|_| {})));
    accept(|_| linked(parameter(|p| p.kind = LAHAR_PARAMETER_INTEGER)));
    accept(|_| linked(parameter(|p| (p.required, p.default_value) = (1, f64::NAN))));
    accept(|_| linked(choice(c"a|b", 1.0)));
    accept(|_| linked(state(|_| {})));
    accept(|_| linked(inputs(&[1, 2, 3, 4, 5, 6, 7, 8, 9])));
}

//! Random calls: mostly sensible arguments, some of each kind of bad ones.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::CString;
use std::ops::Range;
use std::path::Path;

use lahar::error::Status;

use super::caller::{Arguments, Caller, on_log, on_progress};
use super::header::{Declaration, Function, Header};
use super::setup::Random;

/// Longest array of a host, in points; with the largest stride and width it fits into `ARRAY`.
const MOST_POINTS: i64 = 400;
const ARRAY: usize = 1 << 16;
/// Bytes of a struct; longer ones would not be the host's.
const STRUCT: usize = 1024;
/// Most live handles of a type.
const MOST_HANDLES: usize = 3;

/// Most bodies of a world.
const MOST_BODIES: i64 = 4;

/// A host that calls at random.
pub struct Host<'a> {
    caller: &'a Caller,
    header: &'a Header,
    random: Random,
    /// Live handles by type; the first `shared` of each are never freed.
    pub handles: BTreeMap<&'a str, Vec<i64>>,
    shared: BTreeMap<&'a str, usize>,
    texts: Vec<CString>,
    /// Places of the plugins among the texts.
    plugins: Range<usize>,
    numbers: Vec<f64>,
    rising: Vec<f64>,
    /// Of a material's first parameters.
    constants: Vec<f64>,
    integers: Vec<i64>,
    output: Vec<u64>,
    structs: Vec<[u64; STRUCT / 8]>,
    lists: Vec<Vec<i64>>,
    /// How often each function gave each status.
    pub seen: BTreeMap<(&'a str, String), u64>,
    /// What broke the contract.
    pub breaks: BTreeMap<(&'a str, String), String>,
    is_traced: bool,
}

impl<'a> Host<'a> {
    pub fn new(caller: &'a Caller, header: &'a Header, seed: u64, words: &[String]) -> Self {
        let mut random = Random::new(seed);
        let texts = words.iter().map(|word| CString::new(word.as_str()).expect("no NUL"));
        let strange = [vec![], b"\xff\xfe not UTF-8".to_vec(), vec![b'x'; 5000]];
        let strange = strange.map(|text| CString::new(text).expect("no NUL"));
        let texts = texts.chain(strange).collect();
        let numbers = random.many(ARRAY, 1e-3, 1.0);
        Self {
            caller,
            header,
            random,
            handles: BTreeMap::new(),
            shared: BTreeMap::new(),
            texts,
            plugins: words.len() - 3..words.len(),
            numbers,
            rising: (0..ARRAY).map(|k| 0.1 * k as f64).collect(),
            constants: [1e5, 0.3, 30.0, 10.0, 0.0].into_iter().cycle().take(ARRAY).collect(),
            integers: (0..ARRAY as i64).map(|k| k % 64).collect(),
            output: vec![0; ARRAY],
            structs: vec![[0; STRUCT / 8]; 16],
            lists: vec![Vec::new(); 4],
            seen: BTreeMap::new(),
            breaks: BTreeMap::new(),
            is_traced: std::env::var_os("LAHAR_CALLS_TRACE").is_some(),
        }
    }

    /// Uses the handles of another host, too, but never frees them.
    pub fn share(&mut self, handles: &BTreeMap<&'a str, Vec<i64>>) {
        self.handles = handles.clone();
        self.shared = handles.iter().map(|(kind, list)| (*kind, list.len())).collect();
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.random.next() < probability
    }

    fn below(&mut self, n: usize) -> usize {
        (self.random.next() * n as f64) as usize
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// Makes a context, a material, and a world with a body, as a good host does.
    pub fn prepare(&mut self) {
        let context = self.made("lahar_context", "lahar_context_create", &[1]);
        let plugin = self.texts[self.plugins.start].as_ptr() as i64;
        self.good("lahar_context_load_plugin", &[context, plugin, 0]);
        let names: Vec<i64> = self.texts[..2].iter().map(|text| text.as_ptr() as i64).collect();
        let values = [1e5, 0.3];
        let model = self.texts[MODELS.start].as_ptr() as i64;
        let (names, values) = (names.as_ptr() as i64, values.as_ptr() as i64);
        let inputs = [context, model, 2, names, values];
        let material = self.made("lahar_material", "lahar_material_create", &inputs);
        // many combinations of options are refused
        let tries = (0..1000).find(|_| {
            let options = self.a_struct("lahar_world_options", 0, true, 2.0);
            let words = vec![context, options, self.output.as_mut_ptr() as i64];
            let arguments = Arguments { words, doubles: Vec::new() };
            self.caller.call("lahar_world_create", &arguments) as i32 == 0
        });
        assert!(tries.is_some(), "no world: {}", self.caller.message());
        let world = self.output[0] as i64;
        self.keep("lahar_world", world);
        let fill = self.a_struct("lahar_fill", 0, true, 2.0);
        let (low, high) = ([0.1; 3], [0.9; 3]);
        let (low, high) = (low.as_ptr() as i64, high.as_ptr() as i64);
        // a static grid may be too small for it
        let words = vec![world, material, low, high, fill, 0];
        self.caller.call("lahar_body_add_box", &Arguments { words, doubles: Vec::new() });
    }

    /// Calls a function that must succeed.
    fn good(&self, name: &str, words: &[i64]) {
        let words = words.to_vec();
        let answer = self.caller.call(name, &Arguments { words, doubles: Vec::new() });
        assert_eq!(answer as i32, 0, "{name}: {}", self.caller.message());
    }

    /// The same for one that makes an object.
    fn made(&mut self, kind: &'a str, name: &str, words: &[i64]) -> i64 {
        let place = self.output.as_mut_ptr() as i64;
        self.good(name, &[words, &[place]].concat());
        let handle = self.output[0] as i64;
        self.keep(kind, handle);
        handle
    }

    /// Keeps a handle; frees another where there are too many.
    fn keep(&mut self, kind: &'a str, handle: i64) {
        let shared = self.shared.get(kind).copied().unwrap_or(0);
        let list = self.handles.entry(kind).or_default();
        list.push(handle);
        if list.len() > MOST_HANDLES + shared {
            let place = shared + self.below(MOST_HANDLES);
            let handle = self.handles.get_mut(kind).expect("a list").remove(place);
            self.free(kind, handle);
        }
    }

    /// Calls one function, any but that which prints.
    pub fn call_any(&mut self) {
        if self.chance(0.003) {
            self.prepare();
        }
        let functions = &self.header.functions;
        let function = loop {
            let function = &functions[self.below(functions.len())];
            let name = &function.name;
            let weight = match name.as_str() {
                "lahar_log_stderr" => 0.0,
                name if name.ends_with("_free") && name != "lahar_view_free" => 0.05,
                "lahar_context_create" | "lahar_world_create" => 0.2,
                _ => 1.0,
            };
            if self.chance(weight) {
                break function;
            }
        };
        self.call(function);
    }

    fn call(&mut self, function: &'a Function) {
        let mut arguments = Arguments::default();
        let (mut made, mut freed) = (None, None);
        // a host that means well most of the time
        let care = if self.chance(0.7) { 1.0 } else { 0.8 };
        for (n, argument) in function.arguments.iter().enumerate() {
            if (argument.base.as_str(), argument.pointers) == ("double", 0) {
                let value = self.number(&argument.name, care);
                arguments.doubles.push(value);
                continue;
            }
            let word = self.word(argument, n, care);
            if self.is_handle(argument) && argument.pointers == 2 && word != 0 {
                made = Some((argument.base.as_str(), word));
            } else if function.name.ends_with("_free") {
                freed = Some((argument.base.as_str(), word));
            }
            arguments.words.push(word);
        }
        if let Some((kind, word)) = freed {
            let shared = self.shared.get(kind).copied().unwrap_or(0);
            let list = self.handles.entry(kind).or_default();
            match list.iter().position(|handle| *handle == word) {
                Some(place) if place < shared => return,
                Some(place) => drop(list.remove(place)),
                None => {}
            }
        }
        if self.is_traced {
            println!("{} {arguments:?}", function.name);
        }
        self.output[0] = u64::MAX; // no handle
        let answer = self.caller.call(&function.name, &arguments);
        self.judge(function, answer as i32, made);
        if answer == 0 && function.name.starts_with("lahar_body_add_") {
            self.thin_out(arguments.words[0]);
        }
    }

    fn judge(&mut self, function: &'a Function, answer: i32, made: Option<(&'a str, i64)>) {
        if !function.has_status {
            *self.seen.entry((&function.name, "called".into())).or_default() += 1;
            return;
        }
        let status = self.caller.status_name(answer);
        *self.seen.entry((&function.name, status.clone())).or_default() += 1;
        let is_listed = Status::from_i32(answer).is_ok_and(|s| function.statuses.contains(&s));
        if answer != 0 && !is_listed {
            let message = self.caller.message();
            self.breaks.entry((&function.name, status.clone())).or_insert(message);
        }
        let Some((kind, _)) = made else { return };
        let handle = self.output[0] as i64;
        if answer != 0 {
            // what fails leaves NULL, and nothing where it did not come to that
            if handle != 0 && handle != -1 {
                self.breaks.insert((&function.name, status), format!("handle {handle:x}"));
            }
            return;
        }
        self.keep(kind, handle);
    }

    /// Removes bodies of a world that gets too many, so that steps stay short.
    fn thin_out(&mut self, world: i64) {
        let mut count = 0i64;
        let words = vec![world, &raw mut count as i64];
        self.caller.call("lahar_world_body_count", &Arguments { words, doubles: Vec::new() });
        if count > MOST_BODIES {
            for body in 0..64 {
                let words = vec![world, body];
                self.caller.call("lahar_body_remove", &Arguments { words, doubles: Vec::new() });
            }
        }
    }

    fn free(&self, kind: &str, handle: i64) {
        let arguments = Arguments { words: vec![handle], doubles: Vec::new() };
        self.caller.call(&format!("{kind}_free"), &arguments);
    }

    /// Frees all handles, in any order of types.
    pub fn free_all(&mut self) {
        let mut all: Vec<(&str, i64)> = Vec::new();
        for (kind, list) in std::mem::take(&mut self.handles) {
            let shared = self.shared.get(kind).copied().unwrap_or(0);
            all.extend(list[shared..].iter().map(|handle| (kind, *handle)));
        }
        while !all.is_empty() {
            let (kind, handle) = all.swap_remove(self.below(all.len()));
            self.free(kind, handle);
        }
    }

    fn is_handle(&self, argument: &Declaration) -> bool {
        ["lahar_context", "lahar_material", "lahar_world", "lahar_view"]
            .contains(&argument.base.as_str())
    }

    /// An argument that goes as a word.
    fn word(&mut self, argument: &'a Declaration, n: usize, care: f64) -> i64 {
        if self.header.callbacks.contains(&argument.base) {
            return match argument.base.as_str() {
                "lahar_log_callback" if self.chance(0.5) => on_log as *const () as i64,
                "lahar_progress_callback" if self.chance(0.8) => on_progress as *const () as i64,
                _ => 0,
            };
        }
        if argument.pointers == 0 {
            return self.integer(&argument.name, care);
        }
        // the criteria of NULL let a run go on for a million steps
        if argument.base != "lahar_settle_criteria" && !self.chance(0.9 + 0.1 * care) {
            return 0;
        }
        match (argument.base.as_str(), argument.pointers) {
            (_, 2) if self.is_handle(argument) => self.output.as_mut_ptr() as i64,
            (base, 1) if self.is_handle(argument) => {
                let live = self.handles.get(base).cloned().unwrap_or_default();
                if live.is_empty() { 0 } else { self.one_of(&live) }
            }
            ("char", 2) => self.texts_of(n, &argument.name),
            ("char", 1) if argument.is_const => self.text_for(&argument.name),
            (base, 1) if self.header.structs.contains_key(base) => {
                self.a_struct(base, n, argument.is_const, care)
            }
            ("double", 1) if argument.is_const => self.array(&argument.name, care),
            ("int64_t", 1) if argument.is_const => self.integers.as_ptr() as i64,
            _ => self.output[8..].as_mut_ptr() as i64, // something that is written, or `user`
        }
    }

    /// A text that means something in this place, or any other.
    fn text_for(&mut self, name: &str) -> i64 {
        let meant = match name {
            "parameter" => PARAMETERS,
            "model" => MODELS,
            "field" => FIELDS,
            "name_or_path" => self.plugins.clone(),
            _ => 0..self.texts.len(),
        };
        if self.chance(0.3) {
            return self.text();
        }
        let place = meant.start + self.below(meant.len());
        self.texts[place].as_ptr() as i64
    }

    fn text(&mut self) -> i64 {
        let place = self.below(self.texts.len());
        self.texts[place].as_ptr() as i64
    }

    /// An array of texts, with what a model needs in front.
    fn texts_of(&mut self, n: usize, name: &str) -> i64 {
        assert_eq!(name, "names", "another array of texts: say what is in it");
        let mut list: Vec<i64> = PARAMETERS.map(|k| self.texts[k].as_ptr() as i64).collect();
        list.extend((0..MOST_POINTS).map(|_| if self.chance(0.1) { 0 } else { self.text() }));
        self.lists[n % 4] = list;
        self.lists[n % 4].as_ptr() as i64
    }

    fn array(&mut self, name: &str, care: f64) -> i64 {
        if name == "times" && self.chance(care) {
            return self.rising.as_ptr() as i64;
        }
        if name == "max" && self.chance(care) {
            return self.rising[10..].as_ptr() as i64; // above what `min` is
        }
        if name == "values" && self.chance(0.5) {
            return self.constants.as_ptr() as i64;
        }
        if !self.chance(care) {
            let place = self.below(64);
            self.numbers[place] = self.number("", 0.0);
        } else {
            let place = self.below(64);
            self.numbers[place] = self.random.next();
        }
        self.numbers.as_ptr() as i64
    }

    /// A struct: as its init function leaves it, with some fields set.
    fn a_struct(&mut self, base: &'a str, n: usize, is_input: bool, care: f64) -> i64 {
        let fields = &self.header.structs[base];
        let size: usize = fields.iter().map(|field| self.size_of(field)).sum();
        self.structs[n].fill(0);
        let start = self.structs[n].as_mut_ptr() as i64;
        let init = format!("{base}_init");
        if is_input && self.header.functions.iter().any(|f| f.name == init) {
            let words = vec![start, size as i64];
            self.caller.call(&init, &Arguments { words, doubles: Vec::new() });
            self.set_fields(n, 0, fields, care);
        }
        let told = if self.chance(0.9 + 0.1 * care) { size } else { self.below(STRUCT) };
        let first = &mut self.structs[n][0];
        *first = *first >> 32 << 32 | told as u64;
        start
    }

    fn size_of(&self, field: &Declaration) -> usize {
        let one = match (field.pointers, field.base.as_str()) {
            (0, "int32_t" | "uint32_t" | "lahar_status") => 4,
            (0, base) if self.header.structs.contains_key(base) => {
                self.header.structs[base].iter().map(|field| self.size_of(field)).sum()
            }
            _ => 8,
        };
        one * field.length
    }

    /// Sets most fields from byte `at` on; gives the byte behind them.
    fn set_fields(&mut self, n: usize, mut at: usize, fields: &'a [Declaration], care: f64) {
        for field in fields {
            let size = self.size_of(field);
            let is_kept = field.name == "reserved" && self.chance(care) || self.chance(0.3);
            let must = ["max_steps", "count", "data", "times", "values"];
            if is_kept && !must.contains(&field.name.as_str()) && at > 0 && field.name != "spacing"
            {
                at += size;
                continue;
            }
            if let (0, Some(inner)) = (field.pointers, self.header.structs.get(&field.base)) {
                // not given, or given; a host's array is NULL or as long as it says
                if self.chance(0.5) {
                    self.set_fields(n, at, inner, care);
                }
                at += size;
                continue;
            }
            for k in 0..field.length {
                let place = at + k * size / field.length;
                let bits = match (field.pointers, field.base.as_str()) {
                    (0, "double") => self.number(&field.name, care).to_bits(),
                    (0, _) => self.integer(&field.name, care) as u64,
                    _ if self.chance(0.05) => 0,
                    _ => self.array(&field.name, care) as u64,
                };
                let word = &mut self.structs[n][place / 8];
                *word = match (size / field.length, place % 8) {
                    (8, _) => bits,
                    (_, 0) => *word >> 32 << 32 | bits & 0xffff_ffff,
                    _ => *word & 0xffff_ffff | bits << 32,
                };
            }
            at += size;
        }
    }

    fn integer(&mut self, name: &str, care: f64) -> i64 {
        if !self.chance(care) {
            // no size may be longer than the host's memory, and no run without end
            let least = [i64::MIN, -1, -7, i32::MIN as i64, 0];
            let any = [i64::MIN, -1, 0, i64::MAX, i32::MAX as i64, 1 << 40, 99];
            return match name {
                "size" | "max_steps" => self.one_of(&least),
                "count" | "capacity" | "component_stride" | "point_stride" => {
                    self.one_of(&[i64::MIN, -1, 0, i64::MAX])
                }
                "particles_per_cell" => self.one_of(&[i32::MIN as i64, -1, 0]),
                _ => self.one_of(&any),
            };
        }
        match name {
            "size" => self.below(STRUCT) as i64,
            "max_steps" => self.one_of(&[0, 1, 2, 3]),
            "count" => self.one_of(&[0, 1, 2, 4, 5, 16, 25, 100, MOST_POINTS]),
            "capacity" => self.one_of(&[0, 1, 10, 500]),
            "component_stride" => self.one_of(&[0, 0, 0, 1, 2, MOST_POINTS]),
            "point_stride" => self.one_of(&[0, 0, 0, 1, 2, 9]),
            "dimension" => self.one_of(&[2, 2, 3]),
            "threads" => self.one_of(&[0, 1, 2]),
            "side" => self.one_of(&[1, -1]),
            "reserved" => 0,
            "particles_per_cell" => self.one_of(&[1, 2]),
            _ => self.one_of(&[0, 0, 1, 1, 2, 3, 4]),
        }
    }

    fn number(&mut self, name: &str, care: f64) -> f64 {
        if !self.chance(care) {
            return self.one_of(&[
                f64::NAN,
                f64::INFINITY,
                -f64::INFINITY,
                -1.0,
                0.0,
                1e300,
                1e-300,
                1e30,
            ]);
        }
        match name {
            "spacing" => self.one_of(&[0.25, 0.5]),
            "density" => 1000.0,
            "mass" => self.one_of(&[0.0, 0.0, 10.0]),
            "dt" => self.one_of(&[1e-5, 1e-4, 1e-2]),
            "until" => self.one_of(&[1e-3, 0.1, 10.0, 1e9]),
            "cfl" | "damping" | "friction" | "k0" | "radius" | "center" => {
                0.1 + 0.4 * self.random.next()
            }
            "gravity" => self.one_of(&[0.0, -9.81]),
            "min" | "box_min" | "position" => self.one_of(&[-0.5, 0.0, 0.1]),
            "max" | "box_max" => self.one_of(&[0.5, 1.0, 2.0]),
            "interval" => self.one_of(&[0.0, 1e-3]),
            "kinetic_ratio" | "unbalanced_ratio" => self.one_of(&[1e-3, 1e3]),
            _ => self.one_of(&[0.0, 0.0, 0.1, -0.1, 1.0, 20.0]),
        }
    }

    /// Statuses that were seen, by name.
    pub fn statuses(&self) -> BTreeSet<&str> {
        self.seen.keys().map(|(_, status)| status.as_str()).collect()
    }
}

const PARAMETERS: Range<usize> = 0..5;
const MODELS: Range<usize> = 5..8;
const FIELDS: Range<usize> = 8..15;

/// Texts that mean something to the library; plugins are the last.
pub fn words(plugins: &[String], folder: &Path) -> Vec<String> {
    let words = [
        "youngs_modulus",
        "poissons_ratio",
        "friction_angle",
        "cohesion",
        "cone",
        "linear_elastic",
        "drucker_prager",
        "newtonian",
        "position",
        "velocity",
        "stress",
        "volume",
        "mass",
        "momentum",
        "force",
        "/no/such/folder/x.vtp",
    ];
    let file = |name: &str| folder.join(name).display().to_string();
    let mut all: Vec<String> = words.map(String::from).into();
    all.extend([file("a.vtp"), file("a.txt"), folder.display().to_string()]);
    all.extend_from_slice(plugins);
    all
}

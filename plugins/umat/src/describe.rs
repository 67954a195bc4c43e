//! Turns a library and its sidecar into the tables of the plugin ABI.

use crate::calls;
use crate::host::{c_string, log};
use crate::library::UserLibrary;
use crate::sidecar::{
    self, CountOrList, Field, HiddenLength, Kind, Modulus, Routine, Shear, Sidecar, Threads,
    USUAL_PARAMETERS, USUAL_STATES,
};
use lahar_plugin_abi::*;
use std::ffi::c_char;
use std::path::Path;
use std::ptr;

/// State variables of the adapter itself, behind those of the routine.
pub const OWN_STATES: [&str; 5] = [
    "total_strain",
    "displacement_gradient",
    "elastic_energy",
    "plastic_dissipation",
    "creep_dissipation",
];

/// Places of the fixed inputs.
pub const DENSITY: usize = 0;
pub const ELEMENT_LENGTH: usize = 1;
pub const TEMPERATURE: usize = 2;
pub const POSITION: usize = 3;
pub const PARTICLE_ID: usize = 6;
pub const INTERNAL_ENERGY: usize = 7;

/// Position in the engine's order of component c of a symmetric tensor in the order 11, 22, 33, 12, 13, 23.
pub const ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];

/// One `STATEV`: its component among the engine's, how many times larger it is there, and the inverse, which is exact.
pub struct Place {
    pub component: usize,
    pub factor: f64,
    pub inverse: f64,
}

/// A lower bound of the modulus of waves [Pa].
pub enum Floor {
    Value(f64),
    /// Position among the parameters.
    Parameter(usize),
}

/// What the calls need to know of an adapted library.
pub struct Adapted {
    pub library: UserLibrary,
    pub cmname: [u8; 80],
    pub ntens: usize,
    pub hidden_length: HiddenLength,
    pub floor: Option<Floor>,
    pub parameter_count: usize,
    /// Whether the first parameter says how many of the others there are.
    pub counted: bool,
    /// One for each `STATEV`.
    pub states: Vec<Place>,
    /// Components of the routine's variables that are no STATEV: shears out of the plane.
    pub unused: Vec<usize>,
    /// First value of each `STATEV`.
    pub initial: Vec<f64>,
    /// Components of all state variables.
    pub components: usize,
    /// First component of the adapter's own variables; the energies follow them.
    pub total_strain: usize,
    pub displacement_gradient: usize,
    pub energies: Option<usize>,
    pub inputs: usize,
    /// Which inputs stand in `PREDEF`.
    pub predef: Vec<usize>,
}

/// The plugin made of the library at `path`.
pub fn adapt(path: &Path) -> Result<&'static lahar_plugin_desc, String> {
    let found = sidecar::read(path)?;
    let without_sidecar = found.is_none();
    let sidecar = found.unwrap_or_default();
    let library = UserLibrary::open(path, sidecar.routine, sidecar.threads)?;
    let name = sidecar.model.clone().unwrap_or_else(|| name_of(path));
    if without_sidecar {
        log(
            LAHAR_PLUGIN_LOG_INFORMATION,
            &format!(
                "{}: model `{name}` has no sidecar file {}: parameters `nprops` and `prop_1` to `prop_{USUAL_PARAMETERS}`, state \
                 variables `statev_1` to `statev_{USUAL_STATES}`",
                path.display(),
                path.with_extension("json").display()
            ),
        );
    }
    let (parameters, counted) = parameters(&sidecar);
    let mut states = States::default();
    states.of_routine(&sidecar, library.routine);
    let adapted = states.adapted(&sidecar, library, &name, (&parameters, counted))?;
    let adapted: &'static Adapted = Box::leak(Box::new(adapted));
    let model = model(&sidecar, &name, adapted, parameters, states.table);
    calls::remember(model, adapted);
    Ok(plugin(&sidecar, &name, model))
}

/// `libmy_umat.so` has the model `my_umat`.
fn name_of(path: &Path) -> String {
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = file.split(".so").next().unwrap_or_default();
    let stem = stem.strip_prefix("lib").filter(|s| !s.is_empty()).unwrap_or(stem);
    let name: String =
        stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => name,
        false => format!("umat_{name}"),
    }
}

fn text(text: &str) -> *const c_char {
    c_string(text).into_raw()
}

fn leak<T>(list: Vec<T>) -> *const T {
    if list.is_empty() { ptr::null() } else { Vec::leak(list).as_ptr() }
}

fn parameter(key: &str, symbol: &str, unit: &str, description: &str) -> lahar_parameter_desc {
    lahar_parameter_desc {
        key: text(key),
        symbol: text(symbol),
        unit: text(unit),
        description: text(description),
        kind: LAHAR_PARAMETER_REAL,
        required: 0,
        default_value: 0.0,
        hard_min: f64::NEG_INFINITY,
        hard_max: f64::INFINITY,
        advised_min: f64::NEG_INFINITY,
        advised_max: f64::INFINITY,
        choices: ptr::null(),
    }
}

/// The parameters, and whether the first of them is their count.
fn parameters(sidecar: &Sidecar) -> (Vec<lahar_parameter_desc>, bool) {
    let numbered = |i: usize, required: i32| lahar_parameter_desc {
        required,
        ..parameter(&format!("prop_{i}"), &format!("PROPS({i})"), "-", "value of PROPS")
    };
    match &sidecar.parameters {
        None => {
            let most = USUAL_PARAMETERS as f64;
            let count = lahar_parameter_desc {
                kind: LAHAR_PARAMETER_INTEGER,
                required: 1,
                default_value: most,
                hard_min: 0.0,
                hard_max: most,
                ..parameter("nprops", "NPROPS", "-", "number of values of PROPS")
            };
            let values = (1..=USUAL_PARAMETERS).map(|i| numbered(i, 0));
            (std::iter::once(count).chain(values).collect(), true)
        }
        Some(CountOrList::Count(n)) => ((1..=*n).map(|i| numbered(i, 1)).collect(), false),
        Some(CountOrList::List(list)) => (list.iter().map(described).collect(), false),
    }
}

fn described(p: &sidecar::Parameter) -> lahar_parameter_desc {
    let [hard_min, hard_max, advised_min, advised_max] = p.bounds();
    let value = p.default.or(p.typical);
    let usual = |text: &Option<String>, other: &str| text.clone().unwrap_or(other.into());
    lahar_parameter_desc {
        required: i32::from(p.default.is_none()),
        default_value: value.unwrap_or(0.0f64.clamp(hard_min, hard_max)),
        hard_min,
        hard_max,
        advised_min,
        advised_max,
        ..parameter(
            &p.key,
            &usual(&p.symbol, &p.key),
            &usual(&p.unit, "-"),
            &usual(&p.description, "parameter of the user's routine"),
        )
    }
}

/// The table of state variables as it grows.
#[derive(Default)]
struct States {
    table: Vec<lahar_state_desc>,
    places: Vec<Place>,
    initial: Vec<f64>,
}

impl States {
    /// Adds a variable; returns its first component.
    fn push(
        &mut self,
        key: &str,
        unit: &str,
        description: &str,
        kind: i32,
        rotation: i32,
    ) -> usize {
        let first = self.initial.len();
        let count = match kind {
            LAHAR_STATE_SCALAR => 1,
            LAHAR_STATE_VECTOR => 3,
            LAHAR_STATE_SYMMETRIC => 6,
            _ => 9,
        };
        self.initial.resize(first + count, 0.0);
        let (key, unit, description) = (text(key), text(unit), text(description));
        self.table.push(lahar_state_desc { key, unit, description, kind, rotation, initial: 0.0 });
        first
    }

    /// The variables of the routine, and where each `STATEV` stands.
    fn of_routine(&mut self, sidecar: &Sidecar, routine: Routine) {
        let list = match &sidecar.states {
            Some(CountOrList::List(list)) => list,
            count => {
                let n = if let Some(CountOrList::Count(n)) = count { *n } else { USUAL_STATES };
                for i in 1..=n {
                    let at = self.push(&format!("statev_{i}"), "-", "value of STATEV", 0, 0);
                    self.places.push(Place { component: at, factor: 1.0, inverse: 1.0 });
                }
                return;
            }
        };
        let ntens = sidecar.ntens.unwrap_or(6) as usize;
        for state in list {
            let (kind, count) = match state.kind {
                Kind::Scalar => (LAHAR_STATE_SCALAR, 1),
                Kind::Vector => (LAHAR_STATE_VECTOR, 3),
                Kind::Symmetric => (LAHAR_STATE_SYMMETRIC, ntens),
                Kind::Tensor => (LAHAR_STATE_TENSOR, 9),
            };
            let rotation = i32::from(state.rotation == sidecar::Rotation::Objective);
            let (unit, description) = (state.unit.as_deref(), state.description.as_deref());
            let description = description.unwrap_or("state variable of the user's routine");
            let first = self.push(&state.key, unit.unwrap_or("-"), description, kind, rotation);
            self.initial[first..].fill(state.initial);
            if let Some(last) = self.table.last_mut() {
                last.initial = state.initial;
            }
            for c in 0..count {
                let at = match (state.kind, routine) {
                    (Kind::Symmetric, Routine::Umat) => ORDER[c],
                    (Kind::Tensor, _) => 3 * (c % 3) + c / 3,
                    _ => c,
                };
                let engineering = state.shear == Shear::Engineering && c >= 3;
                let factor = if engineering { 2.0 } else { 1.0 };
                self.places.push(Place { component: first + at, factor, inverse: 1.0 / factor });
            }
        }
    }

    /// Adds the adapter's own variables.
    fn adapted(
        &mut self,
        sidecar: &Sidecar,
        library: UserLibrary,
        name: &str,
        (parameters, counted): (&[lahar_parameter_desc], bool),
    ) -> Result<Adapted, String> {
        let vumat = library.routine == Routine::Vumat;
        let used = |c: &usize| self.places.iter().any(|place| place.component == *c);
        let unused = (0..self.initial.len()).filter(|c| !used(c)).collect();
        if vumat && self.table.iter().any(|s| s.rotation != LAHAR_ROTATION_NONE) {
            return Err(
                "the sidecar makes a state variable objective, but tensors of a VUMAT are \
                        components along axes that turn with the material; take `rotation` out"
                    .into(),
            );
        }
        let objective = LAHAR_ROTATION_OBJECTIVE;
        let [strain, gradient, energies @ ..] = OWN_STATES;
        let total_strain = match vumat {
            true => 0,
            false => self.push(strain, "-", "STRAN", LAHAR_STATE_SYMMETRIC, objective),
        };
        let displacement_gradient =
            self.push(gradient, "-", "F - I", LAHAR_STATE_TENSOR, LAHAR_ROTATION_NONE);
        let energies = sidecar.energy.then(|| {
            let texts = ["elastic energy", "plastic dissipation", "dissipation by creep"];
            let unit = if vumat { "J/kg" } else { "J/m^3" };
            let all =
                energies.iter().zip(texts).map(|(key, text)| self.push(key, unit, text, 0, 0));
            all.fold(usize::MAX, usize::min)
        });
        let mut cmname = [b' '; 80];
        let upper = sidecar.cmname.clone().unwrap_or_else(|| name.to_ascii_uppercase());
        let length = upper.len().min(80);
        cmname[..length].copy_from_slice(&upper.as_bytes()[..length]);
        let inputs = inputs(sidecar, library.routine);
        let at = |field: &Field| inputs.iter().position(|i| *i == input(*field)).unwrap_or(0);
        Ok(Adapted {
            cmname,
            ntens: sidecar.ntens.unwrap_or(6) as usize,
            hidden_length: sidecar.hidden_length,
            floor: floor(sidecar)?,
            parameter_count: parameters.len(),
            counted,
            initial: self.places.iter().map(|p| p.factor * self.initial[p.component]).collect(),
            states: std::mem::take(&mut self.places),
            unused,
            components: self.initial.len(),
            total_strain,
            displacement_gradient,
            energies,
            inputs: inputs.len(),
            predef: sidecar.predef.iter().map(at).collect(),
            library,
        })
    }
}

fn floor(sidecar: &Sidecar) -> Result<Option<Floor>, String> {
    let key = match &sidecar.modulus {
        None => return Ok(None),
        Some(Modulus::Value(value)) => return Ok(Some(Floor::Value(*value))),
        Some(Modulus::Parameter(key)) => key,
    };
    let Some(CountOrList::List(list)) = &sidecar.parameters else {
        return Err(format!("`modulus` names the parameter `{key}`, but the sidecar names none"));
    };
    if let Some(at) = list.iter().position(|p| p.key == *key) {
        return Ok(Some(Floor::Parameter(at)));
    }
    let close = |p: &&sidecar::Parameter| strsim::jaro_winkler(&p.key, key);
    let nearest = list.iter().max_by(|a, b| close(a).total_cmp(&close(b)));
    let advice = nearest.map(|p| format!("; did you mean `{}`?", p.key)).unwrap_or_default();
    Err(format!("`modulus` names the parameter `{key}`, which the sidecar does not have{advice}"))
}

fn input(field: Field) -> i32 {
    match field {
        Field::Density => LAHAR_INPUT_DENSITY,
        Field::Temperature => LAHAR_INPUT_TEMPERATURE,
        Field::InternalEnergy => LAHAR_INPUT_INTERNAL_ENERGY,
        Field::PorePressure => LAHAR_INPUT_PORE_PRESSURE,
    }
}

fn inputs(sidecar: &Sidecar, routine: Routine) -> Vec<i32> {
    let mut all = vec![
        LAHAR_INPUT_DENSITY,
        LAHAR_INPUT_ELEMENT_LENGTH,
        LAHAR_INPUT_TEMPERATURE,
        LAHAR_INPUT_POSITION_X,
        LAHAR_INPUT_POSITION_Y,
        LAHAR_INPUT_POSITION_Z,
        LAHAR_INPUT_PARTICLE_ID,
    ];
    let energy = (routine == Routine::Vumat).then_some(LAHAR_INPUT_INTERNAL_ENERGY);
    for one in energy.into_iter().chain(sidecar.predef.iter().map(|f| input(*f))) {
        if !all.contains(&one) {
            all.push(one);
        }
    }
    all
}

fn model(
    sidecar: &Sidecar,
    name: &str,
    adapted: &Adapted,
    parameters: Vec<lahar_parameter_desc>,
    states: Vec<lahar_state_desc>,
) -> &'static lahar_model_desc {
    let routine = adapted.library.routine;
    let usual = format!("The {routine:?} of {}", adapted.library.path().display());
    let given = |text: &Option<String>, other: &str| text.clone().unwrap_or(other.into());
    let inputs = inputs(sidecar, routine);
    let energy = if sidecar.energy { LAHAR_OUTPUT_ENERGY } else { 0 };
    let factor = if routine == Routine::Umat { LAHAR_OUTPUT_DT_FACTOR } else { 0 };
    // A routine that keeps nothing between calls has points that do not know of each other.
    let threads = match sidecar.threads {
        Threads::Serial => 0,
        Threads::Copies => LAHAR_CAPABILITY_THREAD_SAFE,
        Threads::Safe => {
            LAHAR_CAPABILITY_THREAD_SAFE
                | LAHAR_CAPABILITY_POINTWISE
                | LAHAR_CAPABILITY_DETERMINISTIC
        }
    };
    let has_sdvini = adapted.library.has_sdvini();
    Box::leak(Box::new(lahar_model_desc {
        struct_size: size_of::<lahar_model_desc>() as u32,
        kinematics: LAHAR_KINEMATICS_VELOCITY_GRADIENT,
        name: text(name),
        summary: text(&given(&sidecar.summary, &usual)),
        reference: text(&given(&sidecar.reference, "not told by the library")),
        parameter_count: parameters.len() as u32,
        parameter_size: size_of::<lahar_parameter_desc>() as u32,
        parameters: leak(parameters),
        state_count: states.len() as u32,
        state_size: size_of::<lahar_state_desc>() as u32,
        states: leak(states),
        input_count: inputs.len() as u32,
        required_minor: 0,
        inputs: leak(inputs),
        outputs: LAHAR_OUTPUT_WAVE_SPEED | LAHAR_OUTPUT_STATUS | factor | energy,
        capabilities: LAHAR_CAPABILITY_MAY_STOP | LAHAR_CAPABILITY_MAY_PRINT | threads,
        create: Some(calls::create),
        destroy: Some(calls::destroy),
        check: None,
        init_state: has_sdvini.then_some(calls::init_state),
        update: Some(calls::update),
        wave_speed: Some(calls::wave_speed),
        get_extension: None,
    }))
}

fn plugin(
    sidecar: &Sidecar,
    name: &str,
    model: &'static lahar_model_desc,
) -> &'static lahar_plugin_desc {
    let models: &[*const lahar_model_desc] = vec![ptr::from_ref(model)].leak();
    Box::leak(Box::new(lahar_plugin_desc {
        struct_size: size_of::<lahar_plugin_desc>() as u32,
        abi_major: LAHAR_PLUGIN_ABI_MAJOR,
        abi_minor: LAHAR_PLUGIN_ABI_MINOR,
        model_count: 1,
        id: text(&format!("umat.{name}")),
        version: text(concat!("adapter ", env!("CARGO_PKG_VERSION"))),
        author: text(sidecar.author.as_deref().unwrap_or("not told by the library")),
        licence: text(sidecar.licence.as_deref().unwrap_or("LicenseRef-unknown")),
        url: text(""),
        models: models.as_ptr(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_named_after_its_file() {
        for (path, name) in [
            ("/a/libmy_umat.so", "my_umat"),
            ("soil.so.2", "soil"),
            ("/x/lib3d-clay.so", "umat_3d_clay"),
            ("lib.so", "lib"),
        ] {
            assert_eq!(name_of(Path::new(path)), name);
        }
    }
}

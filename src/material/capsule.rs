//! Failure capsules: the call of a model at one point, written to a small JSON file and run again
//! alone.
//!
//! Numbers are written with all their digits; those that are not finite are the texts `NaN`, `inf`
//! and `-inf`. Points, parameters, inputs and state variables go by their names.

use super::{Kinematics, Material, Model, StressBatch};
use crate::context::Context;
use crate::error::{Error, Result, Status};
use crate::material::scratch::{Scratch, with_scratch};
use crate::memory::ensure;
use lahar_plugin_abi::LAHAR_POINT_FAILED;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::fmt;
use std::fs::OpenOptions;
use std::io::{BufWriter, ErrorKind, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

/// Version of the format.
const FORMAT: u32 = 1;

/// Bytes that a parameter, an input or a state variable takes in a capsule, beside its components.
const BYTES_OF_NAME: usize = 256;

/// Files of one name in a folder, beyond which no more are written.
const COPIES: usize = 1000;

/// A number; equal to another if all bits are, or if neither is a number.
#[derive(Clone, Copy, Debug)]
pub struct Number(pub f64);

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits() || self.0.is_nan() && other.0.is_nan()
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self.0 {
            value if value.is_finite() => serializer.serialize_f64(value),
            value => serializer.serialize_str(&value.to_string()),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged, expecting = "expected a number, or one of the texts NaN, inf and -inf")]
        enum Raw {
            Number(f64),
            Text(Text),
        }
        #[derive(Deserialize)]
        enum Text {
            #[serde(rename = "NaN")]
            Nan,
            #[serde(rename = "inf")]
            Infinity,
            #[serde(rename = "-inf")]
            MinusInfinity,
        }
        Ok(Self(match Raw::deserialize(deserializer)? {
            Raw::Number(value) => value,
            Raw::Text(Text::Nan) => f64::NAN,
            Raw::Text(Text::Infinity) => f64::INFINITY,
            Raw::Text(Text::MinusInfinity) => f64::NEG_INFINITY,
        }))
    }
}

/// Values by name, in the order in which the model declares them.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T>(pub Vec<(String, T)>);

impl<T> Named<T> {
    /// The value of this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// The values of all `names`, in their order. Errors: a name that is not among them, one that
    /// is missing.
    fn values<'a>(
        &self,
        what: &str,
        names: impl Iterator<Item = &'a str> + Clone,
    ) -> Result<Vec<&T>> {
        for (name, _) in &self.0 {
            if !names.clone().any(|known| known == name) {
                return Err(Error::unknown_name(what, name, names));
            }
        }
        names
            .map(|name| {
                self.get(name).ok_or_else(|| {
                    let text = format!(
                        "the capsule lacks the {what} `{name}`; a capsule that lahar writes has all"
                    );
                    Error::new(Status::MissingParameter, text)
                })
            })
            .collect()
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Pairs<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Pairs<T> {
            type Value = Named<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("values by name")
            }
            fn visit_map<A: MapAccess<'de>>(
                self,
                mut map: A,
            ) -> std::result::Result<Named<T>, A::Error> {
                let mut pairs: Vec<(String, T)> = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, T>()? {
                    if pairs.iter().any(|(known, _)| *known == name) {
                        return Err(serde::de::Error::custom(format!("`{name}` is given twice")));
                    }
                    pairs.push((name, value));
                }
                Ok(Named(pairs))
            }
        }
        deserializer.deserialize_map(Pairs(PhantomData))
    }
}

/// What a model was asked at a point that failed, and what it answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Capsule {
    /// Version of the format.
    pub lahar_capsule: u32,
    /// Name of the model.
    pub model: String,
    /// Id of its plugin.
    pub plugin: String,
    /// Version of the plugin.
    pub plugin_version: String,
    /// Its file; of a plugin that is linked into the host the id in brackets.
    pub plugin_path: String,
    /// Id of the body.
    pub body: i64,
    /// Id of the particle inside its body.
    pub particle: i64,
    /// Number of steps before the one that failed.
    pub step: i64,
    /// Time at the start of the step [s].
    pub time: Number,
    /// Length of the step [s].
    pub dt: Number,
    /// Every parameter.
    pub parameters: Named<Number>,
    /// What the model takes: `strain_increment` [-] (6), `velocity_gradient` [1/s] (9) or
    /// `deformation_gradient` [-] (9).
    pub kinematics: Named<Vec<Number>>,
    /// The inputs that the model wants.
    pub inputs: Named<Number>,
    /// Stress at the start, rotated as the model gets it [Pa]: xx, yy, zz, xy, yz, zx.
    pub stress0: Vec<Number>,
    /// Components of each state variable at the start.
    pub state0: Named<Vec<Number>>,
    /// The answer.
    pub end: End,
}

/// What a model answers at a point. At a point that failed, stress, state and outputs are what
/// happened to be left there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// One of `LAHAR_POINT_*`.
    pub status: i32,
    /// Stress at the end [Pa].
    pub stress1: Vec<Number>,
    /// Components of each state variable at the end.
    pub state1: Named<Vec<Number>>,
    /// The declared outputs: `wave_speed` [m/s], `diffusivity` [m^2/s], `energy` [J/m^3],
    /// `dt_factor` [-].
    pub outputs: Named<Number>,
}

impl End {
    fn of_point(model: &Model, s: &Scratch<'_>, k: usize) -> Self {
        let outputs: [(&str, &[f64]); 4] = [
            ("wave_speed", &*s.wave_speed),
            ("diffusivity", &*s.diffusivity),
            ("energy", &*s.energy),
            ("dt_factor", &*s.dt_factor),
        ];
        let given = outputs
            .iter()
            .filter_map(|(name, values)| Some((name.to_string(), Number(*values.get(k)?))));
        Self {
            status: s.status[k],
            stress1: components(s.stress1, s.stride, k),
            state1: states(model, s.state1, s.stride, k),
            outputs: Named(given.collect()),
        }
    }

    /// Whether both are the same answer: the same failure, or the same numbers bit for bit.
    fn is(&self, other: &Self) -> bool {
        self.status == other.status && (self.status >= LAHAR_POINT_FAILED || self == other)
    }
}

/// The result of a point that was run again.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The answer.
    pub end: End,
    /// Whether it is that of the capsule: the same failure, or the same numbers bit for bit.
    pub reproduced: bool,
    /// Id and version of the plugin that answered.
    pub plugin: [String; 2],
}

/// Where and when a model was called.
#[derive(Clone, Copy, Debug)]
pub struct Occasion {
    /// Id of the body.
    pub body: i64,
    /// Id of the particle inside its body.
    pub particle: i64,
    /// Number of steps before this one.
    pub step: i64,
    /// Time at the start of the step [s].
    pub time: f64,
    /// Length of the step [s].
    pub dt: f64,
}

impl Capsule {
    /// The call at point `k` of a chunk, after it. Version and path of the plugin stay empty.
    /// Error: [`Status::OutOfMemory`].
    pub fn of_point(
        material: &Material,
        s: &Scratch<'_>,
        k: usize,
        occasion: Occasion,
    ) -> Result<Self> {
        let model = material.model();
        let names = model.parameters.len() + model.inputs.len() + 2 * model.states.len();
        let bytes = BYTES_OF_NAME * names + 32 * model.state_components();
        ensure(bytes, "a failure capsule")?;
        let parameters = model.parameters.iter().zip(&material.values);
        let inputs = model.inputs.iter().zip(components(s.inputs, s.stride, k));
        let name = kinematics_of(model);
        let taken = match name {
            "strain_increment" => &*s.strain_increment,
            "velocity_gradient" => &*s.velocity_gradient,
            _ => &*s.deformation_gradient,
        };
        Ok(Self {
            lahar_capsule: FORMAT,
            model: model.name.into(),
            plugin: model.plugin_id.into(),
            plugin_version: String::new(),
            plugin_path: String::new(),
            body: occasion.body,
            particle: occasion.particle,
            step: occasion.step,
            time: Number(occasion.time),
            dt: Number(occasion.dt),
            parameters: Named(parameters.map(|(p, v)| (p.key.into(), Number(*v))).collect()),
            kinematics: Named(vec![(name.into(), components(taken, s.stride, k))]),
            inputs: Named(inputs.map(|(input, v)| (input.key().into(), v)).collect()),
            stress0: components(s.stress0, s.stride, k),
            state0: states(model, s.state0, s.stride, k),
            end: End::of_point(model, s, k),
        })
    }

    /// Writes the capsule into a folder as `lahar-capsule-<model>-<body>-<particle>-<step>.json`,
    /// or with `-2`, `-3`, ... before the ending where there are such files, and gives its path.
    /// Error: [`Status::File`].
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        let Self { model, body, particle, step, .. } = self;
        let stem = format!("lahar-capsule-{model}-{body}-{particle}-{step}");
        let failed = |path: &Path, why: &dyn fmt::Display| {
            let text = format!("the failure capsule {} can not be written: {why}", path.display());
            Error::new(Status::File, text)
        };
        for copy in 1..=COPIES {
            let number = if copy == 1 { String::new() } else { format!("-{copy}") };
            let path = folder.join(format!("{stem}{number}.json"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    let mut file = BufWriter::new(file);
                    let written = serde_json::to_writer_pretty(&mut file, self);
                    let written = written.map_err(std::io::Error::from);
                    let written = written.and_then(|()| writeln!(file)).and_then(|()| file.flush());
                    return written.map_err(|why| failed(&path, &why)).map(|()| path);
                }
                Err(why) if why.kind() == ErrorKind::AlreadyExists => {}
                Err(why) => return Err(failed(&path, &why)),
            }
        }
        Err(failed(&folder.join(stem), &format!("there are {COPIES} of this name already")))
    }

    /// Reads a capsule.
    ///
    /// Errors: [`Status::File`] if there is none, [`Status::InvalidArgument`] if it is not one or
    /// not whole, [`Status::UnknownName`] for a key that a capsule does not have.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|why| {
            let text = format!("the failure capsule {} can not be read: {why}", path.display());
            Error::new(Status::File, text)
        })?;
        let broken = |why: serde_json::Error| {
            let path = path.display();
            Error::invalid(format!("{path} is not a failure capsule, or not a whole one: {why}"))
        };
        let capsule: Self = serde_json::from_str(&text).map_err(broken)?;
        // What was understood, written again, has every key that a capsule has.
        let known = serde_json::to_value(&capsule).map_err(broken)?;
        check_keys(&serde_json::from_str(&text).map_err(broken)?, &known)?;
        if capsule.lahar_capsule != FORMAT {
            return Err(Error::new(
                Status::Unsupported,
                format!(
                    "{} has the format {}, this library reads {FORMAT}: use the version of lahar that wrote it",
                    path.display(),
                    capsule.lahar_capsule
                ),
            ));
        }
        Ok(capsule)
    }

    /// Runs the point again, alone, with the model of this name in the context.
    ///
    /// Errors: [`Status::UnknownName`] (model, parameter, input or state variable, with the closest
    /// name), [`Status::MissingParameter`] (one is missing), [`Status::InvalidArgument`] (a wrong
    /// number of components), and those of [`Material::new`] and [`Material::update`].
    pub fn replay(&self, context: &Context) -> Result<Replay> {
        let model = context.model(&self.model).map_err(|mut error| {
            let plugin =
                format!("; the capsule is of the plugin {} {}", self.plugin, self.plugin_version);
            error.message.push_str(&plugin);
            error.message.push_str(": load it first");
            error
        })?;
        let keys = model.parameters.iter().map(|p| p.key);
        let values = self.parameters.values(&format!("parameter of `{}`", model.name), keys)?;
        let named: Vec<(&str, f64)> =
            model.parameters.iter().zip(values).map(|(p, v)| (p.key, v.0)).collect();
        let material = Material::new(context, model.name, &named)?;
        let end = with_scratch(&material, 1, |s| {
            self.fill(model, s)?;
            let (dt, time, step) = (self.dt.0, self.time.0, self.step);
            material.update(&mut StressBatch { dt, time, step, ..s.batch() })?;
            Ok(End::of_point(model, s, 0))
        })?;
        let version = context.plugin_of(model).map_or("", |plugin| plugin.version);
        Ok(Replay {
            reproduced: end.is(&self.end),
            end,
            plugin: [model.plugin_id, version].map(str::to_string),
        })
    }

    /// Puts the start into the scratch of one point.
    fn fill(&self, model: &Model, s: &mut Scratch<'_>) -> Result<()> {
        let stride = s.stride;
        let of = |what: &str| format!("{what} of `{}`", model.name);
        let name = kinematics_of(model);
        let taken = self.kinematics.values(&of("kinematics"), [name].into_iter())?[0];
        match name {
            "strain_increment" => put(name, taken, 6, s.strain_increment, stride),
            "velocity_gradient" => put(name, taken, 9, s.velocity_gradient, stride),
            _ => put(name, taken, 9, s.deformation_gradient, stride),
        }?;
        put("stress0", &self.stress0, 6, s.stress0, stride)?;
        let keys = model.inputs.iter().map(|input| input.key());
        for (i, value) in self.inputs.values(&of("input"), keys)?.into_iter().enumerate() {
            s.inputs[i * stride] = value.0;
        }
        let keys = model.states.iter().map(|state| state.key);
        let values = self.state0.values(&of("state variable"), keys)?;
        let mut first = 0;
        for (state, values) in model.states.iter().zip(values) {
            put(state.key, values, state.components(), &mut s.state0[first * stride..], stride)?;
            first += state.components();
        }
        Ok(())
    }
}

fn kinematics_of(model: &Model) -> &'static str {
    match model.kinematics {
        Kinematics::StrainIncrement | Kinematics::GreenNaghdi => "strain_increment",
        Kinematics::VelocityGradient => "velocity_gradient",
        Kinematics::DeformationGradient => "deformation_gradient",
    }
}

/// All components of point `k`.
fn components(data: &[f64], stride: usize, k: usize) -> Vec<Number> {
    data.chunks(stride).map(|row| Number(row[k])).collect()
}

fn states(model: &Model, data: &[f64], stride: usize, k: usize) -> Named<Vec<Number>> {
    let mut all = components(data, stride, k).into_iter();
    let states = model.states.iter();
    Named(states.map(|s| (s.key.into(), all.by_ref().take(s.components()).collect())).collect())
}

/// Writes the components of the first point.
fn put(name: &str, values: &[Number], wanted: usize, to: &mut [f64], stride: usize) -> Result<()> {
    if values.len() != wanted {
        let got = values.len();
        let text = format!("`{name}` of the capsule has {got} components; expected {wanted}");
        return Err(Error::invalid(text));
    }
    for (c, value) in values.iter().enumerate() {
        to[c * stride] = value.0;
    }
    Ok(())
}

/// Refuses a key that is not known, at any depth.
fn check_keys(given: &Value, known: &Value) -> Result<()> {
    let (Value::Object(given), Value::Object(known)) = (given, known) else { return Ok(()) };
    for (key, value) in given {
        let Some(known) = known.get(key) else {
            let names = known.keys().map(String::as_str);
            return Err(Error::unknown_name("key of a failure capsule", key, names));
        };
        check_keys(value, known)?;
    }
    Ok(())
}

//! The sidecar file: what the library of a UMAT does not contain. That of `libmodel.so` is
//! `libmodel.json` in the same folder.

use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// Parameters and state variables that a library without a sidecar gets.
pub const USUAL_PARAMETERS: usize = 40;
pub const USUAL_STATES: usize = 20;
const MOST: usize = 1000;

/// The file, as it is written.
#[derive(serde::Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub struct Sidecar {
    /// Name of the model; without it that of the file.
    pub model: Option<String>,
    pub summary: Option<String>,
    pub reference: Option<String>,
    pub author: Option<String>,
    pub licence: Option<String>,
    /// `CMNAME`; without it the name of the model in capitals.
    pub cmname: Option<String>,
    pub routine: Option<Routine>,
    pub parameters: Option<CountOrList<Parameter>>,
    pub states: Option<CountOrList<State>>,
    pub ntens: Option<u32>,
    pub threads: Threads,
    pub hidden_length: HiddenLength,
    pub modulus: Option<Modulus>,
    /// Whether SSE, SPD and SCD are kept, and SSE given to the engine.
    pub energy: bool,
    /// What stands in `PREDEF`.
    pub predef: Vec<Field>,
}

/// Which routine of the library.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
pub enum Routine {
    Umat,
    Vumat,
}

/// From which threads the routine may be called.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub enum Threads {
    /// One call at a time.
    #[default]
    Serial,
    /// Each thread has a copy of the library, with `SAVE` variables and `COMMON` blocks of its own.
    Copies,
    /// The routine keeps nothing between calls: any threads at once.
    Safe,
}

/// How the length of `CMNAME` is passed behind the last argument.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub enum HiddenLength {
    /// As gfortran since 8 and ifx do.
    #[default]
    #[serde(rename = "size_t")]
    SizeT,
    Int,
    /// Routines in C.
    None,
}

/// A value of the engine that can stand in `PREDEF`.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    Density,
    Temperature,
    InternalEnergy,
    PorePressure,
}

/// A modulus [Pa]: a number, or the key of a parameter.
#[derive(serde::Deserialize, Debug)]
#[serde(untagged)]
pub enum Modulus {
    Value(f64),
    Parameter(String),
}

/// One of `PROPS`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    pub key: String,
    pub symbol: Option<String>,
    pub unit: Option<String>,
    pub description: Option<String>,
    /// Value if the host gives none; without it the host must.
    pub default: Option<f64>,
    /// A value with which tools may try the model.
    pub typical: Option<f64>,
    #[serde(default)]
    pub hard: [Option<f64>; 2],
    #[serde(default)]
    pub advised: [Option<f64>; 2],
}

/// One or more of `STATEV`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    pub key: String,
    pub unit: Option<String>,
    pub description: Option<String>,
    #[serde(default)]
    pub kind: Kind,
    #[serde(default)]
    pub rotation: Rotation,
    #[serde(default)]
    pub shear: Shear,
    #[serde(default)]
    pub initial: f64,
}

/// Shape of a state variable.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    #[default]
    Scalar,
    Vector,
    /// `NTENS` values in Abaqus' order.
    Symmetric,
    /// Nine values, column by column as Fortran stores them.
    Tensor,
}

/// Whether the engine turns it with the material.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub enum Rotation {
    #[default]
    None,
    Objective,
}

/// How the routine stores shears of a symmetric tensor.
#[derive(serde::Deserialize, Clone, Copy, PartialEq, Eq, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub enum Shear {
    #[default]
    Tensor,
    Engineering,
}

/// `5`, or a list with a name for each.
pub enum CountOrList<T> {
    Count(usize),
    List(Vec<T>),
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for CountOrList<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = CountOrList<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a count up to {MOST} or a list of objects")
            }

            fn visit_u64<E: serde::de::Error>(self, count: u64) -> Result<Self::Value, E> {
                let sane = usize::try_from(count).ok().filter(|count| *count <= MOST);
                sane.map(CountOrList::Count)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Unsigned(count), &self))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut all = Vec::new();
                while let Some(one) = list.next_element()? {
                    all.push(one);
                }
                Ok(CountOrList::List(all))
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

/// Reads the sidecar of the library at `path`; None if there is none.
pub fn read(path: &Path) -> Result<Option<Sidecar>, String> {
    let file = path.with_extension("json");
    match std::fs::read_to_string(&file) {
        Ok(text) => parse(&text).map(Some).map_err(|e| format!("sidecar {}: {e}", file.display())),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(format!("sidecar {} cannot be read: {e}", file.display())),
    }
}

fn parse(text: &str) -> Result<Sidecar, String> {
    let sidecar: Sidecar = serde_json::from_str(text).map_err(|e| {
        let text = e.to_string();
        let nearest = nearest(&text).map(|n| format!("; did you mean `{n}`?"));
        format!("{text}{}", nearest.unwrap_or_default())
    })?;
    sidecar.check()?;
    Ok(sidecar)
}

/// Of "unknown field `x`, expected one of `a`, `b`": whichever of a and b is nearest to x.
fn nearest(message: &str) -> Option<String> {
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let mut quoted = message.split('`').skip(1).step_by(2);
    let received = quoted.next().filter(|_| unknown)?;
    let close = |candidate: &&str| strsim::jaro_winkler(received, candidate);
    let best = quoted.max_by(|a, b| close(a).total_cmp(&close(b)))?;
    (close(&best) > 0.8).then(|| best.to_string())
}

impl Sidecar {
    fn check(&self) -> Result<(), String> {
        if let Some(name) = &self.model {
            identifier("model", name)?;
        }
        if !matches!(self.ntens, None | Some(4 | 6)) {
            let ntens = self.ntens.unwrap_or(0);
            return Err(format!("expected 4 (plane strain) or 6 for `ntens`, got {ntens}"));
        }
        if let Some(name) = self.cmname.as_ref().filter(|n| n.len() > 80 || !n.is_ascii()) {
            return Err(format!("expected up to 80 ASCII characters for `cmname`, got `{name}`"));
        }
        if let Some(CountOrList::List(list)) = &self.parameters {
            unique("parameters", list.iter().map(|p| p.key.as_str()))?;
            list.iter().try_for_each(Parameter::check)?;
        }
        if let Some(CountOrList::List(list)) = &self.states {
            unique("states", list.iter().map(|s| s.key.as_str()))?;
            list.iter().try_for_each(State::check)?;
        }
        match &self.modulus {
            Some(Modulus::Value(m)) if !(*m > 0.0 && m.is_finite()) => {
                Err(format!("expected a positive `modulus` [Pa], got {m}"))
            }
            _ => Ok(()),
        }
    }
}

impl Parameter {
    /// Hard bounds, then advised bounds; infinite where the file gives none.
    pub fn bounds(&self) -> [f64; 4] {
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let ([a, b], [c, d]) = (self.hard, self.advised);
        [a.unwrap_or(low), b.unwrap_or(high), c.unwrap_or(low), d.unwrap_or(high)]
    }

    fn check(&self) -> Result<(), String> {
        identifier("key", &self.key)?;
        let key = &self.key;
        if self.default.is_some() && self.typical.is_some() {
            return Err(format!(
                "parameter `{key}` has a `default` and a `typical` value; keep `default` if hosts may leave it out, \
                 else `typical`"
            ));
        }
        let [low, high, advised_low, advised_high] = self.bounds();
        if low > high || advised_low > advised_high {
            return Err(format!("parameter `{key}`: a lower bound is above the upper one"));
        }
        for value in [self.default, self.typical].into_iter().flatten() {
            if !(low..=high).contains(&value) {
                return Err(format!(
                    "parameter `{key}`: expected a value inside the hard bounds {low} to {high}, got {value}"
                ));
            }
        }
        Ok(())
    }
}

impl State {
    fn check(&self) -> Result<(), String> {
        identifier("key", &self.key)?;
        let key = &self.key;
        if super::describe::OWN_STATES.contains(&key.as_str()) {
            return Err(format!(
                "state `{key}`: the adapter keeps a variable of this name; call yours otherwise"
            ));
        }
        if self.kind == Kind::Scalar && self.rotation == Rotation::Objective {
            return Err(format!("state `{key}`: a scalar does not turn; give its `kind`"));
        }
        if self.kind != Kind::Symmetric && self.shear == Shear::Engineering {
            return Err(format!("state `{key}`: only a symmetric tensor has engineering shears"));
        }
        Ok(())
    }
}

fn identifier(field: &str, name: &str) -> Result<(), String> {
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(letters) {
        return Ok(());
    }
    Err(format!(
        "expected ASCII letters, digits and `_`, a letter first, for `{field}`, got `{name}`"
    ))
}

fn unique<'a>(what: &str, keys: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut seen = std::collections::HashSet::new();
    for key in keys {
        if !seen.insert(key) {
            return Err(format!("two of `{what}` have the key `{key}`"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        parse(text).err().unwrap_or_else(|| panic!("accepted: {text}"))
    }

    #[test]
    fn an_unknown_key_is_an_error_with_line_and_nearest_key() {
        let text = error("{\n \"parameters\": 2,\n \"sates\": 3}");
        assert!(text.contains("unknown field `sates`"), "{text}");
        assert!(text.contains("did you mean `states`?") && text.contains("line 3"), "{text}");
        let text = error("{\"parameters\": [{\"key\": \"E\", \"units\": \"Pa\"}]}");
        assert!(text.contains("did you mean `unit`?"), "{text}");
        let text = error("{\"threads\": \"copy\"}");
        assert!(text.contains("did you mean `copies`?"), "{text}");
        assert!(!error("{\"zzz\": 1}").contains("did you mean"));
    }

    #[test]
    fn the_example_of_the_manual_is_a_sidecar() {
        let manual = include_str!("../README.md");
        let (_, rest) = manual.split_once("```json\n").expect("an example");
        let (example, _) = rest.split_once("```").expect("its end");
        let sidecar = parse(example).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(sidecar.model.as_deref(), Some("my_soil"));
        let Some(CountOrList::List(states)) = sidecar.states else { panic!("no list of states") };
        assert_eq!((states[1].kind, states[1].rotation), (Kind::Symmetric, Rotation::Objective));
        // Every key has its row.
        let message = error("{\"zzz\": 1}");
        for key in message.split('`').skip(3).step_by(2) {
            assert!(manual.contains(&format!("`{key}`")), "the manual lacks `{key}`");
        }
    }

    #[test]
    fn bad_json_tells_the_line() {
        let text = error("{\n \"states\": 3,\n");
        assert!(text.contains("line 3"), "{text}");
        let text = error("{\"states\": \"many\"}");
        assert!(text.contains("expected a count up to 1000 or a list of objects"), "{text}");
    }

    #[test]
    fn values_that_make_no_sense_are_refused_with_the_key() {
        for (text, expected) in [
            (r#"{"ntens": 3}"#, "expected 4 (plane strain) or 6"),
            (r#"{"model": "my soil"}"#, "for `model`, got `my soil`"),
            (r#"{"modulus": -1}"#, "expected a positive `modulus`"),
            (r#"{"states": [{"key": "a"}, {"key": "a"}]}"#, "two of `states` have the key `a`"),
            (r#"{"states": [{"key": "total_strain"}]}"#, "the adapter keeps a variable"),
            (r#"{"states": [{"key": "a", "rotation": "objective"}]}"#, "a scalar does not turn"),
            (r#"{"states": [{"key": "a", "shear": "engineering"}]}"#, "only a symmetric tensor"),
            (
                r#"{"parameters": [{"key": "a", "default": 2, "hard": [3, null]}]}"#,
                "inside the hard",
            ),
            (r#"{"parameters": [{"key": "a", "default": 2, "typical": 2}]}"#, "keep `default`"),
            (r#"{"parameters": [{"key": "a", "hard": [3, 2]}]}"#, "a lower bound is above"),
        ] {
            assert!(error(text).contains(expected), "{text}: {}", error(text));
        }
    }
}

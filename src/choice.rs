//! Choices: what an option, or the kind of a thing, can be. Each choice is one list.
//!
//! The macro `choices!` makes an enum of a list, with the number, the key and the name of each
//! value. The constants of `lahar.h` and `lahar.f90` are written from the same list by `cargo xtask
//! headers`.

use crate::error::{Error, Result};
use std::ffi::CStr;

/// One value of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Its number in the C interface.
    pub number: i32,
    /// Its name in data, in snake case.
    pub key: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// Its constant in `lahar.h`.
    pub constant: &'static str,
    /// The same.
    pub constant_c: &'static CStr,
    /// Lines of its documentation, in `lahar.h` and here.
    pub doc: &'static [&'static str],
}

/// The list of a choice.
#[derive(Clone, Copy, Debug)]
pub struct List {
    /// What is chosen, as errors call it.
    pub what: &'static str,
    /// The values.
    pub values: &'static [Value],
}

impl List {
    /// Position of the value with this number.
    pub fn by_number(&self, number: i32) -> Result<usize> {
        self.values.iter().position(|value| value.number == number).ok_or_else(|| {
            let known: Vec<String> = self
                .values
                .iter()
                .map(|value| format!("{} ({})", value.number, value.name))
                .collect();
            let known = match &known[..] {
                [before @ .., last] if !before.is_empty() => {
                    format!("{} or {last}", before.join(", "))
                }
                _ => known.concat(),
            };
            Error::invalid(format!("{} must be {known}, got {number}", self.what))
        })
    }

    /// Position of the value with this key.
    pub fn by_key(&self, key: &str) -> Result<usize> {
        let keys = self.values.iter().map(|value| value.key);
        let found = keys.clone().position(|known| known == key);
        found.ok_or_else(|| Error::unknown_name(self.what, key, keys))
    }
}

/// Makes an enum of a list. A value has a documentation (which goes to `lahar.h` too), a number, a
/// key, a constant, and a name for people if that is another than the key:
///
/// ```ignore
/// choices! {
///     /// Where in a step the stress is updated.
///     pub enum StepOrder: "order" {
///         /// Order of a step: update stress last.
///         Usl = 0, "usl", LAHAR_ORDER_USL, "USL";
///     }
/// }
/// ```
macro_rules! choices {
    (
        $(#[$meta:meta])*
        pub enum $Choice:ident: $what:literal {
            $(
                $(#[doc = $doc:literal])+
                $Value:ident = $number:literal, $key:literal, $constant:ident $(, $name:literal)?;
            )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(i32)]
        pub enum $Choice {
            $($(#[doc = $doc])+ $Value = $number,)+
        }

        impl $Choice {
            /// The list of the values, in the order of [`Self::ALL`].
            pub const LIST: $crate::choice::List = $crate::choice::List {
                what: $what,
                values: &[$($crate::choice::Value {
                    number: Self::$Value.number(),
                    key: Self::$Value.key(),
                    name: Self::$Value.name(),
                    constant: stringify!($constant),
                    constant_c: $crate::choice::c_text(concat!(stringify!($constant), "\0")),
                    doc: &[$($doc),+],
                }),+],
            };

            /// All values.
            pub const ALL: [Self; Self::LIST.values.len()] = [$(Self::$Value),+];

            /// Its number in the C interface.
            pub const fn number(self) -> i32 {
                self as i32
            }

            /// Its name in data, in snake case.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$Value => $key,)+
                }
            }

            /// Its name for people.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$Value => $crate::choice::name_of!($key $(, $name)?),)+
                }
            }

            /// The value with this number.
            pub fn from_i32(number: i32) -> $crate::error::Result<Self> {
                Ok(Self::ALL[Self::LIST.by_number(number)?])
            }

            /// The value with this key.
            pub fn from_key(key: &str) -> $crate::error::Result<Self> {
                Ok(Self::ALL[Self::LIST.by_key(key)?])
            }
        }

        impl<'de> serde::Deserialize<'de> for $Choice {
            /// From its key.
            fn deserialize<S>(source: S) -> std::result::Result<Self, S::Error>
            where
                S: serde::Deserializer<'de>,
            {
                let key: String = serde::Deserialize::deserialize(source)?;
                Self::from_key(&key).map_err(serde::de::Error::custom)
            }
        }
    };
}

/// The name for people: the key unless there is another.
macro_rules! name_of {
    ($key:literal) => {
        $key
    };
    ($key:literal, $name:literal) => {
        $name
    };
}

pub(crate) use {choices, name_of};

/// A text that ends with its only NUL.
pub(crate) const fn c_text(text: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(text.as_bytes()) {
        Ok(text) => text,
        Err(_) => panic!("a NUL stands in the middle of a text"),
    }
}

#[cfg(test)]
mod tests {
    use crate::error::Status;

    choices! {
        /// A choice for the tests below.
        #[derive(PartialOrd)]
        pub enum Soil: "soil" {
            /// Soil: grains.
            Sand = 0, "sand", LAHAR_SOIL_SAND;
            /// Soil: platelets,
            /// of two lines.
            FatClay = -3, "fat_clay", LAHAR_SOIL_FAT_CLAY, "fat clay";
            /// Soil: in between.
            Silt = 7, "silt", LAHAR_SOIL_SILT;
        }
    }

    #[test]
    fn values_are_found_by_number_and_by_key() {
        for soil in Soil::ALL {
            assert_eq!(Soil::from_i32(soil.number()), Ok(soil));
            assert_eq!(Soil::from_key(soil.key()), Ok(soil));
            let data = serde_json::from_str::<Soil>(&format!("\"{}\"", soil.key()));
            assert_eq!(data.expect("a value"), soil);
        }
        assert_eq!((Soil::FatClay.number(), Soil::FatClay.name()), (-3, "fat clay"));
        assert_eq!(Soil::Silt.name(), "silt");
        assert!(Soil::FatClay < Soil::Sand);
        let [_, clay, _] = Soil::LIST.values else { panic!("{:?}", Soil::LIST) };
        assert_eq!(clay.constant, "LAHAR_SOIL_FAT_CLAY");
        assert_eq!(clay.doc, [" Soil: platelets,", " of two lines."]);
    }

    #[test]
    fn an_unknown_value_is_answered_with_the_known_ones() {
        let error = Soil::from_i32(1).expect_err("no such number");
        assert_eq!(error.status, Status::InvalidArgument);
        assert_eq!(error.message, "soil must be 0 (sand), -3 (fat clay) or 7 (silt), got 1");
        let error = Soil::from_key("slit").expect_err("no such key");
        assert_eq!(error.status, Status::UnknownName);
        assert!(error.message.contains("no soil is named `slit`; did you mean `silt`?"), "{error}");
        let error = serde_json::from_str::<Soil>("\"slit\"").expect_err("no such key");
        assert!(error.to_string().contains("did you mean `silt`?"), "{error}");
    }
}

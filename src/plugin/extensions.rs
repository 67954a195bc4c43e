//! The extensions of a model that the engine knows: their tables, checked when the plugin is
//! loaded.

use super::handshake::Location;
use crate::error::Result;
use crate::material::Transfer;
use lahar_plugin_abi::*;
use std::ffi::CStr;

/// The tables of the extensions that the engine knows.
pub(super) struct Extensions {
    pub(super) tangent: Option<&'static lahar_tangent_extension>,
    pub(super) energy: Option<&'static lahar_energy_extension>,
    transfer: Vec<i32>,
}

impl Extensions {
    /// # Safety
    ///
    /// As for [`read_plugin`](super::handshake::read_plugin).
    pub(super) unsafe fn read(desc: &lahar_model_desc, location: &Location<'_>) -> Result<Self> {
        // SAFETY: by contract of the caller; a table of an id is of the type that the ABI names.
        let (tangent, energy, transfer) = unsafe {
            (
                table_of::<lahar_tangent_extension>(desc, c"lahar.tangent", location)?,
                table_of::<lahar_energy_extension>(desc, c"lahar.energy", location)?,
                table_of::<lahar_transfer_extension>(desc, c"lahar.transfer", location)?,
            )
        };
        location.ensure(tangent.is_none_or(|t| t.tangent.is_some()), || {
            "expected a function in `lahar.tangent`, got NULL".into()
        })?;
        location.ensure(energy.is_none_or(|t| t.stored.is_some()), || {
            "expected a function in `lahar.energy`, got NULL".into()
        })?;
        let declared = desc.capabilities & LAHAR_CAPABILITY_TANGENT != 0;
        location.ensure(declared == tangent.is_some(), || {
            let (says, gives) = if declared { ("", "not ") } else { ("not ", "") };
            format!(
                "LAHAR_CAPABILITY_TANGENT is {says}declared, but `lahar.tangent` is {gives}offered"
            )
        })?;
        let transfer = match transfer {
            None => Vec::new(),
            Some(t) => {
                // SAFETY: by contract of the caller.
                let rules = unsafe {
                    location.entries("transfer rules", t.rules, t.count, size_of::<i32>())
                }?;
                rules.into_iter().copied().collect()
            }
        };
        Ok(Self { tangent, energy, transfer })
    }

    /// One rule per state variable; the mean if the model gives none.
    pub(super) fn rules(&self, states: usize, location: &Location<'_>) -> Result<Vec<Transfer>> {
        let given = self.transfer.len();
        location.ensure(given == 0 || given == states, || {
            format!("expected {states} rules in `lahar.transfer`, got {given}")
        })?;
        let rule = |rule: &i32| match *rule {
            LAHAR_TRANSFER_MEAN => Ok(Transfer::Mean),
            LAHAR_TRANSFER_MAX => Ok(Transfer::Max),
            LAHAR_TRANSFER_NEVER => Ok(Transfer::Never),
            other => Err(location.error(format!("expected transfer rules 0 to 2, got {other}"))),
        };
        if given == 0 {
            return Ok(vec![Transfer::Mean; states]);
        }
        self.transfer.iter().map(rule).collect()
    }
}

/// The table of an extension; None if the model does not offer it.
///
/// # Safety
///
/// As for [`read_plugin`](super::handshake::read_plugin); the table of `id` is a `T`.
unsafe fn table_of<T>(
    desc: &lahar_model_desc,
    id: &CStr,
    location: &Location<'_>,
) -> Result<Option<&'static T>> {
    let Some(get_extension) = desc.get_extension else { return Ok(None) };
    // SAFETY: the id ends with a NUL; loading is exclusive.
    let table = unsafe { get_extension(desc, id.as_ptr()) }.cast::<T>();
    if table.is_null() {
        return Ok(None);
    }
    // SAFETY: by contract of the caller.
    unsafe { location.inside(format!("{}, extension {id:?}", location.at)).table(table) }.map(Some)
}

//! The `bind(c)` layer of `lahar.f90`, made from `lahar.h`.
//!
//! The section between two marker lines of the module is replaced; what stands around it is written by hand.

mod declarations;
mod module;

use crate::process;
use declarations::Header;

const HEADER: &str = "include/lahar/lahar.h";
const MODULE: &str = "include/lahar/lahar.f90";
const BEGIN: &str = "  ! ---- begin of the part that `cargo xtask headers` writes ----\n";
const END: &str = "  ! ---- end of the part that `cargo xtask headers` writes ----\n";

/// Writes the generated section, or only compares it.
pub fn run(check: bool) -> Result<(), String> {
    let root = process::root();
    let read =
        |file: &str| std::fs::read_to_string(root.join(file)).map_err(|e| format!("{file}: {e}"));
    let header = Header::parse(&read(HEADER)?).map_err(|e| format!("{HEADER}: {e}"))?;
    let before = read(MODULE)?;
    let after = replaced(&before, &module::section(&header)?)?;
    if before == after {
        return Ok(());
    }
    if check {
        return Err(format!("{MODULE} does not fit {HEADER}; run `cargo xtask headers`"));
    }
    std::fs::write(root.join(MODULE), after).map_err(|e| format!("{MODULE}: {e}"))
}

fn replaced(text: &str, section: &str) -> Result<String, String> {
    let (Some(begin), Some(end)) = (text.find(BEGIN), text.find(END)) else {
        return Err(format!("{MODULE} has lost its marker lines"));
    };
    Ok(format!("{}{section}{}", &text[..begin + BEGIN.len()], &text[end..]))
}

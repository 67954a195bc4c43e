//! The `bind(c)` layers of `lahar.f90` and `lahar_plugin.f90`, made from `lahar.h` and
//! `lahar_plugin.h`.
//!
//! The section between two marker lines of a module is replaced; what stands around it is written
//! by hand.

mod declarations;
mod module;

use declarations::Header;
use xtask_front::process;

/// Headers, and the modules that are made from them.
const MODULES: [(&str, &str); 2] = [
    ("include/lahar/lahar.h", "include/lahar/lahar.f90"),
    ("include/lahar/lahar_plugin.h", "include/lahar/lahar_plugin.f90"),
];
const BEGIN: &str = "  ! ---- begin of the part that `cargo xtask headers` writes ----\n";
const END: &str = "  ! ---- end of the part that `cargo xtask headers` writes ----\n";

/// Writes the generated sections, or only compares them.
pub fn run(check: bool) -> Result<(), String> {
    let root = process::root();
    let read =
        |file: &str| std::fs::read_to_string(root.join(file)).map_err(|e| format!("{file}: {e}"));
    for (header_file, module_file) in MODULES {
        let header =
            Header::parse(&read(header_file)?).map_err(|e| format!("{header_file}: {e}"))?;
        let before = read(module_file)?;
        let after = replaced(&before, &module::section(&header)?)
            .ok_or_else(|| format!("{module_file} has lost its marker lines"))?;
        if before == after {
            continue;
        }
        if check {
            return Err(format!(
                "{module_file} does not fit {header_file}; run `cargo xtask headers`"
            ));
        }
        std::fs::write(root.join(module_file), after).map_err(|e| format!("{module_file}: {e}"))?;
    }
    Ok(())
}

fn replaced(text: &str, section: &str) -> Option<String> {
    let (begin, end) = (text.find(BEGIN)?, text.find(END)?);
    Some(format!("{}{section}{}", &text[..begin + BEGIN.len()], &text[end..]))
}

//! `cargo xtask setup`: finds what is missing on Debian 12 and installs it when it may.

use crate::process::{self, succeeds};

/// Which tasks the machine is made ready for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// A C compiler.
    Demo,
    /// The C, C++ and Fortran compilers, valgrind, rustfmt and clippy.
    Tests,
}

/// A program that is looked for, and the Debian package that brings it.
struct Tool {
    program: &'static str,
    package: &'static str,
    need: Need,
}

const TOOLS: [Tool; 5] = [
    Tool { program: "cc", package: "build-essential", need: Need::Demo },
    Tool { program: "c++", package: "build-essential", need: Need::Tests },
    Tool { program: "nm", package: "binutils", need: Need::Tests },
    Tool { program: "gfortran", package: "gfortran", need: Need::Tests },
    Tool { program: "valgrind", package: "valgrind", need: Need::Tests },
];

/// What may be done about a missing Debian package.
#[derive(Clone, Copy)]
enum Rights {
    Root,
    Sudo,
    None,
}

/// Installs what `need` asks for and the machine lacks. If it may not, the error holds the one line
/// to run.
pub fn run(need: Need) -> Result<(), String> {
    debian_packages(need)?;
    if need == Need::Tests {
        rust_component("rustfmt", "fmt")?;
        rust_component("clippy", "clippy")?;
    }
    Ok(())
}

fn debian_packages(need: Need) -> Result<(), String> {
    let mut packages: Vec<&str> = TOOLS
        .iter()
        .filter(|tool| need == Need::Tests || tool.need == need)
        .filter(|tool| !succeeds(tool.program, &["--version"]))
        .map(|tool| tool.package)
        .collect();
    packages.dedup();
    if packages.is_empty() {
        return Ok(());
    }
    let list = packages.join(" ");
    println!("missing: {list}");
    let by_hand = format!(
        "run this line and try again:\n    sudo apt-get update && sudo apt-get install -y {list}"
    );
    let (program, first): (&str, &[&str]) = match rights() {
        Rights::Root => ("env", &[]),
        Rights::Sudo => ("sudo", &["-n", "env"]),
        Rights::None => return Err(format!("cannot install packages without root; {by_hand}")),
    };
    let apt = |arguments: &[&str]| {
        let line =
            [first, &["DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"], arguments].concat();
        process::run(program, &line).map_err(|e| format!("{e}; {by_hand}"))
    };
    apt(&["update"])?;
    apt(&[&["install", "-y", "--no-install-recommends"], packages.as_slice()].concat())
}

fn rights() -> Rights {
    let root = std::process::Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|output| output.stdout.trim_ascii() == b"0");
    if !succeeds("apt-get", &["--version"]) {
        Rights::None
    } else if root {
        Rights::Root
    } else if succeeds("sudo", &["-n", "true"]) {
        Rights::Sudo
    } else {
        Rights::None
    }
}

fn rust_component(component: &str, subcommand: &str) -> Result<(), String> {
    if succeeds("cargo", &[subcommand, "--version"]) {
        return Ok(());
    }
    process::run("rustup", &["component", "add", component]).map_err(|e| {
        format!("{e}; cargo {subcommand} is missing: install the component {component}")
    })
}

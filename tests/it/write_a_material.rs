//! The chapter "Write a material": its commands are run one by one, and what it prints of their
//! output is compared.

use super::compiler::{read, run};
use super::support::{repository, scratch_folder, target_folder};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A block of commands, and what the chapter shows of the output of the last one.
struct Block {
    section: String,
    commands: Vec<String>,
    shown: Vec<String>,
}

#[test]
fn every_command_of_the_chapter_runs_and_prints_what_stands_there() {
    let folder = folder();
    let mut compared = 0;
    for block in blocks(&read("docs/book/write_a_material.md")) {
        let mut printed = String::new();
        for command in &block.commands {
            let mut shell = Command::new("sh");
            printed = run(shell.args(["-c", command]).current_dir(&folder));
            println!("$ {command}\n{printed}");
        }
        compare(&block.shown, &printed);
        compared += block.shown.iter().filter(|line| *line != "...").count();
    }
    assert!(compared > 15, "only {compared} lines of output are shown");
}

#[test]
fn the_way_of_an_author_has_fewer_than_ten_commands() {
    let blocks = blocks(&read("docs/book/write_a_material.md"));
    for (section, start, end) in [("In C", "cp ", "./own"), ("In Fortran", "cp ", "./own")] {
        let of_section = blocks.iter().filter(|block| block.section == section);
        let commands: Vec<&String> = of_section.flat_map(|block| &block.commands).collect();
        assert!(commands.len() < 10 && commands.len() > 4, "{section}: {commands:?}");
        assert!(commands[0].starts_with(start) && commands[commands.len() - 1].starts_with(end));
        assert!(commands.iter().any(|command| command.contains("lahar plugin check")), "{section}");
    }
}

/// A folder that looks like the repository's after its build.
fn folder() -> PathBuf {
    let folder = scratch_folder();
    let lahar = target_folder().join("lahar");
    assert!(lahar.is_file(), "{}: cargo build --release --workspace", lahar.display());
    fs::create_dir(folder.join("target")).expect("a folder");
    symlink(target_folder(), folder.join("target/release")).expect("a link");
    for name in ["include", "plugins", "examples-c"] {
        symlink(repository(name), folder.join(name)).expect("a link");
    }
    assert!(Path::new(&folder.join("plugins/template")).is_dir());
    folder
}

/// The blocks of commands of a chapter; a block of text belongs to the commands before it.
fn blocks(chapter: &str) -> Vec<Block> {
    let (mut found, mut section, mut language) = (Vec::<Block>::new(), "", "");
    for line in chapter.lines() {
        let trimmed = line.trim();
        match (language, trimmed.strip_prefix("```")) {
            ("", Some(opened)) => {
                language = if opened.is_empty() { "none" } else { opened };
                if opened == "sh" {
                    let section = section.to_string();
                    found.push(Block { section, commands: Vec::new(), shown: Vec::new() });
                }
            }
            (_, Some(_)) => language = "",
            ("sh", None) => found.last_mut().expect("sh").commands.push(trimmed.into()),
            ("text", None) => found.last_mut().expect("text after sh").shown.push(line.into()),
            ("", None) => section = line.strip_prefix("## ").unwrap_or(section),
            _ => {}
        }
    }
    found
}

/// Every shown line must be printed, in this order, and the next one unless `...` stands between. A
/// line that ends with `...` goes on.
fn compare(shown: &[String], printed: &str) {
    let mut rest = printed.lines();
    let mut may_skip = false;
    for line in shown {
        if line == "..." {
            may_skip = true;
            continue;
        }
        let found = if may_skip {
            rest.any(|l| matches(line, l))
        } else {
            matches(line, rest.next().unwrap_or(""))
        };
        assert!(found, "the chapter shows `{line}`, but what was printed is\n{printed}");
        may_skip = false;
    }
}

/// Word by word; a number may have more digits than are shown.
fn matches(shown: &str, printed: &str) -> bool {
    let (shown, is_start) = match shown.strip_suffix("...") {
        Some(start) => (start, true),
        None => (shown, false),
    };
    let (shown, printed): (Vec<_>, Vec<_>) =
        (shown.split_whitespace().collect(), printed.split_whitespace().collect());
    let fits = if is_start { shown.len() <= printed.len() } else { shown.len() == printed.len() };
    fits && shown.iter().zip(printed).all(|(a, b)| a == &b || is_rounded(a, b))
}

/// Whether `full` begins as `short` does when it is rounded to that many decimals.
fn is_rounded(short: &str, full: &str) -> bool {
    let (mantissa, exponent) = short.split_once('E').unwrap_or((short, "0"));
    let (Some((_, decimals)), Ok(exponent)) = (mantissa.split_once('.'), exponent.parse::<i32>())
    else {
        return false;
    };
    let (Ok(a), Ok(b)) = (short.parse::<f64>(), full.parse::<f64>()) else { return false };
    (a - b).abs() <= 0.5001 * 10_f64.powi(exponent - decimals.len() as i32)
}

#[test]
fn shown_output_is_distinguished_from_other_output() {
    let printed = "particles = 12\nrun_out = 2.3934\nok   loads: fine\nheight = 4.0580E-001";
    let shown = |text: &str| text.lines().map(String::from).collect::<Vec<_>>();
    compare(&shown("particles = 12\nrun_out = 2.39"), printed);
    compare(&shown("...\nok   loads: ...\nheight =  4.06E-001"), printed);
    for wrong in [
        "particles = 13",
        "particles = 1.2",
        "run_out = 2.39",
        "...\nrun_out = 2.40",
        "...\nheight = 4.06",
    ] {
        let result = std::panic::catch_unwind(|| compare(&shown(wrong), printed));
        assert!(result.is_err(), "`{wrong}` was taken");
    }
}

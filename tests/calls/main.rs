//! Random calls of the C interface: a host that is read from `lahar.h`, so that new functions take
//! part. Whatever it does within the contract ends in a status that the header lists, without a
//! crash or a caught defect.
//!
//! `LAHAR_CALLS` is the number of calls (a million takes minutes), `LAHAR_CALLS_SEED` another start,
//! `LAHAR_CALLS_TRACE` prints each call before it is made.
#![allow(clippy::print_stdout)] // tests report the figures that they judge

#[path = "../it/setup.rs"]
#[allow(dead_code)]
mod setup;
#[path = "../it/support.rs"]
mod support;

mod caller;
mod header;
mod random;

use std::collections::BTreeMap;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use caller::Caller;
use header::Header;
use random::{Host, words};
use support::{plugin_path, repository, scratch_folder, target_folder};

/// Calls of a run of the suite: every function succeeds about ten times or more.
const CALLS: u64 = 400_000;

/// No run of the suite takes longer; one that is asked for may.
const LONGEST: Duration = Duration::from_secs(50);

fn header() -> Header {
    let text = std::fs::read_to_string(repository("include/lahar/lahar.h")).expect("lahar.h");
    Header::read(&text)
}

fn caller() -> Caller {
    let exe = std::env::current_exe().expect("the path of the test");
    let beside = exe.with_file_name("liblahar.so");
    Caller::new(&if beside.exists() { beside } else { target_folder().join("liblahar.so") })
}

fn texts() -> Vec<String> {
    let plugins = ["linear_elastic", "drucker_prager", "newtonian"].map(plugin_path);
    words(&plugins, &scratch_folder())
}

/// A number of the environment.
fn asked(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().expect(name))
}

/// Calls until a number is reached, or the time is over; how many.
fn call_many(host: &mut Host<'_>, calls: u64) -> u64 {
    let start = Instant::now();
    let is_over = || start.elapsed() > LONGEST && asked("LAHAR_CALLS").is_none();
    (0..calls).take_while(|n| n % 64 != 0 || !is_over()).map(|_| host.call_any()).count() as u64
}

fn assert_kept(host: &Host<'_>) {
    let breaks: Vec<String> = host
        .breaks
        .iter()
        .map(|((function, status), message)| format!("{function} gave {status}: {message}"))
        .collect();
    assert!(breaks.is_empty(), "not in lahar.h:\n{}", breaks.join("\n"));
}

#[test]
fn the_header_is_read_whole() {
    let header = header();
    let symbols = std::fs::read_to_string(repository("include/lahar/symbols.txt")).expect("a list");
    let mut names: Vec<&str> = header.functions.iter().map(|f| f.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, symbols.lines().filter(|l| !l.starts_with('#')).collect::<Vec<_>>());
    let of = |name: &str| header.functions.iter().find(|f| f.name == name).expect("a function");
    assert_eq!(of("lahar_body_read").arguments.len(), 7);
    assert!(header.functions.iter().all(|f| f.has_status != f.statuses.is_empty()));
    assert_eq!(header.structs["lahar_particles"].len(), 10);
}

#[test]
fn random_calls_end_in_statuses_that_the_header_lists() {
    let (header, caller, texts) = (header(), caller(), texts());
    let seed = asked("LAHAR_CALLS_SEED").unwrap_or(1);
    let mut host = Host::new(&caller, &header, seed, &texts);
    let wanted = asked("LAHAR_CALLS").unwrap_or(CALLS);
    let done = call_many(&mut host, wanted);
    host.free_all();
    for ((function, status), count) in &host.seen {
        println!("{count:>8} {function} {status}");
    }
    println!("{done} calls, seed {seed}");
    assert_kept(&host);
    if wanted >= CALLS {
        // a host that is always refused would show nothing
        assert!(done >= 10_000, "only {done} calls in {LONGEST:?}");
    }
    if done >= CALLS {
        for function in &header.functions {
            let name = function.name.as_str();
            let done = |status: &str| host.seen.contains_key(&(name, status.to_string()));
            let never = ["lahar_log_stderr", "lahar_context_register_plugin"];
            let is_done = done("called") || done("LAHAR_OK") || never.contains(&name);
            assert!(is_done, "{name} never succeeded");
        }
        assert!(host.statuses().len() >= 15, "{:?}", host.statuses());
    }
}

#[test]
fn two_threads_on_the_same_worlds_get_busy_instead_of_races() {
    let (header, caller, texts) = (header(), caller(), texts());
    let mut owner = Host::new(&caller, &header, 7, &texts);
    owner.prepare();
    owner.prepare();
    let calls = asked("LAHAR_CALLS").unwrap_or(CALLS) / 4;
    let mut seen: BTreeMap<String, u64> = BTreeMap::new();
    thread::scope(|scope| {
        let run = |seed| {
            let mut host = Host::new(&caller, &header, seed, &texts);
            host.share(&owner.handles);
            move || {
                call_many(&mut host, calls);
                host.free_all();
                assert_kept(&host);
                host.seen
            }
        };
        let threads = [8, 9].map(|seed| scope.spawn(run(seed)));
        for thread in threads {
            for ((_, status), count) in thread.join().expect("no break of the contract") {
                *seen.entry(status).or_default() += count;
            }
        }
    });
    println!("{seen:?}");
    owner.free_all();
    if calls >= CALLS / 4 {
        assert!(seen.contains_key("LAHAR_ERROR_BUSY"), "the threads never met");
    }
}

#[test]
fn random_calls_are_clean_under_valgrind() {
    let mut command = Command::new("valgrind");
    command.args(["-q", "--error-exitcode=9", "--leak-check=full"]);
    command.args(["--errors-for-leak-kinds=definite,indirect", "--show-leak-kinds=definite"]);
    command.arg(std::env::current_exe().expect("the path of the test"));
    command.args(["--exact", "random_calls_end_in_statuses_that_the_header_lists", "--nocapture"]);
    let output = command.env("LAHAR_CALLS", "1500").output().expect("valgrind");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("1 passed"), "{text}");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

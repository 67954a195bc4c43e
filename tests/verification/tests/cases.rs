//! One test for each file in `tests/cases`: the case in its small sizes.

use lahar_verification::case::{self, Case};
use lahar_verification::{judge, run};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let files = case::files().expect("the folder of the cases");
    assert!(!files.is_empty(), "there are no cases");
    let trials = files.into_iter().map(|path| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name_of_test = format!("case_{name}_reaches_its_gates");
        Trial::test(name_of_test, move || {
            let case = Case::read(&path)?;
            if case.case.to_lowercase() != name {
                return Err(Failed::from(format!("case {} stands in {name}.json", case.case)));
            }
            reaches_its_gates(case)
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit();
}

fn reaches_its_gates(case: Case) -> Result<(), Failed> {
    let cases = [case];
    let done = run::run_all(&cases, false, |_, _| ())?;
    let rows = judge::judge(&cases[0], &judge::outcomes_of(&cases[0], &done))?;
    if rows.is_empty() {
        return Err("no check of this case belongs to the test suite".into());
    }
    let wrong: Vec<String> =
        rows.iter().filter(|row| !row.verdict.passes()).map(|row| format!("{row:#?}")).collect();
    let failures: Vec<_> = done.iter().filter_map(|done| done.outcome.failure.as_ref()).collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!("{}\nengine: {failures:?}", wrong.join("\n")).into())
}

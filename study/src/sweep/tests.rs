//! Sweep files, good and bad.

use super::read::{SweepError, sweep};
use super::*;
use crate::case::catalogue;
use crate::case::{ProblemCase, StabilityCase, document, load as load_case};
use std::path::Path;

const BASE: &str = r#"problem = "contact"
[shell]
law = "hooke"
[dimensionless]
bending = 3e-5
pressure = 3e-3
adhesion = 2e-3
film = 0.05
[path]
start = 1.2
end = 0.9
"#;

fn read(text: &str) -> Result<Sweep, SweepError> {
    read_shard(text, Shard::ALL)
}

fn read_shard(text: &str, shard: Shard) -> Result<Sweep, SweepError> {
    let tree = document::parse("s.toml", text, &[])?;
    sweep("s.toml", "s", Path::new(""), tree, shard, &catalogue())
}

fn good(vary: &str) -> Sweep {
    read(&format!("{BASE}{vary}")).unwrap_or_else(|error| panic!("{error}"))
}

/// The message about a sweep that is refused; it names all `parts`.
#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let message = read(text).unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is missing in:\n{message}");
    }
}

/// The numbers that a key takes in the cases, in their order.
fn numbers(sweep: &Sweep, axis: usize) -> Vec<f64> {
    let number = |case: usize| sweep.plan.settings(case)[axis].number().unwrap();
    (0..sweep.plan.count().unwrap()).map(number).collect()
}

#[test]
fn a_range_is_even_or_even_in_its_logarithm() {
    let vary = "[[vary]]\nkey = \"dimensionless.adhesion\"\nfrom = 1e-4\nto = 1.0\ncount = 5\n";
    assert_eq!(numbers(&good(vary), 0), [1e-4, 0.250075, 0.50005, 0.750025, 1.0]);
    let log = format!("{vary}scale = \"log\"\n");
    assert_eq!(numbers(&good(&log), 0), [1e-4, 1e-3, 1e-2, 0.1, 1.0]);
}

#[test]
fn the_last_key_varies_fastest() {
    let sweep = good(
        "[[vary]]\nkey = \"dimensionless.adhesion\"\nvalues = [1e-3, 2e-3]\n\
         [[vary]]\nkey = \"mesh.elements\"\nfrom = 10\nto = 30\ncount = 3\n",
    );
    assert_eq!(numbers(&sweep, 0), [1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3]);
    assert_eq!(numbers(&sweep, 1), [10.0, 20.0, 30.0, 10.0, 20.0, 30.0]);
    let ProblemCase::Contact(last) = &sweep.cases[5].case.as_ref().unwrap().problem else {
        panic!("{:?}", sweep.cases[5]);
    };
    assert_eq!((last.groups.adhesion, last.mesh.elements), (2e-3, 30));
    assert_eq!(sweep.cases[5].case.as_ref().unwrap().name, "s-5");
    assert!(sweep.plan.plane().is_some());
}

#[test]
fn keys_of_one_zip_advance_together() {
    let sweep = good(
        "[[vary]]\nkey = \"dimensionless.adhesion\"\nvalues = [1e-3, 2e-3]\nzip = \"a\"\n\
         [[vary]]\nkey = \"path.end\"\nvalues = [0.8, 0.7, 0.6]\n\
         [[vary]]\nkey = \"path.start\"\nvalues = [1.3, 1.4]\nzip = \"a\"\n",
    );
    assert_eq!(numbers(&sweep, 0), [1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3]);
    assert_eq!(numbers(&sweep, 1), [0.8, 0.7, 0.6, 0.8, 0.7, 0.6]);
    assert_eq!(numbers(&sweep, 2), [1.3, 1.3, 1.3, 1.4, 1.4, 1.4]);
    assert!(sweep.plan.plane().is_none());
    refused(
        &format!(
            "{BASE}[[vary]]\nkey = \"path.end\"\nvalues = [0.8, 0.7]\nzip = \"a\"\n\
             [[vary]]\nkey = \"path.start\"\nvalues = [1.2]\nzip = \"a\"\n"
        ),
        &["line 19", "vary.zip", "path.start has 1 values and path.end has 2"],
    );
}

#[test]
fn a_base_may_be_another_case_with_keys_laid_over_it() {
    let sweep = read(
        "case = \"fig12\"\nmesh.elements = 50\n[[vary]]\nkey = \"shell.law\"\n\
         values = [\"hooke\", \"skalak\"]\n",
    );
    let sweep = sweep.unwrap();
    let ProblemCase::Contact(case) = &sweep.cases[1].case.as_ref().unwrap().problem else {
        panic!("{sweep:?}");
    };
    assert_eq!((case.groups.bending, case.mesh.elements), (3e-5, 50));
    let catalogue = read("case = \"bratu\"\n[[vary]]\nkey = \"path.end\"\nvalues = [1, 2.5]\n");
    assert_eq!(catalogue.unwrap().plan.parameter, "lambda");
    refused(
        "case = \"fig13\"\n[[vary]]\nkey = \"path.end\"\nvalues = [0.7]\n",
        &["s.toml, line 1: case = \"fig13\": fig13: neither a case file", "did you mean"],
    );
    refused(
        "\ncase = \"gone.toml\"\n[[vary]]\nkey = \"path.end\"\nvalues = [0.7]\n",
        &["s.toml, line 2: case = \"gone.toml\": gone.toml: no such file"],
    );
}

#[test]
fn a_shard_holds_every_nth_case_and_shards_share_the_plan() {
    let text = format!("{BASE}[[vary]]\nkey = \"path.end\"\nfrom = 0.5\nto = 0.9\ncount = 5\n");
    let of = |shard: &str| read_shard(&text, shard.parse().unwrap()).unwrap();
    let indices = |sweep: &Sweep| sweep.cases.iter().map(|c| c.index).collect::<Vec<_>>();
    assert_eq!(indices(&of("1/2")), [0, 2, 4]);
    assert_eq!(indices(&of("2/2")), [1, 3]);
    assert_eq!(Plan { shard: Shard::ALL, ..of("2/2").plan }, read(&text).unwrap().plan);
    for wrong in ["0/2", "3/2", "1", "a/b", "1/0", ""] {
        assert!(wrong.parse::<Shard>().unwrap_err().contains("k/n"), "{wrong}");
    }
}

#[test]
fn unknown_keys_are_named_with_their_line_and_a_suggestion() {
    let vary = "[[vary]]\nkey = \"path.end\"\nvalues = [0.7]\n";
    refused(
        &format!("{BASE}{vary}vlaues = [0.8]\n"),
        &["line 15: vary.vlaues: unknown key (did you mean \"values\"?)", "allowed here: key"],
    );
    refused(
        &format!("{BASE}[[vary]]\nkey = \"dimensionless.adhesoin\"\nvalues = [1e-3]\n"),
        &["line 13: dimensionless.adhesoin: unknown key (did you mean \"adhesion\"?)"],
    );
    refused(
        &format!("{BASE}{vary}[[varry]]\nkey = 1\n"),
        &["varry: unknown key (did you mean \"vary\"?)", "case, vary"],
    );
    refused(&format!("{BASE}{vary}").replace("hooke", "hook"), &["line 3: shell.law = \"hook\""]);
}

#[test]
fn what_is_wrong_with_an_axis_is_said() {
    let with = |vary: &str| format!("{BASE}[[vary]]\n{vary}");
    refused(BASE, &["vary: missing", "[[vary]]"]);
    refused(&format!("vary = []\n{BASE}"), &["vary: missing"]);
    refused(&format!("vary = 3\n{BASE}"), &["line 1: vary = 3: expected an array of tables"]);
    refused(&format!("vary = [3]\n{BASE}"), &["vary = 3: expected a table [[vary]]"]);
    refused(&with("values = [1]\n"), &["vary.key: missing"]);
    refused(&with("key = \"path.end\"\n"), &["vary.from: missing", "vary.to", "vary.count"]);
    refused(&with("key = \"path.end\"\nvalues = []\n"), &["vary.values: missing", "empty"]);
    refused(&with("key = \"path.end\"\nvalues = 0.7\n"), &["expected an array of numbers"]);
    refused(&with("key = \"path.end\"\nvalues = [true]\n"), &["vary.values = true"]);
    refused(&with("key = \"path.end\"\nvalues = [0.7]\nfrom = 1\n"), &["vary.from"]);
    refused(
        &with("key = \"path.end\"\nfrom = 0.0\nto = 1\ncount = 3\nscale = \"log\"\n"),
        &["line 14: vary.from = 0.0: must be different from 0"],
    );
    refused(
        &with("key = \"path.end\"\nfrom = -1\nto = 1\ncount = 3\nscale = \"log\"\n"),
        &["vary.to = 1: must be of the same sign"],
    );
    refused(
        &with("key = \"path.end\"\nfrom = 0.7\nto = 0.8\ncount = 1\n"),
        &["vary.count = 1: must be a whole number from 2"],
    );
    refused(
        &with("key = \"path.end\"\nfrom = 0.7\nto = 0.8\ncount = 3\nscale = \"lg\"\n"),
        &["vary.scale = \"lg\": must be one of linear, log (did you mean \"log\"?)"],
    );
    refused(&with("key = \"problem\"\nvalues = [\"bratu\"]\n"), &["problem cannot vary"]);
    refused(&with("key = \"path.end.x\"\nvalues = [1]\n"), &["\"end\" is not a table"]);
    refused(&with("key = \"path..end\"\nvalues = [1]\n"), &["write it as table.key"]);
    let twice = "key = \"path.end\"\nvalues = [0.7]\n[[vary]]\nkey = \"path.end\"\nvalues = [1]\n";
    refused(&with(twice), &["line 16: vary.key", "varies already"]);
    let many = "from = 1\nto = 2\ncount = 1000000\n";
    refused(
        &with(&format!("key = \"path.end\"\n{many}[[vary]]\nkey = \"path.start\"\n{many}")),
        &["more than 10000000 cases"],
    );
}

#[test]
fn values_out_of_range_fail_alone_unless_all_do() {
    let vary = "[[vary]]\nkey = \"dimensionless.adhesion\"\nvalues = [1e-3, -1.0]\n";
    let sweep = good(vary);
    assert!(sweep.cases[0].case.is_ok());
    let reason = sweep.cases[1].case.as_ref().unwrap_err();
    assert_eq!(
        reason,
        "s.toml, line 13: dimensionless.adhesion = -1.0: must be positive and finite"
    );
    refused(&format!("{BASE}{}", vary.replace("1e-3", "-2.0")), &["line 13", "-2.0"]);
    // a word that means nothing is no value
    refused(
        &format!("{BASE}[[vary]]\nkey = \"shell.law\"\nvalues = [\"hooke\", \"hoke\"]\n"),
        &["line 13: shell.law = \"hoke\"", "did you mean \"hooke\""],
    );
}

#[test]
fn a_shipped_sweep_has_a_name_and_is_no_case() {
    let phase = load(Path::new("phase"), Shard::ALL, &catalogue()).unwrap();
    assert_eq!((&phase.plan.name[..], phase.cases.len()), ("phase", 17 * 17));
    let error = load_case(Path::new("phase"), &[], &catalogue()).unwrap_err().to_string();
    assert!(error.starts_with("phase, line ") && error.contains("for \"arclen sweep\""), "{error}");
}

#[test]
fn modes_without_symmetry_are_counted_in_a_sweep_where_somebody_says_so() {
    let vary = "[[vary]]\nkey = \"dimensionless.adhesion\"\nvalues = [1e-4, 1e-3]\n";
    let scans = |text: &str| -> Vec<StabilityCase> {
        let sweep = read(text).unwrap_or_else(|error| panic!("{error}"));
        sweep.cases.into_iter().map(|case| case.case.unwrap().stability).collect()
    };
    let full = StabilityCase::default();
    let own = StabilityCase::Axisymmetric;
    let over = |case: &str, table: &str| format!("case = \"{case}\"\n{table}{vary}");
    for (text, expected) in [
        (format!("{BASE}{vary}"), own),
        (format!("{BASE}[stability]\nscan = \"full\"\n{vary}"), full),
        (format!("{BASE}[stability]\nscan = \"axisymmetric\"\n{vary}"), own),
        (format!("{BASE}[stability]\nmax_n = 12\n{vary}"), StabilityCase::Full { max_n: 12 }),
        // a base that says nothing of it has the default of a sweep, not that of a trace
        (over("fig12", ""), own),
        (over("fig12", "[stability]\nscan = \"full\"\n"), full),
    ] {
        assert_eq!(scans(&text), [expected; 2], "{text}");
    }
    let both = "[[vary]]\nkey = \"stability.scan\"\nvalues = [\"full\", \"axisymmetric\"]\n";
    assert_eq!(scans(&format!("{BASE}{both}")), [full, own]);
    // a shell from pole to pole has its trace's
    let plates = "[[vary]]\nkey = \"plate.top.adhesion\"\nvalues = [1e-3, 2e-3]\n";
    assert_eq!(scans(&format!("case = \"two-plates\"\n{plates}")), [full; 2]);
}

//! Cases, good and bad.

mod film;
mod physical;
mod picture;

use super::source::load_text;
use super::*;
use problems::Allowed;
use proptest::prelude::*;

const GOOD: &str = r#"problem = "contact"
[shell]
law = "hooke"
poisson = 0.5
[dimensionless]
bending = 3e-5
pressure = 3e-3
adhesion = 2e-3
film = 0.03333333333333333
[mesh]
elements = 200
[path]
start = 1.15
end = 0.65
"#;

const PHYSICAL: &str = r#"problem = "contact"
[shell]
law = "mooney-rivlin"
b = 1
[physical]
radius = "1.5 µm"
chi = "0.05 N/m"
bending = "3e-16 N·m"
pressure = "1 atm"
adhesion = "0.1 mN/m"
film = "50 nm"
[path]
start = 1.3
end = 0.6
max_step = 0.05
min_step = 1e-8
max_points = 900
"#;

fn given(text: &str) -> Override {
    Override::given_by("--set", text)
}

fn elements(count: &str) -> Override {
    Override::given_by("--elements", format!("mesh.elements={count}"))
}

fn parameter(name: &str, default: f64, allowed: Allowed) -> CatalogueParameter {
    CatalogueParameter { name: name.into(), default, allowed }
}

fn catalogue() -> Vec<CatalogueEntry> {
    vec![
        CatalogueEntry {
            name: "bratu".into(),
            summary: "Bratu's equation".into(),
            parameter: "lambda".into(),
            axes: vec![("lambda".into(), "load".into()), ("max_u".into(), "largest u".into())],
            start: 0.0,
            end: 1.0,
            start_allowed: Allowed::Any,
            parameters: vec![parameter("length", 1.0, Allowed::Above(0.0))],
            elements: Some(ElementRange { default: 64, least: 8, most: 1000 }),
        },
        CatalogueEntry {
            name: "cusp".into(),
            summary: "the cusp".into(),
            parameter: "mu".into(),
            axes: vec![("mu".into(), "parameter".into()), ("x".into(), "state".into())],
            start: -1.0,
            end: 1.0,
            start_allowed: Allowed::Within(-3.0, 3.0),
            parameters: vec![parameter("nu", 0.5, Allowed::Any)],
            elements: None,
        },
    ]
}

fn read_with(text: &str, overrides: &[Override]) -> Result<LoadedCase, String> {
    load_text("a.toml", "a", text, overrides, &catalogue()).map_err(|error| error.to_string())
}

fn read(text: &str) -> ResolvedCase {
    read_with(text, &[]).unwrap().case
}

/// The complaint about `GOOD` with `from` replaced by `to`.
fn complaint(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    read_with(&GOOD.replacen(from, to, 1), &[]).unwrap_err()
}

fn complaint_physical(from: &str, to: &str) -> String {
    assert!(PHYSICAL.contains(from), "{from}");
    read_with(&PHYSICAL.replacen(from, to, 1), &[]).unwrap_err()
}

#[track_caller]
fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is missing in:\n{message}");
    }
}

#[test]
fn a_dimensionless_case_resolves_with_its_defaults() {
    let case = read(GOOD);
    assert_eq!(case.name, "a");
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    assert_eq!(contact.shell, Shell { law: Law::Hooke, poisson: 0.5 });
    assert_eq!(contact.groups.surface_tension, 0.0);
    assert_eq!(contact.groups.gas_exponent, 1.07);
    assert_eq!(contact.mesh, MeshCase { elements: 200, grading: None, tolerance: None });
    assert_eq!((case.path.start, case.path.end, case.path.max_points), (1.15, 0.65, 5000));
    let defaults =
        read(&GOOD.replace("[mesh]\nelements = 200\n", "").replace("poisson = 0.5\n", ""));
    let ProblemCase::Contact(contact) = &defaults.problem else { panic!("{defaults:?}") };
    assert_eq!((contact.mesh.elements, contact.shell.poisson), (400, 0.5));
}

#[test]
fn a_tolerance_takes_the_place_of_elements() {
    let mesh = |text: &str, overrides: &[&str]| {
        let overrides: Vec<Override> = overrides.iter().copied().map(Override::new).collect();
        read_with(text, &overrides).map(|loaded| *loaded.case.problem.mesh().unwrap())
    };
    let asked = GOOD.replace("elements = 200", "tolerance = 1e-6");
    assert_eq!(mesh(&asked, &[]).unwrap().tolerance, Some(1e-6));
    // what is laid over a file counts
    assert_eq!(mesh(GOOD, &["mesh.tolerance=1e-7"]).unwrap().tolerance, Some(1e-7));
    let fixed = mesh(&asked, &["mesh.elements=90"]).unwrap();
    assert_eq!((fixed.elements, fixed.tolerance), (90, None));
    let both = GOOD.replace("elements = 200", "elements = 200\ntolerance = 1e-6");
    says(&mesh(&both, &[]).unwrap_err(), &["mesh", "elements and tolerance"]);
    says(&mesh(GOOD, &["mesh.tolerance=1e-6", "mesh.grading=3"]).unwrap_err(), &["grading and"]);
    says(&mesh(GOOD, &["mesh.tolerance=1"]).unwrap_err(), &["mesh.tolerance = 1", "1e-10 to 1e-2"]);
    // as it was read
    let written = read(&asked).to_toml();
    assert!(written.contains("[mesh]\ntolerance = 1e-6\n"), "{written}");
}

#[test]
fn a_physical_case_gives_its_groups() {
    let case = read(PHYSICAL);
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    let groups = contact.groups;
    assert!((groups.bending - 3e-16 / (0.05 * 1.5e-6 * 1.5e-6)).abs() < 1e-18);
    assert!((groups.pressure - 101_325.0 * 1.5e-6 / 0.05).abs() < 1e-14);
    assert!((groups.adhesion - 2e-3).abs() < 1e-18);
    assert!((groups.film - 1.0 / 30.0).abs() < 1e-16);
    let (_, polymer) = SHIPPED.iter().find(|(name, _)| *name == "polymer").unwrap();
    let polymer = read(polymer);
    let ProblemCase::Contact(contact) = &polymer.problem else { panic!("{polymer:?}") };
    // E h = 52.5 N/m; (h/R0)²/(12 · 3/4)
    let physical = contact.physical.as_ref().unwrap();
    assert!((physical.chi() - 52.5).abs() < 1e-12);
    assert!((contact.groups.bending - (25.0_f64 / 1500.0).powi(2) / 9.0).abs() < 1e-18);
}

#[test]
fn resolved_cases_read_back_as_themselves() {
    let catalogue_case = "problem = \"bratu\"\n[parameters]\nlength = 2\n[path]\nend = 3.0\n";
    let ring = "problem = \"ring-load\"\n[shell]\nlaw = \"skalak\"\npoisson = 0.7\n[dimensionless]\n\
                bending = 1e-5\n[mesh]\ngrading = 4\n[path]\nstart = 1\nend = 30\n";
    let texts = [GOOD, PHYSICAL, catalogue_case, ring, "name = \"x-1\"\nproblem = \"cusp\"\n"];
    for text in texts.into_iter().chain(SHIPPED.iter().map(|(_, text)| *text)) {
        let case = read(text);
        let written = case.to_toml();
        let again = load_text("case.toml", "case", &written, &[], &catalogue()).unwrap();
        assert_eq!(again.case, case, "{written}");
        assert!(again.notes.is_empty());
    }
    says(&read(PHYSICAL).to_toml(), &["radius = \"1.5 µm\"", "#   bending = 0.00266"]);
}

#[test]
fn unknown_keys() {
    let message = complaint("poisson", "possion");
    says(
        &message,
        &[
            "a.toml, line 4",
            "shell.possion",
            "unknown key",
            "did you mean \"poisson\"",
            "law, poisson, b",
        ],
    );
    let message = complaint("law = \"hooke\"", "law = \"hooke\"\nadhesion = 2e-3");
    says(&message, &["line 4: shell.adhesion", "it belongs in [dimensionless]"]);
    says(
        &complaint("[mesh]", "[msh]"),
        &["line 10: msh", "did you mean \"mesh\"", "physical, mesh, path"],
    );
    says(&complaint("[mesh]", "[mesh.fine]"), &["line 10: mesh.fine: unknown key"]);
    says(
        &complaint("[mesh]", "[mesh]\n\"a b\\u001b\" = 1"),
        &["mesh.\"a b\\u{1b}\"", "elements, grading"],
    );
    let message = read_with("problem = \"cusp\"\n[parameters]\nmu = 1", &[]).unwrap_err();
    says(&message, &["line 3: parameters.mu", "it belongs in [path]", "allowed here: nu"]);
    let message = read_with("problem = \"cusp\"\n[mesh]\nelements = 9", &[]).unwrap_err();
    says(&message, &["line 3: mesh.elements", "unknown key"]);
}

#[test]
fn missing_keys() {
    says(
        &complaint("problem = \"contact\"", ""),
        &["a.toml: problem: missing", "contact, two-plates, ring-load"],
    );
    says(&complaint("law = \"hooke\"\n", ""), &["line 2: shell.law: missing", "mooney-rivlin"]);
    says(&complaint("\"hooke\"", "\"mooney-rivlin\""), &["shell.b: missing"]);
    for key in
        ["bending = 3e-5", "pressure = 3e-3", "adhesion = 2e-3", "film = 0.03333333333333333"]
    {
        let name = key.split(' ').next().unwrap();
        says(&complaint(key, ""), &["line 5", &format!("dimensionless.{name}: missing")]);
    }
    says(&complaint("end = 0.65", ""), &["line 12: path.end: missing"]);
    says(&complaint_physical("radius = \"1.5 µm\"\n", ""), &["physical.radius: missing", "25 nm"]);
    says(&complaint_physical("chi = \"0.05 N/m\"\n", ""), &["line 5: physical.chi: missing"]);
    let neither = complaint_physical("chi = \"0.05 N/m\"\nbending = \"3e-16 N·m\"\n", "");
    says(&neither, &["physical.young: missing", "young and thickness", "chi and bending"]);
    // everything that is wrong is said at once, in order
    let message = read_with("problem = \"contact\"\n[shell]\nlow = 1\n[path]\nstart = 0.5\n", &[]);
    let message = message.unwrap_err();
    says(
        &message,
        &[
            "shell.low",
            "shell.law: missing",
            "dimensionless: missing",
            "path.start = 0.5",
            "path.end",
        ],
    );
}

#[test]
fn tables_that_exclude_each_other() {
    let both = complaint("[mesh]", "[physical]\nradius = \"1 um\"\n[mesh]");
    says(&both, &["a.toml, line 10: physical", "both [dimensionless] and [physical]"]);
    let neither = read_with(
        "problem = \"contact\"\n[shell]\nlaw = \"hooke\"\n[path]\nstart = 2\nend = 1\n",
        &[],
    );
    says(&neither.unwrap_err(), &["[dimensionless] or [physical]"]);
    let mixed = complaint_physical("chi", "young = \"1 GPa\"\nchi");
    says(&mixed, &["has young, chi, bending", "either young and thickness, or chi and bending"]);
}

#[test]
fn physical_values() {
    says(
        &complaint_physical("\"50 nm\"", "\"50 Pa\""),
        &[
            "line 11: physical.film = \"50 Pa\"",
            "expected a length such as \"25 nm\"",
            "unit of pressure",
        ],
    );
    says(
        &complaint_physical("\"50 nm\"", "50"),
        &["line 11: physical.film = 50", "expected a length", "add the unit"],
    );
    says(&complaint_physical("\"50 nm\"", "\"50\""), &["the unit is missing"]);
    says(
        &complaint_physical("\"50 nm\"", "\"-50 nm\""),
        &["physical.film = \"-50 nm\": must be positive"],
    );
    says(&complaint_physical("\"50 nm\"", "\"nan nm\""), &["not a finite number"]);
    says(&complaint_physical("\"50 nm\"", "true"), &["expected a length", "got a boolean"]);
    says(
        &complaint_physical(
            "chi = \"0.05 N/m\"\nbending = \"3e-16 N·m\"",
            "young = \"2 GPa\"\nthickness = \"-25 nm\"",
        ),
        &["line 8: physical.thickness = \"-25 nm\": must be positive"],
    );
    says(
        &complaint_physical("\"1 atm\"", "\"-1 atm\""),
        &["physical.pressure", "must be zero or positive"],
    );
    says(&complaint_physical("1.5 µm", "1e-300 m"), &["check their units"]);
}

#[test]
fn values_out_of_range() {
    says(
        &complaint("poisson = 0.5", "poisson = 0.7"),
        &["line 4: shell.poisson = 0.7: must be greater than -1 and at most 0.5"],
    );
    says(&complaint("poisson = 0.5", "poisson = -1"), &["shell.poisson = -1"]);
    says(&complaint("poisson = 0.5", "poisson = nan"), &["shell.poisson = nan"]);
    says(&complaint("poisson = 0.5", "b = 1.5"), &["line 4: shell.b = 1.5: must be from 0 to 1"]);
    says(
        &complaint("bending = 3e-5", "bending = -3e-5"),
        &["line 6: dimensionless.bending = -3e-5: must be positive"],
    );
    says(&complaint("bending = 3e-5", "bending = inf"), &["dimensionless.bending = inf"]);
    says(&complaint("bending = 3e-5", "bending = 1e999"), &["dimensionless.bending = 1e999"]);
    says(&complaint("adhesion = 2e-3", "adhesion = 0"), &["dimensionless.adhesion = 0"]);
    says(
        &complaint("elements = 200", "elements = 7"),
        &["line 11: mesh.elements = 7: must be a whole number from 8"],
    );
    says(&complaint("elements = 200", "elements = 99999999999999999999"), &["mesh.elements = 9"]);
    says(&complaint("elements = 200", "elements = -200"), &["mesh.elements = -200"]);
    says(
        &complaint("start = 1.15", "start = 1.0"),
        &["line 13: path.start = 1.0: must be greater than 1"],
    );
    says(&complaint("start = 1.15", "start = nan"), &["path.start = nan"]);
    says(&complaint("end = 0.65", "end = 0"), &["line 14: path.end = 0"]);
    says(
        &complaint("end = 0.65", "end = 1.15"),
        &["line 14: path.end = 1.15: must be different from path.start"],
    );
    says(
        &complaint("end = 0.65", "end = 0.65\nmax_step = 0"),
        &["path.max_step = 0: must be positive"],
    );
    says(
        &complaint("end = 0.65", "end = 0.65\nmax_step = 0.1\nmin_step = 1"),
        &["path.min_step = 1: must be at most path.max_step"],
    );
    says(&complaint("end = 0.65", "end = 0.65\nmax_points = 1"), &["path.max_points = 1"]);
    says(
        &complaint("\"hooke\"", "\"hook\""),
        &[
            "line 3: shell.law = \"hook\": must be one of hooke, mooney-rivlin, skalak",
            "did you mean \"hooke\"",
        ],
    );
    says(
        &complaint("\"contact\"", "\"bartu\""),
        &[
            "line 1: problem = \"bartu\"",
            "did you mean \"bratu\"",
            "contact, two-plates, ring-load, bratu",
        ],
    );
    let message = read_with("problem = \"cusp\"\n[path]\nstart = 1\n", &[]).unwrap_err();
    says(&message, &["path.start = 1: must be different from path.end"]);
    says(
        &complaint("problem", "name = \"a/b\"\nproblem"),
        &["line 1: name = \"a/b\": must be a name fit for a folder"],
    );
}

#[test]
fn values_of_the_wrong_type() {
    says(
        &complaint("bending = 3e-5", "bending = \"3e-5\""),
        &["dimensionless.bending = \"3e-5\": expected a number, got a string", "without quotes"],
    );
    says(&complaint("bending = 3e-5", "bending = [1]"), &["expected a number, got an array"]);
    says(&complaint("bending = 3e-5", "bending = 1979-05-27"), &["got a date"]);
    says(
        &complaint("elements = 200", "elements = 200.0"),
        &["mesh.elements = 200.0: expected an integer, got a float"],
    );
    says(&complaint("elements = 200", "elements = {a = 1}"), &["expected an integer, got a table"]);
    says(&complaint("\"hooke\"", "3"), &["shell.law = 3: expected a string, got an integer"]);
    let message =
        read_with(&format!("mesh = 3\n{}", GOOD.replace("[mesh]\nelements = 200\n", "")), &[]);
    says(&message.unwrap_err(), &["line 1: mesh = 3: expected a table [mesh], got an integer"]);
    says(&complaint("[mesh]", "[[mesh]]"), &["line 10: mesh", "got an array"]);
}

#[test]
fn text_that_is_not_toml() {
    says(
        &complaint("poisson = 0.5", "law = \"skalak\""),
        &["a.toml, line 4: duplicate key \"law\"", "keep one"],
    );
    says(&complaint("[mesh]", "[shell]"), &["a.toml, line 10: duplicate key \"shell\""]);
    says(
        &complaint("poisson = 0.5", "poisson = "),
        &["a.toml, line 4: not valid TOML", "poisson ="],
    );
    says(&complaint("poisson = 0.5", "poisson 0.5"), &["a.toml, line 4: not valid TOML"]);
    says(&read_with(&"[".repeat(100_000), &[]).unwrap_err(), &["a.toml, line 1"]);
    says(
        &read_with(&format!("{}x = 1", "a.".repeat(100_000)), &[]).unwrap_err(),
        &["a.toml, line 1"],
    );
}

#[test]
fn overrides_replace_values_and_say_where_they_came_from() {
    let set = |text: &str| read_with(GOOD, &[given(text)]);
    let case = set("dimensionless.adhesion=3e-3").unwrap().case;
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    assert_eq!(contact.groups.adhesion, 3e-3);
    assert_eq!(set(" path . end = 0.7").unwrap().case.path.end, 0.7);
    let case = set("shell.law=skalak").unwrap().case;
    assert!(matches!(
        case.problem,
        ProblemCase::Contact(ContactCase { shell: Shell { law: Law::Skalak, .. }, .. })
    ));
    let case = read_with(PHYSICAL, &[given("physical.film=2.5 um")]).unwrap().case;
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    assert_eq!(contact.physical.as_ref().unwrap().film.si, 2.5e-6);
    let case = read_with(GOOD, &[given("mesh.elements=90"), elements("100")]).unwrap().case;
    assert!(matches!(
        case.problem,
        ProblemCase::Contact(ContactCase { mesh: MeshCase { elements: 100, .. }, .. })
    ));

    says(&set("shell.poisson=2").unwrap_err(), &["a.toml, --set: shell.poisson = 2: must be"]);
    says(
        &set("shell.possion=0.3").unwrap_err(),
        &["--set: shell.possion: unknown key", "did you mean"],
    );
    says(&set("path.end=").unwrap_err(), &["--set: path.end = : expected a number, got a string"]);
    says(&set("path.end").unwrap_err(), &["--set path.end: expected KEY=VALUE"]);
    says(&set("=3").unwrap_err(), &["--set =3: the key is empty"]);
    says(&set("problem.x=3").unwrap_err(), &["--set problem.x=3: \"problem\" is not a table"]);
    says(&set("physical.radius=1 um").unwrap_err(), &["both [dimensionless] and [physical]"]);
    says(&set(&format!("{}=1", "a.".repeat(100_000))).unwrap_err(), &["--set"]);
    let message = read_with(GOOD, &[elements("4")]).unwrap_err();
    says(&message, &["a.toml, --elements: mesh.elements = 4: must be a whole number from 8"]);
}

#[test]
fn what_has_no_effect_is_noted() {
    let loaded = read_with(&GOOD.replace("poisson", "b = 1.0\npoisson"), &[]).unwrap();
    assert_eq!(loaded.notes, ["shell.b has no effect: hooke has no such parameter"]);
}

#[test]
fn catalogue_problems_resolve_by_name() {
    let loaded = load("bratu".as_ref(), &[given("path.end=3")], &catalogue()).unwrap();
    assert_eq!(loaded.case.path.end, 3.0);
    let ProblemCase::Catalogue(bratu) = &loaded.case.problem else { panic!("{loaded:?}") };
    assert_eq!((bratu.elements, bratu.parameters["length"]), (Some(64), 1.0));
    assert_eq!(load("fig12".as_ref(), &[], &[]).unwrap().case.name, "fig12");
    let message = load("brattu".as_ref(), &[], &catalogue()).unwrap_err().to_string();
    says(&message, &["brattu", "did you mean \"bratu\"", "fig12", "cusp"]);
}

#[test]
fn catalogue_problems_name_what_they_refuse() {
    let refused = |name: &str, set: &str| {
        load(name.as_ref(), &[given(set)], &catalogue()).unwrap_err().to_string()
    };
    for (name, set, parts) in [
        ("bratu", "parameters.length=-1", ["parameters.length = -1", "must be positive"]),
        ("bratu", "mesh.elements=1001", ["mesh.elements = 1001", "a whole number from 8 to 1000"]),
        ("cusp", "path.start=4", ["path.start = 4", "must be from -3 to 3"]),
        ("cusp", "path.start=1", ["path.start = 1", "different from path.end"]),
    ] {
        says(&refused(name, set), &parts);
    }
}

#[test]
fn files_that_cannot_be_read() {
    let place = tempfile::tempdir().unwrap();
    let complaint = |name: &str| {
        let path = place.path().join(name);
        let message = load(&path, &[], &[]).unwrap_err().to_string();
        says(&message, &[&path.display().to_string()]);
        message
    };
    says(&complaint("gone.toml"), &["no such file"]);
    std::fs::create_dir(place.path().join("folder.toml")).unwrap();
    says(&complaint("folder.toml"), &["this is a folder"]);
    std::fs::write(place.path().join("latin.toml"), b"a = 1\n# \xb5m\n").unwrap();
    says(&complaint("latin.toml"), &["line 2", "not UTF-8", "save"]);
    std::fs::write(place.path().join("long.toml"), vec![b'#'; 1 << 21]).unwrap();
    says(&complaint("long.toml"), &["not a case file"]);
    std::fs::write(place.path().join("mine.toml"), GOOD).unwrap();
    assert_eq!(load(&place.path().join("mine.toml"), &[], &[]).unwrap().case.name, "mine");
}

#[test]
fn every_file_name_makes_a_name_that_a_case_may_give_itself() {
    let place = tempfile::tempdir().unwrap();
    let names = [
        ("my case.toml", "my case"),
        ("...toml", "case"),
        (".hidden.toml", "hidden"),
        ("a\nb:c.toml", "a_b_c"),
        ("μ\"x.toml", "μ\"x"),
    ];
    for (file, name) in names {
        let path = place.path().join(file);
        std::fs::write(&path, GOOD).unwrap();
        let case = load(&path, &[], &[]).unwrap().case;
        assert_eq!(case.name, name);
        assert_eq!(read(&case.to_toml()), case);
    }
}

/// One random change of a text.
fn mutate(text: &mut Vec<char>, (kind, at, with): (u8, usize, char)) {
    let at = at % (text.len() + 1);
    match kind % 5 {
        0 => text.insert(at, with),
        1 if at < text.len() => text[at] = with,
        2 if at < text.len() => drop(text.remove(at)),
        3 => text.truncate(at),
        _ => {
            // a line twice, or moved
            let line: String =
                text.iter().collect::<String>().lines().nth(at % 14).unwrap_or("").into();
            text.extend(line.chars().chain(['\n']));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn no_text_makes_it_panic(
        physical in any::<bool>(),
        changes in proptest::collection::vec(
            (any::<u8>(), any::<usize>(), prop_oneof![proptest::char::range(' ', '~'), any::<char>(), Just('\n')]),
            1..6,
        ),
    ) {
        let mut text: Vec<char> = if physical { PHYSICAL } else { GOOD }.chars().collect();
        for change in changes {
            mutate(&mut text, change);
        }
        let text: String = text.into_iter().collect();
        match read_with(&text, &[]) {
            Err(message) => prop_assert!(message.contains("a.toml"), "{}", message),
            Ok(loaded) => {
                let again = load_text("b", "b", &loaded.case.to_toml(), &[], &catalogue()).unwrap();
                prop_assert_eq!(again.case, loaded.case);
            }
        }
    }

    #[test]
    fn no_override_makes_it_panic(text in "\\PC{0,40}", value in "[-+.0-9a-z\"'{}\\[\\] ]{0,12}") {
        let _ = read_with(GOOD, &[given(&text)]);
        let _ = read_with(GOOD, &[given(&format!("path.end={value}"))]);
    }
}

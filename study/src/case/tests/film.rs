//! Potentials of the film in cases.

use super::*;

const DLVO: &str = "film = 0.03333333333333333\npotential = \"dlvo\"\ndebye = 0.15\n";

fn dlvo(text: &str) -> Result<LoadedCase, String> {
    read_with(&GOOD.replace("film = 0.03333333333333333\n", text), &[])
}

#[test]
fn another_potential_is_read_and_written() {
    let case = dlvo(DLVO).unwrap().case;
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    let Film::Dlvo(film) = contact.potential else { panic!("{contact:?}") };
    assert_eq!((film.debye(), contact.groups.adhesion), (0.15, 2e-3));
    let text = case.to_toml();
    assert!(text.contains("potential = \"dlvo\"") && text.contains("debye = 0.15"), "{text}");
    assert_eq!(read_with(&text, &[]).unwrap().case, case);
    // the first potential goes without saying
    assert!(!read(GOOD).to_toml().contains("potential"));
    assert_eq!(
        dlvo("film = 0.03333333333333333\npotential = \"four-two\"\n").unwrap().case,
        read(GOOD)
    );
}

#[test]
fn each_plate_has_a_potential_of_its_own() {
    let text = SHIPPED.iter().find(|(name, _)| *name == "two-plates").unwrap().1;
    let text = text.replacen("device = \"grip\"", "potential = \"dlvo\"\ndebye = 0.2 #", 1);
    let case = read(&text);
    let ProblemCase::TwoPlates(plates) = &case.problem else { panic!("{case:?}") };
    let [Some(top), Some(bottom)] = plates.plates else { panic!("{plates:?}") };
    assert!(matches!(top.potential, Film::Dlvo(film) if film.debye() == 0.2));
    assert_eq!(bottom.potential, Film::FourTwo);
    assert_eq!(read(&case.to_toml()), case);
}

#[test]
fn mistakes_about_potentials_are_named() {
    let message = |text: &str| dlvo(text).unwrap_err();
    let film = "film = 0.03333333333333333\n";
    says(
        &message(&format!("{film}potential = \"dlvo\"\n")),
        &["dimensionless.debye", "such as 0.1"],
    );
    for bad in ["0.34", "0.3333333333333333333", "0.009", "-1", "nan"] {
        let text = format!("{film}potential = \"dlvo\"\ndebye = {bad}\n");
        says(&message(&text), &["line 11: dimensionless.debye", "less than 1/3"]);
    }
    says(
        &message(&format!("{film}debye = 0.1\n")),
        &["line 10: dimensionless.debye = 0.1", "four-two has no such key", "potential = \"dlvo\""],
    );
    says(
        &message(&format!("{film}potential = \"dvlo\"\n")),
        &["line 10: dimensionless.potential = \"dvlo\"", "four-two", "dlvo"],
    );
}

#[test]
fn surface_forces_make_adhesion_and_film() {
    let (_, text) = SHIPPED.iter().find(|(name, _)| *name == "dlvo").unwrap();
    let case = read(text);
    let ProblemCase::Contact(contact) = &case.problem else { panic!("{case:?}") };
    let (groups, physical) = (contact.groups, contact.physical.as_ref().unwrap());
    let Film::Dlvo(film) = contact.potential else { panic!("{groups:?}") };
    // A = 12π w0 δ²/(1 − 2ρ)
    let (w0, length) = (groups.adhesion * 0.05, groups.film * 1e-6);
    let hamaker = 12.0 * std::f64::consts::PI * w0 * length * length / (1.0 - 2.0 * film.debye());
    assert!((hamaker / 1e-20 - 1.0).abs() < 1e-12, "{hamaker:e}");
    assert!((film.debye() * length / 3e-9 - 1.0).abs() < 1e-12);
    assert_eq!((physical.adhesion.si, physical.film.si), (w0, length));
    assert_eq!(read(&case.to_toml()), case);
    assert!(case.to_toml().contains("hamaker = \"1e-20 J\""), "{}", case.to_toml());

    let changed = |from: &str, to: &str| read_with(&text.replace(from, to), &[]).unwrap_err();
    says(
        &changed("\"40 mV\"", "\"4 mV\""),
        &["physical.hamaker", "no minimum", "must be less than"],
    );
    says(&changed("\"1e-20 J\"", "\"1e-60 J\""), &["physical.hamaker", "too weak"]);
    says(
        &changed("\"1e-20 J\"", "\"1e-20 N/m\""),
        &["physical.hamaker", "expected a Hamaker constant"],
    );
    says(&changed("\"40 mV\"", "\"0 mV\""), &["physical.surface_potential", "not zero"]);
    says(&changed("debye = \"3 nm\"\n", ""), &["physical.debye"]);
    says(&changed("surface_potential = \"40 mV\"\n", ""), &["physical.double_layer", "30 mV"]);
    let both = "surface_potential = \"40 mV\"\ndouble_layer = \"4 mJ/m2\"\n";
    says(
        &changed("surface_potential = \"40 mV\"\n", both),
        &["physical.surface_potential", "keep one"],
    );
    let given = "potential = \"dlvo\"\nfilm = \"20 nm\"\n";
    says(&changed("potential = \"dlvo\"\n", given), &["physical.film", "dlvo has no such key"]);
    let by_strength =
        text.replace("surface_potential = \"40 mV\"", "double_layer = \"0.67 mJ/m2\"");
    assert!(read_with(&by_strength, &[]).is_ok());
}

#[test]
fn an_override_exchanges_the_potential() {
    let with = |name: &str, texts: &[&str]| {
        let overrides: Vec<Override> = texts.iter().copied().map(Override::new).collect();
        load(name.as_ref(), &overrides, &[])
    };
    let dlvo = ["physical.potential=dlvo", "physical.hamaker=5 zJ", "physical.debye=5 nm"];
    let loaded =
        with("polymer", &[&dlvo[..], &["physical.double_layer=2 mJ/m2"]].concat()).unwrap();
    assert!(loaded.notes.iter().any(|note| note.starts_with("physical.film is passed over")));
    let ProblemCase::Contact(contact) = &loaded.case.problem else { panic!("{loaded:?}") };
    assert!(matches!(contact.potential, Film::Dlvo(_)));
    // what is given with it still must go with it
    let both = with("polymer", &[&dlvo[..], &["physical.film=20 nm"]].concat()).unwrap_err();
    assert!(both.to_string().contains("potential dlvo has no such key"), "{both}");
}

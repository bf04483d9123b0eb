//! Titles that say which shell or problem a picture shows.

use study::case::{
    Film, Law, PhysicalCase, PhysicalShell, ProblemCase, ResolvedCase, Shell, Stiffness, catalogue,
    shown,
};
use study::units::Quantity;

/// A title with a second line below it: law and groups of a shell, in the units in which the case gives
/// them; of a problem of the catalogue, what it is and its parameters.
pub fn titled(title: &str, case: &ResolvedCase) -> String {
    let more = match &case.problem {
        ProblemCase::Contact(contact) => {
            let numbers = match &contact.physical {
                Some(physical) => physically(physical),
                None => {
                    let g = &contact.groups;
                    listed(&[
                        ("k_{b}/(χR₀²)", g.bending),
                        ("P_{A}R₀/χ", g.pressure),
                        ("w₀/χ", g.adhesion),
                        ("δ_{A}/R₀", g.film),
                        ("γ/χ", g.surface_tension),
                    ])
                }
            };
            let film = potential(&contact.potential);
            format!("{}; {numbers}; {film}", law(contact.shell))
        }
        ProblemCase::TwoPlates(plates) => {
            let sides = [("above", plates.plates[0]), ("below", plates.plates[1])];
            let films: String = sides
                .into_iter()
                .zip(&plates.physical_plates)
                .filter_map(|((side, plate), given)| Some((side, plate?, given)))
                .map(|(side, plate, given)| {
                    let depth = match given {
                        Some(given) => film(&given.adhesion, &given.film),
                        None => {
                            let (adhesion, film) = (number(plate.adhesion), number(plate.film));
                            format!("w₀/χ = {adhesion}, δ_{{A}}/R₀ = {film}")
                        }
                    };
                    format!("; {side} {depth}, {}", potential(&plate.potential))
                })
                .collect();
            let groups = match &plates.physical {
                Some(physical) => shell(physical),
                None => listed(&[
                    ("k_{b}/(χR₀²)", plates.bending),
                    ("P_{A}R₀/χ", plates.pressure),
                    ("γ/χ", plates.surface_tension),
                ]),
            };
            format!("{}; {groups}{films}", law(plates.shell))
        }
        ProblemCase::RingLoad(ring) => {
            let groups = match &ring.physical {
                Some(physical) => shell(physical),
                None => listed(&[
                    ("k_{b}/(χR₀²)", ring.groups.bending),
                    ("P_{A}R₀/χ", ring.groups.pressure),
                ]),
            };
            format!("{}; {groups}", law(ring.shell))
        }
        ProblemCase::Catalogue(problem) => {
            let entry = catalogue().into_iter().find(|entry| entry.name == problem.name);
            let summary = entry.map(|entry| entry.summary).unwrap_or_default();
            let values: Vec<String> = problem
                .parameters
                .iter()
                .map(|(name, value)| format!("{name} = {}", number(*value)))
                .collect();
            let gap = if values.is_empty() || summary.is_empty() { "" } else { "; " };
            format!("{summary}{gap}{}", values.join(", "))
        }
        _ => String::new(),
    };
    if more.is_empty() { title.to_owned() } else { format!("{title}\n{more}") }
}

/// A title fit for a picture: its first line shortened where a name is very long.
pub(crate) fn fit(title: &str) -> String {
    match title.split_once('\n') {
        Some((first, more)) => format!("{}\n{more}", shown(first)),
        None => shown(title),
    }
}

fn law(shell: Shell) -> String {
    let name = match shell.law {
        Law::Hooke => "Hooke's law".to_owned(),
        Law::MooneyRivlin { b } => format!("Mooney-Rivlin's law, b = {}", number(b)),
        Law::Skalak => "Skalak's law".to_owned(),
    };
    format!("{name}, ν = {}", number(shell.poisson))
}

/// The potential of a film, with what it has beside depth and length.
fn potential(film: &Film) -> String {
    match film {
        Film::FourTwo => "4-2 film".to_owned(),
        Film::Dlvo(dlvo) => format!("DLVO film, λ/δ_{{A}} = {}", number(dlvo.debye())),
    }
}

/// A quantity as it was written, its power of ten raised.
fn quantity(text: &str) -> String {
    match text.split_once(' ') {
        Some((value, unit)) if value.contains(['e', 'E']) => value
            .parse()
            .map_or_else(|_| text.to_owned(), |value| format!("{} {unit}", number(value))),
        _ => text.to_owned(),
    }
}

/// What is zero is left out.
fn listed(values: &[(&str, f64)]) -> String {
    let known = values.iter().filter(|(_, value)| *value != 0.0);
    let words: Vec<String> =
        known.map(|(name, value)| format!("{name} = {}", number(*value))).collect();
    words.join(", ")
}

fn physically(physical: &PhysicalCase) -> String {
    let mut words = wall(&physical.radius, &physical.stiffness);
    words.push(format!("P_{{A}} = {}", physical.pressure.text));
    words.push(film(&physical.adhesion, &physical.film));
    words.extend(tension(&physical.surface_tension));
    micro(&words.join(", "))
}

/// A shell in physical units without its film.
fn shell(physical: &PhysicalShell) -> String {
    let mut words = wall(&physical.radius, &physical.stiffness);
    if physical.pressure.si != 0.0 {
        words.push(format!("P_{{A}} = {}", physical.pressure.text));
    }
    words.extend(physical.surface_tension.as_ref().and_then(tension));
    micro(&words.join(", "))
}

fn micro(words: &str) -> String {
    words.replace(" um", " µm").replace(" uN", " µN")
}

fn wall(radius: &Quantity, stiffness: &Stiffness) -> Vec<String> {
    let mut words = vec![format!("R₀ = {}", radius.text)];
    match stiffness {
        Stiffness::Homogeneous { young, thickness } => {
            words.push(format!("E = {}, h = {}", young.text, thickness.text));
        }
        Stiffness::Moduli { chi, bending } => {
            let (chi, bending) = (quantity(&chi.text), quantity(&bending.text));
            words.push(format!("χ = {chi}, k_{{b}} = {bending}"));
        }
    }
    words
}

fn film(adhesion: &Quantity, film: &Quantity) -> String {
    micro(&format!("w₀ = {}, δ_{{A}} = {}", quantity(&adhesion.text), film.text))
}

fn tension(tension: &Quantity) -> Option<String> {
    (tension.si != 0.0).then(|| format!("γ = {}", tension.text))
}

/// Four digits, with a power of ten where the number is small or large.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-2..1e4).contains(&size) {
        let text = format!("{value:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
    }
    let text = format!("{value:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
    let power = format!("10^{{{}}}", exponent.replace('-', "−"));
    if mantissa == "1" { power } else { format!("{mantissa}·{power}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::case::{Override, load};

    fn of(case: &str, keys: &[&str]) -> String {
        let overrides: Vec<Override> = keys.iter().copied().map(Override::new).collect();
        titled("it", &load(case.as_ref(), &overrides, &catalogue()).unwrap().case)
    }

    #[test]
    fn a_title_says_law_and_groups_or_the_problem() {
        assert_eq!(
            of("fig12", &["shell.law=skalak", "shell.poisson=0.3"]),
            "it\nSkalak's law, ν = 0.3; k_{b}/(χR₀²) = 3·10^{−5}, P_{A}R₀/χ = 3·10^{−3}, \
             w₀/χ = 2·10^{−3}, δ_{A}/R₀ = 0.0333; 4-2 film"
        );
        let dlvo = ["dimensionless.potential=dlvo", "dimensionless.debye=0.1"];
        assert!(of("fig12", &dlvo).ends_with("; DLVO film, λ/δ_{A} = 0.1"));
        assert!(of("polymer", &[]).contains("w₀ = 10^{−4} N/m"));
        assert!(
            of("polymer", &[]).contains("R₀ = 1.5 µm, E = 2.1 GPa, h = 25 nm, P_{A} = 101325 Pa")
        );
        assert!(of("cusp", &[]).ends_with("; lambda = 1"), "{}", of("cusp", &[]));
        assert!(
            of("two-plates", &[]).contains("; above w₀/χ = 2·10^{−3}, δ_{A}/R₀ = 0.0333, 4-2 film")
        );
        assert!(of("ring-load", &[]).contains("k_{b}/(χR₀²) = 9.158·10^{−6}"));
    }

    #[test]
    fn numbers_have_four_digits() {
        let all = [0.0, 0.5, -0.3, 1e-5, 2.5e7, 1234.56789].map(number);
        assert_eq!(all, ["0", "0.5", "−0.3", "10^{−5}", "2.5·10^{7}", "1234.5679"]);
    }
}

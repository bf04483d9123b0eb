//! What each figure shows: `figures/figNN.toml`, embedded.

use serde::Deserialize;

/// A figure.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    /// Its number in the paper.
    pub number: u32,
    /// Title.
    pub title: String,
    /// What is seen, with the parameters.
    pub caption: String,
    /// What is doubtful in the paper, and how it was decided.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Branches that are traced.
    #[serde(default, rename = "curve")]
    pub curves: Vec<CurveSpec>,
    /// Panels.
    #[serde(rename = "panel")]
    pub panels: Vec<PanelSpec>,
}

/// A branch that is traced.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CurveSpec {
    /// Its name in the figure.
    pub name: String,
    /// The case it starts from, of `figures/cases`.
    pub case: String,
    /// Values that replace those of the case, as `--set` takes them.
    #[serde(default)]
    pub set: Vec<String>,
    /// For the legend.
    pub label: String,
    /// Whether a claim about it rests on modes without its symmetries.
    #[serde(default)]
    pub stability: bool,
}

/// A panel.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PanelSpec {
    /// Its letter, unlike those of the other panels; empty for the only one.
    pub letter: String,
    /// What it shows.
    pub title: String,
    /// What is drawn.
    pub show: Show,
    /// The branches, by name.
    pub curves: Vec<String>,
    /// What stands on the horizontal axis, and in which the states are given.
    #[serde(default)]
    pub x: Abscissa,
    /// Unit of the force.
    #[serde(default)]
    pub y: Ordinate,
    /// Deformations of the states that are shown.
    #[serde(default)]
    pub states: Vec<f64>,
    /// Which time the branch takes that deformation, counted from the zero of the force; −1: the last
    /// time before it. The first by default.
    #[serde(default)]
    pub passes: Vec<i32>,
    /// Parts of the energy; all by default.
    #[serde(default)]
    pub parts: Vec<Part>,
    /// A part of the energy on the right axis.
    pub right: Option<Part>,
    /// Range of the horizontal axis.
    pub x_range: Option<[f64; 2]>,
    /// Range of the vertical axis.
    pub y_range: Option<[f64; 2]>,
    /// Laws laid over the curves, those of the first one.
    #[serde(default)]
    pub laws: Vec<Law>,
    /// Whether the branches of the ring load are drawn too.
    #[serde(default)]
    pub ring_load: bool,
}

impl Manifest {
    /// Number and title.
    pub(crate) fn heading(&self) -> String {
        match self.number {
            STABILITY => self.title.clone(),
            number => format!("Figure {number}. {}", self.title),
        }
    }

    /// Whether modes without the symmetries of the branches are counted.
    pub(crate) fn scans(&self) -> bool {
        self.panels.iter().any(|panel| panel.show == Show::Windows)
    }
}

/// What a panel draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Show {
    /// Force curves.
    Force,
    /// Parts of the energy.
    Energies,
    /// Meridians.
    Shapes,
    /// Disjoining pressure.
    Pressure,
    /// Stretches on which modes are unstable, without the symmetries of the branch too.
    Windows,
}

/// What stands on the horizontal axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Abscissa {
    /// Deformation of one pole in `R0`.
    #[default]
    Deformation,
    /// The same in nanometres.
    Nm,
    /// The total approach of the plates in micrometres: twice the deformation.
    ApproachUm,
    /// Deformation of one pole in thicknesses.
    Thicknesses,
    /// Plate distance in `R0`.
    Distance,
}

/// Unit of the force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Ordinate {
    /// `√(χk_b)`.
    #[default]
    Reduced,
    /// Nanonewtons.
    #[serde(rename = "nN")]
    NanoNewton,
    /// `10⁶F/(2πEhR0)`, of the benchmark.
    Benchmark,
}

/// A part of the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Part {
    /// Sum of all.
    Total,
    /// Membrane.
    Stretching,
    /// Bending.
    Bending,
    /// Interaction with the plates.
    Film,
    /// Gas.
    Gas,
    /// Surface tension.
    Surface,
}

impl Part {
    /// Its name in tables, and of its colour.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Part::Total => "total",
            Part::Stretching => "stretching",
            Part::Bending => "bending",
            Part::Film => "film",
            Part::Gas => "gas",
            Part::Surface => "surface",
        }
    }
}

/// A law of [`shell_contact::asymptotics`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Law {
    /// Eq. (32).
    Reissner,
    /// Eq. (33) as printed.
    PrintedPogorelov,
    /// The same between plates.
    PlatePogorelov,
    /// Eq. (39) in full.
    Cubic,
    /// Reissner's and the measured share of the cubic law.
    LinearAndCubicShare,
}

macro_rules! embedded {
    ($($number:literal: $file:literal),* $(,)?) => {
        &[$(($number, include_str!(concat!("../figures/", $file)))),*]
    };
}

/// Every figure that is computed: number and manifest.
pub(crate) const FIGURES: &[(u32, &str)] = embedded! {
    4: "fig04.toml", 5: "fig05.toml", 6: "fig06.toml", 7: "fig07.toml", 9: "fig09.toml",
    10: "fig10.toml", 11: "fig11.toml", 12: "fig12.toml", 13: "fig13.toml", 14: "fig14.toml",
    15: "fig15.toml", 16: "fig16.toml", 17: "fig17.toml", 18: "fig18.toml", 19: "fig19.toml",
    20: "fig20.toml",
};

/// The number of the figure that is not of the paper.
pub(crate) const STABILITY: u32 = 0;

/// That figure: number and manifest.
pub(crate) const OWN: (u32, &str) = (STABILITY, include_str!("../figures/stability.toml"));

/// What names of files begin with.
pub(crate) fn stem(figure: u32) -> String {
    if figure == STABILITY { "stability".to_owned() } else { format!("fig{figure:02}") }
}

/// Figures in which nothing is computed: number and why.
pub(crate) const SCHEMATIC: &[(u32, &str)] = &[
    (1, "a sketch of the bubble under the cantilever and of its coordinates"),
    (2, "a sketch of the tensions and moments on a patch of the shell"),
    (3, "a sketch of the compression, and the interaction potential of Eq. (13)"),
    (8, "a sketch of the contact, transition and outer regions"),
];

macro_rules! cases {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../figures/cases/", $name, ".toml")))),*]
    };
}

/// The cases from which curves start: name and text.
pub(crate) const CASES: &[(&str, &str)] =
    cases!["hard", "polymer", "soft", "lipid", "polyelectrolyte", "phospholipid", "benchmark",];

/// The manifest of a figure.
///
/// # Errors
/// When the embedded text is not one, which a test excludes.
pub(crate) fn parse(text: &str) -> Result<Manifest, toml::de::Error> {
    toml::from_str(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn manifests_parse_and_name_only_what_exists() {
        for (number, text) in FIGURES.iter().chain([&OWN]) {
            let m = parse(text).unwrap();
            assert_eq!(m.number, *number);
            for curve in &m.curves {
                assert!(CASES.iter().any(|(name, _)| *name == curve.case), "{}", curve.case);
                assert!(m.panels.iter().any(|p| p.curves.contains(&curve.name)), "{}", curve.name);
            }
            for (i, panel) in m.panels.iter().enumerate() {
                assert!(m.panels[..i].iter().all(|p| p.letter != panel.letter), "{number}");
                assert!(!panel.curves.is_empty());
                for name in &panel.curves {
                    assert!(m.curves.iter().any(|c| c.name == *name), "{number}: {name}");
                }
                assert!(panel.passes.is_empty() || panel.passes.len() == panel.states.len());
                let of_states = matches!(panel.show, Show::Shapes | Show::Pressure);
                assert_eq!(of_states, !panel.states.is_empty());
            }
        }
        let numbers: Vec<u32> = FIGURES.iter().chain(SCHEMATIC).map(|(n, _)| *n).collect();
        assert_eq!(numbers.len(), 20);
    }
}

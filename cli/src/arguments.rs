//! The command line.

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;
use study::case::Override;
use study::sweep::Shard;

/// Bifurcation diagrams: branches of solutions followed around their folds.
#[derive(Debug, Parser)]
#[command(
    name = "arclen",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done; 1 the results could not be written; 2 usage or input error, \
                  nothing created; 3 stopped early, files complete for what was computed."
)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Follow a branch; write its points, special points and pictures
    Trace(TraceArguments),
    /// Follow a branch and all that leave it; write them as one diagram
    Diagram(DiagramArguments),
    /// Follow the periodic orbits that leave Hopf points; write them, what is known of them and pictures
    Orbits(OrbitsArguments),
    /// Close and open the plates once, with the jumps between stable states; write the path, the energy
    /// it dissipates and pictures
    Cycle(CycleArguments),
    /// Follow special points in two parameters; write the curves, the special points on them and a
    /// picture
    Map(MapArguments),
    /// Open a page on which sliders move the parameters of a case and its branch follows
    Explore(ExploreArguments),
    /// Fit measured force curves: moduli, thickness, adhesion, contact point, and how well they are known
    Fit(FitArguments),
    /// Compute figures of the reference paper, and compare its claims with them
    Figure(FigureArguments),
    /// Trace many cases, over grids and lists of parameters, on all cores
    Sweep(SweepArguments),
    /// Unite the results of the shards of a sweep
    Merge(MergeArguments),
    /// Print a case with every default written out, or say what is wrong with it
    Check(CaseArguments),
    /// List the cases and problems that have names
    List,
    /// Print a completion script for a shell
    Completions {
        /// Which shell
        shell: Shell,
    },
}

/// The overrides of `--set`.
pub(crate) fn set(texts: &[String]) -> impl Iterator<Item = Override> {
    texts.iter().map(|text| Override::given_by("--set", text))
}

impl OutputArguments {
    /// The overrides of `--picture`.
    pub(crate) fn looks(&self) -> impl Iterator<Item = Override> {
        self.picture.iter().map(|text| Override::given_by("--picture", format!("picture.{text}")))
    }
}

/// The override of an option that is short for another.
pub(crate) fn short(flag: &'static str, key: &str, value: Option<&str>) -> Option<Override> {
    value.map(|value| Override::given_by(flag, format!("{key}={value}")))
}

/// Which case.
#[derive(Debug, Args)]
pub(crate) struct CaseArguments {
    /// A case file, or a name from "arclen list"
    #[arg(value_name = "CASE.toml|NAME")]
    pub(crate) case: PathBuf,
    /// Number of elements, as --set mesh.elements=N
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) elements: Option<String>,
    /// Number of eigenvalues to compute at every point, the most unstable ones, as
    /// --set path.eigenvalues=K
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) eigenvalues: Option<String>,
    /// Replace a value of the case, e.g. --set dimensionless.adhesion=3e-3; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

impl CaseArguments {
    /// The files that are read.
    pub(crate) fn inputs(&self) -> [PathBuf; 1] {
        [self.case.clone()]
    }

    /// The overrides, in the order in which they are applied.
    pub(crate) fn overrides(&self) -> Vec<Override> {
        let own = [
            ("--elements", "mesh.elements", &self.elements),
            ("--eigenvalues", "path.eigenvalues", &self.eigenvalues),
        ];
        let own =
            own.into_iter().filter_map(|(flag, key, value)| short(flag, key, value.as_deref()));
        set(&self.set).chain(own).collect()
    }

    /// The same with those of `--picture` after them.
    pub(crate) fn with_looks(&self, output: &OutputArguments) -> Vec<Override> {
        self.overrides().into_iter().chain(output.looks()).collect()
    }

    /// The words that give the same case on a command line.
    pub(crate) fn words(&self) -> Vec<String> {
        let own = [("--elements", &self.elements), ("--eigenvalues", &self.eigenvalues)];
        let own = own.into_iter().filter_map(|(flag, value)| Some((flag, value.clone()?)));
        let sets = self.set.iter().map(|text| ("--set", text.clone()));
        let options = sets.chain(own).flat_map(|(flag, value)| [flag.to_owned(), value]);
        std::iter::once(self.case.to_string_lossy().into_owned()).chain(options).collect()
    }
}

/// Which case, and how its page is served.
#[derive(Debug, Args)]
pub(crate) struct ExploreArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Port of the loopback interface [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Print the page's address only, and open no browser
    #[arg(long)]
    pub(crate) no_open: bool,
}

/// Which case, and what to do with its branch.
#[derive(Debug, Args)]
pub(crate) struct TraceArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Write report.html too, a page on which to move along the branch and look at its states
    #[arg(long)]
    pub(crate) report: bool,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// Which case, and what to do with its cycle.
#[derive(Debug, Args)]
pub(crate) struct CycleArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Write report.html too, a page on which to move along both ways and the complete branch and look
    /// at their states
    #[arg(long)]
    pub(crate) report: bool,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// Which case, and what to do with its diagram.
#[derive(Debug, Args)]
pub(crate) struct DiagramArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Most branch points between a branch and the first one, as --set diagram.depth=N
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) depth: Option<String>,
    /// Begin anew, even if the folder holds an unfinished diagram: the same command otherwise goes
    /// on from what is kept in DIR/unfinished
    #[arg(long)]
    pub(crate) restart: bool,
    /// Write report.html too, a page on which to move along the branches and look at their states
    #[arg(long)]
    pub(crate) report: bool,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

impl DiagramArguments {
    /// The case, with the depth among its overrides.
    pub(crate) fn overrides(&self) -> Vec<Override> {
        let depth = short("--depth", "diagram.depth", self.depth.as_deref());
        self.case.overrides().into_iter().chain(depth).chain(self.output.looks()).collect()
    }
}

/// Which case, and which of its periodic orbits.
#[derive(Debug, Args)]
pub(crate) struct OrbitsArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Only the cycles that leave this Hopf point, counted from 0 in the order of the branches
    /// [default: all]
    #[arg(long, value_name = "K")]
    pub(crate) hopf: Option<usize>,
    /// Most period doublings and branch points between a branch of cycles and its Hopf point, as
    /// --set diagram.cycle_depth=N
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) depth: Option<String>,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

impl OrbitsArguments {
    /// The case, with the depth among its overrides.
    pub(crate) fn overrides(&self) -> Vec<Override> {
        let depth = short("--depth", "diagram.cycle_depth", self.depth.as_deref());
        self.case.overrides().into_iter().chain(depth).chain(self.output.looks()).collect()
    }
}

/// Which case, over which second parameter, and what to do with the curves.
#[derive(Debug, Args)]
pub(crate) struct MapArguments {
    /// Which case.
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// The second parameter, a key of the table dimensionless or parameters; its bounds are map.from
    /// and map.to
    /// [default: a tenth to ten times the case's value]
    #[arg(long, value_name = "KEY")]
    pub(crate) over: String,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// Which curves, what is known of them, and what to do with their fits.
#[derive(Debug, Args)]
pub(crate) struct FitArguments {
    /// Measured curves: .csv, .jpk-force, maps (.jpk-force-map, .jpk-qi-data), or afmformats' .tab
    #[arg(value_name = "CURVE", required_unless_present = "plan")]
    pub(crate) curves: Vec<PathBuf>,
    /// What the laboratory knows: the tables instrument, shell, physical and data
    #[arg(long, value_name = "LAB.toml")]
    pub(crate) known: Option<PathBuf>,
    /// Replace a known value, e.g. --set instrument.spring_constant="0.08 N/m"; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Keep a quantity at its known value; may be repeated
    #[arg(long, value_name = "KEY")]
    pub(crate) fix: Vec<String>,
    /// Look for a quantity that is kept otherwise; may be repeated
    #[arg(long, value_name = "KEY")]
    pub(crate) free: Vec<String>,
    /// What is known of a quantity, with its error; may be repeated
    #[arg(long, value_name = "KEY=VALUE:SD")]
    pub(crate) prior: Vec<String>,
    /// Law of the membrane: hooke, mooney-rivlin, skalak, or all [default: shell.law]
    #[arg(long, value_name = "NAME|all")]
    pub(crate) law: Option<String>,
    /// Segments that are fitted
    #[arg(long, value_enum, default_value_t = SegmentsWanted::Both)]
    pub(crate) segments: SegmentsWanted,
    /// Piezo heights that are fitted, e.g. --range "7.5 um:9 um"
    #[arg(long, value_name = "A:B", allow_hyphen_values = true)]
    pub(crate) range: Option<String>,
    /// Profile likelihoods to follow, apart by commas, or none
    /// [default: those of the moduli where the covariance cannot be trusted]
    #[arg(long, value_name = "KEYS|none")]
    pub(crate) profile: Option<String>,
    /// Let outliers count less (soft-L1)
    #[arg(long)]
    pub(crate) robust: bool,
    /// Write report.html too, a page with all pictures, quantities with their intervals and verdicts, jumps and
    /// warnings
    #[arg(long, conflicts_with = "plan")]
    pub(crate) report: bool,
    /// Instead of a fit: what a measurement of this shell would identify, from the Fisher information;
    /// --known gives lever and noise (instrument.noise), the case's path the range
    #[arg(long, value_name = "CASE.toml", conflicts_with = "curves")]
    pub(crate) plan: Option<PathBuf>,
    /// Number of threads for several curves, at most 1024 [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// Which segments of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum SegmentsWanted {
    /// The approach
    Approach,
    /// The retract
    Retract,
    /// Both
    Both,
}

/// Which figures, and what to do with them.
#[derive(Debug, Args)]
pub(crate) struct FigureArguments {
    /// Numbers of figures, "stability", or "all"
    #[arg(value_name = "N|stability|all", required = true)]
    pub(crate) numbers: Vec<String>,
    /// Number of elements, as --set mesh.elements=N
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) elements: Option<String>,
    /// Replace a value in every case of the figures, e.g. --set shell.poisson=0.3; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

impl FigureArguments {
    /// The overrides of all cases, in the order in which they are applied.
    pub(crate) fn overrides(&self) -> Vec<Override> {
        let elements = short("--elements", "mesh.elements", self.elements.as_deref());
        set(&self.set).chain(elements).collect()
    }
}

/// Which sweep, and how to share the work.
#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    /// A sweep file, a case file that also says which keys vary; or a name from "arclen list"
    #[arg(value_name = "SWEEP.toml|NAME")]
    pub(crate) sweep: PathBuf,
    /// Number of threads, at most 1024 [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Compute only the k-th of n shares of the cases, for the jobs of a cluster; "arclen merge"
    /// unites them
    #[arg(long, value_name = "k/n", default_value_t = Shard::ALL, hide_default_value = true)]
    pub(crate) shard: Shard,
    /// Begin anew: the same command otherwise goes on with the cases that are not in DIR/cases yet
    #[arg(long)]
    pub(crate) restart: bool,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// Which shards.
#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// Folders that "arclen sweep --shard" wrote
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,
    /// What to do with the results.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

/// A format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// Lines, at any size
    Svg,
    /// Pixels, two to one of the SVG
    Png,
    /// A page of the picture's size
    Pdf,
}

/// What to do with the results.
#[derive(Debug, Args)]
pub(crate) struct OutputArguments {
    /// Folder for the results, made if missing [default: ./arclen-out/CASE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the JSON on standard output; without --out, write no files
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw no pictures
    #[arg(long)]
    pub(crate) no_pictures: bool,
    /// Formats of the pictures, apart by commas; pages and fits have theirs
    #[arg(
        long,
        value_enum,
        value_name = "svg,png,pdf",
        value_delimiter = ',',
        default_value = "svg"
    )]
    pub(crate) format: Vec<Format>,
    /// How pictures look, as --set picture.KEY=VALUE, e.g. --picture legend=false; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) picture: Vec<String>,
    /// No progress, no summary, no notes
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

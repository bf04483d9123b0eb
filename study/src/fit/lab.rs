//! What a laboratory knows: a TOML file, overrides, and what is fixed, freed or known with an error.

use super::error::{Missing, SetupError, Wish, keys as known_keys};
use crate::case::document::{self, Override};
use crate::case::error::{Complaint, LoadError};
use crate::case::keys::{FRACTION, NOT_NEGATIVE, POISSON_RATIOS, POSITIVE, Range};
use crate::case::reader::{Reader, Section};
use crate::case::source;
use crate::units::{self, Dimension};
use identify::data::{Direction, Layout};
use identify::fit::Setup;
use identify::fit::objective::{DerivedPrior, Prior};
use identify::uncertainty::{Derived, Quantity};
use identify::{Key, LawName, Parameters};
use std::path::Path;

const TABLES: [&str; 4] = ["instrument", "shell", "physical", "data"];
const INSTRUMENT: &[&str] =
    &["spring_constant", "spring_constant_sd", "sensitivity", "contacts", "noise"];
const SHELL: &[&str] = &["law", "poisson", "poisson_sd", "b", "b_sd"];
const DATA: &[&str] = &[
    "force_column",
    "height_column",
    "segment_column",
    "force_unit",
    "height_unit",
    "decimal",
    "separator",
    "force_sign",
    "height",
    "curve",
];
/// Largest number of a curve in a map: more than any instrument makes.
const LAST_CURVE: i64 = 100_000_000;
/// Keys of `[physical]` that are fitted, with their dimension; each may have a `_sd`.
const PHYSICAL: [(Key, Dimension); 7] = [
    (Key::Radius, Dimension::Length),
    (Key::Chi, Dimension::Tension),
    (Key::Bending, Dimension::Moment),
    (Key::Adhesion, Dimension::Tension),
    (Key::Film, Dimension::Length),
    (Key::Pressure, Dimension::Pressure),
    (Key::SurfaceTension, Dimension::Tension),
];

/// What is known and asked for, before the curve is seen.
#[derive(Debug, Clone)]
pub struct Lab {
    /// Known values; NaN for none.
    pub base: Parameters,
    /// What is known with an error.
    pub priors: Vec<Prior>,
    /// Keys that are known exactly because their value stands without an error.
    fixed: Vec<Key>,
    /// The law, if it is said.
    pub law: Option<LawName>,
    /// Relative standard deviation of the lever's stiffness, if it is said.
    pub spring_constant_sd: Option<f64>,
    /// Poles that deform.
    pub contacts: u8,
    /// Standard deviation of the force's noise, N: of a planned measurement.
    pub noise: Option<f64>,
    /// How the files of curves are laid out.
    pub layout: Layout,
}

/// What changes what is known: options of the command line, arguments in Python.
#[derive(Debug, Clone, Copy)]
pub struct Wishes<'a> {
    /// Keys that keep their known value.
    pub fix: &'a [String],
    /// Keys that are looked for.
    pub free: &'a [String],
    /// `KEY=VALUE:SD`.
    pub prior: &'a [String],
    /// Which segments.
    pub only: Option<Direction>,
    /// `A:B`.
    pub range: Option<&'a str>,
    /// Soft-L1.
    pub robust: bool,
}

/// The tables of a file of known values, with their keys.
pub fn keys() -> [(&'static str, Vec<String>); 4] {
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    let values = PHYSICAL.iter().map(|(key, _)| key.name().to_owned());
    let errors = PHYSICAL.iter().map(|(key, _)| format!("{}_sd", key.name()));
    let gas = ["gas_exponent", "gas_exponent_sd"].map(str::to_owned);
    let physical = values.chain(errors).chain(gas).collect();
    let [instrument, shell, of_physical, data] = TABLES;
    [
        (instrument, owned(INSTRUMENT)),
        (shell, owned(SHELL)),
        (of_physical, physical),
        (data, owned(DATA)),
    ]
}

/// Reads what is known: a file and overrides, or these alone; messages then call the file `nameless`.
///
/// # Errors
/// Everything that is wrong with the file and its overrides.
pub fn load(path: Option<&Path>, nameless: &str, overrides: &[Override]) -> Result<Lab, LoadError> {
    let (file, text) = match path {
        Some(path) => (path.display().to_string(), source::read(path)?),
        None => (nameless.to_owned(), String::new()),
    };
    let tree = document::parse(&file, &text, overrides)?;
    let reader = Reader::new(&file);
    let lab = read(&reader, Section::root(&tree));
    match lab {
        Some(lab) if reader.has_no_errors() => Ok(lab),
        _ => Err(LoadError::Invalid(reader.into_errors())),
    }
}

fn read(reader: &Reader, root: Section<'_>) -> Option<Lab> {
    let known = keys();
    let listed: [Vec<&str>; 4] =
        known.each_ref().map(|(_, keys)| keys.iter().map(String::as_str).collect());
    let homes: [(&'static str, &[&str]); 4] = std::array::from_fn(|k| (TABLES[k], &*listed[k]));
    reader.only(root, &TABLES, &homes);
    let table = |name, allowed: &[&str]| {
        let section = reader.section(root, name);
        reader.only(section, allowed, &homes);
        section
    };
    let mut lab = Lab {
        base: Parameters::default(),
        priors: Vec::new(),
        fixed: Vec::new(),
        law: None,
        spring_constant_sd: None,
        contacts: 2,
        noise: None,
        layout: Layout::default(),
    };
    let instrument = table("instrument", INSTRUMENT);
    let tension = Dimension::Tension;
    if let Some(k) = reader.quantity(instrument, "spring_constant", tension, POSITIVE) {
        lab.base[Key::SpringConstant] = k.si;
    }
    lab.spring_constant_sd = spring_constant_sd(reader, instrument, lab.base[Key::SpringConstant]);
    lab.contacts = reader.count(instrument, "contacts", 1, 2).unwrap_or(2) as u8;
    let noise = reader.quantity(instrument, "noise", Dimension::Force, POSITIVE);
    lab.noise = noise.map(|noise| noise.si);
    let shell = table("shell", SHELL);
    let names = LawName::ALL.map(LawName::name);
    lab.law = reader.word(shell, "law", &names).and_then(LawName::of);
    let mut plain = |section, key: Key, allowed: Range| {
        let value = reader.number(section, key.name(), allowed);
        let name = format!("{}_sd", key.name());
        let sd = reader.number(section, &name, POSITIVE);
        lab.take(key, value, sd);
    };
    plain(shell, Key::Poisson, POISSON_RATIOS);
    plain(shell, Key::MooneyB, FRACTION);
    let physical = table("physical", &listed[2]);
    plain(physical, Key::GasExponent, NOT_NEGATIVE);
    for (key, dimension) in PHYSICAL {
        let sd_name = &format!("{}_sd", key.name());
        let allowed = if key == Key::SurfaceTension { NOT_NEGATIVE } else { POSITIVE };
        let value = reader.quantity(physical, key.name(), dimension, allowed);
        let sd = reader.quantity(physical, sd_name, dimension, POSITIVE);
        if let (None, Some(_), Some(node)) = (&value, &sd, physical.get(sd_name)) {
            let why = format!("there is no {} that it belongs to", key.name());
            reader.refuse(physical, sd_name, node, Complaint::Conflict(why));
        }
        lab.take(key, value.map(|v| v.si), sd.map(|v| v.si));
    }
    lab.layout = layout(reader, table("data", DATA));
    let sensitivity = reader.quantity(instrument, "sensitivity", Dimension::Sensitivity, POSITIVE);
    lab.layout.sensitivity = sensitivity.map(|sensitivity| sensitivity.si);
    Some(lab)
}

/// `"10 %"`, or a stiffness.
fn spring_constant_sd(reader: &Reader, section: Section<'_>, nominal: f64) -> Option<f64> {
    const KEY: &str = "spring_constant_sd";
    let text = reader.text(section, KEY)?;
    let node = section.get(KEY)?;
    if let Some(share) = text.trim().strip_suffix('%') {
        let share = share.trim().parse::<f64>().ok().map(|x| x / 100.0);
        if let Some(share) = share.filter(|x| (0.0..=1.0).contains(x)) {
            return Some(share);
        }
        let allowed = "from 0 % to 100 %, or a stiffness such as \"0.008 N/m\"".to_owned();
        reader.refuse(section, KEY, node, Complaint::OutOfRange { allowed });
        return None;
    }
    let sd = reader.quantity(section, KEY, Dimension::Tension, NOT_NEGATIVE)?.si;
    (nominal > 0.0).then(|| sd / nominal)
}

fn layout(reader: &Reader, data: Section<'_>) -> Layout {
    let text = |key| reader.text(data, key).map(str::to_owned);
    let separator = reader.word(data, "separator", &["comma", "semicolon", "tab"]);
    let sign = Range { holds: |x| x == 1.0 || x == -1.0, words: "1 or -1" };
    Layout {
        force_column: text("force_column"),
        height_column: text("height_column"),
        segment_column: text("segment_column"),
        force_unit: text("force_unit"),
        height_unit: text("height_unit"),
        decimal_comma: reader.word(data, "decimal", &["point", "comma"]).map(|w| w == "comma"),
        separator: separator.map(|word| match word {
            "semicolon" => ';',
            "tab" => '\t',
            _ => ',',
        }),
        force_sign: reader.number(data, "force_sign", sign),
        height_rises: reader.word(data, "height", &["falls", "rises"]).map(|w| w == "rises"),
        curve: reader.count(data, "curve", 0, LAST_CURVE),
        // of the table instrument
        sensitivity: None,
        spring_constant: None,
    }
}

impl Lab {
    fn take(&mut self, key: Key, value: Option<f64>, sd: Option<f64>) {
        let Some(value) = value else { return };
        self.base[key] = value;
        match sd {
            Some(sd) => self.priors.push(Prior { key, value, sd }),
            None => self.fixed.push(key),
        }
    }

    /// The fit that is asked for; `stated` is the stiffness of the lever that the curve's file states.
    ///
    /// # Errors
    /// Says what is asked for that cannot be, or what is missing.
    pub fn setup(
        &self,
        law: LawName,
        stated: Option<f64>,
        wishes: Wishes<'_>,
    ) -> Result<Setup, SetupError> {
        let mut base = self.base;
        if base[Key::SpringConstant].is_nan() {
            base[Key::SpringConstant] = stated.unwrap_or(f64::NAN);
        }
        let mut setup = Setup::new(law, base, self.priors.clone());
        setup.contacts = self.contacts;
        setup.robust = wishes.robust;
        setup.only = wishes.only;
        setup.spring_constant_sd = self.spring_constant_sd.unwrap_or(0.1);
        setup.free.retain(|key| !self.fixed.contains(key));
        for prior in &self.priors {
            free(&mut setup, prior.key);
        }
        for text in wishes.prior {
            let prior = match parse_prior(text)? {
                Stated::Key(prior) => prior,
                Stated::Derived(prior) => {
                    setup.derived.retain(|p| p.of != prior.of);
                    setup.derived.push(prior);
                    continue;
                }
            };
            setup.base[prior.key] = prior.value;
            setup.priors.retain(|p| p.key != prior.key);
            setup.priors.push(prior);
            free(&mut setup, prior.key);
        }
        if setup.base[Key::SpringConstant].is_nan() {
            return Err(Missing::SpringConstant.into());
        }
        for name in wishes.free {
            let key = key(Wish::Free, name)?;
            free(&mut setup, key);
        }
        for name in wishes.fix {
            let key = key(Wish::Fix, name)?;
            if setup.base[key].is_nan() {
                return Err(SetupError::NothingToKeep { name: name.clone() });
            }
            setup.free.retain(|k| *k != key);
            setup.priors.retain(|p| p.key != key);
            if key == Key::SpringConstant {
                setup.spring_constant_sd = 0.0;
            }
        }
        if law != LawName::MooneyRivlin {
            // no unknown of the other laws
            setup.free.retain(|key| *key != Key::MooneyB);
            setup.priors.retain(|prior| prior.key != Key::MooneyB);
        }
        let radius = Key::Radius;
        if setup.base[radius].is_nan() {
            return Err(Missing::Radius.into());
        }
        if let Some(range) = wishes.range {
            setup.range = Some(parse_range(range)?);
        }
        Ok(setup)
    }

    /// Whether a fit by one law can have what is asked of it.
    ///
    /// # Errors
    /// When the share `b` is looked for and the law has none.
    pub fn allows(law: LawName, wishes: Wishes<'_>) -> Result<(), SetupError> {
        let is_b = |name: &str| Key::of(bare(name)) == Some(Key::MooneyB);
        let named = |wish, names: &[String]| names.iter().any(|name| is_b(name)).then_some(wish);
        let prior = |text: &String| text.split_once('=').is_some_and(|(name, _)| is_b(name));
        let stated = wishes.prior.iter().any(prior).then_some(Wish::Prior);
        match named(Wish::Free, wishes.free).or(stated) {
            Some(wish) if law != LawName::MooneyRivlin => Err(SetupError::NoShare { wish, law }),
            _ => Ok(()),
        }
    }

    /// How a file is laid out, with what is known of the lever; wrong options are told by [`Lab::setup`].
    pub fn layout(&self, wishes: Wishes<'_>) -> Layout {
        let mut priors = wishes.prior.iter().filter_map(|text| match parse_prior(text) {
            Ok(Stated::Key(prior)) if prior.key == Key::SpringConstant => Some(prior),
            _ => None,
        });
        let prior = priors.next_back();
        let known = prior.map_or(self.base[Key::SpringConstant], |prior| prior.value);
        Layout { spring_constant: Some(known).filter(|k| k.is_finite()), ..self.layout.clone() }
    }

    /// Whether the radius stands without an error, which is knowledge that nobody has.
    pub fn radius_is_exact(&self) -> bool {
        self.fixed.contains(&Key::Radius)
    }
}

fn free(setup: &mut Setup, key: Key) {
    if !setup.free.contains(&key) {
        setup.free.push(key);
    }
}

/// A name without its table.
fn bare(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, bare)| bare).trim()
}

/// The key of a name, with or without its table.
fn key(wish: Wish, name: &str) -> Result<Key, SetupError> {
    let unknown = || SetupError::UnknownKey { wish, name: name.to_owned(), allowed: known_keys() };
    Key::of(bare(name)).ok_or_else(unknown)
}

fn dimension(key: Key) -> Option<Dimension> {
    match key {
        Key::Contact => Some(Dimension::Length),
        Key::SpringConstant | Key::Tilt => Some(Dimension::Tension),
        _ => PHYSICAL.iter().find(|(k, _)| *k == key).map(|(_, dimension)| *dimension),
    }
}

fn number(wish: Wish, key: Key, text: &str) -> Result<f64, SetupError> {
    number_of(wish, key.name(), dimension(key), text)
}

fn number_of(
    wish: Wish,
    key: &'static str,
    dimension: Option<Dimension>,
    text: &str,
) -> Result<f64, SetupError> {
    let text = text.trim().trim_matches('"');
    let written = || text.to_owned();
    match dimension {
        Some(dimension) => units::parse(text, dimension)
            .map(|quantity| quantity.si)
            .map_err(|error| SetupError::Quantity { wish, key, text: written(), error }),
        None => text
            .parse::<f64>()
            .ok()
            .filter(|x| x.is_finite())
            .ok_or_else(|| SetupError::Number { wish, key, text: written() }),
    }
}

/// What follows from the moduli and may be known beforehand, with its dimension.
const DERIVED: [(Derived, Dimension); 3] = [
    (Derived::Young, Dimension::Pressure),
    (Derived::Thickness, Dimension::Length),
    (Derived::ForceScale, Dimension::Force),
];

/// What `--prior` states.
enum Stated {
    Key(Prior),
    Derived(DerivedPrior),
}

fn parse_prior(text: &str) -> Result<Stated, SetupError> {
    const WISH: Wish = Wish::Prior;
    let parts = text.split_once('=').and_then(|(k, rest)| Some((k, rest.split_once(':')?)));
    let Some((name, (value, sd))) = parts else {
        return Err(SetupError::PriorForm { text: text.to_owned() });
    };
    let positive = || SetupError::PriorSign { name: name.trim().to_owned() };
    let bare = bare(name);
    let derived = DERIVED.into_iter().find(|(of, _)| Quantity::Derived(*of).name() == bare);
    if let Some((of, dimension)) = derived {
        let own = Quantity::Derived(of).name();
        let number = |text| number_of(WISH, own, Some(dimension), text);
        let (value, sd) = (number(value)?, number(sd)?);
        if sd <= 0.0 || value <= 0.0 {
            return Err(positive());
        }
        return Ok(Stated::Derived(DerivedPrior { of, value, sd }));
    }
    let Some(key) = Key::of(bare) else {
        let derived = DERIVED.into_iter().map(|(of, _)| Quantity::Derived(of).name());
        let allowed = derived.chain(known_keys()).collect();
        return Err(SetupError::UnknownKey { wish: WISH, name: name.to_owned(), allowed });
    };
    let (value, sd) = (number(WISH, key, value)?, number(WISH, key, sd)?);
    if sd <= 0.0 || key.is_logarithmic() && value <= 0.0 {
        return Err(positive());
    }
    Ok(Stated::Key(Prior { key, value, sd }))
}

fn parse_range(text: &str) -> Result<(f64, f64), SetupError> {
    const WISH: Wish = Wish::Range;
    let Some((a, b)) = text.split_once(':') else {
        return Err(SetupError::RangeForm { text: text.to_owned() });
    };
    let (a, b) = (number(WISH, Key::Contact, a)?, number(WISH, Key::Contact, b)?);
    if a == b {
        return Err(SetupError::RangeEmpty { text: text.to_owned() });
    }
    Ok((a, b))
}

//! A channel of a segment: integers or floats, scaled to the unit of the sensor, then converted slot by slot.
//!
//! `x = multiplier · raw + offset`, first of the encoder (to volts), then of each conversion: `distance` (volts to
//! metres, by the sensitivity) and `force` (metres to newtons, by the spring constant) of a deflection, `nominal`
//! and `calibrated` of a height. Each conversion names the slot it starts from; `conversions.base` is that of the
//! raw data. In the old layout all this stands in the header of the segment under `channel.NAME.`, in the new one
//! under `lcd-info.N.` of `shared-data/header.properties`, and the segment says which `N`.

use super::error::ArchiveError;
use super::properties::Properties;

/// Where the new layout keeps what segments have in common.
pub(super) const SHARED: &str = "shared-data/header.properties";
/// Slots of a height, after the file's default.
const HEIGHTS: [&str; 3] = ["nominal", "calibrated", "absolute"];
/// More conversions in a row than any instrument has.
const LONGEST_CHAIN: usize = 16;

/// What is known of the lever beside the file; it replaces what the file says.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Told {
    /// Sensitivity of the deflection, m/V.
    pub(super) sensitivity: Option<f64>,
    /// Spring constant, N/m.
    pub(super) spring_constant: Option<f64>,
}

/// A property that was found.
struct Found<'a> {
    entry: &'a str,
    key: String,
    value: &'a str,
}

impl Found<'_> {
    fn refuse(&self, allowed: &str) -> ArchiveError {
        ArchiveError::Value {
            entry: self.entry.to_owned(),
            key: self.key.clone(),
            value: self.value.chars().take(40).collect(),
            allowed: allowed.to_owned(),
        }
    }

    fn number(&self) -> Result<f64, ArchiveError> {
        let number = self.value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| self.refuse("a finite number"))
    }

    fn count(&self) -> Result<usize, ArchiveError> {
        self.value.trim().parse().map_err(|_| self.refuse("a whole number, not negative"))
    }
}

/// How samples are stored: all big-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoder {
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
}

/// The names of integer encoders; each may have `-limited` at its end.
const ENCODERS: [(&str, Encoder); 6] = [
    ("signedshort", Encoder::I16),
    ("unsignedshort", Encoder::U16),
    ("signedinteger", Encoder::I32),
    ("unsignedinteger", Encoder::U32),
    ("signedlong", Encoder::I64),
    ("unsignedlong", Encoder::U64),
];

impl Encoder {
    fn width(self) -> usize {
        match self {
            Encoder::I16 | Encoder::U16 => 2,
            Encoder::I32 | Encoder::U32 | Encoder::F32 => 4,
            Encoder::I64 | Encoder::U64 => 8,
        }
    }

    fn decode(self, bytes: &[u8]) -> Vec<f64> {
        let two = |f: fn([u8; 2]) -> f64| bytes.as_chunks::<2>().0.iter().map(|c| f(*c)).collect();
        let four = |f: fn([u8; 4]) -> f64| bytes.as_chunks::<4>().0.iter().map(|c| f(*c)).collect();
        let eight =
            |f: fn([u8; 8]) -> f64| bytes.as_chunks::<8>().0.iter().map(|c| f(*c)).collect();
        match self {
            Encoder::I16 => two(|c| f64::from(i16::from_be_bytes(c))),
            Encoder::U16 => two(|c| f64::from(u16::from_be_bytes(c))),
            Encoder::I32 => four(|c| f64::from(i32::from_be_bytes(c))),
            Encoder::U32 => four(|c| f64::from(u32::from_be_bytes(c))),
            Encoder::F32 => four(|c| f64::from(f32::from_be_bytes(c))),
            Encoder::I64 => eight(|c| i64::from_be_bytes(c) as f64),
            Encoder::U64 => eight(|c| u64::from_be_bytes(c) as f64),
        }
    }
}

/// `y = multiplier · x + offset`, from the slot `base`.
#[derive(Debug, Clone, PartialEq)]
struct Step {
    base: String,
    multiplier: f64,
    offset: f64,
    unit: String,
}

/// The conversions from the raw data to a slot, or the slot that is not defined.
enum Chain {
    Complete(Vec<Step>),
    Undefined(String),
}

/// A channel of a segment, as its headers describe it.
pub(super) struct Channel<'a> {
    name: &'a str,
    own: &'a Properties,
    shared: Option<(&'a Properties, String)>,
}

impl<'a> Channel<'a> {
    /// The channel `name` of the segment with the header `own`.
    pub(super) fn new(
        name: &'a str,
        own: &'a Properties,
        common: Option<&'a Properties>,
    ) -> Result<Self, ArchiveError> {
        let key = format!("channel.{name}.lcd-info.*");
        let shared = match (own.get(&key), common) {
            (None, _) => None,
            (Some(_), None) => return Err(ArchiveError::NoEntry { entry: SHARED.to_owned() }),
            (Some(number), Some(common)) => Some((common, format!("lcd-info.{number}."))),
        };
        let channel = Channel { name, own, shared };
        if channel.shared.is_some() {
            let named = channel.need("channel.name")?;
            if named.value != name {
                return Err(named.refuse(&format!("{name}, which {}: {key} says", own.entry)));
            }
        }
        Ok(channel)
    }

    fn get(&self, key: &str) -> Option<Found<'a>> {
        let shared =
            self.shared.as_ref().map(|(common, prefix)| (*common, format!("{prefix}{key}")));
        let own =
            ["", "data."].map(|data| (self.own, format!("channel.{}.{data}{key}", self.name)));
        shared.into_iter().chain(own).find_map(|(properties, key)| {
            let value = properties.get(&key)?;
            Some(Found { entry: &properties.entry, key, value })
        })
    }

    /// Where a key stands, or would.
    fn place(&self, key: &str) -> (String, String) {
        match (self.get(key), &self.shared) {
            (Some(found), _) => (found.entry.to_owned(), found.key),
            (None, Some((common, prefix))) => (common.entry.clone(), format!("{prefix}{key}")),
            (None, None) => (self.own.entry.clone(), format!("channel.{}.{key}", self.name)),
        }
    }

    fn need(&self, key: &str) -> Result<Found<'a>, ArchiveError> {
        self.get(key).ok_or_else(|| {
            let (entry, key) = self.place(key);
            ArchiveError::NoKey { entry, key }
        })
    }

    /// The entry of the samples, seen from the folder of the segment.
    pub(super) fn file(&self) -> Result<&'a str, ArchiveError> {
        let format = self.get("file.format");
        if let Some(format) = format.filter(|format| format.value != "raw") {
            return Err(format.refuse("raw"));
        }
        Ok(self.need("file.name")?.value)
    }

    fn encoder(&self) -> Result<Encoder, ArchiveError> {
        let kind = self.get("type");
        if kind.as_ref().is_some_and(|kind| matches!(kind.value, "float-data" | "float")) {
            return Ok(Encoder::F32);
        }
        let names = || ENCODERS.map(|(name, _)| name).join(", ");
        let Some(found) = self.get("encoder.type") else {
            return Err(match kind {
                Some(kind) => kind.refuse("short-data, integer-data, long-data or float-data"),
                None => {
                    let (entry, key) = self.place("encoder.type");
                    ArchiveError::NoKey { entry, key }
                }
            });
        };
        let plain = found.value.strip_suffix("-limited").unwrap_or(found.value);
        let known = ENCODERS.iter().find(|(name, _)| *name == plain);
        known
            .map(|(_, encoder)| *encoder)
            .ok_or_else(|| found.refuse(&format!("one of {} (or …-limited)", names())))
    }

    /// Factor and offset under `place`.
    fn scaling(&self, place: &str) -> Result<(f64, f64), ArchiveError> {
        for (key, allowed) in [("type", "linear"), ("style", "offsetmultiplier")] {
            let found = self.get(&format!("{place}.scaling.{key}"));
            if let Some(found) = found.filter(|found| found.value != allowed) {
                return Err(found.refuse(allowed));
            }
        }
        let multiplier = self.need(&format!("{place}.scaling.multiplier"))?;
        let offset = self.need(&format!("{place}.scaling.offset"))?.number()?;
        match multiplier.number()? {
            0.0 => Err(multiplier.refuse("a finite number other than 0")),
            factor => Ok((factor, offset)),
        }
    }

    /// The unit under `place`, or nothing.
    fn unit(&self, place: &str) -> String {
        [format!("{place}unit.unit"), format!("{place}unit")]
            .iter()
            .find_map(|key| self.get(key))
            .map_or_else(String::new, |found| found.value.to_owned())
    }

    /// The samples as the sensor gave them, and their unit.
    fn raw(&self, entry: &str, bytes: &[u8]) -> Result<(Vec<f64>, String), ArchiveError> {
        let encoder = self.encoder()?;
        let stated = match self.get("num-points") {
            Some(found) => found,
            None => {
                let key = "force-segment-header.num-points".to_owned();
                let entry = self.own.entry.as_str();
                match self.own.get(&key) {
                    Some(value) => Found { entry, key, value },
                    None => return Err(ArchiveError::NoKey { entry: entry.to_owned(), key }),
                }
            }
        };
        let (count, width) = (stated.count()?, encoder.width());
        if count.checked_mul(width) != Some(bytes.len()) {
            return Err(ArchiveError::Length {
                entry: entry.to_owned(),
                bytes: bytes.len(),
                width,
                key: stated.key,
                stated: count,
            });
        }
        let mut samples = encoder.decode(bytes);
        if encoder == Encoder::F32 {
            return Ok((samples, self.unit("")));
        }
        let (multiplier, offset) = self.scaling("encoder")?;
        for x in &mut samples {
            *x = multiplier * *x + offset;
        }
        Ok((samples, self.unit("encoder.scaling.")))
    }

    /// The conversion that makes `slot`; nothing where it is not defined.
    fn step(&self, slot: &str, told: Told) -> Result<Option<Step>, ArchiveError> {
        let step = |base: &str, multiplier, unit: &str| Step {
            base: base.to_owned(),
            multiplier,
            offset: 0.0,
            unit: unit.to_owned(),
        };
        match (slot, told.sensitivity, told.spring_constant) {
            ("distance", Some(sensitivity), _) => {
                let base = self.need("conversion-set.conversions.base")?.value;
                return Ok(Some(step(base, sensitivity, "m")));
            }
            ("force", _, Some(stiffness)) => return Ok(Some(step("distance", stiffness, "N"))),
            _ => {}
        }
        let place = format!("conversion-set.conversion.{slot}");
        let defined = self.get(&format!("{place}.defined")).is_none_or(|d| d.value != "false");
        if !defined || self.get(&format!("{place}.scaling.multiplier")).is_none() {
            return Ok(None);
        }
        let (multiplier, offset) = self.scaling(&place)?;
        let base = self.need(&format!("{place}.base-calibration-slot"))?.value.to_owned();
        Ok(Some(Step { base, multiplier, offset, unit: self.unit(&format!("{place}.scaling.")) }))
    }

    fn chain(&self, slot: &str, told: Told) -> Result<Chain, ArchiveError> {
        let base = self.need("conversion-set.conversions.base")?.value;
        let (mut at, mut steps) = (slot.to_owned(), Vec::new());
        while at != base {
            if steps.len() == LONGEST_CHAIN {
                let (entry, key) = self.place(&format!("conversion-set.conversion.{slot}"));
                return Err(ArchiveError::Circle { entry, key });
            }
            let Some(step) = self.step(&at, told)? else { return Ok(Chain::Undefined(at)) };
            at.clone_from(&step.base);
            steps.push(step);
        }
        steps.reverse();
        Ok(Chain::Complete(steps))
    }

    /// The sensitivity (m/V) and the spring constant (N/m) that the file states.
    pub(super) fn stated(&self) -> Result<Told, ArchiveError> {
        let of = |slot, base: &str| -> Result<Option<f64>, ArchiveError> {
            let step = self.step(slot, Told::default())?.filter(|step| step.base == base);
            Ok(step.map(|step| step.multiplier))
        };
        let volts = self.need("conversion-set.conversions.base")?.value;
        Ok(Told { sensitivity: of("distance", volts)?, spring_constant: of("force", "distance")? })
    }

    /// What is known of the lever and has no use here, because the file has the deflection in metres, or the force.
    pub(super) fn unused(&self, told: Told) -> Result<Vec<String>, ArchiveError> {
        let base = self.need("conversion-set.conversions.base")?;
        let needless = |what: &str| {
            format!(
                "the {what} that is known is not used: the file's own samples are {}",
                base.value
            )
        };
        let metres = told.sensitivity.is_some() && matches!(base.value, "distance" | "force");
        let newtons = told.spring_constant.is_some() && base.value == "force";
        let sensitivity = metres.then(|| needless("sensitivity"));
        Ok(sensitivity.into_iter().chain(newtons.then(|| needless("spring constant"))).collect())
    }

    /// The samples as forces, N.
    pub(super) fn force(
        &self,
        entry: &str,
        bytes: &[u8],
        told: Told,
    ) -> Result<Vec<f64>, ArchiveError> {
        let distance = matches!(self.chain("distance", told)?, Chain::Complete(_));
        let steps = match self.chain("force", told)? {
            Chain::Complete(steps) => steps,
            Chain::Undefined(slot) => {
                let (entry, key) = self.place(&format!("conversion-set.conversion.{slot}.defined"));
                return Err(match (slot.as_str(), distance) {
                    ("force", true) => ArchiveError::NoSpringConstant { entry, key },
                    ("force", false) => ArchiveError::NotCalibrated { entry, key },
                    ("distance", _) => ArchiveError::NoSensitivity { entry, key },
                    _ => ArchiveError::NoKey { entry, key },
                });
            }
        };
        let (samples, unit) = self.raw(entry, bytes)?;
        if told.sensitivity.is_some() && steps.len() > 1 && unit != "V" {
            let (entry, key) = self.place("encoder.scaling.unit.unit");
            let allowed = "V, for a sensitivity in metres per volt was given".to_owned();
            return Err(ArchiveError::Value { entry, key, value: unit, allowed });
        }
        self.converted(entry, samples, &steps, &unit, "N")
    }

    /// The samples as heights, m: in the file's default slot, or the first other one that is in metres.
    pub(super) fn height(
        &self,
        entry: &str,
        bytes: &[u8],
        channels: &str,
    ) -> Result<Vec<f64>, ArchiveError> {
        let default = self.get("conversion-set.conversions.default").map(|found| found.value);
        let (samples, unit) = self.raw(entry, bytes)?;
        for slot in default.into_iter().chain(HEIGHTS) {
            let Chain::Complete(steps) = self.chain(slot, Told::default())? else { continue };
            if steps.last().map_or(&unit, |step| &step.unit) == "m" {
                return self.converted(entry, samples, &steps, &unit, "m");
            }
        }
        let (entry, key) = self.place("conversion-set.conversions.list");
        let (channel, found) = (self.name.to_owned(), channels.to_owned());
        Err(ArchiveError::NoMetres { entry, key, channel, found })
    }

    fn converted(
        &self,
        entry: &str,
        mut samples: Vec<f64>,
        steps: &[Step],
        raw: &str,
        wanted: &str,
    ) -> Result<Vec<f64>, ArchiveError> {
        let unit = steps.last().map_or(raw, |step| step.unit.as_str());
        if unit != wanted {
            let (entry, key) = self.place("conversion-set.conversions.list");
            let allowed = format!("conversions that end in {wanted}");
            return Err(ArchiveError::Value { entry, key, value: format!("[{unit}]"), allowed });
        }
        for step in steps {
            for x in &mut samples {
                *x = step.multiplier * *x + step.offset;
            }
        }
        match samples.iter().position(|x| !x.is_finite()) {
            Some(sample) => Err(ArchiveError::NotFinite {
                entry: entry.to_owned(),
                sample,
                value: samples[sample],
            }),
            None => Ok(samples),
        }
    }
}

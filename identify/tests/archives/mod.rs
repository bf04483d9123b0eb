//! JPK archives written in memory: a curve of 40 + 40 samples whose numbers are known, in both header layouts.
#![allow(unreachable_pub, reason = "a module of tests")]

use identify::data::Direction;
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// m/V.
pub const SENSITIVITY: f64 = 1.0 / 16_777_216.0;

/// Where a segment's channels are described.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Common {
    /// In the header of the segment.
    Own,
    /// In `shared-data/header.properties`.
    Shared,
}

/// How samples are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    SignedShort,
    UnsignedShort,
    SignedInteger,
    UnsignedInteger,
    SignedLong,
    UnsignedLong,
}

impl Samples {
    pub const ALL: [Samples; 6] = [
        Samples::SignedShort,
        Samples::UnsignedShort,
        Samples::SignedInteger,
        Samples::UnsignedInteger,
        Samples::SignedLong,
        Samples::UnsignedLong,
    ];

    fn names(self) -> [&'static str; 2] {
        match self {
            Samples::SignedShort => ["signedshort", "short-data"],
            Samples::UnsignedShort => ["unsignedshort", "short-data"],
            Samples::SignedInteger => ["signedinteger", "integer-data"],
            Samples::UnsignedInteger => ["unsignedinteger", "integer-data"],
            Samples::SignedLong => ["signedlong", "long-data"],
            Samples::UnsignedLong => ["unsignedlong", "long-data"],
        }
    }

    fn bytes(self, x: i64) -> Vec<u8> {
        match self {
            Samples::SignedShort => i16::try_from(x).unwrap().to_be_bytes().to_vec(),
            Samples::UnsignedShort => u16::try_from(x).unwrap().to_be_bytes().to_vec(),
            Samples::SignedInteger => i32::try_from(x).unwrap().to_be_bytes().to_vec(),
            Samples::UnsignedInteger => u32::try_from(x).unwrap().to_be_bytes().to_vec(),
            Samples::SignedLong => x.to_be_bytes().to_vec(),
            Samples::UnsignedLong => u64::try_from(x).unwrap().to_be_bytes().to_vec(),
        }
    }
}

fn raw_deflection(direction: Direction, at: i64) -> i64 {
    let from_far = if direction == Direction::Approach { at } else { 39 - at };
    100 + (from_far - 25).max(0).pow(2) * 16 + at % 3
}

fn raw_height(direction: Direction, at: i64) -> i64 {
    let from_far = if direction == Direction::Approach { at } else { 39 - at };
    1000 - 20 * from_far
}

/// Height and force of a sample: the factors of [`Archive::new`], all powers of two.
pub fn known(direction: Direction, at: i64) -> (f64, f64) {
    let volts = raw_deflection(direction, at) as f64 / 1024.0 + 0.5;
    let absolute = raw_height(direction, at) as f64 / 1_073_741_824.0 + 1.0 / 4_194_304.0;
    (absolute + 1.0 / 65_536.0, volts * SENSITIVITY * 0.0625)
}

#[derive(Clone)]
struct Part {
    style: &'static str,
    raw: BTreeMap<&'static str, Vec<i64>>,
}

/// What becomes an archive.
#[derive(Clone)]
pub struct Archive {
    common: Common,
    samples: Samples,
    floats: Vec<&'static str>,
    channels: Vec<(&'static str, BTreeMap<String, String>)>,
    general: BTreeMap<String, String>,
    parts: Vec<Part>,
    indexes: Vec<usize>,
    edits: Vec<(String, Option<Vec<u8>>)>,
    replaced: Vec<[String; 3]>,
}

impl Archive {
    pub fn new(common: Common) -> Archive {
        let part = |style, direction| Part {
            style,
            raw: BTreeMap::from([
                ("vDeflection", (0..40).map(|at| raw_deflection(direction, at)).collect()),
                ("measuredHeight", (0..40).map(|at| raw_height(direction, at)).collect()),
                ("height", (0..40).map(|at| raw_height(direction, at)).collect()),
            ]),
        };
        let mut archive = Archive {
            common,
            samples: Samples::SignedInteger,
            floats: Vec::new(),
            channels: ["vDeflection", "measuredHeight", "height"]
                .map(|c| (c, BTreeMap::new()))
                .into(),
            general: BTreeMap::from([
                ("jpk-data-file".into(), "spm-forcefile".into()),
                ("force-scan-series.force-segments.count".into(), "2".into()),
            ]),
            parts: vec![part("extend", Direction::Approach), part("retract", Direction::Retract)],
            indexes: Vec::new(),
            edits: Vec::new(),
            replaced: Vec::new(),
        };
        for (channel, unit, base, default, multiplier, offset) in [
            ("vDeflection", "V", "volts", "force", 1.0 / 1024.0, 0.5),
            ("measuredHeight", "m", "absolute", "nominal", 2f64.powi(-30), 2f64.powi(-22)),
            ("height", "V", "volts", "nominal", 2f64.powi(-29), 2f64.powi(-21)),
        ] {
            for (key, value) in [
                ("encoder.scaling.type", "linear"),
                ("encoder.scaling.style", "offsetmultiplier"),
                ("encoder.scaling.multiplier", &format!("{multiplier:e}")),
                ("encoder.scaling.offset", &format!("{offset:e}")),
                ("encoder.scaling.unit.type", "metric-unit"),
                ("encoder.scaling.unit.unit", unit),
                ("conversion-set.conversions.base", base),
                ("conversion-set.conversions.default", default),
                (&format!("conversion-set.conversion.{base}.defined"), "false"),
            ] {
                archive.set(channel, key, value);
            }
        }
        archive.encode(Samples::SignedInteger, false);
        archive.conversion("vDeflection", "distance", SENSITIVITY, 0.0);
        archive.conversion("vDeflection", "force", 0.0625, 0.0);
        archive.conversion("measuredHeight", "nominal", 1.0, 2f64.powi(-16));
        archive.conversion("height", "nominal", 1.0, 2f64.powi(-15));
        archive
    }

    /// A property of a channel, in every segment.
    pub fn set(&mut self, channel: &str, key: &str, value: &str) {
        let found = self.channels.iter_mut().find(|(name, _)| *name == channel).unwrap();
        found.1.insert(key.to_owned(), value.to_owned());
    }

    pub fn conversion(&mut self, channel: &str, slot: &str, multiplier: f64, offset: f64) {
        let place = format!("conversion-set.conversion.{slot}");
        let (base, unit) = match (channel, slot) {
            (_, "force") => ("distance", "N"),
            ("measuredHeight", _) => ("absolute", "m"),
            _ => ("volts", "m"),
        };
        for (key, value) in [
            ("defined", "true"),
            ("base-calibration-slot", base),
            ("scaling.type", "linear"),
            ("scaling.style", "offsetmultiplier"),
            ("scaling.multiplier", &format!("{multiplier:e}")),
            ("scaling.offset", &format!("{offset:e}")),
            ("scaling.unit.unit", unit),
        ] {
            self.set(channel, &format!("{place}.{key}"), value);
        }
    }

    /// As an instrument leaves a slot that was not calibrated.
    pub fn undefine(&mut self, channel: &str, slot: &str) {
        let place = format!("conversion-set.conversion.{slot}.");
        let found = self.channels.iter_mut().find(|(name, _)| *name == channel).unwrap();
        found.1.retain(|key, _| !key.starts_with(&place));
        self.set(channel, &format!("{place}defined"), "false");
    }

    pub fn encode(&mut self, samples: Samples, limited: bool) {
        self.samples = samples;
        let [encoder, kind] = samples.names();
        let encoder = if limited { format!("{encoder}-limited") } else { encoder.to_owned() };
        for channel in ["vDeflection", "measuredHeight", "height"] {
            self.set(channel, "encoder.type", &encoder);
            self.set(channel, "type", kind);
        }
    }

    /// Stores a channel as floats in its unit, without an encoder.
    pub fn floats(&mut self, channel: &'static str) {
        self.floats.push(channel);
        let found = self.channels.iter_mut().find(|(name, _)| *name == channel).unwrap();
        found.1.retain(|key, _| !key.starts_with("encoder."));
        self.set(channel, "type", "float-data");
        self.set(channel, "unit.unit", "m");
    }

    /// Other samples.
    pub fn raw(&mut self, segment: usize, channel: &'static str, raw: &[i64]) {
        // every channel of a segment is as long
        for (name, values) in &mut self.parts[segment].raw {
            if *name == channel {
                *values = raw.to_vec();
            } else {
                values.truncate(raw.len());
            }
        }
    }

    pub fn style(&mut self, segment: usize, style: &'static str) {
        self.parts[segment].style = style;
    }

    pub fn insert_segment(&mut self, at: usize, style: &'static str) {
        let part = Part { style, ..self.parts[0].clone() };
        self.parts.insert(at, part);
        self.count();
    }

    /// Divides a segment into two of the same direction.
    pub fn halve(&mut self, segment: usize) {
        let mut second = self.parts[segment].clone();
        second.raw.values_mut().for_each(|raw| *raw = raw.split_off(20));
        self.parts[segment].raw.values_mut().for_each(|raw| raw.truncate(20));
        self.parts.insert(segment + 1, second);
        self.count();
    }

    fn count(&mut self) {
        let count = self.parts.len().to_string();
        self.general("force-scan-series.force-segments.count", &count);
    }

    pub fn general(&mut self, key: &str, value: &str) {
        self.general.insert(key.to_owned(), value.to_owned());
    }

    pub fn remove_channel(&mut self, channel: &str) {
        self.channels.retain(|(name, _)| *name != channel);
    }

    /// Further curves with these numbers.
    pub fn map(&mut self, numbers: &[usize]) {
        self.indexes.extend(numbers);
    }

    /// Replaces an entry; `None` leaves it out.
    pub fn entry(&mut self, entry: &str, bytes: Option<Vec<u8>>) {
        self.edits.push((entry.to_owned(), bytes));
    }

    /// Replaces text in an entry of properties.
    pub fn replace(&mut self, entry: &str, old: &str, new: &str) {
        self.replaced.push([entry, old, new].map(str::to_owned));
    }

    fn header(&self, part: &Part) -> String {
        let points = part.raw["vDeflection"].len();
        let names: Vec<&str> = self.channels.iter().map(|(name, _)| *name).collect();
        let mut text = format!(
            "#Sun Nov 29 2026\nforce-segment-header.num-points={points}\nforce-segment-header.time-stamp=\
             2026-11-29 17\\:51\\:15\nchannels.list={}\n",
            names.join(" ")
        );
        let style = format!("settings.style={}\n", part.style);
        match self.common {
            Common::Own => text.push_str(&format!("force-segment-header.{style}")),
            Common::Shared => {
                let number = self.styles().iter().position(|s| *s == part.style).unwrap();
                text.push_str(&format!(
                    "force-segment-header.force-segment-header-info.*={number}\n"
                ));
            }
        }
        for (number, (name, properties)) in self.channels.iter().enumerate() {
            let place = format!("channel.{name}.");
            text.push_str(&format!("{place}data.file.name=channels/{name}.dat\n"));
            text.push_str(&format!("{place}data.file.format=raw\n"));
            match self.common {
                Common::Shared => {
                    text.push_str(&format!("{place}lcd-info.*={number}\n"));
                    text.push_str(&format!("{place}data.num-points={points}\n"));
                }
                Common::Own => {
                    for (key, value) in properties {
                        let data = !key.starts_with("conversion-set");
                        let key = if data { format!("data.{key}") } else { key.clone() };
                        text.push_str(&format!("{place}{key}={value}\n"));
                    }
                }
            }
        }
        text
    }

    fn styles(&self) -> Vec<&'static str> {
        let mut styles: Vec<&str> = self.parts.iter().map(|part| part.style).collect();
        styles.sort_unstable();
        styles.dedup();
        styles
    }

    fn shared(&self) -> String {
        let mut text = String::new();
        for (number, style) in self.styles().iter().enumerate() {
            text.push_str(&format!("force-segment-header-info.{number}.settings.style={style}\n"));
        }
        for (number, (name, properties)) in self.channels.iter().enumerate() {
            text.push_str(&format!("lcd-info.{number}.channel.name={name}\n"));
            for (key, value) in properties {
                text.push_str(&format!("lcd-info.{number}.{key}={value}\n"));
            }
        }
        text
    }

    fn channel(&self, name: &str, raw: &[i64]) -> Vec<u8> {
        if self.floats.contains(&name) {
            let absolute = |x: &i64| *x as f32 / 1_073_741_824.0 + 1.0 / 4_194_304.0;
            return raw.iter().flat_map(|x| absolute(x).to_be_bytes()).collect();
        }
        raw.iter().flat_map(|x| self.samples.bytes(*x)).collect()
    }

    fn entries(&self) -> Vec<(String, Vec<u8>)> {
        let general: String =
            self.general.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
        let mut entries = vec![("header.properties".to_owned(), general.clone().into_bytes())];
        let roots: Vec<String> = match self.indexes.as_slice() {
            [] => vec![String::new()],
            some => some.iter().map(|number| format!("index/{number}/")).collect(),
        };
        for root in roots {
            if !root.is_empty() {
                entries.push((root.clone(), Vec::new()));
                entries.push((format!("{root}header.properties"), general.clone().into_bytes()));
            }
            entries.push((format!("{root}segments/"), Vec::new()));
            for (number, part) in self.parts.iter().enumerate() {
                let folder = format!("{root}segments/{number}/");
                entries.push((folder.clone(), Vec::new()));
                let header = self.header(part).into_bytes();
                entries.push((format!("{folder}segment-header.properties"), header));
                for (name, _) in &self.channels {
                    let bytes = self.channel(name, &part.raw[name]);
                    entries.push((format!("{folder}channels/{name}.dat"), bytes));
                }
            }
        }
        if self.common == Common::Shared {
            let shared = self.shared().into_bytes();
            entries.push(("shared-data/header.properties".to_owned(), shared));
        }
        for [entry, old, new] in &self.replaced {
            let found = entries.iter_mut().find(|(name, _)| name == entry).unwrap();
            let text = String::from_utf8(found.1.clone()).unwrap();
            assert!(text.contains(old), "{entry}: {old} is not in\n{text}");
            found.1 = text.replace(old, new).into_bytes();
        }
        for (entry, bytes) in &self.edits {
            entries.retain(|(name, _)| name != entry);
            entries.extend(bytes.clone().map(|bytes| (entry.clone(), bytes)));
        }
        entries
    }

    /// The archive.
    pub fn zip(&self) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for (name, bytes) in self.entries() {
            if name.ends_with('/') {
                writer.add_directory(name.trim_end_matches('/'), deflated).unwrap();
            } else {
                writer.start_file(name.as_str(), deflated).unwrap();
                writer.write_all(&bytes).unwrap();
            }
        }
        writer.finish().unwrap().into_inner()
    }
}

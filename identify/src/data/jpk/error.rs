//! What can be wrong with a JPK archive: entry, key and value, what is allowed, and what to do.

/// Why a JPK archive gives no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// No zip archive, or a damaged one.
    #[error("no readable JPK archive (zip): {why}; copy the file from the instrument again")]
    NotZip {
        /// What is wrong.
        why: String,
    },
    /// Neither of the two places where JPK puts curves.
    #[error(
        "the archive holds no force curve: neither segments/ nor index/; images and calibrations are not read"
    )]
    NoCurve,
    /// Several curves and no choice.
    #[error(
        "the archive holds {count} curves, numbered from {first} to {last}; choose one with --set data.curve=NUMBER"
    )]
    ManyCurves {
        /// How many.
        count: usize,
        /// Lowest number.
        first: usize,
        /// Highest number.
        last: usize,
    },
    /// A curve that is not in the archive.
    #[error(
        "data.curve = {wanted}: there is no such curve; the archive holds {count}, numbered from {first} to {last}"
    )]
    NoSuchCurve {
        /// What was asked for.
        wanted: usize,
        /// How many there are.
        count: usize,
        /// Lowest number.
        first: usize,
        /// Highest number.
        last: usize,
    },
    /// An entry that others refer to is missing.
    #[error(
        "{entry}: missing in the archive; it is incomplete: copy the file from the instrument again"
    )]
    NoEntry {
        /// The entry.
        entry: String,
    },
    /// An entry where none belongs.
    #[error(
        "{entry}: not a place of a JPK archive (allowed: segments/NUMBER/…, index/NUMBER/…); the archive is \
         damaged: copy the file from the instrument again"
    )]
    Misplaced {
        /// The entry.
        entry: String,
    },
    /// An entry that cannot be unpacked.
    #[error("{entry}: cannot be unpacked: {why}; copy the file from the instrument again")]
    Damaged {
        /// The entry.
        entry: String,
        /// What is wrong.
        why: String,
    },
    /// An entry that unpacks to more than a curve can be.
    #[error("{entry}: unpacks to more than {limit} bytes; this is not a curve")]
    TooLong {
        /// The entry.
        entry: String,
        /// Most bytes that are read.
        limit: u64,
    },
    /// A line that is no property.
    #[error("{entry}, line {line}: \"\\u\" must be followed by four hexadecimal digits")]
    Properties {
        /// The entry.
        entry: String,
        /// The line.
        line: usize,
    },
    /// A property that is needed and missing.
    #[error(
        "{entry}: {key}: missing; give the file as the instrument saved it, not an export of the evaluation program"
    )]
    NoKey {
        /// The entry in which it should stand.
        entry: String,
        /// The key.
        key: String,
    },
    /// A property whose value is not allowed.
    #[error("{entry}: {key} = {value}: must be {allowed}")]
    Value {
        /// The entry.
        entry: String,
        /// The key.
        key: String,
        /// What stands there.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A channel that is not in the file.
    #[error(
        "{entry}: {option}: no channel \"{wanted}\"; the channels are: {found}. Name one with --set {option}=NAME"
    )]
    NoChannel {
        /// The entry.
        entry: String,
        /// Key that would name it.
        option: &'static str,
        /// What was looked for.
        wanted: String,
        /// What is there.
        found: String,
    },
    /// Another number of samples than is stated.
    #[error(
        "{entry}: {bytes} bytes; {key} = {stated} samples of {width} bytes need {}; the file is truncated: copy it \
         from the instrument again", *.stated as u64 * *.width as u64
    )]
    Length {
        /// The entry.
        entry: String,
        /// How long it is.
        bytes: usize,
        /// Bytes of a sample.
        width: usize,
        /// Key that states the number of samples.
        key: String,
        /// The number stated.
        stated: usize,
    },
    /// A sample that is no number.
    #[error(
        "{entry}: sample {sample} is {value}, not a finite number; the measurement cannot be used"
    )]
    NotFinite {
        /// The entry.
        entry: String,
        /// Which sample, from 0.
        sample: usize,
        /// What stands there.
        value: f64,
    },
    /// Conversions that lead back to themselves.
    #[error(
        "{entry}: {key}: the conversions refer to each other in a circle; none leads to the raw data"
    )]
    Circle {
        /// The entry.
        entry: String,
        /// Where the circle was entered.
        key: String,
    },
    /// Volts without sensitivity.
    #[error(
        "{entry}: {key}: not defined: the deflection is in volts and its sensitivity is not in the file; give it \
         with --set instrument.sensitivity=\"60 nm/V\" (your value) or in the file of known values"
    )]
    NoSensitivity {
        /// The entry.
        entry: String,
        /// The key.
        key: String,
    },
    /// Volts without sensitivity and without spring constant.
    #[error(
        "{entry}: {key}: not defined: the deflection is in volts, and neither its sensitivity nor the spring constant \
         of the lever is in the file; give both with --set instrument.sensitivity=\"60 nm/V\" --set \
         instrument.spring_constant=\"0.08 N/m\" (your values) or in the file of known values"
    )]
    NotCalibrated {
        /// The entry.
        entry: String,
        /// The key.
        key: String,
    },
    /// A deflection without spring constant.
    #[error(
        "{entry}: {key}: not defined: the spring constant of the lever is not in the file; give it with --set \
         instrument.spring_constant=\"0.08 N/m\" (your value) or in the file of known values"
    )]
    NoSpringConstant {
        /// The entry.
        entry: String,
        /// The key.
        key: String,
    },
    /// A height that stays in volts.
    #[error(
        "{entry}: {key}: no conversion of the height {channel} to metres is defined; name another channel with \
         --set data.height_column=NAME ({found})"
    )]
    NoMetres {
        /// The entry.
        entry: String,
        /// The key.
        key: String,
        /// The channel.
        channel: String,
        /// What channels there are.
        found: String,
    },
    /// Only pauses, or nothing.
    #[error("no segment extends or retracts ({found}); an approach or a retract is needed")]
    OnlyPauses {
        /// What segments there are.
        found: String,
    },
}

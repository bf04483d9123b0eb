//! JPK's archives: numbers known beforehand in both layouts, refusals with their words, damaged files.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod archives;

use archives::{Archive, Common, Samples};
use identify::data::jpk::numbers;
use identify::data::{Curve, Direction, Layout, read};

const NAME: &str = "a.jpk-force";

fn good(archive: &Archive) -> Curve {
    read(NAME, &archive.zip(), &Layout::default()).unwrap()
}

fn refused(archive: &Archive, layout: &Layout) -> String {
    let message = read(NAME, &archive.zip(), layout).unwrap_err().to_string();
    assert!(message.starts_with("a.jpk-force: "), "{message}");
    message
}

fn told(sensitivity: Option<f64>, spring_constant: Option<f64>) -> Layout {
    Layout { sensitivity, spring_constant, ..Layout::default() }
}

#[test]
fn both_layouts_give_the_known_numbers() {
    for common in [Common::Own, Common::Shared] {
        let curve = good(&Archive::new(common));
        assert_eq!(curve.spring_constant, Some(0.0625));
        assert_eq!(curve.notes, [""; 0]);
        assert_eq!(curve.segments.len(), 2);
        for (segment, direction) in
            curve.segments.iter().zip([Direction::Approach, Direction::Retract])
        {
            assert_eq!(segment.direction, direction);
            assert_eq!(segment.force.len(), 40);
            for (at, sample) in (0..40).enumerate() {
                // powers of two: the chain of factors rounds nothing
                let (height, force) = archives::known(direction, sample);
                assert_eq!(segment.height[at], height, "{common:?} {direction:?} {at}");
                assert_eq!(segment.force[at], force, "{common:?} {direction:?} {at}");
            }
        }
    }
}

#[test]
fn every_encoder_gives_the_same_numbers() {
    let wanted = good(&Archive::new(Common::Own));
    for common in [Common::Own, Common::Shared] {
        for samples in Samples::ALL {
            for limited in [false, true] {
                let mut archive = Archive::new(common);
                archive.encode(samples, limited);
                assert_eq!(good(&archive), wanted, "{common:?} {samples:?} {limited}");
            }
        }
        let mut archive = Archive::new(common);
        archive.floats("measuredHeight");
        assert_eq!(good(&archive), wanted, "{common:?} floats");
    }
}

/// Numbers of `fmt-jpk-fd_spot3-0192.jpk-force` (old layout, shorts) and of curve 2 of
/// `fmt-jpk-fd_2020.02.07-16.29.05.036.jpk-qi-data` (new layout, integers) from the test data of afmformats 0.18.7
/// (MIT): factors and raw samples as they stand there, forces and heights as `JPKReader.get_data` gives them.
#[test]
fn real_files_as_afmformats_reads_them() {
    struct Real {
        common: Common,
        samples: Samples,
        deflection: [f64; 2],
        sensitivity: f64,
        stiffness: f64,
        height: [f64; 2],
        nominal: f64,
        raw: [[i64; 4]; 4],
        force: [[f64; 4]; 2],
        metres: [[f64; 4]; 2],
    }
    let short = Real {
        common: Common::Own,
        samples: Samples::SignedShort,
        deflection: [3.0921021713588157e-4, -0.00728873489143207],
        sensitivity: 7.000143623002982e-8,
        stiffness: 0.043493666407368466,
        // the absolute height is -1e-5 m/V; here both factors are one
        height: [-1e-5 * 3.096917515831235e-4, -1e-5 * -0.008066754124209652],
        nominal: 1.0e-4,
        raw: [
            [-523, -510, -492, 3720],
            [24949, 25486, 26024, 26563],
            [3762, -595, -608, -618],
            [26563, 26033, 25493, 24956],
        ],
        force: [
            [
                -5.145579192349918e-10,
                -5.023193638438933e-10,
                -4.853736717639109e-10,
                3.479918274951986e-9,
            ],
            [
                3.5194582231386116e-9,
                -5.823406875549216e-10,
                -5.945792429460201e-10,
                -6.039935163237882e-10,
            ],
        ],
        metres: [
            [
                2.2815672438768612e-5,
                2.1152627732767232e-5,
                1.948648610925003e-5,
                1.7817247568217007e-5,
            ],
            [
                1.7817247568217007e-5,
                1.9458613851607555e-5,
                2.1130949310156427e-5,
                2.2793994016157793e-5,
            ],
        ],
    };
    let integer = Real {
        common: Common::Shared,
        samples: Samples::SignedInteger,
        deflection: [5.568822848285905e-9, -0.00012012213894932133],
        sensitivity: 2.4459525780419943e-8,
        stiffness: 0.03011408349962541,
        height: [-1.13243431640625e-14, -2.08004723508582e-5],
        nominal: 5e-6,
        raw: [
            [-36665206, -27041245, -26222701, -7305936],
            [-1804000652, -1769953609, -1733397193, -1695627023],
            [-9679667, -54574447, -59789421, -60664415],
            [-1695236674, -1727221955, -1762752489, -1799983135],
        ],
        force: [
            [
                -1.5048410831393407e-10,
                -1.1100794472603005e-10,
                -1.0765038988474408e-10,
                -3.0056423149640146e-11,
            ],
            [
                -3.9793141042582466e-11,
                -2.239453502548769e-10,
                -2.45336455926509e-10,
                -2.489255608992364e-10,
            ],
        ],
        metres: [
            [
                4.628650100582292e-6,
                4.2430897019286995e-6,
                3.8291123022964745e-6,
                3.401389935851499e-6,
            ],
            [
                3.3969694898217494e-6,
                3.7591817880647175e-6,
                4.161541747883106e-6,
                4.583154359406839e-6,
            ],
        ],
    };
    for real in [short, integer] {
        let mut archive = Archive::new(real.common);
        archive.encode(real.samples, false);
        for (channel, [multiplier, offset]) in
            [("vDeflection", real.deflection), ("measuredHeight", real.height)]
        {
            archive.set(channel, "encoder.scaling.multiplier", &format!("{multiplier:e}"));
            archive.set(channel, "encoder.scaling.offset", &format!("{offset:e}"));
        }
        archive.conversion("vDeflection", "distance", real.sensitivity, 0.0);
        archive.conversion("vDeflection", "force", real.stiffness, 0.0);
        archive.conversion("measuredHeight", "nominal", 1.0, real.nominal);
        for segment in 0..2 {
            archive.raw(segment, "vDeflection", &real.raw[2 * segment]);
            archive.raw(segment, "measuredHeight", &real.raw[2 * segment + 1]);
        }
        let curve = good(&archive);
        for segment in 0..2 {
            for at in 0..4 {
                let (force, wanted) = (curve.segments[segment].force[at], real.force[segment][at]);
                assert!((force / wanted - 1.0).abs() < 1e-12, "{force:e} {wanted:e}");
                let (height, wanted) =
                    (curve.segments[segment].height[at], real.metres[segment][at]);
                assert!((height / wanted - 1.0).abs() < 1e-12, "{height:e} {wanted:e}");
            }
        }
    }
}

#[test]
fn pauses_are_left_out_and_told() {
    let mut archive = Archive::new(Common::Shared);
    archive.insert_segment(1, "pause");
    let curve = good(&archive);
    assert_eq!(curve.segments, good(&Archive::new(Common::Shared)).segments);
    assert_eq!(curve.notes, ["pauses are not fitted and left out: segment 1"]);
    let mut alone = Archive::new(Common::Own);
    alone.style(0, "pause");
    alone.style(1, "pause");
    assert!(refused(&alone, &Layout::default()).contains("pauses alone: 0, 1"));
}

#[test]
fn an_approach_of_two_speeds_is_one_segment() {
    let mut archive = Archive::new(Common::Own);
    archive.halve(0);
    assert_eq!(good(&archive), good(&Archive::new(Common::Own)));
}

#[test]
fn segments_that_were_not_written_are_told() {
    let mut archive = Archive::new(Common::Own);
    archive.general("force-scan-series.force-segments.count", "3");
    let curve = good(&archive);
    assert!(curve.notes[0].contains("force-segments.count = 3"), "{:?}", curve.notes);
}

#[test]
fn the_height_that_a_sensor_measured_is_taken_unless_another_is_named() {
    let mut archive = Archive::new(Common::Shared);
    let (measured, _) = archives::known(Direction::Approach, 0);
    assert_eq!(good(&archive).segments[0].height[0], measured);
    let named = Layout { height_column: Some("height".into()), ..Layout::default() };
    let piezo = read(NAME, &archive.zip(), &named).unwrap();
    assert_eq!(piezo.segments[0].height[0], 2.0 * measured);
    let wrong = Layout { height_column: Some("Height".into()), ..Layout::default() };
    let message = refused(&archive, &wrong);
    for words in ["data.height_column", "\"Height\"", "vDeflection, measuredHeight, height"] {
        assert!(message.contains(words), "{message}");
    }
    archive.remove_channel("measuredHeight");
    let curve = good(&archive);
    assert_eq!(curve.segments, piezo.segments);
    assert!(curve.notes[0].contains("no sensor measured the height"), "{:?}", curve.notes);
    archive.undefine("height", "nominal");
    assert!(refused(&archive, &Layout::default()).contains("no conversion of the height height"));
}

#[test]
fn volts_need_sensitivity_and_spring_constant() {
    for common in [Common::Own, Common::Shared] {
        let place = match common {
            Common::Own => "segments/0/segment-header.properties: channel.vDeflection.",
            Common::Shared => "shared-data/header.properties: lcd-info.0.",
        };
        let wanted = good(&Archive::new(common)).segments;
        let mut archive = Archive::new(common);
        archive.undefine("vDeflection", "force");
        let message = refused(&archive, &Layout::default());
        for words in [place, "conversion.force", "--set instrument.spring_constant="] {
            assert!(message.contains(words), "{message}");
        }
        let curve = read(NAME, &archive.zip(), &told(None, Some(0.0625))).unwrap();
        assert_eq!((curve.segments, curve.spring_constant), (wanted.clone(), None));
        archive.undefine("vDeflection", "distance");
        let message = refused(&archive, &Layout::default());
        assert!(message.contains("neither its sensitivity nor the spring constant"), "{message}");
        let message = refused(&archive, &told(None, Some(0.0625)));
        assert!(message.contains("--set instrument.sensitivity="), "{message}");
        let both = told(Some(archives::SENSITIVITY), Some(0.0625));
        assert_eq!(read(NAME, &archive.zip(), &both).unwrap().segments, wanted);
        archive.set("vDeflection", "encoder.scaling.unit.unit", "A");
        assert!(refused(&archive, &both).contains("scaling.unit.unit = A: must be V"));
    }
}

#[test]
fn what_is_known_of_the_lever_replaces_what_the_file_says() {
    let archive = Archive::new(Common::Shared);
    let curve = good(&archive);
    let more = told(Some(2.0 * archives::SENSITIVITY), Some(0.25));
    let other = read(NAME, &archive.zip(), &more).unwrap();
    for (a, b) in curve.segments.iter().zip(&other.segments) {
        assert!(a.force.iter().zip(&b.force).all(|(a, b)| *b == 8.0 * a));
        assert_eq!(a.height, b.height);
    }
    // the file's constant is told, so that the program can warn
    assert_eq!(other.spring_constant, Some(0.0625));
    assert!(other.notes[0].contains("states a sensitivity"), "{:?}", other.notes);
}

#[test]
fn a_deflection_in_metres_needs_no_sensitivity_and_says_so() {
    let mut archive = Archive::new(Common::Shared);
    // the samples are metres: what the sensitivity would have made of volts
    let factor = archives::SENSITIVITY / 1024.0;
    archive.set("vDeflection", "encoder.scaling.multiplier", &format!("{factor:e}"));
    let offset = archives::SENSITIVITY * 0.5;
    archive.set("vDeflection", "encoder.scaling.offset", &format!("{offset:e}"));
    archive.set("vDeflection", "encoder.scaling.unit.unit", "m");
    archive.undefine("vDeflection", "distance");
    archive.set("vDeflection", "conversion-set.conversions.base", "distance");
    let curve = good(&archive);
    assert_eq!(curve, good(&Archive::new(Common::Shared)));
    let known = read(NAME, &archive.zip(), &told(Some(1e-7), Some(0.0625))).unwrap();
    assert_eq!(known.segments, curve.segments);
    let note = "the sensitivity that is known is not used: the file's own samples are distance";
    assert_eq!(known.notes, [note]);
}

#[test]
fn newtons_for_a_volt_are_no_spring_constant() {
    let mut archive = Archive::new(Common::Own);
    archive.conversion("vDeflection", "force", archives::SENSITIVITY * 0.0625, 0.0);
    let place = "conversion-set.conversion.force.base-calibration-slot";
    archive.set("vDeflection", place, "volts");
    let curve = good(&archive);
    assert_eq!(curve.segments, good(&Archive::new(Common::Own)).segments);
    assert_eq!(curve.spring_constant, None);
}

#[test]
fn signs_that_go_the_other_way_are_refused_or_turned() {
    let mut archive = Archive::new(Common::Own);
    archive.conversion("vDeflection", "force", -0.0625, 0.0);
    assert!(refused(&archive, &Layout::default()).contains("data.force_sign=-1"));
    let turned = Layout { force_sign: Some(-1.0), ..Layout::default() };
    let curve = read(NAME, &archive.zip(), &turned).unwrap();
    assert_eq!(curve.segments, good(&Archive::new(Common::Own)).segments);
    let mut archive = Archive::new(Common::Own);
    archive.conversion("measuredHeight", "nominal", -1.0, 0.0);
    assert!(refused(&archive, &Layout::default()).contains("data.height=rises"));
}

#[test]
fn of_a_map_one_curve_is_asked_for() {
    let wanted = good(&Archive::new(Common::Shared)).segments;
    let mut map = Archive::new(Common::Shared);
    map.map(&[109]);
    assert_eq!(good(&map).segments, wanted);
    map.map(&[129, 416]);
    assert_eq!(numbers(&map.zip()).unwrap(), [109, 129, 416]);
    for ending in identify::data::jpk::ENDINGS {
        let name = format!("m.{ending}");
        let message = read(&name, &map.zip(), &Layout::default()).unwrap_err().to_string();
        let words = "3 curves, numbered from 109 to 416; choose one with --set data.curve=NUMBER";
        assert!(message.contains(words), "{message}");
        let one = Layout { curve: Some(129), ..Layout::default() };
        let curve = read(&name, &map.zip(), &one).unwrap();
        assert_eq!((curve.name, curve.segments), (name, wanted.clone()));
    }
    let none = Layout { curve: Some(110), ..Layout::default() };
    assert!(refused(&map, &none).contains("data.curve = 110: there is no such curve"));
}

#[test]
fn what_is_wrong_is_named_with_entry_key_value_and_what_is_allowed() {
    const HEAD: &str = "segments/0/segment-header.properties";
    const SHARED: &str = "shared-data/header.properties";
    let place = "lcd-info.0.conversion-set";
    // entry, what stands there, what stands there instead, words of the message
    let edited: [(&str, &str, &str, &[&str]); 19] = [
        (
            SHARED,
            "=signedinteger\n",
            "=signedbyte\n",
            &["lcd-info.0.encoder.type = signedbyte", "one of signedshort"],
        ),
        (SHARED, "integer-data", "raster-data", &["a.jpk-force"]),
        (
            SHARED,
            "0.encoder.scaling.style=offsetmultiplier",
            "0.encoder.scaling.style=table",
            &["style = table", "offsetmultiplier"],
        ),
        (
            SHARED,
            "lcd-info.0.encoder.scaling.multiplier=",
            "lcd-info.0.encoder.scaling.multiplier=NaN#",
            &["multiplier = NaN#", "a finite number"],
        ),
        (
            SHARED,
            "lcd-info.0.encoder.scaling.offset=5e-1",
            "lcd-info.0.encoder.scaling.offset=inf",
            &["offset = inf", "a finite number"],
        ),
        (
            SHARED,
            "conversion.force.scaling.multiplier=6.25e-2",
            "conversion.force.scaling.multiplier=0",
            &["multiplier = 0", "other than 0"],
        ),
        (
            SHARED,
            "lcd-info.0.encoder.scaling.offset",
            "lcd-info.0.encoder.scaling.ofset",
            &["lcd-info.0.encoder.scaling.offset: missing"],
        ),
        (
            SHARED,
            "lcd-info.0.channel.name=vDeflection",
            "lcd-info.0.channel.name=hDeflection",
            &["channel.name = hDeflection", "vDeflection"],
        ),
        (
            SHARED,
            "force.base-calibration-slot=distance",
            "force.base-calibration-slot=force",
            &["in a circle"],
        ),
        (
            SHARED,
            "conversion.force.scaling.unit.unit=N",
            "conversion.force.scaling.unit.unit=V",
            &["[V]", "end in N"],
        ),
        (
            SHARED,
            "conversions.base=volts",
            "conversions.bass=volts",
            &[&format!("{place}.conversions.base: missing")],
        ),
        (
            SHARED,
            "settings.style=extend",
            "settings.style=sideways",
            &["settings.style = sideways", "extend, retract or pause"],
        ),
        (
            SHARED,
            "lcd-info.0.channel.name=vDeflection",
            "lcd-info.0.channel.name=\\u00g1",
            &["line 3", "four hexadecimal digits"],
        ),
        (
            HEAD,
            "force-segment-header-info.*=0",
            "force-segment-header-info.*=7",
            &["force-segment-header-info.7.settings.style: missing"],
        ),
        (HEAD, "channels.list", "channel.list", &["channels.list: missing"]),
        (
            HEAD,
            "channels/vDeflection.dat",
            "channels/v.dat",
            &["segments/0/channels/v.dat: missing"],
        ),
        (
            HEAD,
            "channel.vDeflection.data.num-points=40",
            "channel.vDeflection.data.num-points=41",
            &["160 bytes", "= 41 samples of 4 bytes need 164", "truncated"],
        ),
        (
            HEAD,
            "channel.vDeflection.data.num-points=40",
            "channel.vDeflection.data.num-points=-1",
            &["num-points = -1", "not negative"],
        ),
        (
            HEAD,
            "vDeflection.data.file.format=raw",
            "vDeflection.data.file.format=gzip",
            &["file.format = gzip: must be raw"],
        ),
    ];
    for (entry, old, new, words) in edited {
        let mut archive = Archive::new(Common::Shared);
        if old == "integer-data" {
            // a ramp that is computed, not stored: it has no encoder
            archive.replace(entry, "lcd-info.0.encoder.type", "lcd-info.0.encoder.tape");
        }
        archive.replace(entry, old, new);
        let message = refused(&archive, &Layout::default());
        // the entry, or one that it leads to
        assert!([SHARED, "segments/0/"].iter().any(|e| message.contains(e)), "{message}");
        for words in words {
            assert!(message.contains(words), "{old} -> {new}: {words}: {message}");
        }
    }
    let missing = [
        ("header.properties", "header.properties: missing in the archive"),
        (SHARED, "shared-data/header.properties: missing in the archive"),
        (HEAD, "segments/0/segment-header.properties: missing in the archive"),
        ("segments/1/channels/measuredHeight.dat", "measuredHeight.dat: missing in the archive"),
    ];
    for (entry, words) in missing {
        let mut archive = Archive::new(Common::Shared);
        archive.entry(entry, None);
        let message = refused(&archive, &Layout::default());
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn what_is_no_archive_of_curves_is_named() {
    for (bytes, words) in [
        (b"segment,height_nm,force_nN\n".to_vec(), "no readable JPK archive"),
        (Vec::new(), "no readable JPK archive"),
        (Archive::new(Common::Own).zip()[..2000].to_vec(), "no readable JPK archive"),
    ] {
        let message = read(NAME, &bytes, &Layout::default()).unwrap_err().to_string();
        assert!(message.contains(words) && message.starts_with(NAME), "{message}");
    }
    let mut image = Archive::new(Common::Own);
    for segment in 0..2 {
        for entry in ["", "segment-header.properties", "channels/vDeflection.dat"] {
            image.entry(&format!("segments/{segment}/{entry}"), None);
        }
        for channel in ["measuredHeight", "height"] {
            image.entry(&format!("segments/{segment}/channels/{channel}.dat"), None);
        }
    }
    assert!(refused(&image, &Layout::default()).contains("holds no force curve"));
    let mut strange = Archive::new(Common::Own);
    strange.entry("segments/one/segment-header.properties", Some(Vec::new()));
    let message = refused(&strange, &Layout::default());
    assert!(message.contains("segments/one/segment-header.properties: not a place"), "{message}");
}

#[test]
fn samples_that_are_no_numbers_are_named() {
    let mut archive = Archive::new(Common::Shared);
    archive.floats("measuredHeight");
    let mut bytes = vec![0; 160];
    bytes[8..12].copy_from_slice(&f32::NAN.to_be_bytes());
    archive.entry("segments/0/channels/measuredHeight.dat", Some(bytes));
    let message = refused(&archive, &Layout::default());
    assert!(message.contains("measuredHeight.dat: sample 2 is NaN"), "{message}");
}

#[test]
fn an_entry_that_unpacks_without_end_is_stopped() {
    // 32 MB of zeros, a few kilobytes in the archive
    for entry in ["segments/0/channels/vDeflection.dat", "shared-data/header.properties"] {
        let mut archive = Archive::new(Common::Shared);
        archive.entry(entry, Some(vec![0; 32 << 20]));
        let bytes = archive.zip();
        assert!(bytes.len() < 100_000, "{}", bytes.len());
        let message = read(NAME, &bytes, &Layout::default()).unwrap_err().to_string();
        assert!(message.contains(entry) && message.contains("unpacks to more than"), "{message}");
    }
}

/// Flipped bits, bytes set at random and cut ends: an error that names the file, or the same curve.
#[test]
fn damaged_archives_are_refused_or_read_as_before() {
    let (mut errors, mut same) = (0, 0);
    for (common, seed) in [(Common::Own, 1_u64), (Common::Shared, 2)] {
        let archive = Archive::new(common);
        let (bytes, curve) = (archive.zip(), good(&archive));
        let mut state = seed;
        // Knuth's linear congruence; its upper bits are random enough to choose places
        let mut below = |n: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        for round in 0..600 {
            let mut damaged = bytes.clone();
            match round % 3 {
                0 => damaged.truncate(below(bytes.len())),
                1 => damaged[below(bytes.len())] ^= 1 << below(8),
                _ => {
                    let at = below(bytes.len());
                    for byte in damaged.iter_mut().skip(at).take(1 + below(8)) {
                        *byte = below(256) as u8;
                    }
                }
            }
            match read(NAME, &damaged, &Layout::default()) {
                Ok(found) => {
                    assert_eq!(found, curve, "{common:?} {round}");
                    same += 1;
                }
                Err(error) => {
                    assert!(error.to_string().starts_with("a.jpk-force: "), "{round}: {error}");
                    errors += 1;
                }
            }
        }
    }
    // both happen: some bytes are dates and attributes, or other channels
    assert!(errors > 600 && same > 100, "{errors} {same}");
}

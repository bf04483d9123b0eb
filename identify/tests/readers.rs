//! Files of curves: what is read, what is asked for, what is refused, each with its words.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use identify::data::{Direction, Layout, read};

const TAB: &str = include_str!("data/open-1-hard-knee.tab");

fn refused(name: &str, text: &str, layout: &Layout) -> String {
    read(name, text.as_bytes(), layout).unwrap_err().to_string()
}

fn ramp(header: &str, separator: &str, row: impl Fn(f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for (name, back) in [("approach", false), ("retract", true)] {
        for i in 0..20 {
            let i = if back { 19 - i } else { i };
            let (h, f) = (2000.0 - 10.0 * f64::from(i), f64::from(i));
            text.push_str(&format!("{name}{separator}{}\n", row(h, f)));
        }
    }
    text
}

#[test]
fn tab_of_afmformats() {
    let curve = read("a.tab", TAB.as_bytes(), &Layout::default()).unwrap();
    assert_eq!(curve.spring_constant, Some(1.2));
    assert_eq!(curve.segments[0].direction, Direction::Approach);
    assert_eq!(curve.segments[1].direction, Direction::Retract);
    // the numbers as they stand, to the last bit
    assert_eq!(curve.segments[0].force[0], -3.2281651e-09);
    assert_eq!(curve.segments[0].height[0], 8.60801744e-06);
}

#[test]
fn columns_by_name_with_their_units() {
    for header in [
        "segment,height [nm],force [nN]",
        "segment,height (nm),force (nN)",
        "segment,height_nm,force_nN",
        "segment,height_piezo_nm,Force / nN",
    ] {
        let text = ramp(header, ",", |h, f| format!("{h},{f}"));
        let curve = read("a.csv", text.as_bytes(), &Layout::default()).unwrap();
        assert_eq!(curve.segments.len(), 2, "{header}");
        assert!((curve.segments[0].height[1] - 1.99e-6).abs() < 1e-18, "{header}");
        assert!((curve.segments[0].force[1] - 1e-9).abs() < 1e-21, "{header}");
    }
}

#[test]
fn without_a_unit_one_is_asked_for() {
    let text = ramp("segment,height,force [nN]", ",", |h, f| format!("{h},{f}"));
    let message = refused("a.csv", &text, &Layout::default());
    assert!(message.contains("a.csv: data.height_unit") && message.contains("nm"), "{message}");
    let told = Layout { height_unit: Some("nm".into()), ..Layout::default() };
    assert!(read("a.csv", text.as_bytes(), &told).is_ok());
    let wrong = Layout { height_unit: Some("inch".into()), ..Layout::default() };
    assert!(refused("a.csv", &text, &wrong).contains("data.height_unit = inch"));
}

#[test]
fn a_decimal_comma_is_told() {
    let comma = |x: f64| format!("{x:.2}").replace('.', ",");
    let text =
        ramp("segment;height [nm];force [nN]", ";", |h, f| format!("{};{}", comma(h), comma(f)));
    let message = refused("a.csv", &text, &Layout::default());
    assert!(message.contains("data.decimal=comma"), "{message}");
    let told = Layout { decimal_comma: Some(true), ..Layout::default() };
    let curve = read("a.csv", text.as_bytes(), &told).unwrap();
    assert!((curve.segments[0].height[1] - 1.99e-6).abs() < 1e-18);
}

/// With commas between columns too the halves of numbers would be read as columns.
#[test]
fn halves_of_numbers_are_no_columns() {
    let halves = ramp("segment,height [nm],force [nN]", ",", |h, f| format!("{h},5,{f},5"));
    let words = refused("a.csv", &halves, &Layout::default());
    assert!(words.contains("a.csv, line 2: 5 fields under 3 names"), "{words}");
    // a separator at the end of each line is none
    let ends = ramp("segment,height [nm],force [nN]", ",", |h, f| format!("{h},{f},,"));
    assert_eq!(read("a.csv", ends.as_bytes(), &Layout::default()).unwrap().len(), 40);
}

#[test]
fn volts_with_the_sensitivity_and_spring_constant_of_the_lever() {
    let lever = |sensitivity, spring_constant| Layout {
        sensitivity,
        spring_constant,
        force_column: Some("deflection".into()),
        ..Layout::default()
    };
    for (header, volts) in [("deflection [V]", 1.0), ("deflection [mV]", 1e-3)] {
        let text = ramp(&format!("segment,height [nm],{header}"), ",", |h, f| format!("{h},{f}"));
        let known = lever(Some(6e-8), Some(0.05));
        let curve = read("a.csv", text.as_bytes(), &known).unwrap();
        let wanted = 7.0 * volts * 6e-8 * 0.05;
        assert!((curve.segments[0].force[7] / wanted - 1.0).abs() < 1e-14, "{header}");
        for (known, words) in [
            (lever(None, Some(0.05)), "needs the sensitivity"),
            (lever(Some(6e-8), None), "needs the spring constant"),
            (lever(None, None), "needs sensitivity and spring constant"),
        ] {
            let message = refused("a.csv", &text, &known);
            assert!(message.contains(header) && message.contains(words), "{message}");
        }
    }
    // a height stays in volts whatever the lever is
    let text = ramp("segment,height [V],force [nN]", ",", |h, f| format!("{h},{f}"));
    let known = Layout { force_column: None, ..lever(Some(6e-8), Some(0.05)) };
    assert!(refused("a.csv", &text, &known).contains("data.height_unit = V: must be one of m"));
}

#[test]
fn of_two_heights_the_measured_one_is_taken_and_told() {
    let header = "segment,height (piezo) [nm],height (measured) [nm],force [nN]";
    let text = ramp(header, ",", |h, f| format!("{},{h},{f}", 0.6 * h));
    let curve = read("a.csv", text.as_bytes(), &Layout::default()).unwrap();
    assert!((curve.segments[0].height[1] - 1.99e-6).abs() < 1e-18);
    assert!(
        curve.notes[0].contains("data.height_column=\"height (piezo) [nm]\""),
        "{:?}",
        curve.notes
    );
    let told = Layout { height_column: Some("height (piezo)".into()), ..Layout::default() };
    let curve = read("a.csv", text.as_bytes(), &told).unwrap();
    assert!((curve.segments[0].height[1] - 0.6 * 1.99e-6).abs() < 1e-18);
    assert!(curve.notes.is_empty());
}

#[test]
fn forces_of_a_tab_follow_the_spring_constant_that_is_known() {
    let known = Layout { spring_constant: Some(2.4), ..Layout::default() };
    let curve = read("a.tab", TAB.as_bytes(), &known).unwrap();
    assert_eq!(curve.spring_constant, Some(1.2));
    assert_eq!(curve.segments[0].force[0], 2.0 * -3.2281651e-09);
    let same = Layout { spring_constant: Some(1.2), ..Layout::default() };
    let curve = read("a.tab", TAB.as_bytes(), &same).unwrap();
    assert_eq!(curve.segments[0].force[0], -3.2281651e-09);
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let none = Layout::default();
    let good = ramp("segment,height_nm,force_nN", ",", |h, f| format!("{h},{f}"));
    for (name, text, words) in [
        ("a.csv", good.replace("1950,5\n", "1950,nan\n"), "line 7: force_nN = \"nan\""),
        ("a.csv", good.replace("force_nN", "kraft_nM"), "data.force_column"),
        ("a.csv", good.replace("force_nN", "force_V"), "volts"),
        ("a.csv", good.replacen("approach", "sideways", 1), "line 2: segment = \"sideways\""),
        (
            "a.csv",
            good.replace("approach", "x").replace("retract", "approach").replace("x,", "retract,"),
            "data.height=rises",
        ),
        ("a.csv", "segment,height_nm,force_nN\n".to_owned(), "no samples"),
        ("a.tab", "1\t2\n".to_owned(), "no header"),
        ("a.jpk-force", good.clone(), "no readable JPK archive"),
        ("a.ibw", good.clone(), "format \".ibw\" is not known"),
    ] {
        let message = refused(name, &text, &none);
        assert!(message.contains(words) && message.contains(name), "{words}: {message}");
    }
    let flipped = ramp("segment,height_nm,force_nN", ",", |h, f| format!("{h},{}", -f));
    assert!(refused("a.csv", &flipped, &none).contains("data.force_sign=-1"));
    let told = Layout { force_sign: Some(-1.0), ..Layout::default() };
    assert!(read("a.csv", flipped.as_bytes(), &told).is_ok());
    let shaken = ramp("segment,height_nm,force_nN", ",", |h, f| {
        format!("{},{f}", if f % 3.0 == 0.0 { h + 90.0 } else { h })
    });
    assert!(refused("a.csv", &shaken, &none).contains("to and fro"));
}

#[test]
fn without_segments_the_approach_ends_at_the_least_height() {
    let text: String = ramp("segment,height_nm,force_nN", ",", |h, f| format!("{h},{f}"))
        .lines()
        .map(|l| format!("{}\n", l.split_once(',').unwrap().1))
        .collect();
    let curve = read("a.csv", text.as_bytes(), &Layout::default()).unwrap();
    assert_eq!(curve.segments.len(), 2);
    assert!(curve.notes[0].contains("no column says the segment"));
}

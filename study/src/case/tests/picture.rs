//! How pictures look, in cases.

use super::*;

#[test]
fn a_look_is_read_and_written() {
    assert!(!read(GOOD).to_toml().contains("[picture]"));
    let text = format!(
        "{GOOD}\n[picture]\nwidth = 300\nfont_size = 20\nx = \"z0\"\ny = \"gas_pressure\"\nx_from = 0.8\n\
         x_to = 0.9\ny_scale = \"logarithmic\"\nlegend = false\n"
    );
    let case = read(&text);
    let picture = &case.picture;
    assert_eq!((picture.width, picture.height, picture.font_size), (Some(300), None, 20.0));
    assert_eq!(picture.x.column.as_deref(), Some("z0"));
    assert_eq!((picture.x.from, picture.x.to), (Some(0.8), Some(0.9)));
    assert_eq!(picture.y.scale, AxisScale::Logarithmic);
    assert!(!picture.parts.legend && picture.parts.title);
    assert_eq!(read(&case.to_toml()), case);
}

#[test]
fn what_is_wrong_with_a_look_is_said() {
    let complaint = |line: &str| {
        read_with(&format!("{GOOD}\n[picture]\n{line}\n"), &[]).unwrap_err().replace('\n', " | ")
    };
    let line = GOOD.lines().count() + 3;
    for (text, key, words) in [
        ("width = 20", "width = 20", "150 to 4000"),
        ("font_size = 0", "font_size = 0", "must be from 6 to 60"),
        ("x = \"forc\"", "x = \"forc\"", "(did you mean \"force\"?)"),
        ("x_scale = \"log\"", "x_scale = \"log\"", "automatic, linear, logarithmic"),
        ("x_from = 2\nx_to = 1", "x_to = 1", "greater than picture.x_from"),
        ("legend = 1", "legend = 1", "expected"),
        ("colour = 1", "colour", "unknown key"),
        ("y_scale = \"logarithmic\"\ny_from = -1.0", "y_from = -1.0", "positive on a logarithmic"),
    ] {
        let said = complaint(text);
        assert!(said.contains(&format!("picture.{key}")) && said.contains(words), "{text}: {said}");
        assert!(said.starts_with(&format!("a.toml, line {line}")) || text.contains('\n'), "{said}");
    }
    let given = Override::given_by("--picture", "picture.x=\"y\"");
    let said = read_with("problem = \"cusp\"\n", &[given]).unwrap_err();
    assert_eq!(said, "a.toml, --picture: picture.x = \"y\": must be one of mu, x, unstable");
}

#[test]
fn pictures_of_no_single_case_have_looks_too() {
    let of = |text: &str| picture_of(&[Override::given_by("--picture", format!("picture.{text}"))]);
    assert_eq!(of("width=200").unwrap().width, Some(200));
    let said = of("width=2").unwrap_err().to_string();
    assert!(said.starts_with("pictures, --picture: picture.width = 2: "), "{said}");
    assert!(of("x=force").unwrap_err().to_string().contains("axes of their own"));
}

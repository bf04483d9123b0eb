//! A branch as columns, as a table in CSV, and as a place from which to go on.

use super::{Branch, Point};
use std::io::{self, Write};

/// What a column of a branch shows.
#[derive(Debug, Clone, Copy)]
enum Column {
    Parameter,
    Observable(usize),
    Arclength,
    Slope,
    Unstable,
    Certified,
    Unknown(usize),
}

/// A point of a branch from which another trace can start ([`Branch::restart_point`]).
#[derive(Debug, Clone, PartialEq)]
pub struct RestartPoint {
    /// The unknowns.
    pub u: Vec<f64>,
    /// Value of the continued parameter.
    pub p: f64,
    /// Whether the parameter increases along the branch from there on.
    pub increasing: bool,
}

impl Branch {
    /// The values of a quantity at all points, in order: the continued parameter or an observable by
    /// its name, else `s`, `dp_ds`, `unstable` (NaN where it is not known), `certified` (1 or 0), or
    /// the unknown number `i` as `u[i]`. `None` where there is no such quantity.
    ///
    /// ```
    /// use continuation::{Settings, Tracer, samples::Cusp};
    /// let settings = Settings { target: Some(2.0), ..Settings::default() };
    /// let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)?.run_quietly();
    /// let (mu, x) = (branch.column("mu").unwrap(), branch.column("u[0]").unwrap());
    /// assert_eq!((mu.first(), mu.last()), (Some(&-2.0), Some(&2.0)));
    /// assert!(mu.iter().zip(&x).all(|(mu, x)| (mu + x - x.powi(3)).abs() < 1e-9));
    /// assert!(branch.column("force").is_none());
    /// # Ok::<(), continuation::TraceError>(())
    /// ```
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.find(name)?;
        Some(self.points.iter().map(|point| value(point, column)).collect())
    }

    /// Writes the branch as a table in CSV, a line for each point: `point`, the arclength `s`, the
    /// continued parameter, the observables, `unstable` (empty where it is not known), `certified`
    /// and the kind of special point in `event`. Numbers are written such that they are read back
    /// exactly.
    ///
    /// ```
    /// use continuation::{Settings, Tracer, samples::Cusp};
    /// let settings = Settings { target: Some(2.0), ..Settings::default() };
    /// let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)?.run_quietly();
    /// let mut csv = Vec::new();
    /// branch.write_csv(&mut csv).unwrap();
    /// assert!(csv.starts_with(b"point,s,mu,x,unstable,certified,event\n0,0.0,-2.0,"));
    /// # Ok::<(), continuation::TraceError>(())
    /// ```
    ///
    /// # Errors
    /// What the writer reports.
    pub fn write_csv(&self, mut out: impl Write) -> io::Result<()> {
        let observables = self.observables.iter().map(String::as_str);
        let titles: Vec<&str> = ["point", "s", &self.parameter]
            .into_iter()
            .chain(observables)
            .chain(["unstable", "certified", "event"])
            .collect();
        for (at, title) in titles.iter().enumerate() {
            separate(&mut out, at)?;
            word(&mut out, title)?;
        }
        writeln!(out)?;
        for (index, point) in self.points.iter().enumerate() {
            write!(out, "{index},{:?},{:?}", point.s, point.p)?;
            for value in &point.observables {
                write!(out, ",{value:?}")?;
            }
            match point.unstable {
                Some(count) => write!(out, ",{count},{},", point.certified)?,
                None => write!(out, ",,{},", point.certified)?,
            }
            if let Some(event) = point.event.and_then(|event| self.events.get(event)) {
                word(&mut out, &event.kind.to_string())?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// Writes some of the columns ([`Branch::column`]) as a table in CSV, under their names.
    ///
    /// # Errors
    /// When there is no such column ([`io::ErrorKind::NotFound`]), and what the writer reports.
    pub fn write_columns(&self, mut out: impl Write, names: &[&str]) -> io::Result<()> {
        let find = |name: &&str| {
            self.find(name).ok_or_else(|| {
                io::Error::new(io::ErrorKind::NotFound, format!("the branch has no column {name}"))
            })
        };
        let columns = names.iter().map(find).collect::<io::Result<Vec<Column>>>()?;
        for (at, name) in names.iter().enumerate() {
            separate(&mut out, at)?;
            word(&mut out, name)?;
        }
        writeln!(out)?;
        for point in &self.points {
            for (at, column) in columns.iter().enumerate() {
                separate(&mut out, at)?;
                write!(out, "{:?}", value(point, *column))?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// The point from which to go on, special or not: its state, its parameter and the branch's way
    /// there; `None` where there is none of that number. [`crate::Tracer::from_point`] goes on from
    /// it.
    pub fn restart_point(&self, index: usize) -> Option<RestartPoint> {
        let point = self.points.get(index)?;
        // where the branch is vertical, as the next point says, else as the one before
        let around = [Some(index), index.checked_add(1), index.checked_sub(1)];
        let slopes = around.into_iter().flatten().filter_map(|i| self.points.get(i));
        let slope = slopes.map(|q| q.dp_ds).find(|slope| *slope != 0.0);
        Some(RestartPoint {
            u: point.u.clone(),
            p: point.p,
            increasing: slope.is_none_or(|slope| slope > 0.0),
        })
    }

    fn find(&self, name: &str) -> Option<Column> {
        if name == self.parameter {
            return Some(Column::Parameter);
        }
        if let Some(at) = self.observables.iter().position(|known| known == name) {
            return Some(Column::Observable(at));
        }
        match name {
            "s" => Some(Column::Arclength),
            "dp_ds" => Some(Column::Slope),
            "unstable" => Some(Column::Unstable),
            "certified" => Some(Column::Certified),
            _ => {
                let at: usize = name.strip_prefix("u[")?.strip_suffix(']')?.parse().ok()?;
                let is_one = self.points.first().is_some_and(|point| at < point.u.len());
                is_one.then_some(Column::Unknown(at))
            }
        }
    }
}

fn value(point: &Point, column: Column) -> f64 {
    match column {
        Column::Parameter => point.p,
        Column::Observable(at) => point.observables.get(at).copied().unwrap_or(f64::NAN),
        Column::Arclength => point.s,
        Column::Slope => point.dp_ds,
        Column::Unstable => point.unstable.map_or(f64::NAN, |count| count as f64),
        Column::Certified => f64::from(u8::from(point.certified)),
        Column::Unknown(at) => point.u.get(at).copied().unwrap_or(f64::NAN),
    }
}

fn separate(out: &mut impl Write, at: usize) -> io::Result<()> {
    if at == 0 { Ok(()) } else { write!(out, ",") }
}

/// A word, in quotes where it holds what separates.
fn word(out: &mut impl Write, text: &str) -> io::Result<()> {
    if text.contains([',', '"', '\n', '\r']) {
        write!(out, "\"{}\"", text.replace('"', "\"\""))
    } else {
        write!(out, "{text}")
    }
}

//! What people see at the end of a sweep.

use super::json::SweepResult;
use super::record::{CaseRecord, Status};
use crate::record::StabilityRecord;
use crate::record::phase::Class;
use crate::record::summary::{aligned, count};
use std::fmt::Write as _;
use std::path::Path;

/// Cases with a reason that are named.
const NAMED: usize = 10;

/// Which modes were counted along the branches of shells, and how many lose stability to those that
/// break the symmetry.
fn stability(records: &[CaseRecord]) -> String {
    let mut out = String::new();
    let scans: Vec<StabilityRecord> =
        records.iter().filter_map(|record| record.stability).collect();
    let (full, own): (Vec<_>, Vec<_>) = scans.into_iter().partition(|scan| scan.full);
    let (all, only) = (!full.is_empty(), !own.is_empty());
    for scans in [own, full] {
        let number = scans.len();
        let Some(scan) = scans.into_iter().reduce(|all, one| all.and(&one)) else { continue };
        let of = if all && only {
            format!("{}, ", count(number, "case", "cases"))
        } else {
            String::new()
        };
        out += &scan.text().replace("stability: ", &format!("stability: {of}"));
    }
    if all {
        let lost = records.iter().filter_map(|record| record.first_loss.as_ref());
        let (waves, mirror): (Vec<_>, Vec<_>) = lost.partition(|loss| loss.n > 0);
        let _ = writeln!(
            out,
            "first loss of symmetry along the branch: with waves around the axis in {}, without in {}",
            count(waves.len(), "case", "cases"),
            mirror.len(),
        );
    }
    out
}

/// The summary; `folder` is where the files went, if they went anywhere.
pub fn sweep_summary(result: &SweepResult, folder: Option<&Path>) -> String {
    let mut out = String::new();
    let records = &result.records;
    if records.iter().any(|record| record.phase.is_some()) {
        let of = |class| {
            records.iter().filter(|r| r.phase.map_or(Class::Unknown, |p| p.class) == class).count()
        };
        let rows = Class::ALL.map(|class| (class, of(class)));
        let mut lines = vec![vec!["class".to_owned(), "cases".to_owned()]];
        let met = rows.iter().filter(|(_, number)| *number > 0);
        lines.extend(met.map(|(class, number)| vec![class.to_string(), number.to_string()]));
        out.push_str(&aligned(&lines));
        out.push('\n');
    }
    out.push_str(&stability(records));
    let troubled = records.iter().filter(|record| record.status != Status::Finished);
    for record in troubled.clone().take(NAMED) {
        let reason = record.reason.as_deref().or(record.stopped_because.as_deref());
        let _ = writeln!(out, "case {}: {}: {}", record.case, record.status, reason.unwrap_or("–"));
    }
    if troubled.clone().count() > NAMED {
        let _ = writeln!(out, "… and {} more, see sweep.json", troubled.count() - NAMED);
    }
    let seconds: f64 = records.iter().map(|record| record.seconds).sum();
    let shard = match result.plan.shard {
        shard if shard.is_all() => String::new(),
        shard => format!(", shard {shard}"),
    };
    let _ = writeln!(
        out,
        "{}{shard}: {}; {} of {} finished, {} stopped early, {} failed; {seconds:.2} s of work",
        result.plan.name,
        result.stopped_because(),
        result.number(Status::Finished),
        count(result.asked, "case", "cases"),
        result.number(Status::StoppedEarly),
        result.number(Status::Failed),
    );
    if result.waiting() > 0 {
        let _ = writeln!(out, "{} to go: give the same command again", result.waiting());
    }
    if let Some(folder) = folder {
        let _ = writeln!(out, "written to {}", folder.display());
    }
    out
}

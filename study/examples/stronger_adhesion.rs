//! A shipped case with two changed keys: how adhesion deepens the pull-off.
//!
//! `cargo run --release -p arclen-study --example stronger_adhesion`

use std::ops::ControlFlow;
use study::{case, run};

#[allow(clippy::print_stdout)] // an example may
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let loaded = case::find("fig12", &["dimensionless.adhesion=3e-3", "mesh.elements=100"])?;
    let branch = run::run_trace(&loaded.case, &mut |_| ControlFlow::Continue(()))?;
    let (z0, force) = (branch.table.numbers("z0"), branch.table.numbers("force"));
    println!("z0 ({})  force ({})", branch.table.unit("z0"), branch.table.unit("force"));
    for (z0, force) in z0.iter().zip(&force) {
        println!("{z0:.6}  {force:.6}");
    }
    for event in branch.events.iter().filter(|event| event.kind == "pull-off") {
        println!("pull-off: {:.6}", event.force.unwrap_or(f64::NAN));
    }
    Ok(())
}

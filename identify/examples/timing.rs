#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]
use identify::data::{Curve, Direction, Segment};
use identify::fit::{Setup, fit, objective::Prior};
use identify::{Key, LawName, Parameters};
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let sets = [("open-1-hard-knee", 37.4, 2.01129e-15, 2e-4, 20e-9, 1.62e-6, LawName::Hooke, 1.58e-6, 1.2, 7.8030095e-6), ("open-2-soft-lipid", 0.06, 4e-16, 2e-4, 40e-9, 1.4e-6, LawName::MooneyRivlin, 1.44e-6, 0.06, 12.2588772e-6), ("open-3-soft-adhesive", 0.045, 2.4e-16, 1.2e-3, 45e-9, 1.55e-6, LawName::MooneyRivlin, 1.55e-6, 0.05, 13.6340636e-6)];
    for (name, c, k, w, d, r, law, opt, spring, hc) in sets {
        let text = std::fs::read_to_string(format!("{dir}/{name}.csv")).unwrap();
        let mut segs: Vec<Segment> = vec![];
        for dir in [Direction::Approach, Direction::Retract] {
            let mut s = Segment { direction: dir, height: vec![], force: vec![] };
            for l in text.lines().skip(1) { let v: Vec<&str> = l.split(',').collect(); if v[0] == dir.name() { s.height.push(v[1].parse().unwrap()); s.force.push(v[2].parse().unwrap()); } }
            segs.push(s);
        }
        let curve = Curve { name: name.into(), segments: segs, ..Curve::default() };
        let mut p = Parameters::default();
        p[Key::Radius] = opt; p[Key::SpringConstant] = spring;
        let setup = Setup::new(law, p, vec![Prior { key: Key::Radius, value: opt, sd: 5e-8 }]);
        let t = std::time::Instant::now();
        let fitted = fit(&curve, &setup);
        println!("{name}: {:.2} s", t.elapsed().as_secs_f64());
        match fitted {
            Err(e) => println!("  {e}"),
            Ok(f) => {
                let q = f.objective.parameters(&f.best.x);
                let n = f.objective.count();
                println!("  evals {} starts {} chi2/n {:.4} noise {:.3e} conv {} others {} coarse {:.1} elements {} look {:?}", f.evaluations, f.starts, f.best.at.chi2 / n as f64, f.objective.noise, f.best.converged, f.others.len(), f.coarse_cost, f.objective.model.effort.elements, f.look);
                let cov = f.best.at.normal.clone().try_inverse().unwrap();
                for (i, (key, truth)) in [(Key::Chi, c), (Key::Bending, k), (Key::Adhesion, w), (Key::Film, d), (Key::Radius, r), (Key::Contact, hc), (Key::Offset, 0.0), (Key::Tilt, 0.0)].iter().enumerate() {
                    println!("  {:10} truth {:.6e} estimate {:.6e} sd {:.2e} z {:.2} ratio {:.5}", key.name(), truth, q[*key], cov[(i,i)].sqrt(), (key.coordinate(q[*key]) - key.coordinate(*truth)) / cov[(i,i)].sqrt(), q[*key]/truth);
                }
                println!("  nodes {}", f.branch.nodes().len()); println!("  E {:.4e} h {:.4e}", q.young(), q.thickness());
                for s in &f.branch.stretches { println!("  stretch {:.4e} {:.4e} {} {}", s.from, s.to, s.begins_at_fold, s.ends_at_fold); }
            }
        }
    }
}

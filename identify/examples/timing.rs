#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]
use identify::data::{Curve, Direction, Segment};
use identify::fit::{Setup, objective::Prior};
use identify::{Key, LawName, Parameters};
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let sets = [
        (
            "open-1-hard-knee",
            37.4,
            2.01129e-15,
            2e-4,
            20e-9,
            1.62e-6,
            LawName::Hooke,
            1.58e-6,
            1.2,
            7.8030095e-6,
        ),
        (
            "open-2-soft-lipid",
            0.06,
            4e-16,
            2e-4,
            40e-9,
            1.4e-6,
            LawName::MooneyRivlin,
            1.44e-6,
            0.06,
            12.2588772e-6,
        ),
        (
            "open-3-soft-adhesive",
            0.045,
            2.4e-16,
            1.2e-3,
            45e-9,
            1.55e-6,
            LawName::MooneyRivlin,
            1.55e-6,
            0.05,
            13.6340636e-6,
        ),
    ];
    for (name, c, k, w, d, r_, law, opt, spring, hc) in sets {
        let text = std::fs::read_to_string(format!("{dir}/{name}.csv")).unwrap();
        let mut segs: Vec<Segment> = vec![];
        for dir in [Direction::Approach, Direction::Retract] {
            let mut s = Segment { direction: dir, height: vec![], force: vec![] };
            for l in text.lines().skip(1) {
                let v: Vec<&str> = l.split(',').collect();
                if v[0] == dir.name() {
                    s.height.push(v[1].parse().unwrap());
                    s.force.push(v[2].parse().unwrap());
                }
            }
            segs.push(s);
        }
        let curve = Curve { name: name.into(), segments: segs, ..Curve::default() };
        let mut p = Parameters::default();
        p[Key::Radius] = opt;
        p[Key::SpringConstant] = spring;
        let mut setup = Setup::new(law, p, vec![Prior { key: Key::Radius, value: opt, sd: 5e-8 }]);
        if let Some(x) = std::env::args().nth(2) {
            let lo: f64 = x.parse().unwrap();
            setup.range = Some((lo, 1.0));
        }
        setup.spring_constant_sd = 0.0;
        let t = std::time::Instant::now();
        let found = identify::identify(&curve, &setup, &identify::Profiles::WhereNeeded);
        println!("{name}: {:.2} s", t.elapsed().as_secs_f64());
        match found {
            Err(e) => println!("  {e}"),
            Ok(f) => {
                let r = &f.report;
                println!("  {:?} {:?}", r.quality, r.reach);
                let mut q = p;
                q[Key::Chi] = c;
                q[Key::Bending] = k;
                let truth = [
                    ("chi", c),
                    ("bending", k),
                    ("adhesion", w),
                    ("film", d),
                    ("radius", r_),
                    ("contact", hc),
                    ("young", q.young()),
                    ("thickness", q.thickness()),
                    ("sqrt_chi_kb", q.force_scale()),
                ];
                for (key, truth) in truth {
                    let e = r.estimate(key).unwrap();
                    let i = e.interval95.map(|x| x.unwrap_or(f64::NAN));
                    println!(
                        "  {key:10} truth {truth:.5e} estimate {:.5e} stat sd {:.2}% [{:.5e}, {:.5e}] inside {} {} {:?}",
                        e.value,
                        100.0 * e.sd_statistical.unwrap_or(f64::NAN) / e.value,
                        i[0],
                        i[1],
                        i[0] < truth && truth < i[1],
                        e.method,
                        e.verdict
                    );
                }
                println!("  {} evals {}", r.weakest_direction, r.cost.evaluations);
                for w in &r.warnings {
                    println!("  {}: {}", w.code, w.text);
                }
                for j in &r.jumps {
                    println!("  {j:?}");
                }
                for p in &r.profiles {
                    println!(
                        "  {} {:?}",
                        p.key,
                        p.points
                            .iter()
                            .map(|x| (format!("{:.4} {:.2}", x.offset, x.growth)))
                            .collect::<Vec<_>>()
                    );
                }
            }
        }
    }
}

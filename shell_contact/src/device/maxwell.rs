//! Maxwell points: two equilibria of equal total potential at one value of the device's parameter.
//!
//! Along a branch the potential has the slope `−2√k_b F` in `z0` or the base, `2√k_b z0` in the force.
//! Monotone stretches of the branch, Hermite cubics in the parameter, are compared on their common
//! range; where their potentials cross, Newton's method in the parameter follows, both states being
//! solved for at every trial.

use super::Loading;
use continuation::{Branch, Matrix, NewtonSettings, newton};

/// Two states of equal potential.
#[derive(Debug, Clone, PartialEq)]
pub struct MaxwellPoint {
    /// The device's parameter.
    pub parameter: f64,
    /// Total potential of both, in `χR0²`.
    pub potential: f64,
    /// Heights of the plate, in the order along the branch.
    pub z0: [f64; 2],
    /// Forces.
    pub force: [f64; 2],
    /// Energies of the whole shell, without the device.
    pub energy: [f64; 2],
    /// Unstable modes under the device.
    pub unstable: [Option<usize>; 2],
    /// The unknowns.
    pub states: [Vec<f64>; 2],
    /// Estimated error of the parameter.
    pub error_estimate: f64,
}

impl MaxwellPoint {
    /// Whether both states are stable, so that the system can pass from one to the other.
    pub fn is_stable(&self) -> bool {
        self.unstable == [Some(0); 2]
    }
}

/// Iterations in the parameter.
const MOST: usize = 30;
/// Heights or forces that agree so well, and shells too, are one state.
const SAME: f64 = 1e-7;

/// All Maxwell points of a branch traced in the device's parameter, stable or not, in the order of
/// the first of their states along the branch.
pub fn maxwell_points<P: Loading>(problem: &P, branch: &Branch) -> Vec<MaxwellPoint> {
    let curve = Curve::new(problem, branch);
    let stretches = curve.stretches();
    let mut found: Vec<MaxwellPoint> = Vec::new();
    for (k, a) in stretches.iter().enumerate() {
        for b in &stretches[k + 1..] {
            for (p, at_a, at_b) in curve.crossings(a, b) {
                let polished = polish(problem, branch, p, at_a, at_b);
                found.extend(polished.filter(|m| !found.iter().any(|n| is_same(m, n))));
            }
        }
    }
    found
}

fn is_same(a: &MaxwellPoint, b: &MaxwellPoint) -> bool {
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < SAME && (a[1] - b[1]).abs() < SAME;
    near(a.z0, b.z0) && near(a.force, b.force)
}

/// The branch as parameter, potential and its slope.
struct Curve {
    p: Vec<f64>,
    potential: Vec<f64>,
    slope: Vec<f64>,
}

/// A stretch in which the parameter grows or falls: indices of its first and last point.
type Stretch = (usize, usize);
/// A place on a stretch: between this point and the next, at this share of the way.
type Place = (usize, f64);

impl Curve {
    fn new<P: Loading>(problem: &P, branch: &Branch) -> Self {
        let device = problem.device();
        let column = |name: &str| branch.observables.iter().position(|n| n == name);
        let (force, energy) = (column("force"), column("energy_total"));
        let mut curve = Curve { p: Vec::new(), potential: Vec::new(), slope: Vec::new() };
        let mut parameters = problem.parameters_at(0.0);
        let root = problem.root(&parameters);
        for point in &branch.points {
            let value = |at: Option<usize>| at.map_or(f64::NAN, |k| point.observables[k]);
            parameters[0] = point.p;
            let z0 = problem.plate(&point.u, &parameters);
            curve.p.push(point.p);
            curve.potential.push(value(energy) + device.potential(root, point.p, z0));
            curve.slope.push(device.potential_slope(root, z0, value(force)));
        }
        curve
    }

    fn stretches(&self) -> Vec<Stretch> {
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut upwards = None;
        for k in 1..self.p.len() {
            let step = self.p[k] - self.p[k - 1];
            let way = (step != 0.0).then_some(step > 0.0).or(upwards);
            match stretches.last_mut() {
                Some(last) if way == upwards => last.1 = k,
                _ => stretches.push((k - 1, k)),
            }
            upwards = way;
        }
        stretches
    }

    /// Potential of a stretch at `p`, and where that is.
    fn at(&self, stretch: Stretch, p: f64) -> Option<(f64, Place)> {
        let upwards = self.p[stretch.1] > self.p[stretch.0];
        let inside = (stretch.0..stretch.1).find(|&k| {
            let (a, b) = (self.p[k], self.p[k + 1]);
            if upwards { a <= p && p <= b } else { b <= p && p <= a }
        })?;
        let (a, b) = (inside, inside + 1);
        let h = self.p[b] - self.p[a];
        let t = if h == 0.0 { 0.0 } else { (p - self.p[a]) / h };
        let d = self.potential[b] - self.potential[a];
        let (sa, sb) = (h * self.slope[a], h * self.slope[b]);
        let curve = (3.0 * d - 2.0 * sa - sb) + t * (sa + sb - 2.0 * d);
        Some((self.potential[a] + t * (sa + t * curve), (a, t)))
    }

    /// Where the potentials of two stretches cross.
    fn crossings(&self, a: &Stretch, b: &Stretch) -> Vec<(f64, Place, Place)> {
        let range = |s: &Stretch| {
            let (x, y) = (self.p[s.0], self.p[s.1]);
            (x.min(y), x.max(y))
        };
        let ((low_a, high_a), (low_b, high_b)) = (range(a), range(b));
        let (low, high) = (low_a.max(low_b), high_a.min(high_b));
        let mut grid: Vec<f64> = (a.0..=a.1)
            .chain(b.0..=b.1)
            .map(|k| self.p[k])
            .chain([low, high])
            .filter(|p| (low..=high).contains(p))
            .collect();
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        // more places than points: near a fold the stretches are close and steep
        let between: Vec<f64> = grid.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        grid.extend(between);
        grid.sort_by(f64::total_cmp);
        let mut crossings = Vec::new();
        let mut before: Option<(f64, f64)> = None;
        for p in grid {
            let (Some((ea, _)), Some((eb, _))) = (self.at(*a, p), self.at(*b, p)) else { continue };
            let difference = ea - eb;
            // at a fold that two stretches share there is no difference
            if difference.abs() <= 1e-13 * (ea.abs() + eb.abs()) {
                continue;
            }
            if let Some((p0, d0)) = before
                && d0 * difference < 0.0
            {
                let p = p0 + (p - p0) * d0 / (d0 - difference);
                if let (Some((_, at_a)), Some((_, at_b))) = (self.at(*a, p), self.at(*b, p)) {
                    crossings.push((p, at_a, at_b));
                }
            }
            before = Some((p, difference));
        }
        crossings
    }
}

/// Newton's method in the parameter.
fn polish<P: Loading>(
    problem: &P,
    branch: &Branch,
    mut at: f64,
    a: Place,
    b: Place,
) -> Option<MaxwellPoint> {
    let start = |(k, t): Place| -> Vec<f64> {
        let (x, y) = (&branch.points[k].u, &branch.points[k + 1].u);
        x.iter().zip(y).map(|(x, y)| x + t * (y - x)).collect()
    };
    let mut states = [start(a), start(b)];
    let reach = |(k, _): Place| (branch.points[k + 1].p - branch.points[k].p).abs();
    let (first, reach) = (at, 2.0 * (reach(a) + reach(b)));
    let mut p = problem.parameters_at(at);
    let root = problem.root(&p);
    let mut last = f64::INFINITY;
    for _ in 0..MOST {
        p[0] = at;
        let (mut potential, mut slope) = ([0.0; 2], [0.0; 2]);
        let (mut z0, mut force, mut energy) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for k in 0..2 {
            newton(problem, &mut states[k], &p, &NewtonSettings::default()).ok()?;
            z0[k] = problem.plate(&states[k], &p);
            force[k] = problem.mean_force(&states[k], &p).ok()?;
            energy[k] = problem.energy(&states[k], &p).ok()?;
            potential[k] = problem.potential(&states[k], &p).ok()?;
            slope[k] = problem.device().potential_slope(root, z0[k], force[k]);
        }
        let same = (z0[0] - z0[1]).abs() + (force[0] - force[1]).abs();
        let steepness = slope[0] - slope[1];
        if same < SAME || steepness == 0.0 || (at - first).abs() > reach {
            return None;
        }
        let step = (potential[0] - potential[1]) / steepness;
        let rounding =
            4.0 * f64::EPSILON * (potential[0].abs() + potential[1].abs()) / steepness.abs();
        let settled = step.abs() <= rounding || (step.abs() < 1e-11 && step.abs() >= 0.5 * last);
        if settled {
            let unstable = [0, 1].map(|k| modes(problem, &states[k], &p));
            return Some(MaxwellPoint {
                parameter: at,
                potential: 0.5 * (potential[0] + potential[1]),
                z0,
                force,
                energy,
                unstable,
                states,
                error_estimate: step.abs() + rounding,
            });
        }
        last = step.abs();
        at -= step;
    }
    None
}

fn modes<P: Loading>(problem: &P, x: &[f64], p: &[f64]) -> Option<usize> {
    let mut hessian = problem.new_jacobian();
    problem.jacobian(x, p, &mut hessian).ok()?;
    let floor = f64::EPSILON * hessian.norm();
    let inertia = hessian.factor(floor).inertia;
    inertia.map(|(negative, _)| negative.saturating_sub(problem.multipliers()))
}

//! The branch as an instrument sees it: force over the travel of the piezo, in stable stretches.
//!
//! One lever of stiffness `K` presses the bubble on a rigid substrate. With `n` contacts that deform (two:
//! both poles; one: the bubble is held), the travel beyond the contact point is
//!
//! ```text
//! X = n R0 (1 − z0) + F/K,     D = z_s − S F̂_s/(n R0 K) = −X_s/(n R0),     S = √(χ k_b)
//! ```
//!
//! Along the branch `X` turns back at the folds under the lever; a stretch is a part between them on which
//! `X` grows and no mode is unstable: the negative eigenvalues at fixed plate, and one more where
//! `D/z_s < 0`. At fixed `X` a coordinate `x` of the parameters moves the force by
//!
//! ```text
//! dF/dx = [ z_s S_x F̂ + S Σ_q (z_s F̂_q) q_x + S F̂_s/(n R0) (n R0_x (1 − z0) − F K_x/K²) ] / D
//! ```
//!
//! Numbers between points are cubic Hermite interpolants in the arclength, of `z0` and `F̂` separately.

use crate::branch::{Group, Node, ShellBranch};
use crate::data::Direction;
use crate::error::ModelError;
use crate::parameters::{Key, Parameters};

/// Force and its derivatives at a travel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Force, N.
    pub force: f64,
    /// `dF/dX`, N/m.
    pub stiffness: f64,
    /// Height of the plate, `z0/R0`.
    pub height: f64,
    /// `dF/dx` at fixed travel, in the order of the keys asked for.
    pub by_key: Vec<f64>,
}

/// A stable stretch, by travel.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Travel at its ends, m.
    pub from: f64,
    /// The larger one.
    pub to: f64,
    /// Whether it begins at a fold under the lever.
    pub begins_at_fold: bool,
    /// Whether it ends at one; otherwise it ends where the branch was left.
    pub ends_at_fold: bool,
    /// Arclength at its ends.
    s: (f64, f64),
    /// Points from `nodes.0` to `nodes.1` lie in it.
    nodes: (usize, usize),
}

/// A jump under the lever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeverJump {
    /// The stretch that ends.
    pub from: usize,
    /// The one that is reached.
    pub to: usize,
    /// Travel at which it happens, m.
    pub travel: f64,
}

/// Most stretches: a curve with more is that of a mesh that does not resolve its film.
const MOST: usize = 32;

/// A branch under a lever.
#[derive(Debug, Clone)]
pub struct LeverBranch {
    nodes: Vec<Node>,
    parameters: Parameters,
    contacts: f64,
    /// Its stable stretches, from the free shell inwards.
    pub stretches: Vec<Stretch>,
}

impl LeverBranch {
    /// Reads a branch under the lever of `parameters`, with one contact or two.
    ///
    /// # Errors
    /// When no part of it is stable.
    pub fn new(
        branch: ShellBranch,
        parameters: &Parameters,
        contacts: u8,
    ) -> Result<LeverBranch, ModelError> {
        let mut lever = LeverBranch {
            nodes: branch.nodes,
            parameters: *parameters,
            contacts: f64::from(contacts),
            stretches: Vec::new(),
        };
        lever.stretches = lever.find_stretches();
        if lever.stretches.is_empty() { Err(ModelError::NothingStable) } else { Ok(lever) }
    }

    /// The same dimensionless branch under other scales: moduli that change alike, and another lever. `None`
    /// when nothing of it is stable then.
    pub fn stretched(&self, parameters: &Parameters) -> Option<LeverBranch> {
        let mut other =
            LeverBranch { parameters: *parameters, stretches: Vec::new(), ..self.clone() };
        other.stretches = other.find_stretches();
        (!other.stretches.is_empty()).then_some(other)
    }

    /// The points of the branch.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    fn scale(&self) -> f64 {
        self.parameters.force_scale()
    }

    /// `n R0`.
    fn reach(&self) -> f64 {
        self.contacts * self.parameters[Key::Radius]
    }

    /// Travel where the plate is at `z` and the dimensionless force is `f`.
    pub fn travel(&self, z: f64, f: f64) -> f64 {
        self.reach() * (1.0 - z) + self.scale() * f / self.parameters[Key::SpringConstant]
    }

    /// `dX/ds`.
    fn travel_slope(&self, dz: f64, df: f64) -> f64 {
        -self.reach() * dz + self.scale() * df / self.parameters[Key::SpringConstant]
    }

    fn find_stretches(&self) -> Vec<Stretch> {
        let nodes = &self.nodes;
        let slope: Vec<f64> = nodes.iter().map(|n| self.travel_slope(n.dz, n.dforce)).collect();
        let mut found = Vec::new();
        let mut k = 0;
        while k < nodes.len() {
            // NaN is no growth
            if slope[k].partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
                k += 1;
                continue;
            }
            let first = k;
            while k + 1 < nodes.len() && slope[k + 1] > 0.0 {
                k += 1;
            }
            let last = k;
            k += 1;
            let middle = nodes[(first + last) / 2];
            // −X_s = n R0 D and X_s > 0: the lever adds a mode where the plate recedes
            let unstable = middle.unstable + usize::from(middle.dz > 0.0);
            if unstable > 0 {
                continue;
            }
            let start = (first > 0).then(|| self.turn(first - 1)).flatten();
            let end = (last + 1 < nodes.len()).then(|| self.turn(last)).flatten();
            let s = (start.unwrap_or(nodes[first].s), end.unwrap_or(nodes[last].s));
            let at = |s: f64, k: usize| {
                let (z, f, ..) = self.between(k, s);
                self.travel(z, f)
            };
            let from = at(s.0, if start.is_some() { first - 1 } else { first });
            let to = at(s.1, if end.is_some() { last } else { last.saturating_sub(1) });
            // a point alone, or one that is no number, is no stretch
            if from.partial_cmp(&to) != Some(std::cmp::Ordering::Less) || found.len() == MOST {
                continue;
            }
            found.push(Stretch {
                from,
                to,
                begins_at_fold: start.is_some(),
                ends_at_fold: end.is_some(),
                s,
                nodes: (first, last),
            });
        }
        found
    }

    /// Arclength in the interval after point `k` where the travel turns, by bisection of its slope.
    fn turn(&self, k: usize) -> Option<f64> {
        let (a, b) = (self.nodes.get(k)?.s, self.nodes.get(k + 1)?.s);
        let slope = |s: f64| {
            let (_, _, dz, df) = self.between(k, s);
            self.travel_slope(dz, df)
        };
        let (mut low, mut high) = (a, b);
        let sign = slope(low) > 0.0;
        if (slope(high) > 0.0) == sign {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if (slope(middle) > 0.0) == sign { low = middle } else { high = middle }
        }
        Some(if sign { low } else { high })
    }

    /// `z0`, `F̂` and their slopes at `s` in the interval after point `k`.
    fn between(&self, k: usize, s: f64) -> (f64, f64, f64, f64) {
        let k = k.min(self.nodes.len().saturating_sub(2));
        let Some(b) = self.nodes.get(k + 1) else {
            let a = &self.nodes[k];
            return (a.z, a.force, a.dz, a.dforce);
        };
        let a = &self.nodes[k];
        let h = b.s - a.s;
        let t = (s - a.s) / h;
        let (z, dz) = hermite(a.z, b.z, h * a.dz, h * b.dz, t);
        let (f, df) = hermite(a.force, b.force, h * a.dforce, h * b.dforce, t);
        (z, f, dz / h, df / h)
    }

    /// Arclength, and the interval, at a travel inside a stretch.
    fn place(&self, stretch: &Stretch, travel: f64) -> (usize, f64) {
        let (first, last) = stretch.nodes;
        let inside = &self.nodes[first..=last];
        let count = inside.partition_point(|n| self.travel(n.z, n.force) <= travel);
        // the interval after that point; before the first one it belongs to the fold
        let k = if count == 0 { first.saturating_sub(1) } else { first + count - 1 };
        let k = k.min(self.nodes.len().saturating_sub(2));
        let (mut low, mut high) = (
            self.nodes[k].s.max(stretch.s.0),
            self.nodes.get(k + 1).map_or(stretch.s.1, |n| n.s.min(stretch.s.1)),
        );
        let mut s = 0.5 * (low + high);
        for _ in 0..50 {
            let (z, f, dz, df) = self.between(k, s);
            let miss = self.travel(z, f) - travel;
            if miss > 0.0 {
                high = s
            } else {
                low = s
            }
            let newton = s - miss / self.travel_slope(dz, df);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let done = (next - s).abs() <= 1e-12 * (1.0 + s.abs());
            s = next;
            if done {
                break;
            }
        }
        (k, s)
    }

    /// What is read on a stretch at a travel. Beyond its ends it goes on along the lever's line, the shell
    /// as rigid as at the end: continuous, and worse with every sample there.
    pub fn read(&self, stretch: &Stretch, travel: f64, keys: &[Key], out: &mut Reading) {
        let inside = travel.clamp(stretch.from, stretch.to);
        let (k, s) = self.place(stretch, inside);
        let (z, f, dz, df) = self.between(k, s);
        let lever = self.parameters[Key::SpringConstant];
        let (scale, reach) = (self.scale(), self.reach());
        let d = dz - scale * df / (reach * lever);
        let at_end = inside != travel;
        let stiffness = scale * df / (-reach * d);
        out.height = z;
        if at_end {
            out.force = scale * f + lever * (travel - inside);
            out.stiffness = lever;
        } else {
            out.force = scale * f;
            out.stiffness = stiffness;
        }
        out.by_key.clear();
        for &key in keys {
            out.by_key.push(match key {
                Key::Contact => out.stiffness,
                Key::Offset | Key::Tilt => 0.0,
                // at an end that moves with the parameters no derivative is claimed
                _ if at_end => 0.0,
                _ => self.derivative(key, k, s, (z, f, df, dz), d),
            });
        }
    }

    /// The jumps on the way from stretch `start` to the travel `end`: each from the fold at which a stretch ends to the
    /// next that reaches as far.
    pub fn jumps(&self, direction: Direction, start: usize, end: f64) -> Vec<LeverJump> {
        let mut found = Vec::new();
        let mut from = start;
        while let Some(stretch) = self.stretches.get(from) {
            let next = match direction {
                Direction::Approach if stretch.ends_at_fold && stretch.to < end => {
                    let travel = stretch.to;
                    let beyond = |k: &usize| self.stretches[*k].to > travel;
                    (from + 1..self.stretches.len()).find(beyond).map(|to| (to, travel))
                }
                Direction::Retract if stretch.begins_at_fold && stretch.from > end => {
                    let travel = stretch.from;
                    let beyond = |k: &usize| self.stretches[*k].from < travel;
                    (0..from).rev().find(beyond).map(|to| (to, travel))
                }
                _ => None,
            };
            let Some((to, travel)) = next else { break };
            found.push(LeverJump { from, to, travel });
            from = to;
        }
        found
    }

    /// Travel of the fold at which a stretch ends in a direction, and its derivatives by the coordinates of the keys.
    /// There `X_s = 0`, so that what the fold moves by along the branch does not count:
    ///
    /// ```text
    /// dX/dx = n R0_x (1 − z0) + (S_x F̂ + S Σ_q F̂_q q_x)/K − S F̂ K_x/K²
    /// ```
    pub fn fold(&self, stretch: usize, direction: Direction, keys: &[Key]) -> (f64, Vec<f64>) {
        let Some(stretch) = self.stretches.get(stretch) else { return (f64::NAN, Vec::new()) };
        let (k, s) = match direction {
            Direction::Approach => (stretch.nodes.1, stretch.s.1),
            Direction::Retract => (stretch.nodes.0.saturating_sub(1), stretch.s.0),
        };
        let (z, f, dz, df) = self.between(k, s);
        let lever = self.parameters[Key::SpringConstant];
        // the same sum as of the force at fixed travel, which `D` divides
        let by_key = keys.iter().map(|&key| self.derivative(key, k, s, (z, f, df, dz), dz) / lever);
        (self.travel(z, f), by_key.collect())
    }

    /// `dF/dx` at fixed travel.
    fn derivative(
        &self,
        key: Key,
        k: usize,
        s: f64,
        (z, f, df, dz): (f64, f64, f64, f64),
        d: f64,
    ) -> f64 {
        let (scale, reach) = (self.scale(), self.reach());
        let p = &self.parameters;
        // of ln S; of the groups; of ln R0; of ln K
        let mut by_groups = 0.0;
        let mut group = |which: Group, amount: f64| {
            if amount != 0.0 {
                by_groups += amount * self.by_group(k, s, which);
            }
        };
        let (mut ln_scale, mut ln_radius, mut ln_lever) = (0.0, 0.0, 0.0);
        match key {
            Key::Chi => {
                ln_scale = 0.5;
                group(Group::Bending, -1.0);
                group(Group::Pressure, -1.0);
                group(Group::Adhesion, -1.0);
                group(Group::SurfaceTension, -p[Key::SurfaceTension] / p[Key::Chi]);
            }
            Key::Bending => {
                ln_scale = 0.5;
                group(Group::Bending, 1.0);
            }
            Key::Adhesion => group(Group::Adhesion, 1.0),
            Key::Film => group(Group::Film, 1.0),
            Key::Radius => {
                ln_radius = 1.0;
                group(Group::Bending, -2.0);
                group(Group::Pressure, 1.0);
                group(Group::Film, -1.0);
            }
            Key::Pressure => group(Group::Pressure, 1.0),
            Key::SurfaceTension => group(Group::SurfaceTension, 1.0 / p[Key::Chi]),
            Key::GasExponent => group(Group::GasExponent, 1.0),
            Key::Poisson => group(Group::Poisson, 1.0),
            Key::MooneyB => group(Group::MooneyB, 1.0),
            Key::SpringConstant => ln_lever = 1.0,
            Key::Contact | Key::Offset | Key::Tilt => {}
        }
        let shift = reach * ln_radius * (1.0 - z) - scale * f * ln_lever / p[Key::SpringConstant];
        (dz * scale * ln_scale * f + scale * by_groups + scale * df / reach * shift) / d
    }

    /// `z_s F̂_q` at `s` after point `k`, by a cubic through four points.
    fn by_group(&self, k: usize, s: f64, which: Group) -> f64 {
        let first = k.saturating_sub(1).min(self.nodes.len().saturating_sub(4));
        let near = &self.nodes[first..(first + 4).min(self.nodes.len())];
        let mut sum = 0.0;
        for (i, a) in near.iter().enumerate() {
            let mut weight = 1.0;
            for (j, b) in near.iter().enumerate() {
                if i != j {
                    weight *= (s - b.s) / (a.s - b.s);
                }
            }
            sum += weight * a.by_group[which as usize];
        }
        sum
    }
}

/// Cubic with given values and slopes (per unit of `t`) at 0 and 1: value and slope at `t`.
fn hermite(a: f64, b: f64, da: f64, db: f64, t: f64) -> (f64, f64) {
    let c2 = 3.0 * (b - a) - 2.0 * da - db;
    let c3 = 2.0 * (a - b) + da + db;
    (a + t * (da + t * (c2 + t * c3)), da + t * (2.0 * c2 + t * 3.0 * c3))
}

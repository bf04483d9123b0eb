//! From parameters to what an instrument would read at every sample.

use crate::assign::assign;
use crate::attend::Attended;
use crate::branch::{Effort, GROUPS, Group, Span, trace};
use crate::data::Curve;
use crate::error::ModelError;
use crate::lever::{LeverBranch, Reading};
use crate::parameters::{Key, Parameters};
use shell_contact::LawName;
use shell_contact::Resolution;

/// Gap of the free shell, in `R0`, from which the branch starts at the farthest: beyond it the film pulls
/// with less than 1e-4 of its pull at contact.
const FARTHEST_GAP: f64 = 1.0;
/// The nearest start, in film lengths: closer the free shell is no start.
const NEAREST_GAP: f64 = 3.0;
/// Least height of the plates that a branch is followed to, in `R0`.
const LOWEST: f64 = 0.05;
/// How much farther than the data a branch goes, relative to their travel.
const BEYOND: f64 = 0.01;

/// What a curve is compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// The membrane's law.
    pub law: LawName,
    /// Poles that deform: 2, or 1.
    pub contacts: u8,
    /// Stiffness by which the instrument made forces of deflections, N/m.
    pub nominal_spring_constant: f64,
    /// How much work a branch may be.
    pub effort: Effort,
}

/// The model's answer at every sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Force that the instrument would report, N.
    pub force: Vec<f64>,
    /// Height of the plate, `z0/R0`.
    pub height: Vec<f64>,
    /// Its derivatives by the coordinates of the keys, row by row.
    pub by_key: Vec<f64>,
    /// Which stable stretch each sample is on.
    pub stretch: Vec<usize>,
    /// How far its travel lies beyond an end of its stretch, m: negative before the beginning, 0 inside.
    pub beyond: Vec<f64>,
}

/// The groups that keys act through.
pub fn groups_of(keys: &[Key]) -> Vec<Group> {
    let mut wanted = [false; GROUPS];
    for key in keys {
        let groups: &[Group] = match key {
            Key::Chi => &[Group::Bending, Group::Pressure, Group::Adhesion, Group::SurfaceTension],
            Key::Bending => &[Group::Bending],
            Key::Adhesion => &[Group::Adhesion],
            Key::Film => &[Group::Film],
            Key::Radius => &[Group::Bending, Group::Pressure, Group::Film],
            Key::Pressure => &[Group::Pressure],
            Key::SurfaceTension => &[Group::SurfaceTension],
            Key::GasExponent => &[Group::GasExponent],
            Key::Poisson => &[Group::Poisson],
            Key::MooneyB => &[Group::MooneyB],
            Key::Contact | Key::Offset | Key::Tilt | Key::SpringConstant => &[],
        };
        for group in groups {
            wanted[*group as usize] = true;
        }
    }
    Group::ALL.into_iter().filter(|g| wanted[*g as usize]).collect()
}

impl Model {
    /// The branch that spans the heights of a curve, and how well its mesh resolves it.
    ///
    /// # Errors
    /// When the parameters are impossible or the branch ends before the data do.
    pub fn branch(
        &self,
        curve: &Curve,
        p: &Parameters,
        keys: &[Key],
    ) -> Result<(LeverBranch, Resolution), ModelError> {
        let range = (p[Key::Contact] - curve.farthest(), p[Key::Contact] - curve.nearest());
        self.branch_over(range, p, keys)
    }

    /// The same for somebody who may stop it.
    ///
    /// # Errors
    /// As [`Model::branch`], and when it is stopped.
    pub fn branch_attended(
        &self,
        curve: &Curve,
        p: &Parameters,
        keys: &[Key],
        attended: Attended<'_>,
    ) -> Result<(LeverBranch, Resolution), ModelError> {
        let range = (p[Key::Contact] - curve.farthest(), p[Key::Contact] - curve.nearest());
        self.traced(range, p, keys, &|| attended.is_stopped())
    }

    /// The branch over a range of travels, m.
    ///
    /// # Errors
    /// As [`Model::branch`].
    pub fn branch_over(
        &self,
        range: (f64, f64),
        p: &Parameters,
        keys: &[Key],
    ) -> Result<(LeverBranch, Resolution), ModelError> {
        self.traced(range, p, keys, &|| false)
    }

    fn traced(
        &self,
        (least, most): (f64, f64),
        p: &Parameters,
        keys: &[Key],
        stop: &dyn Fn() -> bool,
    ) -> Result<(LeverBranch, Resolution), ModelError> {
        let reach = f64::from(self.contacts) * p[Key::Radius];
        let needed = most + BEYOND * (most - least);
        let film = NEAREST_GAP * p[Key::Film] / p[Key::Radius];
        let gap = (-least / reach).max(film).clamp(1e-3, FARTHEST_GAP);
        let (scale, lever) = (p.force_scale(), p[Key::SpringConstant]);
        let travel = |z: f64, f: f64| reach * (1.0 - z) + scale * f / lever;
        let enough = |z: f64, f: f64| travel(z, f) >= needed;
        let span = Span { start: 1.0 + 1.05 * gap, end: LOWEST, enough: &enough, stop };
        let branch = trace(self.law, p, &span, self.effort, &groups_of(keys))?;
        if branch.nodes.len() < 4 || !branch.complete {
            let farthest = branch.nodes.iter().map(|n| travel(n.z, n.force));
            let reached = farthest.fold(f64::NEG_INFINITY, f64::max);
            return Err(match branch.too_dear {
                Some(most) => ModelError::TooDear { most, reached },
                None => ModelError::TooShort { reached, needed },
            });
        }
        let resolution = branch.resolution;
        Ok((LeverBranch::new(branch, p, self.contacts)?, resolution))
    }

    /// What would be read, on the stretches with the least misfit to the curve. `weight` is one over the
    /// noise.
    pub fn predict(
        &self,
        curve: &Curve,
        branch: &LeverBranch,
        p: &Parameters,
        keys: &[Key],
        weight: f64,
    ) -> Prediction {
        let farthest = curve.farthest();
        let gauge = self.nominal_spring_constant / p[Key::SpringConstant];
        let mut reading = Reading::default();
        let mut way = Vec::with_capacity(curve.len());
        for segment in &curve.segments {
            if branch.stretches.len() < 2 {
                way.resize(way.len() + segment.height.len(), 0);
                continue;
            }
            let misfit: Vec<Vec<f64>> = branch
                .stretches
                .iter()
                .map(|stretch| {
                    segment
                        .height
                        .iter()
                        .zip(&segment.force)
                        .map(|(height, force)| {
                            branch.read(stretch, p[Key::Contact] - height, &[], &mut reading);
                            let model = gauge * reading.force + baseline(p, farthest, *height);
                            // one outlier does not decide between stretches
                            (weight * (force - model)).powi(2).min(1e4)
                        })
                        .collect()
                })
                .collect();
            way.extend(assign(segment.direction, &misfit));
        }
        self.predict_on(curve, branch, p, keys, way)
    }

    /// What would be read if each sample were on the stretch that `way` says.
    pub fn predict_on(
        &self,
        curve: &Curve,
        branch: &LeverBranch,
        p: &Parameters,
        keys: &[Key],
        way: Vec<usize>,
    ) -> Prediction {
        let farthest = curve.farthest();
        let gauge = self.nominal_spring_constant / p[Key::SpringConstant];
        let mut out = Prediction::default();
        let mut reading = Reading::default();
        let heights = curve.segments.iter().flat_map(|segment| &segment.height);
        for (&at, &height) in way.iter().zip(heights) {
            let stretch = &branch.stretches[at];
            let travel = p[Key::Contact] - height;
            branch.read(stretch, travel, keys, &mut reading);
            out.force.push(gauge * reading.force + baseline(p, farthest, height));
            out.height.push(reading.height);
            out.beyond.push(travel - travel.clamp(stretch.from, stretch.to));
            for (key, by) in keys.iter().zip(&reading.by_key) {
                out.by_key.push(match key {
                    Key::Offset => 1.0,
                    Key::Tilt => farthest - height,
                    // a stiffer lever than thought: the same deflection is more force
                    Key::SpringConstant => gauge * (by - reading.force),
                    _ => gauge * by,
                });
            }
        }
        out.stretch = way;
        out
    }
}

/// What is read at a height where nothing touches, N.
fn baseline(p: &Parameters, farthest: f64, height: f64) -> f64 {
    p[Key::Offset] + p[Key::Tilt] * (farthest - height)
}

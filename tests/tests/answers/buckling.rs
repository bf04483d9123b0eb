//! Buckling of the uniformly shrunk sphere under external pressure (Zoelly).

use continuation::linalg::SymmetricBand;
use continuation::{
    EvalError, EventKind, Matrix, NewtonSettings, ParamId, Parameter, Problem, Settings, Stability,
    StopReason, Tracer, newton,
};
use shell_contact::Mesh;
use shell_contact::asymptotics::buckling_pressure;
use shell_contact::density::Coefficients;
use shell_contact::energy;
use shell_contact::film::FourTwo;
use shell_contact::membrane::Hooke;
use shell_contact::spline::HALF_BANDWIDTH;
use std::ops::ControlFlow;

/// A sphere without plates under an external pressure that follows it: energy `E + pV̂`.
struct Pressurised {
    mesh: Mesh,
    law: Hooke,
    coefficients: Coefficients,
    parameters: [Parameter; 1],
}

impl Pressurised {
    fn new(elements: usize, poisson: f64, bending: f64) -> Pressurised {
        Pressurised {
            mesh: Mesh::uniform(elements).unwrap(),
            law: Hooke { poisson },
            coefficients: Coefficients {
                bending,
                poisson,
                b: 0.0,
                surface_tension: 0.0,
                adhesion: 0.0,
                film: 0.1,
                plate: 5.0,
            },
            parameters: [Parameter::new("pressure", "chi/R0", 0.1)],
        }
    }
}

impl Problem for Pressurised {
    type Jacobian = SymmetricBand;
    fn dim(&self) -> usize {
        self.mesh.unknowns()
    }
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), HALF_BANDWIDTH)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.linearise(u, p, r, &mut self.new_jacobian())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        self.linearise(u, p, &mut vec![0.0; self.dim()], j)
    }
    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut SymmetricBand,
    ) -> Result<(), EvalError> {
        energy::volume_gradient(&self.mesh, u, r)?;
        r.iter_mut().for_each(|r| *r *= p[0]);
        j.set_zero();
        let c = &self.coefficients;
        energy::add_linearisation(&self.mesh, u, &self.law, &FourTwo, c, -p[0], r, j)
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        energy::volume_gradient(&self.mesh, u, out).map(|_| ())
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.mesh.mass().mul(x, y);
    }
    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }
}

/// Radius of the uniformly shrunk sphere, `p = 2τ/λ` with `τ = (1 − λ²)/(2(1 − ν))`.
fn shrunk(pressure: f64) -> f64 {
    let b = 0.5 * (1.0 - 0.3) * pressure;
    (1.0 + b * b).sqrt() - b
}

/// The state is the sphere shrunk exactly, as far as splines can: an equilibrium of the mesh is an
/// imperfect sphere, whose branch turns back before the transcritical point `l = 4`.
///
/// The first two even modes, `l = 4` and `l = 6`, at 1.0193 and 1.0544 times `4√k_b`.
#[test]
fn uniformly_shrunk_sphere_buckles_at_the_known_pressures() {
    let bending = 1e-3;
    let leading = buckling_pressure(bending);
    let ratios = [16, 32, 64, 128].map(|elements| {
        let problem = Pressurised::new(elements, 0.3, bending);
        let half = 0.5 * leading;
        let mut shape = vec![0.0; problem.dim()];
        newton(&problem, &mut shape, &[half], &NewtonSettings::default()).unwrap();
        let error = (0..=20).fold(0.0_f64, |worst, i| {
            let place = problem.mesh.place(&shape, f64::from(i) * 0.0785);
            worst.max((place.s[0].hypot(place.z[0]) - shrunk(half)).abs())
        });
        assert!(error < 2e-7, "uniform to discretisation error: {error:.1e}");
        let unstable = |ratio: f64| {
            let p = ratio * leading;
            let scale = (1.0 - shrunk(p)) / (1.0 - shrunk(half));
            let u: Vec<f64> = shape.iter().map(|x| scale * x).collect();
            let mut hessian = problem.new_jacobian();
            problem.jacobian(&u, &[p], &mut hessian).unwrap();
            let floor = f64::EPSILON * hessian.norm();
            hessian.factor(floor).inertia.unwrap().0
        };
        [0, 1].map(|modes| {
            let (mut low, mut high) = (0.9, 1.1);
            assert!(unstable(low) == 0 && unstable(high) >= 2);
            while high - low > 1e-11 {
                let middle = 0.5 * (low + high);
                if unstable(middle) > modes {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            low
        })
    });
    for (mode, known) in [(0, 1.0193), (1, 1.0544)] {
        let gaps = [0, 1, 2].map(|m| ratios[m][mode] - ratios[m + 1][mode]);
        let orders = [0, 1].map(|m| (gaps[m] / gaps[m + 1]).log2());
        println!("{known}: {:?}, orders {orders:.2?}", ratios.map(|r| r[mode]));
        assert!((ratios[3][mode] - known).abs() < 6e-5);
        assert!(orders[1] > 3.6, "{orders:?}");
    }
}

/// On a mesh the sphere is imperfect by `h⁴`; the transcritical point `l = 4` unfolds and the branch
/// turns back below it, nearer by the square root of that.
#[test]
fn imperfect_sphere_folds_below_the_transcritical_point() {
    let leading = buckling_pressure(1e-3);
    let gaps = [12, 24, 48].map(|elements| {
        let problem = Pressurised::new(elements, 0.3, 1e-3);
        let settings = Settings { target: Some(1.08 * leading), ..Settings::default() };
        let u = vec![0.0; problem.dim()];
        let branch =
            Tracer::new(&problem, "pressure", &u, &[0.0], settings).unwrap().run(&mut |at| {
                if at.events > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
        let fold = branch.events.first().expect("a fold");
        assert_eq!(fold.kind, EventKind::Fold);
        assert_eq!((fold.unstable_before, fold.unstable_after), (Some(0), Some(1)));
        1.019_324_04 - fold.p / leading
    });
    let orders = [0, 1].map(|k| (gaps[k] / gaps[k + 1]).log2());
    println!("{gaps:?}, orders {orders:.2?}");
    assert!(gaps[2] > 0.0 && gaps[2] < 1e-5 && orders[1] > 1.7, "{gaps:?} {orders:?}");
}

/// On finer meshes the branches pass each other nearer than a tracer can follow, by the square of the
/// elements' length: it stops and says how near, and does not take the other branch for its own. What is
/// nearer than rounding is a branch point.
#[test]
fn corners_too_sharp_to_follow() {
    let leading = buckling_pressure(1e-3);
    let trace = |elements| {
        let problem = Pressurised::new(elements, 0.3, 1e-3);
        let settings = Settings { target: Some(1.08 * leading), ..Settings::default() };
        let u = vec![0.0; problem.dim()];
        Tracer::new(&problem, "pressure", &u, &[0.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()))
    };
    let known = [1.019_324_04, 1.054_440_31];
    let gaps = [192, 384].map(|elements| {
        let branch = trace(elements);
        let stop = &branch.stopped;
        assert_eq!(stop.reason, StopReason::BranchesTooClose, "{elements}: {stop:?}");
        assert!(branch.events.is_empty(), "{elements}: {:?}", branch.events);
        let last = branch.points.last().unwrap();
        let off = (last.p / leading - known[0]).abs();
        assert!(off < 2e-5 && last.unstable == Some(0), "{elements}: {off} {:?}", last.unstable);
        let gap = stop.detail.split("distance of ").nth(1).unwrap().split(' ').next().unwrap();
        gap.parse::<f64>().unwrap()
    });
    println!("{gaps:?}");
    assert!((3.0..5.0).contains(&(gaps[0] / gaps[1])) && gaps[0] < 1e-6, "{gaps:?}");
    let branch = trace(600);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let found: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    assert_eq!(found.len(), 2);
    for (point, known) in found.iter().zip(known) {
        let off = (point.p / leading - known).abs();
        assert!(off < 5e-6, "{off}");
    }
    assert_eq!(branch.points.last().unwrap().unstable, Some(2));
}

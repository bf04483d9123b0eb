"""The engine with residuals in Python, against known answers."""

import pickle

import numpy as np
import pytest
from conftest import bratu

import arclen


def test_folds_of_the_cusp_are_exact(cusp):
    branch = cusp.trace("mu", [-1.5], {"mu": -2, "lambda": 1}, target=2)
    exact = 2 / (3 * np.sqrt(3))
    folds = branch.events.of("LP")
    assert [event.kind for event in branch.events] == ["fold", "fold"]
    assert np.allclose([fold.p for fold in folds], [exact, -exact], rtol=0, atol=1e-12)
    assert np.allclose([fold.u[0] for fold in folds], [-1 / np.sqrt(3), 1 / np.sqrt(3)], atol=1e-6)
    assert (branch["mu"][0], branch["mu"][-1]) == (-2.0, 2.0)
    assert branch.stopped_because == "target" and branch.is_complete and branch.is_certain
    assert abs(branch["mu"] + branch["x"] - branch["x"] ** 3).max() < 1e-9
    assert folds[0].unstable_before == 0 and folds[0].unstable_after == 1
    assert abs(abs(folds[0].modes[0][0]) - 1) < 1e-12
    # p − p₀ = ½ p″ s²: |p″| = 6 x at the fold
    assert abs(abs(folds[0].normal_form["curvature"]) - 6 / np.sqrt(3)) < 1e-6


def test_parameters_by_name_by_order_and_as_a_number(cusp, pitchfork):
    by_name = cusp.trace("mu", [-1.5], {"lambda": 1, "mu": -2}, 2)
    by_order = cusp.trace("mu", [-1.5], [-2, 1], 2)
    assert np.array_equal(by_name["mu"], by_order["mu"])
    assert by_name.parameters == {"mu": -2.0, "lambda": 1.0}
    assert by_name[3].parameters == {"mu": by_name["mu"][3], "lambda": 1.0}
    assert pitchfork.trace("p", 0.0, -1.0, 1).stopped_because == "target"


def test_a_cusp_lies_on_the_fold_curve(cusp):
    branch = cusp.trace("mu", [-1.5], [-2, 1], 2)
    curve = cusp.curve(branch.events.of("LP")[0], "lambda", domain=(-1, 2))
    mu, lam = curve["mu"], curve["lambda"]
    assert lam.max() == 2.0 and mu.min() < 0 < mu.max()
    assert abs(27 * mu**2 - 4 * lam**3).max() < 1e-9
    (event,) = curve.events.of("CP")
    assert event.kind == "cusp" and abs(event.p) < 1e-9 and abs(event["mu"]) < 1e-9
    assert event.u.shape == (1,) and curve.states.shape == (len(curve), 1)


def test_hopf_point_its_form_and_its_curve(brusselator):
    branch = brusselator.trace("B", [1, 1], {"A": 1, "B": 1}, target=3)
    (hopf,) = branch.events
    assert (hopf.label, hopf.kind, hopf.type) == ("H", "hopf", "supercritical")
    assert abs(hopf.p - 2) < 1e-12 and abs(hopf.normal_form["frequency"] - 1) < 1e-10
    mode = hopf.modes[0]
    jacobian = np.array([[1.0, 1.0], [-2.0, -1.0]])
    omega = (jacobian @ mode) / mode
    assert np.allclose(omega, omega[0]) and abs(abs(omega[0].imag) - 1) < 1e-6
    curve = brusselator.curve(hopf, "A", domain=(0.5, 2))
    assert (curve["A"].min(), curve["A"].max()) == (0.5, 2.0)
    assert abs(curve["B"] - 1 - curve["A"] ** 2).max() < 1e-9


def test_branches_that_leave_a_pitchfork(pitchfork):
    trunk = pitchfork.trace("p", [0], [-1], 1)
    (event,) = trunk.events
    assert (event.label, event.type, event.criticality) == ("BP", "pitchfork", "supercritical")
    assert abs(event.p) < 1e-12 and len(event.directions) == 1
    ends = [pitchfork.branch_off(event, forward=way, target=1)[-1].u[0] for way in (True, False)]
    assert sorted(np.round(ends, 12)) == [-1.0, 1.0]


def test_a_curve_of_branch_points():
    problem = arclen.Problem(lambda u, p: (p[0] - p[1] ** 2) * u - u**3, ["p", "q"])
    trunk = problem.trace("p", [0], [-1, 0.5], 1)
    curve = problem.curve(trunk.events.of("BP")[0], "q", domain=(-1, 1))
    assert (curve["q"].min(), curve["q"].max()) == (-1.0, 1.0)
    assert abs(curve["p"] - curve["q"] ** 2).max() < 1e-9


def test_a_diagram_has_all_branches():
    def f(u, p):
        x, y = u
        return [p[0] * x - x**3, (x * x - 0.5) * y - y**3]

    problem = arclen.Problem(f, ["p"])
    diagram = problem.diagram("p", [0, 0], [-1], target=1)
    assert len(diagram) == 7 and len(diagram.joints) == 3 and diagram.is_complete
    assert diagram.stopped_because == "complete"
    assert diagram[0].origin == {"kind": "start"}
    assert diagram[1].origin["kind"] == "switch" and diagram[1].origin["branch"] == 0


def test_deflation_finds_the_other_solutions(cusp):
    found = cusp.deflate([0, 1], known=[[1.0]])
    assert sorted(round(float(u[0]), 12) for u in found) == [-1.0, 0.0]
    assert found.report["exhausted"]


def test_a_disconnected_branch():
    problem = arclen.Problem(lambda u, p: p[0] * u - u**3 + 1e-3, ["p"])
    first = problem.trace("p", [0], [-1], domain=(-1, 1))
    assert not len(first.events)
    (near,) = problem.near_bifurcations(first)
    assert near["kind"] == "branch-point" and near["gap"] < 0.1
    u, p = problem.disconnected([first])[0]
    other = problem.both_ways("p", u, p, domain=(-1, 1))
    assert [event.label for event in other.events] == ["LP"] and other["p"][0] == 1.0
    assert len(problem.diagram("p", [0], [-1], domain=(-1, 1))) == 2


def test_both_ways_goes_from_end_to_end(cusp):
    branch = cusp.both_ways("mu", [0.1], [0, 1], domain=(-1, 1))
    assert (branch["mu"][0], branch["mu"][-1]) == (1.0, -1.0)
    assert branch.began_because == "domain" and (np.diff(branch["s"]) > 0).all()


def test_restart_from_points_events_and_ends(cusp):
    half = cusp.trace("mu", [-1.5], [-2, 1], 0)
    whole = cusp.trace("mu", [-1.5], [-2, 1], 2)
    rest = cusp.restart(half, target=2)
    assert rest["mu"][0] == 0.0 and rest["mu"][-1] == 2.0
    assert np.allclose([e.p for e in rest.events], [e.p for e in whole.events], atol=1e-12)
    after = cusp.restart(whole.events[0], target=2)
    assert [event.label for event in after.events] == ["LP"]
    assert cusp.restart(whole[2], target=2).stopped_because == "target"
    back = cusp.restart(whole[-1], increasing=False, target=-2)
    assert len(back.events) == 2


def test_watched_observables(cusp):
    branch = cusp.trace("mu", [-1.5], [-2, 1], 2, zeros=["x"], values=[-1.0])
    assert [event.label for event in branch.events] == ["UZ", "LP", "UZ", "LP"]
    (zero,) = branch.events.of("zero-x")
    assert abs(zero["x"]) < 1e-10
    assert branch.events[0].p == -1.0 and branch.events[0].kind == "target"
    stopped = cusp.trace("mu", [-1.5], [-2, 1], 2, stop_at={"x": 0.5})
    assert abs(stopped["x"][-1] - 0.5) < 1e-10 and stopped.stopped_because == "target"


@pytest.mark.parametrize("how", ["differences", "jac", "band", "band and jac"])
def test_bratu_in_every_storage(how):
    n = 50
    f, jac = bratu(n)
    options = {
        "differences": {},
        "jac": {"jac": jac, "parameter_derivative": lambda u, p: np.exp(u)},
        "band": {"sparsity": 1},
        "band and jac": {"sparsity": (1, 1), "jac": jac},
    }[how]
    problem = arclen.Problem(f, ["p"], **options, observe={"top": lambda u, p: u.max()})
    branch = problem.trace("p", np.zeros(n), [0.0], stop_at={"top": 6.0}, max_points=300)
    (fold,) = branch.events.of("LP")
    # of this discretisation, from an independent solution of f = 0, det = 0
    assert abs(fold.p - 3.5130556) < 1e-3
    assert fold.unstable_before == 0 and fold.unstable_after == 1
    reference = arclen.Problem(f, ["p"], jac=jac).trace("p", np.zeros(n), [0.0], 3.4)
    assert abs(fold.p - reference_fold(f, jac, fold.u, fold.p)) < 1e-10
    assert reference.events.of("LP") == []


def reference_fold(f, jac, u, p):
    """The fold near (u, p) by Newton's method for f = 0, f_u v = 0, |v| = 1."""
    n = u.size
    v = np.linalg.svd(jac(u, [p]))[2][-1]
    for _ in range(6):
        j, e = jac(u, [p]), np.exp(u)
        residual = np.concatenate([f(u, [p]), j @ v, [v @ v - 1]])
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        matrix[:n, :n] = j
        matrix[:n, 2 * n] = e
        matrix[n : 2 * n, :n] = np.diag(p * e * v)
        matrix[n : 2 * n, n : 2 * n] = j
        matrix[n : 2 * n, 2 * n] = e * v
        matrix[2 * n, n : 2 * n] = 2 * v
        step = np.linalg.solve(matrix, -residual)
        u, v, p = u + step[:n], v + step[n : 2 * n], p + step[2 * n]
    return p


def test_energy_and_mass():
    # u = 0 of ½ k u² with k = diag(1, 4) − p: unstable beyond 1; du/dt with a mass matrix
    problem = arclen.Problem(
        lambda u, p: (np.array([1.0, 4.0]) - p[0]) * u + u**3, ["p"], stability="energy"
    )
    branch = problem.trace("p", [0, 0], [0], 5)
    assert [round(event.p, 9) for event in branch.events] == [1.0, 4.0]
    assert branch["unstable"][0] == 0 and branch["unstable"][-1] == 2
    values, vectors, certified = problem.modes([0, 0], [0], 2)
    assert np.allclose(values, [1, 4]) and certified and len(values) == 2
    for mass in ([1.0, 2.0], np.diag([1.0, 2.0])):
        heavy = arclen.Problem(
            lambda u, p: (p[0] - np.array([1.0, 4.0])) * u, ["p"], mass=mass, stability="dynamics"
        )
        assert np.allclose(heavy.modes([0, 0], [0], 2)[0], [-1, -2])


def test_no_stability_counts_nothing():
    problem = arclen.Problem(lambda u, p: p[0] - u**2, ["p"], stability=None)
    branch = problem.trace("p", [1], [1], domain=(-1, 2), increasing=False)
    assert np.isnan(branch["unstable"]).all()
    assert branch.events.of("LP")[0].unstable_before is None


def test_check_and_solve(cusp):
    assert cusp.solve([1.2], [0, 1])[0] == pytest.approx(1, abs=1e-12)
    wrong = arclen.Problem(lambda u, p: u**2 - p, ["p"], jac=lambda u, p: np.diag(3 * u))
    assert wrong.check([1.0], [1.0])["jacobian"] > 0.1
    right = arclen.Problem(lambda u, p: u**2 - p, ["p"], jac=lambda u, p: np.diag(2 * u))
    assert right.check([1.0], [1.0])["jacobian"] < 1e-8
    assert set(right.check([1.0], [1.0])["parameters"]) == {"p"}


def test_eigenvalues_at_every_point(brusselator):
    branch = brusselator.trace("B", [1, 1], [1, 1], 3, eigenvalues=2)
    for point in branch:
        b = point.p
        exact = np.linalg.eigvals([[b - 1, 1], [-b, -1]])
        assert np.allclose(np.sort_complex(point.eigenvalues), np.sort_complex(exact), atol=1e-8)


def test_metric_weights_the_arclength():
    light = arclen.Problem(lambda u, p: u - p, ["p"], metric=[4.0])
    branch = light.trace("p", [0], [0], 1)
    assert branch["s"][-1] == pytest.approx(np.sqrt(5))


def bound(u, p):
    return p[0] - u**2


def test_problems_can_be_pickled():
    problem = pickle.loads(pickle.dumps(arclen.Problem(bound, ["p"])))
    assert problem.trace("p", [1], [1], 2).stopped_because == "target"

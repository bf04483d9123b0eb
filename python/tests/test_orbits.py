"""Periodic orbits of problems that are NumPy functions."""

import pickle

import numpy as np
import pytest

import arclen


def brusselator(u, p):
    x, y = u
    return [1 - (p[0] + 1) * x + x * x * y, p[0] * x - x * x * y]


def hopf_form(u, p):
    """Cycles of radius sqrt(mu), period 2 pi / omega, multiplier exp(-4 pi mu / omega)."""
    growth = p[0] - u[0] ** 2 - u[1] ** 2
    return [growth * u[0] - p[1] * u[1], p[1] * u[0] + growth * u[1]]


def orbits_of(omega, **settings):
    problem = arclen.Problem(hopf_form, parameters=["mu", "omega"])
    branch = problem.trace("mu", u0=[0, 0], p0=[-1, omega], target=1.5)
    (hopf,) = branch.events.of("H")
    return problem.orbits(hopf, target=1.5, **settings)


@pytest.mark.parametrize("omega", [0.3, 1.0, 7.0])
def test_cycles_of_the_normal_form_are_exact_in_every_respect(omega):
    orbits = orbits_of(omega)
    assert orbits.stopped_because == "target"
    mu = orbits["mu"]
    assert np.all(np.diff(mu) > 0)
    np.testing.assert_allclose(orbits["period"], 2 * np.pi / omega, rtol=1e-9)
    np.testing.assert_allclose(orbits["max_u[0]"], np.sqrt(mu), rtol=1e-6)
    np.testing.assert_allclose(orbits["min_u[1]"], -np.sqrt(mu), rtol=1e-6)
    for index in (0, len(orbits) // 2, -1):
        t, u = orbits.orbit(index)
        assert t[0] == 0 and t[-1] == orbits["period"][index] and np.all(np.diff(t) > 0)
        assert np.array_equal(u[0], u[-1])
        np.testing.assert_allclose(np.hypot(u[:, 0], u[:, 1]), np.sqrt(mu[index]), rtol=1e-6)
        logs, arguments, errors = orbits.multiplier_logs(index)
        exact = sorted([0.0, -4 * np.pi * mu[index] / omega], reverse=True)
        assert np.all(np.abs(logs - exact) <= errors)
        assert np.all(arguments == 0)
    assert np.all(orbits["unstable"][orbits["certified"] > 0] == 0)


def test_states_at_times_and_periodic_continuation():
    orbits = orbits_of(2.0)
    period = orbits["period"][-1]
    times = np.linspace(0, period, 7)
    t, u = orbits.orbit(-1, times)
    assert np.array_equal(t, times) and u.shape == (7, 2)
    _, later = orbits.orbit(-1, times + 3 * period)
    np.testing.assert_allclose(u, later, atol=1e-9)
    assert np.array_equal(orbits.states[-1], orbits.u(-1))
    with pytest.raises(ValueError, match="no time"):
        orbits.orbit(-1, [np.nan])


def test_settings_reach_the_discretisation_and_bad_ones_are_named():
    coarse = orbits_of(1.0, degree=3, intervals=10, max_intervals=10)
    assert coarse._orbits.point(0)["intervals"] == 10
    unchecked = orbits_of(1.0, check=False)
    assert unchecked.errors(0)["error"] is None and not np.any(unchecked["certified"])
    with pytest.raises(ValueError, match="degree"):
        orbits_of(1.0, degree=9)
    with pytest.raises((TypeError, ValueError), match="degrees"):
        orbits_of(1.0, degrees=4)


def test_special_points_lead_on_and_wrong_ones_are_refused():
    problem = arclen.Problem(brusselator, parameters=["B"])
    branch = problem.trace("B", u0=[1, 1], p0=[1], target=3)
    (hopf,) = branch.events.of("H")
    orbits = problem.orbits(hopf, target=3)
    assert abs(orbits["period"][-1] - 7.1569199) < 1e-6
    assert isinstance(orbits, arclen.Orbits) and "Orbits" in repr(orbits)
    assert orbits.origin["kind"] == "hopf"
    with pytest.raises(TypeError, match="no event"):
        problem.orbits(branch[0])
    fold = arclen.Problem(lambda u, p: [p[0] - u[0] ** 2], parameters=["p"])
    turned = fold.trace("p", u0=[1], p0=[1], max_points=40, domain=(-1, 2), increasing=False)
    (event,) = turned.events.of("LP")
    with pytest.raises(ValueError, match="fold"):
        fold.orbits(event)


def test_roessler_doubles_and_the_doubled_orbits_are_followed():
    def f(u, p):
        x, y, z = u
        return [-y - z, x + p[0] * y, 0.2 + z * (x - 5.7)]

    problem = arclen.Problem(f, parameters=["a"])
    z = 0.2 / 5.7
    branch = problem.trace("a", u0=[-0.1 * z, -z, z], p0=[-0.1], target=0.15)
    (hopf,) = branch.events.of("H")
    assert abs(hopf.p - 0.005978441849616576) < 1e-9
    single = problem.orbits(hopf, target=0.13)
    doubling = single.events.of("PD")[0]
    assert doubling.type == "supercritical"
    assert single.event_errors[doubling.number] < 1e-6
    double = problem.orbits(doubling, target=0.13)
    assert abs(double["period"][0] / (2 * single["period"][doubling.index]) - 1) < 0.01
    first = np.flatnonzero(double["certified"] > 0)[0]
    assert double["unstable"][first] == 0


def test_orbits_are_pickled_whole_and_damage_is_refused():
    orbits = orbits_of(1.0)
    again = pickle.loads(pickle.dumps(orbits))
    assert type(again) is arclen.Orbits and again == orbits
    assert np.array_equal(again.orbit(3)[1], orbits.orbit(3)[1])
    data = orbits._orbits.to_bytes()
    rng = np.random.default_rng(5)
    for _ in range(200):
        bad = bytearray(data)
        for at in rng.integers(0, len(bad), 3):
            bad[at] ^= int(rng.integers(1, 256))
        try:
            arclen._arclen.RawOrbits.from_bytes(bytes(bad)).orbit(0)
        except (ValueError, IndexError):
            pass


def test_an_exception_in_f_arrives_unchanged_and_an_observer_stops():
    calls = 0
    bound = np.inf  # a trace and its differences also look beyond its end

    def f(u, p):
        if p[0] > bound:
            raise RuntimeError("beyond")
        return brusselator(u, p)

    problem = arclen.Problem(f, parameters=["B"])
    branch = problem.trace("B", u0=[1, 1], p0=[1], target=2.2)
    (hopf,) = branch.events.of("H")
    bound = 2.3
    with pytest.raises(RuntimeError, match="beyond"):
        problem.orbits(hopf, target=3)
    bound = np.inf

    def progress(points, events, p, s):
        nonlocal calls
        calls += 1
        return points >= 3

    few = problem.orbits(hopf, target=2.2, progress=progress)
    assert few.stopped_because == "interrupted" and len(few) == 3 and calls == 3


def test_pictures():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    orbits = orbits_of(1.0)
    assert len(orbits.plot().lines) >= 2
    assert orbits.plot_orbit(-1, x=0, y=1) is not None

"""Calls that make no sense: an exception that says so, and the interpreter lives."""

import random
import warnings

import numpy as np
import pytest

import arclen

ORDINARY = (TypeError, ValueError, IndexError, KeyError, MemoryError, OverflowError)

WRONG = [
    (dict(parameters=[]), ValueError, "at least one"),
    (dict(parameters=["p", "p"]), ValueError, "twice"),
    (dict(parameters=["s"]), ValueError, "a column's"),
    (dict(parameters=[1]), TypeError, "not a name"),
    (dict(parameters=3), TypeError, "list of names"),
    (dict(f=3), TypeError, "cannot be called"),
    (dict(jac=3), TypeError, "cannot be called"),
    (dict(parameter_derivative=3), TypeError, "cannot be called"),
    (dict(stability="Energy"), ValueError, "dynamics"),
    (dict(observe=[1]), TypeError, "dictionary"),
    (dict(observe={"p": abs}), ValueError, "twice"),
    (dict(observe={"x": 1}), TypeError, "cannot be called"),
    (dict(scales={"q": 1}), ValueError, "no parameter 'q'"),
    (dict(scales={"p": 0}), ValueError, "positive"),
    (dict(metric=[-1.0]), ValueError, "negative"),
    (dict(metric=[1.0, 1.0]), ValueError, "2 weights for 1"),
    (dict(mass=np.eye(2)), ValueError, "shape"),
    (dict(mass="heavy"), (TypeError, ValueError), "mass"),
    (dict(sparsity=-1), ValueError, "negative"),
    (dict(sparsity="dense"), TypeError, "sparsity"),
    (dict(sparsity=np.eye(3)), ValueError, "shape"),
]


@pytest.mark.parametrize("options, error, message", WRONG)
def test_problems(options, error, message):
    f = options.pop("f", lambda u, p: u - p)
    options.setdefault("parameters", ["p"])
    with pytest.raises(error, match=message):
        arclen.Problem(f, **options).trace("p", [0], [0], 1)


TRACES = [
    (("q", [0], [0], 1), {}, ValueError, "no parameter 'q'"),
    ((1, [0], [0], 1), {}, TypeError, "not a name"),
    (("p", [], [0], 1), {}, ValueError, "at least one unknown"),
    (("p", [[0.0]], [0], 1), {}, ValueError, "one dimension"),
    (("p", ["a"], [0], 1), {}, TypeError, "u0"),
    (("p", [np.nan], [0], 1), {}, ValueError, "finite"),
    (("p", [0], [0, 1], 1), {}, ValueError, "p0: 2 numbers"),
    (("p", [0], {"q": 1}, 1), {}, ValueError, "no p0: parameter 'q'"),
    (("p", [0], {}, 1), {}, ValueError, "no value of 'p'"),
    (("p", [0], [0], np.nan), {}, ValueError, "NaN"),
    (("p", [0], [0], "up"), {}, TypeError, "not a number"),
    (("p", [0], [0], np.inf), {}, ValueError, "finite"),
    (("p", [0], [0]), dict(max_point=3), TypeError, "did you mean 'max_points'"),
    (("p", [0], [0]), dict(max_points=-3), ValueError, "negative"),
    (("p", [0], [0]), dict(max_points=1), ValueError, "at least 2"),
    (("p", [0], [0]), dict(max_points=2.5), TypeError, "integer"),
    (("p", [0], [0]), dict(max_step=0), ValueError, "positive"),
    (("p", [0], [0]), dict(domain=(1, 2)), ValueError, "start"),
    (("p", [0], [0]), dict(domain=3), TypeError, "pair"),
    (("p", [0], [0]), dict(increasing=1), TypeError, "True or False"),
    (("p", [0], [0]), dict(counting="all"), ValueError, "no counting 'all'"),
    (("p", [0], [0]), dict(zeros=["x"]), ValueError, "no observable 'x'"),
    (("p", [0], [0]), dict(stop_at=3), TypeError, "dictionary"),
    (("p", [0], [0]), dict(progress=3), TypeError, "progress"),
]


@pytest.mark.parametrize("arguments, options, error, message", TRACES)
def test_traces(arguments, options, error, message):
    problem = arclen.Problem(lambda u, p: u - p, ["p"])
    with pytest.raises(error, match=message):
        problem.trace(*arguments, **options)


def test_events_of_the_wrong_kind(cusp, pitchfork):
    branch = cusp.trace("mu", [-1.5], [-2, 1], 2)
    fold = branch.events[0]
    with pytest.raises(arclen.ArclenError, match="no branches that leave"):
        cusp.branch_off(fold, target=1)
    with pytest.raises(ValueError, match="the parameters mu, lambda"):
        pitchfork.restart(fold, target=1)
    with pytest.raises(arclen.ArclenError, match="another one besides"):
        cusp.curve(fold, "mu", domain=(-1, 1))
    with pytest.raises(TypeError):
        cusp.curve(branch, "lambda")
    trunk = pitchfork.trace("p", [0], [-1], 1)
    with pytest.raises(arclen.ArclenError, match="direction 5"):
        pitchfork.branch_off(trunk.events[0], direction=5)
    curve = cusp.curve(fold, "lambda", domain=(0.5, 2))
    with pytest.raises(ValueError, match="the parameters lambda"):
        cusp.restart(curve)


def test_a_dense_jacobian_that_does_not_fit_into_memory():
    problem = arclen.Problem(lambda u, p: u - p, ["p"])
    with pytest.raises(MemoryError, match="sparsity"):
        problem.trace("p", np.zeros(10**6), [0], 1)


def test_a_branch_of_another_number_of_unknowns(pitchfork):
    two = arclen.Problem(lambda u, p: u - p, ["p"]).trace("p", [0, 0], [0], 1)
    one = arclen.Problem(lambda u, p: u[:1] - p, ["p"])
    with pytest.raises(ValueError, match="shape|length"):
        one.restart(two, target=3)


VALUES = [
    None, True, 0, 1, -1, 2, 10**30, 0.0, 1.0, -1.5, 1e308, np.nan, np.inf, "p", "", "x", b"p", [],
    [0], [0.0, 1.0], [np.nan], ["a"], [[0.0]], (), (0, 1), (1, 0), {}, {"p": 0}, {"p": "a"},
    {"q": 1}, np.zeros(1), np.zeros(2), np.zeros((1, 1)), np.zeros(0), np.array(0.5), np.eye(2),
    np.zeros(1, np.float32), np.zeros(1, complex), np.array(["a"]), np.array([None]), np.int64(3),
    np.float64(0.5), object(), set(), lambda u, p: u - p, lambda u, p: None, lambda *a: 1 / 0, len,
    range(2), slice(1), Ellipsis,
]  # fmt: skip
SETTINGS = [
    "target", "domain", "increasing", "max_step", "min_step", "first_step", "max_points",
    "tolerance", "max_iterations", "max_angle", "eigenvalues", "counting", "event_tolerance",
    "zeros", "extrema", "stop_at", "values", "progress", "nothing",
]  # fmt: skip
OPTIONS = [
    "jac", "parameter_derivative", "sparsity", "mass", "stability", "observe", "scales", "units",
    "metric",
]  # fmt: skip


def test_ten_thousand_random_calls():
    rng = random.Random(20_261)
    good = arclen.Problem(lambda u, p: p[0] * u - u**3, ["p"], observe={"x": lambda u, p: u[0]})
    branch = good.trace("p", [0], [-1], 1)
    event, point = branch.events[0], branch[2]
    values = [*VALUES, branch, event, point]
    refused = {}

    def some(*usual):
        """A value that is right, or any other."""
        return rng.choice(usual) if usual and rng.random() < 0.6 else rng.choice(values)

    def options(names, most):
        return {name: rng.choice(values) for name in rng.sample(names, rng.randint(0, most))}

    def bounded(names=SETTINGS):
        return {"max_points": 5, **options(names, 2)}

    def problem():
        made = arclen.Problem(
            some(lambda u, p: u - p), some(["p"], ["p", "q"]), **options(OPTIONS, 2)
        )
        return made.trace(some("p"), some([0.0]), some([0.0], [0.0, 1.0]), **bounded())

    calls = [
        problem,
        lambda: good.trace(some("p"), some([0.0]), some([-1.0]), **bounded()),
        lambda: good.both_ways(some("p"), some([0.0]), some([-1.0]), **bounded()),
        lambda: good.diagram(
            some("p"), some([0.0]), some([-1.0]), depth=some(1), max_branches=some(2),
            **{"domain": (-2, 1), **bounded()},
        ),
        lambda: good.restart(some(branch, event, point), **bounded()),
        lambda: good.branch_off(some(event), some(0), some(True), **bounded()),
        lambda: good.curve(some(event), some("p"), **bounded()),
        lambda: good.solve(some([1.0]), some([1.0])),
        lambda: good.modes(some([1.0]), some([1.0]), some(1)),
        lambda: good.check(some([1.0]), some([1.0]), some(1.0)),
        lambda: good.deflate(
            some([1.0]), known=some([[0.0]]), branches=some([branch]), starts=some([[0.5]]),
            max_attempts=20, max_solutions=3,
        ),
        lambda: good.near_bifurcations(some(branch)),
        lambda: branch[some("p", 0)],
        lambda: branch.u(some(0)),
        lambda: pickle_of_noise(rng, branch),
    ]  # fmt: skip
    done = 0
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for _ in range(10_000):
            try:
                rng.choice(calls)()
                done += 1
            except (*ORDINARY, ZeroDivisionError, AttributeError) as error:
                assert str(error) or isinstance(error, KeyError)
                refused[type(error).__name__] = refused.get(type(error).__name__, 0) + 1
    # some calls make sense; most do not
    assert done > 500 and sum(refused.values()) > 5_000
    assert good.trace("p", [0], [-1], 1) == branch


def pickle_of_noise(rng, branch):
    """A branch from bytes of which some are others."""
    content = bytearray(branch._raw.to_bytes())
    for _ in range(rng.randint(1, 8)):
        content[rng.randrange(len(content))] = rng.randrange(256)
    raw = type(branch._raw).from_bytes(bytes(content))
    other = arclen.Branch(raw, ["p"], branch.dim)
    repr(other), other.events, other._repr_html_()

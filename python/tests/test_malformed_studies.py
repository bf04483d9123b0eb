"""Calls of studies, fits and figures that make no sense: an exception, and the interpreter lives."""

import random
import warnings

import numpy as np

import arclen

ORDINARY = (TypeError, ValueError, IndexError, KeyError, AttributeError, OverflowError, OSError)

VALUES = [
    None, True, 0, 1, -1, 10**30, 1.5, 1e308, np.nan, np.inf, "", "x", "bratu", "fig12", "\0", "é\n", b"b",
    [], [0.0], ["a"], (), {}, {"problem": "contact"}, {"path": {"end": 0.9}}, {1: 2}, {"a": {"b": {}}},
    np.zeros(2), np.array(["a"]), object(), set(), len, Ellipsis, "hooke", "8 um", "1 N/m", "radius=1:1",
]  # fmt: skip
KEYS = [
    "elements", "end", "start", "adhesion", "law", "film", "scan", "max_n", "max_points", "depth", "progress",
    "path__end", "path", "mesh.elements", "nothing", "name", "problem", "", "a.b.c", "spring_constant",
]  # fmt: skip
COLUMNS = ["segment", "height", "force", "weight"]


def test_ten_thousand_random_calls(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    rng = random.Random(20_262)
    short = {"elements": 8, "max_points": 3, "scan": "axisymmetric"}
    branch = arclen.trace("fig12", **short)
    bratu = arclen.trace("bratu", elements=10)
    event = bratu.events[0]
    values = [*VALUES, branch, bratu, event, branch[0], branch.case]

    def some(*usual):
        return rng.choice(usual) if usual and rng.random() < 0.6 else rng.choice(values)

    def keys(most=2):
        return {name: rng.choice(values) for name in rng.sample(KEYS, rng.randint(0, most))}

    def case():
        return some("bratu", bratu.case, {"problem": "bratu", "mesh": {"elements": 8}})

    def curve():
        return {name: some([0.0, 1.0]) for name in rng.sample(COLUMNS, rng.randint(0, 4))}

    # few points where a case happens to be right
    calls = [
        lambda: arclen.Case(some("fig12", "bratu"), **keys(3)),
        lambda: arclen.trace(case(), **{"max_points": 3, **keys()}),
        lambda: arclen.diagram(case(), **{"max_points": 3, "depth": 0, **keys()}),
        lambda: arclen.cycle(case(), **{"max_points": 3, **keys()}),
        lambda: arclen.map(case(), some("lambda", "film"), **{"max_points": 3, **keys()}),
        lambda: arclen.fit(some(curve(), "curve.csv"), some({"instrument": keys()}), **keys()),
        lambda: arclen.fit(curve(), law=some("hooke"), fix=some(["radius"]), prior=some({})),
        lambda: arclen.fit([some("curve.csv")], segments=some("both"), range=some("1 um:2 um")),
        lambda: arclen.plan(some("bratu", "polymer"), some({}), fix=some(()), **keys()),
        lambda: arclen.figure(some(), **{"elements": 8, **keys()}),
        lambda: arclen.study(some("missing.toml"), out=some("out"), shard=some(None, "1/2")),
        lambda: bratu.case.sweep(some({some("elements"): some([8])}), out=some("out")),
        lambda: arclen.main(some(["check", "fig12"], [some("check"), some("fig12")])),
        lambda: branch[some("force", 0)],
        lambda: bratu.shape(some(event)),
        lambda: bratu.meridian(some(event)),
        lambda: bratu.case._raw.meridian(some([0.0]), some(1.0)),
        lambda: branch.case._raw.meridian([rng.choice([0.0, 1e300, np.nan])] * 34, some(1.0)),
        lambda: arclen.CaseBranch.load(some("out")),
    ]
    done, refused = 0, 0
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for _ in range(10_000):
            try:
                rng.choice(calls)()
                done += 1
            except ORDINARY as error:
                assert str(error) or isinstance(error, KeyError)
                refused += 1
    assert done > 300 and refused > 5_000
    assert arclen.trace("fig12", **short) == branch

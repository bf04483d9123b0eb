"""Numerical continuation and bifurcation of equilibria ``f(u, p) = 0``.

A problem of one's own is a residual; `Problem.trace` follows its solutions along a parameter and locates the special
points on the way: folds, branch points, Hopf points.

>>> import numpy as np, arclen
>>> def f(u, p):                       # the Brusselator, du/dt = f
...     x, y = u
...     b = p[0]
...     return [1 - (b + 1) * x + x * x * y, b * x - x * x * y]
>>> problem = arclen.Problem(f, parameters=["B"], stability="dynamics")
>>> branch = problem.trace("B", u0=[1, 1], p0=[1], target=3)
>>> [(event.label, round(event.p, 9)) for event in branch.events]
[('H', 2.0)]
>>> branch[0].p, branch[-1].p, branch.stopped_because
(1.0, 3.0, 'target')

Cases of shells between plates, and a catalogue of classical problems, are there already: `trace`,
`diagram`, `cycle` and `map` compute what the program ``arclen`` does, number by number.

>>> bratu = arclen.trace("bratu")
>>> bratu.parameter, [event.label for event in bratu.events.of("fold")]
('lambda', ['LP'])
"""

from ._arclen import EngineError as ArclenError
from ._arclen import __version__
from ._branch import Branch, Diagram, Event, Point, Solutions
from ._case import Case, cases
from ._command import main
from ._definition import InterruptedWarning
from ._figures import Figures, figure
from ._fit import Estimate, Fit, Plan, fit, plan
from ._orbits import Orbits
from ._problem import Problem
from ._study import CaseBranch, Cycle, Map, cycle, diagram, map, trace
from ._sweep import Study, study

__all__ = [
    "ArclenError",
    "Branch",
    "Case",
    "CaseBranch",
    "Cycle",
    "Diagram",
    "Estimate",
    "Event",
    "Figures",
    "Fit",
    "InterruptedWarning",
    "Map",
    "Orbits",
    "Plan",
    "Point",
    "Problem",
    "Solutions",
    "Study",
    "__version__",
    "cases",
    "cycle",
    "diagram",
    "figure",
    "fit",
    "main",
    "map",
    "plan",
    "study",
    "trace",
]

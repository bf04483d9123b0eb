"""Branches of periodic orbits."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arclen
from . import _convert as convert
from ._arclen import RawOrbits
from ._branch import Branch, Event

if TYPE_CHECKING:
    from ._problem import Problem

_CYCLES = (
    "degree",
    "intervals",
    "max_intervals",
    "accuracy",
    "adapt_every",
    "period_growth",
    "check",
)


class Orbits(Branch):
    """A branch of periodic orbits of ``M du/dt = f(u, p)``.

    It is a `Branch` whose columns are ``period`` and ``max_x``, ``min_x``, ``mean_x`` of every observable
    ``x`` of the problem, or of its unknowns ``u[0]``, ``u[1]``, ... where it has none; ``unstable`` counts
    the Floquet multipliers outside the unit circle. ``u(index)`` is the state at time 0. Its special points
    are ``"fold"`` (a limit point of cycles), ``"period-doubling"``, ``"neimark-sacker"`` and
    ``"branch-point"``; ``Event.type`` of a period doubling is ``"supercritical"`` or ``"subcritical"``
    where that is known.

    Attributes
    ----------
    event_errors : list of float or None
        Estimated error of the parameter at each special point, the discretisation included; None where it
        is not known.
    """

    def __init__(
        self, raw: RawOrbits, names: Sequence[str], dim: int, origin: Any = None
    ) -> None:
        super().__init__(raw.branch, names, dim, origin)
        self._orbits = raw

    @property
    def event_errors(self) -> list[float | None]:
        return self._orbits.event_errors

    @property
    def states(self) -> np.ndarray:
        """The states at time 0 of all orbits, an array of shape (points, n)."""
        return np.array([self.u(index) for index in range(len(self))]).reshape(-1, self.dim)

    def orbit(self, index: int, t: Any = None) -> tuple[np.ndarray, np.ndarray]:
        """One orbit over time.

        Parameters
        ----------
        index : int
            Its point on the branch; ``-1`` is the last one.
        t : array, optional
            Times; by default the nodes of the mesh, from 0 to the period. The orbit is continued
            periodically.

        Returns
        -------
        t : ndarray, shape (m,)
        u : ndarray, shape (m, n)
        """
        index = self._index(index)
        if t is None:
            return self._orbits.orbit(index)
        times = np.atleast_1d(np.asarray(t, dtype=float))
        return times, self._orbits.at(index, times.tolist())

    def multipliers(self, index: int) -> np.ndarray:
        """The Floquet multipliers of an orbit, the largest first, the trivial one among them.

        Those too large or too small for a number are infinite or zero: `multiplier_logs` has them.
        """
        record = self._orbits.point(self._index(index))
        return np.array([complex(re, im) for re, im, *_ in record["multipliers"]], dtype=complex)

    def multiplier_logs(self, index: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the multipliers: logarithms of the moduli, arguments, estimated errors of the logarithms.

        An error that is not known is NaN.
        """
        record = self._orbits.point(self._index(index))
        rows = [
            (log, argument, np.nan if error is None else error)
            for _, _, log, argument, error in record["multipliers"]
        ]
        columns = np.array(rows, dtype=float).reshape(-1, 3).T
        return columns[0], columns[1], columns[2]

    def errors(self, index: int) -> dict[str, float | None]:
        """Estimated errors at a point; None where they are not known.

        ``error`` and ``period_error`` are relative, of states and period; ``parameter_error`` is that of
        the parameter; ``trivial_error`` is how far the trivial multiplier is from 1.
        """
        record = self._orbits.point(self._index(index))
        names = ("error", "period_error", "parameter_error", "trivial_error")
        return {name: record[name] for name in names}

    def plot_orbit(
        self, index: int = -1, ax: Any = None, x: int | str = "t", y: int = 0, **style: Any
    ) -> Any:
        """Draws one orbit: unknown `y` over time, or over unknown `x`. Needs matplotlib."""
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.gca()
        t, u = self.orbit(index)
        across = t if isinstance(x, str) else u[:, x]
        unstable = self["unstable"][index]
        ax.plot(across, u[:, y], **{"linestyle": "--" if unstable > 0 else "-", **style})
        ax.set_xlabel("t" if isinstance(x, str) else f"u[{x}]")
        ax.set_ylabel(f"u[{y}]")
        return ax

    def plot(self, ax: Any = None, x: str | None = None, y: str | None = None, **style: Any) -> Any:
        """Draws maximum and minimum over the parameter; see `Branch.plot`. With `y` that column."""
        if y is not None:
            return super().plot(ax, x, y, **style)
        first = self.observables[1].removeprefix("max_")
        ax = super().plot(ax, x, f"max_{first}", **style)
        style.setdefault("color", ax.lines[0].get_color())
        return super().plot(ax, x, f"min_{first}", **style)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Not for orbits: pickle them."""
        raise TypeError("orbits are kept by pickle: pickle.dump(orbits, file)")

    def __reduce__(self) -> Any:
        return (Orbits, (self._orbits, self._names, self.dim, self.origin))

    def __repr__(self) -> str:
        labels = ", ".join(event.label for event in self.events) or "no events"
        return (
            f"<Orbits in {self.parameter}: {len(self)} points, {labels}, "
            f"stopped: {self.stopped_because}>"
        )


def follow(problem: Problem, event: Any, settings: dict[str, Any]) -> Orbits:
    """See `Problem.orbits`."""
    if not isinstance(event, Event):
        raise TypeError(f"orbits: {event!r} is no event of a branch")
    branch = event.branch
    problem._own(branch)
    settings = dict(settings)
    direction = convert.index(settings.pop("direction", 0), "direction")
    if direction < 0:
        raise ValueError(f"direction is {direction}; it must not be negative")
    forward = settings.pop("forward", True)
    if not isinstance(forward, (bool, np.bool_)):
        raise TypeError(f"forward: {forward!r} is not True or False")
    cycles = {name: settings.pop(name) for name in _CYCLES if name in settings}
    cycles = {name: _plain(value) for name, value in cycles.items()}
    run = problem._traced(settings, "orbits", ["period"])
    orbits = branch._orbits if isinstance(branch, Orbits) else None
    equilibria = None if orbits is not None else branch._raw
    way = (direction, bool(forward))
    number = event.number
    n = branch.dim
    values = event.parameters
    p = np.array([values.get(name, 0.0) for name in problem.parameters])

    def dress(raw: RawOrbits) -> Orbits:
        origin = {"kind": event.kind, "event": number, "parameter": event.p}
        return Orbits(raw, problem.parameters, n, origin)

    def call(engine: Any) -> Any:
        return _arclen.follow_orbits(engine, equilibria, orbits, number, way, cycles, *run)

    return problem._compute(event.u[:n], p, call, dress)


def _plain(value: Any) -> Any:
    """A NumPy scalar as a plain number."""
    return value.item() if isinstance(value, np.generic) else value

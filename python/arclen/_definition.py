"""What a problem is made of: its functions and parameters, checked; one compiled engine for each number of unknowns."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _arclen
from . import _convert as convert
from ._branch import Branch, Diagram, Point

#: Unknowns up to which all eigenvalues are computed at every point without being asked for.
_FULL_SPECTRUM = 120


class InterruptedWarning(UserWarning):
    """Ctrl-C ended a computation, and what was computed is what it returned."""


class Definition:
    """The functions and parameters of a problem; `Problem` computes with it."""

    def __init__(
        self,
        f: Callable[..., Any],
        parameters: Sequence[str],
        jac: Callable[..., Any] | None = None,
        parameter_derivative: Callable[..., Any] | None = None,
        sparsity: Any = None,
        mass: Any = None,
        stability: str | None = "auto",
        observe: Mapping[str, Callable[..., float]] | None = None,
        *,
        scales: Mapping[str, float] | None = None,
        units: Mapping[str, str] | None = None,
        metric: Any = None,
    ) -> None:
        if not callable(f):
            raise TypeError(f"f: {f!r} cannot be called")
        if jac is not None and not callable(jac):
            raise TypeError(f"jac: {jac!r} cannot be called")
        if isinstance(parameters, str):
            parameters = [parameters]
        self.parameters: list[str] = convert.names(parameters, "parameters")
        if not self.parameters:
            raise ValueError("parameters: a problem needs at least one")
        self.f = f
        self.jac = jac
        self.parameter_derivative = parameter_derivative
        if parameter_derivative is not None:
            convert.derivative(parameter_derivative, self.parameters)
        self.sparsity = sparsity
        self.mass = mass
        if stability not in ("auto", "dynamics", "energy", None):
            raise ValueError(f'stability={stability!r}: it is "dynamics", "energy" or None')
        self.stability = stability
        if observe is not None and not isinstance(observe, Mapping):
            raise TypeError(f"observe: {observe!r} is not a dictionary {{name: function}}")
        self.observe = dict(observe or {})
        for name, function in self.observe.items():
            if not callable(function):
                raise TypeError(f"observe[{name!r}]: {function!r} cannot be called")
        convert.names([*self.parameters, *self.observe], "parameters and observables")
        self.scales = {}
        for name, scale in (scales or {}).items():
            convert.one_of(name, self.parameters, "parameter")
            self.scales[name] = convert.finite(scale, f"scales[{name!r}]")
            if self.scales[name] <= 0:
                raise ValueError(f"scales[{name!r}] is {scale}; it must be positive")
        self.units = {}
        for name, unit in (units or {}).items():
            convert.one_of(name, self.parameters, "parameter")
            self.units[name] = str(unit)
        self.metric = None if metric is None else convert.vector(metric, "metric")
        if self.metric is not None and (self.metric < 0).any():
            raise ValueError("metric: weights must not be negative")
        self._begin()

    def _begin(self) -> None:
        self._lock = threading.Lock()
        self._engines: dict[int, Any] = {}
        self._patterns: dict[int, convert.Pattern] = {}
        self.partial: Branch | Diagram | None = None
        """What was computed before an exception ended the last computation."""

    def __getstate__(self) -> dict[str, Any]:
        hidden = ("_lock", "_engines", "_patterns", "partial")
        return {key: value for key, value in self.__dict__.items() if key not in hidden}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._begin()

    def __repr__(self) -> str:
        name = getattr(self.f, "__name__", type(self.f).__name__)
        return f"<Problem {name}(u, p) = 0, p = ({', '.join(self.parameters)})>"

    def _start(self, parameter: Any, u0: Any, p0: Any) -> tuple[np.ndarray, np.ndarray, str]:
        which = convert.one_of(parameter, self.parameters, "parameter")
        return convert.vector(u0, "u0"), convert.named(p0, self.parameters, "p0"), which

    def _traced(
        self,
        settings: dict[str, Any],
        where: str,
        observables: list[str] | None = None,
        **more: Any,
    ) -> tuple[dict[str, Any], list[Any], Any]:
        """Settings, watches and the observer of a trace."""
        settings = {**settings, **more}
        watched = convert.watches(
            list(self.observe) if observables is None else observables,
            settings.pop("zeros", ()),
            settings.pop("extrema", ()),
            settings.pop("stop_at", {}),
            settings.pop("values", ()),
        )
        progress = convert.progress(settings.pop("progress", None))
        return convert.settings(settings, convert.SETTINGS, where), watched, progress

    def _place(self, point: Point) -> tuple[np.ndarray, np.ndarray]:
        """State and parameters of a point."""
        values = point.parameters
        return point.u, np.array([values.get(name, 0.0) for name in self.parameters])

    def _own(self, branch: Branch) -> None:
        """Refuses curves of special points, and branches of problems with other parameters."""
        if branch._names != self.parameters:
            names = ", ".join(branch._names)
            raise ValueError(
                f"the branch is in a problem with the parameters {names}; this one has "
                f"{', '.join(self.parameters)}"
            )

    def _engine(self, u: np.ndarray, p: np.ndarray) -> Any:
        """The compiled problem for so many unknowns."""
        n = u.size
        if n == 0:
            raise ValueError("u0: a problem needs at least one unknown")
        with self._lock:
            if n in self._engines:
                return self._engines[n]
        pattern = self._pattern(u, p)
        mass = convert.mass(self.mass, n)
        if self.metric is not None and self.metric.size != n:
            raise ValueError(f"metric: {self.metric.size} weights for {n} unknowns")
        if mass is not None and pattern is not None:
            pattern = convert.union(pattern, mass[0], mass[1])
        pattern = convert.narrow(pattern, n)
        stability = self.stability
        if stability == "auto":
            stability = "dynamics" if n <= _FULL_SPECTRUM else None
        names = self.parameters
        slope = self.parameter_derivative
        engine = _arclen.make_engine(
            n,
            self.f,
            None if self.jac is None else convert.jacobian(self.jac, n),
            None if slope is None else convert.derivative(slope, names),
            [(name, self.units.get(name, ""), self.scales.get(name, 1.0)) for name in names],
            list(self.observe.items()),
            stability,
            pattern,
            mass,
            None if self.metric is None else self.metric.tolist(),
        )
        with self._lock:
            return self._engines.setdefault(n, engine)

    def _pattern(self, u: np.ndarray, p: np.ndarray) -> convert.Pattern:
        n = u.size
        with self._lock:
            if n in self._patterns:
                return self._patterns[n]
        if self.sparsity is not None:
            pattern = convert.pattern(self.sparsity, n)
        elif self.jac is None:
            pattern = None
        else:
            # what it returns decides how it is stored
            first = self.jac(_read_only(u), _read_only(p))
            if convert.is_sparse(first):
                convert.matrix(first, n)
                coo = first.tocoo()
                pattern = (np.asarray(coo.row, np.int64), np.asarray(coo.col, np.int64))
            else:
                pattern = None
        with self._lock:
            return self._patterns.setdefault(n, pattern)

    def _grow(self, n: int, error: _arclen.OutsidePattern) -> None:
        """Takes account of entries that the first Jacobian did not have."""
        rows, columns = (np.array(one, dtype=np.int64) for one in error.args)
        if self.sparsity is not None:
            raise ValueError(
                f"jac returned entry ({rows[0]}, {columns[0]}), which is not in `sparsity`"
            ) from None
        with self._lock:
            self._patterns[n] = convert.union(self._patterns[n], rows, columns)
            self._engines.pop(n, None)

    def _compute(self, u: np.ndarray, p: np.ndarray, call: Callable[[Any], Any], dress: Any) -> Any:
        """Calls the engine, and dresses the result as a branch, or by a function."""
        while True:
            found, error = call(self._engine(u, p))
            if not isinstance(error, _arclen.OutsidePattern):
                break
            # a trace from the beginning: the pattern only grows, so that this ends
            self._grow(u.size, error)
        if found is not None:
            found = dress(found) if callable(dress) else Branch(found, dress, u.size)
        if error is None:
            return found
        kept = isinstance(found, (Branch, Diagram)) and len(found) > 0
        if isinstance(error, KeyboardInterrupt) and kept:
            text = f"interrupted: {found!r} is what was computed"
            warnings.warn(text, InterruptedWarning, stacklevel=3)
            return found
        self.partial = found if kept else None
        raise error


def _read_only(x: np.ndarray) -> np.ndarray:
    copy = x.copy()
    copy.flags.writeable = False
    return copy

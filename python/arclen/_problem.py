"""Problems of the user's own, and everything that can be computed of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _convert as convert
from ._branch import Branch, Diagram, Event, Point, Solutions
from ._definition import Definition

if TYPE_CHECKING:
    from ._orbits import Orbits


class Problem(Definition):
    """Equilibria ``f(u, p) = 0`` of a function of n unknowns and a few parameters.

    The number of unknowns is that of ``u0`` where a trace starts.

    Parameters
    ----------
    f : callable
        ``f(u, p)`` returns n numbers: an array of float64, or a list. ``u`` is an array of shape
        (n,) and ``p`` one with the values of all parameters in the order of `parameters`; both are
        read-only. NaN says that there is no value at a state; an exception ends the computation and
        arrives unchanged.
    parameters : list of str
        Names of the parameters.
    jac : callable, optional
        ``jac(u, p)`` returns ∂f/∂u: an array of shape (n, n), or a matrix of `scipy.sparse`. By
        default by differences of order six, near 1e-13 for smooth f.
    parameter_derivative : callable, optional
        ``parameter_derivative(u, p)`` returns ∂f/∂p, of shape (n, number of parameters), or (n,) of
        a single parameter. By default by differences.
    sparsity : int, (int, int), array or sparse matrix, optional
        Where the Jacobian may differ from zero: its half-bandwidth, numbers of diagonals below and
        above, or a matrix. By default dense, or the pattern of what `jac` returns. Needed for sparse
        Jacobians by differences.
    mass : array or sparse matrix, optional
        M of ``M du/dt = f``, or its diagonal; by default the identity.
    stability : {"dynamics", "energy", None}, optional
        ``"dynamics"``: du/dt = f, eigenvalues of the Jacobian with positive real part are unstable.
        ``"energy"``: f is the gradient of an energy, negative eigenvalues are unstable. None: nothing
        is counted, and Hopf points are not sought. By default ``"dynamics"`` for up to 120 unknowns,
        of which all eigenvalues are computed, and None beyond.
    observe : dict, optional
        Scalar functions of a state by name, ``{"norm": lambda u, p: ...}``: further columns.
    scales : dict, optional
        Typical magnitudes of parameters by name, 1 by default; they matter where a trace has neither
        target nor domain.
    units : dict, optional
        Units of parameters by name, for people.
    metric : array of shape (n,), optional
        Weights of the unknowns in the arclength, ``ds² = Σ wᵢ duᵢ² + dp²``: with quadrature weights a
        step means the same on every mesh.

    Notes
    -----
    A problem does not change; several threads may use it at a time. Methods release the global
    interpreter lock but for calls of the functions above. Ctrl-C ends a computation: it returns what it
    has (``stopped_because == "interrupted"``) and warns with `InterruptedWarning`; where there is
    nothing yet, `KeyboardInterrupt` is raised.

    Examples
    --------
    A pitchfork, and the branches that leave it:

    >>> import arclen
    >>> problem = arclen.Problem(lambda u, p: p[0] * u - u**3, ["p"])
    >>> trunk = problem.trace("p", u0=[0], p0=[-1], target=1)
    >>> (point,) = trunk.events
    >>> point.label, point.type, point.criticality, abs(round(point.p, 9))
    ('BP', 'pitchfork', 'supercritical', 0.0)
    >>> fork = problem.branch_off(point, target=1)
    >>> abs(round(float(fork[-1].u[0]), 12)), fork[-1].unstable
    (1.0, 0)
    """

    # ---- branches --------------------------------------------------------------------------------

    def trace(
        self, parameter: str, u0: Any, p0: Any, target: float | None = None, **settings: Any
    ) -> Branch:
        """The branch through the solution near a state, in one direction.

        Parameters
        ----------
        parameter : str
            The parameter to continue in.
        u0 : array of shape (n,)
            A state from which Newton's method leads to the first point.
        p0 : dict, sequence or float
            Values of all parameters: by name, or in their order.
        target : float, optional
            The trace ends the first time the parameter takes this value, exactly.
        domain : (float, float), optional
            The trace ends at the bounds of this interval; one may be infinite.
        increasing : bool, optional
            Whether the parameter increases at first; by default towards the target, else upwards.
        max_step, min_step, first_step : float, optional
            Lengths of steps, in the problem's metric; by default a twentieth and 1e-10 of the range of
            the parameter in scaled arclength, and a tenth of the longest.
        max_points : int, optional
            Largest number of points, 5000.
        zeros, extrema : list of str, optional
            Observables of which zeros, or minima and maxima along the branch, are special points.
        stop_at : dict, optional
            Values of observables at which the trace ends.
        values : list of float, optional
            Values of the parameter that are to be met exactly, each an event.
        eigenvalues : int, optional
            Number of eigenvalues to compute at every point, the most unstable ones.
        counting : {"automatic", "full", "few"}, optional
            How unstable modes are counted where the Jacobian is not symmetric: all eigenvalues where
            that is cheap, always, or never.
        tolerance, event_tolerance, max_angle, max_iterations : optional
            1e-11, 1e-12, 0.35 radians and 8: of corrections, of the location of special points, of
            tangents in a step, of corrections in a step.
        progress : bool or callable, optional
            True shows a bar of tqdm, if that is installed; a function is called after every point with
            the numbers of points and events, the parameter and the arclength, and ends the trace by
            returning True.

        Returns
        -------
        Branch

        Raises
        ------
        ArclenError
            When there is no solution near the start, or no branch through it.
        TypeError, ValueError
            When an argument, or what a function returned, is unusable.
        """
        run = self._traced(settings, "trace", target=target)
        u, p, which = self._start(parameter, u0, p0)
        return self._compute(
            u, p, lambda engine: engine.trace(which, u.tolist(), p.tolist(), *run), self.parameters
        )

    def both_ways(self, parameter: str, u0: Any, p0: Any, **settings: Any) -> Branch:
        """The branch through the solution near a state, in both directions, as one branch.

        Parameters are those of `trace`. A closed curve is traced once. ``branch.began_because`` says why
        it ends at its first point.

        Returns
        -------
        Branch
        """
        run = self._traced(settings, "both_ways")
        u, p, which = self._start(parameter, u0, p0)
        return self._compute(
            u,
            p,
            lambda engine: engine.both_ways(which, u.tolist(), p.tolist(), *run),
            self.parameters,
        )

    def restart(self, point: Point | Branch, **settings: Any) -> Branch:
        """On along a branch from one of its points.

        Parameters
        ----------
        point : Point, Event or Branch
            Where to go on; of a branch from its last point. At a fold or branch point the trace starts
            from the next point.
        **settings
            Those of `trace`; without ``increasing`` the branch's way.

        Returns
        -------
        Branch
        """
        if isinstance(point, Branch):
            point = point[-1]
        if not isinstance(point, Point):
            raise TypeError(f"restart: {point!r} is neither a point nor a branch")
        branch, index = point.branch, point.index
        self._own(branch)
        run = self._traced(settings, "restart")
        u, p = self._place(point)
        return self._compute(
            u, p, lambda engine: engine.restart(branch._raw, index, *run), self.parameters
        )

    def branch_off(
        self, event: Event, direction: int = 0, forward: bool = True, **settings: Any
    ) -> Branch:
        """A branch that leaves a branch point.

        Parameters
        ----------
        event : Event
            The branch point.
        direction : int, optional
            Which of ``event.directions``.
        forward : bool, optional
            Along that direction, or against it.
        **settings
            Those of `trace`.

        Returns
        -------
        Branch
            Its first point is the branch point. One that cannot be reached has a single point, and says
            why in ``stopped_detail``.
        """
        if not isinstance(event, Event):
            raise TypeError(f"branch_off: {event!r} is no event of a branch")
        direction = convert.index(direction, "direction")
        if direction < 0:
            raise ValueError(f"direction is {direction}; it must not be negative")
        if not isinstance(forward, (bool, np.bool_)):
            raise TypeError(f"forward: {forward!r} is not True or False")
        self._own(event.branch)
        run = self._traced(settings, "branch_off")
        u, p = self._place(event)
        raw, number = event.branch._raw, event.number
        return self._compute(
            u,
            p,
            lambda engine: engine.leave(raw, number, direction, bool(forward), *run),
            self.parameters,
        )

    def curve(self, event: Event, second: str, **settings: Any) -> Branch:
        """The curve of a fold, Hopf point or branch point when a second parameter varies too.

        Parameters
        ----------
        event : Event
            A fold, Hopf point or branch point.
        second : str
            The other parameter, in which the curve is traced, both ways.
        **settings
            Those of `trace`; ``domain`` bounds the second parameter, and ``stop_at`` the first one by
            its name.

        Returns
        -------
        Branch
            Both parameters are columns. Its events are cusps, Bogdanov-Takens, zero-Hopf, generalised
            Hopf and double-Hopf points.
        """
        if not isinstance(event, Event):
            raise TypeError(f"curve: {event!r} is no event of a branch")
        first = event.branch.parameter
        second = convert.one_of(second, self.parameters, "parameter")
        self._own(event.branch)
        run = self._traced(settings, "curve", observables=[first, *self.observe])
        u, p = self._place(event)
        raw, number = event.branch._raw, event.number
        names = [name for name in self.parameters if name != first]
        return self._compute(u, p, lambda engine: engine.curve(raw, number, second, *run), names)

    def orbits(self, event: Event, **settings: Any) -> Orbits:
        """The periodic orbits that leave a special point.

        Parameters
        ----------
        event : Event
            A Hopf point of a branch of this problem; or a period doubling or branch point of `Orbits`.
        direction, forward : int, bool, optional
            At a branch point, which of ``event.directions``, and along it or against it.
        degree : int, optional
            Degree of the polynomials, 2 to 7, by default 4.
        intervals, max_intervals : int, optional
            Fewest and most intervals of the mesh, by default 30 and 400.
        accuracy : float, optional
            Relative error aimed at, by default 1e-10; the mesh follows it.
        adapt_every, period_growth, check : optional
            Points between meshes; growth of the period at which an approach to a homoclinic orbit ends the
            trace; whether errors are estimated, without which no count is certain.
        **settings
            Those of `trace`; without ``increasing`` the branch goes away from the special point. What can be
            watched is ``"period"``.

        Returns
        -------
        Orbits
        """
        from ._orbits import follow

        return follow(self, event, settings)

    def diagram(
        self,
        parameter: str,
        u0: Any,
        p0: Any,
        *,
        depth: int = 2,
        max_branches: int = 1000,
        disconnected: bool = True,
        **settings: Any,
    ) -> Diagram:
        """The branch through a solution, those that leave it, those that leave them.

        Parameters
        ----------
        parameter, u0, p0, **settings
            Those of `trace`; a target, a domain or a value in ``stop_at`` must bound it.
        depth : int, optional
            How many branch points lie between the first branch and others at most.
        max_branches : int, optional
            Largest number of branches.
        disconnected : bool, optional
            Whether deflation seeks branches beside near-bifurcations that nothing connects with the
            others.

        Returns
        -------
        Diagram
        """
        trace, watches, progress = self._traced(settings, "diagram")
        whole: dict[str, Any] = {
            "trace": trace,
            "depth": convert.count(depth, "depth"),
            "max_branches": convert.count(max_branches, "max_branches"),
        }
        if not disconnected:
            whole["search"] = None
        u, p, which = self._start(parameter, u0, p0)

        def dress(found: dict[str, Any]) -> Diagram:
            branches = []
            for one in found["branches"]:
                origin = _origin(one["origin"])
                branches.append(Branch(one["branch"], self.parameters, u.size, origin))
            joints, stopped = found["joints"], found["stopped"]
            return Diagram(branches, joints, stopped, found["is_complete"])

        return self._compute(
            u,
            p,
            lambda engine: engine.diagram(which, u.tolist(), p.tolist(), whole, watches, progress),
            dress,
        )

    # ---- solutions -------------------------------------------------------------------------------

    def solve(
        self, u0: Any, p0: Any, tolerance: float = 1e-12, max_iterations: int = 50
    ) -> np.ndarray:
        """The solution to which Newton's method leads at fixed parameters.

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        ArclenError
            When it leads to none.
        """
        u, p = convert.vector(u0, "u0"), convert.named(p0, self.parameters, "p0")
        tolerance = convert.finite(tolerance, "tolerance")
        count = convert.count(max_iterations, "max_iterations")
        found = self._compute(
            u, p, lambda engine: engine.newton(u.tolist(), p.tolist(), tolerance, count), _same
        )
        return found[0]

    def deflate(
        self,
        p0: Any,
        known: Iterable[Any] = (),
        branches: Iterable[Branch] = (),
        starts: Iterable[Any] = (),
        **settings: Any,
    ) -> Solutions:
        """Further solutions at the same parameters: deflation.

        Parameters
        ----------
        p0 : dict, sequence or float
            Values of all parameters.
        known : list of arrays of shape (n,), optional
            Solutions that are known.
        branches : list of Branch, optional
            Branches whose solutions there are known; other points of them are starts.
        starts : list of arrays of shape (n,), optional
            States from which attempts start; others start beside known solutions.
        tolerance, max_iterations, separation, length, reach, modes, amplitudes, max_solutions, \
max_attempts : optional
            Settings of the search.

        Returns
        -------
        Solutions
            A list of arrays of shape (n,). That nothing more was found proves nothing.
        """
        p = convert.named(p0, self.parameters, "p0")
        options = convert.settings(settings, convert.DEFLATION, "deflate")
        branches = list(branches)
        known = [convert.vector(u, "known") for u in convert.states(known, "known")]
        starts = [convert.vector(u, "starts") for u in convert.states(starts, "starts")]
        for branch in branches:
            if not isinstance(branch, Branch):
                raise TypeError(f"branches: {branch!r} is no branch")
            self._own(branch)
        first = [*known, *starts, *(branch.u(0) for branch in branches)]
        if not first:
            raise ValueError("deflate: give known solutions, branches or starts")
        raws = [branch._raw for branch in branches]
        lists = [[u.tolist() for u in known], [u.tolist() for u in starts]]
        found = self._compute(
            first[0],
            p,
            lambda engine: engine.deflate(p.tolist(), *lists, raws, 12, options),
            _same,
        )
        return Solutions(*found)

    def disconnected(
        self, branches: Iterable[Branch], values: Iterable[float] = (), **settings: Any
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Solutions ``(u, p)`` on none of the branches: starts for `both_ways`.

        They are sought beside near-bifurcations of the branches and at the given values of their
        parameter. Settings are those of `deflate`.
        """
        branches = list(branches)
        if not branches or not all(isinstance(branch, Branch) for branch in branches):
            raise TypeError("disconnected: give a list of branches")
        for branch in branches:
            self._own(branch)
        options = convert.settings(settings, convert.DEFLATION, "disconnected")
        at = convert.numbers_of(values, "values")
        raws = [branch._raw for branch in branches]
        u, p = self._place(branches[0][0])
        found = self._compute(u, p, lambda engine: engine.disconnected(raws, at, options), _same)
        return [(np.array(u), np.array(p)) for u, p in found]

    def near_bifurcations(self, branch: Branch) -> list[dict[str, Any]]:
        """Bifurcations that a small change of the problem would make.

        Returns
        -------
        list of dict
            ``kind`` (``"branch-point"`` or ``"folds"``), ``point``, ``s``, ``p``, ``u``, ``gap`` (in
            natural amplitudes) and ``direction``.
        """
        if not isinstance(branch, Branch):
            raise TypeError(f"near_bifurcations: {branch!r} is no branch")
        self._own(branch)
        u, p = self._place(branch[0])
        found = self._compute(u, p, lambda engine: engine.near(branch._raw), _same)
        for one in found:
            one["u"] = np.array(one["u"])
            one["direction"] = np.array(one["direction"]["du"])
        return found

    def modes(self, u: Any, p: Any, count: int = 6) -> tuple[np.ndarray, list[np.ndarray], bool]:
        """The most unstable eigenvalues of a state, and their modes.

        Returns
        -------
        values : ndarray of complex
            The most unstable first.
        vectors : list of ndarray, shape (n,)
            Modes of length 1 in the norm of the mass matrix, of symmetric problems with ``"energy"``;
            otherwise empty.
        certified : bool
            Whether no more unstable eigenvalue is missing.
        """
        u, p = convert.vector(u, "u"), convert.named(p, self.parameters, "p")
        number = min(convert.count(count, "count"), u.size)
        found = self._compute(
            u, p, lambda engine: engine.modes(u.tolist(), p.tolist(), number), _same
        )
        values, vectors, certified = found
        pairs = np.array([complex(re, im) for re, im in values], dtype=complex)
        return pairs, [np.array(vector) for vector in vectors], certified

    def check(self, u: Any, p: Any, scale: float = 1.0) -> dict[str, Any]:
        """How far the derivatives deviate from differences of f, relative to their largest entry.

        Near 1e-9 for correct ones. Costs 4 n calls of f.

        Returns
        -------
        dict
            ``jacobian``, ``at`` (its worst entry), ``parameters`` (by name).
        """
        u, p = convert.vector(u, "u"), convert.named(p, self.parameters, "p")
        scale = convert.finite(scale, "scale")
        found = self._compute(
            u, p, lambda engine: engine.check(u.tolist(), p.tolist(), scale), _same
        )
        jacobian, at, parameters = found
        by_name = dict(zip(self.parameters, parameters))
        return {"jacobian": jacobian, "at": at, "parameters": by_name}


def _same(found: Any) -> Any:
    return found


def _origin(value: Any) -> dict[str, Any]:
    if isinstance(value, str):
        return {"kind": value}
    ((kind, rest),) = value.items()
    return {"kind": kind, **rest}

"""Traced branches, their points and special points, and diagrams of them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from . import _draw
from ._arclen import RawBranch

if TYPE_CHECKING:
    import pandas

_MAGIC = b"arclen branch\n"


class Point:
    """One solution on a branch.

    Attributes
    ----------
    branch : Branch
        The branch.
    index : int
        Its place on the branch.
    u : ndarray, shape (n,)
        The unknowns.
    p : float
        The continued parameter.
    s : float
        Arclength from the first point, in the problem's metric.
    dp_ds : float
        Slope of the parameter along the branch.
    unstable : int or None
        Number of unstable modes; None where it is not known.
    certified : bool
        Whether that number is certain.
    eigenvalues : ndarray of complex
        Those asked for by ``eigenvalues=``, the most unstable first.
    parameters : dict
        Values of all parameters.
    """

    def __init__(self, branch: Branch, index: int) -> None:
        record = branch._raw.point(index)
        self.branch = branch
        self.index = index
        self.p: float = record["p"]
        self.s: float = record["s"]
        self.dp_ds: float = record["dp_ds"]
        self.unstable: int | None = record["unstable"]
        self.certified: bool = record["certified"]
        self.eigenvalues: np.ndarray = _complex(record["eigenvalues"])
        self._observables: list[float] = record["observables"]

    @property
    def u(self) -> np.ndarray:
        return self.branch.u(self.index)

    @property
    def parameters(self) -> dict[str, float]:
        return self.branch._parameters_at(self.index)

    def __getitem__(self, name: str) -> float:
        """The value of a column at this point."""
        if not isinstance(name, str):
            raise TypeError(f"{name!r} is not the name of a column")
        return float(self.branch[name][self.index])

    __iter__ = None  # a point is no sequence

    def __repr__(self) -> str:
        return f"<Point {self.index}: {self.branch.parameter} = {self.p:.9g}>"


class Event(Point):
    """A special point.

    It has the attributes of a `Point`, and these.

    Attributes
    ----------
    kind : str
        ``"fold"``, ``"branch-point"``, ``"hopf"``, ``"cusp"``, ``"bogdanov-takens"``,
        ``"generalised-hopf"``, ``"zero-hopf"``, ``"double-hopf"``, ``"zero-NAME"``,
        ``"NAME-minimum"``, ``"NAME-maximum"``, ``"target"``.
    label : str
        The short form: LP, BP, H, CP, BT, GH, ZH, HH; MIN and MAX of an observable; UZ for other
        values that were asked for.
    number : int
        Its place in `Branch.events`.
    unstable_before, unstable_after : int or None
        Numbers of unstable modes along the branch.
    residual : float
        Largest component of the residual, in the unit of f.
    error_estimate : float
        Estimated error of the location, a length in the problem's metric.
    type : str or None
        Of a branch point ``"transcritical"``, ``"pitchfork"``, ``"multiple"`` or ``"degenerate"``;
        of a Hopf point ``"supercritical"`` or ``"subcritical"``; None where it is not known.
    criticality : str or None
        ``"supercritical"`` or ``"subcritical"``, of a pitchfork or Hopf point, where it is certain.
    normal_form : dict
        Of a fold ``curvature`` (d²p/ds²), ``curvature_error``, ``order``; of a Hopf point
        ``frequency``, ``lyapunov`` (the first Lyapunov coefficient), ``lyapunov_error``; of a branch
        point ``multiplicity``, ``curvature``, ``curvature_error``, ``from_side``.
    modes : list of ndarray, shape (n,)
        Critical eigenvectors of length 1; complex at a Hopf point.
    directions : list of (ndarray, float)
        Of a branch point the unit tangents (du, dp) of the branches that leave it.
    """

    def __init__(self, branch: Branch, number: int, record: Mapping[str, Any]) -> None:
        super().__init__(branch, record["point"])
        self.number = number
        self.kind: str = record["kind"]
        self.label: str = record["label"]
        self.unstable_before: int | None = record["unstable_before"]
        self.unstable_after: int | None = record["unstable_after"]
        self.residual: float = record["residual"]
        self.error_estimate: float = record["error_estimate"]
        detail = record["detail"]
        form: dict[str, Any] = {}
        if isinstance(detail, dict):
            ((what, form),) = detail.items()
            form = dict(form)
        else:
            what = None
        self.criticality: str | None = form.pop("criticality", None)
        self.type: str | None = form.pop(
            "shape", self.criticality if what in ("hopf", "doubling") else None
        )
        form.pop("traced", None)
        self.directions: list[tuple[np.ndarray, float]] = [
            (np.asarray(one["du"]), float(one["dp"])) for one in form.pop("leaving", [])
        ]
        self.normal_form: dict[str, Any] = form
        self.modes: list[np.ndarray] = [
            np.asarray(re) + 1j * np.asarray(im) if im else np.asarray(re)
            for re, im in record["modes"]
        ]

    def __repr__(self) -> str:
        kind = f"{self.type} {self.kind}" if self.type else self.kind
        return f"<Event {self.label}: {kind} at {self.branch.parameter} = {self.p:.9g}>"


class Events(Sequence["Event"]):
    """The special points of a branch, in order along it."""

    def __init__(self, events: list[Event]) -> None:
        self._events = events

    def __len__(self) -> int:
        return len(self._events)

    @overload
    def __getitem__(self, key: int) -> Event: ...
    @overload
    def __getitem__(self, key: slice) -> list[Event]: ...
    def __getitem__(self, key: int | slice) -> Event | list[Event]:
        return self._events[key]

    def __iter__(self) -> Iterator[Event]:
        return iter(self._events)

    def of(self, kind: str) -> list[Event]:
        """Those of one kind, by its long name or its label."""
        return [event for event in self._events if kind in (event.kind, event.label)]

    def __repr__(self) -> str:
        return "[" + ", ".join(map(repr, self._events)) + "]"


class Branch:
    """A traced branch: its points as columns, its special points, why it ended.

    ``branch["name"]`` is a column, a read-only array with one value for each point: the continued
    parameter and the observables by name, ``"s"``, ``"dp_ds"``, ``"unstable"`` (NaN where it is not
    known), ``"certified"``, and ``"u[3]"``, an unknown. ``branch[3]`` and ``branch[-1]`` are points.

    Attributes
    ----------
    parameter : str
        Name of the continued parameter.
    parameters : dict
        Values of all parameters at the start.
    observables : list of str
        Names of the observables.
    columns : list of str
        Names of the columns, but for those of the unknowns.
    events : sequence of Event
        Special points in order along the branch; ``events.of("LP")`` are those of one kind.
    stopped_because : str
        ``"target"``, ``"closed-loop"``, ``"domain"``, ``"retraced"``; or, of a branch that was not
        traced as far as was asked, ``"max-points"``, ``"step-too-small"``, ``"branches-too-close"``,
        ``"unbounded"``, ``"returned-to-start"``, ``"interrupted"``.
    stopped_detail : str
        A sentence about it.
    began_because : str or None
        The same for the first point, where that is an end and not a start (`Problem.both_ways`).
    is_complete : bool
        Whether it was traced as far as was asked.
    is_certain : bool
        Whether every count of unstable modes is certain and every change of it explained.
    doubts : list of (float, float, str)
        Pieces (from, to) in which special points may be missing, and why.
    statistics : dict
        ``newton_iterations`` (Jacobians assembled), ``accepted`` and ``rejected`` steps.
    dim : int
        Number of unknowns of the problem.
    """

    def __init__(self, raw: RawBranch, names: Sequence[str], dim: int, origin: Any = None) -> None:
        self._raw = raw
        self._names = list(names)
        self.dim = dim
        self.origin: dict[str, Any] | None = origin
        self.parameter: str = raw.parameter
        self.observables: list[str] = raw.observables
        # at once, while the points are at hand; unknowns are read when they are asked for
        self._columns: dict[str, np.ndarray] = {name: raw.column(name) for name in self.columns}
        self._events: Events | None = None
        ((self.stopped_because, self.stopped_detail), began) = raw.stopped
        self.began_because: str | None = began[0] if began else None

    # ---- data ------------------------------------------------------------------------------------

    @property
    def columns(self) -> list[str]:
        return [self.parameter, *self.observables, "s", "dp_ds", "unstable", "certified"]

    @property
    def parameters(self) -> dict[str, float]:
        return dict(zip(self._names, map(float, self._raw.parameters)))

    @property
    def events(self) -> Events:
        if self._events is None:
            records = enumerate(self._raw.events())
            self._events = Events([Event(self, number, record) for number, record in records])
        return self._events

    @property
    def is_complete(self) -> bool:
        return self._raw.is_complete

    @property
    def is_certain(self) -> bool:
        return self._raw.is_certain

    @property
    def doubts(self) -> list[tuple[float, float, str]]:
        return self._raw.doubts

    @property
    def statistics(self) -> dict[str, int]:
        return self._raw.statistics

    @overload
    def __getitem__(self, key: str) -> np.ndarray: ...
    @overload
    def __getitem__(self, key: int) -> Point: ...
    def __getitem__(self, key: str | int) -> np.ndarray | Point:
        column = self._columns.get(key) if isinstance(key, str) else None
        if column is not None:
            return column
        if isinstance(key, str):
            try:
                column = self._raw.column(key)
            except KeyError:
                known = ", ".join(self.columns)
                raise KeyError(f"no column {key!r}: there are {known}, and u[i]") from None
            self._columns[key] = column
            return column
        return Point(self, self._index(key))

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and self[name] is not None
        except KeyError:
            return False

    def __len__(self) -> int:
        return len(self._raw)

    def __iter__(self) -> Iterator[Point]:
        return (Point(self, index) for index in range(len(self)))

    def _index(self, index: Any) -> int:
        try:
            at = range(len(self))[index]
        except TypeError:
            raise TypeError(f"{index!r} is neither a name nor the number of a point") from None
        except IndexError:
            raise IndexError(f"point {index} of a branch of {len(self)} points") from None
        if not isinstance(at, int):
            raise TypeError("a branch has no slices: slice its columns")
        return at

    def u(self, index: int) -> np.ndarray:
        """The unknowns at a point, an array of shape (n,)."""
        return self._raw.u(self._index(index))[: self.dim]

    @property
    def states(self) -> np.ndarray:
        """The unknowns at all points, an array of shape (points, n)."""
        return self._raw.states()[:, : self.dim]

    def shape(self, event: Event) -> Any:
        """The critical mode at a special point, an array of shape (n,); None where there is none.

        Where several modes are critical, `Event.modes` has them all.
        """
        if not isinstance(event, Event) or event.branch is not self:
            raise TypeError(f"shape: {event!r} is no event of this branch")
        return event.modes[0] if event.modes else None

    def _parameters_at(self, index: int) -> dict[str, float]:
        values = self.parameters
        values[self.parameter] = float(self[self.parameter][index])
        return values

    # ---- out -------------------------------------------------------------------------------------

    def to_pandas(self) -> pandas.DataFrame:
        """The columns as a table, with the kind of special point in ``event``. Needs pandas."""
        import pandas

        table = pandas.DataFrame({name: self[name] for name in self.columns})
        kinds = [""] * len(self)
        for event in self.events:
            kinds[event.index] = event.kind
        table["event"] = kinds
        table.index.name = "point"
        return table

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str | None:
        """The branch as CSV, every number to the last bit: written to a file, else returned."""
        text = self._raw.to_csv()
        if path is None:
            return text
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        return None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes everything to a file, from which `load` makes an equal branch."""
        body = repr((self._names, self.dim)).encode() + b"\n"
        temporary = f"{os.fspath(path)}.part"
        with open(temporary, "wb") as file:
            file.write(_MAGIC + body + self._raw.to_bytes())
        os.replace(temporary, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Branch:
        """A branch that `save` wrote.

        Raises
        ------
        ValueError
            When the file holds something else.
        """
        import ast

        with open(path, "rb") as file:
            magic, head, body = file.readline(), file.readline(), file.read()
        try:
            if magic != _MAGIC:
                raise ValueError("it begins differently")
            names, dim = ast.literal_eval(head.decode())
            return cls(RawBranch.from_bytes(body), names, dim)
        except (ValueError, SyntaxError, TypeError) as error:
            raise ValueError(f"{os.fspath(path)} holds no branch: {error}") from None

    def __reduce__(self) -> Any:
        return (Branch, (self._raw, self._names, self.dim, self.origin))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Branch):
            return NotImplemented
        return self._names == other._names and self._raw.to_bytes() == other._raw.to_bytes()

    __hash__ = object.__hash__

    def plot(self, ax: Any = None, x: str | None = None, y: str | None = None, **style: Any) -> Any:
        """Draws the branch, unstable parts dashed and special points labelled. Needs matplotlib.

        Parameters
        ----------
        ax : matplotlib axes, optional
            Where to draw; by default the current axes.
        x, y : str, optional
            Columns; by default the parameter and the first observable, or ``u[0]``.
        **style
            Passed on to ``ax.plot``.

        Returns
        -------
        matplotlib axes
        """
        return _draw.plot(self, ax, x, y, style)

    def __repr__(self) -> str:
        ends = f"{self['s'].size} points" if len(self) else "no points"
        labels = ", ".join(event.label for event in self.events) or "no events"
        return f"<Branch in {self.parameter}: {ends}, {labels}, stopped: {self.stopped_because}>"

    def _repr_html_(self) -> str:
        return _draw.html([self])


class Diagram(Sequence[Branch]):
    """A bifurcation diagram: a sequence of branches.

    ``branch.origin`` says where each begins: ``{"kind": "start"}``; ``{"kind": "switch", "branch",
    "event", "direction", "forward"}``, at a branch point of another branch; or ``{"kind":
    "deflation", "branch", "near", "parameter"}``, disconnected from all others.

    Attributes
    ----------
    branches : list of Branch
        In the order in which they were traced.
    joints : list of dict
        Branch points, each with the branches that ``passed`` it (branch, event) and ``begun`` there.
    stopped_because : str
        ``"complete"``, ``"max-branches"`` or ``"interrupted"``.
    is_complete : bool
        Whether everything that was asked for was followed, every branch to its end, all counts
        certain, and all branches at every branch point known.
    """

    def __init__(
        self, branches: list[Branch], joints: list[Any], stopped: str, is_complete: bool
    ) -> None:
        self.branches = branches
        self.joints = joints
        self.stopped_because = stopped
        self.is_complete = is_complete

    def __len__(self) -> int:
        return len(self.branches)

    @overload
    def __getitem__(self, key: int) -> Branch: ...
    @overload
    def __getitem__(self, key: slice) -> list[Branch]: ...
    def __getitem__(self, key: int | slice) -> Branch | list[Branch]:
        return self.branches[key]

    @property
    def events(self) -> list[Event]:
        """The special points of all branches."""
        return [event for branch in self.branches for event in branch.events]

    def plot(self, ax: Any = None, x: str | None = None, y: str | None = None, **style: Any) -> Any:
        """Draws all branches; see `Branch.plot`."""
        for branch in self.branches:
            ax = branch.plot(ax, x, y, **style)
        return ax

    def __repr__(self) -> str:
        return f"<Diagram of {len(self)} branches, {len(self.joints)} branch points>"

    def _repr_html_(self) -> str:
        return _draw.html(self.branches)


class Solutions(list[np.ndarray]):
    """Solutions found by deflation, arrays of shape (n,).

    Attributes
    ----------
    report : dict
        How many attempts were made and how they ended; ``exhausted`` is True where every start led
        to nothing new.
    """

    def __init__(self, solutions: list[np.ndarray], report: dict[str, Any]) -> None:
        super().__init__(solutions)
        self.report = report


def _complex(pairs: list[tuple[float, float]]) -> np.ndarray:
    return np.array([complex(re, im) for re, im in pairs], dtype=complex)

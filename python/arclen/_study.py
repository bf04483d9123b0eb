"""What is computed of cases of shells, devices and the catalogue: the program's own studies."""

from __future__ import annotations

import json
import os
import pathlib
import warnings
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _convert as convert
from ._branch import Branch, Diagram, Event, Events, Point
from ._case import Case, resolved
from ._definition import InterruptedWarning

if TYPE_CHECKING:
    import pandas
    import xarray


class _Table:
    """Columns of a table of the program."""

    def _read(self, record: Mapping[str, Any]) -> None:
        self._columns: dict[str, Any] = {}
        self.labels: dict[str, str] = {}
        self.units: dict[str, str] = {}
        for name, label, unit, values in record["columns"]:
            if isinstance(values, list):
                values = np.array(values, dtype=object)
                values.flags.writeable = False
            self._columns[name] = values
            self.labels[name] = label
            self.units[name] = unit
        self._csv: str = record["csv"]


class CaseBranch(_Table, Branch):
    """A branch of a case: a `Branch` with the columns of the program's ``branch.csv``.

    Numbers are those of the file to the last bit; a cell that is empty there is NaN. Columns of words are
    arrays of strings. States are kept at special points alone: ``event.u`` is there, ``u`` of other points is
    None.

    Attributes
    ----------
    case : Case or None
        The case.
    units, labels : dict
        Unit and name in words of every column.
    record : dict
        What the program writes to ``events.json``.
    shapes : list of dict
        Meridians at a few points: ``label``, ``sigma`` and ``z`` (arrays), ``plate``.
    """

    def __init__(self, case: Case | None, record: dict[str, Any], origin: Any = None) -> None:
        self._record = record
        self._read(record)
        self.case = case
        self.origin = origin
        self.dim = 0
        self.record: dict[str, Any] = json.loads(record["json"])
        self.parameter: str = self.record["parameter"]
        fixed = ("point", self.parameter, "unstable", "event")
        self.observables = [name for name in self._columns if name not in fixed]
        self.stopped_because: str = self.record["stopped_because"]
        self.stopped_detail: str = self.record.get("stopped_detail") or ""
        self.began_because = None
        self.shapes: list[dict[str, Any]] = record.get("shapes", [])
        self._events = None

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    @property
    def parameters(self) -> dict[str, float]:
        return {self.parameter: float(self[self.parameter][0])}

    @property
    def events(self) -> Events:
        if self._events is None:
            marked = np.flatnonzero(self._columns["event"] != "")
            found: list[Event] = []
            for number, record in enumerate(self.record["events"]):
                at = int(marked[number]) if number < marked.size else len(self) - 1
                found.append(CaseEvent(self, number, at, record))
            self._events = Events(found)
        return self._events

    @property
    def is_complete(self) -> bool:
        complete = ("target", "closed-loop", "domain", "retraced", "cycles-vanish")
        return self.stopped_because in complete

    @property
    def is_certain(self) -> bool:
        return self.record.get("certified") is not False

    @property
    def doubts(self) -> list[tuple[float, float, str]]:
        return []

    @property
    def statistics(self) -> dict[str, int]:
        return {"newton_iterations": self.record["newton_iterations"]}

    def __getitem__(self, key: Any) -> Any:
        column = self._columns.get(key) if isinstance(key, str) else None
        if column is not None:
            return column
        if isinstance(key, str):
            raise KeyError(f"no column {key!r}: there are {', '.join(self.columns)}")
        return CasePoint(self, self._index(key))

    def __len__(self) -> int:
        return len(self._columns["point"])

    def __iter__(self) -> Iterator[Point]:
        return (CasePoint(self, index) for index in range(len(self)))

    def u(self, index: int) -> np.ndarray:
        raise ValueError("the states of a case are not kept")

    @property
    def states(self) -> np.ndarray:
        raise ValueError("the states of a case are not kept")

    def shape(self, event: Event) -> dict[str, Any] | None:
        """The mode of a shell at a loss of symmetry; those of the branch's own unknowns are `Event.modes`.

        Returns
        -------
        dict or None
            ``n``, ``parity``, and arrays over the meridian: ``s`` (angle from the pole), the amplitudes
            ``u``, ``w`` (radial, axial) and ``v`` (around the axis); None at other special points.
        """
        if not isinstance(event, CaseEvent) or event.branch is not self:
            raise TypeError(f"shape: {event!r} is no event of this branch")
        modes = self._record.get("modes", {})
        found = modes.get(event.number)
        return None if found is None else dict(found)

    def meridian(self, event: Event) -> dict[str, np.ndarray] | None:
        """The shell at a special point.

        Returns
        -------
        dict or None
            Arrays of shape (samples,) from the pole on: ``sigma`` (distance from the axis) and ``z`` (height
            above the equator), in R0, and where there is a film its ``pressure``; None of a problem without a
            shell, and of a branch from files.
        """
        if not isinstance(event, CaseEvent) or event.branch is not self:
            raise TypeError(f"meridian: {event!r} is no event of this branch")
        if event.u is None or self.case is None:
            return None
        found = self.case._raw.meridian(event.u.tolist(), event.p)
        if found is None:
            return None
        return {name: one for name, one in zip(("sigma", "z", "pressure"), found) if one.size}

    def to_pandas(self) -> pandas.DataFrame:
        """The columns as a table; ``attrs`` hold units and labels. Needs pandas."""
        import pandas

        table = pandas.DataFrame(self._columns)
        table.attrs = {"units": self.units, "labels": self.labels}
        return table.set_index("point")

    def to_xarray(self) -> xarray.Dataset:
        """The numbers along the branch, with units and labels as attributes. Needs xarray."""
        import xarray

        variables = {
            name: ("point", values, {"units": self.units[name], "long_name": self.labels[name]})
            for name, values in self._columns.items()
            if name not in ("point", "event")
        }
        variables["event"] = ("point", self._columns["event"].astype(str), {})
        name = self.record["case"]
        return xarray.Dataset(variables, {"point": self._columns["point"]}, {"case": name})

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str | None:
        """``branch.csv``, written to a file, else returned."""
        if path is None:
            return self._csv
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(self._csv)
        return None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a folder as the program does: ``branch.csv``, ``events.json``, ``case.toml``."""
        folder = pathlib.Path(path)
        folder.mkdir(parents=True, exist_ok=True)
        files = {"branch.csv": self._csv, "events.json": self._record["json"]}
        if self.case is not None:
            files["case.toml"] = self.case.to_toml()
        for name, text in files.items():
            convert.write(folder / name, text.encode())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> CaseBranch:
        """A branch from a folder that `save` or the program wrote.

        Raises
        ------
        ValueError
            When the folder holds something else.
        """
        folder = pathlib.Path(path)
        try:
            table = (folder / "branch.csv").read_text("utf-8")
            events = (folder / "events.json").read_text("utf-8")
            case = None
            if (folder / "case.toml").exists():
                toml = (folder / "case.toml").read_text("utf-8")
                case = resolved(json.loads(events)["case"], toml)
            return cls(case, {"columns": _columns(table), "csv": table, "json": events})
        except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
            raise ValueError(f"{folder} holds no branch of the program: {error}") from None

    def __reduce__(self) -> Any:
        return (CaseBranch, (self.case, self._record, self.origin))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CaseBranch) and self._csv == other._csv

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        labels = ", ".join(event.label for event in self.events) or "no events"
        name = self.record["case"]
        return f"<Branch of {name}: {len(self)} points, {labels}, stopped: {self.stopped_because}>"


class CasePoint(Point):
    """A point of a branch of a case; its values are ``point["force"]``."""

    def __init__(self, branch: CaseBranch, index: int) -> None:
        self.branch = branch
        self.index = index
        self.p = float(branch[branch.parameter][index])
        self.s = self.dp_ds = float("nan")
        count = branch["unstable"][index] if "unstable" in branch else float("nan")
        self.unstable = None if np.isnan(count) else int(count)
        self.certified = branch.is_certain
        self.eigenvalues = np.zeros(0, dtype=complex)

    @property
    def u(self) -> Any:
        """None: states of cases are kept at special points alone."""
        return None

    def __getitem__(self, name: str) -> Any:
        if not isinstance(name, str):
            raise TypeError(f"{name!r} is not the name of a column")
        return self.branch[name][self.index]


_LABELS = {
    "fold": "LP",
    "branch-point": "BP",
    "hopf": "H",
    "cusp": "CP",
    "bogdanov-takens": "BT",
    "zero-hopf": "ZH",
    "generalised-hopf": "GH",
    "double-hopf": "HH",
    "symmetry-breaking": "SB",
}


class CaseEvent(CasePoint, Event):
    """A special point of a branch of a case.

    `kind`, `label`, `p`, `unstable_before`, `unstable_after`, `residual`, `error_estimate`, `type` and
    `criticality` are those of `Event`; `mesh_error` is what the elements add to the error of `p`, NaN where that was
    not estimated; `record` has everything that ``events.json`` says of it.

    `u` is the state, the solver's unknowns (of a shell those of `arclen-shell`'s discretisation), an array of
    shape (n,), and `modes` are the critical eigenvectors among the branch's own unknowns, null vectors at folds
    and branch points, complex at Hopf points. Both are lost in the files of `save`: then `u` is None and
    `modes` is empty.
    """

    def __init__(self, branch: CaseBranch, number: int, index: int, record: dict[str, Any]) -> None:
        CasePoint.__init__(self, branch, index)
        self.number = number
        self.record = record
        self.kind = record["kind"]
        self.label = _LABELS.get(self.kind, "UZ")
        if self.label == "UZ" and self.kind.endswith(("-minimum", "-maximum")):
            self.label = self.kind[-7:-4].upper()
        value = record.get(branch.parameter)
        self.p = float("nan") if value is None else float(value)
        self.unstable_before = record.get("unstable_before")
        self.unstable_after = record.get("unstable_after")
        self.residual = convert.or_nan(record.get("residual"))
        self.error_estimate = convert.or_nan(record.get("error_estimate"))
        self.mesh_error = convert.or_nan(record.get("mesh_error"))
        self.type = record.get("type")
        self.criticality = record.get("criticality")
        form = ("curvature", "order", "frequency", "lyapunov", "lyapunov_error", "multiplicity")
        self.normal_form = {key: record[key] for key in form if key in record}
        states = branch._record.get("states")
        self._u, vectors = states[number] if states else (None, [])
        self.modes = [re if im is None else re + 1j * im for re, im in vectors]
        self.directions = []

    @property
    def u(self) -> Any:
        """The state at the special point, an array of shape (n,); None of a branch from files."""
        return self._u


class Cycle(_Table):
    """A cycle of loading and unloading: ``cycle["force"]`` are columns of the path.

    Attributes
    ----------
    columns : list of str
    record : dict
        What the program writes to ``cycle.json``: ``jumps``, ``pull_off``, ``dissipated_total``,
        ``loop_area`` and more.
    stopped_because : str
    """

    def __init__(self, case: Case, record: dict[str, Any]) -> None:
        self.case = case
        self._read(record["path"])
        self.record: dict[str, Any] = json.loads(record["json"])
        self.stopped_because: str = self.record.get("stopped_because", "")

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    @property
    def jumps(self) -> list[dict[str, Any]]:
        return self.record["jumps"]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise KeyError(f"no column {name!r}: there are {', '.join(self.columns)}")
        return self._columns[name]

    def to_pandas(self) -> pandas.DataFrame:
        """The path as a table. Needs pandas."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_csv(self) -> str:
        """The path as CSV."""
        return self._csv

    def __repr__(self) -> str:
        return f"<Cycle of {self.case.name}: {len(self.jumps)} jumps>"


class Curve(_Table):
    """A curve of special points of a map; ``curve["film"]`` is a column.

    Attributes
    ----------
    kind : str
        Of the special points: ``"fold"``, ``"hopf"``, ``"branch-point"``.
    began_because, stopped_because : str
        Why it ends at either end.
    """

    def __init__(self, record: dict[str, Any]) -> None:
        self._read(record)
        self.kind: str = record["kind"]
        self.began_because, self.stopped_because = record["stopped"]

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise KeyError(f"no column {name!r}: there are {', '.join(self.columns)}")
        return self._columns[name]

    def to_csv(self) -> str:
        """The curve as CSV."""
        return self._csv

    def __repr__(self) -> str:
        return f"<Curve of {self.kind}s>"


class Map:
    """Curves of special points in two parameters.

    Attributes
    ----------
    curves : list of Curve
    points : list of dict
        Special points on them: ``kind``, both parameters by name, ``error_estimate`` (None of cusps of cycles).
    record : dict
        What the program writes to ``map.json``.
    """

    def __init__(self, case: Case, record: dict[str, Any]) -> None:
        self.case = case
        self.curves = [Curve(one) for one in record["curves"]]
        self.record: dict[str, Any] = json.loads(record["json"])
        self.points: list[dict[str, Any]] = self.record["points"]
        self.stopped_because: str = self.record.get("stopped_because", "")

    def __repr__(self) -> str:
        kinds = ", ".join(point["kind"] for point in self.points) or "no special points"
        return f"<Map of {self.case.name}: {len(self.curves)} curves, {kinds}>"


# ---- computations --------------------------------------------------------------------------------


def trace(case: Any, *, progress: Any = None, **keys: Any) -> CaseBranch:
    """The branch of a case, as ``arclen trace`` computes it.

    Parameters
    ----------
    case : str, path, dict or Case
        See `Case`.
    progress : bool or callable, optional
        True shows a bar of tqdm; a function is called after every point with the numbers of points and
        events and the parameter, and ends the trace by returning True.
    **keys
        Values in place of those of the case; see `Case`.

    Returns
    -------
    CaseBranch

    Raises
    ------
    ValueError
        When something is wrong with the case, or there is no first point.

    Examples
    --------
    >>> import arclen
    >>> branch = arclen.trace("bratu")
    >>> branch.stopped_because, branch.events.of("LP")[0].kind
    ('target', 'fold')
    """
    loaded = Case(case, **keys)
    record, error = loaded._raw.trace(convert.progress(progress))
    return settled(CaseBranch(loaded, record), error)


def diagram(case: Any, *, progress: Any = None, **keys: Any) -> Diagram:
    """The bifurcation diagram of a case, as ``arclen diagram`` computes it.

    Parameters are those of `trace`. ``branch.origin`` is the entry ``from`` of ``diagram.json``.

    Returns
    -------
    Diagram
    """
    loaded = Case(case, **keys)
    found, error = loaded._raw.diagram(convert.progress(progress))
    record = json.loads(found["json"])
    branches: list[Branch] = [
        CaseBranch(loaded, one, about.get("from"))
        for one, about in zip(found["branches"], record["branches"])
    ]
    stopped = record["stopped_because"]
    complete = stopped == "complete" and all(branch.is_complete for branch in branches)
    return settled(Diagram(branches, found["joints"], stopped, complete), error)


def cycle(case: Any, *, progress: Any = None, **keys: Any) -> Cycle:
    """Loading and unloading with jumps, as ``arclen cycle`` computes it; parameters as for `trace`."""
    loaded = Case(case, **keys)
    record, error = loaded._raw.cycle(convert.progress(progress))
    return settled(Cycle(loaded, record), error)


def map(case: Any, over: str, *, progress: Any = None, **keys: Any) -> Map:
    """Special points in two parameters, as ``arclen map --over KEY`` computes it.

    Parameters
    ----------
    case, progress, **keys
        Those of `trace`.
    over : str
        The second parameter: a key of the case, such as ``"film"``.

    Returns
    -------
    Map
    """
    if not isinstance(over, str):
        raise TypeError(f"over: {over!r} is not a key")
    loaded = Case(case, **keys)
    record, error = loaded._raw.map(over, convert.progress(progress))
    return settled(Map(loaded, record), error)


def settled(found: Any, error: BaseException | None) -> Any:
    """The result, or the exception of a callback; Ctrl-C leaves what there is."""
    if error is None:
        return found
    if isinstance(error, KeyboardInterrupt):
        warnings.warn(
            f"interrupted: {found!r} is what was computed", InterruptedWarning, stacklevel=3
        )
        return found
    raise error


def _columns(text: str) -> list[tuple[str, str, str, Any]]:
    """Columns of a CSV file of the program, as far as the file tells."""
    import csv

    rows = list(csv.reader(text.splitlines()))
    columns: list[tuple[str, str, str, Any]] = []
    for at, name in enumerate(rows[0]):
        cells = [row[at] for row in rows[1:]]
        values: Any = cells
        if name != "event":
            try:
                values = np.array([float(cell) if cell else np.nan for cell in cells])
                values.flags.writeable = False
            except ValueError:
                pass
        columns.append((name, name, "", values))
    return columns

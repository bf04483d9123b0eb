"""Cases: found, changed and checked by the program's own rules."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arclen
from ._convert import write

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ._branch import Diagram
    from ._fit import Plan
    from ._study import CaseBranch, Cycle, Map
    from ._sweep import Study


@functools.cache
def _tables() -> list[tuple[str, str, list[str]]]:
    """The tables of case files, the problems that have them, their keys."""
    return _arclen.case_keys()


def cases() -> dict[str, str]:
    """Names of the shipped cases and of the problems of the catalogue, each with a line about it.

    >>> import arclen
    >>> "fig12" in arclen.cases(), "bratu" in arclen.cases()
    (True, True)
    """
    shipped, catalogue = _arclen.list_cases()
    return {**dict.fromkeys(shipped, "a shipped case"), **dict(catalogue)}


class Case:
    """A checked case: what is computed, and with which values.

    Parameters
    ----------
    what : str, path, dict or Case
        A shipped case (`cases`), a problem of the catalogue, the path of a case file, or the contents of
        one as a dictionary of dictionaries.
    **keys
        Values in place of those of the case: ``adhesion=3e-3``, ``elements=200``, ``end=0.7``. A key that
        stands in several tables is written with its own, ``path__end=0.7`` or
        ``**{"path.end": 0.7}``, or ``path={"end": 0.7}``.

    Attributes
    ----------
    name : str
        Its name.
    notes : list of str
        Remarks that are no errors.

    Raises
    ------
    ValueError
        When something is wrong with it; the message names the file, the key, the value and what to write
        instead.

    Examples
    --------
    >>> import arclen
    >>> case = arclen.Case("fig12", elements=60)
    >>> case.name
    'fig12'
    >>> arclen.Case("fig12", adhesion=-1)
    Traceback (most recent call last):
    ...
    ValueError: fig12, keyword: dimensionless.adhesion = -1: must be ...
    """

    def __init__(self, what: Any, **keys: Any) -> None:
        self._source: str | tuple[str, str]
        given: list[str] = []
        if isinstance(what, Case):
            self._source, given = what._source, list(what._keys)
        elif isinstance(what, Mapping):
            name = what.get("name", "case")
            self._source = (str(name), _toml(what))
        elif isinstance(what, (str, os.PathLike)):
            path = os.fspath(what)
            if not isinstance(path, str):
                raise TypeError(f"{what!r} is not a path of text")
            self._source = path
        else:
            raise TypeError(f"{what!r} is neither a name, a path nor a dictionary")
        if keys:
            if any(_is_bare(key, value) for key, value in keys.items()):
                # where a bare key stands depends on the case
                raw = self._load(given)
                flat = _flat(keys, _homes(raw.problem, raw.is_physical, raw.parameters))
            else:
                flat = _flat(keys, {})
            given += [f"{key}={_value(value)}" for key, value in flat]
        self._keys: list[str] = given
        self._raw = self._load(given)

    def _load(self, keys: list[str]) -> _arclen.RawCase:
        if isinstance(self._source, tuple):
            name, text = self._source
            return _arclen.parse_case(name, text, keys)
        return _arclen.find_case(self._source, keys)

    @property
    def name(self) -> str:
        return self._raw.name

    @property
    def notes(self) -> list[str]:
        return self._raw.notes

    def to_toml(self) -> str:
        """The case as a case file, with every default written out."""
        return self._raw.to_toml()

    def trace(self, **options: Any) -> CaseBranch:
        """The branch; see `arclen.trace`."""
        from ._study import trace

        return trace(self, **options)

    def diagram(self, **options: Any) -> Diagram:
        """The bifurcation diagram; see `arclen.diagram`."""
        from ._study import diagram

        return diagram(self, **options)

    def cycle(self, **options: Any) -> Cycle:
        """Loading and unloading; see `arclen.cycle`."""
        from ._study import cycle

        return cycle(self, **options)

    def map(self, over: str, **options: Any) -> Map:
        """Special points in two parameters; see `arclen.map`."""
        from ._study import map

        return map(self, over, **options)

    def plan(self, known: Any = None, **options: Any) -> Plan:
        """What a measurement of this shell would identify; see `arclen.plan`."""
        from ._fit import plan

        return plan(self, known, **options)

    def sweep(
        self,
        vary: Mapping[str, Any],
        executor: Executor | None = None,
        out: str | os.PathLike[str] | None = None,
        **options: Any,
    ) -> Study:
        """The case with all combinations of values of some keys; see `arclen.study`.

        Parameters
        ----------
        vary : dict
            For each key its values: a list, or a dictionary as in a sweep file, such as
            ``{"from": 1e-4, "to": 1e-2, "count": 5, "scale": "log"}``.
        executor, **options
            Those of `arclen.study`.
        out : str or path, optional
            The folder, by default ``arclen-out/NAME``; its ``sweep.toml`` is the sweep, for the program too.

        Returns
        -------
        Study

        Examples
        --------
        >>> import arclen, tempfile
        >>> with tempfile.TemporaryDirectory() as out:
        ...     study = arclen.Case("bratu").sweep({"elements": [20, 40]}, out=out)
        >>> len(study), study.keys
        (2, ['mesh.elements'])
        """
        from ._sweep import study

        if not isinstance(vary, Mapping) or not vary:
            raise TypeError(f"vary: {vary!r} is not a dictionary of keys and their values")
        raw = self._raw
        homes = _homes(raw.problem, raw.is_physical, raw.parameters)
        text = self.to_toml()
        for key, values in vary.items():
            ((key, _),) = _flat({key: None}, homes)
            if not isinstance(values, Mapping):
                values = {"values": list(values)}
            text += f"\n[[vary]]\n{_toml({'key': key, **values})}"
        folder = os.fspath(out) if out is not None else os.path.join("arclen-out", self.name)
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, "sweep.toml")
        write(path, text.encode())
        return study(path, executor, folder, **options)

    def __repr__(self) -> str:
        return f"<Case {self.name}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Case) and self.to_toml() == other.to_toml()

    __hash__ = object.__hash__

    def __reduce__(self) -> Any:
        # as it was resolved: the file may be another one elsewhere
        return (resolved, (self.name, self.to_toml()))


def resolved(name: str, toml: str) -> Case:
    case = Case.__new__(Case)
    case._source, case._keys = (name, toml), []
    case._raw = case._load([])
    return case


def _is_bare(key: str, value: Any) -> bool:
    return not isinstance(value, Mapping) and "." not in key and "__" not in key


def _homes(problem: str, is_physical: bool, parameters: Iterable[str]) -> dict[str, str]:
    """The table in which a bare key of a case stands, of those that stand in one alone."""
    other = "dimensionless" if is_physical else "physical"
    kind = problem if problem in ("contact", "two-plates", "ring-load") else "catalogue"
    homes: dict[str, str | None] = {}
    # plates have other keys beside [physical]
    others = {table for table, problems, _ in _tables() if problems == f"{kind} with [physical]"}
    for table, problems, names in _tables():
        if table in others:
            belongs = problems == (f"{kind} with [physical]" if is_physical else kind)
        else:
            belongs = kind in problems.split(", ") or problems.startswith("all")
        if belongs and table != other:
            homes.update((name, None if name in homes else table) for name in names)
    homes.update((name, "parameters") for name in parameters)
    return {name: table for name, table in homes.items() if table is not None}


def _flat(keys: Mapping[str, Any], homes: Mapping[str, str]) -> Iterator[tuple[str, Any]]:
    """Keys with their tables."""
    for key, value in keys.items():
        if isinstance(value, Mapping):
            for inner, one in _flat_table(value):
                yield f"{key}.{inner}", one
        elif not _is_bare(key, value):
            yield key.replace("__", "."), value
        else:
            yield f"{homes[key]}.{key}" if key in homes else key, value


def _flat_table(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            for inner, one in _flat_table(value):
                yield f"{key}.{inner}", one
        else:
            yield str(key), value


def _value(value: Any) -> str:
    """A value in TOML."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_value(one) for one in value) + "]"
    raise TypeError(f"{value!r} is no value of a case file")


def _toml(tables: Mapping[Any, Any], prefix: str = "") -> str:
    """A dictionary of dictionaries in TOML."""
    lines, inner = [], []
    for key, value in tables.items():
        word = json.dumps(str(key))
        if isinstance(value, Mapping):
            inner.append(f"[{prefix}{word}]\n{_toml(value, f'{prefix}{word}.')}")
        else:
            lines.append(f"{word} = {_value(value)}\n")
    return "".join([*lines, *inner])

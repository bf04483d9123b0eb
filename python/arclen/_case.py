"""Cases: found, changed and checked by the program's own rules."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from . import _arclen

#: The table of a case file in which a bare key stands.
_TABLES = {
    "law": "shell",
    "poisson": "shell",
    "b": "shell",
    "bending": "dimensionless",
    "pressure": "dimensionless",
    "adhesion": "dimensionless",
    "film": "dimensionless",
    "surface_tension": "dimensionless",
    "gas_exponent": "dimensionless",
    "radius": "physical",
    "young": "physical",
    "thickness": "physical",
    "chi": "physical",
    "elements": "mesh",
    "grading": "mesh",
    "start": "path",
    "end": "path",
    "max_step": "path",
    "min_step": "path",
    "max_points": "path",
    "eigenvalues": "path",
    "depth": "diagram",
    "max_branches": "diagram",
    "scan": "stability",
    "max_n": "stability",
    "stiffness": "device",
}


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
        self._raw = self._load(given)
        # where a bare key stands depends on the case
        given += [f"{key}={_value(value)}" for key, value in _flat(keys, self.to_toml())]
        self._keys: list[str] = given
        if keys:
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


def _flat(keys: Mapping[str, Any], toml: str) -> Iterator[tuple[str, Any]]:
    """Keys with their tables."""
    for key, value in keys.items():
        if isinstance(value, Mapping):
            for inner, one in _flat_table(value):
                yield f"{key}.{inner}", one
        elif "." in key or "__" in key:
            yield key.replace("__", "."), value
        elif f"\n{key} = " in toml.partition("\n[parameters]")[2].partition("\n[")[0]:
            # a parameter of a problem of the catalogue
            yield f"parameters.{key}", value
        elif key in _TABLES:
            table = _TABLES[key]
            if table == "dimensionless" and "\n[physical]" in toml and key != "gas_exponent":
                table = "physical"
            yield f"{table}.{key}", value
        else:
            yield key, value


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

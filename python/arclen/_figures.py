"""The figures of the reference paper, as the program computes them."""

from __future__ import annotations

import json
import os
import pathlib
from typing import Any

from . import _arclen
from . import _convert as convert
from ._case import _flat, _homes, _value
from ._study import settled


class Figures:
    """Computed figures.

    Attributes
    ----------
    record : dict
        What the program writes to ``figures.json``.
    files : dict of str to bytes
        All other files by name: pictures, a page, the paper's claims compared with what was computed.
    summary : str
        The same in words.
    is_complete : bool
        Whether every branch was traced to its end.
    """

    def __init__(self, found: dict[str, Any]) -> None:
        self._found = found
        self.record: dict[str, Any] = json.loads(found["json"])
        self.files: dict[str, bytes] = found["files"]
        self.summary: str = found["summary"]
        self.is_complete: bool = found["complete"]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a folder as ``arclen figure`` does."""
        folder = pathlib.Path(path)
        for name, content in {"figures.json": self._found["json"].encode(), **self.files}.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            convert.write(folder / name, content)

    def __reduce__(self) -> Any:
        return (Figures, (self._found,))

    def __repr__(self) -> str:
        return f"<Figures: {', '.join(sorted(self.files))}>"

    def _repr_html_(self) -> str:
        pictures = [text.decode() for name, text in self.files.items() if name.endswith(".svg")]
        return f"<div>{''.join(pictures)}</div>"


def figure(name: Any, out: str | os.PathLike[str] | None = None, **keys: Any) -> Figures:
    """Figures of the reference paper, as ``arclen figure`` computes them.

    Parameters
    ----------
    name : int, str, or list of them
        The number of a figure, ``"stability"``, or ``"all"``.
    out : str or path, optional
        A folder into which the program's files are written.
    **keys
        Values in place of those of all cases of the figures; see `Case`.

    Returns
    -------
    Figures

    Raises
    ------
    ValueError
        When there is no such figure, or it has no cases with such keys.

    Examples
    --------
    >>> import arclen
    >>> figures = arclen.figure(9, elements=40)
    >>> any(name.endswith(".svg") for name in figures.files)
    True
    """
    names = name if isinstance(name, (list, tuple)) else [name]
    words = [word if isinstance(word, str) else str(convert.index(word, "name")) for word in names]
    homes = _homes("contact", False, ())
    given = [f"{key}={_value(value)}" for key, value in _flat(keys, homes)]
    found, error = _arclen.compute_figures(words, given)
    figures = settled(Figures(found), error)
    if out is not None:
        figures.save(out)
    return figures

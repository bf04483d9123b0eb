"""Fits of measured force curves, and plans of measurements, as the program makes them."""

from __future__ import annotations

import json
import os
import pathlib
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from . import _arclen
from . import _convert as convert
from ._case import Case, _flat, _value, resolved
from ._study import settled

if TYPE_CHECKING:
    import pandas


class Estimate:
    """A quantity with what is known of it, in SI units.

    Attributes
    ----------
    key : str
    value : float
    unit : str
    sd : float or None
        Standard deviation.
    interval68, interval95 : (float or None, float or None)
        None is an open end.
    method : str
        ``"covariance"``, ``"profile"``, or ``"fixed"``.
    verdict : str or None
        ``"identified"``, ``"weak"``, ``"not-identifiable"``; None where nothing may be said.
    record : dict
        Everything that ``fit.json`` says of it.
    """

    def __init__(self, record: dict[str, Any]) -> None:
        self.record = record
        self.key: str = record["key"]
        self.value: float = convert.or_nan(record["value"])
        self.unit: str = record["unit"]
        self.sd: float | None = record["sd"]
        self.interval68: tuple[float | None, float | None] = tuple(record["interval68"])
        self.interval95: tuple[float | None, float | None] = tuple(record["interval95"])
        self.method: str = record["method"]
        self.verdict: str | None = record["verdict"]

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        error = "" if self.sd is None else f" ± {self.sd:.2g}"
        unit = f" {self.unit}" if self.unit else ""
        return f"<{self.key} = {self.value:.6g}{error}{unit}>"


class Estimates(Mapping[str, Estimate]):
    """Quantities by their names."""

    def __init__(self, records: list[dict[str, Any]]) -> None:
        self._all = {record["key"]: Estimate(record) for record in records}

    def __getitem__(self, key: str) -> Estimate:
        if key not in self._all:
            raise KeyError(f"no quantity {key!r}: there are {', '.join(self._all)}")
        return self._all[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        return "{" + ", ".join(map(repr, self._all.values())) + "}"


class Fit:
    """A fit of one curve. ``fit["force"]`` is a column, one value for each sample.

    Attributes
    ----------
    parameters, derived : mapping of str to Estimate
        Quantities of the model, and what follows from them (``young``, ``thickness``, ``sqrt_chi_kb``).
    warnings : list of str
        Remarks in sentences; ``record["warnings"]`` has their codes.
    is_good : bool
        Whether the model describes the curve: settled, and ``chi2_dof`` at most 2.
    quality : dict
        ``chi2_dof``, ``noise``, ``converged`` and more.
    law : str
        The law of the membrane.
    columns : list of str
        ``segment``, ``piezo``, ``separation``, ``approach_one_pole``, ``force``, ``model``, ``residual``,
        ``used``: SI units, arrays of shape (samples,).
    case : Case
        The fitted shell, to be traced.
    record : dict
        What the program writes to ``fit.json``.
    files : dict of str to str
        Its other files by name: ``fit.csv``, ``case.toml``, pictures.
    """

    def __init__(self, found: dict[str, Any]) -> None:
        self._found = found
        self.record: dict[str, Any] = json.loads(found["json"])
        self.parameters = Estimates(self.record["parameters"])
        self.derived = Estimates(self.record["derived"])
        self.warnings: list[str] = [one["text"] for one in self.record["warnings"]]
        self.is_good: bool = found["good"]
        self.quality: dict[str, Any] = self.record["quality"]
        self.law: str = self.record["law"]
        self.curve: str = self.record["curve"]
        self.files: dict[str, str] = found["files"]
        self.summary: str = found["summary"]
        self._columns = {name: np.asarray(values) for name, values in found["columns"].items()}
        for column in self._columns.values():
            column.flags.writeable = False

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise KeyError(f"no column {name!r}: there are {', '.join(self._columns)}")
        return self._columns[name]

    @property
    def case(self) -> Case:
        return resolved(pathlib.Path(self.curve).stem or "fit", self.files["case.toml"])

    def to_pandas(self) -> pandas.DataFrame:
        """The samples as a table. Needs pandas."""
        import pandas

        return pandas.DataFrame(self._columns)

    def plot(self, ax: Any = None, x: str = "piezo", **style: Any) -> Any:
        """Draws the samples and the model. Needs matplotlib.

        Parameters
        ----------
        ax : matplotlib axes, optional
            Where to draw; by default the current axes.
        x : str, optional
            The column across: ``"piezo"``, ``"separation"`` or ``"approach_one_pole"``.
        **style
            Passed on to ``ax.plot`` for the model.

        Returns
        -------
        matplotlib axes
        """
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.gca()
        across, label = self[x], "model"
        ax.plot(across, self["force"], ".", color="#999999", markersize=2, label="measured")
        for segment in dict.fromkeys(self["segment"]):
            of = (self["segment"] == segment) & self["used"]
            model = np.where(of, self["model"], np.nan)
            ax.plot(across, model, **{"color": "#d55e00", "label": label, **style})
            label = "_" + label
        ax.set_xlabel(f"{x} [m]")
        ax.set_ylabel("force [N]")
        ax.legend()
        return ax

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a folder as the program does: ``fit.json``, ``fit.csv``, ``case.toml``, pictures."""
        folder = pathlib.Path(path)
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in {"fit.json": self._found["json"], **self.files}.items():
            convert.write(folder / name, text.encode())

    def __reduce__(self) -> Any:
        return (Fit, (self._found,))

    def __repr__(self) -> str:
        moduli = ", ".join(repr(self.derived[key])[1:-1] for key in ("young", "thickness"))
        good = "" if self.is_good else ", not good"
        return f"<Fit of {self.curve}: {moduli}, chi2/dof {self.quality['chi2_dof']:.3g}{good}>"

    def _repr_html_(self) -> str:
        rows = []
        for one in [*self.derived.values(), *self.parameters.values()]:
            if one.method == "fixed":
                continue
            low, high = ("open" if end is None else f"{end:.4g}" for end in one.interval95)
            cells = [one.key, f"{one.value:.5g}", one.unit, f"{low} – {high}", one.verdict or ""]
            rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
        titles = ("", "value", "unit", "95 % interval", "verdict")
        head = "".join(f"<th>{title}</th>" for title in titles)
        notes = "".join(f"<li>{escape(warning)}</li>" for warning in self.warnings)
        picture = self.files.get("fit.svg", "")
        return f"<div>{picture}<table><tr>{head}</tr>{''.join(rows)}</table><ul>{notes}</ul></div>"


class Plan:
    """How well measurements to several depths would identify a shell, at best.

    Attributes
    ----------
    depths : list of dict
        ``deformation`` (in R0), ``travel`` (m), ``force`` (N), and ``relative_sd`` of each quantity.
    needed : dict
        For each quantity the least deformation of those compared at which it is known to 5 %; None where
        it is at none.
    record : dict
        What the program writes to ``plan.json``.
    """

    def __init__(self, text: str, summary: str) -> None:
        self._text, self.summary = text, summary
        self.record: dict[str, Any] = json.loads(text)
        self.depths: list[dict[str, Any]] = self.record["depths"]
        self.needed: dict[str, float | None] = self.record["deformation_for_5_percent"]

    def __reduce__(self) -> Any:
        return (Plan, (self._text, self.summary))

    def __str__(self) -> str:
        return self.summary

    def __repr__(self) -> str:
        return f"<Plan of {self.record['case']}: {len(self.depths)} depths>"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.summary)}</pre>"


def fit(
    curves: Any,
    known: Any = None,
    *,
    law: str | None = None,
    fix: Iterable[str] = (),
    free: Iterable[str] = (),
    prior: Iterable[str] | Mapping[str, tuple[Any, Any]] = (),
    segments: str = "both",
    range: str | None = None,
    profile: str | Iterable[str] | None = None,
    robust: bool = False,
    progress: Any = None,
    **keys: Any,
) -> Any:
    """Fits measured force curves, as ``arclen fit`` does.

    Parameters
    ----------
    curves : path, dict of arrays, or list of them
        Files in the program's formats; or a curve itself, a dictionary (or table) with ``segment``
        (``"approach"``, ``"retract"``), ``height`` (m) and ``force`` (N) of each sample.
    known : path or dict, optional
        What the laboratory knows, a file or its tables ``instrument``, ``shell``, ``physical``, ``data``.
    law : str, optional
        ``"hooke"``, ``"mooney-rivlin"``, ``"skalak"``, or ``"all"``; by default ``shell.law``.
    fix, free : list of str, optional
        Quantities that are kept at their known value, and such that are looked for.
    prior : dict or list of str, optional
        What is known of quantities with errors: ``{"radius": ("1.5 um", "50 nm")}``, or ``"KEY=VALUE:SD"``.
    segments : {"both", "approach", "retract"}, optional
        Which are fitted.
    range : str, optional
        Piezo heights that are fitted, ``"7.5 um:9 um"``.
    profile : str or list of str, optional
        Quantities whose profile likelihoods are followed, or ``"none"``.
    robust : bool, optional
        Whether outliers count less.
    progress : bool or callable, optional
        True shows a bar of tqdm; a function is called with the stage (``"starts"``, ``"descents"``,
        ``"polish"``, ``"profiles"``) and the share of the work that is done, and stops the fit by returning
        True.
    **keys
        Values in place of those of `known`: ``spring_constant="0.08 N/m"``, or with the table,
        ``instrument__noise="50 pN"``.

    Returns
    -------
    Fit, or list of Fit and ValueError
        One curve gives its fit. Of a list, or a map of curves, each gives its fit, or the error that says why
        it has none.

    Raises
    ------
    ValueError
        When something is wrong with the curve or what is known, or nothing fits it. The message names the
        file, the key, the value and the remedy.
    KeyboardInterrupt
        At Ctrl-C before a first shell was found. Later a fit keeps what it has, with the warning ``stopped``
        in its record and an `InterruptedWarning`; of several curves those that follow have an error.
    """
    given, asked = _asked(known, keys, fix, free, prior, segments, range, robust)
    if isinstance(profile, Iterable) and not isinstance(profile, str):
        profile = ",".join(profile)
    if law is not None and not isinstance(law, str):
        raise TypeError(f"law: {law!r} is not a name")
    told = convert.fit_progress(progress)
    try:
        return _fits(curves, given, law, profile, asked, told)
    finally:
        getattr(told, "close", lambda: None)()


def _fits(
    curves: Any,
    given: tuple[str | None, list[str]],
    law: str | None,
    profile: Any,
    asked: dict[str, Any],
    told: Any,
) -> Any:
    with tempfile.TemporaryDirectory(prefix="arclen-") as scratch:
        several = isinstance(curves, (list, tuple))
        paths = [
            _path(curve, scratch, number)
            for number, curve in enumerate(curves if several else [curves])
        ]
        try:
            sources = _arclen.curve_sources(paths, *given)
        except ValueError as error:
            _refuse(error)
        found: list[Fit | ValueError] = []
        stopped: BaseException | None = None
        for source in sources:
            if stopped is not None:
                found.append(ValueError(f"{source[0]}: stopped"))
                continue
            try:
                one, stopped = _fitted(source, given, law, profile, asked, scratch, told)
                found.append(one)
            except ValueError as error:
                if len(sources) == 1 and not several:
                    raise
                found.append(error)
    result = found[0] if len(found) == 1 and not several else found
    return settled(result, stopped)


def _fitted(
    source: Any,
    given: tuple[str | None, list[str]],
    law: str | None,
    profile: Any,
    asked: dict[str, Any],
    scratch: str,
    told: Any,
) -> tuple[Fit, BaseException | None]:
    try:
        known, keys = given
        record, reason, stopped = _arclen.fit_curve(
            source, known, keys, law, profile, asked, told
        )
    except ValueError as error:
        _refuse(error, scratch)
    if record is None and stopped is not None:
        raise stopped
    if record is None:
        raise ValueError(_plain(reason or "nothing fits", scratch))
    # the file of a curve that was given as arrays is no place to be named
    record["json"] = record["json"].replace(scratch + os.sep, "")
    record["summary"] = record["summary"].replace(scratch + os.sep, "")
    record["files"] = {
        name: text.replace(scratch + os.sep, "") for name, text in record["files"].items()
    }
    return Fit(record), stopped


def plan(
    case: Any,
    known: Any = None,
    *,
    fix: Iterable[str] = (),
    free: Iterable[str] = (),
    prior: Iterable[str] | Mapping[str, tuple[Any, Any]] = (),
    **keys: Any,
) -> Plan:
    """What a measurement of a shell would identify, as ``arclen fit --plan`` says.

    Parameters
    ----------
    case : str, path, dict or Case
        A contact case in physical units: the shell, and how deep the curve goes.
    known, fix, free, prior, **keys
        Those of `fit`; lever and noise are needed.

    Returns
    -------
    Plan

    Examples
    --------
    >>> import arclen
    >>> lever = {"instrument": {"spring_constant": "0.3 N/m", "noise": "50 pN"}}
    >>> plan = arclen.plan("polymer", lever)
    >>> len(plan.depths), "young" in plan.needed
    (10, True)
    """
    given, asked = _asked(known, keys, fix, free, prior, "both", None, False)
    try:
        return Plan(*_arclen.plan_measurement(Case(case)._raw, *given, asked))
    except ValueError as error:
        _refuse(error)


def _asked(
    known: Any,
    keys: dict[str, Any],
    fix: Iterable[str],
    free: Iterable[str],
    prior: Any,
    segments: str,
    range: str | None,
    robust: bool,
) -> tuple[tuple[str | None, list[str]], dict[str, Any]]:
    """What is known, and what is asked, for the compiled part."""
    path, tables = None, {}
    if isinstance(known, Mapping):
        tables = dict(known)
    elif isinstance(known, (str, os.PathLike)):
        path = os.fspath(known)
    elif known is not None:
        raise TypeError(f"known: {known!r} is neither a path nor a dictionary")
    homes: dict[str, str] = {}
    for table, names in _arclen.lab_keys():
        homes.update((name, table) for name in names if name not in homes)
    flat = [*_flat(tables, {}), *_flat(keys, homes)]
    if isinstance(prior, Mapping):
        prior = [f"{key}={value}:{sd}" for key, (value, sd) in prior.items()]
    convert.one_of(segments, ("both", "approach", "retract"), "segments")
    if range is not None and not isinstance(range, str):
        raise TypeError(f"range: {range!r} is no text such as '7.5 um:9 um'")
    asked = {
        "fix": _words(fix, "fix"),
        "free": _words(free, "free"),
        "prior": _words(prior, "prior"),
        "segments": segments,
        "range": range,
        "robust": bool(robust),
    }
    return (path, [f"{key}={_value(value)}" for key, value in flat]), asked


def _words(value: Any, what: str) -> list[str]:
    words = [value] if isinstance(value, str) else list(value)
    for word in words:
        if not isinstance(word, str):
            raise TypeError(f"{what}: {word!r} is not a word")
    return words


def _path(curve: Any, scratch: str, number: int) -> str:
    """The file of a curve; arrays are written to one."""
    if isinstance(curve, (str, os.PathLike)):
        return os.fspath(curve)
    try:
        height = convert.numbers_of(curve["height"], "height")
        force = convert.numbers_of(curve["force"], "force")
        segment = [str(word) for word in curve["segment"]]
    except (TypeError, KeyError, IndexError):
        raise TypeError(
            "curves: a path, or a dictionary of the arrays segment, height and force, is expected"
        ) from None
    if not len(height) == len(force) == len(segment):
        counts = f"{len(segment)}, {len(height)} and {len(force)}"
        raise ValueError(f"curves: segment, height and force have {counts} samples")
    rows = [f"{s},{z!r},{f!r}\n" for s, z, f in zip(segment, height, force)]
    path = os.path.join(scratch, f"curve-{number}.csv")
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(["segment,height_m,force_N\n", *rows])
    return path


def _plain(text: str, scratch: str | None = None) -> str:
    """A message of the program in the words of the arguments here."""
    if scratch is not None:
        text = text.replace(scratch + os.sep, "")
    text = re.sub(r"--(\w+) (?=[\w\"])", r"\1=", text)
    return re.sub(r"--(\w+)", r"\1", text)


def _refuse(error: ValueError, scratch: str | None = None) -> NoReturn:
    raise ValueError(_plain(str(error), scratch)) from None

"""What users write, as what the engine takes; every complaint names the argument."""

from __future__ import annotations

import difflib
import numbers
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np


def is_sparse(value: Any) -> bool:
    """Whether it is one of SciPy's sparse matrices, without importing SciPy."""
    return hasattr(value, "tocsc") and hasattr(value, "tocoo") and hasattr(value, "shape")


def vector(value: Any, what: str, length: int | None = None) -> np.ndarray:
    """A one-dimensional array of finite floats, copied."""
    try:
        array = np.asarray(value)
    except Exception as error:
        raise TypeError(f"{what}: not an array of numbers: {error}") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{what}: dtype {array.dtype} is not real numbers")
    if array.ndim == 0:
        array = array.reshape(1)
    if array.ndim != 1:
        raise ValueError(f"{what}: shape {array.shape}; it must have one dimension")
    if length is not None and array.size != length:
        raise ValueError(f"{what}: {array.size} numbers; it must have {length}")
    array = array.astype(np.float64)
    if not np.isfinite(array).all():
        at = int(np.flatnonzero(~np.isfinite(array))[0])
        raise ValueError(f"{what}: entry {at} is {array[at]}; all must be finite")
    return array


def number(value: Any, what: str) -> float:
    """A float; NaN is refused, infinity is not."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        if isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "fiu":
            value = value.item()
        else:
            raise TypeError(f"{what}: {value!r} is not a number")
    result = float(value)
    if np.isnan(result):
        raise ValueError(f"{what} is NaN")
    return result


def or_nan(value: Any) -> float:
    """A number of a record, NaN where there is none."""
    return float("nan") if value is None else float(value)


def index(value: Any, what: str) -> int:
    """An integer."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{what}: {value!r} is not an integer")
    return int(value)


def one_of(value: str, known: Iterable[str], what: str) -> str:
    """A known name; others are answered with the nearest one."""
    known = list(known)
    if not isinstance(value, str):
        raise TypeError(f"{what}: {value!r} is not a name")
    if value not in known:
        near = difflib.get_close_matches(value, known, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"no {what} {value!r}: there are {', '.join(map(repr, known))}{hint}")
    return value


def named(value: Any, names: list[str], what: str) -> np.ndarray:
    """Values of all names, from a mapping, a sequence in their order or, of one name, a number."""
    if isinstance(value, Mapping):
        for name in value:
            one_of(name, names, f"{what}: parameter")
        missing = [name for name in names if name not in value]
        if missing:
            raise ValueError(f"{what}: no value of {', '.join(map(repr, missing))}")
        value = [number(value[name], f"{what}[{name!r}]") for name in names]
    return vector(value, what, len(names))


# ---- settings ------------------------------------------------------------------------------------

SETTINGS = {
    "target": number,
    "domain": None,
    "increasing": None,
    "max_step": number,
    "min_step": number,
    "first_step": number,
    "max_points": index,
    "tolerance": number,
    "max_iterations": index,
    "max_angle": number,
    "eigenvalues": index,
    "counting": None,
    "event_tolerance": number,
}
DEFLATION = {
    "tolerance": number,
    "max_iterations": index,
    "separation": number,
    "length": number,
    "reach": number,
    "modes": index,
    "amplitudes": None,
    "max_solutions": index,
    "max_attempts": index,
}


def settings(given: Mapping[str, Any], known: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Settings for the engine, which checks their ranges; those that are None keep their defaults."""
    result: dict[str, Any] = {}
    for key, value in given.items():
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            hint = f"; did you mean {near[0]!r}?" if near else f"; there are {', '.join(known)}"
            raise TypeError(f"{where}() got an unexpected keyword argument {key!r}{hint}")
        if value is None:
            continue
        read = known[key]
        if read is not None:
            value = read(value, key)
            if read is index and not 0 <= value < 2**53:
                raise ValueError(f"{key} is {value}; it must not be negative, nor beyond 2**53")
        elif key == "domain":
            if not isinstance(value, (tuple, list, np.ndarray)) or len(value) != 2:
                raise TypeError(f"domain: {value!r} is not a pair (lowest, highest)")
            value = (number(value[0], "domain[0]"), number(value[1], "domain[1]"))
        elif key == "increasing":
            if not isinstance(value, (bool, np.bool_)):
                raise TypeError(f"increasing: {value!r} is not True or False")
            value = bool(value)
        elif key == "counting":
            value = one_of(value, ["automatic", "full", "few"], "counting")
        elif key == "amplitudes":
            value = vector(value, key).tolist()
        result[key] = value
    return result


def watches(
    observables: list[str],
    zeros: Iterable[str],
    extrema: Iterable[str],
    stop_at: Mapping[str, float],
    values: Iterable[float],
) -> list[dict[str, Any]]:
    """Special points that the user asks for."""
    result: list[dict[str, Any]] = []
    for name in [zeros] if isinstance(zeros, str) else zeros:
        name = one_of(name, observables, "observable")
        result.append({"value": {"observable": name, "level": 0.0, "stop": False}})
    for name in [extrema] if isinstance(extrema, str) else extrema:
        result.append({"extremum": {"observable": one_of(name, observables, "observable")}})
    if not isinstance(stop_at, Mapping):
        raise TypeError(f"stop_at: {stop_at!r} is not a dictionary {{observable: value}}")
    for name, level in stop_at.items():
        name = one_of(name, observables, "observable")
        level = finite(level, f"stop_at[{name!r}]")
        result.append({"value": {"observable": name, "level": level, "stop": True}})
    for value in numbers_of(values, "values"):
        result.append({"parameter": {"value": value}})
    return result


def numbers_of(value: Any, what: str) -> list[float]:
    """A list of finite floats; empty for an empty one."""
    if not isinstance(value, np.ndarray):
        try:
            value = list(value)
        except TypeError:
            value = [value]
    return [finite(one, what) for one in value]


def finite(value: Any, what: str) -> float:
    """A finite float."""
    result = number(value, what)
    if not np.isfinite(result):
        raise ValueError(f"{what} is {result}; it must be finite")
    return result


# ---- matrices ------------------------------------------------------------------------------------


def csc(value: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Data, rows and column starts of a sparse matrix, in the engine's types."""
    matrix = value.tocsc()
    if matrix.dtype.kind not in "fiu" or matrix.dtype == np.float32:
        raise TypeError(f"jac returned dtype {matrix.dtype}; arclen needs float64")
    return (
        np.ascontiguousarray(matrix.data, dtype=np.float64),
        np.ascontiguousarray(matrix.indices, dtype=np.int64),
        np.ascontiguousarray(matrix.indptr, dtype=np.int64),
    )


def jacobian(jac: Callable[..., Any], n: int) -> Callable[..., Any]:
    """The user's Jacobian, returning what the engine reads."""

    def call(u: np.ndarray, p: np.ndarray) -> Any:
        value = jac(u, p)
        if type(value) is np.ndarray and value.dtype == np.float64 and value.ndim == 2:
            return value
        return matrix(value, n)

    return call


def matrix(value: Any, n: int) -> Any:
    """A dense array of two dimensions, or the parts of a sparse one, of what `jac` returned."""
    if is_sparse(value):
        if value.shape != (n, n):
            raise ValueError(f"jac returned a matrix of shape {value.shape}, expected ({n}, {n})")
        return csc(value)
    try:
        array = np.asarray(value)
    except Exception as error:
        raise TypeError(f"jac must return a matrix of {n} rows: {error}") from None
    if array.dtype.kind not in "fiu" or array.dtype.itemsize < 8 and array.dtype.kind == "f":
        raise TypeError(f"jac returned dtype {array.dtype}; arclen needs float64")
    if array.ndim == 0 and n == 1:
        array = array.reshape(1, 1)
    if array.shape != (n, n):
        raise ValueError(f"jac returned an array of shape {array.shape}, expected ({n}, {n})")
    return np.asarray(array, dtype=np.float64)


def derivative(function: Any, names: list[str]) -> Callable[..., Any]:
    """The derivatives by the parameters, called with the number of one."""
    if callable(function):

        def call(u: np.ndarray, p: np.ndarray, which: int) -> Any:
            value = np.asarray(function(u, p))
            if value.ndim == 1 and len(names) == 1:
                return value
            if value.ndim != 2 or value.shape[1] != len(names):
                raise ValueError(
                    f"parameter_derivative returned shape {value.shape}, "
                    f"expected ({u.size}, {len(names)}): a column for each parameter"
                )
            return np.ascontiguousarray(value[:, which])

        return call
    raise TypeError(f"parameter_derivative: {function!r} cannot be called")


Pattern = Any  # None (dense), (below, above), or (rows, columns)


def pattern(sparsity: Any, n: int) -> Pattern:
    """The pattern of a Jacobian as the engine wants it; banded where the band is narrow."""
    if isinstance(sparsity, (numbers.Integral, np.integer)) and not isinstance(sparsity, bool):
        sparsity = (int(sparsity), int(sparsity))
    if (
        isinstance(sparsity, (tuple, list))
        and len(sparsity) == 2
        and all(isinstance(k, (numbers.Integral, np.integer)) for k in sparsity)
        and not any(isinstance(k, bool) for k in sparsity)
    ):
        below, above = int(sparsity[0]), int(sparsity[1])
        if below < 0 or above < 0:
            raise ValueError(f"sparsity={sparsity!r}: numbers of diagonals are not negative")
        return (min(below, n), min(above, n))
    if is_sparse(sparsity):
        coo = sparsity.tocoo()
        shape, rows, columns = coo.shape, coo.row, coo.col
    else:
        try:
            array = np.asarray(sparsity)
        except Exception as error:
            raise TypeError(f"sparsity: {error}") from None
        if array.dtype.kind not in "fiub" or array.ndim != 2:
            raise TypeError(
                "sparsity: give a half-bandwidth, (below, above), a sparse matrix or an array of "
                f"shape ({n}, {n}) that is not zero where the Jacobian may be"
            )
        shape = array.shape
        rows, columns = np.nonzero(array)
    if shape != (n, n):
        raise ValueError(f"sparsity: shape {shape}; the Jacobian has ({n}, {n})")
    return (np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64))


def union(one: Pattern, rows: np.ndarray, columns: np.ndarray) -> Pattern:
    """A pattern with further entries; dense stays dense."""
    if one is None:
        return None
    if isinstance(one[0], int):
        if rows.size == 0:
            return one
        below = max(one[0], int((rows - columns).max()))
        above = max(one[1], int((columns - rows).max()))
        return (below, above)
    return (np.concatenate([one[0], rows]), np.concatenate([one[1], columns]))


def narrow(one: Pattern, n: int) -> Pattern:
    """A band in place of a sparse pattern where it holds little more and is faster."""
    if one is None or isinstance(one[0], int):
        return one
    rows, columns = one
    if rows.size == 0:
        return (0, 0)
    keys = np.unique(columns * n + rows)
    rows, columns = keys % n, keys // n
    below = max(int((rows - columns).max()), 0)
    above = max(int((columns - rows).max()), 0)
    # a band is factored several times as fast as a sparse matrix of as many entries
    if n * (2 * below + above + 1) <= 6 * rows.size:
        return (below, above)
    return (rows, columns)


def mass(value: Any, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Rows, columns and values of a mass matrix."""
    if value is None:
        return None
    if is_sparse(value):
        coo = value.tocoo()
        shape, rows, columns, data = coo.shape, coo.row, coo.col, coo.data
    else:
        try:
            array = np.asarray(value)
        except Exception as error:
            raise TypeError(f"mass: {error}") from None
        if array.ndim == 1:
            shape = (array.size, array.size)
            rows = columns = np.arange(array.size)
            data = array
        elif array.ndim == 2:
            shape = array.shape
            rows, columns = np.nonzero(array)
            data = array[rows, columns]
        else:
            raise ValueError(f"mass: shape {array.shape}; it is a matrix or its diagonal")
    if shape != (n, n):
        raise ValueError(f"mass: shape {shape}; the problem has {n} unknowns")
    return (
        np.asarray(rows, dtype=np.int64),
        np.asarray(columns, dtype=np.int64),
        vector(data, "mass") if np.size(data) else np.zeros(0),
    )


def names(names: Any, what: str) -> list[str]:
    try:
        result = list(names)
    except TypeError:
        raise TypeError(f"{what}: {names!r} is not a list of names") from None
    for name in result:
        if not isinstance(name, str):
            raise TypeError(f"{what}: {name!r} is not a name")
        if not name or name in ("s", "dp_ds", "unstable", "certified") or name.startswith("u["):
            raise ValueError(f"{what}: {name!r} cannot be a name: it is empty, or a column's")
        if result.count(name) > 1:
            raise ValueError(f"{what}: {name!r} occurs twice")
    return result


def count(value: Any, what: str) -> int:
    value = index(value, what)
    if not 0 <= value < 2**53:
        raise ValueError(f"{what} is {value}; it must not be negative, nor beyond 2**53")
    return value


def states(value: Any, what: str) -> list[Any]:
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"{what}: {value!r} is not a list of arrays") from None


def progress(progress: Any) -> Callable[..., Any] | None:
    """What is called after every point."""
    if progress is None or progress is False:
        return None
    if callable(progress):
        return progress
    if progress is not True:
        raise TypeError(f"progress: {progress!r} is neither a bool nor callable")
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    bar = tqdm(unit=" points")

    def update(points: int, events: int, p: float, s: float) -> bool:
        bar.update(points - bar.n)
        bar.set_postfix(events=events, p=f"{p:.6g}", refresh=False)
        return False

    return update


def fit_progress(progress: Any) -> Callable[[str, float], Any] | None:
    """What is told how far a fit is."""
    if progress is None or progress is False:
        return None
    if callable(progress):
        return progress
    if progress is not True:
        raise TypeError(f"progress: {progress!r} is neither a bool nor callable")
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    bar = tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed} {postfix}")

    def update(stage: str, share: float) -> bool:
        # the next of several curves begins anew
        if 100 * share < bar.n:
            bar.reset()
        bar.set_postfix_str(stage, refresh=False)
        bar.update(100 * share - bar.n)
        return False

    update.close = bar.close  # type: ignore[attr-defined]
    return update


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Replaces a file at once, so that nobody reads half of it."""
    folder, name = os.path.split(os.fspath(path))
    part = os.path.join(folder, f".{name}.part")
    with open(part, "wb") as file:
        file.write(content)
    os.replace(part, path)

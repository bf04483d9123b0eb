"""Sweeps on any executor, kept in the files of ``arclen sweep``."""

from __future__ import annotations

import concurrent.futures
import functools
import io
import os
import uuid
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arclen
from ._study import _columns

if TYPE_CHECKING:
    import pandas


class Study:
    """The cases of a sweep that are kept in a folder.

    Attributes
    ----------
    name : str
    out : str
        The folder; ``arclen sweep FILE --out DIR`` goes on from it and writes its tables.
    keys : list of str
        What varies.
    records : list of dict
        How each case went: ``case``, ``status``, ``reason``, ``stopped_because``, ``points`` and more.
    lost : dict
        Numbers of cases whose worker died or raised each time, with the exception. They are not kept: the
        same study runs them again.
    """

    def __init__(self, raw: _arclen.RawSweep, out: str, lost: dict[int, BaseException]) -> None:
        self._raw = raw
        self.name: str = raw.name
        self.out = out
        self.keys: list[str] = raw.keys
        self.records: list[dict[str, Any]] = raw.records(out)
        self.lost = lost

    def values(self, case: int) -> dict[str, Any]:
        """What varies, in a case."""
        return dict(zip(self.keys, self._raw.values(case)))

    @functools.cached_property
    def curves(self) -> dict[str, np.ndarray]:
        """The points of all cases: columns, with the case and its values in front."""
        return _arrays(self._raw.tables(self.out)[0])

    @functools.cached_property
    def events(self) -> dict[str, np.ndarray]:
        """The special points of all cases, likewise."""
        return _arrays(self._raw.tables(self.out)[1])

    def to_pandas(self) -> pandas.DataFrame:
        """The points of all cases as a table. Needs pandas."""
        import pandas

        return pandas.read_csv(io.StringIO(self._raw.tables(self.out)[0]))

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        lost = f", {len(self.lost)} lost" if self.lost else ""
        return f"<Study {self.name}: {len(self)} of {len(self._raw)} cases{lost}>"


def _arrays(text: str) -> dict[str, np.ndarray]:
    return {name: np.asarray(values) for name, _, _, values in _columns(text)}


@functools.lru_cache(maxsize=4)
def _sweep(path: str, changed: float, shard: str | None) -> _arclen.RawSweep:
    return _arclen.RawSweep(path, shard)


def _run(
    path: str, changed: float, case: int, out: str, shard: str | None = None, attempt: str = ""
) -> int:
    """Runs and keeps a case; in a worker.

    `attempt` makes each call another one: an executor such as Dask's takes equal calls for one, and would answer the
    second with the failure of the first.
    """
    _sweep(path, changed, shard).run(case, out)
    return case


def study(
    sweep: str | os.PathLike[str],
    executor: concurrent.futures.Executor | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    shard: str | None = None,
    progress: Callable[[int, int], Any] | None = None,
) -> Study:
    """Computes a sweep on an executor, and keeps each case as it arrives.

    Cases that the folder holds already are not computed again, whoever computed them: a study, the program
    or a shard of either. Those whose worker died or raised are run once more, one at a time.

    Parameters
    ----------
    sweep : str or path
        A sweep file, or a shipped sweep by its name.
    executor : concurrent.futures.Executor, optional
        Threads, processes, loky, ``dask.distributed.Client.get_executor()``, mpi4py: its workers must see
        the sweep file and the folder. By default a thread for each processor, which is enough on one
        machine: cases are computed without the interpreter's lock.
    out : str or path, optional
        The folder; by default ``arclen-out/NAME``, of a shard ``arclen-out/NAME-k-of-n``.
    shard : str, optional
        ``"k/n"`` computes the k-th of n shares of the cases alone, into a folder of its own;
        ``arclen.main(["merge", *folders])`` unites them.
    progress : callable, optional
        Called after each case with the numbers of cases that are done and of all.

    Returns
    -------
    Study

    Raises
    ------
    ValueError
        When something is wrong with the sweep, or the folder is of another one.
    """
    path = os.fspath(sweep)
    is_file = os.path.exists(path)
    path = os.path.abspath(path) if is_file else path
    changed = os.path.getmtime(path) if is_file else 0.0
    raw = _arclen.RawSweep(path, shard)
    place = f"arclen-out/{raw.name}{raw.suffix}" if out is None else os.fspath(out)
    folder = os.path.abspath(place)
    waiting = raw.begin(folder)
    lost: dict[int, BaseException] = {}
    done = len(raw) - len(waiting)

    def take(case: int, future: concurrent.futures.Future[int]) -> None:
        nonlocal done
        error = future.exception()
        if error is None:
            done += 1
            lost.pop(case, None)
            if progress is not None:
                progress(done, len(raw))
        else:
            lost[case] = error

    def submit(pool: concurrent.futures.Executor, cases: list[int]) -> None:
        attempt = uuid.uuid4().hex
        futures: dict[concurrent.futures.Future[int], int] = {}
        for case in cases:
            try:
                futures[pool.submit(_run, path, changed, case, folder, shard, attempt)] = case
            except concurrent.futures.BrokenExecutor as error:
                lost[case] = error
        for future in concurrent.futures.as_completed(futures):
            take(futures[future], future)

    own = executor is None
    pool = executor or concurrent.futures.ThreadPoolExecutor(os.cpu_count())
    try:
        submit(pool, waiting)
        for case in sorted(lost):
            if isinstance(lost[case], concurrent.futures.BrokenExecutor):
                # a pool does not survive the death of a worker: each case gets one of its own
                with concurrent.futures.ProcessPoolExecutor(1) as single:
                    submit(single, [case])
            else:
                submit(pool, [case])
    finally:
        if own:
            pool.shutdown(cancel_futures=True)
    return Study(raw, folder, lost)

"""Sweeps on executors: the same files whoever computes them, and nothing lost when workers die."""

import concurrent.futures
import json
import multiprocessing
import os
import shutil
import signal
import subprocess

import numpy as np
import pytest

import arclen
from arclen import _sweep

SWEEP = """
problem = "contact"

[shell]
law = "hooke"
poisson = 0.5

[dimensionless]
bending = 3e-3
pressure = 3e-3
adhesion = 2e-4
film = 0.0333

[mesh]
elements = 40

[path]
start = 1.15
end = 1.0

[stability]
scan = "axisymmetric"

[[vary]]
key = "dimensionless.adhesion"
values = [1e-4, 2e-4, 3e-4, 4e-4]
"""


@pytest.fixture
def sweep(tmp_path):
    path = tmp_path / "films.toml"
    path.write_text(SWEEP)
    return path


def files(folder):
    """What is kept, without the times that the cases took."""
    study = arclen.study(folder.parent / "films.toml", out=folder)
    return [{**record, "seconds": 0} for record in study.records], study.curves["force"]


def processes(workers):
    # workers that are not copies of a process with threads
    context = multiprocessing.get_context("spawn")
    return concurrent.futures.ProcessPoolExecutor(workers, mp_context=context)


def test_threads_and_processes_compute_the_same(sweep, tmp_path):
    done = []
    study = arclen.study(sweep, out=tmp_path / "threads", progress=lambda *at: done.append(at))
    assert len(study) == 4 and not study.lost and sorted(done) == [(k, 4) for k in range(1, 5)]
    assert study.keys == ["dimensionless.adhesion"]
    assert study.values(2) == {"dimensionless.adhesion": 3e-4}
    assert {record["status"] for record in study.records} == {"finished"}
    force = arclen.trace(_case(3e-4))["force"]
    assert np.array_equal(study.curves["force"][study.curves["case"] == 2], force, equal_nan=True)
    with processes(2) as pool:
        arclen.study(sweep, pool, tmp_path / "processes")
    threads, others = files(tmp_path / "threads"), files(tmp_path / "processes")
    assert threads[0] == others[0] and np.array_equal(threads[1], others[1], equal_nan=True)


def _case(adhesion):
    return {
        "problem": "contact",
        "shell": {"law": "hooke", "poisson": 0.5},
        "dimensionless": {
            "bending": 3e-3,
            "pressure": 3e-3,
            "adhesion": adhesion,
            "film": 0.0333,
        },
        "mesh": {"elements": 40},
        "path": {"start": 1.15, "end": 1.0},
        "stability": {"scan": "axisymmetric"},
    }


def test_kept_cases_are_not_computed_again(sweep, tmp_path):
    raw = _sweep._arclen.RawSweep(str(sweep))
    out = str(tmp_path / "out")
    assert raw.begin(out) == [0, 1, 2, 3]
    raw.run(1, out)
    done = []
    arclen.study(sweep, out=out, progress=lambda *at: done.append(at))
    assert len(done) == 3 and raw.begin(out) == []
    with pytest.raises(ValueError, match="other|differ"):
        other = tmp_path / "other.toml"
        other.write_text(SWEEP.replace("4e-4]", "5e-4]"))
        arclen.study(other, out=out)


class Deadly(concurrent.futures.Executor):
    """Processes, of which some die: at their first case, or at a certain one always."""

    def __init__(self, always):
        self.pool = processes(1)
        self.always = always

    def submit(self, function, *arguments):
        return self.pool.submit(run_or_die, self.always, *arguments)


def run_or_die(always, path, changed, case, *arguments):
    if case == always:
        os.kill(os.getpid(), signal.SIGKILL)
    return _sweep._run(path, changed, case, *arguments)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_killed_worker_costs_nothing(sweep, tmp_path):
    pool = Deadly(always=1)
    study = arclen.study(sweep, pool, tmp_path / "out")
    assert len(study) == 4 and not study.lost
    arclen.study(sweep, out=tmp_path / "undisturbed")
    disturbed, other = files(tmp_path / "out"), files(tmp_path / "undisturbed")
    assert disturbed[0] == other[0] and np.array_equal(disturbed[1], other[1], equal_nan=True)


def test_a_case_that_always_fails_is_reported(sweep, tmp_path):
    class Failing(concurrent.futures.ThreadPoolExecutor):
        def submit(self, function, path, changed, case, *arguments):
            if case == 2:
                return super().submit(int, "no number")
            return super().submit(function, path, changed, case, *arguments)

    with Failing(2) as pool:
        study = arclen.study(sweep, pool, tmp_path / "out")
    assert len(study) == 3 and list(study.lost) == [2]
    assert isinstance(study.lost[2], ValueError)
    assert len(arclen.study(sweep, out=tmp_path / "out")) == 4


@pytest.mark.skipif(not os.environ.get("ARCLEN"), reason="ARCLEN is not the path of the program")
def test_the_program_goes_on_from_a_study(sweep, tmp_path):
    program = shutil.which(os.environ["ARCLEN"])
    out = tmp_path / "out"
    raw = _sweep._arclen.RawSweep(str(sweep))
    raw.begin(str(out))
    raw.run(0, str(out))
    command = [program, "sweep", sweep, "--out", out, "--json"]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    json.loads(run.stdout)
    assert raw.begin(str(out)) == []
    study = arclen.study(sweep, out=out)
    assert len(study) == 4
    written = (out / "curves.csv").read_text()
    assert study._raw.tables(study.out)[0] == written


def test_errors_of_sweeps(tmp_path):
    with pytest.raises(ValueError, match="phase"):
        arclen.study("phases")
    (tmp_path / "bad.toml").write_text(SWEEP.replace('adhesion"', 'adhesoin"'))
    with pytest.raises(ValueError, match="adhesoin"):
        arclen.study(tmp_path / "bad.toml")


def test_shards_unite(sweep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shares = [arclen.study(sweep, shard=f"{k}/3") for k in (1, 2, 3)]
    assert [len(share) for share in shares] == [2, 1, 1]
    folders = [share.out for share in shares]
    assert folders[0].endswith("arclen-out/films-1-of-3")
    assert arclen.main(["merge", *folders, "--out", "all", "--quiet"]) == 0
    assert len(json.loads((tmp_path / "all/sweep.json").read_text())["cases"]) == 4
    with pytest.raises(ValueError, match='shard="4/3": expected k/n'):
        arclen.study(sweep, shard="4/3")


def test_a_case_with_keys_that_vary(sweep, tmp_path):
    case = arclen.Case(_case(1e-4))
    study = case.sweep({"adhesion": [1e-4, 2e-4, 3e-4, 4e-4]}, out=tmp_path / "out")
    assert study.keys == ["dimensionless.adhesion"] and len(study) == 4
    arclen.study(sweep, out=tmp_path / "file")
    force = arclen.study(sweep, out=tmp_path / "file").curves["force"]
    assert np.array_equal(study.curves["force"], force, equal_nan=True)
    # the sweep is a file of the program beside what it gave
    again = arclen.study(tmp_path / "out" / "sweep.toml", out=tmp_path / "out")
    assert again.records == study.records
    grid = case.sweep(
        {"bending": {"from": 1e-3, "to": 1e-2, "count": 2, "scale": "log"}, "law": ["hooke"]},
        out=tmp_path / "grid",
    )
    assert [grid.values(k)["dimensionless.bending"] for k in range(2)] == [1e-3, 1e-2]
    for wrong in ({}, 3, None):
        with pytest.raises(TypeError):
            case.sweep(wrong)
    with pytest.raises(ValueError, match="adhesoin"):
        case.sweep({"adhesoin": [1.0]}, out=tmp_path / "bad")

"""Studies on Dask: workers die, and nothing is lost."""

import os
import signal

import numpy as np
import pytest

import arclen
from arclen import _sweep

distributed = pytest.importorskip("distributed")

SWEEP = """
problem = "bratu"
[mesh]
elements = 40
[[vary]]
key = "path.end"
from = 1.0
to = 3.0
count = 200
"""


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    path = tmp_path_factory.mktemp("dask") / "ends.toml"
    path.write_text(SWEEP)
    return path


@pytest.fixture(scope="module")
def client():
    import dask

    # each death counts, and workers come back quickly
    settings = {
        "distributed.scheduler.allowed-failures": 0,
        "distributed.comm.timeouts.connect": 20,
    }
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def kept(study):
    return [{**record, "seconds": 0} for record in study.records], study.curves["point"]


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_killed_worker_costs_nothing(sweep, client, tmp_path):
    pids = list(client.run(os.getpid).values())
    done = []

    def progress(count, total):
        done.append(count)
        if count == 40:
            os.kill(pids[0], signal.SIGKILL)

    study = arclen.study(sweep, client.get_executor(), tmp_path / "out", progress=progress)
    assert len(study) == 200 and not study.lost
    assert done[-1] == 200
    undisturbed = arclen.study(sweep, out=tmp_path / "undisturbed")
    (records, points), (expected, others) = kept(study), kept(undisturbed)
    assert records == expected and np.array_equal(points, others)


class Deadly:
    """An executor on which one case kills each worker that takes it."""

    def __init__(self, executor):
        self.executor = executor

    def submit(self, function, path, changed, case, *arguments):
        return self.executor.submit(run_or_die, path, changed, case, *arguments)


def run_or_die(path, changed, case, *arguments):
    if case == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return _sweep._run(path, changed, case, *arguments)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_case_that_always_kills_its_worker_is_reported(sweep, client, tmp_path):
    client.wait_for_workers(2, timeout=60)
    study = arclen.study(sweep, Deadly(client.get_executor()), tmp_path / "out")
    assert list(study.lost) == [7] and len(study) == 199
    assert isinstance(study.lost[7], distributed.KilledWorker)


def test_the_job_script_for_slurm():
    jobqueue = pytest.importorskip("dask_jobqueue")
    with jobqueue.SLURMCluster(
        cores=16, processes=16, memory="32GB", walltime="02:00:00", queue="compute",
        job_extra_directives=["--job-name=films"], scheduler_options={"dashboard_address": None},
    ) as cluster:  # fmt: skip
        script = cluster.job_script()
    for line in ("#SBATCH --job-name=films", "#SBATCH -p compute", "#SBATCH -t 02:00:00"):
        assert line in script
    assert "--nworkers 16" in script and "--nthreads 1" in script

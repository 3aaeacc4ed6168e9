"""A sweep whose driver or workers are killed, or whose disk fills up, ends with the same bits once it is resumed.

The moments of interruption come from seeded generators and count completed chunks, so a slow machine changes nothing.
"""

import logging
import os
import random
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from stored import files

from numeric.sweeps.run import run
from numeric.sweeps.space import parameter_space
from verification.app.cli import main

ROOT = Path(__file__).parents[3]
PARTS = 12
GRID = ["parameter-space", "--alphas", f"0.07:0.1:{PARTS}", "--lams", "0.3:0.6:3"]
SPACE = [*GRID, "--starts", "4", "--bounces", "400"]
SECONDS = [*GRID, "--starts", "64", "--bounces", "160000"]  # so long that an interruption is never too late


def started(arguments, prepare=None):
    """Starts a sweep that reacts to Ctrl-C, even where a background shell makes its tests ignore that signal."""
    command = [sys.executable, "-m", "verification", "sweep", *arguments]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}

    def prepared():
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        if prepare is not None:
            prepare()

    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, cwd=ROOT, env=environment, preexec_fn=prepared, **pipes)


def chunks(store):
    return len(list((store / "nu_min" / "c").rglob("0")))


def reached(process, store, count):
    """Waits until so many chunks are stored or the process has ended; returns whether it still runs."""
    while chunks(store) < count and process.poll() is None:
        time.sleep(0.002)
    return process.poll() is None


def stop(process, number=signal.SIGKILL):
    process.send_signal(number)
    return process.communicate()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The files of a sweep that ran undisturbed."""
    store = tmp_path_factory.mktemp("whole") / "store"
    assert main(["sweep", *SPACE, "--store", str(store)]) == 0
    return files(store)


@pytest.mark.slow
def test_a_driver_killed_at_random_moments_ends_with_the_same_bits(whole, tmp_path):
    store, rng = tmp_path / "store", random.Random(5)
    killed = []
    for _ in range(2):
        process = started([*SPACE, "--store", str(store)])
        last = PARTS - 1  # which a quick one may have passed before it was killed
        if reached(process, store, rng.randint(min(chunks(store) + 1, last), last)):
            time.sleep(rng.uniform(0, 0.02))  # in the middle of whatever comes next
        stop(process)
        killed.append(chunks(store))

    assert 0 < killed[0] <= killed[1]
    assert main(["sweep", *SPACE, "--store", str(store)]) == 0
    assert files(store) == whole


@pytest.mark.slow
def test_an_interrupted_sweep_says_how_to_go_on(tmp_path):
    store, undisturbed = tmp_path / "store", tmp_path / "undisturbed"
    process = started([*SECONDS, "--store", str(store), "--workers", "1"])
    assert reached(process, store, 1)
    out, said = stop(process, signal.SIGINT)

    assert (process.returncode, out) == (130, "")
    assert said.startswith("pinball: interrupted; ")
    assert said.endswith(f" of {PARTS} parts are in {store}, and the same command goes on from there\n")
    assert all(main(["sweep", *SECONDS, "--store", str(place)]) == 0 for place in (store, undisturbed))
    assert files(store) == files(undisturbed)


STORING = ["parameter-space", "--alphas", "0:0.1:401", "--lams", "0.3:0.6:3", "--starts", "1", "--bounces", "8"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_ctrl_c_while_results_are_stored_is_one_sentence(tmp_path, seed):
    """The parts take no time, so nearly all of the run stores results: Ctrl-C falls into a random write."""
    store, draw = tmp_path / "store", random.Random(seed)
    process = started([*STORING, "--transient", "0", "--store", str(store)])
    assert reached(process, store, draw.randrange(1, 40))
    time.sleep(draw.uniform(0, 0.02))
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]

    assert process.returncode == 130
    assert said.count("\n") == 1
    assert f"of 401 parts are in {store}, and the same command goes on from there" in said
    assert list(store.rglob("*.partial")) == []


@pytest.mark.slow
def test_a_limit_on_files_is_met_with_one_sentence(tmp_path):
    diagram = ["bifurcation", "circle", "--lams", "0.1:0.9:3", "--orbits", "20", "--points", "500", "--bounces", "8"]
    arguments = [*diagram, "--transient", "0", "--store", str(tmp_path / "store")]
    process = started(arguments, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000)))
    out, said = process.communicate()

    assert (process.returncode, out) == (1, "")
    assert said.startswith("pinball: a file would be too large; 0 of 1 parts are in ")
    assert list((tmp_path / "store").rglob("*.partial")) == []
    assert main(["sweep", *arguments]) == 0
    assert xr.open_zarr(tmp_path / "store").s.notnull().all()


@pytest.fixture(scope="module")
def cluster():
    """A Dask scheduler with two worker processes."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
        host="127.0.0.1",
    ) as cluster:
        yield cluster


@pytest.mark.slow
def test_a_cluster_finds_the_same_bits_also_when_a_worker_is_killed(whole, cluster, tmp_path):
    store, rng = tmp_path / "store", random.Random(7)

    def kill(moment):
        while chunks(store) < moment:
            time.sleep(0.002)
        os.kill(cluster.workers[0].pid, signal.SIGKILL)

    killer = threading.Thread(target=kill, args=(rng.randint(1, PARTS // 2),))
    killer.start()
    assert main(["sweep", *SPACE, "--store", str(store), "--scheduler", cluster.scheduler_address]) == 0
    killer.join()

    assert files(store) == whole


@pytest.mark.slow
def test_a_driver_of_a_cluster_may_be_killed(whole, cluster, tmp_path):
    store, rng = tmp_path / "store", random.Random(11)
    arguments = [*SPACE, "--store", str(store), "--scheduler", cluster.scheduler_address]
    process = started(arguments)
    reached(process, store, rng.randint(1, PARTS // 2))
    stop(process)

    assert chunks(store) > 0
    assert main(["sweep", *arguments]) == 0
    assert files(store) == whole


def test_a_task_that_fails_on_a_worker_is_told(cluster):
    sweep = parameter_space(np.array([0.09, 0.2]), np.array([0.5]), starts=2, bounces=80)

    with pytest.raises(ValueError, match="alpha must lie in"):
        run(sweep, scheduler=cluster.scheduler_address)


@pytest.mark.slow
@pytest.mark.parametrize("address", ["nowhere", "tcp://127.0.0.1:1"])
def test_a_scheduler_that_is_not_there_is_told(address, capsys):
    assert main(["sweep", *SPACE, "--scheduler", address]) == 2
    assert f"--scheduler {address}: no Dask scheduler answers there; accepted: " in capsys.readouterr().err

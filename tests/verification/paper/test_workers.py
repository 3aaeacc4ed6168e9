"""Work in processes: all items are done, for any number of processes; a death is reported; Ctrl-C ends all."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import chain
from pathlib import Path

import pytest

from numeric.sweeps.workers import TRIES, Lost, in_processes
from verification.app.cli import main
from verification.app.commands.verify import Last, write_report
from verification.paper.claims.claim import seconds
from verification.paper.claims.folder import paper, recorded
from verification.paper.claims.sharing import shared_out
from verification.paper.report import report

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("jobs", [1, 3])
def test_every_item_is_answered_whatever_the_number_of_processes(jobs):
    tasks = [[1, 2, 3], [4], [5, 6], [7]]

    assert sorted(in_processes(float, tasks, jobs)) == [(n, float(n)) for n in range(1, 8)]


def test_a_process_that_dies_is_replaced_and_what_it_died_of_is_named():
    """Each item is a signal that a process sends to itself; 0 is no signal."""
    answers = list(in_processes(signal.raise_signal, [[0, signal.SIGKILL, 0], [0]], 1))

    assert [answer for _, answer in answers] == [None, Lost(-signal.SIGKILL), None, None]
    assert [item for item, _ in answers] == [0, signal.SIGKILL, 0, 0]
    assert str(answers[1][1]) == (
        f"the process that worked at it died {TRIES} times, at last of signal 9 (Killed); it may have run out of memory"
    )


def test_what_work_raises_is_raised_here_and_the_other_processes_end():
    answers = in_processes(time.sleep, [[60.0], [0.0, "a text"]], 2)
    assert next(answers) == (0.0, None)
    processes = multiprocessing.active_children()

    with pytest.raises(TypeError):
        list(answers)
    assert len(processes) == 2
    assert not any(process.is_alive() for process in processes)


def mark(path):
    """Creates an empty file, as the work of one item."""
    Path(path).touch()


def test_a_process_goes_on_with_the_next_task_while_its_answer_is_looked_at(tmp_path):
    first, second = str(tmp_path / "first"), str(tmp_path / "second")
    answers, latest = in_processes(mark, [[first], [second]], 1), time.monotonic() + 30

    assert next(answers) == (first, None)
    while not Path(second).exists() and time.monotonic() < latest:  # nobody asks for an answer meanwhile
        time.sleep(0.01)
    assert Path(second).exists()
    assert list(answers) == [(second, None)]


@pytest.mark.parametrize("jobs", [1, 2, 16])
def test_claims_that_share_results_are_judged_by_one_process_and_the_dearest_begin(jobs):
    claims = report.catalogue()
    groups = shared_out(claims, jobs)
    costs = [seconds(group) for group in groups]

    assert sorted(claim.id for group in groups for claim in group) == sorted(c.id for c in claims)
    assert costs == sorted(costs, reverse=True)
    known, spares = recorded(paper())
    assert set(known) <= {claim.id for claim in claims}
    assert {*spares, *chain.from_iterable(spares.values())} <= set(known)
    assert any(len(group) > 1 for group in groups)


def running(folder):
    """The numbers of the processes whose working directory is the folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            found += [int(process.name)] if (process / "cwd").readlink() == folder else []
        except OSError:
            continue
    return found


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/cwd").exists(), reason="processes are looked up in /proc")
@pytest.mark.parametrize("started", [4, 5])  # the command, two servants of multiprocessing, one worker or two
def test_ctrl_c_ends_every_process(tmp_path, started):
    command = [sys.executable, "-m", "verification", "verify", "--only", "egg.*", "--jobs", "2", "--no-figures"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 600
    while len(running(tmp_path)) < started and process.poll() is None:
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGINT)

    assert process.communicate(timeout=600)[1].endswith("pinball: interrupted\n")
    assert process.returncode == 130
    while running(tmp_path) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert running(tmp_path) == []


def test_ctrl_c_waits_while_processes_start_though_another_thread_hears_it():
    """A signal mask applies to one thread only, and libraries of linear algebra start threads of their own."""
    program = """
import os, signal, threading, time
from numeric.sweeps.workers import undisturbed
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Thread(target=time.sleep, args=(2,), daemon=True).start()
try:
    with undisturbed():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)
        print("started")
    print("not heard")
except KeyboardInterrupt:
    print("heard")
"""
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)

    assert run.stdout.split("\n")[:2] == ["started", "heard"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["map.A", "cuspless.lambda_c", "egg.alpha_hat"])
def test_a_judge_loads_no_module_that_its_digest_leaves_out(name):
    """Including imports inside functions, and names that a room's `__init__` loads when they are first used."""
    program = (
        "import sys; from verification.paper.report import report; before = set(sys.modules); "
        f"list(report.verify({name!r})); print(*(set(sys.modules) - before))"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {module for module in run.stdout.split() if module.partition(".")[0] in report.STOREYS}

    assert loaded
    assert loaded <= report.closure(next(claim.home for claim in report.catalogue() if claim.id == name))


def test_only_what_changed_is_judged_again(tmp_path, capsys):
    claims = [claim for claim in report.catalogue() if claim.id in ("ellipse.P1", "ellipse.P2")]
    results = [replace(report.judge(claim), seconds=0.5) for claim in claims]
    code = report.codes(claims, 15)
    write_report(tmp_path, results, (), {**code, "ellipse.P2": "another"})

    assert list(Last.read(tmp_path, claims, 15).results.values()) == [r for r in results if r.id != "ellipse.P2"]
    assert Last.read(tmp_path, claims, 16).results == {}
    write_report(tmp_path, results, (), code)
    assert main(["verify", "--only", "ellipse.P[12]", "--changed", "--no-figures", "--report", str(tmp_path)]) == 0
    assert "0 of 2 claims depend on code that has changed" in capsys.readouterr().out
    assert all(result.seconds == 0.5 for result in Last.read(tmp_path, claims, 15).results.values())


def test_a_report_that_is_none_is_refused_in_one_sentence(tmp_path, capsys):
    (tmp_path / "report.json").write_text("[]")

    assert main(["verify", "--changed", "--report", str(tmp_path)]) == 2
    assert "report.json is no report (AttributeError); remove it" in capsys.readouterr().err

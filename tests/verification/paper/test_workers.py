"""Work in processes: every item answered, in any number of them; one that dies is said; nothing outlives Ctrl-C."""

import gc
import multiprocessing
import operator
import os
import re
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
from verification.paper.claims.claim import Verdict, seconds
from verification.paper.claims.folder import paper, recorded
from verification.paper.claims.sharing import shared_out, sharing
from verification.paper.report import report

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("jobs", [1, 3])
def test_every_item_is_answered_whatever_the_number_of_processes(jobs):
    tasks = [[1, 2, 3], [4], [5, 6], [7]]

    assert sorted(in_processes(float, tasks, jobs)) == [(n, float(n)) for n in range(1, 8)]


def test_a_process_that_dies_is_replaced_and_what_it_died_of_is_named():
    """The items are signals that a process sends to itself; 0 is none."""
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


def test_processes_search_for_unused_cycles_as_rarely_as_the_one_that_asks_and_not_in_what_they_imported():
    before = gc.get_threshold()
    gc.set_threshold(12_345, 6, 7)
    try:
        found = dict(in_processes(operator.call, [[gc.get_threshold, gc.get_freeze_count]], 1))
    finally:
        gc.set_threshold(*before)

    assert found[gc.get_threshold] == (12_345, 6, 7)
    assert found[gc.get_freeze_count] > 1000


def mark(path):
    """Work that leaves a file behind."""
    Path(path).touch()


def test_a_process_goes_on_with_the_next_task_while_its_answer_is_looked_at(tmp_path):
    first, second = str(tmp_path / "first"), str(tmp_path / "second")
    answers, latest = in_processes(mark, [[first], [second]], 1), time.monotonic() + 30

    assert next(answers) == (first, None)
    while not Path(second).exists() and time.monotonic() < latest:  # nobody asks for an answer meanwhile
        time.sleep(0.01)
    assert Path(second).exists()
    assert list(answers) == [(second, None)]


@pytest.mark.skipif("forkserver" not in multiprocessing.get_all_start_methods(), reason="where nothing can fork")
def test_what_is_begun_early_is_what_processes_are_forked_of_and_is_imported_meanwhile():
    code = (
        "import sys; from multiprocessing.forkserver import _forkserver as server\n"
        "from numeric.sweeps import workers\n"
        "workers.begin(['tabnanny']); first = server._forkserver_pid\n"
        "asked = \"'tabnanny' in __import__('sys').modules\"\n"
        "(_, forked), = workers.in_processes(eval, [[asked]], 1, ['tabnanny'])\n"
        "print(forked, eval(asked), first == server._forkserver_pid)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)

    assert told.stdout.split() == ["True", "False", "True"]


SECONDS = re.compile(r"(?:\"seconds\": |seconds: |claims took |quiet\">)[\d.]+(?: s; [\d.]+ s with)?")


def files(folder):
    """The files of a report, without the seconds in them."""
    return {path.name: SECONDS.sub("", path.read_text()) for path in folder.iterdir()}


def test_the_report_does_not_depend_on_the_number_of_processes(tmp_path, monkeypatch):
    """Two sections, each with a figure."""
    monkeypatch.setattr(report, "SMALL", 0.0)
    for jobs in ("1", "2"):
        assert (
            main(["verify", "--only", "ellipse.[ls]*s[qt]*[2s]", "--jobs", jobs, "--report", str(tmp_path / jobs)]) == 0
        )

    one, two = files(tmp_path / "1"), files(tmp_path / "2")
    assert one["report.html"].count('<img src="data:image/') == 2
    assert one == two


def test_a_claim_whose_process_dies_is_open_and_says_so(monkeypatch):
    claims = report.catalogue()[1:3]
    lost, found = Lost(-9), report.judge(claims[1])
    monkeypatch.setattr(report, "SMALL", 0.0)
    monkeypatch.setattr(report, "in_processes", lambda *_: (pair for pair in zip(claims, (lost, found), strict=True)))

    first, second = report.judged(claims, 15, 2)
    assert (first.id, first.verdict) == (claims[0].id, Verdict.OPEN)
    assert first.method == f"not judged: {lost}"
    assert second == found


@pytest.mark.parametrize("jobs", [1, 2])
def test_claims_are_told_in_the_catalogues_order_whatever_order_they_are_judged_in(monkeypatch, jobs):
    def backwards(claims, digits, jobs):
        yield from (report.judge(claim) for claim in (claims if jobs == 1 else claims[::-1]))

    wanted = [claim.id for claim in report.catalogue() if claim.id.startswith("ellipse.P")]
    monkeypatch.setattr(report, "judged", report.judged if jobs == 1 else backwards)

    assert [result.id for result in report.verify("ellipse.P*", jobs=jobs)] == wanted
    assert len(wanted) > 3


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


def test_the_fewer_processes_the_more_stays_together():
    def claim(name, seconds, **spares):
        return replace(report.catalogue()[0], id=name, seconds=seconds, home=name, spares=tuple(spares.items()))

    claims = [claim("a", 4.0, b=0.5), claim("b", 4.0, c=2.0), claim("c", 2.0), claim("d", 10.0)]

    def together(jobs):
        return [[each.id for each in group] for group in sharing(claims, jobs)]

    assert together(1) == [["a"], ["b", "c"], ["d"]]  # with a they would be half of all, and spare a twentieth of it
    assert together(4) == [["a"], ["b", "c"], ["d"]]  # more than a process's share, but a third of it is spared
    assert together(1 / 2) == [["a", "b", "c"], ["d"]]
    assert [[c.id for c in group] for group in shared_out(claims, 1 / 2)] == [["a", "b", "c"], ["d"]]


def test_small_claims_of_one_module_go_in_handfuls():
    first = report.catalogue()[0]
    claims = [replace(first, id=f"{home}{n}", seconds=1.0, home=home) for n in range(100) for home in "xy"]

    groups = shared_out(claims, 2)

    assert all(len({claim.home for claim in group}) == 1 for group in groups)
    assert {len(group) for group in groups[:-2]} == {12}  # of a process's hundred seconds
    assert shared_out(claims, 400) == [[claim] for claim in claims]


def running(folder):
    """The processes that work in a folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            found += [int(process.name)] if (process / "cwd").readlink() == folder else []
        except OSError:
            continue
    return found


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
    """A mask binds one thread; libraries of linear algebra start threads of their own."""
    program = """
import os, signal, threading, time
from numeric.sweeps.workers import _undisturbed
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Thread(target=time.sleep, args=(2,), daemon=True).start()
try:
    with _undisturbed():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)
        print("started")
    print("not heard")
except KeyboardInterrupt:
    print("heard")
"""
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)

    assert run.stdout.split("\n")[:2] == ["started", "heard"]


@pytest.mark.parametrize("name", ["map.A", "cuspless.lambda_c", "egg.alpha_hat"])
def test_a_judge_loads_no_module_that_its_digest_leaves_out(name):
    """Imports inside functions and names that a room hands out when asked are followed as well."""
    program = (
        "import sys; from verification.paper.report import report; before = set(sys.modules); "
        f"list(report.verify({name!r})); print(*(set(sys.modules) - before))"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {module for module in run.stdout.split() if module.partition(".")[0] in report.STOREYS}

    assert loaded
    assert loaded <= report.closure(next(claim.home for claim in report.catalogue() if claim.id == name))


def test_a_digest_changes_with_every_module_that_a_judge_can_load_and_with_no_other(monkeypatch):
    claims = [claim for claim in report.catalogue() if claim.id in ("ellipse.P1", "cuspless.corner_orbit")]
    before = report.codes(claims, 15)
    texts = dict(report.sources())
    texts["verification.proofs.corner.corner"] += "\n# another text\n"
    monkeypatch.setattr(report, "sources", lambda: texts)
    report.digest.cache_clear()
    after = report.codes(claims, 15)
    report.digest.cache_clear()

    assert after["ellipse.P1"] == before["ellipse.P1"]
    assert after["cuspless.corner_orbit"] != before["cuspless.corner_orbit"]
    assert report.codes(claims, 16)["ellipse.P1"] != before["ellipse.P1"]


def test_only_what_changed_is_judged_again(tmp_path, monkeypatch, capsys):
    claims = [claim for claim in report.catalogue() if claim.id in ("ellipse.P1", "ellipse.P2")]
    results = [replace(report.judge(claim), seconds=0.5) for claim in claims]
    code = report.codes(claims, 15)
    write_report(tmp_path, results, (), {**code, "ellipse.P2": "another"})

    assert list(Last.read(tmp_path, claims, 15).results.values()) == [r for r in results if r.id != "ellipse.P2"]
    assert Last.read(tmp_path, claims, 16).results == {}
    monkeypatch.setattr(report, "judge", lambda claim, digits: pytest.fail(f"{claim.id} was judged"))
    write_report(tmp_path, results, (), code)
    assert main(["verify", "--only", "ellipse.P[12]", "--changed", "--no-figures", "--report", str(tmp_path)]) == 0
    assert "0 of 2 claims depend on code that has changed" in capsys.readouterr().out


def test_a_report_that_is_none_is_refused_in_one_sentence(tmp_path, capsys):
    (tmp_path / "report.json").write_text("[]")

    assert main(["verify", "--changed", "--report", str(tmp_path)]) == 2
    assert "report.json is no report (AttributeError); remove it" in capsys.readouterr().err


def test_a_section_is_asked_for_by_its_number(capsys):
    assert main(["verify", "--section", "17"]) == 2
    assert "--section '17' has no claim; accepted: Abstract, 1" in capsys.readouterr().err

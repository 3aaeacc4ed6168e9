"""A folder with another paper's claims: verified like the package's own paper, or refused in one sentence."""

import json
import re
import sys
from pathlib import Path

import pytest
from asking import refusal

from verification import verify
from verification.app.cli import main
from verification.paper.claims.claim import Verdict
from verification.paper.claims.folder import OWN, SHIPPED, begin, judge_of, paper
from verification.paper.report import report
from verification.paper.report.report import codes

OTHERS = sorted(path.parent.name for path in SHIPPED.glob("*/paper.toml") if path.parent.name != OWN)

PAPER = """
title = "Two numbers"
authors = ["N. N."]
citation = "nowhere"
letters = ["q"]

[sections]
"Thirds" = "a source of its own"
"Squares" = ""

[[claim]]
id = "x.square"
section = "Squares"
quote = "$(q+1)^2$"
printed = "q^2 + 2*q + 1"

[[claim]]
id = "x.half"
section = "Thirds"
quote = "$q/3$"
printed = "q/3"

[[claim]]
id = "circle.exit_angle"
section = "Thirds"
quote = "$q$"
printed = "2*q"
"""
JUDGES = """
import os

from sympy import Symbol

from verification.paper.claims.judges import identity, judges

q = Symbol("q", real=True)


@judges("x.square")
def square(claim):
    return identity(claim, (q + 1) ** 2)


@judges(
    "x.half", 'circle.exit_angle'
)
def half(claim):
    return identity(claim, q / 2, ("3", "2"), f"a half, not a third, says process {os.getpid()}")
"""


@pytest.fixture
def folder(tmp_path):
    """A paper with three claims; the name of one is also a name in the package's own paper."""
    home = tmp_path / "two"
    home.mkdir()
    (home / "paper.toml").write_text(PAPER)
    (home / "judges.py").write_text(JUDGES)
    return home


def changed(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def verdicts(folder, **options):
    return {result.id: result.verdict for result in verify(claims=folder, **options)}


def test_why_a_claim_is_not_settled_is_shown_as_long_as_it_is_not(folder):
    changed(folder / "paper.toml", "[sections]", 'unsettled = "why.toml"\n\n[sections]')
    (folder / "why.toml").write_text('[reasons]\n"x.square" = "no method"\n"x.half" = "no time"\n')
    changed(folder / "judges.py", "return identity(claim, (q + 1) ** 2)", "return 1 / 0")
    found = {result.id: (result.verdict, result.unsettled) for result in verify(claims=folder)}

    assert found["x.square"] == (Verdict.OPEN, "no method")
    assert found["x.half"] == (Verdict.CORRECTED, "")

    (folder / "why.toml").write_text('[reasons]\n"x.cube" = "no method"\n')
    with pytest.raises(ValueError, match=r"speaks of 'x.cube', which is no claim"):
        paper(folder)


def test_the_claims_of_a_folder_are_judged_by_its_own_judges(folder):
    """Also the claim that shares its name with one of the package's own paper."""
    found = verdicts(folder)

    assert found == {"x.square": Verdict.CONFIRMED, "x.half": Verdict.CORRECTED, "circle.exit_angle": Verdict.REFUTED}
    theirs, ours = (next(c for c in paper(name).claims if c.id == "circle.exit_angle") for name in (folder, OWN))
    assert judge_of(theirs) is not judge_of(ours)


def test_the_packages_own_paper_is_a_folder_like_any_other():
    assert [claim.id for claim in report.catalogue(SHIPPED / OWN)] == [claim.id for claim in report.catalogue()]
    assert {result.id for result in verify("circle.exit*", claims=SHIPPED / OWN)} == {"circle.exit_angle"}


def test_the_report_says_which_paper_it_is_about_and_keeps_its_order_of_sections(folder, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["verify", "--claims", str(folder), "--report", str(out), "--json", str(tmp_path / "x.json")]) == 0

    page, text = (out / "report.html").read_text(), (out / "report.md").read_text()
    for told in (page, text):
        assert "Two numbers" in told
        assert "N. N.; nowhere" in told
        assert told.index("Thirds") < told.index("Squares")
        assert "a source of its own" in told
        assert "Arroyo" not in told
    assert "data:image/" not in page
    about = {"title": "Two numbers", "authors": ["N. N."], "citation": "nowhere"}
    assert json.loads((tmp_path / "x.json").read_text())["paper"] == about
    assert json.loads((out / "report.json").read_text())["paper"] == about


SECONDS = re.compile(r"(?:\"seconds\": |seconds: |claims took |quiet\">)[\d.]+(?: s; [\d.]+ s with)?")


def dear(folder):
    """The same folder, with claims whose declared seconds are so long that other processes verify them."""
    changed(folder / "paper.toml", "[sections]", 'seconds = "seconds.json"\n\n[sections]')
    (folder / "seconds.json").write_text('{"seconds": {"x.square": 9.0, "x.half": 9.0}, "spares": {}}')
    return folder


def test_worker_processes_load_the_judges_too(folder):
    folder = dear(folder)
    one, two = (list(verify(claims=folder, jobs=jobs)) for jobs in (1, 2))

    assert [result.verdict for result in one] == [result.verdict for result in two]
    assert two[1].erratum.startswith("a half")
    assert two[1].erratum != one[1].erratum  # judged in another process


def test_the_report_does_not_depend_on_the_number_of_processes(folder, tmp_path):
    changed(dear(folder) / "judges.py", "{os.getpid()}", "one")
    files = []
    for jobs in ("1", "2"):
        assert main(["verify", "--claims", str(folder), "--jobs", jobs, "--report", str(tmp_path / jobs)]) == 0
        files.append({path.name: SECONDS.sub("", path.read_text()) for path in (tmp_path / jobs).iterdir()})

    assert files[0] == files[1]


@pytest.mark.slow
def test_a_claim_whose_process_dies_is_open_and_says_so(folder):
    changed(
        folder / "judges.py", "return identity(claim, q / 2", "os.kill(os.getpid(), 9)\n    return identity(claim, q"
    )
    alone, lost, _ = verify(claims=dear(folder), jobs=2)

    assert (alone.id, alone.verdict) == ("x.square", Verdict.CONFIRMED)
    assert (lost.id, lost.verdict) == ("x.half", Verdict.OPEN)
    assert lost.method.startswith("not judged: the process that worked at it died")


def test_only_and_section_choose_among_the_claims_of_a_folder(folder, tmp_path, capsys):
    asked = ["verify", "--claims", str(folder), "--report", str(tmp_path / "out"), "--json", "-"]

    assert main([*asked, "--section", "sQUARES"]) == 0
    assert [claim["id"] for claim in json.loads(capsys.readouterr().out)["claims"]] == ["x.square"]
    assert main([*asked, "--only", "*.half"]) == 0
    assert [claim["id"] for claim in json.loads(capsys.readouterr().out)["claims"]] == ["x.half"]
    assert "--section '7' has no claim; accepted: Thirds, Squares" in refusal(capsys, *asked, "--section", "7")


def test_a_folder_is_read_without_running_anything(folder):
    changed(folder / "judges.py", "import os", "import os\nraise RuntimeError('it was run')")
    before = set(sys.modules)

    assert [claim.id for claim in paper(folder).claims] == ["x.square", "x.half", "circle.exit_angle"]
    codes(paper(folder).claims, 15)
    assert {name for name in set(sys.modules) - before if name.startswith("claims_")} == set()


def test_a_judge_that_returns_no_judgement_leaves_its_claim_open_and_is_told(folder):
    changed(folder / "judges.py", "return identity(claim, (q + 1) ** 2)", "identity(claim, (q + 1) ** 2)")
    (found,) = verify("x.square", claims=folder)

    assert found.verdict is Verdict.OPEN
    assert found.method == "the judge failed: TypeError: it returns None, and a judge returns a Judgement"


def test_judges_that_were_edited_are_run_anew(folder):
    assert verdicts(folder, only="x.half") == {"x.half": Verdict.CORRECTED}
    before = codes(paper(folder).claims, 15)
    changed(folder / "judges.py", "q / 2", "q / 3")

    assert verdicts(folder, only="x.half") == {"x.half": Verdict.CONFIRMED}
    assert codes(paper(folder).claims, 15)["x.half"] != before["x.half"]


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("paper.toml", "title = ", "title ", "paper.toml is no TOML: Expected '=' after a key"),
        ("paper.toml", 'title = "Two numbers"', "", "paper.toml: 'title' is missing"),
        ("paper.toml", '["N. N."]', "3", "paper.toml: authors = 3 should be a list of texts"),
        ("paper.toml", 'letters = ["q"]', "leters = []", "no key is called 'leters'; accepted: title, "),
        ("paper.toml", 'id = "x.half"', 'id = "x.square"', "two claims have the id 'x.square'"),
        ("paper.toml", 'id = "x.half"', "", "paper.toml: 'id' is missing"),
        ("paper.toml", 'quote = "$q/3$"', "", "claim 'x.half': 'quote' is missing"),
        ("paper.toml", 'printed = "q/3"', "printed = 3", "'x.half': printed = 3 should be a text or a list"),
        ("paper.toml", 'printed = "q/3"', 'printed = ["q", 3]', "printed = ['q', 3] should be a text or a list"),
        ("paper.toml", '"q/3"', '"q/3"\nover = { q = "(0; 1)" }', "q = '(0; 1)' } is no range of a l"),
        ("paper.toml", '"q/3"', '"q/3"\nover = { p = "(0, 1)" }', "p = '(0, 1)' } is no range of a l"),
        ("paper.toml", '"Squares" = ""', "", "claim 'x.square': no section is called 'Squares'; listed: 'Thirds'"),
        ("paper.toml", 'letters = ["q"]', 'claims = ["no.toml"]', "no.toml cannot be read: No such file or directory"),
        ("paper.toml", 'letters = ["q"]', 'judges = ["no.py"]', "no.py, and there is no such file"),
        ("judges.py", '"x.half", ', "", "the claim 'x.half' has no judge; write a function below @judges('x.half')"),
        ("judges.py", '"x.half"', '"x.half", "x.third"', "judges.py judges 'x.third', which is no claim of "),
        ("judges.py", '"x.half"', '"x.half", "x.square"', "judges.py: 'x.square' is judged twice"),
        ("judges.py", "import os", "import o s", "judges.py cannot be loaded: SyntaxError"),
        ("judges.py", "import os", "import nosuchmodule", "judges.py cannot be loaded: ModuleNotFoundError"),
        ("judges.py", "import os", "raise SystemExit(0)", "judges.py cannot be loaded: SystemExit"),
    ],
)
def test_a_folder_that_is_not_in_order_is_refused_in_one_sentence(folder, capsys, tmp_path, file, old, new, said):
    changed(folder / file, old, new)

    assert said in refusal(capsys, "verify", "--claims", str(folder), "--report", str(tmp_path / "out"))


def test_what_is_no_folder_of_a_paper_is_told_what_is(capsys, tmp_path):
    known = ", ".join(sorted([OWN, *OTHERS]))

    assert f"accepted: a folder with a paper.toml, {known}" in refusal(capsys, "verify", "--claims", "no/such")
    assert "has no paper.toml; `pinball claims new DIR` makes" in refusal(capsys, "verify", "--claims", str(tmp_path))


def test_a_new_folder_works_at_once_and_is_not_written_over(tmp_path, capsys):
    home = tmp_path / "deep" / "mine"
    assert main(["claims", "new", str(home)]) == 0
    assert sorted(path.name for path in home.iterdir()) == ["judges.py", "paper.toml"]

    assert verdicts(home) == {"circle.area": Verdict.CONFIRMED}
    changed(home / "paper.toml", 'printed = "pi"', 'printed = "2*pi"')
    assert verdicts(home) == {"circle.area": Verdict.REFUTED}
    capsys.readouterr()
    assert "is there already; accepted: a new folder" in refusal(capsys, "claims", "new", str(home))
    with pytest.raises(ValueError, match="cannot be written"):
        begin(tmp_path / "deep" / "mine" / "judges.py" / "below")


def test_help_says_that_the_judges_of_a_folder_are_run(capsys):
    assert main(["verify", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())

    assert "this option runs, so use only folders that you trust" in told

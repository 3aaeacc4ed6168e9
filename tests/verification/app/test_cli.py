"""The command line: errors are one sentence, scenes are exact, and only needed modules are loaded."""

import json
import os
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import click
import pytest
from asking import refusal
from sympy import Rational, cos

from symbolic import tables
from symbolic.tables.definition import GALLERY
from symbolic.tables.scene import Scene
from symbolic.tables.table import theta
from verification.app.cli import COMMANDS, Output, json_option, main
from verification.app.scene import scene_options, table_options


@pytest.fixture
def scenes(monkeypatch):
    """A list that two test commands, `pinball show` and `pinball shape`, fill with the scenes they are given."""
    seen = []

    @click.command()
    @scene_options
    @json_option
    def show(scene, output):
        seen.append((scene, scene.table))

    @click.command()
    @table_options
    def shape(scene):
        seen.append((scene, scene.table))

    for command in (show, shape):
        monkeypatch.setitem(COMMANDS, command.name, "for tests")
        monkeypatch.setitem(sys.modules, f"verification.app.commands.{command.name}", SimpleNamespace(command=command))
    return seen


def test_verify_writes_the_report_and_json_has_standard_output_to_itself(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["verify", "--only", "cuspless.lambda_c", "--json", "-"]) == 0

    said = capsys.readouterr()
    (claim,) = json.loads(said.out)["claims"]
    assert said.err == ""
    assert claim["id"] == "cuspless.lambda_c"
    assert (tmp_path / "report" / "report.html").exists()
    assert json.loads((tmp_path / "report" / "report.json").read_text())["claims"][0]["verdict"] == claim["verdict"]


def test_claims_are_listed_and_those_that_several_globs_name_are_judged(capsys, tmp_path):
    assert main(["claims", "list", "--section", "5"]) == 0
    assert "\ncuspless.lambda_c " in capsys.readouterr().out
    asked = ["--only", "ellipse.P1", "--only", "cuspless.lambda_?"]
    assert main(["verify", *asked, "--no-figures", "--report", str(tmp_path), "--json", "-"]) == 0
    ids = {claim["id"] for claim in json.loads(capsys.readouterr().out)["claims"]}
    assert ids == {"ellipse.P1", "cuspless.lambda_c"}


def test_a_result_that_cannot_be_written_is_kept_elsewhere(tmp_path):
    """The folder may be removed while the result is computed."""
    (tmp_path / "folder").mkdir()
    output = Output(str(tmp_path / "folder" / "x.json"))
    (tmp_path / "folder").rmdir()

    with pytest.raises(ValueError, match="cannot be written") as caught:
        output.write({"schema": 1, "nu": float("nan")})
    kept = str(caught.value).rsplit(" ", 1)[1]
    assert json.loads(Path(kept).read_text()) == {"schema": 1, "nu": None}


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["verify", "--only", "elipse.*"], "--only 'elipse.*' matches no claim; the nearest are: ellipse."),
        (["verify", "--only", "a,b"], "accepted: one name at a time, as in --only 'a' --only 'b'"),
        (["slap", "circle", "--law", "-eta", "--law=-lam*eta"], "--law is given 2 times; accepted: once"),
        (["slap", "egg", "--alpha", "0.08", "--lam", "0.5"], "--lam 0.5: the slap map is the limit at lam = 0; leave"),
        (["claims", "old"], "Invalid value for 'new|list': 'old' is not one of 'new', 'list'"),
        (["claims", "new"], "DIR is missing; accepted: pinball claims new DIR"),
        (["verify", "--digits", "0"], "accepted: integers from 1 to 10000"),
        (["verify", "--digits", "9" * 5000], "accepted: integers from 1 to 10000"),
        (["verify", "--digits"], "'--digits' requires an argument"),
        (
            ["verify", "--nope"],
            "no option is called --nope; accepted: --changed, --claims, --digits, --figures, --help, --jobs, --json, ",
        ),
        (["verify", "more"], "unexpected extra argument (more); pinball verify --help shows what is accepted"),
        (["verify", "--json", "no/such/file"], "there is no directory 'no/such'; create it first"),
        (["verify", "--json", "."], "'.' is a directory; accepted: a file, or - for standard output"),
        (["verify", "--report", "/dev/null/x"], "--report '/dev/null/x' cannot be made"),
        (["judge"], "no command is called 'judge'; accepted: orbit, "),
        (["reprt"], "; did you mean report?"),
        (["orbit", "eg"], "; did you mean egg?"),
        (["orbit", "egg", "--lamm", "1"], "; did you mean --lam?"),
        (["judge\nme\x1b"], "no command is called 'judge\\nme\\x1b'"),
    ],
)
def test_bad_input_is_one_sentence_and_nothing_is_written(capsys, tmp_path, monkeypatch, arguments, sentence):
    monkeypatch.chdir(tmp_path)
    assert sentence in refusal(capsys, *arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "scene"),
    [
        ("circle --lam 0", Scene("circle", lam=0)),
        ("egg --alpha 0.08 --lam .5", Scene("egg", alpha="2/25", lam="1/2")),
        ("egg --alpha 1/17 --K 4 --lam 1", Scene("egg", alpha="1/17", lam=1, K=4)),
        ("ellipse --a sqrt(2) --lam 1/3", Scene("ellipse", a="sqrt(2)", lam="1/3")),
        ("--polar 1+cos(5*theta)/40 --lam 1e-3", Scene(tables.polar(1 + cos(5 * theta) / 40), lam="1/1000")),
        ("--parametric 2*cos(theta) sin(theta) --lam 1", Scene(tables.parametric("2*cos(theta)", "sin(theta)"))),
    ],
)
def test_a_scene_is_exact(scenes, arguments, scene):
    assert main(["show", *arguments.split()]) == 0

    assert [seen for seen, _ in scenes] == [scene]


def test_a_table_of_the_gallery_and_a_shape_of_ones_own_are_typed_like_the_papers(scenes):
    assert main(["show", "stadium", "--lam", "9/10", "--shape", "straight=1/2"]) == 0
    assert main(["show", "--polar", "1 + b*cos(5*theta)", "--shape", "b=1/40", "--lam", "1"]) == 0
    assert main(["show", "--polar", "1 + b*cos(5*theta)", "--shape", "b=1/40:0..1/4", "--lam", "1"]) == 0

    (stadium, _), (star, _), (ranged, _) = scenes
    assert ranged.ranges == {"b": (0, Fraction(1, 4))}
    assert stadium == Scene(tables.stadium(Rational(1, 2)), lam="9/10")
    assert star.shape == {"b": Fraction(1, 40)}
    assert set(GALLERY) == set(tables.GALLERY)


def test_a_number_that_table_and_law_share_is_that_of_both(scenes):
    law = ("--law", "-lam*eta*(1 - straight/100)")
    assert main(["show", "stadium", "--lam", "9/10", "--shape", "straight=1/2", *law]) == 0
    assert main(["show", "egg", "--lam", "9/10", "--shape", "alpha=2/25", "--law", "-lam*eta*(1 - alpha)"]) == 0

    (stadium, table), (egg, _) = scenes
    assert table == tables.stadium(Rational(1, 2))
    assert stadium.law.numbers == (("straight", "1/2"),)
    assert (egg.shape, egg.law.numbers) == ({"alpha": Fraction(2, 25)}, (("alpha", "2/25"),))


def test_a_scene_file_is_taken_by_a_command_and_its_contraction_may_be_changed(scenes, tmp_path):
    path = tmp_path / "sinai.toml"
    path.write_text(Scene(tables.sinai("1/5"), lam="1/2").text)
    assert main(["show", "--scene", str(path)]) == 0
    assert main(["show", "--scene", str(path), "--lam", "3/4"]) == 0

    assert [seen for seen, _ in scenes] == [Scene(tables.sinai("1/5"), lam=lam) for lam in ("1/2", "3/4")]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("--lam 1", "one table is needed, none given; accepted: circle, ellipse, cardioid, cuspless, egg, --polar or"),
        ("stadium --shape b=1 --lam 1", "stadium: --shape b is none of its lengths; accepted: straight, radius"),
        ("egg --alpha 2/25 --shape alpha=1/20 --lam 1", "--shape alpha is given, and --alpha 2/25 too; leave one out"),
        ("stadium --shape straight --lam 1", "--shape 'straight' sets nothing; give NAME=VALUE such as b=1/10"),
        ("--polar 1+b*cos(theta) --shape b=0.1:0..2 --lam 1", "--polar: rho = b*cos(theta) + 1 is not positive at"),
        ("--polar 1+b*cos(theta) --shape b=0.1:1/4 --lam 1", "--shape b=0.1:1/4 varies a parameter; this"),
        ("--polar 1+b*cos(theta) --shape b=0.1..0.3 --lam 1", "NAME=VALUE:LOW..HIGH, and NAME=LOW:HIGH"),
        ("--scene nowhere.toml", "scene: nowhere.toml cannot be read (No such file or"),
        ("circle --polar 1 --lam 1", "one table is needed, polar and circle given"),
        ("circle", "--lam is missing; accepted: numbers in [0, 1], as in --lam 1/2"),
        ("circle --lam 1.0001", "--lam = 10001/10000 is no contraction; accepted: numbers in [0, 1]"),
        ("circle --lam -1", "--lam = -1 is no contraction"),
        ("circle --lam sqrt(2)", "--lam = sqrt(2) is no contraction"),
        ("circle --lam nan", "--lam = 'nan': 'nan' at column 1 is unknown"),
        ("circle --lam 1/0", "--lam = '1/0': '0' at column 3 may not be divided by"),
        ("circle --lam 1e999999999", "too long a number"),
        ("egg --lam 1", "egg: --alpha is missing; give it a number such as --alpha 2/25"),
        ("egg --alpha 0.2 --lam 1", "egg: alpha = 1/5 makes the table non-convex; alpha must lie in [0, 1/10]"),
        ("egg --alpha 0.1 --K 4 --lam 1", "alpha must lie in [0, 1/17]"),
        ("egg --alpha 0.1 --K 1 --lam 1", "accepted: integers from 2"),
        ("ellipse --a 1/2 --lam 1", "ellipse: a = 1/2 makes the y axis the longer one; a must lie in [1, oo)"),
        ("ellipse --a pi*theta --lam 1", "--a = 'pi*theta': 'theta' at column 4 is unknown"),
        ("circle --a 2 --lam 1", "circle: --a = 2 is no shape parameter of this table; accepted: none"),
        ("circle --K 3 --lam 1", "circle: --K = 3 is only for the egg; leave it out"),
        ("--polar theta.real --lam 1", "--polar: '.' at column 6 is no part of a formula"),
        ("--polar __import__('os').system('true') --lam 1", '--polar: "\'" at column 12 is no part of a formula'),
        ("--polar theta --lam 1", "polar: the boundary is not closed"),
        ("--polar 1+2*cos(theta) --lam 1", "polar: rho = 2*cos(theta) + 1 is not positive"),
        ("--parametric cos(theta) -sin(theta) --lam 1", "parametric: the boundary runs clockwise"),
        ("--lam 1 --parametric cos(theta)", "requires 2 arguments"),
    ],
)
def test_a_scene_that_is_none_is_one_sentence(scenes, capsys, arguments, sentence):
    assert sentence in refusal(capsys, "show", *arguments.split())
    assert scenes == []


def pinball(*arguments: str, **kwargs) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "verification", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600, **kwargs)


SWEEP = "sweep parameter-space --alphas 0:0.1:2 --lams 0:1:2 --starts 2 --bounces 8 --transient 0 --store s.zarr"
ORBIT = "orbit {} --lam 1/2 --start 0.3,0.2 --bounces 3"


@pytest.mark.parametrize(
    ("package", "extra", "arguments"),
    [
        ("xarray", "sweep", SWEEP),
        ("zarr", "sweep", SWEEP),
        ("pyarrow", "table", ORBIT.format("circle") + " --out o.parquet"),
        ("matplotlib", "plot", "figure egg-slap"),
        ("svgelements", "outline", ORBIT.format("--data a.svg")),
        ("ezdxf", "outline", ORBIT.format("--data a.dxf")),
    ],
)
def test_a_missing_extra_is_one_sentence_with_the_command_that_brings_it(
    package, extra, arguments, capsys, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    for name in ("a.svg", "a.dxf"):
        Path(name).touch()
    for module in (package, f"{package}.disassemble"):
        monkeypatch.setitem(sys.modules, module, None)

    assert re.search(rf"pip install '\.\[{extra}\]' in a checkout", refusal(capsys, *arguments.split()))


def test_help_loads_no_mathematics():
    loaded = "import sys; from verification.app import cli; cli.main(['--help']); "
    loaded += "print(sorted(sys.modules), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", loaded], capture_output=True, text=True, check=True, timeout=600)

    for module in ("sympy", "numpy", "scipy", "matplotlib", "flint", "mpmath", "llvmlite", "rich"):
        assert f"'{module}'" not in done.stderr
    for name, about in COMMANDS.items():
        assert name in done.stdout
        assert about in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("table", ["--polar 1+cos(3*theta)/20", "stadium", "--scene flower.toml"])
def test_a_table_of_ones_own_is_read_and_proved_once_and_then_without_sympy(table, tmp_path):
    flower = '[shape]\nb = "{}"\n'
    said = 'polar = "1 + b*cos(3*theta)"\nlam = "1/2"\n'
    (tmp_path / "flower.toml").write_text(said + flower.format("1/20"))
    asked = ["orbit", *table.split(), "--lam", "1/2", "--start", "0.3,0.2", "--bounces", "3"]
    code = f"import sys; from verification.app import cli; status = cli.main({asked}); "
    code += "print('sympy' in sys.modules, file=sys.stderr); sys.exit(status)"
    kept = dict(os.environ, PINBALL_CACHE=str(tmp_path / "cache"))

    def run() -> subprocess.CompletedProcess[str]:
        options = {"capture_output": True, "text": True, "check": True, "timeout": 600}
        return subprocess.run([sys.executable, "-c", code], env=kept, cwd=tmp_path, **options)

    first, second = run(), run()
    assert (first.stderr, second.stderr) == ("True\n", "False\n")
    assert first.stdout == second.stdout
    if "--scene" in table:  # what the file says now counts, and not its name
        (tmp_path / "flower.toml").write_text(said + flower.format("1/30"))
        third = run()
        assert third.stdout != first.stdout
        assert third.stderr == "True\n"


@pytest.mark.slow
def test_every_command_has_help_with_an_example():
    for name in COMMANDS:
        done = pinball(name, "--help")

        assert done.returncode == 0
        example = " ".join(done.stdout.split()).partition("Example: ")[2]
        assert example.startswith("pinball ")
        assert f"pinball {name}" in example


def test_a_reader_that_goes_away_is_no_error():
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "verification", "--help"]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, check=False, timeout=600)
    os.close(write)

    assert (done.returncode, done.stderr) == (141, "")

"""The independent checker proves the committed certificates, without the package, and refuses false ones."""

import ast
import copy
import json
import os
import re
import shutil
import subprocess
import sys
from fractions import Fraction

import mpmath
import pytest
from committed import FOLDER, document, told, verdict

QUICK = ("minor-axis", "five-waves", "saddle-node", "alpha-tilde", "alpha-hat", "lambda-star", "phi-star", "lambda-c")
LONG = "boundary-crisis"  # the one kind that takes seconds
REGION = "triangle-region"  # another is made of cells
STANDARD = {
    "ast", "bisect", "decimal", "fractions", "functools", "importlib", "itertools", "json", "math", "pathlib", "re",
    "sys",
}  # fmt: skip
NEEDS = {
    "boundaries.py": {"identity"},
    "crisis.py": {"region"},
    "laws.py": {"curves"},
    "long.py": {"tangency"},
    "region.py": {"curves"},
}  # of the others; docs/trust.md
BESIDE = (  # each for what few certificates need
    "boundaries.py", "corner.py", "crisis.py", "curves.py", "entries.py", "formulas.py", "identity.py", "laws.py",
    "long.py", "region.py", "tangency.py",
)  # fmt: skip
OWN = ("symbolic", "numeric", "verification", "flint", "sympy", "mpmath", "numpy")


@pytest.mark.slow
def test_a_sample_of_every_kind_is_proved_by_python_alone_in_an_empty_folder(tmp_path):
    names = (*QUICK, LONG, REGION)
    for reader in ("check.py", *BESIDE):
        (tmp_path / reader).write_bytes((FOLDER / reader).read_bytes())
    shutil.copytree(FOLDER / "schema", tmp_path / "schema")
    watched = f"import runpy, sys\nsys.argv = {['check.py', *(str(FOLDER / f'{name}.json') for name in names)]!r}\n"
    watched += (
        "try:\n    runpy.run_path('check.py', run_name='__main__')\nexcept SystemExit as end:\n    print(end.code)\n"
    )
    watched += f"print([name for name in {OWN!r} if name in sys.modules])\n"
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", watched], cwd=tmp_path, env={}, capture_output=True, text=True, timeout=600
    )
    lines = [line for line in done.stdout.splitlines() if not line.startswith("  ")]

    assert done.stderr == ""
    assert [line.split(": ")[1] for line in lines[:-2]] == ["proved"] * len(names)
    assert lines[-2:] == ["0", "[]"]


def test_every_kind_is_in_the_sample(check):
    """All except one of two minutes, which `make check-all` runs; its steps have tests of their own."""
    assert {document(name)["kind"] for name in (*QUICK, LONG, REGION)} == {*check.KINDS, "trapping region"}


@pytest.mark.parametrize("name", ["check.py", *BESIDE])
def test_the_second_reader_is_one_short_file_of_the_standard_library_and_shorter_ones_beside_it(name):
    text = (FOLDER / name).read_text()
    tree = ast.parse(text)
    imported = {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    imported |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    called = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}

    assert len(text.splitlines()) <= (600 if name == "check.py" else 250)
    assert imported - STANDARD == ({"check", *NEEDS.get(name, ())} if name in BESIDE else set())
    assert not called & {"eval", "exec", "compile", "__import__", "open"}


def test_the_second_reader_has_no_line_of_the_package():
    """A line longer than usual Python phrases that occurs in both would be a copy."""
    package = FOLDER.parent
    theirs = {
        line.strip()
        for room in ("symbolic", "numeric", "verification")
        for path in (package / room).rglob("*.py")
        for line in path.read_text().splitlines()
    }
    read = [line for name in ("check.py", *BESIDE) for line in (FOLDER / name).read_text().splitlines()]
    ours = {line.strip() for line in read if len(line.strip()) > 45}
    words = (  # the statement, of one text
        '"corner": "{scene}', '"corner, -theta', '"falls as lam', '"cycle": "{scene}', '"tangency": "{scene}',
    )  # fmt: skip

    assert {line for line in ours & theirs if not line.startswith(words)} == set()


def test_the_same_files_are_made_again_byte_by_byte(make):
    for name in ("minor-axis", "lambda-c", "lambda-star", "marked-point", "spline", "law-in-all-words"):
        assert make.text(name) == (FOLDER / f"{name}.json").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [
        {"PYTHONHASHSEED": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        {"PYTHONHASHSEED": "2", "fewer": "AVX-512"},
        {"PYTHONHASHSEED": "3", "fewer": "AVX2"},
        {"LC_ALL": "C", "TZ": "Asia/Tokyo", "PYTHONOPTIMIZE": "1"},
    ],
    ids=["one thread", "no AVX-512", "no AVX2", "another place"],
)
def test_a_certificate_has_the_same_bytes_whatever_the_machine(tmp_path, environment, fewer):
    names = ("saddle-node", "alpha-hat")
    command = [sys.executable, str(FOLDER / "make.py"), "--into", str(tmp_path), *names]
    around = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "PYTHONPATH": str(FOLDER.parent)}
    around |= fewer.get(environment.get("fewer"), {}) | {k: x for k, x in environment.items() if k != "fewer"}
    subprocess.run(command, cwd=FOLDER.parent, env=around, check=True, timeout=600)

    for name in names:
        assert (tmp_path / f"{name}.json").read_bytes() == (FOLDER / f"{name}.json").read_bytes()


@pytest.mark.parametrize(
    ("entry", "place", "factor", "answer"),
    [
        ("range", 0, Fraction(1, 100), "not proved: saddle"),  # beyond it nothing is known of graphs
        ("range", 0, 100, "not proved: saddle"),  # the image of the shorter graph does not reach so far
        ("bounds", 0, Fraction(1, 8), "not proved: remainder"),
        ("frame", 1, 1 + Fraction(1, 10**9), "not proved: remainder"),  # no saddle is here
        ("drift", 0, 3, "not proved"),
    ],
)
def test_a_local_manifold_is_enclosed_only_where_it_is(check, entry, place, factor, answer):
    given = document(LONG)
    number = check.exact(given["unstable"][entry][place]) * factor
    given["unstable"][entry][place] = [str(round(number * 2**400)), "-400"]

    assert verdict(check, given).startswith(answer)


def cycle(scene: dict, theta: list[str], components: list[int]) -> dict:
    """A certificate of a cycle at these decimals, with the statement that its entries require."""
    centre = [[str(round(Fraction(x) * 2**200)), "-200"] for x in theta]
    checks = dict.fromkeys(("exists", "unique", "precise", "admissible", "minimal_period"), True)
    first = {"schema": 4, "name": "", "kind": "cycle", "scene": scene, "free": "", "statement": ""}
    box = {"bits": 160, "digits": 10, "centre": centre, "radius": ["1", "-40"]}
    return told(first | {"components": components, "mirror": False, "checks": checks} | box)


HALF_PI = "1.57079632679489661923132169163975144209858469968755291048747229615390820314310449931401741267105853"
PI = "3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706"
AXIS = [HALF_PI, f"-{HALF_PI}"]  # the short one
ELLIPSE, CIRCLE = {"table": "ellipse", "shape": {"a": "2"}}, {"table": "circle"}
STADIUM = [
    {"name": "right", "x": "1 + cos(theta)", "y": "sin(theta)", "from": "-pi/2", "to": "pi/2"},
    {"name": "top", "x": "-theta", "y": "1", "from": "-1", "to": "1"},
    {"name": "left", "x": "-1 - cos(theta)", "y": "-sin(theta)", "from": "-pi/2", "to": "pi/2"},
    {"name": "bottom", "x": "theta", "y": "-1", "from": "-1", "to": "1"},
]
TURNED = [piece | {"x": f"-({piece['x']})"} for piece in STADIUM]  # clockwise
NONE = "not proved|refused"


@pytest.mark.parametrize(
    ("scene", "lam", "theta", "components", "answer"),
    [
        *((ELLIPSE, lam, AXIS, [0, 0], "proved: a cycle of period 2") for lam in ("1/3", "0", "1")),
        (ELLIPSE, "1/3", 2 * AXIS, [0] * 4, "not proved: minimal_period"),  # a regular solution for four bounces, too
        (ELLIPSE, "1/3", [HALF_PI, HALF_PI], [0, 0], "not proved"),  # of lines, and not of rays
        (ELLIPSE, "1/3", [*AXIS, AXIS[1]], [0] * 3, "not proved"),
        *((CIRCLE, lam, ["0", PI], [0, 0], "not proved") for lam in ("0", "1", "1/2")),  # one of a line of solutions
        ({"component": STADIUM}, "1/3", ["0", "0"], [0, 2], "proved: a cycle of period 2: boundary of 4 pieces"),
        ({"component": STADIUM}, "1/3", ["0", "0"], [1, 3], "not proved: a divisor"),  # one of many
        ({"component": STADIUM}, "1/3", ["0", PI], [0, 2], "not proved"),  # beyond the end of a piece
        ({"component": TURNED}, "1/3", ["0", "0"], [0, 2], "not proved: scene: not just one curve"),
        ({"table": "cardioid"}, "1/3", ["0", PI], [0, 0], NONE),  # at the cusp
        ({"table": "cuspless"}, "1/3", ["2.0943951023931954923084", "-0.43301270189221932338"], [0, 1], NONE),
    ],
)
def test_a_cycle_is_proved_where_it_is_one_alone_and_runs_inside_of_the_table(
    check, scene, lam, theta, components, answer
):
    assert re.match(answer, verdict(check, cycle(scene | {"lam": lam}, theta, components)))


def test_a_bounce_beyond_the_end_of_its_piece_is_none_though_no_chord_is_in_the_way(check):
    """The axis of a lens whose upper arc is whole, or ends before the middle, where a bay begins."""
    said_by = lambda x, y, low, high: {"x": x, "y": y, "from": low, "to": high}  # noqa: E731
    lower, right = said_by("theta", "theta**2/8 - 1", "-1", "1"), said_by("1", "theta", "-7/8", "7/8")
    upper, left = said_by("-theta", "1 - theta**2/8", "-1", "1"), said_by("-1", "-theta", "-7/8", "7/8")
    bay = [said_by("1/2", "theta", "31/32", "3"), said_by("-theta", "3", "-1/2", "1")]
    ends = [upper | {"to": "-1/2"}, *bay, left | {"from": "-3"}]
    whole, part = ({"component": [lower, right, *rest], "lam": "1/3"} for rest in ([upper, left], ends))

    assert verdict(check, cycle(whole, ["0", "0"], [0, 2])).startswith("proved")
    assert verdict(check, cycle(part, ["0", "0"], [0, 2])).startswith("not proved: admissible: a bounce may be off")


@pytest.mark.parametrize(
    ("law", "shape", "answer"),
    [
        ("-lam*eta", {}, "proved: a cycle of period 2: ellipse, phi = -lam*eta, a = 2"),
        ("-lam*eta - b*eta**3", {"b": "1/5"}, "proved: a cycle of period 2: ellipse, phi = -lam*eta - b*eta**3"),
        ("-lam*eta + b", {"b": "1/5"}, "not proved: exists"),  # a particle on the axis leaves it
        ("-lam*eta + theta - theta", {}, "proved"),
        ("-lam*gamma(eta)", {}, "refused: the formula has"),
        ("-2*eta", {}, "refused: law: it may lead out of the table"),
        ("-eta", {}, "proved"),  # the elastic law
        ("-K*eta", {}, "refused: the formula has 'K', which is not understood"),  # a letter without a number
    ],
)
def test_a_law_that_is_told_is_the_law(check, law, shape, answer):
    scene = {"table": "ellipse", "shape": {"a": "2"} | shape, "law": law, "lam": "1/3"}

    assert verdict(check, cycle(scene, [HALF_PI, f"-{HALF_PI}"], [0, 0])).startswith(answer)


@pytest.mark.slow
def test_a_chord_across_a_bay_is_not_free(check):
    """A flower of six petals: the equations hold from the far side of one petal to the next, across a bay."""
    with mpmath.workdps(60):
        side = mpmath.findroot(lambda t: mpmath.diff(lambda u: (1 + 0.45 * mpmath.cos(6 * u)) * mpmath.cos(u), t), 0.96)
        apart = [mpmath.nstr(side, 50), mpmath.nstr(mpmath.pi - side, 50)]
    flower = {"polar": "1 + cos(6*theta)*9/20", "lam": "1/3"}
    middle, bay = (verdict(check, cycle(flower, ends, [0, 0])) for ends in (["0", PI], apart))

    assert middle.startswith("proved")  # from petal to petal
    assert bay.startswith("not proved: admissible: a chord may meet the boundary")


def test_no_entry_leads_to_a_traceback(check, tmp_path, capsys):
    """Each entry is replaced by each of a dozen unusual values; and files that hold no document."""
    odd = (None, True, -1, 2**70, "", "x", [], {}, [[]], 0.5, "\x1b", {"table": []}, [["1", "2", "3"]])
    given, paths = document("minor-axis"), []
    for key in given:
        for k, value in enumerate(value for value in odd if value != given[key] or isinstance(value, bool)):
            path = tmp_path / f"{key}-{k}.json"
            path.write_text(json.dumps(copy.deepcopy(given) | {key: value}))
            paths.append(str(path))
    for k, none in enumerate([[], None, "kind", 3, {}, {"kind": "cycle"}, {"kind": ["cycle"]}]):
        paths.append(str(tmp_path / f"none-{k}.json"))
        (tmp_path / f"none-{k}.json").write_text(json.dumps(none))
    (tmp_path / "text.json").write_text("no")
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe")
    (tmp_path / "deep.json").write_text("[" * 100_000)
    paths += [str(tmp_path / name) for name in ("text.json", "bytes.json", "deep.json", "none.json")]

    assert check.main([]) == check.main(paths[-1:]) == check.main(paths) == 1
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(paths) + 1
    assert not [line for line in lines if ": proved" in line]
    assert all(": refused: " in line for line in lines if "/none" in line)
    assert all(line.isprintable() for line in lines)

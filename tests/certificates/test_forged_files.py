"""False certificates: true ones, each forged in one way; both checkers refuse every one."""

import copy
import json

import pytest
from committed import document, told

from verification.app.cli import main


def scened(name: str, scene: dict, **entries: object) -> str:
    """The certificate of a cycle with another scene."""
    return json.dumps(told(document(name) | {"scene": scene} | entries))


def altered(name: str, /, **entries: object) -> str:
    """The certificate with other entries, as its words do not say."""
    return json.dumps(document(name) | entries)


def pieces(*rows: tuple[str, str, str, str]) -> dict:
    keys = ("name", "x", "y", "from", "to")
    return {
        "component": [dict(zip(keys, (f"piece{k}", *row), strict=True)) for k, row in enumerate(rows, 1)],
        "lam": "1/3",
    }


# ---- laws that lead out of the table, about a cycle that runs along normals, which is one under each of them

LAWS = (
    "3*eta", "-lam*tan(eta)", "eta**3 - eta*lam", "-eta*lam/(1 - eta**2)", "-lam*log(eta + 1)", "-3*eta**5 - eta*lam",
    "-6*eta*lam", "-lam*tan(3*eta/2)", "sinh(2*eta)", "-eta*lam/(eta + 1)", "exp(eta) - 1", "-eta*lam/(eta - 3/2)",
    "-eta*(sin(theta)**2/1000000000 + 1)", "-eta*((theta - pi/2)**8/100000000000000000000 + 1)",
    "-eta*lam - 3*exp(-1000000*(eta - 3/2)**2 - 1000000*(theta - 1)**2)", "-eta*lam*Abs(eta - 1)/(eta - 1)",
    "-lam*eta*sqrt((eta - 1)**2)/(eta - 1)", "-lam*eta*(eta - 1)**2/(eta - 1)**2", "-eta*(atan(1/(eta - 1)) + pi/2)/4",
)  # fmt: skip
NORMAL = ("minor-axis", "five-waves", "scatterer")  # the last two under laws of the place and some others


def under(name: str, law: str) -> str:
    return scened(name, document(name)["scene"] | {"law": law})


# ---- boundaries that are none, away from the cycle

SIDES = [("theta - 1/2", "-1/2", "0", "1"), ("1/2", "theta - 1/2", "0", "1"), ("1/2 - theta", "1/2", "0", "1"),
         ("-1/2", "1/2 - theta", "0", "1")]  # fmt: skip
HOLE = ("cos(theta)/4", "-sin(theta)/4", "-pi", "pi")  # of the cycle, with the first side


def disc(x: str, y: str, radius: str, turn: str = "-") -> tuple[str, str, str, str]:
    return f"{radius}*cos(theta) + {x}", f"{y} {turn} {radius}*sin(theta)", "-pi", "pi"


def side(k: int, **changed: str) -> list[tuple[str, str, str, str]]:
    rows = [dict(zip(("x", "y", "start", "end"), row, strict=True)) for row in SIDES]
    rows[k] |= changed
    return [tuple(row.values()) for row in rows]


U2 = "10**16*sin(theta)**2"  # so a loop of 1e-8, where the parameter is 0
LOOP = [f"2*cos(theta) + 1/(10**8*(1 + {U2}))", f"sin(theta)*(1 - 3/(1 + {U2})**2)"]
CUSP = {"undefined": [{"name": "m", "component": 0, "theta": "pi"}]}
COARSE = {"radius": ["1", "-24"], "digits": 6}
BOUNDARIES = {
    "a disc across a side": pieces(*SIDES, HOLE, disc("1/2", "2/5", "1/20")),
    "a disc across a side by a little": pieces(*SIDES, HOLE, disc("2/5", "2/5", "(1/10 + 1/10**12)")),
    "a disc that touches a side": pieces(*SIDES, HOLE, disc("2/5", "2/5", "1/10")),
    "a disc across the other": pieces(*SIDES, HOLE, disc("1/4", "1/4", "3/20")),
    "a disc in the other": pieces(*SIDES, HOLE, disc("0", "0", "1/8")),
    "a disc elsewhere": pieces(*SIDES, HOLE, disc("4", "0", "1/8")),
    "a disc round the table": pieces(*SIDES, HOLE, disc("0", "0", "5/2")),
    "a disc over the cycle and a side": pieces(*SIDES, HOLE, disc("-1/4", "0", "2/5")),
    "a disc that runs backwards": pieces(*SIDES, HOLE, disc("2/5", "2/5", "1/20", "+")),
    "a curve of no width": pieces(*SIDES, HOLE, ("2/5 + cos(theta)/20", "2/5 + 0*theta", "-pi", "pi")),
    "many discs over one another": pieces(
        *SIDES, HOLE, *(disc(f"{3 * i}/100 + 3/10", f"{3 * j}/100 + 3/10", "1/50") for i in range(5) for j in range(5))
    ),
    "no outer curve": pieces(HOLE, disc("0", "-3/4", "1/4")),
    "a side with a loop": pieces(
        *side(2, x="1/2 - theta - sin(2*pi*theta)/4", y="1/2 + (1 - cos(2*pi*theta))/10"), HOLE
    ),
    "a side through the disc": pieces(*side(2, y="1/2 - theta*(1 - theta)*2"), HOLE),
    "a side across another": pieces(*side(2, x="1/2 - theta + 5*theta*(1 - theta)*(1/2 - theta)"), HOLE),
    "a gap": pieces(*side(2, y="1/2 + theta/100"), HOLE),
    "a gap of 1e-30": pieces(*side(2, y="1/2 + theta/10**30"), HOLE),
    "a gap of 1e-120": pieces(*side(2, y="1/2 + theta/10**60/10**60"), HOLE),
    "a gap of 1e-60 in an end": pieces(*side(2, end="1 - 1/10**60"), HOLE),
    "a hole twice": pieces(*SIDES, HOLE, HOLE),
    "two discs that touch": pieces(*SIDES, HOLE, disc("7/20", "7/20", "1/20"), disc("9/20", "7/20", "1/20")),
    "a disc about the bounce": pieces(*SIDES, HOLE, disc("-1/4", "0", "1/1000")),
    "a disc on the chord": pieces(*SIDES, HOLE, disc("-3/8", "0", "(1/10**12)")),
    "a disc that does not close": pieces(*SIDES, (*HOLE[:3], "pi - 1/10**60")),
    "a piece backwards": pieces(*side(2, start="1", end="0"), HOLE),
}
CURVES = {
    "a loop of 1e-8": ("minor-axis", {"parametric": LOOP}, {}),
    "a limacon with a loop of 1e-13": ("cardioid", {"polar": "(1 + 1/10**13)*cos(theta) + 1"} | CUSP, COARSE),
    "a limacon with a loop of 1e-40": ("cardioid", {"polar": "(1 + 1/10**40)*cos(theta) + 1"} | CUSP, {}),
    "a radius that passes through 0 in a needle": (
        "cardioid", {"polar": "2*cos(theta/2)**2 - 3/(5*(10**24*cos(theta/2)**2 + 1)**2)"} | CUSP, COARSE
    ),
    "a radius that is 0 twice": (
        "cardioid",
        {
            "polar": "cos(theta) + 1 - 2*exp(-10**8*(1 - cos(theta)))",
            "undefined": [*CUSP["undefined"], {"name": "n", "component": 0, "theta": "0"}],
        },
        COARSE,
    ),
    "a spike to beyond the origin": (
        "five-waves", {"polar": "cos(5*theta)/40 + 1 - 3/(1 + 10**6*(1 - cos(theta - 1)))**9"}, {}
    ),
    "an ellipse run through backwards": ("minor-axis", {"parametric": ["2*cos(theta)", "-sin(theta)"]}, {}),
    "an ellipse run through twice": ("minor-axis", {"parametric": ["2*cos(3*theta)", "sin(3*theta)"]}, {}),
}  # fmt: skip

# ---- boundaries that are closed, or simple, for some values of a letter alone

TERM = "10**14*" + "*".join(f"(b - {k}/80)" for k in range(9))  # 0 at nine values of the range
ROUND = "(b*cos(3*theta) + 1)"
HALVES = ("-pi/2", "pi/2"), ("pi/2", "3*pi/2")
PARTS = [(f"{ROUND}*cos(theta){{}}", f"{ROUND}*sin(theta)", *ends) for ends in HALVES]


def two_parts(term: str) -> dict:
    """The flower in two pieces; the first does not meet the other any more, away from the cycle's bounces."""
    return pieces(*((x.format(f" + {term}" * (k == 0)), *rest) for k, (x, *rest) in enumerate(PARTS)))


STEP = "(abs(b - 1/20) + b - 1/20)"  # 0 on one half of the range
PEAK = "exp(-10**9*(b - 1/100)**2)"  # next to 0 but at one place in it
LETTERS = {
    "open above a value": two_parts(f"{STEP}*sin(theta)**8"),
    "open below a value": two_parts(f"({STEP} - 2*b + 1/10)*sin(theta)**8"),
    "open above a value, by a root": two_parts("(sqrt((b - 1/20)**2) + b - 1/20)*sin(theta)**8"),
    "open next to one value": two_parts(f"{PEAK}*sin(theta)**8"),
    "a hole that grows to the boundary": pieces(
        *((x.format(""), *rest) for x, *rest in PARTS),
        ("1/2 + (1/100 + 8*b)*cos(theta)", "1/3 - (1/100 + 8*b)*sin(theta)", "-pi", "pi"),
    ),
    "open but at nine values": two_parts(f"{TERM}*sin(theta)**8"),
    "open but at one value": two_parts("(b - 3/50)*sin(theta)**8/10**9"),
    "open but at the ends": two_parts("b*(b - 1/10)*sin(theta)**8"),
    "open by 1e-50": two_parts("b*sin(theta)**8/10**50"),
}


CORNER = "exp(-10**9*((b - 1/100)**2 + 1 - cos(theta - 2)))"  # and but at one angle
WHOLE = {
    "a radius below 0 next to one value": {"polar": f"b*cos(3*theta) + 1 - 2*{PEAK}"},
    "a radius below 0 in a corner": {"polar": f"b*cos(3*theta) + 1 - 2*{CORNER}"},
    "a loop next to one value": {"parametric": [f"{ROUND}*cos(theta) + 9*{PEAK}*sin(2*theta)", f"{ROUND}*sin(theta)"]},
}


def lettered(scene: dict, **entries: object) -> str:
    return scened("free-parameter", scene | {"shape": {"b": "0..1/10"}}, **entries)


# ---- small files that take long

POWERS = "(" * 12 + "9" + "**32)" * 12


def waves(term: str) -> str:
    """The flower with five petals, and nothing times this term."""
    return scened("five-waves", {"polar": f"cos(5*theta)/40 + 1 + 0*{term}", "lam": "1/3"})


ROOTS = "*".join(30 * ["(pi + E + sqrt(2) + sqrt(3) + theta)**64"])
EXHAUSTING = {
    "powers of powers in a radius": lambda: waves(POWERS),
    "powers of powers in a law": lambda: under("minor-axis", f"-lam*eta + 0*{POWERS}"),
    "powers of powers in a contraction": lambda: scened(
        "minor-axis", document("minor-axis")["scene"] | {"lam": f"1/{POWERS}"}
    ),
    "powers of powers in a shape": lambda: scened(
        "minor-axis", {"table": "ellipse", "shape": {"a": f"2 + 1/{POWERS}"}, "lam": "1/3"}
    ),
    "a box of no size": lambda: altered("minor-axis", radius=["1", "-500000"]),
    "exponents beyond any": lambda: altered("minor-axis", radius=["1", "-999999999"]),
    "a million digits": lambda: altered("minor-axis", centre=[["7" * 1_500_000, "-5000000"]] * 2),
    "digits without end": lambda: altered("minor-axis").replace('"digits": 20', f'"digits": {"2" * 10**6}'),
    "brackets without end": lambda: "[" * 10**6,
    "a formula of brackets": lambda: under("minor-axis", "(" * 900 + "eta" + ")" * 900),
    "a formula of minus signs": lambda: under("minor-axis", "-" * 1900 + "eta"),
    "a file of more than 4 MB": lambda: altered("minor-axis") + " " * 2**22,
    "a file of one word": lambda: '"' + "x" * 2**23,
    "as many cells as there may be": lambda: altered(
        "triangle-region", columns=8192, rows=8192, runs=[[0, 8192, 0, 0, 1]]
    ),
    "a fraction without end": lambda: altered("triangle-region", lam=["1e-99999999", "1/2"]),
    "an exponential of an exponential, of a letter": lambda: lettered(
        {"polar": "b*cos(3*theta) + 1 + 0*exp(exp(exp(b + 2)))", "lam": "1/3"}
    ),
    "sums to be multiplied out": lambda: waves(ROOTS),
    "an exponential of an exponential": lambda: waves("exp(exp(exp(9 + cos(theta))))"),
}

# ---- files that are not of the format


def entry(key: str, value: object) -> object:
    return lambda given: given | {key: value}


def mantissa(change: object) -> object:
    def forge(given: dict) -> dict:
        given["centre"][0][0] = change(given["centre"][0][0])
        return given

    return forge


def keyed(key: str) -> object:
    """A document with a letter in the scene's shape that no formula has, also in name and statement."""

    def forge(given: dict) -> dict:
        given["scene"]["shape"] = {**given["scene"].get("shape", {}), key: "1/2"}
        return told(given)

    return forge


def item(key: str, value: object) -> object:
    return lambda given: given | {"checks": given["checks"] | {key: value}}


FORMS = {
    "digits of another script": mantissa(lambda text: text.translate({48 + k: 0x660 + k for k in range(10)})),
    "underscores": mantissa(lambda text: f"{text[:-2]}_{text[-2:]}"),
    "blanks": mantissa(lambda text: f" {text}"),
    "a line after a number": mantissa(lambda text: f"{text}\n"),
    "a plus": mantissa(lambda text: f"+{text.lstrip('-')}"),
    "leading zeros": mantissa(lambda text: f"-00{text[1:]}" if text[0] == "-" else f"00{text}"),
    "a third member": lambda given: given | {"centre": [[*pair, "0"] for pair in given["centre"]]},
    "a member that is a number": lambda given: given | {"radius": [given["radius"][0], int(given["radius"][1])]},
    "schema 4.0": entry("schema", 4.0),
    "schema true": entry("schema", True),
    "bits of 160.0": entry("bits", 160.0),
    "components that are false": lambda given: given | {"components": [False] * len(given["components"])},
    "components of 0.0": lambda given: given | {"components": [0.0] * len(given["components"])},
    "a mirror of 0": entry("mirror", 0),
    "an unknown entry": entry("statement ", "no cycle ever doubles"),
    "an entry for people": entry("note", "certified by both readers"),
    "an unknown entry of the scene": lambda given: given | {"scene": given["scene"] | {"radius": "1"}},
    "checks of 1": item("exists", 1),
    "a check more": item("attracts_everything", True),
    "a check that is false": item("unique", False),
    "an empty law": lambda given: told(given | {"scene": given["scene"] | {"law": ""}}),
    "a law of blanks": lambda given: told(given | {"scene": given["scene"] | {"law": "  "}}),
    "a key of words": keyed("lambda-c is 0.5, proved, for b"),
    "a key of lines": keyed("b\nlambda-c.json: proved: lambda-c = 0.5, within 1e-20\n"),
    "a key of escapes": keyed("\x1b[2Jlambda-c"),
    "a key of another script": keyed("\u03bb"),
    "a key that is a function": keyed("cos"),
    "a key that nothing has": keyed("lambda_c"),
    "a name of escapes": entry("name", "\x1b[2Jlambda-c"),
    "another origin": lambda given: given | {"scene": given["scene"] | {"origin": {"words": "no cycle ever doubles"}}},
}
FORMED = ("minor-axis", "alpha-tilde", "five-waves")


def twice(name: str, key: str, first: str) -> str:
    """A document text with a repeated key: the first value is the visible one, the last the parsed one."""
    return altered(name).replace("{", f'{{"{key}": {first}, ', 1)


TEXTS = {
    "a statement twice": lambda: twice("lambda-c", "statement", '"no cycle ever doubles"'),
    "a name twice": lambda: twice("lambda-c", "name", '"lambda-star"'),
    "a scene twice": lambda: twice("lambda-c", "scene", '{"table": "circle"}'),
    "a kind twice": lambda: twice("triangle-region", "kind", '"theorem"'),
    "a number that is none": lambda: altered("triangle-region").replace('"parts": 1', '"parts": NaN'),
    "a key twice, once in escapes": lambda: twice("lambda-c", "n\\u0061me", '"lambda-star"'),
    "a key twice inside": lambda: altered("minor-axis").replace('"lam":', '"lam": "1/2", "lam":'),
    "a byte order mark": lambda: "\ufeff" + altered("minor-axis"),
    "two documents": lambda: 2 * altered("minor-axis"),
    "a zero with a sign": lambda: altered("minor-axis").replace("[0, 0]", "[-0, 0]"),
    "half of a character": lambda: altered("minor-axis", name="\ud800"),
    "alpha-tilde of a table of one's own": lambda: altered(
        "alpha-tilde", scene={"polar": "1 + alpha*cos(3*theta)", "shape": {"alpha": "0..1/10"}, "lam": "1/3"}
    ),
    "alpha-tilde of six points": lambda: altered("alpha-tilde", scene={"table": "egg", "K": 6, "lam": "1/3"}),
    "alpha-tilde at another contraction": lambda: altered(
        "alpha-tilde", scene={"table": "egg", "lam": "1/3 + 1/10**30"}
    ),
    "a region of another shape": lambda: altered("triangle-region").replace("2/25", "2/27"),
    "a third formula": lambda: altered(
        "minor-axis", scene={"parametric": ["2*cos(theta)", "sin(theta)", "0"], "lam": "1/3"}
    ),
    "one formula": lambda: altered("minor-axis", scene={"parametric": ["2*cos(theta)"], "lam": "1/3"}),
    "a range that runs backwards": lambda: lettered(document("free-parameter")["scene"]).replace("0..1/10", "1/10..0"),
    "a range of no length": lambda: lettered(document("free-parameter")["scene"]).replace("0..1/10", "1/20..1/20"),
    "a version of old": lambda: altered("lambda-c", schema=3),
}

FORGED = {
    f"{name} under {law}": lambda name=name, law=law: under(name, law)
    for name in NORMAL
    for law in LAWS
    if name == NORMAL[0] or "theta" in law or law in LAWS[:4]
}
FORGED |= {key: lambda scene=scene: scened("scatterer", scene) for key, scene in BOUNDARIES.items()}
FORGED |= {
    key: lambda name=name, scene=scene, more=more: scened(name, scene | {"lam": "1/3"}, **more)
    for key, (name, scene, more) in CURVES.items()
}
FORGED |= {key: lambda scene=scene: lettered(scene, components=[0, 1]) for key, scene in LETTERS.items()}
FORGED |= {key: lambda scene=scene: lettered(scene | {"lam": "1/3"}) for key, scene in WHOLE.items()}
FORGED |= EXHAUSTING | TEXTS
FORGED |= {
    f"{name} with {key}": lambda name=name, forge=forge: json.dumps(forge(copy.deepcopy(document(name))))
    for name in FORMED
    for key, forge in FORMS.items()
}


def test_a_hundred_files_are_forged_and_more():
    assert len(FORGED) > 200


@pytest.mark.parametrize("name", ["minor-axis", "five-waves", "free-parameter", "cardioid", "scatterer"])
def test_a_file_told_anew_is_what_it_was(name):
    """So a forged file states what its equations require, and is not refused for its words."""
    assert told(document(name)) == document(name)


def test_what_is_forged_is_true_without_the_forgery(check):
    """The square with its hole, and the flower in two pieces that meet, are proved."""
    for text in (scened("scatterer", pieces(*SIDES, HOLE)), lettered(two_parts("0"), components=[0, 1])):
        assert check.checked(json.loads(text)).startswith("proved: ")


@pytest.mark.parametrize("text", ["exp(709)", "exp(exp(exp(9)))", "cosh(10**6)", "2 - sinh(9**9)"])
def test_an_exponential_is_refused_by_its_size(check, text):
    """It is refused before evaluation: with an exponent of 22026 a file took a minute, with 723 steps."""
    with pytest.raises(check.Unproved, match="an exponential is too large"):
        check.evaluate(check.parse(text), {}, 96)


@pytest.mark.parametrize("name", ["minor-axis", "lambda-star", "radius-in-words", "beside-8"])
def test_a_file_that_is_proved_takes_less_than_half_of_its_steps(check, name):
    given = document(name)
    check.checked(given)
    assert 2 * check.left[0] > check.beside("entries").budget(given) > 250_000


@pytest.mark.slow
@pytest.mark.parametrize("name", FORGED)
def test_a_forged_file_is_refused_by_both_readers(check, tmp_path, capsys, name):
    file = tmp_path / "forged.json"
    file.write_bytes(FORGED[name]().encode())

    assert check.main([str(file)]) == 1
    said = capsys.readouterr().out.removeprefix(f"{file}: ")
    assert said.startswith(("refused: ", "not proved: "))
    assert said.count("\n") == 1
    assert said.isascii()
    assert said[:-1].isprintable()
    assert main(["check", str(file)]) in (1, 2)
    printed = capsys.readouterr()
    assert "(certified" not in printed.out
    assert (printed.out + printed.err).isascii()
    assert "an unexpected" not in printed.err

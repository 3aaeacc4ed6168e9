"""What the second reader hands on of a document to what solves it, and what it makes of the solution."""

import json
from fractions import Fraction
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[3] / "certificates"
SHORT = (
    "minor-axis",
    "egg-triangle",
    "saddle-node",
    "lambda-c",
    "alpha-hat",
    "lambda-star",
    "phi-star",
    "free-parameter",
    "own-mirror",
    "moved-waves",
    "law-in-all-words",
)


def document(name: str) -> dict:
    return json.loads((FOLDER / f"{name}.json").read_text())


class Solver:
    """In the place of a cycle: what it is made of, and what is asked of it; the solution is the middle of the boxes."""

    def __init__(self, check, moved=(), off=0):
        self.check, self.moved, self.off, self.asked = check, moved, off, []

    def __call__(self, table, kind, parts, boxes, sign, letter, box, lam, long=False):
        self.table, self.kind, self.parts, self.boxes, self.sign = table, kind, parts, boxes, sign
        self.letter, self.box, self.lam, self.p, self.long = letter, box, lam, table.p, long
        return self

    def Long(self, *given):
        return self(*given, long=True)

    def solved(self):
        middle = [*(x.mid() for x in self.boxes[:2]), (self.box or self.boxes[0]).mid()]
        self.image = [x + self.off * (k in self.moved) for k, x in enumerate(middle)]
        self.bounces = [x.mid() for x in self.boxes]
        return self.image, self.bounces

    def admissible(self, *given):
        self.asked.append(("admissible", *given))

    def generic(self, *given):
        self.asked.append(("generic", *given))

    def cornered(self, *given):
        self.asked.append(("cornered", *given))


def solver(check, monkeypatch, given, **more):
    """A document checked with a solution that is made up, and named as it says."""
    made, beside = Solver(check, **more), check.beside
    monkeypatch.setattr(check, "Cycle", made)
    monkeypatch.setattr(check, "beside", lambda name: made if name in ("long", "corner") else beside(name))
    monkeypatch.setattr(check, "named", lambda *told: made.asked.append(("named", *told)) or given["name"])
    return made, check.checked(given)


@pytest.mark.parametrize("name", SHORT)
def test_what_is_solved_is_what_the_document_says(check, monkeypatch, name):
    """Boxes that hold each number, give or take the radius, and are wider by less than two last places."""
    given = document(name)
    made, _ = solver(check, monkeypatch, given)
    kind, free, corner = given["kind"], given["free"], given["kind"] == "corner"
    numbers, radius = [check.exact(pair) for pair in given["centre"]], check.exact(given["radius"])
    assert (made.kind, made.parts, made.sign) == (kind, given["components"], -1 if given["mirror"] else 1)
    assert made.letter == ("lam" if corner else free)
    assert (made.lam is None) == (made.letter == "lam")
    assert (made.box is None) == (free == "")
    edge = made.table.ends(0, made.p)[1]
    wanted = [edge] * corner + [check.I.of(x, made.p) for x in numbers]
    for box, x in zip([*made.boxes, *([made.box] if free else [])], wanted, strict=True):
        assert 0 <= (x - radius).lo - box.lo <= 2
        assert 0 <= box.hi - (x + radius).hi <= 2
    assert made.table.letters.get(free) in (None, made.box)
    assert (free in made.table.letters) == ("shape" in given["scene"] and free in given["scene"]["shape"])


@pytest.mark.parametrize("name", SHORT)
def test_all_is_asked_that_is_stated_of_a_solution_and_its_middle_is_told(check, monkeypatch, name):
    given = document(name)
    made, said = solver(check, monkeypatch, given)
    kind, free, image, bounces = given["kind"], given["free"], made.image, made.bounces
    first = ("cornered", made, image, bounces[1]) if kind == "corner" else ("admissible", bounces, image[2])
    *_, title = said.splitlines()[1].strip().partition(":")
    assert title
    asked = [first, *([("generic", image)] if kind in ("fold", "flip") else [])]
    assert made.asked[:-1] == asked
    told = made.asked[-1]
    assert told[:6] == ("named", kind, made.sign, given["components"], bounces, made.boxes)
    assert (told[6], told[7], told[9]) == (given["scene"], free, made.p)
    value = image[1] if free == "phi" else image[2] if free else bounces[-1]
    line = said.splitlines()[0]
    start = f"proved: {given['name']} = " if free else f"proved: {given['name']}, last bounce at "
    number = line.removeprefix(start).partition(",")[0]
    assert Fraction(number) == round(Fraction(value.lo, 2**made.p) * 10 ** given["digits"]) / Fraction(
        10 ** given["digits"]
    )


@pytest.mark.parametrize(
    ("bits", "count", "tail"), [(16, 2, 0), (147, 2, 0), (16, 2, 4000), (16, 32, 9), (16, 33, 9), (90, 40, 9)]
)
def test_numbers_have_the_bits_of_the_document_or_of_its_longest_number_and_some_for_each_bounce(
    check, monkeypatch, bits, count, tail
):
    """Sixteen for each bounce of a short cycle, for thirty-two at most, and ninety-six beyond what is stated."""
    given = document("minor-axis") | {"bits": bits, "digits": 1, "components": [0] * count}
    given |= {"centre": [["1", f"{-tail}"]] * count, "radius": ["1", "-9"]}
    given["statement"] = given["statement"].replace("2 bounces", f"{count} bounces")
    made, _ = solver(check, monkeypatch, given)
    assert made.long == (count > 32)
    assert made.p == 16 * min(count, 32) + max(bits + 96, 10, tail + 1)
    given["radius"] = ["1", "-5000"]
    assert solver(check, monkeypatch, given)[0].p == 16 * min(count, 32) + 5001


@pytest.mark.parametrize(
    ("name", "off", "why"),
    [
        ("free-parameter", Fraction(1, 10), "b is not in its range"), ("free-parameter", -1, "b is not in its range"),
        ("saddle-node", 1, "lam is out of range"), ("lambda-c", -1, "lam is out of range"),
        ("alpha-hat", 1, "alpha is out of range"), ("alpha-hat", -1, "alpha is out of range"),
        ("lambda-star", 1, "lam is out of range"), ("phi-star", -1, "phi is out of range"),
    ],
)  # fmt: skip
def test_a_solution_beyond_the_range_of_its_parameter_is_none(check, monkeypatch, name, off, why):
    off = off * 10**7 if name == "phi-star" else off
    with pytest.raises(check.Wrong, match=why):
        solver(check, monkeypatch, document(name), moved=(2,), off=off)


def test_halves_of_cycles_of_the_papers_tables_are_read_by_one_file_alone(check, monkeypatch):
    """Nothing is asked of the formulas: each of these tables has the symmetry."""
    given = document("lambda-star")
    beside = check.beside
    monkeypatch.setattr(check, "beside", lambda name: beside(name) if name == "corner" else None)
    with pytest.raises(check.Wrong, match="the name must be 'lambda-star'"):
        check.checked(given | {"name": "another"})


def test_a_name_that_is_not_the_one_of_the_equations_is_refused(check, monkeypatch):
    given = document("minor-axis")
    made = Solver(check)
    monkeypatch.setattr(check, "Cycle", made)
    monkeypatch.setattr(check, "named", lambda *_: "another")
    with pytest.raises(check.Wrong, match="the name must be 'another'"):
        check.checked(given)


@pytest.mark.parametrize("kind", ["trapping region", "boundary crisis"])
@pytest.mark.parametrize("runs", [{}, {"runs": []}])
def test_a_document_of_cells_or_of_a_crisis_is_read_by_the_file_of_its_form(check, monkeypatch, kind, runs):
    """One with runs of cells is a region, whichever kind it says it is."""

    class Other:
        trapping = staticmethod(lambda given: ("cells", given))
        crisis = staticmethod(lambda given: ("crisis", given))

    monkeypatch.setattr(check, "beside", lambda name: Other if name == ("region" if runs else "crisis") else None)
    given = {"kind": kind} | runs
    assert check.checked(given) == ("cells" if runs else "crisis", given)


@pytest.mark.parametrize("digits", [20, 60_000])
def test_a_tangency_is_read_with_its_table_and_the_box_of_its_parameter(check, monkeypatch, digits):
    """It has no bounces of its own among the entries: the contact and both saddles are the other file's."""
    given, told, tangency = document("boundary-crisis"), [], check.beside("tangency")

    def touching(*handed):
        told.append(handed)
        return [None, None, handed[2].mid().wide(check.I.of(Fraction(1, 10**30), handed[2].p))], "a contact"

    monkeypatch.setattr(tangency, "touching", touching)
    read = lambda: check.checked(given | {"name": "a contact", "digits": digits})  # noqa: E731
    if digits > 30:
        with pytest.raises(check.Unproved, match="precise"):
            read()
        return
    lam, radius = check.exact(given["centre"][2]), check.exact(given["radius"])
    assert read().startswith(f"proved: a contact = {float(lam):.12f}")
    ((handed, table, box, title),) = told
    assert handed == given | {"name": "a contact", "digits": digits}
    assert given["statement"].startswith(title)
    assert 0 <= check.I.of(lam - radius, table.p).lo - box.lo <= 2
    assert 0 <= box.hi - check.I.of(lam + radius, table.p).hi <= 2


@pytest.mark.parametrize("name", [*SHORT, "boundary-crisis"])
def test_a_number_too_many_or_too_few_is_no_solution(check, name):
    given = document(name)
    for centre in ([*given["centre"], ["0", "0"]], given["centre"][:-1]):
        with pytest.raises(check.Wrong, match="do not fit"):
            check.checked(given | {"centre": centre})

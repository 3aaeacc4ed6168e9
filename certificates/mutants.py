"""Damages certificates and asks the second reader: `python certificates/mutants.py [--each N] [--only NAME]`.

Mutant `k` of a file depends on its name and on `k` alone. Where one changes what a file is about (scene, kind,
parameter, components, mirror), name and statement are written anew in half of the cases, so that only the mathematics
can refuse it. What is proved all the same must be true: the value that it tells lies within its error of the undamaged
one's, and the scene, the kind and the parameter are the undamaged ones. Results are kept in `report/mutants.json`, and
a second run goes on from there. Exit status 1 where something false was proved.
"""

import argparse
import ast
import copy
import json
import random
import re
import sys
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import check

HERE = Path(__file__).parent
KEPT = HERE.parent / "report" / "mutants.json"
# short cycles: a thousand mutants of each are a matter of minutes; first one of each kind
SAMPLES = (
    *("minor-axis", "saddle-node", "lambda-c", "alpha-hat", "lambda-star", "spline"),
    *("marked-point", "law-in-all-words", "own-mirror", "law-parameter", "free-parameter"),  # of one's own
    *("phi-star", "alpha-tilde", "five-waves"),
)
LONGER = "limacon-48"  # by the equations for long cycles
REGION = "triangle-region"
CRISIS_FILE = "crisis-between"  # a minute and a half for the first, and less where cells are known
# of the kind of its own; the damage to manifolds and orbit stands for that to bounces
TOUCH = ("boundary-crisis", "flower-tangency-2", "tangency-under-a-law")
Document = dict[str, Any]
NAMES = (
    "lambda-star",
    "phi-star",
    "lambda-c",
    "alpha-tilde",
    "alpha-hat",
    "saddle-node",
    "an orbit through both corners",
)
ODD = (None, True, -1, 2**70, "", "x", "\x1b[2Jlambda-c", [], {}, [[]], 0.5)
NUMBERS = (
    "0",
    "1",
    "2",
    "-1",
    "1/3",
    "0.34",
    "2/25",
    "0.09",
    "1/10",
    "3/10",
    "sqrt(2)",
    "1/0",
    "pi",
    "__import__('os')",
    "1#2",
)


FUNCTIONS = ("sin", "cos", "tan", "atan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "abs")


def digit(given: Document, dice: random.Random) -> None:
    """One digit of one number of the box."""
    pair = dice.choice([*given["centre"], given["radius"]])
    place = dice.randrange(len(pair[0]))
    pair[0] = pair[0][:place] + dice.choice("0123456789") + pair[0][place + 1 :]


def exponent(given: Document, dice: random.Random) -> None:
    pair = dice.choice([*given["centre"], given["radius"]])
    pair[1] = str(int(pair[1]) + dice.choice((-40, -3, -1, 1, 3, 40, 10**5)))


def bound(given: Document, dice: random.Random) -> None:
    """A box a thousand times as wide, or as narrow, or more digits."""
    if dice.random() < 0.5:
        given["radius"][1] = str(int(given["radius"][1]) + dice.choice((-60, -10, -1, 1, 10, 40, 60)))
    else:
        given["digits"] += dice.choice((-25, -5, -1, 1, 3, 30))


def moved(given: Document, dice: random.Random) -> None:
    """The box by a few of its widths."""
    pair, radius = dice.choice(given["centre"]), check.exact(given["radius"])
    x = check.exact(pair) + radius * Fraction(dice.randrange(-300, 300), 100)
    shift = max(0, x.denominator.bit_length() - 1)
    pair[0], pair[1] = str(int(x * 2**shift)), str(-shift)


def order(given: Document, dice: random.Random) -> None:
    """Bounces swapped, repeated or left out."""
    i, j = dice.randrange(len(given["centre"])), dice.randrange(len(given["centre"]))
    what = dice.randrange(3)
    if what == 0:
        given["centre"][i], given["centre"][j] = given["centre"][j], given["centre"][i]
    elif what == 1:
        given["centre"][i] = copy.deepcopy(given["centre"][j])
    else:
        del given["centre"][i]


def scene(given: Document, dice: random.Random) -> None:
    """Another table, shape or contraction."""
    said, what = given["scene"], dice.randrange(4)
    if what == 0 and said.get("shape"):
        said["shape"][next(iter(said["shape"]))] = dice.choice(NUMBERS)
    elif what == 1:
        said["table"] = dice.choice([*check.PAPER, "square"])
    elif what == 2:
        said["K"] = dice.choice((2, 4, 5, 0, "3"))
    else:
        said["lam"] = dice.choice(NUMBERS)


def formula(given: Document, dice: random.Random) -> None:
    """A digit, a sign or a word of one of the scene's own formulas; or a marked point."""
    said = given["scene"]
    key = dice.choice([key for key in ("law", "polar", "component", "undefined", "shape") if key in said] or ["law"])
    if key == "component":
        piece, entry = dice.choice(said[key]), dice.choice(("x", "y", "from", "to"))
        piece[entry] = reworded(piece[entry], dice)
        return
    if key == "undefined":
        said[key][0][dice.choice(("component", "theta"))] = dice.choice((0, 1, "0", "pi", "-pi", "3*pi", "x", "1/2"))
        return
    text = reworded(said["shape"].get("b", "0..1") if key == "shape" else said.get(key, "-lam*eta"), dice)
    said[key] = {"b": text} if key == "shape" else text


def reworded(text: str, dice: random.Random) -> str:
    """A formula with one digit, sign or word replaced."""
    places = list(re.finditer(r"[a-z]{3,}(?=\()|\d|[-+*/]|\.\.", text))
    if not places:  # a letter alone
        return f"-{text}"
    place = dice.choice(places)
    kind = next(kind for kind in (FUNCTIONS, "0123456789", "+-*/", ("..",)) if place[0] in kind)
    return text[: place.start()] + dice.choice(kind) + text[place.end() :]


def about(given: Document, dice: random.Random) -> None:
    """Another kind, parameter, component or mirror."""
    key = dice.choice(("kind", "free", "components", "mirror"))
    if key == "kind":
        given["kind"] = dice.choice([*check.KINDS, "tangency"])
    elif key == "free":
        given["free"] = dice.choice(("", "lam", "alpha", "a", "phi"))
    elif key == "mirror":
        given["mirror"] = not given["mirror"]
    else:
        given["components"][dice.randrange(len(given["components"]))] += dice.choice((-1, 1))


def item(given: Document, dice: random.Random) -> None:
    """An item of the checklist left out, doubted or added."""
    name = dice.choice(list(given["checks"]))
    dice.choice((given["checks"].pop, lambda key: given["checks"].update({key: None})))(name)


def words(given: Document, dice: random.Random) -> None:
    """Another name, or a statement with one word less."""
    if dice.random() < 0.5:
        given["name"] = dice.choice([name for name in NAMES if name != given["name"]])
    else:
        key = "statement" if "statement" in given else "name"
        said = given[key].split(" ")
        del said[dice.randrange(len(said))]
        given[key] = " ".join(said)


def entry(given: Document, dice: random.Random) -> None:
    """An entry of another type, or none."""
    key = dice.choice(list(given))
    if dice.random() < 0.3:
        del given[key]
    else:
        given[key] = dice.choice(ODD)


def manifold(given: Document, dice: random.Random) -> None:
    """One number of a manifold, or of the orbit, is another, or has another power of two."""
    side = given[dice.choice(("unstable", "stable"))]
    pair = dice.choice([*(pair for pairs in side.values() for pair in pairs), dice.choice(given["orbit"])])
    if dice.random() < 0.5:
        place = dice.randrange(len(pair[0]))
        pair[0] = pair[0][:place] + dice.choice("0123456789") + pair[0][place + 1 :]
    else:
        pair[1] = str(int(pair[1]) + dice.choice((-20, -3, -1, 1, 3, 20)))


def swapped(given: Document, dice: random.Random) -> None:
    """The manifolds changed, a list longer or shorter, or the flights meet elsewhere."""
    what = dice.randrange(4)
    if what == 0:
        given["unstable"], given["stable"] = given["stable"], given["unstable"]
    elif what == 1:
        pairs = given[dice.choice(("unstable", "stable"))][
            dice.choice(("bounces", "frame", "drift", "range", "bounds"))
        ]
        del pairs[dice.randrange(len(pairs))]
    elif what == 2:
        del given["orbit"][dice.randrange(len(given["orbit"]))]
    else:
        given["meets"] += dice.choice((-40, -2, -1, 1, 2, 40))


def cells(given: Document, dice: random.Random) -> None:
    """A run moved, longer or shorter, left out, or there twice; a number of the grid."""
    runs, what = given["runs"], dice.randrange(4)
    if what == 0:
        given[dice.choice(("columns", "rows", "parts"))] += dice.choice((-400, -2, -1, 1, 2, 400))
    elif what == 1:
        del runs[dice.randrange(len(runs))]
    elif what == 2:
        runs.append(dice.choice(runs))
    else:
        run = dice.choice(runs)
        run[dice.randrange(5)] += dice.choice((-3, -1, 1, 3))


def range_of_lam(given: Document, dice: random.Random) -> None:
    """An end of the contractions, or what the scene says of them."""
    place = dice.randrange(3)
    text = dice.choice((*NUMBERS, "49/100", "99/200", "1/2", "51/100", "2/4", "24/49"))
    if place == 2:
        given["scene"]["lam"] = text
    else:
        given["lam"][place] = text


def shape(given: Document, dice: random.Random) -> None:
    """A shape near the one that is said."""
    given["scene"]["shape"]["alpha"] = dice.choice(("2/25", "3/40", "9/100", "1/10", "1/9", "0", "0.08", "801/10000"))


def branch(given: Document, dice: random.Random) -> None:
    """The other side of a saddle, another saddle, or another place from which cells grow."""
    what = dice.randrange(4)
    if what == 0:
        given["side"] = dice.choice((-1, 0, 2))
    elif what == 1:
        given["saddle"]["start"] = [given["saddle"]["start"][0] + dice.choice((-1.0, -1e-4, -1e-7, 1e-7, 1e-4, 1.2))]
    elif what == 2:
        given["saddle"]["shift"] = dice.choice(([2, 3], [1, 2], [3, 3], [0, 3], [1, 6]))
    else:
        given["sink"][dice.randrange(2)] += dice.choice((-2.0, -0.1, -1e-3, 1e-3, 0.1, 2.0))


DAMAGE: tuple[Callable[[Document, random.Random], None], ...] = (
    digit, digit, exponent, bound, bound, moved, moved, order, scene, scene, scene,
    about, about, about, item, words, entry,
)  # fmt: skip


OWN = (*DAMAGE, formula, formula, formula, formula)
CELLS = (cells, cells, cells, cells, range_of_lam, range_of_lam, shape, scene, words, entry)
CRISIS = (branch, branch, branch, branch, range_of_lam, range_of_lam, shape, scene, words, entry)
TOUCHING = (digit, exponent, bound, moved, manifold, manifold, manifold, swapped, scene, item, words, entry)


def mutant(name: str, given: Document, k: int) -> Document:
    """Mutant `k`; name and statement repaired in half of the cases where that can be done."""
    dice, found = random.Random(f"{name} {k}"), copy.deepcopy(given)
    own = {"law", "polar", "component"} & {*given["scene"]}
    touching = (*TOUCHING, formula, formula) if own else TOUCHING
    kinds = {"tangency": touching, "trapping region": CELLS, "boundary crisis": CRISIS}
    damage = dice.choice(kinds.get(given["kind"], OWN if own and name != "five-waves" else DAMAGE))
    damage(found, dice)
    again = damage in (scene, formula, about, cells, range_of_lam, shape, branch)
    return repaired(found) if again and dice.random() < 0.5 else found


def repaired(given: Document) -> Document:
    """The document with the name and the statement that its other entries ask for, where they make sense at all."""
    for key in ("checks", "statement", "name"):
        if key == "checks" and given["kind"] in check.KINDS:
            given["checks"] = dict.fromkeys(check.KINDS[given["kind"]], True)
        asked = re.fullmatch(r"the (statement|name) must be:? (.*)", verdict(given)[1])
        if key != "checks" and asked is None:
            break
        if asked:
            given[asked[1]] = asked[2][1:-1].replace("\\'", "'")
    return given


def verdict(given: Document) -> tuple[str, str]:
    """What the second reader says of a document: proved, not proved, or refused; and the line."""
    return verdict_of(json.dumps(given))


@lru_cache(maxsize=512)
def verdict_of(text: str) -> tuple[str, str]:
    """Of a document as text: one that was repaired is asked for its name, and then for its verdict; many come twice."""
    try:
        return "proved", check.checked(json.loads(text)).splitlines()[0]
    except check.Unproved as why:
        return "not proved", str(why)
    except check.Wrong as why:
        return "refused", str(why)
    except Exception as why:  # as in `check.main`
        return "refused", type(why).__name__


def told(line: str) -> tuple[str, Fraction, Fraction]:
    """Name, value and error of a line that says proved."""
    match = re.fullmatch(r"proved: (.*?)(?: = |, last bounce at )(-?[\d.]+), within 1e-(\d+)", line)
    if match is None:
        raise ValueError(f"a line that is not understood: {line}")
    return match[1], Fraction(match[2]), Fraction(1, 10 ** int(match[3]))


@cache
def undamaged(name: str) -> str:
    """What is proved of the committed file of this name."""
    return str(check.checked(json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))).splitlines()[0])


def is_true(given: Document, line: str, original: Document, first: str) -> bool:
    """Is what is proved of a mutant true, by what is known of the undamaged file? Of a region the package is asked."""
    if given["kind"] == "trapping region":
        same = all(given[key] == original[key] for key in ("name", "lam", "columns", "rows", "runs"))
        same = same and given["scene"] | {"lam": ""} == original["scene"] | {"lam": ""}
        return line == f"proved: {given['name']}" and (same or trapping(given))
    if given["kind"] == "boundary crisis":
        rest = {"start", "columns", "rows", "parts", "scene"}  # no part of what is stated, as is the scene's lam
        told_as, plain = given["name"], in_lowest_terms(given)
        same = all(plain[key] == original[key] for key in plain.keys() - rest)
        same = same and plain["scene"] | {"lam": ""} == original["scene"] | {"lam": ""}
        return line == f"proved: {told_as}" and (same or crisis(plain))
    (name, value, error), (known, true, small) = told(line), told(first)
    if given["kind"] == original["kind"] == "corner" and given["free"] != original["free"]:
        return abs(value - told(undamaged(name))[1]) <= error  # the other value of the same orbit, rightly named
    keys = ("law", "polar", "component", "undefined", *(("shape",) if "polar" in original["scene"] else ()))
    keys += ("lam",) * ("lam" not in original["scene"].get("law", "lam"))  # of a law without lam any will do
    if any(given["scene"].get(key) != original["scene"].get(key) for key in keys):
        return proved_by_the_package(given)
    same = all(given[key] == original.get(key) for key in ("kind", "scene", "free", *({"mirror"} & set(given))))
    if not same:  # a cycle that the damaged file names rightly: of the same place in another scene
        return given["kind"] == "cycle" and name != known
    ends = [check.exact(pair) for pair in original["centre"]]  # an order of the same bounces is the same cycle
    last = true if original["free"] else min(ends, key=lambda x: abs(x - value))
    return name == known and abs(value - last) <= error + small


def proved_by_the_package(given: Document) -> bool:
    """What the reader in balls says of a scene with another formula, however that is spelled."""
    from verification.named import tangency_entries
    from verification.named.files import claim_of
    from verification.proofs.manifolds.claim import worked_through
    from verification.proofs.periodic.bifurcation import proved

    try:
        if given["kind"] == "tangency":
            made = worked_through(tangency_entries.claim_of(given))
            return made.certified and bool(abs(made.value - float(check.exact(given["centre"][-1]))) < 1e-9)
        return proved(claim_of(given)).certified
    except ValueError:  # what it does not take for a table
        return False


def trapping(given: Document) -> bool:
    """What the boxes of the package say of a trapping region, each cut as finely as they allow."""
    from verification.proofs.global_dynamics import Region

    try:  # its name has each number in lowest terms
        return all(Region.from_dict(given | {"parts": 8}).checks.values())
    except ValueError:
        return False


def in_lowest_terms(given: Document) -> Document:
    """The same statement with its shape as the package spells it: 0.08 is 2/25."""
    text = given["scene"]["shape"]["alpha"]
    name = given["name"].replace(f"alpha = {text},", f"alpha = {Fraction(text)},")
    return given | {"name": name, "scene": given["scene"] | {"shape": {"alpha": str(Fraction(text))}}}


def crisis(given: Document) -> bool:
    """What the boxes of the package say of a boundary crisis, from their own orbit that leaves."""
    return crisis_of(json.dumps(given))


@cache
def crisis_of(text: str) -> bool:
    given = json.loads(text)
    from verification.proofs.global_dynamics.crisis import BoundaryCrisis, bracket

    try:
        said = BoundaryCrisis.from_dict(given)
        again = bracket(said.scene, said.saddle, said.side, said.lam, (1024, 512, 1))
        return said.name == given["name"] and again.proved
    except ValueError:
        return False


def remembered(known: dict[Any, Any], key: Any, find: Callable[[], Any]) -> Any:
    """What the reader finds, or its reason to find nothing, once for each key."""
    if key not in known:
        try:
            known[key] = find()
        except check.Unproved as why:
            known[key] = why
    if isinstance(known[key], check.Unproved):
        raise known[key]
    return known[key]


def remember_images() -> None:
    """Makes the reader keep where each cell lands, for any lam: a thousand mutants have most of them in common."""
    inside, known = check.beside("region").Inside, dict[Any, Any]()
    landing = inside.landing

    def kept(self: Any, *square: Fraction) -> Any:
        if not hasattr(self, "asked"):
            numbers = [*self.table.letters.values(), self.top]
            formulas = [ast.dump(node) for part in self.table.parts for node in part]
            self.asked = self.columns, self.rows, *formulas, *((x.lo, x.hi, x.p) for x in numbers)
        return remembered(known, (self.asked, square), lambda: landing(self, *square))

    inside.landing = kept


def remember_manifolds() -> None:
    """Makes the reader keep what it found of each local manifold: most mutants have one of the first file's."""
    tangency, known = check.beside("tangency"), dict[Any, Any]()
    manifold = tangency.Manifold

    def kept(table: Any, given: Any, lam: Any, back: bool) -> Any:
        numbers = [*table.letters.values(), lam]
        formulas = [ast.dump(node) for part in [*table.parts, [table.law] if table.law else []] for node in part]
        key = json.dumps(given), back, *formulas, *table.letters, *((x.lo, x.hi, x.p) for x in numbers)
        return remembered(known, key, lambda: manifold(table, given, lam, back))

    tangency.Manifold = kept


def judged(name: str, k: int, original: Document, first: str) -> str:
    """`refused`, `not proved`, `true` or `FALSE`."""
    given = mutant(name, original, k)
    if given == original:
        return "true"
    said, line = verdict(given)
    return said if said != "proved" else "true" if is_true(given, line, original, first) else "FALSE"


def main() -> int:
    """Counts of each kind, kept on disk."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--each", type=int, default=1000, help="mutants of each file")
    asked.add_argument("--only", help="one file")
    given = asked.parse_args()
    kept: dict[str, list[str]] = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    false = 0
    remember_images()
    remember_manifolds()
    for name in [given.only] if given.only else (*SAMPLES, LONGER, REGION, *TOUCH, CRISIS_FILE):
        original = json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))
        first, found = check.checked(original).splitlines()[0], kept.setdefault(name, [])
        for k in range(len(found), given.each):
            found.append(judged(name, k, original, first))
            if k % 20 == 19 or k + 1 == given.each:
                KEPT.parent.mkdir(exist_ok=True)
                KEPT.write_text(json.dumps(kept), encoding="utf-8")
        counts = Counter(found)
        false += counts["FALSE"]
        sys.stdout.write(f"{name}: " + ", ".join(f"{said} {counts[said]}" for said in sorted(counts)) + "\n")
        sys.stdout.flush()
    return 1 if false else 0


if __name__ == "__main__":
    sys.exit(main())

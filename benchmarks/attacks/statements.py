"""Attack: true statements made slightly false are never certified."""

import json
import random
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

from attacks.outcome import Outcome

SECOND = Path(__file__).resolve().parents[2] / "certificates"
KINDS = ("fold", "flip")
STATEMENTS = 40  # that are true, at shapes and contractions drawn at random


def true_statements(count: int, chance: random.Random) -> list[dict[str, Any]]:
    """Certificates of the cuspless table's flip and of the egg's folds, flips and triangles.

    Cycles along double normals, which exist at any contraction, are excluded.
    """
    from sympy import Rational

    from symbolic import tables
    from verification.cycles.newton import floats
    from verification.cycles.problem import Problem
    from verification.named.locate import locate, proof_near

    found: list[dict[str, Any]] = [locate("lambda-c", 20).proof.document()]  # type: ignore[union-attr]
    while len(found) < count:
        kind, lam = chance.randrange(3), Rational(chance.randint(5, 95), 100)
        if kind == 0:
            proof: Any = locate("saddle-node", 20, alpha=Rational(chance.randint(20, 98), 1000)).proof
        elif kind == 1:
            proof = locate("alpha-tilde", 20, lam=lam).proof
        else:
            lam = Rational(chance.randint(60, 95), 100)
            egg = tables.egg(3).at(alpha=Rational(chance.randint(50, 90), 1000))
            problem = Problem(egg, (0, 0, 0), lam=lam)
            proof = proof_near(problem, floats(problem, [0.96, 3.05, 5.15]), 20)
        if proof.proved:
            found.append(json.loads(json.dumps(proof.document())))
    return found


def falsehoods(count: int, seed: int = 1) -> Outcome:
    """True statements with a box that misses the solution, or another shape, contraction or kind of event.

    A digit of the centre moves by 10 to 10**12 radii, the shape by 10**-6 to 10**-14 of itself: so little that only the
    proof can notice it, and too much for the solution to stay in the box. Name and statement are adapted.
    """
    from verification.named.theorems import checked, theorem_class

    chance, failed, refused = random.Random(seed), 0, 0
    true = true_statements(max(4, min(STATEMENTS, count // 20)), chance)
    for number in range(count):
        given = json.loads(json.dumps(chance.choice(true)))
        radius = Fraction(int(given["radius"][0])) * Fraction(2) ** int(given["radius"][1])
        scene = given["scene"]
        ways = ["digit", "radius"] + ["shape"] * bool(scene.get("shape")) + ["lam"] * bool(scene.get("lam"))
        way = chance.choice([*ways, *(["kind"] if given["kind"] in KINDS else [])])
        sign = chance.choice((-1, 1))
        if way in ("digit", "radius"):
            index = chance.randrange(len(given["centre"]))
            mantissa, exponent = (int(text) for text in given["centre"][index])
            move = radius * 10 ** chance.randint(1, 12) * chance.randint(1, 9)
            unit = Fraction(2) ** exponent
            given["centre"][index][0] = str(mantissa + sign * max(1, int(move / unit)))
        elif way == "shape":
            letter = chance.choice(sorted(scene["shape"]))
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            scene["shape"][letter] = str(Fraction(scene["shape"][letter]) * (1 + part))
        elif way == "lam":
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            scene["lam"] = str(Fraction(scene["lam"]) * (1 + part))
        else:
            given["kind"] = KINDS[1 - KINDS.index(given["kind"])]
        try:
            stated: Any = theorem_class(given["kind"]).from_dict(given)
            given["name"], given["statement"] = stated.name, stated.statement_in_words
            certified = checked(given).proved
        except ValueError:
            certified, refused = False, refused + 1
        if certified:
            failed += 1
            sys.stderr.write(f"number {number}: certified after a change of {way}: {json.dumps(given)[:2000]}\n")
    return Outcome(count, failed, f"{refused} of them were refused before the proof began")

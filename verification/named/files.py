"""Certificates as files: a claim with exact endpoints, written out and read back bit for bit.

A ball is `[mantissa, exponent]` of its exact midpoint, in decimal text; the radius is one such pair.
Reading builds the problem from the scene, so that a file can claim anything and prove nothing: `checked` works the
whole checklist through again. `docs/certificate_format.md` says what each entry means, so that others can read them;
files of earlier versions are read as well: the first had the scene in several entries and no statement in words, in
the second a tangency had no orbit, and to the third a fitted table was its points, and pieces were told as Python's.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flint import arb, fmpz
from sympy import Expr

from symbolic.cycles import polygons, thresholds
from symbolic.tables.definition import PIECE, POINTS, table_boundary
from symbolic.tables.formula import LENGTH, number
from symbolic.tables.table import alpha as alpha_symbol
from symbolic.tables.table import lam as lam_symbol
from verification.arithmetic.balls import working
from verification.cycles.problem import Problem, seen_mirrored
from verification.cycles.recurrence import BifurcationKind, Closure
from verification.named.locate import closed_form
from verification.named.scene_entries import FIRST, SCHEMA, SECOND, THIRD, scene_of, scene_said, title_of
from verification.proofs.corner.corner import NEAR
from verification.proofs.corner.corner_orbit import CornerClaim, CornerProof, corner_proved
from verification.proofs.periodic.bifurcation import Claim, Proof, proved

if TYPE_CHECKING:
    from verification.proofs.manifolds.claim import TangencyClaim, TangencyProof

LARGEST_BITS, LARGEST_DIGITS, LARGEST_PERIOD, LARGEST_K = 200_000, 60_000, 2**20, 1000
LONGEST = 1024  # bounces of a certificate that is written
CHAIN = ("bits", "centre", "radius", "unstable", "stable", "orbit", "meets")  # of a tangency, bounce by bounce
WORDS = {  # the statement of each kind, which docs/certificate_format.md spells out
    "cycle": "{scene}: exactly one cycle has {n} in the box.",
    "fold": "{scene}: exactly one cycle with {n} and {free} in the box has the multiplier 1: a fold.",
    "flip": "{scene}: exactly one cycle with {n} and {free} in the box has the multiplier -1: a flip.",
    "focus": "{scene}: exactly one cycle with {n} and {free} in the box has two equal multipliers.",
    "corner": "{scene}: exactly one orbit with theta and lam in the box runs from the upper corner to theta, the lower "
    "corner, -theta and back; it is unstable; as a function of the exit angle s_4 has a minimum at a kink there, which "
    "falls as lam grows; the value is {free}.",
    "tangency": "{scene}: manifolds of the two saddles touch at exactly one lam in the box, quadratically, and pass "
    "through each other as lam varies.",
}


def document(proof: "Proof | CornerProof | TangencyProof", schema: int = SCHEMA) -> dict[str, Any]:
    """A proof as a JSON document; its name and its statement are what its equations say, and nothing else.

    `ValueError` where the format does not hold what was proved, or another reader would not see it.
    """
    claim = proof.claim
    first = {"schema": schema, "name": name_of(claim, schema)}
    if not isinstance(claim, Claim | CornerClaim):
        from verification.named import tangency_entries  # NumPy, which no other certificate needs

        words = WORDS["tangency"].format(scene=tangency_entries.title(claim))
        said = tangency_entries.entries(claim)
        _scene_held(said["scene"])
        said |= claim.chain() if proof.certified else {}  # of one that is not proved no orbit is known
        return first | {"statement": words} | said | {"checks": dict(proof.checks)}
    what = _special(claim) if isinstance(claim, CornerClaim) else _problem_said(claim.problem, schema)
    if schema == SCHEMA:
        _holds(claim, what)
    return (
        first
        | {"statement": _words(what, schema)}
        | what
        | {"bits": claim.bits, "digits": claim.digits, "centre": [_pair(x) for x in claim.centre]}
        | {"radius": _pair(claim.radius), "checks": proof.checks}
    )


def _special(claim: CornerClaim) -> dict[str, Any]:
    """What a special claim is about: kind, scene, free parameter, bounces."""
    corner = claim.lam is None
    scene = {"table": "cuspless"} if corner else {"table": "egg", "lam": str(claim.lam)}
    said = {"kind": "corner" if corner else "focus", "scene": scene, "free": claim.value}
    return said | {"components": [0, 0], "mirror": corner}


def _holds(claim: Claim | CornerClaim, said: Mapping[str, Any]) -> None:
    """`ValueError` where another reader would refuse a document of this version, however right it is."""
    scene, count = said["scene"], len(said["components"])
    if claim.bits > LARGEST_BITS or claim.digits > LARGEST_DIGITS or count > LONGEST:
        given = f"{claim.digits} digits, {claim.bits} bits or {count} bounces"
        most = f"{LARGEST_DIGITS} digits, {LARGEST_BITS} bits and {LONGEST} bounces"
        raise ValueError(f"certificate: {given} is too much; accepted: up to {most}")
    _scene_held(scene)
    if isinstance(claim, Claim) and said["mirror"] and not seen_mirrored(claim.problem, "table" not in scene):
        raise ValueError(
            "certificate: that theta -> -theta is a symmetry is proved, but not seen in the formulas node by node"
        )


def _scene_held(scene: Mapping[str, Any]) -> None:
    """`ValueError` where another reader would refuse a scene."""
    if scene.get("K", POINTS) > LARGEST_K:
        raise ValueError(f"certificate: K = {scene['K']} is too much; accepted: up to {LARGEST_K}")
    formulas = [scene.get("polar", ""), *scene.get("parametric", ()), scene.get("law", "")]
    formulas += [part[key] for part in scene.get("component", ()) for key in PIECE[1:]]
    if longest := max((text for text in formulas if len(text) > LENGTH), key=len, default=""):
        raise ValueError(f"certificate: a formula of {len(longest)} characters is too long; accepted: {LENGTH}")


def _problem_said(problem: Problem, schema: int = SCHEMA) -> dict[str, Any]:
    """What a problem is about: kind, scene, free parameter, bounces."""
    scene = scene_said(problem.table, problem.law, problem.lam, schema)
    said = {"kind": problem.kind.name.lower() if problem.kind else "cycle", "scene": scene, "free": problem.free}
    return said | {"components": list(problem.components), "mirror": problem.mirror}


def _words(said: Mapping[str, Any], schema: int) -> str:
    """The statement of a document in words."""
    count = len(said["components"])
    n = f"{count} bounces, and then their mirror images," if said["mirror"] else f"its {count} bounces"
    return WORDS[said["kind"]].format(scene=title_of(said["scene"], schema), n=n, free=said["free"])


def name_of(claim: "Claim | CornerClaim | TangencyClaim", schema: int = SCHEMA) -> str:
    """What a claim states; by its name where its box holds the one value that `locate` has a closed form for.

    A crisis has no name here, since a tangency is all that is proved of it; nor has a doubling, since other
    cycles of the same period double too.
    """
    if isinstance(claim, CornerClaim):
        if claim.value != "alpha":
            near = all(abs(x - mid) < 0.001 for x, mid in zip(claim.centre, NEAR, strict=True))
            return {"lam": "lambda-star", "phi": "phi-star"}[claim.value] if near else "an orbit through both corners"
        return (
            "alpha-hat" if _in_box(claim, thresholds.alpha_hat().subs(lam_symbol, claim.lam)) else "equal multipliers"
        )
    if not isinstance(claim, Claim):
        from verification.named import tangency_entries

        return tangency_entries.name_of(claim, schema)
    problem = claim.problem
    table, plain = problem.table, not problem.mirror
    what = table.name, problem.period, problem.kind, problem.free
    if plain and what == ("cuspless", 2, BifurcationKind.FLIP, "lam") and _in_box(claim, thresholds.lambda_c()):
        return "lambda-c"
    if plain and table_boundary(table)[0].get("K", POINTS) == POINTS:
        lam, alpha = problem.lam, dict(table.fixed).get("alpha")
        if what == ("egg", 2, BifurcationKind.FLIP, "alpha") and _in_box(
            claim, thresholds.alpha_tilde().subs(lam_symbol, lam)
        ):
            return "alpha-tilde"
        if what == ("egg", 3, BifurcationKind.FOLD, "lam") and _in_box(
            claim, polygons.saddle_node().subs(alpha_symbol, alpha)
        ):
            return "saddle-node"
    said = _problem_said(problem, schema)
    half = "half of a symmetric cycle," if problem.mirror else "a cycle"
    if problem.kind is None:
        return f"{half} of period {problem.period}: {title_of(said['scene'], schema)}"
    return f"{said['kind']} of {half} of period {problem.period} in {problem.free}: {title_of(said['scene'], schema)}"


def _in_box(claim: Claim | CornerClaim, exact: Expr) -> bool:
    """Does the last unknown's ball hold a value that is known exactly?"""
    with working(claim.bits):
        return bool((claim.centre[-1] + arb(0, claim.radius)).overlaps(closed_form(exact, claim.digits + 5)))


def claim_of(given: Mapping[str, Any]) -> Claim | CornerClaim:
    """The claim of a document; `ValueError` with the entry that is wrong."""
    try:
        if given["schema"] not in range(FIRST, SCHEMA + 1):
            raise ValueError(
                f"certificate: schema = {given['schema']} is unknown; this version reads {FIRST} to {SCHEMA}"
            )
        bits, digits = int(given["bits"]), int(given["digits"])
        if not 16 <= bits <= LARGEST_BITS or not 1 <= digits <= LARGEST_BITS:
            raise ValueError(f"certificate: bits = {bits} or digits = {digits} is out of range")
        centre, radius = tuple(_ball(pair) for pair in given["centre"]), _ball(given["radius"])
        if not centre:
            raise ValueError("certificate: centre has no unknowns; accepted: one for each bounce and free parameter")
        said = _of_first(given) if given["schema"] == FIRST else given
        lam = number(said["scene"]["lam"], "lam") if "lam" in said["scene"] else None
        if lam is not None and not 0 <= lam <= 1:
            raise ValueError(f"certificate: lam = {lam} is no contraction; accepted: numbers in [0, 1]")
        if said["kind"] in ("corner", "focus"):
            _sized(centre, 2 if lam is None else 3, "unknowns")
            claim = CornerClaim(said["free"], centre, radius, bits, digits, lam)
            if _special(claim) != {key: said[key] for key in ("kind", "scene", "free", "components", "mirror")}:
                raise ValueError(f"certificate: scene, components or mirror is not that of a {said['kind']}")
            return claim
        problem = _problem(said, lam, centre[-1] + arb(0, radius))
        _sized(centre, problem.period + bool(problem.free), "unknowns")
        return Claim(problem, centre, radius, bits, digits)
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def _of_first(given: Mapping[str, Any]) -> dict[str, Any]:
    """What a document of the first version says, in the entries of this one."""
    lam = {} if given["lam"] is None else {"lam": given["lam"]}
    if given["kind"] == "special":
        corner = given["value"] != "alpha"
        scene = {"table": "cuspless" if corner else "egg"} | lam
        said = {"kind": "corner" if corner else "focus", "free": given["value"], "mirror": corner}
        return said | {"scene": scene, "components": [0, 0]}
    points = {"K": given["points"]} if given["points"] not in (0, POINTS) else {}
    shape = {"shape": given["shape"]} if given["shape"] else {}
    return {**given, "scene": {"table": given["table"]} | points | shape | lam}


def _problem(said: Mapping[str, Any], lam: Any, box: arb) -> Problem:
    components = tuple(int(i) for i in said["components"])
    if not 2 <= len(components) <= LARGEST_PERIOD:
        raise ValueError(f"certificate: {len(components)} bounces are out of range; accepted: 2 to {LARGEST_PERIOD}")
    table, law = scene_of(said["scene"], said["free"], box)
    if not set(components) <= set(range(len(table.components))):
        raise ValueError(f"certificate: {table.name} has components 0 to {len(table.components) - 1} only")
    kind = None if said["kind"] == "cycle" else BifurcationKind[said["kind"].upper()]
    return Problem(table, components, kind, said["free"], lam, Closure(-1 if said["mirror"] else 1), law)


def _sized(centre: tuple[arb, ...], wanted: int, what: str) -> None:
    if len(centre) != wanted:
        raise ValueError(f"certificate: centre has {len(centre)} entries for {wanted} {what}")


def read(path: Path) -> dict[str, Any]:
    """The document in a file; `ValueError` when it is none."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"certificate {str(path)!r} cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise ValueError(f"certificate {str(path)!r} is no JSON document: {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"certificate {str(path)!r} holds no JSON object")
    return found


def checked(given: Mapping[str, Any]) -> "Proof | CornerProof | TangencyProof":
    """The checklist of a document's claim, worked through anew; what the file says of it is not believed.

    Name and statement must be those that the equations have, and the list of checks must be whole.
    """
    proof: Proof | CornerProof | TangencyProof
    if given.get("kind") == "tangency" and given.get("schema") in range(FIRST, SCHEMA + 1):
        from verification.named import tangency_entries
        from verification.proofs.manifolds.claim import worked_through

        contact = tangency_entries.claim_of(given)
        _rightly_named(given, contact)
        proof = worked_through(contact)
    else:
        claim = claim_of(given)
        _rightly_named(given, claim)
        proof = corner_proved(claim) if isinstance(claim, CornerClaim) else proved(claim)
    if given["schema"] >= THIRD or (given["schema"] == SECOND and given["kind"] != "tangency"):
        _rightly_said(given, json.loads(json.dumps(document(proof, given["schema"]))))
    return proof


def check(path: Path | str) -> "Proof | CornerProof | TangencyProof":
    """The proof that a certificate file leads to, worked through anew; `certified` says whether every item holds."""
    return checked(read(Path(path)))


def _rightly_named(given: Mapping[str, Any], claim: "Claim | CornerClaim | TangencyClaim") -> None:
    said, true = given.get("name"), name_of(claim, given["schema"])
    if said != true:
        raise ValueError(f"certificate: name = {ascii(said)[:80]} is not what it states, which is {true!r}")


def _rightly_said(given: Mapping[str, Any], true: Mapping[str, Any]) -> None:
    """Holds the entries of a file, and what they say in words and promise, to those that its proof has."""
    wrong = [key for key in true if key != "checks" and given.get(key) != true[key]]
    if wrong:
        said, meant = (ascii(found)[:200] for found in (given.get(wrong[0]), true[wrong[0]]))
        raise ValueError(f"certificate: {wrong[0]} = {said} is not what its equations say, which is {meant}")
    if not isinstance(given.get("checks"), Mapping) or set(given["checks"]) != set(true["checks"]):
        raise ValueError(f"certificate: checks must list just these: {', '.join(true['checks'])}")
    own = {*CHAIN} if true["kind"] == "tangency" else set()  # of a tangency that is not proved no orbit is known
    if unknown := set(given) - set(true) - own:
        raise ValueError(f"certificate: the entry {ascii(min(unknown))[:60]} is unknown; accepted: {', '.join(true)}")


def _pair(x: arb) -> list[str]:
    mantissa, exponent = x.man_exp()
    return [str(mantissa), str(exponent)]


def _ball(pair: Any) -> arb:
    mantissa, exponent = (fmpz(str(text)) for text in pair)  # int() refuses more than 4300 digits
    if abs(exponent) > LARGEST_BITS * 2:
        raise ValueError(f"certificate: the exponent {exponent} is out of range")
    return arb((mantissa, exponent))

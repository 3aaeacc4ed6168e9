"""Certificates as files: a claim with exact endpoints, written out and read back bit for bit.

A ball is `[mantissa, exponent]` of its exact midpoint, in decimal text; the radius is one such pair.
Reading builds the problem from the table's name and exact shape, so that a file can claim anything
and prove nothing: `checked` works the whole checklist through again.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flint import arb, fmpz
from sympy import Expr

from symbolic import tables
from symbolic.cycles import polygons, thresholds
from symbolic.tables.formula import number
from symbolic.tables.geometry import boundary_coefficients
from symbolic.tables.table import Table
from symbolic.tables.table import alpha as alpha_symbol
from symbolic.tables.table import lam as lam_symbol
from verification.arithmetic.balls import working
from verification.cycles.recurrence.problem import Problem
from verification.cycles.recurrence.recurrence import BifurcationKind, Closure
from verification.named.locate import closed_form
from verification.proofs.corner.corner import NEAR
from verification.proofs.corner.corner_orbit import CornerClaim, CornerProof, corner_proved
from verification.proofs.periodic.bifurcation import Claim, Proof, proved

if TYPE_CHECKING:
    from verification.proofs.manifolds.proof import TangencyClaim, TangencyProof

SCHEMA = 1
LARGEST_BITS, LARGEST_PERIOD = 200_000, 2**20


def document(proof: "Proof | CornerProof | TangencyProof") -> dict[str, Any]:
    """A proof as a JSON document; its name is what its equations say, and nothing else."""
    claim = proof.claim
    name = name_of(claim)
    if not isinstance(claim, Claim | CornerClaim):
        return {"schema": SCHEMA, "name": name} | claim.to_dict() | {"checks": dict(proof.checks)}
    box = {
        "bits": claim.bits,
        "digits": claim.digits,
        "centre": [_pair(x) for x in claim.centre],
        "radius": _pair(claim.radius),
        "checks": proof.checks,
    }
    if isinstance(claim, CornerClaim):
        lam = None if claim.lam is None else str(claim.lam)
        return {"schema": SCHEMA, "name": name, "kind": "special", "value": claim.value, "lam": lam} | box
    problem = claim.problem
    return {
        "schema": SCHEMA,
        "name": name,
        "table": problem.table.name,
        "points": _points(problem.table),
        "shape": {parameter: str(value) for parameter, value in problem.table.fixed},
        "kind": problem.kind.name.lower() if problem.kind else "cycle",
        "free": problem.free,
        "mirror": problem.mirror,
        "lam": None if problem.lam is None else str(problem.lam),
        "components": list(problem.components),
    } | box


def name_of(claim: "Claim | CornerClaim | TangencyClaim") -> str:
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
        contact = claim.contact
        kind = "homoclinic" if contact.unstable == contact.stable else "heteroclinic"
        return f"{kind} tangency in the egg, alpha = {claim.alpha}"
    problem = claim.problem
    table, plain = problem.table, not problem.mirror
    what = table.name, problem.period, problem.kind, problem.free
    if plain and what == ("cuspless", 2, BifurcationKind.FLIP, "lam") and _in_box(claim, thresholds.lambda_c()):
        return "lambda-c"
    if plain and _points(table) in (0, 3):
        lam, alpha = problem.lam, dict(table.fixed).get("alpha")
        if what == ("egg", 2, BifurcationKind.FLIP, "alpha") and _in_box(
            claim, thresholds.alpha_tilde().subs(lam_symbol, lam)
        ):
            return "alpha-tilde"
        if what == ("egg", 3, BifurcationKind.FOLD, "lam") and _in_box(
            claim, polygons.saddle_node().subs(alpha_symbol, alpha)
        ):
            return "saddle-node"
    half = "half of a symmetric cycle, of" if problem.mirror else "a cycle of"
    shape = "".join(f", {name} = {value}" for name, value in table.fixed)
    kind = "cycle" if problem.kind is None else problem.kind.name.lower()
    return f"{kind} of {half} period {problem.period} in {problem.free}: {table.name}{shape}"


def _in_box(claim: Claim | CornerClaim, exact: Expr) -> bool:
    """Does the last unknown's ball hold a value that is known exactly?"""
    with working(claim.bits):
        return bool((claim.centre[-1] + arb(0, claim.radius)).overlaps(closed_form(exact, claim.digits + 5)))


def claim_of(given: Mapping[str, Any]) -> Claim | CornerClaim:
    """The claim of a document; `ValueError` with the entry that is wrong."""
    try:
        if given["schema"] != SCHEMA:
            raise ValueError(f"certificate: schema = {given['schema']} is unknown; this version reads {SCHEMA}")
        bits, digits = int(given["bits"]), int(given["digits"])
        if not 16 <= bits <= LARGEST_BITS or not 1 <= digits <= LARGEST_BITS:
            raise ValueError(f"certificate: bits = {bits} or digits = {digits} is out of range")
        centre, radius = tuple(_ball(pair) for pair in given["centre"]), _ball(given["radius"])
        lam = None if given["lam"] is None else number(given["lam"], "lam")
        if lam is not None and not 0 <= lam <= 1:
            raise ValueError(f"certificate: lam = {lam} is no contraction; accepted: numbers in [0, 1]")
        if given["kind"] == "special":
            unknowns = 2 if lam is None else 3
            _sized(centre, unknowns, "unknowns")
            return CornerClaim(given["value"], centre, radius, bits, digits, lam)
        problem = _problem(given, lam)
        _sized(centre, problem.period + bool(problem.free), "unknowns")
        return Claim(problem, centre, radius, bits, digits)
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def _problem(given: Mapping[str, Any], lam: Any) -> Problem:
    components = tuple(int(i) for i in given["components"])
    if not 2 <= len(components) <= LARGEST_PERIOD:
        raise ValueError(f"certificate: {len(components)} bounces are out of range; accepted: 2 to {LARGEST_PERIOD}")
    shape = {parameter: number(text, parameter) for parameter, text in given["shape"].items()}
    table = tables.named(given["table"], int(given["points"])).at(**shape)
    if not set(components) <= set(range(len(table.components))):
        raise ValueError(f"certificate: {table.name} has components 0 to {len(table.components) - 1} only")
    kind = None if given["kind"] == "cycle" else BifurcationKind[given["kind"].upper()]
    return Problem(table, components, kind, given["free"], lam, Closure(-1 if given["mirror"] else 1))


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

    The name is part of the statement: a file under another name than its equations have is refused.
    """
    if given.get("kind") == "tangency" and given.get("schema") == SCHEMA:
        from verification.proofs.manifolds import proof as tangency  # NumPy, which no other certificate needs

        contact = tangency.claim_of(given)
        _rightly_named(given, contact)
        return tangency.worked_through(contact)
    claim = claim_of(given)
    _rightly_named(given, claim)
    return corner_proved(claim) if isinstance(claim, CornerClaim) else proved(claim)


def check(path: Path | str) -> "Proof | CornerProof | TangencyProof":
    """The proof that a certificate file leads to, worked through anew; `certified` says whether every item holds."""
    return checked(read(Path(path)))


def _rightly_named(given: Mapping[str, Any], claim: "Claim | CornerClaim | TangencyClaim") -> None:
    said, true = given.get("name"), name_of(claim)
    if said != true:
        raise ValueError(f"certificate: name = {ascii(said)[:80]} is not what it states, which is {true!r}")


def _points(table: Table) -> int:
    """`K` of an egg: the boundary turns by `2*pi/K` into itself."""
    if table.name != "egg":
        return 0
    waves = boundary_coefficients(table.components[0])
    return max(waves) - 1 if waves else 0


def _pair(x: arb) -> list[str]:
    mantissa, exponent = x.man_exp()
    return [str(mantissa), str(exponent)]


def _ball(pair: Any) -> arb:
    mantissa, exponent = (fmpz(str(text)) for text in pair)  # int() refuses more than 4300 digits
    if abs(exponent) > LARGEST_BITS * 2:
        raise ValueError(f"certificate: the exponent {exponent} is out of range")
    return arb((mantissa, exponent))

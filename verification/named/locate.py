"""Bifurcations by name: their parameters to N digits, with a proof.

mpmath computes an approximate solution of the chord system, and `verification.proofs` proves it in balls; if there is a
closed form, the two must agree. The true value lies within `radius` of `value`; both are decimals.
"""

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import mpmath
from flint import arb
from sympy import Expr, Integer, N, S, acos

from numeric.lowering.files import write_whole
from symbolic import tables
from symbolic.cycles import polygons, thresholds
from symbolic.tables.definition import exact, like
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import alpha as alpha_symbol
from symbolic.tables.table import lam as lam_symbol
from verification.arithmetic.balls import bits_of, decimal, exact_balls, working
from verification.arithmetic.iteration import telling
from verification.cycles.cascade import HIGHEST, critical_cycle
from verification.cycles.cascade import symmetry_breaking as first_symmetry_breaking
from verification.cycles.critical import corner, focus
from verification.cycles.newton import NewtonStep, System, refined
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.proofs.corner.corner_orbit import CornerOrbit, EqualMultipliers
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.periodic.cycle_in_box import SolutionInBox, UniqueCycle, closed_form, cycle_in_box

if TYPE_CHECKING:
    from verification.proofs.manifolds.certificate import Tangency  # NumPy, which no other name needs

MOST_DIGITS = 20_000
BUDGET = 4_000_000  # bounces times digits: some ten minutes
MPMATH_SHARE = 0.7  # of the time that a proof and its approximation take
Steps = tuple[NewtonStep, ...]
Proved: TypeAlias = "SolutionInBox | Tangency"
FOLD_DIGITS = 50  # at most, of the proof beside a crisis
GMPY2 = mpmath.libmp.BACKEND == "gmpy"
WORDS = {True: "proved", False: "refuted", None: "unknown"}  # the three answers of a checklist


@dataclass(frozen=True, eq=False, repr=False)
class Located:
    """A value in decimals with its radius, and the checklist of its proof."""

    name: str
    value: str
    radius: str
    digits: int
    checks: Checks
    seconds: float
    ball: arb = field(repr=False)
    proof: "Proved | None" = field(repr=False, default=None)
    notes: Mapping[str, str] = field(default_factory=dict)
    steps: Steps = field(repr=False, default=())

    @property
    def certified(self) -> bool:
        """True if every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())

    @property
    def title(self) -> str:
        """The name of the result: the name asked for, or that of the event from which the tangency was continued."""
        return self.notes.get("called", self.name)

    def to_dict(self) -> dict[str, Any]:
        """The value, its checks and notes as JSON, as printed by `pinball locate --json`."""
        return {
            "name": self.name,
            "title": self.title,
            "value": self.value,
            "radius": self.radius,
            "digits": self.digits,
            "certified": self.certified,
            "checks": dict(self.checks),
            "notes": dict(self.notes),
            "gmpy2": GMPY2,
            "newton": [{"digits": step.digits, "log10_correction": step.correction} for step in self.steps],
            "seconds": self.seconds,
        }

    @property
    def certificate(self) -> str | None:
        """The text of the certificate's file, which `check` and `pinball check` read; None without a proof."""
        return None if self.proof is None else json.dumps(self.proof.document(), indent=1) + "\n"

    def save(self, path: str | Path) -> None:
        """Writes the certificate's file; `ValueError` if there is no certificate, or the file cannot be written."""
        if (certificate := self.certificate) is None:
            raise ValueError(f"certificate: {self.name} was not proved; accepted: values that are certified")
        try:
            write_whole(path, certificate)
        except OSError as why:
            raise ValueError(f"certificate: {path} cannot be written ({why.strerror}); name another file") from None

    @property
    def said(self) -> str:
        """`certified`, or which items of the checklist are not proved."""
        left = ", ".join(f"{item.replace('_', ' ')} {WORDS[value]}" for item, value in self.checks.items() if not value)
        return f"not certified: {left}" if left else "certified"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and {**self.to_dict(), "seconds": 0} == {**other.to_dict(), "seconds": 0}

    def __hash__(self) -> int:
        return hash((self.name, self.value))

    def __str__(self) -> str:
        return f"{self.title} = {self.value} +- {self.radius} ({self.said})"

    def __repr__(self) -> str:
        return f"Located({self})"

    def _repr_html_(self) -> str:
        from numeric.pinball.states import html_table

        rows = [*((item, WORDS[value]) for item, value in self.checks.items()), *self.notes.items()]
        table = html_table(("item", "result"), [(item.replace("_", " "), text) for item, text in rows])
        return f"<p>{escape(str(self)).replace('+-', '&plusmn;')}</p>{table}"


@dataclass(frozen=True)
class SearchOutcome:
    """The result of a search: ball, checklist, proof if there is one, notes, and the steps of Newton's method."""

    ball: arb
    checks: Checks
    proof: "Proved | None" = None
    notes: Mapping[str, str] = field(default_factory=dict)
    steps: Steps = ()


def locate(name: str, digits: int = 30, law: Law | str = PAPERS_LAW, **shape: Any) -> Located:
    """The parameter value of the bifurcation `name` (see `NAMES`) to `digits` decimals; tangencies under any `law`.

    The parameters that a name takes, such as `alpha`, `lam` or `n`, are exact numbers: `"2/25"`, `"0.08"`, a fraction.
    `ValueError` names what is missing or out of range, and what is accepted.

    >>> locate("lambda-c", 20).value
    '0.0934003354313602414161'
    >>> locate("saddle-node", 12, alpha="0.08").value
    '0.3781212525901'
    """
    if name not in NAMES:
        raise ValueError(f"locate: no value is called {name!r}; accepted: {', '.join(NAMES)}{like(name, NAMES)}")
    if digits not in range(1, MOST_DIGITS + 1):
        raise ValueError(f"locate: digits = {digits!r} is out of range; accepted: 1 to {MOST_DIGITS}")
    search, parameters = NAMES[name]
    shape = dict(USUAL.get(name, {})) | shape
    if set(shape) != set(parameters):
        other = "; a table of your own: bifurcations(table, 'saddle-node', period=3, ...)" * ("table" in shape)
        raise ValueError(f"locate {name}: given {_listed(shape)}; it takes {_listed(parameters)}{other}")
    shape = {letter: S(exact(f"locate {name}: {letter}", value)) for letter, value in shape.items()}
    for letter in {"n", "period"} & {*shape}:
        if not shape[letter].is_Integer:
            raise ValueError(f"locate {name}: {letter} = {shape[letter]} is no integer")
    law = law if isinstance(law, Law) else Law(law)
    if not law.uniform and not isinstance(search, partial):
        raise ValueError(f"locate {name}: law = {law}; accepted: {PAPERS_LAW}, and any law for tangencies of manifolds")
    started = time.perf_counter()
    found = search(digits, **shape) if law.uniform else search(digits, **shape, law=Law(str(law.phi)))
    value, radius = decimal(found.ball, digits + 1)
    seconds = time.perf_counter() - started
    rest = found.ball, found.proof, found.notes, found.steps
    return Located(name, value, radius, digits, found.checks, seconds, *rest)


def proof_near(problem: Problem, start: list[float], digits: int, in_balls: bool = False) -> UniqueCycle:
    """The proof for the solution near `start`: Newton's method to a few more digits, then a proof in balls.

    With `in_balls`, Newton's method is faster (`refined`), and the last bits of the centre differ.
    """
    return _searched(problem, start, digits, in_balls)[0]


def _searched(problem: Problem, start: list[float], digits: int, in_balls: bool = False) -> tuple[UniqueCycle, Steps]:
    box, steps = _box(problem, start, digits, 64 + 8 * problem.period.bit_length(), (digits + 2, digits), in_balls)
    return cycle_in_box(problem, *box), steps


def _box(
    system: System, start: list[float], digits: int, guard: int, sizes: tuple[int, int], in_balls: bool = False
) -> tuple[tuple[tuple[arb, ...], arb, int, int], Steps]:
    """A box (centre, radius, bits, digits) and Newton's steps; `sizes` are the digits of its radius and its centre."""
    tick = telling(f"{digits} digits")
    solution = refined(system, start, sizes[1], in_balls)
    tick(MPMATH_SHARE)
    bits = bits_of(digits, guard)
    with working(bits):
        radius = (arb(10) ** -sizes[0]).mid()
    return (tuple(exact_balls(solution.z)), radius, bits, digits), solution.steps


def _agreeing(searched: tuple[SolutionInBox, Steps], ball: arb) -> SearchOutcome:
    """The result of a proof, with the further check that the value agrees with a closed form, the ball `ball`."""
    proof, steps = searched
    overlap = proof.found and bool(proof.value.overlaps(ball))
    return SearchOutcome(ball, proof.checks | {"closed_form_agrees": overlap or None}, proof, _direction(proof), steps)


def _direction(proof: SolutionInBox) -> dict[str, str]:
    if not isinstance(proof, UniqueCycle) or proof.supercritical is None:
        return {}
    born = "a stable" if proof.supercritical else "an unstable"
    return {"kind": f"{'super' if proof.supercritical else 'sub'}critical: {born} cycle of twice the period is born"}


def _small(system: System, start: list[float], digits: int) -> tuple[tuple[tuple[arb, ...], arb, int, int], Steps]:
    return _box(system, start, digits, 100, (digits + 3, digits + 5))


def _at_corner(value: str, digits: int) -> SearchOutcome:
    box, steps = _small(corner(), [0.2545, 0.0712], digits)
    proof = CornerOrbit(*box, value)
    return SearchOutcome(proof.value, proof.checks, proof, proof.notes, steps)


def lambda_star(digits: int) -> SearchOutcome:
    """The contraction at which the cuspless orbit through both corners exists. Paper: section 5.2."""
    return _at_corner("lam", digits)


def phi_star(digits: int) -> SearchOutcome:
    """The exit angle at the upper corner of the cuspless orbit through both corners, in radians."""
    return _at_corner("phi", digits)


def lambda_c(digits: int) -> SearchOutcome:
    """The contraction at which the cuspless cardioid's horizontal orbit doubles its period. Paper: section 5.1."""
    exact = thresholds.lambda_c()
    problem = Problem(tables.cuspless, (1, 0), BifurcationKind.FLIP, "lam")
    return _agreeing(_searched(problem, [0, 0, float(N(exact))], digits), closed_form(exact, digits))


def alpha_tilde(digits: int, lam: Expr) -> SearchOutcome:
    """The shape at which the egg's diameters double their period. Paper: section 6.3."""
    exact = thresholds.alpha_tilde().subs(lam_symbol, _unit("lam", lam))
    problem = Problem(tables.egg(3), (0, 0), BifurcationKind.FLIP, "alpha", lam)
    return _agreeing(_searched(problem, [0.0, 3.14, float(N(exact))], digits), closed_form(exact, digits))


def alpha_hat(digits: int, lam: Expr) -> SearchOutcome:
    """The shape above which the multipliers of the egg's diameters are complex. Paper: section 6.3."""
    exact = thresholds.alpha_hat().subs(lam_symbol, _unit("lam", lam))
    ball = closed_form(exact, digits)
    if lam in (0, 1):
        why = {0: "the discriminant touches 0 there and does not cross it", 1: "the table is a circle there"}[lam]
        return SearchOutcome(ball, {"precise": True} | dict.fromkeys(("exists", "unique")), None, {"degenerate": why})
    box, steps = _small(focus(lam), [0.0, 3.14, float(N(exact))], digits)
    return _agreeing((EqualMultipliers(*box, lam), steps), ball)


def saddle_node(digits: int, alpha: Expr) -> SearchOutcome:
    """The contraction at which the egg's period-3 cycles are born. Paper: section 6.4."""
    table = tables.egg(3).at(alpha=alpha)
    if alpha == 0:
        raise ValueError(
            "locate saddle-node: alpha = 0 is a circle, with triangles at lam = 1 only; accepted: 0 < alpha <= 1/10"
        )
    exact = polygons.saddle_node().subs(alpha_symbol, alpha)
    turn = -float(N(acos(-alpha))) / 3  # cos(3*theta) = -alpha where the normal is tilted most
    problem = Problem(table, (0, 0, 0), BifurcationKind.FOLD, "lam")
    start = [turn + float(N(2 * S.Pi / 3)) * k for k in range(3)]
    return _agreeing(_searched(problem, [*start, float(N(exact))], digits), closed_form(exact, digits))


def doubling(digits: int, alpha: Expr, n: Expr) -> SearchOutcome:
    """The contraction at which the egg's cycle of period `2**(n-1)` doubles its period. Paper: section 6.6."""
    if (period := 2 ** max(int(n) - 1, 0)) * digits > BUDGET and n <= HIGHEST:
        raise ValueError(
            f"locate doubling: period {period} with {digits} digits is more work than the budget allows; "
            f"accepted for n = {n}: up to {BUDGET // period} digits"
        )
    problem, start = critical_cycle(alpha, int(n))
    proof, steps = _searched(problem, start, digits)
    return SearchOutcome(proof.value, proof.checks, proof, _direction(proof), steps)


def symmetry_breaking(digits: int, alpha: Expr) -> SearchOutcome:
    """The contraction at which the egg's symmetric cycle of period 4 has its pitchfork."""
    problem, start = first_symmetry_breaking(alpha)
    proof = proof_near(problem, start, digits)
    born = "two stable cycles" if proof.supercritical else "two unstable cycles"
    return SearchOutcome(proof.value, proof.checks, proof, {"kind": f"pitchfork: {born} without the symmetry are born"})


def egg_crisis(kind: str, digits: int, alpha: Expr, law: Law = PAPERS_LAW) -> SearchOutcome:
    """A crisis of the egg's chaotic attractor, as a proved tangency of a saddle's manifolds. Paper: section 6.7.

    It is not proved that no other contact ends the attractor before.
    """
    from verification.proofs.manifolds.known import (  # NumPy, which no other name needs
        SEARCHED,
        SHAPE,
        crisis,
        decimals,
        proof,
    )

    found = crisis(kind, alpha, digits, law)
    stable, unstable = found.touch.multipliers[:2]
    orbit = found.touch.contact.unstable
    proved_fold = False
    if not found.cycle.problem.closure.shift[0]:  # of a cycle that closes with a turn there is no certificate
        fold = proof_near(found.cycle.problem, found.cycle.start, min(digits, FOLD_DIGITS))
        near = bool(abs(fold.value - arb(str(found.parameter))) < 1e-3)
        proved_fold = fold.proved and near
    notes = {
        "mechanism": f"homoclinic tangency of the {orbit.name}, multipliers {unstable:.6g} and {stable:.6g}",
        "method": f"the fold of a cycle of {found.period} bounces that shadows it, estimated error, not a proof",
        "second_method": f"tangency of the manifolds, {found.apart:.1e} away with error {found.touch.error:.1e}",
        "transient": f"if an attractor ends here, lasts like (distance beyond)^-{found.exponent:.4f}, in the limit",
    }
    if alpha == SHAPE and law.uniform and kind in SEARCHED:
        low, bounces = SEARCHED[kind]
        notes["is_the_first"] = f"not shown; none earlier found from {low} on, in flights of up to {bounces} bounces"
    if alpha != SHAPE or not law.uniform:
        notes = _continued(kind, alpha, float(found.parameter), notes, law)
    value, error = decimals(found)
    with working(bits_of(digits, 100)):
        ball = arb(value, error)
    checks: Checks = {"shadowing_fold": proved_fold or None, "two_methods_agree": found.agrees or None}
    made = proof(found, alpha, digits + 2, law)
    inside = bool(ball.contains(made.value))
    checks |= {"tangency": True if made.proof.touches and inside else None}
    checks |= {item: made.checks[item] if inside else None for item in ("quadratic", "transversal")}
    held = made.proved and inside
    strange = held and made.strange.proved
    checks |= {"strange_attractors": strange or None, "is_the_crisis": None}
    if held:
        notes["proved"] = f"the two manifolds touch, within {error} of the value; that the attractor ends there is not"
    if strange:
        notes["follows"] = "strange attractors for a set of contractions of positive measure, as near as one likes"
    return SearchOutcome(ball, checks, made if held else None, notes)


def _continued(kind: str, alpha: Expr, lam: float, notes: dict[str, str], law: Law = PAPERS_LAW) -> dict[str, str]:
    """The notes on a tangency at a shape or law where the attractor was not examined: its name, and what particles do.

    The exponent of transients is left out if no orbit is chaotic, as it belongs to an attractor that is destroyed.
    """
    from numeric import PinballMap
    from verification.named.crises import ORBITS, extent

    event = f"{kind} crisis" if kind in ("merging", "boundary") else kind
    paper = "" if law.uniform else f" under {PAPERS_LAW} to alpha = {alpha}, phi = {law}"
    notes = {"called": f"tangency continued from the {event} at alpha = 2/25{paper}"} | notes
    below = lam * (1 - 1e-3)
    seen = extent(PinballMap("egg", lam=below, alpha=str(alpha), law=law))
    if seen is None:
        del notes["transient"]
        return notes | {"attractor": f"none of {ORBITS} orbits is chaotic at lam = {below:.6f}: no crisis is seen"}
    return notes | {
        "attractor": f"some orbits are chaotic at lam = {below:.6f}; whether that ends here was not looked at"
    }


def one_of(kind: str, parameter: str, digits: int, alpha: Expr, law: Law = PAPERS_LAW, **which: Expr) -> SearchOutcome:
    """A crisis with a number (`period` or `n`): of bands, a window or a small family of cycles, or an interior one."""
    from verification.proofs.manifolds.known import CONTACTS

    name = f"{kind}-{which[parameter]}"
    if name not in CONTACTS:
        known = sorted(int(other.rpartition("-")[2]) for other in CONTACTS if other.rpartition("-")[0] == kind)
        listed = ", ".join(str(other) for other in known)
        raise ValueError(f"locate {kind}: {parameter} = {which[parameter]} is not known; accepted: {listed}")
    return egg_crisis(name, digits, alpha, law)


def _unit(parameter: str, value: Expr) -> Expr:
    if not 0 <= value <= 1:
        raise ValueError(f"locate: {parameter} = {value} is out of range; accepted: numbers from 0 to 1")
    return value


def _listed(parameters: Any) -> str:
    return ", ".join(parameters) or "no parameter"


NAMES: Mapping[str, tuple[Callable[..., SearchOutcome], tuple[str, ...]]] = {
    "lambda-star": (lambda_star, ()),
    "phi-star": (phi_star, ()),
    "lambda-c": (lambda_c, ()),
    "alpha-tilde": (alpha_tilde, ("lam",)),
    "alpha-hat": (alpha_hat, ("lam",)),
    "saddle-node": (saddle_node, ("alpha",)),
    "doubling": (doubling, ("alpha", "n")),
    "symmetry-breaking": (symmetry_breaking, ("alpha",)),
    "merging-crisis": (partial(egg_crisis, "merging"), ("alpha",)),
    "boundary-crisis": (partial(egg_crisis, "boundary"), ("alpha",)),
    "band-merging": (partial(one_of, "band-merging", "period"), ("alpha", "period")),
    "symmetry-restoring": (partial(egg_crisis, "symmetry-restoring"), ("alpha",)),
    "interior-crisis": (partial(one_of, "interior-crisis", "n"), ("alpha", "n")),
    "window-end": (partial(one_of, "window-end", "period"), ("alpha", "period")),
    "window-merging": (partial(one_of, "window-merging", "period"), ("alpha", "period")),
    "family-end": (partial(one_of, "family-end", "period"), ("alpha", "period")),
    "family-merging": (partial(one_of, "family-merging", "period"), ("alpha", "period")),
}
USUAL = {  # parameters that need not be given
    "band-merging": {"period": Integer(4)},
    "interior-crisis": {"n": Integer(1)},
}

"""The paper's argument against period 3 at small contractions, judged. Paper: section 6.4.

It follows the positions of three bounces from every position with *any* initial angle, and says that
the third never is the first one again up to `lambda_c`. A witness refutes it: two collision rules,
at the second and third bounce, with the first position given and returned to. The exit angle of the
witness is free when any angle may be taken, and at most `lam*pi/2` when it must be one that a
collision can produce (in a convex table every such angle is produced).
"""

from dataclasses import dataclass

from flint import arb
from sympy import Expr, Rational

from symbolic.generation.text import kernel, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import egg
from verification.arithmetic.balls import exact_balls
from verification.arithmetic.words import Arithmetic, balls, bits_of, working
from verification.cycles.recurrence.chain import Vector
from verification.cycles.shooting.newton import refined
from verification.cycles.shooting.small import Small
from verification.proofs.periodic.interval_newton import Status, contraction

DIGITS = 20
SLAP = Rational(1, 5), (0.2838, 3.7697)  # at alpha = 2/25, lam = 0: first bounce, and the next two
PRODUCED = Rational(2, 5), (4.8086, 8.9349)  # at alpha = 2/25, lam = 3/10


@dataclass(frozen=True)
class Witness:
    """`angle` starts at `theta0` an orbit whose third bounce is `theta0` again; proved when `exists`.

    `produced`: the angle is one that a collision can produce, `|angle| <= lam*pi/2`.
    """

    exists: bool | None
    produced: bool | None
    angle: arb


def returning(alpha: Expr, lam: Expr, theta0: Rational) -> Small:
    """Unknown second and third bounce of an orbit of the egg that starts at `theta0` and returns to it."""
    table = egg(3).at(alpha=alpha)

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        angle = load(chord_kernel(table, 0, 0, 0), arithmetic)
        given = load(kernel("given", [], {"start": theta0, "lam": lam}), arithmetic)()
        start, contraction = given
        one, two = z
        return [
            angle(one, two)[0] + contraction * angle(one, start)[0],
            angle(two, start)[0] + contraction * angle(two, one)[0],
        ]

    return Small(f"egg, a return to theta0 = {theta0} after three bounces", equations)


def witness(alpha: Expr, lam: Expr, theta0: Rational, near: tuple[float, float]) -> Witness:
    """The orbit near the bounces `near`, proved.

    At `lam = 0` already, with any angle; at `lam = 3/10` with an angle that a collision can produce.

    >>> one = witness(Rational(2, 25), Rational(0), *SLAP)
    >>> one.exists, one.produced
    (True, False)
    >>> other = witness(Rational(2, 25), Rational(3, 10), *PRODUCED)
    >>> other.exists, other.produced
    (True, True)
    """
    system = returning(alpha, lam, theta0)
    solution = refined(system, near, DIGITS)
    bits = bits_of(DIGITS, 64)
    with working(bits):
        radius = (arb(10) ** -(DIGITS + 2)).mid()
        found = contraction(system, exact_balls(solution.z), radius, bits)
        table = egg(3).at(alpha=alpha)
        angle = load(chord_kernel(table, 0, 0, 0), balls(bits))
        start, contracted = load(kernel("given", [], {"start": theta0, "lam": lam}), balls(bits))()
        phi = angle(start + arb(0), found.zero[0])[0]
        spare = contracted * arb.pi() / 2 - abs(phi)
        exists = True if found.status is Status.UNIQUE else None
        return Witness(exists, True if spare > 0 else False if spare < 0 else None, phi)

"""Krawczyk's operator [Krawczyk1969], for wide boxes around short cycles.

`K = m - Y F(m) + (1 - Y F'(X)) (X - m)` with `Y` near the inverse of the middle of `F'(X)`. The
preconditioner is a full matrix, so the cost is cubic in the period; in return the balls of `F'(X)`
may be wide, which elimination along the chain does not forgive. For a ball of contractions the
motion of the cycle with `lam` is kept in one piece, `Y dF/dlam (lam - middle)`.
"""

from flint import arb, arb_mat

from verification.arithmetic import balls, working
from verification.certificates.contraction import Enclosure, Status, compared
from verification.shooting.chain import Chain
from verification.shooting.problem import Linearised, Problem, Rows


def krawczyk(problem: Problem, centre: list[arb], radii: list[float], bits: int) -> Enclosure:
    """What Krawczyk's operator proves about the cycles in a box; `lam` may be a ball.

    >>> from symbolic.tables import ellipse
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=arb("0.5", "0.01"))
    >>> krawczyk(axis, [arb("1.57"), arb("-1.57")], [0.01, 0.01], 64).status.name
    'UNIQUE'
    """
    with working(bits):
        box = [arb(x, r) for x, r in zip(centre, radii, strict=True)]
        try:
            at = Linearised(Rows(problem, balls(bits)), centre, slope=False)
            slope = dense(Linearised(Rows(problem, balls(bits)), box).plain)
            near = arb_mat([[x.mid() for x in row] for row in slope.tolist()]).inv()
        except ZeroDivisionError:
            return Enclosure(Status.UNKNOWN, box)
        inverse = arb_mat([[x.mid() for x in row] for row in near.tolist()])
        step = inverse * arb_mat([[f[0] + at.lam.mid() * b[0]] for f, b in zip(at.out, at.into, strict=True)])
        drift = inverse * arb_mat([[b[0]] for b in at.into])  # the rules are linear in lam
        one = arb_mat([[int(i == j) for j in range(len(centre))] for i in range(len(centre))])
        spread = (one - inverse * slope) * arb_mat([[x - m] for x, m in zip(box, centre, strict=True)])
        image = [m - step[i, 0] - drift[i, 0] * (at.lam - at.lam.mid()) + spread[i, 0] for i, m in enumerate(centre)]
        return Enclosure(compared(image, box), image)


def dense(chain: Chain) -> arb_mat:
    """The matrix of a chain."""
    n = len(chain.diagonal)
    rows = [[arb(0)] * n for _ in range(n)]
    for i, (lower, diagonal, upper) in enumerate(zip(chain.lower, chain.diagonal, chain.upper, strict=True)):
        rows[i][i] += diagonal
        rows[i][i - 1] += lower * (chain.sign if i == 0 else 1)
        rows[i][(i + 1) % n] += upper * (chain.sign if i == n - 1 else 1)
    return arb_mat(rows)

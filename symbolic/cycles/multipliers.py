"""Where the multipliers of a cycle lie, decided from trace and determinant of its monodromy.

The characteristic polynomial is `mu**2 - trace*mu + det`; its values at 1 and -1 and the size of
`det` decide everything (Jury's criterion), so no root is ever extracted.
"""

from sympy import Expr, Interval, Matrix, eye, solve, symbols

from symbolic.proofs.signs import Box, Finding, conjunction, positive


def inside_unit_circle(trace: Expr, det: Expr, box: Box) -> Finding:
    """Are both multipliers smaller than 1 in modulus, everywhere in the box?

    >>> from sympy import Rational, S
    >>> inside_unit_circle(S.Zero, Rational(1, 2), {}).outcome.name
    'PROVED'
    """
    return conjunction(positive(1 - trace + det, box), positive(1 + trace + det, box), positive(1 - det, box))


def saddle(trace: Expr, det: Expr, box: Box) -> Finding:
    """Is `0 < mu_minus < 1 < mu_plus`?

    >>> from sympy import Rational, S
    >>> saddle(S(3), S(1), {}).outcome.name
    'PROVED'
    """
    return conjunction(positive(trace - 1 - det, box), positive(det, box))


def real_and_distinct(trace: Expr, det: Expr, box: Box) -> Finding:
    """Are the multipliers real and different?"""
    return positive(trace**2 - 4 * det, box)


def complex_pair(trace: Expr, det: Expr, box: Box) -> Finding:
    """Are the multipliers complex conjugates off the real line? Their modulus is then `sqrt(det)`."""
    return positive(4 * det - trace**2, box)


def contracting_norm() -> Finding:
    """Is there for every attracting monodromy matrix a quadratic norm in which it contracts?

    For the companion matrix `M` of any trace and determinant inside Jury's triangle, `N - M.T*N*M = 1` has a positive
    definite solution `N`; a matrix that is no multiple of the identity is similar to its companion matrix, and a
    multiple contracts as it is. So near an attracting cycle, where `DT` is continuous, it contracts too.

    >>> contracting_norm().outcome.name
    'PROVED'
    """
    det, share = symbols("det share", real=True)  # trace = share*(1 + det)
    inside = {det: Interval.open(-1, 1), share: Interval.open(-1, 1)}
    first, mixed, last = symbols("first mixed last")
    companion, norm = Matrix([[0, 1], [-det, share * (1 + det)]]), Matrix([[first, mixed], [mixed, last]])
    (found,) = solve(list(norm - companion.T * norm * companion - eye(2)), [first, mixed, last], dict=True)
    solution = norm.subs(found)
    return conjunction(positive(solution[0, 0], inside), positive(solution.det().factor(), inside))

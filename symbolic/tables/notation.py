"""LaTeX with the paper's letters."""

from sympy import Basic, Expr, Matrix, Symbol
from sympy import latex as sympy_latex

from symbolic.tables.symbols import K0, K1, cos_eta1, cos_phi0, eta, lam, phi
from symbolic.tables.table import Component, Table

SPECIAL = {
    lam: r"\lambda",
    phi: r"\varphi",
    eta: r"\eta",
    K0: "K_{0}",
    K1: "K_{1}",
    cos_phi0: r"\cos \varphi_{0}",
    cos_eta1: r"\cos \eta_{1}",
}


def latex(expression: Expr | Matrix | Component | Table) -> str:
    """`expression` in LaTeX, in the paper's letters; a component is its parametrisation.

    >>> from symbolic.tables.symbols import alpha
    >>> latex(lam * alpha)
    '\\\\alpha \\\\lambda'
    >>> from symbolic.tables import cuspless
    >>> latex(cuspless.component("wall").point[0])
    '- \\\\frac{1}{4}'
    """
    if isinstance(expression, Table):
        return r" \\ ".join(latex(component) for component in expression.components)
    if isinstance(expression, Component):
        x, y = (latex(coordinate) for coordinate in expression.point)
        return rf"\left({x}, {y}\right), \quad {latex(expression.start)} \leq \theta \leq {latex(expression.end)}"
    return str(sympy_latex(expression, symbol_names=_names(expression)))


def equation(left: str, right: Expr | Matrix) -> str:
    """A displayed equation for a notebook cell; `left` is LaTeX already.

    >>> equation(r"\\varphi", -lam * eta)
    '$\\\\displaystyle \\\\varphi = - \\\\eta \\\\lambda$'
    """
    return rf"$\displaystyle {left} = {latex(right)}$"


def letter(name: str) -> str:
    """A name of the code as the paper's letter, with what follows as a subscript.

    >>> letter("theta_next"), letter("lam"), letter("mu0")
    ('\\\\theta_{\\\\mathrm{next}}', '\\\\lambda', '\\\\mu_{0}')
    """
    stem, _, tail = name.partition("_")
    digits = stem[len(stem.rstrip("0123456789")) :]
    stem = stem[: len(stem) - len(digits)]
    base = {"lam": r"\lambda", "phi": r"\varphi"}.get(stem) or str(sympy_latex(Symbol(stem)))
    parts = [digits] if digits else []
    parts += [rf"\mathrm{{{tail}}}"] if tail else []
    return base + (f"_{{{','.join(parts)}}}" if parts else "")


def _names(expression: Expr | Matrix) -> dict[Basic, str]:
    symbols = sorted(expression.free_symbols, key=str)
    return {s: SPECIAL.get(s) or letter(s.name) for s in symbols}

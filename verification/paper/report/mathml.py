"""What a claim says, as HTML: the paper's LaTeX and our own formulas as MathML, everything else escaped.

A formula of ours is plain text such as `4*sin(theta/2)`. It is set as it is written: its syntax tree
is printed, and nothing is evaluated, reordered or simplified on the way.
"""

import ast
import re
from collections.abc import Callable

from latex2mathml.converter import convert
from markupsafe import Markup, escape

from symbolic.tables.table import letter

PAPER = {  # the paper's own macros
    r"\defeq": ":=",
    r"\phi": r"\varphi",
    r"\nn": r"\mathbf{n}",
    r"\vv": r"\mathbf{v}",
    r"\ttt": r"\mathbf{t}",
    r"\qq": r"\mathbf{q}",
    r"\rmd": r"\mathrm{d}",
    r"\fl": "",
    r"\noalign{\medskip}": "",
    r"\medskip": "",
    r"\emph": "",
}
MACRO = re.compile(r"\\noalign\{\\medskip\}|\\[A-Za-z]+")
TEXT_MACRO = re.compile(r"\\emph\{([^{}]*)\}")
LATEX_ONLY = re.compile(r"\\[a-zA-Z]+")  # a quote without dollars that is a formula all the same
SIGNS = {
    ast.Lt: "<",
    ast.LtE: r"\leq",
    ast.Gt: ">",
    ast.GtE: r"\geq",
    ast.Eq: "=",
    ast.NotEq: r"\neq",
    ast.In: r"\in",
}
TYPED = {"``": "\u201c", "''": "\u201d", "--": "\u2013", "~": "\u00a0", "\\ ": " ", "\\'e": "\u00e9"}
PLAIN = {"<=": "\u2264", ">=": "\u2265", "!=": "\u2260", "->": "\u2192", "+-": "\u00b1", "sqrt": "\u221a"}
GREEK = {
    "lam": "\u03bb",
    "lambda": "\u03bb",
    "theta": "\u03b8",
    "alpha": "\u03b1",
    "phi": "\u03c6",
    "eta": "\u03b7",
    "kappa": "\u03ba",
    "mu": "\u03bc",
    "nu": "\u03bd",
    "pi": "\u03c0",
}
SUBSCRIPTS = {"plus": "+", "minus": "\u2212", "star": "*", "oo": "\u221e"}
LETTER = re.compile(rf"(?<![\w.&])(?<![a-z]-)({'|'.join(GREEK)})(?:_?(\d+|plus|minus|star|oo)|_([a-z]))?(?!\w|-[a-z])")
FUNCTIONS = {name: rf"\{name}" for name in ("sin", "cos", "tan", "log", "exp", "min", "max", "inf", "sup")}
FUNCTIONS |= {f"a{name}": rf"\arc{name}" for name in ("sin", "cos", "tan")}
ATOM = 5


def mathml(latex: str, display: bool = False) -> Markup:
    """LaTeX in the paper's macros as MathML, with the LaTeX kept for readers that copy it.

    >>> "<mi>&#x003BB;</mi>" in mathml(r"\\lambda")
    True
    """
    known = MACRO.sub(lambda found: PAPER.get(found.group(), found.group()), latex)
    whole = convert(known, display="block" if display else "inline")
    return Markup(whole.replace("<math ", f'<math alttext="{escape(latex)}" ', 1))


def prose(quote: str) -> Markup:
    """The paper's words with their formulas.

    >>> prose(r"it is \\emph{stable} & so")
    Markup('it is <em>stable</em> &amp; so')
    """
    if "$" not in quote and LATEX_ONLY.search(TEXT_MACRO.sub("", quote)):
        rows = quote if r"\begin" in quote or "&" not in quote else rf"\begin{{array}}{{cc}} {quote} \end{{array}}"
        return mathml(rows, display=True)
    parts = quote.split("$")
    return Markup("").join(_words(part) if i % 2 == 0 else mathml(part) for i, part in enumerate(parts))


def remark(text: str) -> Markup:
    """Our own words, in which the code's letters and signs become the paper's.

    >>> remark("lam <= 1 for theta0")
    Markup('λ ≤ 1 for θ<sub>0</sub>')
    """
    for sign, shown in PLAIN.items():
        text = text.replace(sign, shown)
    text = re.sub(r"(?<=[\w)\]])\*(?=[\w(])", "\u00b7", text)
    return Markup(LETTER.sub(_greek, str(escape(text))))


def _greek(found: re.Match[str]) -> str:
    below = found[2] or found[3]
    return GREEK[found[1]] + (f"<sub>{SUBSCRIPTS.get(below, below)}</sub>" if below else "")


def _words(text: str) -> Markup:
    for typed, shown in TYPED.items():
        text = text.replace(typed, shown)
    plain = str(escape(text))
    return Markup(TEXT_MACRO.sub(r"<em>\1</em>", plain))


def formula(text: str) -> Markup | None:
    """A formula in our notation as MathML; None when the text is no formula.

    >>> formula("the table is a circle") is None
    True
    """
    try:
        code = re.sub(r"(?<![<>=!])=(?!=)", "==", text.strip().replace("^", "**"))
        tree = ast.parse(code, mode="eval").body
        return Markup(str(mathml(_latex(tree))).replace("<math ", '<math displaystyle="true" ', 1))
    except (SyntaxError, ValueError, RecursionError):
        return None


def _latex(node: ast.expr, within: int = 0) -> str:
    """The syntax tree as LaTeX, in parentheses where `within` binds more closely."""
    text, binding = _printed(node)
    return rf"\left({text}\right)" if binding < within else text


def _printed(node: ast.expr) -> tuple[str, int]:
    match node:
        case ast.Constant(value=int() | float()):
            return ast.unparse(node), ATOM
        case ast.Name(id=name):
            return {"oo": r"\infty", "C": "C"}.get(name) or letter(name), ATOM
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"-{_latex(operand, 2)}", 2
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return rf"\frac{{{_latex(left)}}}{{{_latex(right)}}}", ATOM
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return f"{_latex(left, ATOM)}^{{{_latex(right)}}}", 4
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            dot = r" \cdot " if _ends_in_digit(left) and _begins_with_digit(right) else r" \, "
            return f"{_latex(left, 2)}{dot}{_latex(right, 3)}", 2
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            return f"{_latex(left, 1)} {'+' if isinstance(op, ast.Add) else '-'} {_latex(right, 2)}", 1
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            return _call(name, [_latex(each) for each in arguments]), ATOM
        case ast.Compare(left=left, ops=ops, comparators=others):
            pairs = zip(ops, others, strict=True)
            return _latex(left) + "".join(f" {SIGNS[type(op)]} {_latex(each)}" for op, each in pairs), 0
        case ast.List(elts=rows) if rows and all(isinstance(row, ast.List) for row in rows):
            lines = (" & ".join(_latex(entry) for entry in row.elts) for row in rows if isinstance(row, ast.List))
            return r"\begin{pmatrix}" + r" \\ ".join(lines) + r"\end{pmatrix}", ATOM
        case ast.List(elts=entries) | ast.Tuple(elts=entries):
            inside = r",\; ".join(_latex(entry) for entry in entries)
            return (rf"\left[{inside}\right]" if isinstance(node, ast.List) else rf"\left({inside}\right)"), ATOM
    raise ValueError(f"no formula: {ast.dump(node)[:60]}")


def _call(name: str, arguments: list[str]) -> str:
    special: dict[str, Callable[[str], str]] = {
        "sqrt": lambda x: rf"\sqrt{{{x}}}",
        "abs": lambda x: rf"\left|{x}\right|",
        "Abs": lambda x: rf"\left|{x}\right|",
    }
    if name in special and len(arguments) == 1:
        return special[name](arguments[0])
    head = FUNCTIONS.get(name) or letter(name)
    return rf"{head}\left({', '.join(arguments)}\right)"


def _ends_in_digit(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) or (isinstance(node, ast.BinOp) and _ends_in_digit(node.right))


def _begins_with_digit(node: ast.expr) -> bool:
    left = node.left if isinstance(node, ast.BinOp) and not isinstance(node.op, ast.Div) else node
    return isinstance(left, ast.Constant) or (left is not node and _begins_with_digit(left))

"""Texts of claims as HTML: the paper's LaTeX and our own formulas become MathML, other text is escaped.

Our formulas are plain text such as `4*sin(theta/2)`. Each is typeset as written, from its syntax tree, and never
evaluated, reordered or simplified. In a sentence, the longest piece that parses as a formula is typeset as a formula.
"""

import ast
import base64
import re
from functools import lru_cache
from importlib.resources import files

from latex2mathml.converter import convert
from markupsafe import Markup, escape

from symbolic.tables.formula import letter

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
LATEX_ONLY = re.compile(r"\\[a-zA-Z]+")  # a quote without dollars that is a formula
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
GREEK = {name: chr(code) for name, code in zip(
    ("alpha", "gamma", "delta", "theta", "kappa", "lambda", "mu", "nu", "pi", "rho", "tau", "phi", "chi", "eta", "eps"),
    (0x3B1, 0x3B3, 0x3B4, 0x3B8, 0x3BA, 0x3BB, 0x3BC, 0x3BD, 0x3C0, 0x3C1, 0x3C4, 0x3C6, 0x3C7, 0x3B7, 0x3B5),
    strict=True,
)} | {"lam": "\u03bb"}  # fmt: skip
SUBSCRIPTS = {"plus": "+", "minus": "\u2212", "star": "*", "oo": "\u221e", "pm": "\u00b1", "infinity": "\u221e"}
SUBSCRIPTS |= {"+": "+", "-": "\u2212"}
LETTER = re.compile(
    rf"(?<![\w.&])(?<![a-z]-)({'|'.join(GREEK)})"
    r"(?:_?(\d+|plus|minus|star|oo|pm|infinity)|_([a-z+-])|(\*)(?=[\s.,;:)&]|$))?(?!\w|-[a-z])"
)
TILDE = re.compile(rf"\b({'|'.join(GREEK)})[-_](tilde|hat)\b")
BELOW = {"plus": "+", "minus": "-", "star": "*", "oo": r"\infty", "pm": r"\pm", "infinity": r"\infty"}
ABOVE = {"tilde": r"\tilde", "hat": r"\hat"}
FUNCTIONS = {name: rf"\{name}" for name in ("sin", "cos", "tan", "log", "exp", "min", "max", "inf", "sup", "det")}
FUNCTIONS |= {f"a{name}": rf"\arc{name}" for name in ("sin", "cos", "tan")}
WORDS = {"oo": r"\infty", "C": "C", "trace": r"\operatorname{tr}", "det": r"\det", "share": "u", "_T": r"\tau"}
NAME = (
    rf"(?:(?:{'|'.join((*GREEK, *FUNCTIONS, *WORDS, 'sqrt', 'abs', 'Abs', 'sign'))})\d*"
    r"|[A-Za-z]\d*|cos_phi\d|cos_eta\d)"
    r"(?:_(?:[a-z]\b|\d+\b|oo|plus|minus|star|pm|tilde|hat|[+-](?!\d)))?'?(?![A-Za-z_])"
)
NUMBER = r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.]*[A-Za-z_]|\.\d)"
SIGN = r"\s*(?:\*\*|<=|>=|!=|[-+*/^<>=])\s*"
STARRED = r"(?<![\w.])(?:lambda|lam|phi|s)\*(?=[\s,;:.)\]]|$)"
TOKEN = re.compile(
    rf"(?P<name>{STARRED}|(?<![\w.]){NAME})|(?P<number>(?<![\w.]){NUMBER})|(?P<sign>{SIGN})"
    r"|(?P<mark>[()\[\]|]'?)|(?P<comma>, )"
)
WORTH = re.compile(r"[\w)\]|']\s*(?:\*\*|[*/^<>=]|!=|[-+]\s|[-+](?=[\w(]))|\w\(|\|.")
ARTICLE = re.compile(r", a$")  # "lam < 1, a focus": no letter, unless a conjunction or a verb comes next
NO_NOUN = re.compile(r"(?! [A-Za-z]{2})| (?:and|or|is|are|in|at|as|to|with)\b")
APPOSED = re.compile(r"\w -\d")  # a word and a negative number, as in "trace -2": no subtraction
PAIR = re.compile(r"([\[(])((?:[^\[\](),;:]|\([^()]*\))+), ((?:[^\[\](),;:]|\([^()]*\))+)([\])])")
AN_ELEMENT = re.compile(rf"\b({NAME}) in (?=[\[(])")
LOW = re.compile(r"\\left\(((?:[^()\\^]|\\(?!frac|sqrt|left|right|begin)[a-z,;]+)*)\\right\)")  # no stretch
APART = r"sin|cos|tan|arcsin|arccos|arctan|sinh|cosh|tanh|log|ln|exp|det|min|max|inf|sup|tr"
THIN = '<mspace width="0.17em"/>'
RELATION = "&#x0(?:003[CDE]|226[045]|2208|2192|21A6|0028|005B|002C);"
SPACING = [  # corrections of MathML: upright names, roots, slashes, signs
    (re.compile(rf"(?<!under>)(?<!over>)<mo(?: movablelimits=\"true\")?>({APART})</mo>"), r"<mi>\1</mi>"),
    (re.compile(rf"(</m(?:[ni]|su[bp]|subsup|row|frac)>|&#x00029;</mo>)<mi>({APART})</mi>"), rf"\1{THIN}<mi>\2</mi>"),
    (re.compile(rf"(?<!<msu[bp]>)<mi>({APART})</mi>(?=<m[nis])"), rf"<mi>\1</mi>{THIN}"),
    (  # a root of one letter hangs below the line unless its box is as high as the root sign
        re.compile(r"<msqrt>((?:<mrow>)?<m[in]>[^<]*</m[in]>(?:</mrow>)?)</msqrt>"),
        r'<msqrt><mpadded height="0.84em" depth="0.16em">\1</mpadded></msqrt>',
    ),
    (re.compile(r"<mo>(&#x0002F;)</mo>"), r'<mo lspace="0" rspace="0">\1</mo>'),
    (re.compile(rf"({RELATION}</mo>)<mo>(&#x02212;|&#x000B1;)</mo>"), r'\1<mo form="prefix">\2</mo>'),
]
BARS = re.compile(r"(?<!\\left)\\lvert|(?<!\\right)\\rvert")
INLINE, ATOM = 5, 6  # precedence of a quotient and of an atom


def font_style() -> Markup:
    """The CSS of formulas, with an embedded font (in a text font, fraction bars would cross matrices)."""
    font = base64.b64encode((files("verification.paper.report") / "math.woff2").read_bytes()).decode("ascii")
    face = f'@font-face {{ font-family: "PinballMath"; src: url(data:font/woff2;base64,{font}) format("woff2"); }}'
    return Markup(f'{face}\nmath {{ font-family: "PinballMath", math; font-size: 1.04em; }}\n')


@lru_cache(maxsize=4096)
def mathml(latex: str, display: bool = False) -> Markup:
    """LaTeX that may use the paper's macros, as MathML; the LaTeX is its alternative text.

    >>> "<mi>&#x003BB;</mi>" in mathml(r"\\lambda")
    True
    """
    known = MACRO.sub(lambda found: PAPER.get(found.group(), found.group()), latex)
    known = BARS.sub(lambda found: (r"\left" if found[0] == r"\lvert" else r"\right") + found[0], known)
    whole = convert(LOW.sub(r"(\1)", known), display="block" if display else "inline")
    for wrong, right in SPACING:
        whole = wrong.sub(right, whole)
    plain = whole.replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "", 1).replace(' display="inline"', "", 1)
    return Markup(plain.replace("<math", f'<math alttext="{escape(latex)}"', 1))


@lru_cache(maxsize=4096)
def prose(quote: str) -> Markup:
    """The paper's text with its formulas, as HTML.

    >>> prose(r"it is \\emph{stable} & so")
    Markup('it is <em>stable</em> &amp; so')
    """
    if "$" not in quote and LATEX_ONLY.search(TEXT_MACRO.sub("", quote)):
        rows = quote if r"\begin" in quote or "&" not in quote else rf"\begin{{pmatrix}} {quote} \end{{pmatrix}}"
        return mathml(rows, display=True)
    parts = quote.split("$")
    return Markup("").join(_words(part) if i % 2 == 0 else mathml(part) for i, part in enumerate(parts))


def _words(text: str) -> Markup:
    for typed, shown in TYPED.items():
        text = text.replace(typed, shown)
    plain = str(escape(text))
    return Markup(TEXT_MACRO.sub(r"<em>\1</em>", plain))


@lru_cache(maxsize=8192)
def remark(text: str) -> Markup:
    """Our own text as HTML: names and operators of the code become symbols of the paper, and formulas MathML.

    >>> remark("lam <= for theta0")
    Markup('λ ≤ for θ<sub>0</sub>')
    >>> remark("zero for a**2 - 1 and so on").count("<math ")
    1
    """
    return Markup("").join(shown for _, shown in pieces(text))


def pieces(text: str) -> list[tuple[str, Markup]]:
    """The formulas, words and spaces of a sentence in order, each as a pair of source and HTML."""
    text = AN_ELEMENT.sub("\\1 \u2208 ", text)
    found, at = [], 0
    for start, end, latex in [*formulas(text), (len(text), len(text), "")]:
        if start > at:
            found.append((text[at:start], _plain(text[at:start])))
        if latex:
            found.append((text[start:end], mathml(latex)))
        at = end
    return found


def _plain(text: str) -> Markup:
    for sign, shown in PLAIN.items():
        text = text.replace(sign, shown)
    text = re.sub(r"(?<=[\w)\]])\*(?=[\w(])", "\u00b7", text)
    text = re.sub(r"(?<![\w)])-(?=\d)", "\u2212", text)
    text = re.sub(r"\b_T\b", "\u03c4", re.sub(r"\boo\b", "\u221e", text))
    text = re.sub(r"\blambda-(c|star)\b", r"lambda_\1", text)
    text = re.sub(r"(?<=[a-z\d]{2})_(?=[a-z]{2}|a )(?!plus|minus|star|oo|pm|infinity)", " ", text)  # names of checks
    marked = TILDE.sub(lambda found: GREEK[found[1]] + {"tilde": "\u0303", "hat": "\u0302"}[found[2]], text)
    greek = LETTER.sub(_greek, str(escape(marked)))
    return Markup(re.sub(r"\b([A-Za-z])_(\d?[a-z]?)\b", r"<i>\1</i><sub>\2</sub>", greek))


def _greek(found: re.Match[str]) -> str:
    below = found[2] or found[3] or found[4]
    return GREEK[found[1]] + (f"<sub>{SUBSCRIPTS.get(below, below)}</sub>" if below else "")


def formulas(text: str) -> list[tuple[int, int, str]]:
    r"""The start, the end and the LaTeX of each formula in a sentence; no formula extends across an error bar `+-`.

    >>> [text for *_, text in formulas("nu_+ = 0.5 +- 7e-05 there")]
    ['\\nu_{+} = 0.5', '7 \\cdot 10^{-5}']
    """
    text = text.replace("+-", "\u00b1 ")
    found: list[tuple[int, int, str]] = []
    at = 0
    for run in _runs(text):
        first = 0
        while first < len(run):
            start = run[first].end() - len(run[first].group().lstrip())
            last = next((n for n in range(len(run), first, -1) if _set(text[start : run[n - 1].end()], text, start)), 0)
            if start >= at and last:
                end = run[last - 1].end()
                found.append((start, end, _set(text[start:end], text, start) or ""))
                first, at = last, end
            else:
                first += 1
    return found


def _runs(text: str) -> list[list[re.Match[str]]]:
    """Maximal runs of adjacent tokens that could be a formula."""
    runs: list[list[re.Match[str]]] = [[]]
    for token in TOKEN.finditer(text):
        if runs[-1] and runs[-1][-1].end() != token.start():
            runs.append([])
        runs[-1].append(token)
    return [run for run in runs if run]


def _set(piece: str, text: str, start: int) -> str | None:
    """A piece of a sentence as LaTeX; None if it is no formula, or merely a word or a number."""
    if (
        piece != piece.strip()
        or piece.startswith("- ")
        or not WORTH.search(piece)
        or APPOSED.search(piece)
        or (start and piece[0] == "(" and text[start - 1] in "')]")  # an argument, as in kappa''(0) < 1
        or (ARTICLE.search(piece) and not NO_NOUN.match(text, start + len(piece)))
        or (start and (text[start - 1].isalnum() or text[start - 1] in "\\_^*/"))
    ):
        return None
    if piece.endswith("*") and text[start + len(piece) :][:1] not in ("", *" ,;:.)]"):
        return None
    if pair := PAIR.fullmatch(piece):
        ends = _read(pair[2]), _read(pair[3])
        return None if None in ends else rf"\left{pair[1]}{ends[0]}, {ends[1]}\right{pair[4]}"
    return _read(piece)


@lru_cache(maxsize=4096)
def formula(text: str) -> Markup | None:
    """A formula in our notation as MathML; None if the text is not a formula.

    >>> formula("the table is a circle") is None
    True
    """
    latex = _read(text.strip())
    return None if latex is None else Markup(str(mathml(latex)).replace("<math", '<math displaystyle="true"', 1))


@lru_cache(maxsize=8192)
def _read(text: str) -> str | None:
    """A formula in our notation as LaTeX; None if the text is not a formula."""
    if any(text.count(a) != text.count(b) for a, b in ("()", "[]")) or text.count("|") % 2:
        return None
    text = re.sub(r"\b(lam|phi|s)\*(?=[\s,;:.)\]]|$)", r"\1_star", text)
    text = re.sub(r"\|([^|]+)\|", r" abs(\1)", re.sub(r"\blambda\b", "lam", text))
    text = re.sub(r"\(([^()]*(?:\([^()]*\))?[^()]*)\)'", r"prime(\1)", text)
    text = re.sub(r"(\w)'", r"\1_prime", text)
    text = re.sub(r"_([+-])(?!\d)", lambda found: "_plus" if found[1] == "+" else "_minus", text)
    code = re.sub(r"(?<![<>=!])=(?!=)", "==", text.replace("^", "**"))
    try:
        return _Source(code.strip()).latex(ast.parse(code.strip(), mode="eval").body)
    except (SyntaxError, ValueError, RecursionError):
        return None


class _Source:
    """A formula as typed; its numbers keep their digits."""

    def __init__(self, code: str) -> None:
        self.code = code

    def latex(self, node: ast.expr, within: int = 0) -> str:
        """The syntax tree as LaTeX, in parentheses if the surrounding operator `within` has a higher precedence."""
        text, binding = self._printed(node)
        return rf"\left({text}\right)" if binding < within else text

    def _printed(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Constant(value=int() | float()):
                return self._number(node), ATOM
            case ast.Name(id=name):
                return _letter(name), ATOM
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self.latex(operand, 2)}", 2
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return rf"\frac{{{self.latex(left)}}}{{{self.latex(right)}}}", INLINE
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return f"{self.latex(left, ATOM)}^{{{self._exponent(right)}}}", 4
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                dot = r" \cdot " if _ends_in_digit(left) and _begins_with_digit(right) else r" \, "
                return f"{self.latex(left, 2)}{dot}{self.latex(right, 3)}", 2
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
                return f"{self.latex(left, 1)} {'+' if isinstance(op, ast.Add) else '-'} {self.latex(right, 2)}", 1
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                return _call(name, [self.latex(each) for each in arguments]), ATOM
            case ast.Call(func=ast.Call() as function, args=arguments, keywords=[]):  # as in (f^2)'(s)
                inside = ", ".join(self.latex(each) for each in arguments)
                return rf"{self.latex(function)}\left({inside}\right)", ATOM
            case ast.Compare(left=left, ops=ops, comparators=others):
                pairs = zip(ops, others, strict=True)
                return self.latex(left) + "".join(f" {SIGNS[type(op)]} {self.latex(each)}" for op, each in pairs), 0
            case ast.List(elts=entries) | ast.Tuple(elts=entries):
                return self._listed(node, entries), ATOM
        raise ValueError(f"no formula: {ast.dump(node)[:60]}")

    def _number(self, node: ast.expr) -> str:
        typed = ast.get_source_segment(self.code, node) or ""
        mantissa, _, exponent = typed.lower().partition("e")
        return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else typed

    def _exponent(self, node: ast.expr) -> str:
        """An exponent as LaTeX; a quotient of two numbers or symbols is written on one line."""
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            sides = node.left, node.right
            if all(isinstance(side, ast.Constant | ast.Name) for side in sides):
                return "/".join(self.latex(side) for side in sides)
        return self.latex(node)

    def _listed(self, node: ast.expr, entries: list[ast.expr]) -> str:
        """A list of entries as LaTeX: a matrix, a column in brackets, or a point in parentheses."""
        if entries and all(isinstance(row, ast.List) for row in entries):
            lines = (
                " & ".join(self.latex(entry) for entry in row.elts) for row in entries if isinstance(row, ast.List)
            )
            return r"\begin{pmatrix}" + r" \\ ".join(lines) + r"\end{pmatrix}"
        inside = r",\; ".join(self.latex(entry) for entry in entries)
        if isinstance(node, ast.List):
            return rf"\left[{inside}\right]"
        return rf"\left({inside}\right)" if self.code[node.col_offset] == "(" else inside


def _letter(name: str) -> str:
    """A name in the code as a symbol of the paper, in LaTeX."""
    if name.endswith("_prime"):
        return f"{_letter(name.removesuffix('_prime'))}'"
    if name in WORDS or name in FUNCTIONS:
        return WORDS.get(name) or FUNCTIONS[name]
    stem, _, tail = name.partition("_")
    if stem in ("cos", "sin") and tail:
        return rf"\{stem} {_letter(tail)}"
    if tail in ABOVE:
        return rf"{ABOVE[tail]}{{{_letter(stem)}}}"
    return f"{_letter(stem)}_{{{BELOW[tail]}}}" if tail in BELOW else letter(name)


def _call(name: str, arguments: list[str]) -> str:
    if name == "sqrt" and len(arguments) == 1:
        return rf"\sqrt{{{arguments[0]}}}"
    if name in ("abs", "Abs") and len(arguments) == 1:
        return rf"\left|{arguments[0]}\right|"
    inside = rf"\left({', '.join(arguments)}\right)"
    return f"{inside}'" if name == "prime" else f"{_letter(name)}{inside}"


def _ends_in_digit(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) or (isinstance(node, ast.BinOp) and _ends_in_digit(node.right))


def _begins_with_digit(node: ast.expr) -> bool:
    left = node.left if isinstance(node, ast.BinOp) and not isinstance(node.op, ast.Div) else node
    return isinstance(left, ast.Constant) or (left is not node and _begins_with_digit(left))

"""The mutants of a module: cosmic-ray's operators, without those that change nothing a test could see.

Used: each arithmetic operator is replaced by its nearest neighbour (ARITHMETIC), each comparison by its negation and by
the one with the other border (COMPARISONS), each number by the next and the one before; `and` and `or`, `True` and
`False`, `break` and `continue` change places; a sign or a `not` is taken away, a `not` is added to a condition; a loop
runs zero times; what an `except` names is not caught; a decorator is dropped. What proves has mutants of its own:
mutation_core.py.

Left out, and why: see LEFT_OUT of mutation_page.py, which the page prints.
"""

import ast
import hashlib
import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOT = Path(__file__).resolve().parent.parent
STOREYS = ("symbolic", "numeric", "verification")
STATE = ROOT / "report" / "mutation"

ARITHMETIC = (
    "Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "FloorDiv_Div", "Mod_FloorDiv", "LShift_RShift",
    "RShift_LShift", "BitOr_BitAnd", "BitAnd_BitOr", "BitXor_BitOr",
)  # fmt: skip
COMPARISONS = (
    "Eq_NotEq", "NotEq_Eq", "Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE", "GtE_Gt", "GtE_Lt",
    "Is_IsNot", "IsNot_Is",
)  # fmt: skip
OPERATORS = (
    *(f"core/ReplaceBinaryOperator_{name}" for name in ARITHMETIC),
    *(f"core/ReplaceComparisonOperator_{name}" for name in COMPARISONS),
    "core/ReplaceUnaryOperator_USub_UAdd", "core/ReplaceUnaryOperator_Delete_Not",
    "core/AddNot", "core/ReplaceAndWithOr", "core/ReplaceOrWithAnd", "core/ReplaceTrueWithFalse",
    "core/ReplaceFalseWithTrue", "core/ReplaceBreakWithContinue", "core/ReplaceContinueWithBreak",
    "core/ZeroIterationForLoop", "core/ExceptionReplacer", "core/RemoveDecorator", "core/NumberReplacer",
)  # fmt: skip
MEMOS = ("cache", "lru_cache", "memoised")  # decorators that change speed only


@dataclass(frozen=True)
class Mutant:
    """One change: where it is, the line before and after, the lines of its statement, and the whole mutated text."""

    path: str
    operator: str
    function: str
    line: int
    old: str
    new: str
    repeat: int
    statement: tuple[int, int]
    text: str

    @property
    def key(self) -> str:
        """A name that does not move when lines above are added or taken away."""
        again = f" #{self.repeat}" if self.repeat else ""
        return f"{self.path}: {self.old} -> {self.new}{again}"


def statements(tree: ast.Module) -> list[tuple[int, int]]:
    """First and last line of each statement; of one that has a body, of its head."""
    spans = []
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            inside = [child for name in ("body", "cases") for child in getattr(node, name, [])]
            first = min([getattr(node, "lineno", 0), *(d.lineno for d in getattr(node, "decorator_list", []))])
            last = max(first, inside[0].lineno - 1) if inside and hasattr(inside[0], "lineno") else node.end_lineno
            spans.append((first, last))
    return spans


def function_at(tree: ast.AST, line: int) -> str:
    """The innermost function or class around a line, as `Class.method`; empty outside of all."""
    for node in ast.iter_child_nodes(tree):
        if not hasattr(node, "lineno"):
            continue
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
        if first <= line <= node.end_lineno:
            own = [node.name] if isinstance(node, ast.FunctionDef | ast.ClassDef) else []
            inner = function_at(node, line)
            return ".".join([*own, inner] if inner else own)
    return ""


def is_unseen(node) -> bool:
    """Whether no run sees this node: an annotation, a branch for the type checker, the size of a memo."""
    child = node
    while (parent := child.parent) is not None:
        kind = parent.type
        if kind == "annassign" and child is parent.children[1]:
            return True
        if (kind == "param" and child.type == "tfpdef") or (kind == "tfpdef" and child is not parent.children[0]):
            return True
        if kind == "funcdef" and child is parent.annotation:
            return True
        if parent.type == "decorator" and is_memo(parent):
            return True
        if kind == "if_stmt" and parent.children[1].get_code().strip() == "TYPE_CHECKING":
            return True
        child = parent
    return False


def is_memo(node) -> bool:
    """Whether this decorator only remembers results."""
    name = node.get_code().strip().removeprefix("@").partition("(")[0]
    return name.rpartition(".")[2] in MEMOS


def positions(source: str) -> Iterator[tuple[str, int, int]]:
    """Operator, occurrence and line of each change that a run could see."""
    nodes = list(ast_nodes(get_ast(source)))
    for name in OPERATORS:
        operator, occurrence = get_operator(name)(), 0
        for node in nodes:
            for start, _ in operator.mutation_positions(node):
                if not is_unseen(node) and not (name.endswith("RemoveDecorator") and is_memo(node)):
                    yield name.removeprefix("core/"), occurrence, start[0]
                occurrence += 1


class Plain(ast.NodeTransformer):
    """`not a == b` as `a != b`, `not not a` as `a`: so that two operators do not count one mutant twice."""

    NEGATED: ClassVar = {
        ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn,
        ast.NotIn: ast.In, ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt,
    }  # fmt: skip

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        """A negation, pushed into what it negates."""
        self.generic_visit(node)
        inner = node.operand
        if isinstance(node.op, ast.Not) and isinstance(inner, ast.Compare) and len(inner.ops) == 1:
            return ast.Compare(inner.left, [self.NEGATED[type(inner.ops[0])]()], inner.comparators)
        if isinstance(node.op, ast.Not) and isinstance(inner, ast.UnaryOp) and isinstance(inner.op, ast.Not):
            return inner.operand
        return node


def shape_of(source: str) -> str:
    """The syntax tree as text, without places."""
    return ast.dump(Plain().visit(ast.parse(source)))


def mutants(path: str) -> list[Mutant]:
    """Every mutant of a module, in the order of its lines; made once for each text of the module and of this file."""
    source = (ROOT / path).read_text()
    key = hashlib.sha256("\0".join((path, source, Path(__file__).read_text())).encode()).hexdigest()[:24]
    kept = STATE / f"mutants-{key}.json"
    if not kept.is_file():
        STATE.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps([asdict(mutant) for mutant in made(path, source)]))
    entries = json.loads(kept.read_text())
    return [Mutant(**entry | {"statement": tuple(entry["statement"])}) for entry in entries]


def made(path: str, source: str) -> list[Mutant]:
    """The mutants of a text; the same syntax tree is not counted twice."""
    tree = ast.parse(source)
    spans, same = statements(tree), {shape_of(source)}
    repeats: Counter[tuple[str, str]] = Counter()
    found = []
    for operator, occurrence, line in sorted(positions(source), key=lambda position: position[2]):
        text = mutate_code(source, get_operator(f"core/{operator}")(), occurrence)
        try:
            shape = shape_of(text)
        except SyntaxError:
            continue
        if shape in same:
            continue
        same.add(shape)
        old, new = changed(source, text)
        around = [span for span in spans if span[0] <= line <= span[1]]
        statement = min(around, key=lambda span: span[1] - span[0], default=(line, line))
        found.append(
            Mutant(path, operator, function_at(tree, line), line, old, new, repeats[old, new], statement, text)
        )
        repeats[old, new] += 1
    return found


def changed(before: str, after: str) -> tuple[str, str]:
    """The lines in which two texts differ, joined and stripped."""
    one, two = before.splitlines(), after.splitlines()
    head = next((n for n, (a, b) in enumerate(zip(one, two, strict=False)) if a != b), min(len(one), len(two)))
    longest = min(len(one), len(two)) - head
    tail = next((n for n in range(longest) if one[-1 - n] != two[-1 - n]), longest)
    return tuple(" ".join(" ".join(lines[head : len(lines) - tail]).split()) for lines in (one, two))

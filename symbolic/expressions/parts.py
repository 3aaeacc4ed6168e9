"""Splits a generated function into parts: those that depend on only some of its arguments, and the remainder.

The parts contain the function's own assignments, unchanged and in the same order, so that with any kind of numbers the
results have the same bits as those of the whole function.
"""

import ast
from collections.abc import Sequence
from functools import cache

from symbolic.expressions.text import VOCABULARY, Kernel


@cache
def parted(kernel: Kernel, *groups: tuple[str, ...]) -> tuple[Kernel, ...]:
    """A kernel cut into several: for each group of arguments, a kernel of what depends on this group only, and a last
    one.

    The last kernel takes all arguments and then the results of the other kernels, and returns the results of the whole.
    A value that two groups have in common is computed by the kernel of the first one.

    >>> from sympy import cos, sin, symbols
    >>> from symbolic.expressions.text import kernel
    >>> x, y = symbols("x y")
    >>> at_x, at_y, rest = parted(kernel("sum", [x, y], {"s": (sin(x) + cos(y)) ** 2 + sin(x) + y}), ("x",), ("y",))
    >>> at_x.arguments, at_x.results, rest.arguments
    (('x',), ('c0',), ('x', 'y', 'c0'))
    >>> print(rest.text)
    def sum_rest(x, y, c0):
        c1 = c0 + cos(y)
        s = c0 + y + c1 * c1
        return (s,)
    <BLANKLINE>
    """
    (function,) = ast.parse(kernel.text).body
    assert isinstance(function, ast.FunctionDef)
    steps = {_target(step): step for step in function.body if isinstance(step, ast.Assign)}
    needs = {name: _names(step.value) for name, step in steps.items()}
    reach: dict[str, frozenset[str]] = {name: frozenset([name]) for name in kernel.arguments}
    for name in steps:
        reach[name] = frozenset().union(*(reach[each] for each in needs[name]))
    mine = [[name for name in steps if reach[name] <= {*group}] for group in groups]
    own = {name for names in mine for name in names}
    left = [name for name in steps if name not in own]
    asked = {each for name in left for each in needs[name]} | set(kernel.results)
    made, given = list[Kernel](), list[str]()
    for k, (group, names) in enumerate(zip(groups, mine, strict=True)):
        results = [name for name in names if name in asked and name not in given]
        made.append(_written(kernel, f"{kernel.name}_{k}", group, results, [steps[name] for name in names]))
        given += results
    rest = [steps[name] for name in left]
    return *made, _written(kernel, f"{kernel.name}_rest", (*kernel.arguments, *given), kernel.results, rest)


def _target(step: ast.Assign) -> str:
    (target,) = step.targets
    assert isinstance(target, ast.Name)
    return target.id


def _names(e: ast.AST) -> set[str]:
    return {node.id for node in ast.walk(e) if isinstance(node, ast.Name)} - set(VOCABULARY)


def _written(
    kernel: Kernel, name: str, arguments: Sequence[str], results: Sequence[str], steps: Sequence[ast.Assign]
) -> Kernel:
    body = "".join(f"    {ast.unparse(step)}\n" for step in steps)
    listed = ", ".join(results) + ("," if len(results) == 1 else "")
    text = f"def {name}({', '.join(arguments)}):\n{body}    return ({listed})\n"
    return Kernel(name, tuple(arguments), tuple(results), kernel.words, text)

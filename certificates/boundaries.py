"""User-defined boundaries and laws, for `check.py`: their pieces, periods, symmetry and marks, from the formulas alone.

A formula is a syntax tree from `check.parse`. A property is proved from the nodes of the tree, or the document is
refused.
"""

import ast
from fractions import Fraction

from check import I, Wrong, beside, evaluate, need, parse, pi
from identity import atom, exact, function
from identity import plus as added
from identity import times as multiplied

ODD, EVEN = ("sin", "tan", "sinh", "tanh", "atan"), ("cos", "cosh", "abs", "Abs")  # odd and even functions


def parity(node):
    """1 for a formula that is even under theta -> -theta, eta -> -eta, -1 for an odd one, 0 for others."""
    if isinstance(node, ast.Constant):
        return 1
    if isinstance(node, ast.Name):
        return -1 if node.id in ("theta", "eta") else 1
    if isinstance(node, ast.UnaryOp):
        return parity(node.operand)
    if isinstance(node, ast.Call):
        name, inner = getattr(node.func, "id", ""), parity(node.args[0])
        return inner if name in ODD else abs(inner) if name in EVEN else max(inner, 0)
    x, y = parity(node.left), parity(node.right)
    if isinstance(node.op, ast.Add | ast.Sub):
        return x if x == y else 0
    if isinstance(node.op, ast.Mult | ast.Div):
        return x * y
    exponent = linear(node.right) or {}
    whole = set(exponent) == {""} and exponent[""].denominator == 1
    return x ** abs(int(exponent[""])) if whole else max(x, 0) * max(y, 0)


def symmetric(table, parts):
    """True if each of these components is its own image under theta -> -theta, and the law is odd in both signs."""
    wanted = {1: [1], 2: [1, -1]}  # parities of the radius; of x and y
    even = all([parity(node) for node in table.parts[k][:-2]] == wanted[len(table.parts[k]) - 2] for k in parts)
    return even and (table.law is None or parity(table.law) == -1)


def linear(node):
    """The coefficients of a sum of letters and `pi` times fractions, the constant as ""; None for other formulas."""
    if isinstance(node, ast.Constant | ast.Name):
        return {"": node.value} if isinstance(node, ast.Constant) else {node.id: Fraction(1)}
    if isinstance(node, ast.UnaryOp):
        return times(linear(node.operand), {"": Fraction(-1 if isinstance(node.op, ast.USub) else 1)})
    x, y = map(linear, (node.left, node.right)) if isinstance(node, ast.BinOp) else (None, None)
    if x is None or y is None:
        return None
    if isinstance(node.op, ast.Div) and {*y} == {""}:
        return times(x, {"": 1 / y[""]})
    if isinstance(node.op, ast.Mult):
        return times(x, y)
    return plus(x, y, -1 if isinstance(node.op, ast.Sub) else 1) if isinstance(node.op, ast.Add | ast.Sub) else None


def times(x, y):
    """The product of two such sums, if one of them is a fraction."""
    if x is None or {*x} <= {""}:
        x, y = y, x
    return x and y and ({k: v * y[""] for k, v in x.items()} if {*y} == {""} else None)


def plus(x, y, sign):
    found = {key: x.get(key, 0) + sign * y.get(key, 0) for key in {*x, *y}}
    return {key: v for key, v in found.items() if v}


def has_theta(node):
    return any(isinstance(part, ast.Name) and part.id == "theta" for part in ast.walk(node))


def slope(node):
    """The coefficient of theta in a formula that is linear in theta and free of it otherwise; None for others."""
    if not has_theta(node):
        return Fraction(0)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        x, y = map(slope, (node.left, node.right))
        return None if x is None or y is None else x + y if isinstance(node.op, ast.Add) else x - y
    return (linear(node) or {}).get("theta")


def periodic(node):
    """True if theta occurs only in sines, cosines and tangents of whole multiples of theta plus constants."""
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("sin", "cos", "tan"):
        rate = slope(node.args[0])
        if rate is not None and rate.denominator == 1:
            return True
    if isinstance(node, ast.Name):
        return node.id != "theta"
    return all(periodic(part) for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr))


def closed(part):
    """True if a component is a closed curve of period 2*pi, from its formulas and its ends."""
    *formulas, start, end = part
    return linear(ast.BinOp(end, ast.Sub(), start)) == {"pi": 2} and all(map(periodic, formulas))


def called_by(way, said):
    """A boundary in words, as in titles of documents."""
    return {
        "polar": lambda: f"polar {said}",
        "parametric": lambda: f"parametric {'; '.join(said)}",
        "component": lambda: f"boundary of {len(said)} pieces",
    }[way]()


def pieces(way, said):
    """The components of a boundary: the formulas of each, and the ends of theta."""
    if way == "component":
        return [[entry[key] for key in ("x", "y", "from", "to")] for entry in said]
    return [[said, "-pi", "pi"]] if way == "polar" else [[*said, "-pi", "pi"]]


def own(table, way, scene, span):
    """The closed components, and the points where the map is undefined; proves that the boundary bounds a table.

    For a letter with a range, `span`, this is proved for the whole range. A law that is not periodic in theta holds for
    bounces between the ends only.
    """
    length = table.law and any(getattr(node, "id", "") == "s" for node in ast.walk(table.law))
    need(not length, "scene: a law with s, arc length as an integral, is read by `pinball check` alone", Wrong)
    if way != "table":
        shape = scene.get("shape", {})
        letters(table, shape)
        known = {name: exact(parse(text), {})[0] for name, text in shape.items() if name != span}
        table.closed = list(map(closed, table.parts))
        table.curves = joined(table, known)
        table.marks = [marked(table, mark) for mark in scene.get("undefined", [])]
        cusps = cusped(table, scene.get("undefined", []), known) if way == "polar" else []
        beside("curves").outline(table, span, cusps)
    if table.law and not periodic(table.law):
        table.closed = [False] * len(table.parts)


def letters(table, shape):
    """Refuses a formula with a letter without number or range, and a letter that no formula has."""
    for k, part in enumerate(table.parts, 1):
        need(
            words(part) <= {*shape, "theta", "pi", "E"},
            f"scene: piece {k} has a letter without a number or a range",
            Wrong,
        )
    used = words([*(tree for part in table.parts for tree in part), *([table.law] if table.law else [])])
    need({*shape} <= used, "scene: the table has other letters, and so has the law", Wrong)


def words(trees):
    """The letters of formulas."""
    nodes = [node for tree in trees for node in ast.walk(tree)]
    called = {id(node.func) for node in nodes if isinstance(node, ast.Call)}
    return {node.id for node in nodes if isinstance(node, ast.Name) and id(node) not in called}


def joined(table, known):
    """The closed curves of a boundary, each a range of pieces whose ends are proved to be the same points.

    A curve continues where the next piece begins at the end of a piece, and must otherwise be closed.
    """
    tips, first, curves = [[tip(part, end, known) for end in part[-2:]] for part in table.parts], 0, []
    for k, (_, last) in enumerate(tips, 1):
        if k == len(tips) or last != tips[k][0]:
            back = last == tips[first][0] or (first == k - 1 and table.closed[first])
            need(back, f"scene: the boundary is not closed: piece {k} is not seen to end where another begins", Wrong)
            curves, first = [*curves, range(first, k)], k
    return curves


def tip(part, end, known):
    """The point at an end of a piece, as sums in the letters without numbers."""
    at = known | {"theta": exact(end, known)[0]}
    found = [exact(node, at)[0] for node in part[:-2]]
    return found if len(found) > 1 else [multiplied(found[0], function(name, at["theta"])) for name in ("cos", "sin")]


def cusped(table, marks, known):
    """The marked places, modulo `2*pi`, at which radius and slope are 0: there a radius may vanish."""
    found = []
    for (_, place), mark in zip(table.marks, marks, strict=True):
        theta = exact(parse(mark["theta"]), known)[0]
        for turn in (-2, 0, 2):
            at = known | {"theta": added(theta, atom("pi"), turn)}
            if exact(table.parts[0][0], at) == ({}, {}):
                found.append((mark["theta"], I.of(place, table.p) + pi(table.p) * turn))
    need(len({text for text, _ in found}) <= 1, "scene: the radius is 0 at more than one point", Wrong)
    return [place for _, place in found]


def marked(table, mark):
    """The component and parameter of a point where the map is undefined."""
    fit = 0 <= mark["component"] < len(table.parts)
    need(fit, "scene: an undefined point is not understood", Wrong)
    return mark["component"], I.of(evaluate(parse(mark["theta"]), table.letters, table.p)[0], table.p)

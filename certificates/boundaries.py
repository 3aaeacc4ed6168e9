"""Boundaries and laws of one's own, for `check.py`: pieces, periods, symmetry and marks, from their formulas alone.

A formula is a tree, as `check.parse` makes it. What is asked of one is seen in its nodes, or refused.
"""

import ast
from fractions import Fraction

from check import I, Unproved, Wrong, beside, evaluate, need, parse, pi

ODD, EVEN = ("sin", "tan", "sinh", "tanh", "atan"), ("cos", "cosh", "abs", "Abs")  # as functions


def parity(node):
    """1 of a formula that theta -> -theta, eta -> -eta leaves as it is, -1 of one whose sign it turns, 0 of others."""
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
    """Is each of these components its own image under theta -> -theta, and the law its own under both signs?"""
    wanted = {1: [1], 2: [1, -1]}  # of the radius; of x and y
    even = all([parity(node) for node in table.parts[k][:-2]] == wanted[len(table.parts[k]) - 2] for k in parts)
    return even and (table.law is None or parity(table.law) == -1)


def linear(node):
    """The coefficients of a sum of letters and `pi` times fractions, the constant under no name; None of another."""
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
    """The product of two such sums where one of them is a fraction."""
    if x is None or {*x} <= {""}:
        x, y = y, x
    return x and y and ({k: v * y[""] for k, v in x.items()} if {*y} == {""} else None)


def plus(x, y, sign):
    found = {key: x.get(key, 0) + sign * y.get(key, 0) for key in {*x, *y}}
    return {key: v for key, v in found.items() if v}


def has_theta(node):
    return any(isinstance(part, ast.Name) and part.id == "theta" for part in ast.walk(node))


def slope(node):
    """The fraction that theta has in a formula that is else free of it; None of one that is not of this form."""
    if not has_theta(node):
        return Fraction(0)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        x, y = map(slope, (node.left, node.right))
        return None if x is None or y is None else x + y if isinstance(node.op, ast.Add) else x - y
    return (linear(node) or {}).get("theta")


def periodic(node):
    """Does theta stand only in sines, cosines and tangents of whole numbers times theta, and of what has none?"""
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("sin", "cos", "tan"):
        rate = slope(node.args[0])
        if rate is not None and rate.denominator == 1:
            return True
    if isinstance(node, ast.Name):
        return node.id != "theta"
    return all(periodic(part) for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr))


def closed(part):
    """Is a component a curve that comes round after 2*pi, from its formulas and its ends?"""
    *formulas, start, end = part
    return linear(ast.BinOp(end, ast.Sub(), start)) == {"pi": 2} and all(map(periodic, formulas))


def called_by(way, said):
    """A boundary in words."""
    return {
        "polar": lambda: f"polar {said}",
        "parametric": lambda: f"parametric {'; '.join(said)}",
        "component": lambda: f"boundary of {len(said)} pieces",
    }[way]()


def pieces(way, said):
    """The components of a boundary: formulas of each, and the ends of theta."""
    if way == "component":
        return [[entry[key] for key in ("x", "y", "from", "to")] for entry in said]
    return [[said, "-pi", "pi"]] if way == "polar" else [[*said, "-pi", "pi"]]


def own(table, way, scene):
    """Which components are closed, and where the map is undefined; a radius is positive where nothing is marked.

    Where a law has theta, and not its period, a bounce lies between the ends."""
    length = table.law and any(getattr(node, "id", "") == "s" for node in ast.walk(table.law))
    need(not length, "scene: a law with s, arc length as an integral, is read by `pinball check` alone", Wrong)
    if way != "table":
        table.turns = [beside("curves").inside]
        table.closed = list(map(closed, table.parts))
        table.curves = joined(table, scene)
        table.marks = [marked(table, mark) for mark in scene.get("undefined", [])]
        if way == "polar" and not table.marks:
            positive(table)
    if table.law and not periodic(table.law):
        table.closed = [False] * len(table.parts)


def fraction(node, names):
    """The value of a formula of fractions, sums, products and whole powers; None of another."""
    if isinstance(node, ast.Constant | ast.Name):
        return node.value if isinstance(node, ast.Constant) else names.get(node.id)
    parts = [getattr(node, key) for key in ("operand", "left", "right") if hasattr(node, key)]
    found = [fraction(part, names) for part in parts]
    if not found or None in found:
        return None
    x, y, op = found[0], found[-1], type(node.op)
    if op in (ast.USub, ast.UAdd, ast.Add, ast.Sub, ast.Mult):
        return {ast.USub: -x, ast.UAdd: x, ast.Add: x + y, ast.Sub: x - y, ast.Mult: x * y}[op]
    if op is ast.Div:
        return x / y if y else None
    bits = x.numerator.bit_length() + x.denominator.bit_length()
    fit = op is ast.Pow and y.denominator == 1 and bits * abs(y) < 10**6 and (x or y > 0)
    return x ** int(y) if fit else None


def number(node, names, p):
    """The value of a formula: as a fraction where it is one, else as an interval."""
    found = fraction(node, {name: x for name, x in names.items() if isinstance(x, Fraction)})
    letters = {name: I.of(x, p) for name, x in names.items()}
    return I.of(evaluate(node, letters, p)[0], p) if found is None else found


def settings(scene, p):
    """The numbers of a scene's parameters: nine times, from end to end, where one has a range."""
    ends = {name: text.partition("..") for name, text in scene.get("shape", {}).items()}
    ends = {name: [number(parse(at[k] or at[0]), {}, p) for k in (0, 2)] for name, at in ends.items()}
    shares = [Fraction(k, 8) for k in range(9 if ".." in "".join(scene.get("shape", {}).values()) else 1)]
    return [{name: low + (high - low) * share for name, (low, high) in ends.items()} for share in shares]


def joined(table, scene):
    """Refuses a piece that does not run forward, and pieces that are no closed curves, one after the other.

    A curve goes on where the next piece begins at a piece's end, and else has to be back where it began."""
    p, cases, known = table.p, settings(scene, table.p), {*scene.get("shape", {}), "theta", "pi", "E"}
    for k, part in enumerate(table.parts, 1):
        nodes = [node for tree in part for node in ast.walk(tree)]
        called = {getattr(node.func, "id", "") for node in nodes if isinstance(node, ast.Call)}
        words = {node.id for node in nodes if isinstance(node, ast.Name)} - called
        need(words <= known, f"scene: piece {k} has a letter without a number or a range", Wrong)
        for here, there in zip(cases, cases[1:] or cases, strict=False):
            names = {name: I.of(x, p).hull(I.of(there[name], p)) for name, x in here.items()}
            low, high = (number(node, names, p) for node in part[-2:])
            need(I.of(high - low, p) > 0, f"scene: piece {k} does not run forward, from less to more", Wrong)
    for names in cases:
        tips, first, curves = [[tip(part, end, names, p) for end in part[-2:]] for part in table.parts], 0, []
        for k, (_, last) in enumerate(tips, 1):
            if k == len(tips) or not meet(last, tips[k][0], p):
                back = meet(last, tips[first][0], p)
                need(back, f"scene: the boundary is not closed: piece {k} ends where no other begins", Wrong)
                curves, first = [*curves, range(first, k)], k
    return curves


def tip(part, end, names, p):
    """The point at an end of a piece."""
    at = names | {"theta": number(end, names, p)}
    found = [number(node, at, p) for node in part[:-2]]
    if len(found) > 1:
        return found
    s, c = I.of(at["theta"], p).sin_cos()
    return c * found[0], s * found[0]


def meet(one, other, p):
    """Are two points the same: exactly where they are fractions, and else as far as intervals see?"""
    gaps = [x - y for x, y in zip(one, other, strict=True)]
    return all(not gap if isinstance(gap, Fraction) else 0 in I.of(gap, p) for gap in gaps)


def positive(table):
    """Refuses a radius that may not be, over the range of a free parameter."""
    queue, spent = [(Fraction(-1), Fraction(1))], 0
    while queue:
        a, b = queue.pop()
        spent += 1
        need(spent < 500, "scene: the radius may not be positive", Wrong)
        names = table.letters | {"theta": pi(64) * I.of(a, 64).hull(I.of(b, 64))}
        try:
            radius = I.of(evaluate(table.parts[0][0], names, 64)[0], 64)
            need(radius.hi > 0, "scene: the radius may not be positive", Wrong)
            queue += [] if radius > 0 else [(a, (a + b) / 2), ((a + b) / 2, b)]
        except Unproved:  # a formula may have no value on a wide piece
            queue += [(a, (a + b) / 2), ((a + b) / 2, b)]


def marked(table, mark):
    """Component and parameter of a point where the map is undefined."""
    fit = set(mark) == {"name", "component", "theta"} and type(mark["component"]) is int
    need(fit and 0 <= mark["component"] < len(table.parts), "scene: an undefined point is not understood", Wrong)
    return mark["component"], I.of(evaluate(parse(mark["theta"]), table.letters, table.p)[0], table.p)

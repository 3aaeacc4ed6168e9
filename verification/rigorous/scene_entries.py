"""The scene of a certificate: table and law as JSON entries, read and written, and as a title in words.

Such entries differ from a scene file: they have no starts and no name, and the free parameter has a range in place of a
number.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from flint import arb
from sympy import Expr, S

from symbolic import tables
from symbolic.tables.definition import (
    BOUNDARY,
    KEYS,
    KINDS,
    LAW_NAMES,
    PAPER,
    PIECE,
    POINTS,
    RESERVED,
    UNIFORM,
    boundary_of,
    built,
    known_entries,
    range_ends,
    table_boundary,
    text_entry,
)
from symbolic.tables.formula import LENGTH, number
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table
from symbolic.tables.validity import prove_table
from verification.arithmetic.balls import bits_of, real_ball, working

LARGEST_K = 1000
PARAMETER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")


def scene_said(table: Table, law: Law, lam: Expr | None = None) -> dict[str, Any]:
    """The JSON entries of a table, of a law, and of `lam` unless it is free. A fitted table is written as its formula.

    >>> from symbolic.tables.law import PAPERS_LAW
    >>> scene_said(tables.egg(3).at(alpha="2/25"), PAPERS_LAW, S(1) / 3)
    {'table': 'egg', 'shape': {'alpha': '2/25'}, 'lam': '1/3'}
    """
    boundary, held = table_boundary(replace(table, fit=None))
    scene = {key: value for key, value in boundary.items() if key != "name"}
    scene |= {"shape": {parameter: str(value) for parameter, value in held.items()}} if held else {}
    if "table" not in boundary and table.shapes:  # the free parameter of a user's table: its range
        (own,) = table.shapes
        scene |= {"shape": {own.symbol.name: f"{own.range.start}..{own.range.end}"}}
    scene |= {} if law.uniform else _law_said(table, law, scene)
    return scene | ({} if lam is None else {"lam": str(lam)})


def _law_said(table: Table, law: Law, scene: dict[str, Any]) -> dict[str, Any]:
    """The entries `law` and `shape`: the law's formula, and the law's parameters beside those of the table."""
    if law.measured and len(table.components) > 1:
        raise ValueError(
            f"certificate: law = {law} has another formula in theta on each component of {table.name}, "
            "which a certificate cannot state; write the law in theta"
        )
    shape, own = scene.get("shape", {}), dict(law.numbers)
    twice = [name for name in own if shape.get(name, own[name]) != own[name]]
    if twice:
        raise ValueError(f"certificate: {twice[0]} is a parameter of the table, and another one of the law; rename one")
    return ({"shape": {**shape, **own}} if shape or own else {}) | {"law": law.formula}


def title_of(scene: Mapping[str, Any]) -> str:
    """A scene in words, from its JSON entries.

    >>> title_of({"polar": "1 + cos(5*theta)/40", "lam": "1/3"})
    'polar 1 + cos(5*theta)/40, lam = 1/3'
    """
    kind = next(key for key in KINDS if key in scene)
    title = scene[kind] if kind == "table" else f"{kind} {scene[kind]}"
    if kind in ("parametric", "component"):
        pieces = scene[kind]
        title = f"boundary of {len(pieces)} pieces" if kind == "component" else f"parametric {'; '.join(pieces)}"
    points = f" of {scene['K']} points" if "K" in scene else ""
    law = [("phi", scene["law"])] if "law" in scene else []
    numbers = [(name, text) for name, text in scene.get("shape", {}).items() if ".." not in text]
    said = [*law, *numbers, *([("lam", scene["lam"])] if "lam" in scene else [])]
    return title + points + "".join(f", {k} = {v}" for k, v in said)


def scene_of(scene: Mapping[str, Any], free: str, box: arb) -> tuple[Table, Law]:
    """Table and law from JSON entries; `free` names the parameter that may have a range, which must hold `box`.

    A user's boundary is proved valid over the whole range; `ValueError` if this fails.
    """
    known_entries("certificate: scene", scene, tuple(key for key in KEYS if key != "name"))
    law = Law(text_entry("law", scene.get("law", UNIFORM)))
    texts = scene.get("shape", {})
    for parameter in texts:
        if not PARAMETER.fullmatch(parameter) or parameter in (*LAW_NAMES, *RESERVED):
            raise ValueError(f"certificate: shape: {ascii(parameter)[:60]} cannot be the name of a parameter")
    ranges = {parameter: text for parameter, text in texts.items() if isinstance(text, str) and ".." in text}
    if set(ranges) - {free}:
        raise ValueError(f"certificate: {', '.join(ranges)} has a range; only the free parameter may have one")
    numbers = {parameter: number(text, parameter) for parameter, text in texts.items() if parameter not in ranges}
    law = law.at(**{parameter: numbers[parameter] for parameter in law.parameters if parameter in numbers})
    if "table" in scene:
        table = tables.named(scene["table"], scene.get("K", POINTS))
        own = set(numbers) - (set(dict(law.numbers)) - set(PAPER[table.name]))  # one number may belong to both
        return table.at(**{parameter: numbers[parameter] for parameter in own}), law
    table = _over(scene, *next(iter(ranges.items())), box) if ranges else built(boundary_of(scene, ()))
    prove_table(table, {shape.symbol: (shape.range.start, shape.range.end) for shape in table.shapes})
    return table, law


def _over(scene: Mapping[str, Any], parameter: str, text: str, box: arb) -> Table:
    """The table over the range of its free parameter; `ValueError` unless the range holds the `box`."""
    low, high = range_ends(parameter, text)
    boundary = {key: value for key, value in scene.items() if key in BOUNDARY}
    table = Scene.of({**boundary, "shape": {parameter: f"{low}:{low}..{high}"}}).family
    with working(bits_of(30)):
        if not (box >= real_ball(S(low)) and box <= real_ball(S(high))):
            raise ValueError(f"certificate: {parameter} is not proved to lie in its range {text}")
    return table


def check_size(scene: Mapping[str, Any]) -> None:
    """`ValueError` where `K` or a formula of a scene is too large for other certificate checkers."""
    if scene.get("K", POINTS) > LARGEST_K:
        raise ValueError(f"certificate: K = {scene['K']} is too much; accepted: up to {LARGEST_K}")
    formulas = [scene.get("polar", ""), *scene.get("parametric", ()), scene.get("law", "")]
    formulas += [part[key] for part in scene.get("component", ()) for key in PIECE[1:]]
    if longest := max((text for text in formulas if len(text) > LENGTH), key=len, default=""):
        raise ValueError(f"certificate: a formula of {len(longest)} characters is too long; accepted: {LENGTH}")

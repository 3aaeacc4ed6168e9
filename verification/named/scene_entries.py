"""What the scene of a certificate says: a table and a law as entries, and the other way round; and in words.

Unlike a scene file it has no starts and no name, and the range of a free parameter stands in the place of its number.
"""

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
    PAPER,
    POINTS,
    UNIFORM,
    boundary_of,
    built,
    known_entries,
    range_ends,
    table_boundary,
    text_entry,
)
from symbolic.tables.formula import number
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table
from verification.arithmetic.balls import bits_of, real_ball, working

SCHEMA, THIRD, SECOND, FIRST = 4, 3, 2, 1  # versions of the format


def scene_said(table: Table, law: Law, lam: Expr | None = None, schema: int = SCHEMA) -> dict[str, Any]:
    """The entries of a table, a law, and a contraction that is not free. A fitted table is its fit.

    >>> from symbolic.tables.law import PAPERS_LAW
    >>> scene_said(tables.egg(3).at(alpha="2/25"), PAPERS_LAW, S(1) / 3)
    {'table': 'egg', 'shape': {'alpha': '2/25'}, 'lam': '1/3'}
    """
    boundary, held = table_boundary(replace(table, fit=None) if schema == SCHEMA else table)
    scene = {key: value for key, value in boundary.items() if key != "name"}
    scene |= {"shape": {parameter: str(value) for parameter, value in held.items()}} if held else {}
    if "table" not in boundary and table.shapes:  # the free parameter of a table of one's own, by its range
        (own,) = table.shapes
        scene |= {"shape": {own.symbol.name: f"{own.range.start}..{own.range.end}"}}
    scene |= {} if law.uniform else _law_said(table, law, scene)
    return scene | ({} if lam is None else {"lam": str(lam)})


def _law_said(table: Table, law: Law, scene: dict[str, Any]) -> dict[str, Any]:
    """The law's formula, and the numbers of its own parameters beside the table's."""
    if law.measured and len(table.components) > 1:
        raise ValueError(
            f"certificate: law = {law} has another formula in theta on each component of {table.name}, "
            "which a certificate has no words for; write the law in theta"
        )
    shape, own = scene.get("shape", {}), dict(law.numbers)
    twice = [name for name in own if shape.get(name, own[name]) != own[name]]
    if twice:
        raise ValueError(f"certificate: {twice[0]} is a number of the table, and another one of the law; rename one")
    return {"shape": {**shape, **own}, "law": law.formula}


def title_of(scene: Mapping[str, Any], schema: int = SCHEMA) -> str:
    """A scene in words.

    >>> title_of({"polar": "1 + cos(5*theta)/40", "lam": "1/3"})
    'polar 1 + cos(5*theta)/40, lam = 1/3'
    """
    kind = next(key for key in KINDS if key in scene)
    title = scene[kind] if kind == "table" else f"{kind} {scene[kind]}"
    if schema == SCHEMA and kind in ("parametric", "component"):
        pieces = scene[kind]
        title = f"boundary of {len(pieces)} pieces" if kind == "component" else f"parametric {'; '.join(pieces)}"
    points = f" of {scene['K']} points" if "K" in scene else ""
    law = [("phi", scene["law"])] if "law" in scene else []
    numbers = [(name, text) for name, text in scene.get("shape", {}).items() if ".." not in text]
    said = [*law, *numbers, *([("lam", scene["lam"])] if "lam" in scene else [])]
    return title + points + "".join(f", {k} = {v}" for k, v in said)


def scene_of(scene: Mapping[str, Any], free: str, box: arb) -> tuple[Table, Law]:
    """Table and law of such entries; a `free` parameter of a table of one's own has a range, which the `box` is in."""
    known_entries("certificate: scene", scene, tuple(key for key in KEYS if key != "name"))
    law = Law(text_entry("law", scene.get("law", UNIFORM)))
    texts = scene.get("shape", {})
    ranges = {parameter: text for parameter, text in texts.items() if isinstance(text, str) and ".." in text}
    if set(ranges) - {free}:
        raise ValueError(f"certificate: {', '.join(ranges)} has a range; accepted: for the free parameter alone")
    numbers = {parameter: number(text, parameter) for parameter, text in texts.items() if parameter not in ranges}
    law = law.at(**{parameter: numbers[parameter] for parameter in law.parameters if parameter in numbers})
    if "table" in scene:
        table = tables.named(scene["table"], int(scene.get("K", POINTS)))
        own = set(numbers) - (set(dict(law.numbers)) - set(PAPER[table.name]))  # one number may be of both
        table = table.at(**{parameter: numbers[parameter] for parameter in own})
    elif ranges:
        table = _over(scene, *next(iter(ranges.items())), box)
    else:
        table = built(boundary_of(scene, ()))
    return table, law


def _over(scene: Mapping[str, Any], parameter: str, text: str, box: arb) -> Table:
    """The table over the range of its free parameter, in which the `box` must lie."""
    low, high = range_ends(parameter, text)
    boundary = {key: value for key, value in scene.items() if key in BOUNDARY}
    table = Scene.of({**boundary, "shape": {parameter: f"{low}:{low}..{high}"}}).family
    with working(bits_of(30)):
        if not (box >= real_ball(S(low)) and box <= real_ball(S(high))):
            raise ValueError(f"certificate: {parameter} is not proved to lie in its range {text}")
    return table

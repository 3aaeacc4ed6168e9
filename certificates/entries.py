"""The reading of files, for `check.py`: strict JSON that fits its schema, before anything is proved.

The schemas are in `schema/`; of JSON Schema the keywords used there are implemented. A whole number is written without
a point, and neither text nor `true` is a number.
"""

import ast
import json
import re
from fractions import Fraction
from functools import cache
from pathlib import Path

from check import Wrong, need

LARGEST, LONGEST_INTEGER = 2**22, 20  # the most bytes of a file; the most characters of a whole number
STEPS, MORE = 250_000, 1000  # the most steps of formulas for one file, and more for each of its bounces
SCHEMAS = {"trapping region": "trapping_region_1", "boundary crisis": "boundary_crisis_1"}
TYPES = {
    "object": [dict],
    "array": [list],
    "string": [str],
    "boolean": [bool],
    "integer": [int],
    "number": [int, float],
}


def read(path):
    """The document in a file; a key that occurs twice, or NaN, is refused as ambiguous."""
    with Path(path).open("rb") as file:
        text = file.read(LARGEST + 1)
    need(len(text) <= LARGEST, f"the file has more than {LARGEST} bytes", Wrong)
    try:
        return json.loads(text.decode(), object_pairs_hook=once, parse_int=whole, parse_constant=no_number)
    except RecursionError:
        raise Wrong("the file is nested too deeply") from None


def once(pairs):
    found = dict(pairs)
    need(len(found) == len(pairs), f"a key stands twice among {ascii(sorted(found))[:60]}", Wrong)
    return found


def whole(text):
    need(len(text) <= LONGEST_INTEGER, "a whole number is too long", Wrong)
    need(text != "-0", "0 has no sign", Wrong)
    return int(text)


def no_number(text):
    raise Wrong(f"{text} is no number")


@cache
def schema(name):
    return json.loads((Path(__file__).parent / "schema" / f"{name}.json").read_text(encoding="utf-8"))


def fits(given):
    """Refuses a document that does not fit the schema of its kind."""
    kind = given.get("kind") if isinstance(given, dict) else None
    root = schema(SCHEMAS.get(kind, "version_4") if isinstance(kind, str) else "version_4")
    fault = wrong(given, root, root, "")
    need(not fault, f"the file is not of its format: {fault}", Wrong)


def budget(given):
    """The number of formula steps that a file may take; a step is one operation on numbers of up to 512 bits."""
    cells = {"trapping region": 8 * STEPS, "boundary crisis": 40 * STEPS}.get(given["kind"])
    return cells or STEPS + MORE * len(given.get("components", given.get("orbit", [])))


def equal(x, y):
    return type(x) is type(y) and x == y


def wrong(x, rule, root, at):
    """The first violation of a rule by a value, in words, with its place; nothing where there is none."""
    if rule is True or rule is False:
        return "" if rule else f"{at} is one too many"
    name = at or "the document"
    if "$ref" in rule:
        named = schema(rule["$ref"].split("#")[0].removesuffix(".json")) if rule["$ref"][0] != "#" else root
        if fault := wrong(x, named["$defs"][rule["$ref"].rpartition("/")[2]], named, at):
            return fault
    if "type" in rule and type(x) not in TYPES[rule["type"]]:
        return f"{name} must be of type {rule['type']}"
    if ("const" in rule and not equal(x, rule["const"])) or not any(equal(x, y) for y in rule.get("enum", [x])):
        return f"{name} must be {' or '.join(map(str, rule.get('enum', [rule.get('const')])))}"
    if "oneOf" in rule and sum(not wrong(x, way, root, at) for way in rule["oneOf"]) != 1:
        return f"{name} must say just one of {', '.join(way['required'][0] for way in rule['oneOf'])}"
    if "if" in rule and (fault := wrong(x, rule["else" if wrong(x, rule["if"], root, at) else "then"], root, at)):
        return fault
    within = {str: in_text, list: in_list, dict: in_object, int: in_range, float: in_range}.get(type(x))
    return within(x, rule, root, at) if within else ""


def in_text(x, rule, root, at):
    fit = rule.get("minLength", 0) <= len(x) <= rule.get("maxLength", LARGEST)
    return "" if fit and re.fullmatch(rule.get("pattern", ".*"), x) else f"{at} = {ascii(x)[:60]} is not of its form"


def in_range(x, rule, root, at):
    fit = rule.get("minimum", x) <= x <= rule.get("maximum", x)
    fit = fit and ("exclusiveMinimum" not in rule or rule["exclusiveMinimum"] < x < rule["exclusiveMaximum"])
    return "" if fit else f"{at} is out of range"


def in_list(x, rule, root, at):
    first = rule.get("prefixItems", [])
    if not rule.get("minItems", 0) <= len(x) <= rule.get("maxItems", LARGEST):
        return f"{at} has {len(x)} entries"
    rules = (first[k] if k < len(first) else rule.get("items", True) for k in range(len(x)))
    faults = (wrong(y, one, root, f"{at}[{k}]") for k, (y, one) in enumerate(zip(x, rules, strict=True)))
    return next(filter(None, faults), "")


def in_object(x, rule, root, at):
    if missing := [key for key in rule.get("required", []) if key not in x]:
        return f"{at or 'the document'} has no entry {missing[0]}"
    known, rest = rule.get("properties", {}), rule.get("additionalProperties", True)
    for key, value in x.items():
        if not re.fullmatch(rule.get("propertyNames", {}).get("pattern", ".*"), key) or (
            rest is False and key not in known
        ):
            return f"{at or 'the document'} has the entry {ascii(key)[:60]}, which means nothing"
        if fault := wrong(value, known.get(key, rest), root, f"{at}.{key}" if at else key):
            return fault
    return "" if len(x) >= rule.get("minProperties", 0) else f"{at} is empty"


def parse(text):
    """The syntax tree of a formula, by Python's grammar, never executed. A decimal is the exact decimal shown."""
    need(re.fullmatch(r"[\w+\-*/^(). ]{1,2000}", text, re.ASCII), "a formula has characters that mean nothing", Wrong)
    said = text.strip().replace("^", "**")
    try:
        tree = ast.parse(said, mode="eval").body
        for node in (node for node in ast.walk(tree) if isinstance(node, ast.Constant)):
            shown = ast.get_source_segment(said, node)
            node.value = Fraction(shown if re.fullmatch(r"[\d.]+([eE][-+]?\d{1,3})?", shown) else "")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Wrong(f"the formula {text[:60]} is not understood") from None
    return tree

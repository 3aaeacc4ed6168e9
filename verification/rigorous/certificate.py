"""Theorems that are written as JSON documents, in which each entry is a field of the theorem's dataclass, in order.

>>> from dataclasses import dataclass, field
>>> from verification.rigorous.theorem import hypothesis
>>> @dataclass(frozen=True, eq=False, repr=False)
... class Divides(Certified):
...     '''A whole number divides another.'''
...     kind = "divisor"
...     divisor: int = field(metadata=whole("divisor", 100))
...     number: int = field(metadata=whole("number", 10**6, 0))
...
...     @property
...     def name(self) -> str:
...         return f"{self.divisor} divides {self.number}"
...
...     @hypothesis
...     def no_remainder(self) -> bool:
...         '''Nothing is left over.'''
...         return self.number % self.divisor == 0
>>> document = Divides(3, 12).to_dict()
>>> document
{'schema': 1, 'name': '3 divides 12', 'kind': 'divisor', 'divisor': 3, 'number': 12}
>>> Divides.from_dict(document).proved
True
"""

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import fields
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

from flint import arb

from verification.arithmetic.balls import decimal
from verification.rigorous.theorem import Theorem

SCHEMA = 4  # the version of the format of cycles, corner orbits and tangencies
LARGEST_FILE, LONGEST_INTEGER = 2**22, 20  # bytes of a file; digits of a JSON integer
END = re.compile(r"0|[1-9][0-9]{0,39}(/[1-9][0-9]{0,39})?")  # an end of a range of contractions, as text
Metadata = dict[str, "Entry"]


class Entry(NamedTuple):
    """How a field is read from its entry, given the fields before, and written; an empty `name` means the field's."""

    read: Callable[[Any, Mapping[str, Any]], Any]
    write: Callable[[Any], Any]
    name: str


def entry(
    read: Callable[[Any, Mapping[str, Any]], Any], write: Callable[[Any], Any] = lambda value: value, name: str = ""
) -> Metadata:
    """Metadata of a dataclass field that is an entry of the certificate, with the functions that read and write it."""
    return {"entry": Entry(read, write, name)}


def whole(name: str, most: int, least: int = 1) -> Metadata:
    """Metadata of a dataclass field that is an integer from `least` to `most`."""
    return entry(lambda given, _: whole_number(name, given, most, least))


def whole_number(name: str, given: Any, most: int, least: int = 1) -> int:
    """The entry `given` if it is an integer from `least` to `most`; else `ValueError` that names the entry."""
    if isinstance(given, bool) or not isinstance(given, int) or not least <= given <= most:
        raise ValueError(f"certificate: {name} holds {given!r}; accepted: whole numbers from {least} to {most}")
    return given


def parse_range(given: Any) -> tuple[Fraction, Fraction]:
    """The two ends of a range of contractions; `ValueError` unless they are two fractions as text."""
    if not all(isinstance(end, str) and END.fullmatch(end) for end in given) or len(given) != 2:
        raise ValueError(f"certificate: lam = {ascii(given)[:80]}; accepted: two ends, as fractions")
    return Fraction(given[0]), Fraction(given[1])


RANGE = entry(lambda given, _: parse_range(given), lambda ends: [str(end) for end in ends])


def decimal_result(value: arb, digits: int) -> dict[str, Any]:
    """The entry `result` of a document: value and radius of a ball in decimals, and the number of digits."""
    middle, radius = decimal(value, digits + 1)
    return {"value": middle, "radius": radius, "digits": digits}


class Certified(Theorem):
    """A theorem that can be written as a JSON document, with a fixed entry `kind`.

    Subclasses are frozen dataclasses with `eq=False, repr=False`: theorems with the same document are equal. The
    attributes `map` and `proof` are not pickled; their functions are compiled anew.
    """

    kind: ClassVar[str]
    schema: ClassVar[int] = 1
    beside: ClassVar[tuple[str, ...]] = ()  # entries of `evidence` that are not in the statement

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        return hash(self.name)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("map", "proof")}

    @property
    def name(self) -> str:
        """The title of the theorem: the statement with its data, in one line."""
        raise NotImplementedError

    @property
    def evidence(self) -> dict[str, Any]:
        """Further entries of the document: the checklist, or data that spare a checker the search."""
        return {}

    @property
    def result(self) -> dict[str, Any]:
        """The proved value as a decimal, with radius and digits; empty for a theorem without a value."""
        return {}

    @property
    def follows(self) -> dict[str, Theorem]:
        """The theorems that are deduced from this one, by name."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document."""
        written = {}
        for each in fields(self):  # type: ignore[arg-type]  # subclasses are dataclasses
            entry: Entry = each.metadata["entry"]
            written[entry.name or each.name] = entry.write(getattr(self, each.name))
        return {"schema": self.schema, "name": self.name, "kind": self.kind, **written}

    def document(self) -> dict[str, Any]:
        """The certificate, which consists of the statement and the evidence."""
        return self.to_dict() | self.evidence

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> Self:
        """The theorem that a document states; `ValueError` names the first entry that is wrong."""
        try:
            if json.dumps(given["schema"]) != str(cls.schema):
                said = ascii(given["schema"])[:80]
                raise ValueError(f"certificate: schema = {said} is unknown; this version reads {cls.schema}")
            return cls.read(given)
        except (KeyError, IndexError, TypeError, AttributeError, OverflowError) as error:
            raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> Self:
        """The theorem of a document of this version, read field by field."""
        read: dict[str, Any] = {}
        if given["kind"] != cls.kind:
            raise ValueError(f"certificate: {ascii(given['kind'])[:80]} is no {cls.kind}")
        for each in fields(cls):  # type: ignore[arg-type]
            entry: Entry = each.metadata["entry"]
            read[each.name] = entry.read(given[entry.name or each.name], read)
        return cls(**read)

    def check_entries(self, given: Mapping[str, Any], evidence: Mapping[str, Any] | None = None) -> None:
        """Raises `ValueError` at the first entry of a document that differs, as JSON text, from the entry of this
        theorem.

        Without `evidence` the entries in `beside` may be anything. Runs of cells may stand in any order.
        """
        true = self.to_dict() | ({"runs": given["runs"]} if "runs" in given else {})
        if _text(given.get("name")) != _text(true["name"]):
            said = ascii(given.get("name"))[:80]
            raise ValueError(f"certificate: name = {said} is not what it states, which is {true['name']!r}")
        true |= {key: entry for key, entry in (evidence or {}).items() if key != "checks"}
        wrong = [key for key in true if _text(given.get(key)) != _text(true[key])]
        if wrong:
            said, meant = (ascii(found)[:200] for found in (given.get(wrong[0]), true[wrong[0]]))
            raise ValueError(f"certificate: {wrong[0]} = {said} is not what its equations say, which is {meant}")
        if unknown := set(given) - {*true, *self.beside}:
            known = ", ".join(true)
            raise ValueError(f"certificate: the entry {ascii(min(unknown))[:60]} is unknown; accepted: {known}")
        if evidence and "checks" in evidence:
            listed, checks = given.get("checks"), evidence["checks"]
            if not isinstance(listed, Mapping) or set(listed) != set(checks):
                raise ValueError(f"certificate: checks must list just these: {', '.join(checks)}")
            if any(verdict is not True and verdict is not checks[item] for item, verdict in listed.items()):
                raise ValueError("certificate: checks must say true of each item that is proved")


def _text(entry: Any) -> str:
    """An entry as JSON text, in which 4 differs from 4.0, and 1 from true."""
    return json.dumps(entry, sort_keys=True)


def read_document(path: Path) -> dict[str, Any]:
    """The JSON object in a file; `ValueError` if it is too large, not JSON, or ambiguous, as by a repeated key."""
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST_FILE + 1)
        if len(text) > LARGEST_FILE:
            raise ValueError(f"it has more than {LARGEST_FILE} bytes")
        found = json.loads(text.decode("utf-8"), object_pairs_hook=_once, parse_int=_whole, parse_constant=_no_number)
    except OSError as error:
        raise ValueError(f"certificate {str(path)!r} cannot be read ({error.strerror})") from None
    except RecursionError:
        raise ValueError(f"certificate {str(path)!r} is no JSON document: it is nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"certificate {str(path)!r} is no JSON document: {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"certificate {str(path)!r} holds no JSON object")
    return found


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(key for k, (key, _) in enumerate(pairs) if key in dict(pairs[:k]))
        raise ValueError(f"the key {ascii(twice)[:60]} stands twice in one object")
    return found


def _whole(text: str) -> int:
    if len(text) > LONGEST_INTEGER:
        raise ValueError(f"a whole number has {len(text)} digits")
    if text == "-0":
        raise ValueError("0 has no sign")
    return int(text)


def _no_number(text: str) -> None:
    raise ValueError(f"{text} is no number")

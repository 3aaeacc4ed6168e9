"""Which claims depend on code that changed: a digest of every module that a judge can load, read off the imports.

Nothing is run for it: the source text names what it imports, at the top or inside a function, and a module that names
another depends on it. So the set is never too small, and it is larger than what one claim needs.
"""

import re
from collections.abc import Iterable, Mapping
from functools import cache
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from verification.paper.claims.claim import Claim
from verification.paper.figures.catalogue import Picture
from verification.paper.report.report import made_with

STOREYS = ("symbolic", "numeric", "verification")
OURS = rf"(?:{'|'.join(STOREYS)})"
FROM = re.compile(r"^[ \t]*from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[^\n(]*)", re.MULTILINE)
IMPORT = re.compile(rf"^[ \t]*import[ \t]+({OURS}[\w.]*)", re.MULTILINE)
LEFT_OUT = re.compile(
    r'"""[\s\S]*?"""|^if TYPE_CHECKING:\n(?:[ \t].*\n|\n)*', re.MULTILINE
)  # words, and what runs nothing
QUOTED = re.compile(rf"[\"']({OURS}(?:\.\w+)+)[\"'.]")  # a module named by text, or the room of one


@cache
def sources() -> Mapping[str, str]:
    """The text of every module of the package by its dotted name; of a room's stub, by the room's and `.pyi`."""
    found: dict[str, str] = {}
    for storey in STOREYS:
        _gather(files(storey), storey, found)
    return found


def _gather(folder: Traversable, name: str, found: dict[str, str]) -> None:
    for path in folder.iterdir():
        if path.is_dir() and (path / "__init__.py").is_file():
            _gather(path, f"{name}.{path.name}", found)
        elif path.name.endswith((".py", ".pyi")):
            stem, ending = path.name.split(".")
            dotted = name if stem == "__init__" else f"{name}.{stem}"
            found[f"{dotted}.pyi" if ending == "pyi" else dotted] = path.read_text(encoding="utf-8")


@cache
def exports(room: str) -> Mapping[str, str]:
    """Where the names come from that a room hands out when asked for them.

    >>> exports("verification")["verify"]
    'verification.paper.report.report'
    """
    pairs = FROM.findall(sources().get(f"{room}.pyi", ""))
    return {name: f"{room}{origin}".rstrip(".") for origin, names in pairs for name in _names(names)}


def _names(listed: str) -> list[str]:
    return [name.split(" as ")[0].strip() for name in listed.strip("()").split(",") if name.strip()]


@cache
def imports(module: str) -> frozenset[str]:
    """The modules of the package that the text of one names.

    >>> "symbolic.expressions.signs" in imports("verification.paper.claims.judges")
    True
    """
    found = named(LEFT_OUT.sub("", sources()[module]))
    # Packages run first.
    above = {each.rsplit(".", n)[0] for each in {*found, module} for n in range(1, each.count(".") + 1)}
    return frozenset((found | above) & sources().keys())


def named(text: str) -> set[str]:
    """The modules of the package that a text imports or quotes, and the names that it takes from them."""
    known, found = sources(), set(IMPORT.findall(text))
    for origin, names in FROM.findall(text):
        found.add(origin)
        if origin in known:
            for name in _names(names):
                found |= {f"{origin}.{name}", *([exports(origin)[name]] if name in exports(origin) else [])}
    for quoted in QUOTED.findall(text):
        found |= {quoted, *(each for each in known if each.rpartition(".")[0] == quoted)}
    return found


def closure(module: str) -> frozenset[str]:
    """The module and all that it can load, directly or through others."""
    found, waiting = {module}, [module]
    while waiting:
        new = imports(waiting.pop()) - found
        found |= new
        waiting += new
    return frozenset(found)


@cache
def digest(module: str) -> str:
    """A digest of the text of a module and of all that it can load, and of the versions of what they rest on."""
    whole = sha256(repr(sorted(made_with().items())).encode())
    for name in sorted(closure(module)):
        whole.update(f"\n{name}\n".encode() + sources()[name].encode())
    return whole.hexdigest()


def codes(claims: Iterable[Claim], digits: int, figures: Iterable[Picture] = ()) -> dict[str, str]:
    """A digest for each claim, by its id, and for each figure of their sections, by `figure NAME`.

    It changes with the claim's words, its judge, all that this can load, and how many digits are asked for.
    """
    claims = list(claims)
    judged = {claim.id: _digest(claim.home, claim, digits) for claim in claims}
    sections = {claim.section for claim in claims}
    return judged | {f"figure {each.name}": _digest(each.module, each) for each in figures if each.section in sections}


def _digest(module: str, *words: object) -> str:
    code = outside(module) if module.endswith(".py") else digest(module)
    return sha256(repr((code, words)).encode()).hexdigest()


def outside(path: str) -> str:
    """A digest of a module that is no part of the package, with all that it can load of the package."""
    text = Path(path).read_text(encoding="utf-8")
    whole = sha256(text.encode())
    for name in sorted(named(text) & sources().keys()):
        whole.update(digest(name).encode())
    return whole.hexdigest()

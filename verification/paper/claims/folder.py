"""A paper in a folder: its bibliographic data, its claims as printed, and the modules that judge them.

`paper.toml` has the title, the authors, the citation, the sections, and the claims or the files that hold them;
`judges.py`, or the modules that it names, has a judge for each claim. Reading a folder runs no code of it; a judge runs
when its claim is judged.
"""

import json
import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from hashlib import sha256
from importlib import import_module
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from numeric.lowering.files import write_whole
from verification.paper.claims.claim import Claim
from verification.paper.claims.judges import JUDGES, Judge

FILE = "paper.toml"
OWN = "focusing"  # the default paper
SHIPPED = Path(__file__).resolve().parent  # where the papers that come with the package are
ROOT = SHIPPED.parents[2]
JUDGED, QUOTED = re.compile(r"^@judges\(([^)]*)\)", re.MULTILINE), re.compile(r"[\"']([^\"']+)[\"']")


@dataclass(frozen=True)
class Paper:
    """A paper read from a folder: citation, sections in order (with their own source, if any), and claims in order.

    `judges` are modules and `figures` is a module with a function `pictures`. `seconds` is a record of computing times,
    `unsettled` has the reasons why claims are not settled, and `certified` the certificates of claims; all are paths,
    empty where the folder has none. `senses` defines words of the paper as the verdicts understand them.
    """

    folder: Path
    title: str
    authors: tuple[str, ...]
    citation: str
    sections: Mapping[str, str]
    claims: tuple[Claim, ...]
    judges: tuple[Path, ...]
    sentences: tuple[Path, ...] = ()
    figures: str = ""
    seconds: str = ""
    unsettled: str = ""
    certified: str = ""
    senses: Mapping[str, str] = field(default_factory=dict)

    @property
    def about(self) -> dict[str, object]:
        """Title, authors and citation, as a JSON object."""
        return {"title": self.title, "authors": list(self.authors), "citation": self.citation}

    @property
    def source(self) -> str:
        """The authors and the citation, as text."""
        return "; ".join(filter(None, (", ".join(self.authors), self.citation)))

    def certificates(self) -> dict[str, tuple[Path, ...]]:
        """The certificates, by claim id, of each claim whose certificate files all exist.

        >>> [path.name for path in paper().certificates()["egg.doubling.3"]]
        ['doubling-3.json']
        """
        if not self.certified:
            return {}
        listed = _toml(Path(self.certified))
        folders = [Path(self.certified).parent / name for name in listed["folders"]]
        home = next((path for path in folders if path.is_dir()), self.folder)
        files = {name: tuple(home / f"{each}.json" for each in known) for name, known in listed["files"].items()}
        return {name: paths for name, paths in files.items() if all(path.is_file() for path in paths)}


BESIDE = ("figures", "seconds", "unsettled", "certified")
NAMED = dict.fromkeys(("title", "citation", *BESIDE), str)
LISTED = ("authors", "letters", "claims", "sentences", "judges")
ENTRY = {"id": str, "section": str, "quote": str, "printed": (str, list), "kind": str, "over": dict, "base": str}


def read(folder: Path) -> Paper:
    """The paper in a folder, without running its code; `ValueError` says in a sentence what is wrong."""
    path = folder / FILE
    if not path.is_file():
        raise ValueError(f"{folder} has no {FILE}; `pinball claims new DIR` makes a folder that has one")
    whole = _toml(path)
    own = whole.pop("claim", [])
    _checked(
        path,
        whole,
        {**NAMED, **dict.fromkeys(LISTED, list), "sections": (list, dict), "senses": dict},
        ("title", "sections"),
    )
    lists = {name: tuple(map(str, whole.get(name, ()))) for name in LISTED}
    entries = [(path, entry) for entry in own]
    entries += [(folder / name, entry) for name in lists["claims"] for entry in _toml(folder / name).get("claim", [])]
    sections = whole["sections"] if isinstance(whole["sections"], dict) else dict.fromkeys(whole["sections"], "")
    claims = tuple(_claim(where, entry, sections, lists["letters"]) for where, entry in entries)
    twice = [name for name, number in Counter(claim.id for claim in claims).items() if number > 1]
    if twice or not claims:
        raise ValueError(f"{path}: {f'two claims have the id {twice[0]!r}' if twice else 'there is no [[claim]]'}")
    beside = {name: str(folder / whole[name]) if name in whole else "" for name in BESIDE}
    judges, sentences = ([folder / name for name in lists[key]] for key in ("judges", "sentences"))
    return Paper(
        folder,
        whole["title"],
        lists["authors"],
        whole.get("citation", ""),
        sections,
        claims,
        tuple(judges or [folder / "judges.py"]),
        tuple(sentences),
        **beside,
        senses={word: str(meaning) for word, meaning in whole.get("senses", {}).items()},
    )


def _toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # not TOML, or not UTF-8
        raise ValueError(f"{path} is no TOML: {error}") from None


def _checked(where: Path, entry: Any, kinds: Mapping[str, Any], needed: Iterable[str], name: str = "") -> None:
    """Raises `ValueError` if a table of the file has a missing, unknown or wrong key, and says what is accepted."""
    label = f"{where}{f', claim {name!r}' if name else ''}"
    if not isinstance(entry, dict):
        raise ValueError(f"{label}: a claim is a table [[claim]], not {entry!r}")
    for key in needed:
        if key not in entry:
            raise ValueError(f"{label}: {key!r} is missing")
    for key, value in entry.items():
        if key not in kinds:
            raise ValueError(f"{label}: no key is called {key!r}; accepted: {', '.join(kinds)}")
        rows = value if isinstance(value, list) else []
        texts = all(isinstance(each, str) or (key == "printed" and _texts(each)) for each in rows)
        if not isinstance(value, kinds[key]) or not texts:
            raise ValueError(f"{label}: {key} = {value!r} should be {WANTED[kinds[key]]}")


def _texts(row: Any) -> bool:
    return isinstance(row, list) and all(isinstance(each, str) for each in row)


WANTED = {str: "a text", list: "a list of texts", dict: "a table", (str, list): "a text or a list of them"}
WANTED[list, dict] = "a list of texts, or a table with a source for each"


def _claim(where: Path, entry: Any, sections: Mapping[str, str], letters: tuple[str, ...]) -> Claim:
    _checked(
        where,
        entry,
        ENTRY,
        ("id", "section", "quote", "printed"),
        entry.get("id", "") if isinstance(entry, dict) else "",
    )
    if entry["section"] not in sections:
        listed = ", ".join(map(repr, sections))
        raise ValueError(f"{where}, claim {entry['id']!r}: no section is called {entry['section']!r}; listed: {listed}")
    over = tuple(entry.get("over", {}).items())
    found = Claim(**{"kind": "property", **entry, "over": over, "letters": letters})
    for name, text in over:
        ranged = isinstance(text, str) and (text[:1] not in ("[", "(") or "," in text)  # other ranges are in words
        if name not in found.names or not ranged:
            said = f"over = {{ {name} = {text!r} }} is no range of a letter"
            raise ValueError(f'{where}, claim {entry["id"]!r}: {said}; accepted: over = {{ lam = "(0, 1/3)" }}')
    return found


def paper(claims: str | Path = OWN) -> Paper:
    """The paper in a folder, or a paper of the package by its name, with the module that judges each claim.

    No code of the folder is run: the judges are read from the text of the decorators. `ValueError` names a claim
    without a judge, or a judge without a claim.

    >>> paper().sections["4 Cardioid"], paper("focusing").authors[0]
    ('', 'A. Arroyo')
    """
    folder = Path(claims)
    known = sorted(path.parent.name for path in SHIPPED.glob("*/paper.toml"))
    if not folder.is_dir():
        if str(claims) in known:
            return _shipped(str(claims))
        raise ValueError(
            f"there is no folder {str(claims)!r}; accepted: a folder with a paper.toml, {', '.join(known)}"
        )
    return _with_judges(read(folder.resolve()))


@cache
def _shipped(name: str) -> Paper:
    return _with_judges(read(SHIPPED / name))


def _with_judges(found: Paper) -> Paper:
    homes: dict[str, str] = {}
    for path in found.judges:
        if not path.is_file():
            raise ValueError(f"{found.folder} names the judges in {path}, and there is no such file")
        for ids in JUDGED.findall(path.read_text(encoding="utf-8")):
            for name in QUOTED.findall(ids):
                if name in homes:
                    raise ValueError(f"{path}: {name!r} is judged twice; one judge for each claim")
                homes[name] = home(path)
    ids = [claim.id for claim in found.claims]
    for name in ids:
        if name not in homes:
            raise ValueError(
                f"the claim {name!r} has no judge; write a function below @judges({name!r}) in {found.judges[0]}"
            )
    for name, where in homes.items():
        if name not in ids:
            raise ValueError(f"{where} judges {name!r}, which is no claim of {found.folder}")
    seconds, spares = recorded(found)
    why = _toml(Path(found.unsettled)).get("reasons", {}) if found.unsettled else {}
    for name in why:
        if name not in ids:
            raise ValueError(f"{found.unsettled} speaks of {name!r}, which is no claim of {found.folder}")
    new = (
        replace(
            claim,
            home=homes[claim.id],
            seconds=seconds.get(claim.id, claim.seconds),
            spares=tuple(spares.get(claim.id, {}).items()),
            unsettled=why.get(claim.id, ""),
        )
        for claim in found.claims
    )
    return replace(found, claims=tuple(new))


def recorded(found: Paper) -> tuple[dict[str, float], dict[str, dict[str, float]]]:
    """The recorded seconds of each claim, and the seconds that its results save others; empty without a record."""
    if not found.seconds:
        return {}, {}
    record = json.loads(Path(found.seconds).read_text(encoding="utf-8"))
    return record["seconds"], record["spares"]


def begin(folder: Path) -> list[Path]:
    """Writes a folder for a paper with one claim and its judge; returns the files. `ValueError` if it exists."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise ValueError(f"{folder} is there already; accepted: a new folder, or an empty one")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        written = [folder / name for name in (FILE, "judges.py")]
        for path in written:
            write_whole(path, (SHIPPED / "skeleton" / f"{path.stem}.txt").read_bytes())
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror or error}") from None
    return written


def home(path: Path) -> str:
    """The name of a judge's module: dotted within this package, else its path.

    >>> home(Path(__file__))
    'verification.paper.claims.folder'
    """
    path = path.resolve()
    inside = path.is_relative_to(ROOT) and (path.parent / "__init__.py").is_file()
    return ".".join(path.relative_to(ROOT).with_suffix("").parts) if inside else str(path)


def judge_of(claim: Claim) -> Judge:
    """The function that judges a claim; its module is imported at the first call."""
    return JUDGES[module(claim.home).__name__, claim.id]


class _AsItStands(SourceFileLoader):
    """A loader that reads a module from its source and ignores bytecode, which may be out of date."""

    def get_code(self, fullname: str) -> CodeType:
        return self.source_to_code(self.get_data(self.path), self.path)


def module(home: str) -> ModuleType:
    """A module of this package by its dotted name, or another by its path, reloaded if its text has changed."""
    if not home.endswith(".py"):
        return import_module(home)
    path = Path(home)
    try:
        name = f"claims_{sha256(str(path).encode() + path.read_bytes()).hexdigest()[:12]}_{path.stem}"
        if name not in sys.modules:
            spec = spec_from_file_location(name, path, loader=_AsItStands(name, str(path)))
            assert spec is not None
            assert spec.loader is not None
            found = module_from_spec(spec)
            spec.loader.exec_module(found)
            sys.modules[name] = found
    except (Exception, SystemExit) as error:
        raise ValueError(f"{path} cannot be loaded: {type(error).__name__}: {error}") from error
    return sys.modules[name]

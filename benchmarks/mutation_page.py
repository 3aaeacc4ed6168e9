"""The page on mutation testing, from docs/mutation.json (what was measured) and docs/mutation.toml (why some survive).

An entry of the TOML file is a `[[reason]]` with the `module`, a sentence `why`, and the mutants it speaks of: `changes`
are texts "line before -> line after" as `list` and the JSON file have them, `lines` are lines before, all of whose
survivors it explains.
"""

import json
import tomllib
from functools import cache
from importlib.metadata import version

from mutation_mutants import LEFT_OUT, ROOT

FIGURES, REASONS, PAGE = (ROOT / "docs" / f"mutation.{end}" for end in ("json", "toml", "md"))
OPEN = "Neither killed nor explained yet"
HEAD = """\
# Mutation testing

A mutant is the package with one small mistake: a `+` for a `-`, a `<` for a `<=`, a 3 for a 2. The tests kill it when
one of them fails. This page counts the mutants that they do not kill, and says of each why. It is written by
`python benchmarks/mutation.py page`; `make mutation` measures what has not been measured.

Mutants are made with the operators of cosmic-ray {version}. A coverage run says which tests execute which statement. A
fork for each mutant, in which no module that depends on it has been imported before, asks these tests: the module's own
first, the quickest first. No memo and no file of an earlier run is left, so nothing hides a mutant. A test has three
times its own seconds and five more; one that is stopped by then has failed (`timeout`), as has a module that cannot be
imported.

{summary}

## By module

| module | mutants | killed | of these by timeout | survived | share killed | explained |
|---|---|---|---|---|---|---|
"""


def percent(share: float) -> str:
    """A share with one digit, cut and not rounded up."""
    return f"{int(share * 1000 + 1e-9) / 10:.1f} %"


def killed(entry: dict) -> int:
    """How many mutants of a module some test noticed."""
    return entry.get("killed", 0) + entry.get("timeout", 0)


@cache
def given() -> list[dict]:
    """The entries of the file with the reasons."""
    return tomllib.loads(REASONS.read_text()).get("reason", [])


def reason(path: str, before: str, after: str) -> str:
    """Why this mutant survives; empty when nobody has said."""
    for entry in given():
        named = f"{before} -> {after}" in entry.get("changes", []) or before in entry.get("lines", [])
        if named and entry["module"] == path:
            return entry["why"].strip()
    return ""


def reasons(path: str, alive: list[dict]) -> dict[str, list[dict]]:
    """The survivors of a module under the reasons given for them."""
    found: dict[str, list[dict]] = {}
    for mutant in alive:
        found.setdefault(reason(path, mutant["before"], mutant["after"]) or OPEN, []).append(mutant)
    return found


def summary(name: str, figures: dict[str, dict]) -> str:
    """One sentence on a storey."""
    asked, total = (sum(entry[key] for entry in figures.values()) for key in ("asked", "mutants"))
    hits = sum(map(killed, figures.values()))
    alive = sum(len(entry["alive"]) for entry in figures.values())
    opened = sum(len(reasons(path, entry["alive"]).get(OPEN, [])) for path, entry in figures.items())
    every = "all " if asked == total else ""
    text = f"`{name}`: {hits} of {every}{asked} mutants killed, {percent(hits / asked)}; {alive} survive, "
    text += f"of which {alive - opened} are explained below" if opened else "each explained below"
    if asked < total:
        text += f". Asked was a random part of {total} mutants"
    fresh, fresh_hits = (sum(entry.get(key, 0) for entry in figures.values()) for key in ("fresh", "fresh_killed"))
    if fresh and asked < total:
        from numeric.dynamics.kinds import wilson  # here: no mutant is asked after the package was imported

        share = wilson(fresh_hits, fresh)
        text += f". Of {fresh} mutants drawn at random after the last test was written {fresh_hits} are killed, "
        text += f"{percent(fresh_hits / fresh)}; Wilson's 95 % interval for all that were not asked before is "
        text += f"{percent(share.low)} to {percent(share.high)}"
    return text + "."


def row(path: str, entry: dict) -> str:
    """The line of a module in the table."""
    asked, opened = entry["asked"], len(reasons(path, entry["alive"]).get(OPEN, []))
    part = f"{asked}" if asked == entry["mutants"] else f"{asked} of {entry['mutants']}"
    cells = [f"`{path}`", part, killed(entry), entry.get("timeout", 0), len(entry["alive"])]
    cells += [percent(killed(entry) / asked), len(entry["alive"]) - opened]
    return "| " + " | ".join(map(str, cells)) + " |\n"


def survivors(path: str, entry: dict) -> str:
    """A module's survivors, reason by reason."""
    text = f"\n### `{path}`\n"
    for why, mutants in reasons(path, entry["alive"]).items():
        text += f"\n{why}:\n\n" if why == OPEN else f"\n{why}\n\n"
        for mutant in mutants:
            text += f"    {mutant['line']:>3} - {mutant['before']}\n        + {mutant['after']}\n"
    return text


def page(figures: dict[str, dict]) -> str:
    """The whole page."""
    storeys = sorted({path.partition("/")[0] for path in figures}, reverse=True)
    parts = {name: {path: entry for path, entry in figures.items() if path.startswith(name + "/")} for name in storeys}
    text = HEAD.format(version=version("cosmic-ray"), summary="\n\n".join(summary(*part) for part in parts.items()))
    text += "".join(row(path, entry) for path, entry in sorted(figures.items()))
    text += "\n## What is left out\n\n" + "".join(f"- {what}: {why}.\n" for what, why in LEFT_OUT.items())
    text += "\n## Survivors\n\nLine, before (-) and after (+).\n"
    return text + "".join(survivors(path, entry) for path, entry in sorted(figures.items()) if entry["alive"])


def write_page(new: dict[str, dict]) -> None:
    """Merges new figures into those that are kept, and writes the page."""
    figures = (json.loads(FIGURES.read_text()) if FIGURES.is_file() else {}) | new
    figures = {path: entry for path, entry in sorted(figures.items()) if (ROOT / path).is_file() and entry["mutants"]}
    FIGURES.write_text(json.dumps(figures, indent=1) + "\n")
    PAGE.write_text(page(figures))

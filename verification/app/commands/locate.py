"""`pinball locate`: the parameter values of named events, to a given number of certified digits.

`pinball check` verifies a certificate without the search that found it.
"""

import os
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from numeric.lowering.files import write_whole
from symbolic.tables.definition import exact, like, words_of
from symbolic.tables.scene import Scene
from verification.app.cli import DIGITS, DONE, FAILED, Output, Whole, json_option, plot_option
from verification.app.scene import optional_options

if TYPE_CHECKING:
    from verification.named.locate import Located
    from verification.plots.results import Marked


PARAMETERS = ("lam", "alpha", "n", "period")
TANGENCY = "tangency"  # only with a table


def _names(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """The names of events that begin with `begun`, for completion in a shell."""
    from verification.named.locate import NAMES

    return [name for name in (*NAMES, TANGENCY) if name.startswith(begun)]


@click.command(epilog="Example: pinball locate saddle-node --alpha 0.08 --digits 50")
@click.argument("name", shell_complete=_names)
@optional_options
@click.option("--digits", type=Whole(1, 20_000), default=30, show_default=True, help="Decimal digits.")
@click.option("--lam", metavar="NUMBER", help="The contraction, for alpha-tilde and alpha-hat; LOW:HIGH for a table.")
@click.option("--n", metavar="INTEGER", help="Which doubling, of period 2^(n-1) to 2^n, or which interior crisis.")
@click.option("--period", metavar="INTEGER", help="Of a table's cycles; of the attractors that a window began with.")
@click.option(
    "--searches",
    type=Whole(1, 100),
    metavar="INTEGER",
    help="At how many values a table's cycles are looked for; 12, or 3 for tangencies, which take longer.",
)
@click.option("--certificate", metavar="FILE", help="Write the certificate, for `pinball check`.")
@plot_option("dynamics.situated", "the cycle in the table, and the branch near the value")
@json_option
def command(
    name: str,
    scene: Scene | None,
    axis: str | None,
    bare: dict[str, Any],
    digits: int,
    n: str | None,
    period: str | None,
    searches: int | None,
    certificate: str | None,
    output: Output,
) -> int:
    """Where does it happen, to N certified digits? Exit status 1 when something is not proved.

    NAME is lambda-star, phi-star, lambda-c, alpha-tilde, alpha-hat, saddle-node, doubling, symmetry-breaking, or
    merging-crisis, boundary-crisis, symmetry-restoring, band-merging, interior-crisis and, with --period, window-end,
    window-merging, family-end, family-merging: tangencies of manifolds. The tangency is proved; that the attractor
    changes there, and not earlier, is not. With --law the value is followed from the paper's law to another one.

    With a table, saddle-node, doubling and symmetry-breaking are bifurcations of its cycles of one --period, as --lam
    LOW:HIGH varies, or as --shape NAME=LOW:HIGH varies at one --lam. For tangency, --lam LOW:HIGH varies, and the
    manifolds of saddles up to that period are searched for contacts. Cycles are searched for at some values only: each
    bifurcation found is proved, but not that there is no other.
    """
    from symbolic.tables.formula import number
    from symbolic.tables.law import PAPERS_LAW, Law
    from verification.named.locate import locate

    if certificate is not None:
        writable(certificate)
    if scene is not None:
        if n is not None or period is None:
            raise ValueError(
                "bifurcations of a table take --period and not --n; accepted: --period with an integer from 2"
            )
        return of_scene(scene, axis, name, bare["lam"], period, digits, searches, certificate, output)
    if bare["K"] is not None:
        raise ValueError(f"--K {bare['K']} needs a table; accepted: egg --K {bare['K']}, with --period")
    if name == TANGENCY:
        raise ValueError("locate tangency needs a table; accepted: egg --alpha 2/25 --lam 0.6:0.7 --period 3")
    options = bare["lam"], bare["alpha"], n, period
    given = {parameter: text for parameter, text in zip(PARAMETERS, options, strict=True) if text is not None}
    shape = {parameter: number(text, f"--{parameter}") for parameter, text in given.items()}
    if "n" in shape and not shape["n"].is_Integer:
        raise ValueError(f"--n {n} is no integer; accepted: integers from 2")
    if "period" in shape and not shape["period"].is_Integer:
        raise ValueError(f"--period {period} is no integer; accepted: the period of a window, as in docs/crises.md")
    law = PAPERS_LAW if bare["law"] is None else Law(bare["law"])
    with output.progress(f"Locating {name}", 1) as step:
        found = locate(name, digits, law, **shape)
        step(name)
    if certificate is not None:
        _write(certificate, found)
    output.write(found.to_dict(), [found], n or period)
    show(output, found, "search and proof")
    return DONE if found.certified else FAILED


def of_scene(
    scene: Scene,
    axis: str | None,
    name: str,
    lam: str | None,
    period: str,
    digits: int,
    searches: int | None,
    certificate: str | None,
    output: Output,
) -> int:
    """Locates and prints the bifurcations of a table's cycles, or its tangencies; returns the exit status."""
    from verification.named.bifurcations import FEW_SEARCHES, KINDS, SEARCHES, bifurcations
    from verification.named.locate import NAMES

    asked_of = *KINDS, TANGENCY
    if name not in asked_of:
        why = f"{name} knows its own table of the paper" if name in NAMES else f"no value is called {name}"
        raise ValueError(f"locate: {why}; accepted with {scene.name}: {', '.join(asked_of)}{like(name, asked_of)}")
    if not (period.isascii() and period.isdigit() and len(period) <= DIGITS and int(period) >= 2):
        raise ValueError(f"--period {period} is no period; accepted: integers from 2")
    scene, parameter, ends = interval_of(scene, axis, lam)
    count = searches or (FEW_SEARCHES if name == TANGENCY else SEARCHES)
    asked: dict[str, Any] = {"period": int(period), "digits": digits, parameter: ends}
    asked["searches"] = count if name == TANGENCY else searches
    with output.progress(f"Locating {name}", count) as step:
        if name != TANGENCY:
            found = bifurcations(scene, name, tick=step, **asked)
        else:
            found = _tangencies(scene, parameter, asked | {"tick": step})
    if certificate is not None and found:
        if len(found) != 1:
            raise ValueError(
                f"--certificate holds one value, and {len(found)} were found; accepted: a smaller interval"
            )
        _write(certificate, found[0])
    document = {"name": name, "period": int(period), "parameter": parameter, "from": str(ends[0]), "to": str(ends[1])}
    output.write({**document, "found": [one.to_dict() for one in found]}, *([found] if found else []))
    for one in found:
        show(output, one, "proof")
    if not found:
        said = f"no {name} of period {period} found for {parameter} from {ends[0]} to {ends[1]}"
        output.console.print(f"{said} from cycles at {count} values; --searches {3 * count} looks at more")
    return DONE if found and all(one.certified for one in found) else FAILED


def _tangencies(scene: Scene, parameter: str, asked: dict[str, Any]) -> "tuple[Located, ...]":
    """The tangencies of a table's manifolds as the contraction varies; `ValueError` if another parameter varies."""
    if parameter != "lam":
        raise ValueError(f"locate tangency: {parameter} varies; accepted: --lam LOW:HIGH")
    from verification.named.tangencies import tangencies

    return tangencies(scene, **asked)


def interval_of(scene: Scene, axis: str | None, lam: str | None) -> tuple[Scene, str, tuple[str, str]]:
    """The scene at its fixed contraction, the parameter that varies, and the two ends of its interval."""
    if lam is None:
        raise ValueError("--lam is missing; accepted: LOW:HIGH, or one number and --shape NAME=LOW:HIGH")
    ends = (axis or "").rpartition("=")[2] or lam
    low, colon, high = ends.partition(":")
    if axis is None and not colon and len(scene.ranges) == 1:
        ((name, (first, last)),) = scene.ranges.items()
        return scene.at(lam=exact("--lam", lam)), name, (str(first), str(last))
    if not colon or (axis is not None and ":" in lam):
        raise ValueError(
            f"--lam {lam}: one parameter varies; accepted: LOW:HIGH, or a number and --shape NAME=LOW:HIGH"
        )
    if axis is None:
        return scene, "lam", (low, high)
    name, known = axis.partition("=")[0] if "=" in axis else "", [*scene.shape, *dict(scene.law.numbers)]
    name = name or (known[0] if len(known) == 1 else name)
    if name not in known:
        raise ValueError(
            f"--shape {axis}: {name or 'this'} is no parameter here; accepted: {', '.join(known) or 'none'}"
        )
    return scene.at(lam=exact("--lam", lam)), name, (low, high)


HAPPENS = {"flip": "period {n} doubles", "fold": "period {n} folds", "tangency": "manifolds touch"}  # on a diagram


def marked(path: str, scene: Scene, parameter: str) -> "Marked":
    """The parameter value that a certificate proves for this scene (checked anew), and a text on what happens there."""
    from symbolic.tables.definition import table_boundary
    from verification.named.theorems import checked
    from verification.plots.results import Marked
    from verification.rigorous.certificate import SCHEMA, read_document

    given = read_document(Path(path))
    boundary, held = table_boundary(replace(scene.table, fit=None))
    shape = {name: str(value) for name, value in held.items()} | dict(scene.law.numbers)
    own = {key: value for key, value in boundary.items() if key != "name"}
    own |= ({} if scene.law.uniform else {"law": scene.law.formula}) | {"shape": shape}
    own |= {} if parameter == "lam" else {"lam": str(scene.lam)}
    if given.get("schema") != SCHEMA or given.get("free") != parameter:
        raise ValueError(f"--mark {path} has no {parameter}; accepted: files of locate --certificate for {parameter}")
    said = {"shape": {}, **given["scene"]}
    for either in (own, said):
        either["shape"] = {name: text for name, text in either["shape"].items() if name != parameter}
    if said != own:
        raise ValueError(f"--mark {path} is about another scene: {given.get('statement')}")
    proof = checked(given)
    if not proof.proved:
        raise ValueError(f"--mark {path} does not prove what it says; pinball check {path} shows the checklist")
    n = len(given.get("components", ()))
    words = f"period {2 * n} loses its symmetry" if given.get("mirror") and given["kind"] == "flip" else None
    words = words or HAPPENS.get(given["kind"], str(given["name"])).format(n=n)
    return Marked(float(proof.result["value"]), words)


def show(output: Output, found: "Located", timed: str) -> None:
    """Prints the value, the checklist and the notes; `timed` says what took the seconds."""
    from verification.named.locate import GMPY2, WORDS

    said = "certified" if found.certified else "not certified"
    output.console.print(f"{found.title} = {found.value} +- {found.radius}  ({said}, {timed} {found.seconds:.2f} s)")
    for item, value in found.checks.items():
        output.console.print(f"  {item.replace('_', ' '):28} {WORDS[value]}")
    notes = {**found.notes, "arithmetic": f"mpmath {'on' if GMPY2 else 'without'} gmpy2 to search, arb to prove"}
    if found.steps:
        notes["newton"] = ", ".join(f"1e{step.correction:.0f} ({step.digits} digits)" for step in found.steps)
    for item, text in notes.items():
        for i, line in enumerate(wrap(str(text), 80 - 31)):
            output.console.print(f"  {'' if i else item.replace('_', ' '):28} {line}")


def writable(path: str) -> None:
    """Raises `ValueError`, before any work, if the certificate's file could not be written."""
    where = Path(path)
    if where.is_dir() or not where.parent.is_dir() or not os.access(where if where.exists() else where.parent, os.W_OK):
        raise ValueError(f"--certificate {path!r} cannot be written; accepted: a file in a directory of yours")


def _write(path: str, found: "Located") -> None:
    if (certificate := found.certificate) is None:
        raise ValueError(
            f"--certificate: {found.name} was not proved here; accepted: names and shapes that are certified"
        )
    write_whole(path, certificate)


@click.command(epilog="Example: pinball locate lambda-c --certificate lambda_c.json && pinball check lambda_c.json")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@json_option
def check_command(files: tuple[str, ...], output: Output) -> int:
    """Does a certificate prove what it says? Exit status 1 when an item of its checklist is not proved.

    The whole checklist is proved anew, whatever verdict the file contains. With several files, the JSON has a list of
    the verdicts under `files`.
    """
    from verification.rigorous.certificate import read_document

    documents = []
    for file in files:
        given = read_document(Path(file))
        try:
            document, lines = _checked(given)
        except ValueError as why:
            raise ValueError(f"{file}: {why}") from None
        documents.append(document)
        for line in lines:
            output.console.print(line)
    output.write(
        documents[0]
        if len(files) == 1
        else {"files": [{"file": file, **document} for file, document in zip(files, documents, strict=True)]}
    )
    return DONE if all(document["certified"] for document in documents) else FAILED


def _checked(given: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Proves a certificate's theorem anew; returns the verdict as a JSON document and as lines of text."""
    from verification.named.locate import WORDS
    from verification.named.theorems import checked

    started = time.perf_counter()
    proof = checked(given)
    certified, checks, seconds = proof.proved, proof.checks, time.perf_counter() - started
    result, follows = proof.result, proof.follows
    document = {"name": proof.name, **result, "certified": certified, "checks": checks, "seconds": seconds}
    value = f" = {result['value']} +- {result['radius']}" if result else ""
    lines = [f"{proof.name}{value}  ({'' if certified else 'not '}certified, proof {seconds:.2f} s)"]
    lines += [f"  {item.replace('_', ' '):28} {WORDS[outcome]}" for item, outcome in checks.items()]
    scene = given["scene"]
    if result and "lam" in scene and "law" in scene and "lam" not in words_of([scene["law"]]):
        lines.append("  the law does not depend on lam, so the contraction above has no effect")
    for name, theorem in follows.items():
        document[name] = theorem.checks
        lines.append(f"  {name.replace('_', ' ') + ' follow':28} {WORDS[theorem.proved or None]}")
    return document, lines

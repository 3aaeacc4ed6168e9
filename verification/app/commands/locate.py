"""`pinball locate`: where does it happen, to so many certified digits?

`pinball check` verifies a certificate without the search that found it.
"""

import json
import os
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import exact, like
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, json_option, plot_option, write_whole
from verification.app.scene import optional_options

if TYPE_CHECKING:
    from verification.named.locate import Located
    from verification.plots.results import Marked


PARAMETERS = ("lam", "alpha", "n", "period")
TANGENCY = "tangency"  # asked of a scene


def _names(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """The names that complete what is typed in a shell."""
    from verification.named.locate import NAMES

    return [name for name in (*NAMES, TANGENCY) if name.startswith(begun)]


@click.command(epilog="Example: pinball locate saddle-node --alpha 0.08 --digits 50")
@click.argument("name", shell_complete=_names)
@optional_options
@click.option("--digits", type=click.IntRange(1, 20_000), default=30, show_default=True, help="Decimal digits.")
@click.option("--lam", metavar="NUMBER", help="The contraction, for alpha-tilde and alpha-hat; LOW:HIGH for a table.")
@click.option("--n", metavar="INTEGER", help="Which doubling, of period 2^(n-1) to 2^n, or which interior crisis.")
@click.option("--period", metavar="INTEGER", help="Of a table's cycles; of the attractors that a window began with.")
@click.option("--searches", type=click.IntRange(1, 100), default=3, show_default=True, help="For a table's cycles.")
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
    searches: int,
    certificate: str | None,
    output: Output,
) -> int:
    """Where does it happen, to N certified digits? Exit status 1 when something is not proved.

    NAME is lambda-star, phi-star, lambda-c, alpha-tilde, alpha-hat, saddle-node, doubling, symmetry-breaking, or
    merging-crisis, boundary-crisis, symmetry-restoring, band-merging, interior-crisis and, with --period, window-end,
    window-merging, family-end, family-merging: tangencies of manifolds, which are proved; that the attractor changes
    there, and nowhere before, is not. With --law they are those of another law, followed there from the paper's.

    With a table, saddle-node, doubling and symmetry-breaking are those of its cycles of one --period, as --lam
    LOW:HIGH varies, or --shape NAME=LOW:HIGH and --lam is one number; tangency is where, as --lam LOW:HIGH varies, the
    manifolds of a saddle up to that period touch. Cycles are looked for at some values: each bifurcation that is found
    is proved, and that there is no other is not.
    """
    from symbolic.tables.formula import number
    from symbolic.tables.law import PAPERS_LAW, Law
    from verification.named.locate import locate

    if certificate is not None:
        writable(certificate)
    if scene is not None:
        if n is not None or period is None:
            raise ValueError("a table's cycles have a --period and no --n; accepted: --period with an integer from 2")
        return of_scene(scene, axis, name, bare["lam"], period, digits, searches, certificate, output)
    if bare["K"] is not None:
        raise ValueError(f"--K {bare['K']} says something of a table; accepted: egg --K {bare['K']}, with --period")
    if name == TANGENCY:
        raise ValueError("locate tangency is asked of a table; accepted: egg --alpha 2/25 --lam 0.6:0.7 --period 3")
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
    show(output, found)
    return DONE if found.certified else FAILED


def of_scene(
    scene: Scene,
    axis: str | None,
    name: str,
    lam: str | None,
    period: str,
    digits: int,
    searches: int,
    certificate: str | None,
    output: Output,
) -> int:
    """The bifurcations of the cycles of a table."""
    from verification.named.locate import NAMES
    from verification.named.questions import KINDS, bifurcations

    asked_of = *KINDS, TANGENCY
    if name not in asked_of:
        why = f"{name} knows its own table of the paper" if name in NAMES else f"no value is called {name}"
        raise ValueError(f"locate: {why}; accepted with {scene.name}: {', '.join(asked_of)}{like(name, asked_of)}")
    if not period.isascii() or not period.isdigit() or int(period) < 2:
        raise ValueError(f"--period {period} is no period; accepted: integers from 2")
    scene, parameter, ends = interval_of(scene, axis, lam)
    asked: dict[str, Any] = {"period": int(period), "digits": digits, "searches": searches, parameter: ends}
    with output.progress(f"Locating {name}", searches) as step:
        if name != TANGENCY:
            found = bifurcations(scene, name, tick=step, **asked)
        else:
            found = _tangencies(scene, parameter, asked | {"tick": step})
    if certificate is not None:
        if len(found) != 1:
            raise ValueError(
                f"--certificate holds one value, and {len(found)} were found; accepted: a smaller interval"
            )
        _write(certificate, found[0])
    document = {"name": name, "period": int(period), "parameter": parameter, "from": str(ends[0]), "to": str(ends[1])}
    output.write({**document, "found": [one.to_dict() for one in found]}, *([found] if found else []))
    for one in found:
        show(output, one)
    if not found:
        output.console.print(f"no {name} of period {period} found for {parameter} from {ends[0]} to {ends[1]}")
    return DONE if found and all(one.certified for one in found) else FAILED


def _tangencies(scene: Scene, parameter: str, asked: dict[str, Any]) -> "tuple[Located, ...]":
    """The tangencies of manifolds as the contraction varies."""
    if parameter != "lam":
        raise ValueError(f"locate tangency: {parameter} varies; accepted: --lam LOW:HIGH")
    from verification.named.tangencies import tangencies

    return tangencies(scene, **asked)


def interval_of(scene: Scene, axis: str | None, lam: str | None) -> tuple[Scene, str, tuple[str, str]]:
    """The scene at its fixed contraction, what varies, and from where to where."""
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
    """The value of a certificate of this scene, checked anew, and what happens there."""
    from symbolic.tables.definition import table_boundary
    from verification.named.files import checked, read
    from verification.named.scene_entries import SCHEMA
    from verification.plots.results import Marked

    given = read(Path(path))
    boundary, held = table_boundary(replace(scene.table, fit=None))
    shape = {name: str(value) for name, value in held.items()} | dict(scene.law.numbers)
    own = {key: value for key, value in boundary.items() if key != "name"}
    own |= ({} if scene.law.uniform else {"law": scene.law.formula}) | {"shape": shape}
    own |= {} if parameter == "lam" else {"lam": str(scene.lam)}
    if given.get("schema") != SCHEMA or given.get("free") != parameter:
        raise ValueError(f"--mark {path} says nothing of {parameter}; accepted: what locate --certificate wrote of it")
    said = {"shape": {}, **given["scene"]}
    for either in (own, said):
        either["shape"] = {name: text for name, text in either["shape"].items() if name != parameter}
    if said != own:
        raise ValueError(f"--mark {path} is about another scene: {given.get('statement')}")
    proof = checked(given)
    if not proof.certified:
        raise ValueError(f"--mark {path} does not prove what it says; pinball check {path} shows the checklist")
    n = len(given.get("components", ()))
    words = f"period {2 * n} loses its symmetry" if given.get("mirror") and given["kind"] == "flip" else None
    words = words or HAPPENS.get(given["kind"], str(given["name"])).format(n=n)
    return Marked(float(proof.value.mid()), words)


def show(output: Output, found: "Located") -> None:
    """The value, the checklist and the notes, for people."""
    from verification.named.locate import GMPY2, WORDS

    said = "certified" if found.certified else "not certified"
    output.console.print(f"{found.title} = {found.value} +- {found.radius}  ({said}, {found.seconds:.2f} s)")
    for item, value in found.checks.items():
        output.console.print(f"  {item.replace('_', ' '):28} {WORDS[value]}")
    notes = {**found.notes, "arithmetic": f"mpmath {'on' if GMPY2 else 'without'} gmpy2 to search, arb to prove"}
    if found.steps:
        notes["newton"] = ", ".join(f"1e{step.correction:.0f} ({step.digits} digits)" for step in found.steps)
    for item, text in notes.items():
        for i, line in enumerate(wrap(str(text), 80 - 31)):
            output.console.print(f"  {'' if i else item.replace('_', ' '):28} {line}")


def writable(path: str) -> None:
    """Refuses, before any work, a file that could not be written."""
    where = Path(path)
    if where.is_dir() or not where.parent.is_dir() or not os.access(where if where.exists() else where.parent, os.W_OK):
        raise ValueError(f"--certificate {path!r} cannot be written; accepted: a file in a directory of yours")


def _write(path: str, found: "Located") -> None:
    from verification.named.files import document

    if found.proof is None:
        raise ValueError(
            f"--certificate: {found.name} was not proved here; accepted: names and shapes that are certified"
        )
    write_whole(Path(path), json.dumps(document(found.proof), indent=1) + "\n")


BOXES = "trapping region", "boundary crisis", "no two attractors"  # kinds of certificates that name no cycle


@click.command(epilog="Example: pinball locate lambda-c --certificate lambda_c.json && pinball check lambda_c.json")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@json_option
def check_command(files: tuple[str, ...], output: Output) -> int:
    """Does a certificate prove what it says? Exit status 1 when an item of its checklist is not proved.

    The whole checklist is worked through anew; what the file says of itself is not believed. With several files the
    JSON has a list of them, under `files`.
    """
    from verification.named.files import read

    documents = []
    for file in files:
        given = read(Path(file))
        boxes = given.get("kind") in BOXES
        try:
            document, lines = (_boxes_checked if boxes else _proof_checked)(given)
        except ValueError as why:
            raise ValueError(f"{file}: {why}" if len(files) > 1 else str(why)) from None
        documents.append(document)
        for line in lines:
            output.console.print(line)
    output.write(
        documents[0]
        if len(files) == 1
        else {"files": [{"file": file, **document} for file, document in zip(files, documents, strict=True)]}
    )
    return DONE if all(document["certified"] for document in documents) else FAILED


Checked = tuple[dict[str, Any], list[str]]


def _proof_checked(given: Mapping[str, Any]) -> Checked:
    """The value that a certificate proves, and its checklist: for JSON, and in lines."""
    from verification.arithmetic.balls import decimal
    from verification.named.files import checked
    from verification.named.locate import WORDS

    started = time.perf_counter()
    proof = checked(given)
    seconds = time.perf_counter() - started
    name = str(given["name"])  # held to be what the equations say
    value, radius = decimal(proof.value, proof.claim.digits + 1)
    document: dict[str, Any] = {
        "name": name,
        "value": value,
        "radius": radius,
        "digits": proof.claim.digits,
        "certified": proof.certified,
        "checks": proof.checks,
        "seconds": seconds,
    }
    said = "certified" if proof.certified else "not certified"
    lines = [f"{name} = {value} +- {radius}  ({said}, {seconds:.2f} s)", *_checklist(proof.checks)]
    if given["kind"] == "tangency":
        from verification.proofs.manifolds.claim import TangencyProof  # NumPy, which no other certificate needs

        if isinstance(proof, TangencyProof):
            document["strange_attractors"] = follow = proof.strange
            lines.append(f"  {'strange attractors follow':28} {WORDS[all(follow.values()) or None]}")
    return document, lines


def _checklist(checks: Mapping[str, bool | None]) -> list[str]:
    from verification.named.locate import WORDS

    return [f"  {item.replace('_', ' '):28} {WORDS[outcome]}" for item, outcome in checks.items()]


def _boxes_checked(given: Mapping[str, Any]) -> Checked:
    """What has no value to show: boxes of a trapping region are mapped anew, those of other statements grow again."""
    from verification.proofs.global_dynamics.crisis import BoundaryCrisis
    from verification.proofs.global_dynamics.regions import Region, checked
    from verification.proofs.unstable_curves.certificate import Certificate

    started = time.perf_counter()
    kinds: tuple[type[Region | BoundaryCrisis | Certificate], ...] = Region, BoundaryCrisis, Certificate
    name, checks = checked(given, kinds[BOXES.index(given["kind"])].from_dict)
    seconds, certified = time.perf_counter() - started, all(checks.values())
    said = "certified" if certified else "not certified"
    document = {"name": name, "certified": certified, "checks": checks, "seconds": seconds}
    return document, [f"{name}  ({said}, {seconds:.2f} s)", *_checklist(checks)]

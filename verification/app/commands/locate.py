"""`pinball locate`: where does it happen, to so many certified digits?

`pinball check` verifies a certificate without the search that found it.
"""

import json
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from verification.app.cli import DONE, FAILED, Output, json_option, write_whole

if TYPE_CHECKING:
    from verification.named.locate import Located


LETTERS = ("lam", "alpha", "n", "period")


@click.command(epilog="Example: pinball locate saddle-node --alpha 0.08 --digits 50")
@click.argument("name")
@click.option("--digits", type=click.IntRange(1, 20_000), default=30, show_default=True, help="Decimal digits.")
@click.option("--lam", metavar="NUMBER", help="The contraction, for alpha-tilde and alpha-hat.")
@click.option("--alpha", metavar="NUMBER", help="The shape of the egg, for the names that need one.")
@click.option("--n", metavar="INTEGER", help="Which doubling, of period 2^(n-1) to 2^n, or which interior crisis.")
@click.option("--period", metavar="INTEGER", help="Of the attractors that a window, a family or bands began with.")
@click.option("--certificate", metavar="FILE", help="Write the certificate, for `pinball check`.")
@json_option
def command(
    name: str,
    digits: int,
    lam: str | None,
    alpha: str | None,
    n: str | None,
    period: str | None,
    certificate: str | None,
    output: Output,
) -> int:
    """Where does it happen, to N certified digits? Exit status 1 when something is not proved.

    NAME is lambda-star, phi-star, lambda-c, alpha-tilde, alpha-hat, saddle-node, doubling, symmetry-breaking, or
    merging-crisis, boundary-crisis, symmetry-restoring, band-merging, interior-crisis and, with --period, window-end,
    window-merging, family-end, family-merging: tangencies of manifolds, which are proved; that the attractor changes
    there, and nowhere before, is not.
    """
    from symbolic.tables.formula import number
    from verification.named.locate import GMPY2, WORDS, locate

    given = {letter: text for letter, text in zip(LETTERS, (lam, alpha, n, period), strict=True) if text is not None}
    shape = {letter: number(text, f"--{letter}") for letter, text in given.items()}
    if "n" in shape and not shape["n"].is_Integer:
        raise ValueError(f"--n {n} is no integer; accepted: integers from 2")
    if "period" in shape and not shape["period"].is_Integer:
        raise ValueError(f"--period {period} is no integer; accepted: the period of a window, as in docs/crises.md")
    if certificate is not None:
        writable(certificate)
    with output.progress(f"Locating {name}", 1) as step:
        found = locate(name, digits, **shape)
        step(name)
    if certificate is not None:
        _write(certificate, found)
    output.write(found.to_dict())
    said = "certified" if found.certified else "not certified"
    output.console.print(f"{found.title} = {found.value} +- {found.radius}  ({said}, {found.seconds:.2f} s)")
    for item, value in found.checks.items():
        output.console.print(f"  {item.replace('_', ' '):28} {WORDS[value]}")
    notes = {**found.notes, "arithmetic": f"mpmath {'on' if GMPY2 else 'without'} gmpy2 to search, arb to prove"}
    if found.steps:
        notes["newton"] = ", ".join(f"1e{step.correction:.0f} ({step.digits} digits)" for step in found.steps)
    for item, text in notes.items():
        output.console.print(f"  {item.replace('_', ' '):28} {text}")
    return DONE if found.certified else FAILED


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


@click.command(epilog="Example: pinball locate lambda-c --certificate lambda_c.json && pinball check lambda_c.json")
@click.argument("file")
@json_option
def check_command(file: str, output: Output) -> int:
    """Does a certificate prove what it says? Exit status 1 when an item of its checklist is not proved.

    The whole checklist is worked through anew; what the file says of itself is not believed.
    """
    from verification.arithmetic.balls import decimal
    from verification.named.files import checked, read
    from verification.named.locate import WORDS

    started = time.perf_counter()
    given = read(Path(file))
    if given.get("kind") == "trapping region":
        return _region_checked(given, output)
    proof = checked(given)
    seconds = time.perf_counter() - started
    name = str(given["name"])  # held to be what the equations say
    value, radius = decimal(proof.value, proof.claim.digits + 1)
    output.write(
        {
            "name": name,
            "value": value,
            "radius": radius,
            "digits": proof.claim.digits,
            "certified": proof.certified,
            "checks": proof.checks,
            "seconds": seconds,
        }
    )
    said = "certified" if proof.certified else "not certified"
    output.console.print(f"{name} = {value} +- {radius}  ({said}, {seconds:.2f} s)")
    for item, outcome in proof.checks.items():
        output.console.print(f"  {item.replace('_', ' '):28} {WORDS[outcome]}")
    return DONE if proof.certified else FAILED


def _region_checked(given: dict[str, Any], output: Output) -> int:
    """A trapping region has no value to show: its boxes are mapped anew."""
    from verification.named.locate import WORDS
    from verification.proofs.global_dynamics.regions import checked

    started = time.perf_counter()
    name, checks = checked(given)
    seconds, certified = time.perf_counter() - started, all(checks.values())
    output.write({"name": name, "certified": certified, "checks": checks, "seconds": seconds})
    output.console.print(f"{name}  ({'certified' if certified else 'not certified'}, {seconds:.2f} s)")
    for item, outcome in checks.items():
        output.console.print(f"  {item.replace('_', ' '):28} {WORDS[outcome]}")
    return DONE if certified else FAILED

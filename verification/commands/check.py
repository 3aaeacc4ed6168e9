"""`pinball check`: verify a certificate without the search that found it."""

import time
from pathlib import Path

import click

from verification.cli import DONE, FAILED
from verification.commands.output import Output, json_option


@click.command(epilog="Example: pinball locate lambda-c --certificate lambda_c.json && pinball check lambda_c.json")
@click.argument("file")
@json_option
def command(file: str, output: Output) -> int:
    """Does a certificate prove what it says? Exit status 1 when an item of its checklist is not proved.

    The whole checklist is worked through anew; what the file says of itself is not believed.
    """
    from verification.balls import decimal
    from verification.certificates.files import checked, read
    from verification.locate import WORDS

    started = time.perf_counter()
    given = read(Path(file))
    proof = checked(given)
    seconds = time.perf_counter() - started
    name = str(given.get("name", file))
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

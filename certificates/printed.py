"""Checks that each number printed as certified has a certificate: `python certificates/printed.py [--prove] [REPORT]`.

It reads README.md, the pages of docs, the reports in docs/reports with the certificates inside them, and REPORT (by
default report/report.json, which `pinball verify` writes). A number has a certificate when one at the right place in
the list below, or of the same page, agrees with its printed digits. With `--prove` the independent checker proves those
inside of reports; `make check-all` proves the files of this folder as well. Exit status 1 where something is missing.
"""

import json
import re
import sys
import tomllib
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import check

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
REPORT = ROOT / "report" / "report.json"
SECOND = r"`([\w.-]+\.json|-\d)`"  # in the table of docs/trust.md: `doubling-3.json`, `-4`
LISTED = tomllib.loads((ROOT / "verification/paper/claims/focusing/certificates.toml").read_text(encoding="utf-8"))
CLAIMS: dict[str, list[str]] = LISTED["files"]  # of the paper's report: what says `certified`, or has such a value
WITHOUT: dict[str, str] = LISTED["without"]  # and why
ALSO: dict[str, str] = LISTED["partly"]  # parts of a sentence that have none here
FOLLOWING = ("nu_plus", "nu_minus", "multiplier of a round, out", "in")  # columns


def value(given: dict[str, Any]) -> Fraction:
    """The value of a certificate: its free unknown; for `phi-star` that of the proved line; else the last bounce."""
    if given["name"] == "phi-star":
        return Fraction(re.search(r"= (-?[\d.]+)", check.checked(given))[1])
    return check.exact(given["centre"][-1])


def holds(given: dict[str, Any], printed: str) -> bool:
    """True if the printed digits differ from the certificate's value by at most one in the last digit."""
    last = Fraction(10) ** Decimal(printed).as_tuple().exponent
    return abs(value(given) - Fraction(printed)) <= last


def committed() -> dict[str, dict[str, Any]]:
    """The certificates of this folder that prove a number."""
    found = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(HERE.glob("*.json"))}
    return {name: given for name, given in found.items() if "centre" in given}


def kept_reports() -> Iterator[tuple[str, list[dict[str, Any]], list[str]]]:
    """Each report of docs/reports: name, certificates inside it, and the numbers it calls proved or certified."""
    for path in sorted((ROOT / "docs" / "reports").glob("*.json")):
        report = json.loads(path.read_text(encoding="utf-8"))
        blocks = [b for part in report["sections"] for b in part["blocks"]]
        inside = [block["document"] | {"schema": 4} for block in blocks if block["kind"] == "certificate"]
        tables = [block for block in blocks if block["kind"] == "table"]
        cells = [
            (row[0], *pair)
            for each in tables
            for row in each["rows"]
            for pair in zip(each["columns"], row, strict=True)
        ]
        told = [cell["value"] for *where, cell in cells if isinstance(cell, dict) and is_certified(*where, cell)]
        told += [event["value"] for event in report["events"] if event["certified"]]
        yield path.stem, inside, list(dict.fromkeys(told))


def is_certified(row: Any, column: str, cell: dict[str, Any]) -> bool:
    """True if a cell of a report is a proved number with an error, of a kind that has certificates.

    A perimeter is an integral; multipliers and exponents follow from a cycle that is enclosed when the report is made.
    """
    return cell.get("known") == "proved" and bool(cell.get("error")) and row != "perimeter" and column not in FOLLOWING


def of_pages() -> Iterator[tuple[str, str]]:
    """The page and number of each line that ends in `(certified)`."""
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for match in re.finditer(r"= (-?[\d.]+) \+- \S+ +\(certified", path.read_text(encoding="utf-8")):
            yield str(path.relative_to(ROOT)), match[1]


def of_trust() -> Iterator[tuple[str, str]]:
    """The file and number of each row of docs/trust.md that has both, in order."""
    for row in (line.split("|") for line in (ROOT / "docs" / "trust.md").read_text(encoding="utf-8").splitlines()):
        if len(row) == 8 and (numbers := re.findall(r"-?0\.\d{5}", row[2])):
            names = [name.removesuffix(".json") for name in re.findall(SECOND, row[4])]
            full = [name if name[0] != "-" else names[0].rpartition("-")[0] + name for name in names]
            yield from zip(full, numbers, strict=True) if full else ()


def of_claims(path: Path) -> Iterator[tuple[str, str, str]]:
    """For each certified number of a report: claim, file and number; the file is empty where none is listed."""
    for claim in json.loads(path.read_text(encoding="utf-8"))["claims"]:
        name, said = claim["id"], " ".join(str(claim.get(key)) for key in ("method", "derived", "erratum"))
        if claim["value"] is None and "certified" not in said:
            continue
        if name not in {**CLAIMS, **WITHOUT, **ALSO}:
            yield name, "", str(claim["value"] or "a sentence that says certified")
        for file in CLAIMS.get(name, ()) if claim["value"] and "exponent" not in name else ():
            yield name, file, claim["value"].rstrip("0")


def said(given: tuple[str, dict[str, Any]]) -> str:
    """The line that the independent checker prints of a page's certificate; its exception if it proves nothing."""
    page, document = given
    return f"{page}: {check.checked(document).splitlines()[0]}\n"


def main(args: list[str]) -> int:
    """Prints one line for each number without a certificate, and the counts."""
    report = next((Path(arg) for arg in args if arg != "--prove"), REPORT)
    files, missing, proved, count = committed(), [], [], 0
    found = [(page, number, [*files.values()]) for page, number in of_pages()]
    found += [("docs/trust.md", number, [files[name]] if name in files else []) for name, number in of_trust()]
    for page, inside, told in kept_reports():
        here = [*inside, *files.values()]
        found += [(f"docs/reports/{page}.json", number, here) for number in told]
        proved += [(page, given) for given in inside] if "--prove" in args else []
    with ProcessPoolExecutor() as processes:
        for line in processes.map(said, proved):
            sys.stdout.write(line)
    for claim, file, number in of_claims(report) if report.exists() else ():
        found.append((claim, number, [files[file]] if file in files else []))
    for place, number, given in found:
        count += 1
        if not any(holds(each, number) for each in given):
            missing.append(f"{place}: no certificate holds {number}")
    missing += [f"{name}.json is missing" for each in CLAIMS.values() for name in each if name not in files]
    sys.stdout.write("".join(f"{line}\n" for line in missing) + f"{count} numbers, {len(missing)} without\n")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

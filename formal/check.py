"""Checks every proof of `formal/`, and that the theorems assume what `formal/assumptions.txt` says, and no more.

    python formal/check.py [--record]

`make formal` runs this. It installs nothing and needs no package of Python. Exit status: 0 all proofs hold; 1 a proof
fails or assumes something else; 2 Coq or a library of it is not there.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent
RECORD = HERE / "assumptions.txt"
# In an order in which each finds what it needs.
CARDIOID = ("Cardioid", "Stretch", "Cycles", "Map", "Landing", "Near", "Unstable")
NEWTON = ("Newton", "Jets", "Checked", "Boxes")
PAPER = ("Generated", "Frames", "Algebra", "Errata", "Stability", "Fold")
EGG = ("Cascade", "Triangles", "Sentences", "Equations", "Doublings")
FILES = ("Bounce", "Cone", *CARDIOID, *PAPER, *NEWTON, *EGG, "Numbers", "Slap", "Examples")
LIBRARIES = "From Coquelicot Require Import Coquelicot. From Interval Require Import Tactic."
NEEDED = "make formal needs coqc 8.16 with coquelicot and interval (Debian: coq libcoq-coquelicot libcoq-interval)"
COQC = ("coqc", "-q", "-w", "-ambiguous-paths", "-Q", ".", "Pinball")
GROUPS = {
    "reals": r"ClassicalDedekindReals\.sig_(forall|not)_dec|FunctionalExtensionality\.functional_extensionality_dep",
    "classic": r"Classical_Prop\.classic",
    "machine": r"(PrimInt63|Uint63|PrimFloat|FloatAxioms|FloatOps|Sint63|Int63|CarryType)\.\w+",
}
HEADER = """# What the theorems of each file of formal/ assume, as `Print Assumptions` lists it; `make formal` compares.
# reals: the three axioms by which Coq's standard library makes the real numbers. classic: excluded middle.
# machine: the kernel's 63-bit integers and float64 with their axioms, which the tactic `interval` computes with.
"""


def files() -> list[tuple[str, list[str]]]:
    """Every file that states theorems, with their names.

    >>> files()[0]
    ('Bounce', ['derivative_matrix'])
    """
    found = ((name, re.findall(r"^Theorem (\w+)", (HERE / f"{name}.v").read_text(), re.MULTILINE)) for name in FILES)
    return [(name, names) for name, names in found if names]


def questions() -> str:
    """A Coq file that prints, for each file, what its theorems together assume; one by one takes ten times as long."""
    lines = [f"From Pinball Require {name}." for name in FILES]
    for file, names in files():
        together = ", ".join(f"@Pinball.{file}.{name}" for name in names)
        lines += [f'Goal True. idtac "{file}:". exact I. Qed.']
        lines += [f"Definition of_{file} := ({together}, I).", f"Print Assumptions of_{file}."]
    return "\n".join([*lines, ""])


def grouped(printed: str) -> Iterator[str]:
    """A line for each file: the groups of its axioms, and in full any axiom of no group.

    >>> list(grouped("Cone:\\nAxioms:\\nClassical_Prop.classic : forall P, P\\nMine.secret : False\\n"))
    ['Cone: Mine.secret classic']
    """
    for block in re.split(rf"^(?=(?:{'|'.join(FILES)}):$)", printed, flags=re.MULTILINE):
        name, *lines = block.splitlines() or [""]
        if not name.endswith(":"):
            continue
        lines = [line for line in lines if line not in ("Axioms:", "Closed under the global context")]
        axioms = [found[1] for line in lines if (found := re.match(r"([A-Za-z_][\w.]*)(?: |$)", line))]
        yield f"{name} {' '.join(sorted({_group(axiom) for axiom in axioms})) or 'nothing'}"


def _group(axiom: str) -> str:
    return next((group for group, pattern in GROUPS.items() if re.fullmatch(pattern, axiom)), axiom)


def missing() -> bool:
    """True when coqc or one of the libraries is not there."""
    if not shutil.which("coqc"):
        return True
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "Libraries.v").write_text(LIBRARIES)
        return subprocess.run(["coqc", "-q", "Libraries.v"], cwd=folder, capture_output=True).returncode != 0


def assumptions() -> str:
    """All proofs checked in a folder of their own, and the text of `assumptions.txt`; an error of Coq is raised."""
    with tempfile.TemporaryDirectory() as folder:
        for name in FILES:
            shutil.copy(HERE / f"{name}.v", folder)
            subprocess.run([*COQC, f"{name}.v"], cwd=folder, check=True)
        (Path(folder) / "Questions.v").write_text(questions())
        asked = subprocess.run([*COQC, "Questions.v"], cwd=folder, check=True, capture_output=True, text=True)
    return HEADER + "".join(f"{line}\n" for line in grouped(asked.stdout))


def main(arguments: list[str]) -> int:
    """The exit status."""
    if missing():
        print(NEEDED, file=sys.stderr)  # noqa: T201 - the one sentence that is asked for
        return 2
    try:
        found = assumptions()
    except subprocess.CalledProcessError as error:
        print(f"formal: {error.cmd[-1]} fails", error.stderr or "", file=sys.stderr)  # noqa: T201
        return 1
    if "--record" in arguments:
        RECORD.write_text(found)
    changed = sorted(set(found.splitlines()) ^ set(RECORD.read_text().splitlines()))
    held = f"{sum(len(names) for _, names in files())} theorems hold"
    said = f"formal: assumptions differ from {RECORD.name}: {changed}" if changed else held
    print(said, file=sys.stderr if changed else sys.stdout)
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

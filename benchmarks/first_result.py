"""What a scene and a question cost before the first bounce, and what is left out: writes docs/leave_out.md.

    python benchmarks/first_result.py [RUNS]        from the start of a process to its first result, and to its end:
                                                    warm, and with an empty cache
    python benchmarks/first_result.py page [RUNS]   the table of docs/leave_out.md

Each line of the table is a fresh process. Operation counts come from the generated text, modules from
`sys.modules`, memory from `VmHWM` of Linux (getrusage would count the parent's), times are the shortest of some runs.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, fields
from numeric.kernels.text import kernel_text, operations
from verification.measure.extremes.orbits import SCENES
from verification.measure.work.bench import LAWS

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "leave_out.md"
TABLES = SCENES | {"stadium": {}}  # and one that is not the paper's, by its name
ORBITS = {
    name: f"PinballMap({name!r}, lam=0.95" + "".join(f", {key}={value!r}" for key, value in shape.items()) + ")"
    for name, shape in TABLES.items()
}
QUESTIONS = {"end": {}, "orbit": {"record": True}, "exponents": {"exponents": True}}
EVERYTHING = KernelSpec(
    "pinball", record=True, exponents=True
)  # what a kernel made for no scene in particular would do
PROBE = """
import json, pathlib, sys, time
import numpy
began = time.process_time()
from numeric import PinballMap
from numeric.pinball.sampling import Growth
map = PinballMap({name!r}, lam={lam!r}{shape})
{asked}
tops = sorted({{module.partition(".")[0] for module in sys.modules}} - set(sys.stdlib_module_names))
own = sorted(module for module in sys.modules if module.startswith("numeric."))
status = pathlib.Path("/proc/self/status")
peak = int(status.read_text().split("VmHWM:")[1].split()[0]) if status.exists() else 0
print(json.dumps({{"tops": tops, "own": own, "peak": peak, "spent": time.process_time() - began}}))
"""
ASKED = {
    "end": "growth = Growth(map, 0.3, 0.0); growth.skip(10)",
    "orbit": "map.orbit(0.3, 0.0, 10)",
    "exponents": "map.exponents(0.3, 0.0, 10)",
}
PRIVATE = ("_", "cython_runtime", "sitecustomize", "usercustomize")
WORDS = """# What a scene does not need

Each line is a fresh process that asks one question of one scene, with the kernel in the cache. *Operations* are the
vector instructions of one bounce, compares and selects included, and *share* is what is left of the kernel that
does everything for that table: general `lam`, a tangent vector and a record. *State* is the doubles kept for a
particle. A component index is part of the state of the cuspless table and of the stadium; the others have one component
and no index. *Modules* are those of `numeric` and the packages beside it (of llvmlite only its version is read).
*Memory* is the peak of the resident set above that of a process that only imports NumPy, and *time* the processor's
from NumPy's import to the answer, the shortest of three runs on a busy machine.

The stadium stands for the tables of `tables.GALLERY`: asked for by name, `PinballMap("stadium", straight=2)`, what its
kernel is made from is kept like that of the paper's tables. `tables.stadium()` is the exact table, and needs SymPy.

`python benchmarks/first_result.py page` writes this page; `tests/verification/measure/test_leave_out_page.py` holds
operations, state and modules to their line. The split by kind of instruction is in [kernels.md](kernels.md).
"""
COLD = """
## Before and after the cache

Before anything is on disk the same process compiles the kernel, of what SymPy made of the table: for those with a name
that comes with the package (`numeric/lowering/shipped.py`), for others it is derived once. Here the question is the
exponents at `lam` = 19/20; *before* is with an empty cache and *after* with what it left there.
"""


def environment(folder):
    """Without what keeps Python from caching its modules, and with a kernel cache of its own."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PINBALL_CACHE": folder, "PYTHONPATH": str(ROOT)}


def milliseconds(program, runs, folder, before=lambda: None):
    """From the start of a process to the line that it prints, and to its end: medians over some runs."""
    times = []
    for _ in range(runs + 1):
        before()
        start = time.perf_counter()
        with subprocess.Popen([sys.executable, "-c", program], env=environment(folder), stdout=subprocess.PIPE) as made:
            assert made.stdout is not None
            assert made.stdout.readline()
            answered = time.perf_counter() - start
            assert made.wait() == 0
        times.append((1e3 * answered, 1e3 * (time.perf_counter() - start)))
    return [statistics.median(column) for column in zip(*times[1:], strict=True)]


def program(name, law, asked):
    """The text of a process that asks one question of one scene."""
    shape = "".join(f", {key}={value!r}" for key, value in TABLES[name].items())
    return PROBE.format(name=name, lam=LAWS[law], shape=shape, asked=ASKED[asked])


def probe(text, folder, runs=1, warm=True):
    """What a process imported, its peak memory in kB and its shortest time in seconds; a first one fills the cache."""
    said = []
    for _ in range(runs + warm):
        done = subprocess.run(
            [sys.executable, "-c", text], env=environment(folder), capture_output=True, text=True, check=True
        )
        said.append(json.loads(done.stdout))
    last = said[-1]
    last["tops"] = [name for name in last["tops"] if not name.startswith(PRIVATE)]
    return last | {"spent": min(one["spent"] for one in said[warm:])}


def counted(name, law, asked):
    """Operations, the share of the kernel that does everything, and the doubles of a particle's state."""
    map = PinballMap(name, lam=LAWS[law], **TABLES[name])
    question = KernelSpec(law, **QUESTIONS[asked])
    own, whole = (
        sum(operations(kernel_text(map.family, map.engine.names, one)).values()) for one in (question, EVERYTHING)
    )
    return own, own / whole, len(fields(map.family, question))


def line(name, law, asked, said):
    """The part of a line that a test can hold: all but memory and time."""
    own, share, state = counted(name, law, asked)
    modules = f"{len(said['own'])}: {', '.join(top for top in said['tops'] if top != 'numeric') or 'none'}"
    return f"| {name} | {law} | {asked} | {own} | {share:.0%} | {state} | {modules} |"


def cost(said, alone):
    """Memory above that of a process that only imports NumPy, and time after that import."""
    return f"{(said['peak'] - alone['peak']) / 1024:.1f} | {1e3 * said['spent']:.0f}"


def page(runs):
    """The text of docs/leave_out.md."""
    head = "| scene | law | question | operations | share | state | modules: own, others | memory, MB | time, ms |"
    lines, colds = [WORDS, head, "|---" * 9 + "|"], [COLD, "| scene | modules before | after | memory, MB, before |"
             " time, ms, before | memory, MB, after | time, ms, after |", "|---" * 7 + "|"]  # fmt: skip
    end = PROBE[PROBE.index("status =") :].replace("{{", "{").replace("}}", "}")
    bare = "import json, pathlib, sys, time\nimport numpy\nbegan = time.process_time()\ntops = own = []\n" + end
    with tempfile.TemporaryDirectory() as folder:
        alone = probe(bare, folder, runs)
        for name in TABLES:
            for law in LAWS:
                for asked in QUESTIONS:
                    said = probe(program(name, law, asked), folder, runs)
                    lines.append(f"{line(name, law, asked, said)} {cost(said, alone)} |")
                    sys.stderr.write(lines[-1] + "\n")
            with tempfile.TemporaryDirectory() as empty:
                text = program(name, "pinball", "exponents")
                before, after = probe(text, empty, 1, warm=False), probe(text, empty, runs)
                tops = [
                    f"{len(one['own'])}: {', '.join(x for x in one['tops'] if x != 'numeric')}"
                    for one in (before, after)
                ]
                colds.append(f"| {name} | {tops[0]} | {tops[1]} | {cost(before, alone)} | {cost(after, alone)} |")
    return "\n".join([*lines, *colds]) + "\n"


def main(runs):
    """The times of the paper's tables, and of the stadium."""
    with tempfile.TemporaryDirectory() as folder:

        def forget():
            for path in Path(folder).iterdir():
                path.unlink()

        sys.stdout.write(f"{'milliseconds':<14}{'first result':>14}{'to the end':>12}{'cold':>9}{'to the end':>12}\n")
        for name, text in (("interpreter", "print(0)"), ("import numpy", "import numpy; print(0)")):
            sys.stdout.write("{:<14}{:>14.0f}{:>12.0f}\n".format(name, *milliseconds(text, runs, folder)))
        for name, map in ORBITS.items():
            text = f"from numeric import PinballMap; print({map}.orbit(0.3, 0.2, 10).theta[-1])"
            warm, cold = milliseconds(text, runs, folder), milliseconds(text, max(runs // 3, 3), folder, forget)
            sys.stdout.write("{:<14}{:>14.0f}{:>12.0f}{:>9.0f}{:>12.0f}\n".format(name, *warm, *cold))
        sys.stdout.write("Cold: the kernel is compiled; what SymPy makes of these tables comes with the package.\n")


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[:1] == ["page"]:
        PAGE.write_text(page(int(words[1]) if len(words) > 1 else 5))
    else:
        main(int(words[0]) if words else 25)

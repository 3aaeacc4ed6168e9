"""Measures the cost of a scene and a question before the first bounce, and writes docs/leave_out.md.

    python benchmarks/first_result.py [RUNS]

Each line of the table is a fresh process. Operation counts come from the generated text, modules from `sys.modules`,
memory from `VmHWM` of Linux (getrusage would count the parent's), times are the shortest of some runs.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, fields
from numeric.kernels.text import kernel_text, operations
from verification.measure.extremes.orbits import SCENES
from verification.measure.work.bench import LAWS

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "leave_out.md"
TABLES = SCENES | {"stadium": {}}  # and one that is not the paper's, by its name
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

A kernel computes only what the requested result needs. Each row is a fresh process that computes one kind of result
(*question*) for one scene, with the kernel in the cache:

- *operations*: vector instructions of one bounce, compares and selects included; *share*: operations as a percentage of
  those of the full kernel for that table, with a general contraction, a tangent vector and a record;
- *state*: doubles kept for a particle; for the cuspless table and the stadium one of them is a component index;
- *modules*: the number of modules of `numeric`, and the other packages imported (of llvmlite only its version is read);
- *memory*: the peak of the resident set above that of a process that only imports NumPy; *time*: processor time
  from NumPy's import to the result.

The stadium is an example for the tables of `tables.GALLERY`. By name, as in `PinballMap("stadium", straight=2)`, it
needs no SymPy; the exact table `tables.stadium()` needs SymPy.

`python benchmarks/first_result.py` writes this page; `tests/verification/measure/test_leave_out_page.py` compares
operations, state and modules with it. [Kernels](kernels.md) has the number of operations of each kind.
"""
COLD = r"""
## With an empty cache and with a full one

With an empty cache the process compiles the kernel first. For named tables the package contains the formulas that SymPy
derives (`numeric/lowering/shipped.py`); for others they are derived once. The table is for exponents at
$\lambda = 19/20$; *before* is with an empty cache and *after* with the cache that the first process filled.
"""


def environment(folder):
    """The environment without settings that keep Python from caching modules, and with its own kernel cache."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PINBALL_CACHE": folder, "PYTHONPATH": str(ROOT)}


def program(name, law, asked):
    """The text of a program that asks one question about one scene."""
    shape = "".join(f", {key}={value!r}" for key, value in TABLES[name].items())
    return PROBE.format(name=name, lam=LAWS[law], shape=shape, asked=ASKED[asked])


def probe(text, folder, runs=1, warm=True):
    """The modules that a process imported, its peak memory in kB and its shortest time, with filled caches."""
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
    """The number of operations, relative to the kernel with everything, and the doubles of a particle's state."""
    map = PinballMap(name, lam=LAWS[law], **TABLES[name])
    question = KernelSpec(law, **QUESTIONS[asked])
    own, whole = (
        sum(operations(kernel_text(map.family, map.engine.names, one)).values()) for one in (question, EVERYTHING)
    )
    return own, own / whole, len(fields(map.family, question))


def line(name, law, asked, said):
    """The part of a line that a test can compare: all but memory and time."""
    own, share, state = counted(name, law, asked)
    modules = f"{len(said['own'])}: {', '.join(top for top in said['tops'] if top != 'numeric') or 'none'}"
    return f"| {name} | {law} | {asked} | {own} | {share:.0%} | {state} | {modules} |"


def cost(said, alone):
    """The memory above that of a process that only imports NumPy, and the time after that import."""
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


if __name__ == "__main__":
    PAGE.write_text(page(int(sys.argv[1]) if len(sys.argv) > 1 else 5))

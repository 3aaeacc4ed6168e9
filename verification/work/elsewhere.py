"""mpmath without gmpy2, timed in a process of its own: the choice is made when mpmath is imported.

`python -m verification.work.elsewhere QUESTION METHOD RUNS SETTING...` prints what a method found and took, as JSON.
"""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

from verification.work.question import Answer

PLAIN = {"MPMATH_NOGMPY": "1", "SYMPY_GROUND_TYPES": "python"}
MORE = 10  # digits written beyond those that were asked for
Sample = tuple[Answer | None, list[float], str]


def available() -> bool:
    """Is gmpy2 there, so that to do without it is something else?"""
    return find_spec("gmpy2") is not None


def sampled(question: str, method: str, settings: Sequence[int], runs: int) -> list[Sample]:
    """What `measure.sample` gives for each setting, from a process in which mpmath has Python's integers."""
    command = [sys.executable, "-m", "verification.work.elsewhere", question, method, str(runs), *map(str, settings)]
    folders = os.pathsep.join(path for path in sys.path if path)
    environment = {**os.environ, **PLAIN, "PYTHONPATH": folders}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        return [(None, [0.0], f"the process without gmpy2 ended: {reason}")] * len(settings)
    return [(row["answer"], row["seconds"], row["failure"]) for row in json.loads(done.stdout)]


def main(arguments: Sequence[str]) -> None:
    """Answers on standard output."""
    import mpmath

    from verification.work.catalogue import question
    from verification.work.measure import sample

    name, method, runs, *settings = arguments
    if mpmath.libmp.BACKEND != "python":
        raise SystemExit("mpmath has gmpy2 here, which it should not")
    (chosen,) = (m for m in question(name).methods if m.name == method)
    rows: list[dict[str, Any]] = []
    for i, setting in enumerate(map(int, settings)):
        answer, seconds, failure = sample(chosen, setting, int(runs), warm=i > 0)
        texts = None if answer is None else [mpmath.nstr(x, setting + MORE) for x in answer]
        rows.append({"answer": texts, "seconds": seconds, "failure": failure})
    sys.stdout.write(json.dumps(rows))


if __name__ == "__main__":
    main(sys.argv[1:])

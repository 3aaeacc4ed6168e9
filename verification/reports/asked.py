"""What a report is asked for, how its commands are written, and the parts of it that are kept on disk.

Each step of the work leaves one file, with a digest of the question in it: a report that was stopped goes on from
there, and the files of another question are not taken for its own.
"""

import json
import shlex
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.lowering.cache import sources
from numeric.sweeps.sweep import versions
from symbolic.tables.definition import exact, value_text
from symbolic.tables.scene import Scene

Arrays = Mapping[str, NDArray[Any]]
FILE = "scene.toml"  # among the parts: the scene as a file that `--scene` reads
DRAWN = "--plot FILE.svg"  # of the command beneath a picture
CONTRACTIONS = ("1/10", "1/2", "9/10")


@dataclass(frozen=True)
class Asked:
    """The question: a scene, the interval of the parameter that varies, and what is looked at on the way.

    `low` and `high` are exact numbers as text, `at` the contractions of portraits and censuses, `period` the longest
    cycle that is searched for, `digits` those of a certificate. `second` is a parameter of the table or of the law that
    varies beside the contraction, with its ends; the rest of the report is then at the scene's own value of it.
    """

    scene: Scene
    parameter: str = "lam"
    low: str = "0"
    high: str = "1"
    at: tuple[str, ...] = CONTRACTIONS
    period: int = 3
    digits: int = 20
    seed: int = 1
    second: tuple[str, str, str] | None = None

    def __post_init__(self) -> None:
        low, high = (exact(self.parameter, end) for end in (self.low, self.high))
        if not low < high or (self.parameter == "lam" and not 0 <= low < high <= 1):
            within = " of contractions, both between 0 and 1" if self.parameter == "lam" else ""
            raise ValueError(f"report: {self.parameter} from {self.low} to {self.high} is no interval{within}")
        for text in self.at:
            if not 0 <= exact("--at", text) <= 1:
                raise ValueError(f"report: --at {text} is no contraction; accepted: numbers in [0, 1]")
        if self.parameter != "lam" and len(self.at) != 1:
            raise ValueError(f"report: {self.parameter} varies at one contraction, and --at has {len(self.at)}")
        if not 2 <= self.period <= 12:
            raise ValueError(f"report: period {self.period} is out of range; accepted: 2 to 12")

    @cached_property
    def digest(self) -> str:
        """Of the question, the program and the versions: what the bits of the answers depend on."""
        program = sources("symbolic", "numeric", "verification")
        said = {**asdict(self), "scene": self.scene.text, "versions": versions(), "program": program}
        return sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def ends(self) -> tuple[float, float]:
        """The interval in float64."""
        return float(exact(self.parameter, self.low)), float(exact(self.parameter, self.high))

    @property
    def title(self) -> str:
        """The table in a few words: its name, or the radius."""
        said = self.scene.document
        return f"r = {said['polar']}" if "polar" in said and "name" not in said else self.scene.name

    @property
    def both(self) -> str:
        """The options of a report in two parameters that name the second one."""
        return "" if self.second is None else "--vary {}={}:{}".format(*self.second)

    @property
    def own(self) -> float:
        """The scene's own value of the second parameter."""
        assert self.second is not None
        name = self.second[0]
        return float(exact(name, value_text(self.scene.document["shape"][name])))

    @property
    def varied(self) -> str:
        """What varies, as options of a command that follows."""
        if self.parameter == "lam":
            return f"--lam {self.low}:{self.high}"
        return f"--lam {self.at[0]} --shape {self.parameter}={self.low}:{self.high}"

    def command(self, name: str, *options: str, lam: str | None = None) -> str:
        """A command line that asks the scene, at `lam` if it is given.

        >>> Asked(Scene("egg", alpha="2/25")).command("attractor", "--seed 1", lam="1/2")
        'pinball attractor egg --alpha 2/25 --lam 1/2 --seed 1'
        """
        at = [] if lam is None else ["--lam", lam]
        return " ".join(["pinball", name, *(shlex.quote(word) for word in (*self._words, *at)), *options])

    @property
    def _words(self) -> list[str]:
        said = self.scene.document
        shape = said.get("shape", {})
        law = ["--law", said["law"]] if "law" in said else []
        given = [word for key, value in shape.items() for word in ("--shape", f"{key}={value}")]
        if "table" in said:
            own = [word for key in self.scene.shape for word in (f"--{key}", shape[key])]
            law += [
                w for key, value in shape.items() if key not in self.scene.shape for w in ("--shape", f"{key}={value}")
            ]
            return [said["table"], *(["--K", str(said["K"])] if "K" in said else []), *own, *law]
        if "polar" in said and not {"undefined", "origin"} & set(said):
            return ["--polar", said["polar"], *given, *law]
        return ["--scene", FILE]

    def scene_file(self) -> str:
        """The text of the scene's file."""
        return self.scene.text + "\n"


class Parts:
    """The folder of a report's parts: a document for each step, arrays and pictures.

    `scheduler` is the address of a Dask cluster whose workers do the grids; left out, this machine does them.
    """

    def __init__(self, folder: Path, digest: str, scheduler: str | None = None) -> None:
        self.folder, self.digest, self.scheduler = folder, digest, scheduler

    def made(self, asked: Asked) -> None:
        """Makes the folder, with the scene as a file in it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self.text(FILE, asked.scene_file())

    def read(self, name: str) -> dict[str, Any] | None:
        """The document of a step, if it is there and answers the same question."""
        try:
            found = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found if isinstance(found, dict) and found.get("digest") == self.digest else None

    def write(self, name: str, document: Mapping[str, Any]) -> None:
        """Keeps the document of a step; a reader finds all of it or nothing."""
        self.text(f"{name}.json", json.dumps({"digest": self.digest, **document}, allow_nan=False))

    def text(self, name: str, text: str) -> None:
        """Writes a file at once."""
        path = self.folder / name
        temporary = path.with_name(f".{name}")
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(path)

    def keep(self, name: str, arrays: Arrays) -> None:
        """Keeps arrays."""
        temporary = self.folder / f".{name}.npz"
        named: dict[str, Any] = dict(arrays)
        np.savez_compressed(temporary, **named)
        temporary.replace(self.folder / f"{name}.npz")

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """The arrays that were kept under a name."""
        with np.load(self.folder / f"{name}.npz") as found:
            return dict(found)

    def picture(self, name: str) -> Path:
        """Where a picture lies."""
        return self.folder / f"{name}.svg"

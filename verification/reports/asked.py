"""The settings of a report, its command lines, and its intermediate results, which are kept on disk.

Each step of the work writes one file that contains a digest of the settings. A report that was stopped can be resumed
from these files; files with other settings are ignored.
"""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.lowering.cache import sources
from numeric.lowering.files import PARTIAL, json_text, replacing, write_whole
from numeric.sweeps.sweep import versions
from symbolic.tables.definition import exact, value_text
from symbolic.tables.scene import Scene

Arrays = Mapping[str, NDArray[Any]]
FILE = "scene.toml"  # among the parts: the scene as a file that `--scene` reads
DRAWN = "--plot FILE.svg"  # option of the command beneath a picture
LONG = re.compile(r"-?\d+\.\d{6,}")  # a number with enough digits to be told from others
CONTRACTIONS = ("1/10", "1/2", "9/10")


@dataclass(frozen=True)
class Asked:
    """The settings of a report: a scene, the interval of the parameter that varies, and what is examined on it.

    `low` and `high` are exact numbers as text, `at` the contractions for which portraits are drawn and attractors are
    counted, `period` the longest period that is searched for, `digits` the number of digits in a certificate. `second`
    is a parameter of the table or of the law that varies beside the contraction, with its ends; the other sections are
    then at the scene's own value of it.
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
        """A digest of the settings, the program and the package versions, which together determine all results."""
        program = sources("symbolic", "numeric", "verification")
        said = {**asdict(self), "scene": self.scene.text, "versions": versions(), "program": program}
        return sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def ends(self) -> tuple[float, float]:
        """The ends of the interval in float64."""
        return float(exact(self.parameter, self.low)), float(exact(self.parameter, self.high))

    @property
    def title(self) -> str:
        """The table in a few words: its name, or its formula for the radius."""
        said = self.scene.document
        return f"r = {said['polar']}" if "polar" in said and "name" not in said else self.scene.name

    @property
    def both(self) -> str:
        """The option `--vary` for a second parameter; empty if there is none."""
        return "" if self.second is None else "--vary {}={}:{}".format(*self.second)

    @property
    def own(self) -> float:
        """The scene's own value of the second parameter."""
        assert self.second is not None
        name = self.second[0]
        return float(exact(name, value_text(self.scene.document["shape"][name])))

    @property
    def own_value(self) -> float:
        """The scene's own value of the parameter that varies; if it lies outside the interval, the nearer end."""
        low, high = self.ends
        own = (
            self.scene.lam
            if self.parameter == "lam"
            else exact(self.parameter, value_text(self.scene.document["shape"][self.parameter]))
        )
        return float(min(max(float(own), low), high))

    @property
    def varied(self) -> str:
        """The parameter that varies and its interval, as options for `pinball follow`."""
        if self.parameter == "lam":
            return f"--lam {self.low}:{self.high}"
        return f"--lam {self.at[0]} --shape {self.parameter}={self.low}:{self.high}"

    def command(self, name: str, *options: str, lam: str | None = None) -> str:
        """A `pinball` command line for the scene, at `lam` if it is given.

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
        """The scene as the text of a scene file."""
        return self.scene.text + "\n"


class Parts:
    """The folder of a report's intermediate results: a document for each step, arrays and pictures.

    A document has a checksum of itself and of its step's files, and the digest of the settings; a step is computed
    again if its files were altered. Certificates from an earlier run are proved again before they are shown.
    `scheduler` is the address of a Dask cluster whose workers compute the grids; without it, this machine does.
    """

    def __init__(self, folder: Path, digest: str, scheduler: str | None = None) -> None:
        self.folder, self.digest, self.scheduler = folder, digest, scheduler
        self.believed: dict[str, dict[str, Any]] = {}  # documents of this run, and those that were checked in it
        self.files: dict[str, str] = {}  # names and checksums of files since the last document
        self.drawn: set[str] = set()  # names of pictures of this run
        self.memory: dict[str, Any] = {}  # further results of this run

    def made(self, asked: Asked) -> None:
        """Creates the folder, with the scene as a file in it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for left in self.folder.glob(f".*{PARTIAL}"):  # of a report that was killed
            left.unlink(missing_ok=True)
        write_whole(self.folder / FILE, asked.scene_file())

    def read(self, name: str) -> dict[str, Any] | None:
        """The document of a step; None if it is missing, was altered, or has other settings."""
        if name not in self.believed:
            try:
                found = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
            except (OSError, ValueError):
                return None
            if not isinstance(found, dict) or found.get("digest") != self.digest or not self._unaltered(name, found):
                return None
            self.believed[name] = found
        return self.believed[name]

    def write(self, name: str, document: Mapping[str, Any]) -> None:
        """Writes the document of a step, with checksums of the files that the step has written."""
        whole = json.loads(json_text({"digest": self.digest, "files": self.files, **document}))
        write_whole(self.folder / f"{name}.json", json_text({**whole, "checksum": self._checksum(name, whole)}))
        self.believed[name], self.files = whole, {}

    def keep(self, name: str, arrays: Arrays) -> None:
        """Writes arrays to the file `name.npz`."""
        named: dict[str, Any] = dict(arrays)
        with replacing(self.folder / f"{name}.npz") as file:
            np.savez_compressed(file, **named)
        self.noted(f"{name}.npz")

    def noted(self, file: str) -> None:
        """Records that a file belongs to the step whose document is written next."""
        self.files[file] = sha256((self.folder / file).read_bytes()).hexdigest()

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """The arrays in the file `name.npz`, by name."""
        with np.load(self.folder / f"{name}.npz") as found:
            return dict(found)

    def picture(self, name: str) -> Path:
        """The path of a picture's SVG file."""
        return self.folder / f"{name}.svg"

    def _checksum(self, name: str, document: Mapping[str, Any]) -> str:
        text = json.dumps({key: value for key, value in document.items() if key != "checksum"}, sort_keys=True)
        return sha256(f"{self.digest} {name} {text}".encode()).hexdigest()

    def _unaltered(self, name: str, document: Mapping[str, Any]) -> bool:
        """True if a document of an earlier run and its files are unchanged, and its certificates are proved again."""
        if document.get("checksum") != self._checksum(name, document):
            return False
        try:
            files = [sha256((self.folder / file).read_bytes()).hexdigest() for file in document["files"]]
        except OSError:
            return False
        blocks = [block["document"] for block in document["blocks"] if block["kind"] == "certificate"]
        blocks += [document["data"]["certificate"]] if "certificate" in document["data"] else []
        return files == list(document["files"].values()) and all(self._holds(given, document) for given in blocks)

    @staticmethod
    def _holds(given: Mapping[str, Any], document: Mapping[str, Any]) -> bool:
        """True if a certificate is proved anew, and the value that it proves is among the numbers of its step."""
        from verification.named.theorems import checked

        try:
            proof = checked(given)
        except (ValueError, ArithmeticError):
            return False
        shown = {**document, "blocks": [block for block in document["blocks"] if block["kind"] != "certificate"]}
        value = Fraction(proof.result["value"])  # which may have more digits than are shown
        return proof.proved and any(
            round(value, len(text.partition(".")[2])) == Fraction(text) for text in LONG.findall(json.dumps(shown))
        )

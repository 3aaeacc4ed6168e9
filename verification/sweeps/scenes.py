"""A scene as a line of text, which labels results and travels to other machines; its map, and random balls in it."""

import json
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.sampling import Starts, interior_starts
from verification.commands.mapped import pinball_map
from verification.commands.scene import Scene

KEPT = 16  # maps
Array = NDArray[np.float64]


def text_of(scene: Scene) -> str:
    """The scene without its contraction, as JSON with sorted keys.

    >>> text_of(Scene("egg", {"alpha": "2/25"}))
    '{"K": 3, "formula": [], "shape": {"alpha": "2/25"}, "table": "egg"}'
    """
    parts = {"table": scene.table_name, "shape": dict(scene.shape), "formula": list(scene.formula), "K": scene.K}
    return json.dumps(parts, sort_keys=True)


def map_of(text: str, lam: Any) -> PinballMap:
    """The map of a scene written by `text_of`, with a contraction, or one for each ball.

    >>> map_of('{"K": 3, "formula": [], "shape": {"a": "2"}, "table": "ellipse"}', 0.5).law
    'pinball'
    """
    return _elastic(text).at(lam)


def spread(text: str, lams: Array, each: int, seed: int) -> tuple[PinballMap, Starts]:
    """Balls of one scene at several contractions: `each` random starts for each `lam`, one `lam` after the other.

    >>> map, starts = spread(text_of(Scene("circle")), np.array([0.0, 0.5]), 3, seed=1)
    >>> map.lam.tolist(), starts.theta.size
    ([0.0, 0.0, 0.0, 0.5, 0.5, 0.5], 6)
    """
    return map_of(text, np.repeat(lams, each)), interior_starts(_elastic(text), len(lams) * each, seed)


@lru_cache(KEPT)
def _elastic(text: str) -> PinballMap:
    parts = json.loads(text)
    scene = Scene(parts["table"], parts["shape"], tuple(parts["formula"]), "1", parts["K"])
    return pinball_map(scene)

"""A scene as a line of text, which labels results and travels to other machines; its map, and random balls in it."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.sampling import Starts, interior_starts
from symbolic.scene import Scene
from verification.commands.mapped import pinball_map

KEPT = 16  # maps
Array = NDArray[np.float64]


def text_of(scene: Scene) -> str:
    """The scene as a sweep labels it: at `lam = 1`, since the contraction is an axis of the sweep.

    >>> text_of(Scene("egg", alpha="2/25", lam="1/2"))
    'scene = { table = "egg", shape = { alpha = "2/25" }, lam = "1" }'
    """
    return scene.at(lam=1).text


def map_of(text: str, lam: Any) -> PinballMap:
    """The map of a scene written by `text_of`, with a contraction, or one for each ball.

    >>> map_of(text_of(Scene("ellipse", a=2)), 0.5).law
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
    return pinball_map(Scene.parse(text))

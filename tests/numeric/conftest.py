"""Scenes that the tests share, and a cache folder of the tests' own."""

import os
import tempfile
from types import SimpleNamespace

import numpy as np
import pytest

os.environ["PINBALL_CACHE"] = tempfile.mkdtemp(prefix="pinball-cache-")

from numeric import PinballMap

SHAPES = {
    "circle": {},
    "ellipse": {"a": "3/2"},
    "cardioid": {},
    "cuspless": {},
    "egg": {"alpha": "0.08"},
}


def starts(map, count, seed, steepest=1.0):
    """Random balls: component, theta and phi; `sin(phi)` is uniform below `sin` of the steepest angle."""
    rng = np.random.default_rng(seed)
    component = rng.integers(0, len(map.states.ends), count)
    ends = np.array(map.states.ends)[component]
    theta = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * rng.uniform(0.001, 0.999, count)
    return component, theta, np.arcsin(rng.uniform(-steepest, steepest, count) * 0.9999)


@pytest.fixture(params=list(SHAPES))
def table(request):
    """Each table of the paper: its name, its shape, a map at some `lam`, and random balls."""
    name, shape = request.param, SHAPES[request.param]
    return SimpleNamespace(
        name=name,
        shape=shape,
        map=lambda lam, **more: PinballMap(name, lam=lam, **shape, **more),
        starts=starts,
    )

"""A small sweep for a figure: on all cores, as plain arrays, with neither xarray nor Zarr."""

from verification.sweeps.cost import cores
from verification.sweeps.pools import on_threads
from verification.sweeps.store import Memory
from verification.sweeps.sweep import Array, Sweep


def swept(sweep: Sweep) -> dict[str, Array]:
    """The fields of a sweep by name.

    >>> from verification.sweeps.parameter_space import parameter_space
    >>> import numpy as np
    >>> int(swept(parameter_space(np.array([0.0]), np.array([0.5]), 3, 40, 40))["chaotic"][0, 0])
    0
    """
    results = Memory(sweep)
    for index, arrays in on_threads(sweep, results.missing(), cores()):
        results.write(index, arrays)
    return results.arrays

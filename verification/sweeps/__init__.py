"""Sweeps: grids of independent tasks, on the cores of one machine or on a Dask cluster, chunk by chunk into Zarr.

A sweep says what its dimensions are and has one task, a function of a part of the grid and of that part's own seed.
So results are the same bits in whatever order, on however many threads or machines the parts are done, and a sweep
that was killed goes on where it stopped.
"""

from verification.sweeps.cost import Cost, cost
from verification.sweeps.pools import UnfinishedError
from verification.sweeps.run import run
from verification.sweeps.sweep import Axis, Field, Part, Sweep

__all__ = ["Axis", "Cost", "Field", "Part", "Sweep", "UnfinishedError", "cost", "run"]

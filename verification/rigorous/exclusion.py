"""A search that proves that a region holds no solution: boxes cover it, each is tested, and undecided ones are halved.

The boxes are arrays of some thousand at a time. If the midpoint of a half box is rounded, the half box is widened by
the rounding error, so that neighbouring boxes leave no gap. Midpoints and widths of few binary digits are halved
exactly.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from verification.arithmetic.arrays import Array, Mask
from verification.arithmetic.balls import Box, bisected
from verification.arithmetic.iteration import Tick, silent

CHUNK = 4096  # boxes in one call of the test


@dataclass(frozen=True)
class Cuboids:
    """Boxes in `n` dimensions, as rows of midpoints and of half widths: two arrays of shape `(boxes, n)`."""

    middle: Array
    half: Array

    def __getitem__(self, rows: Any) -> "Cuboids":
        return Cuboids(self.middle[rows], self.half[rows])

    @property
    def size(self) -> int:
        """The number of boxes."""
        return len(self.middle)

    def halves(self) -> "Cuboids":
        """Each box cut in two across its longest side; the two halves cover it.

        >>> Cuboids(np.array([[0.0, 3.0]]), np.array([[1.0, 2.0]])).halves().middle.tolist()
        [[0.0, 2.0], [0.0, 4.0]]
        """
        cut = np.arange(self.half.shape[1]) == np.argmax(self.half, axis=1)[:, None]
        half = np.where(cut, self.half / 2, self.half)
        step, parts = np.where(cut, half, 0.0), []
        for aside in (-step, step):
            middle = self.middle + aside
            moved = middle - self.middle
            off = np.abs((self.middle - (middle - moved)) + (aside - moved))  # the exact rounding error of the middle
            off = off + np.where(cut, np.abs(self.half - 2 * half), 0.0)  # that of the half, which may underflow
            parts.append(Cuboids(middle, np.where(off == 0, half, np.nextafter(half + off, np.inf))))
        return Cuboids(*(np.concatenate([getattr(one, name) for one in parts]) for name in ("middle", "half")))


class Search(NamedTuple):
    """Outcome of a search: `proved` is True if every box of a cover passed the test, None if the search is undecided.

    `boxes` is the number of boxes tested, and `share` the part of the region that passed, where it is counted.
    """

    proved: bool | None
    boxes: int
    share: float = 0.0


def exclude(
    start: Cuboids,
    nothing_in: Callable[[Cuboids], Mask],
    budget: int,
    smallest: float,
    tick: Callable[[int], None] = lambda boxes: None,
) -> Search:
    """A search for a proof that the region covered by `start` holds nothing.

    `nothing_in` returns a mask of the boxes that are proved to hold nothing; the other boxes are halved. The search
    ends undecided after `budget` boxes, or at an undecided box with all sides below `smallest`. `tick` is called with
    the number of boxes tested so far. `ValueError` if a box is not finite, and if there are no boxes, since an empty
    cover is more likely a mistake than a region.

    >>> line = Cuboids(np.array([[0.0]]), np.array([[1.0]]))
    >>> exclude(line, lambda boxes: np.abs(boxes.middle[:, 0] - 2) > boxes.half[:, 0], 100, 1e-3).proved
    True
    >>> exclude(line, lambda boxes: np.abs(boxes.middle[:, 0] - 1 / 3) > boxes.half[:, 0], 100, 1e-3).proved is None
    True
    """
    if not start.size:
        raise ValueError("exclude: no boxes to search; give a cover with at least one")
    with np.errstate(over="ignore"):
        ends = np.abs(start.middle) + start.half
    if not np.all((start.half >= 0) & np.isfinite(ends)):
        raise ValueError(
            "exclude: a middle is not finite, or a half width is negative or not finite; accepted: bounded boxes"
        )
    queue, tested = start, 0
    while queue.size:
        chunk, queue = queue[-CHUNK:], queue[:-CHUNK]
        tested += chunk.size
        tick(tested)
        if tested > budget:
            return Search(None, tested)
        left = chunk[~nothing_in(chunk)]
        if np.any(np.max(left.half, axis=1, initial=0.0) < smallest):
            return Search(None, tested)
        halves = left.halves()
        queue = Cuboids(*(np.concatenate(pair) for pair in ((queue.middle, halves.middle), (queue.half, halves.half))))
    return Search(True, tested)


def bisect(
    start: Box,
    holds: Callable[[Box], bool],
    budget: int,
    smallest: float = 0.0,
    tick: Tick = silent,
    halves: Callable[[Box], list[Box]] = bisected,
) -> Search:
    """A search like `exclude`, box by box, for tests in balls of any precision.

    A box for which `holds` is False is cut in two. `tick` is called with the share of `start` that each box which holds
    makes up. The search ends undecided before a box with all sides below `smallest` is tested.

    >>> bisect(((0.0, 1.0),), lambda box: abs(box[0][0] - 2) > box[0][1], 100)
    Search(proved=True, boxes=1, share=1.0)
    """
    queue, boxes, done = [(start, 1.0)], 0, 0.0
    while queue:
        box, share = queue.pop()
        if boxes == budget or max(half for _, half in box) < smallest:
            return Search(None, boxes, done)
        boxes += 1
        if holds(box):
            done += share
            tick(share)
        else:
            queue += [(half, share / 2) for half in halves(box)]
    return Search(True, boxes, done)

"""A second count of the fixed points of `T**n`: cells of phase space, quartered until the map is affine on them.

The displacement `v = (sin(theta_n - theta), phi_n - phi)` is continuous on a smooth convex table. On a cell
where its values at the corners and the centre are affine up to a small rest, the zero of the affine map is
in the cell or is not; where the rest is too large the cell is quartered. The index is the sign of the
determinant of the affine part. Sampled in float64, so no proof; but it has no seeds, no chord system and no
symmetry in common with the search.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from verification.cycles.search.newton import Array

COLUMNS, ROWS = 96, 48
DEPTH = 16  # quarterings of a cell at most
MOST = 100_000  # cells of one level
POINTS = 60_000  # of the circle, at lam = 0
SAME = 1e-6


@dataclass(frozen=True)
class Zeros:
    """Fixed points with index 1 and -1, and the cells that stayed open: the counts are whole when none did."""

    positive: int
    negative: int
    open: int


def fixed_points(map: PinballMap, n: int) -> Zeros:
    """The fixed points of `T**n` on a smooth convex table of one component, by their indices.

    >>> fixed_points(PinballMap("ellipse", lam=0.5, a=1.5), 2)
    Zeros(positive=2, negative=2, open=0)
    """
    lam = float(map.lam)
    if lam == 0:
        return _on_the_circle(map, n)
    half = np.array([pi / COLUMNS, lam * pi / 2 / ROWS])
    columns, rows = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS), indexing="ij")
    cells = np.stack([-pi + 0.07 + (2 * columns.ravel() + 1) * half[0], (2 * rows.ravel() + 1 - ROWS) * half[1]], -1)
    found: list[Array] = []
    for _ in range(DEPTH):
        zeros, unsettled = _examined(map, cells, half, n)
        found.append(zeros)
        half = half / 2
        quarters = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]) * half
        cells = (unsettled[:, None, :] + quarters[None]).reshape(-1, 2)
        if not len(cells) or len(cells) > MOST:
            break
    index = _each_once(map, np.concatenate(found), n)
    return Zeros(int(np.sum(index > 0)), int(np.sum(index < 0)), len(cells))


def _displacement(map: PinballMap, at: Array, n: int) -> tuple[Array, NDArray[np.bool_]]:
    """`v` at phase points, and whether the return is near the start rather than opposite."""
    theta, phi = np.mod(at[..., 0].ravel() + pi, 2 * pi) - pi, np.clip(at[..., 1].ravel(), -1.57, 1.57)
    place, out = theta, phi
    for _ in range(n):
        step = map.step(place, out)
        place, out = step.theta, step.phi
    v = np.stack([np.sin(place - theta), out - phi], -1).reshape(at.shape)
    return v, (np.cos(place - theta) > 0).reshape(at.shape[:-1])


def _examined(map: PinballMap, cells: Array, half: Array, n: int) -> tuple[Array, Array]:
    """The zeros in settled cells, and the cells that are not settled."""
    points = np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    v, near = _displacement(map, cells[:, None, :] + points[None] * half, n)
    centre, corners = v[:, 0], v[:, 1:]
    mean = corners.mean(axis=1)
    slope = np.stack(
        [
            (corners[:, [1, 3]].sum(1) - corners[:, [0, 2]].sum(1)) / 4,
            (corners[:, 2:].sum(1) - corners[:, :2].sum(1)) / 4,
        ],
        -1,
    )  # v changes by slope[:, :, k] from the centre to side k
    twist = (corners[:, 0] + corners[:, 3] - corners[:, 1] - corners[:, 2]) / 4
    rest = np.abs(twist) + 2 * np.abs(mean - centre)
    reach = np.abs(slope).sum(axis=2)
    away = np.any(np.abs(centre) > 1.2 * reach + 4 * rest + 1e-12, axis=1) & np.all(rest < 0.3 + 0 * rest, axis=1)
    away |= ~np.any(near, axis=1)
    det = slope[:, 0, 0] * slope[:, 1, 1] - slope[:, 0, 1] * slope[:, 1, 0]
    with np.errstate(all="ignore"):
        inverse = (
            np.stack(
                [
                    np.stack([slope[:, 1, 1], -slope[:, 0, 1]], -1),
                    np.stack([-slope[:, 1, 0], slope[:, 0, 0]], -1),
                ],
                1,
            )
            / det[:, None, None]
        )
        zero = -np.einsum("ijk,ik->ij", inverse, centre)
        unsure = np.einsum("ijk,ik->ij", np.abs(inverse), rest)
        outside = np.any(np.abs(zero) > 1.1 + 4 * unsure, axis=1) & np.all(unsure < 3, axis=1)
        inside = np.all(unsure < 0.2, axis=1) & np.all(np.abs(zero) < 1.2, axis=1)
    settled = away | outside | inside
    hits = cells + zero * half
    return hits[inside & ~away & near[:, 0]], cells[~settled]


def _each_once(map: PinballMap, zeros: Array, n: int) -> Array:
    """The indices of the zeros, each polished by Newton's method on the map itself and counted once."""
    if not len(zeros):
        return np.zeros(0)
    h, at = 1e-7, zeros
    for _ in range(5):
        shifts = np.array([[0.0, 0.0], [h, 0.0], [0.0, h]])
        v, _ = _displacement(map, at[:, None, :] + shifts[None], n)
        slope = np.stack([(v[:, 1] - v[:, 0]) / h, (v[:, 2] - v[:, 0]) / h], -1)
        step = np.linalg.solve(slope, v[:, 0][:, :, None])[:, :, 0]
        at = at - np.clip(step, -1e-2, 1e-2)
    v, near = _displacement(map, at, n)
    good = (np.max(np.abs(v), axis=1) < 1e-5) & near
    at, det = at[good], np.linalg.det(slope[good])
    key = np.stack([np.cos(at[:, 0]), np.sin(at[:, 0]), at[:, 1]], -1)
    kept: list[int] = []
    for i in range(len(key)):
        if not kept or np.min(np.max(np.abs(key[kept] - key[i]), axis=1)) > SAME:
            kept.append(i)
    return np.asarray(np.sign(det[kept]), dtype=np.float64)


def _on_the_circle(map: PinballMap, n: int) -> Zeros:
    """At `lam = 0` the exit is the normal, and sign changes along the boundary count.

    The transverse multiplier is 0, so the index of a crossing is 1 where `T0**n - 1` falls.
    """
    theta = -pi + (np.arange(POINTS) + 0.123) * 2 * pi / POINTS
    place = theta
    for _ in range(n):
        place = map.step(place, 0.0 * place).theta
    v, real = np.sin(place - theta), np.cos(place - theta) > 0
    crossing = (np.sign(v) != np.sign(np.roll(v, -1))) & real
    return Zeros(int(np.sum(crossing & (v > 0))), int(np.sum(crossing & (v < 0))), 0)

"""How a tangent vector and an area grow along orbits, over as many bounces as wanted, and then over more.

A `Growth` is a set of balls on their way, each with one tangent vector. Sums of logarithms are kept from the start,
so differences between two moments are the growth between them, and nothing is lost by looking often.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric.flights.family import SLAP
from numeric.kernels.spec import TANGENT, KernelSpec, starting

if TYPE_CHECKING:
    from numeric.pinball.map import PinballMap

Array = NDArray[np.float64]
GENERIC = 0.8, 0.6  # a first tangent vector (ds, dphi), of length 1


class Growth:
    """Balls with a tangent vector each, in the coordinates `(s, phi)`; `advance` moves all of them.

    `stretch` is the logarithm of the vector's length, `volume` that of `|det|` without the factors `lam`, both since
    the start; `bounces` is what each ball made before it stopped, if it did.

    >>> import numpy as np
    >>> from numeric import PinballMap
    >>> growth = Growth(PinballMap("cardioid", lam=0), 0, np.pi / 3, 0.0)  # T0' = 1 - t*|K| = -5/4 there
    >>> growth.advance(2)
    >>> growth.advance(2)
    >>> bool(abs(growth.stretch[0] / 4 - np.log(5 / 4)) < 1e-14), int(growth.bounces[0])
    (True, 4)
    """

    def __init__(self, map: "PinballMap", component: ArrayLike, theta: ArrayLike, phi: ArrayLike) -> None:
        self.map = map
        where, at, angle = map._start(theta, phi, component)
        self.component, self.theta, self.phi = where.ravel(), at.ravel(), angle.ravel()
        self.law, self.lam = map._law(angle), map._lams(at)
        self.own = map.states.enter(self.component, self.theta, self.phi, self.law)
        self.bounces: NDArray[np.int64] = np.zeros(at.size, dtype=np.int64)
        self.code: NDArray[np.int64] = np.zeros(at.size, dtype=np.int64)
        self.began()

    def began(self) -> None:
        """Starts the sums anew, with the generic vector."""
        self.speed, curvature = self.map.states.bending(self.component, self.theta)
        ds, dphi = (1.0, 0.0) if self.law == SLAP else GENERIC
        self.n0 = self.map.states.departure(self.own, self.law)
        omega = curvature * ds + dphi
        self.tangent: list[Any] = starting(self.n0 * (ds / self.speed), omega, self.n0)
        self.stretch, self.volume = np.zeros(self.theta.size), np.zeros(self.theta.size)

    def skip(self, bounces: int, threads: int | None = None) -> None:
        """Moves the balls alone, and starts the sums where they arrive; these bounces do not count."""
        if bounces:
            self._run(KernelSpec(self.law), bounces, (), threads)
            self.began()

    def advance(self, bounces: int, threads: int | None = None) -> None:
        """Moves balls and vectors on."""
        if not bounces:
            return
        going = self.code == 0
        rows = self._run(KernelSpec(self.law, exponents=True), bounces, self.tangent, threads)
        self.tangent = [rows[name] for name in TANGENT]
        speed, curvature = self.map.states.bending(self.component, self.theta)
        moved = rows["shift"] / rows["n0"] * speed
        turned = rows["omega"] - curvature * moved
        with np.errstate(divide="ignore"):
            stretch = np.log(np.hypot(moved, turned) / rows["down"]) + rows["growth"] * np.log(2.0)
            ends = np.log(speed / self.speed) + np.log(self.n0 / rows["n0"])
            volume = np.log(rows["up"] / rows["down"]) + rows["volume"] * np.log(2.0) + ends
        self.stretch = np.where(going, stretch, self.stretch)
        self.volume = np.where(going, volume, self.volume)
        made = bounces - (rows["lost"].astype(np.int64) if "lost" in rows else 0)
        self.bounces = self.bounces + np.where(going, made, 0)

    def _run(self, question: KernelSpec, bounces: int, tangent: Any, threads: int | None) -> dict[str, Array]:
        map = self.map
        rows = map.engine.run(question, self.own, self.lam, map.shape, bounces, tangent, threads).rows
        self.own = [rows[name] for name in map.family.fields(self.law)]
        self.component, self.theta = map.states.place(self.own)
        self.phi = map.states.exit(self.component, self.theta, self.own, self.law)
        if "code" in rows:
            self.code = np.where(self.code == 0, rows["code"].astype(np.int64), self.code)
        return rows

"""Claims on the cardioid's chaotic attractor: sampled with an error, proved at `lam = 0`. Paper: sections 4.1, 4.2."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.growth import Growth
from numeric.pinball.sampling import interior_starts
from verification.certificates.chaotic_exponent import ChaoticProof, slap_exponent
from verification.claims.claim import Claim, Judgement
from verification.claims.judges import answer, by, judges
from verification.claims.on_samples import sampled
from verification.claims.spectra import CELLS, EARLY, SEED, uneven, visited

FIFTHS = (0.2, 0.4, 0.6, 0.8, 1.0)
LONG = 12_000  # bounces: 20 to a cell, if every cell is visited
DUE = 15  # visits of one orbit to a cell, below which it may miss it by chance
Array = NDArray[np.float64]


@cache
def slap_proof() -> ChaoticProof:
    """The natural measure at `lam = 0` and its exponent, proved."""
    return slap_exponent()


@judges("cardioid.slap_ergodic")
def slap_ergodic(claim: Claim) -> Judgement:
    """One invariant measure has a density: it is ergodic, and natural."""
    proof = slap_proof()
    missing = [name for name, holds in proof.checks.items() if holds is not True]
    return Judgement(
        by(
            "the transfer operator of the slap map has exactly one invariant density on the boundary; so its measure "
            "of an invariant set is 0 or 1, and the time averages of almost every start are its means",
            answer(proof.certified, f"not proved: {', '.join(missing)}" if missing else ", ".join(proof.checks)),
        ),
        "ergodic: one invariant measure with a density, and almost every start follows it, with the exponent "
        f"{proof.value.str(15, radius=False)}; mixing is not shown",
    )


@cache
def coverage(table: str) -> Array:
    """Visits to cells at every fifth of a contraction, 16 orbits each."""
    return visited(table, FIFTHS, 16, LONG)


@judges("cardioid.attractor_grows", "cuspless.attractor_fills")
def grows(claim: Claim) -> Judgement:
    """The share of cells visited, against the contraction."""
    counts = coverage(claim.id.partition(".")[0])
    shares = [float(np.mean(c.sum(axis=0) > 0)) for c in counts]
    rough = uneven(counts[-1])
    listed = ", ".join(f"{x:.0%} at {value:g}" for x, value in zip(shares, FIFTHS, strict=True))
    said = (
        f"16 orbits of {LONG} bounces visit this share of {CELLS}x{CELLS} cells of (s, sin phi): {listed}; at lam = 1 "
        f"the cells' shares vary by {rough:.1%} beyond counting; |sin phi| <= sin(lam*pi/2) bounds the attractor"
    )
    good = bool(np.all(np.diff(shares) > 0)) and shares[-1] == 1 and rough < 0.05
    return sampled("it grows at each step sampled; uniform at lam = 1, the map's own measure", said, good)


@judges("cardioid.transitive")
def transitive(claim: Claim) -> Judgement:
    """Single orbits visit the same cells, equally often."""
    worst = 1.0
    for counts in coverage("cardioid"):
        often = counts.sum(axis=0) > len(counts) * DUE
        worst = min(worst, float(np.mean(counts[:, often] > 0)))
    proof = slap_proof()
    said = (
        f"16 orbits each at lam = 0.2, ..., 1 together visit at least {worst:.2%} of the pairs of an orbit and a cell "
        f"where {DUE} visits are due; at lam = 0 it is {'' if proof.certified else 'not '}proved that almost every "
        "start has one distribution; not of any orbit: unstable cycles lie on the attractor"
    )
    derived = "almost every start, not any: proved at lam = 0, sampled for lam > 0"
    return sampled(derived, said, worst > 0.999 and proof.certified)


@cache
def approaches(contraction: str) -> Array:
    """The smallest distance to the cusp after so many bounces, one column for each of 256 balls."""
    map = PinballMap("cardioid", lam=contraction)
    start = interior_starts(map, 256, SEED)
    growth = Growth(map, start.component, start.theta, start.phi if map.law != "slap" else 0 * start.phi)
    growth.skip(EARLY)
    orbit = map.orbit(growth.theta, growth.phi, 4096)
    return np.asarray(np.minimum.accumulate(np.hypot(orbit.x, orbit.y), axis=0))


def nearing() -> str:
    """How the smallest distance to the cusp falls with the number of bounces, in words.

    At `lam = 0` a landing at the distance `d` has come from `s` of the order `d**(3/2)`, so `d` falls like `n**(-2/3)`.
    """
    told, powers = [], []
    for contraction in ("0", "3/10", "8/10"):
        first, last = np.median(approaches(contraction)[[64, 4096]], axis=1)
        powers.append(f"{np.log(last / first) / np.log(64):.2f}")
        told.append(f"{first:.1e} after 64 bounces and {last:.1e} after 4096 at lam = {contraction}")
    return (
        f"sampled, the median of the smallest distance to the cusp is {'; '.join(told)}: it falls like the bounces to "
        f"the powers {', '.join(powers)} (-2/3 follows at lam = 0, -1 for the elastic measure)"
    )

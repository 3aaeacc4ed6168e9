"""All extreme cases in their groups, run one by one, and what to do where a verdict is not `STABLE`."""

from collections.abc import Iterator
from dataclasses import replace

from verification.extremes import flights, near, products
from verification.extremes.cases import CASES
from verification.extremes.kernels import TEXTBOOK
from verification.extremes.orbits import SHORT, orbits
from verification.extremes.orbits import findings as of_orbit
from verification.extremes.stability import Finding, Stability

ADVICE = {
    (TEXTBOOK.name, Stability.UNSTABLE): "PinballMap: the root that is known is divided out",
}
STOPPED = {
    "JOIN": "`verification.certificates.corner`: both reflections are followed",
    "CUSP": "nothing: the paper leaves the map undefined there",
    "GRAZING": "ExactMap with more digits",
    "division by zero": "ExactMap, which names the outcome CUSP",
}
Group = tuple[str, str, list[Finding]]


def rows(longer: bool = False, collisions: int = SHORT) -> Iterator[Group]:
    """Group, case and findings; with `longer`, what takes minutes too."""
    for case in CASES:
        yield case.group, case.name, [advised(found) for found in flights.findings(case)]
    for cycle in (*near.CYCLES, *(near.LONGER if longer else ())):
        yield cycle.group, cycle.name, near.findings(cycle)
    for product in (*products.PRODUCTS, *(products.LONGER if longer else ())):
        yield "Products and exponents", product.name, products.findings(product)
    for orbit in orbits(collisions):
        yield "Long orbits", orbit.name, of_orbit(orbit)


def advised(found: Finding) -> Finding:
    """With what to use in its place, where the kernel is not stable or stopped a ball."""
    advice = ADVICE.get((found.kernel, found.stability), "")
    said = [STOPPED[status] for status in found.status.split(", ") if status in STOPPED]
    return replace(found, instead="; ".join(text for text in (advice, *said) if text))

"""What a kernel is asked, and the rows of state that the question needs."""

from typing import NamedTuple

from numeric.backends.protocol import Backend, M, N, modulus
from numeric.flights.family import Array, Family

TANGENT = ("shift", "omega", "growth", "up", "down", "volume", "n0")
FAR = 2.0**100  # a double holds 2**1000


class KernelSpec(NamedTuple):
    """What a kernel is made for, besides the end of the trajectory."""

    law: str
    record: bool = False
    exponents: bool = False

    @property
    def text(self) -> str:
        """The question as part of a name."""
        return "-".join([self.law, *(["record"] if self.record else []), *(["exponents"] if self.exponents else [])])


def fields(family: Family, spec: KernelSpec) -> tuple[str, ...]:
    """The rows of `state`."""
    extra = TANGENT if spec.exponents else ()
    return (*family.fields(spec.law), *(("code", "lost") if family.stops else ()), *extra)


def starting(q: Array, omega: Array, n0: Array) -> list[Array]:
    """The rows of a tangent vector at the start: `q` across the first flight, `omega`, and `N0` of its departure."""
    nought = 0.0 * q
    return [q, omega, nought, nought + 1.0, nought + 1.0, nought, n0]


def rescaled(ops: Backend[N, M], rows: list[N]) -> list[N]:
    """The rows of a tangent vector, with mantissas far from one brought back; done every `renormalise_every` bounces.

    The vector is `(q, omega)*2**growth/down` and the product of the ratios of cosines `2**volume*up/down`; so no
    logarithm and no division is needed on the way.
    """
    q, omega, growth, up, down, volume, n0 = rows
    size, one, nought = ops.maximum(modulus(q), modulus(omega)), ops.number(1.0), ops.number(0.0)
    away = (size < ops.number(1 / FAR)) | (ops.number(FAR) < size)
    for product in (up, down):
        away = away | (product < ops.number(1 / FAR)) | (ops.number(FAR) < product)

    def nearer() -> list[N]:
        (small, gained), (smaller, rise), (smallest, fall) = (
            [ops.select(away, x, otherwise) for x, otherwise in zip(ops.power_of_two(y), (one, nought), strict=True)]
            for y in (size, up, down)
        )
        scaled = [q * small, omega * small, growth + gained - fall]
        return [*scaled, up * smaller, down * smallest, volume + rise - fall, n0]

    return list(ops.when(away, rows, nearer))

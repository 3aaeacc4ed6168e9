"""Which step serves which blueprint. Only the one that is asked for is imported."""

from numeric.flights.family import Family
from numeric.lowering.table_ir import Blueprint

PATHS = {
    "circle": "closed form in angles",
    "ellipse": "closed form in unit numbers",
    "fourier": "chord polynomial, one real zero",
    "cardioid": "cubic for the far end, its interval known from one sign",
    "cuspless": "the cardioid's cubic, the wall, and a quartic from the wall",
    "general": "every zero of the flight function on every piece, first hit",
}


def family_of(blueprint: Blueprint, convex: bool = True) -> Family:
    """The family of a blueprint; a Fourier sum that is not convex goes the general way."""
    name = blueprint.family
    if name == "circle":
        from numeric.flights.circle import Circle

        return Circle()
    if name == "ellipse":
        from numeric.flights.harmonic import Ellipse

        return Ellipse(blueprint)
    if name == "fourier" and convex:
        from numeric.flights.harmonic import Fourier

        return Fourier(blueprint)
    if name == "cardioid":
        from numeric.flights.cardioid import Cardioid

        return Cardioid()
    if name == "cuspless":
        from numeric.flights.cuspless import Cuspless

        return Cuspless()
    from numeric.flights.general import General

    return General(blueprint)

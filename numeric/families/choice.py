"""Which step serves which blueprint."""

from numeric.blueprint import Blueprint
from numeric.families.cardioid import Cardioid
from numeric.families.circle import Circle
from numeric.families.cuspless import Cuspless
from numeric.families.family import Family
from numeric.families.general import General
from numeric.families.harmonic import Ellipse, Fourier

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
    if blueprint.family == "circle":
        return Circle()
    if blueprint.family == "ellipse":
        return Ellipse(blueprint)
    if blueprint.family == "fourier" and convex:
        return Fourier(blueprint)
    if blueprint.family == "cardioid":
        return Cardioid()
    if blueprint.family == "cuspless":
        return Cuspless()
    return General(blueprint)

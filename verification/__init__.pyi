from .maps import strategies
from .maps.enclosed import EnclosedMap
from .maps.exact import ExactMap
from .named.files import check
from .named.locate import Located, locate
from .named.questions import (
    BranchEvent,
    FollowedOrbit,
    PeriodicOrbit,
    PeriodicOrbits,
    certify,
    find_cycles,
    follow,
)
from .paper.report.report import verify

__all__ = [
    "BranchEvent",
    "EnclosedMap",
    "ExactMap",
    "FollowedOrbit",
    "Located",
    "PeriodicOrbit",
    "PeriodicOrbits",
    "certify",
    "check",
    "find_cycles",
    "follow",
    "locate",
    "strategies",
    "verify",
]

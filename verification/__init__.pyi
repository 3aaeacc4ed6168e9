from .maps import laws, strategies
from .maps.enclosed import EnclosedMap
from .maps.exact import ExactMap
from .named.files import check
from .named.locate import Located, locate
from .named.questions import (
    BranchEvent,
    FollowedOrbit,
    PeriodicOrbit,
    PeriodicOrbits,
    bifurcations,
    certify,
    find_cycles,
    follow,
)
from .paper.report.report import verify
from .reports.report import report

__all__ = [
    "BranchEvent",
    "EnclosedMap",
    "ExactMap",
    "FollowedOrbit",
    "Located",
    "PeriodicOrbit",
    "PeriodicOrbits",
    "bifurcations",
    "certify",
    "check",
    "find_cycles",
    "follow",
    "laws",
    "locate",
    "report",
    "strategies",
    "verify",
]

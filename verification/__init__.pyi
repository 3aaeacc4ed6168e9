from . import judging
from .maps import laws, strategies
from .maps.enclosed import EnclosedMap
from .maps.exact import ExactMap
from .measure.work.scenes import WorkPrecision, work_precision
from .named.bifurcations import bifurcations
from .named.locate import Located, locate
from .named.questions import (
    BranchEvent,
    FollowedOrbit,
    PeriodicOrbit,
    PeriodicOrbits,
    certify,
    find_cycles,
    follow,
    morse_graph,
    trapping_region,
)
from .named.theorems import check
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
    "WorkPrecision",
    "bifurcations",
    "certify",
    "check",
    "find_cycles",
    "follow",
    "judging",
    "laws",
    "locate",
    "morse_graph",
    "report",
    "strategies",
    "trapping_region",
    "verify",
    "work_precision",
]

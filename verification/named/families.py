"""Global continuation: every family of cycles that attracts random starts somewhere, followed from birth to death.

At many values of a parameter, random starts show the attractors (`numeric.sweeps.endings`). A cycle that is on no known
branch is followed both ways, with the branches born on it where it doubles its period or loses a symmetry; all starts
are then compared with the new branches. For chaotic and neutral orbits, which are not cycles, the ends of their
parameter ranges are bisected. The idea is that of `global_continuation` of Attractors.jl; here each branch ends in an
event that can be proved.

A family is missed if fewer than `least` of the starts end on it at each value. `Continuation.check` samples values that
were not used.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import S

from numeric import PinballMap
from numeric.dynamics.attractors import with_images
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.recognition import Attractor, Kind, polished
from numeric.sweeps.endings import CHAOTIC, CYCLE, NEUTRAL, STAGES, STOPPED, UNSETTLED, Endings, endings, marks_of
from numeric.sweeps.sweep import at_value, map_of, text_of
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal
from verification.arithmetic.iteration import silent
from verification.cycles.arc import LostError, Steps
from verification.cycles.branch import Branch, Event, branch
from verification.cycles.chords import Chords
from verification.cycles.family import ALIKE, CLOSE, CycleFamily, Interval, closing, left, marks_along, same_event
from verification.cycles.recurrence import IDENTITY, Array, BifurcationKind
from verification.cycles.switching import switched
from verification.cycles.systems import whole
from verification.named.accounts import Check, Range, Unfollowed
from verification.named.events import proof_of
from verification.named.questions import PeriodicOrbit, Tick, ring_over
from verification.proofs.periodic.cycle_in_box import UniqueCycle

VALUES, SHAPES, STARTS = 200, 40, 200  # each shape is a table of its own
LEAST, OFTEN, LONG = 0.01, 3, 64  # a cycle longer than LONG needs this share of starts, or OFTEN in all
SOON = 3  # runs of the starts if cycles of one period are asked for, not how long chaos lasts
STEPS = Steps(first=0.002, most=250)  # along a branch, each way
LONGEST = 128  # period of a cycle that a doubling leads to
NEAREST = 3e-4  # of the interval: a cycle that attracts over less is not followed beyond its doubling
ROUNDS = 10  # bisections of the ends of a range without cycles
FINER, FEW = 8, 40  # parts of the distance of two values in chaos, where windows are narrow, and starts there
AMID, SETS = 5, 100  # values at which chaotic attractors are told apart, and starts there
CERTAIN = 8  # of the starts at a value are expected on what a range has: one that is on none ends it
BATCH = 100  # values at once, between which time may end
SURE = 3.0  # of n starts none ends on what attracts a share of 3/n, with a chance of 5 %
UNKNOWN, FAILED, NO_CYCLE = -1, -2, -3  # in place of a family's number
KINDS = {CHAOTIC: "chaotic", NEUTRAL: "neutral"}  # endings that are no cycles


@dataclass(frozen=True)
class FamilyEvent:
    """An event next to which a family attracts, the family's index, and the index of the family born there, if any."""

    event: Event
    family: int
    born: int | None


@dataclass(eq=False, repr=False)
class Continuation:
    """The families of a scene over an interval of one parameter, as far as known; with `only`, those of one period.

    >>> found = Continuation(Scene("ellipse", a="3/2"), "lam", ("1/10", "9/10"), starts=20).run(values=8)
    >>> [(family.period, family.attracts) for family in found.families]
    [(2, ((0.1, 0.9),))]
    """

    scene: Scene
    parameter: str
    ends: tuple[Any, Any]
    starts: int = STARTS
    seed: int = 1
    least: float = LEAST
    only: int | None = None
    tick: Tick = silent
    families: list[CycleFamily] = field(default_factory=list)
    seen: list[Endings] = field(default_factory=list)
    labels: list[NDArray[np.int64]] = field(default_factory=list)
    unfollowed: list[Unfollowed] = field(default_factory=list)

    @cached_property
    def interval(self) -> Interval:
        """The interval of the parameter in float64."""
        low, high = (float(exact(self.parameter, end)) for end in self.ends)
        return low, high

    @property
    def width(self) -> float:
        """The length of the interval."""
        return self.interval[1] - self.interval[0]

    def run(self, values: int | None = None) -> "Continuation":
        """Samples `values` values, follows the cycles found, and bisects the ends of chaotic ranges; returns `self`."""
        values = values or (VALUES if self.parameter == "lam" else SHAPES)
        known = {each.value for each in self.seen}
        grid = self.interval[0] + (np.arange(values) + 0.5) / values * self.width
        self.sample(np.array([value for value in grid if value not in known]))
        while self.follow_next():
            pass
        if self.only is None:
            self.bisect()
        self.refine(self.width / values)
        while self.follow_next():
            pass
        return self

    def cycle(self, family: CycleFamily) -> PeriodicOrbit:
        """The cycle of a family at the point `CycleFamily.start`."""
        z, (components, theta, phi) = family.start, family.orbit
        one, two = sorted(family.branch.system.spectrum(z).multipliers, key=lambda mu: -abs(mu))
        value: dict[str, Any] = {self.parameter: repr(float(z[-1]))}
        bounces = components, tuple(theta.tolist()), tuple(phi.tolist())
        return PeriodicOrbit(self.scene.at(**value), *bounces, (complex(one), complex(two)))

    def symmetry(self, family: CycleFamily) -> tuple[str, int]:
        """The symmetry of the cycles of a family, and the number of symmetric images of one cycle."""
        component, theta, phi = family.orbit
        points = PhasePoints(np.array(component), theta, phi)
        images = with_images(self.map_at(float(family.start[-1])), [Attractor(Kind.CYCLE, family.period, points)])
        return images[0].symmetry, len(images)

    def proof(self, event: Event, digits: int) -> UniqueCycle | None:
        """The proof of an event; None if its kind has no certificate, or if it cannot be proved."""
        try:
            return proof_of(event, digits, self.parameter, None if self.parameter == "lam" else S(self.scene.lam))
        except (ValueError, ZeroDivisionError):
            return None

    def document(self, digits: int = 20) -> dict[str, Any]:
        """Events, branches and ranges without cycles as JSON; events are proved to `digits` digits."""
        return {
            "parameter": self.parameter,
            "from": str(self.ends[0]),
            "to": str(self.ends[1]),
            "events": [self.event_document(event, self.proof(event.event, digits), digits) for event in self.events],
            "branches": [self.branch_document(family) for family in self.families],
            "ranges": self.document_of_ranges(),
            "unfollowed": [asdict(one) for one in self.unfollowed],
            "values": len(self.seen),
            "starts": self.starts,
            "missed_below": max(self.least, SURE / self.starts),
        }

    def document_of_ranges(self) -> list[dict[str, Any]]:
        """The ranges without cycles as JSON."""
        found = [one for kind in KINDS for one in self.seen_without_cycle(kind)]
        return [{"kind": KINDS[one.kind], "low": list(one.low), "high": list(one.high)} for one in found]

    def amid_chaos(self) -> list[float]:
        """Some parameter values, well spread, at which a sufficient fraction of the starts is chaotic."""
        at = np.array(
            [seen.value for seen in self.seen if np.sum(seen.kind == CHAOTIC) >= max(2, self.least * seen.starts)]
        )
        targets: Any = np.linspace(at.min(initial=np.inf), at.max(initial=-np.inf), AMID + 2)[1:-1] if at.size else []
        return sorted({float(at[np.argmin(np.abs(at - target))]) for target in targets})

    def event_document(self, event: FamilyEvent, proof: UniqueCycle | None, digits: int) -> dict[str, Any]:
        """An event as JSON; its value and radius are decimals as text."""
        certified = proof is not None and proof.proved
        value, radius = decimal(proof.value, digits + 1) if proof and certified else (repr(event.event.value), None)
        return {
            "kind": event.event.kind.name.lower(),
            "period": self.families[event.family].period,
            "parameter": self.parameter,
            "value": value,
            "radius": radius,
            "certified": certified,
            "branch": event.family,
            "born": event.born,
        }

    def branch_document(self, family: CycleFamily) -> dict[str, Any]:
        """A family as JSON."""
        symmetry, copies = self.symmetry(family)
        return {
            "period": family.period,
            "symmetry": symmetry,
            "copies": copies,
            "low": family.low,
            "high": family.high,
            "attracts": [list(one) for one in family.attracts],
        }

    def __repr__(self) -> str:
        periods = ", ".join(str(family.period) for family in self.families)
        return (
            f"Continuation({self.parameter} from {self.ends[0]} to {self.ends[1]}: cycles of periods {periods or '-'})"
        )

    def map_at(self, value: float) -> PinballMap:
        """The map at a value of the parameter."""
        if self.parameter == "lam":
            return map_of(text_of(self.scene), value)
        return map_of(at_value(text_of(self.scene), self.parameter, value), float(self.scene.lam))

    @cached_property
    def size(self) -> float:
        """The unit of length for distances: a power of two near the size of the table in the middle of the interval."""
        return float(self.map_at(sum(self.interval) / 2).states.size)

    def endings(self, values: Array, starts: int, seed: int) -> list[Endings]:
        """For each of some parameter values, the attractors on which random starts end."""
        told = partial(self.tick, f"{len(values)} values of {self.parameter}")
        stages = len(STAGES) if self.only is None else SOON
        return endings(text_of(self.scene), self.parameter, values, float(self.scene.lam), starts, seed, told, stages)

    def sample(self, values: Array, starts: int | None = None) -> None:
        """Samples random starts at the given values, and adds the attractors on which they end."""
        if not len(values):
            return
        new = self.endings(values, starts or self.starts, self.seed + len(self.seen))
        rows = sorted(
            zip([*self.seen, *new], [*self.labels, *map(self.labelled, new)], strict=True), key=lambda row: row[0].value
        )
        self.seen, self.labels = [row[0] for row in rows], [row[1] for row in rows]

    def labelled(self, seen: Endings, label: NDArray[np.int64] | None = None, first: int = 0) -> NDArray[np.int64]:
        """The index of the family on which each start ends; with `label`, only families from `first` on are tried."""
        label = np.where(seen.kind == CYCLE, UNKNOWN, NO_CYCLE) if label is None else label
        for number, family in enumerate(self.families[first:], first):
            rows = np.nonzero((label == UNKNOWN) & (seen.period == family.period))[0]
            if not rows.size or not family.low <= seen.value <= family.high:
                continue
            for marks, wide in family.near(seen.value):
                near = np.max(np.abs(seen.marks[rows] - marks), axis=1) < wide + seen.gap[rows] * self.size
                label[rows[near]] = number
        return label

    def clusters(self, seen: Endings, label: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
        """Groups of starts, as indices, that end on the same cycle up to symmetry, if no known family contains it."""
        left = np.nonzero(label == UNKNOWN)[0]
        while left.size:
            apart = np.max(np.abs(seen.marks[left] - seen.marks[left[0]]), axis=1)
            alike = (seen.period[left] == seen.period[left[0]]) & (apart < CLOSE * self.size)
            yield left[alike]
            left = left[~alike]

    def follow_next(self) -> bool:
        """Follows the cycle that most starts reach, among cycles on no known family; False if there is none."""
        clusters = [
            (rows.size, -int(seen.period[rows[0]]), i, rows)
            for i, (seen, label) in enumerate(zip(self.seen, self.labels, strict=True))
            for rows in self.clusters(seen, label)
            if self.only in (None, seen.period[rows[0]])
        ]
        if not clusters:
            return False
        size, period, i, rows = max(clusters, key=lambda row: row[:2])
        seen, label = self.seen[i], self.labels[i]
        alike = sum(
            int(np.sum((one == UNKNOWN) & (each.period == -period)))
            for each, one in zip(self.seen, self.labels, strict=True)
        )
        if size < max(2, self.least * self.starts) and alike < OFTEN and -period > LONG:
            return False
        self.tick(f"period {seen.period[rows[0]]} at {self.parameter} = {seen.value:.4g}")
        known = len(self.families)
        number = self._followed(seen, rows)
        label[rows] = number
        if number == FAILED:
            self._give_up(seen, rows[0])
        for other, own in zip(self.seen, self.labels, strict=True):
            self.labelled(other, own, known)
        return True

    def _followed(self, seen: Endings, rows: NDArray[np.int64]) -> int:
        """Follows the cycle on which the starts `rows` end, unless it is known; returns the index of its family."""
        map, n = self.map_at(seen.value), int(seen.period[rows[0]])
        here = seen.points.only(rows[:1])
        orbit = map.orbit(here.theta, here.phi, n - 1, here.component)
        cycle = polished(map, PhasePoints(orbit.component[:, 0], orbit.theta[:, 0], orbit.phi[:, 0]))
        share = rows.size / seen.starts
        if cycle is None:
            self.unfollowed.append(Unfollowed(seen.value, n, share, "Newton's method does not settle on it"))
            return FAILED
        known = self._known(cycle.period, seen.value, self._marks(map, cycle.points))
        if known is not None:
            return known
        points, own = cycle.points, {self.parameter: repr(seen.value)}
        given = tuple(points.component.tolist()), tuple(points.theta.tolist()), tuple(points.phi.tolist())
        try:
            made = ring_over(PeriodicOrbit(self.scene.at(**own), *given, cycle.multipliers), self.parameter, self.ends)
            found = branch(made[0], points.theta, self.parameter, made[1], self.interval, made[2], STEPS, left(n))
        except (ValueError, ZeroDivisionError) as why:
            self.unfollowed.append(Unfollowed(seen.value, cycle.period, share, str(why)))
            return FAILED
        new, number = CycleFamily(found, self.size), len(self.families)
        known = self._known(new.period, *new.marked_start)  # starts next to a fold lie between no two of its points
        if known is not None:
            return known
        self.families.append(new)
        self._descend(number)
        return number

    def _marks(self, map: PinballMap, points: PhasePoints) -> Array:
        """The marks of a cycle: numbers that identify it up to symmetry."""
        at = map.orbit(points.theta, points.phi, 1, points.component)
        return np.asarray(marks_of(np.stack([at.x[0], at.y[0]])[:, :, None])[0])

    def _known(self, period: int, value: float, marks: Array) -> int | None:
        """The index of the known family that has a cycle with these marks at the value; None if there is none."""
        alike = (i for i, family in enumerate(self.families) if family.period == period and family.holds(value, marks))
        return next(alike, None)

    def _give_up(self, seen: Endings, row: int) -> None:
        """Marks the start `row` as failed, and all starts at nearby values that end on nearly the same cycle."""
        for other, label in zip(self.seen, self.labels, strict=True):
            if abs(other.value - seen.value) < 10 / VALUES * self.width:
                apart = np.max(np.abs(other.marks - seen.marks[row]), axis=1)
                label[(label == UNKNOWN) & (other.period == seen.period[row]) & (apart < 10 * CLOSE * self.size)] = (
                    FAILED
                )

    def _descend(self, number: int) -> None:
        """Adds the attracting families born on family `number`, its parent, and recursively those of new families."""
        family = self.families[number]
        for event in family.branch.along:
            if not self._leads_on(family, event):
                continue
            try:
                found = self._parent_at(family, event) if event.birth else self._children_at(family, event)
            except (LostError, ValueError):
                continue
            for each in found:
                new = CycleFamily(each, self.size, None if event.birth else number, None if event.birth else event)
                if not new.attracts or self._known(new.period, *new.marked_start) is not None:
                    continue
                self.families.append(new)
                self.tick(f"period {new.period} from {self.parameter} = {event.value:.6g}")
                self._descend(len(self.families) - 1)

    def _children_at(self, family: CycleFamily, event: Event) -> list[Branch]:
        """The branches that are born on a family at an event, one from each set of symmetric images."""
        n = family.period * (2 if event.kind is BifurcationKind.FLIP else 1)
        found = switched(family.branch, event, self.interval, STEPS, left(n))
        return found if event.kind is BifurcationKind.BORDER_COLLISION else found[:1]

    def _parent_at(self, family: CycleFamily, event: Event) -> list[Branch]:
        """The branch on which a family is born, with the event of its birth added; empty if the branch is known."""
        part = event.ring
        assert isinstance(part, Chords)
        steps = STEPS if part.closure == IDENTITY else replace(STEPS, most=6)
        (found,) = switched(family.branch, event, self.interval, steps, left(family.period))
        if part.closure != IDENTITY:  # the part of a symmetric cycle
            z = CycleFamily(found, self.size).start
            ring, x = whole(part, z[:-1], closing(part, z[:-1]))
            if self._known(ring.period, float(z[-1]), marks_along(ring, np.append(x, z[-1])[None])[0]) is not None:
                return []
            system = found.system
            fixed = dict(system.fixed)
            found = branch(ring, x, self.parameter, float(z[-1]), self.interval, fixed, STEPS, left(ring.period))
        if not any(same_event(event, other) for other in found.events):
            at = min(
                found.points, key=lambda point: abs(point.z[-1] - event.value)
            )  # no test function changes its sign
            met = replace(event, birth=False, point=replace(event.point, s=at.s))
            found = replace(found, events=tuple(sorted((*found.events, met), key=lambda one: one.point.s)))
        return [found]

    def _leads_on(self, family: CycleFamily, event: Event) -> bool:
        """True if an attracting family that is not yet known may be born at an event, or be the parent of this one."""
        kind, n = event.kind, family.period
        if kind is BifurcationKind.FLIP and not event.birth:
            supercritical = event.form is None or event.form.supercritical is not False
            wide = [high - low for low, high in family.attracts if min(event.value - low, high - event.value) > -ALIKE]
            near = max(wide, default=0.0) < NEAREST * self.width
            if not supercritical or 2 * n > LONGEST or near:
                return False
        elif kind is BifurcationKind.BORDER_COLLISION:
            if not event.located:
                return False
        elif kind not in (BifurcationKind.FLIP, BifurcationKind.PITCHFORK):
            return False
        others = (e for f in self.families if f is not family for e in (*f.branch.along, f.birth) if e is not None)
        met = any(e.birth != event.birth and same_event(event, e) for e in others)
        return not met and family.attracts_next_to(event)

    @property
    def events(self) -> list[FamilyEvent]:
        """The events next to which a family attracts, in order and without repetition, with the family born at each."""
        found: list[FamilyEvent] = []
        for number, family in enumerate(self.families):
            for event in family.branch.along:
                inside = min(abs(event.value - end) for end in self.interval) > ALIKE
                if not (inside and family.attracts_next_to(event)) or event.kind is BifurcationKind.NEUTRAL_SADDLE:
                    continue
                begins = event.kind is BifurcationKind.BORDER_COLLISION and abs(event.value - family.low) < ALIKE
                born = number if event.birth or event.kind is BifurcationKind.FOLD else self._born(number, event)
                born = number if born is None and begins else born
                parent = self._parent(number, event) if event.birth else number
                if event.birth and parent is not None:
                    continue  # listed with the family on which it is born
                found.append(FamilyEvent(event, number, born))
        return sorted(found, key=lambda each: each.event.value)

    def _born(self, number: int, event: Event) -> int | None:
        """The index of the family that is born at this event of family `number`; None if it is not known."""
        for other, family in enumerate(self.families):
            births = [*family.branch.births, *([family.birth] if family.birth and family.parent == number else [])]
            if other != number and any(same_event(event, each) for each in births):
                return other
        return None

    def _parent(self, number: int, event: Event) -> int | None:
        """The index of the family on which family `number` is born at this event; None if it is not known."""
        for other, family in enumerate(self.families):
            if other != number and any(same_event(event, each) for each in family.branch.events):
                return other
        return None

    def seen_without_cycle(self, kind: int) -> list[Range]:
        """The ranges in which starts end on chaotic or neutral orbits (`kind`); each end lies between two values.

        A value with few starts, none of them of this kind, does not end a range if this could be by chance.
        """
        rows, share, found = list[tuple[float, bool]](), 0.0, list[Range]()
        for seen in self.seen:
            count = int(np.sum(seen.kind == kind))
            if count >= 2 or seen.starts >= self.starts or share * seen.starts > CERTAIN:
                rows.append((seen.value, count >= max(2, self.least * seen.starts)))
                share = count / seen.starts
        low = self.interval
        for k, (value, now) in enumerate(rows):
            if now and not (k and rows[k - 1][1]):
                low = rows[k - 1][0] if k else self.interval[0], value
            if now and not (k + 1 < len(rows) and rows[k + 1][1]):
                found.append(Range(kind, low, (value, rows[k + 1][0] if k + 1 < len(rows) else self.interval[1])))
        return found

    def bisect(self) -> None:
        """Samples repeatedly inside the intervals that hold the ends of chaotic and neutral ranges."""
        for _ in range(ROUNDS):
            gaps = {
                end
                for kind in (CHAOTIC, NEUTRAL)
                for one in self.seen_without_cycle(kind)
                for end in (one.low, one.high)
            }
            middles = {(a + b) / 2 for a, b in gaps if b - a > self.width / 2**ROUNDS / VALUES}
            inner = [x for x in middles if self.seen[0].value < x < self.seen[-1].value]
            if not inner:
                return
            self.sample(np.array(sorted(inner)))

    def refine(self, step: float) -> None:
        """Samples values `step / FINER` apart between neighbouring values of which one has chaotic starts."""
        inner = list[float]()
        for one, two in pairwise(self.seen):
            parts = int(np.ceil(FINER * (two.value - one.value) / step - 0.5))
            if CHAOTIC in (*one.kind, *two.kind):
                inner += np.linspace(one.value, two.value, parts + 1)[1:-1].tolist() if parts > 1 else []
        for first in range(0, len(inner), BATCH):
            self.sample(np.array(inner[first : first + BATCH]), min(FEW, self.starts))

    def check(self, values: int = 8, starts: int = 400, seed: int = 2027) -> Check:
        """A check by random starts at random values, one in each of `values` equal parts of the interval.

        It counts the starts that end on known attractors. A new attractor is reported as missing even if only a few
        starts reach it.
        """
        shares = (np.arange(values) + np.random.default_rng(seed).uniform(size=values)) / values
        at = self.interval[0] + self.width * shares
        accounted, unsettled, missing = 0, 0, list[Unfollowed]()
        for seen in self.endings(at, starts, seed):
            label = self.labelled(seen)
            for kind, words in KINDS.items():
                count = int(np.sum(seen.kind == kind))
                if not count or any(one.holds(seen.value) for one in self.seen_without_cycle(kind)):
                    accounted += count
                else:
                    missing.append(Unfollowed(seen.value, 0, count / starts, f"{words} outside of the ranges"))
            unsettled += int(np.sum(seen.kind == UNSETTLED))
            accounted += int(np.sum(label >= 0) + np.sum(seen.kind == STOPPED))
            for rows in self.clusters(seen, label):
                number = self._known(int(seen.period[rows[0]]), seen.value, seen.marks[rows[0]])
                accounted += rows.size * (number is not None)
                if number is None:
                    missing.append(
                        Unfollowed(seen.value, int(seen.period[rows[0]]), rows.size / starts, "on no branch")
                    )
        return Check(tuple(at.tolist()), starts, seed, accounted, unsettled, tuple(missing))

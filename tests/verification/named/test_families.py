"""All families of attracting cycles, compared with an independent brute-force scan.

`python tests/verification/named/test_families.py VALUES STARTS [NAME...]` scans larger scenes and prints the results.
"""

import json
import sys
from collections import Counter

import numpy as np
import pytest

from numeric import PinballMap
from numeric.dynamics.recognition import Kind
from numeric.sweeps.endings import endings
from numeric.sweeps.sweep import text_of
from symbolic import Scene, double_normals
from symbolic.cycles.thresholds import flip_contraction, stability_number
from verification import bifurcations
from verification.app.cli import main as main_of_app

LIMACON = Scene.of({"polar": "1 + 3*cos(theta)/10"})
LENS = Scene.of({
    "component": [
        {"name": "lower", "x": "theta", "y": "3*(theta**2 - 1)/5", "from": "-1", "to": "1"},
        {"name": "upper", "x": "-theta", "y": "2*(1 - theta**2)/5", "from": "-1", "to": "1"},
    ]
})  # fmt: skip
SCENES = {
    "limacon": (LIMACON, {}),
    "flower": (Scene.of({"polar": "1 + cos(5*theta)/40"}), {}),
    "pea": (Scene.of({"polar": "1 + cos(2*theta)/10"}), {}),
    "exponential": (Scene.of({"polar": "exp(cos(2*theta)/8)"}), {}),
    "egg": (Scene("egg", alpha="2/25"), {}),
    "bean": (Scene.of({"polar": "1 + 2*cos(2*theta)/5"}), {}),
    "stadium": (Scene("stadium"), {}),
    "cuspless": (Scene("cuspless"), {}),
    "lens": (LENS, {}),
    "law": (Scene.of({"polar": "1 + cos(3*theta)/20", "law": "-lam*eta*(1 - eta**2/40)"}), {}),
    "letters": (
        Scene.of({"polar": "1 + b*cos(3*theta)", "shape": {"b": "1/25"}, "lam": "7/10"}),
        {"b": ("1/50", "3/50")},
    ),
}


def scan(scene, starts, seed):
    """The number of random starts that end on each attracting cycle of period up to 64, from iteration alone."""
    map, rng = PinballMap(scene), np.random.default_rng(seed)
    ends = np.array(map.states.ends)
    part = rng.integers(0, len(ends), starts)
    theta = ends[part, 0] + (ends[part, 1] - ends[part, 0]) * rng.uniform(size=starts)
    phi, found = np.arcsin(rng.uniform(-1, 1, starts)), Counter()
    for before in (300, 1500, 4000 + min(100_000, int(100 / (1 - float(scene.lam)))), 60_000):
        if theta.size:
            end = map.exponents(theta, phi, min(10_000, before), before, part)  # errors of 1 over the bounces
            going = end.code == 0
            theta, phi, part, nu = end.theta[going], end.phi[going], end.component[going], end.nu_plus[going]
        if not theta.size:
            break
        orbit = map.orbit(theta, phi, 64, part)
        place = np.stack([orbit.x, orbit.y, np.sin(orbit.phi)])
        gap = np.linalg.norm(place[:, 1:] - place[:, :1], axis=0)
        near = gap.min(axis=0)  # a slow spiral about a cycle that is to double comes nearer after two rounds
        back, n = (near < 1e-9) & (nu < -1e-4), np.argmax(gap < np.maximum(1e-6, 1e4 * near), axis=0) + 1
        means = np.cumsum(np.concatenate([place, place**2]), axis=1)[:, n - 1, np.arange(n.size)] / n
        for period in np.unique(n[back]):
            left = means[:, back & (n == period)].T
            while left.size:
                alike = np.max(np.abs(left - left[0]), axis=1) < 1e-5
                found[int(period), *np.round(left[0], 4).tolist()] += int(alike.sum())
                left = left[~alike]
        left = ~back & (nu < (np.inf if before < 4000 else 0.01))  # chaos has had its time
        theta, phi, part = theta[left], phi[left], part[left]
    return found


def unaccounted(document, scene, values, starts, least=0.01):
    """What a scan at some values sees and a document does not say: cycles on no branch, and changes without an event.

    At a value there are at most so many cycles of a period as branches have copies there. A cycle with at least such a
    share of the starts that none ends on at the next value was born, or ended, at an event of its period in between,
    unless it has at most five times that share and a branch has it at both: then its basin is small at the other one.
    """
    missing, before = [], None
    for i, value in enumerate(values):
        seen = scan(scene.at(**{document["parameter"]: repr(float(value))}), starts, i)
        shares = {
            n: sorted((seen[key] / starts for key in seen if key[0] == n), reverse=True) for n in {k[0] for k in seen}
        }
        attracting = Counter()
        for one in document["branches"]:
            attracting[one["period"]] += one["copies"] * any(a <= value <= b for a, b in one["attracts"])
        for n, own in shares.items():
            if sum(share >= least for share in own) > attracting[n]:
                missing.append(f"{value:.6g}: cycles of period {n}, {own}, on branches {attracting[n]}")
        here = shares, attracting
        for (one, _), (two, known) in ((before, here), (here, before)) if before else ():
            for n, own in one.items():
                count = max(len(two.get(n, [])), known[n])
                lost = sum(s >= least for s in own) > count or sum(s >= 5 * least for s in own) > len(two.get(n, []))
                if lost and not _event(document, n, values[i - 1], value):
                    missing.append(f"{values[i - 1]:.6g} to {value:.6g}: no event of period {n}, {own}")
        before = here
    return missing


def _event(document, period, low, high):
    """Has a document an event between two values of a branch of some period?"""
    return any(
        document["branches"][branch]["period"] == period
        for event in document["events"]
        if low - 1e-9 <= float(event["value"]) <= high + 1e-9
        for branch in (event["branch"], event["born"])
        if branch is not None
    )


@pytest.fixture(scope="module")
def limacon():
    return bifurcations(LIMACON, lam=("93/100", "97/100"), values=24)


@pytest.mark.slow
def test_a_scan_finds_no_attracting_cycle_that_is_on_no_branch(limacon):
    assert unaccounted(limacon.document(5), LIMACON, np.linspace(0.931, 0.969, 9), 400) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "low", "high"),
    [("law", 50, "3/4", "1"), ("bean", 30, "0", "1"), ("cuspless", 30, "0", "3/20"), ("lens", 20, "9/10", "1")],
)
def test_a_scan_of_other_scenes_finds_none_and_no_change_without_an_event(name, values, low, high):
    scene, _ = SCENES[name]
    found = bifurcations(scene, lam=(low, high), values=values, starts=100)
    at = found.interval[0] + found.width * (np.arange(12) + 0.3) / 12

    assert unaccounted(found.document(5), scene, at, 400) == []


@pytest.mark.slow
def test_starts_at_other_values_end_on_branches_that_are_known(limacon):
    found = limacon.check(values=3, starts=200)

    assert found.missing == ()
    assert found.accounted + found.unsettled == 600


def test_chaos_that_ends_on_cycles_after_a_long_while_is_no_attractor():
    """At 0.9975 three starts of ten wander for thousands of bounces in this table, and all of them end on cycles."""
    (found,) = endings(text_of(LIMACON), "lam", np.array([0.9975]), 1.0, starts=100, seed=3)

    assert found.count(Kind.CYCLE) == 100


@pytest.mark.slow
def test_starts_on_a_cycle_that_has_just_doubled_are_of_its_family():
    """Next to a doubling starts are so near the cycle that they count as on it, which attracts no more."""
    periods = Counter(family.period for family in bifurcations(SCENES["flower"][0], lam=("0.49", "0.52")).families)

    assert {n: periods[n] for n in (4, 16, 32, 64, 128)} == dict.fromkeys((4, 16, 32, 64, 128), 1)


def test_each_birth_is_an_event_that_is_proved(limacon):
    """The triangles of this table are born in a fold above 0.9, and attract from there on."""
    said = limacon.document(digits=15)
    births = {event["born"]: event for event in said["events"] if event["born"] is not None}
    born = [(i, branch) for i, branch in enumerate(said["branches"]) if branch["low"] > 0.93]

    assert {branch["period"] for _, branch in born} >= {3, 5, 12, 16}
    for i, branch in born:
        own = [float(event["value"]) for event in said["events"] if i in (event["branch"], event["born"])]
        assert births[i]["certified"], branch
        assert abs(float(births[i]["value"]) - branch["low"]) < 1e-9
        for end in (end for ends in branch["attracts"] for end in ends if end < 0.97):
            assert min(abs(value - end) for value in own) < 1e-9, branch


def test_a_threshold_in_closed_form_is_the_event_of_a_family():
    """Two ways to one number: symmetry and algebra, and following a family to its doubling."""
    found = bifurcations(SCENES["flower"][0], lam=("0", "1/5"), values=6, starts=40)
    (chord,) = double_normals(SCENES["flower"][0].table)
    closed = flip_contraction(stability_number(chord))
    event = next(one for one in found.document(15)["events"] if one["period"] == 2)

    assert (event["kind"], event["certified"]) == ("flip", True)
    assert str(closed.evalf(30)).startswith(event["value"][:15])
    assert [branch["period"] for branch in found.document(15)["branches"]][:2] == [2, 4]
    assert event["born"] == 1


def test_the_command_says_the_same_and_checks_itself(tmp_path, capsys):
    out = tmp_path / "found.json"
    words = ["follow", "ellipse", "--a", "3/2", "--lam", "1/10:9/10", "--all", "--json", str(out)]

    assert main_of_app(words) == 0
    document = json.loads(out.read_text())
    assert [(one["period"], one["symmetry"], one["attracts"]) for one in document["branches"]] == [
        (2, "D2", [[0.1, 0.9]])
    ]
    assert document["check"]["accounted"] == 3200
    assert "3200 of 3200 random starts at 8 other values end on what is known" in capsys.readouterr().out


def main(values, starts, *names):
    """Prints for each scene the families, the events, and the cycles of a scan that belong to no branch."""
    for name in names or SCENES:
        scene, interval = SCENES[name]
        found = bifurcations(scene, **(interval or {"lam": ("0", "1")}))
        document = found.document(10)
        low, high = found.interval
        at = low + (high - low) * (np.arange(int(values)) + 0.3) / int(values)
        missing = unaccounted(document, scene, at, int(starts))
        said = f"{len(document['branches'])} families, {len(document['events'])} events"
        sys.stdout.write(f"{name}: {said}; on no branch: {missing or 'none'}; {found.check().words}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])

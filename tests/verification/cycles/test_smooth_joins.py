"""A join with equal tangents is no corner: cycles, branches and proofs do not depend on how a curve is cut."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner
from sympy import Rational, pi

from symbolic import Scene
from symbolic.cycles.polygons import saddle_node
from symbolic.tables.table import alpha as alpha_symbol
from verification.app.commands.follow import command as main_follow
from verification.app.commands.orbit import cycles_command
from verification.cycles.search import all_cycles
from verification.named.questions import PeriodicOrbit, certify, find_cycles, follow
from verification.proofs.periodic.completeness import no_others

WHOLE = Scene("ellipse", a="3/2", lam="1/2")
CUTS = [["0", "pi/2", "pi", "3*pi/2", "2*pi"], ["-3/10", "1", "2", "2*pi - 3/10"]]  # at the axes, and elsewhere


def boundary_of_arcs(formulas, ends, lam):
    """The boundary of one arc between each two neighbouring ends; the formulas are `(x, y)`, one pair for each arc."""
    parts = [
        {"name": f"arc {i}", "x": x, "y": y, "from": low, "to": high}
        for i, ((x, y), (low, high)) in enumerate(zip(formulas, pairwise(ends), strict=True))
    ]
    return Scene.of({"component": parts, "lam": lam})


def in_arcs(ends, lam="1/2"):
    """The ellipse with half axes 3/2 and 1, cut at these values of its parameter."""
    return boundary_of_arcs([("3*cos(theta)/2", "sin(theta)")] * (len(ends) - 1), ends, lam)


def by_radius(radii, ends, lam):
    """The boundary whose arcs have these polar radii."""
    return boundary_of_arcs([(f"{r}*cos(theta)", f"{r}*sin(theta)") for r in radii], ends, lam)


@pytest.mark.slow
def test_the_two_diameters_of_an_ellipse_of_24_points_are_found_on_its_knots(tmp_path):
    """A spline through evenly spaced points; on the short axis det M = lam**2, and both exponents are -log(2)/2."""
    path, found = tmp_path / "ellipse.csv", tmp_path / "cycles.json"
    turns = 2 * np.pi * np.arange(24) / 24
    np.savetxt(path, np.column_stack([1.5 * np.cos(turns), np.sin(turns)]), delimiter=",")
    given = ["--data", str(path), "--lam", "0.5", "--period", "2", "--json", str(found)]

    done = CliRunner().invoke(cycles_command, given)
    cycles = json.loads(found.read_text())["cycles"]

    assert done.exit_code == 0, done.output
    assert "period 2       2 cycles, index sums vanish" in done.output
    stable, saddle = sorted(cycles, key=lambda cycle: cycle["stability"])
    assert (stable["stability"], saddle["stability"]) == ("stable", "unstable")
    sizes = [abs(complex(m["real"], m["imaginary"])) for m in stable["multipliers"]]
    assert np.log(sizes) / 2 == pytest.approx([-np.log(2) / 2] * 2, abs=1e-9)
    assert not stable["one_sided"]


@pytest.mark.slow
@pytest.mark.parametrize("ends", CUTS)
def test_cycles_of_an_ellipse_in_several_arcs_are_those_of_the_ellipse(ends):
    found, whole = (find_cycles(scene, up_to=3) for scene in (in_arcs(ends), find_cycles(WHOLE, up_to=3)[0].scene))

    assert len(found) == len(whole) == 2
    for one, other in zip(*(sorted(each, key=lambda o: o.stability.value) for each in (found, whole)), strict=True):
        assert one.multipliers == pytest.approx(other.multipliers, abs=1e-9)
    assert found.searched.balanced == whole.searched.balanced


def halves(first, second, cuts=()):
    """Half ellipses of half axes 1 and, to the right, `first`, to the left `second`: joins at x = 0."""
    ends = ["-pi/2", *cuts, "pi/2", "3*pi/2"]
    axes = [first] * (len(ends) - 2) + [second]
    return boundary_of_arcs([(f"{a}*cos(theta)", "sin(theta)") for a in axes], ends, "1/2")


@pytest.mark.slow
@pytest.mark.parametrize("scene", [halves("3/2", 2), halves(2, "3/2"), halves("3/2", 2, ("1/5",))])
def test_a_cycle_on_two_joins_is_proved_and_attracts_whatever_the_cut(scene):
    """By the focal lengths the return contracts on all four sides; the image and the cut change nothing."""
    found = find_cycles(scene, period=2)
    (short,) = [orbit for orbit in found if orbit.one_sided]
    proof = certify(short, digits=20)

    assert found.searched.balanced == {2: True}
    assert short.stability.value == "stable"
    assert proof.certified
    assert proof.notes["stability"].startswith("attracts")
    assert abs(abs(Rational(proof.value)) - pi.evalf(40) / 2) <= Rational(proof.radius) + Rational(1, 10**39)


@pytest.mark.slow
@pytest.mark.parametrize("scene", [halves("3/2", 2), in_arcs(CUTS[1], "1/4")])
def test_that_cycles_are_all_is_proved_for_a_curve_of_several_pieces_and_not_without_one(tmp_path, scene):
    """A canary: with either of the two diameters left out the proof stays open."""
    path = tmp_path / "scene.toml"
    path.write_text(scene.text)
    done = CliRunner().invoke(cycles_command, ["--scene", str(path), "--period", "2", "--prove", "2"])
    lam = Rational(str(scene.lam))
    known = all_cycles(scene.table, lam, 2).catalogue

    assert "the 2 cycles of period 2 are proved to be all" in done.output
    for left in known.cycles:
        less = replace(known, cycles=[cycle for cycle in known.cycles if cycle is not left])
        assert no_others(less, lam, 2, budget=3000).complete is None


def test_a_saddle_on_joins_does_not_attract():
    """Half ellipses with one long axis, which ends on joins of two curvatures: det(1 - M) < 0 on every side."""
    scene = boundary_of_arcs(
        [("cos(theta)", y) for y in ("2*sin(theta)/3", "sin(theta)/2")], ["0", "pi", "2*pi"], "1/2"
    )
    found = find_cycles(scene, period=2)
    (level,) = [orbit for orbit in found if orbit.one_sided]

    assert "unstable, one-sided" in repr(level)
    assert certify(level, digits=15).notes["stability"].startswith("does not attract")


def bumped_egg(bump, mirrored=False):
    """The egg with a bump on one arc, to which it joins with its tangents: there the curvature jumps by it."""
    ends, egg = ["3/5", "5/2", "4", "2*pi + 3/5"], "1 + 2*cos(3*theta)/25"
    radii = [f"({egg} + ({bump})*(1 - cos(theta - 3/5))*(1 - cos(theta - 5/2)))", f"({egg})", f"({egg})"]
    if mirrored:
        radii = [r.replace("theta", "(-theta)") for r in reversed(radii)]
        ends = [f"-({end})" for end in reversed(ends)]
    return by_radius(radii, ends, "0.3783")


@pytest.mark.slow
@pytest.mark.parametrize(("bump", "what"), [("1/5", "persistence"), ("-1/2", "nonsmooth fold")])
def test_a_branch_goes_on_over_a_join_at_which_the_curvature_jumps(tmp_path, bump, what):
    """The fold is the egg's, and so is the cycle on the join; paper, section 6.4. The mirror image does the same."""
    egg = Scene("egg", alpha="2/25", lam="0.3783")
    triangle = PeriodicOrbit(egg, (0,) * 3, (0.56, 4.7487902, 2.6543951), (0.0,) * 3, (0.5j, -0.5j))
    whole = follow(triangle, lam=("0.37", "0.5")).branch
    seen = []
    for mirrored, start, parts in (
        (False, "6.8431853,4.7487902,2.6543951", "arc 2,arc 2,arc 1"),
        (True, "-6.8431853,-4.7487902,-2.6543951", "arc 0,arc 0,arc 1"),
    ):
        scene, file = tmp_path / "scene.toml", tmp_path / "branch.json"
        scene.write_text(bumped_egg(bump, mirrored).text)
        given = ["--scene", str(scene), "--start", start, "--components", parts, "--at", "0.3783"]
        done = CliRunner().invoke(main_follow, [*given, "--lam", "0.37:0.5", "--json", str(file)])
        (branch,) = json.loads(file.read_text())["branches"]
        seen.append([(event["event"], event["lam"], event.get("collision")) for event in branch["events"]])

        assert what in done.output
    first, said = min((value, said) for kind, value, said in seen[0] if kind == "border collision")
    fold = next(value for kind, value, _ in seen[0] if kind == "fold")

    assert said.startswith(what)
    assert any(np.min(np.abs(z[:-1] - 0.6)) < 1e-9 for z in whole.at(first))
    assert fold == pytest.approx(float(saddle_node().subs(alpha_symbol, Rational(2, 25))), abs=1e-9)
    for one, other in zip(sorted(seen[0]), sorted(seen[1]), strict=True):
        assert (one[0], one[2], one[1]) == (other[0], other[2], pytest.approx(other[1], abs=1e-9))


def egg_in_arcs(ends, alpha, lam):
    """The paper's egg, cut at these angles."""
    return by_radius([f"(1 + {alpha}*cos(3*theta))"] * (len(ends) - 1), ends, lam)


@pytest.mark.slow
def test_a_branch_passes_a_join_on_its_way_to_its_fold_which_is_proved_there():
    """A bounce of the triangle moves from 0.79 at lam = 1/2 to 0.55 at the fold (paper, section 6.4)."""
    scene = egg_in_arcs(["7/10", "5/2", "4", "2*pi + 7/10"], "2/25", "1/2")
    start = PeriodicOrbit(scene, (0, 2, 1), (0.7923155335, 4.9811057383, 2.8867106359), (0.0,) * 3, (0.5j, -0.5j))
    branch = follow(start, lam=("0.37", "1"))
    (fold,) = branch.folds
    found = certify(fold, digits=20)
    exact = saddle_node().subs(alpha_symbol, Rational(2, 25)).evalf(40)

    assert not branch.border_collisions
    assert min(fold.event.point.z[:-1]) < 0.7
    assert found.certified
    assert abs(Rational(found.value) - exact) <= Rational(found.radius) + Rational(1, 10**39)


@pytest.mark.slow
def test_a_doubling_of_a_cycle_on_two_joins_is_proved():
    """The egg's diameter from 0 to pi, both joins of one analytic curve (paper, section 6.3)."""
    scene = egg_in_arcs(["0", "pi", "2*pi"], "7/100", "1/10")
    whole = Scene("egg", alpha="7/100", lam="1/10")
    values = [
        certify(
            follow(PeriodicOrbit(one, parts, (0.0, np.pi), (0.0, 0.0), (0j, 0j)), lam=("0", "1")).flips[0], digits=20
        )
        for one, parts in ((scene, (0, 1)), (whole, (0, 0)))
    ]

    assert all(one.certified for one in values)
    assert values[0].value == values[1].value

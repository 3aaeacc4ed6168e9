"""Boundary crises by the independent checker: the saddle, its branch and the cells, step by step."""

from fractions import Fraction

import numpy as np
import pytest
from committed import document

from numeric import PinballMap

GIVEN = document("crisis-between")
TURN, LOW, HIGH = Fraction(1, 3), Fraction(3, 5), Fraction(663, 1000)


@pytest.fixture(scope="module")
def tables(check):
    """The table of the file in precisions of 64 and 256 bits."""
    scene = {key: x for key, x in GIVEN["scene"].items() if key != "lam"}
    return [check.read_scene(scene, "lam", bits)[0] for bits in (64, 256)]


@pytest.fixture(scope="module")
def branch(crisis, tables):
    saddle = crisis.continued(tables[0], TURN, LOW, LOW + Fraction(1, 10**6), GIVEN["saddle"]["start"][0])[0]
    return crisis.Branch(tables[1], TURN, LOW, saddle, crisis.SMALL)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"lam": ["663/1000", "3/5"]}, "out of range"),
        ({"lam": ["3/5", "1"]}, "out of range"),
        ({"lam": ["0", "3/5"]}, "out of range"),
        ({"lam": ["0.6", "663/1000"]}, "out of range"),
        ({"lam": ["3/5", "661/1000"]}, "name must be"),
        ({"side": -1}, "name must be"),
        ({"side": 2}, "out of range"),
        ({"sink": [0.0, float("nan")]}, "out of range"),
        ({"sink": [0.0, "0"]}, "out of range"),
        ({"start": 100.0}, "out of range"),
        ({"start": 10.0}, "out of range"),
        ({"sink": [-10.0, 0.0]}, "out of range"),
        ({"columns": True}, "out of range"),
        ({"rows": "512"}, "out of range"),
        ({"parts": 0}, "out of range"),
        ({"scene": GIVEN["scene"] | {"lam": "__import__('os')"}}, "characters that mean nothing"),
        ({"scene": GIVEN["scene"] | {"lam": "2"}}, "lam is out of range"),
        ({"schema": 2}, "schema 1"),
        ({"name": "boundary crisis"}, "name must be"),
        ({"proved_by": "me"}, "entries"),
        ({"scene": {"table": "ellipse", "shape": {"a": "2"}}}, "egg"),
        ({"scene": GIVEN["scene"] | {"law": "-lam*eta"}}, "egg"),
        ({"scene": GIVEN["scene"] | {"K": 4}}, "a turn of the table"),
        ({"saddle": GIVEN["saddle"] | {"shift": [1, 2]}}, "a turn of the table"),
        ({"saddle": GIVEN["saddle"] | {"shift": [3, 3]}}, "a turn of the table"),
        ({"saddle": GIVEN["saddle"] | {"sign": -1}}, "a turn of the table"),
        ({"saddle": GIVEN["saddle"] | {"start": [-0.2, 0.1]}}, "a turn of the table"),
    ],
)
def test_every_entry_is_looked_at(check, change, why):
    with pytest.raises(check.Wrong, match=f"{why}|not of its format"):
        check.checked(GIVEN | change)


@pytest.mark.parametrize(
    ("start", "low", "why"),
    [(-0.2079, LOW, "not where it is said"), (0.9, LOW, "not"), (-0.20795, Fraction(3, 10), "one cycle|not where")],
)
def test_a_saddle_that_is_another_or_none_is_refused(check, crisis, tables, start, low, why):
    """Below the fold at 0.37812 (the paper's 0.378) there is no triangle."""
    with pytest.raises((check.Unproved, ZeroDivisionError), match=why):
        crisis.continued(tables[0], TURN, low, HIGH, start)


def test_the_branch_grows_by_the_multiplier_of_the_saddle(crisis, tables, branch):
    """The multiplier is that of the float64 map's matrix of one bounce at the triangle of the vertices."""
    theta, psi = branch.theta.real(), branch.psi.real()
    step = PinballMap("egg", lam="0.6", alpha="0.08", kernels=False)
    ends = np.array([[1e-6, 0], [-1e-6, 0], [0, 1e-6], [0, -1e-6]])
    to = step.step(theta + ends[:, 0], psi + ends[:, 1])
    matrix = [[(x[0] - x[1]) / 2e-6, (x[2] - x[3]) / 2e-6] for x in (to.theta, to.phi)]
    multiplier = max(np.linalg.eigvals(np.array(matrix)).real)

    assert branch.grows.real() == pytest.approx(multiplier, rel=1e-8)
    assert float(branch.most) >= branch.grows.real()


@pytest.mark.parametrize("small", [1, 3])
def test_a_local_branch_that_is_too_large_is_not_proved(check, crisis, tables, branch, small):
    near = branch.theta.wide(check.I.of(Fraction(1, 2**30), branch.theta.p))
    with pytest.raises(check.Unproved):
        crisis.Branch(tables[1], TURN, LOW, near, small)
    with pytest.raises(check.Unproved, match="another"):
        crisis.Branch(tables[1], TURN, LOW, branch.theta.mid(), crisis.SMALL)
    with pytest.raises(check.Unproved, match="beyond"):
        branch.followed(check.I.of(branch.reach * 2, branch.theta.p), [(0, branch.theta)])


def test_a_piece_of_the_branch_holds_its_orbits(check, crisis, tables, branch):
    """Orbits of 16 points along the first piece in float64, whose errors are far smaller than the piece."""
    map = crisis.Grown(tables[0], check.I.of(LOW, 64), check.I.of(HIGH, 64), 3)
    theta, phi = next(branch.pieces(1, map))
    rounds = 1 + int(np.ceil(np.log(crisis.AWAY / float(branch.reach)) / np.log(float(branch.most))))
    x = float(branch.reach) * np.linspace(float(branch.most) ** (-1 / crisis.PIECES), 1, 16)
    at = branch.theta.real() + x, branch.psi.real() + x * branch.along.real()
    step = PinballMap("egg", lam="0.6", alpha="0.08", kernels=False)
    for _ in range(rounds):
        landed = step.step(*at)
        at = landed.theta, landed.phi
    turned = at[0] + 2 * np.pi * np.rint((theta.real() - at[0]) / (2 * np.pi))
    slack = 1e-16 / float(branch.reach) * 4  # of the start in float64, as much larger as the piece is

    assert np.all(np.abs(turned - theta.real()) < theta.width() / 2.0**257 + slack)
    assert np.all(np.abs(at[1] - phi.real()) < phi.width() / 2.0**257 + slack)
    assert theta.width() / 2**256 < 0.05


@pytest.mark.parametrize("entered", [True, False])
def test_an_orbit_along_the_branch_enters_all_cells_and_none_of_none(check, crisis, tables, entered):
    strip, start = check.I.of(HIGH, 64), GIVEN["saddle"]["start"][0]
    map = crisis.Grown(tables[0], check.I.of(LOW, 64).hull(strip), strip, 3)
    saddle = crisis.continued(tables[0], TURN, LOW, HIGH, start)[1]
    rough, last = (crisis.Branch(tables[0], TURN, HIGH, saddle, crisis.SMALL) for _ in range(2))
    cells = {(i, j) for i in range(crisis.GRID[0]) for j in range(crisis.GRID[1])} if entered else set()

    assert last.leaves(1, map, cells, rough, samples=2) is entered

"""Short curves at the cusp: each inequality can fail, and curves followed by an independent map obey the theorem."""

from dataclasses import replace

import numpy as np
import pytest
from sympy import Rational

from symbolic.cycles.cusp import expansion
from symbolic.tables.table import lam
from verification.proofs.global_dynamics.one_step import ONE_STEP

CONTRACTIONS = [k / 20 for k in range(1, 20, 2)]


CANARIES = [
    ({"share": Rational(1, 20_000)}, {"nears"}),  # the piece that lands is longer than it may be
    ({"share": Rational(1, 300)}, {"turns", "nears"}),
    ({"passing": Rational(3, 2)}, {"passes"}),  # what holds at S alone
    ({"landing": Rational(6)}, {"lands"}),
    ({"turn": Rational(1, 4)}, {"passes"}),
    ({"turn": Rational(1, 40)}, {"turns"}),
    ({"near": Rational(18)}, {"lands"}),
    ({"near": Rational(20)}, {"nears"}),
    ({"passing": Rational(27, 20)}, {"sums"}),
    ({"landing": Rational(9, 2)}, {"sums"}),
    ({"passing": -Rational(1)}, {"sums"}),  # stretches are positive: of long curves it would prove anything
    ({"landing": -Rational(1)}, {"sums"}),
]


def test_the_theorem_is_proved():
    assert ONE_STEP.proved


@pytest.mark.parametrize(("changes", "failing"), CANARIES)
def test_each_inequality_fails_by_its_data_and_no_other(changes, failing):
    assert {*replace(ONE_STEP, **changes).open} == failing


def bounced(half, phi, contraction):
    """The next half angle and exit angle, from the first zero ahead of a quartic in `exp(i*theta)`, by eigenvalues."""
    u = np.exp(2j * half)
    z, v = (1 + u) ** 2 / 2, -np.exp(3j * half - 1j * phi)
    w = v.conj()
    rest = [w, (w - v) / 2 - z * w + z.conj() * v, -v, -v / 2]  # of the powers 3 to 0, the leading one w/2
    companion = np.zeros((half.size, 4, 4), dtype=complex)
    companion[:, [1, 2, 3], [0, 1, 2]] = 1
    companion[:, 0] = -np.stack(rest, axis=1) / (w / 2)[:, None]
    ends = np.angle(np.linalg.eigvals(companion)) / 2
    for _ in range(6):  # of Newton's method on the boundary
        there, along = (1 + np.exp(2j * ends)) ** 2 / 2, 2j * np.cos(ends) * np.exp(3j * ends)
        off, speed = (((there - z[:, None]) * w[:, None]).imag, (along * w[:, None]).imag)
        ends = ends - np.where(np.abs(speed) > 1e-14, off / np.where(speed == 0, 1, speed), 0)
    ahead = (((1 + np.exp(2j * ends)) ** 2 / 2 - z[:, None]) * w[:, None]).real
    true = np.abs((((1 + np.exp(2j * ends)) ** 2 / 2 - z[:, None]) * w[:, None]).imag) < 1e-9
    first = np.argmin(np.where((ahead > 1e-6) & true, ahead, np.inf), axis=1)
    end = ends[np.arange(half.size), first]
    end = (end + np.pi / 2) % np.pi - np.pi / 2
    return end, contraction * np.arcsin(np.clip((v * (-1j) * np.exp(-3j * end)).real, -1, 1))


def least_expansion(contraction):
    """The theorem's lower bound for the expansion, in float64."""
    return float(expansion().subs(lam, Rational(contraction).limit_denominator(100)))


@pytest.mark.slow
@pytest.mark.parametrize("contraction", CONTRACTIONS)
def test_pieces_at_the_cusp_are_two_and_their_inverse_stretches_sum_to_less_than_one(contraction):
    """Curves across `phi = theta/2`, longer than the theorem requires, with slopes at both ends of the cone."""
    length = max((1 - contraction) ** 3 / 480, 1e-5)  # shorter ones are lost in roundings
    for half in np.linspace(-0.98, 0.98, 15) * contraction * np.pi / 2:
        for slope in (0.0, -contraction):
            u = (np.arange(-40, 40) + 0.5) / 80 * length
            end, _ = bounced(half + u / 3, half + slope * u, contraction)
            stretch = np.diff(end) / np.diff(u / 3)
            before, after = stretch[:39], stretch[40:]
            passes, lands = sorted([before.min(), after.min()])
            assert abs(np.diff(end)[39]) > 0.1  # it is cut there
            assert passes > 7 / 5
            assert lands > 5
            assert 1 / passes + 1 / lands < 1 / least_expansion(contraction)


@pytest.mark.slow
@pytest.mark.parametrize("contraction", CONTRACTIONS)
def test_long_curves_are_in_few_pieces_and_every_bounce_stretches_them(contraction):
    """The images of a horizontal line across the wall, for five bounces: pieces at most double and are monotone."""
    half = np.linspace(-1.5, 1.5, 20_001)
    phi, piece = np.full(half.size, 0.4 * contraction), np.zeros(half.size, dtype=int)
    for count in range(1, 6):
        end, phi = bounced(half, phi, contraction)
        whole = np.diff(piece) == 0
        cut = whole & (np.diff(end) < 0)
        assert np.all(np.diff(end)[whole & ~cut] >= np.diff(half)[whole & ~cut] * least_expansion(contraction) - 1e-9)
        piece = np.concatenate([[0], np.cumsum(~whole | cut)])
        half = end
        assert piece[-1] + 1 <= 2**count


@pytest.mark.slow
@pytest.mark.parametrize("contraction", CONTRACTIONS[::3])
def test_nearly_every_start_comes_near_the_cusp(contraction):
    """All but a few of the points of a line come within 0.25 of the cusp, in the half angle, in 400 bounces."""
    half, phi = np.linspace(-1.5, 1.5, 400), np.full(400, 0.3 * contraction)
    nearest = np.full(half.size, np.inf)
    for _ in range(400):
        half, phi = bounced(half, phi, contraction)
        nearest = np.minimum(nearest, np.pi / 2 - np.abs(half))
    assert np.mean(nearest > 0.25) < 0.02


@pytest.mark.parametrize("contraction", CONTRACTIONS[::3])
def test_flights_land_near_the_cusp_only_from_near_its_curve(contraction):
    """The law of sines for start, landing and cusp; of a line the points `e` from the curve have a share `O(e)`."""
    half, phi = np.linspace(-1.5, 1.5, 20_001), np.full(20_001, 0.3 * contraction)
    for _ in range(4):
        aim = phi - half
        share = np.array([np.mean(np.abs(aim) < e) / e for e in (0.1, 0.03, 0.01)])
        assert np.all(share < 3)
        end, out = bounced(half, phi, contraction)
        chord = np.abs(np.exp(4j * end) - np.exp(4j * half) + 2 * (np.exp(2j * end) - np.exp(2j * half))) / 2
        assert np.all(np.abs(chord * np.sin(aim) - 2 * np.cos(end) ** 2 * np.sin(2 * (end - half))) < 1e-8)
        half, phi = end, out

"""The loop around a step, on a step so simple that every number is known: a particle that drifts, and slows."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from numeric import PinballMap
from numeric.flights.family import Family, Landing
from numeric.kernels import engine as engines
from numeric.kernels.engine import Engine, _pieces
from numeric.kernels.machine import TANGENT, KernelSpec, starting

END = 4.0  # a particle beyond it is stopped with code 1


class Drift(Family):
    """`x -> x + pace*v`, `v -> lam*v`; flights have the length `v`, the boundary bends by `x`, `N0` is `2 + v`."""

    name = "drift"
    position, direction = ("x",), ("v",)
    renormalise_every = 3

    @classmethod
    def matches(cls, boundary):
        return False

    def enter(self, ops, component, theta):
        return [theta]

    def place(self, ops, position):
        return ops.number(0.0), position[0]

    def fly(self, ops, shape, law, position, exit):
        x = position[0] + shape[0] * exit[0]
        code = ops.select(ops.number(END) < x, ops.number(1.0), ops.number(0.0))
        return Landing([x], exit[0], exit[0] + ops.number(1.0), code if self.stops else None)

    def leave(self, ops, shape, law, lam, landing):
        return [lam * landing.across]

    def slapped(self, ops, shape, position):
        return [ops.number(0.0) * position[0]]

    def departure(self, ops, shape, position, exit):
        return exit[0] + ops.number(2.0)

    def kept(self, ops, shape, position):
        return [position[0] * ops.number(0.5)]

    def length(self, ops, shape, n0, start, end, landing):
        return (end[0] - start[0]) * ops.number(2.0)

    def bend(self, ops, shape, landing):
        return -landing.position[0], ops.number(4.0)


class Endless(Drift):
    """The same without outcomes."""

    name = "endless"
    stops = False


class Silent(Endless):
    """A family that has outcomes, but none under the law of the run, as ellipses at lam = 0."""

    name = "silent"
    stops = True

    def fly(self, ops, shape, law, position, exit):
        landing = super().fly(ops, shape, law, position, exit)
        landing.code = None
        return landing


@pytest.fixture(params=[True, False], ids=["lanes", "arrays"])
def ways(request):
    """An engine, of lanes or arrays, eight to a block."""
    return lambda family=None: Engine(family or Drift(), "a test's", ["pace"], request.param, 8)


def by_hand(x, v, lam, pace, bounces, end=END):
    """Places and paces, the bounces lost and the code, exactly."""
    states, lost, code = [(x, v)], 0, 0
    for _ in range(bounces):
        if code == 0 and x + pace * v > end:
            code = 1
        if code:
            lost += 1
        else:
            x, v = x + pace * v, lam * v
        states.append((x, v))
    return states, lost, code


COUNT = 19  # two whole blocks of eight, and three lanes more
START = np.linspace(-4, 9, COUNT), np.linspace(3, -2, COUNT)
LAM = 2.0 ** -(np.arange(COUNT) % 3)


@pytest.mark.parametrize("bounces", [1, 2, 7])
@pytest.mark.parametrize("family", [Drift(), Endless()], ids=["stopping", "endless"])
@pytest.mark.parametrize("threads", [1, 2, None])
def test_every_bounce_of_every_ball_is_recorded(ways, family, bounces, threads):
    result = ways(family).run(KernelSpec("pinball", record=True), START, LAM, [0.5], bounces, threads=threads)

    assert result.record.shape == (bounces, 2, COUNT)
    assert list(result.rows) == ["x", "v", *(["code", "lost"] if family.stops else [])]
    for i in range(COUNT):
        x, v = (float(row[i]) for row in START)
        states, lost, code = by_hand(x, v, float(LAM[i]), 0.5, bounces, END if family.stops else np.inf)
        assert [tuple(row) for row in result.record[:, :, i].tolist()] == states[1:]
        assert (result.rows["x"][i], result.rows["v"][i]) == states[-1]
        if family.stops:
            assert (result.rows["lost"][i], result.rows["code"][i]) == (lost, code)
    if family.stops and bounces == 7:
        assert set(result.rows["lost"]) > {0.0, 7.0}


def test_rows_of_outcomes_stay_empty_where_the_law_has_none(ways):
    silent, endless = (
        ways(family).run(KernelSpec("pinball"), START, LAM, [0.5], 7) for family in (Silent(), Endless())
    )

    assert not silent.rows["code"].any()
    assert not silent.rows["lost"].any()
    assert all(np.array_equal(silent.rows[name], row) for name, row in endless.rows.items())


def test_a_state_of_one_row_is_a_state(ways):
    result = ways(Endless()).run(KernelSpec("slap", record=True), START[:1], 0 * LAM, [0.5], 2)

    assert result.record.shape == (2, 1, COUNT)
    assert np.array_equal(result.rows["x"], START[0])


def test_a_run_without_a_record_ends_at_the_same_place(ways):
    with_record, plain = (ways().run(KernelSpec("pinball", record=r), START, LAM, [0.5], 7) for r in (True, False))

    assert plain.record is None
    assert all(np.array_equal(plain.rows[name], row) for name, row in with_record.rows.items())


@pytest.mark.parametrize("part", [1, 2 * 24 * 3, 2 * 24 * 3 + 1, 2 * 24 * 7, 10**6])
def test_records_in_parts_have_no_seam(ways, part, monkeypatch):
    whole = ways().run(KernelSpec("pinball", record=True), START, LAM, [0.5], 7)
    pages = []
    advance = Engine._advance

    def watched(self, *arguments):
        pages.append(arguments[5].shape)
        advance(self, *arguments)

    monkeypatch.setattr(engines, "PART", part)
    monkeypatch.setattr(Engine, "_advance", watched)
    parts = ways().run(KernelSpec("pinball", record=True), START, LAM, [0.5], 7)
    most = max(1, part // 48)

    assert np.array_equal(parts.record, whole.record)
    assert all(np.array_equal(parts.rows[name], row) for name, row in whole.rows.items())
    assert [page[0] for page in pages] == [min(most, 7 - done) for done in range(0, 7, most)]
    assert {page[1:] for page in pages} == {(2, 24)}


@pytest.mark.parametrize(("count", "width"), [(1, 8), (8, 8), (9, 16), (16, 16)])
def test_rows_are_padded_to_whole_blocks_with_the_last_ball(ways, count, width, monkeypatch):
    states = []
    monkeypatch.setattr(Engine, "_advance", lambda self, question, state, lam, *more: states.append((state, lam)))
    x = np.arange(1.0, count + 1)
    ways().run(KernelSpec("pinball"), [x, -x], x / 16, [0.5], 1)
    ((state, lam),) = states

    assert state.shape == (4, width)
    assert state[0].tolist() == [*x, *[count] * (width - count)]
    assert np.array_equal(state[1], -state[0])
    assert not state[2:].any()
    assert np.array_equal(lam, state[0] / 16)


@pytest.mark.parametrize(("registers", "width"), [(32, 32), (16, 16)])
def test_an_engine_has_the_lanes_of_its_family_and_of_the_processor_unless_told_otherwise(
    monkeypatch, registers, width
):
    monkeypatch.setattr("numeric.kernels.machine.wide", lambda: registers == 32)

    assert (Engine(Drift(), "", []).width, Engine(Drift(), "", [], lanes=4).width) == (width, 4)
    assert Engine(Drift(), "", [], kernels=False).width == 32


def test_the_bits_of_an_orbit_do_not_depend_on_the_lanes_that_a_processor_has(monkeypatch):
    told = []
    for registers in (32, 16):
        monkeypatch.setattr("numeric.kernels.machine.wide", lambda registers=registers: registers == 32)
        told.append(PinballMap("cuspless", lam=0.9).orbit(np.linspace(-2, 2, 37), 0.3, 20))

    assert all(np.array_equal(one, other, equal_nan=True) for one, other in zip(*told, strict=True))


@pytest.mark.parametrize("bounces", [1, 3, 4, 8])
@pytest.mark.parametrize("family", [Drift(), Endless()], ids=["stopping", "endless"])
def test_tangent_vectors_follow_the_derivative_matrix(ways, family, bounces):
    """By the formulas at the head of `numeric/flights/family.py`, in rational numbers."""
    x, v = np.array([-4.0, 0.0, 2.0, 3.5]), np.array([3.0, 1.0, -0.5, 2.0])
    lam, q, omega = np.array([0.5, 1.0, 0.25, 0.5]), np.array([1.0, 0.5, -2.0, 1.0]), np.array([-0.5, 2.0, 1.0, 1.0])
    tangent = starting(q, omega, v + 2)
    result = ways(family).run(KernelSpec("pinball", exponents=True), [x, v], lam, [0.5], bounces, tangent)
    end = END if family.stops else np.inf
    for i in range(4):
        states, lost, _ = by_hand(*(Fraction(float(a[i])) for a in (x, v, lam)), Fraction(1, 2), bounces, end)
        shift, turn, volume = Fraction(float(q[i])), Fraction(float(omega[i])), Fraction(1)
        for (x0, v0), (x1, v1) in pairwise(states[: bounces - lost + 1]):
            n1, n0 = v0 + 1, v1 + 2
            moved = shift + (x1 - x0) * turn
            shift, turn = -moved * n0 / n1, -(1 + lam[i]) * (-x1 / 4) * moved / n1 - Fraction(float(lam[i])) * turn
            volume *= n0 / n1
        rows = {name: float(row[i]) for name, row in result.rows.items()}
        scale = 2 ** rows["growth"] / rows["down"] * (-1) ** (bounces - lost)

        assert tuple(rows) == (*family.fields("pinball"), *(["code", "lost"] if family.stops else []), *TANGENT)
        assert (rows["x"], rows["v"]) == states[-1]
        assert rows["shift"] * scale == pytest.approx(float(shift), rel=1e-13)
        assert rows["omega"] * scale == pytest.approx(float(turn), rel=1e-13)
        assert rows["up"] / rows["down"] * 2 ** rows["volume"] == pytest.approx(float(volume), rel=1e-13)
        assert rows["n0"] == states[-1][1] + 2


@pytest.mark.parametrize("bounces", [1, 2, 3, 4, 6, 7])
def test_mantissas_are_looked_at_every_few_bounces_and_at_the_end(ways, bounces):
    """A vector of 2**150 that doubles at each bounce is brought back at the first look, and there its size is read."""
    start = [np.array([0.0]), np.array([0.0])]
    tangent = starting(np.array([2.0**150]), np.array([2.0**150]), np.array([2.0]))
    rows = ways().run(KernelSpec("pinball", exponents=True), start, np.array([1.0]), [0.5], bounces, tangent).rows

    assert rows["growth"][0] == 150 + min(bounces, 3)
    assert rows["shift"][0] / rows["down"][0] == 2.0 ** max(0, bounces - 3)


@pytest.mark.parametrize("kernels", [True, False])
def test_a_kernel_is_made_where_it_is_asked_for_and_only_there(kernels, monkeypatch):
    asked = []
    monkeypatch.setattr(
        "numeric.kernels.machine.compiled", lambda *key: asked.append(key)
    )  # and gives none, as without LLVM
    engine = Engine(Drift(), "a test's", ["pace"], kernels)
    result = engine.run(KernelSpec("pinball"), START, LAM, [0.5], 2)

    assert result.rows["x"][0] == by_hand(float(START[0][0]), float(START[1][0]), 1.0, 0.5, 2)[0][-1][0]
    assert len(asked) == kernels
    assert Engine(Drift(), "", []).kernels


def test_work_is_counted_in_bounces_of_lanes(monkeypatch):
    asked = []
    monkeypatch.setattr(engines, "_pieces", lambda *given: asked.append(given) or [(0, given[0])])
    Engine(Drift(), "a test's", ["pace"], lanes=8).run(KernelSpec("pinball"), START, LAM, [0.5], 7, threads=2)

    assert asked == [(3, 24 * 7, 2)]


def test_blocks_are_shared_out_in_consecutive_pieces(monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 4)
    worth = engines.WORTH_A_THREAD

    assert _pieces(7, 0, 1) == [(0, 7)]
    assert _pieces(7, 0, 3) == [(0, 2), (2, 4), (4, 7)]
    assert _pieces(2, 0, 9) == [(0, 1), (1, 2)]
    assert _pieces(5, 0, 0) == [(0, 5)]
    assert [len(_pieces(9, work, None)) for work in (0, worth - 1, worth, 2 * worth, 99 * worth)] == [1, 1, 2, 3, 4]
    assert len(_pieces(9, 0, 4)) == 4
    for count in (None, 1):
        monkeypatch.setattr("os.cpu_count", lambda count=count: count)
        assert _pieces(9, 99 * worth, None) == _pieces(9, worth, None) == [(0, 9)]
        assert len(_pieces(9, 0, 4)) == 4  # as many as were asked for
    monkeypatch.delattr("os.cpu_count")  # is not asked for what is worth no second thread
    assert _pieces(9, worth - 1, None) == [(0, 9)]

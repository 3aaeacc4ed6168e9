"""Sweeps: parts tile the grid, bits do not depend on the number of workers, a store is whole or refused."""

import numpy as np
import pytest
import xarray as xr
from stored import files
from sympy import Rational, cos

from numeric import PinballMap
from numeric.sweeps.cost import cost
from numeric.sweeps.fields import bifurcation
from numeric.sweeps.orbits import record
from numeric.sweeps.run import run
from numeric.sweeps.space import parameter_space
from numeric.sweeps.store import opened
from numeric.sweeps.sweep import Axis, Field, Sweep, text_of
from symbolic import Scene, tables
from symbolic.tables.table import theta

TIMES = Axis("x", np.arange(7.0), "1", "first factor", 3), Axis("y", np.arange(5), "1", "second factor", 2)


def product(part):
    rng = np.random.default_rng(part.seed)
    whole = np.multiply.outer(part.values["x"], part.values["y"])
    return {"product": whole, "noise": rng.normal(size=whole.shape), "sign": np.full(whole.shape, -1)}


def table(task=product, seed=1, axes=TIMES, **settings):
    fields = (
        Field("product", ("x", "y"), "float64", "1", "product of both"),
        Field("noise", ("x", "y"), "float64", "1", "random numbers"),
        Field("sign", ("x", "y"), "int8", "1", "what stands for a missing whole number, too"),
    )
    return Sweep("table", "Products", axes, fields, task, seed, "none", settings, 0, lambda: None)


def test_the_parts_tile_the_grid():
    found = run(table())

    assert np.array_equal(found.product, np.multiply.outer(np.arange(7.0), np.arange(5)))


def test_no_two_parts_share_their_random_numbers():
    noise = run(table()).noise.values

    assert np.unique(noise).size == noise.size
    assert not np.any(noise == run(table(seed=2)).noise.values)


@pytest.mark.parametrize("workers", [1, 3])
def test_the_bits_depend_on_no_number_of_threads(workers):
    sweep = parameter_space(np.array([0.06, 0.09]), np.array([0.3, 1.0]), starts=20, bounces=200, transient=50)

    assert run(sweep, workers=workers).identical(run(sweep, workers=2))


def test_the_bits_depend_on_no_order():
    sweep = table()
    backwards = {at: sweep.task(sweep.part(at)) for at in reversed(sweep.indices())}

    found = run(sweep)
    for at, arrays in backwards.items():
        for field in sweep.fields:
            assert np.array_equal(found[field.name].values[sweep.where(field, at)], arrays[field.name])


def test_a_store_says_what_it_holds(tmp_path):
    scene = text_of(Scene("egg", alpha="2/25"))
    sweep = bifurcation(scene, np.array([0.3, 0.4]), orbits=2, points=3, bounces=80, transient=10)
    kept = run(sweep, tmp_path / "store")

    read = xr.open_zarr(tmp_path / "store")
    assert read.identical(kept)
    assert read.load().identical(run(sweep))
    assert read.s.dims == ("lam", "orbit", "bounce")
    assert read.s.attrs["units"] == "length"
    assert read.attrs["scene"] == scene
    assert read.attrs["seed"] == 1
    assert "pinball-billiards" in read.attrs["versions"]


def test_a_part_that_equals_the_missing_value_is_not_done_twice(tmp_path):
    calls = []

    def counted(part):
        calls.append(part.at)
        return product(part)

    run(table(counted), tmp_path / "store")
    run(table(counted), tmp_path / "store")

    assert sorted(calls) == sorted(table().indices())


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (table(seed=2), "seed = 1 and not 2"),
        (table(bounces=3), "bounces = none and not 3"),
        (
            table(axes=(TIMES[0], Axis("y", np.arange(5) + 1, "1", "second factor", 2))),
            "y = 5 values from 0 to 4 and not 5 values from 1 to 5",
        ),
        (table(axes=(Axis("x", np.arange(7.0), "1", "first factor", 7), TIMES[1])), "parts of another size"),
    ],
    ids=["seed", "settings", "values", "chunks"],
)
def test_another_sweep_is_refused(tmp_path, other, said):
    run(table(), tmp_path / "store")
    before = files(tmp_path / "store")

    with pytest.raises(ValueError, match=said):
        run(other, tmp_path / "store")

    assert files(tmp_path / "store") == before


def test_a_directory_of_something_else_is_refused(tmp_path):
    (tmp_path / "letter.txt").write_text("keep me")

    with pytest.raises(ValueError, match="not a sweep of ours"):
        run(table(), tmp_path)

    assert files(tmp_path) == {"letter.txt": b"keep me"}


def test_a_second_driver_is_refused(tmp_path):
    with opened(table(), tmp_path / "store"), pytest.raises(ValueError, match="another process is writing to it"):
        run(table(), tmp_path / "store")


def test_the_cost_is_that_of_all_bounces():
    sweep = parameter_space(np.linspace(0, 0.1, 3), np.linspace(0, 1, 4), starts=5, bounces=100, transient=60)
    expected = cost(sweep, workers=2)

    assert expected.collisions == 3 * 4 * 5 * 160
    assert expected.parts == 3
    assert expected.bytes == run(sweep).nbytes
    assert expected.seconds == expected.collisions * expected.nanoseconds * 1e-9 / 2


def test_the_diagram_of_the_egg_doubles_its_period():
    # the paper: period 4 before lambda_3 = 0.372, period 8 after it (section 6.6)
    scene = text_of(Scene("egg", alpha="2/25"))
    found = run(bifurcation(scene, np.array([0.36, 0.38]), orbits=6, points=16, transient=20_000))

    points = [np.unique(np.round(one, 5)).size for one in found.theta.values[:, 0]]
    assert points == [4, 8]
    assert not found.chaotic.any()


def test_the_count_of_chaotic_orbits_is_the_paper_s_picture():
    # section 6.5: chaos at alpha = 0.08 within about [0.42, 0.66] and at lam = 1, none at alpha = 0
    found = run(parameter_space(np.array([0.0, 0.08]), np.array([0.1, 0.5, 1.0]), starts=20, bounces=2000))

    assert np.array_equal(found.chaotic.values > 0, [[False] * 3, [False, True, True]])
    assert np.all(found.nu_max.values >= found.nu_min.values)


class StoppedError(Exception):
    """Raised by a listener to stop a sweep halfway."""


WITHOUT_A_KERNEL = tables.polar(1 + Rational(3, 5) * cos(theta), name="limacon")


@pytest.mark.slow
@pytest.mark.parametrize(
    "map",
    [
        PinballMap("cuspless", lam=0.8),
        PinballMap("cardioid", lam=[[0.2, 0.9, 1.0]]),
        PinballMap("circle", lam=0.6, kernels=False),
        PinballMap(WITHOUT_A_KERNEL, lam=0.9),
    ],
    ids=lambda map: map.ir.table,
)
def test_an_orbit_that_was_stopped_goes_on_to_the_same_bits(tmp_path, map):
    start, stop = ([[0.5, 0.7, 2.0]], 0.25), 2  # on the cardioid the first one flies into the cusp
    asked = {"fields": ("s", "theta", "eta", "code"), "every": 2}

    def pulled(done, pieces):
        assert pieces == 4
        if done == stop:
            raise StoppedError

    with pytest.raises(StoppedError):
        record(map, tmp_path / "orbit", *start, 30, piece=12, tick=pulled, **asked)
    made = []
    found = record(map, tmp_path / "orbit", *start, 30, piece=12, tick=lambda *at: made.append(at), **asked)
    whole = map.orbit(*start, 30, **asked)

    assert made == [(i, 4) for i in range(stop + 1, 5)]
    assert found.bounce.values.tolist() == list(range(0, 31, 2))
    assert "checkpoint" not in found
    for name in asked["fields"]:
        assert np.array_equal(found[name].values, whole[name][:, 0], equal_nan=name == "eta")


def test_a_store_takes_no_other_orbit_and_is_made_whole_when_a_file_of_it_is_damaged(tmp_path):
    egg, path = PinballMap("egg", lam=0.5, alpha=0.08), tmp_path / "orbit"
    whole = record(egg, path, [0.1, 0.2], 0.3, 40, piece=20).theta.values
    with pytest.raises(ValueError, match="holds a sweep with theta = numbers with digest"):
        record(egg, path, [0.1, 0.25], 0.3, 40, piece=20)
    with pytest.raises(ValueError, match=r"holds a sweep with lam = 0\.5 and not 0\.6; resume"):
        record(egg.at(0.6), path, [0.1, 0.2], 0.3, 40, piece=20)
    (path / "theta" / "c" / "1" / "0").write_bytes(b"nothing")
    with pytest.warns(UserWarning, match="damaged"):
        again = record(egg, path, [0.1, 0.2], 0.3, 40, piece=20)

    assert np.array_equal(again.theta.values, whole)


def test_the_period_of_a_pair_is_that_of_the_cycle_which_attracts_there():
    """Egg at alpha = 2/25, paper section 6: period 4 at 0.25 and 0.32, and only the triangle at 0.9."""
    sweep = parameter_space(np.array([0.05, 0.08]), np.array([0.25, 0.32, 0.9]), starts=3, bounces=200, transient=2000)
    found = run(sweep, workers=1)

    assert found.period.values.tolist() == [[2, 2, 2], [4, 4, 3]]

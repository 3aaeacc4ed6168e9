"""`pinball sweep`, `bifurcation` and `basins`: their output as text and JSON, and their refusals."""

import json

import numpy as np
import pytest
import xarray as xr
from asking import refusal

from numeric.sweeps.fields import KINDS, basins, exponents
from numeric.sweeps.run import run
from symbolic import Scene
from verification.app.cli import main


def document(capsys, *arguments):
    assert main([*arguments, "--json", "-"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_a_bifurcation_diagram_as_json(capsys):
    found = document(
        capsys, "bifurcation", "egg", "--alpha", "0.08", "--lams", "0.1:0.3:3", "--orbits", "4", "--points", "8"
    )

    assert found["coords"]["lam"] == [0.1, 0.2, 0.3]
    assert found["scene"] == Scene("egg", alpha="0.08").text
    assert found["fields"]["phi"]["dims"] == ["lam", "orbit", "bounce"]
    assert found["fields"]["phi"]["units"] == "rad"
    phi = np.array(found["fields"]["phi"]["values"])
    assert phi.shape == (3, 4, 8)
    assert np.allclose(phi[..., :4], phi[..., 4:], atol=1e-6)  # the paper: period 4 at alpha = 0.08 and small lam


@pytest.mark.slow
def test_basins_of_the_cuspless_table_are_those_of_period_2_and_of_chaos(capsys):
    # the paper, section 5.2: at lam = 0.09 a period-2 and a chaotic attractor coexist
    found = document(capsys, "basins", "cuspless", "--lam", "0.09", "--columns", "12", "--rows", "9")

    kinds = {(a["kind"], a["period"]) for a in found["settings"]["attractors"]}
    assert kinds == {("chaotic", 0), ("cycle", 2)}
    assert set(np.ravel(found["fields"]["label"]["values"])) == {0, 1}
    assert np.allclose(found["coords"]["sin_phi"], (np.arange(9) - 4) / 4.5)


@pytest.mark.slow
def test_basins_have_the_symmetry_of_the_table():
    # y -> -y maps (s, phi) to (-s, -phi), and swaps or keeps attractors
    found = run(basins(Scene("cuspless").text, 0.09, 40, 30, starts=200))

    label = found.label.values
    assert np.mean(label == label[::-1, ::-1]) > 0.98  # rounding decides where basins are thinner than a cell


def test_a_window_of_phase_space(tmp_path, capsys):
    store = str(tmp_path / "store")
    arguments = ["basins", "egg", "--alpha", "0.08", "--lam", "0.7", "--columns", "8", "--rows", "4", "--store", store]
    assert main([*arguments, "--window", "-1", "1", "0", "0.5"]) == 0

    said = capsys.readouterr().out
    assert "cycle of period 3" in said
    read = xr.open_zarr(store)
    assert read.s.values.tolist() == [-0.875, -0.625, -0.375, -0.125, 0.125, 0.375, 0.625, 0.875]
    assert read.sin_phi.values.tolist() == [0.0625, 0.1875, 0.3125, 0.4375]
    assert main([*arguments, "--window", "-1", "1", "0", "0.5"]) == 0
    assert "1 of 1 parts were there" in capsys.readouterr().out


@pytest.mark.slow
def test_exponents_of_each_attractor_obey_the_sum_rule_of_the_ellipse():
    # the period-2 orbit has det DT^2 = lam^2, so the exponents add up to log(lam)
    found = run(exponents(Scene("ellipse", a="2").text, np.array([0.3, 0.6])))

    assert found.orbits.values[:, 0].tolist() == [100, 100]
    assert [KINDS[int(kind)].name for kind in found.kind.values[:, 0]] == ["CYCLE", "CYCLE"]
    assert np.allclose(found.total.values[:, 0], np.log([0.3, 0.6]), rtol=0, atol=1e-10)
    assert np.isnan(found.nu_plus.values[:, 1]).all()


@pytest.mark.slow
def test_attractors_are_not_averaged_together(capsys):
    # the paper, section 6.7: chaos and period 3 coexist at alpha = 0.08, lam = 0.5
    assert main(["sweep", "exponents", "egg", "--alpha", "0.08", "--lams", "0.5", "--orbits", "60"]) == 0

    lines = capsys.readouterr().out.splitlines()[1:]
    periods = [line.split()[2] for line in lines]
    assert periods[:3] == ["-", "3", "3"]
    assert float(lines[0].split()[3]) > 0.1
    assert all(float(line.split()[3]) < 0 for line in lines[1:])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("sweep nothing", "accepted: parameter-space, exponents, bifurcation, basins"),
        ("sweep", "Missing command"),
        ("basins cuspless --lam 0.1 --columns 2 --rows 2 --window 1 0 0 1", "window"),
        ("bifurcation --polar 1+b*cos(theta) --shape b=0:2:3 --lams 0.3", "is not positive at"),
        ("bifurcation --polar 1 --shape b=0:2:3 --lams 0.3", "polar: no shape parameter b; it has: none"),
        ("bifurcation egg --shape alpha=0:0.1:3 --lams 0:1:3", "both vary; accepted: one number"),
        ("sweep parameter-space egg --alpha 0.1 --lams 0.3", "one shape parameter must vary; accepted: --alphas"),
        ("bifurcation circle --shape b=0:2:3 --lams 0.3", "b = 0 is no shape parameter"),
        ("bifurcation egg --alpha 1/2 --lams 0.3", "alpha must lie in [0, 1/10]"),
        ("sweep parameter-space --alphas 0:0.2:3 --lams 0.3", "in [0, 1/10]"),
        ("sweep parameter-space --alphas 0.1 --lams 0.3 --store /dev/null", "is not a sweep of ours"),
    ],
)
def test_bad_input_is_one_sentence(arguments, said, capsys):
    assert said in refusal(capsys, *arguments.split())


@pytest.mark.slow
def test_a_dry_run_of_basins_looks_for_no_attractor(capsys):
    arguments = ["basins", "cuspless", "--lam", "0.09", "--columns", "1000", "--rows", "1000", "--dry-run"]
    found = document(capsys, *arguments)
    assert found["collisions"] == 10**9
    assert found["bytes"] == 2 * 10**6 + 2 * 8 * 1000


@pytest.mark.slow
def test_a_parameter_of_ones_own_is_swept_like_the_egg_s(capsys):
    # the egg written as a table of one's own: the same particles, the same attractors
    chosen = ["--lams", "0.5", "--orbits", "3", "--points", "4", "--bounces", "40", "--transient", "200"]
    own = document(capsys, "bifurcation", "--polar", "1 + b*cos(3*theta)", "--shape", "b=0.05:0.08:2", *chosen)
    egg = document(capsys, "bifurcation", "egg", "--shape", "alpha=0.05:0.08:2", *chosen)

    assert own["coords"]["b"] == egg["coords"]["alpha"] == [0.05, 0.08]
    assert own["fields"]["phi"]["dims"] == ["b", "orbit", "bounce"]
    assert own["settings"]["lam"] == 0.5
    own_phi, phi = (np.array(found["fields"]["phi"]["values"])[0] for found in (own, egg))
    assert np.allclose(own_phi, phi, rtol=0, atol=1e-9)  # of period 2; the other shape is chaotic


@pytest.mark.slow
def test_a_parameter_of_a_law_is_swept():
    # the period-2 orbit on the minor axis has det DT^2 = sigma^2, with the law's slope sigma = 1/2 + 2*b at 0
    scene = Scene("ellipse", a="2", law="-lam*eta - b*sin(2*eta)", lam="1/2", b="0:0..1/10")
    found = run(exponents(scene.text, np.array([0.1]), orbits=4, groups=1, parameter="b", lam=0.5))

    assert found.total.dims == ("b", "group")
    assert np.allclose(found.total.values[:, 0], np.log([0.7]), rtol=0, atol=1e-9)


def test_the_plane_of_a_parameter_of_a_scene_and_the_contraction(capsys):
    arguments = ["sweep", "parameter-space", "egg", "--shape", "alpha=0.02:0.1:2"]
    assert main([*arguments, "--lams", "0.2:0.21:11", "--starts", "5"]) == 0

    assert capsys.readouterr().out.splitlines()[:5] == [
        "alpha down, lam from 0.2 to 0.21 across, printed above each |; # chaos, . none",
        "lam        0.2       0.21",
        "alpha      |         |",
        "0.02       ...........",
        "0.1        ###########",
    ]


@pytest.mark.parametrize("name", ["orbit.npz", "orbit.zarr"])
def test_an_orbit_goes_into_a_table_whole_and_the_answer_holds_its_beginning(capsys, tmp_path, name):
    asked = ["orbit", "cuspless", "--lam", "1/2", "--start", "0.3,0.2", "--bounces", "300"]
    whole = document(capsys, *asked)["bounces"]
    said = document(capsys, *asked, "--out", str(tmp_path / name))
    found = np.load(tmp_path / name) if name.endswith("npz") else xr.open_zarr(tmp_path / name)

    assert said["bounces"] == whole[:40]
    assert said["last"] == "regular"
    for key in ("theta", "x", "y", "phi"):
        assert np.asarray(found[key]).ravel().tolist() == [entry[key] for entry in whole]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--out", "orbit.txt"], "--out orbit.txt: accepted: a name that ends in .csv, .npz, .parquet or .zarr"),
        (
            ["--out", "orbit.npz", "--arithmetic", "arb"],
            "--out orbit.npz holds float64 columns; accepted: --arith",
        ),
        (["--out", "nowhere/o.npz"], "--out nowhere/o.npz: there is no directory 'nowhere'; create it first"),
    ],
)
def test_a_table_of_an_orbit_that_cannot_be_written_is_refused_in_a_sentence(capsys, words, reason):
    orbit = ["orbit", "circle", "--lam", "1/2", "--start", "0.3,0.2", "--bounces", "3"]
    assert reason in refusal(capsys, *orbit, *words)

"""The figures: properties of their data, that all of them can be drawn, and sentences for bad requests."""

import json
import subprocess
import sys
import warnings

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from symbolic.cycles.cycle import discriminant, minor_axis
from symbolic.cycles.thresholds import stability_number, trace_of
from symbolic.tables import named
from symbolic.tables.geometry import evolute
from symbolic.tables.table import a, lam, theta
from verification.app.cli import main
from verification.paper.figures import basins, cardioid, circle_ellipse, egg
from verification.paper.figures.catalogue import pictures
from verification.plots.sheet import Curve

TINY = 0.02
LABELS = [  # every \label{fig:...} of the paper
    *("circle-ellipse-config", "ellipse-evals", "slap-ellipse"),
    *("cardioidAttractor", "cardioidLyapunovExponents", "cardioidSlap"),
    *("cuspless-attractors-config", "cardioid-attractors", "cuspless-period-4", "cardioid-basins"),
    *("cusplessLyapunovExponents", "cusplessSlap", "islands", "polar-slap", "period3", "polar-nonslap"),
    *("polar-phase-diag", "polar_attractors_config", "polar-attractors-phase", "bifn", "crisis", "intermingled"),
]
JOIN = 3**0.5 / 4


def crossings(curve: Curve) -> np.ndarray:
    """The places where a graph crosses the diagonal, by linear interpolation; jumps do not count."""
    gap = curve.y - curve.x
    i = np.flatnonzero(np.sign(gap[1:]) * np.sign(gap[:-1]) < 0)
    return curve.x[i] + (curve.x[i + 1] - curve.x[i]) * gap[i] / (gap[i] - gap[i + 1])


@pytest.mark.slow
@pytest.mark.parametrize("name", list(pictures()))
def test_every_figure_draws_without_a_warning(name):
    picture = pictures()[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        panels = picture.data(TINY)
        image = picture.image(panels, ".png")

    assert image.startswith(b"\x89PNG")
    assert json.loads(json.dumps(picture.document(panels, TINY), allow_nan=False))["panels"]


def test_the_names_cover_every_figure_of_the_paper():
    assert sorted(label for picture in pictures().values() for label in picture.labels) == sorted(
        f"fig:{label}" for label in LABELS
    )


def test_the_eigenvalues_multiply_to_the_square_of_lambda_and_are_those_of_the_stability_matrix():
    (panel,) = circle_ellipse.eigenvalues(0.1)
    lams, plus = panel.curves["mu_plus"]
    P = stability_number(minor_axis()).subs(a, 5)
    k = int(np.argmin(np.abs(lams - 0.2)))
    at = Rational(repr(float(lams[k])))
    trace = trace_of(P).subs(lam, at)

    assert np.allclose(plus * panel.curves["mu_minus"].y, lams**2, rtol=1e-12, atol=1e-15)
    assert plus[k] == pytest.approx(float((trace + discriminant(trace, at**2) ** Rational(1, 2)) / 2), rel=1e-12)
    assert np.allclose(plus[lams > panel.facts["lambda_minus"]], lams[lams > panel.facts["lambda_minus"]])


def test_the_second_slap_iterate_of_the_cardioid_meets_the_diagonal_at_the_vertical_orbit_alone():
    (panel,) = cardioid.slap()

    assert crossings(panel.curves["T_0^2"]) == pytest.approx([-2, 2], abs=1e-4)
    assert np.isnan(panel.curves["T_0^2"].y).sum() > 0  # jumps are gaps, not lines


def test_the_slap_iterates_of_the_cuspless_table_meet_the_diagonal_at_its_two_orbits_of_period_2_alone():
    (panel,) = cardioid.cuspless_slap()
    vertical = 2 - 9 * JOIN  # s = 2 of the cardioid, counted from the wall's centre

    for power in ("T_0^2", "T_0^4"):
        assert crossings(panel.curves[power]) == pytest.approx([vertical, 0, -vertical], abs=1e-4)


@pytest.mark.parametrize("iterate", [1, 2, 3, 4])
def test_the_graphs_of_the_egg_are_iterates_of_the_slap_map(iterate):
    panel = egg.slap(0.2)[1]
    x, y = panel.curves["T_0" if iterate == 1 else f"T_0^{iterate}"]
    some = np.flatnonzero(~np.isnan(y))[::7]
    image, map = x[some], PinballMap("egg", lam=0, alpha="0.08")
    for _ in range(iterate):
        image = map.slap(image).theta[1]

    assert np.max(np.abs(np.exp(1j * image) - np.exp(1j * y[some]))) < 1e-9


def test_no_slap_iterate_of_the_egg_has_period_3_and_the_fourth_has_more_points_than_the_second_at_008_only():
    left, right = egg.slap()
    counts = [[crossings(panel.curves[f"T_0^{n}"]).size for n in (2, 3, 4)] for panel in (left, right)]

    assert [third for _, third, _ in counts] == [0, 0]
    assert counts[0][2] == counts[0][0]
    assert counts[1][2] > counts[1][0]


def test_the_fourth_collision_touches_the_join_at_lambda_star_stays_off_below_and_passes_above():
    (panel,) = cardioid.corner(4.0)
    lowest = {name: float(curve.y.min()) for name, curve in panel.curves.items()}

    assert lowest["0.05"] > -JOIN + 0.02
    assert lowest["0.0712172"] == pytest.approx(-JOIN, abs=1e-3)
    assert lowest["0.09"] < -JOIN - 0.02


def test_each_triangle_obeys_the_collision_law_and_they_turn_counterclockwise():
    angles = [egg.triangle(name) for name in egg.TRIANGLES]
    lams = np.array([float(name) for name in egg.TRIANGLES])
    exit = np.pi / 3 * lams / (1 + lams)  # incidence and exit add up to pi/3
    orbit = PinballMap("egg", lam=lams, alpha="0.08").orbit(np.array(angles), exit, 3)

    assert np.max(np.abs(np.exp(1j * orbit.theta[3]) - np.exp(1j * orbit.theta[0]))) < 1e-12
    assert np.max(np.abs(orbit.phi[1] - exit)) < 1e-12
    assert np.all(np.diff(angles) > 0)


def test_the_projected_graph_keeps_off_the_diagonal_at_02_and_meets_it_at_03():
    (panel,) = egg.perturbed_slap(40.0)
    gap = {name: np.abs(np.exp(1j * curve.x) - np.exp(1j * curve.y)) for name, curve in panel.curves.items()}

    assert gap["0.2"].min() > 0.5
    assert gap["0.3"].min() < 0.01  # proved elsewhere: egg.projection_misses


def test_the_evolute_is_touched_by_the_flights_of_the_slap_map():
    for panel in circle_ellipse.evolutes(4.0)[:3]:
        x, y = (z.reshape(-1, 3)[:, :2] for z in panel.curves["flights"])
        along = np.stack([x[:, 1] - x[:, 0], y[:, 1] - y[:, 0]])
        along = along / np.hypot(*along)
        centre = panel.curves["evolute"]
        across = along[0][:, None] * (centre.y - y[:, :1]) - along[1][:, None] * (centre.x - x[:, :1])

        assert np.max(np.min(np.abs(across), axis=1)) < 1e-3


@pytest.mark.parametrize(("table", "shape"), [("ellipse", {"a": "1.2"}), ("cardioid", {})])
def test_centres_of_curvature_in_float64_are_those_of_the_exact_formula(table, shape):
    at = np.array([0.3, 1.1, -2.0])
    exact = evolute(named(table).at(**shape).components[0])
    x, y = circle_ellipse.centres(PinballMap(table, lam=0, **shape), at)

    for k, value in enumerate(at):
        expected = [float(z.subs(theta, Rational(float(value)))) for z in exact]
        assert [x[k], y[k]] == pytest.approx(expected, abs=1e-13)


def test_below_lambda_star_nothing_is_chaotic_and_above_lambda_c_everything_is():
    (panel,) = cardioid.cuspless_exponents(0.5)
    lams, share = panel.curves["chaotic_share"]

    assert np.all(share[lams < 0.0712] == 0)
    assert np.all(share[lams > 0.1] == 1)
    assert np.all(np.isnan(panel.curves["nu_plus_chaotic"].y[lams < 0.0712]))


def test_reflection_swaps_the_basins_of_the_two_triangles():
    panel = basins.egg(0.3)[0]
    labels, names = panel.raster.labels, panel.raster.names
    first, second = names.index("period 3"), names.index("period 3 (2)")
    mirrored = labels[::-1, ::-1].copy()
    mirrored[labels[::-1, ::-1] == first], mirrored[labels[::-1, ::-1] == second] = second, first

    assert {first, second, names.index("chaotic")} == set(np.unique(labels))
    assert np.mean(mirrored != labels) < 0.01


def test_the_list_and_the_data_alone_need_no_matplotlib():
    code = (
        "import sys; from verification.app.cli import main; "
        "status = [main(['figure', '--list']), main(['figure', 'cuspless-s4', '--json', '-'])]; "
        "sys.exit(any(status) or 'matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=600)

    assert done.returncode == 0, done.stderr
    assert "egg-basins" in done.stdout


def test_a_figure_goes_where_out_says_and_its_data_where_json_says(tmp_path, capsys):
    path, data = tmp_path / "graph.SVG", tmp_path / "graph.json"

    assert main(["figure", "cardioid-slap", "--out", str(path), "--json", str(data)]) == 0
    assert b"<svg" in path.read_bytes()[:1000]
    assert json.loads(data.read_text())["panels"][0]["curves"]["T_0^2"]["y"]
    assert str(path) in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["egg-slep"], "NAME = egg-slep is no figure; accepted: ellipse-configuration, "),
        ([], "NAME is missing; accepted: "),
        (
            ["egg-slap", "--out", "egg.jpg"],
            "--out = egg.jpg has the ending '.jpg'; accepted endings: .png, .svg, .pdf, .webp",
        ),
        (["egg-slap", "--out", "no/egg.png"], "--out = no/egg.png: there is no folder 'no'; create it first"),
        (["egg-slap", "--all"], "egg-slap and --all: name one figure, or ask for all"),
    ],
)
def test_a_bad_request_is_told_in_one_sentence(arguments, said, capsys):
    assert main(["figure", *arguments]) == 2
    assert said in capsys.readouterr().err

"""The public names of the three packages, and a script of an hour's work with them, at small sizes."""

import importlib
import pickle

import pytest
from hypothesis import given, settings
from matplotlib.figure import Figure

from numeric import PinballMap, attractors, basins, bifurcation_diagram, exponents, parameter_space
from symbolic import Scene, curvature, double_normals, generate, monodromy, multipliers, tables, thresholds
from verification import (
    certify,
    find_cycles,
    follow,
    laws,
    morse_graph,
    report,
    strategies,
    trapping_region,
    verify,
    work_precision,
)

FRONT = {
    "symbolic": "Scene Law tables curvature arc_length perimeter area derivative_matrix double_normals monodromy "
    "multipliers thresholds slap_map generate theta theta0 theta1 phi eta lam a alpha",
    "numeric": "PinballMap attractors basins exponents bifurcation_diagram parameter_space",
    "verification": "find_cycles follow certify locate check verify report work_precision trapping_region morse_graph "
    "ExactMap EnclosedMap laws strategies",
}
PEA = tables.polar("1 + b*cos(2*theta)", b="0:1/5")
AT = {"b": "1/10", "lam": "1/2"}
HERE = Scene(PEA, **AT)
SAID = {"a table": (PEA, AT), "a scene": (HERE, {}), "a map": (PinballMap(PEA, **AT), {})}


@pytest.mark.parametrize("package", FRONT)
def test_every_promised_name_is_at_the_front_and_on_the_page_of_help(package):
    module = importlib.import_module(package)
    lines = [line.split(maxsplit=1) for line in (module.__doc__ or "").splitlines() if line.startswith("    ")]
    page = {line[0].partition("(")[0]: line[1] for line in lines if len(line) == 2}

    for name in FRONT[package].split():
        assert name in dir(module)
        assert getattr(module, name) is not None
        assert page[name]
    assert not [name for name in dir(module) if not name.startswith("_") and name not in module.__all__]


def test_a_table_of_ones_own_is_derived():
    long, short = double_normals(PEA)
    found = thresholds(short)

    assert {letter.name for letter in curvature(PEA).free_symbols} == {"theta", "b"}
    assert monodromy(short).shape == (2, 2)
    assert len(multipliers(long)) == 2
    assert set(found) == {"flip", "focus"}
    assert abs(float(generate(curvature(PEA), "arb")(0, 0).mid()) + 1) < 1e-12  # a circle


@pytest.mark.parametrize("said", SAID)
def test_an_orbit_goes_where_people_take_it(said):
    table, numbers = SAID[said]
    orbit = PinballMap(table, **numbers).orbit(theta=0.3, phi=0.2, bounces=100)

    assert {orbit.map} == {PinballMap(HERE)} != {PinballMap(HERE, kernels=False)}
    assert orbit == PinballMap(PEA, b=0.1, lam=0.5).orbit(0.3, 0.2, 100)
    assert orbit != PinballMap(PEA, b=0.1, lam=0.4).orbit(0.3, 0.2, 100)
    assert orbit.to_xarray().sizes["bounce"] == len(orbit.to_pandas()) == 101
    assert orbit.plot().axes
    assert repr(orbit) == "Orbit(100 bounces of 1 particle)"


@pytest.mark.parametrize("said", SAID)
def test_attractors_are_found_from_whatever_says_a_table(said):
    table, numbers = SAID[said]
    (found,) = attractors(table, **numbers, orbits=20, seed=1)

    assert (found.period, found.share.count) == (2, 20)
    assert repr(found).startswith("Attractor(period 2, 83.9% to 100.0% of the starts, nu_plus = -0.")


GRIDS = {
    "attractors": lambda: attractors(PEA, **AT, orbits=20),
    "basins": lambda: basins(PEA, **AT, columns=6, rows=4, orbits=10, transient=200),
    "exponents": lambda: exponents(PEA, **AT, orbits=4, bounces=200),
    "diagram": lambda: bifurcation_diagram(
        PEA, b="1/10", lam=("0.2", "0.6"), values=3, orbits=2, points=5, bounces=64, transient=64
    ),
    "space": lambda: parameter_space(
        PEA, b=("0", "1/5"), lam=("0.2", "0.6"), columns=3, rows=2, orbits=2, bounces=64, transient=64
    ),
}


@pytest.mark.parametrize("question", GRIDS)
def test_results_draw_themselves_compare_and_are_pickled(question):
    found = GRIDS[question]()
    axes = Figure().add_subplot()

    assert found == pickle.loads(pickle.dumps(found))
    assert found.plot().axes
    assert found.plot(axes=axes) is axes.figure
    assert axes.has_data()
    assert "\n" not in repr(found)


def test_a_branch_of_a_cycle_is_followed_drawn_and_its_fold_proved():
    triangle = find_cycles("egg", alpha="2/25", lam="1/2", period=3).stable[0]
    branch = follow(triangle, lam=("0.37", "0.6"))
    proof = certify(branch.folds[0], digits=30)

    assert proof.certified
    assert proof.value.startswith("0.37812125259009023575")  # the closed form of section 6.4
    assert certify(triangle, digits=20).certified
    assert branch.plot().axes
    assert "\n" not in repr(branch) + repr(proof) + repr(proof.proof)
    again = pickle.loads(pickle.dumps(proof))
    assert (again.value, again.certified) == (proof.value, True)
    assert again.proof.value.mid() == proof.proof.value.mid()


@pytest.mark.parametrize("said", SAID)
def test_cycles_are_found_from_whatever_says_a_table(said):
    table, numbers = SAID[said]
    found = find_cycles(table, **numbers, period=2)

    assert len(found.stable) == len(found.unstable) == 1
    assert found == pickle.loads(pickle.dumps(found))


test_the_derivative_of_a_table_of_ones_own = laws.jacobian(PEA, max_examples=5, derandomize=True, database=None)


@settings(max_examples=3, derandomize=True, database=None, deadline=None)
@given(strategies.particles(PEA))
def test_a_drawn_table_has_a_letter_within_its_range(particle):
    assert 0 <= particle.map.exact_shape[0] <= 1 / 5


@pytest.mark.parametrize("question", ["step", "jacobian", "orbit", "cycle", "exponent"])
def test_errors_are_measured_against_run_time_for_ones_own_scene(question):
    found = work_precision(PEA, question, **AT, runs=1, digits=20)

    assert {"float64", "mpmath", "arb"} <= {row.arithmetic for row in found.rows}
    assert all(row.kept for row in found.rows if row.proved)
    assert min(row.error for row in found.rows if row.arithmetic == "float64") < 1e-12
    assert all(row.error < 1e-14 for row in found.rows if row.digits == 16)
    assert found.plot().axes


def test_what_traps_all_orbits_is_proved():
    found = trapping_region("ellipse", a="3/2", lam="1/2", columns=64, rows=32)

    assert all(found.checks.values())
    assert found == pickle.loads(pickle.dumps(found))
    assert len(morse_graph("ellipse", a="3/2", lam="1/2", columns=64, rows=32).attracting) == 1


def test_a_report_of_ones_own_table_is_one_page(tmp_path):
    made = report(PEA, b="1/10", minutes=0.01, out=tmp_path / "pea.html")

    assert (tmp_path / "pea.html").read_text().startswith("<!doctype html>")
    assert len(repr(made)) < 200


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: find_cycles(PEA, b=0.1, lam="1/2", period=2), "b = 0.1 is a rounded float; write it exactly, as the"),
        (lambda: find_cycles(PEA, b="1/10", lam=0.5, period=2), "lam = 0.5 is a rounded float; write it exactly, as"),
        (lambda: Scene("egg", alpha=0.08), "alpha = 0.08 is a rounded float; write it exactly, as the text '0.08'"),
        (lambda: report(PEA, b=0.1), "b = 0.1 is a rounded float; write it exactly"),
        (lambda: work_precision(PEA, "step", b=0.1), "b = 0.1 is a rounded float; write it exactly"),
        (lambda: trapping_region(PEA, b="1/10", lam=0.5), "lam = 0.5 is a rounded float; write it exactly"),
        (lambda: find_cycles(3, period=2), "3 is no table; accepted: a table, a scene, a map"),
        (lambda: find_cycles(PEA, period=2), "the shape parameter b needs a value"),
        (lambda: attractors(PEA, lam="1/2"), "the shape parameter b needs a value"),
        (lambda: follow(PEA, lam=("0", "1")), "follow: Table given; accepted: a cycle"),
        (lambda: follow(find_cycles(HERE, period=2)[0], lams=("0", "1")), "lam, b; did you mean lam?"),
        (lambda: bifurcation_diagram("egg", lams=(0, 1)), "no shape parameter lams; it has: alpha; did you mean lam?"),
        (lambda: certify(PEA), "certify: Table given; accepted: a cycle"),
        (lambda: work_precision(PEA, "leap", **AT), "question = 'leap'; accepted: step, jacobian, orbit, cycle, fold"),
        (lambda: laws.jacobian(["egg", "eg"]), "no table is called 'eg'; accepted: circle"),
        (lambda: Scene(tables.polar), "polar: a call of it makes no table"),
        (lambda: HERE.save("/no/such/folder/pea.toml"), "cannot be written"),
        (lambda: verify(claims="nodir"), "there is no folder 'nodir'; accepted: a folder with a paper.toml"),
        (lambda: PinballMap("circle", lam=[0.1, 0.2]).scene, "lam has 2 values; a scene has one contraction"),
    ],
)
def test_what_is_no_answer_is_one_sentence(ask, said):
    with pytest.raises(ValueError, match=r".") as caught:
        ask()
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_table_may_be_said_by_the_function_that_makes_it(tmp_path):
    egg = Scene(tables.egg, alpha="2/25", lam="1/2")
    egg.save(tmp_path / "egg.toml")

    assert egg == Scene("egg", alpha="2/25", lam="1/2") == Scene.load(tmp_path / "egg.toml")
    assert Scene("square", side="1/2").table == tables.square("1/2")
    assert PinballMap(tables.egg, alpha=0.08, lam=0.5).scene == egg

# `make verify` judges the paper, `make test` tests the package; both make .venv first.
# `make test` runs lint and all tests but those marked slow, in a few minutes on two cores once all is installed; these
# are `make slow`.
# On another machine: make PYTHON=python3.12, make test JOBS=8.

PYTHON ?= python3
JOBS ?= auto
VENV := .venv
BIN := $(VENV)/bin

.PHONY: verify test slow golden browser check-all formal lint docs dist letter bench torture clean
.DELETE_ON_ERROR:
# Compiled modules are kept, whatever the environment says: otherwise each command that a test runs compiles all anew.
unexport PYTHONDONTWRITEBYTECODE

# Open claims are a result (exit status 1); a run that wrote no report is a failure.
verify: $(VENV)/main.stamp
	@rm -f report/report.json
	@status=0; $(BIN)/pinball verify --report report --work benchmarks/records/work_precision.json || status=$$?; \
	test $$status -le 1 && test -f report/report.json

# Each process begins with its own part of the files, so that what a file computes for several tests is computed once;
# one that is done takes over tests of another.
PYTEST := $(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal

test: lint
	$(PYTEST) -m "not slow"

slow: $(VENV)/test.stamp
	$(PYTEST) -m slow $$(grep -rl --include='test_*.py' 'mark\.slow' tests)

# Writes anew what the package says today, which `make test` compares: a change is a line of a difference.
golden: $(VENV)/test.stamp
	$(BIN)/python tests/test_golden.py

# The pages, those of the docs too, in a headless Chromium, which must be on the path or named by CHROMIUM.
browser: $(VENV)/test.stamp $(VENV)/browser.stamp docs
	$(BIN)/python -m pytest -q tests/browser

# The certificates of the report, by the second reader: Python alone, nothing of this package. A few minutes. Then
# whether each number that report and pages call certified has one.
check-all:
	@ls certificates/*.json | xargs -n 1 -P $$(getconf _NPROCESSORS_ONLN) $(PYTHON) -I -S certificates/check.py
	@$(PYTHON) -S certificates/printed.py --prove

# The theorems in Coq. Nothing is installed: where Coq is missing, one sentence says what is needed.
formal:
	@$(PYTHON) formal/check.py

# Before: the table IRs that come with the package, made anew where their sources changed; commit them.
lint: $(VENV)/test.stamp
	$(BIN)/python -m numeric.lowering.shipped
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(VENV)/docs.stamp
	$(BIN)/sphinx-build -q -W -b html docs docs/_build

# The wheel, installed by itself in an empty environment, and not the checkout, must answer.
dist: $(VENV)/dist.stamp
	rm -rf dist
	$(BIN)/python -m build --outdir dist .
	$(PYTHON) -m venv --clear dist/try
	dist/try/bin/python -m pip install --quiet dist/*.whl
	cd dist/try && bin/pinball locate lambda-c --digits 20 && bin/pinball verify --only 'ellipse.*' --report report

# The letter to the authors, of two pages at most, and the tables of a report, where LaTeX is.
REPORT := report
letter:
	cd $(REPORT) && pdflatex -halt-on-error letter.tex | grep -E 'letter.pdf .[12] pages?,' && pdflatex -halt-on-error -jobname tables \
	  '\documentclass{article}\usepackage{booktabs,longtable}\begin{document}\input{report}\end{document}' | grep 'tables.pdf '

# What moved since the dossier was measured; a machine that is busy moves something, and that is no failure.
bench: $(VENV)/bench.stamp
	-$(BIN)/pinball bench --compare benchmarks/records/bench.json
	-$(BIN)/python benchmarks/work_precision.py --compare
	-$(BIN)/python benchmarks/extremes.py --check

# Half an hour of attacks on two free cores, without `processors`, which is asked by name; see docs/reliability.md.
torture: $(VENV)/test.stamp
	$(BIN)/python benchmarks/torture.py

clean:
	rm -rf $(VENV) report dist docs/_build docs/jupyter_execute .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# A stamp is a finished installation; it is made again when pyproject.toml changes.
$(VENV)/main.stamp: extras := [plot,sweep]
$(VENV)/test.stamp: extras := [test]
$(VENV)/bench.stamp: extras := [bench]
$(VENV)/docs.stamp: extras := [docs,plot,sweep]
$(VENV)/dist.stamp: extras := [dist]
$(VENV)/browser.stamp: extras := [browser]

$(VENV)/%.stamp: pyproject.toml $(VENV)/made.stamp
	$(BIN)/python -m pip install --quiet --editable ".$(extras)"
	@touch $@

$(VENV)/made.stamp:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("Python 3.11 or later is needed: make PYTHON=...")'
	$(PYTHON) -m venv $(VENV)
	@touch $@

# Both targets work as the first command in a fresh clone with only Python 3.11+ and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# One more than cores: some tests wait for a browser, a cluster or a clock.
WORKERS = $(shell $(PYTHON) -c "import os; print((os.cpu_count() or 1) + 1)")
# Asserts that pytest rewrites are kept beside the tests; writing them anew costs a sixth of the inner loop.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test checked tested quick docs bench mutants clean

demo: $(VENV)/installed
	$(BIN)/regrasp demo

# With `make -j3 test docs` what takes one core goes on beside the tests, which take all there are.
test: checked tested

tested: $(VENV)/installed-dev
	$(BIN)/regrasp warm-up
	$(BIN)/pytest -n $(WORKERS) --dist worksteal

checked: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/regrasp demo -o $(VENV)/demo
	rm -rf $(VENV)/bench
	$(BIN)/regrasp bench --quick -o $(VENV)/bench
	$(BIN)/regrasp bench report $(VENV)/bench

# The inner loop: what a change most often breaks, about a minute on two cores.
quick: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/pytest -n auto -m "not slow"

# The site, for a browser without a network: .venv/site/index.html. Warnings are errors.
docs: $(VENV)/installed-dev
	$(BIN)/sphinx-build --quiet --fresh-env --nitpicky --fail-on-warning --keep-going -c docs/site . $(VENV)/site
	$(BIN)/python docs/site/check.py $(VENV)/site

bench: $(VENV)/installed-dev
	$(BIN)/python benchmarks/speed/closed_form.py
	$(BIN)/python benchmarks/speed/programs.py
	$(BIN)/python benchmarks/speed/felt.py
	$(BIN)/python benchmarks/speed/regrasps.py
	$(BIN)/python benchmarks/speed/space.py
	$(BIN)/regrasp bench --settings default --settings mid --settings high --repeat 3 --time-limit 5 -o benchmarks/solvers
	$(BIN)/regrasp bench report benchmarks/solvers

# Hours; goes on where it was ended. `make mutants AREAS=verification` does one.
mutants: $(VENV)/installed-dev
	$(BIN)/python benchmarks/mutants $(AREAS)

$(VENV)/installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip
	$(BIN)/pip install --quiet -e .
	touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(BIN)/pip install --quiet -e ".[dev]"
	touch $@

clean:
	rm -rf $(VENV) regrasp-demo

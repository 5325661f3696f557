# `make build` and `make test` need python3 with its venv, and make; everything else comes into .venv, pinned. `make bench`
# adds gcc's figures where arm-none-eabi-gcc is installed; `make prove` needs frama-c, clang with libFuzzer, and cppcheck.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# Tests and commands start many processes of Python: without bytecode on disk each compiles the whole toolkit again.
unexport PYTHONDONTWRITEBYTECODE

# The vocabulary, analysis, synthesis and emission: what `make quick` tests of them compiles nothing and is not `slow`.
QUICK := tests/analyse tests/synthesise tests/emit $(wildcard tests/test_*.py)

.PHONY: install build quick test test-all types tests test-whole test-kernels docs bench prove constraints machines clean

install: $(VENV)/.build

build: $(VENV)/.build
	$(BIN)/synth build

quick: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -q -n auto -m "not slow" $(QUICK)

# mypy runs on one core, beside the tests.
test: $(VENV)/.dev
	$(BIN)/ruff check .
	$(MAKE) --no-print-directory --jobs=2 types tests

types: $(VENV)/.dev
	$(BIN)/mypy

tests: $(VENV)/.dev
	$(BIN)/python -m pytest -n auto --dist loadfile -m "not whole"

# Whole campaigns and ensembles, studies, walks through the docs and other kernels beside what a change must pass.
test-all: test test-whole test-kernels docs

test-whole: $(VENV)/.dev
	$(BIN)/python -m pytest -n auto --dist loadfile -m whole

# The vocabulary, analysis and synthesis under two other kernels of OpenBLAS, which round otherwise.
test-kernels: $(VENV)/.dev
	$(BIN)/python -m tests.kernels

# The site, with its reference from the docstrings; a warning fails it.
docs: $(VENV)/.docs
	$(BIN)/python -m sphinx -q -W --keep-going -j auto -b html docs build/docs

bench: $(VENV)/.dev
	$(BIN)/synth cost
	$(BIN)/synth verify --target cortex-m4f
	$(BIN)/synth verify --target cortex-m7
	$(BIN)/python -m benchmarks.axes
	$(BIN)/python -m benchmarks.synthesis
	$(BIN)/python -m benchmarks.disk
	$(BIN)/python -m benchmarks.startup
	$(BIN)/python -m benchmarks.response
	$(BIN)/python -m benchmarks.simulation
	$(BIN)/python -m benchmarks.margins
	$(BIN)/python -m benchmarks.riccati
	$(BIN)/python -m benchmarks.glsdc

prove: $(VENV)/.dev
	$(BIN)/synth prove --whole

# Resolves every dependency for all served Pythons, and checks that each has wheels for all of them.
constraints:
	bash .ci/constraints

# Runs the commands of the README on stock systems; needs root and debootstrap.
machines:
	bash .ci/machines

# An environment that works keeps its Python, whatever PYTHON is. The build backend is installed first and build isolation is
# off, so that it too is the pinned one. Wheels alone: a pin without one for this Python is refused, not compiled.
$(VENV)/.build $(VENV)/.dev $(VENV)/.docs: $(VENV)/.%: pyproject.toml constraints.txt
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || { $(PYTHON) .ci/served.py && $(PYTHON) -m venv --clear $(VENV); }
	$(BIN)/python -m pip install --quiet -c constraints.txt --only-binary :all: setuptools
	$(BIN)/python -m pip install --quiet -c constraints.txt --only-binary :all: --no-build-isolation -e '.$(if $(filter-out build,$*),[$*])'
	touch $@

clean:
	rm -rf .venv build dist reports *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

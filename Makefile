# `make build` and `make test` need python3 and make alone; everything else comes into .venv, pinned. `make bench` adds
# gcc's figures where arm-none-eabi-gcc is installed; `make prove` needs frama-c, clang with libFuzzer, and cppcheck.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

# Tests and commands start many processes of Python: without bytecode on disk each compiles the whole toolkit again.
unexport PYTHONDONTWRITEBYTECODE

# The vocabulary, analysis, synthesis and emission: what `make quick` tests of them compiles nothing and is not `slow`.
QUICK := tests/analyse tests/synthesise tests/emit $(wildcard tests/test_*.py)

.PHONY: install build quick test types tests test-kernels docs bench prove clean

install: $(STAMP)

build: $(STAMP)
	$(BIN)/synth build

quick: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -q -n auto -m "not slow" $(QUICK)

# mypy runs on one core, beside the tests.
test: $(STAMP)
	$(BIN)/ruff check .
	$(MAKE) --no-print-directory --jobs=2 types tests

types: $(STAMP)
	$(BIN)/mypy

tests: $(STAMP)
	$(BIN)/python -m pytest -n auto --dist loadfile

# The vocabulary, analysis and synthesis under two other kernels of OpenBLAS, which round otherwise.
test-kernels: $(STAMP)
	$(BIN)/python -m tests.kernels

# The site, with its reference from the docstrings; a warning fails it.
docs: $(STAMP)
	$(BIN)/python -m sphinx -q -W --keep-going -j auto -b html docs build/docs

bench: $(STAMP)
	$(BIN)/synth cost
	$(BIN)/synth verify --target cortex-m4f
	$(BIN)/synth verify --target cortex-m7
	$(BIN)/python -m benchmarks.axes
	$(BIN)/python -m benchmarks.synthesis
	$(BIN)/python -m benchmarks.disk
	$(BIN)/python -m benchmarks.planar
	$(BIN)/python -m benchmarks.startup
	$(BIN)/python -m benchmarks.response
	$(BIN)/python -m benchmarks.simulation
	$(BIN)/python -m benchmarks.margins
	$(BIN)/python -m benchmarks.riccati
	$(BIN)/python -m benchmarks.glsdc
	$(BIN)/python -m benchmarks.hall
	$(BIN)/python -m benchmarks.hostile

prove: $(STAMP)
	$(BIN)/synth prove --whole

# The build backend is installed first and build isolation is off, so that it too is the pinned one.
$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet -c constraints.txt setuptools
	$(BIN)/python -m pip install --quiet -c constraints.txt --no-build-isolation -e '.[dev,docs]'
	touch $@

clean:
	rm -rf $(VENV) build dist reports *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

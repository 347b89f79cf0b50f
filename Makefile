# A machine with Python 3.11 or newer and make needs nothing else: every target installs what it uses into .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
READY_FOR_DOCS := $(VENV)/.ready-for-docs
PARALLEL := -n auto --dist loadfile

FUZZ_MINUTES ?= 30

.PHONY: demo test test-all fuzz check docs format clean

demo: $(READY)  ## simulate a walk, smooth it, write a report
	$(BIN)/pdr-est demo -o demo-out

test: $(READY)  ## the fast tests
	$(BIN)/python -m pytest $(PARALLEL) -m "not slow"

test-all: $(READY)  ## all tests
	$(BIN)/python -m pytest $(PARALLEL)

fuzz: $(READY)  ## random damage to all inputs for FUZZ_MINUTES; what fails joins the corpus of the tests
	PDR_EST_FUZZ_MINUTES=$(FUZZ_MINUTES) $(BIN)/python -m pytest tests/fuzz

check: $(READY)  ## lint, format and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(READY_FOR_DOCS)  ## the documentation site, build/docs/index.html; broken links fail
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "Documentation: build/docs/index.html"

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

$(READY): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "pdr_est needs Python 3.11 or newer; set PYTHON")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[dev]"
	touch $(READY)

$(READY_FOR_DOCS): $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[docs]"
	touch $(READY_FOR_DOCS)

clean:
	rm -rf $(VENV) demo-out build *.egg-info .mypy_cache .pytest_cache .ruff_cache

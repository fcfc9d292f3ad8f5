# A machine with git, make and Python >= 3.11 needs nothing else: each target sets itself up in .venv.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
PIP    := $(BIN)/python -m pip install --quiet --disable-pip-version-check

export OMP_NUM_THREADS ?= 1

.PHONY: help setup dance test slow check docs wheel format lock clean

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1|/p' $(MAKEFILE_LIST) | awk -F'|' '{ printf "make %-8s %s\n", $$1, $$2 }'

setup: $(READY)  ## create .venv with the locked dependencies and this project in it

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	    || { echo "$(PYTHON) is older than Python 3.11: name a newer one, as in 'make PYTHON=python3.12 $(MAKECMDGOALS)'" >&2; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "Installing the locked dependencies into $(VENV) (once)"
	@$(PIP) --require-hashes --only-binary :all: -r requirements.lock
	@$(PIP) --no-deps --no-build-isolation --editable .
	@touch $@

dance: $(READY)  ## replay twenty seconds of dance under physics
	$(BIN)/sot replay lafan1_dance1_subject2 --feet planted --start 5 --duration 20 --out runs/dance
	@echo
	@echo "Watch it:  $(BIN)/sot view runs/dance         (add --web for a browser)"
	@echo "Plots:     $(BIN)/sot report runs/dance       (one page)"
	@echo "Figures:   runs/dance/report.json"

test: $(READY)  ## the quick tests
	$(BIN)/pytest -n auto --dist loadfile

slow: $(READY)  ## whole runs, and the commands of the README
	$(BIN)/pytest -m slow -n auto --dist loadfile

check: $(READY)  ## format, lint, types, import rules
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(VENV)/.docs  ## the documentation site, in build/site; its notebooks are run
	$(BIN)/sphinx-build --fail-on-warning --keep-going --quiet docs build/site
	@echo "Open build/site/index.html"

$(VENV)/.docs: $(READY) requirements-docs.lock
	@$(PIP) --require-hashes --only-binary :all: -r requirements-docs.lock
	@touch $@

wheel: $(READY)  ## source distribution and wheel, in dist
	$(BIN)/hatchling build -d dist

format: $(READY)  ## format the code and mend what the linter can
	$(BIN)/ruff format
	$(BIN)/ruff check --fix

LOCK := $(BIN)/uv pip compile pyproject.toml --universal --python-version 3.11 --upgrade --generate-hashes \
    --no-emit-index-url --no-annotate --no-header --quiet

lock: $(READY)  ## resolve the dependencies anew into requirements.lock and requirements-docs.lock
	$(LOCK) --extra test --output-file requirements.lock
	$(LOCK) --extra docs --constraint requirements.lock --output-file requirements-docs.lock

clean:  ## remove what was installed and built (runs/ stays)
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

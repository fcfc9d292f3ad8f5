# A machine with git, make and Python >= 3.11 needs nothing else: each target sets itself up in .venv.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready

export OMP_NUM_THREADS ?= 1

.PHONY: help setup dance test slow check format lock clean

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1|/p' $(MAKEFILE_LIST) | awk -F'|' '{ printf "make %-8s %s\n", $$1, $$2 }'

setup: $(READY)  ## create .venv with the locked dependencies and this project in it

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	    || { echo "$(PYTHON) is older than Python 3.11: name a newer one, as in 'make PYTHON=python3.12 $(MAKECMDGOALS)'" >&2; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "Installing the locked dependencies into $(VENV) (once)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes --only-binary :all: -r requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
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

format: $(READY)  ## format the code and mend what the linter can
	$(BIN)/ruff format
	$(BIN)/ruff check --fix

lock:  ## resolve the dependencies anew into requirements.lock
	@test -x build/lock/bin/uv || { $(PYTHON) -m venv build/lock && build/lock/bin/pip install --quiet uv; }
	build/lock/bin/uv pip compile pyproject.toml --extra test --universal --python-version 3.11 --upgrade \
	    --generate-hashes --no-emit-index-url --no-annotate --no-header --quiet --output-file requirements.lock

clean:  ## remove what was installed and built (runs/ stays)
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

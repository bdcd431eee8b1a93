# `make demo` and `make test` need nothing but make and Python 3.11 on Debian or Ubuntu: they install the rest.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)

.PHONY: setup demo test lint clean

setup: $(VENV)/.installed system-packages

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV) || { $(SUDO) apt-get update && $(SUDO) apt-get install -y python3-venv && $(PYTHON) -m venv $(VENV); }
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

# YADE and h5py for the system's Python, which loads YADE.
.PHONY: system-packages
system-packages:
	@command -v yade >/dev/null && /usr/bin/python3 -c 'import h5py' 2>/dev/null || \
		{ $(SUDO) apt-get update && $(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends yade python3-h5py; }

# Exit code 4 (inconclusive) is an answer: the wall's joints slide, so limit analysis gives it a bound only.
demo: setup
	$(BIN)/crosscheck run two_pads arch_spreading wall_third || [ $$? -eq 4 ]

test: setup
	$(BIN)/python -m pytest

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

clean:
	rm -rf $(VENV) crosscheck-results build dist *.egg-info

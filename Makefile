# `make demo` and `make test` need nothing but make and Python 3.11 on Debian or Ubuntu: they install the rest.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SUDO := $(shell [ "$$(id -u)" = 0 ] || command -v sudo)
APT_INSTALL := $(SUDO) apt-get update -qq && $(SUDO) env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends
ask = { echo 'Not installed: $(1). As root: apt-get install $(1); then the same make again.$(2)' >&2; exit 1; }

.NOTPARALLEL:

.PHONY: setup demo test test-all test-long hard-cases lint release clean

setup: $(VENV)/.installed system-packages

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	@$(PYTHON) -m venv $(VENV) || \
		{ $(APT_INSTALL) python3-venv && $(PYTHON) -m venv $(VENV); } || $(call ask,python3-venv)
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

# YADE and h5py for the system's Python, which loads YADE.
.PHONY: system-packages
system-packages:
	@{ command -v yade && /usr/bin/python3 -c 'import h5py'; } >/dev/null 2>&1 || \
		{ echo 'Installing yade and python3-h5py by apt: about 0.4 GB to fetch, 2.2 GB on disk.' >&2 && $(APT_INSTALL) yade python3-h5py; } || \
		$(call ask,yade python3-h5py, Without YADE: $(BIN)/crosscheck run two_pads --no-yade)

demo: setup
	$(BIN)/crosscheck run two_pads arch_spreading wall_third

# Processes side by side, one thread in each; cores that a container only seems to have would make them too many.
PROCESSES := 2
PYTEST_OPTIONS :=
PYTEST := OMP_NUM_THREADS=1 $(BIN)/python -m pytest --numprocesses $(PROCESSES) --dist loadgroup --no-loadscope-reorder $(PYTEST_OPTIONS)
test: setup
	$(PYTEST) -m 'not slow and not long'

# Each test once, what fails fast first.
test-all: test
	$(PYTEST) -m 'slow and not long'

test-long: setup
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m long

# What is hard, and what goes wrong, at length: writes the pages of outcomes again. Hours on one core.
hard-cases: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/hard_cases_table.py -o comparison/gallery/hard_cases.md
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/random_laws_report.py -o comparison/gallery
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/fuzz_readers.py --count 10000 --write comparison/gallery/fuzz.md
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m long tests/yade/test_faults_of_yade.py tests/cli/test_interruptions.py tests/cli/test_damaged_results.py

.PHONY: seed-paper test-browser viewer-library
# The campaign after the seed paper by both methods, some ten minutes on two cores, and its report in the gallery.
seed-paper: setup
	OMP_NUM_THREADS=1 $(BIN)/crosscheck campaign seed_paper || case $$? in 1 | 4) ;; *) exit 3 ;; esac # disagree and inconclusive are results
	mkdir -p comparison/gallery/seed_paper
	cp $(addprefix crosscheck-campaigns/seed_paper/,campaign.json results.csv costs.csv) comparison/gallery/seed_paper/
	$(BIN)/crosscheck report comparison/gallery/seed_paper || case $$? in 1 | 4) ;; *) exit 3 ;; esac # disagree and inconclusive are results
	$(BIN)/python tests/benchmarks/conclusions.py

# The browser's tests skip where there is none; this installs one (about 0.1 GB to fetch) and runs them.
test-browser: setup
	@{ command -v chromium || command -v chromium-browser || command -v google-chrome; } >/dev/null || $(APT_INSTALL) chromium || $(call ask,chromium)
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m browser tests/comparison

# comparison/report/web/three.min.js: what the viewer uses of three.js, bundled byte for byte the same by these versions; needs npm.
viewer-library:
	npm install --no-save --no-fund --no-audit --prefix build/three three@0.187.0 esbuild@0.28.2
	cp build/three/node_modules/three/LICENSE comparison/report/web/three.LICENSE
	NODE_PATH=build/three/node_modules build/three/node_modules/.bin/esbuild comparison/report/web/three.entry.js --bundle --minify \
		--format=iife --global-name=THREE --banner:js="/* three.js 0.187.0, shortened. $$(cat comparison/report/web/three.LICENSE) */" \
		--outfile=comparison/report/web/three.min.js

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Source distribution and wheel of the version in pyproject.toml, in dist/.
release: setup
	rm -rf build dist *.egg-info
	$(BIN)/python -m build
	cd dist && sha256sum * > SHA256SUMS

clean:
	rm -rf $(VENV) crosscheck-results build dist *.egg-info

# Everything from a fresh clone: Python 3.11 to 3.13 and make are all that is needed.
PYTHON ?= python3
BIN := .venv/bin

# Of hidden-effects and pairs: where seeds begin (else where the report's do); processes at a time. CASES: case names.
SEED ?=
CASES ?= *
# Of pairs: how many.
PAIRS ?= 20
JOBS ?= 2

# Of patches: how many changes of parameters.
COUNT ?= 100000
# Of dataset-campaign: how many clips; a folder of photographs; a Python that has tonic.
CLIPS ?=
PHOTOGRAPHS ?=
TONIC ?=
# Of soak: how long.
MINUTES ?= 60
# Of fuzz: how long.
SECONDS ?= 600

# Of study-reconstruction: a folder of photographs; further arguments, see `python -m tests.reconstruction_study --help`.
PHOTOGRAPHS ?=
STUDY ?=

# Of docs: a warning is an error, and all are told. All pages are made anew, since code may have changed.
STRICT := --fresh-env --nitpicky --fail-on-warning --keep-going --quiet

.PHONY: run test check docs docs-serve format dist clean hidden-effects patches ranges soak fuzz v4l2 interop
.PHONY: calibration-table dataset-campaign study-reconstruction pairs presets

run: .venv/installed-server
	$(BIN)/voltcam serve

# A file runs in one process, so that its fixtures are made once.
test: .venv/installed-dev
	$(BIN)/pytest -n logical --dist loadfile --no-loadscope-reorder

check: .venv/installed-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/pyright
	$(BIN)/lint-imports

# Wheel and sdist, checked, and used from an empty environment with each extra.
dist: .venv/installed-dev
	$(BIN)/python .ci/dist.py

calibration-table: .venv/installed-dev
	$(BIN)/python -m tests.lab.calibration.calibration_table

docs: .venv/installed-dev
	$(BIN)/sphinx-build $(STRICT) docs build/docs

docs-serve: .venv/installed-dev
	$(BIN)/sphinx-autobuild docs build/docs

format: .venv/installed-dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

hidden-effects: .venv/installed-dev
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1 nice -n 10 \
		$(BIN)/python -m tests.hidden_effects $(if $(SEED),--seed $(SEED)) --cases '$(CASES)' --jobs $(JOBS)

# Goes on where it was interrupted; recordings are in the folder VOLTCAM_DATA.
study-reconstruction: .venv/installed-learn
	nice -n 10 $(BIN)/python -m tests.reconstruction_study $(if $(PHOTOGRAPHS),--photographs '$(PHOTOGRAPHS)') $(STUDY)

# One camera, two recordings: calibrated on the first, judged on the second. Goes on where it was interrupted.
pairs: .venv/installed-dev
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1 nice -n 10 \
		$(BIN)/python -m tests.pairs_study $(if $(SEED),--seed $(SEED)) --count $(PAIRS) --jobs $(JOBS)

# Needs slider_depth and davis346_street in the folder VOLTCAM_DATA.
presets: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.presets

fuzz: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.fuzz --seconds $(SECONDS) $(if $(SEED),--seed $(SEED))

soak: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.soak --minutes $(MINUTES) $(if $(SEED),--seed $(SEED))

dataset-campaign: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.dataset --count $(or $(CLIPS),1000) $(if $(PHOTOGRAPHS),--photographs '$(PHOTOGRAPHS)') \
		$(if $(TONIC),--tonic '$(TONIC)')

patches: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.patches --count $(COUNT) $(if $(SEED),--seed $(SEED))

# The same changes without a daemon around the simulator, which looks at every number that it keeps.
ranges: .venv/installed-dev
	$(BIN)/python -m tests.campaigns.ranges --count $(COUNT) $(if $(SEED),--seed $(SEED))

# Debian's kernel in QEMU with its test camera, unplugged and plugged in again; says so where that cannot be had.
v4l2: .venv/installed-dev
	$(BIN)/python -m tests.v4l2

# Heavy libraries of others read what Voltcam writes; in an environment of their own.
interop: .venv-interop/installed
	.venv-interop/bin/pytest -rs tests/interop

clean:
	rm -rf .venv .venv-interop dist build

.venv/bin/pip:
	$(PYTHON) -m venv .venv

.venv-interop/installed: pyproject.toml tests/interop/requirements.txt
	$(PYTHON) -m venv .venv-interop
	.venv-interop/bin/pip install --quiet --editable '.[server,ros2]' 'pytest>=8.3' -r tests/interop/requirements.txt
	touch $@

.venv/installed-server: pyproject.toml | .venv/bin/pip
	$(BIN)/pip install --quiet --editable '.[server]'
	touch $@

.venv/installed-learn: pyproject.toml .venv/installed-dev
	$(BIN)/pip install --quiet --editable '.[dev,learn]'
	touch $@

.venv/installed-dev: pyproject.toml | .venv/bin/pip
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

# Everything from a fresh clone: Python 3.11 to 3.13 and make are all that is needed.
PYTHON ?= python3
BIN := .venv/bin

.PHONY: run test check format clean

run: .venv/installed-server
	$(BIN)/voltcam serve

test: .venv/installed-dev
	$(BIN)/pytest

check: .venv/installed-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/pyright
	$(BIN)/lint-imports

format: .venv/installed-dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf .venv dist

.venv/bin/pip:
	$(PYTHON) -m venv .venv

.venv/installed-server: pyproject.toml | .venv/bin/pip
	$(BIN)/pip install --quiet --editable '.[server]'
	touch $@

.venv/installed-dev: pyproject.toml | .venv/bin/pip
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

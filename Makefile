# The one door. Every target sets up what it needs.
PYTHON ?= python3.11
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
SPEED  ?= 200

.PHONY: demo demo-refine test check bench setup clean

setup: $(STAMP)
$(STAMP): pyproject.toml
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) not found: install Python 3.11, or say PYTHON=..."; exit 2; }
	@[ -x $(BIN)/python ] || $(PYTHON) -m venv $(VENV)
	@echo "setting up $(VENV) (once; about a minute)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	@touch $@

# both processes on loopback at 5 ms: probe, arm, run, report (SPEED= line speed in FPM)
demo: setup
	$(BIN)/python -m sim_plant.cli.main demo --speed-fpm $(SPEED) --out out/demo

# two records with an undeclared effect: name it, write the amended line, error before and after
demo-refine: setup
	$(BIN)/python -m sim_plant.cli.main refine config/lines/euclid.yaml --example --out out/refine

# everything that decides whether a change may land
test: setup check
	$(BIN)/python -m pytest -q

# style, types, floors
check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# speed, as ratios measured in one run
bench: setup
	$(BIN)/python -m sim_plant.cli.main bench

clean:
	rm -rf $(VENV) out runs .pytest_cache .mypy_cache .ruff_cache

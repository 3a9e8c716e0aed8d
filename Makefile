# make help says what there is.

PYTHON ?=
SCENE ?=
PORT ?=
ARGS ?=

# Stays on this machine unless the user's environment says otherwise.
export ROS_AUTOMATIC_DISCOVERY_RANGE ?= LOCALHOST
# A sourced ROS brings pytest plugins that are made for its own pytest.
export PYTEST_DISABLE_PLUGIN_AUTOLOAD = 1

BIN := .venv/bin
# Any Python can choose the right one; -S: an active environment of the wheels would start itself twice.
ANY_PYTHON := $(shell for p in python3 python3.13 python3.12 python3.11 python3.10; do \
	command -v $$p && break; done)
SET_UP = @$(or $(ANY_PYTHON),$(PYTHON),python3) -S tools/set_up.py --python '$(PYTHON)'

.PHONY: help set-up run listen reset pause resume step set check clean distclean
.PHONY: bench bench-viewer bench-long bench-soak
.PHONY: fuzz
.PHONY: test test-kernel test-compiled-kernel test-bare-kernel test-offline test-rest test-viewer

help:
	@echo 'make run        set up what is needed, start the node and its live page   (SCENE=gas PORT=8080 ARGS="-p rate:=100.0")'
	@echo 'make listen     in another terminal: what the node publishes'
	@echo 'make reset      in another terminal: the scene from its first instant; also make pause, resume, step'
	@echo 'make set        in another terminal: a parameter, NAME=time_scale VALUE=0.1'
	@echo 'make test       everything that CI runs'
	@echo 'make check      ruff, mypy and import contracts only'
	@echo 'make fuzz       odd input of every kind, with new seeds, MINUTES=5; what fails is left in out/fuzz'
	@echo 'make bench      the engine and the node beside others: docs/benchmarks, 10 minutes'
	@echo 'make bench-viewer the live page in a browser: docs/viewer.md, 5 minutes'
	@echo 'make bench-long a run of 10^9 contacts, 6 minutes;   make bench-soak   memory, 10 minutes'
	@echo 'make set-up     only make the environments that run and test need'
	@echo 'make clean      remove what tests and builds leave'
	@echo 'make distclean  remove the environments too'
	@echo 'Each takes PYTHON=..., the Python 3.10-3.13 to use, for example make PYTHON=python3.12 run'

set-up: .venv .venvs/kernel .venvs/offline .venvs/colcon .venvs/bench

.PHONY: .venv .venvs/kernel .venvs/offline .venvs/colcon .venvs/bench
.venv .venvs/kernel .venvs/offline .venvs/colcon .venvs/bench:
	$(SET_UP) $@

define NOTICE
The node publishes the scene $(or $(SCENE),lesson):
  /<circle>/pose and /<circle>/twist of each named circle (in the lesson: /green/pose, /green/twist),
  /poses, /bodies, /contacts, /time, /markers, /markers/static and /diagnostics.
See it in the browser: the address that bounce_viewer prints below.
Look at it from another terminal:   make listen
Start the scene again:              make reset
With ROS 2 sourced:                 ros2 topic echo /green/pose
                                    ros2 service call /bounce/reset std_srvs/srv/Trigger
Ctrl-C ends it.

endef
export NOTICE

run: .venv
	@printf '%s\n' "$$NOTICE"
	@exec $(BIN)/python -S tools/run.py --ros-args $(if $(SCENE),-p 'scene:=$(SCENE)') $(if $(PORT),-p 'bounce_viewer:port:=$(PORT)') $(ARGS)

listen: .venv
	@exec $(BIN)/python examples/listen.py $(ARGS)

reset pause resume step: .venv
	@exec $(BIN)/python examples/control.py $@ $(ARGS)

set: .venv
	@exec $(BIN)/python examples/control.py set '$(NAME)' '$(VALUE)' $(ARGS)

check: .venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Two at a time where that disturbs nobody; what goes by a clock runs alone.
test: set-up check
	+$(MAKE) --no-print-directory -j 2 --output-sync test-kernel test-bare-kernel test-compiled-kernel test-offline
	+$(MAKE) --no-print-directory test-rest
	+$(MAKE) --no-print-directory test-viewer
	@echo 'make test: PASSED'

# Branch coverage of the plain engine, measured by the kernel's own tests. Mutants run in the bare environment.
test-kernel: .venv
	$(BIN)/python -m pytest -p pytest_cov.plugin --cov --cov-fail-under=95 --cov-report=term-missing test/kernel \
		--ignore=test/kernel/test_mutation.py --engine plain

# Of the kernel's tests, those in which the engine runs.
ENGINE_TESTS = awkward_cases exactness laws referee
test-compiled-kernel: .venv
	$(BIN)/python -m pytest $(ENGINE_TESTS:%=test/kernel/test_%.py) --engine compiled

# The same tests where there is nothing but numpy and pytest: no ROS, no YAML, no compiler.
test-bare-kernel: .venvs/kernel
	env -u PYTHONPATH .venvs/kernel/bin/python -m pytest test/kernel

# Where there is no ROS: recordings, pictures and sweeps need none.
test-offline: .venvs/offline
	env -u PYTHONPATH .venvs/offline/bin/python -m pytest test/offline

test-rest: .venv .venvs/kernel .venvs/colcon .venvs/bench
	$(BIN)/python -m pytest --durations=15 --ignore=test/kernel --ignore=test/offline --ignore=test/viewer

# The live page in a real browser; where there is none the tests skip and say so.
test-viewer: .venv
	$(BIN)/python -m pytest --durations=10 test/viewer

# The tests in test/fuzz are its first cases. One again: ARGS="--target scene --seed 7".
MINUTES ?= 5
fuzz: .venv
	$(BIN)/python test/fuzz/campaign.py --minutes $(MINUTES) $(ARGS)

# The node first: nothing else is at work then.
bench: .venv .venvs/bench
	$(BIN)/python -m benchmarks.node
	.venvs/bench/bin/python -m benchmarks.engine
	.venvs/bench/bin/python -m benchmarks.report

bench-viewer: .venv
	$(BIN)/python -m benchmarks.viewer

bench-long: .venvs/bench
	.venvs/bench/bin/python -m benchmarks.long_run
	.venvs/bench/bin/python -m benchmarks.report

bench-soak: .venv .venvs/bench
	$(BIN)/python -m benchmarks.node --soak 600
	.venvs/bench/bin/python -m benchmarks.report

clean:
	rm -rf build install log out .coverage .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -not -path './.venv*' -prune -exec rm -rf {} +

distclean: clean
	rm -rf .venvs *.egg-info
	if [ -e .venv/circle_bounce_ros.json ]; then rm -rf .venv; fi

# `make demo` and `make test` are all a newcomer needs; each does its own set-up.
# One Cargo profile and one target folder serve tests, command and wheel.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON ?= python3
VENV := .venv
PIP := $(VENV)/bin/python -m pip --disable-pip-version-check --quiet
PINS := tests/python/requirements.txt
DEMO := flat uphill downhill

# a missing toolchain is said by .ci/prerequisites, not mended behind the user's back
export MATURIN_NO_INSTALL_RUST := 1

.PHONY: help
help: ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-11s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

.PHONY: demo
demo: ## build, run the flat, uphill and downhill missions, say where their pages are
	@.ci/prerequisites demo
	@$(MAKE) --no-print-directory install
	@$(VENV)/bin/python -m cohaul.demo $(DEMO:%=scenarios/r2p2/%.yaml) --out out/demo

.PHONY: test
test: ## everything CI runs
	@.ci/prerequisites test
	@.ci/timed "make test" $(MAKE) --no-print-directory check python-test

.PHONY: check
check: ## format, lints, Rust tests, documentation
	@.ci/timed format cargo fmt --all --check
	@.ci/timed lints cargo clippy --release --locked --workspace --all-targets -- --deny warnings
	@.ci/timed "Rust tests" cargo test --release --locked --workspace
	@RUSTDOCFLAGS="--deny warnings" .ci/timed documentation cargo doc --release --locked --workspace --no-deps
	@if cargo deny --version >/dev/null 2>&1; then .ci/timed licences cargo deny --offline check; fi

.PHONY: python-test
python-test: install $(VENV)/tests-ready
	@.ci/timed "Python tests" $(VENV)/bin/python -m pytest tests/python

.PHONY: install
install: $(VENV)/ready ## build the Python package and install it into .venv
	@rm -rf target/wheel
	@.ci/timed wheel $(VENV)/bin/maturin build --release --locked --compatibility linux \
		--interpreter $(VENV)/bin/python --out target/wheel
	@$(PIP) install --no-deps --force-reinstall target/wheel/*.whl

.PHONY: bench
bench: ## measure speeds
	cargo bench --locked --workspace

.PHONY: bench-peers
bench-peers: ## plan every instance in DIR, one CSV row each in out/bench-peers.csv; with PEERS=CSV, compare
	@test -n "$(DIR)" || { echo "say which folder: make bench-peers DIR=…"; exit 2; }
	cargo build --release --locked --workspace
	.ci/bench-peers "$(DIR)" --out out/bench-peers.csv
	$(if $(PEERS),.ci/compare-peers out/bench-peers.csv "$(PEERS)")

.PHONY: growth
growth: install $(VENV)/tests-ready ## plot planning time and memory against the number of agents, into out/growth
	cargo build --release --locked --workspace
	$(VENV)/bin/python .ci/growth --out out/growth

.PHONY: results
results: ## run the published experiments, write their report and its summary
	cargo build --release --locked --workspace
	.ci/results target/release/cohaul

.PHONY: format
format: ## format the Rust sources
	cargo fmt --all

.PHONY: clean
clean: ## remove everything that was built or written
	rm -rf target $(VENV) out

# what the wheel needs
$(VENV)/ready: $(PINS)
	@.ci/prerequisites demo
	@$(PYTHON) -m venv --clear $(VENV)
	@$(PIP) install --constraint $(PINS) maturin numpy
	@touch $@

# what the tests need beyond
$(VENV)/tests-ready: $(VENV)/ready
	@$(PIP) install --requirement $(PINS)
	@touch $@

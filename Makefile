# What people type. `make demo` and `make test` set everything up that they need.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Mesa's device-selection layer complains on stderr where there is no desktop session; the library chooses the device itself.
export VK_LOADER_LAYERS_DISABLE := VK_LAYER_MESA_device_select
# What tests measure of this machine is no user's.
export SOFTSHADOW_CACHE ?= $(CURDIR)/target/calibrations

.PHONY: help setup driver browser venv tools extension demo gallery test test-rust test-python package fuzz lint docs bench evidence clean

help:
	@echo "make demo      render the demonstration scene; says where the picture and the numbers are"
	@echo "make gallery   pictures side by side of what the techniques do, with numbers, in about a minute; demo/gallery/index.md"
	@echo "make test      all tests, Rust and Python"
	@echo "make package   the packages that would be published, built and tried in an empty environment"
	@echo "make fuzz      a minute of hostile input for each reader and for settings, two at a time"
	@echo "make lint      formatting, clippy, ruff, mypy, stubs"
	@echo "make docs      reference of the Python package, from its docstrings; docs/softshadow.html"
	@echo "make bench     time, bytes and error of the techniques, and the papers' ratios, in a few minutes; bench/report/index.html"
	@echo "make evidence  heavy checks against other renderers, with meshes; writes EVIDENCE.md"

setup: extension driver

# A software Vulkan driver, where nothing but GL answers (or nothing at all). Only Debian and Ubuntu are known here.
driver: extension
	@if $(BIN)/python -c "import sys, softshadow; sys.exit(all(a['backend'] == 'gl' for a in softshadow.doctor().adapters))" 2>/dev/null; \
	then :; elif command -v apt-get >/dev/null; then \
	  echo "no Vulkan adapter found: installing Mesa's software driver"; \
	  sudo=$$([ "$$(id -u)" = 0 ] || echo sudo); \
	  $$sudo apt-get update -qq && \
	  $$sudo apt-get install -y -qq mesa-vulkan-drivers libvulkan1 libegl1 libgl1-mesa-dri; \
	else echo "no Vulkan adapter found: install a driver, for example Mesa's lavapipe"; fi

# Reports are opened in it by tests, which without it are skipped.
browser:
	@if command -v chromium chromium-browser google-chrome >/dev/null; then :; elif command -v apt-get >/dev/null; then \
	  sudo=$$([ "$$(id -u)" = 0 ] || echo sudo); \
	  $$sudo apt-get update -qq && $$sudo apt-get install -y -qq --no-install-recommends chromium; \
	else echo "no browser found: install Chromium"; fi

venv: $(VENV)/.made

$(VENV)/.made: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet "maturin>=1.9.4,<2" numpy
	touch $@

# What tests and checks need besides.
tools: $(VENV)/.tools

$(VENV)/.tools: $(VENV)/.made
	$(BIN)/python -m pip install --quiet trimesh matplotlib tqdm pytest ruff mypy pillow wgpu pygfx
	touch $@

extension: venv
	@test -d target/release || echo "compiling Rust: some minutes, this time"
	PIP_QUIET=1 $(BIN)/maturin develop --release --quiet

demo: extension
	$(BIN)/python -m softshadow.demo --output demo

gallery: setup
	$(BIN)/softshadow gallery --output demo/gallery

test: setup test-rust test-python

# Everything through the software driver; then the truth again on the processor without one.
test-rust:
	SOFTSHADOW_DEVICE=software cargo test --release --workspace --quiet
	cargo test --release --package softshadow --test truth --quiet

test-python: extension tools
	$(BIN)/python -m pytest -q

# sdist, wheel and crates; only the crates of this workspace are compiled again.
package: venv
	$(BIN)/python tests/packaging/packages.py

# Other inputs every time; the figures name the seed, and target/fuzz/ holds what was new or red.
fuzz: export SOFTSHADOW_FUZZ_SECONDS = 60
fuzz: export SOFTSHADOW_FUZZ_SEED ?= $(shell date +%s)
fuzz:
	cargo test --release --package softshadow --test fuzz --quiet -- --nocapture --test-threads 2

lint: extension tools
	cargo fmt --all --check
	cargo clippy --release --workspace --all-targets --quiet -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --quiet
	$(BIN)/ruff check python tests
	$(BIN)/ruff format --check python tests
	$(BIN)/mypy --strict python/softshadow
	$(BIN)/python -m mypy.stubtest softshadow._core

# Wanted only here.
docs: extension
	$(BIN)/python -m pip install --quiet "pdoc>=15"
	$(BIN)/python -m pdoc --docformat numpy --no-show-source --output-directory docs softshadow
	@echo "reference docs/softshadow.html"

# More scenes, sizes and settings: target/release/softshadow-bench --help
bench: extension
	cargo build --release --package softshadow_bench --quiet
	mkdir -p bench
	target/release/softshadow-bench --ratios --json bench/lines.jsonl
	$(BIN)/python -m softshadow.bench.report --output bench/report --lines bench/lines.jsonl

# Other renderers are large; they are wanted only here.
evidence: setup tools
	@if ! ldconfig -p | grep -q libusb-1.0; then \
	  sudo=$$([ "$$(id -u)" = 0 ] || echo sudo); $$sudo apt-get install -y -qq libusb-1.0-0 libgomp1 libx11-6; fi
	$(BIN)/python -m pip install --quiet open3d mitsuba embreex
	$(BIN)/python tests/evidence/run.py --output EVIDENCE.md

clean:
	cargo clean
	rm -rf $(VENV) demo bench dist docs

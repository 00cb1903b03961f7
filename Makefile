# Every target sets up what it needs in .venv; see tools/bootstrap.py (the same targets without make:
# `python3 tools/bootstrap.py demo`).
PYTHON ?= python3
RUN = $(PYTHON) tools/bootstrap.py

.PHONY: help demo test test-all image-test check bench load capacity setup messages interfaces clean

help:     ## this list
	@sed -n 's/^\([a-z-]*\): *## /\1\t/p' $(firstword $(MAKEFILE_LIST)) | expand -t 12
demo:     ## grade a small class over HTTP and show the dashboard
	@$(RUN) demo $(ARGS)
test:     ## the tests without the slow ones; ARGS="tests/unit/checks -k credit" names some
	@$(RUN) test $(ARGS)
test-all: ## all tests, and more examples of each property: twice as long
	@$(RUN) test-all $(ARGS)
image-test: ## build the container image without a daemon and try it as an ordinary container
	@$(RUN) image-test $(ARGS)
check:    ## formatting, lint, types, layers
	@$(RUN) check
bench:    ## measured cost of one grading against a bare PyBullet loop
	@$(RUN) bench $(ARGS)
load:     ## a class of 300 hands in over HTTP: latencies, throughput, gradebook; ARGS=--help tells more
	@$(RUN) load $(ARGS)
capacity: ## simulate deadline evenings from measured times: docs/capacity.md's table and picture
	@$(RUN) capacity $(ARGS)
setup:    ## create .venv, compile
	@$(RUN) setup
messages: ## find texts that are missing, unused or differ between Chinese and English
	@$(RUN) messages
interfaces: ## regenerate the shim's interface data from interfaces/
	@$(RUN) interfaces
clean:    ## remove .venv and everything that tools leave behind
	rm -rf .venv demo-output .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache dist build

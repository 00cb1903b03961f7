#!/bin/sh
# Renew the lock files from pyproject.toml (needs uv). Hashes only: no index address is recorded.
set -eu
cd "$(dirname "$0")/.."
options="--universal --generate-hashes --no-header --no-annotate --no-emit-index-url --no-emit-find-links --python-version 3.11"
uv pip compile --quiet $options --extra all pyproject.toml --output-file requirements-extras.lock
# What grades, for the autograders of other platforms.
uv pip compile --quiet $options --extra physics --extra plots --constraint requirements-extras.lock pyproject.toml --output-file requirements.lock
uv pip compile --quiet $options --group pyproject.toml:dev --constraint requirements-extras.lock --output-file requirements-dev.lock
# What builds the wheel, for the image; the development tools would be several hundred megabytes there.
echo hatchling | uv pip compile --quiet $options --constraint requirements-dev.lock - --output-file requirements-build.lock

#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test; further arguments go to ctest. Safe to repeat.
source "$(dirname "${BASH_SOURCE[0]}")/../pipeline/setup.sh"
build release
ctest --preset release --parallel "$(nproc)" "$@"

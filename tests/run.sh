#!/usr/bin/env bash
# Builds Matchlight and runs every test.
#
# Usage: tests/run.sh   (on Debian 12; asks for the administrator's password if packages are missing)
# Tests that need more data than the repository holds run when MATCHLIGHT_DATA names the folder of it.
set -euo pipefail
cd "$(dirname "$0")/.."

samples/install_packages.sh
cmake --preset release
cmake --build --preset release --parallel "$(nproc)"
ctest --preset release --parallel 2

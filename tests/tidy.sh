#!/usr/bin/env bash
# Runs clang-tidy over all of src, several sources at a time: most of its time goes to the headers that they share.
# A group that it complains of, or in which two sources use one name, is judged again source by source.
#
# Usage: tests/tidy.sh
set -euo pipefail
cd "$(dirname "$0")/.."

# GCC's own warning flags are in the compile commands; clang is not to stumble over those it does not have.
tidy() { clang-tidy --quiet --extra-arg=-Wno-unknown-warning-option "$@" 2>/dev/null; }

# One group of sources, given by the file that includes them.
judge() {
    # What one source includes or hides from another is no fault of either.
    tidy -p build/tidy --checks=-bugprone-suspicious-include --extra-arg=-Wno-shadow "$1" >/dev/null && return
    local failed=0 source
    while read -r source; do
        tidy -p build/release "$source" || failed=1
    done < <(sed -n 's/^#include "\(.*\)"$/\1/p' "$1")
    return "$failed"
}
export -f tidy judge

rm -rf build/tidy  # groups of sources that are no more would stay
cmake --preset release >/dev/null
cmake --preset release -B build/tidy -DCMAKE_UNITY_BUILD=ON >/dev/null
find build/tidy/src -name 'unity_*.cxx' -print0 | sort -z |
    xargs -0 -n 1 -P "$(nproc)" bash -c 'judge "$0" || { echo "clang-tidy: see above"; exit 255; }'

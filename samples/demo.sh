#!/usr/bin/env bash
# Builds Matchlight, puts three objects onto the table of the sample shot, and says where the video is.
#
# Usage: samples/demo.sh   (on Debian 12; asks for the administrator's password if packages are missing)
set -euo pipefail
cd "$(dirname "$0")/.."

samples/install_packages.sh
cmake --preset release
cmake --build --preset release --parallel "$(nproc)" --target matchlight

scene=samples/table/table.toml
result=out/table.mp4
mkdir -p out
started=$(date +%s.%N)
build/release/matchlight track "$scene"
build/release/matchlight render "$scene" -o "$result" --overwrite
seconds=$(awk -v from="$started" -v to="$(date +%s.%N)" 'BEGIN { printf "%.1f", to - from }')

echo
echo "The shot was tracked and rendered in $seconds s. The result is $PWD/$result"

#!/usr/bin/env bash
# Makes the Debian package, unpacks it elsewhere, and runs the program from there: nothing of the source tree is needed.
#
# Usage: package_test.sh BUILD_FOLDER
set -euo pipefail
build=$(cd "$1" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

(cd "$scratch" && cpack --config "$build/CPackConfig.cmake" -B "$scratch/packed")
package=$(find "$scratch/packed" -maxdepth 1 -name 'matchlight_*.deb')
dpkg-deb --info "$package"
dpkg-deb --field "$package" Depends | grep libavformat
dpkg-deb --contents "$package" | grep 'usr/share/matchlight/shaders/'
dpkg-deb --contents "$package" | grep 'usr/share/matchlight/probes/city/probe.exr'
dpkg-deb --contents "$package" | grep 'usr/share/matchlight/calib/boards/charuco_12x8.toml'
dpkg --extract "$package" "$scratch/root"

program=$scratch/root/usr/bin/matchlight
"$program" --version
cd "$scratch"
# The shaders must be those of the package, not those of the source tree the program was built in.
"$program" doctor | tee doctor.txt
grep -F "$scratch/root/usr/share/matchlight/shaders" doctor.txt

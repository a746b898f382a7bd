#!/usr/bin/env bash
# Installs the Debian packages that Matchlight is built and run with, where they are missing: the one list of them.
#
# Usage: samples/install_packages.sh [--development]
# --development adds what the checks of the source text need (formatter, linter).
set -euo pipefail

packages=(
    # building
    cmake g++ ninja-build pkg-config dpkg-dev file
    # core, commands and tests
    libcli11-dev libeigen3-dev libfmt-dev libgmock-dev libgtest-dev libspdlog-dev libtomlplusplus-dev locales
    nlohmann-json3-dev
    # footage and images
    libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libopencv-dev libopenexr-dev libopenimageio-dev
    libopencolorio-dev
    # tracking, boards to print, and what the tests render these with again
    libapriltag-dev libcairo2-dev libceres-dev libopencv-contrib-dev librsvg2-bin poppler-utils
    # models and drawing; Mesa's software rasteriser serves where there is no GPU
    libassimp-dev libegl-dev libegl1 libegl-mesa0 libepoxy-dev libfftw3-dev libgl1-mesa-dri libglfw3-dev libglm-dev
    zlib1g-dev
    # the preview's controls, and letters for them
    libimgui-dev fonts-dejavu-core
    # a screen for the tests of the preview's window, where there is none
    xvfb
)
if [ "${1:-}" = "--development" ]; then
    packages+=(ccache clang-format clang-tidy)
fi

if ! command -v apt-get > /dev/null; then
    echo "This is not Debian: install what answers to these packages by hand: ${packages[*]}" >&2
    exit 1
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query --show --showformat '${db:Status-Status}' "$package" 2>/dev/null || true)
    if [ "$status" != installed ]; then
        missing+=("$package")
    fi
done
if [ "${#missing[@]}" -eq 0 ]; then
    exit 0
fi

echo "Installing Debian packages: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo > /dev/null; then
        echo "There is no sudo here: run samples/install_packages.sh as root first" >&2
        exit 1
    fi
    as_root=(sudo)
fi
"${as_root[@]}" apt-get update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "${missing[@]}"

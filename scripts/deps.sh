#!/bin/sh
# Installs what building and testing need, on Debian and Ubuntu; elsewhere names it.
set -eu
packages="gcc g++ libc6-dev cmake ninja-build pkg-config zlib1g-dev liblz4-dev liblzma-dev libexpat1-dev libspng-dev libcjson-dev libcmocka-dev ffmpeg libopenexr-dev libassimp-dev libstb-dev"

if ! command -v dpkg-query >/dev/null 2>&1; then
    echo "This is no Debian or Ubuntu: please install what these packages hold: $packages" >&2
    exit 0
fi
[ "$(dpkg --print-architecture)" != amd64 ] || packages="$packages libembree-dev" # for meshes and tests/oracle, which others go without
missing=""
for package in $packages; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

sudo=""
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
        echo "Please install, as root: apt-get install$missing" >&2
        exit 1
    fi
    sudo=sudo
fi
echo "Installing:$missing" >&2
$sudo apt-get update -qq
# shellcheck disable=SC2086 # one word per package
$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2

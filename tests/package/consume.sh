#!/bin/sh
# consume.sh c|cxx PREFIX WORK: copies an example out of the tree, builds it against the installation with find_package and with
# pkg-config, and runs both: they must draw the same picture.
set -eu
language=$1 prefix=$2 work=$3
warnings="-pedantic -Wall -Wextra -Wshadow -Wconversion -Werror"
rm -rf "$work"
mkdir -p "$work"

if [ "$language" = c ]; then
    example=draw modules=meniscus
    compile() { "$CC" -std=c99 "$@"; }
    set -- -DCMAKE_C_COMPILER="$CC" -DCMAKE_C_FLAGS="$FLAGS"
elif [ -x "$CXX" ]; then
    example=read_and_draw modules="meniscus-io meniscus"
    compile() { "$CXX" -std=c++11 "$@"; }
    set -- -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_CXX_FLAGS="$FLAGS"
else
    echo "skipped: no C++ compiler" >&2
    exit 77
fi
cp -R "$SOURCE/examples/$example" "$work/source"

"$CMAKE" -S "$work/source" -B "$work/build" -G "$GENERATOR" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release "$@"
"$CMAKE" --build "$work/build"

PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name meniscus.pc)")
LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")
export PKG_CONFIG_PATH LD_LIBRARY_PATH
# shellcheck disable=SC2046,SC2086 # words
compile $warnings $FLAGS "$work/source/$example".c* $(pkg-config --cflags --libs $modules) -lm -o "$work/by_pkg_config"

# A block of 16 x 8 x 16 particles.
awk 'BEGIN { print "x,y,z"; for (i = 0; i < 2048; i++) print i % 16 / 10 "," int(i / 16) % 8 / 10 "," int(i / 128) / 10 }' >"$work/block.csv"

draw() { # PROGRAM NAME
    if [ $example = draw ]; then
        "$1" "$work/$2.ppm"
    else
        "$1" "$work/block.csv" "$work/$2.png"
    fi
}
if [ $example = read_and_draw ] && [ "$PNG" = 0 ]; then # it says so
    if draw "$work/by_pkg_config" none; then
        exit 1
    fi
    exit 0
fi
draw "$work/build/$example" one
draw "$work/by_pkg_config" two
cmp "$work"/one.p?? "$work"/two.p??
[ "$(wc -c <"$(echo "$work"/one.p??)")" -gt 1000 ]

# What is wrong is said, and no picture is left.
if draw "$work/by_pkg_config" missing/folder; then
    exit 1
fi

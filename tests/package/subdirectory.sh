#!/bin/sh
# subdirectory.sh KIND BUILD PREFIX: builds the library inside another project (subdirectory/), static or shared, draws with it there,
# and installs it. Plain C kernels without the usual optimization: what is tested is the build, and this is quick.
set -eu
unset DESTDIR
kind=$1 build=$2 prefix=$3
here=$(dirname "$0")

shared=OFF
[ "$kind" = static ] || shared=ON
# shellcheck disable=SC2086 # one word per feature
"$CMAKE" -S "$here/subdirectory" -B "$build" -G "$GENERATOR" -DCMAKE_C_COMPILER="$CC" -DCMAKE_C_FLAGS="-O1 $FLAGS" \
    -DMENISCUS_SOURCE_DIR="$SOURCE" -DBUILD_SHARED_LIBS=$shared -DMNS_SIMD=OFF -DMNS_INSTALL=ON $FEATURES
"$CMAKE" --build "$build"
"$build/draw" "$build/draw.ppm"
"$build/formats"

rm -rf "$prefix"
"$CMAKE" --install "$build" --prefix "$prefix"

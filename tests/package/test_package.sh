#!/bin/sh
# The library as others use it: installed, found by CMake and by pkg-config, or added as a folder; the examples built and run against it.
#   test_package.sh SOURCE BUILD WORK SHARED CC CXX FLAGS
# BUILD: a build to install as it is; empty: one is made, with SHARED on or off. FLAGS: for compiler and linker (sanitizers).
set -eu
source=$1 build=$2 work=$3 shared=$4 cc=$5 cxx=$6 flags=$7
rm -rf "$work"
mkdir -p "$work"
prefix=$work/prefix
export CC="$cc" CFLAGS="$flags" CXXFLAGS="$flags" LDFLAGS="$flags"
[ -z "$cxx" ] || export CXX="$cxx"

if [ -z "$build" ]; then
    build=$work/build
    cmake -S "$source" -B "$build" -G Ninja -DBUILD_SHARED_LIBS="$shared" -DMNS_BUILD_TESTS=OFF -DMNS_BUILD_PROGRAM=OFF >/dev/null
    cmake --build "$build" >/dev/null
fi
cmake --install "$build" --prefix "$prefix" >/dev/null
lib=$(dirname "$(find "$prefix" -name 'libmeniscus.*' | head -n 1)")
export LD_LIBRARY_PATH="$lib" PKG_CONFIG_PATH="$lib/pkgconfig"

# Nothing but the public names leaves a shared library.
if [ "$shared" = ON ]; then
    for library in "$lib"/libmeniscus.so "$lib"/libmeniscus_io.so; do
        others=$(nm -D --defined-only "$library" | awk '$2 ~ /[A-Z]/ && $3 !~ /^mns_/ && $3 !~ /^(_init|_fini)$/ {print $3}')
        [ -z "$others" ] || { echo "$library exports $others"; exit 1; }
    done
    hidden=$(nm -D --defined-only "$lib/libmeniscus.so" | grep -c 'mns_kernels_get\|mns_fail$' || true)
    [ "$hidden" = 0 ] || { echo "internal names are exported"; exit 1; }
fi

# find_package
cmake -S "$source/examples/draw" -B "$work/draw" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/draw" >/dev/null
cd "$work/draw"
./draw
[ "$(wc -c < draw.ppm)" -gt 1500000 ]
cd "$work"
if [ -n "$cxx" ] && [ -e "$prefix/include/meniscus/io.h" ] && grep -q spng "$lib/pkgconfig/meniscus-io.pc"; then
    cmake -S "$source/examples/read_and_draw" -B "$work/read" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
    cmake --build "$work/read" >/dev/null
    printf 'x,y,z\n0,0,0\n0.1,0,0\n0,0.1,0\n0,0,0.1\n' > four.csv
    "$work/read/read_and_draw" four.csv four.png
    [ "$(head -c 4 four.png | tail -c 3)" = PNG ]
    ! "$work/read/read_and_draw" missing.csv missing.png 2> message
    grep -q missing.csv message
fi

# pkg-config
static=""
[ "$shared" = ON ] || static=--static
# shellcheck disable=SC2046,SC2086 # one word per flag
"$cc" $flags $(pkg-config --cflags meniscus) "$source/examples/draw/draw.c" -o draw_pc $(pkg-config $static --libs meniscus) -lm
./draw_pc
# shellcheck disable=SC2086
pkg-config $static --libs meniscus-io >/dev/null

# As a folder of another project, which gets the library and nothing else.
mkdir -p folder
cat > folder/CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.18)
project(folder LANGUAGES C)
add_subdirectory("$source" meniscus)
if(TARGET test_params OR TARGET meniscus_program OR CMAKE_BUILD_TYPE)
  message(FATAL_ERROR "the library brought more than itself")
endif()
add_executable(draw "$source/examples/draw/draw.c")
target_link_libraries(draw PRIVATE meniscus::meniscus \$<\$<PLATFORM_ID:Linux>:m>)
END
cmake -S folder -B folder/build -G Ninja -DMNS_BUILD_IO=OFF -DMNS_SIMD=OFF >/dev/null
cmake --build folder/build --target draw >/dev/null

#!/bin/sh
# What a change must pass before it lands: the style, and all tests under every compiler, sanitizer and kind of build.
# Besides scripts/deps.sh it needs clang, its run-time library (libclang-rt-14-dev) and clang-format.
#   sh scripts/check.sh          everything
#   sh scripts/check.sh NAME...  of: format gcc clang address thread scalar shared bare
set -eu
cd "$(dirname "$0")/.."

format() {
    git ls-files '*.c' '*.h' '*.cpp' | xargs clang-format --dry-run -Werror
}

build() { # NAME COMPILER OPTIONS...: builds and tests in build-NAME
    folder=build-$1 compiler=$2
    shift 2
    cmake -S . -B "$folder" -G Ninja -DCMAKE_C_COMPILER="$compiler" -DMNS_WERROR=ON "$@"
    cmake --build "$folder"
    ctest --test-dir "$folder" --output-on-failure
}

check() {
    case $1 in
    format) format ;;
    gcc) build gcc gcc ;;
    clang) build clang clang ;;
    address) build address clang -DCMAKE_BUILD_TYPE=RelWithDebInfo -DMNS_SANITIZE=fuzzer-no-link,address,undefined -DMNS_BUILD_FUZZERS=ON ;;
    thread) build thread clang -DCMAKE_BUILD_TYPE=RelWithDebInfo -DMNS_SANITIZE=thread ;;
    scalar) build scalar gcc -DMNS_SIMD=OFF ;;
    shared) build shared gcc -DBUILD_SHARED_LIBS=ON ;;
    bare) build bare gcc -DMNS_WITH_ZLIB=OFF -DMNS_WITH_LZ4=OFF -DMNS_WITH_LZMA=OFF -DMNS_WITH_EXPAT=OFF -DMNS_WITH_PNG=OFF -DMNS_WITH_MESHES=OFF ;;
    *)
        echo "no such check: $1 (format gcc clang address thread scalar shared bare)" >&2
        exit 2
        ;;
    esac
}

[ $# -gt 0 ] || set -- format gcc clang address thread scalar shared bare
for name in "$@"; do
    echo "== $name"
    check "$name"
done

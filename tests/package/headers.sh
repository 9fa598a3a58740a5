#!/bin/sh
# headers.sh c|cxx PREFIX: each installed header compiles by itself, and twice, without a warning.
set -eu
language=$1 prefix=$2
warnings="-pedantic -Wall -Wextra -Wshadow -Wconversion -Werror"

check() { # COMPILER STANDARD SUFFIX
    for header in "$prefix"/include/meniscus/*.h; do
        name=meniscus/$(basename "$header")
        echo "$2: $name"
        # shellcheck disable=SC2086 # words
        printf '#include <%s>\n#include <%s>\nint main(void) { return 0; }\n' "$name" "$name" |
            "$1" -x "$3" -std="$2" $warnings $FLAGS -fsyntax-only -I"$prefix/include" -
    done
}

if [ "$language" = c ]; then
    for standard in c99 c11 c17; do
        check "$CC" $standard c
    done
    exit 0
fi
if [ ! -x "$CXX" ]; then
    echo "skipped: no C++ compiler" >&2
    exit 77
fi
for standard in c++11 c++17; do
    check "$CXX" $standard c++
done

#!/bin/sh
# Every public header compiles by itself, as C99 and as C++11, without a warning.
#   test_headers.sh CC CXX INCLUDE BUILT_INCLUDE          CXX may be empty: no C++ compiler here
set -eu
cc=$1 cxx=$2
shift 2
flags="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only"
count=0
for folder in "$@"; do
    for header in "$folder"/meniscus/*.h; do
        [ -e "$header" ] || continue
        name=meniscus/$(basename "$header")
        # shellcheck disable=SC2086 # one word per flag
        printf '#include <%s>\n#include <%s>\nint used;\n' "$name" "$name" | "$cc" -std=c99 $flags -I"$1" -I"$2" -x c -
        # shellcheck disable=SC2086
        [ -z "$cxx" ] || printf '#include <%s>\n#include <%s>\nint used;\n' "$name" "$name" | "$cxx" -std=c++11 $flags -I"$1" -I"$2" -x c++ -
        count=$((count + 1))
    done
done
[ "$count" -ge 8 ] || { echo "only $count headers found"; exit 1; }
echo "$count headers"

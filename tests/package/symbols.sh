#!/bin/sh
# symbols.sh KIND PREFIX: a shared library exports what the headers declare and nothing else; the names in a static library all begin
# with mns_, so that they meet no one else's. Names that begin with an underscore are the compiler's and the sanitizers' own.
set -eu
kind=$1 prefix=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

sed -n 's/^MNS_API [^(]*[ *]\(mns_[a-z0-9_]*\)(.*/\1/p' "$prefix"/include/meniscus/*.h | sort -u >"$work/declared"
[ "$(wc -l <"$work/declared")" -gt 20 ] || { echo "too few functions found in the headers" >&2; exit 1; }

if [ "$kind" = shared ]; then
    find "$prefix" -name 'libmeniscus*.so' -exec "$NM" -D --defined-only {} +
else
    find "$prefix" -name 'libmeniscus*.a' -exec "$NM" -g --defined-only {} +
fi | awk 'NF == 3 { print $3 }' | grep -v '^_' | sort -u >"$work/defined"

if [ "$kind" = shared ]; then
    comm -13 "$work/declared" "$work/defined" | sed 's/^/exported but not declared: /' >"$work/faults"
else
    grep -v '^mns_' "$work/defined" | sed 's/^/without mns_: /' >"$work/faults" || true
fi
cat "$work/faults" >&2
[ ! -s "$work/faults" ]

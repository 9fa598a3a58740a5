#!/bin/sh
# docs/options.md is what the program says, and the manual page names every option.
. "$(dirname "$0")/common.sh"
docs=$2/docs

ok --help-options
cmp -s .out "$docs/options.md" || complain "docs/options.md is out of date: meniscus --help-options >docs/options.md"
for option in $(grep -o '^| `[^`]*`' .out | grep -o -- '--[a-z-]*' | sort -u); do
    sed 's/\\-/-/g' "$docs/meniscus.1" | grep -q -- "$option" || complain "docs/meniscus.1 does not tell of $option"
done
done_testing

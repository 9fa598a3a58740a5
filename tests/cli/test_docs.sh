#!/bin/sh
# docs/options.md is what the program says, and the manual page names every option.
. "$(dirname "$0")/common.sh"
docs=$2/docs

ok --help-options
cmp -s .out "$docs/options.md" || complain "docs/options.md is out of date: meniscus --help-options >docs/options.md"
"$program" --help-look-schema >schema.json 2>.err || complain "--help-look-schema: $(cat .err)"
cmp -s schema.json "$docs/look.schema.json" || complain "docs/look.schema.json is out of date: meniscus --help-look-schema >docs/look.schema.json"
for option in $(grep -o '^| `[^`]*`' .out | grep -o -- '--[a-z-]*' | sort -u); do
    sed 's/\\-/-/g' "$docs/meniscus.1" | grep -q -- "$option" || complain "docs/meniscus.1 does not tell of $option"
done
done_testing

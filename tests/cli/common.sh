# shellcheck shell=sh
# Shared by the tests of the program, whose first argument it is; they run in a folder of their own, which is emptied first.
set -u
program=$1
name=$(basename "$0" .sh)
rm -rf "cli_$name"
mkdir "cli_$name"
cd "cli_$name" || exit 1
failures=0

complain()
{
    echo "FAILED: $*" >&2
    failures=$((failures + 1))
}

# ok ARGUMENTS...: succeeds, with nothing on standard error.
ok()
{
    "$program" "$@" >.out 2>.err
    status=$?
    [ $status = 0 ] || complain "meniscus $*: status $status: $(cat .err)"
    [ ! -s .err ] || complain "meniscus $*: said: $(cat .err)"
}

# warns WORDS ARGUMENTS...: succeeds, with one line that holds the words.
warns()
{
    words=$1
    shift
    "$program" "$@" >.out 2>.err
    status=$?
    [ $status = 0 ] || complain "meniscus $*: status $status: $(cat .err)"
    one_line "$words" "$@"
}

# refuses STATUS WORDS ARGUMENTS...: fails so, with one line that holds the words.
refuses()
{
    wanted=$1
    words=$2
    shift 2
    "$program" "$@" >.out 2>.err
    status=$?
    [ $status = "$wanted" ] || complain "meniscus $*: status $status, not $wanted: $(cat .err)"
    one_line "$words" "$@"
}

one_line()
{
    words=$1
    shift
    [ "$(wc -l <.err)" -eq 1 ] || complain "meniscus $*: not one line: $(cat .err)"
    grep -q '^meniscus: ' .err || complain "meniscus $*: does not say who speaks: $(cat .err)"
    grep -qF -- "$words" .err || complain "meniscus $*: lacks '$words': $(cat .err)"
}

# prints PATTERN: what the last command printed matches.
prints() { grep -q -- "$1" .out || complain "printed no '$1': $(cat .out)"; }

# holds PATTERN FILE
holds() { grep -q -- "$1" "$2" || complain "$2 holds no '$1': $(cat "$2")"; }

exists() { for file in "$@"; do [ -s "$file" ] || complain "$file is not there"; done; }
missing() { for file in "$@"; do [ ! -e "$file" ] || complain "$file should not be there"; done; }

# is_png FILE WIDTH HEIGHT CHANNELS
is_png()
{
    type=2
    [ "$4" = 4 ] && type=6
    wanted=$(printf '%d %d 8 %d' "$2" "$3" $type)
    got=$(od -An -tu1 -N26 "$1" | tr -s ' \n' ' ' | awk '{ print $17 * 16777216 + $18 * 65536 + $19 * 256 + $20, $21 * 16777216 + $22 * 65536 + $23 * 256 + $24, $25, $26 }')
    [ "$got" = "$wanted" ] || complain "$1 is '$got', not '$wanted' (width, height, bits, type)"
}

# nothing_left: no half-written file lies about.
nothing_left()
{
    left=$(find . -name '*.tmp-*')
    [ -z "$left" ] || complain "left behind: $left"
}

done_testing()
{
    nothing_left
    [ $failures = 0 ] || { echo "$failures failures" >&2; exit 1; }
}

#!/bin/sh
# The lab: text, JSON, CSV, plot and pictures; wrong usage, and places where nothing can be written.
. "$(dirname "$0")/common.sh"
small='--size 320x240 --repeat 1 --threads 2'

ok lab $small --filter none,narrow-range-1d --scenes drop-0,waves --equal-time 50 --plot plot.svg
prints '^320x240, '
prints '^drop-0: '
prints '^waves: '
prints '^  narrow-range-1d .*[0-9]\.[0-9]'
prints '^at equal time: .* 50 ms'
[ "$(grep -c '^  none  ' .out)" = 3 ] || complain "not a line each for none in two scenes and at equal time"
holds '^<svg ' plot.svg
holds 'narrow-range-1d</text>' plot.svg
tail -1 plot.svg | grep -q '^</svg>$' || complain "the plot does not end"

ok lab $small --filter none --filter gaussian --scenes step --json
for key in width height isa threads radius_pixels measures rows claims scene filter depth_rms edge beside_depth ms; do
    prints "\"$key\":"
done
prints '"filter":	"gaussian"'
ok lab $small --filter none --scenes plane-0 --csv -o table.csv
[ ! -s .out ] || complain "-o: printed all the same"
holds '^scene,filter,drift,depth_rms,' table.csv
[ "$(wc -l <table.csv)" = 2 ] || complain "a scene and a filter are not two lines: $(cat table.csv)"
awk -F, 'NF != n && NR > 1 { exit 1 } { n = NF }' table.csv || complain "lines of table.csv differ in length"
ok lab $small --filter none --scenes plane-0 --set radius_scale=1.5 --json
prints '"radius_pixels":	7.5'

# Everything but the milliseconds is the same again, with any number of threads.
ok lab $small --filter narrow-range-1d --scenes sphere --csv -o one.csv --threads 1
ok lab $small --filter narrow-range-1d --scenes sphere --csv -o two.csv --threads 2
[ "$(sed 's/,[^,]*$//' one.csv)" = "$(sed 's/,[^,]*$//' two.csv)" ] || complain "the lab's numbers depend on threads"

if "$program" --version | grep -q '^writes: .*png'; then
    ok lab $small --filter none,gaussian --scenes step --pictures pictures
    is_png pictures/step-none.png 320 240 3
    is_png pictures/step-gaussian-normal.png 320 240 3
    is_png pictures/step.png 320 120 3
fi

ok lab --help
prints '^  drop-45 '
prints 'beside_depth'
refuses 2 "'sharpen' is none of none, narrow-range" lab --filter none,sharpen
refuses 2 "'' is none of plane-0" lab --scenes step,
refuses 2 'exclude each other' lab --json --csv
refuses 2 'takes no' lab crown.npz
refuses 2 'prints text' lab papers --json
refuses 2 'at least 320x240' lab --size 319x240
refuses 2 'milliseconds above 0' lab --equal-time 0
refuses 2 "'--eye' is no option of lab" lab --eye 1,2,3
refuses 2 "sigma" lab --sigma -1
refuses 1 'missing/a.json: cannot be written: No such file' lab -o missing/a.json
refuses 1 'missing/a.svg: cannot be written: No such file' lab --plot missing/a.svg
refuses 1 'missing/a: cannot be made: No such file' lab --pictures missing/a
if [ -w /dev/full ]; then
    "$program" lab $small --filter none --scenes step >/dev/full 2>.err
    [ $? = 1 ] || complain "a full disk: not status 1"
    one_line 'standard output: cannot be written: No space left' lab
fi
done_testing

#!/bin/sh
# A simulation's own foam: matched with the frames by number, told apart by name, refuses where it belongs to none.
. "$(dirname "$0")/common.sh"
small="--size 160x120 --threads 2"

mkdir in foam
for i in 3 4 5; do
    "$program" sample crown --particles 4000 -o in/f_$i.npz || exit 1
done
"$program" sample drop --particles 500 -o foam/diffuse_4_foam.npz || exit 1
"$program" sample drop --particles 300 -o foam/diffuse_4_spray.npz || exit 1
"$program" sample drop --particles 200 -o foam/diffuse_5_bubbles.npz || exit 1

ok render in -o plain_%d.png $small
"$program" render in -o with_%d.png $small --foam-particles foam --verbose >.out 2>.err || complain "render: $(cat .err)"
grep -q "frame 4: 800 diffuse particles" .err || complain "the files of frame 4 are not put together: $(cat .err)"
grep -q "frame 5: 200 diffuse particles" .err || complain "frame 5: $(cat .err)"
cmp -s plain_3.png with_3.png || complain "a frame without foam files is another picture"
cmp -s plain_4.png with_4.png && complain "the foam of frame 4 does not show"
cmp -s plain_5.png with_5.png && complain "the bubbles of frame 5 do not show"

# A pattern, and a single frame of a sequence.
ok render in -o part_%d.png $small --frames 4 --foam-particles foam/diffuse_%d_foam.npz --foam-particles foam/diffuse_%d_spray.npz
cmp -s part_4.png with_4.png || complain "by pattern the picture is another"

# What belongs to no frame.
cp foam/diffuse_4_foam.npz foam/late_9_foam.npz
refuses 2 "matches no frame" render in -o x_%d.png $small --foam-particles foam/late_9_foam.npz
cp foam/diffuse_4_foam.npz foam/foam.npz
refuses 2 "no number" render in -o x_%d.png $small --foam-particles foam/foam.npz
rm foam/foam.npz
warns "1 of 4 files match no frame" render in -o x_%d.png $small --foam-particles foam
refuses 2 "noise" render in -o x_%d.png $small --foam noise --foam-particles foam
refuses 1 "nothing_" render in -o x_%d.png $small --foam-particles nothing_%d.npz
done_testing

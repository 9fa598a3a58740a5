#!/bin/sh
# Foam over a sequence: a part of it is drawn as in the whole, and files that are not as they should be get a line each.
. "$(dirname "$0")/common.sh"
small="--size 96x72 --threads 2 --eye 1.5,1.5,2.5 --target 0.5,0.3,0.3"
short="--foam layered --set foam_lifetime=0.15 --set foam_fade_in=0.06 --set foam_fade_out=0.05 --set noise_cooldown=0.1"

# frame NUMBER FILE [AWK]: 400 particles of which every third is thrown about in some frames; ids in another order in each. AWK changes one: x, y, z, speed, id.
frame()
{
    awk -v n="$1" "BEGIN {
        print \"x,y,z,velocity:0,velocity:1,velocity:2,density,id\"
        for (p = 0; p < 400; p++) {
            i = (p * 7 + n) % 400
            x = i % 10 * 0.1; y = int(i / 10) % 8 * 0.1; z = int(i / 80) * 0.1
            speed = (i % 3 == 0 && (i + n) % 11 < 2) ? 4 : 0.1; id = i
            ${3-}
            printf \"%g,%g,%g,0,%g,0,%g,%d\n\", x, y + n * 0.001, z, speed, (y > 0.55 ? 880 : 1000), id
        }
    }" >"$2"
}

mkdir in whole part
n=1
while [ $n -le 24 ]; do
    frame $n in/f_$n.csv
    n=$((n + 1))
done
ok render in -o whole/p_%02d.png $small $short
ok render in -o plain_%02d.png $small --frames 20
cmp -s whole/p_20.png plain_20.png && complain "foam changes nothing"

# max(2 * 0.15, 0.1) + 0.06 s at 30 frames a second: 11 frames, and two more.
"$program" render in -o part/p_%02d.png $small $short --frames 22:24 --verbose >.out 2>.err || complain "a part: $(cat .err)"
[ "$(grep -c 'particles with foam' .err)" = 16 ] || complain "a part reads $(grep -c 'particles with foam' .err) frames, not 3 + 13"
ok render in -o part/p_%02d.png $small $short --frames 4:16:6
ok render in -o part/p_%02d.png $small $short --frames 18
for n in 04 10 16 18 22 23 24; do
    cmp -s part/p_$n.png whole/p_$n.png || complain "frame $n of a part is not that of the whole"
done
cp whole/p_2*.png part
rm part/p_21.png part/p_24.png
ok render in -o part/p_%02d.png $small $short --frames 19: --resume
for n in 19 21 24; do
    cmp -s part/p_$n.png whole/p_$n.png || complain "frame $n of a resumed run is not that of the whole"
done

# A frame that cannot be read is no frame of the sequence, in a part as in the whole.
cp -r in holed
echo nothing >holed/f_12.csv
"$program" render holed -o h_%02d.png $small $short --keep-going --frames 20:21 >.out 2>.err && complain "a bad frame: status 0"
"$program" render holed -o all_%02d.png $small $short --keep-going >.out 2>.err && complain "a bad frame: status 0"
cmp -s h_20.png all_20.png || complain "beside a bad frame a part is not the whole"

# No file has to bring anything but positions.
mkdir bare
for n in 1 2 3; do
    cut -d, -f1-3 in/f_$n.csv >bare/f_$n.csv
done
ok render bare -o bare_%d.png $small $short
warns 'one frame without velocities' render bare/f_1.csv -o one.png $small --foam layered
ok render bare/f_1.csv -o one.png $small --foam layered --quiet
ok render in/f_3.csv -o one.png $small --foam noise

# The time between frames is that of a .pvd, else 1 / fps.
{
    echo '<VTKFile type="Collection"><Collection>'
    for n in 1 2 3; do
        "$program" convert bare/f_$n.csv -o timed_$n.vtp || exit 1
        echo "<DataSet timestep=\"$n\" file=\"timed_$n.vtp\"/>"
    done
    echo '</Collection></VTKFile>'
} >timed.pvd
fast="--foam layered --set foam_weber_low=1e-5 --set foam_weber_high=1e-3 --set foam_air=0"
ok render timed.pvd -o timed_%d.png $small $fast
ok render timed.pvd -o again_%d.png $small $fast --fps 1000
cmp -s timed_3.png again_3.png || complain "--fps changes the times of a .pvd"
ok render bare -o slow_%d.png $small $fast --fps 1
ok render bare -o fast_%d.png $small $fast --fps 1000
cmp -s slow_3.png fast_3.png && complain "--fps changes no velocities"
cmp -s slow_3.png timed_3.png || complain "one frame a second is not --fps 1"

# A line for each thing that is wrong, once for all frames.
bad() # bad WORDS AWK: frame 2 of three is changed
{
    mkdir -p bad
    frame 1 bad/f_1.csv
    frame 2 bad/f_2.csv "$2"
    frame 3 bad/f_3.csv
    warns "$1" render bad -o bad_%d.png $small $short
}
mkdir nameless
frame 2 shorter.csv 'if (i > 389) continue'
for n in 1 2 3; do
    cut -d, -f1-7 in/f_$n.csv >nameless/f_$n.csv
done
cut -d, -f1-7 shorter.csv >nameless/f_2.csv
warns 'changes from 400 to 390 and they have no ids' render nameless -o nameless_%d.png $small $short
bad 'have the id of another (the first such id: 7)' 'if (p == 399) { print "0,0,2,0,0,0,880,7" }'
bad 'would cross the scene' 'if (i == 8) speed = 1e5'
refuses 2 "must be one of none, noise, layered" render in -o x_%d.png --foam foamy
refuses 2 'foam_weber_low' render in/f_1.csv -o one.png $small --foam layered --set foam_weber_low=3
ok bench in/f_3.csv --size 64x48 --repeat 2 --warmup 0 --foam layered
prints 'classify'

done_testing

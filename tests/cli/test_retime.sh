#!/bin/sh
# Pictures between frames: where the particles are, by the middle of what is drawn, and how large, by the pixels that are covered.
. "$(dirname "$0")/common.sh"
# x from -1 to 2, y from -0.75 to 0.75 metres, 32 pixels each
view="--size 96x48 --threads 2 --eye 0.5,0,5 --target 0.5,0,0 --orthographic 1.5 --radius 0.1 --filter none --floor off --background transparent --display opaque"

# places FRAMES...: for each picture the mean x in metres of what is drawn, and how many pixels that is.
places()
{
    # shellcheck disable=SC2086 # words
    "$program" render "$@" $view -o - --output-format rgba >.raw 2>.err || complain "render $*: $(cat .err)"
    [ ! -s .err ] || complain "render $* said: $(cat .err)"
    od -An -v -tu1 -w4 .raw | awk '
        $4 > 127 { n++; sum += (NR - 1) % 96 + 0.5 }
        NR % (96 * 48) == 0 { printf "%.2f %d\n", n ? sum / n / 32 - 1 : 9, n; n = 0; sum = 0 }' >.places
}

# near COLUMN VALUES...: what the pictures have in that column, within 0.02 metres or 2 pixels.
near()
{
    column=$1
    shift
    echo "$@" | tr ' ' '\n' >.wanted
    [ "$(wc -l <.wanted)" = "$(wc -l <.places)" ] || complain "$(wc -l <.places) pictures, not $#"
    paste -d' ' .wanted .places | awk -v column="$column" -v most="$([ "$column" = 1 ] && echo 0.02 || echo 2)" '
        { d = $(column + 1) - $1; if (d > most || d < -most) { print "line " NR ": " $(column + 1) ", not " $1 > "/dev/stderr"; bad = 1 } }
        END { exit bad }' || complain "in column $column: $(tr '\n' ' ' <.places)"
}

# Without velocities, straight lines.
mkdir line fall swap born jump timed
printf 'x,y,z\n0,0,0\n' >line/f_1.csv
printf 'x,y,z\n1,0,0\n' >line/f_2.csv
places line --retime 4
near 1 0 0.25 0.5 0.75 1
# With velocities, cubics: from rest, x = t^2, in whatever unit of time the velocities are.
printf 'x,y,z,vx,vy,vz\n0,0,0,0,0,0\n' >fall/f_1.csv
printf 'x,y,z,vx,vy,vz\n1,0,0,50,0,0\n' >fall/f_2.csv
places fall --retime 4
near 1 0 0.06 0.25 0.56 1
# Velocities that have nothing to do with it are not used.
printf 'x,y,z,vx,vy,vz\n0,0,0,0,9,1\n' >fall/g_1.csv
printf 'x,y,z,vx,vy,vz\n1,0,0,0,-4,1\n' >fall/g_2.csv
places fall/g_%d.csv --retime 2
near 1 0 0.5 1

# By id: two rows, which do not cross although their order does. The middle row stays empty.
printf 'x,y,z,id\n0,0.5,0,7\n0,-0.5,0,9\n' >swap/f_1.csv
printf 'x,y,z,id\n1,-0.5,0,9\n1,0.5,0,7\n' >swap/f_2.csv
places swap --retime 2
near 1 0 0.5 1
tail -c +$((96 * 48 * 4 + 96 * 20 * 4 + 1)) .raw | head -c $((96 * 8 * 4)) | od -An -v -tu1 -w4 | awk '$4 > 0 { bad = 1 } END { exit bad }' ||
    complain "particles of other ids are taken for one another"
places swap --retime 2 --attribute id=
tail -c +$((96 * 48 * 4 + 96 * 20 * 4 + 1)) .raw | head -c $((96 * 8 * 4)) | od -An -v -tu1 -w4 | awk '$4 > 0 { seen = 1 } END { exit !seen }' ||
    complain "without ids, particles are not taken by their order"
# Particles of the same id: the k-th is the k-th.
printf 'x,y,z,id\n0,0.5,0,7\n0,-0.5,0,7\n' >swap/g_1.csv
printf 'x,y,z,id\n1,0.5,0,7\n1,-0.5,0,7\n' >swap/g_2.csv
places swap/g_%d.csv --retime 2
near 1 0 0.5 1

# What appears grows, what vanishes shrinks, and both go on as fast as they are.
printf 'x,y,z,vx,vy,vz,id\n0,0.4,0,1,0,0,1\n0,0,0,1,0,0,2\n' >born/f_1.csv
printf 'x,y,z,vx,vy,vz,id\n1,0.4,0,1,0,0,1\n1,0,0,1,0,0,3\n' >born/f_2.csv
places born --retime 2
near 1 0 0.5 1
one=$(awk 'NR == 1 { print int($2 / 2) }' .places)
near 2 $((2 * one)) $((one + one / 4)) $((2 * one)) # one whole, and two of half the radius that are in the same place

# A jump is one that vanishes and one that appears: none is drawn on its way.
i=1
while [ $i -le 40 ]; do
    printf '%s,0,0\n' "-0.$((500 + i))"
    i=$((i + 1))
done >rest.txt
{ printf 'x,y,z\n-0.9,0.5,0\n'; cat rest.txt; } >jump/f_1.csv
{ printf 'x,y,z\n1.8,0.5,0\n'; sed 's/^-0.5/-0.4/' rest.txt; } >jump/f_2.csv
places jump --retime 2
tail -c +$((96 * 48 * 4 + 1)) .raw | head -c $((96 * 48 * 4)) | od -An -v -tu1 -w384 | awk '{ seen += $(4 * 48) > 0 } END { exit seen > 0 }' ||
    complain "a particle that jumps is drawn on its way"

# Times of a .pvd: frames at 0, 1 and 3 seconds give pictures that are as far from each other as their times.
for i in 0 1 3; do
    printf 'x,y,z\n%s,0,0\n' "$(echo $i | sed 's/1/0.3333333/; s/3$/1/')" >timed/t_$i.csv
done
printf 'x,y,z\n0.333333333,0,0\n' >timed/t_1.csv
printf '<VTKFile type="Collection"><Collection>' >timed/all.pvd
for i in 0 1 3; do printf '<DataSet timestep="%s" file="t_%s.csv"/>' $i $i; done >>timed/all.pvd
printf '</Collection></VTKFile>' >>timed/all.pvd
if "$program" --version | grep -q 'reads:.*pvd'; then
    places timed/all.pvd --retime 2
    near 1 0 0.25 0.5 0.75 1
fi

# Pictures at frames are the frames' own; numbers are K times the frame's; parts are the whole; a frame that is missing takes its pictures along.
"$program" sample waves --particles 3000 -o wave.npz
mkdir whole part
for i in 3 4 5 6; do ln -s ../wave.npz whole/f_$i.npz; done
ok render whole -o whole/p_%d.png --size 64x48 --retime 3
[ "$(find whole -name 'p_*.png' | wc -l)" = 10 ] || complain "4 frames by --retime 3: $(find whole -name 'p_*.png' | wc -l) pictures"
ok render whole -o part/n_%d.png --size 64x48
cmp -s whole/p_12.png part/n_4.png || complain "picture 12 is not frame 4"
ok render whole -o part/p_%d.png --size 64x48 --retime 3 --frames 4::2
for i in 12 13 14 18; do cmp -s whole/p_$i.png part/p_$i.png || complain "part: picture $i differs"; done
missing part/p_11.png part/p_15.png
rm whole/f_5.npz
: >whole/f_5.npz
"$program" render whole -o part/k_%d.png --size 64x48 --retime 3 --keep-going >.out 2>.err
[ $? = 1 ] || complain "--retime with a bad frame: not status 1"
holds '5 of 10 pictures are missing' .err
exists part/k_12.png part/k_18.png
missing part/k_13.png part/k_15.png part/k_17.png
refuses 2 'must be a whole number of pictures per frame' render whole -o part/%d.png --retime 0

# A shutter: the middle of the streak is half its way on, it covers what the particle passes, and holds as much as the particle, a disc of 3.84
# pixels' radius; a resting one looks as ever.
places line --shutter 0 --frames 1
still=$(cut -d' ' -f2 .places)
"$program" render line $view --frames 1 --shutter 1 --shutter-samples 32 -o - --output-format rgba >.raw
od -An -v -tu1 -w4 .raw | awk -v still="$still" '$4 > 0 { n++; sum += $4 * ((NR - 1) % 96 + 0.5); light += $4 }
    END { x = sum / light / 32 - 1; exit !(x > 0.47 && x < 0.53 && n > 3 * still && light / 255 > 42 && light / 255 < 50) }' ||
    complain "a streak is not where the particle passes"
printf 'x,y,z\n0,0,0\n' >line/f_2.csv
places line --shutter 0.5 --frames 1
near 1 0
near 2 "$still"
refuses 2 'must be the part of the time' render line -o no.png --shutter 2
done_testing

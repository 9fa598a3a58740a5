#!/bin/sh
# Long sequences: killed and resumed, bad frames, pictures that cannot be written, several processes at once.
. "$(dirname "$0")/common.sh"
small="--size 160x120 --threads 2"

mkdir in whole cut
for i in 1 2 3 4; do
    "$program" sample crown --particles $((2000 * i)) -o in/f_$i.npz || exit 1
done
i=5
while [ $i -le 60 ]; do
    ln -s f_$((i % 4 + 1)).npz in/f_$i.npz
    i=$((i + 1))
done
ok render in -o whole/p_%02d.png $small --layer depth=whole/d_%02d.npy

# Killed without a word in the middle, and cut files: --resume gives what an undisturbed run gives, byte for byte.
"$program" render in -o cut/p_%02d.png $small --layer depth=cut/d_%02d.npy >.out 2>.err &
child=$!
tries=0
while [ ! -e cut/p_08.png ] && [ $tries -lt 200 ]; do
    sleep 0.02
    tries=$((tries + 1))
done
kill -9 $child
wait $child 2>/dev/null
find cut -name '*.tmp-*' -exec rm {} +
missing cut/p_60.png
head -c 500 whole/p_03.png >cut/p_03.png
: >cut/p_04.png
head -c 5000 whole/d_05.npy >cut/d_05.npy
ok render in -o cut/p_%02d.png $small --layer depth=cut/d_%02d.npy --resume --stats stats.json
for file in whole/*; do
    cmp -s "$file" "cut/${file#whole/}" || complain "resumed: $file differs from an undisturbed run's"
done
[ "$(find cut -name '*.png' | wc -l)" = 60 ] || complain "resumed: there are $(find cut -name '*.png' | wc -l) pictures"
grep -q '"frame":	2,' stats.json && complain "--resume draws what is there"
holds '"frame":	3,' stats.json
ok render in -o cut/p_%02d.png $small --layer depth=cut/d_%02d.npy --resume --stats stats.json
[ "$(grep -c '"input"' stats.json)" = 0 ] || complain "--resume draws what is all there"
# Pictures of another size are another run's.
ok render in -o cut/p_%02d.png --size 80x60 --resume --frames 7
is_png cut/p_07.png 80 60 3

# Parts of a cluster's job, at the same time, are the whole.
mkdir parts
"$program" render in -o parts/p_%02d.png $small --frames 1::2 2>.err1 &
first=$!
ok render in -o parts/p_%02d.png $small --frames 2::2
wait $first || complain "a part: $(cat .err1)"
for file in whole/*.png; do
    cmp -s "$file" "parts/${file#whole/}" || complain "in parts: $file differs"
done
# Two runs of the same job write the same files, each of them whole.
"$program" render in -o parts/q_%02d.png $small --frames 1:9 2>.err1 &
first=$!
ok render in -o parts/q_%02d.png $small --frames 1:9
wait $first || complain "a twin: $(cat .err1)"
for i in 1 5 9; do
    cmp -s whole/p_0$i.png parts/q_0$i.png || complain "twins: picture $i differs"
done

# Empty and half frames: what is before them is written, what is behind is not, and one line tells.
mkdir bad out
for i in 1 2 3 4 5 6; do cp in/f_1.npz bad/f_$i.npz; done
: >bad/f_3.npz
head -c 40000 in/f_1.npz >bad/f_5.npz
refuses 1 'bad/f_3.npz: ' render bad -o out/p_%d.png $small
exists out/p_1.png out/p_2.png
missing out/p_3.png out/p_4.png
"$program" render bad -o out/q_%d.png $small --keep-going >.out 2>.err
[ $? = 1 ] || complain "--keep-going with bad frames: not status 1"
holds 'warning: bad/f_3.npz: ' .err
holds 'warning: bad/f_5.npz: ' .err
holds '2 of 6 pictures are missing' .err
[ "$(wc -l <.err)" = 3 ] || complain "--keep-going with bad frames: not three lines: $(cat .err)"
exists out/q_1.png out/q_2.png out/q_4.png out/q_6.png
missing out/q_3.png out/q_5.png

# A picture that cannot be written ends the run, and is told before anything that comes later: frame 5 is bad too.
mkdir out/r_2.png
refuses 1 'out/r_2.png: cannot be written: it is a folder' render bad -o out/r_%d.png $small --frames 1:2
exists out/r_1.png
: >bad/f_3.npz
refuses 1 'out/r_2.png: cannot be written: it is a folder' render bad -o out/r_%d.png $small
if [ -w /dev/full ]; then
    ln -s /dev/full out/s_2.png
    refuses 1 'out/s_2.png: cannot be written: No space left' render in -o out/s_%d.png $small
    exists out/s_1.png
fi
(
    failures=0
    ulimit -f 4
    refuses 1 'out/t_1.png: cannot be written: File too large' render in -o out/t_%d.png --size 640x480
    exit $failures
) || failures=$((failures + $?))
missing out/t_1.png
done_testing

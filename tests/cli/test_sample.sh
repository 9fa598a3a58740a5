#!/bin/sh
# Procedural particle sets: as many as asked for, the same every time, refused where they cannot be written.
. "$(dirname "$0")/common.sh"

for shape in crown drop waves block sphere; do
    for count in 1 2 10 1000 20k; do
        ok sample $shape --particles $count -o $shape.npz
        ok info --json $shape.npz
        prints "\"particles\":	$(echo $count | sed 's/k/000/'),"
        for attribute in position velocity density id; do
            prints "\"name\":	\"$attribute\""
        done
    done
    ok sample $shape --particles 20k -o again.npz
    cmp -s $shape.npz again.npz || complain "$shape differs from itself"
done

# A block of 1 m: its particles' radius is half the spacing that its volume and number ask for.
ok sample block --particles 64000 -o block.npy
ok info block.npy
prints 'particles   64000'
awk '/radius/ { exit !($2 > 0.0119 && $2 < 0.0131) }' .out || complain "the radius of a block of 40^3 is not 0.0125: $(grep radius .out)"

ok sample --help
prints '^  crown '
refuses 2 'there are crown, drop' sample castle --particles 10 -o a.npz
refuses 2 'written as .npz, .npy' sample crown --particles 10 -o a.vtk
refuses 1 'missing/a.npz: cannot be written: No such file' sample crown --particles 10 -o missing/a.npz
mkdir folder.npz
refuses 1 'is a folder' sample crown --particles 10 -o folder.npz
if [ -w /dev/full ]; then
    ln -s /dev/full full.npz
    refuses 1 'No space left' sample crown --particles 1000 -o full.npz
fi

# A file that may not grow so far, and a signal.
(ulimit -f 8 && "$program" sample block --particles 10000 -o long.npz 2>.err)
[ $? = 1 ] || complain "a file over its limit: not status 1"
one_line 'long.npz: cannot be written: File too large' sample
missing long.npz
"$program" sample crown --particles 50M -o endless.npz >.out 2>.err &
child=$!
sleep 0.3
kill -TERM $child
wait $child
[ $? = 143 ] || complain "a signal: status is not 143: $(cat .err)"
one_line 'stopped by a signal' sample
missing endless.npz
done_testing

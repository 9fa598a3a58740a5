#!/bin/sh
# OpenEXR pictures and layers, looked at with OpenEXR's own tools where they are installed.
. "$(dirname "$0")/common.sh"
small='--size 61x40 --quiet'

ok sample crown --particles 2000 -o in.npz
ok render in.npz -o a.exr $small --layers depth,normal,transmittance --layer 'thickness=t.exr' --preset oil
exists a.exr t.exr
ok render in.npz -o b.exr $small --exr-type float --background transparent
if command -v exrheader >/dev/null 2>&1; then
    exrheader a.exr >.out
    for words in '^    A, 16-bit floating-point' '^    R, 16-bit' '^    depth.Z, 32-bit' '^    normal.X, 32-bit' '^    transmittance.G, 16-bit' \
        '(0 0) - (60 39)' 'worldToCamera' '"refraction_index":1.47'; do
        prints "$words"
    done
    exrheader t.exr >.out
    prints '^    thickness.Y, 32-bit'
    exrheader b.exr >.out
    prints '^    A, 32-bit floating-point'
else
    echo 'skipped: no exrheader'
fi
if command -v exrinfo >/dev/null 2>&1; then
    exrinfo -s a.exr >.out 2>.err || complain "exrinfo refuses a.exr: $(cat .err)"
fi

# Sequences; only whole files are skipped.
mkdir in
cp in.npz in/f_1.npz
cp in.npz in/f_2.npz
ok render in -o 'o_%d.exr' $small --layers alpha
cmp -s o_1.exr o_2.exr || complain "equal frames, unequal files"
cp o_1.exr whole.exr
head -c 3000 whole.exr >o_1.exr
cp in.npz o_2.exr
ok render in -o 'o_%d.exr' $small --layers alpha --resume
cmp -s o_1.exr whole.exr || complain "--resume trusts half a file"
cmp -s o_2.exr whole.exr || complain "--resume trusts another file"
ok render in -o 'o_%d.exr' --size 64x40 --quiet --layers alpha --resume
cmp -s o_1.exr whole.exr && complain "--resume trusts a file of another size"

refuses 2 'needs an .exr OUTPUT' render in.npz -o no.png --layers depth
refuses 2 "did you mean 'depth'" render in.npz -o no.exr --layers dept
refuses 2 'asked for twice' render in.npz -o no.exr --layers depth,depth
refuses 2 'writes already' render in.npz -o no.exr --layers beauty
refuses 2 'none of half and float' render in.npz -o no.exr --exr-type double
refuses 1 'cannot be written' render in.npz -o no/such/a.exr
if [ -w /dev/full ]; then
    ln -s /dev/full full.exr
    refuses 1 'No space left' render in.npz -o full.exr $small
fi
missing no.png no.exr
done_testing

#!/bin/sh
# Meshes around the fluid: drawn, told apart from a tank, one per frame, and files that are none.
. "$(dirname "$0")/common.sh"
small="--size 64x48 --threads 2"

"$program" sample waves --particles 3000 -o in.npz || exit 1
box()
{
    awk -v low="$1" -v high="$2" 'BEGIN {
        for (i = 0; i < 8; i++) print "v", (i % 2 ? high : low), (int(i / 2) % 2 ? high : low), (int(i / 4) ? high : low)
        print "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4" }'
}
box -0.5 0.5 >box.obj
box -5 5 >tank.obj

ok render in.npz -o none.png --layer scene_depth=none.npy $small
ok render in.npz -o mesh.png --layer scene_depth=mesh.npy $small --mesh box.obj
cmp -s none.png mesh.png && complain "a mesh does not show"
ok render in.npz -o two.png $small --mesh box.obj --container tank.obj
cmp -s mesh.png two.png && complain "a container does not show"
ok render in.npz -o one.png --size 64x48 --threads 1 --mesh box.obj --container tank.obj
cmp -s one.png two.png || complain "1 and 2 threads differ"
ok render in.npz -o scaled.png $small --mesh box.obj --mesh-scale 0.5 --mesh-up z
cmp -s mesh.png scaled.png && complain "--mesh-scale does nothing"

# One per frame.
cp in.npz f_1.npz
cp in.npz f_2.npz
cp in.npz f_3.npz
cp box.obj body_1.obj
box -0.2 0.7 >body_2.obj
ok render f_1.npz f_2.npz -o out_%d.png $small --mesh body_%d.obj
cmp -s out_1.png out_2.png && complain "the mesh does not change"
refuses 1 'body_3.obj: cannot be read: No such file' render f_3.npz -o out_%d.png $small --mesh body_%d.obj

refuses 1 'missing.obj: cannot be read: No such file' render in.npz -o a.png $small --mesh missing.obj
refuses 1 'is no mesh by its name' render in.npz -o a.png $small --mesh in.npz
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' >points.obj
refuses 1 'points.obj: holds no faces' render in.npz -o a.png $small --mesh points.obj
refuses 2 '--mesh-scale' render in.npz -o a.png $small --mesh box.obj --mesh-scale 0
refuses 2 '--mesh-up' render in.npz -o a.png $small --mesh box.obj --mesh-up q
missing a.png
done_testing

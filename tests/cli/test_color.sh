#!/bin/sh
# Colours by an attribute: what may be asked for, ranges that a sequence shares, the legend.
. "$(dirname "$0")/common.sh"
small='--size 160x100 --quiet'

ok sample crown --particles 3000 -o in.npz
ok render in.npz -o plain.png $small
ok render in.npz -o speed.png $small --color-by velocity
ok render in.npz -o up.png $small --color-by velocity.y
ok render in.npz -o computed.png $small --color-by '0 - velocity.y' --colormap coolwarm
for other in plain up computed; do cmp -s speed.png $other.png && complain "$other.png is speed.png"; done
ok render in.npz -o a.png $small --color-by velocity --display color --colormap viridis
cmp -s a.png speed.png || complain "display color and viridis are not the default"
ok render in.npz -o beauty.png $small --color-by velocity --display beauty
cmp -s beauty.png speed.png && complain "--display beauty is not heard"
printf '68 1 84\n253 231 37\n' >two.txt
ok render in.npz -o two.png $small --color-by velocity --colormap two.txt
cmp -s two.png speed.png && complain "a map from a file is not used"
ok render in.npz -o a.png $small --color-by velocity --range 0:3
ok render in.npz -o b.png $small --color-by velocity --range 0:
cmp -s a.png b.png && complain "an open range is not the frame's own"
ok render in.npz -o turned.png $small --color-by velocity --range 3:0
cmp -s a.png turned.png && complain "a range the other way round changes nothing"

# The legend stands at the right, and nowhere else.
ok render in.npz -o legend.npy --size 320x200 --quiet --color-by velocity --legend
ok render in.npz -o none.npy --size 320x200 --quiet --color-by velocity
ok render in.npz -o other.npy --size 320x200 --quiet --color-by velocity --legend --units furlongs
cmp -s legend.npy other.npy && complain "--units changes nothing"
ok render in.npz -o clear.png $small --color-by velocity --legend --background transparent
is_png clear.png 160 100 4
ok render in.npz -o tiny.png --size 8x8 --quiet --color-by velocity --legend
ok render in.npz -o same.png $small --color-by '1' --legend
for python in python3 /usr/bin/python3; do # numpy may be packaged for one of them
    "$python" -c 'import numpy' 2>/dev/null || continue
    "$python" - >.out 2>&1 <<'END' || complain "the legend: $(cat .out)"
import numpy
legend, none = numpy.load('legend.npy'), numpy.load('none.npy')
ys, xs = numpy.nonzero(numpy.abs(legend - none).max(axis=2) > 0)
assert xs.min() > 160 and len(xs) > 200, (xs.min(), len(xs))
def srgb(v): return numpy.where(v <= 0.0031308, 12.92 * v, 1.055 * numpy.maximum(v, 0) ** (1 / 2.4) - 0.055) * 255
picture = srgb(legend[:, :, :3])
for color in ((68, 1, 84), (33, 144, 140), (253, 231, 37)):  # the ends and the middle of viridis
    assert (numpy.abs(picture - color).max(axis=2) < 12).any(), color
END
    compared=yes
    break
done
[ "${compared:-}" ] || echo 'skipped: no numpy'

# Frames of a sequence share the range, whichever of them are drawn.
mkdir in
for i in 1 2 3 4; do printf 'x y z v\n' >in/f_$i.csv; awk -v i=$i 'BEGIN { for (k = 0; k < 64; k++) print k % 4, int(k / 4) % 4, int(k / 16), k * i }' >>in/f_$i.csv; done
ok render in -o 'all_%d.png' $small --color-by v --legend
ok render in -o 'part_%d.png' $small --color-by v --legend --frames 2
cmp -s all_2.png part_2.png || complain "a part of the sequence has another range"
ok render in -o 'fixed_%d.png' $small --color-by v --legend --range 0:1 --frames 2
cmp -s all_2.png fixed_2.png && complain "--range is not heard in a sequence"

refuses 1 "no attribute 'pressure'; there is position" render in.npz -o no.png --color-by pressure
refuses 1 "value 'w': column 1: no attribute" render in -o 'no_%d.png' --color-by w
refuses 2 "did you mean 'viridis'" render in.npz -o no.png --color-by velocity --colormap virids
refuses 1 'no_such.txt: cannot be opened' render in.npz -o no.png --color-by velocity --colormap no_such.txt
refuses 2 'need --color-by' render in.npz -o no.png --legend
for range in 1 1:2:3 a:b : 1:x nan:1 ''; do
    [ "$range" = : ] || refuses 2 'must be A:B' render in.npz -o no.png --color-by velocity --range "$range"
done
missing no.png
done_testing

#!/bin/sh
# Several fluids in one picture: their order at each pixel, layers, sequences, what is refused.
. "$(dirname "$0")/common.sh"
small='--size 64x64 --quiet'

# block X Z: particles from there on, a metre high, 0.5 deep.
block()
{
    awk -v x="$1" -v z="$2" 'BEGIN { print "x y z"; for (i = 0; i < 10; i++) for (j = 0; j < 10; j++) for (k = 0; k < 5; k++) print x + i / 10, j / 10, z + k / 10 }'
}
block 0 0 >back.csv
block 0 1 >front.csv
block 0.4 0.2 >across.csv

# pixel FILE CHANNELS X Y: values of a 64x64 .npy file, whose header ends at a multiple of 64 bytes.
pixel()
{
    skip=$(($(wc -c <"$1") - 4 * 64 * 64 * $2 + 4 * $2 * (64 * $4 + $3)))
    od -An -tf4 -j $skip -N $((4 * $2)) "$1"
}

# is WORDS AWK-CONDITION: the values in $1, $2, ... are so.
is() { echo "$3" | awk "{ exit !($2) }" || complain "$1: $3"; }

# Nothing is reflected, over white: one sees absorption alone.
plain='--size 64x64 --orthographic 2 --eye 0.45,0.45,5 --target 0.45,0.45,0 --background ffffff --floor off --set reflection=0 --set specular=0 --set fluid_color=0,0,0 --set refraction_strength=0'
tints='--set red.absorption=0.1,9,9 --set green.absorption=9,0.1,9'
ok render --fluid red=back.csv --fluid green=front.csv -o behind.npy $plain $tints --layer depth=behind_d.npy --layer thickness=behind_t.npy
ok render --fluid red=front.csv --fluid green=back.csv -o before.npy $plain $tints --layer depth=before_d.npy
for file in behind before; do
    is "both absorb" '$1 < 0.05 && $2 < 0.05 && $3 < 0.05' "$(pixel $file.npy 4 32 32)"
    is "the front of the nearer one" '$1 > 3.4 && $1 < 3.7' "$(pixel ${file}_d.npy 1 32 32)"
    is "nothing in the corner" '$1 > 0.98 && $2 > 0.98 && $3 > 0.98 && $4 == 1' "$(pixel $file.npy 4 1 1)"
done
is "thicknesses add up" '$1 > 0.9 && $1 < 1.1' "$(pixel behind_t.npy 1 32 32)"

# An opaque one hides what is behind it and nothing else.
opaque='--set red.display=opaque --set red.opaque_color=0.9,0,0'
ok render --fluid green=back.csv --fluid red=front.csv -o hides.npy $plain $tints $opaque
is "red hides green" '$1 > 0.1 && $2 < 0.01' "$(pixel hides.npy 4 32 32)"
ok render --fluid green=front.csv --fluid red=back.csv -o hidden.npy $plain --set green.absorption=0.7,0.1,0.7 $opaque
is "red through green" '$1 > 0.05 && $2 < 0.01 && $1 < 0.95 * '"$(pixel hides.npy 4 32 32 | awk '{ print $1 }')" "$(pixel hidden.npy 4 32 32)"

# Side by side and across: each alone, and both.
ok render --fluid red=back.csv --fluid green=across.csv -o across.npy $plain $tints
is "red alone" '$1 > 0.8 && $2 < 0.1' "$(pixel across.npy 4 22 32)"
is "both" '$1 < 0.1 && $2 < 0.1' "$(pixel across.npy 4 40 32)"
is "green alone" '$1 < 0.1 && $2 > 0.8' "$(pixel across.npy 4 54 32)"
ok render --fluid green=across.csv --fluid red=back.csv -o swapped.npy $plain $tints
is "the order of the options is none" '$1 < 0.1 && $2 > 0.8' "$(pixel swapped.npy 4 54 32)"
ok render --fluid red=back.csv --fluid green=across.csv -o clear.npy $plain $tints --background transparent --layer alpha=alpha.npy
is "alpha" '$1 > 0.55 && $1 < 0.75' "$(pixel alpha.npy 1 22 32)"
is "alpha of both" '$1 > 0.9' "$(pixel alpha.npy 1 40 32)"
is "straight alpha" '$4 > 0.55 && $4 < 0.75' "$(pixel clear.npy 4 22 32)"
ok render --fluid red=back.csv --fluid green=across.csv -o clear.png $small --background transparent
is_png clear.png 64 64 4

# One fluid is an input.
ok render back.csv -o plain.png $small --set absorption=1,2,3
ok render --fluid only=back.csv -o only.png $small --set only.absorption=1,2,3
cmp -s plain.png only.png || complain "--fluid alone is not the INPUT"
ok render back.csv --fluid more=front.csv -o more.png $small --anisotropy on
cmp -s plain.png more.png && complain "a fluid beside the INPUT is not drawn"

# Sequences: the same numbers, the same pictures whichever are drawn.
mkdir a b
for i in 1 2 3; do block 0 0.$i >a/a_$i.csv; block 0.3 1.$i >b/b_$i.csv; done
ok render --fluid a=a --fluid b=b -o 'all_%d.png' $small
exists all_1.png all_2.png all_3.png
ok render --fluid a=a/a_%d.csv --fluid b=b -o 'part_%d.png' $small --frames 2
cmp -s all_2.png part_2.png || complain "a part of the sequence is drawn in another way"
cp all_3.png kept.png
rm all_3.png
ok render --fluid a=a --fluid b=b -o 'all_%d.png' $small --resume
cmp -s all_3.png kept.png || complain "--resume draws another picture"
echo broken >b/b_2.csv
"$program" render --fluid a=a --fluid b=b -o 'going_%d.png' $small --keep-going >.out 2>.err && complain "a missing picture is no failure"
exists going_1.png going_3.png
missing going_2.png
rm b/b_2.csv
refuses 2 'they must be the same' render --fluid a=a --fluid b=b -o 'no_%d.png' $small

refuses 2 "did you mean 'green'" render --fluid red=back.csv --fluid green=front.csv -o no.png --set gren.absorption=1,1,1
refuses 2 "did you mean 'absorption'" render --fluid red=back.csv -o no.png --set red.absorbtion=1,1,1
refuses 2 'names it' render back.csv -o no.png --set red.absorption=1,1,1
refuses 2 'all fluids share' render --fluid red=back.csv -o no.png --set red.exposure=1
refuses 2 'named twice' render --fluid a=back.csv --fluid a=front.csv -o no.png
for value in a =x a= 'a b=x' a.b=x; do refuses 2 'must be NAME=FILES' render --fluid "$value" -o no.png; done
both='--fluid a=back.csv --fluid b=front.csv'
refuses 2 'one fluid, not of several' render $both -o no.png --foam layered
refuses 2 'one fluid, not several' render $both -o no.png --shutter 0.5
refuses 2 'layer position is of one fluid' render $both -o no.png --layer position=no.npy
refuses 2 'shows beauty' render $both -o no.png --display depth
refuses 1 'no_such.csv' render --fluid a=back.csv --fluid b=no_such.csv -o no.png
missing no.png
done_testing

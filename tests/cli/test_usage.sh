#!/bin/sh
# What the program says of itself, and wrong usage.
. "$(dirname "$0")/common.sh"

ok --version
prints '^meniscus [0-9]*\.[0-9]*\.[0-9]*$'
prints '^reads: .*npy'
prints '^writes images: .*npy'
prints '^writes particles: .*npz'
prints '^instruction sets: scalar'
ok --help
for command in render info convert bench sample lab; do
    prints "meniscus $command"
    "$program" $command --help >help.txt 2>.err || complain "$command --help: status $?"
    holds "^usage: meniscus $command" help.txt
    holds '--help' help.txt
done
ok render --help
for option in --output --size --eye --target --up --fov --orthographic --orbit --up-axis --radius --radius-scale --attribute --where --filter \
    --iterations --sigma --delta --mu --display --layer --floor --sun --exposure --background --look --save-look --set --frames --resume \
    --keep-going --backend --threads --isa --stats --quiet --verbose; do
    prints "^  .*$option "
done
prints 'absorption'

"$program" >.out 2>.err
[ $? = 2 ] || complain "no command: not status 2"
grep -q '^usage:' .err || complain "no command: no usage"
refuses 2 "unknown command 'rendr'" rendr
refuses 2 'render needs an input' render
refuses 2 'render needs an input' render -o a.png
refuses 2 'info needs an input' info
refuses 2 'bench needs an input' bench
refuses 2 'sample needs' sample
refuses 2 "unknown option '--nothing'" render a.npy -o a.png --nothing m.obj
refuses 2 "did you mean '--filter'" render a.npy -o a.png --fliter none
refuses 2 "'--repeat' is no option of render" render a.npy -o a.png --repeat 3
refuses 2 '--size needs a value' render a.npy -o a.png --size
refuses 2 '--resume takes no value' render a.npy -o a.png --resume=yes
for size in 12 x12 12x 0x5 5x0 12x34x 12X34 -3x4 99999x2 '' ' 3x4' 1e3x5; do
    refuses 2 "it must be WxH" render a.npy -o a.png --size "$size"
done
refuses 2 'three numbers' render a.npy -o a.png --eye 1,2
refuses 2 'three numbers' render a.npy -o a.png --eye 1,nan,2
refuses 2 'three numbers' render a.npy -o a.png --target 1,2,3,4
refuses 2 'points nowhere' render a.npy -o a.png --up 0,0,0
refuses 2 'degrees' render a.npy -o a.png --fov 180
for height in 0 -1 1e-300 1e300; do
    refuses 2 'height of the view' render a.npy -o a.png --orthographic $height
done
for option in --output --camera --look --save-look --stats; do
    refuses 2 "$option: the name is empty" render a.npy $option ''
done
refuses 2 'x, y, z' render a.npy -o a.png --up-axis w
refuses 2 'radius is 0' render a.npy -o a.png --radius 0
refuses 2 'radius is -1' render a.npy -o a.png --radius -1
refuses 2 'radius is nan' render a.npy -o a.png --radius nan
refuses 2 'radius is 1e99' render a.npy -o a.png --radius 1e99
refuses 2 'narrow-range-1d' render a.npy -o a.png --filter sharpen
refuses 2 'beauty, opaque' render a.npy -o a.png --display ugly
refuses 2 'thickness_raw' render a.npy -o a.png --layer thick=a.npy
refuses 2 'NAME=FILE' render a.npy -o a.png --layer depth
refuses 2 'written as .npy or .exr' render a.npy -o a.png --layer depth=a.tif
refuses 2 'asked for twice' render a.npy -o a.png --layer depth=a.npy --layer depth=b.npy
refuses 2 'ROLE=NAME' render a.npy -o a.png --attribute colour=C
refuses 2 'NAME=VALUE' render a.npy -o a.png --set sigma
refuses 2 "did you mean 'sigma'" render a.npy -o a.png --set sigmo=1
refuses 2 'mu must be at most delta' render a.npy -o a.png --mu 5 --delta 2
refuses 2 'on or off' render a.npy -o a.png --floor maybe
refuses 2 'AZ,EL' render a.npy -o a.png --sun 30
refuses 2 'RRGGBB' render a.npy -o a.png --background teal
refuses 2 'A:B:STEP' render a.npy -o a.png --frames a:b
refuses 2 'A:B:STEP' render a.npy -o a.png --frames 1:2:0
refuses 2 'A:B:STEP' render a.npy -o a.png --frames 99999999999999999999:
refuses 2 'auto, cpu' render a.npy -o a.png --backend vulkan
refuses 2 '1 to 1024' render a.npy -o a.png --threads 0
refuses 2 'scalar, sse2' render a.npy -o a.png --isa mmx
refuses 2 'png, rgba and y4m' render a.npy -o - --output-format jpg
refuses 2 'does not read' render - --format gif -o a.png
refuses 2 'whole number' bench a.npy --repeat 0
refuses 2 'whole number' sample crown --particles -5 -o a.npz
refuses 2 'whole number' sample crown --particles 5G -o a.npz
missing a.png a.npz

# A closed and a full standard output.
if [ -w /dev/full ]; then
    "$program" --help >/dev/full 2>.err
    [ $? = 1 ] || complain "--help on a full disk: not status 1"
    one_line 'standard output: cannot be written: No space left' --help
fi
done_testing

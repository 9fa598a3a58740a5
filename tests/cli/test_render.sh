#!/bin/sh
# Pictures: one, sequences, layers, looks, cameras, and every way in which they cannot be made.
. "$(dirname "$0")/common.sh"
small="--size 64x48 --threads 2"

"$program" sample waves --particles 3000 -o in.npz || exit 1
ok render in.npz -o a.png $small
is_png a.png 64 48 3
ok render in.npz -o b.png $small --threads 1
cmp -s a.png b.png || complain "1 and 2 threads differ"
ok render in.npz -o clear.png $small --background transparent
is_png clear.png 64 48 4
ok render in.npz -oa.npy --size=64x48
[ "$(wc -c <a.npy)" = $((128 + 64 * 48 * 4 * 4)) ] || complain "a.npy has $(wc -c <a.npy) bytes"
ok render in.npz --layer depth=d.npy --layer normal=n.npy $small
[ "$(wc -c <d.npy)" = $((128 + 64 * 48 * 4)) ] || complain "d.npy has $(wc -c <d.npy) bytes"
[ "$(wc -c <n.npy)" = $((128 + 64 * 48 * 12)) ] || complain "n.npy has $(wc -c <n.npy) bytes"

# Standard output and standard input.
"$program" render in.npz -o - --output-format rgba $small >raw 2>.err || complain "-o -: $(cat .err)"
[ "$(wc -c <raw)" = $((64 * 48 * 4)) ] || complain "raw has $(wc -c <raw) bytes"
"$program" render - --format npz -o - $small <in.npz >piped.png 2>.err || complain "- to -: $(cat .err)"
cmp -s a.png piped.png || complain "standard input or output differs from files"
refuses 2 'for standard output' render in.npz -o a.png --output-format png
refuses 2 'must be the only input' render - in.npz -o %d.png <in.npz
refuses 2 'standard output takes the picture' render in.npz -o - --stats -
refuses 2 'standard output takes the picture' render in.npz -o - --save-look -
ok render in.npz -o UPPER.PNG --layer depth=UPPER.NPY $small
exists UPPER.PNG UPPER.NPY

# The camera that is chosen shows everything: the border of the picture is empty, the middle is not.
"$program" sample block --particles 4000 -o block.npz
"$program" render block.npz -o - --output-format rgba --background transparent $small >border.raw 2>.err || complain "-o -: $(cat .err)"
od -An -v -tu1 -w256 border.raw >border.txt
awk '(NR == 1 || NR == 48) { for (i = 4; i <= NF; i += 4) bad += $i > 0 } { bad += $4 > 0 || $256 > 0; seen += $128 > 0 } END { exit bad || seen < 24 }' \
    border.txt || complain "the block is cut or small in the picture"

# Outputs that cannot be.
refuses 2 'this build writes' render in.npz -o a.avi
refuses 2 'this build writes' render in.npz -o a.tif
refuses 2 'this build writes' render in.npz -o a
refuses 2 'needs an output' render in.npz
refuses 2 'already' render in.npz -o b.npy --layer beauty=c.npy
refuses 2 'named for two outputs' render in.npz -o x.npy --layer depth=x.npy
"$program" sample sphere --particles 10 -o self.npy
refuses 2 'is an input' render self.npy -o self.npy
refuses 1 'missing/a.png: cannot be written: No such file' render in.npz -o missing/a.png $small
refuses 1 'missing/a.npy: cannot be written: No such file' render in.npz -o b.png --layer depth=missing/a.npy $small
refuses 1 'missing/a.json: cannot be written: No such file' render in.npz -o b.png --stats missing/a.json $small
mkdir folder.png
refuses 1 'folder.png: cannot be written: it is a folder' render in.npz -o folder.png $small
missing b.npy c.npy x.npy a.avi a.tif
if [ -w /dev/full ]; then
    ln -s /dev/full full.png
    refuses 1 'No space left' render in.npz -o full.png $small
    "$program" render in.npz -o - $small >/dev/full 2>.err
    [ $? = 1 ] || complain "a full standard output: not status 1"
    one_line 'standard output: cannot be written' render -o -
    refuses 1 '/dev/full: cannot be written' render in.npz -o c.png $small --stats /dev/full
fi

# A reader that goes away. The status goes through a file, since the pipe's is that of its last command.
{ "$program" render in.npz in.npz in.npz -o - --output-format rgba --size 512x512 2>.err; echo $? >status; } | head -c 1 >.first
[ "$(cat status)" = 1 ] || complain "a closed pipe: status $(cat status)"
one_line 'standard output: cannot be written: Broken pipe' render -o -

# Cameras.
ok render in.npz -o eye.png $small --eye 0,2,4
ok render in.npz -o both.png $small --eye 0,2,4 --target 0,0.4,0
cmp -s eye.png a.png && complain "--eye changes nothing"
ok render in.npz -o target.png $small --target 1,0,0 --up 0,0,1 --fov 20
ok render in.npz -o flat.png $small --orthographic 3 --up-axis z
refuses 2 'must differ' render in.npz -o no.png $small --eye 1,1,1 --target 1,1,1
printf '{"eye": [0, 2, 4], "target": [0, 0.4, 0], "fov": 45}\n' >camera.json
ok render in.npz -o file.png $small --camera camera.json
cmp -s both.png file.png || complain "a camera file is not what its options are"
printf '{"particles_file": "in.npz", "viewport": {"width": 64, "height": 48}, "camera": {"eye": [0, 2, 4], "target": [0, 0.4, 0], "vfov_deg": 45}}' >case.json
ok render case.json -o case.png
cmp -s both.png case.png || complain "a case file is not what its options are"
printf '{"eye": [0, 2]}' >bad.json
refuses 1 'bad.json: "eye" must be an array of 3 numbers' render in.npz -o no.png --camera bad.json
printf '{"eye": [0, 2,\n' >bad.json
refuses 1 'bad.json: line 2: is no JSON' render in.npz -o no.png --camera bad.json
refuses 1 'bad.json: line 2' render bad.json -o no.png
refuses 1 'nowhere.json: cannot be opened' render in.npz -o no.png --camera nowhere.json
printf '{"camera": {}}' >bad.json
refuses 1 'particles_file' render bad.json -o no.png

# Key frames: at a key the key's camera, between them neither, behind them the last.
for i in 1 2 3 4; do ln -s in.npz key_$i.npz; done
printf '{"keys": [{"frame": 1, "eye": [0, 2, 4], "target": [0, 0.4, 0]}, {"frame": 3, "eye": [2, 2, 3], "target": [0, 0.4, 0], "fov": 40}]}' >keys.json
ok render key_%d.npz -o key_%d.png $small --camera keys.json
ok render key_%d.npz -o fix_%d.png $small --eye 0,2,4 --target 0,0.4,0
cmp -s key_1.png fix_1.png || complain "the first key's camera is not what its options are"
cmp -s key_2.png key_1.png && complain "the camera stands still between keys"
cmp -s key_3.png key_4.png || complain "the camera moves behind the last key"
# A camera per frame, by the order of the frames, whatever their numbers: the same cameras give the same pictures.
printf '{"frames": [{"eye": [0, 2, 4], "target": [0, 0.4, 0]}, {"eye": [1, 2, 3.5], "target": [0, 0.4, 0]}, {"eye": [0, 2, 4], "target": [0, 0.4, 0]}]}' >each.json
ok render key_%d.npz -o each_%d.png $small --camera each.json
cmp -s each_1.png fix_1.png || complain "the first frame's camera is not what its options are"
cmp -s each_2.png fix_2.png && complain "the second frame has the first one's camera"
cmp -s each_3.png fix_3.png || complain "the third frame's camera is not what its options are"
cmp -s each_4.png fix_4.png || complain "a frame behind the last camera does not keep it"
printf '{"frames": [{"eye": [0, 2, 4]}]}' >bad.json
refuses 1 'each of "frames" must have an "eye" and a "target"' render in.npz -o no.png --camera bad.json
printf '{"keys": [{"frame": 1, "eye": [0, 2, 4]}]}' >bad.json
refuses 1 'must have a "frame", an "eye" and a "target"' render in.npz -o no.png --camera bad.json
printf '{"keys": [3]}' >bad.json
refuses 1 'must have a "frame"' render in.npz -o no.png --camera bad.json
printf '{"keys": []}' >bad.json
refuses 1 'must be an array of cameras' render in.npz -o no.png --camera bad.json
printf '{"keys": [{"frame": 1, "eye": [0, 2, 4], "target": [0, 0, 0]}, {"frame": 1, "eye": [0, 2, 4], "target": [0, 0, 0]}]}' >bad.json
refuses 1 'rising frames' render in.npz -o no.png --camera bad.json

# Looks.
ok render in.npz -o look1.png $small --set absorption=3,2,1 --filter narrow-range --exposure 0.5 --floor off --save-look look.json
holds '"filter":	"narrow-range"' look.json
holds '"absorption":	\[3,2,1\]' look.json
holds '"floor":	false' look.json
grep -q sigma look.json && complain "the look holds a default"
ok render in.npz -o look2.png $small --look look.json --save-look again.json
cmp -s look1.png look2.png || complain "a look file is not what its options are"
cmp -s look.json again.json || complain "a look changes when it is read and saved"
ok render in.npz -o look3.png $small --exposure 0.1 --look look.json --save-look again.json
holds '"exposure":	0.1' again.json
ok render in.npz -o plain.png $small --save-look - --quiet
prints '^{'
printf '{"sigmo": 1}' >bad.json
refuses 1 "bad.json: there is no parameter 'sigmo'" render in.npz -o no.png --look bad.json
printf '{"sigma": [1]}' >bad.json
refuses 1 'bad.json: "sigma" must be' render in.npz -o no.png --look bad.json
printf '[1]' >bad.json
refuses 1 'must hold a JSON object' render in.npz -o no.png --look bad.json

# Nothing to see.
printf 'x,y,z\n' >none.csv
head -c 128 a.npy | sed 's/(48, 64, 4)/(0, 3)     /' >none.npy
warns 'holds no particles; the picture is the background' render none.npy -o none.png $small
warns 'none of the particles is in view' render in.npz -o behind.png $small --eye 0,2,4 --target 0,4,8
is_png behind.png 64 48 3
printf '1 2 3\n' >one.xyz
ok render one.xyz -o one.png $small --radius 0.1
is_png one.png 64 48 3
ok render one.xyz -o one.png $small
ok render in.npz -o thin.png $small --radius 1e-9 --quiet
ok render in.npz -o fat.png $small --radius 1e6 --quiet
missing no.png

# Sequences.
mkdir frames out
for i in 1 2 9 10 11; do
    "$program" sample sphere --particles $((100 * i)) -o frames/f_$i.npz
done
refuses 2 '5 frames need a pattern' render frames -o out/one.png $small
ok render frames -o out/p_%03d.png $small
exists out/p_001.png out/p_002.png out/p_009.png out/p_010.png out/p_011.png
ok render frames/f_%d.npz -o out/q_%d.png $small --frames 2:10:8 --orbit 30 --layer depth=out/d_%d.npy
exists out/q_2.png out/q_10.png out/d_10.npy
missing out/q_1.png out/q_9.png
# A part of the sequence, drawn alone, is the part of the whole.
ok render frames -o out/r_%d.png $small --frames 9
cmp -s out/r_9.png out/p_009.png || complain "frame 9 alone differs from frame 9 of all"
refuses 2 'chooses none of the 5 frames, whose numbers are 1 to 11' render frames -o out/s_%d.png --frames 3:8
rm out/p_009.png
cp a.png out/p_010.png
ok render frames -o out/p_%03d.png $small --resume --stats stats.json
cmp -s a.png out/p_010.png || complain "--resume draws what is there"
exists out/p_009.png
[ "$(grep -c '"input"' stats.json)" = 1 ] || complain "stats of a resumed sequence: $(cat stats.json)"
for key in read_ms prepare_ms draw_ms write_ms stages splat particles_visible pixels_covered peak_bytes peak_memory_bytes; do
    holds "\"$key\"" stats.json
done
grep -q 'bytes":	[0-9]*$' stats.json || complain "bytes are no whole number: $(cat stats.json)"
printf 'junk' >frames/f_9.npz
refuses 1 'frames/f_9.npz: ' render frames -o out/t_%d.png $small
exists out/t_2.png
missing out/t_9.png out/t_10.png
"$program" render frames -o out/u_%d.png $small --keep-going >.out 2>.err
[ $? = 1 ] || complain "--keep-going with a bad frame: not status 1"
holds 'meniscus: 1 of 5 pictures are missing' .err
exists out/u_2.png out/u_10.png
missing out/u_9.png

# A signal: the picture in hand is finished, and the status tells.
rm frames/f_9.npz
i=20
while [ $i -lt 320 ]; do
    ln -s f_11.npz frames/f_$i.npz
    i=$((i + 1))
done
mkdir stopped
"$program" render frames -o stopped/p_%d.png --size 640x480 >.out 2>.err &
child=$!
tries=0
while [ ! -e stopped/p_2.png ] && [ $tries -lt 100 ]; do
    sleep 0.1
    tries=$((tries + 1))
done
kill -TERM $child
wait $child
[ $? = 143 ] || complain "a signal: status is not 143: $(cat .err)"
one_line 'stopped by a signal' render
left=$(find stopped -name '*.tmp*')
[ -z "$left" ] || complain "a signal left $left"
for file in stopped/*.png; do
    tail -c 8 "$file" | od -An -c | grep -q 'I   E   N   D' || complain "$file is not whole"
done
done_testing

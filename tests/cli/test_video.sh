#!/bin/sh
# Videos: every format read back by ffmpeg's own tools, YUV4MPEG2 against the picture's bytes, and every way in which they cannot be made.
. "$(dirname "$0")/common.sh"
small="--size 64x48 --threads 2"

"$program" sample waves --particles 3000 -o in.npz || exit 1
for i in 1 2 3; do ln -s in.npz f_$i.npz; done

# YUV4MPEG2: the picture's bytes by the matrix of BT.709, limited range; chroma on the left column of two, between two rows.
ok render in.npz -o one.y4m $small --fps 24000/1001
head -n 1 one.y4m >head.txt
holds '^YUV4MPEG2 W64 H48 F24000:1001 Ip A1:1 C420mpeg2 XYSCSS=420MPEG2 XCOLORRANGE=LIMITED$' head.txt
"$program" render in.npz -o piped.y4m $small --fps 23.976 || complain "a decimal --fps"
cmp -s one.y4m piped.y4m || complain "23.976 is not 24000/1001"
"$program" render in.npz -o - --output-format y4m $small --fps 24000/1001 >piped.y4m 2>.err || complain "-o - as y4m: $(cat .err)"
cmp -s one.y4m piped.y4m || complain "y4m on standard output differs from the file"
skip=$(($(wc -c <head.txt) + 6))
[ "$(wc -c <one.y4m)" = $((skip + 64 * 48 * 3 / 2)) ] || complain "one.y4m has $(wc -c <one.y4m) bytes"
"$program" render in.npz -o - --output-format rgba $small >one.rgba
{ od -An -v -tu1 -w1 one.rgba; tail -c +$((skip + 1)) one.y4m | od -An -v -tu1 -w1; } | awk '
    NR <= 64 * 48 * 4 { p[NR - 1] = $1; next }
    { q[n++] = $1 }
    function at(x, y, c) { return p[((y * 64) + (x < 0 ? 0 : x)) * 4 + c] }
    function sum(x, y, c) { return (at(x - 1, y, c) + 2 * at(x, y, c) + at(x + 1, y, c) + at(x - 1, y + 1, c) + 2 * at(x, y + 1, c) + at(x + 1, y + 1, c)) / 8 }
    function luma(r, g, b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b }
    function check(want, got) { bad += got - want > 0.51 || want - got > 0.51; kinds += !(got in seen); seen[got] }
    END {
        for (y = 0; y < 48; y++) for (x = 0; x < 64; x++) check(16 + 219 / 255 * luma(at(x, y, 0), at(x, y, 1), at(x, y, 2)), q[y * 64 + x])
        for (y = 0; y < 24; y++) for (x = 0; x < 32; x++) {
            r = sum(2 * x, 2 * y, 0); g = sum(2 * x, 2 * y, 1); b = sum(2 * x, 2 * y, 2)
            check(128 + 224 / 255 * (b - luma(r, g, b)) / 1.8556, q[64 * 48 + y * 32 + x])
            check(128 + 224 / 255 * (r - luma(r, g, b)) / 1.5748, q[64 * 48 + 32 * 24 + y * 32 + x])
        }
        exit bad > 0 || kinds < 20
    }' || complain "the planes are not the picture's"
ok render f_%d.npz -o three.y4m $small
[ "$(wc -c <three.y4m)" = $(($(head -n 1 three.y4m | wc -c) + 3 * (6 + 64 * 48 * 3 / 2))) ] || complain "three.y4m has $(wc -c <three.y4m) bytes"

# What cannot be.
refuses 2 'cannot be transparent' render in.npz -o no.mp4 --background transparent
refuses 2 'cannot be transparent' render in.npz -o - --output-format y4m --background transparent
refuses 2 'h264 goes into .mp4 or .mkv' render in.npz -o no.webm --codec h264
refuses 2 '--codec and --crf are for .mp4, .mkv and .webm' render in.npz -o no.y4m --crf 20
refuses 2 'is none of auto, h264, vp9 and av1' render in.npz -o no.mp4 --codec mpeg2
refuses 2 'must be pictures per second' render in.npz -o no.mp4 --fps 0
refuses 2 'must be pictures per second' render in.npz -o no.mp4 --fps 30/0
refuses 1 'missing/a.y4m: cannot be written: No such file' render in.npz -o missing/a.y4m
refuses 1 'missing/a.mp4: cannot be written: No such file' render in.npz -o missing/a.mp4

# Encoders that are not there, that lack a codec, that die, that say that all is well.
mkdir bare fake
path=$PATH
PATH=$PWD/bare "$program" render in.npz -o no.mp4 >.out 2>.err
[ $? = 1 ] || complain "without ffmpeg: not status 1"
one_line 'needs the program ffmpeg, which is not here; install it' render -o no.mp4
fake()
{
    printf '#!/bin/sh\ncase "$*" in *-encoders*) echo " V....D libx264 H.264";; *framecrc*) ;; *) head -c 2000 >/dev/null; %s;; esac\n' "$1" >fake/ffmpeg
    chmod +x fake/ffmpeg
    PATH=$PWD/fake:$path
}
fake 'kill -9 $$'
refuses 1 'no.mp4: the encoder ffmpeg failed: ended by signal 9' render f_%d.npz -o no.mp4 $small
fake 'echo "No space left on device" >&2; exit 1'
refuses 1 'no.mp4: the encoder ffmpeg failed: No space left on device' render f_%d.npz -o no.mp4 $small
fake 'cat >/dev/null; exit 3'
refuses 1 'no.mp4: the encoder ffmpeg failed: exit status 3' render f_%d.npz -o no.mp4 $small
fake 'cat >/dev/null; exit 0'
refuses 1 'wrote 0 of 3 pictures; is the disk full?' render f_%d.npz -o no.mp4 $small
refuses 1 'has no encoder for av1 (libaom-av1)' render in.npz -o no.mp4 --codec av1
PATH=$path
missing no.mp4 no.y4m no.webm no.part.mp4

if [ -w /dev/full ]; then
    ln -s /dev/full full.y4m
    refuses 1 'full.y4m: cannot be written: No space left' render in.npz -o full.y4m
    ln -s /dev/full full.mkv
    command -v ffmpeg >/dev/null && refuses 1 'is no plain file' render in.npz -o full.mkv
fi
(
    failures=0
    ulimit -f 1
    refuses 1 'no.y4m: cannot be written: File too large' render f_%d.npz -o no.y4m
    exit $failures
) || failures=$((failures + $?))
missing no.y4m

if ! command -v ffmpeg >/dev/null || ! command -v ffprobe >/dev/null; then
    echo "ffmpeg is not here: the encoded formats are not tested"
    done_testing
    exit 0
fi
encoders=$(ffmpeg -v error -encoders)

# probe FILE CODEC WIDTH HEIGHT PICTURES RATE
probe()
{
    got=$(ffprobe -v error -count_frames -show_entries stream=codec_name,width,height,pix_fmt,color_range,color_space,color_transfer,color_primaries,r_frame_rate,nb_read_frames -of csv=p=0 "$1")
    [ "$got" = "$2,$3,$4,yuv420p,tv,bt709,bt709,bt709,$6,$5" ] || complain "$1 is $got"
}
case $encoders in *libx264*)
    ok render f_%d.npz -o a.mp4 $small --fps 25
    probe a.mp4 h264 64 48 3 25/1
    ok render f_%d.npz -o odd.mkv --size 63x47 --fps 29.97
    probe odd.mkv h264 64 48 3 30000/1001
    ok render f_%d.npz -o low.mp4 $small --crf 45
    [ "$(wc -c <low.mp4)" -lt "$(wc -c <a.mp4)" ] || complain "--crf 45 is no smaller than the default"
    # What is decoded is the picture, on average: ffmpeg rounds down on the way back, by 1.4; the wrong range is 10 off.
    ok render in.npz -o best.mp4 $small --crf 0
    ffmpeg -v error -i best.mp4 -pix_fmt rgba -f rawvideo best.rgba
    cat one.rgba best.rgba | od -An -v -tu1 -w4 | awk '
        NR <= 3072 { r[NR] = $1; g[NR] = $2; b[NR] = $3; next }
        { n = NR - 3072; dr += r[n] - $1; dg += g[n] - $2; db += b[n] - $3 }
        END { most = 2 * 3072; exit dr > most || dr < -most || dg > most || dg < -most || db > most || db < -most }' || complain "a decoded video has other colours"
    (
        failures=0
        ulimit -f 1
        refuses 1 'no.mkv: the encoder ffmpeg' render in.npz -o no.mkv --size 640x480 --crf 1
        exit $failures
    ) || failures=$((failures + $?))
    missing no.mkv
    # A whole video is not made again, whatever is in it; an empty one is.
    printf 'mark' >done.mp4
    ok render f_%d.npz -o done.mp4 $small --resume
    holds mark done.mp4
    : >done.mp4
    ok render f_%d.npz -o done.mp4 $small --resume
    probe done.mp4 h264 64 48 3 30/1
    # A frame that cannot be read: what was drawn is kept beside; or it is left out.
    printf 'junk' >f_4.npz
    "$program" render f_%d.npz -o cut.mp4 $small >.out 2>.err
    [ $? = 1 ] || complain "a bad frame in a video: not status 1"
    holds 'f_4.npz: ' .err
    holds '3 pictures until here are kept in cut.part.mp4' .err
    missing cut.mp4
    probe cut.part.mp4 h264 64 48 3 30/1
    "$program" render f_%d.npz -o kept.mp4 $small --keep-going >.out 2>.err
    [ $? = 1 ] || complain "--keep-going with a bad frame in a video: not status 1"
    probe kept.mp4 h264 64 48 3 30/1
    rm f_4.npz
    # A signal.
    mkdir many
    i=10
    while [ $i -lt 400 ]; do
        ln -s ../in.npz many/f_$i.npz
        i=$((i + 1))
    done
    "$program" render many -o stopped.mp4 --size 640x480 --layer alpha=many/a_%d.npy >.out 2>.err &
    child=$!
    tries=0
    while [ ! -e many/a_20.npy ] && [ $tries -lt 100 ]; do
        sleep 0.05
        tries=$((tries + 1))
    done
    kill -TERM $child
    wait $child
    [ $? = 143 ] || complain "a signal: status is not 143: $(cat .err)"
    missing stopped.mp4
    drawn=$(find many -name 'a_*.npy' | wc -l)
    probe stopped.part.mp4 h264 640 480 "$drawn" 30/1
    ;;
*) echo "ffmpeg has no libx264: H.264 is not tested" ;;
esac
case $encoders in *libvpx-vp9*)
    ok render f_%d.npz -o a.webm $small
    probe a.webm vp9 64 48 3 30/1
    ;;
*) echo "ffmpeg has no libvpx-vp9: VP9 is not tested" ;;
esac
case $encoders in *libaom-av1*)
    ok render f_%d.npz -o av1.mkv --size 128x96 --codec av1 --fps 50
    probe av1.mkv av1 128 96 3 50/1
    ;;
*) echo "ffmpeg has no libaom-av1: AV1 is not tested" ;;
esac
done_testing

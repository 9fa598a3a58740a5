#!/bin/sh
# Times per stage.
. "$(dirname "$0")/common.sh"

"$program" sample crown --particles 5000 -o in.npz || exit 1
ok bench in.npz --size 160x90 --repeat 3 --warmup 1 --json --threads 2 --isa scalar
for key in particles width height backend threads isa filter prepare_ms frame_ms min median max stages splat peak_bytes; do
    prints "\"$key\":"
done
prints '"isa":	"scalar"'
prints '"particles":	5000'
[ "$(head -c 1 .out)" = '[' ] || complain "bench --json is no array"
ok bench in.npz in.npz --size 160x90 --repeat 2 --filter none
[ "$(grep -c 'per new view' .out)" = 2 ] || complain "two inputs: $(cat .out)"
printf '{"particles_file": "in.npz", "spacing": 0.05, "viewport": {"width": 80, "height": 60}, "camera": {"eye": [0, 2, 3]}}' >case.json
ok bench case.json --repeat 1 --warmup 0 --json
prints '"width":	80'
ok bench case.json --repeat 1 --warmup 0 --json --size 40x30
prints '"width":	40'
refuses 1 'missing.npz: cannot be opened' bench missing.npz
done_testing

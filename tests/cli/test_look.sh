#!/bin/sh
# Looks: presets, files and settings, in this order; the schema takes what is saved and refuses what the program refuses.
. "$(dirname "$0")/common.sh"
small='--size 64x40 --quiet'
docs=$2/docs

ok sample crown --particles 2000 -o in.npz
ok --help-options
presets=$(sed -n '/^## Presets/,/^## Parameters/s/^| `\([^`]*\)`.*/\1/p' .out)
[ "$(echo "$presets" | wc -l)" -ge 6 ] || complain "few presets: $presets"
for preset in $presets; do
    ok render in.npz -o "$preset.png" $small --preset "$preset" --save-look "$preset.json"
    ok render in.npz -o again.png $small --look "$preset.json" --save-look again.json
    cmp -s again.png "$preset.png" || complain "$preset: its look file gives another picture"
    cmp -s again.json "$preset.json" || complain "$preset: its look file changes when it is read and saved"
    [ "$preset" = water ] || { cmp -s water.png "$preset.png" && complain "$preset looks like water"; }
done
ok render in.npz -o plain.png $small
cmp -s water.png plain.png || complain "water is not the default"
[ "$(tr -d ' \t\n' <water.json)" = '{}' ] || complain "water changes something: $(cat water.json)"
refuses 2 "did you mean 'murky'? There are water, murky" render in.npz -o no.png --preset murkey
refuses 2 "did you mean 'sigma'" render in.npz -o no.png --set sigmo=1

# A file goes over a preset, an option over a file, wherever they stand; later ones over earlier ones.
echo '{"$schema": "look.schema.json", "refraction_index": 1.2, "shininess": 5}' >mine.json
ok render in.npz -o x.png $small --set shininess=7 --look mine.json --preset oil --preset lava --save-look x.json
holds '"refraction_index":	1.2' x.json
holds '"shininess":	7' x.json
holds '"fluid_color":	\[0.62,0.07,0.006\]' x.json

for python in python3 /usr/bin/python3; do
    "$python" -c 'import jsonschema' 2>/dev/null || continue
    "$python" - "$docs/look.schema.json" >.out 2>&1 <<'END' || complain "the schema: $(cat .out)"
import glob, json, sys, jsonschema
schema = json.load(open(sys.argv[1]))
check = jsonschema.Draft7Validator(schema)  # what the schema uses is the same in newer drafts
for name in glob.glob('*.json'):
    if name != 'schema.json':
        check.validate(json.load(open(name)))
good = [{"floor": False}, {"fluid_color": "ff8000"}, {"radius": "auto"}, {"display": "depth"}, {"iterations": 3}]
bad = [{"floor": 3}, {"fluid_color": "red"}, {"fluid_color": [1, 2]}, {"radius": -1}, {"display": "deep"}, {"iterations": 1.5}, {"sigmo": 1}, []]
assert all(check.is_valid(look) for look in good), [look for look in good if not check.is_valid(look)]
assert not any(check.is_valid(look) for look in bad), [look for look in bad if check.is_valid(look)]
END
    checked=yes
    break
done
[ "${checked:-}" ] || echo 'skipped: no jsonschema'
done_testing

#!/bin/sh
# What files hold, and every kind of file that cannot be read.
. "$(dirname "$0")/common.sh"

printf 'x,y,z,rho,gid\n0,0,0,1000,7\n1,0,0,900,8\n0,2,0,nan,9\n0,0,3,1000,10\n' >four.csv
ok info four.csv
prints '^four.csv$'
prints 'particles   4$'
prints 'bounds      0 0 0 to 1 2 3$'
prints 'rho (used as density)'
ok info --json four.csv
prints '"path":	"four.csv"'
prints '"format":	"csv"'
prints '"particles":	4'
prints '"name":	"gid"'
ok info four.csv --where 'rho>950'
prints 'particles   2 of 4$'
refuses 1 'four.csv: ' info four.csv --where 'rho>>950'
refuses 1 'four.csv: ' info four.csv --where 'no_such>1'
refuses 1 'four.csv: ' info four.csv --attribute velocity=no_such

# Standard input.
"$program" info - --format csv <four.csv >.out 2>.err || complain "info -: status $?"
prints 'particles   4$'
"$program" info - --json <four.csv >.out 2>.err || complain "info - without --format: status $?"

# Positions that are not finite.
printf '0 0 0\n1 nan 0\n0 1 1\n' >holes.xyz
warns 'holes.xyz: ' info holes.xyz
prints 'particles   2 of 3'
ok info --quiet holes.xyz

# Directories, patterns, several files.
mkdir series mixed empty
for i in 1 2 10; do cp four.csv series/frame_$i.csv; done
cp series/* mixed
cp four.csv mixed/other_1.csv
ok info series
[ "$(grep -c '^series/' .out)" = 3 ] || complain "a series of 3: $(cat .out)"
[ "$(grep '^series/' .out | sed -n 2p)" = series/frame_2.csv ] || complain "not sorted by number: $(cat .out)"
ok info series/frame_%d.csv
[ "$(grep -c '^series/' .out)" = 3 ] || complain "a pattern of 3: $(cat .out)"
refuses 1 'no file matches' info series/frame_%03d.csv
refuses 1 'no file matches' info series/%d.csv
refuses 2 'holds 2 series: frame_*.csv (3), other_1.csv (1)' info mixed
mkdir woven
for i in 1 2 10; do
    cp four.csv woven/f_${i}_foam.csv
    cp four.csv woven/f_${i}_spray.csv
done
refuses 2 'holds 2 series: f_*_foam.csv (3), f_*_spray.csv (3); name' info woven
ok info woven/f_%d_spray.csv
[ "$(grep -c '^woven/' .out)" = 3 ] || complain "a pattern of 3 among 6: $(cat .out)"
refuses 1 'holds no particle files' info empty
refuses 1 'missing: cannot be opened: No such file' info missing
refuses 2 'is empty' info ''

# A collection keeps its own order.
if "$program" --version | grep -q '^reads: .*pvd'; then
    mkdir other
    printf '<VTKFile type="Collection"><Collection>%s%s</Collection></VTKFile>\n' '<DataSet timestep="0" file="../series/frame_2.csv"/>' \
        '<DataSet timestep="1" file="../series/frame_1.csv"/>' >other/steps.pvd
    for input in other/steps.pvd other; do
        ok info $input
        [ "$(grep -c '^  format' .out)" = 2 ] || complain "$input is not 2 files: $(cat .out)"
        head -n 1 .out | grep -q 'frame_2.csv$' || complain "$input lost its order: $(cat .out)"
    done
    printf '<VTKFile type="Collection"><Collection></Collection></VTKFile>\n' >other/none.pvd
    refuses 1 'none.pvd' info other/none.pvd
    refuses 2 'holds 2 .pvd files' info other

    # Parts of one time are one set; in a sequence they cannot be.
    printf 'x,y,z\n0,0,0.5\n1,0,0.5\n' >other/part.csv
    parts='<DataSet timestep="0" part="0" file="part.csv"/><DataSet timestep="0" part="1" file="part.csv"/>'
    printf '<VTKFile type="Collection"><Collection>%s</Collection></VTKFile>\n' "$parts" >other/parts.pvd
    ok info other/parts.pvd
    prints 'particles   4$'
    printf '<VTKFile type="Collection"><Collection>%s%s</Collection></VTKFile>\n' "$parts" \
        '<DataSet timestep="1" file="part.csv"/>' >other/parts.pvd
    refuses 1 'parts.pvd: names several files for time 0' info other/parts.pvd
fi

# Bad files.
"$program" sample block --particles 1000 -o good.npy
"$program" sample block --particles 1000 -o good.npz
: >nothing.npy
head -c 100 good.npy >short_head.npy
head -c 5000 good.npy >short.npy
head -c 5000 good.npz >short.npz
printf 'This is a letter, not a particle file.\n' >letter.txt
printf 'This is a letter, not a particle file.\n' >letter.npy
head -c 4096 /dev/zero >zeros.bgeo
sed 's/(1000, 3)/(9999999999999, 3)/' good.npy >huge.npy
printf 'a,b,c\n1,2,3\n' >no_positions.csv
for file in nothing.npy short_head.npy short.npy short.npz letter.txt letter.npy zeros.bgeo huge.npy no_positions.csv; do
    refuses 1 "$file: " info $file
    refuses 1 "$file: " render $file -o picture.png
done
missing picture.png
if [ "$(id -u)" != 0 ]; then
    cp good.npy locked.npy
    chmod 0 locked.npy
    refuses 1 'locked.npy: cannot be opened: Permission denied' info locked.npy
fi

# A file that is refused gets its one line, though columns were left out before; and a line is one line whatever the names.
printf 'x,y,z,name\n0,0,0,a\n1,2\n' >late.csv
refuses 1 'late.csv: ' info late.csv
refuses 1 'no?such.csv: cannot be opened' info "$(printf 'no\nsuch.csv')"

# A reader that has gone before the first byte comes: it says so through a second pipe, since little output fits into an open one.
mkfifo gone
{ read -r _ <gone; "$program" info --json four.csv series 2>.err; echo $? >status; } | { exec <&-; echo >gone; }
[ "$(cat status)" = 1 ] || complain "a closed pipe: status $(cat status)"
one_line 'standard output: cannot be written: Broken pipe' info --json
done_testing

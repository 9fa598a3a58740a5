#!/bin/sh
# From every format to every other: attributes, sequences, subsets; read back by other programs where they are installed.
. "$(dirname "$0")/common.sh"

ok sample crown --particles 2000 -o a.npz
ok info a.npz
sed '1,2d' .out >wanted
for chain in 'a.npz b.vtp c.ply d.npz' 'a.npz e.ply f.vtp g.npz'; do
    before=
    for file in $chain; do
        [ -z "$before" ] || ok convert "$before" -o $file
        ok info $file
        sed '1,2d' .out >got
        cmp -s wanted got || complain "$file is not $before: $(cat got)"
        before=$file
    done
    cmp -s a.npz "$before" || complain "$before, through $chain, is not a.npz"
done
ok convert a.npz -o h.bgeo
ok info h.bgeo
prints 'int32        id'
ok convert h.bgeo -o i.npz
ok info i.npz
prints 'float32\[3\]   velocity'
ok convert a.npz -o h.bgeo.gz
warns 'holds the positions only' convert a.npz -o p.npy

# A subset; a sequence, whose files are numbered as the inputs are.
ok convert a.npz -o half.vtp --where 'id < 1000'
ok info half.vtp
prints 'particles   1000$'
mkdir in
for i in 3 20 100; do cp a.npz in/f_$i.npz; done
ok convert in -o 'o_%04d.vtp'
exists o_0003.vtp o_0020.vtp o_0100.vtp
refuses 2 'need a pattern' convert in -o o.vtp
ok convert in -o one.vtp --frames 20
cmp -s one.vtp o_0020.vtp || complain '--frames 20: another frame'
refuses 2 'is an input' convert in -o 'in/f_%d.npz'
refuses 2 'written as .npz, .npy, .ply, .vtp, .bgeo' convert a.npz -o a.vtk
refuses 2 'written as' convert a.npz -o a.ply.gz
refuses 2 'needs an input and an output' convert a.npz
refuses 1 'cannot be written' convert a.npz -o no/such/folder.npz
echo nonsense >in/f_21.npz
refuses 1 'in/f_21.npz: ' convert in -o 'k_%d.vtp'
"$program" convert in -o 'k_%d.vtp' --keep-going >.out 2>.err
[ $? = 1 ] || complain "--keep-going: not status 1"
holds '1 of 4 frames could not be read' .err
exists k_3.vtp k_20.vtp k_100.vtp
missing k_21.vtp
"$program" convert - --format npz -o stdin.vtp <a.npz || complain 'standard input: not status 0'
cmp -s stdin.vtp b.vtp || complain 'from standard input: not the same file'

# Another program's opinion.
for python in python3 /usr/bin/python3; do # numpy may be packaged for one of them
    "$python" -c 'import numpy' 2>/dev/null || continue
    "$python" - >.out 2>&1 <<'END' || complain "numpy: $(cat .out)"
import numpy
a = numpy.load('a.npz')
d = numpy.load('d.npz')
assert sorted(a) == sorted(d) == ['density', 'id', 'position', 'velocity'], sorted(d)
assert all((a[k] == d[k]).all() and a[k].dtype == d[k].dtype for k in a)
END
    read_by_numpy=yes
    break
done
[ "${read_by_numpy:-}" ] || echo 'skipped: no numpy'
for python in python3 /usr/bin/python3; do # VTK may be packaged for one of them
    "$python" -c 'import vtk' 2>/dev/null || continue
    "$python" - >.out 2>&1 <<'END' || complain "VTK: $(cat .out)"
import vtk
def read(reader, name):
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()
xml, ply = read(vtk.vtkXMLPolyDataReader(), 'b.vtp'), read(vtk.vtkPLYReader(), 'c.ply')
data = xml.GetPointData()
assert xml.GetNumberOfPoints() == ply.GetNumberOfPoints() == 2000
assert xml.GetNumberOfVerts() == 1 and xml.GetVerts().GetNumberOfConnectivityIds() == 2000
assert xml.GetBounds() == ply.GetBounds()
assert data.GetArray('velocity').GetNumberOfComponents() == 3
assert data.GetArray('id').GetDataTypeAsString() == 'unsigned int' and data.GetArray('id').GetRange() == (0, 1999)
END
    read_by_vtk=yes
    break
done
[ "${read_by_vtk:-}" ] || echo 'skipped: no VTK'
done_testing

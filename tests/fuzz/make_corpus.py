#!/usr/bin/env python3
"""Makes the seeds in corpus/: one small file per format and variant. Needs nothing but Python's own library."""
import base64
import gzip
import io
import lzma
import os
import struct
import zipfile
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
POINTS = [(0.0, 0.1, 0.2), (1.0, 1.1, 1.2), (2.0, 2.1, 2.2)]
VELOCITY = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
FLAT = [v for p in POINTS for v in p]
FLAT_VELOCITY = [v for p in VELOCITY for v in p]


def seed(name, data):
    path = os.path.join(HERE, 'corpus', name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'wb') as file:
        file.write(data if isinstance(data, bytes) else data.encode())


def bgeo():
    out = b'BgeoV' + struct.pack('>9I', 5, 3, 0, 0, 0, 3, 0, 0, 0)
    out += struct.pack('>H2sHI', 2, b'id', 1, 1) + bytes(4)
    out += struct.pack('>H8sHI', 8, b'velocity', 3, 5) + bytes(12)
    out += struct.pack('>H4sHII', 4, b'name', 1, 4, 1) + struct.pack('>H5s', 5, b'water')
    for i, (p, v) in enumerate(zip(POINTS, VELOCITY)):
        out += struct.pack('>4f i 3f i', *p, 1.0, i, *v, 0)
    return out + b'\x00\xff'


def npy(descr, shape, body, version=1, fortran=False):
    text = f"{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}".encode()
    text += b' ' * (64 - (len(text) + 11) % 64) + b'\n'
    return b'\x93NUMPY' + bytes([version, 0]) + struct.pack('<H' if version == 1 else '<I', len(text)) + text + body


def npz(method):
    file = io.BytesIO()
    with zipfile.ZipFile(file, 'w', method) as z:
        z.writestr('position.npy', npy('<f4', (3, 3), struct.pack('<9f', *FLAT)))
        z.writestr('velocity.npy', npy('<f8', (3, 3), struct.pack('<9d', *FLAT_VELOCITY)))
        z.writestr('id.npy', npy('<u2', (3,), struct.pack('<3H', 1, 2, 3)))
        z.writestr('time.npy', npy('<f8', (), struct.pack('<d', 0.5)))
    return file.getvalue()


def ply(kind):
    head = (f'ply\nformat {kind} 1.0\ncomment seed\nelement tag 1\nproperty list uchar int ids\nelement vertex 3\nproperty float x\n'
            'property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty double density\n'
            'element face 1\nproperty list uchar int vertex_indices\nend_header\n').encode()
    if kind == 'ascii':
        rows = ''.join(f'{p[0]} {p[1]} {p[2]} 255 128 {i} 1000.5\n' for i, p in enumerate(POINTS))
        return head + b'2 7 8\n' + rows.encode() + b'3 0 1 2\n'
    e = '<' if 'little' in kind else '>'
    body = struct.pack(e + 'B2i', 2, 7, 8)
    for i, p in enumerate(POINTS):
        body += struct.pack(e + '3f3Bd', *p, 255, 128, i, 1000.5)
    return head + body + struct.pack(e + 'B3i', 3, 0, 1, 2)


def legacy_vtk(binary, dataset):
    def numbers(code, values):
        return struct.pack(f'>{len(values)}{code}', *values) + b'\n' if binary else (' '.join(map(str, values)) + '\n').encode()
    out = f'# vtk DataFile Version 4.1\nseed\n{"BINARY" if binary else "ASCII"}\nDATASET {dataset}\nPOINTS 3 float\n'.encode() + numbers('f', FLAT)
    out += (b'CELLS 3 6\n' if dataset == 'UNSTRUCTURED_GRID' else b'VERTICES 3 6\n') + numbers('i', [1, 0, 1, 1, 1, 2])
    if dataset == 'UNSTRUCTURED_GRID':
        out += b'CELL_TYPES 3\n' + numbers('i', [1, 1, 1])
    out += b'POINT_DATA 3\nSCALARS id unsigned_int 1\nLOOKUP_TABLE default\n' + numbers('I', [1, 2, 3])
    out += b'FIELD FieldData 2\nvelocity 3 3 float\n' + numbers('f', FLAT_VELOCITY) + b'density 1 3 double\n' + numbers('d', [1.0, 2.0, 3.0])
    return out


def xml_array(name, kind, code, components, values, encoding, pack, header):
    head = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format='
    if encoding == 'ascii':
        return head + '"ascii">' + ' '.join(map(str, values)) + '</DataArray>', b''
    raw = struct.pack(f'<{len(values)}{code}', *values)
    h = '<{}I' if header == 'UInt32' else '<{}Q'
    if pack:
        packed = pack(raw)
        prefix, body = struct.pack(h.format(4), 1, len(raw), 0, len(packed)), packed
    else:
        prefix, body = struct.pack(h.format(1), len(raw)), raw
    if encoding == 'base64':
        text = base64.b64encode(prefix) + base64.b64encode(body) if pack else base64.b64encode(prefix + body)
        return head + '"binary">' + text.decode() + '</DataArray>', b''
    return head + '"appended" offset="{}"/>', prefix + body


def xml(kind, encoding, compressor=None, pack=None, header='UInt32'):
    arrays, appended = [], b''
    for name, type_name, code, components, values in (('Points', 'Float32', 'f', 3, FLAT), ('velocity', 'Float32', 'f', 3, FLAT_VELOCITY),
                                                      ('id', 'Int64', 'q', 1, [1, 2, 3])):
        text, raw = xml_array(name, type_name, code, components, values, encoding, pack, header)
        arrays.append(text.format(len(appended)) if raw else text)
        appended += raw
    piece = 'NumberOfPoints="3" NumberOfCells="0"' if kind == 'UnstructuredGrid' else 'NumberOfPoints="3" NumberOfVerts="0"'
    packer = f' compressor="{compressor}"' if compressor else ''
    out = (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="{header}"{packer}>\n<{kind}>\n'
           f'<Piece {piece}>\n<Points>{arrays[0]}</Points>\n<PointData>{arrays[1]}{arrays[2]}</PointData>\n</Piece>\n</{kind}>\n').encode()
    if appended:
        out += b'<AppendedData encoding="raw">_' + appended + b'</AppendedData>\n'
    return out + b'</VTKFile>\n'


def main():
    seed('bgeo/points.bgeo', bgeo())
    seed('gzip/points.bgeo', gzip.compress(bgeo(), mtime=0))
    seed('gzip/points.xyz', gzip.compress(b'1 2 3\n4 5 6\n', mtime=0) + gzip.compress(b'7 8 9\n', mtime=0))
    seed('npy/float32.npy', npy('<f4', (3, 3), struct.pack('<9f', *FLAT)))
    seed('npy/float64_big_fortran.npy', npy('>f8', (3, 3), struct.pack('>9d', *FLAT), 2, True))
    seed('npz/stored.npz', npz(zipfile.ZIP_STORED))
    seed('npz/deflated.npz', npz(zipfile.ZIP_DEFLATED))
    for kind in ('ascii', 'binary_little_endian', 'binary_big_endian'):
        seed(f'ply/{kind}.ply', ply(kind))
    seed('csv/paraview.csv', '"velocity:0","velocity:1","velocity:2","id","Points:0","Points:1","Points:2"\n1,0,0,7,0.5,1e-3,nan\n0,1,0,8,1,2,3\n')
    seed('csv/units.csv', 'Pos.x [m];Pos.y [m];Pos.z [m];Idp;name\n1.5;2.5;3.5;9;a\n;;;;b\n')
    seed('csv/bare.txt', '# x y z\n1 2 3\n\n4\t5 6\n')
    seed('csv/element.xyz', '2\ncomment\nO 0.1 0.2 0.3\nH 1.7976931348623157e308 12345678901234567890123 -0\n')
    for binary in (False, True):
        for dataset in ('UNSTRUCTURED_GRID', 'POLYDATA'):
            seed(f'vtk/{dataset.lower()}_{"binary" if binary else "ascii"}.vtk', legacy_vtk(binary, dataset))
    seed('vtk/nul_in_name.vtk', legacy_vtk(False, 'POLYDATA').replace(b'density', b'dens\0\0ity'))
    for folder, kind in (('vtu', 'UnstructuredGrid'), ('vtp', 'PolyData')):
        seed(f'{folder}/ascii.{folder}', xml(kind, 'ascii'))
        seed(f'{folder}/base64.{folder}', xml(kind, 'base64', header='UInt64'))
        seed(f'{folder}/base64_zlib.{folder}', xml(kind, 'base64', 'vtkZLibDataCompressor', zlib.compress))
        seed(f'{folder}/raw.{folder}', xml(kind, 'appended'))
        seed(f'{folder}/raw_zlib.{folder}', xml(kind, 'appended', 'vtkZLibDataCompressor', zlib.compress))
        seed(f'{folder}/raw_lzma.{folder}', xml(kind, 'appended', 'vtkLZMADataCompressor', lzma.compress))
    for kind, ending in (('PUnstructuredGrid', 'vtu'), ('PPolyData', 'vtp')):
        seed(f'pvtu/parallel.p{ending}',
             f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian">\n<{kind} GhostLevel="0">\n'
             '<PPoints><PDataArray type="Float32" Name="Points" NumberOfComponents="3"/></PPoints>\n'
             f'<Piece Source="part_0.{ending}"/>\n<Piece Source="part_1.{ending}"/>\n</{kind}>\n</VTKFile>\n')
    seed('pvtu/blocks.vtm', '<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet><Block index="0"><DataSet index="0" file="a.vtu"/></Block>'
         '<DataSet index="1"/></vtkMultiBlockDataSet></VTKFile>\n')
    seed('pvd/series.pvd', '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
         '<DataSet timestep="0" group="" part="0" file="a_0.vtu"/>\n<DataSet timestep="0.5" file="a_1.vtu"/>\n</Collection>\n</VTKFile>\n')
    seed('where/simple', 'type == 0 && velocity.x > 0.5')
    seed('where/rich', "!(x < 1 || 'type' != 2) && -velocity * 2.5e0 / (y + 1) >= z - 3")


main()

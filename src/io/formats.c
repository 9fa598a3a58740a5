/* formats.c: the formats and compressions of this build. A new format is a file read_<format>.c and a line here. */
#include "io/reader.h"

/* In the order of probing; formats with a signature first, text without one last. */
const struct mns_reader *const mns_readers[] = {
    &mns_reader_bgeo, &mns_reader_npy,
    &mns_reader_npz,  &mns_reader_ply,
    &mns_reader_vtk,
#ifdef MNS_HAVE_EXPAT
    &mns_reader_vtu,  &mns_reader_vtp,
    &mns_reader_pvtu, &mns_reader_pvd,
#endif
    &mns_reader_csv,  NULL,
};

const struct mns_reader *const mns_missing_readers[] = {
#ifndef MNS_HAVE_EXPAT
    &mns_reader_vtk_xml_missing,
#endif
    NULL,
};

static const char *const missing[] = {
#ifndef MNS_HAVE_ZLIB
    "zlib and gzip (zlib)",
#endif
#ifndef MNS_HAVE_LZ4
    "lz4 (liblz4)",
#endif
#ifndef MNS_HAVE_LZMA
    "lzma (liblzma)",
#endif
#ifndef MNS_HAVE_EXPAT
    "vtu, vtp, pvtu and pvd (expat)",
#endif
#ifndef MNS_HAVE_PNG
    "png (spng)",
#endif
#ifndef MNS_HAVE_EXR
    "exr (OpenEXR)",
#endif
    NULL,
};

const char *mns_read_format(size_t index)
{
    size_t count = sizeof(mns_readers) / sizeof(mns_readers[0]);
    return index < count && mns_readers[index] ? mns_readers[index]->name : NULL;
}

const char *mns_missing_feature(size_t index) { return index < sizeof(missing) / sizeof(missing[0]) ? missing[index] : NULL; }

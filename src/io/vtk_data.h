/* vtk_data.h: how arrays are packed in VTK's XML files. */
#ifndef MNS_IO_VTK_DATA_H
#define MNS_IO_VTK_DATA_H

#include "io/vtk_array.h"

struct vtk_packed {
    struct vtk_source source; /* first: check and decode find the rest from it */
    bool big_endian;
    size_t header_size; /* bytes of each number before the data: 4 or 8 */
    bool compressed;
    enum codec codec;
};

extern const struct vtk_source mns_vtk_packed_source; /* check and decode, without a context */

#endif

/* read_pvtu.c: VTK XML files that name others: those of several processes (.pvtu, .pvtp), blocks (.vtm), partitions (.vtpc, .vtpd). The pieces
 * become one set. */
#include "io/set.h"
#include "io/vtk_array.h"
#include "io/vtk_xml.h"

#include <string.h>

struct pvtu {
    struct read_context *context;
    char **sources; /* [capacity], count of them used */
    size_t count, capacity;
    bool has_grid, in_grid;
    bool of_blocks; /* <DataSet file="FILE"> anywhere within, else <Piece Source="FILE"> right below */
};

/* Those from FIRST_OF_BLOCKS on are of blocks. */
static const char *const types[] = {"PUnstructuredGrid",     "PPolyData", "vtkMultiBlockDataSet", "vtkPartitionedDataSetCollection",
                                    "vtkPartitionedDataSet", NULL};
enum { FIRST_OF_BLOCKS = 2 };

static int probe(struct bytes head) { return mns_xml_probe(head, types); }

static mns_result start_piece(struct pvtu *pvtu, const char *source)
{
    if (!source || source[0] == '\0') {
        return mns_read_fail(pvtu->context, MNS_ERR_BAD_DATA, "has a <Piece> without Source=\"FILE\"");
    }
    char **sources = mns_vtk_grow(pvtu->context, pvtu->sources, &pvtu->capacity, pvtu->count, sizeof(*sources));
    if (!sources) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    pvtu->sources = sources;
    size_t size = strlen(source) + 1;
    char *copy = mns_read_alloc(pvtu->context, size, 1);
    if (!copy) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    memcpy(copy, source, size);
    sources[pvtu->count++] = copy;
    return MNS_OK;
}

static mns_result start(struct vtk_xml *xml, const char *name, const char *const *attributes)
{
    struct pvtu *pvtu = xml->user;
    if (xml->depth == 1) {
        pvtu->in_grid = false;
        for (size_t i = 0; types[i] && !pvtu->in_grid; i++) {
            pvtu->in_grid = strcmp(name, types[i]) == 0;
            pvtu->of_blocks = i >= FIRST_OF_BLOCKS;
        }
        pvtu->has_grid |= pvtu->in_grid;
    }
    if (xml->depth < 2 || !pvtu->in_grid) {
        return MNS_OK;
    }
    if (!pvtu->of_blocks) {
        return xml->depth == 2 && strcmp(name, "Piece") == 0 ? start_piece(pvtu, mns_xml_get(attributes, "Source")) : MNS_OK;
    }
    const char *file = strcmp(name, "DataSet") == 0 ? mns_xml_get(attributes, "file") : NULL; /* an empty block names none */
    return file && file[0] != '\0' ? start_piece(pvtu, file) : MNS_OK;
}

static mns_result read_pieces(const struct pvtu *pvtu)
{
    mns_result result = MNS_OK;
    if (!pvtu->has_grid) {
        return mns_read_fail(pvtu->context, MNS_ERR_BAD_DATA, "has no element that names pieces, such as <%s>", types[0]);
    }
    if (pvtu->count == 0) {
        return mns_set_begin(pvtu->context, 0);
    }
    for (size_t i = 0; i < pvtu->count && result == MNS_OK; i++) {
        result = mns_read_referenced(pvtu->context, pvtu->sources[i]);
    }
    return result;
}

static mns_result read_pvtu(struct read_context *context, struct bytes file)
{
    struct pvtu pvtu = {.context = context};
    struct vtk_xml xml = {.context = context, .file = file, .types = types, .user = &pvtu, .start = start};
    /* Only a .pvd may name a .pvtu: a few small files that name each other many times would be read without end. */
    if (context->depth > 1 || (context->depth == 1 && strcmp(context->set->format, "pvd") != 0)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA,
                             "is named as a piece, but has pieces itself: those of a parallel file are .vtu or .vtp files");
    }
    mns_result result = mns_xml_parse(&xml);
    if (result == MNS_OK) {
        result = read_pieces(&pvtu);
    }
    for (size_t i = 0; i < pvtu.count; i++) {
        mns_read_free(context, pvtu.sources[i], strlen(pvtu.sources[i]) + 1, 1);
    }
    if (pvtu.capacity > 0) {
        mns_read_free(context, pvtu.sources, pvtu.capacity, sizeof(*pvtu.sources));
    }
    return result;
}

const struct mns_reader mns_reader_pvtu = {"pvtu", "pvtu pvtp vtm vtpc vtpd", probe, read_pvtu};

/* vtk_missing.c: stands in for VTK's XML formats in a build without expat. */
#include "core/message.h"
#include "io/reader.h"

#include <string.h>

static int probe(struct bytes head)
{
    static const char mark[] = "<VTKFile";
    const uint8_t *at = head.data, *end = head.data + head.size;
    for (; (size_t)(end - at) >= sizeof(mark) - 1; at++) {
        if (memcmp(at, mark, sizeof(mark) - 1) == 0) {
            return 2;
        }
    }
    return 0;
}

static mns_result refuse(struct read_context *context, struct bytes file)
{
    (void)file;
    return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "is a VTK XML file, which this build cannot read: build with expat");
}

const struct mns_reader mns_reader_vtk_xml_missing = {"vtu", "vtu vtp pvtu pvtp vtm vtpc vtpd pvd", probe, refuse};

mns_result mns_pvd_read(mns_pvd **out, const char *path, struct mns_message *message)
{
    if (out) {
        *out = NULL;
    }
    return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: is a VTK XML file, which this build cannot read: build with expat",
                    path ? path : "(no path)");
}

size_t mns_pvd_count(const mns_pvd *pvd)
{
    (void)pvd;
    return 0;
}

const struct mns_pvd_step *mns_pvd_get(const mns_pvd *pvd, size_t index)
{
    (void)pvd, (void)index;
    return NULL;
}

void mns_pvd_destroy(mns_pvd **pvd) { (void)pvd; /* none was made */ }

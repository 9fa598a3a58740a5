/* vtk_xml.h: elements of VTK's XML files, as expat finds them. */
#ifndef MNS_IO_VTK_XML_H
#define MNS_IO_VTK_XML_H

#include "io/reader.h"

struct vtk_xml {
    struct read_context *context;
    struct bytes file;
    const char *const *types; /* NULL-ended: what <VTKFile type="..."> may say */
    void *user;
    /* For each element below the root, whose own type has been checked, too. attributes: name, value, name, value, ..., NULL. A failure ends
     * the parsing. */
    mns_result (*start)(struct vtk_xml *xml, const char *name, const char *const *attributes);
    mns_result (*end)(struct vtk_xml *xml);
    int depth;              /* of the element in hand; the root's is 0 */
    size_t tag_at, tag_end; /* of the tag in hand: bytes of the file */
    bool stop;              /* set by start: what follows is no XML */
    void *parser;           /* mns_xml_parse's own, like all below */
    mns_result result;
    size_t at;        /* in the file: what comes next */
    size_t fed, seen; /* bytes given to the parser, and of these up to the end of the last tag */
    size_t skipped;   /* bytes that were not given to it, all of them in front of the tag in hand */
};

/* Text between tags, which may be as long as the file, is not looked at. */
mns_result mns_xml_parse(struct vtk_xml *xml);

/* The value of an attribute; NULL: it is not there. */
const char *mns_xml_get(const char *const *attributes, const char *name);

/* Parses a whole number that is not negative; false: text is NULL or something else. */
bool mns_xml_count(const char *text, size_t *out);

/* 2 where the head holds <VTKFile type="..."> of one of the types, else 0. */
int mns_xml_probe(struct bytes head, const char *const *types);

#endif

/* vtk_xml.c: VTK's XML files through expat: the root's type, where tags stand in the file, faults with their line.
 *
 * expat allocates for itself, in proportion to the longest tag: not counted against max_bytes. It is given tags alone: pieces that end at a
 * '>', and where that was the end of a tag, the text up to the next '<' is left out. */
#include "io/vtk_xml.h"

#include <expat.h>
#include <string.h>

enum {
    DEPTH_MAX = 16, /* VTK's own files are six deep */
    CHUNK = 65536   /* given to expat at a time, unless a tag is longer; it copies them */
};

static void stop_with(struct vtk_xml *xml, mns_result result)
{
    if (xml->result == MNS_OK) {
        xml->result = result;
    }
    XML_StopParser(xml->parser, XML_FALSE);
}

static mns_result check_root(struct vtk_xml *xml, const char *name, const char *const *attributes)
{
    const char *type = mns_xml_get(attributes, "type");
    if (strcmp(name, "VTKFile") != 0) {
        return mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "is no VTK XML file: its root is <%.60s> where <VTKFile> should be", name);
    }
    for (size_t i = 0; xml->types[i]; i++) {
        if (type && strcmp(type, xml->types[i]) == 0) {
            return MNS_OK;
        }
    }
    return mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "is a VTKFile of type '%.60s' where '%s' should be", type ? type : "",
                         xml->types[0]);
}

static bool locate(struct vtk_xml *xml)
{
    XML_Index at = XML_GetCurrentByteIndex(xml->parser);
    int size = XML_GetCurrentByteCount(xml->parser);
    bool inside = at >= 0 && size >= 0 && (uint64_t)at <= xml->fed && (size_t)size <= xml->fed - (size_t)at;
    xml->seen = inside ? (size_t)at + (size_t)size : 0;
    xml->tag_at = inside ? (size_t)at + xml->skipped : 0;
    xml->tag_end = xml->tag_at + (inside ? (size_t)size : 0);
    return inside;
}

static void XMLCALL on_start(void *user, const XML_Char *name, const XML_Char **attributes)
{
    struct vtk_xml *xml = user;
    if (xml->stop || xml->result != MNS_OK) {
        return;
    }
    mns_result result = MNS_OK;
    if (++xml->depth > DEPTH_MAX) {
        result = mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "has elements nested more than %d deep", (int)DEPTH_MAX);
    } else if (!locate(xml)) {
        result = mns_read_fail(xml->context, MNS_ERR_UNSUPPORTED, "has more XML than this machine's expat can address");
    }
    if (result == MNS_OK && xml->depth == 0) {
        result = check_root(xml, name, (const char *const *)attributes);
    }
    if (result == MNS_OK) {
        result = xml->start(xml, name, (const char *const *)attributes);
    }
    if (result != MNS_OK || xml->stop) {
        stop_with(xml, result);
    }
}

static void XMLCALL on_end(void *user, const XML_Char *name)
{
    struct vtk_xml *xml = user;
    (void)name; /* expat has checked that it fits */
    if (xml->stop || xml->result != MNS_OK) {
        return;
    }
    mns_result result = MNS_OK;
    if (!locate(xml)) {
        result = mns_read_fail(xml->context, MNS_ERR_UNSUPPORTED, "has more XML than this machine's expat can address");
    }
    if (result == MNS_OK && xml->end) {
        result = xml->end(xml);
    }
    xml->depth--;
    if (result != MNS_OK) {
        stop_with(xml, result);
    }
}

/* No VTK file has one, and all that makes XML dangerous needs one. */
static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system, const XML_Char *public, int internal)
{
    struct vtk_xml *xml = user;
    (void)name, (void)system, (void)public, (void)internal;
    if (xml->result == MNS_OK) {
        stop_with(xml, mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "has a DOCTYPE, which no VTK file has"));
    }
}

/* A section of raw text could hide what looks like tags. */
static void XMLCALL on_cdata(void *user)
{
    struct vtk_xml *xml = user;
    if (xml->result == MNS_OK && !xml->stop) {
        stop_with(xml, mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "has a CDATA section, which no VTK file has"));
    }
}

/* How many bytes to give to expat: up to a '>', but no fewer than it has not finished, or a tag full of '>' would take the square of its
 * length. */
static size_t next_size(const struct vtk_xml *xml)
{
    const size_t most = (size_t)1 << 28; /* expat counts in int, and doubles it */
    const uint8_t *next = xml->file.data + xml->at;
    size_t left = xml->file.size - xml->at, pending = xml->fed - xml->seen, chunk = pending > CHUNK ? pending : CHUNK;
    const uint8_t *close = pending < left ? memchr(next + pending, '>', left - pending) : NULL;
    size_t size = close ? (size_t)(close - next) + 1 : left;
    size = size < chunk ? size : chunk;
    return size < most ? size : most;
}

static void skip_text(struct vtk_xml *xml)
{
    size_t left = xml->file.size - xml->at;
    const uint8_t *next = xml->file.data + xml->at, *open;
    if (xml->fed != xml->seen || left == 0) { /* a tag or comment goes on */
        return;
    }
    open = memchr(next, '<', left);
    size_t text = open ? (size_t)(open - next) : left;
    xml->at += text;
    xml->skipped += text;
}

static mns_result fail_xml(struct vtk_xml *xml)
{
    enum XML_Error error = XML_GetErrorCode(xml->parser);
    XML_Index index = XML_GetCurrentByteIndex(xml->parser);
    size_t line = 1, place = (index > 0 ? (size_t)index : 0) + xml->skipped;
    if (error == XML_ERROR_NO_MEMORY) {
        return mns_read_fail(xml->context, MNS_ERR_OUT_OF_MEMORY, "out of memory in expat");
    }
    for (size_t i = 0; i < place && i < xml->file.size; i++) {
        line += xml->file.data[i] == '\n';
    }
    return mns_read_fail(xml->context, MNS_ERR_BAD_DATA, "line %zu of the XML: %s", line, XML_ErrorString(error));
}

mns_result mns_xml_parse(struct vtk_xml *xml)
{
    XML_Parser parser = XML_ParserCreate(NULL);
    if (!parser) {
        return mns_read_fail(xml->context, MNS_ERR_OUT_OF_MEMORY, "out of memory in expat");
    }
    xml->parser = parser;
    xml->depth = -1;
    xml->result = MNS_OK;
    xml->at = xml->fed = xml->seen = xml->skipped = 0;
    XML_SetUserData(parser, xml);
    XML_SetElementHandler(parser, on_start, on_end);
    XML_SetStartDoctypeDeclHandler(parser, on_doctype);
    XML_SetStartCdataSectionHandler(parser, on_cdata);
    enum XML_Status status = XML_STATUS_OK;
    while (status == XML_STATUS_OK && xml->at < xml->file.size) {
        size_t size = next_size(xml);
        const char *next = (const char *)xml->file.data + xml->at;
        xml->at += size;
        xml->fed += size;
        status = XML_Parse(parser, next, (int)size, 0);
        skip_text(xml);
    }
    if (status == XML_STATUS_OK) {
        status = XML_Parse(parser, "", 0, 1);
    }
    if (xml->result == MNS_OK && !xml->stop && status != XML_STATUS_OK) {
        xml->result = fail_xml(xml);
    }
    XML_ParserFree(parser);
    return xml->result;
}

const char *mns_xml_get(const char *const *attributes, const char *name)
{
    for (size_t i = 0; attributes[i]; i += 2) {
        if (strcmp(attributes[i], name) == 0) {
            return attributes[i + 1];
        }
    }
    return NULL;
}

bool mns_xml_count(const char *text, size_t *out)
{
    int64_t value;
    if (!text) {
        return false;
    }
    const char *end = text + strlen(text), *after = mns_parse_int64(text, end, &value);
    if (!after || after != end || value < 0 || (uint64_t)value > SIZE_MAX / 16) {
        return false;
    }
    *out = (size_t)value;
    return true;
}

/* ---- telling the format ---- */

static const uint8_t *find(const uint8_t *at, const uint8_t *end, const char *text)
{
    size_t length = strlen(text);
    for (; (size_t)(end - at) >= length; at++) {
        at = memchr(at, text[0], (size_t)(end - at) - length + 1);
        if (!at) {
            return NULL;
        }
        if (memcmp(at, text, length) == 0) {
            return at;
        }
    }
    return NULL;
}

int mns_xml_probe(struct bytes head, const char *const *types)
{
    const uint8_t *at = head.data, *end = head.data + head.size;
    if (head.size >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0) { /* UTF-8's byte order mark */
        at += 3;
    }
    while (at < end && *at <= ' ') {
        at++;
    }
    if (at == end || *at != '<') {
        return 0;
    }
    const uint8_t *root = find(at, end, "<VTKFile");
    const uint8_t *close = root ? memchr(root, '>', (size_t)(end - root)) : NULL;
    const uint8_t *type = close ? find(root, close, "type=") : NULL;
    while (type && type[-1] > ' ') { /* header_type= */
        type = find(type + 1, close, "type=");
    }
    for (size_t i = 0; type && types[i]; i++) {
        size_t length = strlen(types[i]);
        if ((size_t)(close - type) >= 7 + length && memcmp(type + 6, types[i], length) == 0 &&
            (type[6 + length] == '"' || type[6 + length] == '\'')) {
            return 2;
        }
    }
    return 0;
}

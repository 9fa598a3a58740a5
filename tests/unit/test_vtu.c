/* VTK XML files: every encoding, header, byte order and compression, several pieces; what is wrong with them. */
#include "io_test.h"

enum { POINTS = 5, BLOCK_BYTES = 16 };
enum coding { ASCII, INLINE, APPENDED_BASE64, APPENDED_RAW };
enum compression { NONE, ZLIB, LZ4 };

struct kind {
    enum coding coding;
    enum compression compression;
    int header; /* bytes */
    int big_endian, polydata, pieces;
    int apart; /* base64: the header without compression is a stream of its own, as some writers have it */
};

/* ---- writing ---- */

static void add_base64(struct blob *blob, const uint8_t *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = (uint32_t)data[i] << 16 | (i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0) | (i + 2 < size ? data[i + 2] : 0);
        char text[5] = {digits[bits >> 18], digits[bits >> 12 & 63], i + 1 < size ? digits[bits >> 6 & 63] : '=',
                        i + 2 < size ? digits[bits & 63] : '=', 0};
        add_text(blob, text);
    }
}

/* A zlib stream whose bytes are stored. */
static void add_zlib(struct blob *blob, const uint8_t *data, size_t size)
{
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < size; i++) {
        a = (a + data[i]) % 65521;
        b = (b + a) % 65521;
    }
    add_integer(blob, 0x7801, 2, 1);
    add_integer(blob, 1, 1, 1);
    add_integer(blob, size, 2, 0);
    add_integer(blob, ~size & 0xffff, 2, 0);
    add(blob, data, size);
    add_integer(blob, b << 16 | a, 4, 1);
}

/* An lz4 block of literals alone. */
static void add_lz4(struct blob *blob, const uint8_t *data, size_t size)
{
    add_integer(blob, size < 15 ? size << 4 : 0xf0, 1, 0);
    if (size >= 15) {
        add_integer(blob, size - 15, 1, 0);
    }
    add(blob, data, size);
}

/* The header and the data of an array as the kind has them, in raw bytes or in base64. */
static void add_packed(struct blob *blob, const struct blob *data, const struct kind *kind)
{
    struct blob header = {.size = 0}, body = {.size = 0};
    if (kind->compression == NONE) {
        add_integer(&header, data->size, kind->header, kind->big_endian);
        add(&body, data->data, data->size);
    } else {
        size_t blocks = (data->size + BLOCK_BYTES - 1) / BLOCK_BYTES;
        add_integer(&header, blocks, kind->header, kind->big_endian);
        add_integer(&header, BLOCK_BYTES, kind->header, kind->big_endian);
        add_integer(&header, data->size % BLOCK_BYTES, kind->header, kind->big_endian);
        for (size_t i = 0; i < blocks; i++) {
            size_t before = body.size, left = data->size - i * BLOCK_BYTES;
            (kind->compression == ZLIB ? add_zlib : add_lz4)(&body, data->data + i * BLOCK_BYTES, left < BLOCK_BYTES ? left : BLOCK_BYTES);
            add_integer(&header, body.size - before, kind->header, kind->big_endian);
        }
    }
    if (kind->coding == APPENDED_RAW) {
        add(blob, header.data, header.size);
        add(blob, body.data, body.size);
    } else if (kind->compression == NONE && !kind->apart) {
        add(&header, body.data, body.size);
        add_base64(blob, header.data, header.size);
    } else {
        add_base64(blob, header.data, header.size);
        add_base64(blob, body.data, body.size);
    }
}

/* Component c of point i of an array: [0] position, [1] velocity, [2] id */
static double wanted(int array, int i, int c) { return array == 0 ? i + 0.25 * c : array == 1 ? -10.0 * i - c : 4000000000.0 + i; }

static void add_array(struct blob *xml, struct blob *appended, const struct kind *kind, int array, int first)
{
    static const char *const names[] = {"Points", "velocity", "id"}, *const types[] = {"Float32", "Float64", "UInt32"};
    int components = array == 2 ? 1 : 3;
    struct blob data = {.size = 0};
    char text[256];
    snprintf(text, sizeof(text), "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"%s\"", types[array], names[array],
             components,
             kind->coding == ASCII    ? "ascii"
             : kind->coding == INLINE ? "binary"
                                      : "appended");
    add_text(xml, text);
    for (int i = first; i < first + POINTS; i++) {
        for (int c = 0; c < components; c++) {
            double value = wanted(array, i, c);
            snprintf(text, sizeof(text), "%.10g%c", value, c == 2 ? '\n' : ' ');
            if (kind->coding == ASCII) {
                add_text(&data, text);
            } else if (array == 0) {
                add_float(&data, (float)value, kind->big_endian);
            } else if (array == 1) {
                add_double(&data, value, kind->big_endian);
            } else {
                add_integer(&data, (uint64_t)value, 4, kind->big_endian);
            }
        }
    }
    if (kind->coding == APPENDED_BASE64 || kind->coding == APPENDED_RAW) {
        snprintf(text, sizeof(text), " offset=\"%zu\"/>\n", appended->size);
        add_text(xml, text);
        add_packed(appended, &data, kind);
        return;
    }
    add_text(xml, ">\n<InformationKey name=\"N\" location=\"L\"><Value index=\"0\">1</Value></InformationKey>\n");
    if (kind->coding == ASCII) {
        add(xml, data.data, data.size);
    } else {
        add_packed(xml, &data, kind);
    }
    add_text(xml, "\n<InformationKey name=\"N\" location=\"L\"/>\n</DataArray>\n");
}

static void make(struct blob *xml, const struct kind *kind)
{
    static const char *const compressors[] = {"", " compressor=\"vtkZLibDataCompressor\"", " compressor=\"vtkLZ4DataCompressor\""};
    const char *type = kind->polydata ? "PolyData" : "UnstructuredGrid";
    struct blob appended = {.size = 0};
    char text[512];
    xml->size = 0;
    snprintf(text, sizeof(text),
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\" header_type=\"%s\"%s>\n<%s>\n", type,
             kind->big_endian ? "BigEndian" : "LittleEndian", kind->header == 8 ? "UInt64" : "UInt32", compressors[kind->compression],
             type);
    add_text(xml, text);
    add_text(
        xml,
        "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.5</DataArray></FieldData>\n");
    for (int p = 0; p < kind->pieces; p++) {
        snprintf(text, sizeof(text), "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"0\">\n<PointData>\n", (int)POINTS);
        add_text(xml, text);
        add_array(xml, &appended, kind, 1, p * POINTS);
        add_array(xml, &appended, kind, 2, p * POINTS);
        add_text(xml,
                 "<DataArray type=\"String\" Name=\"names\" format=\"ascii\">1 2 3</DataArray>\n</PointData>\n<CellData/>\n<Points>\n");
        add_array(xml, &appended, kind, 0, p * POINTS);
        add_text(xml, "</Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\"/></Cells>\n</Piece>\n");
    }
    snprintf(text, sizeof(text), "</%s>\n", type);
    add_text(xml, text);
    if (kind->coding == APPENDED_BASE64 || kind->coding == APPENDED_RAW) {
        add_text(xml, kind->coding == APPENDED_RAW ? "<AppendedData encoding=\"raw\">\n _" : "<AppendedData encoding=\"base64\">\n _");
        add(xml, appended.data, appended.size);
        add_text(xml, "\n</AppendedData>\n");
    }
    add_text(xml, "</VTKFile>\n");
}

static void check(const mns_particle_set *set, const struct kind *kind)
{
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_string_equal(mns_particle_set_format(set), kind->polydata ? "vtp" : "vtu");
    assert_int_equal(particles->count, kind->pieces * POINTS);
    assert_int_equal(mns_particle_set_attribute_count(set), 3);
    assert_int_equal(particles->position.type, MNS_F32);
    assert_int_equal(particles->velocity.type, MNS_F64);
    assert_int_equal(particles->id.type, MNS_U32);
    for (int i = 0; i < kind->pieces * POINTS; i++) {
        assert_vector(particles->position, (size_t)i, wanted(0, i, 0), wanted(0, i, 1), wanted(0, i, 2));
        assert_vector(particles->velocity, (size_t)i, wanted(1, i, 0), wanted(1, i, 1), wanted(1, i, 2));
        assert_true(value_of(particles->id, (size_t)i, 0) == wanted(2, i, 0));
    }
}

static int is_there(enum compression compression)
{
#ifndef MNS_HAVE_ZLIB
    if (compression == ZLIB)
        return 0;
#endif
#ifndef MNS_HAVE_LZ4
    if (compression == LZ4)
        return 0;
#endif
    (void)compression;
    return 1;
}

/* ---- reading ---- */

static void every_encoding_is_read(void **state)
{
    (void)state;
    for (int i = 0; i < 4 * 3 * 2 * 2 * 2 * 2 * 2; i++) {
        const struct kind kind = {.coding = (enum coding)(i & 3),
                                  .header = i & 4 ? 8 : 4,
                                  .big_endian = i >> 3 & 1,
                                  .polydata = i >> 4 & 1,
                                  .pieces = 1 + (i >> 5 & 1),
                                  .apart = i >> 6 & 1,
                                  .compression = (enum compression)(i >> 7)};
        struct blob blob;
        if (!is_there(kind.compression)) {
            continue;
        }
        make(&blob, &kind);
        mns_particle_set *set = read_blob(blob.data, blob.size, "a.xml", NULL);
        check(set, &kind);
        mns_particle_set_destroy(&set);
    }
}

/* From a file, whose bytes are the reader's own: at every distance from an aligned address. */
static void raw_data_stay_in_place(void **state)
{
    (void)state;
    for (int i = 0; i < 8 * 2 * 2 * 2; i++) {
        const struct kind kind = {.coding = APPENDED_RAW, .header = i & 8 ? 8 : 4, .pieces = 1 + (i >> 4 & 1), .big_endian = i >> 5};
        struct blob blob;
        struct mns_message message;
        mns_particle_set *set;
        make(&blob, &kind);
        size_t declaration = strlen("<?xml version=\"1.0\"?>"), blanks = (size_t)(i & 7);
        FILE *file = fopen("test_vtu_raw.vtu", "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(blob.data, 1, declaration, file), declaration);
        assert_int_equal(fwrite("        ", 1, blanks, file), blanks);
        assert_int_equal(fwrite(blob.data + declaration, 1, blob.size - declaration, file), blob.size - declaration);
        assert_int_equal(fclose(file), 0);
        mns_result result = mns_particle_set_read(&set, "test_vtu_raw.vtu", NULL, &message);
        remove("test_vtu_raw.vtu");
        if (result != MNS_OK) {
            fail_msg("%s", message.text);
        }
        check(set, &kind);
        mns_particle_set_destroy(&set);
    }
}

#ifdef MNS_HAVE_LZMA
static void lzma_is_read(void **state)
{
    (void)state;
    static const uint8_t xz[] = {0xfd, 0x37, 0x7a, 0x58, 0x5a, 0x00, 0x00, 0x01, 0x69, 0x22, 0xde, 0x36, 0x02, 0x00, 0x21,
                                 0x01, 0x16, 0x00, 0x00, 0x00, 0x74, 0x2f, 0xe5, 0xa3, 0x01, 0x00, 0x13, 0x00, 0x00, 0x7a,
                                 0x44, 0x00, 0x40, 0x7a, 0x44, 0x00, 0x80, 0x7a, 0x44, 0x00, 0xc0, 0x7a, 0x44, 0x00, 0x00,
                                 0x7b, 0x44, 0x00, 0x3b, 0x79, 0xb8, 0x16, 0x00, 0x01, 0x28, 0x14, 0xfc, 0xcf, 0x01, 0x67,
                                 0x90, 0x42, 0x99, 0x0d, 0x01, 0x00, 0x00, 0x00, 0x00, 0x01, 0x59, 0x5a}; /* five floats, 1000 to 1004 */
    struct blob blob = {.size = 0}, header = {.size = 0};
    add_text(
        &blob,
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" compressor=\"vtkLZMADataCompressor\"><PolyData><Piece NumberOfPoints=\"5\">"
        "<PointData><DataArray type=\"Float32\" Name=\"density\" format=\"binary\">");
    add_integer(&header, 1, 4, 0);
    add_integer(&header, 20, 4, 0);
    add_integer(&header, 0, 4, 0);
    add_integer(&header, sizeof(xz), 4, 0);
    add_base64(&blob, header.data, header.size);
    add_base64(&blob, xz, sizeof(xz));
    add_text(
        &blob,
        "</DataArray></PointData><Points><DataArray type=\"Float32\" format=\"ascii\">0 0 0 1 1 1 2 2 2 3 3 3 4 4 4</DataArray></Points>"
        "</Piece></PolyData></VTKFile>");
    mns_particle_set *set = read_blob(blob.data, blob.size, "a.vtp", NULL);
    for (int i = 0; i < 5; i++) {
        assert_true(value_of(mns_particle_set_particles(set)->density, (size_t)i, 0) == 1000.0 + i);
    }
    mns_particle_set_destroy(&set);
}
#endif

/* <VTKFile ...> around a body, as PolyData without compression. */
static void wrap(struct blob *blob, const char *attributes, const char *body)
{
    blob->size = 0;
    add_text(blob, "<VTKFile type=\"PolyData\" ");
    add_text(blob, attributes);
    add_text(blob, "><PolyData>");
    add_text(blob, body);
}

#define POINTS_OF(text)      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">" text "</DataArray></Points>"
#define PIECE(count, inside) "<Piece NumberOfPoints=\"" count "\">" inside "</Piece>"
#define END                  "</PolyData></VTKFile>"

static mns_particle_set *read_body(const char *body)
{
    struct blob blob;
    wrap(&blob, "", body);
    return read_blob(blob.data, blob.size, "a.vtp", NULL);
}

static void pieces_may_differ(void **state)
{
    (void)state;
    /* one is empty, one lacks an array, one has its ghosts marked */
    mns_particle_set *set = read_body(
        PIECE("0", "") PIECE("1", "<PointData><DataArray type=\"Int32\" Name=\"id\" format=\"ascii\">7</DataArray>"
                                  "<DataArray type=\"Float32\" Name=\"rho\" format=\"ascii\">7</DataArray></PointData>" POINTS_OF("1 2 3"))
            PIECE("2", "<PointData><DataArray type=\"Int32\" Name=\"id\" format=\"ascii\">8 9</DataArray><DataArray type=\"UInt8\" "
                       "Name=\"vtkGhostType\" format=\"ascii\">1 0</DataArray></PointData>" POINTS_OF("4 5 6 7 8 9")) END);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_int_equal(particles->count, 2);
    assert_vector(particles->position, 1, 7, 8, 9);
    assert_true(value_of(particles->id, 1, 0) == 9.0);
    assert_null(particles->density.data);
    mns_particle_set_destroy(&set);
    set = read_body(END);
    assert_int_equal(mns_particle_set_particles(set)->count, 0);
    mns_particle_set_destroy(&set);
    set = read_body(PIECE("2", POINTS_OF("nan 0 0 1 2 3")) END);
    assert_int_equal(mns_particle_set_dropped(set), 1);
    mns_particle_set_destroy(&set);
}

static void base64_may_have_blanks(void **state)
{
    (void)state;
    /* 12 0 0 0, then three floats 1 2 3: DAAAAAAAgD8AAABAAABAQA== */
    mns_particle_set *set = read_body(
        PIECE("1", "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">\n  DAAA AAAAgD\n8AAA\tBAAABA QA\n=="
                   "\n</DataArray></Points>") END);
    assert_vector(mns_particle_set_particles(set)->position, 0, 1, 2, 3);
    mns_particle_set_destroy(&set);
}

static void refuse_file(const char *text, mns_result code, const char *words)
{
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = "vtp";
    refuses(text, strlen(text), "a.vtp", &params, code, words);
}

static void refuse(const char *attributes, const char *body, mns_result code, const char *words)
{
    struct blob blob;
    wrap(&blob, attributes, body);
    refuses(blob.data, blob.size, "a.vtp", NULL, code, words);
}

static void bad_xml_is_refused(void **state)
{
    (void)state;
    refuse_file("x", MNS_ERR_BAD_DATA, "line 1 of the XML: ");
    refuse_file("<VTKFile type=\"PolyData\">\n<PolyData>\n</Poly></VTKFile>", MNS_ERR_BAD_DATA, "line 3 of the XML: mismatched tag");
    refuse_file("<VTKFile type=\"PolyData\"><PolyData>", MNS_ERR_BAD_DATA, "no element found");
    refuse_file("<html/>", MNS_ERR_BAD_DATA, "its root is <html> where <VTKFile> should be");
    refuse_file("<VTKFile/>", MNS_ERR_BAD_DATA, "of type '' where 'PolyData' should be");
    refuse_file("<VTKFile type=\"ImageData\"/>", MNS_ERR_BAD_DATA, "of type 'ImageData' where 'PolyData' should be");
    refuse_file("<VTKFile type=\"PolyData\"></VTKFile>", MNS_ERR_BAD_DATA, "has no <PolyData>");
    refuse_file("<VTKFile type=\"PolyData\">\n<!-- > --><PolyData>\n1 2\n3\n</Poly></VTKFile>", MNS_ERR_BAD_DATA,
                "line 5 of the XML: mismatched tag");
    refuse_file("<VTKFile type=\"PolyData\"><![CDATA[ > ]]></VTKFile>", MNS_ERR_BAD_DATA, "has a CDATA section");
    refuse_file("<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile type=\"PolyData\"/>", MNS_ERR_BAD_DATA, "has a DOCTYPE");
    refuse_file("<VTKFile type=\"PolyData\"><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a>", MNS_ERR_BAD_DATA,
                "nested more than 16 deep");
    refuse("byte_order=\"MiddleEndian\"", END, MNS_ERR_BAD_DATA, "byte_order=\"MiddleEndian\"> where LittleEndian or BigEndian should be");
    refuse("header_type=\"UInt16\"", END, MNS_ERR_BAD_DATA, "header_type=\"UInt16\"> where UInt32 or UInt64 should be");
    refuse("compressor=\"vtkZstdDataCompressor\"", END, MNS_ERR_UNSUPPORTED, "'vtkZstdDataCompressor'; zlib, lz4 and lzma are read");
    refuse("", "</PolyData><AppendedData encoding=\"hex\">_", MNS_ERR_BAD_DATA, "encoding=\"hex\"> where raw or base64 should be");
}

static void bad_pieces_are_refused(void **state)
{
    (void)state;
    const char *const pieces[][2] = {
        {"<Piece/>", "<Piece NumberOfPoints=\"\"> where the number of points should be"},
        {PIECE("-1", ""), "NumberOfPoints=\"-1\""},
        {PIECE("2x", ""), "NumberOfPoints=\"2x\""},
        {PIECE("99999999999999999999", ""), "NumberOfPoints=\"99999999999999999999\""},
        {PIECE("2", ""), "has no positions for its 2 points"},
        {PIECE("2", "<PointData><DataArray Name=\"a\"/></PointData>"), "<DataArray type=\"\">"},
        {PIECE("1", "<Points><DataArray type=\"Float32\" NumberOfComponents=\"2\">1 2</DataArray></Points>"), "positions of 2 components"},
        {PIECE("1", "<Points><DataArray type=\"Float32\" NumberOfComponents=\"0\">1 2</DataArray></Points>"), "NumberOfComponents=\"0\""},
        {PIECE("1", "<Points><DataArray type=\"Float32\" format=\"hex\">1 2 3</DataArray></Points>"), "format=\"hex\""},
        {PIECE("1", "<Points><DataArray type=\"Float32\" format=\"appended\"/></Points>"), "offset=\"\""},
        {PIECE("1", "<Points><DataArray type=\"Float32\" format=\"appended\" offset=\"1\"/></Points>"),
         "has no <AppendedData>, where 'Points' should be"},
        {PIECE("1", POINTS_OF("1.0 2.0")), "'Points' holds 2 numbers where 3 should be"},
        {PIECE("1", POINTS_OF("1 2 3 4")), "more than the 3 numbers"},
        {PIECE("1", POINTS_OF("1 two 3")), "number 2 of 'Points': 'two' is no float32"},
        {PIECE("1", POINTS_OF("")), "'Points'"},
        {PIECE("1000000000000", POINTS_OF("1 2 3")), "'Points' has 5 characters"},
    };
    for (size_t i = 0; i < sizeof(pieces) / sizeof(pieces[0]); i++) {
        char body[1024];
        snprintf(body, sizeof(body), "%s%s", pieces[i][0], END);
        refuse("", body, MNS_ERR_BAD_DATA, pieces[i][1]);
    }
    refuse("", PIECE("1", "<Points><DataArray type=\"Int32\" format=\"ascii\">1 2 3</DataArray></Points>") END, MNS_ERR_UNSUPPORTED,
           "positions of type int32");
}

/* One point whose position is appended, raw: these bytes. */
static void refuse_raw(const char *attributes, const char *offset, const struct blob *data, const char *words)
{
    struct blob blob;
    char body[512];
    snprintf(
        body, sizeof(body),
        "<Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float32\" format=\"appended\" offset=\"%s\"/></Points></Piece></PolyData>"
        "<AppendedData encoding=\"raw\">",
        offset);
    wrap(&blob, attributes, body);
    add(&blob, data->data, data->size);
    refuses(blob.data, blob.size, "a.vtp", NULL, MNS_ERR_BAD_DATA, words);
}

/* The numbers of a header behind the underscore, then three floats. */
static struct blob raw(const uint64_t *numbers, size_t count, int bytes)
{
    struct blob blob = {.size = 0};
    add_text(&blob, "_");
    for (size_t i = 0; i < count; i++) {
        add_integer(&blob, numbers[i], bytes, 0);
    }
    for (int i = 0; i < 3; i++) {
        add_float(&blob, 1, 0);
    }
    return blob;
}

static void bad_headers_are_refused(void **state)
{
    (void)state;
    static const char plain[] = "byte_order=\"LittleEndian\"", plain8[] = "byte_order=\"LittleEndian\" header_type=\"UInt64\"";
    struct blob data = {.data = "x", .size = 1};
    refuse_raw(plain, "0", &data, "has no '_' where the appended data begin");
    data = raw((uint64_t[]){12}, 1, 4);
    refuse_raw(plain, "99", &data, "'Points' should begin at byte 99 of the appended data, which have 16");
    refuse_raw(plain, "14", &data, "ends early, in the data of 'Points'");
    data.size--;
    refuse_raw(plain, "0", &data, "ends early, in the data of 'Points'");
    data = raw((uint64_t[]){8}, 1, 4);
    refuse_raw(plain, "0", &data, "'Points' holds 8 bytes where 12 should be");
    data = raw((uint64_t[]){UINT64_MAX}, 1, 8);
    refuse_raw(plain8, "0", &data, "'Points' holds 18446744073709551615 bytes where 12 should be");

    static const char zlib[] = "byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
    data = raw((uint64_t[]){0, 0, 0}, 3, 8);
    refuse_raw(zlib, "0", &data, "'Points' holds 0 bytes where 12 should be");
    data = raw((uint64_t[]){UINT64_MAX, 1, 0, 1}, 4, 8);
    refuse_raw(zlib, "0", &data, "ends early, in the data of 'Points'");
    data = raw((uint64_t[]){1, 8, 0, 12}, 4, 8);
    refuse_raw(zlib, "0", &data, "packed as 1 blocks of 8 bytes, the last of 0; that are not the 12 bytes");
    data = raw((uint64_t[]){2, UINT64_MAX, 12, 4, 4}, 5, 8);
    refuse_raw(zlib, "0", &data, "that are not the 12 bytes that should be there");
    data = raw((uint64_t[]){1, 0, 0, 12}, 4, 8);
    refuse_raw(zlib, "0", &data, "that are not the 12 bytes that should be there");
    data = raw((uint64_t[]){1, 12, 0, 13}, 4, 8);
    refuse_raw(zlib, "0", &data, "ends early, in the data of 'Points'");
#ifdef MNS_HAVE_ZLIB
    data = raw((uint64_t[]){1, 12, 0, 12}, 4, 8);
    refuse_raw(zlib, "0", &data, "a.vtp: 'Points', block 1 of 1: zlib data are corrupt");
#endif

    refuse(plain, PIECE("1", "<Points><DataArray type=\"Float32\" format=\"binary\">DAAA</DataArray></Points>") END, MNS_ERR_BAD_DATA,
           "ends early");
    refuse(plain, PIECE("1", "<Points><DataArray type=\"Float32\" format=\"binary\">DAAAAAAAgD8A</DataArray></Points>") END,
           MNS_ERR_BAD_DATA, "ends early");
    refuse(plain, PIECE("1", "<Points><DataArray type=\"Float32\" format=\"binary\">DAAAAAAAgD8A*ABAAABAQA==</DataArray></Points>") END,
           MNS_ERR_BAD_DATA, "ends early");
}

/* A cut file is refused, whatever its kind: up to the last byte of data, which may be followed by two of padding. */
static void cuts_are_seen(void **state)
{
    (void)state;
    static const struct kind kinds[] = {{.coding = ASCII, .header = 4, .pieces = 1},
                                        {.coding = INLINE, .header = 4, .pieces = 1, .compression = LZ4},
                                        {.coding = APPENDED_RAW, .header = 8, .pieces = 2},
                                        {.coding = APPENDED_BASE64, .header = 8, .pieces = 1},
                                        {.coding = APPENDED_RAW, .header = 4, .pieces = 1, .compression = ZLIB}};
    for (size_t k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++) {
        struct blob blob;
        if (!is_there(kinds[k].compression)) {
            continue;
        }
        make(&blob, &kinds[k]);
        size_t tail = kinds[k].coding < APPENDED_BASE64 ? strlen(">\n") : strlen("\n</AppendedData>\n</VTKFile>\n");
        tail += kinds[k].coding == APPENDED_BASE64 ? strlen("==") : 0;
        for (size_t size = 140; size < blob.size - tail; size++) {
            refuses(blob.data, size, "a.vtu", NULL, MNS_ERR_BAD_DATA, "");
        }
    }
}

static void memory_is_bounded(void **state)
{
    (void)state;
    const struct kind kind = {.coding = INLINE, .header = 4, .pieces = 2};
    struct blob blob;
    struct mns_read_params params;
    mns_read_params_init(&params);
    make(&blob, &kind);
    for (params.max_bytes = 1; params.max_bytes < 2500; params.max_bytes += 50) {
        refuses(blob.data, blob.size, "a.vtu", &params, MNS_ERR_OUT_OF_MEMORY, "max_bytes");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_is_read), cmocka_unit_test(raw_data_stay_in_place),
#ifdef MNS_HAVE_LZMA
        cmocka_unit_test(lzma_is_read),
#endif
        cmocka_unit_test(pieces_may_differ),      cmocka_unit_test(base64_may_have_blanks),  cmocka_unit_test(bad_xml_is_refused),
        cmocka_unit_test(bad_pieces_are_refused), cmocka_unit_test(bad_headers_are_refused), cmocka_unit_test(cuts_are_seen),
        cmocka_unit_test(memory_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* read_csv.c: tables of numbers as text: CSV with comma, semicolon, tab or spaces, with or without names in the first line, and XYZ.
 *
 * Columns whose names differ only in their ending (velocity:0 velocity:1 velocity:2, Points_x Points_y Points_z) become one vector; x, y, z or
 * Points become the position. Values are float64; a column of whole numbers is int64. */
#include "io/set.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMN_MAX = 1024, NAME_LENGTH = 128, VECTOR_MAX = 9 };

enum table_kind { TABLE_NAMED, TABLE_BARE, TABLE_XYZ };

struct column {
    char name[NAME_LENGTH]; /* without its unit */
    char base[NAME_LENGTH]; /* the name without its ending */
    int index;              /* in its vector; -1: a scalar */
    bool text;              /* no numbers: left out */
    bool whole;             /* whole numbers so far */
    double *out;            /* [rows] with stride; NULL: left out */
    size_t stride;
    size_t attribute; /* where whole numbers may be kept as such: index into the set's attributes */
};

struct table {
    struct read_context *context;
    enum table_kind kind;
    char separator;     /* ' ': any run of spaces and tabs */
    struct cursor rows; /* behind the names */
    size_t row_count;
    size_t first_line; /* number of the first line of rows, from 1 */
    size_t column_count;
    struct column *columns; /* [COLUMN_MAX] */
};

/* ---- lines and fields ---- */

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static const char *skip_space(const char *p, const char *end)
{
    while (p < end && is_space(*p)) {
        p++;
    }
    return p;
}

static bool is_blank(struct bytes line)
{
    const char *start = (const char *)line.data, *end = start + line.size, *p = skip_space(start, end);
    return p == end || *p == '#';
}

/* Takes the next field of a line, trimmed and out of its quotes. *more: a separator stood behind it. */
static bool take_field(const char **at, const char *end, char separator, struct bytes *field, bool *more)
{
    const char *p = *at;
    while (p < end && *p != separator && is_space(*p)) {
        p++;
    }
    if (separator == ' ') {
        p = skip_space(p, end);
    }
    if (p == end && !*more) {
        return false;
    }
    const char *start = p, *stop;
    if (p < end && (*p == '"' || *p == '\'')) {
        const char *quote = memchr(p + 1, *p, (size_t)(end - p - 1));
        stop = quote ? quote : end;
        start = p + 1;
        p = quote ? quote + 1 : end;
        while (p < end && *p != separator && !(separator == ' ' && is_space(*p))) {
            p++;
        }
    } else {
        while (p < end && *p != separator && !(separator == ' ' && is_space(*p))) {
            p++;
        }
        stop = p;
    }
    while (stop > start && is_space(stop[-1])) {
        stop--;
    }
    *field = (struct bytes){(const uint8_t *)start, (size_t)(stop - start)};
    if (separator == ' ') {
        p = skip_space(p, end);
    }
    *more = separator != ' ' && p < end;
    *at = p + *more;
    return true;
}

static bool is_number(struct bytes field)
{
    const char *start = (const char *)field.data, *end = start + field.size;
    double value;
    return mns_parse_double(start, end, &value) == end && field.size > 0;
}

static char find_separator(struct bytes line)
{
    static const char candidates[] = {';', ',', '\t'};
    for (size_t i = 0; i < sizeof(candidates); i++) {
        if (memchr(line.data, candidates[i], line.size)) {
            return candidates[i];
        }
    }
    return ' ';
}

static size_t count_fields(struct bytes line, char separator, bool *all_numbers)
{
    const char *at = (const char *)line.data, *end = at + line.size;
    struct bytes field;
    bool more = false;
    size_t count = 0;
    *all_numbers = true;
    while (take_field(&at, end, separator, &field, &more)) {
        *all_numbers &= is_number(field) || (field.size == 0 && count > 0);
        count++;
    }
    return count;
}

/* ---- telling the format ---- */

static bool is_text(struct bytes head)
{
    size_t strange = 0;
    for (size_t i = 0; i < head.size; i++) {
        strange += head.data[i] < 32 && head.data[i] != '\n' && head.data[i] != '\r' && head.data[i] != '\t';
    }
    return strange == 0;
}

/* One line of names and nothing more: a table without rows. */
static bool is_names_alone(struct bytes head)
{
    struct cursor cursor = {head, 0};
    struct bytes line, names = {head.data, 0};
    while (mns_take_line(&cursor, &line)) {
        if (is_blank(line)) {
            continue;
        }
        if (names.size > 0) {
            return false;
        }
        names = line;
    }
    bool numbers;
    char separator = find_separator(names);
    return separator != ' ' && count_fields(names, separator, &numbers) >= 3;
}

/* Perhaps: text with a line of at least two numbers among the first, or a header without rows. */
static int probe(struct bytes head)
{
    struct cursor cursor = {head, 0};
    struct bytes line;
    if (!is_text(head)) {
        return 0;
    }
    for (int i = 0; i < 20 && mns_take_line(&cursor, &line); i++) {
        const char *at = (const char *)line.data, *end = at + line.size;
        struct bytes field;
        bool more = false;
        int numbers = 0;
        char separator = find_separator(line);
        while (numbers < 2 && take_field(&at, end, separator, &field, &more)) {
            numbers += is_number(field);
        }
        if (numbers == 2) {
            return 1;
        }
    }
    return is_names_alone(head);
}

/* ---- names ---- */

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static bool same_name(const char *a, const char *b)
{
    for (; *a && lower(*a) == lower(*b); a++, b++) {
        continue;
    }
    return *a == *b;
}

static bool is_position_name(const char *name)
{
    static const char *const names[] = {"",      "points", "point",       "position", "positions", "pos",
                                        "coord", "coords", "coordinates", "p",        "location"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        if (same_name(name, names[i])) {
            return true;
        }
    }
    return false;
}

/* Cuts a unit off: "Vel.x [m/s]". */
static size_t cut_unit(const char *name, size_t length)
{
    if (length > 2 && (name[length - 1] == ']' || name[length - 1] == ')')) {
        for (size_t i = length - 1; i > 1; i--) {
            if (name[i - 1] == ' ' && (name[i] == '[' || name[i] == '(')) {
                return i - 1;
            }
        }
    }
    return length;
}

/* Splits "velocity:0", "pos_x", "Pos.x", "r[2]", "x" and "posx" into a base and an index. */
static void split_name(struct column *column, const char *name, size_t length)
{
    length = cut_unit(name, length);
    if (length >= NAME_LENGTH) {
        length = NAME_LENGTH - 1;
    }
    memcpy(column->name, name, length);
    column->name[length] = '\0';
    memcpy(column->base, column->name, length + 1);
    column->index = -1;
    bool bracket = length > 2 && name[length - 1] == ']';
    size_t at = length - (bracket ? 2 : 1);
    if (length == 0) {
        return;
    }
    char last = lower(name[at]);
    bool letter = last >= 'x' && last <= 'z', digit = last >= '0' && last < '0' + VECTOR_MAX;
    bool marked = at > 0 && strchr(bracket ? "[" : digit ? ":_." : ":_. ", name[at - 1]) != NULL;
    size_t base = marked ? at - 1 : at;
    if (!letter && !(digit && marked)) {
        return;
    }
    column->base[base] = '\0';
    if (marked || base == 0 || is_position_name(column->base)) {
        column->index = letter ? last - 'x' : last - '0';
        return;
    }
    memcpy(column->base, name, length);
}

static bool same_vector(const struct column *a, const struct column *b)
{
    return a->index >= 0 && b->index >= 0 && strcmp(a->base, b->base) == 0;
}

/* How many components the vector that starts in column c has, in which columns; 1 where it is none. */
static int find_vector(const struct table *table, size_t c, size_t members[VECTOR_MAX])
{
    bool found[VECTOR_MAX] = {false};
    int size = 0;
    for (size_t k = c; k < table->column_count; k++) {
        const struct column *other = &table->columns[k];
        if (!same_vector(&table->columns[c], other) || other->out || other->text) {
            continue;
        }
        if (found[other->index]) {
            return 1;
        }
        found[other->index] = true;
        members[other->index] = k;
        size++;
    }
    for (int i = 0; i < size; i++) {
        if (!found[i]) {
            return 1;
        }
    }
    return size;
}

/* ---- structure ---- */

static void name_bare_columns(struct table *table, bool xyz)
{
    static const char *const axes[] = {"x", "y", "z"};
    size_t first = xyz && table->column_count > 3 ? 1 : 0; /* XYZ: the element stands first */
    for (size_t c = 0; c < table->column_count; c++) {
        char name[32];
        snprintf(name, sizeof(name), "column%zu", c + 1);
        bool axis = c >= first && c < first + 3;
        const char *chosen = axis ? axes[c - first] : c < first ? "type" : name;
        split_name(&table->columns[c], chosen, strlen(chosen));
    }
}

static void name_columns(struct table *table, struct bytes line)
{
    const char *at = (const char *)line.data, *end = at + line.size;
    struct bytes field;
    bool more = false;
    for (size_t c = 0; c < table->column_count && take_field(&at, end, table->separator, &field, &more); c++) {
        split_name(&table->columns[c], (const char *)field.data, field.size);
    }
}

/* Marks columns that hold no numbers in the first row. */
static void mark_text(struct table *table, struct bytes line)
{
    const char *at = (const char *)line.data, *end = at + line.size;
    struct bytes field;
    bool more = false;
    for (size_t c = 0; c < table->column_count && take_field(&at, end, table->separator, &field, &more); c++) {
        struct column *column = &table->columns[c];
        if (field.size == 0) {
            column->text = column->name[0] == '\0'; /* the end of lines that end in a separator */
        }
        if (field.size == 0 || is_number(field)) {
            continue;
        }
        column->text = true;
        if (table->kind != TABLE_XYZ) {
            mns_read_warn(table->context, "column '%s' is left out: it holds text ('%.*s')", column->name,
                          field.size < 40 ? (int)field.size : 40, (const char *)field.data);
        }
    }
}

/* Takes the next line that holds something; counts lines. */
static bool take_row(struct cursor *cursor, struct bytes *line, size_t *line_number)
{
    while (mns_take_line(cursor, line)) {
        ++*line_number;
        if (!is_blank(*line)) {
            return true;
        }
    }
    return false;
}

static size_t count_rows(struct cursor cursor)
{
    struct bytes line;
    size_t rows = 0, lines = 0;
    while (take_row(&cursor, &line, &lines)) {
        rows++;
    }
    return rows;
}

/* XYZ: a line with the number of particles, a line of comment, then one line per particle. */
static bool parse_count_line(struct bytes line, int64_t *count)
{
    const char *start = (const char *)line.data, *end = start + line.size;
    const char *p = mns_parse_int64(skip_space(start, end), end, count);
    return p && skip_space(p, end) == end && *count >= 0;
}

/* The names in a "# x y z" line, as numpy.savetxt writes it, when it has as many as the first row has fields. */
static bool names_in_comment(struct bytes comment, struct bytes row, char separator, struct bytes *names)
{
    bool numbers, row_numbers;
    if (comment.size < 2 || comment.data[0] != '#') {
        return false;
    }
    *names = (struct bytes){comment.data + 1, comment.size - 1};
    return count_fields(*names, separator, &numbers) == count_fields(row, separator, &row_numbers) && !numbers && row_numbers;
}

static mns_result set_structure(struct table *table, struct bytes row, struct bytes names, size_t rows)
{
    bool numbers;
    table->column_count = count_fields(row, table->separator, &numbers);
    if (table->column_count > COLUMN_MAX) {
        return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "line %zu has %zu columns; at most %d are read", table->first_line,
                             table->column_count, (int)COLUMN_MAX);
    }
    for (size_t c = 0; c < table->column_count; c++) {
        table->columns[c] = (struct column){.index = -1, .whole = true};
    }
    if (table->kind == TABLE_NAMED) {
        name_columns(table, names);
    } else {
        name_bare_columns(table, table->kind == TABLE_XYZ);
    }
    if (rows > 0) {
        mark_text(table, row);
    }
    table->row_count = rows;
    /* A row needs a character per field and one between two: a table that is not rectangular must not ask for memory. */
    size_t smallest = 2 * table->column_count - 1;
    if (rows > (mns_left(&table->rows) + 1) / smallest) {
        return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "has not the %zu rows of %zu fields that it should have: it ends early",
                             rows, table->column_count);
    }
    return MNS_OK;
}

static mns_result find_structure(struct table *table, struct bytes file)
{
    if (file.size >= 3 && memcmp(file.data, "\xef\xbb\xbf", 3) == 0) {
        file = (struct bytes){file.data + 3, file.size - 3};
    }
    struct cursor cursor = {file, 0};
    struct bytes first = {NULL, 0}, second, comment = {NULL, 0};
    size_t line = 0;
    while (mns_take_line(&cursor, &first)) {
        line++;
        if (!is_blank(first)) {
            break;
        }
        if (first.size > 0 && first.data[0] == '#') {
            comment = first;
        }
        first.size = 0;
    }
    if (first.size == 0) {
        return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "holds no numbers");
    }
    int64_t count;
    if (parse_count_line(first, &count)) {
        table->kind = TABLE_XYZ;
        if (!mns_take_line(&cursor, &second) && count > 0) {
            return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "ends after the number of particles in line %zu", line);
        }
        table->rows = cursor;
        table->first_line = line + 2;
        size_t lines = 0;
        if (count == 0) {
            return MNS_OK;
        }
        if (!take_row(&cursor, &second, &lines)) {
            return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "says that it has %lld particles, but no line follows the comment",
                                 (long long)count);
        }
        table->separator = find_separator(second);
        return set_structure(table, second, second, (uint64_t)count > SIZE_MAX / 16 ? SIZE_MAX / 16 : (size_t)count);
    }
    bool numbers;
    struct bytes names;
    table->separator = find_separator(first);
    count_fields(first, table->separator, &numbers);
    if (numbers) {
        bool named = names_in_comment(comment, first, table->separator, &names);
        table->kind = named ? TABLE_NAMED : TABLE_BARE;
        table->first_line = line;
        table->rows = (struct cursor){file, (size_t)(first.data - file.data)};
        return set_structure(table, first, named ? names : first, count_rows(table->rows));
    }
    table->kind = TABLE_NAMED;
    table->first_line = line + 1;
    table->rows = cursor;
    size_t lines = 0;
    if (!take_row(&cursor, &second, &lines)) {
        second = (struct bytes){first.data, 0};
    }
    size_t fields = count_fields(first, table->separator, &numbers);
    mns_result result = set_structure(table, second.size ? second : first, first, count_rows(table->rows));
    if (result == MNS_OK && second.size > 0 && table->column_count != fields) {
        return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "line %zu has %zu fields where the first line names %zu",
                             table->first_line + lines - 1, table->column_count, fields);
    }
    return result;
}

/* ---- attributes ---- */

static bool wants_position(const struct table *table, const char *base)
{
    const struct mns_read_params *params = table->context->params;
    for (size_t i = 0; i < params->role_count; i++) {
        if (strncmp(params->roles[i], "position=", 9) == 0) {
            return false; /* found by its name later */
        }
    }
    return is_position_name(base);
}

static mns_result add_attributes(struct table *table)
{
    bool has_position = false;
    for (size_t c = 0; c < table->column_count; c++) {
        struct column *column = &table->columns[c];
        size_t members[VECTOR_MAX] = {c};
        if (column->out || column->text) {
            continue;
        }
        int size = column->index < 0 ? 1 : find_vector(table, c, members);
        bool position = size == 3 && !has_position && wants_position(table, column->base);
        const char *name = position ? "position" : size == 1 ? column->name : column->base[0] ? column->base : "xyz";
        if (size == 1) {
            members[0] = c;
        }
        has_position |= position;
        double *out = mns_set_add(table->context, name, MNS_F64, size);
        if (!out) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
        for (int i = 0; i < size; i++) {
            struct column *member = &table->columns[members[i]];
            member->out = out + i;
            member->stride = (size_t)size;
            member->whole = size == 1;
            member->attribute = table->context->set->attribute_count - 1;
        }
    }
    return MNS_OK;
}

/* ---- numbers ---- */

static mns_result bad_field(const struct table *table, size_t line, size_t c, const char *at, const char *end)
{
    int length = 0;
    while (at + length < end && length < 40 && at[length] != table->separator) {
        length++;
    }
    return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "line %zu, column %zu (%s): '%.*s' is no number", line, c + 1,
                         table->columns[c].name, length, at);
}

static mns_result wrong_count(const struct table *table, size_t line, const char *has)
{
    return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "line %zu has %s than the %zu fields that should be there", line, has,
                         table->column_count);
}

/* Past a field that is left out. */
static const char *skip_field(const char *p, const char *end, char separator)
{
    if (p < end && *p == '"') {
        const char *quote = memchr(p + 1, '"', (size_t)(end - p - 1));
        p = quote ? quote + 1 : end;
    }
    while (p < end && *p != separator && !(separator == ' ' && is_space(*p))) {
        p++;
    }
    return p;
}

static inline const char *skip_padding(const char *p, const char *end, char separator)
{
    while (p < end && (separator == ' ' || *p != separator) && is_space(*p)) {
        p++;
    }
    return p;
}

static inline void store(struct column *column, size_t row, double value)
{
    const double whole_most = 9007199254740992.0; /* 2^53 */
    column->out[row * column->stride] = value;
    column->whole = column->whole && value >= -whole_most && value <= whole_most && value == (double)(int64_t)value;
}

static mns_result read_row(struct table *table, struct bytes line, size_t row, size_t line_number)
{
    const char *p = (const char *)line.data, *end = p + line.size;
    const char separator = table->separator;
    bool expected = true; /* a field: the line begins, or a separator stands before it */
    for (size_t c = 0; c < table->column_count; c++) {
        struct column *column = &table->columns[c];
        double value = (double)NAN; /* of an empty field */
        p = skip_padding(p, end, separator);
        if (p == end && (separator == ' ' || !expected)) {
            return wrong_count(table, line_number, "less");
        }
        const char *start = p;
        if (!column->out) {
            p = skip_field(p, end, separator);
        } else if (p < end && *p != separator) {
            bool quoted = *p == '"';
            p = mns_parse_double(p + quoted, end, &value);
            if (!p) {
                return bad_field(table, line_number, c, start, end);
            }
            p += quoted && p < end && *p == '"';
        }
        if (column->out) {
            store(column, row, value);
        }
        const char *stop = p;
        p = skip_padding(p, end, separator);
        expected = separator != ' ' && p < end && *p == separator;
        if (p < end && !expected && (separator != ' ' || p == stop)) {
            return bad_field(table, line_number, c, start, end);
        }
        p += expected;
    }
    return skip_padding(p, end, ' ') == end ? MNS_OK : wrong_count(table, line_number, "more");
}

static mns_result read_rows(struct table *table)
{
    struct bytes line;
    struct cursor cursor = table->rows;
    size_t line_number = table->first_line - 1;
    for (size_t row = 0; row < table->row_count; row++) {
        if (!take_row(&cursor, &line, &line_number)) {
            return mns_read_fail(table->context, MNS_ERR_BAD_DATA, "ends early: %zu of %zu particles are there", row, table->row_count);
        }
        mns_result result = read_row(table, line, row, line_number);
        if (result != MNS_OK) {
            return result;
        }
    }
    if (table->kind == TABLE_XYZ && take_row(&cursor, &line, &line_number)) {
        mns_read_warn(table->context, "more follows line %zu: only the first frame is read", line_number - 1);
    }
    return MNS_OK;
}

/* Columns of whole numbers become int64, in place: both have 8 bytes. */
static void keep_whole_numbers(const struct table *table)
{
    for (size_t c = 0; c < table->column_count; c++) {
        const struct column *column = &table->columns[c];
        if (!column->out || column->stride != 1 || !column->whole || table->row_count == 0) {
            continue;
        }
        uint8_t *data = (uint8_t *)column->out;
        for (size_t i = 0; i < table->row_count; i++) {
            double value;
            memcpy(&value, data + 8 * i, 8);
            int64_t whole = (int64_t)value;
            memcpy(data + 8 * i, &whole, 8);
        }
        table->context->set->attributes[column->attribute].is.type = MNS_I64;
    }
}

static mns_result read_csv(struct read_context *context, struct bytes file)
{
    struct table table = {.context = context, .first_line = 1};
    table.columns = mns_read_alloc(context, COLUMN_MAX, sizeof(*table.columns));
    if (!table.columns) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    mns_result result = find_structure(&table, file);
    if (result == MNS_OK) {
        result = mns_set_begin(context, table.row_count);
    }
    if (result == MNS_OK) {
        result = add_attributes(&table);
    }
    if (result == MNS_OK) {
        result = read_rows(&table);
    }
    if (result == MNS_OK) {
        keep_whole_numbers(&table);
    }
    mns_read_free(context, table.columns, COLUMN_MAX, sizeof(*table.columns));
    return result;
}

const struct mns_reader mns_reader_csv = {"csv", "csv xyz txt tsv dat", probe, read_csv};

/* bytes.c: bounded reading of bytes, byte order, numbers in text. */
#include "io/reader.h"

#include <float.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOW_MAX = 1000 }; /* characters of a number given to strtod */

bool mns_take(struct cursor *cursor, size_t size, const uint8_t **out)
{
    if (size > mns_left(cursor)) {
        return false;
    }
    *out = cursor->bytes.data + cursor->at;
    cursor->at += size;
    return true;
}

bool mns_take_u16be(struct cursor *cursor, uint16_t *out)
{
    const uint8_t *p;
    if (!mns_take(cursor, 2, &p)) {
        return false;
    }
    *out = (uint16_t)(p[0] << 8 | p[1]);
    return true;
}

bool mns_take_u32be(struct cursor *cursor, uint32_t *out)
{
    const uint8_t *p;
    if (!mns_take(cursor, 4, &p)) {
        return false;
    }
    *out = (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
    return true;
}

bool mns_take_line(struct cursor *cursor, struct bytes *line)
{
    size_t left = mns_left(cursor);
    if (left == 0) {
        return false;
    }
    const uint8_t *start = cursor->bytes.data + cursor->at;
    const uint8_t *newline = memchr(start, '\n', left);
    size_t size = newline ? (size_t)(newline - start) : left;
    cursor->at += size + (newline != NULL);
    *line = (struct bytes){start, size > 0 && start[size - 1] == '\r' ? size - 1 : size};
    return true;
}

/* The swaps below are shifts of whole words, which compilers turn into byte-swap and shuffle instructions. */
static void swap2(uint8_t *out, const uint8_t *in, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint16_t v;
        memcpy(&v, in + 2 * i, 2);
        v = (uint16_t)(v << 8 | v >> 8);
        memcpy(out + 2 * i, &v, 2);
    }
}

static inline uint32_t swapped4(uint32_t v) { return v << 24 | (v & 0xff00u) << 8 | (v >> 8 & 0xff00u) | v >> 24; }

static void swap4(uint8_t *out, const uint8_t *in, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t v;
        memcpy(&v, in + 4 * i, 4);
        v = swapped4(v);
        memcpy(out + 4 * i, &v, 4);
    }
}

static void swap8(uint8_t *out, const uint8_t *in, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t v;
        memcpy(&v, in + 8 * i, 8);
        v = (uint64_t)swapped4((uint32_t)v) << 32 | swapped4((uint32_t)(v >> 32));
        memcpy(out + 8 * i, &v, 8);
    }
}

void mns_copy_elements(void *out, const uint8_t *in, size_t count, enum mns_type type, bool big_endian)
{
    size_t size = mns_type_size(type);
    if (count == 0) {
        return;
    }
    if (size == 1 || big_endian == mns_big_endian()) {
        memcpy(out, in, count * size);
    } else if (size == 2) {
        swap2(out, in, count);
    } else if (size == 4) {
        swap4(out, in, count);
    } else {
        swap8(out, in, count);
    }
}

static const double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* digits * 10^exponent, where that can be told to be correctly rounded; digits < 10^19. */
static bool scale_exactly(uint64_t digits, int exponent, double *out)
{
    if (exponent < -22 || exponent > 22) {
        return false;
    }
    if (digits <= (uint64_t)1 << 53) { /* both factors are exact, so one operation rounds once */
        *out = exponent < 0 ? (double)digits / powers_of_ten[-exponent] : (double)digits * powers_of_ten[exponent];
        return true;
    }
#if LDBL_MANT_DIG == 64
    /* The same in 64 bits. Rounding again to 53 is right unless the 64-bit result lies beside the middle of two doubles. */
    long double scaled = exponent < 0 ? (long double)digits / (long double)powers_of_ten[-exponent]
                                      : (long double)digits * (long double)powers_of_ten[exponent];
    uint64_t mantissa;
    memcpy(&mantissa, &scaled, sizeof(mantissa));
    unsigned below = (unsigned)mantissa & 0x7ffu;
    if (below < 0x3ff || below > 0x401) {
        *out = (double)scaled;
        return true;
    }
#endif
    return false;
}

/* The C library's conversion of [text, end), whatever decimal point the locale has. */
static double convert_slowly(const char *text, const char *end)
{
    char buffer[SLOW_MAX + 16];
    const char *point = localeconv()->decimal_point;
    size_t n = 0;
    for (const char *p = text; p < end && n < SLOW_MAX; p++) {
        if (*p == '.') {
            for (const char *c = point; *c && n < SLOW_MAX; c++) {
                buffer[n++] = *c;
            }
        } else {
            buffer[n++] = (*p | 0x20) == 'd' ? 'e' : *p;
        }
    }
    buffer[n] = '\0';
    return strtod(buffer, NULL);
}

static bool matches_word(const char *text, const char *end, const char *word)
{
    for (; *word; text++, word++) {
        if (text == end || (*text | 0x20) != *word) {
            return false;
        }
    }
    return true;
}

static const char *parse_special(const char *text, const char *end, bool negative, double *out)
{
    if (matches_word(text, end, "nan")) {
        *out = (double)NAN;
        text += 3;
        if (text < end && *text == '(') { /* nan(ind), as Windows programs write it */
            while (text < end && *text++ != ')') {
                continue;
            }
        }
        return text;
    }
    if (matches_word(text, end, "inf")) {
        *out = negative ? -HUGE_VAL : HUGE_VAL;
        return text + (matches_word(text, end, "infinity") ? 8 : 3);
    }
    return NULL;
}

static inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

/* The exponent of 1e-5; text is left alone where there is none. Held within 10 times the range of double. */
static int parse_exponent(const char **text, const char *end)
{
    const char *p = *text;
    if (p == end || ((*p | 0x20) != 'e' && (*p | 0x20) != 'd')) { /* d: Fortran */
        return 0;
    }
    p++;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) {
        p++;
    }
    if (p == end || !is_digit(*p)) {
        return 0;
    }
    int value = 0;
    for (; p < end && is_digit(*p); p++) {
        if (value < 100000) {
            value = value * 10 + (*p - '0');
        }
    }
    *text = p;
    return negative ? -value : value;
}

const char *mns_parse_double(const char *text, const char *end, double *out)
{
    const char *p = text;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) {
        p++;
    }
    const char *start = p;
    uint64_t digits = 0;
    int kept = 0, exponent = 0;
    bool any = false, cut = false, point = false;
    for (; p < end; p++) {
        if (is_digit(*p)) {
            any = true;
            if (kept < 19) {
                digits = digits * 10 + (uint64_t)(*p - '0');
                kept += digits != 0;
                exponent -= point;
            } else {
                cut |= *p != '0';
                exponent += !point && exponent < 100000;
            }
        } else if (*p == '.' && !point) {
            point = true;
        } else {
            break;
        }
    }
    if (!any) {
        return parse_special(start, end, negative, out);
    }
    int power = parse_exponent(&p, end);
    double value = 0.0;
    if (digits != 0 && (cut || !scale_exactly(digits, exponent + power, &value))) {
        if (p - start < SLOW_MAX - 16) {
            value = convert_slowly(start, p);
        } else { /* absurdly long: 19 digits will do */
            char rewritten[48];
            int length = snprintf(rewritten, sizeof(rewritten), "%" PRIu64 "e%d", digits, exponent + power);
            value = convert_slowly(rewritten, rewritten + length);
        }
    }
    *out = negative ? -value : value;
    return p;
}

const char *mns_parse_int64(const char *text, const char *end, int64_t *out)
{
    const char *p = text;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) {
        p++;
    }
    if (p == end || !is_digit(*p)) {
        return NULL;
    }
    uint64_t limit = (uint64_t)INT64_MAX + negative, value = 0;
    for (; p < end && is_digit(*p); p++) {
        uint64_t digit = (uint64_t)(*p - '0');
        if (value > (limit - digit) / 10) {
            return NULL;
        }
        value = value * 10 + digit;
    }
    *out = negative ? -(int64_t)(value - (value != 0)) - (value != 0) : (int64_t)value;
    return p;
}

/* base64.c: RFC 4648, as it stands in VTK's XML files. */
#include "io/base64.h"

/* 0x40 + the six bits of a character; 0: none of base64's */
static const uint8_t sixes[256] = {[' '] = 0, 0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0x7e, 0,    0,    0,    0x7f,
                                   0x74,      0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x7b, 0x7c, 0x7d, 0,    0,    0,    0,    0,    0,
                                   0,         0x40, 0x41, 0x42, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4a, 0x4b, 0x4c, 0x4d, 0x4e,
                                   0x4f,      0x50, 0x51, 0x52, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0,    0,    0,    0,    0,
                                   0,         0x5a, 0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60, 0x61, 0x62, 0x63, 0x64, 0x65, 0x66, 0x67, 0x68,
                                   0x69,      0x6a, 0x6b, 0x6c, 0x6d, 0x6e, 0x6f, 0x70, 0x71, 0x72, 0x73, 0,    0,    0,    0,    0};

enum { VALID = 0x40, EXCESS = VALID << 18 | VALID << 12 | VALID << 6 | VALID };

static bool is_blank(uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* The next four characters, with blanks between them or filled up with '=', as up to three bytes. Returns how many. */
static size_t take_group(const uint8_t **text, const uint8_t *end, uint8_t bytes[3])
{
    const uint8_t *p = *text;
    uint32_t bits = 0;
    size_t count = 0;
    while (p < end && count < 4 && (sixes[*p] || is_blank(*p))) {
        if (sixes[*p]) {
            bits |= (uint32_t)(sixes[*p] & 63) << (18 - 6 * count);
            count++;
        }
        p++;
    }
    for (size_t filled = count; count > 0 && filled < 4 && p < end && (*p == '=' || is_blank(*p)); p++) {
        filled += *p == '=';
    }
    *text = p;
    for (int i = 0; i < 3; i++) {
        bytes[i] = (uint8_t)(bits >> (16 - 8 * i));
    }
    return count > 1 ? count - 1 : 0;
}

size_t mns_base64_decode(struct bytes text, size_t skip, uint8_t *out, size_t size, size_t *used)
{
    const uint8_t *p = text.data, *end = text.data + text.size;
    size_t done = 0;
    while (done < size) {
        if (skip == 0) {
            for (; size - done >= 3 && end - p >= 4; p += 4, done += 3) { /* no blanks, whole groups: nearly always */
                uint32_t a = sixes[p[0]], b = sixes[p[1]], c = sixes[p[2]], d = sixes[p[3]];
                if (!(a & b & c & d & VALID)) {
                    break;
                }
                uint32_t bits = (a << 18) + (b << 12) + (c << 6) + d - EXCESS;
                out[done] = (uint8_t)(bits >> 16);
                out[done + 1] = (uint8_t)(bits >> 8);
                out[done + 2] = (uint8_t)bits;
            }
        }
        if (done == size) {
            break;
        }
        uint8_t bytes[3];
        size_t got = take_group(&p, end, bytes);
        for (size_t i = 0; i < got && done < size; i++) {
            if (skip > 0) {
                skip--;
            } else {
                out[done++] = bytes[i];
            }
        }
        if (got < 3) {
            break;
        }
    }
    *used = (size_t)(p - text.data);
    return done;
}

/* font.c: text in pictures. Glyphs are strokes between points of a grid: the baseline is at 2, capitals reach to 8, small letters to 6, tails to 0. */
#include "font.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = ' ', LAST = '~', CAPITAL = 6 /* grid units from the baseline to the top of a capital */, BASELINE = 2 };

static const float GAP = 1.7f, BLANK = 2.0f, STROKE = 0.8f; /* grid units: between letters, a blank, the width of a stroke */

/* Per character from ' ' on: strokes with blanks between, points XY; a point alone is a dot. */
static const char *const glyphs[LAST - FIRST + 1] = {
    "",                                 /* space */
    "0804 02",                          /* ! */
    "0807 2827",                        /* " */
    "1218 3238 0444 0646",              /* # */
    "4738180706153544433212 2921",      /* $ */
    "0248 0818170708 3343423233",       /* % */
    "4206071828370403122244",           /* & */
    "0807",                             /* ' */
    "18060311",                         /* ( */
    "08161301",                         /* ) */
    "0725 0527 1814",                   /* * */
    "0545 2327",                        /* + */
    "1301",                             /* , */
    "0535",                             /* - */
    "02",                               /* . */
    "0138",                             /* / */
    "183847433212030718",               /* 0 */
    "172822 1232",                      /* 1 */
    "07183847460242",                   /* 2 */
    "07183847463525 354443321203",      /* 3 */
    "32380444",                         /* 4 */
    "480805354443321203",               /* 5 */
    "473818070312324344351504",         /* 6 */
    "084812",                           /* 7 */
    "15060718384746351504031232434435", /* 8 */
    "031232434738180706153546",         /* 9 */
    "05 03",                            /* : */
    "15 1301",                          /* ; */
    "370533",                           /* < */
    "0444 0646",                        /* = */
    "073503",                           /* > */
    "07183847462524 22",                /* ? */
    "433212030718384744242646",         /* @ */
    "022842 1535",                      /* A */
    "0208 083847463505 3544433202",     /* B */
    "4738180703123243",                 /* C */
    "02082846442202",                   /* D */
    "48080242 0535",                    /* E */
    "480802 0535",                      /* F */
    "47381807031232434525",             /* G */
    "0208 4248 0545",                   /* H */
    "1218 0828 0222",                   /* I */
    "3833221203",                       /* J */
    "0208 4804 1542",                   /* K */
    "080242",                           /* L */
    "0208254842",                       /* M */
    "02084248",                         /* N */
    "183847433212030718",               /* O */
    "02083847463505",                   /* P */
    "183847433212030718 2442",          /* Q */
    "02083847463505 2542",              /* R */
    "473818070615354443321203",         /* S */
    "0848 2228",                        /* T */
    "080312324348",                     /* U */
    "082248",                           /* V */
    "0812263248",                       /* W */
    "0248 0842",                        /* X */
    "082548 2522",                      /* Y */
    "08480242",                         /* Z */
    "18080111",                         /* [ */
    "0831",                             /* \ */
    "08181101",                         /* ] */
    "061826",                           /* ^ */
    "0141",                             /* _ */
    "0817",                             /* ` */
    "36160503122233 3632",              /* a */
    "0802 0516263533221203",            /* b */
    "361605031232",                     /* c */
    "3832 3526160503122233",            /* d */
    "043435261605031232",               /* e */
    "38281712 0626",                    /* f */
    "36312000 3526160503122233",        /* g */
    "0802 0516263532",                  /* h */
    "0602 08",                          /* i */
    "161100 18",                        /* j */
    "0802 3603 1432",                   /* k */
    "080312",                           /* l */
    "0206 05162522 25364542",           /* m */
    "0206 0516263532",                  /* n */
    "162635332212030516",               /* o */
    "0006 0516263533221203",            /* p */
    "3036 3526160503122233",            /* q */
    "0206 051626",                      /* r */
    "3616051424332202",                 /* s */
    "18132232 0626",                    /* t */
    "0603122233 3632",                  /* u */
    "062246",                           /* v */
    "0612253246",                       /* w */
    "0632 0236",                        /* x */
    "0622 461000",                      /* y */
    "06360232",                         /* z */
    "28171605141221",                   /* { */
    "0008",                             /* | */
    "08171625141201",                   /* } */
    "04153445",                         /* ~ */
};

static const char box[] = "0208484202";

/* ---- pixels ---- */

static size_t sample_size(enum mns_pixel pixel) { return pixel == MNS_PIXEL_F32 ? 4 : pixel == MNS_PIXEL_U16 ? 2 : 1; }

static float load(const uint8_t *at, enum mns_pixel pixel)
{
    float real;
    uint16_t word;
    switch (pixel) {
    case MNS_PIXEL_F32: memcpy(&real, at, sizeof(real)); return real;
    case MNS_PIXEL_U16: memcpy(&word, at, sizeof(word)); return (float)word / 65535;
    default: return (float)*at / 255;
    }
}

static void store(uint8_t *at, enum mns_pixel pixel, float value)
{
    uint16_t word = pixel == MNS_PIXEL_U16 ? (uint16_t)(value * 65535 + 0.5f) : 0;
    switch (pixel) {
    case MNS_PIXEL_F32: memcpy(at, &value, sizeof(value)); break;
    case MNS_PIXEL_U16: memcpy(at, &word, sizeof(word)); break;
    default: *at = (uint8_t)(value * 255 + 0.5f); break;
    }
}

static float linear_from_srgb(float code) { return code <= 0.04045f ? code / 12.92f : powf((code + 0.055f) / 1.055f, 2.4f); }

void font_blend(const struct mns_image *image, int x, int y, const float srgb[3], float cover)
{
    if (x < 0 || y < 0 || x >= image->width || y >= image->height || !(cover > 0)) {
        return;
    }
    size_t size = sample_size(image->pixel), channels = (size_t)image->channels;
    size_t stride = image->stride ? image->stride : size * channels * (size_t)image->width;
    uint8_t *pixel = (uint8_t *)image->data + (size_t)y * stride + size * channels * (size_t)x;
    float behind = channels == 4 ? load(pixel + 3 * size, image->pixel) : 1, alpha = behind + (1 - behind) * cover;
    for (size_t c = 0; c < channels && c < 3; c++) {
        float over = image->pixel == MNS_PIXEL_F32 ? linear_from_srgb(srgb[c]) : srgb[c];
        float under = load(pixel + c * size, image->pixel) * behind * (1 - cover);
        store(pixel + c * size, image->pixel, (over * cover + under) / alpha);
    }
    if (channels == 4) {
        store(pixel + 3 * size, image->pixel, alpha);
    }
}

/* ---- strokes ---- */

/* What the pen covers, in a rectangle of the image. */
struct ink {
    float *cover; /* [height][width], 0 to 1 */
    int left, top, width, height;
};

struct point {
    float x, y;
};

static float distance_to(struct point p, struct point a, struct point b)
{
    float dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    float t = length2 > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length2 : 0;
    t = fminf(fmaxf(t, 0), 1);
    return hypotf(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/* A stroke with round ends; its edge is a pixel wide. */
static void draw_stroke(struct ink *ink, struct point a, struct point b, float radius)
{
    float reach = radius + 1;
    int first_x = (int)floorf(fminf(a.x, b.x) - reach) - ink->left, last_x = (int)ceilf(fmaxf(a.x, b.x) + reach) - ink->left;
    int first_y = (int)floorf(fminf(a.y, b.y) - reach) - ink->top, last_y = (int)ceilf(fmaxf(a.y, b.y) + reach) - ink->top;
    for (int y = first_y > 0 ? first_y : 0; y <= last_y && y < ink->height; y++) {
        for (int x = first_x > 0 ? first_x : 0; x <= last_x && x < ink->width; x++) {
            const struct point p = {(float)(ink->left + x) + 0.5f, (float)(ink->top + y) + 0.5f};
            float cover = fminf(fmaxf(radius + 0.5f - distance_to(p, a, b), 0), 1);
            float *at = &ink->cover[(size_t)y * (size_t)ink->width + (size_t)x];
            *at = fmaxf(*at, cover);
        }
    }
}

static const char *glyph_of(unsigned char byte) { return byte >= FIRST && byte <= LAST ? glyphs[byte - FIRST] : box; }

/* Grid units from the glyph's left to its right. */
static float glyph_width(const char *glyph)
{
    int most = 0;
    for (const char *at = glyph; *at; at += *at == ' ' ? 1 : 2) {
        most = *at != ' ' && *at - '0' > most ? *at - '0' : most;
    }
    return *glyph ? (float)most : BLANK;
}

static void draw_glyph(struct ink *ink, const char *glyph, float x, float baseline, float unit)
{
    bool down = false; /* the pen */
    struct point before = {0, 0};
    for (const char *at = glyph; *at;) {
        if (*at == ' ') {
            down = false;
            at++;
            continue;
        }
        const struct point here = {x + unit * (float)(at[0] - '0'), baseline - unit * (float)(at[1] - '0' - BASELINE)};
        bool alone = !down && (at[2] == '\0' || at[2] == ' ');
        if (down || alone) {
            draw_stroke(ink, down ? before : here, here, 0.5f * STROKE * unit * (alone ? 1.4f : 1));
        }
        before = here;
        down = true;
        at += 2;
    }
}

float font_width(const char *text, float height)
{
    float width = 0;
    for (const char *at = text; *at; at++) {
        width += glyph_width(glyph_of((unsigned char)*at)) + (at[1] ? GAP : 0);
    }
    return width * height / CAPITAL;
}

int font_draw(const struct mns_image *image, const char *text, float x, float baseline, float height, const float srgb[3])
{
    float unit = height / CAPITAL;
    struct ink ink = {.left = (int)floorf(x - 2 * unit - 1), .top = (int)floorf(baseline - height - 2 * unit - 1)};
    ink.width = (int)ceilf(font_width(text, height) + 4 * unit) + 3;
    ink.height = (int)ceilf(height + 6 * unit) + 3;
    ink.cover = calloc((size_t)ink.width * (size_t)ink.height, sizeof(*ink.cover));
    if (!ink.cover) {
        return false;
    }
    for (const char *at = text; *at; at++) {
        const char *glyph = glyph_of((unsigned char)*at);
        draw_glyph(&ink, glyph, x, baseline, unit);
        x += (glyph_width(glyph) + GAP) * unit;
    }
    for (int i = 0; i < ink.width * ink.height; i++) {
        font_blend(image, ink.left + i % ink.width, ink.top + i / ink.width, srgb, ink.cover[i]);
    }
    free(ink.cover);
    return true;
}

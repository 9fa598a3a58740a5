/* test_splat.c: the kernels of stages bin and splat of every instruction set against plain C, within the tolerances of cpu/splat.h. */
#include "kernels/splat_bench.h"

/* s^2 at a pixel, relative to the most that it is. */
static float inside_of(const struct bench *b, size_t i, int x, int y)
{
    if (b->store.shape[0]) {
        struct ellipsoid e = ellipsoid_project(&b->view, &b->tile[0]->pixels, i);
        struct ellipsoid_poly p = ellipsoid_poly_of(&b->view, &b->tile[0]->pixels, &e);
        return quadratic_at(&p.s2, (float)x + 0.5f - e.sprite.x, (float)y + 0.5f - e.sprite.y) / p.s2.k0;
    }
    struct sprite s = sprite_project(&b->view, &b->tile[0]->pixels, i);
    struct sprite_poly poly = sprite_poly_of(&b->view, &b->tile[0]->pixels, &s);
    float along;
    return sprite_evaluate(&poly, (float)x + 0.5f - s.x, (float)y + 0.5f - s.y, &along) / poly.k0;
}

/* Largest s^2 / R^2 of the set's spheres that are in doubt at a pixel: met at their rim. */
static bool in_doubt(const struct bench *b, int x, int y)
{
    for (size_t i = 0; i < COUNT; i++) {
        if (fabsf(inside_of(b, i, x, y)) < 0.02f) {
            return true;
        }
    }
    return false;
}

static void check_bounds(struct bench *b, const struct splat_kernels *a, const struct splat_kernels *v)
{
    for (size_t first = 0; first < CHUNKS; first += BOUNDS_BATCH) {
        struct splat_bounds plain, vector;
        a->bounds(&b->view, first, &plain);
        v->bounds(&b->view, first, &vector);
        for (size_t i = 0; i < BOUNDS_BATCH && first + i < CHUNKS; i++) {
            const float pairs[][2] = {{plain.x_min[i], vector.x_min[i]},           {plain.x_max[i], vector.x_max[i]},
                                      {plain.y_min[i], vector.y_min[i]},           {plain.y_max[i], vector.y_max[i]},
                                      {plain.near_depth[i], vector.near_depth[i]}, {plain.far_depth[i], vector.far_depth[i]},
                                      {plain.sprite[i], vector.sprite[i]}};
            for (int k = 0; k < 7; k++) {
                assert_true(fabsf(pairs[k][0] - pairs[k][1]) <= 1e-3f + 1e-5f * fabsf(pairs[k][0]));
            }
        }
    }
}

static void check_depth(struct bench *b, const struct splat_kernels *a, const struct splat_kernels *v)
{
    size_t drawn[2] = {0, 0};
    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
        drawn[0] += a->depth(&b->view, b->tile[0], chunk, DEPTH_EMPTY);
        drawn[1] += v->depth(&b->view, b->tile[1], chunk, DEPTH_EMPTY);
    }
    assert_true(drawn[0] > 0 && labs((long)drawn[0] - (long)drawn[1]) <= 3); /* centres on the tile's edge */
    float radius =
        b->view.radius_scale > 0 && !b->store.shape[0] ? 0.2f * b->view.radius : b->view.radius; /* the least, and as of shapes */
    for (int y = 0; y < TILE_SIZE; y++) {
        for (int x = 0; x < TILE_SIZE; x++) {
            float plain = b->tile[0]->nearest[y * TILE_STRIDE + x], vector = b->tile[1]->nearest[y * TILE_STRIDE + x];
            bool alike = fabsf(plain - vector) <= 3e-4f * radius + 1e-6f * fabsf(plain);
            assert_true(alike || in_doubt(b, x, y));
        }
    }
    struct depth_plane planes[2];
    memset(planes, 0, sizeof(planes));
    size_t covered[2];
    for (int i = 0; i < 2; i++) {
        assert_true(mns_depth_plane_resize(&planes[i], &b->memory, b->view.width, b->view.height));
        memset(planes[i].ranges, 0, planes[i].capacity * sizeof(*planes[i].ranges));
        memcpy(b->tile[i]->nearest, b->tile[0]->nearest, TILE_SIZE * TILE_STRIDE * sizeof(float));
    }
    covered[0] = a->resolve_depth(&b->view, b->tile[0], &planes[0]);
    covered[1] = v->resolve_depth(&b->view, b->tile[1], &planes[1]);
    assert_int_equal(covered[0], covered[1]);
    for (size_t i = 0; i < planes[0].plane.floats; i++) {
        assert_true(fabsf(planes[0].plane.block[i] - planes[1].plane.block[i]) <= 1e-6f * planes[0].plane.block[i]);
    }
    for (int i = 0; i < planes[0].blocks_x * planes[0].blocks_y; i++) {
        assert_true(fabsf(planes[0].ranges[i].min - planes[1].ranges[i].min) <= 1e-6f * planes[0].ranges[i].min);
        assert_true(fabsf(planes[0].ranges[i].max - planes[1].ranges[i].max) <= 1e-6f * planes[0].ranges[i].max);
    }
    mns_depth_plane_free(&planes[0], &b->memory);
    mns_depth_plane_free(&planes[1], &b->memory);
}

static void check_thickness(struct bench *b, const struct splat_kernels *a, const struct splat_kernels *v)
{
    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
        /* Every third chunk ends in its middle; a sphere on the edge would fall to either side, and is none here. */
        float end = chunk % 3 == 0 ? 4.0f : DEPTH_EMPTY;
        uint64_t left_out = a->thickness(&b->view, b->tile[0], chunk, end);
        assert_int_equal(v->thickness(&b->view, b->tile[1], chunk, end), left_out);
        assert_true((left_out != 0) == (end < DEPTH_EMPTY));
    }
    assert_int_equal(b->tile[0]->deposited, b->tile[1]->deposited);
    for (int k = 0; k < SUM_COUNT; k++) {
        struct plane planes[2];
        memset(planes, 0, sizeof(planes));
        double total = 0, most = 0, off = 0;
        for (int i = 0; i < 2; i++) {
            assert_true(mns_plane_resize(&planes[i], &b->memory, 128 / b->view.scale, 128 / b->view.scale, PLANE_BORDER));
        }
        a->resolve_sum(&b->view, b->tile[0], k, &planes[0]);
        v->resolve_sum(&b->view, b->tile[1], k, &planes[1]);
        for (size_t i = 0; i < planes[0].floats; i++) {
            double plain = (double)planes[0].block[i], vector = (double)planes[1].block[i];
            total += plain;
            most = fmax(most, plain);
            off += fabs(plain - vector);
            /* A texel may gain or lose the rim of a few chords, s < 0.01 R each. */
            assert_true(fabs(plain - vector) <= 2e-3 * plain + 0.05 * (double)b->view.radius * 2.5);
        }
        assert_true(most > 0 && off <= 5e-4 * total);
        mns_plane_free(&planes[0], &b->memory);
        mns_plane_free(&planes[1], &b->memory);
    }
}

/* With the kernels for particles with a shape in place of those for spheres, whose contracts are the same. */
static struct splat_kernels table_of(enum mns_isa isa, bool with_shapes)
{
    struct splat_kernels table = *mns_kernels_get(isa)->splat;
    if (with_shapes) {
        table.depth = mns_kernels_get(isa)->ellipsoid->depth;
        table.thickness = mns_kernels_get(isa)->ellipsoid->thickness;
    }
    return table;
}

/* Spheres of half a pixel to 30, so that deposits, smooth forms and chords all come up, alone and mixed. */
static void kernels_agree(void **state)
{
    (void)state;
    const float pixels[] = {0.5f, 3, 5, 9, 30};
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i > 0; i--) {
        for (int kind = 0; kind < KINDS; kind++) {
            struct splat_kernels plain = table_of(MNS_ISA_SCALAR, kind >= SHAPES), vector = table_of(isas[i], kind >= SHAPES);
            for (int k = 0; k < 5; k++) {
                for (int scale = 1; scale <= 4; scale *= 2) {
                    struct bench b;
                    open_bench(&b, (enum kind)kind, scale, pixels[k]);
                    check_bounds(&b, &plain, &vector);
                    check_depth(&b, &plain, &vector);
                    check_thickness(&b, &plain, &vector);
                    close_bench(&b);
                }
            }
        }
    }
}

/* Chunks around and beside the eye: the same are culled, the rest get the whole picture. */
static void bounds_close_to_the_eye(void **state)
{
    (void)state;
    const struct splat_kernels *plain = mns_kernels_get(MNS_ISA_SCALAR)->splat;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i > 0; i--) {
        for (int step = -8; step <= 8; step++) {
            struct bench b;
            open_bench(&b, PERSPECTIVE, 4, 3);
            b.view.translation[0] = (float)step;
            b.view.translation[2] = step & 1 ? 0.2f : 1.5f;
            check_bounds(&b, plain, mns_kernels_get(isas[i])->splat);
            close_bench(&b);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_agree),
        cmocka_unit_test(bounds_close_to_the_eye),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

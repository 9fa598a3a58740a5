/* test_foam.c: the kernels of stage foam of every instruction set against plain C, within the tolerances of cpu/foam.h. */
#include "kernels/splat_bench.h"

/* Foam depths as a scene may have them: waves with holes and cliffs. */
static void fill_depth(struct bench *b, struct plane *depth, struct plane *scene)
{
    uint64_t seed = 5;
    memset(depth, 0, sizeof(*depth));
    memset(scene, 0, sizeof(*scene));
    assert_true(mns_plane_resize(depth, &b->memory, b->view.width, b->view.height, 0));
    assert_true(mns_plane_resize(scene, &b->memory, b->view.width, b->view.height, 0));
    for (int y = 0; y < b->view.height; y++) {
        for (int x = 0; x < b->view.width; x++) {
            float z = 4 + 0.4f * sinf(0.1f * (float)x) * cosf(0.07f * (float)y) + (x > 90 ? 0.5f : 0);
            depth->data[y * depth->stride + x] = random_unit(&seed) < 0.3 || (x < 20 && y > 60) ? DEPTH_EMPTY : z;
            scene->data[y * scene->stride + x] = random_unit(&seed) < 0.5 ? DEPTH_EMPTY : 4.2f;
        }
    }
}

static void alike(const float *a, const float *b, double tolerance)
{
    for (int y = 0; y < 121; y++) {
        for (int x = 0; x < 128; x++) {
            double plain = (double)a[y * TILE_STRIDE + x];
            assert_true(fabs(plain - (double)b[y * TILE_STRIDE + x]) <= tolerance * fabs(plain));
        }
    }
}

struct rig {
    struct plane depth[2], scene;
    struct foam_ends ends[2];
    float *limits[2];
};

static void open_rig(struct bench *b, struct rig *rig)
{
    for (int i = 0; i < 2; i++) {
        if (i == 1) {
            mns_plane_free(&rig->scene, &b->memory);
        }
        fill_depth(b, &rig->depth[i], &rig->scene);
        rig->ends[i].all = mns_memory_get(&b->memory, TILE_SIZE * TILE_STRIDE, sizeof(float));
        rig->ends[i].front = mns_memory_get(&b->memory, TILE_SIZE * TILE_STRIDE, sizeof(float));
        rig->limits[i] = mns_memory_get(&b->memory, LIMIT_FLOATS, sizeof(float));
        memset(rig->limits[i], 0, LIMIT_FLOATS * sizeof(float)); /* a kernel clears the rows that its texels take */
        memset(rig->ends[i].all, 0, TILE_SIZE * TILE_STRIDE * sizeof(float));
        memset(rig->ends[i].front, 0, TILE_SIZE * TILE_STRIDE * sizeof(float));
    }
}

static void close_rig(struct bench *b, struct rig *rig)
{
    for (int i = 0; i < 2; i++) {
        mns_memory_put(&b->memory, rig->ends[i].all, TILE_SIZE * TILE_STRIDE, sizeof(float));
        mns_memory_put(&b->memory, rig->ends[i].front, TILE_SIZE * TILE_STRIDE, sizeof(float));
        mns_memory_put(&b->memory, rig->limits[i], LIMIT_FLOATS, sizeof(float));
        mns_plane_free(&rig->depth[i], &b->memory);
    }
    mns_plane_free(&rig->scene, &b->memory);
}

static void check_ends(struct bench *b, struct rig *rig, const struct foam_kernels *const kernels[2], bool has_scene)
{
    size_t covered[2];
    for (int i = 0; i < 2; i++) {
        covered[i] = kernels[i]->ends(&b->view, b->tile[i], 0.3f, has_scene ? &rig->scene : NULL, &rig->depth[i], &rig->ends[i]);
        kernels[i]->limits(&b->view, b->tile[i], &rig->depth[i], rig->limits[i]);
    }
    assert_true(covered[0] > 0 && covered[0] == covered[1]);
    alike(rig->ends[0].all, rig->ends[1].all, 2e-6);
    alike(rig->ends[0].front, rig->ends[1].front, 2e-6);
    for (int i = 0; i < LIMIT_FLOATS; i++) {
        assert_true(fabsf(rig->limits[0][i] - rig->limits[1][i]) <= 1e-6f * rig->limits[0][i]);
    }
    for (size_t i = 0; i < rig->depth[0].floats; i++) {
        assert_true(rig->depth[0].block[i] == rig->depth[1].block[i]);
    }
}

/* One plane of sums of both tiles: each value, and the mean. */
static void check_sum(struct bench *b, int k, double each, double mean)
{
    double total = 0, off = 0;
    const struct splat_kernels *plain = mns_kernels_get(MNS_ISA_SCALAR)->splat;
    struct plane planes[2];
    memset(planes, 0, sizeof(planes));
    for (int i = 0; i < 2; i++) {
        assert_true(mns_plane_resize(&planes[i], &b->memory, 128, 128, 0));
        plain->resolve_sum(&b->view, b->tile[i], k, &planes[i]);
    }
    for (size_t i = 0; i < planes[0].floats; i++) {
        double value = (double)planes[0].block[i], difference = fabs(value - (double)planes[1].block[i]);
        assert_true(difference <= each * value + 0.05 * (double)b->view.radius * 2.5);
        total += value;
        off += difference;
    }
    assert_true(total > 0 && off <= mean * total);
    mns_plane_free(&planes[0], &b->memory);
    mns_plane_free(&planes[1], &b->memory);
}

static void clear(struct bench *b)
{
    for (int i = 0; i < 2; i++) {
        mns_tile_clear(&b->view, b->tile[i], 2);
    }
}

static void kernels_agree(void **state)
{
    (void)state;
    const float pixels[] = {0.5f, 3, 5, 9, 30};
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i > 0; i--) {
        const struct foam_kernels *const kernels[2] = {mns_kernels_get(MNS_ISA_SCALAR)->foam, mns_kernels_get(isas[i])->foam};
        for (int kind = 0; kind < SHAPES; kind++) {
            for (int k = 0; k < 5; k++) {
                for (int scale = 1; scale <= 4; scale *= 2) {
                    struct bench b;
                    struct rig rig;
                    open_bench(&b, (enum kind)kind, scale, pixels[k]);
                    open_rig(&b, &rig);
                    check_ends(&b, &rig, kernels, k % 2 == 0);
                    clear(&b);
                    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
                        for (int j = 0; j < 2; j++) {
                            kernels[j]->front(&b.view, b.tile[j], chunk, rig.limits[j], 5);
                        }
                    }
                    check_sum(&b, 0, 2e-3, 5e-4);
                    for (int j = 0; j < 2; j++) { /* foam has one pixel per texel */
                        b.tile[j]->texels = b.tile[j]->pixels;
                    }
                    b.view.scale = 1;
                    clear(&b);
                    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
                        for (int j = 0; j < 2; j++) {
                            kernels[j]->thickness(&b.view, b.tile[j], chunk, &rig.ends[j], 1);
                        }
                    }
                    check_sum(&b, 0, 4e-3, 1e-3);
                    check_sum(&b, 1, 4e-3, 1e-3);
                    close_rig(&b, &rig);
                    close_bench(&b);
                }
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

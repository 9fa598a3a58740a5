/* test_anisotropy.c: sums over neighbours and shapes of every instruction set against plain C, within the tolerances of cpu/anisotropy.h. */
#include "splat_test.h"

enum { COUNT = 37 };

static struct anisotropy_block block;
static struct anisotropy_batch batch[2];

/* neighbours: in a cube about the batch, scaled by size along each axis. */
static void fill(uint64_t *seed, int neighbours, const double size[3])
{
    block.count = neighbours;
    float *to[3] = {block.x, block.y, block.z};
    for (int i = 0; i < neighbours + ANISOTROPY_PAD; i++) {
        for (int k = 0; k < 3; k++) {
            to[k][i] = i < neighbours ? (float)(size[k] * (2 * random_unit(seed) - 1)) : ANISOTROPY_FAR;
        }
    }
    memset(batch, 0, sizeof(batch));
    for (int i = 0; i < COUNT; i++) {
        for (int n = 0; n < 2; n++) { /* each is its own neighbour */
            batch[n].x[i] = block.x[i % neighbours];
            batch[n].y[i] = block.y[i % neighbours];
            batch[n].z[i] = block.z[i % neighbours];
        }
    }
}

static void kernels_agree(void **state)
{
    (void)state;
    static const double sizes[][3] = {{1, 1, 1},          {0.5, 1, 1}, {1.5, 1e-3, 1}, {1e-4, 1e-4, 1},
                                      {1e-7, 1e-7, 1e-7}, {3, 3, 3},   {0, 0, 0},      {0, 1, 0}};
    static const int counts[] = {1, 2, 16, 100, ANISOTROPY_BLOCK};
    const struct anisotropy_rule rule = {.ratio = 4, .smoothing = 0.9f, .isolated = 0.5f, .lonely = 2, .per_crowd = 0.5f};
    const struct anisotropy_kernels *plain = mns_kernels_get(MNS_ISA_SCALAR)->anisotropy;
    enum mns_isa isas[6];
    for (int n = test_isas(isas) - 1; n > 0; n--) {
        const struct anisotropy_kernels *vector = mns_kernels_get(isas[n])->anisotropy;
        uint64_t seed = 5;
        for (size_t k = 0; k < sizeof(sizes) / sizeof(sizes[0]) * 5; k++) {
            fill(&seed, counts[k % 5], sizes[k / 5]);
            plain->add(&block, &batch[0], 0, COUNT);
            vector->add(&block, &batch[1], 0, 5);
            vector->add(&block, &batch[1], 5, COUNT);
            for (int i = 0; i < COUNT; i++) {
                assert_true(batch[0].sum[0][i] >= 0.999f);
                for (int s = 0; s < ANISOTROPY_SUMS; s++) {
                    assert_true(fabsf(batch[0].sum[s][i] - batch[1].sum[s][i]) <= 1e-3f * batch[0].sum[0][i]);
                }
            }
            memcpy(batch[1].sum, batch[0].sum, sizeof(batch[0].sum));
            plain->shape(&rule, &batch[0], COUNT);
            vector->shape(&rule, &batch[1], COUNT);
            for (int i = 0; i < COUNT; i++) {
                for (int s = 0; s < 6; s++) {
                    assert_true(fabsf(batch[0].shape[s][i] - batch[1].shape[s][i]) <= 1e-4f * 4);
                }
                for (int s = 0; s < 3; s++) {
                    assert_true(fabsf(batch[0].shift[s][i] - batch[1].shift[s][i]) <= 1e-5f);
                }
            }
        }
    }
}

/* A matrix with known eigenvectors: axes 1, 2/3 and less than a quarter, turned. */
static void eigenvectors(void **state)
{
    (void)state;
    const double r[3][3] = {{0.8, 0, 0.6}, {0.48, 0.6, -0.64}, {-0.36, 0.8, 0.48}}, axes[3] = {0.3, 0.2, 0.01};
    const struct anisotropy_rule rule = {.ratio = 4, .isolated = 0.5f, .lonely = 2, .per_crowd = 0.5f};
    const double held[3] = {0.3, 0.2, 0.3 / 4};
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    enum mns_isa isas[6];
    for (int n = test_isas(isas) - 1; n >= 0; n--) {
        double want[6] = {0}, volume = cbrt(held[0] * held[1] * held[2]);
        memset(batch, 0, sizeof(batch));
        batch[0].sum[0][0] = 50;
        for (int k = 0; k < 6; k++) {
            for (int a = 0; a < 3; a++) {
                batch[0].sum[4 + k][0] += (float)(50 * axes[a] * (double)ANISOTROPY_FULL * r[rows[k]][a] * r[columns[k]][a]);
                want[k] += held[a] / volume * r[rows[k]][a] * r[columns[k]][a];
            }
        }
        mns_kernels_get(isas[n])->anisotropy->shape(&rule, &batch[0], 1);
        for (int k = 0; k < 6; k++) {
            assert_true(fabs((double)batch[0].shape[k][0] - want[k]) < 1e-4);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_agree), cmocka_unit_test(eigenvectors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

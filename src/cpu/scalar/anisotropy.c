/* anisotropy.c: sums over neighbours and shapes of particles in plain C: their definition. Formulas: cpu/anisotropy.h. */
#include "cpu/anisotropy.h"

#include <math.h>

static void add(const struct anisotropy_block *block, struct anisotropy_batch *batch, int first, int end)
{
    for (int i = first; i < end; i++) {
        float sum[ANISOTROPY_SUMS] = {0};
        for (int j = 0; j < block->count; j++) {
            float x = block->x[j] - batch->x[i], y = block->y[j] - batch->y[i], z = block->z[j] - batch->z[i];
            float d2 = x * x + y * y + z * z, w = fmaxf(1 - d2 * sqrtf(d2), 0);
            const float terms[ANISOTROPY_SUMS] = {1, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z};
            for (int k = 0; k < ANISOTROPY_SUMS; k++) {
                sum[k] += w * terms[k];
            }
        }
        for (int k = 0; k < ANISOTROPY_SUMS; k++) {
            batch->sum[k][i] += sum[k];
        }
    }
}

/* A symmetric matrix, and the axes that it is turned to. */
struct turned {
    float diagonal[3], off[3]; /* off[k]: of the two axes that are not k */
    float axes[3][3];          /* axes[k]: the k-th */
};

/* Turns axes p and q so that the term between them becomes 0 (Jacobi). r: the third. */
static void rotate(struct turned *m, int p, int q, int r)
{
    float off = m->off[r], apart = m->diagonal[q] - m->diagonal[p];
    /* FLT_MIN: nothing to turn gives 0, not 0 / 0. */
    float t = copysignf(2 * off, apart * off) / (fabsf(apart) + sqrtf(apart * apart + 4 * off * off) + 1.17549435e-38f);
    float c = 1 / sqrtf(1 + t * t), s = t * c, by_p = m->off[q], by_q = m->off[p];
    m->diagonal[p] -= t * off;
    m->diagonal[q] += t * off;
    m->off[r] = 0;
    m->off[q] = c * by_p - s * by_q;
    m->off[p] = s * by_p + c * by_q;
    for (int k = 0; k < 3; k++) {
        float a = m->axes[p][k], b = m->axes[q][k];
        m->axes[p][k] = c * a - s * b;
        m->axes[q][k] = s * a + c * b;
    }
}

/* C, its eigenvalues on the diagonal. */
static struct turned solve(const float c[6])
{
    struct turned m = {{c[0], c[1], c[2]}, {c[5], c[4], c[3]}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        rotate(&m, 0, 1, 2);
        rotate(&m, 0, 2, 1);
        rotate(&m, 1, 2, 0);
    }
    return m;
}

static void shape_one(const struct anisotropy_rule *rule, struct anisotropy_batch *batch, int i)
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    float weight = batch->sum[0][i], mean[3], c[6];
    for (int k = 0; k < 3; k++) {
        mean[k] = batch->sum[1 + k][i] / weight;
    }
    for (int k = 0; k < 6; k++) {
        c[k] = (batch->sum[4 + k][i] / weight - mean[rows[k]] * mean[columns[k]]) / ANISOTROPY_FULL;
    }
    struct turned m = solve(c);
    float least = fmaxf(fmaxf(m.diagonal[0], m.diagonal[1]), m.diagonal[2]) / rule->ratio, axis[3];
    float crowd = fminf(fmaxf((weight - rule->lonely) * rule->per_crowd, 0), 1);
    for (int k = 0; k < 3; k++) {
        axis[k] = fmaxf(fmaxf(m.diagonal[k], least), ANISOTROPY_LEAST);
    }
    float scale = crowd / cbrtf(axis[0] * axis[1] * axis[2]);
    for (int k = 0; k < 6; k++) {
        float sum = k < 3 ? rule->isolated * (1 - crowd) : 0;
        for (int a = 0; a < 3; a++) {
            sum += scale * axis[a] * m.axes[a][rows[k]] * m.axes[a][columns[k]];
        }
        batch->shape[k][i] = sum;
    }
    for (int k = 0; k < 3; k++) {
        batch->shift[k][i] = rule->smoothing * crowd * mean[k];
    }
}

static void shape(const struct anisotropy_rule *rule, struct anisotropy_batch *batch, int count)
{
    for (int i = 0; i < count; i++) {
        shape_one(rule, batch, i);
    }
}

const struct anisotropy_kernels mns_anisotropy_kernels_scalar = {.add = add, .shape = shape};

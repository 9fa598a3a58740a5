/* anisotropy.c: sums over neighbours and shapes of particles over simd.h. Formulas and contracts: cpu/anisotropy.h; their definition:
 * cpu/scalar/anisotropy.c. */
#include "cpu/anisotropy.h"

#include "cpu/simd.h"

/* Lanes are neighbours. One lane's d^2 may be 0, whose root is 0 and not 0 / 0: LEAST stays a normal number when it is squared. */
static void add(const struct anisotropy_block *block, struct anisotropy_batch *batch, int first, int end)
{
    const vf one = vf_set1(1), least = vf_set1(1e-18f);
    for (int i = first; i < end; i++) {
        const vf px = vf_set1(batch->x[i]), py = vf_set1(batch->y[i]), pz = vf_set1(batch->z[i]);
        vf w0 = vf_zero(), x1 = w0, y1 = w0, z1 = w0, xx = w0, yy = w0, zz = w0, xy = w0, xz = w0, yz = w0;
        for (int j = 0; j < block->count; j += VLEN) {
            vf x = vf_load(block->x + j) - px, y = vf_load(block->y + j) - py, z = vf_load(block->z + j) - pz;
            vf d2 = vf_max(vf_fma(x, x, vf_fma(y, y, z * z)), least);
            vf w = vf_max(vf_fnma(d2 * d2, vf_rsqrt_quick(d2), one), vf_zero());
            vf wx = w * x, wy = w * y, wz = w * z;
            w0 += w;
            x1 += wx;
            y1 += wy;
            z1 += wz;
            xx = vf_fma(wx, x, xx);
            yy = vf_fma(wy, y, yy);
            zz = vf_fma(wz, z, zz);
            xy = vf_fma(wx, y, xy);
            xz = vf_fma(wx, z, xz);
            yz = vf_fma(wy, z, yz);
        }
        const vf sums[ANISOTROPY_SUMS] = {w0, x1, y1, z1, xx, yy, zz, xy, xz, yz};
        for (int k = 0; k < ANISOTROPY_SUMS; k++) {
            batch->sum[k][i] += vf_reduce_add(sums[k]);
        }
    }
}

/* As in plain C; lanes are particles. */
struct turned {
    vf diagonal[3], off[3], axes[3][3];
};

SIMD void rotate(struct turned *m, int p, int q, int r)
{
    vf off = m->off[r], apart = m->diagonal[q] - m->diagonal[p], twice = off + off;
    vf square_sum = vf_max(vf_fma(apart, apart, twice * twice), vf_set1(1e-30f)); /* the root of 0 without 0 / 0 */
    vf across = vf_fma(square_sum, vf_rsqrt(square_sum), vf_abs(apart));
    vf t = vf_select(vf_lt(apart, vf_zero()), -twice, twice) * vf_rcp(across);
    vf square = vf_fma(t, t, vf_set1(1)), c = vf_rsqrt(square), s = t * c, by_p = m->off[q], by_q = m->off[p];
    m->diagonal[p] = vf_fnma(t, off, m->diagonal[p]);
    m->diagonal[q] = vf_fma(t, off, m->diagonal[q]);
    m->off[r] = vf_zero();
    m->off[q] = vf_fnma(s, by_q, c * by_p);
    m->off[p] = vf_fma(s, by_p, c * by_q);
    for (int k = 0; k < 3; k++) {
        vf a = m->axes[p][k], b = m->axes[q][k];
        m->axes[p][k] = vf_fnma(s, b, c * a);
        m->axes[q][k] = vf_fma(s, a, c * b);
    }
}

SIMD struct turned solve(const vf c[6])
{
    vf zero = vf_zero(), one = vf_set1(1);
    struct turned m = {{c[0], c[1], c[2]}, {c[5], c[4], c[3]}, {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        rotate(&m, 0, 1, 2);
        rotate(&m, 0, 2, 1);
        rotate(&m, 1, 2, 0);
    }
    return m;
}

SIMD void shape_at(const struct anisotropy_rule *rule, struct anisotropy_batch *batch, int i)
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    vf weight = vf_load(&batch->sum[0][i]), per = vf_set1(1) / weight, mean[3], c[6], axis[3];
    for (int k = 0; k < 3; k++) {
        mean[k] = vf_load(&batch->sum[1 + k][i]) * per;
    }
    for (int k = 0; k < 6; k++) {
        c[k] = vf_fnma(mean[rows[k]], mean[columns[k]], vf_load(&batch->sum[4 + k][i]) * per) * vf_set1(1 / ANISOTROPY_FULL);
    }
    struct turned m = solve(c);
    vf least = vf_max(vf_max(m.diagonal[0], m.diagonal[1]), m.diagonal[2]) * vf_set1(1 / rule->ratio);
    vf crowd = vf_clamp((weight - vf_set1(rule->lonely)) * vf_set1(rule->per_crowd), vf_zero(), vf_set1(1));
    for (int k = 0; k < 3; k++) {
        axis[k] = vf_max(vf_max(m.diagonal[k], least), vf_set1(ANISOTROPY_LEAST));
    }
    vf scale = crowd * vf_exp(vf_set1(-1.0f / 3.0f) * vf_log(axis[0] * axis[1] * axis[2]));
    vf alone = vf_set1(rule->isolated) * (vf_set1(1) - crowd);
    for (int k = 0; k < 6; k++) {
        vf sum = k < 3 ? alone : vf_zero();
        for (int a = 0; a < 3; a++) {
            sum = vf_fma(scale * axis[a] * m.axes[a][rows[k]], m.axes[a][columns[k]], sum);
        }
        vf_store(&batch->shape[k][i], sum);
    }
    for (int k = 0; k < 3; k++) {
        vf_store(&batch->shift[k][i], vf_set1(rule->smoothing) * crowd * mean[k]);
    }
}

static void shape(const struct anisotropy_rule *rule, struct anisotropy_batch *batch, int count)
{
    for (int i = 0; i < count; i += VLEN) {
        shape_at(rule, batch, i);
    }
}

const struct anisotropy_kernels SIMD_NAME(mns_anisotropy_kernels) = {.add = add, .shape = shape};

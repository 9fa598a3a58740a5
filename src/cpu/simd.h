/* simd.h: the thin layer that the vector kernels in src/cpu/simd are written over.
 *
 * Included only by files that CMake compiles once per instruction set, with MNS_SIMD_<ISA> defined and the compiler told to use it.
 * vf: VLEN floats; vi: VLEN int32; vm: VLEN booleans. + - * / and unary - are the compiler's own on vf, + - * & | on vi.
 * Everything is static inline, so that no copy made for a newer processor is ever linked into baseline code.
 *
 * Accuracy: vf_rcp and vf_rsqrt are within 3e-7 relative of the exact value for normal arguments, vf_exp within 2e-6; vf_fma may round once
 * or twice. That is why instruction sets differ in the last digits. vf_min and vf_max give b when a is NaN. */
#ifndef MNS_CPU_SIMD_H
#define MNS_CPU_SIMD_H

#include <stdint.h>

#if defined(MNS_SIMD_AVX512) || defined(MNS_SIMD_AVX2) || defined(MNS_SIMD_SSE2)
#include <immintrin.h>
#elif defined(MNS_SIMD_NEON)
#include <arm_neon.h>
#else
#error "simd.h needs MNS_SIMD_AVX512, MNS_SIMD_AVX2, MNS_SIMD_SSE2 or MNS_SIMD_NEON"
#endif

#define SIMD static inline __attribute__((always_inline, unused))

#if defined(MNS_SIMD_AVX512)

#define VLEN            16
#define SIMD_NAME(base) base##_avx512
typedef __m512 vf;
typedef __m512i vi;
typedef __mmask16 vm;

SIMD vf vf_set1(float a) { return _mm512_set1_ps(a); }
SIMD vf vf_iota(void) { return _mm512_setr_ps(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
SIMD vf vf_load(const float *p) { return _mm512_load_ps(p); }
SIMD vf vf_loadu(const float *p) { return _mm512_loadu_ps(p); }
SIMD void vf_store(float *p, vf a) { _mm512_store_ps(p, a); }
SIMD void vf_storeu(float *p, vf a) { _mm512_storeu_ps(p, a); }
SIMD void vf_stream(float *p, vf a) { _mm512_stream_ps(p, a); }
SIMD vf vf_fma(vf a, vf b, vf c) { return _mm512_fmadd_ps(a, b, c); }
SIMD vf vf_fnma(vf a, vf b, vf c) { return _mm512_fnmadd_ps(a, b, c); }
SIMD vf vf_min(vf a, vf b) { return _mm512_min_ps(a, b); }
SIMD vf vf_max(vf a, vf b) { return _mm512_max_ps(a, b); }
SIMD vf vf_abs(vf a) { return _mm512_abs_ps(a); }
SIMD vf vf_sqrt(vf a) { return _mm512_sqrt_ps(a); }
SIMD vf vf_floor(vf a) { return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
SIMD vf vf_ceil(vf a) { return _mm512_roundscale_ps(a, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC); }
SIMD vf vf_round(vf a) { return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
SIMD vf vf_rcp_estimate(vf a) { return _mm512_rcp14_ps(a); }
SIMD vf vf_rsqrt_estimate(vf a) { return _mm512_rsqrt14_ps(a); }
SIMD vf vf_select(vm m, vf a, vf b) { return _mm512_mask_mov_ps(b, m, a); }
SIMD vf vf_keep(vm m, vf a) { return _mm512_maskz_mov_ps(m, a); }
SIMD vf vf_mask_add(vf acc, vm m, vf a) { return _mm512_mask_add_ps(acc, m, acc, a); }
SIMD vf vf_mask_fma(vf acc, vm m, vf a, vf b) { return _mm512_mask3_fmadd_ps(a, b, acc, m); }
SIMD vf vf_mask_min(vf acc, vm m, vf a) { return _mm512_mask_min_ps(acc, m, acc, a); }
SIMD vf vf_mask_max(vf acc, vm m, vf a) { return _mm512_mask_max_ps(acc, m, acc, a); }
SIMD vm vf_lt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
SIMD vm vf_le(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
SIMD vm vf_gt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ); }
SIMD vm vf_ge(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ); }
SIMD vm vm_and(vm a, vm b) { return _kand_mask16(a, b); }
SIMD vm vm_or(vm a, vm b) { return _kor_mask16(a, b); }
SIMD vm vm_not(vm a) { return _knot_mask16(a); }
SIMD unsigned vm_bits(vm a) { return (unsigned)a; }
SIMD vm vm_first(int n) { return (vm)(n >= 16 ? 0xffffu : n <= 0 ? 0u : (1u << n) - 1u); }
SIMD float vf_reduce_min(vf a) { return _mm512_reduce_min_ps(a); }
SIMD float vf_reduce_max(vf a) { return _mm512_reduce_max_ps(a); }
SIMD float vf_reduce_add(vf a) { return _mm512_reduce_add_ps(a); }
SIMD vi vi_set1(int a) { return _mm512_set1_epi32(a); }
SIMD vi vi_load(const int32_t *p) { return _mm512_load_si512(p); }
SIMD vi vi_loadu(const int32_t *p) { return _mm512_loadu_si512(p); }
SIMD void vi_store(int32_t *p, vi a) { _mm512_store_si512(p, a); }
SIMD void vi_storeu(int32_t *p, vi a) { _mm512_storeu_si512(p, a); }
SIMD vi vi_add(vi a, vi b) { return _mm512_add_epi32(a, b); }
SIMD vi vi_sub(vi a, vi b) { return _mm512_sub_epi32(a, b); }
SIMD vi vi_mul(vi a, vi b) { return _mm512_mullo_epi32(a, b); }
SIMD vi vi_min(vi a, vi b) { return _mm512_min_epi32(a, b); }
SIMD vi vi_max(vi a, vi b) { return _mm512_max_epi32(a, b); }
SIMD vi vi_and(vi a, vi b) { return _mm512_and_si512(a, b); }
SIMD vi vi_or(vi a, vi b) { return _mm512_or_si512(a, b); }
SIMD vi vi_shl(vi a, int n) { return _mm512_slli_epi32(a, (unsigned)n); }
SIMD vi vi_shr(vi a, int n) { return _mm512_srli_epi32(a, (unsigned)n); }
SIMD vi vf_truncate(vf a) { return _mm512_cvttps_epi32(a); }
SIMD vi vf_nearest(vf a) { return _mm512_cvtps_epi32(a); }
SIMD vf vi_float(vi a) { return _mm512_cvtepi32_ps(a); }
SIMD vi vf_bits(vf a) { return _mm512_castps_si512(a); }
SIMD vf vi_as_float(vi a) { return _mm512_castsi512_ps(a); }
SIMD float vf_first(vf a) { return _mm512_cvtss_f32(a); } /* lane 0 */
SIMD vf vf_gather(const float *base, vi index) { return _mm512_i32gather_ps(index, base, 4); }
SIMD vf vf_permute(vf a, vi index) { return _mm512_permutexvar_ps(index, a); } /* lane index[i] of a, index within [0, VLEN) */
SIMD vf vf_scale2(vf a, vf n) { return _mm512_scalef_ps(a, n); }               /* a * 2^n, n whole */
SIMD void vf_lanes_apart(vf p[4]) /* pixels 0-3, 4-7, ... in four vectors -> 0 4 8 12, 1 5 9 13, ... */
{
    vf a = _mm512_shuffle_f32x4(p[0], p[1], 0x88), b = _mm512_shuffle_f32x4(p[0], p[1], 0xdd);
    vf c = _mm512_shuffle_f32x4(p[2], p[3], 0x88), d = _mm512_shuffle_f32x4(p[2], p[3], 0xdd);
    p[0] = _mm512_shuffle_f32x4(a, c, 0x88);
    p[1] = _mm512_shuffle_f32x4(b, d, 0x88);
    p[2] = _mm512_shuffle_f32x4(a, c, 0xdd);
    p[3] = _mm512_shuffle_f32x4(b, d, 0xdd);
}
SIMD void vf_lanes_together(vf p[4]) { vf_lanes_apart(p); } /* its own inverse */
/* The last lane of a, then all of b but its last. */
SIMD vf vf_slide(vf a, vf b) { return _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(b), _mm512_castps_si512(a), 15)); }
SIMD void vf_zip(vf p[2]) /* a0 a1 ..., b0 b1 ... -> a0 b0 a1 b1 ... */
{
    __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
    vf a = p[0], b = p[1];
    p[0] = _mm512_permutex2var_ps(a, low, b);
    p[1] = _mm512_permutex2var_ps(a, high, b);
}
SIMD void vf_unzip(vf p[2]) /* and back */
{
    __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    __m512i odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
    vf a = p[0], b = p[1];
    p[0] = _mm512_permutex2var_ps(a, even, b);
    p[1] = _mm512_permutex2var_ps(a, odd, b);
}
SIMD void vf_transpose_4(vf p[4])
{
    __m512d a = _mm512_castps_pd(_mm512_unpacklo_ps(p[0], p[1])), b = _mm512_castps_pd(_mm512_unpackhi_ps(p[0], p[1]));
    __m512d c = _mm512_castps_pd(_mm512_unpacklo_ps(p[2], p[3])), d = _mm512_castps_pd(_mm512_unpackhi_ps(p[2], p[3]));
    p[0] = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
    p[1] = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
    p[2] = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
    p[3] = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
}
SIMD void vi_store_u8(uint8_t *p, vi a) { _mm_storeu_si128((__m128i *)(void *)p, _mm512_cvtepi32_epi8(a)); }
SIMD void vi_store_u16(uint16_t *p, vi a) { _mm256_storeu_si256((__m256i *)(void *)p, _mm512_cvtepi32_epi16(a)); }

#elif defined(MNS_SIMD_AVX2)

#define VLEN            8
#define SIMD_NAME(base) base##_avx2
typedef __m256 vf;
typedef __m256i vi;
typedef __m256 vm;

SIMD vf vf_set1(float a) { return _mm256_set1_ps(a); }
SIMD vf vf_iota(void) { return _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7); }
SIMD vf vf_load(const float *p) { return _mm256_load_ps(p); }
SIMD vf vf_loadu(const float *p) { return _mm256_loadu_ps(p); }
SIMD void vf_store(float *p, vf a) { _mm256_store_ps(p, a); }
SIMD void vf_storeu(float *p, vf a) { _mm256_storeu_ps(p, a); }
SIMD void vf_stream(float *p, vf a) { _mm256_stream_ps(p, a); }
SIMD vf vf_fma(vf a, vf b, vf c) { return _mm256_fmadd_ps(a, b, c); }
SIMD vf vf_fnma(vf a, vf b, vf c) { return _mm256_fnmadd_ps(a, b, c); }
SIMD vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
SIMD vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
SIMD vf vf_abs(vf a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
SIMD vf vf_sqrt(vf a) { return _mm256_sqrt_ps(a); }
SIMD vf vf_floor(vf a) { return _mm256_floor_ps(a); }
SIMD vf vf_ceil(vf a) { return _mm256_ceil_ps(a); }
SIMD vf vf_round(vf a) { return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
SIMD vf vf_rcp_estimate(vf a) { return _mm256_rcp_ps(a); }
SIMD vf vf_rsqrt_estimate(vf a) { return _mm256_rsqrt_ps(a); }
SIMD vf vf_select(vm m, vf a, vf b) { return _mm256_blendv_ps(b, a, m); }
SIMD vf vf_keep(vm m, vf a) { return _mm256_and_ps(m, a); }
SIMD vf vf_mask_add(vf acc, vm m, vf a) { return _mm256_add_ps(acc, _mm256_and_ps(m, a)); }
SIMD vf vf_mask_fma(vf acc, vm m, vf a, vf b) { return _mm256_fmadd_ps(a, _mm256_and_ps(m, b), acc); }
SIMD vf vf_mask_min(vf acc, vm m, vf a) { return vf_select(m, vf_min(acc, a), acc); }
SIMD vf vf_mask_max(vf acc, vm m, vf a) { return vf_select(m, vf_max(acc, a), acc); }
SIMD vm vf_lt(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
SIMD vm vf_le(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
SIMD vm vf_gt(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
SIMD vm vf_ge(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_GE_OQ); }
SIMD vm vm_and(vm a, vm b) { return _mm256_and_ps(a, b); }
SIMD vm vm_or(vm a, vm b) { return _mm256_or_ps(a, b); }
SIMD vm vm_not(vm a) { return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1))); }
SIMD unsigned vm_bits(vm a) { return (unsigned)_mm256_movemask_ps(a); }
SIMD vm vm_first(int n) { return vf_lt(vf_iota(), vf_set1((float)n)); }
SIMD float vf_reduce_min(vf a)
{
    __m128 b = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_min_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_min_ss(b, _mm_shuffle_ps(b, b, 1)));
}
SIMD float vf_reduce_max(vf a)
{
    __m128 b = _mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_max_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_max_ss(b, _mm_shuffle_ps(b, b, 1)));
}
SIMD float vf_reduce_add(vf a)
{
    __m128 b = _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_add_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_add_ss(b, _mm_shuffle_ps(b, b, 1)));
}
SIMD vi vi_set1(int a) { return _mm256_set1_epi32(a); }
SIMD vi vi_load(const int32_t *p) { return _mm256_load_si256((const __m256i *)(const void *)p); }
SIMD vi vi_loadu(const int32_t *p) { return _mm256_loadu_si256((const __m256i *)(const void *)p); }
SIMD void vi_store(int32_t *p, vi a) { _mm256_store_si256((__m256i *)(void *)p, a); }
SIMD void vi_storeu(int32_t *p, vi a) { _mm256_storeu_si256((__m256i *)(void *)p, a); }
SIMD vi vi_add(vi a, vi b) { return _mm256_add_epi32(a, b); }
SIMD vi vi_sub(vi a, vi b) { return _mm256_sub_epi32(a, b); }
SIMD vi vi_mul(vi a, vi b) { return _mm256_mullo_epi32(a, b); }
SIMD vi vi_min(vi a, vi b) { return _mm256_min_epi32(a, b); }
SIMD vi vi_max(vi a, vi b) { return _mm256_max_epi32(a, b); }
SIMD vi vi_and(vi a, vi b) { return _mm256_and_si256(a, b); }
SIMD vi vi_or(vi a, vi b) { return _mm256_or_si256(a, b); }
SIMD vi vi_shl(vi a, int n) { return _mm256_slli_epi32(a, n); }
SIMD vi vi_shr(vi a, int n) { return _mm256_srli_epi32(a, n); }
SIMD vi vf_truncate(vf a) { return _mm256_cvttps_epi32(a); }
SIMD vi vf_nearest(vf a) { return _mm256_cvtps_epi32(a); }
SIMD vf vi_float(vi a) { return _mm256_cvtepi32_ps(a); }
SIMD vi vf_bits(vf a) { return _mm256_castps_si256(a); }
SIMD vf vi_as_float(vi a) { return _mm256_castsi256_ps(a); }
SIMD float vf_first(vf a) { return _mm256_cvtss_f32(a); }
SIMD vf vf_gather(const float *base, vi index) { return _mm256_i32gather_ps(base, index, 4); }
SIMD vf vf_permute(vf a, vi index) { return _mm256_permutevar8x32_ps(a, index); }
SIMD vf vf_scale2(vf a, vf n) { return _mm256_mul_ps(a, vi_as_float(vi_shl(vi_add(vf_nearest(n), vi_set1(127)), 23))); }

SIMD void vf_lanes_apart(vf p[4]) /* pixels 0 1, 2 3, 4 5, 6 7 in four vectors -> 0 4, 1 5, 2 6, 3 7 */
{
    vf a = p[0], b = p[1], c = p[2], d = p[3];
    p[0] = _mm256_permute2f128_ps(a, c, 0x20);
    p[1] = _mm256_permute2f128_ps(a, c, 0x31);
    p[2] = _mm256_permute2f128_ps(b, d, 0x20);
    p[3] = _mm256_permute2f128_ps(b, d, 0x31);
}
SIMD void vf_lanes_together(vf p[4]) /* and back */
{
    vf a = p[0], b = p[1], c = p[2], d = p[3];
    p[0] = _mm256_permute2f128_ps(a, b, 0x20);
    p[1] = _mm256_permute2f128_ps(c, d, 0x20);
    p[2] = _mm256_permute2f128_ps(a, b, 0x31);
    p[3] = _mm256_permute2f128_ps(c, d, 0x31);
}
SIMD vf vf_slide(vf a, vf b)
{
    __m256i between = _mm256_castps_si256(_mm256_permute2f128_ps(a, b, 0x21)); /* upper half of a, lower of b */
    return _mm256_castsi256_ps(_mm256_alignr_epi8(_mm256_castps_si256(b), between, 12));
}
SIMD void vf_zip(vf p[2])
{
    vf a = _mm256_unpacklo_ps(p[0], p[1]), b = _mm256_unpackhi_ps(p[0], p[1]);
    p[0] = _mm256_permute2f128_ps(a, b, 0x20);
    p[1] = _mm256_permute2f128_ps(a, b, 0x31);
}
SIMD void vf_unzip(vf p[2])
{
    vf a = _mm256_permute2f128_ps(p[0], p[1], 0x20), b = _mm256_permute2f128_ps(p[0], p[1], 0x31);
    p[0] = _mm256_shuffle_ps(a, b, 0x88);
    p[1] = _mm256_shuffle_ps(a, b, 0xdd);
}
SIMD void vf_transpose_4(vf p[4])
{
    __m256d a = _mm256_castps_pd(_mm256_unpacklo_ps(p[0], p[1])), b = _mm256_castps_pd(_mm256_unpackhi_ps(p[0], p[1]));
    __m256d c = _mm256_castps_pd(_mm256_unpacklo_ps(p[2], p[3])), d = _mm256_castps_pd(_mm256_unpackhi_ps(p[2], p[3]));
    p[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(a, c));
    p[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(a, c));
    p[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(b, d));
    p[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(b, d));
}
SIMD void vi_store_u16(uint16_t *p, vi a)
{
    _mm_storeu_si128((__m128i *)(void *)p, _mm_packus_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1)));
}
SIMD void vi_store_u8(uint8_t *p, vi a)
{
    __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
    _mm_storel_epi64((__m128i *)(void *)p, _mm_packus_epi16(words, words));
}

#elif defined(MNS_SIMD_SSE2)

#define VLEN            4
#define SIMD_NAME(base) base##_sse2
typedef __m128 vf;
typedef __m128i vi;
typedef __m128 vm;

SIMD vf vf_set1(float a) { return _mm_set1_ps(a); }
SIMD vf vf_iota(void) { return _mm_setr_ps(0, 1, 2, 3); }
SIMD vf vf_load(const float *p) { return _mm_load_ps(p); }
SIMD vf vf_loadu(const float *p) { return _mm_loadu_ps(p); }
SIMD void vf_store(float *p, vf a) { _mm_store_ps(p, a); }
SIMD void vf_storeu(float *p, vf a) { _mm_storeu_ps(p, a); }
SIMD void vf_stream(float *p, vf a) { _mm_stream_ps(p, a); }
SIMD vf vf_fma(vf a, vf b, vf c) { return _mm_add_ps(_mm_mul_ps(a, b), c); }
SIMD vf vf_fnma(vf a, vf b, vf c) { return _mm_sub_ps(c, _mm_mul_ps(a, b)); }
SIMD vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
SIMD vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }
SIMD vf vf_abs(vf a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
SIMD vf vf_sqrt(vf a) { return _mm_sqrt_ps(a); }
SIMD vf vf_select(vm m, vf a, vf b) { return _mm_or_ps(_mm_and_ps(m, a), _mm_andnot_ps(m, b)); }
SIMD vf vf_keep(vm m, vf a) { return _mm_and_ps(m, a); }
SIMD vf vf_mask_add(vf acc, vm m, vf a) { return _mm_add_ps(acc, _mm_and_ps(m, a)); }
SIMD vf vf_mask_fma(vf acc, vm m, vf a, vf b) { return _mm_add_ps(acc, _mm_mul_ps(a, _mm_and_ps(m, b))); }
SIMD vf vf_mask_min(vf acc, vm m, vf a) { return vf_select(m, vf_min(acc, a), acc); }
SIMD vf vf_mask_max(vf acc, vm m, vf a) { return vf_select(m, vf_max(acc, a), acc); }
SIMD vm vf_lt(vf a, vf b) { return _mm_cmplt_ps(a, b); }
SIMD vm vf_le(vf a, vf b) { return _mm_cmple_ps(a, b); }
SIMD vm vf_gt(vf a, vf b) { return _mm_cmpgt_ps(a, b); }
SIMD vm vf_ge(vf a, vf b) { return _mm_cmpge_ps(a, b); }
SIMD vm vm_and(vm a, vm b) { return _mm_and_ps(a, b); }
SIMD vm vm_or(vm a, vm b) { return _mm_or_ps(a, b); }
SIMD vm vm_not(vm a) { return _mm_xor_ps(a, _mm_castsi128_ps(_mm_set1_epi32(-1))); }
SIMD unsigned vm_bits(vm a) { return (unsigned)_mm_movemask_ps(a); }
SIMD vm vm_first(int n) { return vf_lt(vf_iota(), vf_set1((float)n)); }
SIMD float vf_reduce_min(vf a)
{
    a = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps(a, a, 1)));
}
SIMD float vf_reduce_max(vf a)
{
    a = _mm_max_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_max_ss(a, _mm_shuffle_ps(a, a, 1)));
}
SIMD float vf_reduce_add(vf a)
{
    a = _mm_add_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_add_ss(a, _mm_shuffle_ps(a, a, 1)));
}
SIMD vi vi_set1(int a) { return _mm_set1_epi32(a); }
SIMD vi vi_load(const int32_t *p) { return _mm_load_si128((const __m128i *)(const void *)p); }
SIMD vi vi_loadu(const int32_t *p) { return _mm_loadu_si128((const __m128i *)(const void *)p); }
SIMD void vi_store(int32_t *p, vi a) { _mm_store_si128((__m128i *)(void *)p, a); }
SIMD void vi_storeu(int32_t *p, vi a) { _mm_storeu_si128((__m128i *)(void *)p, a); }
SIMD vi vi_add(vi a, vi b) { return _mm_add_epi32(a, b); }
SIMD vi vi_sub(vi a, vi b) { return _mm_sub_epi32(a, b); }
SIMD vi vi_mul(vi a, vi b)
{
    __m128i even = _mm_mul_epu32(a, b), odd = _mm_mul_epu32(_mm_srli_epi64(a, 32), _mm_srli_epi64(b, 32));
    return _mm_unpacklo_epi32(_mm_shuffle_epi32(even, 0x08), _mm_shuffle_epi32(odd, 0x08));
}
SIMD vi vi_and(vi a, vi b) { return _mm_and_si128(a, b); }
SIMD vi vi_or(vi a, vi b) { return _mm_or_si128(a, b); }
SIMD vi vi_min(vi a, vi b)
{
    __m128i m = _mm_cmplt_epi32(a, b);
    return _mm_or_si128(_mm_and_si128(m, a), _mm_andnot_si128(m, b));
}
SIMD vi vi_max(vi a, vi b)
{
    __m128i m = _mm_cmpgt_epi32(a, b);
    return _mm_or_si128(_mm_and_si128(m, a), _mm_andnot_si128(m, b));
}
SIMD vi vi_shl(vi a, int n) { return _mm_slli_epi32(a, n); }
SIMD vi vi_shr(vi a, int n) { return _mm_srli_epi32(a, n); }
SIMD vi vf_truncate(vf a) { return _mm_cvttps_epi32(a); }
SIMD vi vf_nearest(vf a) { return _mm_cvtps_epi32(a); }
SIMD vf vi_float(vi a) { return _mm_cvtepi32_ps(a); }
SIMD vi vf_bits(vf a) { return _mm_castps_si128(a); }
SIMD vf vi_as_float(vi a) { return _mm_castsi128_ps(a); }
SIMD float vf_first(vf a) { return _mm_cvtss_f32(a); }
SIMD vf vf_round(vf a) /* whole already from 2^23 on */
{
    return vf_select(vf_lt(vf_abs(a), vf_set1(8388608.0f)), vi_float(vf_nearest(a)), a);
}
SIMD vf vf_floor(vf a)
{
    vf r = vf_round(a);
    return _mm_sub_ps(r, vf_keep(vf_gt(r, a), vf_set1(1.0f)));
}
SIMD vf vf_ceil(vf a)
{
    vf r = vf_round(a);
    return _mm_add_ps(r, vf_keep(vf_lt(r, a), vf_set1(1.0f)));
}
SIMD vf vf_rcp_estimate(vf a) { return _mm_rcp_ps(a); }
SIMD vf vf_rsqrt_estimate(vf a) { return _mm_rsqrt_ps(a); }
SIMD vf vf_gather(const float *base, vi index)
{
    int32_t i[4] __attribute__((aligned(16)));
    vi_store(i, index);
    return _mm_setr_ps(base[i[0]], base[i[1]], base[i[2]], base[i[3]]);
}
SIMD vf vf_permute(vf a, vi index)
{
    float lanes[4] __attribute__((aligned(16)));
    vf_store(lanes, a);
    return vf_gather(lanes, index);
}
SIMD vf vf_scale2(vf a, vf n) { return _mm_mul_ps(a, vi_as_float(vi_shl(vi_add(vf_nearest(n), vi_set1(127)), 23))); }

SIMD void vf_lanes_apart(vf p[4]) { (void)p; } /* one pixel each already */
SIMD void vf_lanes_together(vf p[4]) { (void)p; }
SIMD vf vf_slide(vf a, vf b)
{
    vf between = _mm_shuffle_ps(a, b, _MM_SHUFFLE(0, 0, 3, 3)); /* last of a, first of b */
    return _mm_shuffle_ps(between, b, _MM_SHUFFLE(2, 1, 2, 0));
}
SIMD void vf_zip(vf p[2])
{
    vf a = p[0];
    p[0] = _mm_unpacklo_ps(a, p[1]);
    p[1] = _mm_unpackhi_ps(a, p[1]);
}
SIMD void vf_unzip(vf p[2])
{
    vf a = p[0];
    p[0] = _mm_shuffle_ps(a, p[1], 0x88);
    p[1] = _mm_shuffle_ps(a, p[1], 0xdd);
}
SIMD void vf_transpose_4(vf p[4]) { _MM_TRANSPOSE4_PS(p[0], p[1], p[2], p[3]); }
SIMD void vi_store_u16(uint16_t *p, vi a) /* there is no unsigned pack: signed, about 2^15 */
{
    __m128i words = _mm_packs_epi32(_mm_sub_epi32(a, _mm_set1_epi32(32768)), _mm_setzero_si128());
    _mm_storel_epi64((__m128i *)(void *)p, _mm_xor_si128(words, _mm_set1_epi16(-32768)));
}
SIMD void vi_store_u8(uint8_t *p, vi a)
{
    __m128i words = _mm_packs_epi32(a, a);
    int32_t bytes = _mm_cvtsi128_si32(_mm_packus_epi16(words, words));
    __builtin_memcpy(p, &bytes, sizeof(bytes));
}

#elif defined(MNS_SIMD_NEON)

#define VLEN            4
#define SIMD_NAME(base) base##_neon
typedef float32x4_t vf;
typedef int32x4_t vi;
typedef uint32x4_t vm;

SIMD vf vf_set1(float a) { return vdupq_n_f32(a); }
SIMD vf vf_iota(void) { return (vf){0, 1, 2, 3}; }
SIMD vf vf_load(const float *p) { return vld1q_f32(p); }
SIMD vf vf_loadu(const float *p) { return vld1q_f32(p); }
SIMD void vf_store(float *p, vf a) { vst1q_f32(p, a); }
SIMD void vf_storeu(float *p, vf a) { vst1q_f32(p, a); }
SIMD void vf_stream(float *p, vf a) { vst1q_f32(p, a); }
SIMD vf vf_fma(vf a, vf b, vf c) { return vfmaq_f32(c, a, b); }
SIMD vf vf_fnma(vf a, vf b, vf c) { return vfmsq_f32(c, a, b); }
SIMD vf vf_select(vm m, vf a, vf b) { return vbslq_f32(m, a, b); }
SIMD vm vf_lt(vf a, vf b) { return vcltq_f32(a, b); }
SIMD vm vf_le(vf a, vf b) { return vcleq_f32(a, b); }
SIMD vm vf_gt(vf a, vf b) { return vcgtq_f32(a, b); }
SIMD vm vf_ge(vf a, vf b) { return vcgeq_f32(a, b); }
SIMD vf vf_min(vf a, vf b) { return vf_select(vf_lt(a, b), a, b); }
SIMD vf vf_max(vf a, vf b) { return vf_select(vf_gt(a, b), a, b); }
SIMD vf vf_abs(vf a) { return vabsq_f32(a); }
SIMD vf vf_sqrt(vf a) { return vsqrtq_f32(a); }
SIMD vf vf_floor(vf a) { return vrndmq_f32(a); }
SIMD vf vf_ceil(vf a) { return vrndpq_f32(a); }
SIMD vf vf_round(vf a) { return vrndnq_f32(a); }
SIMD vf vf_rcp_estimate(vf a)
{
    vf r = vrecpeq_f32(a);
    return r * vrecpsq_f32(a, r);
}
SIMD vf vf_rsqrt_estimate(vf a)
{
    vf r = vrsqrteq_f32(a);
    return r * vrsqrtsq_f32(a * r, r);
}
SIMD vf vf_keep(vm m, vf a) { return vreinterpretq_f32_u32(vandq_u32(m, vreinterpretq_u32_f32(a))); }
SIMD vf vf_mask_add(vf acc, vm m, vf a) { return acc + vf_keep(m, a); }
SIMD vf vf_mask_fma(vf acc, vm m, vf a, vf b) { return vf_fma(a, vf_keep(m, b), acc); }
SIMD vf vf_mask_min(vf acc, vm m, vf a) { return vf_select(m, vf_min(acc, a), acc); }
SIMD vf vf_mask_max(vf acc, vm m, vf a) { return vf_select(m, vf_max(acc, a), acc); }
SIMD vm vm_and(vm a, vm b) { return vandq_u32(a, b); }
SIMD vm vm_or(vm a, vm b) { return vorrq_u32(a, b); }
SIMD vm vm_not(vm a) { return vmvnq_u32(a); }
SIMD unsigned vm_bits(vm a) { return vaddvq_u32(vandq_u32(a, (uint32x4_t){1, 2, 4, 8})); }
SIMD vm vm_first(int n) { return vf_lt(vf_iota(), vf_set1((float)n)); }
SIMD float vf_reduce_min(vf a) { return vminvq_f32(a); }
SIMD float vf_reduce_max(vf a) { return vmaxvq_f32(a); }
SIMD float vf_reduce_add(vf a) { return vaddvq_f32(a); }
SIMD vi vi_set1(int a) { return vdupq_n_s32(a); }
SIMD vi vi_load(const int32_t *p) { return vld1q_s32(p); }
SIMD vi vi_loadu(const int32_t *p) { return vld1q_s32(p); }
SIMD void vi_store(int32_t *p, vi a) { vst1q_s32(p, a); }
SIMD void vi_storeu(int32_t *p, vi a) { vst1q_s32(p, a); }
SIMD vi vi_add(vi a, vi b) { return vaddq_s32(a, b); }
SIMD vi vi_sub(vi a, vi b) { return vsubq_s32(a, b); }
SIMD vi vi_mul(vi a, vi b) { return vmulq_s32(a, b); }
SIMD vi vi_min(vi a, vi b) { return vminq_s32(a, b); }
SIMD vi vi_max(vi a, vi b) { return vmaxq_s32(a, b); }
SIMD vi vi_and(vi a, vi b) { return vandq_s32(a, b); }
SIMD vi vi_or(vi a, vi b) { return vorrq_s32(a, b); }
SIMD vi vi_shl(vi a, int n) { return vshlq_s32(a, vdupq_n_s32(n)); }
SIMD vi vi_shr(vi a, int n) { return vreinterpretq_s32_u32(vshlq_u32(vreinterpretq_u32_s32(a), vdupq_n_s32(-n))); }
SIMD vi vf_truncate(vf a) { return vcvtq_s32_f32(a); }
SIMD vi vf_nearest(vf a) { return vcvtnq_s32_f32(a); }
SIMD vf vi_float(vi a) { return vcvtq_f32_s32(a); }
SIMD vi vf_bits(vf a) { return vreinterpretq_s32_f32(a); }
SIMD vf vi_as_float(vi a) { return vreinterpretq_f32_s32(a); }
SIMD float vf_first(vf a) { return vgetq_lane_f32(a, 0); }
SIMD vf vf_gather(const float *base, vi index)
{
    int32_t i[4];
    vi_store(i, index);
    return (vf){base[i[0]], base[i[1]], base[i[2]], base[i[3]]};
}
SIMD vf vf_permute(vf a, vi index)
{
    float lanes[4];
    vf_store(lanes, a);
    return vf_gather(lanes, index);
}
SIMD vf vf_scale2(vf a, vf n) { return a * vi_as_float(vi_shl(vi_add(vf_nearest(n), vi_set1(127)), 23)); }

SIMD void vf_lanes_apart(vf p[4]) { (void)p; } /* one pixel each already */
SIMD void vf_lanes_together(vf p[4]) { (void)p; }
SIMD vf vf_slide(vf a, vf b) { return vextq_f32(a, b, 3); }
SIMD void vf_zip(vf p[2])
{
    float32x4x2_t both = vzipq_f32(p[0], p[1]);
    p[0] = both.val[0];
    p[1] = both.val[1];
}
SIMD void vf_unzip(vf p[2])
{
    float32x4x2_t both = vuzpq_f32(p[0], p[1]);
    p[0] = both.val[0];
    p[1] = both.val[1];
}
SIMD void vf_transpose_4(vf p[4])
{
    float32x4x2_t a = vtrnq_f32(p[0], p[1]), b = vtrnq_f32(p[2], p[3]);
    p[0] = vcombine_f32(vget_low_f32(a.val[0]), vget_low_f32(b.val[0]));
    p[1] = vcombine_f32(vget_low_f32(a.val[1]), vget_low_f32(b.val[1]));
    p[2] = vcombine_f32(vget_high_f32(a.val[0]), vget_high_f32(b.val[0]));
    p[3] = vcombine_f32(vget_high_f32(a.val[1]), vget_high_f32(b.val[1]));
}
SIMD void vi_store_u16(uint16_t *p, vi a) { vst1_u16(p, vmovn_u32(vreinterpretq_u32_s32(a))); }
SIMD void vi_store_u8(uint8_t *p, vi a)
{
    uint16x4_t words = vmovn_u32(vreinterpretq_u32_s32(a));
    uint8x8_t bytes = vmovn_u16(vcombine_u16(words, words));
    vst1_lane_u32((uint32_t *)(void *)p, vreinterpret_u32_u8(bytes), 0);
}

#endif

/* vf_stream stores past the caches what will not be read again soon, whole cache lines of it; vf_stream_end comes after the last. */
SIMD void vf_stream_end(void)
{
#ifndef MNS_SIMD_NEON
    _mm_sfence();
#endif
}

SIMD void simd_prefetch(const void *p) { __builtin_prefetch(p); }

SIMD int vm_any(vm a) { return vm_bits(a) != 0; }
SIMD int vm_all(vm a) { return vm_bits(a) == (1u << VLEN) - 1u; }
SIMD vf vf_either(int first, vf a, vf b) /* for all lanes alike; ?: wants one spelling of the type */
{
    if (first) {
        return a;
    }
    return b;
}
SIMD vi vi_select(vm m, vi a, vi b) { return vf_bits(vf_select(m, vi_as_float(a), vi_as_float(b))); }
SIMD vf vf_zero(void) { return vf_set1(0.0f); }
SIMD vf vf_clamp(vf a, vf low, vf high) { return vf_min(vf_max(a, low), high); }

/* VLEN rows of VLEN pixels become its columns. */
SIMD void vf_transpose(vf p[VLEN])
{
    for (int i = 0; i < VLEN; i += 4) {
        vf_transpose_4(p + i);
    }
#if VLEN == 16
    for (int i = 0; i < 4; i++) {
        vf quad[4] = {p[i], p[4 + i], p[8 + i], p[12 + i]};
        vf_lanes_apart(quad);
        p[i] = quad[0];
        p[4 + i] = quad[1];
        p[8 + i] = quad[2];
        p[12 + i] = quad[3];
    }
#elif VLEN == 8
    for (int i = 0; i < 4; i += 2) {
        vf quad[4] = {p[i], p[i + 1], p[4 + i], p[5 + i]};
        vf_lanes_apart(quad);
        p[i] = quad[0];
        p[4 + i] = quad[1];
        p[i + 1] = quad[2];
        p[5 + i] = quad[3];
    }
#endif
}

/* One Newton step on the processor's estimate. */
SIMD vf vf_rcp(vf a)
{
    vf r = vf_rcp_estimate(a);
    return r * vf_fnma(a, r, vf_set1(2.0f));
}
SIMD vf vf_rsqrt(vf a)
{
    vf r = vf_rsqrt_estimate(a);
    return r * vf_fnma(a * r, r * vf_set1(0.5f), vf_set1(1.5f));
}

/* 1 / sqrt(a) within 7e-5 relative, without a Newton step where the processor's own estimate is that good. */
SIMD vf vf_rsqrt_quick(vf a)
{
#if defined(MNS_SIMD_AVX512) || defined(MNS_SIMD_NEON)
    return vf_rsqrt_estimate(a);
#else
    return vf_rsqrt(a);
#endif
}

/* 1 / a within 7e-5 relative, likewise. */
SIMD vf vf_rcp_quick(vf a)
{
#if defined(MNS_SIMD_AVX512) || defined(MNS_SIMD_NEON)
    return vf_rcp_estimate(a);
#else
    return vf_rcp(a);
#endif
}

/* e^a for a in [-87, 88]; smaller arguments give e^-87, larger ones e^88. 2^f by a polynomial on [-0.5, 0.5]. */
SIMD vf vf_exp(vf a)
{
    a = vf_clamp(a, vf_set1(-87.0f), vf_set1(88.0f)) * vf_set1(1.44269504f);
    vf n = vf_round(a), f = a - n, p = vf_set1(1.3333558e-3f);
    p = vf_fma(p, f, vf_set1(9.6181291e-3f));
    p = vf_fma(p, f, vf_set1(5.55041087e-2f));
    p = vf_fma(p, f, vf_set1(0.2402265069f));
    p = vf_fma(p, f, vf_set1(0.6931471806f));
    p = vf_fma(p, f, vf_set1(1.0f));
    return vf_scale2(p, n);
}

/* e^a - 1 for a in [-87, 88], within 3e-6 of itself near 0 too, where e^a - 1 would lose its digits. */
SIMD vf vf_expm1(vf a)
{
    a = vf_clamp(a, vf_set1(-87.0f), vf_set1(88.0f)) * vf_set1(1.44269504f);
    vf n = vf_round(a), f = a - n, p = vf_set1(1.3333558e-3f);
    p = vf_fma(p, f, vf_set1(9.6181291e-3f));
    p = vf_fma(p, f, vf_set1(5.55041087e-2f));
    p = vf_fma(p, f, vf_set1(0.2402265069f));
    p = vf_fma(p, f, vf_set1(0.6931471806f));
    vf scale = vf_scale2(vf_set1(1.0f), n);
    return vf_fma(scale, p * f, scale - vf_set1(1.0f));
}

/* Natural logarithm of a positive normal number, within 1e-7 absolute or 2e-7 relative: ln(2^e m) with m in [sqrt(1/2), sqrt(2)), by Cephes'
 * polynomial for ln(1 + f). */
SIMD vf vf_log(vf a)
{
    vi bits = vf_bits(a), e = vi_sub(vi_shr(vi_add(bits, vi_set1(0x3f800000 - 0x3f3504f3)), 23), vi_set1(127));
    vf f = vi_as_float(vi_sub(bits, vi_shl(e, 23))) - vf_set1(1.0f), f2 = f * f, p = vf_set1(7.0376836e-2f);
    p = vf_fma(p, f, vf_set1(-0.11514610f));
    p = vf_fma(p, f, vf_set1(0.11676998f));
    p = vf_fma(p, f, vf_set1(-0.12420141f));
    p = vf_fma(p, f, vf_set1(0.14249323f));
    p = vf_fma(p, f, vf_set1(-0.16668057f));
    p = vf_fma(p, f, vf_set1(0.20000715f));
    p = vf_fma(p, f, vf_set1(-0.24999994f));
    p = vf_fma(p, f, vf_set1(0.33333331f));
    p = vf_fma(p * f, f2, vf_fma(f2, vf_set1(-0.5f), f));
    return vf_fma(vi_float(e), vf_set1(0.69314718f), p);
}

/* VLEN pixels of four floats each, and their channels. */
SIMD void vf_load_rgba(const float *p, vf c[4])
{
    for (int i = 0; i < 4; i++) {
        c[i] = vf_loadu(p + i * VLEN);
    }
    vf_lanes_apart(c);
    vf_transpose_4(c);
}
SIMD void vf_store_rgba(float *p, vf r, vf g, vf b, vf a)
{
    vf c[4] = {r, g, b, a};
    vf_transpose_4(c);
    vf_lanes_together(c);
    for (int i = 0; i < 4; i++) {
        vf_storeu(p + i * VLEN, c[i]);
    }
}

/* One pixel of four floats. */
typedef float v4 __attribute__((vector_size(16)));
SIMD v4 v4_loadu(const float *p)
{
    v4 a;
    __builtin_memcpy(&a, p, sizeof(a));
    return a;
}
SIMD void v4_storeu(float *p, v4 a) { __builtin_memcpy(p, &a, sizeof(a)); }

/* Between two texels side by side at top and the two at bottom, fx to the right and fy down. */
SIMD v4 v4_bilinear(const float *top, const float *bottom, float fx, float fy)
{
#if defined(MNS_SIMD_AVX512) || defined(MNS_SIMD_AVX2)
    __m256 a = _mm256_loadu_ps(top);
    a = _mm256_fmadd_ps(_mm256_set1_ps(fy), _mm256_sub_ps(_mm256_loadu_ps(bottom), a), a);
    v4 left = _mm256_castps256_ps128(a), right = _mm256_extractf128_ps(a, 1);
#else
    v4 left = v4_loadu(top), right = v4_loadu(top + 4);
    left += fy * (v4_loadu(bottom) - left);
    right += fy * (v4_loadu(bottom + 4) - right);
#endif
    return left + fx * (right - left);
}

#endif

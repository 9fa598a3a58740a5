/* Whole draws with everything at its extremes: parameters at the ends of their ranges, cameras inside, beside and far from the fluid, off-centre and
 * orthographic, scenes from the size of an atom to that of a planet's orbit, particles with mad attributes. What a layer promises must hold whatever
 * the instruction set. Run under sanitizers this is the test that no index and no conversion leaves its range. */
#include "unit/picture_test.h"

enum { CASES = 400, PARTICLES_MAX = 300, SIDE_MAX = 150, ITERATIONS_MAX = 3 };

/* One case: everything that a draw reads. */
struct extreme {
    struct shot shot;
    struct mns_particles particles;
    double position64[PARTICLES_MAX][3];
    float position32[PARTICLES_MAX][3], radius[PARTICLES_MAX], mass[PARTICLES_MAX], color[PARTICLES_MAX][3];
    bool has_scene;
    float scene_color[SIDE_MAX * SIDE_MAX][4], scene_depth[SIDE_MAX * SIDE_MAX];
    struct mns_scene scene;
};

static double uniform(uint64_t *seed, double low, double high) { return low + (high - low) * 0.5 * (noise(seed) + 1); }

static int pick(uint64_t *seed, int count) { return (int)uniform(seed, 0, count); }

static double log_uniform(uint64_t *seed, double low, double high) { return exp(uniform(seed, log(low), log(high))); }

/* A value of the table's range: an end of it, or anything in between. */
static double any_value(uint64_t *seed, const struct mns_param *row)
{
    int kind = pick(seed, 4);
    if (kind < 2) {
        return kind == 0 ? row->minimum : row->maximum;
    }
    return row->minimum > 0 ? log_uniform(seed, row->minimum, row->maximum) : uniform(seed, row->minimum, row->maximum);
}

/* Each parameter stays at its default or, one time in `rarely`, becomes anything that the table allows. */
static void any_params(uint64_t *seed, struct mns_params *params, int rarely)
{
    for (size_t i = 0; i < mns_param_count(); i++) {
        const struct mns_param *row = mns_param_info(i);
        void *field = (char *)params + row->offset;
        if (pick(seed, rarely) != 0) {
            continue;
        }
        if (row->type == MNS_PARAM_FLOAT) {
            for (int k = 0; k < row->components; k++) {
                ((float *)field)[k] = (float)any_value(seed, row);
            }
        } else {
            *(int *)field = (int)row->minimum + pick(seed, (int)(row->maximum - row->minimum) + 1);
        }
    }
    params->thickness_scale = params->thickness_scale == 3 ? 4 : params->thickness_scale;
    params->smooth_scale = params->smooth_scale == 3 ? 4 : params->smooth_scale;
    params->iterations = params->iterations < ITERATIONS_MAX ? params->iterations : ITERATIONS_MAX; /* for the test's own time */
    params->mu = fminf(params->mu, params->delta);
    params->foam_weber_low = fminf(params->foam_weber_low, params->foam_weber_high);
    params->spray_low = fminf(params->spray_low, params->spray_high);
}

/* Looks at, past or out of a ball of fluid of radius `size` around `center`. */
static void any_camera(uint64_t *seed, struct mns_camera *camera, const double center[3], double size)
{
    double reach = size * log_uniform(seed, 0.01, pick(seed, 10) ? 100 : 1e20), eye[3], target[3];
    for (int k = 0; k < 3; k++) {
        eye[k] = center[k] + reach * noise(seed);
        target[k] = center[k] + size * noise(seed);
    }
    const double up[3] = {noise(seed), noise(seed), noise(seed)};
    double near_plane = size * log_uniform(seed, 1e-4, 3), far_plane = near_plane * (1 + log_uniform(seed, 1e-3, 1e6));
    mns_camera_look_at(camera, eye, target, up);
    int kind = pick(seed, 4);
    if (kind == 0) {
        assert_int_equal(mns_camera_orthographic(camera, size * log_uniform(seed, 0.01, 100), near_plane - 2 * size, far_plane), MNS_OK);
    } else if (kind == 1) {
        double left = uniform(seed, -3, 1), bottom = uniform(seed, -3, 1);
        assert_int_equal(mns_camera_frustum(camera, left * near_plane, (left + log_uniform(seed, 0.01, 4)) * near_plane,
                                            bottom * near_plane, (bottom + log_uniform(seed, 0.01, 4)) * near_plane, near_plane, far_plane),
                         MNS_OK);
    } else {
        assert_int_equal(
            mns_camera_perspective(camera, kind == 2 ? uniform(seed, 20, 90) : log_uniform(seed, 0.01, 179), near_plane, far_plane),
            MNS_OK);
    }
}

/* What a hostile float may be. */
static float mad(uint64_t *seed)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, 0, -0.0f, 3e38f, -3e38f, 1e-40f, 1, -1};
    return values[pick(seed, sizeof(values) / sizeof(values[0]))];
}

static void any_particles(uint64_t *seed, struct extreme *out, const double center[3], double size)
{
    mns_particles_init(&out->particles);
    size_t count = out->particles.count = pick(seed, 8) == 0 ? (size_t)pick(seed, 3) : (size_t)pick(seed, PARTICLES_MAX);
    double thickness[3], radius = size * log_uniform(seed, 1e-3, 1), spread = pick(seed, 2) ? 1 : log_uniform(seed, 1, 1e4);
    for (int k = 0; k < 3; k++) {
        thickness[k] = size * (pick(seed, 6) == 0 ? 0 : 1);
    }
    bool is_wild = pick(seed, 4) == 0;
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            out->position64[i][k] = center[k] + thickness[k] * noise(seed);
            if (is_wild && pick(seed, 50) == 0) {
                out->position64[i][k] = (double)mad(seed);
            }
            out->position32[i][k] = (float)out->position64[i][k];
            out->color[i][k] = is_wild ? mad(seed) : (float)uniform(seed, 0, 1);
        }
        out->radius[i] = (float)fmin(fmax(radius * log_uniform(seed, 1 / spread, spread), 1e-12), 1e12);
        out->mass[i] = (float)log_uniform(seed, 1 / spread, spread);
    }
    bool is_double = pick(seed, 2);
    out->particles.position = is_double ? (struct mns_attr){.data = out->position64, .type = MNS_F64}
                                        : (struct mns_attr){.data = out->position32, .type = MNS_F32};
    if (pick(seed, 3) == 0) {
        out->particles.radius = (struct mns_attr){.data = out->radius, .type = MNS_F32};
    }
    if (pick(seed, 3) == 0) {
        out->particles.mass = (struct mns_attr){.data = out->mass, .type = MNS_F32};
    }
    if (pick(seed, 3) == 0) {
        out->particles.color = (struct mns_attr){.data = out->color, .type = MNS_F32};
    }
}

static void any_scene(uint64_t *seed, struct extreme *out, double size)
{
    int width = out->shot.camera.width, height = out->shot.camera.height, pixels = width * height;
    out->has_scene = pick(seed, 3) == 0;
    bool is_wild = pick(seed, 4) == 0;
    for (int i = 0; i < pixels && out->has_scene; i++) {
        out->scene_depth[i] = is_wild ? mad(seed) : (float)(size * log_uniform(seed, 0.1, 10));
        for (int c = 0; c < 4; c++) {
            out->scene_color[i][c] = is_wild && pick(seed, 5) == 0 ? mad(seed) : (float)uniform(seed, 0, 1);
        }
    }
    out->scene = (struct mns_scene){
        .color = {.data = out->scene_color, .width = width, .height = height, .channels = 4, .pixel = MNS_PIXEL_F32},
        .depth = {
            .data = pick(seed, 4) ? out->scene_depth : NULL, .width = width, .height = height, .channels = 1, .pixel = MNS_PIXEL_F32}};
}

static void any_case(uint64_t seed, struct extreme *out)
{
    int width = pick(&seed, 4) == 0 ? 1 + pick(&seed, 3) : 1 + pick(&seed, SIDE_MAX);
    int height = pick(&seed, 4) == 0 ? 1 + pick(&seed, 3) : 1 + pick(&seed, SIDE_MAX);
    out->shot = shot_of(width, height);
    double size = pick(&seed, 2) ? 1 : log_uniform(&seed, 1e-12, 1e11), away = pick(&seed, 3) == 0 ? 1e6 * size : 0;
    const double center[3] = {away * noise(&seed), away * noise(&seed), away * noise(&seed)};
    any_camera(&seed, &out->shot.camera, center, size);
    any_particles(&seed, out, center, size);
    static const int rarely[] = {1000, 12, 3};
    any_params(&seed, &out->shot.params, rarely[pick(&seed, 3)]);
    any_scene(&seed, out, size);
}

static float *layers[MNS_LAYER_COUNT];

static void draw_case(struct extreme *in, enum mns_isa isa)
{
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.passes = 1; /* every layer is asked for */
    params.isa = isa;
    params.threads = 1;
    struct mns_output outputs[MNS_LAYER_COUNT];
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        layers[i] = layer_alloc(&in->shot, (enum mns_layer)i);
        outputs[i] = (struct mns_output){(enum mns_layer)i,
                                         {.data = layers[i],
                                          .width = in->shot.camera.width,
                                          .height = in->shot.camera.height,
                                          .channels = mns_layer_channels((enum mns_layer)i),
                                          .pixel = MNS_PIXEL_F32}};
    }
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &in->shot.camera;
    frame.params = &in->shot.params;
    frame.scene = in->has_scene ? &in->scene : NULL;
    frame.outputs = outputs;
    frame.output_count = MNS_LAYER_COUNT;
    mns_result result = mns_renderer_prepare(renderer, &in->particles);
    if (result == MNS_OK) {
        result = mns_renderer_draw(renderer, &frame);
    }
    if (result != MNS_OK) {
        /* Positions may span more than can be drawn; nothing else here is refused. */
        if (!strstr(mns_renderer_message(renderer), "span")) {
            fail_msg("%s", mns_renderer_message(renderer));
        }
        frame.output_count = 0;
        assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
        for (int i = 0; i < MNS_LAYER_COUNT; i++) {
            free(layers[i]);
            layers[i] = NULL;
        }
    }
    mns_renderer_destroy(&renderer);
}

static bool is_between(float value, float low, float high) { return value >= low && value <= high; }

/* What is wrong with a pixel, or NULL. */
static const char *fault_at(const struct extreme *in, size_t p)
{
    float depth = layers[MNS_LAYER_DEPTH][p], raw = layers[MNS_LAYER_DEPTH_RAW][p];
    const float *normal = layers[MNS_LAYER_NORMAL] + 3 * p;
    float near_plane = (float)in->shot.camera.near_plane, length2 = 0;
    for (size_t c = 0; c < 4; c++) {
        if (!isfinite(layers[MNS_LAYER_BEAUTY][4 * p + c])) {
            return "beauty";
        }
    }
    for (size_t c = 0; c < 3; c++) {
        if (!isfinite(layers[MNS_LAYER_SCENE_COLOR][3 * p + c])) {
            return "scene_color";
        }
        if (!is_between(layers[MNS_LAYER_TRANSMITTANCE][3 * p + c], 0, 1)) {
            return "transmittance";
        }
        if (!is_between(layers[MNS_LAYER_COLOR][3 * p + c], 0, 1.0001f)) {
            return "color";
        }
        length2 += normal[c] * normal[c];
    }
    if (!(raw > 0 || in->shot.camera.near_plane < 0) || (isfinite(raw) && raw < near_plane - 1e-6f * fabsf(near_plane))) {
        return "depth_raw";
    }
    if (!(depth > 0)) {
        return "depth";
    }
    if (!(isinf(depth) ? length2 == 0 : fabsf(length2 - 1) < 1e-3f)) {
        return "normal";
    }
    if (!is_between(layers[MNS_LAYER_THICKNESS_RAW][p], 0, 3e38f) || !is_between(layers[MNS_LAYER_THICKNESS][p], 0, 3e38f)) {
        return "thickness";
    }
    if (!isfinite(layers[MNS_LAYER_CURVATURE][p])) {
        return "curvature";
    }
    if (!is_between(layers[MNS_LAYER_ALPHA][p], 0, 1)) {
        return "alpha";
    }
    if (!isfinite(layers[MNS_LAYER_NOISE][p])) {
        return "noise";
    }
    for (int layer = MNS_LAYER_FOAM_THICKNESS; layer <= MNS_LAYER_THICKNESS_BACK; layer++) {
        if (!is_between(layers[layer][p], 0, 3e38f)) {
            return mns_layer_name((enum mns_layer)layer);
        }
    }
    if (isnan(layers[MNS_LAYER_SCENE_DEPTH][p])) {
        return "scene_depth";
    }
    return NULL;
}

static void describe(const struct extreme *in)
{
    struct mns_params defaults;
    mns_params_init(&defaults);
    for (size_t i = 0; i < mns_param_count(); i++) {
        char value[96], usual[96];
        const char *name = mns_param_info(i)->name;
        mns_params_get(&in->shot.params, name, value, sizeof(value));
        mns_params_get(&defaults, name, usual, sizeof(usual));
        if (strcmp(value, usual) != 0) {
            print_error("  %s=%s", name, value);
        }
    }
    print_error("\n  %d x %d, %zu particles%s%s%s%s\n", in->shot.camera.width, in->shot.camera.height, in->particles.count,
                in->particles.radius.data ? ", radius" : "", in->particles.mass.data ? ", mass" : "",
                in->particles.color.data ? ", color" : "", in->has_scene ? ", scene" : "");
}

static void every_layer_keeps_its_promises(void **state)
{
    (void)state;
    static struct extreme in;
    size_t fluid = 0;
    int faults = 0;
    for (uint64_t seed = 1; seed <= CASES; seed++) {
        any_case(seed * 7919, &in);
        for (enum mns_isa isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
            if (!mns_isa_available(isa)) {
                continue;
            }
            draw_case(&in, isa);
            size_t pixels = (size_t)in.shot.camera.width * (size_t)in.shot.camera.height;
            for (size_t p = 0; p < pixels && layers[0]; p++) {
                const char *fault = fault_at(&in, p);
                fluid += isfinite(layers[MNS_LAYER_DEPTH][p]) ? 1u : 0u;
                if (fault) {
                    print_error("case %d, %s, pixel %zu: %s\n", (int)seed, mns_isa_name(isa), p, fault);
                    describe(&in);
                    faults++;
                    break;
                }
            }
            for (int i = 0; i < MNS_LAYER_COUNT; i++) {
                free(layers[i]);
                layers[i] = NULL;
            }
        }
    }
    assert_int_equal(faults, 0);
    assert_true(fluid > 100000); /* the cases show something */
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_layer_keeps_its_promises)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

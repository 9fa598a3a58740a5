/* draw.c: water in the picture of an engine.
 *
 * The engine keeps its particles in a layout of its own and has drawn its scene, colour and depth, with a camera of its own. Meniscus
 * reads the particles where they lie and puts the water into that picture: the crate stands in the pool.
 *
 *     draw OUTPUT.ppm */
#include <meniscus/meniscus.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 960, HEIGHT = 540 };

/* A particle as this engine happens to store it. */
struct drop {
    uint32_t id;
    float position[3]; /* metres */
    float age;         /* seconds */
};

/* What this engine has drawn before the water comes. */
struct engine_picture {
    float color[HEIGHT][WIDTH][3]; /* linear RGB */
    float depth[HEIGHT][WIDTH];    /* metres along the view axis, INFINITY for the sky */
};

static const double EYE[3] = {1.3, 1.1, 2.2};
static const double TARGET[3] = {0, 0.15, 0};
static const double UP[3] = {0, 1, 0};
static const double CRATE_MIN[3] = {-0.45, 0, 0.1};
static const double CRATE_MAX[3] = {-0.15, 0.3, 0.4};
static const double POOL_RADIUS = 0.8, DROP_RADIUS = 0.07;
static const double SPACING = 0.015; /* metres between particles at rest */

/* Adds particles from bottom to top, or counts them when drops is NULL. */
static void add_column(struct drop *drops, size_t *count, double x, double z, double bottom, double top)
{
    int layers = (int)((top - bottom) / SPACING + 0.5);
    for (int layer = 0; layer < layers; layer++) {
        if (drops) {
            float y = (float)(bottom + (top - bottom) * (layer + 0.5) / layers);
            struct drop drop = {(uint32_t)*count, {(float)x, y, (float)z}, 0};
            drops[*count] = drop;
        }
        ++*count;
    }
}

/* A round pool with rings that run outwards, around the crate, and a drop above it. Returns the number of particles. */
static size_t make_drops(struct drop *drops)
{
    size_t count = 0;
    for (double z = -POOL_RADIUS; z < POOL_RADIUS; z += SPACING) {
        for (double x = -POOL_RADIUS; x < POOL_RADIUS; x += SPACING) {
            double r = sqrt(x * x + z * z);
            int in_crate = x > CRATE_MIN[0] && x < CRATE_MAX[0] && z > CRATE_MIN[2] && z < CRATE_MAX[2];
            if (r < POOL_RADIUS && !in_crate) {
                add_column(drops, &count, x, z, 0, 0.14 + 0.1 * exp(-5 * r) * cos(20 * r));
            }
            if (r < DROP_RADIUS) {
                double half = sqrt(DROP_RADIUS * DROP_RADIUS - r * r);
                add_column(drops, &count, x, z, 0.5 - half, 0.5 + half);
            }
        }
    }
    return count;
}

/* Distance along the ray to the crate, INFINITY past it; *axis: of the face that is hit. */
static double hit_crate(const double ray[3], int *axis)
{
    double enter = 0, leave = INFINITY;
    for (int i = 0; i < 3; i++) {
        double a = (CRATE_MIN[i] - EYE[i]) / ray[i], b = (CRATE_MAX[i] - EYE[i]) / ray[i];
        double near_side = a < b ? a : b, far_side = a < b ? b : a;
        *axis = near_side > enter ? i : *axis;
        enter = near_side > enter ? near_side : enter;
        leave = far_side < leave ? far_side : leave;
    }
    return enter < leave ? enter : INFINITY;
}

/* The engine's own renderer: a crate on a chequered floor under a grey sky. */
static void draw_engine_pixel(const double ray[3], float color[3], float *depth)
{
    int axis = 0;
    double crate = hit_crate(ray, &axis);
    double ground = ray[1] < 0 ? -EYE[1] / ray[1] : INFINITY;
    float light = 0.75f;
    *depth = (float)(crate < ground ? crate : ground); /* a ray is one metre long along the view axis: distances are depths */
    if (crate < ground) {
        static const float face_light[3] = {0.55f, 0.9f, 0.35f};
        light = face_light[axis];
    } else if (ground < 20) {
        int cell = (int)((EYE[0] + ground * ray[0] + 32) * 4) + (int)((EYE[2] + ground * ray[2] + 32) * 4);
        light = cell % 2 ? 0.5f : 0.25f;
    }
    color[0] = light;
    color[1] = crate < ground ? light * 0.4f : light;
    color[2] = crate < ground ? light * 0.1f : light;
}

static void draw_engine_picture(struct engine_picture *picture, const struct mns_camera *camera)
{
    const double *view = camera->view, *projection = camera->projection; /* column-major */
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double right = (2 * (x + 0.5) / WIDTH - 1) / projection[0];
            double up = (1 - 2 * (y + 0.5) / HEIGHT) / projection[5];
            double ray[3];
            for (int i = 0; i < 3; i++) { /* from view space to the world */
                ray[i] = view[4 * i] * right + view[4 * i + 1] * up - view[4 * i + 2];
            }
            draw_engine_pixel(ray, picture->color[y][x], &picture->depth[y][x]);
        }
    }
}

static mns_result draw_water(mns_renderer *renderer, const struct drop *drops, size_t count, const struct mns_camera *camera,
                             struct engine_picture *picture, uint8_t *rgb)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position.data = drops[0].position;
    particles.position.stride = sizeof(drops[0]);
    particles.position.type = MNS_F32;
    mns_result result = mns_renderer_prepare(renderer, &particles); /* once per set of particles */
    if (result != MNS_OK) {
        return result;
    }

    struct mns_params params;
    mns_params_init(&params);
    params.radius = (float)(SPACING / 2); /* known here; else it would be estimated */

    struct mns_scene scene = {{picture->color, 0, WIDTH, HEIGHT, 3, MNS_PIXEL_F32}, {picture->depth, 0, WIDTH, HEIGHT, 1, MNS_PIXEL_F32}};
    struct mns_output output = {MNS_LAYER_BEAUTY, {rgb, 0, WIDTH, HEIGHT, 3, MNS_PIXEL_U8}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = camera;
    frame.params = &params;
    frame.scene = &scene;
    frame.outputs = &output;
    frame.output_count = 1;
    return mns_renderer_draw(renderer, &frame); /* once per view of it */
}

static int write_ppm(const char *path, const uint8_t *rgb)
{
    FILE *file = fopen(path, "wb");
    if (!file) {
        return 0;
    }
    int written = fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT) > 0 && fwrite(rgb, 3 * WIDTH, HEIGHT, file) == HEIGHT;
    return fclose(file) == 0 && written;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: draw OUTPUT.ppm\n");
        return 2;
    }
    int status = 1;
    struct mns_message message;
    mns_renderer *renderer = NULL;
    size_t count = make_drops(NULL);
    struct drop *drops = malloc(count * sizeof(*drops));
    struct engine_picture *picture = malloc(sizeof(*picture));
    uint8_t *rgb = malloc((size_t)3 * WIDTH * HEIGHT);
    if (!drops || !picture || !rgb) {
        fprintf(stderr, "draw: out of memory\n");
        goto done;
    }

    struct mns_camera camera;
    mns_camera_init(&camera, WIDTH, HEIGHT);
    if (mns_camera_look_at(&camera, EYE, TARGET, UP) != MNS_OK || mns_camera_perspective(&camera, 35, 0.05, 100) != MNS_OK) {
        fprintf(stderr, "draw: no such camera\n");
        goto done;
    }
    make_drops(drops);
    draw_engine_picture(picture, &camera);

    if (mns_renderer_create(&renderer, NULL, &message) != MNS_OK) {
        fprintf(stderr, "draw: %s\n", message.text);
        goto done;
    }
    if (draw_water(renderer, drops, count, &camera, picture, rgb) != MNS_OK) {
        fprintf(stderr, "draw: %s\n", mns_renderer_message(renderer));
        goto done;
    }
    if (!write_ppm(argv[1], rgb)) {
        fprintf(stderr, "draw: %s: cannot be written\n", argv[1]);
        goto done;
    }
    status = 0;

done:
    mns_renderer_destroy(&renderer);
    free(rgb);
    free(picture);
    free(drops);
    return status;
}

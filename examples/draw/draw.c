/* draw.c: an engine's own particles over the engine's own background, drawn into the engine's own pixels.
 *
 * Needs meniscus::meniscus alone, no file formats. Writes draw.ppm. */
#include <meniscus/meniscus.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 960, HEIGHT = 540, COUNT = 60 * 20 * 60 };

/* A particle as an engine might keep it: the renderer reads it where it is. */
struct particle {
    float lifetime;
    float position[3];
    float velocity[3];
};

static void make_pool(struct particle *particles)
{
    const float spacing = 0.04f;
    for (int i = 0; i < COUNT; i++) {
        int x = i % 60, z = i / 60 % 60, y = i / 3600;
        float px = spacing * (float)(x - 30), pz = spacing * (float)(z - 30);
        float level = 0.75f + 0.08f * sinf(5.0f * px) * cosf(4.0f * pz);
        particles[i].lifetime = 0;
        particles[i].position[0] = px;
        particles[i].position[1] = level * spacing * ((float)y + 0.5f);
        particles[i].position[2] = pz;
        for (int k = 0; k < 3; k++) {
            particles[i].velocity[k] = 0;
        }
    }
}

/* What the engine has drawn already: here a wall of stripes two metres behind the pool's middle. */
static void make_background(float *color, float *depth, float distance)
{
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            float *c = color + 3 * (y * WIDTH + x), bright = (x / 40 + y / 40) % 2 ? 0.7f : 0.25f;
            c[0] = bright;
            c[1] = bright * 0.95f;
            c[2] = bright * 0.85f;
            depth[y * WIDTH + x] = distance;
        }
    }
}

static int write_ppm(const char *path, const unsigned char *rgb)
{
    FILE *file = fopen(path, "wb");
    if (!file) {
        return 0;
    }
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    size_t written = fwrite(rgb, 3, (size_t)WIDTH * HEIGHT, file);
    return fclose(file) == 0 && written == (size_t)WIDTH * HEIGHT;
}

int main(void)
{
    struct particle *pool = malloc(COUNT * sizeof(*pool));
    float *color = malloc((size_t)WIDTH * HEIGHT * 3 * sizeof(*color)), *depth = malloc((size_t)WIDTH * HEIGHT * sizeof(*depth));
    unsigned char *rgb = malloc((size_t)WIDTH * HEIGHT * 3);
    mns_renderer *renderer = NULL;
    struct mns_message message;
    int status = 1;
    if (!pool || !color || !depth || !rgb) {
        fprintf(stderr, "out of memory\n");
        goto done;
    }
    make_pool(pool);
    make_background(color, depth, 7);

    if (mns_renderer_create(&renderer, NULL, &message) != MNS_OK) {
        fprintf(stderr, "%s\n", message.text);
        goto done;
    }

    /* Once per set of particles. */
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position.data = pool->position;
    particles.position.stride = sizeof(*pool);
    particles.position.type = MNS_F32;
    if (mns_renderer_prepare(renderer, &particles) != MNS_OK) {
        fprintf(stderr, "%s\n", mns_renderer_message(renderer));
        goto done;
    }

    /* Once per view. */
    struct mns_camera camera;
    mns_camera_init(&camera, WIDTH, HEIGHT);
    const double eye[3] = {0, 2.6, 4}, target[3] = {0, 0.2, 0}, up[3] = {0, 1, 0};
    mns_camera_look_at(&camera, eye, target, up);
    mns_camera_perspective(&camera, 40, 0.1, 100);

    struct mns_params params;
    mns_params_init(&params);
    params.radius = 0.02f; /* left out, it is estimated */
    params.absorption[0] = 1.8f;
    params.absorption[1] = 0.5f;
    params.absorption[2] = 0.3f;

    struct mns_scene scene = {
        {color, 0, WIDTH, HEIGHT, 3, MNS_PIXEL_F32},
        {depth, 0, WIDTH, HEIGHT, 1, MNS_PIXEL_F32},
    };
    struct mns_output output = {MNS_LAYER_BEAUTY, {rgb, 0, WIDTH, HEIGHT, 3, MNS_PIXEL_U8}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &params;
    frame.scene = &scene;
    frame.outputs = &output;
    frame.output_count = 1;
    if (mns_renderer_draw(renderer, &frame) != MNS_OK) {
        fprintf(stderr, "%s\n", mns_renderer_message(renderer));
        goto done;
    }
    if (!write_ppm("draw.ppm", rgb)) {
        fprintf(stderr, "draw.ppm cannot be written\n");
        goto done;
    }
    printf("draw.ppm\n");
    status = 0;

done:
    mns_renderer_destroy(&renderer);
    free(rgb);
    free(depth);
    free(color);
    free(pool);
    return status;
}

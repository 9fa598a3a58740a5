/* Meshes against closed form: depth and coverage of a box, a tank's far faces, shadows, what is kept, and files that are none. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "unit/picture_test.h"

#include <meniscus/scene.h>

#include <dirent.h>
#include <stdio.h>
#include <unistd.h>

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

static const struct mns_light daylight = {.struct_size = sizeof(struct mns_light),
                                          .up = {0, 1, 0},
                                          .sun = {0.6, 0.8, 0},
                                          .sun_light = {1, 1, 1},
                                          .sky_light = {0.2f, 0.2f, 0.2f},
                                          .ground_light = {0.1f, 0.1f, 0.1f},
                                          .side_light = {0.15f, 0.15f, 0.15f}};

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* A box with a colour, as an .obj and its .mtl. */
static void write_box(const char *path, const double low[3], const double high[3])
{
    static const int faces[6][4] = {{1, 2, 4, 3}, {5, 7, 8, 6}, {1, 5, 6, 2}, {3, 4, 8, 7}, {1, 3, 7, 5}, {2, 6, 8, 4}};
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, "mtllib box.mtl\nusemtl paint\n");
    for (int i = 0; i < 8; i++) {
        fprintf(file, "v %.17g %.17g %.17g\n", i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    }
    for (int i = 0; i < 6; i++) {
        fprintf(file, "f %d %d %d %d\n", faces[i][0], faces[i][1], faces[i][2], faces[i][3]);
    }
    assert_int_equal(fclose(file), 0);
    write_text("box.mtl", "newmtl paint\nKd 0.5 0.25 0.125\n");
}

static mns_meshes *meshes_of(int threads)
{
    struct mns_meshes_params params;
    struct mns_message message;
    mns_meshes *meshes;
    mns_meshes_params_init(&params);
    params.threads = threads;
    if (mns_meshes_create(&meshes, &params, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    return meshes;
}

static void read_mesh(mns_meshes *meshes, int slot, const char *path, bool container)
{
    struct mns_mesh_params params;
    struct mns_message message;
    mns_mesh_params_init(&params);
    params.container = container;
    if (mns_meshes_read(meshes, slot, path, &params, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
}

static const struct mns_object_pixel *draw(mns_meshes *meshes, const struct mns_camera *camera, const struct mns_light *light)
{
    const struct mns_objects *objects;
    struct mns_message message;
    if (mns_meshes_draw(meshes, camera, light, &objects, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    assert_int_equal(objects->width, camera->width);
    return objects->pixels;
}

/* The ray of a pixel's centre in the world, by the camera's matrices; its parameter is depth. */
static void ray_of(const struct mns_camera *camera, int x, int y, double origin[3], double direction[3])
{
    const double *p = camera->projection, *v = camera->view;
    double clip_x = 2 * (x + 0.5) / camera->width - 1, clip_y = 1 - 2 * (y + 0.5) / camera->height;
    bool orthographic = p[15] == 1;
    const double at[3] = {orthographic ? (clip_x - p[12]) / p[0] : 0, orthographic ? (clip_y - p[13]) / p[5] : 0, 0};
    const double towards[3] = {orthographic ? 0 : (clip_x + p[8]) / p[0], orthographic ? 0 : (clip_y + p[9]) / p[5], -1};
    for (int k = 0; k < 3; k++) {
        origin[k] = direction[k] = 0;
        for (int row = 0; row < 3; row++) {
            origin[k] += v[4 * k + row] * (at[row] - v[12 + row]);
            direction[k] += v[4 * k + row] * towards[row];
        }
    }
}

/* Where the ray enters and leaves the box, grown by `grow` on each side. */
static bool meet_box(const double low[3], const double high[3], double grow, const double origin[3], const double direction[3],
                     double out[2])
{
    out[0] = -INFINITY;
    out[1] = INFINITY;
    for (int c = 0; c < 3; c++) {
        double a = (low[c] - grow - origin[c]) / direction[c], b = (high[c] + grow - origin[c]) / direction[c];
        out[0] = fmax(out[0], fmin(a, b));
        out[1] = fmin(out[1], fmax(a, b));
    }
    return out[0] <= out[1];
}

static const double LOW[3] = {99.5, -50.25, 1000}, HIGH[3] = {100.5, -49, 1000.75}; /* far from the world's origin */

static void aim(struct mns_camera *camera, bool orthographic)
{
    const double eye[3] = {102, -47.5, 1003}, target[3] = {100, -49.5, 1000.25}, up[3] = {0.1, 1, 0};
    mns_camera_init(camera, WIDTH, HEIGHT);
    assert_int_equal(mns_camera_look_at(camera, eye, target, up), MNS_OK);
    assert_int_equal(orthographic ? mns_camera_orthographic(camera, 3, 0.01, 100)
                                  : mns_camera_frustum(camera, -0.03, 0.06, -0.02, 0.04, 0.1, 100),
                     MNS_OK);
}

static void check_box(bool orthographic, bool container)
{
    mns_meshes *meshes = meshes_of(2);
    struct mns_camera camera;
    write_box("box.obj", LOW, HIGH);
    read_mesh(meshes, 0, "box.obj", container);
    aim(&camera, orthographic);
    const struct mns_object_pixel *pixels = draw(meshes, &camera, &daylight);
    int hits = 0, parts = 0;
    for (int i = 0; i < PIXELS; i++) {
        double origin[3], direction[3], in[2], out[2];
        ray_of(&camera, i % WIDTH, i / WIDTH, origin, direction);
        bool surely = meet_box(LOW, HIGH, -1e-3, origin, direction, in), maybe = meet_box(LOW, HIGH, 1e-3, origin, direction, out);
        if (surely == maybe) { /* else the ray meets an edge */
            bool meets = meet_box(LOW, HIGH, 0, origin, direction, in);
            assert_int_equal(meets, isfinite(pixels[i].depth));
            assert_true(!meets || fabs((double)pixels[i].depth - in[container]) < 4e-6 * in[container] + 2e-5);
            hits += meets;
        }
        parts += pixels[i].color[3] > 0 && pixels[i].color[3] < 1;
        assert_true(pixels[i].color[3] >= 0 && pixels[i].color[3] <= 1 && pixels[i].floor_sun == 1);
    }
    assert_true(hits > 500 && parts > 50 && parts < 400); /* the silhouette alone is covered by parts */
    mns_meshes_destroy(&meshes);
}

static void test_depth_is_the_box(void **state)
{
    (void)state;
    check_box(false, false);
    check_box(true, false);
}

static void test_of_a_tank_the_far_side_shows(void **state)
{
    (void)state;
    check_box(false, true);
    check_box(true, true);
}

static void test_light_is_the_material_s(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(1);
    struct mns_camera camera;
    const double low[3] = {-5, -1, -5}, high[3] = {5, 0, 5}, eye[3] = {0, 5, 0.01}, target[3] = {0, 0, 0}, up[3] = {0, 0, -1};
    write_box("slab.obj", low, high);
    read_mesh(meshes, 0, "slab.obj", false);
    mns_camera_init(&camera, WIDTH, HEIGHT);
    assert_int_equal(mns_camera_look_at(&camera, eye, target, up), MNS_OK);
    const struct mns_object_pixel *at = draw(meshes, &camera, &daylight) + PIXELS / 2 + WIDTH / 2;
    static const float albedo[3] = {0.5f, 0.25f, 0.125f};
    for (int c = 0; c < 3; c++) { /* it faces up: all of the sky, and the sun at 0.8 */
        assert_true(fabsf(at->color[c] - 0.2f * albedo[c]) < 1e-5f);
        assert_true(fabsf(at->sunlit[c] - 0.8f * albedo[c]) < 1e-5f);
    }
    assert_true(at->color[3] == 1 && fabsf(at->reach - at->depth) < 0.1f);
    mns_meshes_destroy(&meshes);
}

/* A cube of side 1 that hovers over the floor: its shadow lies where the sun throws it, and under it the floor sees less sky. */
static void test_shadow_lies_where_the_sun_throws_it(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(2);
    struct mns_camera camera;
    struct mns_light light = daylight;
    light.has_floor = 1;
    const double low[3] = {-0.5, 1, -0.5}, high[3] = {0.5, 2, 0.5}, eye[3] = {-3, 6, 4}, target[3] = {-1, 0, 0}, up[3] = {0, 1, 0};
    write_box("cube.obj", low, high);
    read_mesh(meshes, 0, "cube.obj", false);
    mns_camera_init(&camera, WIDTH, HEIGHT);
    assert_int_equal(mns_camera_look_at(&camera, eye, target, up), MNS_OK);
    const struct mns_object_pixel *pixels = draw(meshes, &camera, &light);
    int dark = 0, bright = 0;
    for (int i = 0; i < PIXELS; i++) {
        double origin[3], direction[3], none[2], box[2];
        ray_of(&camera, i % WIDTH, i / WIDTH, origin, direction);
        double t = -origin[1] / direction[1];
        const double floor[3] = {origin[0] + t * direction[0], 0, origin[2] + t * direction[2]};
        if (t < 0 || pixels[i].color[3] > 0) {
            continue;
        }
        bool surely = meet_box(low, high, -0.1, floor, light.sun, none), maybe = meet_box(low, high, 0.1, floor, light.sun, box);
        if (surely == maybe) {
            assert_true(pixels[i].floor_sun == (surely ? 0.0f : 1.0f));
            dark += surely;
            bright += !surely;
        }
        assert_true(isinf(pixels[i].depth));
    }
    assert_true(dark > 100 && bright > 1000);
    mns_meshes_destroy(&meshes);
}

static void test_a_floor_hides_what_is_under_it(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(2);
    struct mns_camera camera;
    struct mns_light light = daylight;
    write_box("box.obj", LOW, HIGH);
    read_mesh(meshes, 0, "box.obj", false);
    aim(&camera, false);
    light.has_floor = 1;
    light.floor_height = -48; /* over the box, under the eye */
    const struct mns_object_pixel *pixels = draw(meshes, &camera, &light);
    for (int i = 0; i < PIXELS; i++) {
        assert_true(pixels[i].color[3] == 0 && isinf(pixels[i].depth));
    }
    mns_meshes_destroy(&meshes);
}

static void test_pictures_are_kept(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(2);
    struct mns_camera camera;
    struct mns_light light = daylight;
    struct mns_mesh_stats stats;
    write_box("box.obj", LOW, HIGH);
    read_mesh(meshes, 0, "box.obj", false);
    aim(&camera, false);
    mns_mesh_stats_init(&stats);
    for (int i = 0; i < 3; i++) {
        draw(meshes, &camera, &light);
    }
    mns_meshes_stats(meshes, &stats);
    assert_int_equal(stats.draws, 1);
    assert_int_equal(stats.triangles, 12);
    assert_true(fabs(stats.bounds_min[2] - LOW[2]) < 1e-4 && fabs(stats.bounds_max[1] - HIGH[1]) < 1e-5);
    light.sun_light[1] = 0.9f;
    draw(meshes, &camera, &light);
    aim(&camera, true);
    draw(meshes, &camera, &light);
    read_mesh(meshes, 0, "box.obj", false);
    draw(meshes, &camera, &light);
    mns_meshes_stats(meshes, &stats);
    assert_int_equal(stats.draws, 4);
    mns_meshes_destroy(&meshes);
}

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    static struct mns_object_pixel first[PIXELS];
    static const int threads[] = {1, 2, 7};
    struct mns_light light = daylight;
    light.has_floor = 1;
    light.floor_height = -50.5;
    write_box("box.obj", LOW, HIGH);
    for (int i = 0; i < 3; i++) {
        mns_meshes *meshes = meshes_of(threads[i]);
        struct mns_camera camera;
        aim(&camera, false);
        read_mesh(meshes, 3, "box.obj", false);
        const struct mns_object_pixel *pixels = draw(meshes, &camera, &light);
        if (i > 0) {
            assert_memory_equal(pixels, first, sizeof(first));
        }
        memcpy(first, pixels, sizeof(first));
        mns_meshes_destroy(&meshes);
    }
}

/* A quad with a texture of two colours, and its file turned from y up to z up in millimetres. */
static void test_textures_axes_and_units(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(1);
    struct mns_camera camera;
    struct mns_mesh_params params;
    struct mns_message message;
    FILE *file = fopen("two.tga", "wb"); /* 2 x 1 pixels, blue and red */
    const unsigned char tga[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0, 255, 0, 0, 0, 0, 255};
    assert_non_null(file);
    assert_int_equal(fwrite(tga, 1, sizeof(tga), file), sizeof(tga));
    assert_int_equal(fclose(file), 0);
    write_text("two.mtl", "newmtl two\nKd 1 1 1\nmap_Kd two.tga\n");
    write_text("two.obj", "mtllib two.mtl\nusemtl two\nv -1000 0 -1000\nv 1000 0 -1000\nv 1000 0 1000\nv -1000 0 1000\n"
                          "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 4/4 3/3 2/2 1/1\n");
    mns_mesh_params_init(&params);
    params.scale = 0.001;
    params.world_up_axis = MNS_AXIS_Z;
    assert_int_equal(mns_meshes_read(meshes, 0, "two.obj", &params, &message), MNS_OK);
    const double eye[3] = {0, 0, 2}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    mns_camera_init(&camera, WIDTH, HEIGHT);
    assert_int_equal(mns_camera_look_at(&camera, eye, target, up), MNS_OK);
    struct mns_light light = daylight;
    light.up[1] = 0;
    light.up[2] = light.sun[2] = 1;
    light.sun[0] = light.sun[1] = 0;
    const struct mns_object_pixel *row = draw(meshes, &camera, &light) + HEIGHT / 2 * WIDTH;
    assert_true(fabsf(row[WIDTH / 2].depth - 2) < 1e-5f);
    assert_true(row[WIDTH / 4].sunlit[2] > 0.9f && row[WIDTH / 4].sunlit[0] < 0.1f);
    assert_true(row[3 * WIDTH / 4].sunlit[0] > 0.9f && row[3 * WIDTH / 4].sunlit[2] < 0.1f);
    mns_meshes_destroy(&meshes);
}

static void refuse(mns_meshes *meshes, const char *path, const char *text, const char *words)
{
    struct mns_message message;
    if (text) {
        write_text(path, text);
    }
    assert_int_not_equal(mns_meshes_read(meshes, 0, path, NULL, &message), MNS_OK);
    if (!strstr(message.text, words) || strncmp(message.text, path, strlen(path)) != 0 || strchr(message.text, '\n')) {
        fail_msg("%s: says '%s', not '%s'", path, message.text, words);
    }
}

static void test_files_that_are_no_mesh(void **state)
{
    (void)state;
    mns_meshes *meshes = meshes_of(1);
    refuse(meshes, "missing.obj", NULL, "No such file");
    refuse(meshes, "mesh.txt", "v 0 0 0\n", ".obj, .ply, .stl, .gltf and .glb can be read");
    refuse(meshes, "empty.ply", "", "is empty");
    refuse(meshes, "points.obj", "v 0 0 0\nv 1 0 0\n", "holds no faces");
    refuse(meshes, "none.stl", "solid x\nendsolid x\n", "holds no faces");
    refuse(meshes, "nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "must be finite");
    refuse(meshes, "far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "must be finite");
    refuse(meshes, "beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "out of range");
    refuse(meshes, "words.ply", "This is no mesh.\n", "cannot be read");
    refuse(meshes, "words.glb", "This is no mesh.\n", "cannot be read");
    write_text("gone.mtl", "newmtl gone\nKd 1 1 1\nmap_Kd gone.png\n");
    refuse(meshes, "gone.obj", "mtllib gone.mtl\nusemtl gone\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n",
           "texture gone.png cannot be opened: No such file");
    write_text("gone.png", "This is no picture.\n");
    refuse(meshes, "gone.obj", NULL, "texture gone.png cannot be read");
    struct mns_message message;
    assert_int_equal(mns_meshes_read(meshes, 256, "box.obj", NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    struct mns_mesh_stats stats;
    mns_mesh_stats_init(&stats);
    mns_meshes_stats(meshes, &stats);
    assert_int_equal(stats.triangles, 0);
    mns_meshes_destroy(&meshes);
}

/* The files lie in a folder of their own, which goes with them. */
static char folder[] = "test_meshes.XXXXXX";

static int enter_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

static int leave_folder(void **state)
{
    (void)state;
    DIR *files = opendir(".");
    assert_non_null(files);
    for (const struct dirent *entry = readdir(files); entry; entry = readdir(files)) {
        if (entry->d_name[0] != '.') {
            assert_int_equal(remove(entry->d_name), 0);
        }
    }
    closedir(files);
    return chdir("..") == 0 ? rmdir(folder) : -1;
}

static void refuse_environment(const char *path, const char *text, const char *words)
{
    struct mns_message message;
    mns_environment *environment;
    if (text) {
        write_text(path, text);
    }
    assert_int_not_equal(mns_environment_read(&environment, path, &message), MNS_OK);
    assert_null(environment);
    if (!strstr(message.text, words) || strchr(message.text, '\n')) {
        fail_msg("%s: says '%s', not '%s'", path, message.text, words);
    }
}

/* Two pixels of Radiance's RGBE, flat: (1, 0.5, 0.25) and 100 times that. */
static void test_environments_from_files(void **state)
{
    (void)state;
    struct mns_message message;
    mns_environment *environment;
    static const char head[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    static const unsigned char pixels[] = {128, 64, 32, 129, 200, 100, 50, 135};
    FILE *file = fopen("sky.hdr", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(head, 1, sizeof(head) - 1, file), sizeof(head) - 1);
    assert_int_equal(fwrite(pixels, 1, sizeof(pixels), file), sizeof(pixels));
    assert_int_equal(fclose(file), 0);
    assert_int_equal(mns_environment_read(&environment, "sky.hdr", &message), MNS_OK);
    mns_environment_destroy(&environment);
    assert_null(environment);
    static const char *const faces[] = {"px", "nx", "py", "ny", "posz", "nz"};
    for (int i = 0; i < 6; i++) {
        char path[32];
        snprintf(path, sizeof(path), "cube_%s.tga", faces[i]);
        file = fopen(path, "wb"); /* 1 x 1 pixel */
        const unsigned char tga[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 255, 128, 0};
        assert_non_null(file);
        assert_int_equal(fwrite(tga, 1, sizeof(tga), file), sizeof(tga));
        assert_int_equal(fclose(file), 0);
    }
    if (mns_environment_read(&environment, "cube_%s.tga", &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    mns_environment_destroy(&environment);
    refuse_environment("none_%s.png", NULL, "none_px.png: cannot be read: No such file");
    refuse_environment("none.hdr", NULL, "none.hdr: cannot be read: No such file");
    refuse_environment("words.hdr", "This is no picture.\n", "words.hdr: cannot be read");
    refuse_environment("words.exr", "This is no picture.\n", "words.exr: ");
    refuse_environment("none.exr", NULL, "none.exr: ");
    refuse_environment("half.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n", "half.hdr: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_depth_is_the_box),
        cmocka_unit_test(test_of_a_tank_the_far_side_shows),
        cmocka_unit_test(test_light_is_the_material_s),
        cmocka_unit_test(test_shadow_lies_where_the_sun_throws_it),
        cmocka_unit_test(test_a_floor_hides_what_is_under_it),
        cmocka_unit_test(test_pictures_are_kept),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_textures_axes_and_units),
        cmocka_unit_test(test_files_that_are_no_mesh),
        cmocka_unit_test(test_environments_from_files),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}

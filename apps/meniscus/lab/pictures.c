/* pictures.c: what the filters look like. */
#include "pictures.h"

#include <meniscus/io.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 3, CHANNELS = 3 };

/* A sheet of pictures at half size. */
struct sheet {
    int width, height; /* pixels of one */
    int count;         /* filled */
    struct mns_image image;
};

static bool sheet_create(struct sheet *sheet, const struct lab *lab, int pictures)
{
    int width = lab->settings.width / 2, height = lab->settings.height / 2, rows = (pictures + COLUMNS - 1) / COLUMNS;
    int columns = pictures < COLUMNS ? pictures : COLUMNS;
    *sheet = (struct sheet){.width = width, .height = height};
    sheet->image = (struct mns_image){.width = columns * width, .height = rows * height, .channels = CHANNELS, .pixel = MNS_PIXEL_U8};
    sheet->image.data = calloc((size_t)sheet->image.width * (size_t)sheet->image.height + 1, CHANNELS);
    return sheet->image.data != NULL;
}

/* Each of its pixels is the mean of four, as the bytes are: near enough for a small picture. */
static void sheet_add(struct sheet *sheet, const unsigned char *pixels, int width)
{
    size_t row = (size_t)width * CHANNELS, out_row = (size_t)sheet->image.width * CHANNELS;
    unsigned char *out = sheet->image.data;
    out += (size_t)(sheet->count / COLUMNS * sheet->height) * out_row + (size_t)(sheet->count % COLUMNS * sheet->width) * CHANNELS;
    for (int y = 0; y < sheet->height; y++) {
        for (int x = 0; x < sheet->width; x++) {
            for (size_t k = 0; k < CHANNELS; k++) {
                const unsigned char *at = pixels + (size_t)(2 * y) * row + (size_t)(2 * x) * CHANNELS + k;
                out[(size_t)y * out_row + (size_t)x * CHANNELS + k] =
                    (unsigned char)((at[0] + at[CHANNELS] + at[row] + at[row + CHANNELS] + 2) / 4);
            }
        }
    }
    sheet->count++;
}

static mns_result draw(struct lab *lab, const struct mns_params *params, void *pixels)
{
    struct mns_camera camera;
    struct mns_frame frame;
    struct mns_output output = {
        MNS_LAYER_BEAUTY,
        {.data = pixels, .width = lab->settings.width, .height = lab->settings.height, .channels = CHANNELS, .pixel = MNS_PIXEL_U8}};
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = params;
    frame.outputs = &output;
    frame.output_count = 1;
    mns_result result = lab_view_camera(&lab->view[0], &camera);
    result = result == MNS_OK ? mns_renderer_draw(lab->renderer, &frame) : result;
    if (result != MNS_OK) {
        snprintf(lab->message.text, sizeof(lab->message.text), "%s", mns_renderer_message(lab->renderer));
    }
    return result;
}

static mns_result write_image(struct lab *lab, const struct mns_image *image, const char *folder, const char *name, const char *end)
{
    size_t size = strlen(folder) + strlen(name) + strlen(end) + 3;
    char *path = malloc(size);
    if (!path) {
        return lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    }
    snprintf(path, size, "%s/%s%s", folder, name, end);
    mns_result result = mns_image_write(path, image, &lab->message);
    free(path);
    return result;
}

/* Both pictures of a filter; pixels: room for one, in which the lit one is left. */
static mns_result write_filter(struct lab *lab, int filter, const char *folder, const struct mns_image *image)
{
    static const int displays[] = {MNS_DISPLAY_NORMAL, MNS_DISPLAY_OPAQUE};
    static const char *const ends[] = {"-normal.png", ".png"};
    char name[96];
    mns_result result = MNS_OK;
    snprintf(name, sizeof(name), "%s-%s", lab_scene_name(lab->scene), lab_filter_name(filter));
    for (int i = 0; result == MNS_OK && i < 2; i++) {
        struct mns_params params = lab_params(lab, filter);
        params.display = displays[i];
        result = draw(lab, &params, image->data);
        result = result == MNS_OK ? write_image(lab, image, folder, name, ends[i]) : result;
    }
    return result;
}

static mns_result write_scene(struct lab *lab, unsigned long filters, const char *folder, const struct mns_image *image,
                              struct sheet *sheet)
{
    mns_result result = MNS_OK;
    sheet->count = 0;
    for (int filter = 0; result == MNS_OK && filter < lab_filter_count(); filter++) {
        if (lab_selected(filters, filter)) {
            result = write_filter(lab, filter, folder, image);
            sheet_add(sheet, image->data, image->width);
        }
    }
    return result == MNS_OK ? write_image(lab, &sheet->image, folder, lab_scene_name(lab->scene), ".png") : result;
}

mns_result lab_write_pictures(struct lab *lab, const struct lab_selection *selection, const char *folder)
{
    struct mns_image image = {.width = lab->settings.width, .height = lab->settings.height, .channels = CHANNELS, .pixel = MNS_PIXEL_U8};
    struct sheet sheet;
    int filters = 0;
    for (int i = 0; i < lab_filter_count(); i++) {
        filters += lab_selected(selection->filters, i);
    }
    image.data = malloc((size_t)image.width * (size_t)image.height * CHANNELS);
    mns_result result = sheet_create(&sheet, lab, filters) && image.data ? MNS_OK : lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    for (int scene = 0; result == MNS_OK && scene < lab_scene_count(); scene++) {
        if (lab_selected(selection->scenes, scene)) {
            result = lab_enter(lab, scene);
            result = result == MNS_OK ? write_scene(lab, selection->filters, folder, &image, &sheet) : result;
        }
    }
    free(image.data);
    free(sheet.image.data);
    return result;
}

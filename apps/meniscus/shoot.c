/* shoot.c: one picture of a sequence. */
#include "shoot.h"

#include "program.h"

#include <math.h>

/* Where in the sequence it is, t from frame to frame. */
static struct moment moment_at(const struct shooting *shooting, const struct shot *shot, double t)
{
    const struct input *input = &shooting->inputs->list[shot->input];
    double next = shot->input + 1 < shooting->inputs->count ? (double)input[1].number : (double)input->number + 1;
    return (struct moment){
        .index = (double)shot->input + t, .number = (double)input->number + t * (next - (double)input->number), .name = input->path};
}

static int prepare_motion(struct shooting *shooting, const struct mns_particles *from, const struct mns_particles *to)
{
    const struct options *options = shooting->drawing->options;
    shooting->motion = shooting->motion ? shooting->motion : motion_create();
    if (!shooting->motion) {
        return program_fail("out of memory");
    }
    return motion_between(shooting->motion, from, to, (double)options->retime * options->fps[1] / options->fps[0]);
}

static void add_times(struct mns_stats *stats, const struct mns_stats *more)
{
    stats->prepare_ms += more->prepare_ms;
    stats->draw_ms += more->draw_ms;
    for (int i = 0; i < stats->stage_count && i < more->stage_count; i++) {
        stats->stage_ms[i] += more->stage_ms[i];
    }
}

/* One of the samples: beauty goes to the shutter, the other layers are those of the sample in the middle. */
static int draw_sample(struct shooting *shooting, const struct shot *shot, int sample, struct picture *picture, size_t count,
                       struct mns_stats *stats)
{
    const struct options *options = shooting->drawing->options;
    struct mns_output images[OUTPUT_MAX];
    size_t used = 0;
    float white = INFINITY;
    for (size_t i = 0; i < count; i++) {
        bool beauty = picture->images[i].layer == MNS_LAYER_BEAUTY;
        if (beauty || sample == options->shutter_samples / 2) {
            images[used] = picture->images[i];
            white = beauty && images[used].image.pixel != MNS_PIXEL_F32 ? 1 : white;
            images[used].image = beauty ? shutter_image(shooting->shutter) : images[used].image;
            used++;
        }
    }
    double t = shot->fraction + shot->step * options->shutter * (sample + 0.5) / options->shutter_samples;
    struct moment moment = moment_at(shooting, shot, t < 1 ? t : 1);
    const struct mns_particles *particles = motion_at(shooting->motion, t < 1 ? t : 1);
    int status = particles ? draw_picture(shooting->drawing, particles, &moment, images, used, stats) : STATUS_FAILED;
    if (status == STATUS_DONE) {
        shutter_add(shooting->shutter, white);
    }
    return status;
}

static int draw_samples(struct shooting *shooting, const struct shot *shot, struct picture *picture, size_t count)
{
    const struct options *options = shooting->drawing->options;
    shooting->shutter = shooting->shutter ? shooting->shutter : shutter_create(options->width, options->height);
    if (!shooting->shutter) {
        return program_fail("--shutter: out of memory for %dx%d pixels", options->width, options->height);
    }
    shutter_open(shooting->shutter);
    for (int sample = 0; sample < options->shutter_samples; sample++) {
        struct mns_stats stats;
        int status = draw_sample(shooting, shot, sample, picture, count, &stats);
        if (status != STATUS_DONE) {
            return status;
        }
        if (sample == 0) {
            picture->stats = stats;
        } else {
            add_times(&picture->stats, &stats);
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (picture->images[i].layer == MNS_LAYER_BEAUTY) {
            shutter_close(shooting->shutter, &picture->images[i].image);
        }
    }
    return STATUS_DONE;
}

int shoot(struct shooting *shooting, const struct shot *shot, const struct mns_particles *from, const struct mns_particles *to, bool fresh,
          struct picture *picture, size_t count)
{
    bool moves = shot_moves(shot, shooting->drawing->options);
    int status = moves && fresh ? prepare_motion(shooting, from, to) : STATUS_DONE;
    if (status != STATUS_DONE) {
        return status;
    }
    if (shooting->drawing->options->shutter > 0) {
        status = draw_samples(shooting, shot, picture, count);
    } else {
        const struct mns_particles *particles = moves ? motion_at(shooting->motion, shot->fraction) : from;
        struct moment moment = moment_at(shooting, shot, shot->fraction);
        status = particles ? draw_picture(shooting->drawing, particles, &moment, picture->images, count, &picture->stats) : STATUS_FAILED;
    }
    if (status == STATUS_DONE) {
        struct moment moment = moment_at(shooting, shot, shot->fraction);
        status = draw_camera(shooting->drawing, &picture->stats, &moment, &picture->camera);
        draw_warn_if_empty(shooting->drawing, shooting->inputs->list[shot->input].path, &picture->stats);
    }
    return status;
}

void shoot_end(struct shooting *shooting)
{
    motion_destroy(shooting->motion);
    shutter_destroy(shooting->shutter);
}

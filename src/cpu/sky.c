/* sky.c: the colours of the sky and of the light, told once per picture. */
#include "cpu/sky.h"

#include "core/environment.h"

/* Linear radiance of a clear sky at midday, next to sunlit white of about 1.6: photographs have the zenith at a tenth to a fifth of that. */
static const float ZENITH[3] = {0.09f, 0.21f, 0.52f};
static const float HORIZON[3] = {0.56f, 0.68f, 0.84f};

/* Parts of the sun's light that the haze scatters about it. */
static const float GLOW_WIDE = 0.11f, GLOW_NARROW = 0.7f;

/* Ground that no floor covers: dry earth. */
static const float EARTH[3] = {0.20f, 0.19f, 0.17f};

/* Mean of the haze over the sky, weighted by the cosine to the zenith: integral of 2 h / (1 + 6 h)^2 over [0, 1]. */
static const float HAZE_MEAN = 0.0605f;
/* The same by the cosine to a horizontal direction: integral of 4 / pi sqrt(1 - h^2) / (1 + 6 h)^2 over [0, 1]. */
static const float HAZE_MEAN_SIDE = 0.1715f;

/* Part of the floor's area that joints between tiles take: two of FLOOR_JOINT per cell. */
static const float JOINTS = 1 - (1 - FLOOR_JOINT) * (1 - FLOOR_JOINT);

static float floor_albedo(const struct mns_params *params, int channel)
{
    float dark = params->floor_pattern == MNS_FLOOR_CHECKER ? 0.5f : params->floor_pattern == MNS_FLOOR_TILES ? JOINTS : 0;
    return params->floor_light[channel] + dark * (params->floor_dark[channel] - params->floor_light[channel]);
}

void mns_sky_resolve(struct sky *sky, const struct frame *frame)
{
    const struct scene_look *look = &frame->look;
    const struct mns_params *params = &frame->params;
    const struct mns_environment *environment = params->background == MNS_BACKGROUND_SKY ? frame->environment : NULL;
    sky_rotate(sky->up, frame->view.rotation, look->up);
    sky_rotate(sky->sun, frame->view.rotation, look->sun);
    float elevation_sine = look->sun[look->axis_up];
    for (int c = 0; c < 3; c++) {
        sky->zenith[c] = ZENITH[c];
        sky->horizon[c] = HORIZON[c];
        sky->sun_light[c] = look->sun_color[c];
        sky->sky_light[c] = ZENITH[c] + (HORIZON[c] - ZENITH[c]) * HAZE_MEAN;
        sky->glow_wide[c] = GLOW_WIDE * look->sun_color[c];
        sky->glow_narrow[c] = GLOW_NARROW * look->sun_color[c];
        if (environment) {
            sky->sky_light[c] = params->environment_intensity * environment->sky_light[c];
            sky->horizon[c] = sky->zenith[c] = params->environment_intensity * environment->horizon[c];
        }
        float albedo = look->has_floor ? floor_albedo(params, c) : EARTH[c];
        sky->ground[c] = environment && !look->has_floor ? params->environment_intensity * environment->ground_light[c]
                                                         : albedo * (look->sun_color[c] * elevation_sine + sky->sky_light[c]);
    }
}

void mns_cpu_light(const struct frame *frame, struct mns_light *out)
{
    const struct scene_look *look = &frame->look;
    struct sky sky;
    mns_sky_resolve(&sky, frame);
    for (int c = 0; c < 3; c++) {
        out->up[c] = (double)look->up[c];
        out->sun[c] = (double)look->sun[c];
        out->sun_light[c] = sky.sun_light[c];
        out->sky_light[c] = sky.sky_light[c];
        out->ground_light[c] = sky.ground[c];
        float side = frame->environment ? sky.sky_light[c] : sky.zenith[c] + (sky.horizon[c] - sky.zenith[c]) * HAZE_MEAN_SIDE;
        out->side_light[c] = 0.5f * (side + sky.ground[c]);
    }
    out->has_floor = look->has_floor;
    out->floor_height = (double)look->floor_height + frame->facts->origin[look->axis_up];
}

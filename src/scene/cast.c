/* cast.c: rays into the meshes: what they hit, in which light, and what the meshes keep from the floor.
 *
 * Four samples per pixel, sixteen where those differ. Each sends a ray towards the sun, and the first four also some into the sky about the normal: one in each
 * of the sixteen cells of a pattern, shifted so that any block of four by four pixels sends them into 256 cells. A second pass takes the mean over such a block
 * where it shows one surface. The same bytes for every number of threads. */
#include "scene/meshes.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { BASE = 4, SAMPLES = 16, SKY_RAYS = 4, ROWS_PER_JOB = 4 };

/* Where in the pixel the samples lie, in sixteenths: no two share a row or a column, and the first four stand for the rest. */
static const unsigned char OFFSETS[SAMPLES][2] = {{2, 5}, {10, 2}, {5, 13}, {13, 10}, {0, 1},  {1, 9},  {3, 14},  {4, 7},
                                                  {6, 4}, {7, 11}, {8, 15}, {9, 8},   {11, 6}, {12, 0}, {14, 12}, {15, 3}};
/* Base samples that differ by more than this in normal, albedo or facing see an edge. */
static const float EDGE_NORMAL = 0.02f, EDGE_ALBEDO = 0.02f, EDGE_FACING = 0.1f;
/* Part of the sun's light that comes into the shadow of other meshes by way of what stands about: as on the floor (cpu/objects.c). */
static const float BOUNCE = 0.15f;
/* Rays leave a surface by so much of the distance that it was reached over. */
static const float LIFT = 2e-5f;
/* What lies this far under the floor still shows, of the meshes' diagonal: the bottom of a tank that stands on it. */
static const float FLOOR_BIAS = 2e-3f;
/* The sky is hidden by what is nearer than this, of the meshes' diagonal. */
static const float OCCLUSION = 0.2f;
/* The sky's light is smoothed where normals have at least this cosine, and depths differ by no more than this part per pixel of a surface that faces the eye. */
static const float SAME_NORMAL = 0.95f, SAME_DEPTH = 0.02f;

enum kind { SEVERAL = -3, SKY = -2, FLOOR = -1 }; /* else the number of a slot */

struct caster {
    struct mns_meshes *meshes;
    const struct view *view;
    float up[3], sun[3], eye[3]; /* eye: of a perspective, in Embree's coordinates */
    float forward[3];
    float sun_light[3], sky_light[3], side_light[3], ground_light[3];
    float floor_height, floor_bias, occlusion_distance;
    bool has_floor;
    void (*row)(const struct caster *c, int y); /* what is done in this pass */
    atomic_int next;
};

struct sample {
    int kind;
    float t; /* depth, metres */
    float point[3], normal[3], albedo[3];
    float facing; /* cosine to the sun, less in shadow; of the floor 1 or 0 */
    float sky;    /* part of the sky that is seen; set for base samples */
};

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* out = transposed rotation * v: from image space to Embree's. */
static void to_space(const float rotation[9], const float v[3], float out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = rotation[i] * v[0] + rotation[3 + i] * v[1] + rotation[6 + i] * v[2];
    }
}

/* The ray through (x, y) in pixels; its parameter is depth. */
static void make_ray(const struct caster *c, float x, float y, float origin[3], float direction[3])
{
    const struct view *view = c->view;
    const float at[3] = {(x - view->cx) / view->fx, (y - view->cy) / view->fy, 1};
    if (!view->orthographic) {
        memcpy(origin, c->eye, sizeof(c->eye));
        to_space(view->rotation, at, direction);
        return;
    }
    const float start[3] = {at[0] - view->translation[0], at[1] - view->translation[1], -view->translation[2]};
    to_space(view->rotation, start, origin);
    memcpy(direction, c->forward, sizeof(c->forward));
}

/* The floor's depth along a ray, +inf where it is not met from above. */
static float floor_depth(const struct caster *c, const float origin[3], const float direction[3])
{
    float fall = dot(c->up, direction), gap = c->floor_height - dot(c->up, origin);
    return c->has_floor && fall < 0 && gap < 0 && gap / fall > 0 ? gap / fall : INFINITY;
}

static bool is_hidden(const struct caster *c, const float from[3], const float direction[3], float far)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    struct RTCRay ray = {.org_x = from[0],
                         .org_y = from[1],
                         .org_z = from[2],
                         .dir_x = direction[0],
                         .dir_y = direction[1],
                         .dir_z = direction[2],
                         .tnear = 0,
                         .tfar = far,
                         .mask = 0xffffffffu};
    rtcOccluded1(c->meshes->casters, &context, &ray);
    return ray.tfar < 0;
}

/* Where a ray starts that leaves the sample's surface. */
static void lift(const struct sample *s, const float away[3], float out[3])
{
    float reach = fmaxf(fmaxf(fabsf(s->point[0]), fabsf(s->point[1])), fmaxf(fabsf(s->point[2]), s->t));
    for (int i = 0; i < 3; i++) {
        out[i] = s->point[i] + LIFT * reach * away[i];
    }
}

/* ---- surfaces ---- */

static void interpolate(const float *values, const uint32_t corners[3], size_t size, const float weights[3], float *out)
{
    for (size_t c = 0; c < size; c++) {
        out[c] = weights[0] * values[size * corners[0] + c] + weights[1] * values[size * corners[1] + c] +
                 weights[2] * values[size * corners[2] + c];
    }
}

/* Texels along one metre of the triangle. */
static float texel_density(const struct mesh *mesh, const struct texture *texture, const uint32_t corners[3], float double_area)
{
    const float *a = mesh->uv + 2 * corners[0], *b = mesh->uv + 2 * corners[1], *c = mesh->uv + 2 * corners[2];
    float uv = fabsf((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    return sqrtf(uv * (float)texture->width[0] * (float)texture->height[0] / fmaxf(double_area, 1e-30f));
}

/* What a mesh looks like where it is hit. footprint: metres across which one sample stands for. */
static void surface(const struct slot *slot, const struct RTCHit *hit, float footprint, const float geometric[3], float double_area,
                    struct sample *out)
{
    const struct mesh *mesh = &slot->mesh;
    const uint32_t *corners = mesh->triangle + 3 * (size_t)hit->primID;
    const struct material *material = &mesh->materials[mesh->material_of[hit->primID]];
    const float weights[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    interpolate(mesh->normal, corners, 3, weights, out->normal);
    float length = sqrtf(dot(out->normal, out->normal));
    for (int c = 0; c < 3; c++) {
        out->normal[c] = length > 0.1f ? out->normal[c] / length : geometric[c];
        out->albedo[c] = material->color[c];
    }
    if (mesh->color) {
        float color[3];
        interpolate(mesh->color, corners, 3, weights, color);
        for (int c = 0; c < 3; c++) {
            out->albedo[c] *= color[c];
        }
    }
    if (material->texture >= 0 && mesh->uv) {
        const struct texture *texture = &mesh->textures[material->texture];
        float uv[2], color[3];
        interpolate(mesh->uv, corners, 2, weights, uv);
        mns_texture_at(texture, uv[0], uv[1], log2f(fmaxf(footprint * texel_density(mesh, texture, corners, double_area), 1e-6f)), color);
        for (int c = 0; c < 3; c++) {
            out->albedo[c] *= color[c];
        }
    }
}

/* The mesh that a ray hits, both sides of its faces alike. */
static void meet_mesh(const struct caster *c, const struct RTCRayHit *hit, const float direction[3], float samples, struct sample *out)
{
    const struct slot *slot = &c->meshes->slots[hit->hit.geomID];
    float geometric[3] = {hit->hit.Ng_x, hit->hit.Ng_y, hit->hit.Ng_z}, double_area = sqrtf(dot(geometric, geometric));
    float speed = sqrtf(dot(direction, direction)), side = dot(geometric, direction) > 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        geometric[i] *= side / fmaxf(double_area, 1e-30f);
    }
    float footprint = (c->view->orthographic ? 1 : out->t) / c->view->fx / sqrtf(samples);
    footprint /= sqrtf(fmaxf(-dot(geometric, direction) / speed, 0.05f)); /* between the pixel's width and its length on the surface */
    out->kind = (int)hit->hit.geomID;
    surface(slot, &hit->hit, footprint, geometric, double_area, out);
    if (dot(out->normal, geometric) < 0) {
        for (int i = 0; i < 3; i++) {
            out->normal[i] = -out->normal[i];
        }
    }
    float cosine = dot(out->normal, c->sun), from[3];
    bool lit = cosine > 0 && dot(geometric, c->sun) > 0;
    if (slot->container) { /* light passes its walls: they throw no shadow either */
        cosine = fabsf(cosine);
        lit = true;
    }
    out->facing = 0;
    if (lit) {
        lift(out, geometric, from);
        out->facing = is_hidden(c, from, c->sun, INFINITY) ? BOUNCE * cosine : cosine;
    }
}

static void meet_floor(const struct caster *c, struct sample *out)
{
    float from[3];
    out->kind = FLOOR;
    memcpy(out->normal, c->up, sizeof(c->up));
    lift(out, c->up, from);
    out->facing = is_hidden(c, from, c->sun, INFINITY) ? 0 : 1;
}

static struct RTCRayHit first_hit(const struct caster *c, const float origin[3], const float direction[3], float far)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit hit = {.ray = {.org_x = origin[0],
                                    .org_y = origin[1],
                                    .org_z = origin[2],
                                    .dir_x = direction[0],
                                    .dir_y = direction[1],
                                    .dir_z = direction[2],
                                    .tnear = c->view->near_plane,
                                    .tfar = far,
                                    .mask = 0xffffffffu},
                            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    rtcIntersect1(c->meshes->all, &context, &hit);
    return hit;
}

/* How far a ray sees: to the far plane, or a little under the floor. */
static float sight(const struct caster *c, const float direction[3], float floor)
{
    float fall = -dot(c->up, direction);
    return fminf(c->view->far_plane, floor < INFINITY ? floor + c->floor_bias / fmaxf(fall, 1e-3f) : INFINITY);
}

static struct sample cast(const struct caster *c, float x, float y, float samples)
{
    float origin[3], direction[3];
    make_ray(c, x, y, origin, direction);
    float floor = floor_depth(c, origin, direction);
    struct RTCRayHit hit = first_hit(c, origin, direction, sight(c, direction, floor));
    struct sample out = {.kind = SKY, .sky = 1, .facing = 1, .t = hit.ray.tfar};
    bool meets = hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    if (!meets) {
        out.t = floor < c->view->far_plane ? floor : INFINITY;
    }
    for (int i = 0; i < 3 && out.t < INFINITY; i++) {
        out.point[i] = origin[i] + out.t * direction[i];
    }
    if (meets) {
        meet_mesh(c, &hit, direction, samples, &out);
    } else if (out.t < INFINITY) {
        meet_floor(c, &out);
    }
    return out;
}

/* ---- the sky's light ---- */

/* Two axes at right angles to a unit vector (Duff and others 2017). */
static void tangents(const float n[3], float a[3], float b[3])
{
    float sign = n[2] < 0 ? -1.0f : 1.0f, p = -1 / (sign + n[2]), q = n[0] * n[1] * p;
    a[0] = 1 + sign * n[0] * n[0] * p;
    a[1] = sign * q;
    a[2] = -sign * n[0];
    b[0] = q;
    b[1] = sign + n[1] * n[1] * p;
    b[2] = -n[1];
}

/* The part of the sky about the normal that a base sample sees, weighted by the cosine: its rays are four of the pixel's sixteen. */
static float sky_seen(const struct caster *c, const struct sample *s, int sample, int x_pixel, int y_pixel)
{
    static const float shifts[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}}; /* Bayer's */
    float a[3], b[3], from[3], shift_u = ((float)(x_pixel & 3) + 0.5f) / 4, shift_v = (shifts[y_pixel & 3][x_pixel & 3] + 0.5f) / 16;
    int seen = 0;
    tangents(s->normal, a, b);
    lift(s, s->normal, from);
    for (int i = 0; i < SKY_RAYS; i++) {
        float u = ((float)((sample + i) % 4) + shift_u) / 4, v = ((float)i + shift_v) / 4;
        float radius = sqrtf(v), angle = 6.2831853f * u, x = radius * cosf(angle), y = radius * sinf(angle), z = sqrtf(fmaxf(1 - v, 0));
        const float direction[3] = {x * a[0] + y * b[0] + z * s->normal[0], x * a[1] + y * b[1] + z * s->normal[1],
                                    x * a[2] + y * b[2] + z * s->normal[2]};
        seen += !is_hidden(c, from, direction, c->occlusion_distance);
    }
    return (float)seen / SKY_RAYS;
}

/* ---- pixels ---- */

static bool differ(const struct sample *a, const struct sample *b)
{
    if (a->kind != b->kind || fabsf(a->facing - b->facing) > EDGE_FACING) {
        return true;
    }
    float albedo = 0;
    for (int i = 0; i < 3; i++) {
        albedo = fmaxf(albedo, fabsf(a->albedo[i] - b->albedo[i]));
    }
    return a->kind >= 0 && (1 - dot(a->normal, b->normal) > EDGE_NORMAL || albedo > EDGE_ALBEDO);
}

struct sum {
    int count, hits, floors;
    float color[3], sunlit[3], reach, floor_sun, floor_sky;
};

static void add(const struct caster *c, struct sum *sum, const struct sample *s)
{
    sum->count++;
    if (s->kind == FLOOR) {
        sum->floors++;
        sum->floor_sun += s->facing;
        sum->floor_sky += s->sky;
    }
    if (s->kind < 0) {
        return;
    }
    float up = dot(s->normal, c->up);
    sum->hits++;
    sum->reach += s->t;
    for (int i = 0; i < 3; i++) {
        /* The parabola through what faces up, sideways and down. */
        float sky = c->sky_light[i], side = c->side_light[i], ground = c->ground_light[i];
        sum->color[i] += s->albedo[i] * s->sky * (side + up * (0.5f * (sky - ground) + up * (0.5f * (sky + ground) - side)));
        sum->sunlit[i] += s->albedo[i] * s->facing * c->sun_light[i];
    }
}

static struct mns_object_pixel mean(const struct sum *sum, float depth)
{
    float scale = 1 / (float)sum->count, floors = (float)(sum->floors > 0 ? sum->floors : 1);
    struct mns_object_pixel out = {.depth = depth, .reach = sum->hits ? sum->reach / (float)sum->hits : INFINITY};
    for (int i = 0; i < 3; i++) {
        out.color[i] = sum->color[i] * scale;
        out.sunlit[i] = sum->sunlit[i] * scale;
    }
    out.color[3] = (float)sum->hits * scale;
    out.floor_sun = sum->floors ? sum->floor_sun / floors : 1;
    out.floor_sky = sum->floors ? sum->floor_sky / floors : 1;
    return out;
}

static struct mns_object_pixel draw_pixel(const struct caster *c, int x, int y, struct guide *guide)
{
    struct sample samples[SAMPLES];
    int count = BASE;
    float sky = 0, known = 0;
    for (int i = 0; i < count; i++) {
        struct sample *s = &samples[i];
        *s = cast(c, (float)x + ((float)OFFSETS[i][0] + 0.5f) / SAMPLES, (float)y + ((float)OFFSETS[i][1] + 0.5f) / SAMPLES, BASE);
        if (i < BASE && s->kind != SKY && c->meshes->params.occlusion) {
            s->sky = sky_seen(c, s, i, x, y);
            sky += s->sky;
            known++;
        }
        for (int k = 0; i == BASE - 1 && k < i && count == BASE; k++) {
            count = differ(s, &samples[k]) ? SAMPLES : BASE;
        }
    }
    *guide = (struct guide){.kind = samples[0].kind, .t = samples[0].t, .sky = known > 0 ? sky / known : 1};
    memcpy(guide->normal, samples[0].normal, sizeof(guide->normal));
    struct sum sum = {.count = 0};
    for (int i = 0; i < count; i++) {
        guide->kind = samples[i].kind == guide->kind ? guide->kind : SEVERAL;
        samples[i].sky = i < BASE ? samples[i].sky : guide->sky;
    }
    for (int i = 0; i < count; i++) {
        samples[i].sky = guide->kind == SEVERAL ? samples[i].sky : 1; /* else it comes when it is smooth */
        add(c, &sum, &samples[i]);
    }
    struct sample centre = {.kind = SKY, .t = INFINITY};
    if (sum.hits) {
        centre = cast(c, (float)x + 0.5f, (float)y + 0.5f, BASE);
    }
    return mean(&sum, centre.kind >= 0 ? centre.t : INFINITY);
}

static void draw_row(const struct caster *c, int y)
{
    int width = c->view->width;
    size_t first = (size_t)y * (size_t)width;
    for (int x = 0; x < width; x++) {
        c->meshes->pixels[first + (size_t)x] = draw_pixel(c, x, y, &c->meshes->guides[first + (size_t)x]);
    }
}

/* The mean part of the sky over the pixels about one that show the same surface: each of the 16 shifts of the rays once. */
static float smooth_sky(const struct caster *c, int x, int y)
{
    static const float weights[5] = {0.5f, 1, 1, 1, 0.5f};
    int width = c->view->width, height = c->view->height;
    const struct guide *own = c->meshes->guides + (size_t)y * (size_t)width + (size_t)x;
    float sum = 0, weight = 0, apart = SAME_DEPTH * (c->view->orthographic ? 1 : own->t);
    for (int j = -2; j <= 2; j++) {
        for (int i = -2; i <= 2; i++) {
            if (x + i < 0 || y + j < 0 || x + i >= width || y + j >= height) {
                continue;
            }
            const struct guide *other = own + j * width + i;
            if (other->kind == own->kind && dot(other->normal, own->normal) > SAME_NORMAL && fabsf(other->t - own->t) <= apart) {
                sum += weights[i + 2] * weights[j + 2] * other->sky;
                weight += weights[i + 2] * weights[j + 2];
            }
        }
    }
    return sum / weight;
}

static void finish_row(const struct caster *c, int y)
{
    int width = c->view->width, begin = width, end = 0;
    struct mns_object_pixel *row = c->meshes->pixels + (size_t)y * (size_t)width;
    for (int x = 0; x < width; x++) {
        int kind = c->meshes->guides[(size_t)y * (size_t)width + (size_t)x].kind;
        float sky = kind >= FLOOR ? smooth_sky(c, x, y) : 1;
        for (int i = 0; i < 3 && kind >= 0; i++) {
            row[x].color[i] *= sky;
        }
        row[x].floor_sky = kind == FLOOR ? sky : row[x].floor_sky;
        if (row[x].color[3] > 0 || row[x].floor_sun < 1 || row[x].floor_sky < 1) {
            begin = x < begin ? x : begin;
            end = x + 1;
        }
    }
    c->meshes->spans[2 * y] = begin < end ? begin : 0;
    c->meshes->spans[2 * y + 1] = end;
}

static void run_rows(void *context, int index)
{
    (void)index;
    struct caster *c = context;
    for (;;) {
        int begin = atomic_fetch_add(&c->next, ROWS_PER_JOB);
        if (begin >= c->view->height) {
            return;
        }
        for (int y = begin; y < begin + ROWS_PER_JOB && y < c->view->height; y++) {
            c->row(c, y);
        }
    }
}

void mns_meshes_cast(struct mns_meshes *meshes, const struct view *view, const struct mns_light *light)
{
    struct caster c = {.meshes = meshes, .view = view, .has_floor = light->has_floor != 0};
    double floor_height = light->floor_height, diagonal2 = 0;
    const float back[3] = {-view->translation[0], -view->translation[1], -view->translation[2]}, forward[3] = {0, 0, 1};
    for (int i = 0; i < 3; i++) {
        double side = meshes->bounds_max[i] - meshes->bounds_min[i];
        diagonal2 += side * side;
        floor_height -= light->up[i] * meshes->origin[i];
        c.up[i] = (float)light->up[i];
        c.sun[i] = (float)light->sun[i];
        c.sun_light[i] = light->sun_light[i];
        c.sky_light[i] = light->sky_light[i];
        c.side_light[i] = light->side_light[i];
        c.ground_light[i] = light->ground_light[i];
    }
    float diagonal = (float)sqrt(diagonal2), given = (float)meshes->params.occlusion_distance;
    c.floor_height = (float)floor_height;
    c.floor_bias = FLOOR_BIAS * diagonal;
    c.occlusion_distance = given > 0 ? given : OCCLUSION * diagonal;
    to_space(view->rotation, back, c.eye);
    to_space(view->rotation, forward, c.forward);
    c.row = draw_row;
    meshes->params.parallel.run(meshes->params.parallel.user, run_rows, &c, meshes->params.threads);
    c.row = finish_row;
    c.next = 0;
    meshes->params.parallel.run(meshes->params.parallel.user, run_rows, &c, meshes->params.threads);
}

// trace_path.c: radiance by paths from the eye (Kajiya 1986).
// Data in: a TraceScene. Data out: radiance a pixel, the encoded picture. Called by: reference.c,
// bench_gi.c, tests. Does not: keep anything between pictures.
//
// At each surface: every lamp (all of them while they are few, else a few by their brightness), one
// point of a surface that shines, and one way on. A shining surface that such a way meets by itself
// is weighed against the point that was chosen (balance heuristic, Veach 1997). What reflects is
// brdf() of shaders/light.glsl, so that direct light is the engine's own.
#include "trace.h"
#include "../engine/base/jobs.h"
#include "../engine/base/random.h"
#include <string.h>

#define TILE_PX       8
#define TILES_A_BATCH 64 // a thread; progress is told between batches
#define ALL_LAMPS     8  // more are chosen among
#define CHOSEN_LAMPS  4
#define START_OFFSET  1e-4f // of the distances at hand, and metres
#define SURE_BOUNCES  3     // afterwards faint paths may end
// Ways are also drawn towards the surroundings of lamps, where the brightest surfaces are, if there
// are few enough of them.
#define GUIDES_CAP   8
#define GUIDE_SHARE  0.3f
#define GUIDE_REACH2 0.5f       // m2
enum { LOBE_NONE, LOBE_PHONG }; // Brdf of world/components.h

typedef struct Path {
    const TraceScene *scene;
    const TraceOptions *options;
    u64 seed; // of the pixel
    u32 sample;
    u32 counter;             // random numbers used
    struct LampLight *lamps; // [all lights], of this thread
    const Vec3 *guides;
    u32 guide_count;
} Path;
typedef struct LampLight {
    f32 color[3], weight;
    Vec3 to; // not unit: ends at the lamp
    f32 t_max;
} LampLight;

static f32 draw(Path *path) { return random_f32(path->seed, path->sample, path->counter++); }

// The first numbers of a sample fill the square evenly: an additive lattice (Roberts 2018, "The
// unreasonable effectiveness of quasirandom sequences"), shifted by the pixel.
static f32 draw_lattice(const Path *path, u32 dimension) {
    static const f64 steps[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                 0.5385972572236101};
    f64 x = random_f32(path->seed, 0x1A77, dimension) + steps[dimension] * path->sample;
    return MIN((f32)(x - floor(x)), 0.9999999f);
}

static f32 sum3(const f32 v[3]) { return v[0] + v[1] + v[2]; }

static void make_basis(Vec3 n, Vec3 *t, Vec3 *b) { // Duff et al. 2017
    f32 sign = n.z >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + n.z), c = n.x * n.y * a;
    *t = vec3(1.0f + sign * n.x * n.x * a, sign * c, -sign * n.x);
    *b = vec3(c, sign + n.y * n.y * a, -n.y);
}
static Vec3 around(Vec3 n, f32 cosine, f32 turn) {
    Vec3 t, b;
    make_basis(n, &t, &b);
    f32 sine = sqrtf(MAX(1.0f - cosine * cosine, 0.0f)), angle = 2.0f * PI_F * turn;
    return vec3_add(vec3_scale(n, cosine), vec3_add(vec3_scale(t, sine * det_cos(angle)),
                                                    vec3_scale(b, sine * det_sin(angle))));
}

// --- What reflects ---

typedef struct Shade {
    const TraceSurface *s;
    Vec3 view;
    f32 n_dot_v, specular[3], power, fresnel, diffuse_share;
    bool exact, has_lobe, phong;
} Shade;

static Shade shade_make(const Path *path, const TraceSurface *s, Vec3 view, bool lobe) {
    const MaterialRecord *m = s->material;
    Shade shade = {.s = s,
                   .view = view,
                   .n_dot_v = MAX(vec3_dot(s->normal, view), 1e-4f),
                   .power = m->specular[3],
                   .fresnel = m->extra[0],
                   .exact = path->scene->packet->settings.specular == SPECULAR_EXACT,
                   .has_lobe = lobe && m->lobes[0] != (f32)LOBE_NONE,
                   .phong = (u32)m->lobes[0] == LOBE_PHONG};
    for (u32 k = 0; k < 3; k++) shade.specular[k] = m->specular[k];
    f32 diffuse = sum3(s->albedo), specular = shade.has_lobe ? sum3(shade.specular) : 0.0f;
    if (shade.has_lobe && shade.fresnel > 0.0f) specular = MAX(specular, 0.3f);
    shade.diffuse_share = diffuse + specular > 0.0f ? diffuse / (diffuse + specular) : 1.0f;
    if (shade.has_lobe) shade.diffuse_share = CLAMP(shade.diffuse_share, 0.1f, 0.9f);
    return shade;
}

static f32 lobe_power(const Shade *shade, f32 cosine, f32 length2) { // specular_power
    f32 c = MAX(cosine, 0.0f);
    if (shade->exact) return det_pow(MAX(c / sqrtf(length2), 1e-6f), shade->power);
    return det_exp(shade->power * ((c * c - length2) / (c * c + length2)));
}

static void brdf(const Shade *shade, Vec3 l, f32 n_dot_l, f32 highlight, f32 out[3]) {
    const f32 *lobes = shade->s->material->lobes;
    f32 c = vec3_dot(l, shade->view) - n_dot_l * shade->n_dot_v;
    f32 t = c > 0.0f ? MAX(n_dot_l, shade->n_dot_v) : 1.0f;
    f32 diffuse = (lobes[2] + lobes[3] * c / MAX(t, 1e-4f)) / PI_F;
    for (u32 k = 0; k < 3; k++) out[k] = shade->s->albedo[k] * diffuse;
    if (!shade->has_lobe) return;
    Vec3 h = vec3_add(shade->view, l);
    f32 length2 = MAX(vec3_dot(h, h), 1e-12f), x2 = length2, cosine = vec3_dot(shade->s->normal, h);
    if (shade->phong) {
        cosine =
            2.0f * n_dot_l * vec3_dot(shade->s->normal, shade->view) - vec3_dot(l, shade->view);
        x2 = 1.0f;
    }
    f32 lobe = highlight * lobe_power(shade, cosine, x2) * lobes[1];
    f32 x = 1.0f - CLAMP(vec3_dot(shade->view, h) / sqrtf(length2), 0.0f, 1.0f);
    f32 f = x * x * x * x * x * shade->fresnel;
    for (u32 k = 0; k < 3; k++)
        out[k] += (shade->specular[k] + (1.0f - shade->specular[k]) * f) * lobe;
}

// --- The way on ---

// Density of choose_lobe_way: a mixture of the diffuse and the specular lobe.
static f32 lobe_density(const Shade *shade, Vec3 l) {
    f32 n_dot_l = vec3_dot(shade->s->normal, l);
    f32 density = n_dot_l > 0.0f ? shade->diffuse_share * n_dot_l / PI_F : 0.0f;
    if (!shade->has_lobe) return density;
    f32 rest = (1.0f - shade->diffuse_share) * (shade->power + 1.0f) / (2.0f * PI_F);
    if (shade->phong) {
        Vec3 mirrored =
            vec3_sub(vec3_scale(shade->s->normal, 2.0f * vec3_dot(shade->s->normal, shade->view)),
                     shade->view);
        f32 cosine = vec3_dot(mirrored, l);
        return density + (cosine > 0.0f ? rest * det_pow(cosine, shade->power) : 0.0f);
    }
    Vec3 h = vec3_normalize(vec3_add(shade->view, l));
    f32 cosine = vec3_dot(shade->s->normal, h), v_dot_h = vec3_dot(shade->view, h);
    if (!(cosine > 0.0f && v_dot_h > 0.0f)) return density;
    return density + rest * det_pow(cosine, shade->power) / (4.0f * v_dot_h);
}

static Vec3 choose_lobe_way(const Shade *shade, f32 lobe, f32 x, f32 y) {
    if (!shade->has_lobe || lobe < shade->diffuse_share)
        return around(shade->s->normal, sqrtf(1.0f - x), y);
    f32 cosine = det_pow(MAX(1.0f - x, 1e-12f), 1.0f / (shade->power + 1.0f));
    Vec3 n = shade->s->normal;
    if (shade->phong) {
        Vec3 mirrored = vec3_sub(vec3_scale(n, 2.0f * vec3_dot(n, shade->view)), shade->view);
        return around(mirrored, cosine, y);
    }
    Vec3 h = around(n, cosine, y);
    return vec3_sub(vec3_scale(h, 2.0f * vec3_dot(h, shade->view)), shade->view);
}

// Cosine of the cone about a guide as a point sees it.
static f32 guide_cone(const Shade *shade, Vec3 guide, Vec3 *axis) {
    Vec3 to = vec3_sub(guide, shade->s->position);
    f32 d2 = vec3_dot(to, to);
    *axis = vec3_normalize(to);
    return sqrtf(d2 / (d2 + GUIDE_REACH2));
}

// Density of choose_way.
static f32 way_density(const Path *path, const Shade *shade, Vec3 l) {
    f32 density = lobe_density(shade, l), guided = 0.0f;
    if (path->guide_count == 0) return density;
    for (u32 i = 0; i < path->guide_count; i++) {
        Vec3 axis;
        f32 cosine = guide_cone(shade, path->guides[i], &axis);
        if (vec3_dot(axis, l) >= cosine) guided += 1.0f / (2.0f * PI_F * (1.0f - cosine + 1e-6f));
    }
    return f32_lerp(density, guided / (f32)path->guide_count, GUIDE_SHARE);
}

static Vec3 choose_way(Path *path, const Shade *shade, f32 x, f32 y) {
    f32 which = draw(path);
    if (path->guide_count == 0) return choose_lobe_way(shade, which, x, y);
    if (which >= GUIDE_SHARE)
        return choose_lobe_way(shade, (which - GUIDE_SHARE) / (1.0f - GUIDE_SHARE), x, y);
    u32 guide = MIN((u32)(which / GUIDE_SHARE * (f32)path->guide_count), path->guide_count - 1);
    Vec3 axis;
    f32 cosine = guide_cone(shade, path->guides[guide], &axis);
    return around(axis, 1.0f - x * (1.0f - cosine + 1e-6f), y);
}

// --- Lamps ---

static f32 attenuation(const Packet *packet, f32 d2, f32 inverse_range2) { // light.glsl
    f32 x = d2 * inverse_range2, inv_d = 1.0f / sqrtf(d2);
    if (packet->attenuation == 1) return CLAMP(1.0f - x, 0.0f, 1.0f);
    if (packet->attenuation == 2) {
        const f32 *k = packet->frame.attenuation;
        return CLAMP(1.0f - x, 0.0f, 1.0f) / (k[0] + k[1] * (d2 * inv_d) + k[2] * d2);
    }
    f32 window = CLAMP(1.0f - x * x, 0.0f, 1.0f);
    return window * window * MIN(inv_d * inv_d, 1e4f);
}

// What a lamp would add; false = nothing.
static bool lamp_light(const Path *path, const Shade *shade, const TraceLight *light,
                       LampLight *out) {
    Vec3 l = light->direction;
    f32 falloff = 1.0f;
    out->to = l;
    out->t_max = 1e30f;
    if (light->kind != 2) {
        out->to = vec3_sub(light->position, shade->s->position);
        out->t_max = 1.0f - START_OFFSET;
        f32 d2 = MAX(vec3_dot(out->to, out->to), 1e-8f);
        if (d2 * light->inverse_range2 >= 1.0f) return false;
        l = vec3_scale(out->to, 1.0f / sqrtf(d2));
        falloff = attenuation(path->scene->packet, d2, light->inverse_range2);
    }
    f32 n_dot_l = vec3_dot(shade->s->normal, l);
    if (n_dot_l <= 0.0f) return false;
    if (light->kind == 1) {
        f32 t = CLAMP((-vec3_dot(l, light->direction) - light->cos_outer) * light->edge, 0, 1);
        falloff *= t * t * (3.0f - 2.0f * t);
    }
    brdf(shade, l, n_dot_l, light->highlight, out->color);
    for (u32 k = 0; k < 3; k++) out->color[k] *= light->color[k] * falloff * n_dot_l;
    out->weight = sum3(out->color);
    return out->weight > 0.0f;
}

// Rays start a little off the surface, on the side that they leave to.
static Vec3 start_point(const TraceSurface *s, Vec3 to) {
    Vec3 p = s->position;
    f32 size = MAX(MAX(fabsf(p.x), fabsf(p.y)), MAX(fabsf(p.z), 1.0f)) * START_OFFSET;
    return vec3_add(p, vec3_scale(s->face, vec3_dot(s->face, to) >= 0.0f ? size : -size));
}

static bool lamp_is_seen(const Path *path, const TraceSurface *s, const LampLight *lamp) {
    Vec3 from = start_point(s, lamp->to), to = lamp->to;
    // The ray to a lamp ends there, wherever it starts.
    if (lamp->t_max < 1e30f) to = vec3_sub(vec3_add(s->position, lamp->to), from);
    return !trace_blocked(path->scene, from, to, lamp->t_max, TRACE_SHADOWS);
}

static void add_lamps(Path *path, const Shade *shade, const TraceLight *lights, u32 count,
                      const f32 factor[3], f32 out[3]) {
    TraceShadows shadows = path->options->shadows;
    u32 kept = 0;
    f32 sum = 0.0f;
    for (u32 i = 0; i < count; i++) {
        LampLight *lamp = &path->lamps[kept];
        if (!lamp_light(path, shade, &lights[i], lamp)) continue;
        bool shadowed =
            shadows == TRACE_SHADOWS_ALL || (shadows == TRACE_SHADOWS_LEVEL && lights[i].shadowed);
        if (shadowed) {
            kept++;
            sum += lamp->weight;
        } else {
            for (u32 k = 0; k < 3; k++) out[k] += factor[k] * lamp->color[k];
        }
    }
    if (kept <= ALL_LAMPS) {
        for (u32 i = 0; i < kept; i++)
            if (lamp_is_seen(path, shade->s, &path->lamps[i]))
                for (u32 k = 0; k < 3; k++) out[k] += factor[k] * path->lamps[i].color[k];
        return;
    }
    for (u32 n = 0; n < CHOSEN_LAMPS; n++) {
        f32 at = ((f32)n + draw(path)) / CHOSEN_LAMPS * sum, before = 0.0f;
        u32 i = 0;
        while (i + 1 < kept && before + path->lamps[i].weight <= at)
            before += path->lamps[i++].weight;
        const LampLight *lamp = &path->lamps[i];
        if (!lamp_is_seen(path, shade->s, lamp)) continue;
        f32 scale = sum / (lamp->weight * CHOSEN_LAMPS);
        for (u32 k = 0; k < 3; k++) out[k] += factor[k] * lamp->color[k] * scale;
    }
}

// --- Surfaces that shine ---

// Chance of an emitter times the density over its area.
static f32 emitter_density(const TraceScene *scene, u32 emitter) {
    const TraceEmitter *e = &scene->emitters[emitter];
    f32 below = emitter ? scene->emitters[emitter - 1].cumulative : 0.0f;
    return (e->cumulative - below) / e->area;
}

static u32 choose_emitter(const TraceScene *scene, f32 at) {
    u32 low = 0, high = scene->emitter_count - 1;
    while (low < high) {
        u32 mid = (low + high) / 2;
        if (scene->emitters[mid].cumulative > at)
            high = mid;
        else
            low = mid + 1;
    }
    return low;
}

static void add_emitter(Path *path, const Shade *shade, f32 x, f32 y, const f32 factor[3],
                        f32 out[3]) {
    const TraceScene *scene = path->scene;
    u32 emitter = choose_emitter(scene, draw(path));
    const TraceTriangle *t = &scene->triangles[scene->emitters[emitter].triangle];
    f32 root = sqrtf(x), u = root * (1.0f - y), v = root * y;
    Vec3 edge1 = {t->edge1[0], t->edge1[1], t->edge1[2]};
    Vec3 edge2 = {t->edge2[0], t->edge2[1], t->edge2[2]};
    Vec3 point = vec3_add(vec3(t->corner[0], t->corner[1], t->corner[2]),
                          vec3_add(vec3_scale(edge1, u), vec3_scale(edge2, v)));
    Vec3 to = vec3_sub(point, shade->s->position);
    f32 d2 = MAX(vec3_dot(to, to), 1e-8f), inv_d = 1.0f / sqrtf(d2);
    Vec3 l = vec3_scale(to, inv_d), n = vec3_normalize(vec3_cross(edge1, edge2));
    f32 n_dot_l = vec3_dot(shade->s->normal, l), cosine = -vec3_dot(n, l);
    bool two_sided = scene->bindings[scene->instances[t->instance].material].double_sided != 0;
    if (two_sided) cosine = fabsf(cosine);
    if (n_dot_l <= 0.0f || cosine <= 1e-5f) return;
    Vec3 from = start_point(shade->s, to);
    if (trace_blocked(scene, from, vec3_sub(point, from), 1.0f - 4.0f * START_OFFSET,
                      TRACE_BOUNCES))
        return;
    f32 emission[3], reflected[3];
    trace_emission(scene, scene->emitters[emitter].triangle, u, v, emission);
    brdf(shade, l, n_dot_l, 1.0f, reflected);
    f32 density = emitter_density(scene, emitter) * d2 / cosine;
    f32 weight = n_dot_l / (density + way_density(path, shade, l));
    for (u32 k = 0; k < 3; k++) out[k] += factor[k] * reflected[k] * emission[k] * weight;
}

// Weight of a shining surface that a way of density `density` met by itself.
static f32 met_weight(const TraceScene *scene, const TraceHit *hit, Vec3 to, Vec3 face,
                      f32 density) {
    u32 emitter = scene->emitter_of[hit->triangle];
    if (emitter == UINT32_MAX) return 1.0f;
    f32 cosine = MAX(-vec3_dot(face, to), 1e-5f);
    f32 other = emitter_density(scene, emitter) * hit->t * hit->t / cosine;
    return density / (density + other);
}

// --- Paths ---

static void sky(const Packet *packet, Vec3 to, f32 factor, const f32 scale[3], f32 out[3]) {
    f32 up = sqrtf(CLAMP(to.y, 0.0f, 1.0f));
    for (u32 k = 0; k < 3; k++)
        out[k] += scale[k] * factor *
                  f32_lerp(packet->frame.sky_horizon[k], packet->frame.sky_zenith[k], up);
}

// pixel_m: width of a pixel a metre away.
static void trace_path(Path *path, Vec3 from, Vec3 to, f32 pixel_m, f32 out[3]) {
    const TraceScene *scene = path->scene;
    const TraceOptions *o = path->options;
    f32 factor[3] = {1, 1, 1}, density = 0.0f, length = 0.0f;
    for (u32 depth = 0;; depth++) {
        TraceHit hit = trace_nearest(scene, from, to, 1e30f, depth ? TRACE_BOUNCES : 0);
        if (hit.triangle == UINT32_MAX) {
            sky(scene->packet, to, depth ? o->sky : 1.0f, factor, out);
            return;
        }
        length += hit.t;
        TraceSurface s = trace_surface(scene, &hit, from, to, length * pixel_m);
        f32 met = depth ? met_weight(scene, &hit, to, s.face, density) : 1.0f;
        for (u32 k = 0; k < 3; k++) out[k] += factor[k] * s.emission[k] * met;
        if (depth == 0)
            for (u32 k = 0; k < 3; k++)
                out[k] += s.albedo[k] * scene->packet->frame.ambient[k] * o->ambient;
        // A back that has no front: walls end light, and send none.
        bool lit = s.material->emissive[3] > 0.0f;
        if (!lit ||
            (depth && !s.front &&
             !scene->bindings[scene->instances[scene->triangles[hit.triangle].instance].material]
                  .double_sided))
            return;
        Vec3 view = vec3_scale(to, -1.0f);
        Shade direct = shade_make(path, &s, view, o->specular || (o->highlights && depth == 0));
        const TraceLight *lights = depth ? scene->far_lights : scene->seen_lights;
        add_lamps(path, &direct, lights, depth ? scene->far_count : scene->seen_count, factor, out);
        if (depth == o->bounces) return;
        Shade shade = shade_make(path, &s, view, o->specular);
        if (scene->emitter_count) {
            f32 x = depth ? draw(path) : draw_lattice(path, 2);
            f32 y = depth ? draw(path) : draw_lattice(path, 3);
            add_emitter(path, &shade, x, y, factor, out);
        }
        f32 x = depth ? draw(path) : draw_lattice(path, 0);
        f32 y = depth ? draw(path) : draw_lattice(path, 1);
        Vec3 way = choose_way(path, &shade, x, y);
        f32 n_dot_l = vec3_dot(s.normal, way), reflected[3];
        density = way_density(path, &shade, way);
        // Below the horizon of the shading normal or of the surface itself there is nothing.
        if (n_dot_l <= 0.0f || !(density > 1e-12f) || vec3_dot(s.face, way) <= 0.0f) return;
        brdf(&shade, way, n_dot_l, 1.0f, reflected);
        f32 most = 0.0f;
        for (u32 k = 0; k < 3; k++) {
            factor[k] *= reflected[k] * n_dot_l / density;
            most = MAX(most, factor[k]);
        }
        if (!(most > 0.0f)) return;
        if (depth >= SURE_BOUNCES && most < 0.9f) {
            f32 stay = MAX(most, 0.05f);
            if (draw(path) >= stay) return;
            for (u32 k = 0; k < 3; k++) factor[k] /= stay;
        }
        from = start_point(&s, way);
        to = way;
    }
}

// --- The picture ---

typedef struct Picture {
    const TraceScene *scene;
    const TraceOptions *options;
    f32 *rgb;
    LampLight *lamps; // [threads][lamp_cap]
    u32 lamp_cap, first_tile, tiles_x;
    Vec3 guides[GUIDES_CAP];
    u32 guide_count;
} Picture;

static void trace_pixel(const Picture *picture, LampLight *lamps, u32 x, u32 y) {
    const Packet *packet = picture->scene->packet;
    const FrameRecord *frame = &packet->frame;
    const TraceOptions *o = picture->options;
    u32 pixel = y * packet->width_px + x;
    f64 sum[3] = {0};
    f32 pixel_m = 2.0f * vec3_length(vec3(frame->ray_up[0], frame->ray_up[1], frame->ray_up[2])) /
                  frame->viewport[1];
    for (u32 i = 0; i < o->samples; i++) {
        Path path = {.scene = picture->scene,
                     .options = o,
                     .seed = random_u64(o->seed, 0x9A7, pixel),
                     .sample = i,
                     .lamps = lamps,
                     .guides = picture->guides,
                     .guide_count = picture->guide_count};
        f32 px = (f32)x + (o->smooth ? draw(&path) : 0.5f);
        f32 py = (f32)y + (o->smooth ? draw(&path) : 0.5f);
        f32 ndc_x = px * frame->viewport[2] * 2.0f - 1.0f;
        f32 ndc_y = 1.0f - py * frame->viewport[3] * 2.0f;
        f32 to[3], out[3] = {0};
        for (u32 k = 0; k < 3; k++)
            to[k] = frame->ray_right[k] * ndc_x + frame->ray_up[k] * ndc_y + frame->ray_forward[k];
        Vec3 eye = {frame->camera[0], frame->camera[1], frame->camera[2]};
        Vec3 way = vec3_normalize(vec3(to[0], to[1], to[2]));
        // Nothing before the near plane is seen.
        f32 near = frame->camera[3] * vec3_length(vec3(to[0], to[1], to[2]));
        trace_path(&path, vec3_add(eye, vec3_scale(way, near)), way, pixel_m, out);
        f32 most = MAX(out[0], MAX(out[1], out[2])), scale = 1.0f;
        if (o->largest > 0.0f && most > o->largest) scale = o->largest / most;
        for (u32 k = 0; k < 3; k++) sum[k] += (f64)(out[k] * scale);
    }
    for (u32 k = 0; k < 3; k++) picture->rgb[3ull * pixel + k] = (f32)(sum[k] / o->samples);
}

static void job_tiles(void *context, u32 begin, u32 end, u32 thread_index) {
    const Picture *picture = context;
    const Packet *packet = picture->scene->packet;
    LampLight *lamps = picture->lamps + (u64)thread_index * picture->lamp_cap;
    for (u32 i = begin; i < end; i++) {
        u32 tile = picture->first_tile + i;
        u32 left = tile % picture->tiles_x * TILE_PX, top = tile / picture->tiles_x * TILE_PX;
        for (u32 y = top; y < MIN(top + TILE_PX, packet->height_px); y++)
            for (u32 x = left; x < MIN(left + TILE_PX, packet->width_px); x++)
                trace_pixel(picture, lamps, x, y);
    }
}

static void find_guides(Picture *picture) {
    const TraceScene *scene = picture->scene;
    u32 count = 0;
    for (u32 i = 0; i < scene->far_count; i++) {
        if (scene->far_lights[i].kind == 2) continue;
        if (count == GUIDES_CAP) return; // too many
        picture->guides[count++] = scene->far_lights[i].position;
    }
    picture->guide_count = count;
}

void trace_picture(const TraceScene *scene, const TraceOptions *options, f32 *rgb, Arena *scratch,
                   TraceProgress progress, void *user) {
    const Packet *packet = scene->packet;
    u64 mark = arena_mark(scratch);
    Picture picture = {.scene = scene,
                       .options = options,
                       .rgb = rgb,
                       .lamp_cap = MAX(scene->seen_count, scene->far_count) + 1,
                       .tiles_x = (packet->width_px + TILE_PX - 1) / TILE_PX};
    find_guides(&picture);
    u32 threads = MAX(jobs_thread_count(), 1);
    picture.lamps = ARENA_PUSH(scratch, LampLight, (u64)threads * picture.lamp_cap);
    u32 total = picture.tiles_x * ((packet->height_px + TILE_PX - 1) / TILE_PX);
    for (u32 done = 0; done < total;) {
        u32 count = MIN(total - done, TILES_A_BATCH * threads);
        picture.first_tile = done;
        jobs_for(count, 1, job_tiles, &picture);
        done += count;
        if (progress) progress(user, done, total);
    }
    arena_rewind(scratch, mark);
}

// srgb_encode_fast of shaders/common.glsl.
static f32 encode(f32 c) {
    f32 a = sqrtf(MAX(c, 0.0f)), b = sqrtf(a), d = sqrtf(b);
    if (c <= 0.0031308f) return 12.92f * c;
    return 0.662002687f * a + 0.684122060f * b - 0.323583601f * d - 0.0225411470f * c;
}
static f32 fraction(f32 x) { return x - floorf(x); }

void trace_encode(const Packet *packet, const f32 *rgb, u8 *rgba) {
    f32 exponent = 0.0f;
    const PacketPost *posts = PACKET_DATA(packet, posts, PacketPost);
    for (u32 i = 0; i < packet->posts.count && packet->settings.post; i++)
        if (posts[i].kind == POST_GAMMA) exponent = posts[i].values[0];
    for (u32 y = 0; y < packet->height_px; y++)
        for (u32 x = 0; x < packet->width_px; x++) {
            u64 pixel = (u64)y * packet->width_px + x;
            f32 dot = ((f32)x + 0.5f) * 0.06711056f + ((f32)y + 0.5f) * 0.00583715f;
            f32 noise = (fraction(52.9829189f * fraction(dot)) - 0.5f) / 255.0f;
            for (u32 k = 0; k < 3; k++) {
                f32 c = rgb[3 * pixel + k] * packet->frame.ambient[3];
                c = packet->settings.tonemap ? c / (1.0f + c) : CLAMP(c, 0.0f, 1.0f);
                f32 code = exponent > 0.0f ? det_pow(MAX(c, 0.0f), 1.0f / exponent) : encode(c);
                rgba[4 * pixel + k] = (u8)(CLAMP(code + noise, 0.0f, 1.0f) * 255.0f + 0.5f);
            }
            rgba[4 * pixel + 3] = 255;
        }
}

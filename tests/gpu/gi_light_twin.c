// gi_light_twin.c: light of voxels as plain loops: the naive twin of shaders/gi_light.glsl. Data
// in: a VoxelScene. Data out: radiance. Called by: gi_light.c.
#include "gi_light_stage.h"
#include <string.h>

static f32 dot3(const f32 *a, const f32 *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static f32 clamp01(f32 x) { return CLAMP(x, 0.0f, 1.0f); }

typedef struct Voxel {
    u32 cascade;
    f32 position[3], size;
    f32 normal[3];  // unit or 0
    f32 facet;      // how much it is one surface
    f32 share[6];   // faces
    bool beside[6]; // is the next voxel on that side occupied?
    f32 albedo[3], emission[3];
} Voxel;

static Voxel unpack(const VoxelScene *stage, u32 slot) {
    Voxel v = {0};
    u32 place = stage->places[slot];
    u32 at[3] = {place & 511, place >> 9 & 511, place >> 18};
    v.cascade = at[2] / stage->gi.dims[2];
    at[2] %= stage->gi.dims[2];
    const f32 *box = stage->gi.origin[v.cascade];
    v.size = box[3];
    const u32 *words = stage->attributes + (u64)slot * GI_ATTRIBUTE_WORDS;
    f32 mean[3];
    for (u32 a = 0; a < 3; a++) {
        v.position[a] = box[a] + ((f32)at[a] + 0.5f) * v.size;
        mean[a] = (f32)(words[GI_ATTRIBUTE_NORMAL] >> 10 * a & 1023) * (2.0f / 1023.0f) - 1.0f;
        v.albedo[a] = (f32)(words[GI_ATTRIBUTE_ALBEDO] >> 8 * a & 255) / 255.0f;
        u32 emission = words[GI_ATTRIBUTE_EMISSION];
        v.emission[a] = ldexpf((f32)(emission >> 9 * a & 511), (int)(emission >> 27) - 24);
    }
    f32 length = sqrtf(dot3(mean, mean));
    v.facet = clamp01(length * 8.0f - 6.4f);
    for (u32 a = 0; a < 3; a++) v.normal[a] = length >= 1.0f / 32 ? mean[a] / length : 0.0f;
    for (u32 f = 0; f < 6; f++)
        v.share[f] = (f32)((f < 4 ? words[GI_ATTRIBUTE_FACES_0] : words[GI_ATTRIBUTE_FACES_1]) >>
                               8 * (f & 3) &
                           255) /
                     255.0f;
    for (u32 f = 0; f < 6; f++) {
        const u32 *dims = stage->gi.dims;
        u32 to[3] = {at[0], at[1], at[2]};
        to[f / 2] += f % 2 ? ~0u : 1u;
        if (to[f / 2] >= dims[f / 2]) continue;
        u32 bit = to[0] + dims[0] * (to[1] + dims[1] * (to[2] + dims[2] * v.cascade));
        u32 layer = dims[0] * dims[1] * dims[2] * dims[3] / 32;
        u32 mask = stage->masks[GI_MASK_STATIC * layer + bit / 32] |
                   stage->masks[GI_MASK_DYNAMIC * layer + bit / 32];
        v.beside[f] = mask >> bit % 32 & 1;
    }
    return v;
}

static f32 face_share(const Voxel *v, u32 f) { return MIN(v->share[f] * 16.0f, 1.0f); }

// Where two bodies touch: opposite faces that cancel out, of those the ones towards other voxels.
static bool is_hidden(const Voxel *v, u32 f) {
    bool cancels = dot3(v->normal, v->normal) > 0.0f && fabsf(v->normal[f / 2]) <= 0.3f;
    return cancels && v->share[f] > 0.0f && v->share[f ^ 1] > 0.0f && v->beside[f];
}

// What each face counts.
static void weigh(const VoxelScene *stage, const Voxel *v, f32 out[6]) {
    bool apart = stage->spec[SPEC_GI_FACES], known = dot3(v->normal, v->normal) > 0.0f;
    f32 sum = 0.0f;
    for (u32 f = 0; f < 6; f++) sum += v->share[f];
    for (u32 f = 0; f < 6; f++) {
        f32 n = v->normal[f / 2], toward = f % 2 ? -n : n;
        out[f] = apart   ? (is_hidden(v, f) ? 0.0f : face_share(v, f))
                 : known ? (toward > 0.0f ? n * n : 0.0f)
                         : v->share[f] / MAX(sum, 1e-3f);
    }
}

static f32 facing(const f32 l[3], u32 f) { return MAX(f % 2 ? -l[f / 2] : l[f / 2], 0.0f); }

// One light of unit distance: irradiance times visibility.
static void add(const VoxelScene *stage, const Voxel *v, const f32 weight[6], const f32 l[3],
                const f32 irradiance[3], LightSum *sum) {
    f32 cosine = 0.0f;
    if (!stage->spec[SPEC_GI_COSINE] && dot3(v->normal, v->normal) > 0.0f)
        cosine = MAX(dot3(v->normal, l), 0.0f);
    else
        for (u32 f = 0; f < 6; f++) cosine += weight[f] * facing(l, f);
    f32 slanted = MAX(dot3(v->normal, l), 0.0f);
    for (u32 f = 0; f < 6; f++)
        for (u32 k = 0; k < 3; k++)
            if (stage->spec[SPEC_GI_FACES])
                sum->face[f][k] +=
                    irradiance[k] * (facing(l, f) + (slanted - facing(l, f)) * v->facet);
            else if (f == 0)
                sum->face[0][k] += irradiance[k] * cosine;
}
static f32 any_facing(const VoxelScene *stage, const Voxel *v, const f32 weight[6],
                      const f32 l[3]) {
    const f32 white[3] = {1, 1, 1};
    LightSum one = {0};
    add(stage, v, weight, l, white, &one);
    f32 sum = one.face[0][0];
    if (!stage->spec[SPEC_GI_FACES]) return sum;
    sum = 0.0f;
    for (u32 f = 0; f < 6; f++) sum += one.face[f][0] * weight[f];
    return sum;
}

static f32 falloff(const VoxelScene *stage, const GiLightRecord *light, f32 d2, const f32 l[3]) {
    f32 x = d2 * light->position[3], d = sqrtf(d2), value;
    const f32 *k = stage->frame.attenuation;
    switch (stage->spec[SPEC_ATTENUATION]) {
    case 1:
        value = clamp01(1 - x);
        break;
    case 2:
        value = clamp01(1 - x) / (k[0] + k[1] * d + k[2] * d2);
        break;
    default:
        value = clamp01(1 - x * x) * clamp01(1 - x * x) * MIN(1 / d2, 1e4f);
    }
    if (light->extra[1] == 0.0f) return value;
    f32 t = clamp01((-dot3(l, light->direction) - light->direction[3]) * light->extra[0]);
    return value * t * t * (3 - 2 * t);
}

static u32 mask_word(const VoxelScene *stage, u32 word) {
    const u32 *dims = stage->gi.dims;
    u32 layer = dims[0] * dims[1] * dims[2] * dims[3] / 32;
    u32 mask =
        stage->masks[GI_MASK_STATIC * layer + word] | stage->masks[GI_MASK_DYNAMIC * layer + word];
    if (stage->spec[SPEC_GI_VISIBILITY] & GI_VISIBILITY_SOLID)
        mask |= stage->masks[GI_MASK_SOLID * layer + word];
    return mask;
}

// The part of [*from, *to] (lengths along the ray) in a box; false: none.
static bool clip(const f32 start[3], const f32 l[3], const f64 low[3], f64 side[3], f64 *from,
                 f64 *to) {
    for (u32 a = 0; a < 3; a++) {
        f64 slope = fabs((f64)l[a]) < 1e-6 ? 1e-6 : (f64)l[a];
        f64 in = (low[a] - (f64)start[a]) / slope, out = in + side[a] / slope;
        *from = MAX(*from, MIN(in, out));
        *to = MIN(*to, MAX(in, out));
    }
    return *from < *to;
}

// Share of light that gets from a voxel through the others: the ray against each full one's box. It
// starts off the voxel's plane, and counts from so many voxels on.
static f32 light_twin_ray(const VoxelScene *stage, const Voxel *v, const f32 l[3], f32 reach,
                          bool soft) {
    const u32 *dims = stage->gi.dims, cascade = v->cascade;
    f32 height = fabsf(v->normal[0]) + fabsf(v->normal[1]) + fabsf(v->normal[2]) - 0.45f, start[3];
    if (dot3(v->normal, l) <= 0.0f) height = 0.0f;
    for (u32 a = 0; a < 3; a++) start[a] = v->position[a] + v->normal[a] * height * v->size;
    f32 begin = stage->spec[SPEC_GI_FACES] ? 1.0f : 2.0f;
    f64 t = (f64)(begin * stage->gi.origin[cascade][3]), seen = 1.0;
    f64 hit = (f64)stage->gi.strength[3], longest = (f64)MAX(dims[0], MAX(dims[1], dims[2]));
    for (u32 c = cascade; c < dims[3]; c++) {
        const f32 *box = stage->gi.origin[c];
        f64 size = (f64)box[3], from = t, to = (f64)reach - size;
        f64 low[3] = {(f64)box[0], (f64)box[1], (f64)box[2]};
        bool outside = false; // a start moved off its grid's border is the next grid's
        for (u32 a = 0; a < 3; a++) {
            f64 at = ((f64)start[a] + (f64)l[a] * t - low[a]) / size;
            outside |= at < 0.0 || at >= (f64)dims[a];
        }
        if (outside || !clip(start, l, low,
                             (f64[3]){size * dims[0], size * dims[1], size * dims[2]}, &from, &to))
            continue;
        t = to;
        u32 volume = dims[0] * dims[1] * dims[2];
        for (u32 bit = 0; bit < volume; bit++) {
            u32 place = bit + volume * c;
            if (!(mask_word(stage, place / 32) >> place % 32 & 1)) continue;
            f64 in = from, out = to;
            f64 corner[3] = {low[0] + size * (bit % dims[0]),
                             low[1] + size * (bit / dims[0] % dims[1]),
                             low[2] + size * (bit / (dims[0] * dims[1]))};
            if (!clip(start, l, corner, (f64[3]){size, size, size}, &in, &out)) continue;
            if (!soft || hit >= 1.0) return 0.0f;
            seen *= 1.0 - MIN(hit * longest / MAX(in / size, 1.0), 1.0);
        }
    }
    return seen < 1.0 / 256 ? 0.0f : (f32)seen;
}

static f32 by_map(const VoxelScene *stage, const Voxel *v) {
    f32 p[3] = {0};
    const f32 *m = stage->frame.shadow_matrix;
    for (u32 row = 0; row < 3; row++) {
        p[row] = m[12 + row];
        for (u32 a = 0; a < 3; a++)
            p[row] += m[4 * a + row] * (v->position[a] + v->normal[a] * 0.5f * v->size);
    }
    if (fabsf(p[0]) >= 1 || fabsf(p[1]) >= 1 || p[2] <= 0 || p[2] >= 1) return 1.0f;
    return p[2] + stage->frame.shadow[3] >= stage->map_depth ? 1.0f : 0.0f;
}

LightSum light_twin(const VoxelScene *stage, u32 slot) {
    Voxel v = unpack(stage, slot);
    f32 weight[6], asked = 0.0f, seen = 0.0f;
    weigh(stage, &v, weight);
    LightSum sum = {0};
    for (u32 i = 0; i < stage->spec[SPEC_DIRECTIONALS]; i++) {
        const DirectionalRecord *sun = &stage->directionals[i];
        if (sun->direction[3] < 0.0f) continue;
        f32 visible = 1.0f;
        bool mapped = sun->direction[3] == 1.0f && sun->color[3] > 0.0f && stage->spec[SPEC_SHADOW];
        if (mapped) visible = by_map(stage, &v);
        if (sun->direction[3] >= 2.0f)
            visible = light_twin_ray(stage, &v, sun->direction, 1e30f, sun->direction[3] == 3.0f);
        if ((mapped || sun->direction[3] >= 2.0f) &&
            any_facing(stage, &v, weight, sun->direction) > 0.0f)
            asked += 1.0f, seen += visible;
        f32 c[3];
        for (u32 k = 0; k < 3; k++) c[k] = sun->color[k] * visible;
        add(stage, &v, weight, sun->direction, c, &sum);
    }
    for (u32 i = 0; i < stage->light_count; i++) {
        const GiLightRecord *light = &stage->lights[i];
        f32 l[3], c[3];
        for (u32 a = 0; a < 3; a++) l[a] = light->position[a] - v.position[a];
        f32 d2 = MAX(dot3(l, l), 1e-8f), d = sqrtf(d2);
        for (u32 a = 0; a < 3; a++) l[a] /= d;
        f32 power = falloff(stage, light, d2, l), visible = 1.0f;
        if (power <= 0.0f) continue;
        if (light->color[3] >= 2.0f && any_facing(stage, &v, weight, l) > 0.0f) {
            visible = light_twin_ray(stage, &v, l, d, light->color[3] == 3.0f);
            asked += 1.0f, seen += visible;
        }
        for (u32 k = 0; k < 3; k++) c[k] = light->color[k] * power * visible;
        add(stage, &v, weight, l, c, &sum);
    }
    u32 faces = stage->spec[SPEC_GI_FACES] ? 6 : 1;
    f32 most = 0.0f; // 0: the inside of a solid
    for (u32 f = 0; f < 6; f++) most = MAX(most, face_share(&v, f));
    for (u32 f = 0; f < faces; f++) {
        bool is_solid = faces == 1 || most == 0.0f;
        // Backs are dark, and count by a part of their share.
        sum.opacity[f] = is_solid ? 1.0f : MAX(face_share(&v, f), 0.6f * v.share[f ^ 1]);
        for (u32 k = 0; k < 3; k++) {
            f32 sent = v.emission[k] + v.albedo[k] * sum.face[f][k] * 0.318309886f;
            sum.face[f][k] = faces > 1 ? sent * weight[f] : sent;
        }
    }
    sum.visibility = asked > 0.0f ? seen / asked : 1.0f;
    return sum;
}

// trace_surface.c: what a ray has met: position, normals, albedo, emission.
// Data in: a hit, the packet's materials, the textures. Data out: TraceSurface (trace.h), as
// shaders/mesh.glsl and material.glsl make it of a fragment. Called by: trace_path.c, trace_scene.c
// (holes). Does not: anisotropic filtering.
#include "trace.h"
#include <string.h>

// --- Textures ---

static f32 decode_byte(u8 code, TextureKind kind) {
    static f32 table[256];
    static bool made; // every thread writes the same values
    if (!made) {
        for (u32 i = 0; i < 256; i++) table[i] = srgb_to_linear((f32)i / 255.0f);
        made = true;
    }
    return kind == TEXTURE_SRGB ? table[code] : (f32)code / 255.0f;
}

static f32 wrap(f32 x) { return x - floorf(x); }

// Bilinear, repeating.
static void sample_level(const Texture *texture, u32 level, f32 u, f32 v, f32 out[4]) {
    const u8 *pixels = texture->pixels;
    u32 width = texture->width, height = texture->height;
    for (u32 i = 0; i < level; i++) {
        pixels += 4ull * width * height;
        width = MAX(width / 2, 1);
        height = MAX(height / 2, 1);
    }
    f32 x = wrap(u) * (f32)width - 0.5f, y = wrap(v) * (f32)height - 0.5f;
    f32 x0 = floorf(x), y0 = floorf(y), fx = x - x0, fy = y - y0;
    memset(out, 0, 4 * sizeof *out);
    for (u32 i = 0; i < 4; i++) {
        i32 px = (i32)x0 + (i32)(i & 1), py = (i32)y0 + (i32)(i >> 1);
        u32 cx = px < 0 ? width - 1 : (u32)px % width, cy = py < 0 ? height - 1 : (u32)py % height;
        f32 weight = (i & 1 ? fx : 1.0f - fx) * (i >> 1 ? fy : 1.0f - fy);
        const u8 *texel = pixels + 4ull * ((u64)cy * width + cx);
        for (u32 k = 0; k < 3; k++) out[k] += weight * decode_byte(texel[k], texture->kind);
        out[3] += weight * (f32)texel[3] / 255.0f;
    }
}

// rate: texture coordinates that a pixel's footprint spans.
static void sample(const AssetStore *assets, u32 id, f32 u, f32 v, f32 rate, f32 out[4]) {
    if (id >= assets->texture_count || !assets->textures[id].pixels) {
        out[0] = out[1] = out[2] = out[3] = 1.0f;
        return;
    }
    const Texture *texture = &assets->textures[id];
    f32 texels = rate * (f32)MAX(texture->width, texture->height);
    f32 level = texels > 1.0f ? det_log(texels) * 1.442695f : 0.0f;
    level = MIN(level, (f32)(texture->mip_count - 1));
    u32 below = (u32)level, above = MIN(below + 1, texture->mip_count - 1);
    f32 coarse[4], share = level - (f32)below;
    sample_level(texture, below, u, v, out);
    if (share <= 0.0f || above == below) return;
    sample_level(texture, above, u, v, coarse);
    for (u32 k = 0; k < 4; k++) out[k] += (coarse[k] - out[k]) * share;
}

// --- Vertices ---

static f32 snorm(u32 bits, u32 shift, u32 width) {
    i32 value = (i32)(bits << (32 - shift - width)) >> (32 - width);
    return MAX((f32)value / (f32)((1u << (width - 1)) - 1), -1.0f);
}

static Vec3 oct_decode(f32 x, f32 y) { // coding.glsl
    Vec3 n = {x, y, 1.0f - fabsf(x) - fabsf(y)};
    f32 t = MAX(-n.z, 0.0f);
    n.x += n.x >= 0.0f ? -t : t;
    n.y += n.y >= 0.0f ? -t : t;
    return vec3_normalize(n);
}

typedef struct Corners {
    const MeshVertex *vertex[3];
    f32 weight[3];
} Corners;

static Corners corners_of(const TraceScene *scene, const TraceTriangle *triangle, f32 u, f32 v) {
    const Mesh *mesh = &scene->assets->meshes[scene->instances[triangle->instance].mesh];
    const u32 *indices = &mesh->indices[triangle->first_index];
    Corners c = {.weight = {1.0f - u - v, u, v}};
    for (u32 i = 0; i < 3; i++) c.vertex[i] = &mesh->vertices[indices[i]];
    return c;
}

static void corners_uv(const Corners *c, f32 out[2]) {
    out[0] = out[1] = 0.0f;
    for (u32 i = 0; i < 3; i++)
        for (u32 k = 0; k < 2; k++) out[k] += c->weight[i] * c->vertex[i]->uv[k];
}

static void corners_color(const Corners *c, f32 out[4]) {
    for (u32 k = 0; k < 4; k++) {
        out[k] = 0.0f;
        for (u32 i = 0; i < 3; i++)
            out[k] += c->weight[i] * (f32)(c->vertex[i]->color >> (8 * k) & 255) / 255.0f;
    }
}

// By the cofactor matrix, as mesh.glsl.
static Vec3 world_normal(const Mat34 *world, Vec3 n) {
    const f32 *m = world->m;
    Vec3 r0 = {m[0], m[1], m[2]}, r1 = {m[4], m[5], m[6]}, r2 = {m[8], m[9], m[10]};
    return vec3_normalize(vec3(vec3_dot(vec3_cross(r1, r2), n), vec3_dot(vec3_cross(r2, r0), n),
                               vec3_dot(vec3_cross(r0, r1), n)));
}

static Vec3 mapped_normal(const TraceScene *scene, const TraceInstance *instance, const Corners *c,
                          Vec3 normal, u32 texture, const f32 uv[2], f32 rate) {
    Vec3 tangent = {0};
    for (u32 i = 0; i < 3; i++) {
        u32 bits = c->vertex[i]->tangent;
        Vec3 t =
            mat34_vector(&instance->world, oct_decode(snorm(bits, 0, 16), snorm(bits, 16, 15)));
        tangent = vec3_add(tangent, vec3_scale(vec3_normalize(t), c->weight[i]));
    }
    f32 sign = c->vertex[0]->tangent >> 31 ? -1.0f : 1.0f;
    tangent = vec3_normalize(vec3_sub(tangent, vec3_scale(normal, vec3_dot(normal, tangent))));
    Vec3 bitangent = vec3_scale(vec3_cross(normal, tangent), sign);
    f32 texel[4], s[3];
    sample(scene->assets, texture, uv[0], uv[1], rate, texel);
    for (u32 k = 0; k < 3; k++) s[k] = texel[k] * (255.0f / 127.0f) - 128.0f / 127.0f;
    return vec3_normalize(vec3_add(vec3_add(vec3_scale(tangent, s[0]), vec3_scale(bitangent, s[1])),
                                   vec3_scale(normal, s[2])));
}

// --- Hits ---

bool trace_triangle_is_solid(const TraceScene *scene, const TraceTriangle *triangle, f32 u, f32 v) {
    u32 material = scene->instances[triangle->instance].material;
    Corners c = corners_of(scene, triangle, u, v);
    f32 uv[2], color[4], texel[4] = {1, 1, 1, 1};
    corners_uv(&c, uv);
    corners_color(&c, color);
    if (scene->bindings[material].albedo_texture)
        sample(scene->assets, scene->bindings[material].albedo_texture, uv[0], uv[1], 0.0f, texel);
    return texel[3] * color[3] >= scene->materials[material].albedo[3];
}

static void emission(const TraceScene *scene, const PacketMaterial *binding,
                     const MaterialRecord *material, const f32 uv[2], f32 rate, f32 out[3]) {
    memcpy(out, material->emissive, 3 * sizeof *out);
    if (!binding->emissive_pass) return;
    f32 texel[4];
    sample(scene->assets, binding->emissive_texture, uv[0], uv[1], rate, texel);
    for (u32 k = 0; k < 3; k++) out[k] += texel[k] * material->extra[k + 1];
}

void trace_emission(const TraceScene *scene, u32 triangle, f32 u, f32 v, f32 out[3]) {
    const TraceTriangle *t = &scene->triangles[triangle];
    u32 material = scene->instances[t->instance].material;
    Corners c = corners_of(scene, t, u, v);
    f32 uv[2];
    corners_uv(&c, uv);
    emission(scene, &scene->bindings[material], &scene->materials[material], uv, 0.0f, out);
}

// Texture coordinates a metre, by areas.
static f32 uv_rate(const Corners *c, Vec3 cross) {
    const f32 *a = c->vertex[0]->uv, *b = c->vertex[1]->uv, *d = c->vertex[2]->uv;
    f32 uv_area = fabsf((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]));
    f32 area = vec3_length(cross);
    return area > 0.0f ? sqrtf(uv_area / area) : 0.0f;
}

TraceSurface trace_surface(const TraceScene *scene, const TraceHit *hit, Vec3 from, Vec3 to,
                           f32 footprint_m) {
    const TraceTriangle *t = &scene->triangles[hit->triangle];
    const TraceInstance *instance = &scene->instances[t->instance];
    const PacketMaterial *binding = &scene->bindings[instance->material];
    Corners c = corners_of(scene, t, hit->u, hit->v);
    TraceSurface s = {.material = &scene->materials[instance->material]};
    Vec3 edge1 = {t->edge1[0], t->edge1[1], t->edge1[2]};
    Vec3 edge2 = {t->edge2[0], t->edge2[1], t->edge2[2]};
    Vec3 cross = vec3_cross(edge1, edge2);
    s.position = vec3_add(from, vec3_scale(to, hit->t));
    s.front = vec3_dot(cross, to) < 0.0f;
    s.face = vec3_scale(vec3_normalize(cross), s.front ? 1.0f : -1.0f);
    Vec3 normal = {0};
    for (u32 i = 0; i < 3; i++) {
        u32 bits = c.vertex[i]->normal;
        Vec3 n =
            world_normal(&instance->world, oct_decode(snorm(bits, 0, 16), snorm(bits, 16, 16)));
        normal = vec3_add(normal, vec3_scale(n, c.weight[i]));
    }
    normal = vec3_normalize(normal);
    f32 uv[2], color[4], texel[4] = {1, 1, 1, 1};
    corners_uv(&c, uv);
    corners_color(&c, color);
    f32 rate = uv_rate(&c, cross) * footprint_m;
    if (binding->normal_texture)
        normal = mapped_normal(scene, instance, &c, normal, binding->normal_texture, uv, rate);
    s.normal = s.front ? normal : vec3_scale(normal, -1.0f);
    if (binding->albedo_texture)
        sample(scene->assets, binding->albedo_texture, uv[0], uv[1], rate, texel);
    for (u32 k = 0; k < 3; k++) s.albedo[k] = texel[k] * color[k] * s.material->albedo[k];
    emission(scene, binding, s.material, uv, rate, s.emission);
    if (!s.front && !binding->double_sided) memset(s.emission, 0, sizeof s.emission);
    return s;
}

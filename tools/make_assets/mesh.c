// Mesh builder: see mesh.h. Works on a triangle soup because shapes then need not know which of
// their edges are sharp: one crease angle decides it for whole models, across shapes.
#include "mesh.h"

#include "materials.h"

#include <stdlib.h>
#include <string.h>

#define WELD_M     2e-4f // corners nearer than this are one point
#define VALLEY_COS 0.88f // flatter valleys are smooth even in carved things

void soup_init(Soup *s) {
    memset(s, 0, sizeof *s);
    s->transform = affine_identity();
    s->tile_m = 1;
}

void soup_free(Soup *s) {
    free(s->position);
    free(s->normal);
    free(s->uv);
    free(s->material);
    free(s->crease_deg);
    free(s->tint);
    memset(s, 0, sizeof *s);
}

void soup_use(Soup *s, int surface) {
    s->surface_now = surface;
    s->tile_m = surface_get(surface).tile_m;
}

void soup_smooth(Soup *s, int crease_deg) { s->crease_now_deg = (uint8_t)crease_deg; }
void soup_carve(Soup *s, int crease_deg) {
    s->crease_now_deg = (uint8_t)(crease_deg + CREASE_VALLEYS);
}

static void *grow(void *p, size_t bytes) {
    void *q = realloc(p, bytes);
    if (!q) abort();
    return q;
}

static void soup_push(Soup *s, const Vec3 p[3], const Vec2 uv[3]) {
    Vec3 area = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    if (vec3_length(area) < 1e-9f) return;
    if (s->triangle_count == s->triangle_cap) {
        s->triangle_cap = s->triangle_cap ? s->triangle_cap * 2 : 1024;
        size_t corners = (size_t)s->triangle_cap * 3;
        s->position = grow(s->position, corners * sizeof *s->position);
        s->normal = grow(s->normal, corners * sizeof *s->normal);
        s->uv = grow(s->uv, corners * sizeof *s->uv);
        s->material = grow(s->material, s->triangle_cap * sizeof *s->material);
        s->crease_deg = grow(s->crease_deg, s->triangle_cap * sizeof *s->crease_deg);
        s->tint = grow(s->tint, s->triangle_cap * sizeof *s->tint);
    }
    bool mirrored = affine_determinant(&s->transform) < 0;
    uint32_t base = s->triangle_count * 3;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t from = mirrored ? 2 - k : k;
        s->position[base + k] = p[from];
        s->uv[base + k] = uv[from];
        s->normal[base + k] = vec3(0, 0, 0);
    }
    Surface surface = surface_get(s->surface_now);
    s->material[s->triangle_count] = (uint8_t)surface.material;
    s->crease_deg[s->triangle_count] = s->crease_now_deg;
    s->tint[s->triangle_count++] = surface.tint;
}

void soup_triangle(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec2 ua, Vec2 ub, Vec2 uc) {
    Vec3 p[3] = {affine_point(&s->transform, a), affine_point(&s->transform, b),
                 affine_point(&s->transform, c)};
    Vec2 uv[3] = {ua, ub, uc};
    soup_push(s, p, uv);
}

void soup_quad(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec2 ua, Vec2 ub, Vec2 uc, Vec2 ud) {
    soup_triangle(s, a, b, c, ua, ub, uc);
    soup_triangle(s, a, c, d, ua, uc, ud);
}

static Vec2 box_uv(Vec3 p, Vec3 n, float tile) {
    float ax = fabsf(n.x), ay = fabsf(n.y), az = fabsf(n.z), k = 1 / tile;
    if (ay > ax && ay > az) return vec2(p.x * k, -p.z * k);
    if (ax > az) return vec2((n.x > 0 ? -p.z : p.z) * k, p.y * k);
    return vec2((n.z > 0 ? p.x : -p.x) * k, p.y * k);
}

void soup_triangle_box(Soup *s, Vec3 a, Vec3 b, Vec3 c) {
    Vec3 p[3] = {affine_point(&s->transform, a), affine_point(&s->transform, b),
                 affine_point(&s->transform, c)};
    Vec3 n = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    if (affine_determinant(&s->transform) < 0) n = vec3_scale(n, -1);
    Vec2 uv[3];
    for (int k = 0; k < 3; k++) uv[k] = box_uv(p[k], n, s->tile_m);
    soup_push(s, p, uv);
}

void soup_quad_box(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    soup_triangle_box(s, a, b, c);
    soup_triangle_box(s, a, c, d);
}

void soup_set_crown_normals(Soup *s, uint32_t first, Vec3 center, float up) {
    for (uint32_t i = first * 3; i < s->triangle_count * 3; i++) {
        Vec3 d = vec3_normalize(vec3_sub(s->position[i], center));
        d.y += up;
        s->normal[i] = vec3_normalize(d);
    }
}

// ---- from soup to indexed mesh ----------------------------------------------------------------

static uint32_t hash_bytes(const void *data, size_t size) {
    const unsigned char *b = data;
    uint32_t h = 2166136261u;
    for (size_t i = 0; i < size; i++) h = (h ^ b[i]) * 16777619u;
    return h ^ (h >> 15);
}

// Open addressing from key bytes to a small number; the tables live for one build only.
typedef struct KeyTable {
    uint32_t *slot; // number + 1, 0 is free
    unsigned char *keys;
    size_t key_size;
    uint32_t mask, count;
} KeyTable;

static KeyTable keys_make(uint32_t capacity, size_t key_size) {
    uint32_t n = 64;
    while (n < capacity * 2) n *= 2;
    KeyTable t = {calloc(n, sizeof(uint32_t)), malloc((size_t)capacity * key_size + 1), key_size,
                  n - 1, 0};
    if (!t.slot || !t.keys) abort();
    return t;
}

static uint32_t keys_find(KeyTable *t, const void *key) {
    uint32_t i = hash_bytes(key, t->key_size) & t->mask;
    while (t->slot[i]) {
        uint32_t number = t->slot[i] - 1;
        if (!memcmp(t->keys + (size_t)number * t->key_size, key, t->key_size)) return number;
        i = (i + 1) & t->mask;
    }
    memcpy(t->keys + (size_t)t->count * t->key_size, key, t->key_size);
    t->slot[i] = ++t->count;
    return t->count - 1;
}

static void keys_free(KeyTable *t) {
    free(t->slot);
    free(t->keys);
}

static float corner_angle(const Vec3 *p, int k) {
    Vec3 e0 = vec3_normalize(vec3_sub(p[(k + 1) % 3], p[k]));
    Vec3 e1 = vec3_normalize(vec3_sub(p[(k + 2) % 3], p[k]));
    return acosf(float_clamp(vec3_dot(e0, e1), -1, 1));
}

// Whether the triangle of corner b rises over that of corner a; both meet in that point.
static bool is_valley(const Soup *s, uint32_t a, uint32_t b, const Vec3 *face) {
    const Vec3 *p = s->position + b / 3 * 3;
    Vec3 mid = vec3_scale(vec3_add(p[0], vec3_add(p[1], p[2])), 1.0f / 3);
    return vec3_dot(face[a / 3], vec3_sub(mid, s->position[a])) > 0;
}

static void compute_normals(const Soup *s, float crease_deg, Vec3 *out) {
    uint32_t corners = s->triangle_count * 3;
    uint32_t *point = malloc(corners * sizeof *point), *next = malloc(corners * sizeof *next);
    uint32_t *head = malloc(corners * sizeof *head);
    Vec3 *face = malloc(s->triangle_count * sizeof *face);
    float *crease_cos = malloc(s->triangle_count * sizeof *crease_cos);
    uint32_t *around = malloc(corners * sizeof *around), *group = malloc(corners * sizeof *group);
    if (!point || !next || !head || !face || !crease_cos || !around || !group) abort();
    memset(head, 0xFF, corners * sizeof *head);
    KeyTable table = keys_make(corners, sizeof(int32_t) * 3);
    for (uint32_t i = 0; i < corners; i++) {
        Vec3 p = s->position[i];
        int32_t key[3] = {(int32_t)lrintf(p.x / WELD_M), (int32_t)lrintf(p.y / WELD_M),
                          (int32_t)lrintf(p.z / WELD_M)};
        point[i] = keys_find(&table, key);
        next[i] = head[point[i]];
        head[point[i]] = i;
    }
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        const Vec3 *p = s->position + t * 3;
        face[t] = vec3_normalize(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
        int own = s->crease_deg[t] & (CREASE_VALLEYS - 1);
        float crease = own ? (float)own : crease_deg;
        crease_cos[t] = cosf(crease * PI_F / 180);
    }
    // At each point, corners that a chain of smooth edges joins share one normal: faces do not
    // choose their own neighbours, so a rounded thing keeps one vertex per point.
    for (uint32_t p = 0; p < table.count; p++) {
        uint32_t n = 0;
        for (uint32_t i = head[p]; i != UINT32_MAX; i = next[i]) around[n++] = i;
        for (uint32_t a = 0; a < n; a++) group[a] = a;
        for (uint32_t a = 0; a < n; a++) {
            for (uint32_t b = 0; b < a; b++) {
                uint32_t t = around[a] / 3, u = around[b] / 3, from = group[a], to = group[b];
                float limit = fmaxf(crease_cos[t], crease_cos[u]);
                if (s->crease_deg[t] & CREASE_VALLEYS && is_valley(s, around[a], around[b], face))
                    limit = fmaxf(limit, VALLEY_COS);
                if (from == to || vec3_dot(face[t], face[u]) < limit) continue;
                for (uint32_t c = 0; c < n; c++)
                    if (group[c] == from) group[c] = to;
            }
        }
        for (uint32_t a = 0; a < n; a++) {
            Vec3 sum = vec3(0, 0, 0);
            for (uint32_t b = 0; b < n; b++) {
                if (group[b] != group[a]) continue;
                uint32_t t = around[b] / 3;
                float weight = corner_angle(s->position + t * 3, (int)(around[b] % 3));
                sum = vec3_mad(sum, face[t], weight);
            }
            bool given = vec3_length(s->normal[around[a]]) > 0.5f;
            out[around[a]] = given ? s->normal[around[a]] : vec3_normalize(sum);
        }
    }
    keys_free(&table);
    free(point);
    free(next);
    free(head);
    free(face);
    free(crease_cos);
    free(around);
    free(group);
}

// Tangent of a triangle: direction of growing u. The sign says whether growing v (upwards) agrees
// with cross(normal, tangent); it is part of a vertex's key, so mirrored charts never share one.
static float triangle_tangent(const Vec3 *p, const Vec2 *uv, Vec3 *tangent) {
    Vec3 e1 = vec3_sub(p[1], p[0]), e2 = vec3_sub(p[2], p[0]);
    float du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y;
    float du2 = uv[2].x - uv[0].x, dv2 = uv[2].y - uv[0].y;
    float det = du1 * dv2 - du2 * dv1;
    Vec3 t = vec3_sub(vec3_scale(e1, dv2), vec3_scale(e2, dv1));
    *tangent = vec3_normalize(det < 0 ? vec3_scale(t, -1) : t);
    return det < 0 ? -1.0f : 1.0f;
}

static void finish_tangent(Vertex *v) {
    Vec3 t = vec3(v->tangent[0], v->tangent[1], v->tangent[2]);
    t = vec3_normalize(vec3_mad(t, v->normal, -vec3_dot(t, v->normal)));
    if (vec3_length(t) < 0.5f) { // charts without area: any perpendicular will do
        Vec3 axis = fabsf(v->normal.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
        t = vec3_normalize(vec3_cross(axis, v->normal));
    }
    v->tangent[0] = t.x;
    v->tangent[1] = t.y;
    v->tangent[2] = t.z;
}

Mesh soup_build(const Soup *s, float crease_deg) {
    typedef struct Key {
        int32_t position[3], normal[3], uv[2], sign, material;
        uint32_t tint;
    } Key;
    uint32_t corners = s->triangle_count * 3;
    Mesh m = {0};
    Vec3 *normals = malloc((corners + 1) * sizeof *normals);
    m.vertices = calloc(corners + 1, sizeof *m.vertices);
    m.indices = malloc((corners + 1) * sizeof *m.indices);
    if (!normals || !m.vertices || !m.indices) abort();
    compute_normals(s, crease_deg, normals);
    KeyTable table = keys_make(corners + 1, sizeof(Key));
    // One pass per material keeps each primitive's vertices together.
    for (int mat = 0; mat < MESH_MATERIALS_MAX; mat++) {
        m.first[mat] = m.index_count;
        bool textured = mat < MAT_COUNT && material_get(mat)->texture >= 0;
        for (uint32_t t = 0; t < s->triangle_count; t++) {
            if (s->material[t] != mat) continue;
            Vec3 tangent;
            float sign = triangle_tangent(s->position + t * 3, s->uv + t * 3, &tangent);
            if (!textured) sign = 1;
            for (uint32_t k = 0; k < 3; k++) {
                uint32_t i = t * 3 + k;
                Vec3 p = s->position[i], n = normals[i];
                Vec2 uv = textured ? s->uv[i] : vec2(0, 0);
                Key key = {{(int32_t)lrintf(p.x / WELD_M), (int32_t)lrintf(p.y / WELD_M),
                            (int32_t)lrintf(p.z / WELD_M)},
                           {(int32_t)lrintf(n.x * 512), (int32_t)lrintf(n.y * 512),
                            (int32_t)lrintf(n.z * 512)},
                           {(int32_t)lrintf(uv.x * 4096), (int32_t)lrintf(uv.y * 4096)},
                           (int32_t)sign,
                           mat,
                           s->tint[t]};
                uint32_t number = keys_find(&table, &key);
                Vertex *v = m.vertices + number;
                if (number == m.vertex_count) {
                    m.vertex_count++;
                    *v = (Vertex){p, n, {0, 0, 0, sign}, {uv.x, 1 - uv.y}, s->tint[t]};
                }
                float w = corner_angle(s->position + t * 3, (int)k);
                v->tangent[0] += tangent.x * w;
                v->tangent[1] += tangent.y * w;
                v->tangent[2] += tangent.z * w;
                m.indices[m.index_count++] = number;
            }
        }
        m.count[mat] = m.index_count - m.first[mat];
    }
    for (uint32_t i = 0; i < m.vertex_count; i++) finish_tangent(m.vertices + i);
    keys_free(&table);
    free(normals);
    return m;
}

void mesh_free(Mesh *m) {
    free(m->vertices);
    free(m->indices);
    memset(m, 0, sizeof *m);
}

// voxel_twin.c: see voxel_twin.h. The order of operations is that of shaders/gi_vox.glsl; a
// compiler that fuses or reorders them would break the tests (the build says -ffp-contract=off).
#include "voxel_twin.h"
#include <math.h>
#include <string.h>

static f32 largest(const f32 v[3]) { return MAX(MAX(fabsf(v[0]), fabsf(v[1])), fabsf(v[2])); }

static void across(const f32 e[3], const f32 p[3], f32 out[3]) {
    for (u32 k = 0; k < 3; k++) {
        u32 a = (k + 1) % 3, b = (k + 2) % 3;
        f32 s = p[a] * e[b], t = p[b] * e[a];
        out[k] = s - t;
    }
}
static f32 along(const f32 n[3], const f32 p[3]) {
    f32 s = n[0] * p[0], t = n[1] * p[1], u = n[2] * p[2];
    s = s + t;
    s = s + u;
    return s;
}
static void steady(f32 v[3]) {
    if (largest(v) < 1e-18f) v[0] = v[1] = v[2] = 0.0f;
}
// Component of a vector that turning puts at k.
static u32 turned(u32 axis, u32 k) { return (axis + 1 + k) % 3; }
static void turn(const f32 p[3], u32 axis, f32 out[3]) {
    for (u32 k = 0; k < 3; k++) out[k] = p[turned(axis, k)];
}
void twin_turn_back(const TwinTriangle *t, const i32 v[3], u32 out[3]) {
    for (u32 k = 0; k < 3; k++) out[turned(t->axis, k)] = (u32)v[k];
}

TwinTriangle twin_triangle(const GiRecord *record, u32 cascade, f32 world[3][3]) {
    TwinTriangle t = {0};
    const f32 *grid = record->origin[cascade];
    f32 inverse = 1.0f / grid[3];
    f32 reach = MAX(MAX(largest(world[0]), largest(world[1])), largest(world[2])) * inverse;
    f32 v[3][3], e[3][3], n[3];
    for (u32 i = 0; i < 3; i++)
        for (u32 k = 0; k < 3; k++) v[i][k] = (world[i][k] - grid[k]) * inverse;
    reach = MAX(reach, MAX(MAX(largest(v[0]), largest(v[1])), largest(v[2])));
    t.slack = reach * 9.5367431640625e-7f + 0.0009765625f;
    for (u32 i = 0; i < 3; i++) {
        for (u32 k = 0; k < 3; k++) e[i][k] = v[(i + 1) % 3][k] - v[i][k];
        steady(e[i]);
    }
    across(e[1], e[0], n);
    steady(n);
    f32 a[3] = {fabsf(n[0]), fabsf(n[1]), fabsf(n[2])};
    u32 axis = a[0] >= a[1] && a[0] >= a[2] ? 0 : a[1] >= a[2] ? 1 : 2;
    f32 l[3] = {largest(e[0]), largest(e[1]), largest(e[2])};
    u32 longest = l[0] >= l[1] && l[0] >= l[2] ? 0 : l[1] >= l[2] ? 1 : 2;
    f32 thin = l[longest] * l[longest];
    thin = thin * 0.001953125f;
    f32 d[3] = {fabsf(e[longest][0]), fabsf(e[longest][1]), fabsf(e[longest][2])};
    u32 edge_axis = d[0] >= d[1] && d[0] >= d[2] ? 1 : d[1] >= d[2] ? 2 : 0;
    t.axis = largest(n) <= thin ? edge_axis : axis;
    for (u32 i = 0; i < 3; i++) {
        turn(v[i], t.axis, t.corners[i]);
        turn(e[i], t.axis, t.edges[i]);
    }
    turn(n, t.axis, t.normal);
    for (u32 k = 0; k < 3; k++) {
        f32 dims = (f32)record->dims[turned(t.axis, k)];
        const f32 p[3] = {t.corners[0][k], t.corners[1][k], t.corners[2][k]};
        f32 low = MIN(MIN(p[0], p[1]), p[2]) - t.slack, high = MAX(MAX(p[0], p[1]), p[2]) + t.slack;
        f32 first = ceilf(low) - 1.0f, last = floorf(high);
        t.low[k] = (i32)CLAMP(first, 0.0f, dims);
        t.high[k] = (i32)CLAMP(last, -1.0f, dims - 1.0f);
    }
    f32 h = 0.5f + t.slack;
    for (u32 i = 0; i < 3; i++) {
        f32 p[3], q[3];
        across(t.edges[i], t.corners[i], p);
        across(t.edges[i], t.corners[(i + 2) % 3], q);
        for (u32 k = 0; k < 3; k++) {
            f32 r = h * (fabsf(t.edges[i][(k + 1) % 3]) + fabsf(t.edges[i][(k + 2) % 3]));
            t.edge_low[i][k] = MIN(p[k], q[k]) - r;
            t.edge_high[i][k] = MAX(p[k], q[k]) + r;
        }
    }
    f32 na = along(t.normal, t.corners[0]), nb = along(t.normal, t.corners[1]),
        nc = along(t.normal, t.corners[2]);
    f32 rn = fabsf(t.normal[0]) + fabsf(t.normal[1]);
    rn = rn + fabsf(t.normal[2]);
    rn = rn * h;
    t.normal_low = MIN(MIN(na, nb), nc) - rn;
    t.normal_high = MAX(MAX(na, nb), nc) + rn;
    return t;
}

bool twin_touches(const TwinTriangle *t, const i32 v[3]) {
    const f32 p[3] = {(f32)v[0] + 0.5f, (f32)v[1] + 0.5f, (f32)v[2] + 0.5f};
    f32 n = along(t->normal, p);
    bool touches = n >= t->normal_low && n <= t->normal_high;
    for (u32 i = 0; i < 3; i++) {
        f32 q[3];
        across(t->edges[i], p, q);
        for (u32 k = 0; k < 3; k++)
            touches = touches && q[k] >= t->edge_low[i][k] && q[k] <= t->edge_high[i][k];
    }
    return touches;
}

bool twin_touches_exactly(f64 corners[3][3], const u32 voxel[3], f64 slack) {
    f64 p[3][3], axes[13][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, e[3][3];
    for (u32 i = 0; i < 3; i++)
        for (u32 k = 0; k < 3; k++) p[i][k] = corners[i][k] - (voxel[k] + 0.5);
    for (u32 i = 0; i < 3; i++)
        for (u32 k = 0; k < 3; k++) e[i][k] = p[(i + 1) % 3][k] - p[i][k];
    for (u32 k = 0; k < 3; k++) {
        u32 a = (k + 1) % 3, b = (k + 2) % 3;
        axes[3][k] = e[0][a] * e[1][b] - e[0][b] * e[1][a];
        for (u32 i = 0; i < 3; i++) { // edge i x unit k
            f64 *axis = axes[4 + 3 * i + k];
            axis[k] = 0, axis[a] = e[i][b], axis[b] = -e[i][a];
        }
    }
    for (u32 i = 0; i < 13; i++) {
        f64 low = INFINITY, high = -INFINITY, radius = 0;
        for (u32 k = 0; k < 3; k++) radius += fabs(axes[i][k]) * (0.5 + slack);
        for (u32 c = 0; c < 3; c++) {
            f64 at = axes[i][0] * p[c][0] + axes[i][1] * p[c][1] + axes[i][2] * p[c][2];
            low = fmin(low, at), high = fmax(high, at);
        }
        if (low > radius || high < -radius) return false;
    }
    return true;
}

void twin_world(const InstanceRecord *instance, const f32 p[3], f32 out[3]) {
    for (u32 k = 0; k < 3; k++) {
        const f32 *row = instance->world[k];
        f32 x = row[0] * p[0], y = row[1] * p[1], z = row[2] * p[2];
        f32 sum = x + y;
        sum = sum + z;
        out[k] = sum + row[3];
    }
}
void twin_world_exactly(const InstanceRecord *instance, const f32 p[3], f64 out[3]) {
    for (u32 k = 0; k < 3; k++) {
        const f32 *row = instance->world[k];
        out[k] = (f64)row[0] * (f64)p[0] + (f64)row[1] * (f64)p[1] + (f64)row[2] * (f64)p[2] +
                 (f64)row[3];
    }
}

// --- What falls into a voxel ---

static void normalise(f32 v[3]) {
    f32 square = along(v, v), inverse = square > 1e-24f ? 1.0f / sqrtf(square) : 0.0f;
    for (u32 k = 0; k < 3; k++) v[k] *= inverse;
}

static void weights(const TwinTriangle *t, const i32 v[3], f32 w[3]) {
    f32 p[3], f[3];
    for (u32 k = 0; k < 3; k++) {
        p[k] = (f32)v[k] + 0.5f - t->corners[0][k];
        f[k] = -t->edges[2][k];
    }
    const f32 *e = t->edges[0];
    f32 d00 = along(e, e), d01 = along(e, f), d11 = along(f, f), d20 = along(p, e),
        d21 = along(p, f);
    f32 area = d00 * d11 - d01 * d01, inverse = area > 1e-12f ? 1.0f / area : 0.0f;
    w[1] = (d11 * d20 - d01 * d21) * inverse;
    w[2] = (d00 * d21 - d01 * d20) * inverse;
    w[0] = 1.0f - w[1] - w[2];
    f32 sum = 0.0f;
    for (u32 k = 0; k < 3; k++) sum += w[k] = CLAMP(w[k], 0.0f, 1.0f);
    for (u32 k = 0; k < 3; k++) w[k] /= sum;
}

static void add_sums(TwinVoxels *out, const Packet *packet, const PacketDraw *draw,
                     const InstanceRecord *instance, const MeshVertex *vertices[3],
                     const TwinTriangle *t, const i32 v[3], u32 bit) {
    const MaterialRecord *material =
        &PACKET_DATA(packet, materials, MaterialRecord)[draw->material];
    bool two_sided =
        PACKET_DATA(packet, material_bindings, PacketMaterial)[draw->material].double_sided;
    f32 w[3], n[3] = {0}, color[3] = {0}, world[3];
    weights(t, v, w);
    for (u32 i = 0; i < 3; i++) {
        Vec3 normal = asset_unpack_normal(vertices[i]->normal);
        const f32 own[3] = {normal.x, normal.y, normal.z};
        for (u32 k = 0; k < 3; k++) {
            n[k] += own[k] * w[i];
            color[k] += (f32)(vertices[i]->color >> (8 * k) & 255) / 255.0f * w[i];
        }
    }
    for (u32 k = 0; k < 3; k++) {
        const f32 *a = instance->world[(k + 1) % 3], *b = instance->world[(k + 2) % 3];
        f32 cofactor[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]};
        world[k] = along(cofactor, n);
    }
    normalise(world);
    out->counts[bit]++;
    for (u32 k = 0; k < 3; k++) {
        out->albedo[bit][k] += CLAMP(material->albedo[k] * color[k], 0.0f, 1.0f);
        out->normal[bit][k] += world[k];
        out->emission[bit][k] += material->emissive[k];
        out->faces[bit][2 * k] += MAX(two_sided ? fabsf(world[k]) : world[k], 0.0f);
        out->faces[bit][2 * k + 1] += MAX(two_sided ? fabsf(world[k]) : -world[k], 0.0f);
    }
}

typedef struct TwinDraw {
    const Packet *packet;
    const PacketDraw *draw;
    const Mesh *mesh;
    u32 layer, cascade;
} TwinDraw;

static void add_triangle(TwinVoxels *out, const TwinDraw *d, const InstanceRecord *instance,
                         const u32 *indices, bool sums) {
    const GiRecord *record = &d->packet->gi.record;
    const MeshVertex *vertices[3];
    f32 world[3][3];
    for (u32 i = 0; i < 3; i++) {
        vertices[i] = &d->mesh->vertices[indices[i]];
        twin_world(instance, vertices[i]->position, world[i]);
    }
    TwinTriangle t = twin_triangle(record, d->cascade, world);
    i32 v[3];
    for (v[2] = t.low[2]; v[2] <= t.high[2]; v[2]++)
        for (v[1] = t.low[1]; v[1] <= t.high[1]; v[1]++)
            for (v[0] = t.low[0]; v[0] <= t.high[0]; v[0]++) {
                if (!twin_touches(&t, v)) continue;
                u32 at[3];
                twin_turn_back(&t, v, at);
                at[2] += record->dims[2] * d->cascade;
                u32 bit = at[0] + record->dims[0] * (at[1] + record->dims[1] * at[2]);
                u32 single = 1u << (bit & 31);
                if (out->masks[GI_MASK_STATIC][bit >> 5] & single && d->layer) continue;
                out->masks[d->layer][bit >> 5] |= single;
                if (sums && d->layer == GI_MASK_STATIC)
                    add_sums(out, d->packet, d->draw, instance, vertices, &t, v, bit);
            }
}

TwinVoxels twin_voxelise(const Packet *packet, const AssetStore *assets, bool sums, Arena *arena) {
    const GiRecord *record = &packet->gi.record;
    u32 voxels = record->dims[0] * record->dims[1] * record->dims[2] * record->dims[3];
    TwinVoxels out = {.words = voxels / 32};
    for (u32 i = 0; i < 2; i++) out.masks[i] = ARENA_PUSH(arena, u32, out.words);
    if (sums) {
        out.counts = ARENA_PUSH(arena, u32, voxels);
        out.albedo = arena_push(arena, voxels * sizeof *out.albedo, 16);
        out.normal = arena_push(arena, voxels * sizeof *out.normal, 16);
        out.faces = arena_push(arena, voxels * sizeof *out.faces, 16);
        out.emission = arena_push(arena, voxels * sizeof *out.emission, 16);
    }
    const InstanceRecord *instances = PACKET_DATA(packet, gi_instances, InstanceRecord);
    for (u32 layer = 0; layer < 2; layer++) {
        PacketSection section = layer ? packet->gi_dynamic_draws : packet->gi_static_draws;
        const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + section.offset);
        for (u32 i = 0; i < section.count; i++) {
            const Mesh *mesh = &assets->meshes[draws[i].mesh];
            for (u32 k = 0; k < draws[i].instance_count; k++)
                for (u32 cascade = 0; cascade < record->dims[3]; cascade++) {
                    TwinDraw d = {packet, &draws[i], mesh, layer, cascade};
                    for (u32 n = 0; n + 2 < mesh->index_count; n += 3)
                        add_triangle(&out, &d, &instances[draws[i].first_instance + k],
                                     &mesh->indices[n], sums);
                }
        }
    }
    return out;
}

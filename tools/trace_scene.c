// trace_scene.c: the level's triangles in world space, a hierarchy of boxes over them, and which of
// them a ray meets. Data in: a packet and its assets. Data out: TraceScene (trace.h).
// Called by: trace_path.c, reference.c, tests. Does not: know light.
//
// Hierarchy: binned surface area heuristic (Wald 2007), 16 bins; triangle test: Moeller and
// Trumbore 1997.
#include "trace.h"
#include "../engine/base/log.h"
#include "../engine/world/components.h"
#include <string.h>

#define BINS       16
#define LEAF_SIZE  4
#define STACK_CAP  96
#define EDGE_SHARE 1e-6f // of a barycentric: rays along an edge meet one of its triangles

// Beyond TRACE_*: of triangles and rays.
enum {
    SOLID = 1 << 2,     // not blended
    ONE_SIDED = 1 << 3, // the eye passes through its back
    HAS_HOLES = 1 << 4, // alpha mask
};

// --- Hierarchy ---

typedef struct Box {
    f32 low[3], high[3];
} Box;
static const Box empty_box = {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};

static void box_grow(Box *box, const Box *other) {
    for (u32 a = 0; a < 3; a++) {
        box->low[a] = MIN(box->low[a], other->low[a]);
        box->high[a] = MAX(box->high[a], other->high[a]);
    }
}
static f32 box_area(const Box *box) {
    f32 x = box->high[0] - box->low[0], y = box->high[1] - box->low[1],
        z = box->high[2] - box->low[2];
    return x < 0.0f ? 0.0f : x * y + y * z + z * x;
}
static Box triangle_box(const TraceTriangle *t) {
    Box box;
    for (u32 a = 0; a < 3; a++) {
        f32 p = t->corner[a], q = p + t->edge1[a], r = p + t->edge2[a];
        box.low[a] = MIN(p, MIN(q, r));
        box.high[a] = MAX(p, MAX(q, r));
    }
    return box;
}

typedef struct Builder {
    TraceTriangle *triangles;
    Box *boxes;
    TraceNode *nodes;
    u32 node_count;
} Builder;

static f32 middle(const Box *box, u32 axis) { return 0.5f * (box->low[axis] + box->high[axis]); }

static void swap_triangles(Builder *b, u32 i, u32 k) {
    TraceTriangle triangle = b->triangles[i];
    Box box = b->boxes[i];
    b->triangles[i] = b->triangles[k], b->boxes[i] = b->boxes[k];
    b->triangles[k] = triangle, b->boxes[k] = box;
}

// The cheapest of 15 planes along an axis; its cost in areas times triangles.
static f32 best_plane(const Builder *b, u32 first, u32 count, u32 axis, f32 low, f32 high,
                      u32 *plane) {
    Box bins[BINS];
    u32 counts[BINS] = {0};
    for (u32 i = 0; i < BINS; i++) bins[i] = empty_box;
    f32 rate = BINS / (high - low);
    for (u32 i = first; i < first + count; i++) {
        u32 bin = MIN((u32)((middle(&b->boxes[i], axis) - low) * rate), BINS - 1);
        box_grow(&bins[bin], &b->boxes[i]);
        counts[bin]++;
    }
    f32 below[BINS], best = 1e30f;
    Box box = empty_box;
    u32 sum = 0;
    for (u32 i = 0; i + 1 < BINS; i++) {
        box_grow(&box, &bins[i]);
        sum += counts[i];
        below[i] = box_area(&box) * (f32)sum;
    }
    box = empty_box;
    sum = 0;
    for (u32 i = BINS - 1; i > 0; i--) {
        box_grow(&box, &bins[i]);
        sum += counts[i];
        f32 cost = below[i - 1] + box_area(&box) * (f32)sum;
        if (sum > 0 && sum < count && cost < best) best = cost, *plane = i;
    }
    return best;
}

// Parts the range; returns the count of the first part, 0 = it stays one leaf.
static u32 split_range(Builder *b, u32 first, u32 count, const Box *box) {
    Box middles = empty_box;
    for (u32 i = first; i < first + count; i++) {
        Box point;
        for (u32 a = 0; a < 3; a++) point.low[a] = point.high[a] = middle(&b->boxes[i], a);
        box_grow(&middles, &point);
    }
    f32 best = box_area(box) * (f32)count;
    u32 axis = 3, plane = 0;
    for (u32 a = 0; a < 3; a++) {
        u32 here = 0;
        if (!(middles.high[a] - middles.low[a] > 1e-6f)) continue;
        f32 cost = best_plane(b, first, count, a, middles.low[a], middles.high[a], &here);
        if (cost < best) best = cost, axis = a, plane = here;
    }
    if (axis == 3) return count > 16 ? count / 2 : 0; // all in one place
    f32 rate = BINS / (middles.high[axis] - middles.low[axis]);
    u32 left = first, right = first + count;
    while (left < right) {
        u32 bin = MIN((u32)((middle(&b->boxes[left], axis) - middles.low[axis]) * rate), BINS - 1);
        if (bin < plane)
            left++;
        else
            swap_triangles(b, left, --right);
    }
    return left - first;
}

static void build_node(Builder *b, u32 node, u32 first, u32 count, u32 depth) {
    Box box = empty_box;
    for (u32 i = first; i < first + count; i++) box_grow(&box, &b->boxes[i]);
    TraceNode *out = &b->nodes[node];
    memcpy(out->low, box.low, sizeof box.low);
    memcpy(out->high, box.high, sizeof box.high);
    u32 part = count > LEAF_SIZE && depth < STACK_CAP / 2 ? split_range(b, first, count, &box) : 0;
    if (part == 0 || part == count) {
        out->first = first;
        out->count = count;
        return;
    }
    u32 children = b->node_count;
    b->node_count += 2;
    out->first = children;
    out->count = 0;
    build_node(b, children, first, part, depth + 1);
    build_node(b, children + 1, first + part, count - part, depth + 1);
}

// --- The packet's triangles ---

static u32 draw_triangles(const TraceScene *scene, const PacketDraw *draw, const MeshLod **lod) {
    const Mesh *mesh = &scene->assets->meshes[draw->mesh];
    *lod = &mesh->lods[MIN(draw->lod, MAX(mesh->lod_count, 1) - 1)];
    return (*lod)->index_count / 3;
}

static void add_instance(TraceScene *scene, const PacketDraw *draw, u32 index, u8 flags) {
    const InstanceRecord *record = &PACKET_DATA(scene->packet, instances, InstanceRecord)[index];
    const Mesh *mesh = &scene->assets->meshes[draw->mesh];
    const PacketMaterial *binding = &scene->bindings[draw->material];
    const MeshLod *lod;
    u32 count = draw_triangles(scene, draw, &lod);
    TraceInstance *instance = &scene->instances[scene->instance_count];
    memcpy(instance->world.m, record->world, sizeof instance->world.m);
    instance->mesh = draw->mesh;
    instance->material = draw->material;
    instance->flags = flags | SOLID;
    if (!binding->double_sided) instance->flags |= ONE_SIDED;
    if (binding->alpha_mode == ALPHA_MASK) instance->flags |= HAS_HOLES;
    for (u32 i = 0; i < count; i++) {
        const u32 *corners = &mesh->indices[lod->first_index + 3 * i];
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) {
            const f32 *v = mesh->vertices[corners[k]].position;
            p[k] = mat34_point(&instance->world, vec3(v[0], v[1], v[2]));
        }
        TraceTriangle *t = &scene->triangles[scene->triangle_count++];
        *t = (TraceTriangle){.corner = {p[0].x, p[0].y, p[0].z},
                             .edge1 = {p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z},
                             .edge2 = {p[2].x - p[0].x, p[2].y - p[0].y, p[2].z - p[0].z},
                             .instance = scene->instance_count,
                             .first_index = lod->first_index + 3 * i,
                             .flags = instance->flags};
    }
    scene->instance_count++;
}

static void add_draws(TraceScene *scene, PacketSection section, const u8 *flags) {
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)scene->packet + section.offset);
    for (u32 i = 0; i < section.count; i++) {
        const PacketDraw *draw = &draws[i];
        for (u32 k = 0; k < draw->instance_count; k++) {
            u32 index = draw->first_instance + k;
            add_instance(scene, draw, index, flags ? flags[index] : TRACE_BOUNCES | TRACE_SHADOWS);
        }
    }
}

static u64 count_draws(const TraceScene *scene, PacketSection section, u32 *instances) {
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)scene->packet + section.offset);
    u64 count = 0;
    for (u32 i = 0; i < section.count; i++) {
        const MeshLod *lod;
        count += (u64)draw_triangles(scene, &draws[i], &lod) * draws[i].instance_count;
        *instances += draws[i].instance_count;
    }
    return count;
}

// --- Lights ---

static TraceLight light_from(const f32 position[4], const f32 color[4]) {
    return (TraceLight){.position = {position[0], position[1], position[2]},
                        .color = {color[0], color[1], color[2]},
                        .highlight = color[3],
                        .inverse_range2 = position[3]};
}

static TraceLight light_from_gi(const GiLightRecord *record) {
    TraceLight light = light_from(record->position, record->color);
    light.kind = (u32)record->extra[1];
    light.direction = vec3(record->direction[0], record->direction[1], record->direction[2]);
    light.cos_outer = record->direction[3];
    light.edge = record->extra[0];
    return light;
}

static TraceLight directional_from(const DirectionalRecord *record, bool shadowed) {
    return (TraceLight){
        .direction = {record->direction[0], record->direction[1], record->direction[2]},
        .color = {record->color[0], record->color[1], record->color[2]},
        .highlight = 1.0f,
        .kind = 2,
        .shadowed = shadowed};
}

static void collect_lights(TraceScene *scene, Arena *arena) {
    const Packet *packet = scene->packet;
    const LightRecord *lights = PACKET_DATA(packet, lights, LightRecord);
    const SpotRecord *spots = PACKET_DATA(packet, spots, SpotRecord);
    const DirectionalRecord *suns = PACKET_DATA(packet, directionals, DirectionalRecord);
    const GiLightRecord *voxel = PACKET_DATA(packet, gi_lights, GiLightRecord);
    const TracedLightRecord *traced = PACKET_DATA(packet, traced_lights, TracedLightRecord);
    u32 points = packet->frame.counts[0], spot_count = packet->frame.counts[1];
    u32 sun_count = packet->directionals.count;
    scene->seen_lights = ARENA_PUSH(arena, TraceLight,
                                    points + spot_count + sun_count + packet->traced_lights.count);
    scene->far_lights = ARENA_PUSH(arena, TraceLight, sun_count + packet->gi_lights.count);
    bool has_gi = packet->gi.params.enabled != 0;
    for (u32 i = 0; i < points + spot_count; i++) {
        TraceLight light = light_from(lights[i].position, lights[i].color);
        if (i >= points) {
            const SpotRecord *spot = &spots[i - points];
            light.kind = 1;
            light.direction = vec3(spot->direction[0], spot->direction[1], spot->direction[2]);
            light.cos_outer = spot->direction[3];
            light.edge = spot->edge[0];
        }
        scene->seen_lights[scene->seen_count++] = light;
    }
    for (u32 i = 0; i < packet->traced_lights.count; i++) {
        TraceLight light = light_from_gi(&traced[i].light);
        light.shadowed = true;
        scene->seen_lights[scene->seen_count++] = light;
    }
    bool suns_are_voxel_lights = false;
    for (u32 i = 0; has_gi && i < packet->gi_lights.count; i++) {
        TraceLight light = light_from_gi(&voxel[i]);
        light.shadowed = voxel[i].color[3] > 0.5f;
        light.highlight = 1.0f;
        suns_are_voxel_lights |= light.kind == 2;
        // There the way it shines, here the way to it.
        if (light.kind == 2) light.direction = vec3_scale(light.direction, -1.0f);
        scene->far_lights[scene->far_count++] = light;
    }
    for (u32 i = 0; i < sun_count; i++) {
        bool shadowed = i == 0 && suns[i].color[3] > 0.5f && packet->shadow_size_px > 0;
        scene->seen_lights[scene->seen_count++] = directional_from(&suns[i], shadowed);
        if (has_gi && !suns_are_voxel_lights)
            scene->far_lights[scene->far_count++] = directional_from(&suns[i], shadowed);
    }
    if (!has_gi) { // there is no second opinion
        scene->far_lights = scene->seen_lights;
        scene->far_count = scene->seen_count;
    }
}

// --- Emitters ---

static Vec3 from_array(const f32 v[3]) { return vec3(v[0], v[1], v[2]); }

static f32 triangle_area(const TraceTriangle *t) {
    return 0.5f * vec3_length(vec3_cross(from_array(t->edge1), from_array(t->edge2)));
}

static void collect_emitters(TraceScene *scene, Arena *arena) {
    scene->emitter_of = ARENA_PUSH(arena, u32, scene->triangle_count);
    f32 *power = ARENA_PUSH(arena, f32, scene->triangle_count);
    u32 count = 0;
    f64 sum = 0.0;
    for (u32 i = 0; i < scene->triangle_count; i++) {
        const TraceTriangle *t = &scene->triangles[i];
        const MaterialRecord *m = &scene->materials[scene->instances[t->instance].material];
        f32 light = 0.0f;
        for (u32 k = 0; k < 3; k++) light += m->emissive[k] + m->extra[k + 1];
        scene->emitter_of[i] = UINT32_MAX;
        if (!(t->flags & TRACE_BOUNCES)) continue;
        power[i] = light * triangle_area(t);
        count += power[i] > 0.0f;
        sum += power[i];
    }
    scene->emitters = ARENA_PUSH(arena, TraceEmitter, count);
    f64 before = 0.0;
    for (u32 i = 0; i < scene->triangle_count; i++) {
        if (!(power[i] > 0.0f)) continue;
        before += power[i];
        scene->emitter_of[i] = scene->emitter_count;
        scene->emitters[scene->emitter_count++] =
            (TraceEmitter){i, triangle_area(&scene->triangles[i]), (f32)(before / sum)};
    }
    if (scene->emitter_count) scene->emitters[scene->emitter_count - 1].cumulative = 1.0f;
}

bool trace_scene_create(TraceScene *scene, const Packet *packet, const AssetStore *assets,
                        const u8 *instance_flags, Arena *arena) {
    *scene = (TraceScene){.packet = packet,
                          .assets = assets,
                          .materials = PACKET_DATA(packet, materials, MaterialRecord),
                          .bindings = PACKET_DATA(packet, material_bindings, PacketMaterial)};
    u32 instances = 0;
    u64 count = count_draws(scene, packet->opaque_draws, &instances) +
                count_draws(scene, packet->mask_draws, &instances);
    u64 bytes = count * (sizeof(TraceTriangle) + sizeof(Box) + 2 * sizeof(TraceNode) + 16) +
                (u64)instances * sizeof(TraceInstance) + MIB(1);
    if (count >= UINT32_MAX / 2 || !arena_can_push(arena, bytes, CACHE_LINE)) {
        LOG(RENDER_LIMIT, "%llu triangles are too many to trace", (unsigned long long)count);
        return false;
    }
    scene->instances = ARENA_PUSH(arena, TraceInstance, instances);
    scene->triangles = ARENA_PUSH(arena, TraceTriangle, count);
    scene->nodes = ARENA_PUSH_COLUMN(arena, TraceNode, 2 * count + 1);
    add_draws(scene, packet->opaque_draws, instance_flags);
    add_draws(scene, packet->mask_draws, instance_flags);
    Builder builder = {scene->triangles, ARENA_PUSH(arena, Box, count), scene->nodes, 1};
    for (u32 i = 0; i < scene->triangle_count; i++)
        builder.boxes[i] = triangle_box(&scene->triangles[i]);
    build_node(&builder, 0, 0, scene->triangle_count, 0);
    scene->node_count = builder.node_count;
    collect_lights(scene, arena);
    collect_emitters(scene, arena);
    return true;
}

// --- Rays ---

typedef struct Ray {
    f32 from[3], to[3], inverse[3];
    u32 flags;
} Ray;

static Ray make_ray(Vec3 from, Vec3 to, u32 flags) {
    Ray ray = {{from.x, from.y, from.z}, {to.x, to.y, to.z}, {0}, flags};
    for (u32 a = 0; a < 3; a++) ray.inverse[a] = 1.0f / (ray.to[a] != 0.0f ? ray.to[a] : 1e-30f);
    return ray;
}

// Where the ray enters the box, 1e30 = it does not before t_max.
static f32 enter_box(const TraceNode *node, const Ray *ray, f32 t_max) {
    f32 near = 0.0f, far = t_max;
    for (u32 a = 0; a < 3; a++) {
        f32 p = (node->low[a] - ray->from[a]) * ray->inverse[a];
        f32 q = (node->high[a] - ray->from[a]) * ray->inverse[a];
        near = MAX(near, MIN(p, q));
        // A hair more, so that rounding loses no triangle that lies in the box's side.
        far = MIN(far, MAX(p, q) * 1.0000004f);
    }
    return near <= far ? near : 1e30f;
}

static bool hit_triangle(const TraceScene *scene, const Ray *ray, u32 index, f32 t_max,
                         TraceHit *out) {
    const TraceTriangle *t = &scene->triangles[index];
    if ((t->flags & ray->flags) != ray->flags) return false;
    Vec3 to = from_array(ray->to), edge1 = from_array(t->edge1), edge2 = from_array(t->edge2);
    Vec3 p = vec3_cross(to, edge2);
    f32 determinant = vec3_dot(edge1, p);
    if (determinant == 0.0f) return false;
    if (ray->flags == 0 && determinant < 0.0f && (t->flags & ONE_SIDED)) return false;
    f32 inverse = 1.0f / determinant;
    Vec3 s = vec3_sub(from_array(ray->from), from_array(t->corner));
    f32 u = vec3_dot(s, p) * inverse;
    if (u < -EDGE_SHARE || u > 1.0f + EDGE_SHARE) return false;
    Vec3 q = vec3_cross(s, edge1);
    f32 v = vec3_dot(to, q) * inverse;
    if (v < -EDGE_SHARE || u + v > 1.0f + EDGE_SHARE) return false;
    f32 along = vec3_dot(edge2, q) * inverse;
    if (!(along > 0.0f && along < t_max)) return false;
    if ((t->flags & HAS_HOLES) && !trace_triangle_is_solid(scene, t, u, v)) return false;
    *out = (TraceHit){along, u, v, index};
    return true;
}

static TraceHit walk(const TraceScene *scene, const Ray *ray, f32 t_max, bool any) {
    TraceHit best = {t_max, 0, 0, UINT32_MAX};
    struct {
        u32 node;
        f32 near;
    } stack[STACK_CAP];
    u32 depth = 0;
    f32 near = enter_box(&scene->nodes[0], ray, t_max);
    if (scene->triangle_count && near < 1e30f) stack[depth].node = 0, stack[depth++].near = near;
    while (depth > 0) {
        depth--;
        if (stack[depth].near > best.t) continue;
        const TraceNode *node = &scene->nodes[stack[depth].node];
        for (u32 i = 0; i < node->count; i++)
            if (hit_triangle(scene, ray, node->first + i, best.t, &best) && any) return best;
        if (node->count) continue;
        u32 one = node->first, other = one + 1;
        f32 t_one = enter_box(&scene->nodes[one], ray, best.t);
        f32 t_other = enter_box(&scene->nodes[other], ray, best.t);
        if (t_one < t_other) { // the nearer one is looked at first, so it goes on top
            u32 node_swap = one;
            f32 t_swap = t_one;
            one = other, other = node_swap;
            t_one = t_other, t_other = t_swap;
        }
        if (t_one < 1e30f) stack[depth].node = one, stack[depth++].near = t_one;
        if (t_other < 1e30f) stack[depth].node = other, stack[depth++].near = t_other;
    }
    return best;
}

TraceHit trace_nearest(const TraceScene *scene, Vec3 from, Vec3 to, f32 t_max, u32 flags) {
    Ray ray = make_ray(from, to, flags);
    return walk(scene, &ray, t_max, false);
}

bool trace_blocked(const TraceScene *scene, Vec3 from, Vec3 to, f32 t_max, u32 flags) {
    Ray ray = make_ray(from, to, flags);
    return walk(scene, &ray, t_max, true).triangle != UINT32_MAX;
}

// packet_gi.c: is what a stranger's packet says of global illumination safe to render?
// Data in: a packet whose layout, header and materials have been checked. Data out: the first
// reason to refuse, or NULL. Called by: packet.c. Does not: prove that the voxels make sense: a
// wrong light is only a wrong picture. Shapes, indices, and whatever steers a loop are proven.
#include "packet_check.h"
#include <string.h>

#define SIDE_MIN       8
#define LIST_CELLS_MAX 32
#define PROBES_MAX     64
#define LEVELS_MAX     10
#define PLACE_MAX_M    1e7f
// Cones of nearly no opening would step for ever.
#define DIFFUSE_TAN_MIN  0.08f  // 10 degrees and a little less
#define SPECULAR_TAN_MIN 0.008f // 1 degree
#define SHADOW_TAN_MIN   0.0008f
#define TAN_MAX          2.0f

static bool number_is_in(f32 value, f64 min, f64 max) {
    return value >= (f32)min && value <= (f32)max;
}

static const char *check_params(const GiParams *p) {
    bool good = true;
#define B(name)               good &= p->name <= 1;
#define E(name, words, count) good &= p->name < count;
#define U(name, min, max)     good &= p->name >= min && p->name <= max;
#define F(name, min, max)     good &= number_is_in(p->name, min, max);
    GI_PARAMS(B, E, U, F)
#undef B
#undef E
#undef U
#undef F
    return good ? NULL : "parameter of global illumination out of range";
}

static const char *check_absent(const Packet *packet) {
    static const GiRecord nothing;
    const PacketSection sections[] = {packet->gi_instances,     packet->gi_static_draws,
                                      packet->gi_dynamic_draws, packet->gi_lights,
                                      packet->gi_lists,         packet->traced_lights};
    for (u32 i = 0; i < COUNT_OF(sections); i++)
        if (sections[i].count != 0) return "voxels without global illumination";
    if (memcmp(&packet->gi.record, &nothing, sizeof nothing) != 0)
        return "record of global illumination that is off";
    return NULL;
}

// ---- the record ----

static const char *check_grids(const PacketGi *gi) {
    const GiRecord *r = &gi->record;
    u32 side = 32u << gi->params.grid, cascades = r->dims[3], smallest = UINT32_MAX, levels = 1;
    if (cascades != gi->params.cascades) return "another number of voxel grids";
    for (u32 a = 0; a < 3; a++) {
        u32 n = r->dims[a], atlas = gi->params.faces == GI_FACES_APART ? n : n / 2;
        if (n < SIDE_MIN || n > side || (n & (n - 1))) return "voxel grid of an impossible size";
        if (r->atlas[a] != atlas) return "the voxels' atlas differs from their grid";
        smallest = MIN(smallest, atlas);
    }
    while (smallest >> levels > 0 && levels < LEVELS_MAX) levels++;
    if (r->atlas[3] != levels) return "the voxels' atlas has another number of levels";
    if (!floats_finite(r->origin, 4 * GI_CASCADES_CAP)) return "voxel grid is not finite";
    for (u32 c = 0; c < GI_CASCADES_CAP; c++) {
        for (u32 a = 0; a < 3; a++)
            if (!number_is_in(r->origin[c][a], -PLACE_MAX_M, PLACE_MAX_M))
                return "voxel grid is out of reach";
        f32 size = r->origin[c][3];
        if (c < cascades ? !number_is_in(size, 1e-8, 1e6) : size != 0.0f)
            return "voxels of an impossible size";
        if (c + 1 < cascades && size * 2.0f != r->origin[c + 1][3])
            return "nested voxel grids do not fit";
    }
    return NULL;
}

static const char *check_numbers(const Packet *packet) {
    const GiParams *p = &packet->gi.params;
    const GiRecord *r = &packet->gi.record;
    const f32 same[][2] = {{r->strength[0], p->strength},   {r->strength[1], p->ao_lambda},
                           {r->strength[2], p->ao_floor},   {r->strength[3], p->hit},
                           {r->cone[1], p->step_factor},    {r->cone[3], p->offset},
                           {r->scale[0], p->byte_radiance}, {r->scale[1], p->sky}};
    for (u32 i = 0; i < COUNT_OF(same); i++)
        if (same[i][0] != same[i][1]) return "the voxels' record differs from its parameters";
    if (!number_is_in(r->cone[0], DIFFUSE_TAN_MIN, TAN_MAX) ||
        !number_is_in(r->specular[0], SPECULAR_TAN_MIN, TAN_MAX))
        return "cone of an impossible opening";
    if (!number_is_in(r->cone[2], 1e-6, PLACE_MAX_M)) return "cone of an impossible length";
    u32 shift = p->resolution, round_up = (1u << shift) - 1;
    f32 width = (f32)((packet->width_px + round_up) >> shift),
        height = (f32)((packet->height_px + round_up) >> shift);
    if (r->trace[0] != width || r->trace[1] != height || r->trace[2] != 1.0f / width ||
        r->trace[3] != 1.0f / height)
        return "the traced picture differs from the picture size";
    if (r->show[0] >= GI_SHOW_COUNT || r->show[1] > 9 || r->show[2] > 5 || r->show[3] != 0)
        return "unknown picture of voxels";
    return NULL;
}

static const char *check_places(const Packet *packet) {
    const GiRecord *r = &packet->gi.record;
    for (u32 a = 0; a < 3; a++) {
        if (r->light_grid[a] < 1 || r->light_grid[a] > LIST_CELLS_MAX)
            return "the voxels' light grid has an impossible size";
        if (!number_is_in(r->light_grid_origin[a], -PLACE_MAX_M, PLACE_MAX_M) ||
            !number_is_in(r->light_grid_rate[a], 1e-9, 1e9))
            return "the voxels' light grid is out of reach";
        if (r->probes[a] < 2 || r->probes[a] > PROBES_MAX) return "impossible number of probes";
        if (!number_is_in(r->probe_origin[a], -PLACE_MAX_M, PLACE_MAX_M))
            return "probes are out of reach";
    }
    if (r->probes[3] != packet->gi.params.share || !number_is_in(r->probe_origin[3], 1e-6, 1e6))
        return "probes differ from their parameters";
    if (r->light_grid[3] != packet->gi_lights.count ||
        r->counts[0] != packet->traced_lights.count || r->counts[1] != packet->gi_instances.count ||
        r->counts[2] != 0 || r->counts[3] != packet->tick)
        return "the voxels' counts differ from their sections";
    if (packet->traced_lights.count > GI_TRACED_CAP) return "too many lights are traced";
    return NULL;
}

// ---- sections ----

// Draws follow each other without holes, static ones first, so each instance is drawn once.
static const char *check_draws(const Packet *packet, u32 mesh_count) {
    const InstanceRecord *instances = PACKET_DATA(packet, gi_instances, InstanceRecord);
    const PacketMaterial *bindings = PACKET_DATA(packet, material_bindings, PacketMaterial);
    const PacketSection lists[] = {packet->gi_static_draws, packet->gi_dynamic_draws};
    u64 cursor = 0;
    for (u32 list = 0; list < COUNT_OF(lists); list++) {
        const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + lists[list].offset);
        for (u32 i = 0; i < lists[list].count; i++) {
            const PacketDraw *draw = &draws[i];
            if (draw->mesh == 0 || draw->mesh >= mesh_count)
                return "voxel draw names a mesh that is not there";
            if (draw->material >= packet->materials.count ||
                bindings[draw->material].alpha_mode > 1)
                return "voxel draw names a material that is not there";
            if (draw->lod != 0 || draw->vertex_lit != 0) return "voxel draw of simpler meshes";
            if (draw->instance_count == 0 || draw->first_instance != cursor)
                return "voxel draw names instances that are not its own";
            cursor += draw->instance_count;
        }
    }
    if (cursor != packet->gi_instances.count) return "voxel draws do not add up";
    for (u32 i = 0; i < packet->gi_instances.count; i++) {
        if (!floats_finite(instances[i].world, 12)) return "voxel instance is not finite";
        if (instances[i].ids[0] >= packet->materials.count)
            return "voxel instance names a material that is not there";
    }
    return NULL;
}

static bool light_is_good(const GiLightRecord *light, u32 kinds) {
    f32 kind = light->extra[1], shadow = light->color[3];
    return (kind == 0.0f || kind == 1.0f || (kind == 2.0f && kinds > 2)) &&
           (kind == 2.0f || light->position[3] >= 0.0f) &&
           (kinds > 2 || shadow == 0.0f || shadow == 1.0f || shadow == 2.0f || shadow == 3.0f);
}

static const char *check_lights(const Packet *packet) {
    const GiLightRecord *lights = PACKET_DATA(packet, gi_lights, GiLightRecord);
    const TracedLightRecord *traced = PACKET_DATA(packet, traced_lights, TracedLightRecord);
    for (u32 i = 0; i < packet->gi_lights.count; i++)
        if (!light_is_good(&lights[i], 2)) return "light of voxels has an unknown kind";
    for (u32 i = 0; i < packet->traced_lights.count; i++) {
        const f32 *shadow = traced[i].shadow;
        if (!light_is_good(&traced[i].light, 3)) return "traced light has an unknown kind";
        if (!number_is_in(shadow[0], SHADOW_TAN_MIN, TAN_MAX) || !(shadow[1] >= 0.0f) ||
            (shadow[2] != 0.0f && shadow[2] != 1.0f))
            return "traced light has an impossible shadow";
    }
    return NULL;
}

// Lists lie in the cells' order without holes; each is ascending.
static const char *check_lists(const Packet *packet) {
    const u32 *grid = packet->gi.record.light_grid, *words = PACKET_DATA(packet, gi_lists, u32);
    u32 cells = grid[0] * grid[1] * grid[2], count = packet->gi_lists.count;
    u64 cursor = 2ull * cells;
    if (count < cursor) return "the voxels' light lists are too short";
    for (u32 i = 0; i < cells; i++) {
        u32 first = words[2 * i], length = words[2 * i + 1];
        if (first != cursor || cursor + length > count)
            return "the voxels' light list does not lie where it belongs";
        bool good = true;
        for (u32 k = 0; k < length; k++)
            good &= words[first + k] < packet->gi_lights.count &&
                    (k == 0 || words[first + k] > words[first + k - 1]);
        if (!good) return "the voxels' light list is damaged";
        cursor += length;
    }
    return cursor == count ? NULL : "the voxels' light lists do not add up";
}

const char *packet_check_gi(const Packet *packet, u32 mesh_count) {
    const DirectionalRecord *suns = PACKET_DATA(packet, directionals, DirectionalRecord);
    for (u32 i = 0; i < packet->directionals.count; i++) {
        f32 shadow = suns[i].direction[3];
        if (shadow != -1.0f && shadow != 0.0f && shadow != 1.0f && shadow != 2.0f && shadow != 3.0f)
            return "directional light has an unknown shadow";
    }
    const char *problem = check_params(&packet->gi.params);
    if (problem) return problem;
    if (!packet->gi.params.enabled) return check_absent(packet);
    problem = check_grids(&packet->gi);
    if (!problem) problem = check_numbers(packet);
    if (!problem) problem = check_places(packet);
    if (!problem) problem = check_draws(packet, mesh_count);
    if (!problem) problem = check_lights(packet);
    if (!problem) problem = check_lists(packet);
    return problem;
}

// gi_volume.c: what global illumination works with: parameters, the box, its grids, the record.
// Data in: the level's `gi` row, settings, drawables with their meshes' boxes, the view. Data out:
// GiParams and a GiRecord without lights (gi_lists.c) and counts of sections (packet_build.c).
// Called by: packet_build. Does not: choose lights or drawables, or know what a GPU can hold.
//
// The grid must not breathe: its box hangs on static things alone, and nested grids about the
// camera move in steps of 8 of their voxels, which are voxels of the next coarser grid as well.
#include "gi.h"
#include "../base/log.h"
#include <string.h>

// A box that is found, not given, has so many voxels of air on each side: surfaces on its faces,
// and the starts of cones before them, are inside.
#define MARGIN_VOXELS 1
#define STEP_VOXELS   8
#define SIDE_MIN      8 // voxels
#define BOX_MAX_M     1e6f
#define BOX_MIN_M     1e-3f

// ---- parameters ----

#define GI_LEVEL_FIELD_(type, name, ...) Column##type name;
typedef struct GiLevel {
    GI_COLUMNS(GI_LEVEL_FIELD_)
} GiLevel;
#undef GI_LEVEL_FIELD_

static GiLevel level_read(const World *world) {
    const GiTable *t = WORLD_TABLE(world, Gi, gi);
    bool present = t->table.count > 0;
#define GI_LEVEL_READ_(type, name, unit, initial, ...)                                             \
    .name = present ? t->name[0] : (Column##type)(initial),
    GiLevel level = {GI_COLUMNS(GI_LEVEL_READ_)};
#undef GI_LEVEL_READ_
    if (!present) level.enabled = 0;
    return level;
}

static u32 param_word(u32 setting, u32 level, u32 count) {
    return MIN(setting ? setting - 1 : level, count - 1);
}
static u32 param_whole(u32 setting, u32 level, u32 min, u32 max) {
    return CLAMP(setting >= min ? setting : level, min, max);
}
static f32 param_number(f32 setting, f32 level, f32 min, f32 max) {
    f32 value = setting >= min ? setting : level;
    return value >= min ? MIN(value, max) : min; // a level's NaN too
}

GiParams gi_params_resolve(const World *world, const RenderSettings *settings) {
    GiLevel level = level_read(world);
#define B(name)               .name = param_word(settings->gi_##name, level.name != 0, 2),
#define E(name, words, count) .name = param_word(settings->gi_##name, level.name, count),
#define U(name, min, max)     .name = param_whole(settings->gi_##name, level.name, min, max),
#define F(name, min, max)                                                                          \
    .name = param_number(settings->gi_##name, level.name, (f32)(min), (f32)(max)),
    return (GiParams){GI_PARAMS(B, E, U, F)};
#undef B
#undef E
#undef U
#undef F
}

// ---- bounds ----

// The mesh's box, turned: its centre goes along, its half sides add up by their absolute values.
static void grow_box(const DrawableTable *d, u32 row, const Mesh *mesh, f32 low[3], f32 high[3]) {
    Mat34 world;
    columns_get_mat34(&d->w00, row, world.m);
    for (u32 a = 0; a < 3; a++) {
        const f32 *m = &world.m[4 * a];
        f32 center = m[3], half = 0.0f;
        const f32 from[3] = {mesh->min.x, mesh->min.y, mesh->min.z};
        const f32 to[3] = {mesh->max.x, mesh->max.y, mesh->max.z};
        for (u32 k = 0; k < 3; k++) {
            center += m[k] * (from[k] + to[k]) * 0.5f;
            half += fabsf(m[k]) * (to[k] - from[k]) * 0.5f;
        }
        low[a] = MIN(low[a], center - half);
        high[a] = MAX(high[a], center + half);
    }
}

static bool box_is_good(const f32 low[3], const f32 high[3]) {
    bool good = true;
    for (u32 a = 0; a < 3; a++)
        good &= low[a] <= high[a] && low[a] > -BOX_MAX_M && high[a] < BOX_MAX_M;
    return good;
}

bool gi_level_bounds(const World *world, const AssetStore *assets, f32 low[3], f32 high[3]) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const MaterialTable *materials = WORLD_TABLE(world, Material, material);
    static const u32 modes[] = {VOXEL_STATIC, VOXEL_DYNAMIC};
    for (u32 mode = 0; mode < COUNT_OF(modes); mode++) {
        for (u32 a = 0; a < 3; a++) low[a] = BOX_MAX_M, high[a] = -BOX_MAX_M;
        for (u32 row = 0; row < d->table.count; row++) {
            u32 owner = table_row(&instances->table, d->owner[row]);
            if (owner == ROW_NONE || instances->voxel_mode[owner] != modes[mode]) continue;
            if (d->mesh[row] == 0 || d->mesh[row] >= assets->mesh_count) continue;
            u32 material = table_row(&materials->table, d->material[row]);
            if (material != ROW_NONE && materials->alpha_mode[material] >= ALPHA_BLEND) continue;
            grow_box(d, row, &assets->meshes[d->mesh[row]], low, high);
        }
        if (box_is_good(low, high)) return true;
    }
    return false;
}

// ---- grids ----

static u32 power_of_two(f32 count, u32 max) {
    u32 n = SIDE_MIN;
    while (n < max && (f32)n < count) n *= 2;
    return n;
}

// Coarsest grid: cubic voxels, the longest side of the box has `side` of them.
static bool fit_grid(const GiLevel *level, const World *world, const AssetStore *assets, u32 side,
                     GiRecord *record, f32 origin[4], f32 low[3], f32 high[3]) {
    bool found = gi_level_bounds(world, assets, low, high);
    const f32 size[3] = {level->size_x, level->size_y, level->size_z};
    const f32 center[3] = {level->center_x, level->center_y, level->center_z};
    f32 cells = (f32)side;
    bool given[3];
    for (u32 a = 0; a < 3; a++) {
        given[a] = size[a] > 0.0f;
        if (!given[a] && !found) return false;
        if (given[a]) low[a] = center[a] - 0.5f * size[a], high[a] = center[a] + 0.5f * size[a];
        high[a] = MAX(high[a], low[a] + BOX_MIN_M);
    }
    if (!box_is_good(low, high)) return false;
    f32 voxel = 0.0f; // the axis that asks for the largest one decides
    for (u32 a = 0; a < 3; a++) {
        f32 margin = given[a] ? 0.0f : 2.0f * MARGIN_VOXELS, length = high[a] - low[a];
        voxel = MAX(voxel, length / (cells - margin));
    }
    for (u32 a = 0; a < 3; a++) {
        f32 margin = given[a] ? 0.0f : 2.0f * MARGIN_VOXELS;
        // A hair more than a whole number is no voxel more.
        f32 count = ceilf((high[a] - low[a]) / voxel - 1e-3f) + margin;
        record->dims[a] = power_of_two(count, side);
        origin[a] = 0.5f * (low[a] + high[a]) - 0.5f * (f32)record->dims[a] * voxel;
        low[a] -= 0.5f * margin * voxel, high[a] += 0.5f * margin * voxel;
    }
    origin[3] = voxel;
    return true;
}

// Finer grids, from the coarsest down: half the size about the eye, each inside the next.
static void place_cascades(GiRecord *record, const f32 coarsest[4], Vec3 eye) {
    u32 count = record->dims[3];
    const f32 at[3] = {eye.x, eye.y, eye.z};
    i32 outer[3] = {0, 0, 0}; // lower corner of the next coarser one, in its voxels
    memcpy(record->origin[count - 1], coarsest, sizeof record->origin[0]);
    f32 voxel = coarsest[3];
    for (u32 c = count - 1; c-- > 0;) {
        voxel *= 0.5f;
        for (u32 a = 0; a < 3; a++) {
            i32 dims = (i32)record->dims[a];
            f32 wish = (at[a] - coarsest[a]) / voxel - 0.5f * (f32)dims;
            wish = wish >= -1e6f ? MIN(wish, 1e6f) : -1e6f;
            i32 corner = (i32)floorf(wish / STEP_VOXELS + 0.5f) * STEP_VOXELS;
            outer[a] = CLAMP(corner, 2 * outer[a], 2 * outer[a] + dims);
            record->origin[c][a] = coarsest[a] + (f32)outer[a] * voxel;
        }
        record->origin[c][3] = voxel;
    }
}

static void shape_atlas(GiRecord *record, u32 faces) {
    u32 smallest = UINT32_MAX, levels = 1;
    for (u32 a = 0; a < 3; a++) {
        record->atlas[a] = faces == GI_FACES_APART ? record->dims[a] : record->dims[a] / 2;
        smallest = MIN(smallest, record->atlas[a]);
    }
    while (smallest >> levels > 0 && levels < GI_ATLAS_LEVELS) levels++;
    record->atlas[3] = levels;
}

// Over the box itself: what rounding to powers of two adds is empty.
static void place_probes(GiRecord *record, const GiParams *params, const f32 low[3],
                         const f32 high[3]) {
    f32 spacing = params->probe_spacing, longest = 0.0f;
    for (u32 a = 0; a < 3; a++) longest = MAX(longest, high[a] - low[a]);
    f32 least = longest / (GI_PROBES_CAP - 1);
    static bool told;
    if (spacing < least && params->diffuse == GI_DIFFUSE_PROBES && !told) {
        LOG(RENDER_LIMIT, "probes stand %.3g m apart instead of %.3g: at most %u along a side",
            (f64)least, (f64)spacing, GI_PROBES_CAP);
        told = true;
    }
    spacing = MAX(spacing, least);
    for (u32 a = 0; a < 3; a++) {
        f32 gaps = ceilf((high[a] - low[a]) / spacing - 1e-3f);
        gaps = CLAMP(gaps, 1.0f, (f32)(GI_PROBES_CAP - 1));
        record->probes[a] = (u32)gaps + 1;
        record->probe_origin[a] = 0.5f * (low[a] + high[a]) - 0.5f * gaps * spacing;
    }
    record->probe_origin[3] = spacing;
    record->probes[3] = params->share;
}

// ---- the record ----

static f32 tan_half(f32 opening_deg) { return det_tan(DEG_TO_RAD(0.5f * opening_deg)); }

static void write_numbers(GiRecord *record, const GiParams *params) {
    const f32 *coarsest = record->origin[record->dims[3] - 1];
    f32 diagonal2 = 0.0f;
    for (u32 a = 0; a < 3; a++) {
        f32 side = (f32)record->dims[a] * coarsest[3];
        diagonal2 += side * side;
    }
    record->strength[0] = params->strength;
    record->strength[1] = params->ao_lambda;
    record->strength[2] = params->ao_floor;
    record->strength[3] = params->hit;
    record->cone[0] = tan_half(params->diffuse_aperture);
    record->cone[1] = params->step_factor;
    record->cone[2] = params->distance > 0.0f ? params->distance : sqrtf(diagonal2);
    record->cone[3] = params->offset;
    record->specular[0] = tan_half(params->specular_aperture);
    record->scale[0] = params->byte_radiance;
    record->scale[1] = params->sky;
}

static void write_picture(GiRecord *record, const GiParams *params, const PacketBuildDesc *desc) {
    u32 shift = params->resolution, round_up = (1u << shift) - 1;
    f32 width = (f32)((desc->width_px + round_up) >> shift),
        height = (f32)((desc->height_px + round_up) >> shift);
    record->trace[0] = width, record->trace[1] = height;
    record->trace[2] = 1.0f / width, record->trace[3] = 1.0f / height;
    record->counts[3] = desc->world->tick;
    record->show[0] = desc->settings.gi_show;
    record->show[1] = desc->settings.gi_show_level;
    record->show[2] = desc->settings.gi_show_direction;
}

GiParts gi_begin_packet(const PacketBuildDesc *desc, const PacketView *view) {
    GiParts parts = {.params = gi_params_resolve(desc->world, &desc->settings)};
    GiRecord *record = &parts.record;
    if (!parts.params.enabled) return parts;
    GiLevel level = level_read(desc->world);
    f32 coarsest[4], low[3], high[3];
    if (!fit_grid(&level, desc->world, desc->assets, 32u << parts.params.grid, record, coarsest,
                  low, high)) {
        parts.params.enabled = 0;
        *record = (GiRecord){0};
        return parts;
    }
    record->dims[3] = parts.params.cascades;
    place_cascades(record, coarsest, view->position);
    shape_atlas(record, parts.params.faces);
    place_probes(record, &parts.params, low, high);
    write_numbers(record, &parts.params);
    write_picture(record, &parts.params, desc);
    return parts;
}

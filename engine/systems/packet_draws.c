// packet_draws.c: material palette, drawcalls, instance records.
// Data in: drawables that passed culling, the material table, meshes. Data out: per alpha mode a
// list of drawcalls, each a run of instances with the same mesh, level of detail and material; the
// palette that G-buffers index. Called by: packet_build (view, and again for the shadow map). Does
// not: cull, or know how a draw is recorded.
//
// Draws of what is voxelised have nothing to do with the view: by mesh, material, entity.
//
// Order: alpha mode, band of distance, material, level of detail, mesh, entity; blended ones far to
// near. It comes from sorting 64-bit keys, so it does not depend on the order of rows. The bands
// are there because a pixel that something nearer covers already is not shaded again.
#include "packet_parts.h"
#include "../base/jobs.h"
#include "../base/log.h"
#include <math.h>
#include <string.h>

#define INSTANCES_PER_JOB 1024

// ---- materials ----

static void make_material(const MaterialTable *m, u32 row, MaterialRecord *record,
                          PacketMaterial *binding) {
    f32 strength = m->emissive_strength[row];
    f32 emissive[3] = {m->emissive_r[row] * strength, m->emissive_g[row] * strength,
                       m->emissive_b[row] * strength};
    bool textured = m->emissive_texture[row] != 0;
    // Words beyond the list can only come from a game's mistake; here they would become indices.
    u32 brdf = MIN(m->brdf[row], BRDF_BLINN_PHONG_NORMALIZED);
    u32 alpha_mode = MIN(m->alpha_mode[row], ALPHA_BLEND);
    f32 power = m->power[row], sigma2 = m->diffuse_roughness[row] * m->diffuse_roughness[row];
    bool oren_nayar = m->diffuse[row] == DIFFUSE_OREN_NAYAR;
    f32 normalisation = 1.0f;
    if (brdf == BRDF_LAMBERT) normalisation = 0.0f;
    // Energy of a Blinn-Phong lobe (Akenine-Moller et al., Real-Time Rendering, 3rd ed., eq. 7.49).
    if (brdf == BRDF_BLINN_PHONG_NORMALIZED) normalisation = (power + 8.0f) / (8.0f * PI_F);
    *record = (MaterialRecord){
        .albedo = {m->albedo_r[row], m->albedo_g[row], m->albedo_b[row],
                   alpha_mode == ALPHA_MASK ? m->alpha_cutoff[row] : 0.0f},
        .specular = {m->specular_r[row], m->specular_g[row], m->specular_b[row], power},
        .emissive = {textured ? 0.0f : emissive[0], textured ? 0.0f : emissive[1],
                     textured ? 0.0f : emissive[2], m->receives_dynamic_light[row] ? 1.0f : 0.0f},
        // Oren and Nayar 1994, "Generalization of Lambert's reflectance model", eq. 30.
        .lobes = {(f32)brdf, normalisation,
                  oren_nayar ? 1.0f - 0.5f * sigma2 / (sigma2 + 0.33f) : 1.0f,
                  oren_nayar ? 0.45f * sigma2 / (sigma2 + 0.09f) : 0.0f},
        .extra = {m->fresnel[row] ? 1.0f : 0.0f, textured ? emissive[0] : 0.0f,
                  textured ? emissive[1] : 0.0f, textured ? emissive[2] : 0.0f}};
    *binding = (PacketMaterial){.albedo_texture = m->albedo_texture[row],
                                .normal_texture = m->normal_texture[row],
                                .emissive_texture = m->emissive_texture[row],
                                .alpha_mode = alpha_mode,
                                .double_sided = m->double_sided[row] != 0,
                                .emissive_pass = textured};
}

// What a drawable without a material gets: the columns' own defaults would need a table row.
static const MaterialRecord missing_record = {.albedo = {0.8f, 0.8f, 0.8f, 0.0f},
                                              .emissive = {0.0f, 0.0f, 0.0f, 1.0f},
                                              .lobes = {BRDF_LAMBERT, 0.0f, 1.0f, 0.0f}};

// Palette index of a drawable's material. Neighbouring rows mostly share one: *memo spares the
// look-up.
typedef struct MaterialMemo {
    Entity entity;
    u32 row;
} MaterialMemo;
static u32 material_row(const MaterialTable *materials, Entity entity, MaterialMemo *memo) {
    if (entity != memo->entity)
        *memo = (MaterialMemo){entity, table_row(&materials->table, entity)};
    return memo->row;
}

// The lobes that most drawables of the level have (not of the view: they must not change while the
// camera turns), for G-buffers that do not say which material a pixel has. Among equals the first.
static void choose_common_lobes(MaterialPalette *palette, const u32 *uses) {
    u32 most = 0, most_shiny = 0;
    f32 *out = palette->common_lobes;
    out[0] = BRDF_LAMBERT, out[1] = 0.0f, out[2] = 1.0f, out[3] = 0.0f;
    for (u32 i = 0; i < palette->count; i++) {
        const MaterialRecord *record = &palette->records[i];
        if (palette->bindings[i].alpha_mode == ALPHA_BLEND) continue; // never in a G-buffer
        if (uses[i] > most) {
            most = uses[i];
            out[1] = record->extra[0], out[2] = record->lobes[2], out[3] = record->lobes[3];
        }
        if (uses[i] > most_shiny && record->lobes[0] != (f32)BRDF_LAMBERT) {
            most_shiny = uses[i];
            out[0] = record->lobes[0];
        }
    }
}

MaterialPalette *packet_collect_materials(const World *world, Arena *scratch) {
    const MaterialTable *materials = WORLD_TABLE(world, Material, material);
    const DrawableTable *drawables = WORLD_TABLE(world, Drawable, drawable);
    MaterialPalette *palette = ARENA_PUSH(scratch, MaterialPalette, 1);
    u32 row_count = materials->table.count;
    u32 *used = ARENA_PUSH(scratch, u32, row_count + 1); // drawables; the last: no material
    u32 uses[MATERIALS_CAP] = {0};
    MaterialMemo memo = {ENTITY_NONE, ROW_NONE};
    for (u32 i = 0; i < drawables->table.count; i++) {
        u32 row = material_row(materials, drawables->material[i], &memo);
        used[row == ROW_NONE ? row_count : row]++;
    }
    palette->index_of_row = ARENA_PUSH(scratch, u16, row_count);
    u32 dropped = 0;
    for (u32 row = 0; row < row_count; row++) {
        palette->index_of_row[row] = PALETTE_NONE;
        if (!used[row]) continue;
        if (palette->count == MATERIALS_CAP) {
            palette->index_of_row[row] = MATERIALS_CAP - 1; // wrong surface, but drawn
            dropped++;
            continue;
        }
        u32 index = palette->count++;
        palette->index_of_row[row] = (u16)index;
        uses[index] = used[row];
        make_material(materials, row, &palette->records[index], &palette->bindings[index]);
        palette->brdf_mask |= 1u << (u32)palette->records[index].lobes[0];
        if (materials->diffuse[row] == DIFFUSE_OREN_NAYAR)
            palette->brdf_mask |= BRDF_MASK_OREN_NAYAR;
        if (materials->fresnel[row]) palette->brdf_mask |= BRDF_MASK_FRESNEL;
    }
    if (used[row_count]) {
        palette->missing = MIN(palette->count, MATERIALS_CAP - 1);
        if (palette->count < MATERIALS_CAP) {
            uses[palette->count] = used[row_count];
            palette->records[palette->count++] = missing_record;
            palette->brdf_mask |= 1u << BRDF_LAMBERT;
        }
    }
    choose_common_lobes(palette, uses);
    static bool told;
    if (dropped > 0 && !told)
        LOG(RENDER_LIMIT, "%u materials beyond %u in use look like the last one", dropped,
            MATERIALS_CAP);
    told |= dropped > 0;
    return palette;
}

// ---- sorting ----

typedef struct SortItem {
    u64 key;
    u32 row;
    u16 material, lod; // palette index; level of detail
} SortItem;

// Least significant digit first, eight bits at a time; digits that are the same in all keys are
// skipped. Stable. Returns which of the two arrays holds the result.
static SortItem *radix_sort(SortItem *items, SortItem *spare, u32 count) {
    u32 histogram[8][256];
    memset(histogram, 0, sizeof histogram);
    for (u32 i = 0; i < count; i++)
        for (u32 digit = 0; digit < 8; digit++)
            histogram[digit][(items[i].key >> (8 * digit)) & 255]++;
    for (u32 digit = 0; digit < 8 && count > 0; digit++) {
        u32 *places = histogram[digit], shift = 8 * digit;
        if (places[(items[0].key >> shift) & 255] == count) continue;
        for (u32 value = 0, sum = 0; value < 256; value++) {
            u32 here = places[value];
            places[value] = sum;
            sum += here;
        }
        for (u32 i = 0; i < count; i++) spare[places[(items[i].key >> shift) & 255]++] = items[i];
        SortItem *swap = items;
        items = spare;
        spare = swap;
    }
    return items;
}

// Key, from the lowest bit: entity index, mesh (16 bits), level of detail (3), material (9), vertex
// lighting (2), band of distance (4), alpha mode (2). Blended: entity index, distance (32,
// inverted; the bits of a non-negative f32 sort like it), alpha mode.
enum {
    KEY_MESH = ENTITY_INDEX_BITS,
    KEY_LOD = KEY_MESH + 16,
    KEY_SURFACE = KEY_LOD + 3,
    KEY_VERTEX = KEY_SURFACE + 9,
    KEY_BAND = KEY_VERTEX + 2,
    KEY_ALPHA = ENTITY_INDEX_BITS + 34,
    BAND_MAX = 15,
    // What is voxelised: entity index, material, mesh.
    VOXEL_KEY_MATERIAL = ENTITY_INDEX_BITS,
    VOXEL_KEY_MESH = VOXEL_KEY_MATERIAL + 9
};
_Static_assert(ASSET_MESHES_MAX <= 1u << 16 && MATERIALS_CAP <= 1u << 9 && MESH_LODS_CAP <= 8 &&
                   KEY_BAND + 4 <= KEY_ALPHA && KEY_ALPHA + 2 <= 64,
               "key fields");

// ---- distance and level of detail ----

// From the eye to the nearest point of a drawable's sphere, m; negative inside.
static f32 sphere_distance(const DrawableTable *d, u32 row, const PacketView *view) {
    Vec3 to = {d->bounds_x[row] - view->position.x, d->bounds_y[row] - view->position.y,
               d->bounds_z[row] - view->position.z};
    return vec3_length(to) - d->bounds_radius[row];
}

// From the eye to the nearest point of a drawable, as far as its sphere and the world's box around
// its mesh tell, m: long thin things are farther than their spheres.
static f32 nearest_distance(const DrawableTable *d, u32 row, const Mesh *mesh,
                            const PacketView *view, f32 to_sphere) {
    f32 m[12], squared = 0.0f;
    columns_get_mat34(&d->w00, row, m);
    Vec3 half = vec3_scale(vec3_sub(mesh->max, mesh->min), 0.5f);
    f32 to[3] = {d->bounds_x[row] - view->position.x, d->bounds_y[row] - view->position.y,
                 d->bounds_z[row] - view->position.z};
    for (u32 axis = 0; axis < 3; axis++) {
        const f32 *w = &m[4 * axis];
        f32 extent = fabsf(w[0]) * half.x + fabsf(w[1]) * half.y + fabsf(w[2]) * half.z;
        f32 gap = MAX(fabsf(to[axis]) - extent, 0.0f);
        squared += gap * gap;
    }
    return MAX(sqrtf(squared), to_sphere);
}

// The coarsest level whose error in the world is no larger. Errors never fall. Nothing forgiven is
// full detail, also where a level without any error is there.
static u32 choose_lod(const Mesh *mesh, f32 world_scale, f32 error_max_m) {
    u32 lod = 0;
    if (!(error_max_m > 0.0f)) return 0;
    while (lod + 1 < mesh->lod_count && mesh->lods[lod + 1].error * world_scale <= error_max_m)
        lod++;
    return lod;
}

// Metres of error that a pixel of the view, or a texel of the shadow map, forgives.
static f32 lod_error_m(f32 error_px, f32 distance, const PacketView *view,
                       const ShadowFit *shadow) {
    if (shadow) return error_px * shadow->texel_m;
    return error_px * MAX(distance, view->near) * 2.0f * view->tan_y / view->height_px;
}

// Half octaves from 1 m: the exponent of the distance's square. At least half the radius: what
// surrounds the camera is a background as a rule, and comes late.
static u32 distance_band(f32 distance, f32 radius) {
    distance = MAX(distance, 0.5f * radius);
    f32 distance2 = distance * distance;
    u32 bits;
    memcpy(&bits, &distance2, sizeof bits);
    u32 exponent = bits >> 23; // not negative: no sign
    return CLAMP(exponent, 127, 127 + BAND_MAX) - 127;
}

// Share of its local light that a drawable gets at its vertices: 0 up to the level's distance, all
// from a quarter beyond, so that nothing pops. It goes by the nearest point: nothing nearer
// changes.
#define VERTEX_BAND 0.25f
static f32 vertex_share(f32 distance, const PacketView *view, const PacketMaterial *binding) {
    f32 from = view->vertex_lighting;
    // A vertex does not know which of its sides is seen.
    if (!(from > 0.0f) || binding->double_sided || binding->alpha_mode == ALPHA_BLEND) return 0.0f;
    return f32_smoothstep(from, from * (1.0f + VERTEX_BAND), distance);
}
static u32 vertex_lit(f32 share) { return share <= 0.0f ? 0 : share < 1.0f ? 1 : 2; }

// ---- keys and runs ----

static u64 blend_key(const DrawableTable *d, u32 row, const PacketView *view) {
    Vec3 to = {d->bounds_x[row] - view->position.x, d->bounds_y[row] - view->position.y,
               d->bounds_z[row] - view->position.z};
    f32 distance2 = vec3_dot(to, to);
    u32 bits;
    memcpy(&bits, &distance2, sizeof bits);
    return (u64)ALPHA_BLEND << KEY_ALPHA | (u64)~bits << ENTITY_INDEX_BITS;
}

DrawLists packet_collect_draws(const PacketBuildDesc *desc, const PacketView *view,
                               const MaterialPalette *palette, const u32 *rows, u32 row_count,
                               const ShadowFit *shadow, Arena *scratch) {
    const DrawableTable *d = WORLD_TABLE(desc->world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(desc->world, Instance, instance);
    const MaterialTable *materials = WORLD_TABLE(desc->world, Material, material);
    SortItem *items = ARENA_PUSH(scratch, SortItem, row_count);
    SortItem *spare = ARENA_PUSH(scratch, SortItem, row_count);
    DrawLists lists = {0};
    MaterialMemo memo = {ENTITY_NONE, ROW_NONE};
    for (u32 i = 0; i < row_count; i++) {
        u32 row = rows[i];
        // The sphere is of the last tick; the mesh may have been changed since.
        if (d->mesh[row] == 0 || d->mesh[row] >= desc->assets->mesh_count) continue;
        u32 place = material_row(materials, d->material[row], &memo);
        u32 material = place == ROW_NONE ? palette->missing : palette->index_of_row[place];
        const PacketMaterial *binding = &palette->bindings[material];
        if (shadow) {
            u32 owner = table_row(&instances->table, d->owner[row]);
            if (owner == ROW_NONE || !instances->casts_shadow[owner] ||
                binding->alpha_mode == ALPHA_BLEND)
                continue;
        }
        const Mesh *mesh = &desc->assets->meshes[d->mesh[row]];
        f32 distance = sphere_distance(d, row, view), radius = d->bounds_radius[row];
        // The sphere's growth from mesh to world is the largest factor on any length.
        f32 world_scale = mesh->radius > 0.0f ? radius / mesh->radius : 1.0f;
        f32 nearest = shadow ? 0.0f : nearest_distance(d, row, mesh, view, distance);
        f32 error_m = lod_error_m(desc->settings.lod_error_px, nearest, view, shadow);
        u32 lod = choose_lod(mesh, world_scale, error_m);

        u64 key = ENTITY_INDEX(d->table.entity[row]);
        if (binding->alpha_mode == ALPHA_BLEND) {
            key |= blend_key(d, row, view);
        } else {
            // A depth pass sees of an opaque material only whether both sides count, and shades
            // nothing: longer runs.
            bool depth_only = shadow && binding->alpha_mode == ALPHA_OPAQUE;
            u64 surface = depth_only ? binding->double_sided : material;
            u64 band = shadow ? 0 : distance_band(distance, radius);
            u64 lit = shadow ? 0 : vertex_lit(vertex_share(distance, view, binding));
            key |= (u64)binding->alpha_mode << KEY_ALPHA | band << KEY_BAND | lit << KEY_VERTEX |
                   surface << KEY_SURFACE | (u64)lod << KEY_LOD | (u64)d->mesh[row] << KEY_MESH;
        }
        items[lists.row_count++] = (SortItem){key, row, (u16)material, (u16)lod};
        lists.triangles += mesh->lods[lod].index_count / 3;
    }
    items = radix_sort(items, spare, lists.row_count);

    lists.rows = ARENA_PUSH(scratch, u32, lists.row_count);
    lists.material = ARENA_PUSH(scratch, u16, lists.row_count);
    lists.vertex_share = ARENA_PUSH(scratch, f32, lists.row_count);
    PacketDraw *draws = ARENA_PUSH(scratch, PacketDraw, lists.row_count), *draw = draws - 1;
    u64 run = UINT64_MAX; // what the draws of one run share
    for (u32 i = 0; i < lists.row_count; i++) {
        const SortItem *item = &items[i];
        u32 mesh = d->mesh[item->row], alpha = palette->bindings[item->material].alpha_mode;
        lists.rows[i] = item->row;
        lists.material[i] = item->material;
        if (!shadow)
            lists.vertex_share[i] = vertex_share(sphere_distance(d, item->row, view), view,
                                                 &palette->bindings[item->material]);
        u64 this_run = item->key >> KEY_MESH;
        if (alpha == ALPHA_BLEND)
            this_run = ((u64)alpha << KEY_ALPHA | (u64)item->material << KEY_SURFACE |
                        (u64)item->lod << KEY_LOD | (u64)mesh << KEY_MESH) >>
                       KEY_MESH;
        if (this_run != run) {
            *++draw = (PacketDraw){.mesh = mesh,
                                   .material = item->material,
                                   .first_instance = i,
                                   .lod = item->lod,
                                   .vertex_lit = vertex_lit(lists.vertex_share[i])};
            if (!lists.lists[alpha]) lists.lists[alpha] = draw; // lists follow each other
            lists.counts[alpha]++;
            run = this_run;
        }
        draw->instance_count++;
    }
    return lists;
}

// ---- what is voxelised ----

DrawLists packet_collect_voxelised(const World *world, const AssetStore *assets,
                                   const MaterialPalette *palette, u32 mode, Arena *scratch) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const MaterialTable *materials = WORLD_TABLE(world, Material, material);
    SortItem *items = ARENA_PUSH(scratch, SortItem, d->table.count);
    SortItem *spare = ARENA_PUSH(scratch, SortItem, d->table.count);
    DrawLists lists = {0};
    MaterialMemo memo = {ENTITY_NONE, ROW_NONE};
    for (u32 row = 0; row < d->table.count; row++) {
        // Hidden ones have no sphere.
        if (d->mesh[row] == 0 || d->mesh[row] >= assets->mesh_count ||
            !(d->bounds_radius[row] >= 0.0f))
            continue;
        u32 owner = table_row(&instances->table, d->owner[row]);
        if (owner == ROW_NONE || instances->voxel_mode[owner] != mode) continue;
        u32 place = material_row(materials, d->material[row], &memo);
        u32 material = place == ROW_NONE ? palette->missing : palette->index_of_row[place];
        if (palette->bindings[material].alpha_mode == ALPHA_BLEND) continue;
        u64 key = ENTITY_INDEX(d->table.entity[row]) |
                  ((u64)d->mesh[row] << VOXEL_KEY_MESH | (u64)material << VOXEL_KEY_MATERIAL);
        items[lists.row_count++] = (SortItem){key, row, (u16)material, 0};
        lists.triangles += assets->meshes[d->mesh[row]].index_count / 3;
    }
    items = radix_sort(items, spare, lists.row_count);

    lists.rows = ARENA_PUSH(scratch, u32, lists.row_count);
    lists.material = ARENA_PUSH(scratch, u16, lists.row_count);
    lists.vertex_share = ARENA_PUSH(scratch, f32, lists.row_count);
    PacketDraw *draws = ARENA_PUSH(scratch, PacketDraw, lists.row_count);
    lists.lists[0] = draws;
    for (u32 i = 0; i < lists.row_count; i++) {
        lists.rows[i] = items[i].row;
        lists.material[i] = items[i].material;
        bool same =
            i > 0 && items[i].key >> VOXEL_KEY_MATERIAL == items[i - 1].key >> VOXEL_KEY_MATERIAL;
        if (!same)
            draws[lists.counts[0]++] = (PacketDraw){
                .mesh = d->mesh[items[i].row], .material = items[i].material, .first_instance = i};
        draws[lists.counts[0] - 1].instance_count++;
    }
    return lists;
}

// ---- instances ----

typedef struct InstanceJob {
    const DrawableTable *drawables;
    const DrawLists *draws;
    InstanceRecord *out;
} InstanceJob;

static void job_instances(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const InstanceJob *job = context;
    const DrawableTable *d = job->drawables;
    for (u32 i = begin; i < end; i++) {
        u32 row = job->draws->rows[i];
        InstanceRecord *record = &job->out[i];
        columns_get_mat34(&d->w00, row, (f32 *)record->world);
        record->ids[0] = job->draws->material[i];
        record->ids[1] = d->table.entity[row];
        memcpy(&record->ids[2], &job->draws->vertex_share[i], sizeof record->ids[2]);
    }
}

void packet_write_instances(const World *world, const DrawLists *draws, InstanceRecord *out) {
    InstanceJob job = {WORLD_TABLE(world, Drawable, drawable), draws, out};
    jobs_for(draws->row_count, INSTANCES_PER_JOB, job_instances, &job);
}

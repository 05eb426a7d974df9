// frame_packet.c: packets from strangers: damaged in thousands of ways, they are refused or they
// are safe, by the word of a second checker that shares nothing with the first.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const Packet *make_packet(SystemsFixture *f, u32 count) {
    fixture_fill(f, 0xF177, count);
    f->world->tick = 321;
    systems_settle(&f->systems, &f->context);
    return fixture_packet(f, ENTITY_NONE, settings_default(), 320, 200, 0);
}

#define VOXEL_SHADOW_LAST 3 // soft_ray
#define NEED(x)                                                                                    \
    if (!(x)) return #x

// Walks the hierarchy over the lights as a shader does: every node once, every light once.
static const char *walk_trees(const Packet *p) {
    const GridNode *nodes = PACKET_DATA(p, grid_nodes, GridNode);
    const u32 *indices = PACKET_DATA(p, light_indices, u32);
    u32 points = p->frame.counts[0], spots = p->frame.counts[1], steps = 0, lights = 0;
    NEED(p->frame.counts[3] == p->grid_nodes.count);
    if (p->frame.counts[3] == 0) return NULL;
    for (u32 class = 0; class < 2; class ++) {
        u32 stack[256], depth = 0, begin = class ? points : 0,
                        end = class ? points + spots : points;
        if (begin == end) continue;
        stack[depth++] = class ? p->frame.counts3[2] : 0;
        while (depth > 0) {
            u32 node = stack[--depth], first, bits;
            NEED(node < p->grid_nodes.count && ++steps <= p->grid_nodes.count);
            memcpy(&first, &nodes[node].low[3], sizeof first);
            memcpy(&bits, &nodes[node].high[3], sizeof bits);
            u32 count = bits & 0x7FFFFFFF;
            NEED(count >= 1 && count <= GRID_NODE_WIDTH);
            for (u32 child = first; child < first + count; child++) {
                if (!(bits >> 31)) {
                    NEED(depth < COUNT_OF(stack) && child > node);
                    stack[depth++] = child;
                    continue;
                }
                NEED((u64)p->frame.counts3[3] + child < p->light_indices.count);
                u32 light = indices[p->frame.counts3[3] + child];
                NEED(light >= begin && light < end);
                lights++;
            }
        }
    }
    NEED(lights == points + spots);
    return NULL;
}

// Reads what passes over voxels read.
static const char *check_voxels_plainly(const Packet *p, u32 mesh_count) {
    const GiRecord *r = &p->gi.record;
    u64 drawn = 0;
    NEED(p->gi.params.enabled || (p->gi_lists.count == 0 && p->traced_lights.count == 0));
    NEED(p->traced_lights.count <= GI_TRACED_CAP && r->counts[0] == p->traced_lights.count);
    const PacketSection draws[] = {p->gi_static_draws, p->gi_dynamic_draws};
    for (u32 list = 0; list < COUNT_OF(draws); list++) {
        for (u32 i = 0; i < draws[list].count; i++) {
            const PacketDraw *d = (const PacketDraw *)((const u8 *)p + draws[list].offset) + i;
            NEED(d->mesh < mesh_count && d->material < p->materials.count && d->lod == 0);
            NEED((u64)d->first_instance + d->instance_count <= p->gi_instances.count);
            drawn += d->instance_count;
        }
    }
    NEED(drawn == p->gi_instances.count);
    for (u32 i = 0; i < p->gi_instances.count; i++) {
        const InstanceRecord *instance = PACKET_DATA(p, gi_instances, InstanceRecord) + i;
        NEED(instance->ids[0] < p->materials.count);
        for (u32 k = 0; k < 12; k++) NEED(isfinite(instance->world[k / 4][k % 4]));
    }
    for (u32 i = 0; i < p->directionals.count; i++) {
        f32 shadow = PACKET_DATA(p, directionals, DirectionalRecord)[i].direction[3];
        NEED(shadow >= -1 && shadow <= VOXEL_SHADOW_LAST && shadow == (f32)(i32)shadow);
    }
    if (!p->gi.params.enabled) return NULL;
    NEED(r->dims[3] >= 1 && r->dims[3] <= GI_CASCADES_CAP && r->atlas[3] >= 1);
    for (u32 a = 0; a < 3; a++) {
        NEED(r->dims[a] >= 8 && r->dims[a] <= 512 && (r->dims[a] & (r->dims[a] - 1)) == 0);
        NEED(r->atlas[a] == r->dims[a] || r->atlas[a] == r->dims[a] / 2);
        NEED(r->atlas[a] >> (r->atlas[3] - 1) >= 1 && r->probes[a] >= 1 && r->probes[a] <= 64);
        NEED(r->light_grid[a] >= 1 && r->light_grid[a] <= 32);
        NEED(isfinite(r->light_grid_rate[a]) && isfinite(r->origin[r->dims[3] - 1][a]));
    }
    for (u32 c = 0; c < r->dims[3]; c++) NEED(r->origin[c][3] > 0 && isfinite(r->origin[c][3]));
    NEED(r->trace[0] >= 1 && r->trace[0] <= p->width_px && r->trace[1] <= p->height_px);
    // Nothing that steps without an end.
    NEED(r->cone[0] > 0.05f && r->cone[1] >= 0.1f && r->cone[2] > 0 && r->specular[0] > 0.005f);
    NEED(isfinite(r->cone[2]) && isfinite(r->cone[3]) && isfinite(r->strength[0]));
    u64 cells = (u64)r->light_grid[0] * r->light_grid[1] * r->light_grid[2];
    const u32 *words = PACKET_DATA(p, gi_lists, u32);
    NEED(p->gi_lists.count >= 2 * cells);
    for (u64 i = 0; i < cells; i++) {
        NEED((u64)words[2 * i] + words[2 * i + 1] <= p->gi_lists.count);
        for (u32 k = 0; k < words[2 * i + 1]; k++)
            NEED(words[words[2 * i] + k] < p->gi_lights.count);
    }
    for (u32 i = 0; i < p->traced_lights.count; i++)
        NEED(PACKET_DATA(p, traced_lights, TracedLightRecord)[i].shadow[0] > 0.0005f);
    return NULL;
}

// Reads what a renderer reads, asking before each access. Returns what is wrong.
static const char *check_plainly(const u8 *block, u64 size, u32 mesh_count, u32 texture_count) {
    const Packet *p = (const Packet *)block;
#define X(name, Type)                                                                              \
    NEED(p->name.offset >= sizeof(Packet) && p->name.offset % CACHE_LINE == 0);                    \
    NEED((u64)p->name.offset + (u64)p->name.count * sizeof(Type) <= size);
    PACKET_SECTIONS(X)
#undef X
    NEED(p->width_px >= 1 && p->width_px <= PACKET_SIDE_MAX && p->height_px >= 1);
    NEED(p->height_px <= PACKET_SIDE_MAX && p->shadow_size_px <= 4096);
    NEED(p->settings.path < PATH_COUNT && p->settings.view < VIEW_COUNT);
    NEED(p->settings.scale >= 0.25f && p->settings.scale <= 1.0f);
    NEED(p->frame.counts2[2] < p->lights.count);
    NEED((u64)p->frame.counts[0] + p->frame.counts[1] < p->lights.count);
    NEED(p->frame.counts[1] <= p->spots.count && p->frame.counts[2] <= p->directionals.count);
    NEED(p->shadow_size_px == 0 || p->directionals.count > 0);
    for (u32 i = 0; i < 16; i++) {
        NEED(isfinite(p->frame.view_projection[i]) && isfinite(p->frame.view[i]));
        NEED(isfinite(p->frame.shadow_matrix[i]));
    }
    const PacketSection draws[] = {p->opaque_draws,   p->mask_draws,   p->blend_draws,
                                   p->emissive_draws, p->shadow_draws, p->shadow_mask_draws};
    u64 drawn = 0;
    for (u32 list = 0; list < COUNT_OF(draws); list++) {
        for (u32 i = 0; i < draws[list].count; i++) {
            const PacketDraw *d = (const PacketDraw *)(block + draws[list].offset) + i;
            NEED(d->mesh < mesh_count && d->material < p->materials.count);
            NEED(d->lod < MESH_LODS_CAP);
            NEED((u64)d->first_instance + d->instance_count <= p->instances.count);
            drawn += d->instance_count;
        }
    }
    NEED(drawn <= 2 * (u64)p->instances.count);
    for (u32 i = 0; i < p->instances.count; i++) {
        const InstanceRecord *r = PACKET_DATA(p, instances, InstanceRecord) + i;
        NEED(r->ids[0] < p->materials.count);
        for (u32 k = 0; k < 12; k++) NEED(isfinite(r->world[k / 4][k % 4]));
    }
    NEED(p->materials.count <= MATERIALS_CAP && p->material_bindings.count == p->materials.count);
    for (u32 i = 0; i < p->materials.count; i++) {
        const PacketMaterial *m = PACKET_DATA(p, material_bindings, PacketMaterial) + i;
        NEED(m->albedo_texture < MAX(texture_count, 1) &&
             m->normal_texture < MAX(texture_count, 1));
        NEED(m->emissive_texture < MAX(texture_count, 1) && m->alpha_mode < 3);
    }
    u32 side_px = settings_tile_px(&p->settings);
    u32 tiles_x = (p->width_px + side_px - 1) / side_px;
    u32 tiles_y = (p->height_px + side_px - 1) / side_px;
    u32 slices = p->frame.grid[2];
    NEED(p->frame.grid[0] == tiles_x && p->frame.grid[1] == tiles_y && p->frame.grid[3] == side_px);
    NEED(slices == 1 || (settings_clustered(&p->settings) && slices <= CLUSTER_SLICES_CAP));
    // A path that reads cells has them.
    NEED(p->cells.count == tiles_x * tiles_y * slices ||
         (p->cells.count == 0 && settings_lists_on_device(&p->settings) &&
          p->blend_draws.count == 0));
    NEED(p->frame.counts3[0] <= p->frame.counts[0] && p->frame.counts3[1] <= p->frame.counts[1]);
    const char *tree = walk_trees(p), *voxels = check_voxels_plainly(p, mesh_count);
    if (tree || voxels) return tree ? tree : voxels;
    for (u32 t = 0; t < p->cells.count; t++) {
        const u32 *list = PACKET_DATA(p, cells, CellRecord)[t].list;
        NEED((u64)list[0] + list[1] + list[2] <= p->light_indices.count);
        NEED((list[3] & 0xFFFF) <= list[1] && list[3] >> 16 <= list[2]);
        const u32 *indices = PACKET_DATA(p, light_indices, u32) + list[0];
        for (u32 i = 0; i < list[1]; i++) NEED(indices[i] < p->frame.counts[0]);
        for (u32 i = list[1]; i < list[1] + list[2]; i++) {
            NEED(indices[i] >= p->frame.counts[0]); // its spot record is index - points
            NEED(indices[i] - p->frame.counts[0] < p->spots.count);
        }
    }
    for (u32 i = 0; i < p->lights.count; i++)
        for (u32 k = 0; k < 4; k++)
            NEED(isfinite(PACKET_DATA(p, lights, LightRecord)[i].position[k]));
    for (u32 i = 0; i < p->texts.count; i++) {
        const PacketText *t = PACKET_DATA(p, texts, PacketText) + i;
        NEED((u64)t->offset + t->length <= p->characters.count && isfinite(t->size_px));
    }
#undef NEED
    return NULL;
}

TEST(frame_packet, built_packets_are_valid) {
    const u32 counts[] = {0, 1, 40, 300};
    for (u32 i = 0; i < COUNT_OF(counts); i++) {
        SystemsFixture *f = systems_fixture_create(1);
        const Packet *p = make_packet(f, counts[i]);
        const char *problem =
            packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT);
        if (problem) fail_msg("%u things: %s", counts[i], problem);
        assert_null(
            check_plainly((const u8 *)p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        // A store with fewer meshes or textures cannot draw it.
        if (counts[i] > 1) {
            assert_non_null(packet_validate(p, p->size, 2, FIXTURE_TEXTURE_COUNT));
            assert_non_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, 1));
        }
        systems_fixture_destroy(f);
    }
}

TEST(frame_packet, sizes_and_alignment_are_checked) {
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *p = make_packet(f, 10);
    u8 *copy = aligned_alloc(64, p->size + 128);
    memcpy(copy, p, p->size);
    assert_null(packet_validate(copy, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    for (u64 size = 0; size < p->size; size += 1 + size / 7)
        assert_non_null(packet_validate(copy, size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_non_null(packet_validate(copy, p->size + 64, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    memmove(copy + 4, copy, p->size);
    assert_non_null(packet_validate(copy + 4, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_non_null(packet_validate(NULL, 0, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    free(copy);
    systems_fixture_destroy(f);
}

// A word of the packet gets an evil value, or two words change places, or a section's fields do.
static void damage(u32 *words, u64 word_count, u64 seed, u32 round) {
    static const u32 evil[] = {0,           1,           2,           3,           0x7F800000u,
                               0x7FC00000u, 0xFF800000u, 0xFFFFFFFFu, 0x80000000u, 0x7FFFFFFFu,
                               64,          128,         1u << 24,    0x10000u};
    const u64 header = sizeof(Packet) / 4;
    u32 hits = 1 + random_u32(seed, 1, round) % 3;
    for (u32 hit = 0; hit < hits; hit++) {
        u64 draw = (u64)round * 8 + hit;
        // Half of the hits go to the header, where the sections are.
        u64 range = random_u32(seed, 2, draw) & 1 ? header : word_count;
        u64 at = random_u64(seed, 3, draw) % range, other = random_u64(seed, 4, draw) % range;
        u32 swap = words[at];
        switch (random_u32(seed, 5, draw) % 5) {
        case 0:
            words[at] = evil[random_u32(seed, 6, draw) % COUNT_OF(evil)];
            break;
        case 1:
            words[at] = words[other], words[other] = swap;
            break;
        case 2:
            words[at] ^= 1u << (random_u32(seed, 6, draw) & 31);
            break;
        case 3:
            words[at] += random_u32(seed, 6, draw) & 1 ? 1u : 0xFFFFFFFFu;
            break;
        case 4:
            words[at] = random_u32(seed, 6, draw);
            break;
        }
    }
}

static void damage_many(const Packet *good, u64 seed, u32 rounds) {
    u64 size = good->size;
    u32 refused = 0, taken = 0;
    for (u32 round = 0; round < rounds; round++) {
        u8 *copy = malloc(size); // an allocation of its own: the sanitizer sees a byte too far
        memcpy(copy, good, size);
        damage((u32 *)copy, size / 4, seed, round);
        if (packet_validate(copy, size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT)) {
            refused++;
        } else {
            const char *problem =
                check_plainly(copy, size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT);
            if (problem) fail_msg("round %u was taken, but not: %s", round, problem);
            taken++;
        }
        free(copy);
    }
    printf("%u refused, %u harmless\n", refused, taken);
    assert_true(refused > rounds / 4 && taken > rounds / 40);
}

TEST(frame_packet, damaged_packets_are_refused_or_safe) {
    const u64 seed = 0xBADF00D;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(1);
    damage_many(make_packet(f, 24), seed, 20000);
    systems_fixture_destroy(f);
}

// Clusters made on the device, for so many lights that there is a hierarchy over them.
static const Packet *make_clusters(SystemsFixture *f, u32 light_count) {
    fixture_fill(f, 0xF177, 24);
    for (u32 i = 0; i < light_count; i++) {
        Vec3 p = {random_range(9, 1, i, -9, 9), random_range(9, 2, i, -5, 5),
                  random_range(9, 3, i, -30, -1)};
        fixture_spawn_light(f, i % 4 ? LIGHT_POINT : LIGHT_SPOT, p, 0.8f);
    }
    systems_settle(&f->systems, &f->context);
    RenderSettings settings = settings_default();
    settings.manager = 0;
    settings.path = PATH_CLUSTERED_FORWARD;
    settings.tile_px = TILE_64;
    settings.clusters = CLUSTERS_GPU;
    return fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
}

TEST(frame_packet, damaged_hierarchies_are_refused_or_safe) {
    const u64 seed = 0xBADF00E;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *p = make_clusters(f, 1100);
    assert_true(p->grid_nodes.count > 100 && p->cells.count > 0 && p->frame.grid[2] > 1);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_null(check_plainly((const u8 *)p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    damage_many(p, seed, 4000);
    // Where chance seldom hits: every node's links, and the order.
    Packet *copy = malloc(p->size);
    memcpy(copy, p, p->size);
    GridNode *nodes = PACKET_WRITE(copy, grid_nodes, GridNode);
    u32 *indices = PACKET_WRITE(copy, light_indices, u32);
    for (u32 i = 0; i < copy->grid_nodes.count * 2; i++) {
        f32 *link = i & 1 ? &nodes[i / 2].high[3] : &nodes[i / 2].low[3];
        u32 kept, value;
        memcpy(&kept, link, sizeof kept);
        for (u32 step = 0; step < 4; step++) {
            value = step < 2 ? kept + (step ? 1 : 0xFFFFFFFFu) : step == 2 ? 0xFFFFFFFFu : 1u << 30;
            memcpy(link, &value, sizeof value);
            if (!packet_validate(copy, copy->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT))
                fail_msg("node %u: link %u instead of %u was taken", i / 2, value, kept);
        }
        memcpy(link, &kept, sizeof kept);
    }
    for (u32 i = copy->frame.counts3[3]; i < copy->light_indices.count; i++) {
        u32 kept = indices[i];
        indices[i] = copy->lights.count - 1; // the dummy
        assert_non_null(
            packet_validate(copy, copy->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        indices[i] = kept;
    }
    assert_null(packet_validate(copy, copy->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    free(copy);
    systems_fixture_destroy(f);
}

// With global illumination: nested grids, lights whose shadows come from the voxels.
static const Packet *make_voxels(SystemsFixture *f, u32 count) {
    fixture_fill(f, 0xF17A, count);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    for (u32 row = 0; row < light->table.count; row++)
        light->screen_shadow[row] = row < 12 ? 0 : row % 3, light->voxel_shadow[row] = row % 5;
    f->world->tick = 99;
    systems_settle(&f->systems, &f->context);
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, "gi.enabled=on,gi.cascades=2,gi.grid=32"));
    return fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
}

TEST(frame_packet, damaged_voxels_are_refused_or_safe) {
    const u64 seed = 0xBADF00F;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *p = make_voxels(f, 24);
    assert_true(p->gi_static_draws.count && p->gi_dynamic_draws.count && p->gi_lights.count);
    assert_true(p->traced_lights.count > 2 && p->directionals.count > p->frame.counts[2]);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_null(check_plainly((const u8 *)p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    damage_many(p, seed, 20000);
    systems_fixture_destroy(f);
}

// Every index field by itself, one too large and far too large.
TEST(frame_packet, each_index_is_checked) {
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *good = make_packet(f, 60);
    assert_true(good->opaque_draws.count && good->mask_draws.count && good->blend_draws.count);
    assert_true(good->emissive_draws.count && good->shadow_draws.count && good->texts.count);
    assert_true(good->spots.count && good->light_indices.count && good->shadow_mask_draws.count);
    Packet *p = malloc(good->size);
    memcpy(p, good, good->size);
#define TOO_LARGE(field, limit)                                                                    \
    do {                                                                                           \
        u32 kept = (field), values[] = {(limit), (limit) + 1, 0x7FFFFFFF, 0xFFFFFFFF};             \
        for (u32 v_ = 0; v_ < 4; v_++) {                                                           \
            (field) = values[v_];                                                                  \
            if (!packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT))           \
                fail_msg(#field " = %u was taken", values[v_]);                                    \
        }                                                                                          \
        (field) = kept;                                                                            \
    } while (0)
#define DRAW_FIELDS(section)                                                                       \
    do {                                                                                           \
        PacketDraw *d = PACKET_WRITE(p, section, PacketDraw) + p->section.count - 1;               \
        TOO_LARGE(d->mesh, FIXTURE_MESH_COUNT);                                                    \
        TOO_LARGE(d->material, p->materials.count);                                                \
        TOO_LARGE(d->lod, MESH_LODS_CAP);                                                          \
        TOO_LARGE(d->first_instance, p->instances.count);                                          \
        TOO_LARGE(d->instance_count, p->instances.count + 1 - d->first_instance);                  \
    } while (0)
    DRAW_FIELDS(opaque_draws);
    DRAW_FIELDS(mask_draws);
    DRAW_FIELDS(blend_draws);
    DRAW_FIELDS(emissive_draws);
    DRAW_FIELDS(shadow_draws);
    DRAW_FIELDS(shadow_mask_draws);
    TOO_LARGE(PACKET_WRITE(p, instances, InstanceRecord)[3].ids[0], p->materials.count);
    PacketMaterial *m = PACKET_WRITE(p, material_bindings, PacketMaterial);
    TOO_LARGE(m->albedo_texture, FIXTURE_TEXTURE_COUNT);
    TOO_LARGE(m->normal_texture, FIXTURE_TEXTURE_COUNT);
    TOO_LARGE(m->emissive_texture, FIXTURE_TEXTURE_COUNT);
    TOO_LARGE(m->alpha_mode, 3);
    TOO_LARGE(m->double_sided, 2);
    TOO_LARGE(m->emissive_pass, 2);
    u32 *indices = PACKET_WRITE(p, light_indices, u32);
    TOO_LARGE(indices[0], p->lights.count - 1); // the dummy is in no list
    TOO_LARGE(indices[p->light_indices.count - 1], p->lights.count - 1);
    CellRecord *cells = PACKET_WRITE(p, cells, CellRecord);
    TOO_LARGE(cells[p->cells.count - 1].list[0], p->light_indices.count + 1);
    TOO_LARGE(cells[p->cells.count / 2].list[1], cells[p->cells.count / 2].list[1] + 1);
    TOO_LARGE(cells[p->cells.count / 2].list[2], cells[p->cells.count / 2].list[2] + 1);
    TOO_LARGE(cells[p->cells.count / 2].list[3], cells[p->cells.count / 2].list[3] + 1);
    PacketText *text = PACKET_WRITE(p, texts, PacketText);
    TOO_LARGE(text->offset, p->characters.count + 1);
    TOO_LARGE(text->length, p->characters.count + 1);
    TOO_LARGE(p->width_px, p->width_px + 1);
    TOO_LARGE(p->shadow_size_px, 4097);
    TOO_LARGE(p->brdf_mask, 64);
    TOO_LARGE(p->attenuation, 3);
    TOO_LARGE(p->flags, 8);
    for (u32 i = 0; i < 4; i++) TOO_LARGE(p->frame.counts[i], p->frame.counts[i] + 1);
    for (u32 i = 0; i < 4; i++) TOO_LARGE(p->frame.counts2[i], p->frame.counts2[i] + 1);
    for (u32 i = 0; i < 4; i++) TOO_LARGE(p->frame.counts3[i], p->frame.counts3[i] + 1);
    for (u32 i = 0; i < 4; i++) TOO_LARGE(p->frame.grid[i], p->frame.grid[i] + 1);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    free(p);
    systems_fixture_destroy(f);
}

TEST(frame_packet, each_index_of_voxels_is_checked) {
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *good = make_voxels(f, 60);
    Packet *p = malloc(good->size);
    memcpy(p, good, good->size);
    PacketSection lists[] = {p->gi_static_draws, p->gi_dynamic_draws};
    for (u32 i = 0; i < 2; i++) {
        PacketDraw *d = (PacketDraw *)((u8 *)p + lists[i].offset) + lists[i].count - 1;
        TOO_LARGE(d->mesh, FIXTURE_MESH_COUNT);
        TOO_LARGE(d->material, p->materials.count);
        TOO_LARGE(d->lod, 1);
        TOO_LARGE(d->first_instance, d->first_instance + 1);
        TOO_LARGE(d->instance_count, d->instance_count + 1);
    }
    TOO_LARGE(PACKET_WRITE(p, gi_instances, InstanceRecord)[2].ids[0], p->materials.count);
    u32 *words = PACKET_WRITE(p, gi_lists, u32);
    GiRecord *r = &p->gi.record;
    u32 cells = r->light_grid[0] * r->light_grid[1] * r->light_grid[2];
    TOO_LARGE(words[0], words[0] + 1);
    TOO_LARGE(words[2 * cells - 1], words[2 * cells - 1] + 1);
    TOO_LARGE(words[2 * cells], p->gi_lights.count);
    TOO_LARGE(words[p->gi_lists.count - 1], p->gi_lights.count);
    for (u32 i = 0; i < 4; i++) {
        TOO_LARGE(r->dims[i], r->dims[i] + 1);
        TOO_LARGE(r->atlas[i], r->atlas[i] + 1);
        TOO_LARGE(r->light_grid[i], r->light_grid[i] + 1);
        TOO_LARGE(r->counts[i], r->counts[i] + 1);
        TOO_LARGE(r->probes[i], 65);
    }
    TOO_LARGE(r->show[0], GI_SHOW_COUNT);
    TOO_LARGE(r->show[1], 10);
    TOO_LARGE(r->show[2], 6);
    TOO_LARGE(p->gi.params.enabled, 2);
    TOO_LARGE(p->gi.params.diffuse, GI_DIFFUSE_VOXELS + 1);
    TOO_LARGE(p->gi.params.grid, 5);
    TOO_LARGE(p->gi.params.cascades, 3);
    TOO_LARGE(p->gi.params.every_n, 3601);
    TOO_LARGE(p->frame.counts[2], p->directionals.count + 1);
    // Numbers that would stall a shader, or place nothing anywhere.
    f32 *const numbers[] = {&r->cone[0],
                            &r->cone[1],
                            &r->cone[2],
                            &r->origin[0][3],
                            &r->specular[0],
                            &r->light_grid_rate[1],
                            &r->trace[0],
                            &r->probe_origin[3],
                            &PACKET_WRITE(p, traced_lights, TracedLightRecord)[0].shadow[0]};
    static const f32 evil[] = {0.0f, -1.0f, 1e-12f, 1e20f, INFINITY, NAN};
    for (u32 i = 0; i < COUNT_OF(numbers); i++) {
        f32 kept = *numbers[i];
        for (u32 k = 0; k < COUNT_OF(evil); k++) {
            *numbers[i] = evil[k];
            if (!packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT))
                fail_msg("number %u = %g was taken", i, (f64)evil[k]);
        }
        *numbers[i] = kept;
    }
    // What is off has nothing.
    p->gi.params.enabled = 0;
    assert_non_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    p->gi.params.enabled = 1;
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    free(p);
    systems_fixture_destroy(f);
}

// systems_packet.c: what a packet says about a world: the same bytes with any number of threads,
// draws in order, lights after the manager, the shadow map's box, flags.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/packet_parts.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static u64 packet_hash(u32 threads) {
    jobs_start(threads);
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, 0xD0, 3000);
    for (u32 i = 0; i < 3; i++) systems_tick(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings_default(), 640, 360, 0);
    u64 hash = hash_bytes(p, p->size, 0);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_true(p->counts.drawables_visible > 500 && p->counts.lights_visible > 500);
    systems_fixture_destroy(f);
    jobs_stop();
    return hash;
}

TEST(systems_packet, threads_do_not_matter) {
    u64 one = packet_hash(1);
    assert_true(one == packet_hash(2) && one == packet_hash(8));
}

// Half octaves of the distance, 1 m to 181 m and beyond. (The camera is at the origin.)
static u32 band_of(const DrawableTable *d, u32 row) {
    f64 r = d->bounds_radius[row];
    f64 to =
        sqrt((f64)d->bounds_x[row] * d->bounds_x[row] + (f64)d->bounds_y[row] * d->bounds_y[row] +
             (f64)d->bounds_z[row] * d->bounds_z[row]);
    f64 distance = to - r > 0.5 * r ? to - r : 0.5 * r;
    for (u32 band = 0; band < 15; band++)
        if (distance < pow(2, 0.5 * (band + 1)) * (1 - 1e-6)) return band;
    return 15;
}

TEST(systems_packet, every_visible_instance_is_drawn_once_in_order) {
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, 0xD1, 800);
    systems_settle(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings_default(), 640, 360, 0);
    const InstanceRecord *instances = PACKET_DATA(p, instances, InstanceRecord);
    const PacketMaterial *bindings = PACKET_DATA(p, material_bindings, PacketMaterial);
    const PacketSection lists[] = {p->opaque_draws, p->mask_draws, p->blend_draws};
    u32 next = 0, emissive = 0;
    f32 last_distance = INFINITY;
    for (u32 list = 0; list < 3; list++) {
        u64 last_order = 0;
        const PacketDraw *draws = (const PacketDraw *)((const u8 *)p + lists[list].offset);
        assert_true(lists[list].count > 0);
        for (u32 i = 0; i < lists[list].count; i++) {
            const PacketDraw *d = &draws[i];
            assert_int_equal(d->first_instance, next);
            next += d->instance_count;
            assert_int_equal(bindings[d->material].alpha_mode, list);
            for (u32 k = 0; k < d->instance_count; k++) {
                const InstanceRecord *r = &instances[d->first_instance + k];
                assert_int_equal(r->ids[0], d->material);
                u32 row = FIXTURE_ROW(f, drawable, r->ids[1]);
                const DrawableTable *t = FIXTURE_TABLE(f, Drawable, drawable);
                assert_int_equal(t->mesh[row], d->mesh);
                if (list < ALPHA_BLEND) {
                    u64 order = (u64)band_of(t, row) << 60 | (u64)d->material << 40 |
                                (u64)d->lod << 36 | (u64)d->mesh << 20 | ENTITY_INDEX(r->ids[1]);
                    assert_true(order > last_order);
                    last_order = order;
                } else {
                    f32 distance =
                        vec3_length(vec3(t->bounds_x[row], t->bounds_y[row], t->bounds_z[row]));
                    assert_true(distance <= last_distance * 1.00001f);
                    last_distance = distance;
                }
            }
            emissive += bindings[d->material].emissive_texture != 0;
        }
    }
    assert_int_equal(next, p->counts.drawables_visible);
    assert_int_equal(p->emissive_draws.count, emissive);
    assert_true(emissive > 0);
    assert_int_equal(p->instances.count, next + p->counts.shadow_casters);

    RenderSettings all = settings_default();
    all.mesh_culling = 0;
    u32 hidden = 0;
    const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    for (u32 i = 0; i < d->table.count; i++) hidden += d->bounds_radius[i] < 0;
    p = fixture_packet(f, ENTITY_NONE, all, 640, 360, 0);
    assert_int_equal(p->counts.drawables_visible, d->table.count - hidden);
    systems_fixture_destroy(f);
}

// The coarsest level whose error, seen from the nearest point of the bounding sphere or of the box
// around the corners of the mesh's box, whichever is farther, is small enough; from the matrices
// alone, level by level.
static u32 naive_lod(const Mesh *mesh, const InstanceRecord *r, const Packet *p, f64 error_px,
                     f64 *slack) {
    f64 center[3], to = 0, scale = 0;
    for (u32 a = 0; a < 3; a++) {
        center[a] = r->world[a][0] * mesh->center.x + r->world[a][1] * mesh->center.y +
                    r->world[a][2] * mesh->center.z + r->world[a][3];
        to += (center[a] - p->frame.camera[a]) * (center[a] - p->frame.camera[a]);
        f64 column = 0;
        for (u32 b = 0; b < 3; b++) column += (f64)r->world[b][a] * r->world[b][a];
        scale = MAX(scale, sqrt(column));
    }
    f64 lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (u32 corner = 0; corner < 8; corner++)
        for (u32 a = 0; a < 3; a++) {
            f64 at = r->world[a][0] * (corner & 1 ? mesh->max.x : mesh->min.x) +
                     r->world[a][1] * (corner & 2 ? mesh->max.y : mesh->min.y) +
                     r->world[a][2] * (corner & 4 ? mesh->max.z : mesh->min.z) + r->world[a][3];
            lo[a] = MIN(lo[a], at), hi[a] = MAX(hi[a], at);
        }
    f64 to_box = 0;
    for (u32 a = 0; a < 3; a++) {
        f64 gap = MAX(MAX(lo[a] - p->frame.camera[a], p->frame.camera[a] - hi[a]), 0.0);
        to_box += gap * gap;
    }
    f64 distance = MAX(sqrt(to) - mesh->radius * scale, p->frame.camera[3]);
    distance = MAX(distance, sqrt(to_box));
    f64 half_height = sqrt((f64)p->frame.ray_up[0] * p->frame.ray_up[0] +
                           (f64)p->frame.ray_up[1] * p->frame.ray_up[1] +
                           (f64)p->frame.ray_up[2] * p->frame.ray_up[2]);
    u32 best = 0;
    *slack = 1;
    for (u32 lod = 0; lod < mesh->lod_count && error_px > 0; lod++) {
        f64 px = mesh->lods[lod].error * scale / distance * p->height_px / (2 * half_height);
        if (px <= error_px) best = lod;
        *slack = MIN(*slack, fabs(px / error_px - 1));
    }
    return best;
}

TEST(systems_packet, level_of_detail_follows_the_error_on_the_screen) {
    const u64 seed = 0x10D;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, seed, 300);
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 eye = FIXTURE_ROW(f, transform, camera), seen[MESH_LODS_CAP] = {0};
    for (u32 round = 0; round < 60; round++) {
        t->x[eye] = random_range(seed, 1, round, -30, 30);
        t->z[eye] = random_range(seed, 2, round, -50, 20);
        t->yaw[eye] = random_range(seed, 3, round, -180, 180);
        FIXTURE_TABLE(f, Camera, camera)->fov[0] = random_range(seed, 4, round, 30, 110);
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        arena_reset(&f->arenas.frame);
        RenderSettings settings = settings_default();
        settings.lod_error_px = round % 4 == 0 ? 0.0f : random_range(seed, 5, round, 0.1f, 16);
        const Packet *p = fixture_packet(f, camera, settings, 640, 360, 0);
        const PacketSection lists[] = {p->opaque_draws, p->mask_draws, p->blend_draws,
                                       p->shadow_draws, p->shadow_mask_draws};
        u32 triangles = 0;
        f64 texel = p->shadow_size_px ? p->frame.shadow[1] / 1.5 : 0;
        for (u32 list = 0; list < COUNT_OF(lists); list++) {
            const PacketDraw *draws = (const PacketDraw *)((const u8 *)p + lists[list].offset);
            for (u32 i = 0; i < lists[list].count; i++) {
                const PacketDraw *d = &draws[i];
                const Mesh *mesh = &f->meshes[d->mesh];
                if (settings.lod_error_px == 0) assert_int_equal(d->lod, 0);
                if (list < 3) triangles += mesh->lods[d->lod].index_count / 3 * d->instance_count;
                for (u32 k = 0; k < d->instance_count; k++) {
                    const InstanceRecord *r =
                        PACKET_DATA(p, instances, InstanceRecord) + d->first_instance + k;
                    f64 slack;
                    u32 want = naive_lod(mesh, r, p, settings.lod_error_px, &slack);
                    if (list < 3 && slack > 1e-4) assert_int_equal(d->lod, want);
                    seen[d->lod] += list < 3;
                    // Scales are 1 to 3 along y. In the shadow map distance plays no part.
                    f64 allowed = texel * settings.lod_error_px;
                    if (list >= 3) assert_true(mesh->lods[d->lod].error <= allowed * 1.001);
                }
            }
        }
        assert_int_equal(triangles, p->counts.triangles);
    }
    for (u32 lod = 0; lod < f->meshes[MESH_CUBE].lod_count; lod++) assert_true(seen[lod] > 20);
    systems_fixture_destroy(f);
}

TEST(systems_packet, materials_become_records) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity unused = fixture_spawn_material(f, ALPHA_OPAQUE, 0), m[4];
    (void)unused;
    for (u32 i = 0; i < 4; i++) {
        m[i] = fixture_spawn_material(f, i == 1 ? ALPHA_MASK : ALPHA_OPAQUE, i == 2 ? 1 : 0);
        u32 row = FIXTURE_ROW(f, material, m[i]);
        MaterialTable *t = FIXTURE_TABLE(f, Material, material);
        t->brdf[row] = i;
        t->power[row] = 56;
        t->emissive_strength[row] = 5;
        t->diffuse[row] = i == 1 ? DIFFUSE_OREN_NAYAR : DIFFUSE_LAMBERT;
        t->fresnel[row] = i == 3;
        Entity box =
            fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
        (void)box;
        FIXTURE_TABLE(f, Drawable, drawable)->material[i] = m[i];
    }
    FIXTURE_TABLE(f, Material, material)->receives_dynamic_light[FIXTURE_ROW(f, material, m[0])] =
        0;
    systems_settle(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, 0);
    const MaterialRecord *r = PACKET_DATA(p, materials, MaterialRecord);
    assert_int_equal(p->materials.count, 4); // in row order, without those that nobody uses
    for (u32 i = 0; i < 4; i++) assert_true(r[i].lobes[0] == (f32)i);
    assert_true(r[0].lobes[1] == 0 && r[1].lobes[1] == 1 && r[2].lobes[1] == 1);
    ASSERT_NEAR(r[3].lobes[1], 64.0 / (8 * 3.14159265), 1e-5);
    assert_true(r[0].albedo[3] == 0 && r[1].albedo[3] == 0.5f);
    assert_true(r[0].emissive[3] == 0 && r[1].emissive[3] == 1);
    assert_true(r[0].emissive[0] == 5 && r[2].emissive[0] == 0 && r[2].extra[1] == 5);
    assert_true(r[0].lobes[2] == 1 && r[0].lobes[3] == 0);
    ASSERT_NEAR(r[1].lobes[2], 1 - 0.5 * 0.25 / 0.58, 1e-6);
    ASSERT_NEAR(r[1].lobes[3], 0.45 * 0.25 / 0.34, 1e-6);
    assert_int_equal(p->brdf_mask, 15 | BRDF_MASK_OREN_NAYAR | BRDF_MASK_FRESNEL);
    assert_int_equal(PACKET_DATA(p, material_bindings, PacketMaterial)[2].emissive_pass, 1);
    // A drawable whose material is gone still draws.
    world_despawn(f->world, m[3]);
    p = fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, 0);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_int_equal(p->counts.drawables_visible, 4);
    systems_fixture_destroy(f);
}

TEST(systems_packet, more_materials_than_fit_are_drawn_anyhow) {
    SystemsFixture *f = systems_fixture_create(5);
    for (u32 i = 0; i < 300; i++) {
        Entity m = fixture_spawn_material(f, ALPHA_OPAQUE, 0);
        fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
        FIXTURE_TABLE(f, Drawable, drawable)->material[i] = m;
    }
    systems_settle(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, 0);
    assert_int_equal(p->materials.count, MATERIALS_CAP);
    assert_int_equal(p->counts.drawables_visible, 300);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    systems_fixture_destroy(f);
}

// ---- lights ----

TEST(systems_packet, light_manager_keeps_what_lights_the_view) {
    SystemsFixture *f = systems_fixture_create(5);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -6), vec3(1, 1, 1), 0, COLLISION_NONE);
    Entity spot = fixture_spawn_light(f, LIGHT_SPOT, vec3(0, 0, -5), 4);
    Entity point = fixture_spawn_light(f, LIGHT_POINT, vec3(1, 0, -5), 2);
    fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, 50), 2); // behind
    Entity dark = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, -5), 2);
    FIXTURE_TABLE(f, Light, light)->intensity[FIXTURE_ROW(f, light, dark)] = 0;
    // Its sphere reaches the view, its cone looks away.
    Entity away = fixture_spawn_light(f, LIGHT_SPOT, vec3(0, 0, 1.5f), 4);
    FIXTURE_TABLE(f, Transform, transform)->yaw[FIXTURE_ROW(f, transform, away)] = 180;
    FIXTURE_TABLE(f, Light, light)->color_g[FIXTURE_ROW(f, light, point)] = 0.5f;
    FIXTURE_TABLE(f, Light, light)->intensity[FIXTURE_ROW(f, light, point)] = 6;
    systems_settle(&f->systems, &f->context);
    RenderSettings settings = settings_default();
    settings.light_gain = 2;
    assert_true(settings_set(&settings, "gi.enabled=on"));
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
    const LightRecord *lights = PACKET_DATA(p, lights, LightRecord);
    assert_int_equal(p->counts.lights_total, 5);
    assert_int_equal(p->counts.lights_visible, 2);
    assert_int_equal(p->frame.counts[0], 1);
    assert_int_equal(p->frame.counts[1], 1);
    assert_int_equal(p->gi_lights.count, 4); // also those outside the view, not the dark one
    assert_true(lights[0].position[0] == 1 && lights[0].position[3] == 0.25f);
    assert_true(lights[0].color[0] == 12 && lights[0].color[1] == 6);
    const SpotRecord *s = PACKET_DATA(p, spots, SpotRecord);
    ASSERT_NEAR(s->direction[2], -1, 1e-6);
    ASSERT_NEAR(s->direction[3], cos(35 * 3.14159265 / 180), 1e-6);
    assert_true(lights[0].color[3] == 1 && lights[1].color[3] == 1); // full highlights
    ASSERT_NEAR(s->edge[0], 1 / (cos(20 * 3.14159265 / 180) - cos(35 * 3.14159265 / 180)), 1e-3);
    const LightRecord *dummy = &lights[p->frame.counts2[2]];
    assert_true(dummy->color[0] == 0 && dummy->position[3] >= 1 && dummy->position[1] < -1000);

    settings.light_culling = 0;
    p = fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
    assert_int_equal(p->counts.lights_visible, 4);
    assert_int_equal(p->counts.lights_shaded, 2); // only those touch a tile
    settings.light_limit = 1;
    p = fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
    assert_int_equal(p->frame.counts[0], 0);
    assert_int_equal(p->frame.counts[1], 1);
    settings = settings_default();
    settings.light_gain = 0;
    p = fixture_packet(f, ENTITY_NONE, settings, 320, 200, 0);
    assert_int_equal(p->lights.count, 1); // the dummy
    // An inner angle beyond the outer one: finite, a hard edge.
    FIXTURE_TABLE(f, Light, light)->inner_angle[FIXTURE_ROW(f, light, spot)] = 60;
    p = fixture_packet(f, ENTITY_NONE, settings_default(), 320, 200, 0);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    systems_fixture_destroy(f);
}

// Points of a spot's light that lie in the view: then the light is in the list of their tile.
TEST(systems_packet, no_lit_pixel_misses_its_light) {
    const u64 seed = 0x117;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, seed, 400);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    for (u32 i = 0; i < light->table.count; i++)
        light->outer_angle[i] = random_range(seed, 20, i, 1, 89);
    Entity camera = fixture_spawn(f, vec3(1, 2, 3));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    t->yaw[FIXTURE_ROW(f, transform, camera)] = 25;
    t->pitch[FIXTURE_ROW(f, transform, camera)] = -10;
    systems_settle(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, camera, settings_default(), 333, 211, 0);
    const LightRecord *lights = PACKET_DATA(p, lights, LightRecord);
    Mat4 matrix;
    memcpy(matrix.m, p->frame.view_projection, sizeof matrix);
    u32 hits = 0;
    for (u32 row = 0; row < light->table.count; row++) {
        if (light->kind[row] == LIGHT_DIRECTIONAL || light->intensity[row] == 0) continue;
        for (u32 k = 0; k < 200; k++) {
            u64 s = (u64)row * 200 + k;
            Vec3 d = {random_range(seed, 30, s, -1, 1), random_range(seed, 31, s, -1, 1),
                      random_range(seed, 32, s, -1, 1)};
            if (vec3_length(d) >= 1) continue;
            Vec3 axis = {light->dir_x[row], light->dir_y[row], light->dir_z[row]};
            if (light->kind[row] == LIGHT_SPOT &&
                vec3_dot(vec3_normalize(d), axis) < cosf(DEG_TO_RAD(light->outer_angle[row])))
                continue;
            Vec3 at = vec3_add(vec3(light->x[row], light->y[row], light->z[row]),
                               vec3_scale(d, light->reach[row]));
            Vec4 clip = mat4_mul_vec4(matrix, (Vec4){at.x, at.y, at.z, 1});
            if (!(clip.w > 0 && clip.z <= clip.w)) continue;
            f32 x = (clip.x / clip.w * 0.5f + 0.5f) * 333,
                y = (0.5f - clip.y / clip.w * 0.5f) * 211;
            if (!(x >= 0 && x < 333 && y >= 0 && y < 211)) continue;
            const u32 *list =
                PACKET_DATA(p, cells, CellRecord)[(u32)y / 16 * p->frame.grid[0] + (u32)x / 16]
                    .list;
            bool found = false;
            for (u32 i = 0; i < list[1] + list[2]; i++) {
                const LightRecord *r = &lights[PACKET_DATA(p, light_indices, u32)[list[0] + i]];
                found |= r->position[0] == light->x[row] && r->position[2] == light->z[row];
            }
            assert_true(found);
            hits++;
        }
    }
    assert_true(hits > 3000);
    systems_fixture_destroy(f);
}

TEST(systems_packet, directional_lights_are_ordered_and_capped) {
    SystemsFixture *f = systems_fixture_create(5);
    for (u32 i = 0; i < 12; i++) {
        Entity sun = fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
        u32 row = FIXTURE_ROW(f, light, sun);
        FIXTURE_TABLE(f, Light, light)->color_r[row] = (f32)(i + 1);
        FIXTURE_TABLE(f, Light, light)->casts_shadow[row] = i == 4 || i == 5;
    }
    systems_settle(&f->systems, &f->context);
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, 0);
    const DirectionalRecord *suns = PACKET_DATA(p, directionals, DirectionalRecord);
    assert_int_equal(p->directionals.count, DIRECTIONALS_CAP);
    const f32 want[] = {5, 1, 2, 3, 4, 6, 7, 8};
    for (u32 i = 0; i < DIRECTIONALS_CAP; i++) {
        assert_true(suns[i].color[0] == want[i] && suns[i].color[3] == (i == 0 ? 1.0f : 0.0f));
        assert_true(suns[i].direction[2] == 1.0f); // towards the light, which shines along -z
    }
    assert_true(p->shadow_size_px == 1024);
    RenderSettings off = settings_default();
    off.shadows = 0;
    p = fixture_packet(f, ENTITY_NONE, off, 64, 64, 0);
    assert_int_equal(p->shadow_size_px, 0);
    assert_true(PACKET_DATA(p, directionals, DirectionalRecord)[0].color[3] == 0);
    assert_int_equal(p->shadow_draws.count, 0);
    systems_fixture_destroy(f);
}

// ---- shadow map ----

static Entity shadow_scene(SystemsFixture *f, Entity *sun) {
    *sun = fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
    FIXTURE_TABLE(f, Light, light)->casts_shadow[0] = 1;
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    return camera;
}

TEST(systems_packet, shadow_map_covers_the_view_and_its_casters) {
    const u64 seed = 0x5AD0;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(5);
    Entity sun, camera = shadow_scene(f, &sun);
    fixture_fill(f, seed, 200);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    for (u32 i = 1; i < light->table.count; i++) light->casts_shadow[i] = 0;
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 eye = FIXTURE_ROW(f, transform, camera), lamp = FIXTURE_ROW(f, transform, sun);
    for (u32 round = 0; round < 200; round++) {
        t->x[eye] = random_range(seed, 1, round, -30, 30);
        t->y[eye] = random_range(seed, 2, round, -5, 5);
        t->yaw[eye] = random_range(seed, 3, round, -180, 180);
        t->pitch[eye] = random_range(seed, 4, round, -80, 80);
        t->pitch[lamp] = round == 0 ? -90 : random_range(seed, 5, round, -90, 90);
        t->yaw[lamp] = random_range(seed, 6, round, -180, 180);
        FIXTURE_TABLE(f, Camera, camera)->fov[0] = random_range(seed, 7, round, 30, 110);
        table_touch(&t->table, eye);
        table_touch(&t->table, lamp);
        systems_settle(&f->systems, &f->context);
        arena_reset(&f->arenas.frame);
        const Packet *p = fixture_packet(f, camera, settings_default(), 640, 360, 0);
        Mat4 shadow;
        memcpy(shadow.m, p->frame.shadow_matrix, sizeof shadow);
        for (u32 k = 0; k < 100; k++) {
            u64 s = (u64)round * 100 + k;
            f32 depth = random_range(seed, 8, s, p->frame.camera[3], 40), point[4] = {0, 0, 0, 1};
            f32 nx = random_range(seed, 9, s, -1, 1), ny = random_range(seed, 10, s, -1, 1);
            if (k < 8) { // the corners themselves
                depth = k & 1 ? 40 : p->frame.camera[3];
                nx = k & 2 ? 1 : -1, ny = k & 4 ? 1 : -1;
            }
            f32 ray[3], length2 = 0;
            for (u32 a = 0; a < 3; a++) {
                ray[a] =
                    p->frame.ray_right[a] * nx + p->frame.ray_up[a] * ny + p->frame.ray_forward[a];
                length2 += ray[a] * ray[a];
            }
            // The shadow distance is one from the camera, not a depth.
            depth = MIN(depth, 40 / sqrtf(length2));
            for (u32 a = 0; a < 3; a++) point[a] = p->frame.camera[a] + ray[a] * depth;
            Vec4 clip = mat4_mul_vec4(shadow, (Vec4){point[0], point[1], point[2], 1});
            ASSERT_NEAR(clip.w, 1, 1e-6);
            f64 slack = 1e-4;
            if (!(fabsf(clip.x) <= 1 && fabsf(clip.y) <= 1 && clip.z >= -slack &&
                  clip.z <= 1 + slack))
                fail_msg("round %u: %g %g %g", round, clip.x, clip.y, clip.z);
        }
        // No caster is cut at the light's end; the projection keeps handedness and reversed depth.
        const PacketDraw *draws = PACKET_DATA(p, shadow_draws, PacketDraw);
        for (u32 i = 0; i < p->shadow_draws.count; i++) {
            for (u32 k = 0; k < draws[i].instance_count; k++) {
                const InstanceRecord *r =
                    PACKET_DATA(p, instances, InstanceRecord) + draws[i].first_instance + k;
                Vec4 clip = mat4_mul_vec4(
                    shadow, (Vec4){r->world[0][3], r->world[1][3], r->world[2][3], 1});
                assert_true(clip.z <= 1.0f);
            }
        }
    }
    systems_fixture_destroy(f);
}

// Moving the camera moves the map by whole texels: the fraction of a fixed point's place in the map
// stays, and turning changes neither size nor fraction.
TEST(systems_packet, shadow_map_stands_still) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity sun, camera = shadow_scene(f, &sun);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    t->pitch[FIXTURE_ROW(f, transform, sun)] = -50;
    t->yaw[FIXTURE_ROW(f, transform, sun)] = 20;
    f64 first[2] = {0}, first_scale = 0;
    u32 eye = FIXTURE_ROW(f, transform, camera);
    for (u32 round = 0; round < 50; round++) {
        t->x[eye] = (f32)round * 0.37f;
        t->z[eye] = (f32)round * 0.11f;
        t->yaw[eye] = (f32)round * 17.0f;
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        const Packet *p = fixture_packet(f, camera, settings_default(), 640, 360, 0);
        Mat4 shadow;
        memcpy(shadow.m, p->frame.shadow_matrix, sizeof shadow);
        Vec4 clip = mat4_mul_vec4(shadow, (Vec4){3, 1, 2, 1});
        f64 texel[2] = {(clip.x * 0.5 + 0.5) * p->shadow_size_px,
                        (clip.y * 0.5 + 0.5) * p->shadow_size_px};
        f64 scale = hypot(hypot(shadow.m[0], shadow.m[4]), shadow.m[8]);
        if (round == 0) {
            first[0] = texel[0], first[1] = texel[1], first_scale = scale;
            continue;
        }
        ASSERT_NEAR(scale, first_scale, 1e-7);
        for (u32 a = 0; a < 2; a++) {
            f64 moved = texel[a] - first[a];
            ASSERT_NEAR(moved, floor(moved + 0.5), 0.02);
        }
    }
    systems_fixture_destroy(f);
}

// Turning on the spot never draws the map again, a walk of some metres only now and then.
TEST(systems_packet, shadow_map_waits_for_a_longer_walk) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity sun, camera = shadow_scene(f, &sun);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    t->pitch[FIXTURE_ROW(f, transform, sun)] = -50;
    u32 eye = FIXTURE_ROW(f, transform, camera), changes = 0;
    u64 key = 0;
    for (u32 round = 0; round < 36; round++) {
        t->yaw[eye] = (f32)round * 10.0f;
        t->pitch[eye] = (f32)(round % 7) * 10.0f - 30.0f;
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        u64 now = fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key;
        if (round > 0) assert_true(now == key);
        key = now;
    }
    for (u32 round = 0; round < 100; round++) { // ten metres
        t->x[eye] = (f32)round * 0.1f;
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        u64 now = fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key;
        changes += now != key;
        key = now;
    }
    assert_in_range(changes, 1, 6);
    systems_fixture_destroy(f);
}

TEST(systems_packet, shadow_key_changes_with_what_the_map_shows) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity sun, camera = shadow_scene(f, &sun);
    Entity box = fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
    Entity lamp = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, -4), 2);
    systems_settle(&f->systems, &f->context);
    u64 key = fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key;
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 row = FIXTURE_ROW(f, transform, lamp);
    t->x[row] += 1;
    table_touch(&t->table, row);
    systems_tick(&f->systems, &f->context);
    assert_true(key == fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key);
    row = FIXTURE_ROW(f, transform, box);
    t->x[row] += 1;
    table_touch(&t->table, row);
    systems_tick(&f->systems, &f->context);
    u64 moved = fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key;
    assert_true(key != moved);
    FIXTURE_TABLE(f, Instance, instance)->casts_shadow[0] = 0;
    assert_true(moved != fixture_packet(f, camera, settings_default(), 64, 64, 0)->shadow_key);
    systems_fixture_destroy(f);
}

// ---- the rest ----

TEST(systems_packet, rays_and_matrices_agree) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity parent = fixture_spawn(f, vec3(3, 2, 1)), camera = fixture_spawn(f, vec3(1, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 row = FIXTURE_ROW(f, transform, parent);
    t->parent[FIXTURE_ROW(f, transform, camera)] = parent;
    t->yaw[row] = 40, t->pitch[row] = -20, t->roll[row] = 15;
    t->scale_x[row] = t->scale_y[row] = t->scale_z[row] = 3; // must not scale what is seen
    systems_settle(&f->systems, &f->context);
    const FrameRecord *frame = &fixture_packet(f, camera, settings_default(), 400, 300, 0)->frame;
    Mat4 matrix;
    memcpy(matrix.m, frame->view_projection, sizeof matrix);
    for (u32 i = 0; i < 64; i++) {
        f32 x = (f32)(i % 8) / 3.5f - 1, y = (f32)(i / 8) / 3.5f - 1, distance = 0.2f + (f32)i;
        f32 p[3];
        for (u32 a = 0; a < 3; a++)
            p[a] =
                frame->camera[a] +
                (frame->ray_right[a] * x + frame->ray_up[a] * y + frame->ray_forward[a]) * distance;
        Vec4 clip = mat4_mul_vec4(matrix, (Vec4){p[0], p[1], p[2], 1});
        ASSERT_NEAR(clip.x / clip.w, x, 1e-4);
        ASSERT_NEAR(clip.y / clip.w, y, 1e-4);
        ASSERT_NEAR(clip.z / clip.w, frame->camera[3] / distance, 1e-4);
    }
    systems_fixture_destroy(f);
}

TEST(systems_packet, flags_follow_from_stamps) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity still =
        fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
    Entity door =
        fixture_spawn_mesh(f, MESH_CUBE, vec3(2, 0, -5), vec3(1, 1, 1), 0, COLLISION_NONE);
    FIXTURE_TABLE(f, Instance, instance)->voxel_mode[1] = VOXEL_DYNAMIC;
    Entity lamp = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, -4), 2);
    systems_settle(&f->systems, &f->context);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    const Entity moved[] = {ENTITY_NONE, still, door, lamp};
    const u32 want[] = {0, 0, PACKET_REVOXELISE, PACKET_RELIGHT};
    assert_int_equal(fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, 0)->flags,
                     PACKET_REVOXELISE | PACKET_RELIGHT);
    systems_tick(&f->systems, &f->context);
    for (u32 i = 0; i < 4; i++) {
        u32 since = f->world->stamp;
        if (moved[i] != ENTITY_NONE) {
            u32 row = FIXTURE_ROW(f, transform, moved[i]);
            t->x[row] += 1;
            table_touch(&t->table, row);
        }
        systems_tick(&f->systems, &f->context);
        u32 flags = fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, since)->flags;
        assert_int_equal(flags, want[i]);
        since = f->world->stamp;
        systems_tick(&f->systems, &f->context);
        assert_int_equal(fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, since)->flags,
                         0);
    }
    u32 since = f->world->stamp;
    world_despawn(f->world, door);
    systems_tick(&f->systems, &f->context);
    assert_int_equal(fixture_packet(f, ENTITY_NONE, settings_default(), 64, 64, since)->flags,
                     PACKET_REVOXELISE);
    systems_fixture_destroy(f);
}

TEST(systems_packet, texts_and_environment_go_along) {
    SystemsFixture *f = systems_fixture_create(5);
    u32 row = world_singleton(f->world, COMPONENT_environment);
    EnvironmentTable *e = FIXTURE_TABLE(f, Environment, environment);
    e->ambient_r[row] = 0.25f, e->ambient_intensity[row] = 2, e->exposure[row] = 3;
    e->attenuation[row] = ATTENUATION_POLYNOMIAL;
    RenderSettings settings = settings_default();
    settings.exposure = 0.5f;
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings, 64, 64, 0);
    assert_true(p->frame.ambient[0] == 0.5f && p->frame.ambient[3] == 1.5f);
    assert_int_equal(p->attenuation, ATTENUATION_POLYNOMIAL);
    const PacketText *texts = PACKET_DATA(p, texts, PacketText);
    assert_int_equal(p->texts.count, 2);
    assert_int_equal(texts[0].length, 12);
    assert_int_equal(texts[1].length, 0);
    assert_memory_equal(PACKET_DATA(p, characters, u8) + texts[0].offset, "1,024 lights", 12);
    systems_fixture_destroy(f);
}

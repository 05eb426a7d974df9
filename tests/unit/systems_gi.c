// systems_gi.c: what a packet says of global illumination: box, grids, draws, lists, traced lights.
// Keys and flags: systems_gi_keys.c.
#include "systems_gi_fixture.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <string.h>

// ---- parameters ----

TEST(systems_gi, is_off_without_the_component_and_can_be_switched_on) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x61, 20);
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "");
    assert_int_equal(p->gi.params.enabled, 0);
    assert_int_equal(p->gi_lights.count + p->gi_lists.count + p->gi_instances.count, 0);
    assert_int_equal(p->gi.static_key | p->gi.light_key, 0);
    p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    assert_int_equal(p->gi.params.enabled, 1);
#define SAME(type, name, unit, initial, ...)                                                       \
    if (strcmp(#name, "enabled") != 0)                                                             \
        assert_true((f64)gi_column_param(&p->gi.params, #name, (f64)(initial)) ==                  \
                    (f64)(Column##type)(initial));
    GI_COLUMNS(SAME)
#undef SAME
    assert_true(p->gi_instances.count > 0 && p->gi_lights.count > 0 && p->gi_lists.count > 0);
    // Nothing to voxelise: no GI.
    SystemsFixture *empty = systems_fixture_create(1);
    fixture_spawn_light(empty, LIGHT_POINT, vec3(0, 0, -3), 4);
    systems_settle(&empty->systems, &empty->context);
    assert_int_equal(gi_packet(empty, ENTITY_NONE, "gi.enabled=on")->gi.params.enabled, 0);
    systems_fixture_destroy(empty);
    systems_fixture_destroy(f);
}

TEST(systems_gi, settings_overrule_the_level) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x62, 5);
    systems_settle(&f->systems, &f->context);
    u32 row = world_singleton(f->world, COMPONENT_gi);
    GiTable *gi = FIXTURE_TABLE(f, Gi, gi);
    gi->bounces[row] = 1, gi->strength[row] = 3, gi->grid[row] = 2, gi->ao[row] = 0;
    gi->faces[row] = 77, gi->hit[row] = -5; // a game's mistakes
    const GiParams *p = &gi_packet(f, ENTITY_NONE, "")->gi.params;
    assert_true(p->enabled == 1 && p->bounces == 1 && p->strength == 3 && p->grid == 2 && !p->ao);
    assert_true(p->faces == GI_FACES_APART && p->hit == 0);
    p = &gi_packet(f, ENTITY_NONE, "gi.bounces=2,gi.strength=0,gi.grid=32,gi.ao=on,gi.hit=0.5")
             ->gi.params;
    assert_true(p->bounces == 2 && p->strength == 0 && p->grid == 0 && p->ao && p->hit == 0.5f);
    p = &gi_packet(f, ENTITY_NONE, "gi.bounces=0,gi.strength=-1,gi.grid=level")->gi.params;
    assert_true(p->bounces == 1 && p->strength == 3 && p->grid == 2);
    assert_int_equal(gi_packet(f, ENTITY_NONE, "gi.enabled=off")->gi.params.enabled, 0);
    systems_fixture_destroy(f);
}

// ---- box and grids ----

static void check_shape(const Packet *p) {
    const GiRecord *r = &p->gi.record;
    u32 side = 32u << p->gi.params.grid, longest = 0;
    for (u32 a = 0; a < 3; a++) {
        u32 n = r->dims[a];
        assert_true(n >= 8 && n <= side && (n & (n - 1)) == 0);
        longest = MAX(longest, n);
    }
    assert_int_equal(longest, side);
}

// All corners of static things, with a voxel of air around; dynamic ones do not matter.
TEST(systems_gi, box_holds_all_static_things) {
    const u64 seed = 0x6B0;
    printf("seed %llx\n", (unsigned long long)seed);
    for (u32 round = 0; round < 40; round++) {
        SystemsFixture *f = systems_fixture_create(1);
        const char *grids[] = {"32", "64", "128", "256", "512"};
        char settings[64];
        f32 wide = random_range(seed, 1, round, 1, 60), high = random_range(seed, 2, round, 1, 60);
        for (u32 i = 0; i < 10; i++) {
            u64 s = round * 16ull + i;
            Entity e = fixture_spawn_mesh(
                f, MESH_CUBE,
                vec3(random_range(seed, 3, s, -wide, wide), random_range(seed, 4, s, -high, high),
                     random_range(seed, 5, s, -wide, wide)),
                vec3(1 + (f32)i, 1, 2), random_range(seed, 6, s, 0, 360), COLLISION_NONE);
            TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
            t->pitch[FIXTURE_ROW(f, transform, e)] = random_range(seed, 7, s, 0, 360);
            InstanceTable *instances = FIXTURE_TABLE(f, Instance, instance);
            u32 row = FIXTURE_ROW(f, instance, e);
            instances->voxel_mode[row] = i < 7 ? VOXEL_STATIC : VOXEL_DYNAMIC;
            instances->visible[row] = i != 3; // hiding one must not move the grid
        }
        systems_settle(&f->systems, &f->context);
        snprintf(settings, sizeof settings, "gi.enabled=on,gi.grid=%s", grids[round % 5]);
        const Packet *p = gi_packet(f, ENTITY_NONE, settings);
        assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        check_shape(p);
        const GiRecord *r = &p->gi.record;
        const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
        f32 low[3] = {1e9f, 1e9f, 1e9f}, top[3] = {-1e9f, -1e9f, -1e9f};
        for (u32 row = 0; row < 7; row++) {
            for (u32 corner = 0; corner < 8; corner++) {
                Mat34 world;
                columns_get_mat34(&d->w00, row, world.m);
                Vec3 q =
                    mat34_point(&world, vec3(corner & 1 ? 0.5f : -0.5f, corner & 2 ? 0.5f : -0.5f,
                                             corner & 4 ? 0.5f : -0.5f));
                const f32 at[3] = {q.x, q.y, q.z};
                for (u32 a = 0; a < 3; a++) {
                    f32 place = (at[a] - r->origin[0][a]) / r->origin[0][3];
                    if (!(place >= 0.99f && place <= (f32)r->dims[a] - 0.99f))
                        fail_msg("round %u: corner at voxel %g of %u", round, (f64)place,
                                 r->dims[a]);
                    low[a] = MIN(low[a], at[a]), top[a] = MAX(top[a], at[a]);
                }
            }
        }
        // No voxel larger than it has to be, no side longer than the next power of two.
        f32 longest = MAX(MAX(top[0] - low[0], top[1] - low[1]), top[2] - low[2]);
        ASSERT_NEAR(r->origin[0][3] * (f32)((32u << round % 5) - 2), longest, longest * 1e-4);
        for (u32 a = 0; a < 3; a++)
            assert_true(r->dims[a] == 8 ||
                        (f32)r->dims[a] * 0.5f < (top[a] - low[a]) / r->origin[0][3] + 3.0f);
        GiRecord before = *r;
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        for (u32 row = 7; row < 10; row++) {
            t->x[row] += 500;
            table_touch(&t->table, row);
        }
        systems_settle(&f->systems, &f->context);
        assert_memory_equal(gi_packet(f, ENTITY_NONE, settings)->gi.record.origin, before.origin,
                            sizeof before.origin);
        systems_fixture_destroy(f);
    }
}

TEST(systems_gi, dynamic_things_alone_make_a_box) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(3, 0, 0), vec3(2, 2, 2), 0, COLLISION_NONE);
    FIXTURE_TABLE(f, Instance, instance)->voxel_mode[0] = VOXEL_DYNAMIC;
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on,gi.grid=32");
    ASSERT_NEAR(p->gi.record.origin[0][3], 2.0 / 30.0, 1e-6);
    ASSERT_NEAR(p->gi.record.origin[0][0], 3.0 - 16.0 * 2.0 / 30.0, 1e-5);
    systems_fixture_destroy(f);
}

TEST(systems_gi, a_given_box_is_taken_as_it_is) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x64, 8);
    systems_settle(&f->systems, &f->context);
    u32 row = world_singleton(f->world, COMPONENT_gi);
    GiTable *gi = FIXTURE_TABLE(f, Gi, gi);
    gi->size_x[row] = 8, gi->size_y[row] = 3, gi->size_z[row] = 1;
    gi->center_x[row] = 1, gi->center_y[row] = 2, gi->center_z[row] = 3;
    const GiRecord *r = &gi_packet(f, ENTITY_NONE, "")->gi.record;
    assert_true(r->dims[0] == 64 && r->dims[1] == 32 && r->dims[2] == 8);
    assert_true(r->origin[0][3] == 0.125f && r->origin[0][0] == -3.0f);
    assert_true(r->origin[0][1] == 0.0f && r->origin[0][2] == 2.5f);
    systems_fixture_destroy(f);
}

TEST(systems_gi, nested_grids_follow_in_steps) {
    const u64 seed = 0x6C4;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x65, 60);
    systems_settle(&f->systems, &f->context);
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 eye = FIXTURE_ROW(f, transform, camera), changes = 0;
    GiRecord last = {0};
    for (u32 round = 0; round < 600; round++) {
        bool jumps = round < 300;
        t->x[eye] = jumps ? random_range(seed, 1, round, -60, 60) : (f32)(round - 300) * 0.02f;
        t->y[eye] = jumps ? random_range(seed, 2, round, -12, 12) : 0;
        t->z[eye] = jumps ? random_range(seed, 3, round, -80, 30) : -10;
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        const Packet *p = gi_packet(f, camera, "gi.enabled=on,gi.cascades=3");
        const GiRecord *r = &p->gi.record;
        assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        assert_int_equal(r->dims[3], 3);
        const f32 at[3] = {t->x[eye], t->y[eye], t->z[eye]};
        for (u32 c = 0; c < 2; c++) {
            f32 voxel = r->origin[c][3], outer = r->origin[c + 1][3];
            assert_true(voxel * 2 == outer);
            for (u32 a = 0; a < 3; a++) {
                f32 n = (f32)r->dims[a], steps = (r->origin[c][a] - r->origin[2][a]) / voxel / 8;
                ASSERT_NEAR(steps, floorf(steps + 0.5f), 1e-3);
                f32 inside = (r->origin[c][a] - r->origin[c + 1][a]) / outer;
                assert_true(inside >= -1e-3f && inside + 0.5f * n <= n + 1e-3f);
                // About the eye wherever the eye is inside the next grid, away from its border.
                f32 own = (at[a] - r->origin[c][a]) / voxel,
                    other = (at[a] - r->origin[c + 1][a]) / outer;
                if (other > 0 && other < n) assert_true(own >= -1e-2f && own <= n + 1e-2f);
                if (other > 0.3f * n && other < 0.7f * n)
                    assert_true(fabsf(own - 0.5f * n) <= 4.0f + 0.2f * n * 2.0f);
            }
        }
        if (round > 300) changes += memcmp(last.origin, r->origin, sizeof last.origin) != 0;
        last = *r;
    }
    printf("%u steps in 6 m\n", changes);
    assert_true(changes > 0 && changes < 20);
    // Without nesting the camera does not matter.
    GiRecord one = gi_packet(f, camera, "gi.enabled=on")->gi.record;
    assert_memory_equal(&one, &gi_packet(f, ENTITY_NONE, "gi.enabled=on")->gi.record, sizeof one);
    systems_fixture_destroy(f);
}

TEST(systems_gi, atlas_probes_and_picture_have_their_shapes) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x66, 8);
    systems_settle(&f->systems, &f->context);
    u32 row = world_singleton(f->world, COMPONENT_gi);
    GiTable *gi = FIXTURE_TABLE(f, Gi, gi);
    gi->size_x[row] = 16, gi->size_y[row] = 8, gi->size_z[row] = 4;
    const GiRecord *r = &gi_packet(f, ENTITY_NONE, "gi.probe_spacing=1")->gi.record;
    assert_true(r->atlas[0] == 32 && r->atlas[1] == 16 && r->atlas[2] == 8 && r->atlas[3] == 4);
    assert_true(r->probes[0] == 17 && r->probes[1] == 9 && r->probes[2] == 5);
    assert_true(r->probe_origin[0] == -8 && r->probe_origin[2] == -2 && r->probe_origin[3] == 1);
    r = &gi_packet(f, ENTITY_NONE, "gi.faces=apart,gi.probe_spacing=0.05,gi.share=8")->gi.record;
    assert_true(r->atlas[0] == 64 && r->atlas[2] == 16 && r->atlas[3] == 5);
    assert_true(r->probes[0] == 64 && r->probes[1] <= 33 && r->probes[3] == 8);
    ASSERT_NEAR(r->probe_origin[3], 16.0 / 63.0, 1e-6);
    // The picture of the fixture is 317 x 201 px.
    const char *words[] = {"gi.resolution=full", "gi.resolution=half", "gi.resolution=quarter"};
    const f32 sizes[3][2] = {{317, 201}, {159, 101}, {80, 51}};
    for (u32 i = 0; i < 3; i++) {
        r = &gi_packet(f, ENTITY_NONE, words[i])->gi.record;
        assert_true(r->trace[0] == sizes[i][0] && r->trace[1] == sizes[i][1]);
    }
    r = &gi_packet(f, ENTITY_NONE, "gi.diffuse_aperture=90,gi.specular_aperture=10")->gi.record;
    ASSERT_NEAR(r->cone[0], 1.0, 1e-6);
    ASSERT_NEAR(r->specular[0], 0.0874887, 1e-6);
    ASSERT_NEAR(r->cone[2], sqrt(16 * 16 + 8 * 8 + 4 * 4), 1e-4); // through everything
    systems_fixture_destroy(f);
}

TEST(systems_gi, ambient_light_gives_way) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x67, 4);
    systems_settle(&f->systems, &f->context);
    f32 plain = gi_packet(f, ENTITY_NONE, "")->frame.ambient[0];
    assert_true(plain > 0);
    assert_true(gi_packet(f, ENTITY_NONE, "gi.enabled=on")->frame.ambient[0] == 0);
    assert_true(gi_packet(f, ENTITY_NONE, "gi.enabled=on,gi.ambient=0.5")->frame.ambient[0] ==
                plain * 0.5f);
    systems_fixture_destroy(f);
}

// ---- draws ----

TEST(systems_gi, everything_is_voxelised_once_wherever_the_view_is) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x6D, 200);
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    const InstanceTable *instances = FIXTURE_TABLE(f, Instance, instance);
    const MaterialTable *materials = FIXTURE_TABLE(f, Material, material);
    u8 *seen = arena_push(&f->arenas.scratch, d->table.count, 1);
    const PacketSection lists[2] = {p->gi_static_draws, p->gi_dynamic_draws};
    const InstanceRecord *records = PACKET_DATA(p, gi_instances, InstanceRecord);
    u32 total = 0;
    for (u32 mode = 0; mode < 2; mode++) {
        u64 last = 0;
        for (u32 i = 0; i < lists[mode].count; i++) {
            const PacketDraw *draw = (const PacketDraw *)((const u8 *)p + lists[mode].offset) + i;
            u64 order = (u64)draw->mesh << 32 | draw->material;
            assert_true(order > last); // one draw for each pair, in order
            last = order;
            for (u32 k = 0; k < draw->instance_count; k++, total++) {
                const InstanceRecord *r = &records[draw->first_instance + k];
                u32 row = table_row(&d->table, r->ids[1]);
                assert_true(row != ROW_NONE && !seen[row]++);
                u32 owner = table_row(&instances->table, d->owner[row]);
                assert_int_equal(instances->voxel_mode[owner], mode ? VOXEL_DYNAMIC : VOXEL_STATIC);
                assert_int_equal(d->mesh[row], draw->mesh);
                assert_int_equal(r->ids[0], draw->material);
                assert_true(r->world[1][3] == d->w13[row]);
            }
        }
    }
    for (u32 row = 0; row < d->table.count; row++) {
        u32 owner = table_row(&instances->table, d->owner[row]);
        u32 material = table_row(&materials->table, d->material[row]);
        bool want = instances->visible[owner] && instances->voxel_mode[owner] != VOXEL_NONE &&
                    materials->alpha_mode[material] != ALPHA_BLEND;
        assert_int_equal(seen[row], want);
    }
    assert_int_equal(total, p->gi_instances.count);
    assert_true(total > 100 && lists[0].count > 3 && lists[1].count > 3);
    systems_fixture_destroy(f);
}

// ---- light lists ----

// Does the light reach the point, by the falloff's window and the cone?
static bool reaches(const GiLightRecord *light, const f32 at[3]) {
    f64 to[3], d2 = 0, along = 0;
    for (u32 a = 0; a < 3; a++) {
        to[a] = (f64)at[a] - light->position[a];
        d2 += to[a] * to[a];
        along += to[a] * light->direction[a];
    }
    if (d2 * light->position[3] >= 1.0) return false;
    return light->extra[1] == 0.0f || along > light->direction[3] * sqrt(d2);
}

static u32 check_lists(const Packet *p, u64 seed, u32 points) {
    const GiRecord *r = &p->gi.record;
    const GiLightRecord *lights = PACKET_DATA(p, gi_lights, GiLightRecord);
    const u32 *words = PACKET_DATA(p, gi_lists, u32);
    u32 found = 0;
    for (u32 i = 0; i < points; i++) {
        f32 at[3];
        u32 cell[3];
        for (u32 a = 0; a < 3; a++) {
            f32 side = (f32)r->dims[a] * r->origin[0][3];
            at[a] = r->origin[0][a] + random_range(seed, 20 + a, i, 0, 1) * side;
            f32 place = (at[a] - r->light_grid_origin[a]) * r->light_grid_rate[a];
            cell[a] = MIN((u32)place, r->light_grid[a] - 1);
        }
        u32 index = cell[0] + r->light_grid[0] * (cell[1] + r->light_grid[1] * cell[2]);
        const u32 *list = words + words[2 * index], count = words[2 * index + 1];
        for (u32 light = 0, k = 0; light < p->gi_lights.count; light++) {
            while (k < count && list[k] < light) k++;
            bool listed = k < count && list[k] == light;
            if (reaches(&lights[light], at) && !listed)
                fail_msg("point %u: light %u is missing", i, light);
            found += listed;
        }
    }
    return found;
}

TEST(systems_gi, no_light_is_missing_in_the_lists) {
    const u64 seed = 0x115;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 listed = 0, lit = 0;
    for (u32 round = 0; round < 10; round++) {
        SystemsFixture *f = systems_fixture_create(1);
        fixture_fill(f, seed + round, 150);
        systems_settle(&f->systems, &f->context);
        const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
        assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        listed += check_lists(p, seed + round, 2000);
        lit += p->counts.gi_light_indices;
        systems_fixture_destroy(f);
    }
    printf("%u listed at 20000 points, %u entries\n", listed, lit);
    assert_true(listed > 1000);
}

// Cells do not list what is far away: a ball's cells against those that it touches at all.
TEST(systems_gi, lists_are_not_much_longer_than_they_need) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, 0), vec3(30, 30, 30), 0, COLLISION_NONE);
    fixture_spawn_light(f, LIGHT_POINT, vec3(0.3f, 0.1f, 0), 8);
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    const GiRecord *r = &p->gi.record;
    f64 cell = 1.0 / r->light_grid_rate[0], ball = 4.0 / 3.0 * 3.14159265 * 512.0;
    assert_int_equal(r->light_grid[0], 16);
    // A ball grown by a cell's diagonal holds all cells that touch it.
    assert_true(p->counts.gi_light_indices * cell * cell * cell > ball);
    assert_true(p->counts.gi_light_indices * cell * cell * cell <
                4.0 / 3.0 * 3.14159265 * pow(8.0 + cell * 1.2, 3));
    u32 full = p->counts.gi_light_indices;
    FIXTURE_TABLE(f, Light, light)->kind[0] = LIGHT_SPOT; // 35 degrees: a tenth of the ball
    systems_settle(&f->systems, &f->context);
    assert_true(gi_packet(f, ENTITY_NONE, "gi.enabled=on")->counts.gi_light_indices < full / 2);
    systems_fixture_destroy(f);
}

TEST(systems_gi, lists_that_do_not_fit_get_larger_cells) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, 0), vec3(20, 20, 20), 0, COLLISION_NONE);
    for (u32 i = 0; i < 1500; i++)
        fixture_spawn_light(f, LIGHT_POINT, vec3((f32)(i % 20) - 10, 0, (f32)(i % 7)), 60);
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_int_equal(p->gi.record.light_grid[0], 8);
    assert_int_equal(p->counts.gi_light_indices, 1500 * 512);
    check_lists(p, 5, 200);
    systems_fixture_destroy(f);
}

// ---- traced lights ----

static Entity spawn_traced(SystemsFixture *f, LightKind kind, Vec3 at, ScreenShadow shadow) {
    Entity e = fixture_spawn_light(f, kind, at, 5);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    light->screen_shadow[FIXTURE_ROW(f, light, e)] = shadow;
    light->shadow_aperture[FIXTURE_ROW(f, light, e)] = 20;
    return e;
}

TEST(systems_gi, traced_lights_leave_the_others) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -5), vec3(9, 9, 9), 0, COLLISION_NONE);
    fixture_spawn_light(f, LIGHT_POINT, vec3(1, 0, -5), 5);
    spawn_traced(f, LIGHT_SPOT, vec3(0, 1, -5), SCREEN_SHADOW_CONE);
    spawn_traced(f, LIGHT_POINT, vec3(0, 0, -4), SCREEN_SHADOW_VOLUME);
    Entity sun = spawn_traced(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), SCREEN_SHADOW_CONE);
    fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    u32 sun_row = FIXTURE_ROW(f, light, sun);
    light->casts_shadow[sun_row] = 1;
    systems_settle(&f->systems, &f->context);
    const char *const without[] = {"", "gi.enabled=on,gi.cone_shadows=off"};
    for (u32 i = 0; i < 2; i++) {
        const Packet *p = gi_packet(f, ENTITY_NONE, without[i]);
        assert_int_equal(p->traced_lights.count, 0);
        assert_int_equal(p->lights.count, 4);
        assert_int_equal(p->directionals.count, 2);
        assert_true(p->shadow_size_px > 0 && packet_screen_shadow(p));
    }
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    assert_int_equal(p->traced_lights.count, 3);
    assert_int_equal(p->gi.record.counts[0], 3);
    assert_int_equal(p->counts.lights_traced, 2);
    assert_int_equal(p->lights.count, 2); // one and the dummy
    assert_int_equal(p->spots.count, 0);
    assert_int_equal(p->gi_lights.count, 3);
    const TracedLightRecord *traced = PACKET_DATA(p, traced_lights, TracedLightRecord);
    assert_true(traced[0].light.extra[1] == LIGHT_SPOT && traced[0].shadow[2] == 0);
    assert_true(traced[1].light.extra[1] == LIGHT_POINT && traced[1].shadow[2] == 1);
    assert_true(traced[2].light.extra[1] == LIGHT_DIRECTIONAL);
    ASSERT_NEAR(traced[0].shadow[0], tan(10 * 3.14159265 / 180), 1e-6);
    ASSERT_NEAR(traced[2].light.direction[2], -1, 1e-6);
    // The sun is behind those of the screen, for the voxels, which ask by ray; it has no map.
    assert_int_equal(p->frame.counts[2], 1);
    assert_int_equal(p->directionals.count, 2);
    assert_int_equal(p->shadow_size_px, 0);
    const DirectionalRecord *suns = PACKET_DATA(p, directionals, DirectionalRecord);
    assert_true(suns[0].direction[3] == VOXEL_SHADOW_NONE);
    assert_true(suns[1].direction[3] == VOXEL_SHADOW_RAY);
    // Voxels may have the map alone.
    light->voxel_shadow[sun_row] = 1 + VOXEL_SHADOW_MAP;
    p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    suns = PACKET_DATA(p, directionals, DirectionalRecord);
    assert_true(p->shadow_size_px > 0 && !packet_screen_shadow(p));
    assert_true(suns[1].direction[3] == VOXEL_SHADOW_MAP && suns[1].color[3] == 1);
    assert_true(suns[0].color[3] == 0);
    light->affects_gi[sun_row] = 0;
    p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
    assert_int_equal(p->directionals.count, 1);
    systems_fixture_destroy(f);
}

TEST(systems_gi, the_first_traced_lights_stay_the_same_as_the_view_turns) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, 0), vec3(30, 30, 30), 0, COLLISION_NONE);
    enum { LIGHTS = 40 };
    for (u32 i = 0; i < LIGHTS; i++) {
        f32 turn = (f32)i * 0.15708f;
        Vec3 at = {8 * det_sin(turn), 0, 8 * det_cos(turn)};
        Entity e = spawn_traced(f, LIGHT_POINT, at, SCREEN_SHADOW_CONE);
        u32 row = FIXTURE_ROW(f, light, e);
        FIXTURE_TABLE(f, Light, light)->color_r[row] = (f32)(i + 1);
        FIXTURE_TABLE(f, Light, light)->priority[row] = 100; // never merged
    }
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 eye = FIXTURE_ROW(f, transform, camera);
    u32 ever = 0;
    for (u32 turn = 0; turn < 36; turn++) {
        t->yaw[eye] = (f32)turn * 10;
        table_touch(&t->table, eye);
        systems_settle(&f->systems, &f->context);
        const Packet *p = gi_packet(f, camera, "gi.enabled=on");
        const TracedLightRecord *traced = PACKET_DATA(p, traced_lights, TracedLightRecord);
        const LightRecord *lights = PACKET_DATA(p, lights, LightRecord);
        for (u32 i = 0; i < p->traced_lights.count; i++) {
            u32 name = (u32)traced[i].light.color[0] - 1;
            assert_true(name < GI_TRACED_CAP &&
                        (i == 0 || traced[i - 1].light.color[0] < traced[i].light.color[0]));
            ever |= 1u << name;
        }
        for (u32 i = 0; i + 1 < p->lights.count; i++)
            assert_true((u32)lights[i].color[0] > GI_TRACED_CAP);
    }
    assert_int_equal(ever, 0xFFFF);
    systems_fixture_destroy(f);
}

// The light that stands for a pair has no shadow from the voxels.
TEST(systems_gi, traced_lights_are_never_merged) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -90), vec3(30, 30, 30), 0, COLLISION_NONE);
    u32 merged[2];
    for (u32 round = 0; round < 2; round++) {
        for (u32 i = 0; i < 2 && round == 0; i++)
            fixture_spawn_light(f, LIGHT_POINT, vec3(0.2f * (f32)i, 0, -60), 4);
        LightTable *light = FIXTURE_TABLE(f, Light, light);
        light->screen_shadow[0] = round ? SCREEN_SHADOW_CONE : SCREEN_SHADOW_MAP;
        systems_settle(&f->systems, &f->context);
        const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on");
        merged[round] = p->counts.lights_merged_pairs;
        assert_int_equal(p->traced_lights.count, round);
    }
    assert_int_equal(merged[0], 1);
    assert_int_equal(merged[1], 0);
    systems_fixture_destroy(f);
}

static u64 voxel_packet_hash(u32 threads) {
    jobs_start(threads);
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x7B, 400);
    systems_settle(&f->systems, &f->context);
    const Packet *p = gi_packet(f, ENTITY_NONE, "gi.enabled=on,gi.cascades=3");
    u64 hash = hash_bytes(p, p->size, 0);
    systems_fixture_destroy(f);
    jobs_stop();
    return hash;
}

TEST(systems_gi, threads_do_not_matter) {
    u64 one = voxel_packet_hash(1);
    assert_true(one == voxel_packet_hash(2) && one == voxel_packet_hash(8));
}

TEST(systems_gi, gi_lights_do_not_hang_on_the_view) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, 0x6E, 120);
    Entity camera = fixture_spawn(f, vec3(5, 2, -80));
    FIXTURE_ADD(f, camera, camera);
    systems_settle(&f->systems, &f->context);
    // The one thing that may: a shadow map that voxels read, which follows the camera in steps.
    const Packet *a = gi_packet(f, ENTITY_NONE, "gi.enabled=on,shadows=off");
    const Packet *b = gi_packet(f, camera, "gi.enabled=on,shadows=off,manager=off,budget=3");
    assert_int_equal(a->gi_lights.count, b->gi_lights.count);
    assert_memory_equal(PACKET_DATA(a, gi_lights, u8), PACKET_DATA(b, gi_lights, u8),
                        a->gi_lights.count * sizeof(GiLightRecord));
    assert_memory_equal(PACKET_DATA(a, gi_lists, u8), PACKET_DATA(b, gi_lists, u8),
                        a->gi_lists.count * sizeof(u32));
    assert_true(a->gi.light_key == b->gi.light_key && a->gi.static_key == b->gi.static_key);
    systems_fixture_destroy(f);
}

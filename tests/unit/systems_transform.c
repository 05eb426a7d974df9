// systems_transform.c: hierarchy, drawables, lights and bounds against recursion; what stands still
// keeps its stamps; the order of systems.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static Mat34 world_of(SystemsFixture *f, const char *name_of_table, u32 row) {
    Mat34 m;
    if (strcmp(name_of_table, "transform") == 0)
        columns_get_mat34(&FIXTURE_TABLE(f, Transform, transform)->w00, row, m.m);
    else
        columns_get_mat34(&FIXTURE_TABLE(f, Drawable, drawable)->w00, row, m.m);
    return m;
}

// Is `row` on a cycle of parents?
static bool on_cycle(SystemsFixture *f, u32 row) {
    const TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 at = row;
    for (u32 steps = 0; steps <= t->table.count; steps++) {
        at = table_row(&t->table, t->parent[at]);
        if (at == ROW_NONE) return false;
        if (at == row) return true;
    }
    return false;
}

static Mat34 world_recursive(SystemsFixture *f, u32 row) {
    const TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    Mat34 local = mat34_from_trs(vec3(t->x[row] + t->offset_x[row], t->y[row] + t->offset_y[row],
                                      t->z[row] + t->offset_z[row]),
                                 vec3(t->pitch[row], t->yaw[row], t->roll[row]),
                                 vec3(t->scale_x[row], t->scale_y[row], t->scale_z[row]));
    u32 parent = table_row(&t->table, t->parent[row]);
    if (parent == ROW_NONE || on_cycle(f, row)) return local;
    return mat34_mul(world_recursive(f, parent), local);
}

static void assert_hierarchy(SystemsFixture *f) {
    const TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    for (u32 row = 0; row < t->table.count; row++) {
        Mat34 want = world_recursive(f, row), have = world_of(f, "transform", row);
        for (u32 i = 0; i < 12; i++)
            if (want.m[i] != have.m[i]) fail_msg("row %u element %u", row, i);
    }
}

// Trees in random row order (parents after children), stale parents, cycles; then changes.
static void random_forest(SystemsFixture *f, u64 seed, u32 count, Entity *entities) {
    for (u32 i = 0; i < count; i++)
        entities[i] = fixture_spawn(
            f, vec3(random_range(seed, 1, i, -2, 2), 0, random_range(seed, 2, i, -2, 2)));
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    for (u32 i = 0; i < count; i++) {
        u32 row = FIXTURE_ROW(f, transform, entities[i]);
        if (random_u32(seed, 3, i) % 3) t->yaw[row] = random_range(seed, 4, i, -180, 180);
        t->scale_y[row] = random_range(seed, 5, i, 0.7f, 1.3f);
        if (random_u32(seed, 6, i) % 4)
            t->parent[row] = entities[random_u32(seed, 7, i) % count]; // cycles come by chance
    }
    // A cycle of three with a tail, an own parent, a chain of a hundred.
    for (u32 i = 0; i < 3; i++)
        t->parent[FIXTURE_ROW(f, transform, entities[i])] = entities[(i + 1) % 3];
    t->parent[FIXTURE_ROW(f, transform, entities[3])] = entities[0];
    t->parent[FIXTURE_ROW(f, transform, entities[4])] = entities[4];
    for (u32 i = 10; i < 110; i++)
        t->parent[FIXTURE_ROW(f, transform, entities[i])] = entities[i + 1];
    t->parent[FIXTURE_ROW(f, transform, entities[110])] = ENTITY_NONE;
}

TEST(systems_transform, hierarchy_equals_recursion) {
    const u64 seed = 0x7EE;
    printf("seed %llx\n", (unsigned long long)seed);
    enum { COUNT = 700 };
    static Entity entities[COUNT];
    for (u32 threads = 1; threads <= 4; threads += 3) {
        jobs_start(threads);
        SystemsFixture *f = systems_fixture_create(1);
        random_forest(f, seed, COUNT, entities);
        systems_settle(&f->systems, &f->context);
        assert_hierarchy(f);
        for (u32 round = 0; round < 30; round++) {
            TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
            for (u32 k = 0; k < 5; k++) {
                u32 i = random_u32(seed, 20 + k, round) % COUNT;
                u32 row = FIXTURE_ROW(f, transform, entities[i]);
                if (row == ROW_NONE) continue;
                if (k == 0 && round % 3 == 0) { // its children become roots
                    world_despawn(f->world, entities[i]);
                } else if (k == 1) {
                    t->parent[row] = entities[random_u32(seed, 30, round) % COUNT];
                    table_touch(&t->table, row);
                } else {
                    t->x[row] += 0.25f;
                    table_touch(&t->table, row);
                }
            }
            systems_tick(&f->systems, &f->context);
            assert_hierarchy(f);
        }
        systems_fixture_destroy(f);
        jobs_stop();
    }
}

TEST(systems_transform, drawables_lights_and_bounds_follow) {
    SystemsFixture *f = systems_fixture_create(1);
    Entity parent = fixture_spawn(f, vec3(1, 2, 3));
    Entity box = fixture_spawn_mesh(f, MESH_CUBE, vec3(4, 0, 0), vec3(2, 1, 1), 30, COLLISION_NONE);
    Entity light = fixture_spawn_light(f, LIGHT_SPOT, vec3(0, 0, -1), 0);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    LightTable *l = FIXTURE_TABLE(f, Light, light);
    u32 p = FIXTURE_ROW(f, transform, parent);
    t->parent[FIXTURE_ROW(f, transform, box)] = parent;
    t->parent[FIXTURE_ROW(f, transform, light)] = parent;
    t->yaw[p] = 90;
    t->scale_x[p] = 3; // shears the box
    u32 row = FIXTURE_ROW(f, light, light);
    l->intensity[row] = 4;
    l->color_g[row] = 0.5f;
    systems_settle(&f->systems, &f->context);
    // Yaw 90 turns -z to -x.
    ASSERT_NEAR(l->x[row], 0, 1e-6);
    ASSERT_NEAR(l->y[row], 2, 1e-6);
    ASSERT_NEAR(l->z[row], 3, 1e-6);
    ASSERT_NEAR(l->dir_x[row], -1, 1e-6);
    ASSERT_NEAR(l->reach[row], 32, 1e-4); // 4 / 32^2 = 1/256
    const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    Mat34 have = world_of(f, "drawable", 0),
          want = world_of(f, "transform", FIXTURE_ROW(f, transform, box));
    assert_memory_equal(&have, &want, sizeof want);
    for (u32 i = 0; i < 8; i++) {
        const f32 *c = f->meshes[MESH_CUBE].vertices[i].position;
        Vec3 corner = mat34_point(&have, vec3(c[0], c[1], c[2]));
        Vec3 from = vec3_sub(corner, vec3(d->bounds_x[0], d->bounds_y[0], d->bounds_z[0]));
        assert_true(vec3_length(from) <= d->bounds_radius[0] * 1.00001f);
    }
    // A given range counts; hidden instances have no bounds; both come back.
    l->range[row] = 7;
    table_touch(&l->table, row);
    InstanceTable *instances = FIXTURE_TABLE(f, Instance, instance);
    instances->visible[0] = 0;
    table_touch(&instances->table, 0);
    systems_tick(&f->systems, &f->context);
    assert_true(l->reach[row] == 7.0f && d->bounds_radius[0] == -1.0f);
    instances->visible[0] = 1;
    table_touch(&instances->table, 0);
    systems_tick(&f->systems, &f->context);
    assert_true(d->bounds_radius[0] > 0.0f);
    world_despawn(f->world, box); // the drawable is left without an owner
    systems_tick(&f->systems, &f->context);
    assert_true(d->bounds_radius[0] == -1.0f);
    systems_fixture_destroy(f);
}

// Under any scale, turn and shear the sphere holds all corners, and without shear it is not larger
// than needed.
TEST(systems_transform, spheres_hold_their_meshes) {
    const u64 seed = 0x5BEE;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(1);
    enum { COUNT = 300 };
    for (u32 i = 0; i < COUNT; i++) {
        Entity parent = fixture_spawn(f, vec3(0, 0, 0));
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        u32 row = FIXTURE_ROW(f, transform, parent);
        f32 *const columns[] = {t->pitch, t->yaw, t->roll};
        for (u32 a = 0; a < 3; a++) columns[a][row] = random_range(seed, a, i, -180, 180);
        t->scale_x[row] = random_range(seed, 4, i, 0.2f, 5);
        t->scale_z[row] = random_range(seed, 5, i, -5, 5);
        Entity box = fixture_spawn_mesh(f, MESH_CUBE, vec3(1, 2, 3),
                                        vec3(random_range(seed, 6, i, 0.5f, 4), 1, 1),
                                        random_range(seed, 7, i, 0, 360), COLLISION_NONE);
        t = FIXTURE_TABLE(f, Transform, transform);
        t->parent[FIXTURE_ROW(f, transform, box)] = parent;
    }
    systems_settle(&f->systems, &f->context);
    const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    for (u32 row = 0; row < COUNT; row++) {
        Mat34 world = world_of(f, "drawable", row);
        for (u32 i = 0; i < 8; i++) {
            const f32 *c = f->meshes[MESH_CUBE].vertices[i].position;
            Vec3 corner = mat34_point(&world, vec3(c[0], c[1], c[2]));
            Vec3 from =
                vec3_sub(corner, vec3(d->bounds_x[row], d->bounds_y[row], d->bounds_z[row]));
            assert_true(vec3_length(from) <= d->bounds_radius[row] * 1.00001f);
        }
    }
    systems_fixture_destroy(f);
}

typedef struct Stamps {
    u32 transform, drawable, light, walker;
    u32 rows;
} Stamps;
static Stamps newest_stamps(SystemsFixture *f) {
    const Table *t = &FIXTURE_TABLE(f, Transform, transform)->table;
    const Table *d = &FIXTURE_TABLE(f, Drawable, drawable)->table;
    Stamps stamps = {t->newest_stamp, d->newest_stamp,
                     FIXTURE_TABLE(f, Light, light)->table.newest_stamp,
                     FIXTURE_TABLE(f, Walker, walker)->table.newest_stamp, 0};
    for (u32 i = 0; i < t->count; i++) stamps.rows += t->stamp[i] * (i + 1);
    for (u32 i = 0; i < d->count; i++) stamps.rows += d->stamp[i] * (i + 7);
    return stamps;
}

TEST(systems_transform, a_static_world_keeps_its_stamps) {
    SystemsFixture *f = systems_fixture_create(1);
    for (u32 i = 0; i < 50; i++) {
        Entity box = fixture_spawn_mesh(f, MESH_CUBE, vec3((f32)i * 3, 0, 0), vec3(1, 1, 1), 10,
                                        i % 2 ? COLLISION_BOX : COLLISION_MESH);
        Entity light = fixture_spawn_light(f, i % 3, vec3((f32)i, 3, 0), 2);
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        t->parent[FIXTURE_ROW(f, transform, light)] = box;
    }
    Entity walker = fixture_spawn(f, vec3(0, 3, 0));
    FIXTURE_ADD(f, walker, walker);
    systems_settle(&f->systems, &f->context);
    f->context.collision = collision_create(f->world, &f->assets);
    for (u32 i = 0; i < 200; i++) systems_tick(&f->systems, &f->context); // the walker lands
    Stamps before = newest_stamps(f);
    u64 hash = table_hash(&FIXTURE_TABLE(f, Transform, transform)->table);
    u32 packet_stamp = f->world->stamp;
    for (u32 i = 0; i < 20; i++) systems_tick(&f->systems, &f->context);
    Stamps after = newest_stamps(f);
    assert_memory_equal(&before, &after, sizeof before);
    assert_true(hash == table_hash(&FIXTURE_TABLE(f, Transform, transform)->table));
    const Packet *p = fixture_packet(f, walker, settings_default(), 64, 64, packet_stamp);
    assert_int_equal(p->flags, 0);

    // One thing moves: its row and what hangs on it, nothing else.
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 row = 0;
    t->x[row] += 1;
    table_touch(&t->table, row);
    u32 since = f->world->stamp, moved = 0;
    systems_tick(&f->systems, &f->context);
    for (u32 i = 0; i < t->table.count; i++) moved += t->table.stamp[i] >= since;
    assert_int_equal(moved, 2); // the box and its light
    moved = 0;
    const DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    for (u32 i = 0; i < d->table.count; i++) moved += d->table.stamp[i] >= since;
    assert_int_equal(moved, 1);
    systems_fixture_destroy(f);
}

// ---- the table of systems ----

static char order[64];
static u32 seen_last_stamp;
static void system_a(SystemContext *context) {
    strcat(order, "a");
    seen_last_stamp = context->last_stamp;
    arena_push(context->scratch, 1000, 16); // given back by the table
}
static void system_b(SystemContext *context) {
    (void)context;
    strcat(order, "b");
}

TEST(systems_table, rows_run_in_order_and_see_their_stamps) {
    SystemsFixture *f = systems_fixture_create(1);
    const System a = {"a", "", "", system_a}, b = {"b", "", "", system_b};
    assert_int_equal(f->systems.count, 4);
    assert_true(systems_insert(&f->systems, "walk", &b));
    assert_true(systems_insert(&f->systems, "b", &a));
    assert_false(systems_insert(&f->systems, "nobody", &a));
    assert_int_equal(f->systems.count, 6);
    const char *const names[] = {"animate", "a", "b", "walk", "transform", "bounds"};
    for (u32 i = 0; i < 6; i++) assert_string_equal(f->systems.rows[i].name, names[i]);
    systems_settle(&f->systems, &f->context);
    assert_string_equal(order, "");
    assert_int_equal(f->world->tick, 0);
    u64 used = f->arenas.scratch.used;
    systems_tick(&f->systems, &f->context);
    assert_string_equal(order, "ab");
    assert_int_equal(f->world->tick, 1);
    assert_int_equal(seen_last_stamp, 0);
    assert_true(f->arenas.scratch.used == used);
    u32 stamp = f->systems.last_stamp[1];
    systems_tick(&f->systems, &f->context);
    assert_string_equal(order, "abab");
    assert_int_equal(seen_last_stamp, stamp);
    assert_true(f->world->stamp > f->systems.last_stamp[5]); // later edits are newer than all rows
    while (systems_insert(&f->systems, NULL, &b)) {
    }
    assert_int_equal(f->systems.count, SYSTEMS_CAP);
    systems_fixture_destroy(f);
}

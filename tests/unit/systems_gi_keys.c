// systems_gi_keys.c: what voxels hang on: keys are of contents, and no change goes unflagged.
#include "systems_gi_fixture.h"
#include "../../engine/base/random.h"
#include <stdio.h>

typedef struct Room {
    SystemsFixture *f;
    Entity wall, door, ghost, lamp, sun, camera, paint, glow;
} Room;

static Entity paint(SystemsFixture *f, Entity thing, Entity material, VoxelMode mode) {
    DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    for (u32 row = 0; row < d->table.count; row++)
        if (d->owner[row] == thing) d->material[row] = material;
    FIXTURE_TABLE(f, Instance, instance)->voxel_mode[FIXTURE_ROW(f, instance, thing)] = mode;
    return thing;
}

static Room make_room(void) {
    Room r = {.f = systems_fixture_create(1)};
    SystemsFixture *f = r.f;
    r.paint = fixture_spawn_material(f, ALPHA_OPAQUE, 0);
    r.glow = fixture_spawn_material(f, ALPHA_MASK, 1);
    Vec3 big = {20, 4, 20}, small = {1, 2, 0.2f};
    r.wall = paint(f, fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -8), big, 0, COLLISION_NONE),
                   r.paint, VOXEL_STATIC);
    r.door = paint(f, fixture_spawn_mesh(f, MESH_CUBE, vec3(2, 0, -5), small, 0, COLLISION_NONE),
                   r.glow, VOXEL_DYNAMIC);
    r.ghost = paint(f, fixture_spawn_mesh(f, MESH_RAMP, vec3(4, 0, -5), small, 0, COLLISION_NONE),
                    r.paint, VOXEL_NONE);
    r.lamp = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, -4), 6);
    r.sun = fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
    r.camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, r.camera);
    systems_settle(&f->systems, &f->context);
    return r;
}

static void move(Room *r, Entity thing, f32 x) {
    TransformTable *t = FIXTURE_TABLE(r->f, Transform, transform);
    u32 row = FIXTURE_ROW(r->f, transform, thing);
    t->x[row] += x;
    table_touch(&t->table, row);
    systems_settle(&r->f->systems, &r->f->context);
}

static PacketGi gi_of(Room *r, const char *settings) {
    char all[256];
    snprintf(all, sizeof all, "gi.enabled=on%s%s", settings[0] ? "," : "", settings);
    PacketGi gi = gi_packet(r->f, r->camera, all)->gi;
    arena_reset(&r->f->arenas.frame);
    return gi;
}

enum { STATIC = 1, DYNAMIC = 2, LIGHT = 4, SURFACE = 8 };
static u32 changed(const PacketGi *a, const PacketGi *b) {
    return (a->static_key != b->static_key ? STATIC : 0) |
           (a->dynamic_key != b->dynamic_key ? DYNAMIC : 0) |
           (a->light_key != b->light_key ? LIGHT : 0) |
           (a->surface_key != b->surface_key ? SURFACE : 0);
}

TEST(systems_gi_keys, each_hangs_on_its_own) {
    Room r = make_room();
    const Entity things[] = {r.door, r.ghost, r.lamp, r.camera};
    const u32 want[] = {DYNAMIC | SURFACE, 0, LIGHT, 0};
    PacketGi first = gi_of(&r, "");
    assert_true(first.static_key && first.dynamic_key && first.light_key);
    for (u32 i = 0; i < COUNT_OF(things); i++) {
        PacketGi before = gi_of(&r, "");
        move(&r, things[i], 0.75f);
        PacketGi there = gi_of(&r, "");
        assert_int_equal(changed(&before, &there), want[i]);
        move(&r, things[i], -0.75f); // and back
        PacketGi back = gi_of(&r, "");
        assert_int_equal(changed(&before, &back), 0);
    }
    // A static thing moves the box, which all hang on.
    move(&r, r.wall, 1);
    PacketGi moved = gi_of(&r, "");
    assert_int_equal(changed(&first, &moved), STATIC | DYNAMIC | LIGHT | SURFACE);
    move(&r, r.wall, -1);
    systems_fixture_destroy(r.f);
}

TEST(systems_gi_keys, materials) {
    Room r = make_room();
    MaterialTable *m = FIXTURE_TABLE(r.f, Material, material);
    u32 paint_row = FIXTURE_ROW(r.f, material, r.paint), glow = FIXTURE_ROW(r.f, material, r.glow);
    PacketGi first = gi_of(&r, "");
#define AFTER(field, row, value, want)                                                             \
    do {                                                                                           \
        f32 kept = m->field[row];                                                                  \
        m->field[row] = value;                                                                     \
        PacketGi now_ = gi_of(&r, "");                                                             \
        assert_int_equal(changed(&first, &now_), want);                                            \
        m->field[row] = kept;                                                                      \
    } while (0)
    AFTER(albedo_g, paint_row, 0.1f, STATIC | SURFACE);
    AFTER(albedo_g, glow, 0.1f, DYNAMIC | SURFACE);
    // Emission is relit; it lies in the voxels as well.
    AFTER(emissive_strength, paint_row, 5, STATIC | LIGHT);
    AFTER(emissive_strength, glow, 5, DYNAMIC | LIGHT);
    AFTER(specular_r, paint_row, 0.5f, 0); // voxels have no highlights
    AFTER(power, glow, 100, 0);
#undef AFTER
    m->emissive_texture[glow] = 2;
    PacketGi now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), DYNAMIC | LIGHT);
    m->emissive_texture[glow] = 1;
    m->albedo_texture[paint_row] = 2;
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), STATIC | SURFACE);
    systems_fixture_destroy(r.f);
}

TEST(systems_gi_keys, settings) {
    Room r = make_room();
    const struct {
        const char *text;
        u32 want;
    } rows[] = {{"gi.strength=3", 0},
                {"gi.ao=off", 0},
                {"gi.specular=off", 0},
                {"gi.resolution=quarter", 0},
                {"gi.policy=never", 0},
                {"gi.show=albedo", 0},
                {"path=forward", 0},
                {"manager=off", 0},
                {"gi.bounces=1", LIGHT},
                {"gi.cosine=average", LIGHT},
                {"gi.faces=apart", LIGHT},
                {"gi.format=byte", LIGHT},
                {"gi.step_factor=1", LIGHT},
                {"gi.diffuse=probes", LIGHT},
                {"gi.sky=1", LIGHT},
                {"light_gain=2", LIGHT},
                {"light_limit=1", 0},
                {"gi.grid=32", STATIC | DYNAMIC | LIGHT | SURFACE},
                {"gi.solid=on", STATIC | DYNAMIC | LIGHT | SURFACE},
                {"gi.cascades=2", STATIC | DYNAMIC | LIGHT | SURFACE}};
    PacketGi first = gi_of(&r, "");
    for (u32 i = 0; i < COUNT_OF(rows); i++) {
        PacketGi now = gi_of(&r, rows[i].text);
        if (changed(&first, &now) != rows[i].want)
            fail_msg("%s changes %u", rows[i].text, changed(&first, &now));
    }
    // Of the camera nothing but the places of nested grids.
    PacketGi nested = gi_of(&r, "gi.cascades=2");
    move(&r, r.camera, 0.01f);
    PacketGi near = gi_of(&r, "gi.cascades=2");
    assert_int_equal(changed(&nested, &near), 0);
    move(&r, r.camera, 6);
    PacketGi far = gi_of(&r, "gi.cascades=2");
    assert_int_equal(changed(&nested, &far), STATIC | DYNAMIC | LIGHT | SURFACE);
    systems_fixture_destroy(r.f);
}

TEST(systems_gi_keys, lights) {
    Room r = make_room();
    LightTable *light = FIXTURE_TABLE(r.f, Light, light);
    u32 lamp = FIXTURE_ROW(r.f, light, r.lamp), sun = FIXTURE_ROW(r.f, light, r.sun);
    PacketGi first = gi_of(&r, ""), now;
    light->voxel_shadow[lamp] = 1 + VOXEL_SHADOW_RAY;
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), LIGHT);
    light->affects_gi[lamp] = 0;
    first = gi_of(&r, "");
    light->intensity[lamp] = 7; // of one that does not light voxels
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), 0);
    // How the screen shows a light does not matter to voxels, but for the sun's map.
    light->screen_shadow[lamp] = SCREEN_SHADOW_CONE;
    light->shadow_aperture[lamp] = 40;
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), 0);
    light->color_g[sun] = 0.25f;
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), LIGHT);
    // What casts into a map that voxels read is part of their light.
    light->casts_shadow[sun] = 1;
    first = gi_of(&r, "");
    move(&r, r.ghost, 0.5f);
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), LIGHT);
    systems_fixture_destroy(r.f);
}

TEST(systems_gi_keys, places_in_tables_do_not_matter) {
    Room r = make_room();
    PacketGi first = gi_of(&r, "");
    // Another material in front, a light that is off, a hidden thing.
    Entity early = fixture_spawn_material(r.f, ALPHA_BLEND, 0);
    Entity thing =
        fixture_spawn_mesh(r.f, MESH_BALL, vec3(1, 0, -4), vec3(1, 1, 1), 0, COLLISION_NONE);
    paint(r.f, thing, early, VOXEL_STATIC); // blended: not voxelised
    Entity off = fixture_spawn_light(r.f, LIGHT_POINT, vec3(0, 1, -4), 5);
    FIXTURE_TABLE(r.f, Light, light)->intensity[FIXTURE_ROW(r.f, light, off)] = 0;
    systems_settle(&r.f->systems, &r.f->context);
    PacketGi now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), 0);
    world_despawn(r.f->world, thing);
    systems_settle(&r.f->systems, &r.f->context);
    now = gi_of(&r, "");
    assert_int_equal(changed(&first, &now), 0);
    systems_fixture_destroy(r.f);
}

// ---- flags ----

// One random edit of anything; returns what it was.
static const char *edit(Room *r, u64 seed, u32 round) {
    SystemsFixture *f = r->f;
    const Entity things[] = {r->wall, r->door, r->ghost, r->lamp, r->sun, r->camera};
    Entity thing = things[random_u32(seed, 1, round) % COUNT_OF(things)];
    f32 number = random_range(seed, 2, round, 0, 1);
    MaterialTable *m = FIXTURE_TABLE(f, Material, material);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    InstanceTable *instances = FIXTURE_TABLE(f, Instance, instance);
    u32 material = FIXTURE_ROW(f, material, round & 1 ? r->paint : r->glow);
    u32 lamp = FIXTURE_ROW(f, light, round & 2 ? r->lamp : r->sun);
    u32 mesh = FIXTURE_ROW(f, instance, things[random_u32(seed, 3, round) % 3]);
    switch (random_u32(seed, 4, round) % 12) {
    case 0:
    case 1:
    case 2: {
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        u32 row = FIXTURE_ROW(f, transform, thing);
        t->x[row] += number - 0.5f;
        t->yaw[row] += number;
        table_touch(&t->table, row);
        return "move";
    }
    case 3:
        m->albedo_r[material] = number;
        table_touch(&m->table, material);
        return "albedo";
    case 4:
        m->emissive_strength[material] = number;
        table_touch(&m->table, material);
        return "emission";
    case 5:
        light->intensity[lamp] = number < 0.3f ? 0 : number;
        table_touch(&light->table, lamp);
        return "intensity";
    case 6:
        light->affects_gi[lamp] ^= 1;
        table_touch(&light->table, lamp);
        return "affects_gi";
    case 7:
        instances->visible[mesh] ^= 1;
        table_touch(&instances->table, mesh);
        return "visible";
    case 8:
        instances->voxel_mode[mesh] = random_u32(seed, 5, round) % 3;
        table_touch(&instances->table, mesh);
        return "voxel_mode";
    case 9:
        if (number < 0.5f) {
            fixture_spawn_mesh(f, MESH_CUBE, vec3(number * 9, 0, -6), vec3(1, 1, 1), 0,
                               COLLISION_NONE);
            return "spawn";
        }
        fixture_spawn_light(f, LIGHT_SPOT, vec3(number * 9, 0, -6), 4);
        return "spawn light";
    case 10: {
        GiTable *gi = FIXTURE_TABLE(f, Gi, gi);
        gi->cosine[0] ^= 1;
        gi->grid[0] = random_u32(seed, 6, round) % 2;
        table_touch(&gi->table, 0);
        return "gi";
    }
    default: {
        EnvironmentTable *e = FIXTURE_TABLE(f, Environment, environment);
        e->sky_zenith_r[0] = number;
        e->attenuation[0] = random_u32(seed, 7, round) % 3;
        table_touch(&e->table, 0);
        return "environment";
    }
    }
}

// Whatever is edited: a key that differs from the last packet's has its flag; and a picture without
// an edit has none. With the previous packet's keys and, by stamps alone, without.
TEST(systems_gi_keys, no_change_goes_unflagged) {
    const u64 seed = 0xF1A6;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 flagged = 0, quiet = 0;
    for (u32 exact = 0; exact < 2; exact++) {
        Room r = make_room();
        SystemsFixture *f = r.f;
        world_singleton(f->world, COMPONENT_gi);
        world_singleton(f->world, COMPONENT_environment);
        FIXTURE_TABLE(f, Gi, gi)->sky[0] = 1;
        PacketGi last = {0};
        u32 since = 0;
        for (u32 round = 0; round < 600; round++) {
            const char *what = round % 5 == 4 ? "nothing" : edit(&r, seed + exact, round);
            systems_tick(&f->systems, &f->context);
            PacketBuildDesc desc = gi_desc(f, ENTITY_NONE, "");
            desc.last_stamp = since;
            desc.previous_gi = exact && since ? &last : NULL;
            const Packet *p = packet_build(&desc, &f->arenas.frame, &f->arenas.scratch, NULL);
            u32 change = since ? changed(&last, &p->gi) : 0, flags = p->flags;
            if ((change & SURFACE) && !(flags & PACKET_REVOXELISE))
                fail_msg("round %u: %s is not voxelised anew", round, what);
            if ((change & LIGHT) && !(flags & PACKET_RELIGHT))
                fail_msg("round %u: %s is not lit anew", round, what);
            if ((change & (STATIC | DYNAMIC)) && flags == 0)
                fail_msg("round %u: %s has no flag", round, what);
            if (round % 5 == 4 && flags) fail_msg("round %u: flags without an edit", round);
            // Emission and light raise nothing but relighting, if that can be told.
            if (exact && since && flags && !strcmp(what, "emission"))
                assert_int_equal(flags, PACKET_RELIGHT);
            if (since && !strcmp(what, "intensity")) assert_int_equal(flags, PACKET_RELIGHT);
            flagged += flags != 0, quiet += flags == 0;
            last = p->gi;
            since = f->world->stamp;
            world_advance_stamp(f->world);
            arena_reset(&f->arenas.frame);
        }
        systems_fixture_destroy(f);
    }
    printf("%u with flags, %u without\n", flagged, quiet);
    assert_true(flagged > 500 && quiet > 200);
}

TEST(systems_gi_keys, cold_packets_say_so) {
    Room r = make_room();
    PacketBuildDesc desc = gi_desc(r.f, r.camera, "");
    desc.last_stamp = r.f->world->stamp + 1;
    Arenas *a = &r.f->arenas;
    assert_int_equal(packet_build(&desc, &a->frame, &a->scratch, NULL)->flags, 0);
    desc.cold = true;
    const Packet *p = packet_build(&desc, &a->frame, &a->scratch, NULL);
    assert_int_equal(p->flags, PACKET_COLD);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    systems_fixture_destroy(r.f);
}

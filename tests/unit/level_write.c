// level_write.c: world to text and back: the same hash.
#include "level_common.h"
#include <stdio.h>

// Loads text, writes the world, loads that, compares; then writes again: the text must be the same.
static void round_trip(const char *text) {
    TestLevel a, b;
    test_level_load_good(&a, text);
    const char *written = level_write(a.world, &a.store, &a.arena);
    test_level_load(&b, written);
    if (!b.is_good) {
        diagnostics_print(b.diagnostics, stderr);
        fputs(written, stderr);
    }
    assert_true(b.is_good);
    for (u32 i = 0; i < a.world->component_count; i++) {
        if (table_hash(a.world->tables[i]) == table_hash(b.world->tables[i])) continue;
        fprintf(stderr, "table %s differs; written:\n%s\n", a.world->tables[i]->desc->name,
                written);
        fail();
    }
    assert_true(world_hash(a.world) == world_hash(b.world));
    assert_string_equal(written, level_write(b.world, &b.store, &b.arena));
    test_level_close(&b);
    test_level_close(&a);
}

TEST(level_write, an_empty_world) { round_trip(""); }

TEST(level_write, everything_comes_back) {
    round_trip(
        "[level]\nseed = -5\n"
        "[environment]\nambient = \"#123456\"\nexposure = 0.1\ngravity = 1.62\n"
        "[rules]\nlimit = 61.5\n"
        "[[material]]\nname = \"brass \\\"old\\\"\"\nalbedo = [0.1, 0.2, 0.3]\nbrdf = \"lambert\"\n"
        "[[model]]\nname = \"ring\"\nshape = \"torus\"\ntube = 0.1\nsegments = 9\nrings = 5\n"
        "[[model]]\nname = \"cave\"\nshape = \"cube\"\ninverted = true\nuv_repeat = 3\n"
        "[[material]]\nname = \"cave/cube\"\nemissive = \"#111\"\nemissive_strength = 2\n"
        "[[prefab]]\nname = \"lamp\"\n"
        "[[prefab.entity]]\ninstance.model = \"ring\"\ninstance.material = \"brass \\\"old\\\"\"\n"
        "[[prefab.entity]]\nname = \"glow\"\nlight.color = \"#fc8\"\nflicker = {}\n"
        "path.points = [[0, 0.1, 0], [1, 2, 3], [4, 5, 6]]\n"
        "[[prefab.entity]]\nname = \"door\"\nparent = \"glow\"\ndoor.lamp = \"glow\"\n"
        "[[entity]]\nname = \"l\"\nprefab = \"lamp\"\nvary.transform.scale = { min = 0.5, max = 2 "
        "}\n"
        "repeat = [{ ring = { count = 5, radius = 3, axis = \"x\" } }, { row = { count = 2, step = "
        "[0.1, 0, 0] } }]\n"
        "[[entity]]\nprefab = \"lamp\"\ntransform.position = [0.1, 1e5, -1e-7]\n"
        "[[entity]]\nname = \"cave\"\ninstance.model = \"cave\"\nparent = \"end\"\n"
        "door = { offset = -10, lock = 0, other = \"ring\" }\n"
        "[[entity]]\nname = \"end\"\npath.points = [[1, 1, 1], [0, 0, 0]]\nwalker = {}\n"
        "camera = {}\n[[entity]]\n");
}

TEST(level_write, borders_of_ranges_come_back) {
    round_trip(
        "[[entity]]\nlight = { outer_angle = 0.1, intensity = 1e6, color = [1000, 0, 0.1] }\n"
        "flicker = { rate = 0.01, amount = 1 }\norbit.period = 0.05\n"
        "camera = { near = 0.001, fov = 150 }\n");
}

TEST(level_write, unnamed_parents_get_names_that_are_free) {
    round_trip("[[prefab]]\nname = \"p\"\n[[prefab.entity]]\n[[prefab.entity]]\n[[prefab.entity]]\n"
               "[[entity]]\nprefab = \"p\"\n[[entity]]\nprefab = \"p\"\n"
               "[[entity]]\nname = \"unnamed\"\n[[entity]]\nname = \"unnamed~2\"\n");
}

TEST(level_write, textures_keep_their_paths) {
    static const u8 pixels[16] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 255};
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 2, 2, 4));
    TestLevel level;
    test_level_load_good(&level, "[[material]]\nname = \"m\"\nalbedo_texture = \"t.png\"\n"
                                 "normal_texture = \"t.png\"\nemissive_texture = \"\"\n");
    const MaterialTable *m = WORLD_TABLE(level.world, Material, material);
    assert_true(m->albedo_texture[0] > 1 && m->normal_texture[0] > 1);
    assert_true(m->albedo_texture[0] != m->normal_texture[0]); // another transfer function
    assert_int_equal(level.info.file_count, 2);
    assert_string_equal(level.info.files[1], "t.png");
    test_level_close(&level);
    round_trip("[[material]]\nname = \"m\"\nalbedo_texture = \"t.png\"\n"
               "[[model]]\nname = \"c\"\nshape = \"cube\"\n"
               "[[material]]\nname = \"c/cube\"\nnormal_texture = \"t.png\"\n"
               "[[entity]]\ninstance.model = \"c\"\n");
    assert_true(file_write(test_temp_path("bad.png"), "no image", 8));
    test_level_load(&level, "[[material]]\nname = \"m\"\nalbedo_texture = \"bad.png\"\n");
    assert_int_equal(level.diagnostics->error_count, 1);
    assert_non_null(strstr(level.diagnostics->items[0].text, "bad.png: not a PNG"));
    assert_int_equal(level.diagnostics->items[0].column, 18);
    test_level_close(&level);
}

TEST(level_write, worlds_made_by_code) {
    World *world = test_level_world();
    Arena arena;
    AssetStore store;
    assert_true(arena_create(&arena, "test", GIB(1)) && asset_store_create(&store));
    Entity twin[2];
    for (u32 i = 0; i < 2; i++) {
        twin[i] = world_spawn(world);
        table_add(world->tables[COMPONENT_transform], twin[i]);
        world_set_name(world, twin[i], "twin");
    }
    Entity gone = world_spawn(world);
    TransformTable *t = WORLD_TABLE(world, Transform, transform);
    t->parent[0] = gone;
    t->parent[1] = twin[0];
    world_despawn(world, gone);
    const char *text = level_write(world, &store, &arena);
    TestLevel level;
    test_level_load_good(&level, text);
    assert_int_equal(WORLD_TABLE(level.world, Transform, transform)->table.count, 2);
    test_level_close(&level);
    world_destroy(world);
    asset_store_destroy(&store);
    arena_destroy(&arena);
}

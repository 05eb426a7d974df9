// level_gltf.c: a .glb file as a level: its lights, its views, and what it gets if it has none.
#include "asset_fixture.h"
#include "level_common.h"
#include <stdio.h>

static void load_glb(TestLevel *level, const char *json) {
    u64 size;
    const u8 *glb = fixture_make_glb(json, &triangle_bin, sizeof triangle_bin, &size);
    test_level_load_bytes(level, "m.glb", glb, size);
    if (!level->is_good) diagnostics_print(level->diagnostics, stderr);
}

// The world as text is the same level.
static void expect_round_trip(TestLevel *level) {
    const char *text = level_write(level->world, &level->store, &level->arena);
    assert_true(file_write(test_temp_path("m.toml"), text, strlen(text)));
    World *world = test_level_world();
    AssetStore store;
    assert_true(asset_store_create(&store));
    LevelInfo info;
    if (!level_load(&level->root, "m.toml", world, &store, &level->arena, &info,
                    level->diagnostics)) {
        diagnostics_print(level->diagnostics, stderr);
        fail();
    }
    assert_true(world_hash(world) == world_hash(level->world));
    world_destroy(world);
    asset_store_destroy(&store);
}

TEST(level_gltf, a_bare_model_gets_a_sun_and_a_view) {
    TestLevel level;
    load_glb(&level, TRIANGLE_JSON);
    assert_true(level.is_good);
    world_check(level.world);
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    assert_int_equal(l->table.count, 1);
    assert_int_equal(l->kind[0], LIGHT_DIRECTIONAL);
    assert_int_equal(l->casts_shadow[0], 1);
    const InstanceTable *i = WORLD_TABLE(level.world, Instance, instance);
    assert_int_equal(i->table.count, 1);
    assert_int_equal(i->voxel_mode[0], VOXEL_STATIC);
    assert_int_equal(i->collision[0], COLLISION_MESH);
    assert_string_equal(world_name(level.world, i->model[0]), "m");
    assert_int_equal(WORLD_TABLE(level.world, Drawable, drawable)->table.count, 1);
    assert_int_equal(WORLD_TABLE(level.world, Camera, camera)->table.count, 2);
    assert_int_equal(WORLD_TABLE(level.world, Walker, walker)->fly[0], 1);
    assert_true(WORLD_TABLE(level.world, Environment, environment)->ambient_r[0] > 0.1f);
    // The view holds the triangle's middle in front and its whole sphere inside 60 degrees.
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    u32 row = test_level_row(&level, COMPONENT_transform, "main");
    Mat34 view = mat34_from_trs(vec3(t->x[row], t->y[row], t->z[row]),
                                vec3(t->pitch[row], t->yaw[row], t->roll[row]), vec3(1, 1, 1));
    view = mat34_inverse(view);
    Vec3 middle = mat34_point(&view, vec3(0.5f, 0.5f, 0));
    ASSERT_NEAR(middle.x, 0, 1e-4);
    ASSERT_NEAR(middle.y, 0, 1e-4);
    f32 radius = 0.70710678f, distance = -middle.z;
    assert_true(distance * det_sin(DEG_TO_RAD(30)) > radius && distance < 4 * radius);
    test_level_row(&level, COMPONENT_walker, "spawn");
    expect_round_trip(&level);
    test_level_close(&level);
}

static const char lit_json[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3,4,5]}],"
    "\"extensionsUsed\":[\"KHR_lights_punctual\"],"
    "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
    "{\"type\":\"point\",\"name\":\"lamp\",\"color\":[1,0.5,0.25],\"intensity\":7,\"range\":3},"
    "{\"type\":\"spot\",\"name\":\"lamp\",\"spot\":{\"innerConeAngle\":0.1,\"outerConeAngle\":0.5}}"
    ","
    "{\"type\":\"directional\",\"intensity\":2}]}},"
    "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.8,\"znear\":0.05}},"
    "{\"type\":\"perspective\",\"name\":\"%s\",\"perspective\":{\"yfov\":1.2,\"znear\":0.2}}],"
    "\"nodes\":[{\"mesh\":0},"
    "{\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
    "{\"rotation\":[-0.70710678,0,0,0.70710678],\"extensions\":{\"KHR_lights_punctual\":{\"light\":"
    "1}}},"
    "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}},"
    "{\"camera\":0,\"translation\":[0,1,5]},{\"camera\":1,\"translation\":[0,2,9]}],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},"
    "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"
    "\"buffers\":[{\"byteLength\":44}]}";

TEST(level_gltf, lights_and_cameras_of_the_file) {
    for (u32 second_is_main = 0; second_is_main < 2; second_is_main++) {
        char json[4096];
        snprintf(json, sizeof json, lit_json, second_is_main ? "main" : "other");
        TestLevel level;
        load_glb(&level, json);
        assert_true(level.is_good);
        const LightTable *l = WORLD_TABLE(level.world, Light, light);
        const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
        assert_int_equal(l->table.count, 3);
        ASSERT_NEAR(WORLD_TABLE(level.world, Environment, environment)->ambient_g[0], 0.02f, 0);
        u32 lamp = test_level_row(&level, COMPONENT_light, "lamp");
        ASSERT_NEAR(l->intensity[lamp], 7, 0);
        ASSERT_NEAR(l->range[lamp], 3, 0);
        ASSERT_NEAR(l->color_b[lamp], 0.25, 0);
        u32 place = table_row(&t->table, l->table.entity[lamp]);
        ASSERT_NEAR(t->z[place], 3, 0);
        u32 spot = test_level_row(&level, COMPONENT_light, "lamp.1");
        assert_int_equal(l->kind[spot], LIGHT_SPOT);
        ASSERT_NEAR(l->outer_angle[spot], 28.6479, 1e-3);
        place = table_row(&t->table, l->table.entity[spot]);
        ASSERT_NEAR(t->pitch[place], -90, 0.05);
        assert_int_equal(l->kind[2], LIGHT_DIRECTIONAL);
        assert_int_equal(l->casts_shadow[2], 1);
        const CameraTable *c = WORLD_TABLE(level.world, Camera, camera);
        assert_int_equal(c->table.count, 3);
        u32 main_row = test_level_row(&level, COMPONENT_camera, "main");
        ASSERT_NEAR(c->fov[main_row], second_is_main ? 68.7549 : 45.8366, 1e-3);
        ASSERT_NEAR(c->near[main_row], second_is_main ? 0.2f : 0.05f, 1e-7);
        if (!second_is_main) test_level_row(&level, COMPONENT_camera, "other");
        place = test_level_row(&level, COMPONENT_transform, "spawn");
        ASSERT_NEAR(t->z[place], second_is_main ? 9 : 5, 0);
        expect_round_trip(&level);
        test_level_close(&level);
    }
}

TEST(level_gltf, a_large_model_is_a_place_to_stand_in) {
    const char *json = fixture_replace(TRIANGLE_JSON, "\"mesh\":0}",
                                       "\"mesh\":0,\"scale\":[20,6,1],\"translation\":[5,-1,2]}");
    TestLevel level;
    load_glb(&level, json);
    assert_true(level.is_good);
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    u32 row = test_level_row(&level, COMPONENT_transform, "spawn");
    ASSERT_NEAR(t->y[row], -1 + 1.7, 1e-5); // eyes above the floor
    assert_true(t->x[row] > 15 && t->x[row] < 25);
    ASSERT_NEAR(t->yaw[row], 90, 0); // along the longest side
    assert_int_equal(WORLD_TABLE(level.world, Walker, walker)->fly[0], 0);
    test_level_close(&level);
}

TEST(level_gltf, a_refused_model_is_one_diagnostic) {
    TestLevel level;
    test_level_load_bytes(&level, "m.glb", "glTF", 4);
    assert_false(level.is_good);
    assert_int_equal(level.diagnostics->error_count, 1);
    assert_non_null(strstr(level.diagnostics->items[0].text, "the model is refused"));
    test_level_close(&level);
    // Named in level text, it is reported at the key.
    assert_true(file_write(test_temp_path("bad.glb"), "glTF", 4));
    test_level_load(&level, "[[model]]\nname = \"m\"\nfile = \"bad.glb\"\n[[entity]]\n"
                            "instance.model = \"m\"\n");
    assert_int_equal(level.diagnostics->error_count, 1); // the name itself is known
    assert_int_equal(level.diagnostics->items[0].line, 3);
    assert_int_equal(level.diagnostics->items[0].column, 8);
    test_level_close(&level);
}

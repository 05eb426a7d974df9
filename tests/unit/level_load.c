// level_load.c: levels without mistakes: every feature of the format, with the exact rows it makes.
#include "level_common.h"
#include <stdio.h>

static const char all_features[] =
    "[level]\n"
    "title = \"All\"\n"
    "seed = 7\n"
    "[environment]\n"
    "ambient = \"#0b1020\"\n"
    "exposure = 2\n"
    "attenuation = \"window\"\n"
    "shadow_size = 512\n"
    "[rules]\n"
    "limit = 30\n"
    "[[model]]\n"
    "name = \"ball\"\n"
    "shape = \"sphere\"\n"
    "segments = 8\n"
    "[[model]]\n"
    "name = \"floor\"\n"
    "shape = \"plane\"\n"
    "uv_repeat = 4.0\n"
    "[[material]]\n"
    "name = \"brass\"\n"
    "albedo = [0.4, 0.3, 0.1]\n"
    "specular = \"#fff\"\n"
    "brdf = \"phong\"\n"
    "double_sided = true\n"
    "[[material]]\n"
    "name = \"ball/sphere\"\n"
    "power = 12\n"
    "[[entity]]\n"
    "name = \"ground\"\n"
    "instance.model = \"floor\"\n"
    "instance.material = \"brass\"\n"
    "instance.collision = \"box\"\n"
    "transform.scale = 20\n"
    "[[entity]]\n"
    "name = \"ball\"\n"
    "parent = \"ground\"\n"
    "[entity.transform]\n"
    "position = [1, 2.5, -3]\n"
    "rotation = [0, 90, 0]\n"
    "scale = [1, 2, 3]\n"
    "[entity.instance]\n"
    "model = \"ball\"\n"
    "[[entity]]\n"
    "light = { kind = \"spot\", color = \"#ffa040\", intensity = 5, static = true }\n"
    "orbit = {}\n"
    "name = \"lamp\"\n"
    "path.points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n"
    "[[entity]]\n"
    "name = \"gate\"\n"
    "door = { lamp = \"lamp\", other = \"brass\", offset = -7, lock = 100 }\n"
    "[[entity]]\n"
    "camera.fov = 75\n"
    "name = \"main\"\n";

TEST(level, loads_every_feature) {
    TestLevel level;
    test_level_load_good(&level, all_features);
    const World *world = level.world;
    assert_string_equal(level.info.title, "All");
    assert_int_equal(level.info.seed, 7);
    assert_int_equal(world->seed, 7);
    assert_int_equal(level.info.entity_count, 5);
    assert_int_equal(level.diagnostics->warning_count, 0);

    const EnvironmentTable *e = WORLD_TABLE(world, Environment, environment);
    assert_int_equal(e->table.count, 1);
    ASSERT_NEAR(e->ambient_r[0], 0.003346536, 1e-8);
    ASSERT_NEAR(e->ambient_g[0], 0.005181517, 1e-8);
    ASSERT_NEAR(e->ambient_b[0], 0.014443844, 1e-8);
    ASSERT_NEAR(e->exposure[0], 2, 0);
    assert_int_equal(e->attenuation[0], ATTENUATION_WINDOW);
    assert_int_equal(e->shadow_size[0], 512);
    ASSERT_NEAR(e->gravity[0], 9.81f, 0);
    const RulesTable *rules = (const RulesTable *)world_find_table(world, "rules");
    assert_int_equal(rules->table.count, 1);
    ASSERT_NEAR(rules->limit[0], 30, 0);

    const MaterialTable *m = WORLD_TABLE(world, Material, material);
    u32 brass = test_level_row(&level, COMPONENT_material, "brass");
    ASSERT_NEAR(m->albedo_g[brass], 0.3f, 0);
    ASSERT_NEAR(m->specular_b[brass], 1, 0);
    assert_int_equal(m->brdf[brass], BRDF_PHONG);
    assert_int_equal(m->double_sided[brass], 1);
    ASSERT_NEAR(m->power[brass], 32, 0);
    ASSERT_NEAR(m->power[test_level_row(&level, COMPONENT_material, "ball/sphere")], 12, 0);

    const ModelTable *models = WORLD_TABLE(world, Model, model);
    assert_int_equal(models->table.count, 2);
    u32 floor_row = test_level_row(&level, COMPONENT_model, "floor");
    assert_int_equal(models->first_material[floor_row],
                     m->table.entity[test_level_row(&level, COMPONENT_material, "floor/plane")]);

    const TransformTable *t = WORLD_TABLE(world, Transform, transform);
    assert_int_equal(t->table.count, 5);
    u32 ball = test_level_row(&level, COMPONENT_transform, "ball");
    u32 ground = test_level_row(&level, COMPONENT_transform, "ground");
    ASSERT_NEAR(t->y[ball], 2.5, 0);
    ASSERT_NEAR(t->z[ball], -3, 0);
    ASSERT_NEAR(t->yaw[ball], 90, 0);
    ASSERT_NEAR(t->scale_z[ball], 3, 0);
    ASSERT_NEAR(t->scale_x[ground], 20, 0);
    ASSERT_NEAR(t->scale_z[ground], 20, 0);
    assert_int_equal(t->parent[ball], t->table.entity[ground]);
    assert_int_equal(t->parent[ground], ENTITY_NONE);

    const LightTable *l = WORLD_TABLE(world, Light, light);
    assert_int_equal(l->table.count, 1);
    assert_int_equal(l->kind[0], LIGHT_SPOT);
    assert_int_equal(l->is_static[0], 1);
    ASSERT_NEAR(l->color_r[0], 1, 0);
    ASSERT_NEAR(l->color_g[0], 0.35153264, 1e-6);
    ASSERT_NEAR(l->intensity[0], 5, 0);
    ASSERT_NEAR(l->gain[0], 1, 0);
    assert_int_equal(WORLD_TABLE(world, Orbit, orbit)->table.count, 1);
    const PathTable *paths = WORLD_TABLE(world, Path, path);
    const f32 *xyz;
    assert_int_equal(world_points(world, paths->points[0], &xyz), 3);
    ASSERT_NEAR(xyz[7], 1, 0);

    const DoorTable *doors = test_level_doors(&level);
    assert_int_equal(doors->table.count, 1);
    assert_int_equal(doors->lamp[0], l->table.entity[0]);
    assert_int_equal(doors->other[0], m->table.entity[brass]);
    assert_int_equal(doors->offset[0], -7);
    assert_int_equal(doors->lock[0], 100);
    ASSERT_NEAR(doors->angle_max[0], 90, 0);

    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    assert_int_equal(d->table.count, 2);
    assert_int_equal(d->owner[0], t->table.entity[ground]);
    assert_int_equal(d->material[0], m->table.entity[brass]);
    assert_int_equal(d->material[1],
                     m->table.entity[test_level_row(&level, COMPONENT_material, "ball/sphere")]);
    assert_int_equal(
        d->mesh[1],
        level.store.models[models->model[test_level_row(&level, COMPONENT_model, "ball")]]
            .parts[0]
            .mesh);
    ASSERT_NEAR(d->l00[0], 1, 0);
    test_level_close(&level);
}

TEST(level, an_empty_level_is_good) {
    TestLevel level;
    test_level_load_good(&level, "");
    assert_int_equal(WORLD_TABLE(level.world, Environment, environment)->table.count, 1);
    assert_int_equal(level.info.file_count, 1);
    assert_string_equal(level.info.files[0], "test.toml");
    test_level_close(&level);
}

TEST(level, same_text_same_world) {
    TestLevel a, b;
    test_level_load_good(&a, all_features);
    test_level_load_good(&b, all_features);
    assert_true(world_hash(a.world) == world_hash(b.world));
    assert_true(a.info.content_hash == b.info.content_hash);
    test_level_close(&b);
    test_level_load_good(&b, "[level]\ntitle = \"Else\"\n");
    assert_true(a.info.content_hash != b.info.content_hash);
    test_level_close(&b);
    test_level_close(&a);
}

TEST(level, colours_are_srgb_text_or_linear_numbers) {
    static const struct {
        const char *text;
        f64 r, g, b;
    } cases[] = {
        {"\"#000000\"", 0, 0, 0},
        {"\"#FFF\"", 1, 1, 1},
        {"\"#f00\"", 1, 0, 0},
        {"\"#808080\"", 0.2158605, 0.2158605, 0.2158605},
        {"\"#0A0a0A\"", 0.003035270, 0.003035270, 0.003035270},
        {"[0.25, 0.5, 1]", 0.25, 0.5, 1},
    };
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        char text[128];
        snprintf(text, sizeof text, "[[entity]]\nname = \"l\"\nlight.color = %s\n", cases[i].text);
        TestLevel level;
        test_level_load_good(&level, text);
        const LightTable *l = WORLD_TABLE(level.world, Light, light);
        ASSERT_NEAR(l->color_r[0], cases[i].r, 1e-6);
        ASSERT_NEAR(l->color_g[0], cases[i].g, 1e-6);
        ASSERT_NEAR(l->color_b[0], cases[i].b, 1e-6);
        test_level_close(&level);
    }
}

TEST(level, prefabs_make_groups_and_own_values_win) {
    TestLevel level;
    test_level_load_good(&level, "[[prefab]]\n"
                                 "name = \"lamp\"\n"
                                 "[[prefab.entity]]\n"
                                 "name = \"post\"\n"
                                 "transform.position = [9, 9, 9]\n"
                                 "transform.scale = 2\n"
                                 "door = { angle = 10, lamp = \"glow\" }\n"
                                 "[[prefab.entity]]\n"
                                 "name = \"arm\"\n"
                                 "transform.position = [0, 3, 0]\n"
                                 "[[prefab.entity]]\n"
                                 "name = \"glow\"\n"
                                 "parent = \"arm\"\n"
                                 "light = { intensity = 4 }\n"
                                 "[[entity]]\n"
                                 "name = \"a\"\n"
                                 "prefab = \"lamp\"\n"
                                 "transform.position = [1, 0, 0]\n"
                                 "door.lock = 5\n"
                                 "[[entity]]\n"
                                 "prefab = \"lamp\"\n");
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    const DoorTable *doors = test_level_doors(&level);
    assert_int_equal(t->table.count, 6);
    assert_int_equal(level.info.entity_count, 6);
    u32 a = test_level_row(&level, COMPONENT_transform, "a");
    u32 arm = test_level_row(&level, COMPONENT_transform, "a/arm");
    u32 glow = test_level_row(&level, COMPONENT_transform, "a/glow");
    ASSERT_NEAR(t->x[a], 1, 0);
    ASSERT_NEAR(t->y[a], 0, 0);
    ASSERT_NEAR(t->scale_y[a], 2, 0);
    assert_int_equal(t->parent[a], ENTITY_NONE);
    assert_int_equal(t->parent[arm], t->table.entity[a]);
    assert_int_equal(t->parent[glow], t->table.entity[arm]);
    // Each door has the lamp of its own group.
    assert_int_equal(doors->table.count, 2);
    assert_int_equal(doors->lamp[0], l->table.entity[0]);
    assert_int_equal(doors->lamp[1], l->table.entity[1]);
    assert_int_equal(doors->lock[0], 5);
    assert_int_equal(doors->lock[1], 2);
    ASSERT_NEAR(doors->angle_max[0], 10, 0);
    // The unnamed instance: same shape, no names.
    u32 second = table_row(&t->table, doors->table.entity[1]);
    ASSERT_NEAR(t->x[second], 9, 0);
    assert_string_equal(world_name(level.world, l->table.entity[1]), "");
    test_level_close(&level);
}

TEST(level, prefabs_nest_and_repeat) {
    TestLevel level;
    test_level_load_good(&level, "[[prefab]]\n"
                                 "name = \"flame\"\n"
                                 "[[prefab.entity]]\n"
                                 "light.intensity = 2\n"
                                 "[[prefab]]\n"
                                 "name = \"chandelier\"\n"
                                 "[[prefab.entity]]\n"
                                 "name = \"hub\"\n"
                                 "[[prefab.entity]]\n"
                                 "name = \"flame\"\n"
                                 "prefab = \"flame\"\n"
                                 "light.range = 6\n"
                                 "repeat = { ring = { count = 3, radius = 2 } }\n"
                                 "[[entity]]\n"
                                 "name = \"c\"\n"
                                 "prefab = \"chandelier\"\n"
                                 "repeat.row = { count = 2, step = [10, 0, 0] }\n");
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    assert_int_equal(l->table.count, 6);
    assert_int_equal(t->table.count, 8);
    u32 row = test_level_row(&level, COMPONENT_light, "c.1/flame.2");
    ASSERT_NEAR(l->intensity[row], 2, 0);
    ASSERT_NEAR(l->range[row], 6, 0);
    u32 place = table_row(&t->table, l->table.entity[row]);
    assert_int_equal(t->parent[place],
                     t->table.entity[test_level_row(&level, COMPONENT_transform, "c.1")]);
    test_level_close(&level);
}

TEST(level, names_of_each_kind_are_apart) {
    TestLevel level;
    test_level_load_good(&level, "[[model]]\nname = \"x\"\nshape = \"cube\"\n"
                                 "[[material]]\nname = \"x\"\n"
                                 "[[prefab]]\nname = \"x\"\n[[prefab.entity]]\n"
                                 "[[entity]]\nname = \"x\"\nprefab = \"x\"\n"
                                 "instance = { model = \"x\", material = \"x\" }\n");
    const InstanceTable *i = WORLD_TABLE(level.world, Instance, instance);
    assert_int_equal(i->model[0], WORLD_TABLE(level.world, Model, model)->table.entity[0]);
    u32 x = test_level_row(&level, COMPONENT_material, "x");
    assert_int_equal(i->material[0], WORLD_TABLE(level.world, Material, material)->table.entity[x]);
    test_level_close(&level);
}

TEST(level, root_is_the_nearest_data_directory) {
    char root[256], relative[256];
    assert_true(level_find_root("data/levels/a.toml", root, 256, relative, 256));
    assert_string_equal(root, "data");
    assert_string_equal(relative, "levels/a.toml");
    assert_true(level_find_root("/x/data/y/data/levels/a.toml", root, 256, relative, 256));
    assert_string_equal(root, "/x/data/y/data");
    assert_string_equal(relative, "levels/a.toml");
    assert_true(level_find_root("/x/y/a.toml", root, 256, relative, 256));
    assert_string_equal(root, "/x/y");
    assert_string_equal(relative, "a.toml");
    assert_true(level_find_root("a.toml", root, 256, relative, 256));
    assert_string_equal(root, ".");
    assert_false(level_find_root("data/levels/a.toml", root, 256, relative, 4));
}

// game_demo.c: tests of the demo's rules: doors, shy fireflies, the touring camera.
#include "../../engine/luz.h"
#include "../../game/door.h"
#include "../../game/shy.h"
#include "../../game/tour.h"
#include "../test.h"
#include <string.h>

static const char level_text[] =
    "[[model]]\nname = \"box\"\nshape = \"cube\"\n"
    "[[entity]]\nname = \"spawn\"\ntransform.position = [0, 1.63, 20]\ncamera = {}\nwalker.fly = "
    "true\n"
    "[[entity]]\nname = \"a\"\ntransform.position = [0, 5, 0]\ncamera = { fov = 40 }\n"
    "[[entity]]\nname = \"b\"\ntransform = { position = [10, 5, 0], rotation = [0, 170, 0] }\n"
    "camera = { fov = 60 }\n"
    "[[entity]]\nname = \"c\"\ntransform = { position = [10, 5, 9], rotation = [0, -170, 0] }\n"
    "camera = { fov = 50 }\n"
    "[[entity]]\nname = \"leaf\"\ntransform.rotation = [0, 30, 0]\ninstance = { model = \"box\" }\n"
    "door = { angle = -90, radius = 3, speed = 180 }\n"
    "[[entity]]\nname = \"fly\"\ntransform.position = [0, 1, 40]\nlight = {}\n"
    "shy = { distance = 2, reach = 1.5, calm = 0.3 }\n";

static Luz *open_demo(void) {
    const char *path = test_temp_path("demo.toml");
    assert_true(file_write(path, level_text, sizeof level_text - 1));
    LuzDesc desc = {.level = path,
                    .components = luz_project.components,
                    .component_count = luz_project.component_count,
                    .systems = luz_project.systems,
                    .system_count = luz_project.system_count,
                    .on_load = luz_project.on_load};
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    return luz;
}

static u32 place_row(Luz *luz, const char *name) {
    World *world = luz_world(luz);
    Entity entity = name ? world_find(world, name) : luz_session(luz)->player;
    u32 row = table_row(world->tables[COMPONENT_transform], entity);
    assert_true(row != ROW_NONE);
    return row;
}

static TransformTable *places_of(Luz *luz) {
    return WORLD_TABLE(luz_world(luz), Transform, transform);
}

// The walker is put somewhere, and a second goes by.
static void stand(Luz *luz, f32 x, f32 z) {
    TransformTable *places = places_of(luz);
    u32 row = place_row(luz, NULL);
    places->x[row] = x;
    places->z[row] = z;
    table_touch(&places->table, row);
    for (u32 i = 0; i < TICK_RATE; i++) luz_step(luz, (Input){0});
}

TEST(game_demo, a_door_opens_and_closes) {
    Luz *luz = open_demo();
    TransformTable *places = places_of(luz);
    stand(luz, 0, 20);
    u32 leaf = place_row(luz, "leaf");
    assert_true(places->yaw[leaf] == 30.0f);
    stand(luz, 1, 1);
    ASSERT_NEAR(places->yaw[leaf], -60.0, 1e-4);
    stand(luz, 0, 20);
    ASSERT_NEAR(places->yaw[leaf], 30.0, 1e-4);
    luz_close(luz);
}

TEST(game_demo, a_resting_door_touches_nothing) {
    Luz *luz = open_demo();
    stand(luz, 0, 20);
    const Table *doors = world_find_table(luz_world(luz), "door");
    u32 stamp = doors->newest_stamp;
    stand(luz, 0, 21);
    assert_int_equal(doors->newest_stamp, stamp);
    luz_close(luz);
}

TEST(game_demo, a_firefly_keeps_its_distance) {
    Luz *luz = open_demo();
    TransformTable *places = places_of(luz);
    stand(luz, 0, 20);
    u32 fly = place_row(luz, "fly");
    ASSERT_NEAR(places->z[fly], 40.0, 1e-6);
    stand(luz, 0, 39.5f);
    assert_true(places->z[fly] > 40.8f && places->z[fly] < 41.5f);
    ASSERT_NEAR(places->x[fly], 0.0, 1e-6);
    for (u32 i = 0; i < 4; i++) stand(luz, 0, 20);
    ASSERT_NEAR(places->z[fly], 40.0, 0.01);
    luz_close(luz);
}

TEST(game_demo, the_tour_visits_cameras_in_name_order) {
    Luz *luz = open_demo();
    World *world = luz_world(luz);
    TransformTable *places = places_of(luz);
    CameraTable *cameras = WORLD_TABLE(world, Camera, camera);
    u32 row = place_row(luz, TOUR_CAMERA);
    u32 camera = table_row(&cameras->table, world_find(world, TOUR_CAMERA));
    TourTable *tours = (TourTable *)world_find_table(world, "tour");
    const u32 leg = (u32)(tours->leg[0] * TICK_RATE) + 1 + (u32)(tours->stay[0] * TICK_RATE);
    // Before the first tick it is at the first stop, and its matrix says so.
    ASSERT_NEAR(places->y[row], 5.0, 1e-5);
    ASSERT_NEAR(places->w13[row], 5.0, 1e-5);
    const f32 expected[3][3] = {{0, 0, 40}, {10, 0, 60}, {10, 9, 50}};
    for (u32 stop = 0; stop < 6; stop++) {
        while (world->tick < stop * leg + 1) luz_step(luz, (Input){0});
        ASSERT_NEAR(places->x[row], expected[stop % 3][0], 1e-4);
        ASSERT_NEAR(places->z[row], expected[stop % 3][1], 1e-4);
        ASSERT_NEAR(cameras->fov[camera], expected[stop % 3][2], 1e-4);
    }
    // From 170 to -170 degrees it turns by 20, not by 340.
    while (world->tick < 7 * leg + leg / 2) luz_step(luz, (Input){0});
    f32 yaw = places->yaw[row];
    assert_true(fabsf(yaw) >= 169.0f && fabsf(yaw) <= 191.0f);
    luz_close(luz);
}

TEST(game_demo, the_same_game_twice) {
    u64 hashes[2];
    for (u32 run = 0; run < 2; run++) {
        Luz *luz = open_demo();
        for (u32 i = 0; i < 600; i++)
            luz_step(luz,
                     (Input){.move_z = 127, .look_x = (i16)(i % 17 - 8), .buttons = INPUT_RUN});
        hashes[run] = world_hash(luz_world(luz));
        luz_close(luz);
    }
    assert_true(hashes[0] == hashes[1]);
}

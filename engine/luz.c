// luz.c: the public face: app/ under its public names, and a few ways to fill a world from code.
//
// Data in: a LuzDesc. Data out: a program that runs, or a Luz to step by hand. Called by: programs.
// Does not: hold any state of its own.
#include "luz.h"
#include "level/level.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

int luz_run(const LuzDesc *desc) {
    Luz *luz = luz_open(desc);
    if (!luz) return APP_FAILED;
    int code = desc->headless ? APP_NO_WINDOW : app_run_window(luz);
    if (code == APP_NO_WINDOW) code = app_run_headless(luz);
    app_record_stop(luz);
    if (code == APP_OK && luz->record_lost) code = APP_ENVIRONMENT;
    luz_close(luz);
    return code;
}

int luz_options(int argc, char **argv, LuzDesc *desc, LuzOptions *options) {
    return app_parse_options(argc, argv, desc, options);
}

Luz *luz_open(const LuzDesc *desc) {
    Luz *luz = calloc(1, sizeof *luz);
    if (luz && app_create(luz, desc)) return luz;
    free(luz);
    return NULL;
}

void luz_close(Luz *luz) {
    if (!luz) return;
    app_destroy(luz);
    free(luz);
}

bool luz_load(Luz *luz, const char *path) { return app_load(luz, path); }
void luz_step(Luz *luz, Input input) { app_tick(luz, input); }

bool luz_draw(Luz *luz, const char *camera, u32 width_px, u32 height_px, RenderImage *out) {
    if (!luz->gpu && !app_open_device(luz, NULL)) return false;
    return app_picture(luz, camera, width_px, height_px, out);
}

bool luz_draw_png(Luz *luz, const char *camera, u32 width_px, u32 height_px, const char *path) {
    RenderImage image;
    return luz_draw(luz, camera, width_px, height_px, &image) &&
           image_write_png(path, image.rgba, image.width_px, image.height_px, 4);
}

World *luz_world(Luz *luz) { return luz->session.world; }
Session *luz_session(Luz *luz) { return &luz->session; }
RenderSettings *luz_settings(Luz *luz) { return &luz->settings; }
void luz_set_camera(Luz *luz, const char *name) { app_set_camera(luz, name); }

void luz_say(Luz *luz, const char *format, ...) {
    char text[sizeof luz->messages[0].text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    app_say(luz, "%s", text);
}

// --- Worlds from code ---

static Entity add_entity(World *world, const char *name, Vec3 position, u32 *row) {
    Entity entity = world_spawn(world);
    if (entity == ENTITY_NONE) return entity;
    world_set_name(world, entity, name);
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    *row = table_add(&transforms->table, entity);
    transforms->x[*row] = position.x;
    transforms->y[*row] = position.y;
    transforms->z[*row] = position.z;
    return entity;
}

// `material` ENTITY_NONE = the model's own.
static void add_instance(World *world, const AssetStore *assets, Entity entity, Entity model,
                         Entity material) {
    InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    u32 row = table_add(&instances->table, entity);
    instances->model[row] = model;
    instances->material[row] = material;
    level_spawn_drawables(world, assets, entity);
}

Entity luz_add_shape(World *world, AssetStore *assets, const char *name, const ShapeDesc *shape,
                     Vec3 position, Vec3 scale, Vec3 color) {
    u32 row, id = asset_generate_model(assets, shape);
    if (!id) return ENTITY_NONE;
    Entity entity = add_entity(world, name, position, &row);
    Entity material = world_spawn(world), model = level_spawn_model(world, assets, id, NULL);
    if (entity == ENTITY_NONE || material == ENTITY_NONE || model == ENTITY_NONE)
        return ENTITY_NONE;
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    transforms->scale_x[row] = scale.x;
    transforms->scale_y[row] = scale.y;
    transforms->scale_z[row] = scale.z;
    MaterialTable *materials = WORLD_TABLE(world, Material, material);
    u32 painted = table_add(&materials->table, material);
    materials->albedo_r[painted] = color.x;
    materials->albedo_g[painted] = color.y;
    materials->albedo_b[painted] = color.z;
    add_instance(world, assets, entity, model, material);
    return entity;
}

Entity luz_add_model(World *world, AssetStore *assets, const char *name, const char *path,
                     Vec3 position, f32 yaw_deg) {
    char directory[1024];
    const char *file;
    FileRoot root;
    file_split_path(path, directory, sizeof directory, &file);
    if (!file_root_open(&root, directory)) return ENTITY_NONE;
    u32 row, id = asset_load_model(assets, &root, file);
    file_root_close(&root);
    if (!id) return ENTITY_NONE;
    Entity entity = add_entity(world, name, position, &row);
    Entity model = level_spawn_model(world, assets, id, NULL);
    if (entity == ENTITY_NONE || model == ENTITY_NONE) return ENTITY_NONE;
    WORLD_TABLE(world, Transform, transform)->yaw[row] = yaw_deg;
    add_instance(world, assets, entity, model, ENTITY_NONE);
    return entity;
}

Entity luz_add_light(World *world, const char *name, Vec3 position, Vec3 color, f32 intensity_cd) {
    u32 row;
    Entity entity = add_entity(world, name, position, &row);
    if (entity == ENTITY_NONE) return entity;
    LightTable *lights = WORLD_TABLE(world, Light, light);
    row = table_add(&lights->table, entity);
    lights->color_r[row] = color.x;
    lights->color_g[row] = color.y;
    lights->color_b[row] = color.z;
    lights->intensity[row] = intensity_cd;
    return entity;
}

Entity luz_add_camera(World *world, const char *name, Vec3 position, f32 yaw_deg, f32 pitch_deg) {
    u32 row;
    Entity entity = add_entity(world, name, position, &row);
    if (entity == ENTITY_NONE) return entity;
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    transforms->yaw[row] = yaw_deg;
    transforms->pitch[row] = pitch_deg;
    table_add(world->tables[COMPONENT_camera], entity);
    return entity;
}

// level_gltf.c: a .gltf or .glb file as a level of its own.
// Data in: a model file. Data out: the same rows as level text would make: the model, one static
// instance of it, its lights and cameras; a sun if it brings no light, a camera if it brings no
// view, and the entity "spawn" where a player starts. Called by level_read.c. Does not: read node
// names or animations; a model that the engine refuses is one diagnostic.
#include "level_internal.h"
#include "../base/log.h"
#include <stdio.h>
#include <string.h>

#define INTERIOR_SIZE  8.0f // m: a larger model is a place to stand in
#define EYE_HEIGHT     1.7f
#define VIEW_FOV_DEG   60.0f
#define LIGHTS_AMBIENT 0.02f // beside the file's own lights

// A name that no entity has yet: "name", "name.1" ...
static void set_name(LevelReader *reader, Entity entity, const char *wanted) {
    char text[LEVEL_NAME_MAX + 16];
    for (u32 i = 0;; i++) {
        snprintf(text, sizeof text, i ? "%.100s.%u" : "%.100s", wanted, i);
        for (char *c = text; *c; c++)
            if ((u8)*c < 32 || (u8)*c == 127) *c = ' ';
        const char *name = arena_copy_string(&reader->scratch, text);
        if (level_names_add(&reader->names, &reader->scratch,
                            (LevelName){name, entity, NAME_ENTITY, {1, 1, 1}}))
            continue;
        world_set_name(reader->world, entity, name);
        return;
    }
}

static Entity spawn_at(LevelReader *reader, const char *name, Vec3 position, Vec3 rotation_deg) {
    Entity entity = world_spawn(reader->world);
    TransformTable *t = WORLD_TABLE(reader->world, Transform, transform);
    u32 row = table_add(&t->table, entity);
    t->x[row] = position.x;
    t->y[row] = position.y;
    t->z[row] = position.z;
    t->pitch[row] = rotation_deg.x;
    t->yaw[row] = rotation_deg.y;
    t->roll[row] = rotation_deg.z;
    if (name[0]) set_name(reader, entity, name);
    reader->entity_total++;
    return entity;
}

static Entity spawn_local(LevelReader *reader, const char *name, const Mat34 *local) {
    return spawn_at(reader, name, mat34_translation(local), mat34_rotation_deg(local));
}

static f32 degrees(f32 radians) { return radians * (180.0f / PI_F); }

static void spawn_light(LevelReader *reader, const ModelLight *light, bool *has_shadow) {
    Entity entity =
        spawn_local(reader, light->name && light->name[0] ? light->name : "light", &light->local);
    LightTable *l = WORLD_TABLE(reader->world, Light, light);
    u32 row = table_add(&l->table, entity);
    l->kind[row] = MIN(light->kind, (u32)LIGHT_DIRECTIONAL);
    l->color_r[row] = CLAMP(light->color[0], 0.0f, 1000.0f);
    l->color_g[row] = CLAMP(light->color[1], 0.0f, 1000.0f);
    l->color_b[row] = CLAMP(light->color[2], 0.0f, 1000.0f);
    l->intensity[row] = CLAMP(light->intensity, 0.0f, 1e6f);
    l->range[row] = CLAMP(light->range, 0.0f, 1e4f);
    l->is_static[row] = true;
    if (light->kind == LIGHT_SPOT) {
        l->inner_angle[row] = CLAMP(degrees(light->inner_rad), 0.0f, 89.0f);
        l->outer_angle[row] = CLAMP(degrees(light->outer_rad), 0.1f, 89.0f);
    }
    if (light->kind == LIGHT_DIRECTIONAL && !*has_shadow) l->casts_shadow[row] = *has_shadow = true;
}

static void spawn_sun(LevelReader *reader) {
    Entity entity = spawn_at(reader, "sun", vec3(0, 0, 0), vec3(-62, 24, 0));
    LightTable *l = WORLD_TABLE(reader->world, Light, light);
    u32 row = table_add(&l->table, entity);
    l->kind[row] = LIGHT_DIRECTIONAL;
    l->color_g[row] = 0.95f;
    l->color_b[row] = 0.86f;
    l->intensity[row] = 9;
    l->casts_shadow[row] = true;
    l->is_static[row] = true;
}

static void set_environment(LevelReader *reader, bool has_lights) {
    // As level text has them: every singleton is there.
    for (u32 i = 0; i < COMPONENT_ENGINE_COUNT; i++)
        if (reader->world->tables[i]->desc->singleton && i != COMPONENT_gi)
            world_singleton(reader->world, i);
    u32 row = world_singleton(reader->world, COMPONENT_environment);
    EnvironmentTable *e = WORLD_TABLE(reader->world, Environment, environment);
    if (has_lights) {
        e->ambient_r[row] = e->ambient_g[row] = e->ambient_b[row] = LIGHTS_AMBIENT;
        return;
    }
    e->ambient_r[row] = 0.16f;
    e->ambient_g[row] = 0.18f;
    e->ambient_b[row] = 0.22f;
    e->sky_zenith_r[row] = 0.18f;
    e->sky_zenith_g[row] = 0.33f;
    e->sky_zenith_b[row] = 0.62f;
    e->sky_horizon_r[row] = 0.55f;
    e->sky_horizon_g[row] = 0.66f;
    e->sky_horizon_b[row] = 0.78f;
}

typedef struct View {
    Vec3 position, rotation_deg;
    bool is_inside;
} View;

// Outside: from the front right, a little above, as far as the bounding sphere needs. Inside: above
// the floor, a quarter of the length from one end and a little off the middle, along the longest
// axis.
static View frame_bounds(Vec3 min, Vec3 max) {
    Vec3 size = vec3_sub(max, min), center = vec3_scale(vec3_add(min, max), 0.5f);
    f32 longest = MAX(size.x, MAX(size.y, size.z));
    if (MAX(size.x, size.z) > INTERIOR_SIZE && size.y > EYE_HEIGHT) {
        View view = {.is_inside = true};
        view.position = vec3(center.x, min.y + EYE_HEIGHT, center.z);
        if (size.x >= size.z) {
            view.position.x += 0.25f * size.x;
            view.position.z += 0.02f * size.z;
            view.rotation_deg.y = 90; // looks along -x
        } else {
            view.position.z += 0.25f * size.z;
            view.position.x += 0.02f * size.x;
        }
        return view;
    }
    f32 radius = MAX(0.5f * vec3_length(size), 1e-3f);
    f32 distance = 1.1f * radius / det_sin(DEG_TO_RAD(VIEW_FOV_DEG) * 0.5f);
    View view = {.rotation_deg = vec3(-20, longest > 0 ? 30.0f : 0, 0)};
    Mat34 turned = mat34_from_trs(vec3(0, 0, 0), view.rotation_deg, vec3(1, 1, 1));
    view.position = vec3_add(center, mat34_vector(&turned, vec3(0, 0, distance)));
    return view;
}

static void add_camera(LevelReader *reader, Entity entity, f32 fov_deg, f32 near) {
    CameraTable *c = WORLD_TABLE(reader->world, Camera, camera);
    u32 row = table_add(&c->table, entity);
    c->fov[row] = CLAMP(fov_deg, 5.0f, 150.0f);
    c->near[row] = CLAMP(near, 0.001f, 10.0f);
}

static void spawn_views(LevelReader *reader, const Model *model) {
    View view = frame_bounds(model->min, model->max);
    f32 fov = VIEW_FOV_DEG;
    f32 size = vec3_length(vec3_sub(model->max, model->min));
    f32 near = CLAMP(size * 0.01f, 0.005f, 0.1f);
    u32 main_index = 0;
    for (u32 i = 0; i < model->camera_count; i++)
        if (model->cameras[i].name && strcmp(model->cameras[i].name, "main") == 0) main_index = i;
    for (u32 i = 0; i < model->camera_count; i++) {
        const ModelCamera *camera = &model->cameras[i];
        const char *own = camera->name && camera->name[0] ? camera->name : "camera";
        Entity entity = spawn_local(reader, i == main_index ? "main" : own, &camera->local);
        add_camera(reader, entity, degrees(camera->fov_y_rad), camera->near);
        if (i != main_index) continue;
        // A player starts where the file looks from, upright.
        view.position = mat34_translation(&camera->local);
        view.rotation_deg = mat34_rotation_deg(&camera->local);
        fov = degrees(camera->fov_y_rad);
    }
    if (model->camera_count == 0)
        add_camera(reader, spawn_at(reader, "main", view.position, view.rotation_deg), fov, near);
    Vec3 upright = vec3(view.rotation_deg.x, view.rotation_deg.y, 0);
    Entity spawn = spawn_at(reader, "spawn", view.position, upright);
    add_camera(reader, spawn, fov, near);
    WalkerTable *walkers = WORLD_TABLE(reader->world, Walker, walker);
    u32 row = table_add(&walkers->table, spawn);
    walkers->fly[row] = !view.is_inside;
}

void level_read_gltf(LevelReader *reader, const char *path) {
    log_hush(LOG_SEVERITY_ERROR);
    u32 id = asset_load_model(reader->store, reader->root, path);
    log_hush(LOG_SEVERITY_NONE);
    if (id == 0) {
        char reason[256];
        log_last_error(reason, sizeof reason);
        level_error(reader, LEVEL_WHOLE_FILE, NULL, "the model is refused: %s", reason);
        return;
    }
    const Model *model = &reader->store->models[id];
    const char *base = strrchr(path, '/');
    base = base ? base + 1 : path;
    char name[LEVEL_NAME_MAX + 1];
    snprintf(name, sizeof name, "%.*s", (int)MIN(strcspn(base, "."), 100u), base);
    if (!name[0]) snprintf(name, sizeof name, "model");
    snprintf(reader->info->title, sizeof reader->info->title, "%s", base);

    set_environment(reader, model->light_count > 0);
    Entity model_entity = level_spawn_model(reader->world, reader->store, id, name);
    Entity scene = spawn_at(reader, "scene", vec3(0, 0, 0), vec3(0, 0, 0));
    InstanceTable *instances = WORLD_TABLE(reader->world, Instance, instance);
    u32 row = table_add(&instances->table, scene);
    instances->model[row] = model_entity;
    instances->collision[row] = COLLISION_MESH;
    bool has_shadow = false;
    for (u32 i = 0; i < model->light_count; i++)
        spawn_light(reader, &model->lights[i], &has_shadow);
    if (model->light_count == 0) spawn_sun(reader);
    spawn_views(reader, model);
    level_spawn_all_drawables(reader, LEVEL_WHOLE_FILE);
}

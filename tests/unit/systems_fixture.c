// systems_fixture.c: see systems_fixture.h.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <stdlib.h>
#include <string.h>

static const u8 cube_faces[12][3] = {{0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3},
                                     {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                     {0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}};

// A mesh over the cube's corners; corners may be moved together to make other shapes.
static Mesh make_mesh(const f32 corners[8][3]) {
    MeshVertex *vertices = calloc(8, sizeof *vertices);
    u32 *indices = calloc(36, sizeof *indices);
    for (u32 i = 0; i < 8; i++) memcpy(vertices[i].position, corners[i], sizeof corners[i]);
    for (u32 i = 0; i < 36; i++) indices[i] = cube_faces[i / 3][i % 3];
    return (Mesh){.vertices = vertices,
                  .indices = indices,
                  .vertex_count = 8,
                  .index_count = 36,
                  .total_index_count = 36,
                  .lod_count = 4,
                  .lods = {{0, 36, 0}, {0, 24, 0}, {0, 12, 0.05f}, {24, 6, 0.2f}},
                  .min = {-0.5f, -0.5f, -0.5f},
                  .max = {0.5f, 0.5f, 0.5f},
                  .radius = 0.8660255f};
}

SystemsFixture *systems_fixture_create(u64 seed) {
    SystemsFixture *f = calloc(1, sizeof *f);
    assert_true(arenas_create(&f->arenas));
    f->world = world_create(seed);
    f32 cube[8][3], ramp[8][3];
    for (u32 i = 0; i < 8; i++)
        for (u32 a = 0; a < 3; a++) cube[i][a] = ramp[i][a] = i >> a & 1 ? 0.5f : -0.5f;
    // The ramp rises towards -z: its upper edge at +z is pressed down.
    for (u32 i = 0; i < 8; i++)
        if ((i & 2) && (i & 4)) ramp[i][1] = -0.5f;
    f->meshes[MESH_CUBE] = make_mesh(cube);
    f->meshes[MESH_RAMP] = make_mesh(ramp);
    f->meshes[MESH_BALL] = (Mesh){.lod_count = 1, .center = {0.25f, 0, 0}, .radius = 0.5f};
    f->models[1] = (Model){.name = "cube", .min = {-0.5f, -0.5f, -0.5f}, .max = {0.5f, 0.5f, 0.5f}};
    f->assets = (AssetStore){.meshes = f->meshes,
                             .models = f->models,
                             .mesh_count = FIXTURE_MESH_COUNT,
                             .model_count = 2,
                             .texture_count = FIXTURE_TEXTURE_COUNT,
                             .stamp = 77};
    systems_create(&f->systems);
    f->context =
        (SystemContext){.world = f->world, .assets = &f->assets, .scratch = &f->arenas.scratch};
    f->model = world_spawn(f->world);
    u32 row = FIXTURE_ADD(f, model, f->model);
    FIXTURE_TABLE(f, Model, model)->model[row] = 1;
    f->material = fixture_spawn_material(f, ALPHA_OPAQUE, 0);
    return f;
}

void systems_fixture_destroy(SystemsFixture *f) {
    collision_destroy(f->context.collision);
    for (u32 i = 0; i < FIXTURE_MESH_COUNT; i++) {
        free((void *)f->meshes[i].vertices);
        free((void *)f->meshes[i].indices);
    }
    world_destroy(f->world);
    arenas_destroy(&f->arenas);
    free(f);
}

Entity fixture_spawn(SystemsFixture *f, Vec3 position) {
    Entity entity = world_spawn(f->world);
    u32 row = FIXTURE_ADD(f, transform, entity);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    t->x[row] = position.x, t->y[row] = position.y, t->z[row] = position.z;
    return entity;
}

Entity fixture_spawn_mesh(SystemsFixture *f, u32 mesh, Vec3 position, Vec3 scale, f32 yaw_deg,
                          CollisionMode collision) {
    Entity entity = fixture_spawn(f, position);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 place = FIXTURE_ROW(f, transform, entity);
    t->scale_x[place] = scale.x, t->scale_y[place] = scale.y, t->scale_z[place] = scale.z;
    t->yaw[place] = yaw_deg;
    u32 row = FIXTURE_ADD(f, instance, entity);
    InstanceTable *instances = FIXTURE_TABLE(f, Instance, instance);
    instances->model[row] = f->model;
    instances->collision[row] = collision;
    Entity part = world_spawn(f->world);
    u32 drawable = FIXTURE_ADD(f, drawable, part);
    DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
    d->owner[drawable] = entity;
    d->mesh[drawable] = mesh;
    d->material[drawable] = f->material;
    return entity;
}

Entity fixture_spawn_light(SystemsFixture *f, LightKind kind, Vec3 position, f32 range) {
    Entity entity = fixture_spawn(f, position);
    u32 row = FIXTURE_ADD(f, light, entity);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    light->kind[row] = kind;
    light->range[row] = range;
    return entity;
}

Entity fixture_spawn_material(SystemsFixture *f, AlphaMode alpha_mode, u32 emissive_texture) {
    Entity entity = world_spawn(f->world);
    u32 row = FIXTURE_ADD(f, material, entity);
    MaterialTable *m = FIXTURE_TABLE(f, Material, material);
    m->alpha_mode[row] = alpha_mode;
    m->emissive_texture[row] = emissive_texture;
    m->emissive_r[row] = 1.0f;
    return entity;
}

void fixture_fill(SystemsFixture *f, u64 seed, u32 count) {
    Entity materials[6];
    for (u32 i = 0; i < 6; i++) {
        materials[i] = fixture_spawn_material(f, (AlphaMode)(i % 3), i == 4 ? 2 : 0);
        MaterialTable *m = FIXTURE_TABLE(f, Material, material);
        m->brdf[FIXTURE_ROW(f, material, materials[i])] = i % 4;
        m->diffuse[FIXTURE_ROW(f, material, materials[i])] = i == 5;
    }
    for (u32 i = 0; i < count; i++) {
        Vec3 p = {random_range(seed, 1, i, -25, 25), random_range(seed, 2, i, -6, 6),
                  random_range(seed, 3, i, -45, 5)};
        Entity thing = fixture_spawn_mesh(f, 1 + i % 3, p, vec3(1, 1 + (f32)(i % 3), 1),
                                          random_range(seed, 4, i, 0, 360), COLLISION_NONE);
        FIXTURE_TABLE(f, Drawable, drawable)
            ->material[FIXTURE_TABLE(f, Drawable, drawable)->table.count - 1] =
            materials[random_u32(seed, 5, i) % 6];
        u32 row = FIXTURE_ROW(f, instance, thing);
        FIXTURE_TABLE(f, Instance, instance)->visible[row] = i % 17 != 0;
        FIXTURE_TABLE(f, Instance, instance)->casts_shadow[row] = i % 5 != 0;
        FIXTURE_TABLE(f, Instance, instance)->voxel_mode[row] =
            i % 7 == 0 ? VOXEL_DYNAMIC : VOXEL_STATIC;

        Vec3 q = {random_range(seed, 6, i, -25, 25), random_range(seed, 7, i, -6, 6),
                  random_range(seed, 8, i, -45, 5)};
        Entity light = fixture_spawn_light(f, i % 4 == 3 ? LIGHT_SPOT : LIGHT_POINT, q,
                                           random_range(seed, 9, i, 0.3f, 4));
        u32 light_row = FIXTURE_ROW(f, light, light);
        FIXTURE_TABLE(f, Light, light)->affects_gi[light_row] = i % 3 != 0;
        FIXTURE_TABLE(f, Light, light)->intensity[light_row] = i % 11 == 10 ? 0.0f : 2.0f;
        if (i % 2 == 0) FIXTURE_ADD(f, orbit, light);
        if (i % 3 == 0) FIXTURE_ADD(f, flicker, light);
        if (i % 5 == 0) FIXTURE_ADD(f, pulse, light);
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        t->yaw[FIXTURE_ROW(f, transform, light)] = random_range(seed, 10, i, 0, 360);
    }
    for (u32 i = 0; i < 3; i++) {
        Entity sun = fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
        FIXTURE_TABLE(f, Transform, transform)->pitch[FIXTURE_ROW(f, transform, sun)] =
            -30.0f - 20.0f * (f32)i;
        FIXTURE_TABLE(f, Light, light)->casts_shadow[FIXTURE_ROW(f, light, sun)] = i == 1;
    }
}

const Packet *fixture_packet(SystemsFixture *f, Entity camera, RenderSettings settings,
                             u32 width_px, u32 height_px, u32 last_stamp) {
    static const PacketText2D texts[] = {{10, 20, 16, 0xFFFFFFFFu, "1,024 lights"},
                                         {10, 40, 16, 0xFF00FFFFu, ""}};
    PacketBuildDesc desc = {.world = f->world,
                            .assets = &f->assets,
                            .camera = camera,
                            .settings = settings,
                            .width_px = width_px,
                            .height_px = height_px,
                            .texts = texts,
                            .text_count = COUNT_OF(texts),
                            .last_stamp = last_stamp};
    return packet_build(&desc, &f->arenas.frame, &f->arenas.scratch, NULL);
}

// systems_fixture.h: a world with the engine's systems and a hand-made asset store (no files).
// Mesh 1 is a cube of side 1, mesh 2 a ramp (both with made-up levels of detail), mesh 3 only a
// sphere (no triangles); model 1 is the
// cube's box. Textures 0..2 exist by number alone.
#ifndef LUZ_TEST_SYSTEMS_FIXTURE_H
#define LUZ_TEST_SYSTEMS_FIXTURE_H
#include "../../engine/systems/systems.h"

enum { MESH_CUBE = 1, MESH_RAMP, MESH_BALL, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT = 3 };

typedef struct SystemsFixture {
    World *world;
    Mesh meshes[FIXTURE_MESH_COUNT];
    Model models[2];
    AssetStore assets;
    Arenas arenas;
    SystemTable systems;
    SystemContext context;
    Entity model, material; // the cube's box; an opaque default material
} SystemsFixture;

SystemsFixture *systems_fixture_create(u64 seed);
void systems_fixture_destroy(SystemsFixture *f);

Entity fixture_spawn(SystemsFixture *f, Vec3 position); // with a transform
// An instance with one drawable; scale is the box's size for the cube.
Entity fixture_spawn_mesh(SystemsFixture *f, u32 mesh, Vec3 position, Vec3 scale, f32 yaw_deg,
                          CollisionMode collision);
Entity fixture_spawn_light(SystemsFixture *f, LightKind kind, Vec3 position, f32 range);
Entity fixture_spawn_material(SystemsFixture *f, AlphaMode alpha_mode, u32 emissive_texture);
// Things, lights of all kinds, materials of all kinds: count of each.
void fixture_fill(SystemsFixture *f, u64 seed, u32 count);

#define FIXTURE_TABLE(f, Name, name) WORLD_TABLE((f)->world, Name, name)
#define FIXTURE_ROW(f, name, entity) table_row((f)->world->tables[COMPONENT_##name], entity)
#define FIXTURE_ADD(f, name, entity) table_add((f)->world->tables[COMPONENT_##name], entity)

const Packet *fixture_packet(SystemsFixture *f, Entity camera, RenderSettings settings,
                             u32 width_px, u32 height_px, u32 last_stamp);
#endif

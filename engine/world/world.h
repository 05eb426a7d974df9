// world.h: the only mutable truth: entities, tables, names, point lists, the tick and the seed.
//
// Use: world_create; register the game's components (the engine's own are there); fill it from
// level text (level/) or code (world_spawn, table_add); run the systems; hash, save, load.
// Single-threaded, except that systems may write disjoint rows of columns from jobs.
#ifndef LUZ_WORLD_H
#define LUZ_WORLD_H
#include "../base/arena.h"
#include "components.h"
#ifdef __cplusplus
extern "C" {
#endif

#define WORLD_COMPONENTS_CAP 64
#define WORLD_POINTS_CAP     (1u << 26) // points of all lists
#define WORLD_NAMES_CAP      (1u << 28) // bytes of all names

// Handles have 12 bits of generation; a slot that has used them all stays dead.
#define GENERATION_RETIRED (1u << (32 - ENTITY_INDEX_BITS))

typedef struct World {
    u64 seed;
    u32 tick;
    // The stamp clock: starts at 1, advanced by world_advance_stamp before each system, so a
    // system that ran at stamp s sees later changes as stamp > s.
    u32 stamp;
    u32 component_count;
    Table *tables[WORLD_COMPONENTS_CAP]; // by component id
    // Entities. generation[index]: of the living or next entity in the slot, from 1, or
    // GENERATION_RETIRED; alive[index]. Slot 0 is never handed out. entity_slots counts the slots
    // ever used, slot 0 included.
    u32 entity_slots, entity_slots_cap, entities_alive;
    u16 *generation;
    u8 *alive;
    u32 *free_slots; // a stack
    u32 free_count;
    // Names: entity index -> offset into name_text; 0 = no name.
    u32 *name_of;
    char *name_text;
    u32 name_text_size, name_text_cap;
    // Point lists: list id -> [point_first[id], point_first[id + 1]) of xyz triples in points;
    // list 0 is empty and counted. Lists are never removed.
    u32 *point_first;
    u32 point_list_count, point_list_cap;
    f32 *points;
    u32 point_count, point_cap;
} World;

World *world_create(u64 seed);
void world_destroy(World *world);

// Returns the component's id. The desc must outlive the world. The engine's own components have
// the ids COMPONENT_*. More than WORLD_COMPONENTS_CAP: LOG WORLD_LIMIT and UINT32_MAX.
u32 world_register_component(World *world, const ComponentDesc *desc);
// By component name, or NULL.
Table *world_find_table(const World *world, const char *name);
#define WORLD_TABLE(world, Name, name) ((Name##Table *)(world)->tables[COMPONENT_##name])

// ENTITY_NONE and LOG WORLD_LIMIT when all slots are taken.
Entity world_spawn(World *world);
// Removes every row of the entity. False if it was not alive.
bool world_despawn(World *world, Entity entity);
bool world_alive(const World *world, Entity entity);

// Names are unique by the level's rules, not enforced here. NULL/"" clears.
void world_set_name(World *world, Entity entity, const char *name);
const char *world_name(const World *world, Entity entity); // "" if none
Entity world_find(const World *world, const char *name);   // linear; ENTITY_NONE if absent

// Copies point_count xyz triples; returns the list's id: never 0, except at WORLD_POINTS_CAP
// points or lists (LOG WORLD_LIMIT).
u32 world_add_points(World *world, const f32 *xyz, u32 point_count);
// Count of points; 0 and *out = NULL for id 0 and unknown ids. The pointer is invalid after the
// next world_add_points.
u32 world_points(const World *world, u32 list, const f32 **out);

static inline u32 world_advance_stamp(World *world) { return ++world->stamp; }

// The singleton's row, made on first use (its columns have defaults).
u32 world_singleton(World *world, u32 component);

// Hash of everything that the simulation can see: tick, seed, entities, every column of every
// row, point lists. Stamps and names are left out. Same world, same hash, on every run.
u64 world_hash(const World *world);
// Hash of one table / one column, for naming the first difference.
u64 table_hash(const Table *table);
u64 column_hash(const Table *table, u32 column);

// The whole world as one block (versioned, checksummed, with column names), allocated in the
// arena (too small: LOG WORLD_LIMIT and {NULL, 0}); and back into a world in which the same
// components are registered. A damaged or foreign block gives LOG WORLD_LOAD and false and leaves
// the world as it was. Unknown components and columns are dropped (LOG NOTE), missing ones get
// defaults. After a load every row counts as changed (stamp). Values are checked as far as the
// world's own sanity needs it: BOOL, ENUM and POINTS are in range; floats may be anything, ENTITY
// columns may be stale (table_row takes them), TEXTURE ids are the asset store's to check.
Bytes world_save(const World *world, Arena *arena);
bool world_load(World *world, Bytes saved);

void world_check(const World *world); // sanity of entities and of all tables; asserts

#ifdef __cplusplus
}
#endif
#endif

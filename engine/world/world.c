// world.c: entities, names, point lists, and the hash of it all.
// Data in: spawns, rows, names. Data out: handles, tables, one 64-bit hash of what the simulation
// can see. Called by: level/, systems, games, captures. Does not: run systems (systems/) or make
// files (world_save.c makes the block).
//
// Handles: a free slot goes on a stack, so handles are a function of the history of spawns and
// despawns, and the hash includes the stack: two worlds with equal hashes also spawn alike.
#include "world.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <stdlib.h>
#include <string.h>

#define SLOTS_FIRST 256
#define LISTS_FIRST 16

static void *array_resize(void *array, u64 count, u64 item_size) {
    void *resized = realloc(array, count * item_size);
    LUZ_ASSERT(resized);
    return resized;
}

// ---- the world ----

World *world_create(u64 seed) {
    World *world = calloc(1, sizeof *world);
    LUZ_ASSERT(world);
    world->seed = seed;
    world->stamp = 1;
    world->entity_slots = 1;   // slot 0 is nobody's
    world->name_text_size = 1; // offset 0 is "no name", and reads as ""
    world->name_text_cap = KIB(4);
    world->name_text = array_resize(NULL, world->name_text_cap, 1);
    world->name_text[0] = 0;
    world->point_list_count = 1; // list 0 is empty
    world->point_list_cap = LISTS_FIRST;
    world->point_first = array_resize(NULL, world->point_list_cap + 1, sizeof(u32));
    world->point_first[0] = world->point_first[1] = 0;
#define X(Name, name, ...)                                                                         \
    LUZ_ASSERT(world_register_component(world, &name##_component) == COMPONENT_##name);
    ENGINE_COMPONENTS(X)
#undef X
    return world;
}

void world_destroy(World *world) {
    if (!world) return;
    for (u32 i = 0; i < world->component_count; i++) table_destroy(world->tables[i]);
    free(world->generation);
    free(world->alive);
    free(world->free_slots);
    free(world->name_of);
    free(world->name_text);
    free(world->point_first);
    free(world->points);
    free(world);
}

u32 world_register_component(World *world, const ComponentDesc *desc) {
    LUZ_ASSERT(!world_find_table(world, desc->name)); // levels and saves go by the name
    u32 id = world->component_count;
    if (id == WORLD_COMPONENTS_CAP) {
        LOG(WORLD_LIMIT, "component '%s': %u components are registered already", desc->name, id);
        return UINT32_MAX;
    }
    world->tables[id] = table_create(desc, id, &world->stamp);
    world->component_count++;
    return id;
}

Table *world_find_table(const World *world, const char *name) {
    for (u32 i = 0; i < world->component_count; i++)
        if (strcmp(world->tables[i]->desc->name, name) == 0) return world->tables[i];
    return NULL;
}

u32 world_singleton(World *world, u32 component) {
    LUZ_ASSERT(component < world->component_count);
    Table *table = world->tables[component];
    LUZ_ASSERT(table->desc->singleton);
    if (table->count > 0) return 0;
    Entity entity = world_spawn(world);
    LUZ_ASSERT(entity != ENTITY_NONE);
    return table_add(table, entity);
}

// ---- entities ----

static void slots_grow(World *world) {
    u32 old = world->entity_slots_cap, cap = MAX(old * 2, SLOTS_FIRST);
    world->generation = array_resize(world->generation, cap, sizeof *world->generation);
    world->alive = array_resize(world->alive, cap, sizeof *world->alive);
    world->free_slots = array_resize(world->free_slots, cap, sizeof *world->free_slots);
    world->name_of = array_resize(world->name_of, cap, sizeof *world->name_of);
    for (u32 i = old; i < cap; i++) {
        world->generation[i] = 1;
        world->alive[i] = 0;
        world->name_of[i] = 0;
    }
    world->entity_slots_cap = cap; // a power of two times 256, so never above ENTITY_CAP
}

static Entity entity_at(const World *world, u32 index) {
    return (u32)world->generation[index] << ENTITY_INDEX_BITS | index;
}

Entity world_spawn(World *world) {
    u32 index;
    if (world->free_count > 0) {
        index = world->free_slots[--world->free_count];
    } else {
        if (world->entity_slots == ENTITY_CAP) {
            LOG(WORLD_LIMIT, "no entity slot is left (%u in use)", world->entities_alive);
            return ENTITY_NONE;
        }
        if (world->entity_slots >= world->entity_slots_cap) slots_grow(world);
        index = world->entity_slots++;
    }
    world->alive[index] = 1;
    world->entities_alive++;
    return entity_at(world, index);
}

bool world_alive(const World *world, Entity entity) {
    u32 index = ENTITY_INDEX(entity);
    return index < world->entity_slots && index != 0 && world->alive[index] &&
           world->generation[index] == ENTITY_GENERATION(entity);
}

bool world_despawn(World *world, Entity entity) {
    if (!world_alive(world, entity)) return false;
    for (u32 i = 0; i < world->component_count; i++) table_remove(world->tables[i], entity);
    u32 index = ENTITY_INDEX(entity);
    world->alive[index] = 0;
    world->name_of[index] = 0;
    world->entities_alive--;
    // After its last generation the slot is lost: 4,095 uses, then no handle could tell apart.
    if (++world->generation[index] != GENERATION_RETIRED)
        world->free_slots[world->free_count++] = index;
    return true;
}

// ---- names ----

// Leaves out the texts that no living entity uses any more.
static void names_compact(World *world) {
    char *text = array_resize(NULL, world->name_text_cap, 1);
    u32 size = 1;
    text[0] = 0;
    for (u32 i = 1; i < world->entity_slots; i++) {
        if (!world->name_of[i]) continue;
        const char *name = world->name_text + world->name_of[i];
        u32 length = (u32)strlen(name) + 1;
        memcpy(text + size, name, length);
        world->name_of[i] = size;
        size += length;
    }
    free(world->name_text);
    world->name_text = text;
    world->name_text_size = size;
}

// Room for `length` more bytes; first by leaving out old texts, then by growing so far that the
// next compaction is at least half a buffer away (amortised O(1) a byte).
static bool names_reserve(World *world, u64 length) {
    if (world->name_text_size + length <= world->name_text_cap) return true;
    names_compact(world);
    u64 needed = world->name_text_size + length, cap = world->name_text_cap;
    if (needed > WORLD_NAMES_CAP) return false;
    while (cap < needed * 2) cap *= 2;
    world->name_text = array_resize(world->name_text, cap, 1);
    world->name_text_cap = (u32)cap;
    return true;
}

void world_set_name(World *world, Entity entity, const char *name) {
    if (!world_alive(world, entity)) return;
    u32 index = ENTITY_INDEX(entity);
    if (!name || !name[0]) {
        world->name_of[index] = 0;
        return;
    }
    // The text may be another entity's name: reserve must not free it under us.
    u64 size = strlen(name) + 1;
    char *copy = array_resize(NULL, size, 1);
    memcpy(copy, name, size);
    if (!names_reserve(world, size)) {
        LOG(WORLD_LIMIT, "names need more than %u bytes", WORLD_NAMES_CAP);
    } else {
        memcpy(world->name_text + world->name_text_size, copy, size);
        world->name_of[index] = world->name_text_size;
        world->name_text_size += (u32)size;
    }
    free(copy);
}

const char *world_name(const World *world, Entity entity) {
    return world_alive(world, entity) ? world->name_text + world->name_of[ENTITY_INDEX(entity)]
                                      : "";
}

Entity world_find(const World *world, const char *name) {
    if (!name || !name[0]) return ENTITY_NONE;
    for (u32 i = 1; i < world->entity_slots; i++)
        if (world->name_of[i] && strcmp(world->name_text + world->name_of[i], name) == 0)
            return entity_at(world, i);
    return ENTITY_NONE;
}

// ---- point lists ----

u32 world_add_points(World *world, const f32 *xyz, u32 point_count) {
    if (point_count > WORLD_POINTS_CAP - world->point_count ||
        world->point_list_count == WORLD_POINTS_CAP) {
        LOG(WORLD_LIMIT, "point lists hold %u points at most", WORLD_POINTS_CAP);
        return 0;
    }
    if (world->point_list_count == world->point_list_cap) {
        world->point_list_cap *= 2;
        world->point_first =
            array_resize(world->point_first, world->point_list_cap + 1, sizeof(u32));
    }
    u32 needed = world->point_count + point_count;
    if (needed > world->point_cap) {
        world->point_cap = MAX(needed, world->point_cap * 2);
        world->points = array_resize(world->points, world->point_cap, 3 * sizeof(f32));
    }
    if (point_count > 0)
        memcpy(world->points + (u64)world->point_count * 3, xyz,
               (u64)point_count * 3 * sizeof(f32));
    world->point_count = needed;
    u32 list = world->point_list_count++;
    world->point_first[list + 1] = needed;
    return list;
}

u32 world_points(const World *world, u32 list, const f32 **out) {
    *out = NULL;
    if (list == 0 || list >= world->point_list_count) return 0;
    u32 first = world->point_first[list], count = world->point_first[list + 1] - first;
    if (count > 0) *out = world->points + (u64)first * 3;
    return count;
}

// ---- hashes ----

u64 column_hash(const Table *table, u32 column) {
    LUZ_ASSERT(column < table->desc->column_count);
    return hash_bytes(table_column(table, column), (u64)table->count * 4, 0);
}

// Chained by value, not by xor or sum: swapping two columns or rows changes the hash.
u64 table_hash(const Table *table) {
    u64 hash = hash_bytes(&table->count, sizeof table->count, hash_string(table->desc->name));
    if (table->count == 0) return hash;
    hash = hash_bytes(table->entity, (u64)table->count * sizeof(Entity), hash);
    for (u32 i = 0; i < table->desc->column_count; i++)
        hash = hash_bytes(table_column(table, i), (u64)table->count * 4, hash);
    return hash;
}

u64 world_hash(const World *world) {
    u64 slots = world->entity_slots;
    u64 head[] = {
        world->seed,           world->tick, slots, world->free_count, world->point_list_count,
        world->component_count};
    u64 hash = hash_bytes(head, sizeof head, 0);
    if (world->entity_slots_cap > 0) {
        hash = hash_bytes(world->generation, slots * sizeof *world->generation, hash);
        hash = hash_bytes(world->alive, slots * sizeof *world->alive, hash);
        hash = hash_bytes(world->free_slots, world->free_count * sizeof *world->free_slots, hash);
    }
    hash = hash_bytes(world->point_first, (world->point_list_count + 1ull) * sizeof(u32), hash);
    if (world->point_count > 0)
        hash = hash_bytes(world->points, world->point_count * 3ull * sizeof(f32), hash);
    for (u32 i = 0; i < world->component_count; i++) {
        u64 table = table_hash(world->tables[i]);
        hash = hash_bytes(&table, sizeof table, hash);
    }
    return hash;
}

// ---- sanity ----

static void world_check_slots(const World *world) {
    LUZ_ASSERT(world->entity_slots >= 1 && world->entity_slots <= ENTITY_CAP);
    LUZ_ASSERT(world->entity_slots == 1 || world->entity_slots <= world->entity_slots_cap);
    u32 alive = 0, retired = 0;
    for (u32 i = 1; i < world->entity_slots; i++) {
        LUZ_ASSERT(world->alive[i] <= 1 && world->generation[i] >= 1);
        LUZ_ASSERT(world->generation[i] <= GENERATION_RETIRED);
        bool is_retired = world->generation[i] == GENERATION_RETIRED;
        LUZ_ASSERT(!(world->alive[i] && is_retired));
        LUZ_ASSERT(world->alive[i] || world->name_of[i] == 0);
        LUZ_ASSERT(world->name_of[i] < world->name_text_size);
        alive += world->alive[i];
        retired += is_retired;
    }
    LUZ_ASSERT(alive == world->entities_alive);
    // Every slot is alive, retired or on the stack; with the count right and each entry of the
    // stack dead, only an entry that is there twice could hide: mark them.
    LUZ_ASSERT(alive + retired + world->free_count == world->entity_slots - 1);
    u8 *seen = calloc(world->entity_slots, 1);
    LUZ_ASSERT(seen);
    for (u32 i = 0; i < world->free_count; i++) {
        u32 slot = world->free_slots[i];
        LUZ_ASSERT(slot != 0 && slot < world->entity_slots && !world->alive[slot] && !seen[slot]);
        LUZ_ASSERT(world->generation[slot] != GENERATION_RETIRED);
        seen[slot] = 1;
    }
    free(seen);
}

void world_check(const World *world) {
    world_check_slots(world);
    LUZ_ASSERT(world->name_text[0] == 0 && world->name_text[world->name_text_size - 1] == 0);
    LUZ_ASSERT(world->point_first[0] == 0 && world->point_first[1] == 0);
    for (u32 i = 0; i < world->point_list_count; i++)
        LUZ_ASSERT(world->point_first[i] <= world->point_first[i + 1]);
    LUZ_ASSERT(world->point_first[world->point_list_count] == world->point_count);
    for (u32 i = 0; i < world->component_count; i++) {
        const Table *table = world->tables[i];
        LUZ_ASSERT(table->id == i && table->clock == &world->stamp);
        table_check(table);
        LUZ_ASSERT(table->newest_stamp <= world->stamp);
        for (u32 row = 0; row < table->count; row++)
            LUZ_ASSERT(world_alive(world, table->entity[row]));
    }
}

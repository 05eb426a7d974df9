// world_save.c: a world as one block of bytes, and back.
// Data in: a world, or a block from anywhere. Data out: a block, or a world equal in every bit
// that world_hash sees, names included. Called by: captures, the app's quick save, tests. Does
// not: touch files, or keep stamps (after a load everything counts as changed).
//
// Block, little-endian, nothing aligned (all access goes through memcpy):
//   u32 magic "LUZW"; u32 version; u64 size of the whole block; u64 XXH3 of all after this field
//   u64 seed; u32 tick; u32 slots (slot 0 included)
//   u16 generation[1 .. slots); u8 alive[1 .. slots)
//   u32 free count; u32 free_slots[]
//   u32 name count; per name: u32 entity index, string
//   u32 list count (without list 0); u32 point count per list; f32 xyz of all points
//   u32 component count; per component:
//     string name; u32 rows; u32 columns; u32 entity[rows];
//     per column: string name; u32 ColumnType; u32 values[rows]
//   string = u32 length, bytes, a zero (not counted)
//
// The checksum finds damage; a stranger can make a block whose checksum fits, so every number is
// checked before it is used as a size or an index, and every allocation is at most a constant times
// the block. Loading fills a fresh world and swaps it in at the end: failure leaves no trace.
#include "../base/hash.h"
#include "../base/log.h"
#include "world.h"
#include <stdlib.h>
#include <string.h>

#define SAVE_MAGIC     0x575A554Cu // "LUZW"
#define SAVE_VERSION   1u
#define SAVE_HEAD_SIZE 24u // magic, version, size, checksum
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "blocks are written as they lie");

// ---- saving: the same walk twice, first to count, then to write ----

typedef struct Writer {
    u8 *out; // NULL while counting
    u64 size;
} Writer;

static void write_bytes(Writer *writer, const void *data, u64 size) {
    if (writer->out && size > 0) memcpy(writer->out + writer->size, data, size);
    writer->size += size;
}
static void write_u32(Writer *writer, u32 value) { write_bytes(writer, &value, sizeof value); }
static void write_u64(Writer *writer, u64 value) { write_bytes(writer, &value, sizeof value); }
static void write_string(Writer *writer, const char *text) {
    u32 length = (u32)strlen(text);
    write_u32(writer, length);
    write_bytes(writer, text, length + 1ull);
}

static void write_entities(Writer *writer, const World *world) {
    u64 slots = world->entity_slots - 1;
    write_u32(writer, world->entity_slots);
    if (slots > 0) {
        write_bytes(writer, world->generation + 1, slots * sizeof *world->generation);
        write_bytes(writer, world->alive + 1, slots);
    }
    write_u32(writer, world->free_count);
    write_bytes(writer, world->free_slots, world->free_count * sizeof(u32));
    u32 name_count = 0;
    for (u32 i = 1; i < world->entity_slots; i++) name_count += world->name_of[i] != 0;
    write_u32(writer, name_count);
    for (u32 i = 1; i < world->entity_slots; i++) {
        if (!world->name_of[i]) continue;
        write_u32(writer, i);
        write_string(writer, world->name_text + world->name_of[i]);
    }
}

static void write_points(Writer *writer, const World *world) {
    write_u32(writer, world->point_list_count - 1);
    for (u32 i = 1; i < world->point_list_count; i++)
        write_u32(writer, world->point_first[i + 1] - world->point_first[i]);
    write_bytes(writer, world->points, world->point_count * 3ull * sizeof(f32));
}

static void write_table(Writer *writer, const Table *table) {
    write_string(writer, table->desc->name);
    write_u32(writer, table->count);
    write_u32(writer, table->desc->column_count);
    write_bytes(writer, table->entity, (u64)table->count * sizeof(Entity));
    for (u32 i = 0; i < table->desc->column_count; i++) {
        write_string(writer, table->desc->columns[i].name);
        write_u32(writer, (u32)table->desc->columns[i].type);
        write_bytes(writer, table_column(table, i), (u64)table->count * 4);
    }
}

static void write_world(Writer *writer, const World *world, u64 size, u64 checksum) {
    write_u32(writer, SAVE_MAGIC);
    write_u32(writer, SAVE_VERSION);
    write_u64(writer, size);
    write_u64(writer, checksum);
    write_u64(writer, world->seed);
    write_u32(writer, world->tick);
    write_entities(writer, world);
    write_points(writer, world);
    write_u32(writer, world->component_count);
    for (u32 i = 0; i < world->component_count; i++) write_table(writer, world->tables[i]);
}

Bytes world_save(const World *world, Arena *arena) {
    Writer counter = {0};
    write_world(&counter, world, 0, 0);
    if (!arena_can_push(arena, counter.size, 16)) {
        LOG(WORLD_LIMIT, "saved world of %llu bytes does not fit",
            (unsigned long long)counter.size);
        return (Bytes){0};
    }
    Writer writer = {.out = arena_push(arena, counter.size, 16)};
    write_world(&writer, world, counter.size, 0);
    LUZ_ASSERT(writer.size == counter.size);
    u64 checksum = hash_bytes(writer.out + SAVE_HEAD_SIZE, writer.size - SAVE_HEAD_SIZE, 0);
    memcpy(writer.out + SAVE_HEAD_SIZE - sizeof checksum, &checksum, sizeof checksum);
    return (Bytes){writer.out, writer.size};
}

// ---- loading ----

typedef struct Reader {
    const u8 *at, *end;
    const char *problem; // the first; NULL while all is well
    u32 dropped;         // components and columns that this program does not know
} Reader;

// The next `count` items of `item_size`, or NULL with a problem set. NULL also for no bytes at
// all, so callers test the problem.
static const void *read_bytes(Reader *reader, u64 count, u64 item_size) {
    if (reader->problem) return NULL;
    // count < 2^32 and item_size is small, so the product does not wrap.
    u64 size = count * item_size;
    if (size > (u64)(reader->end - reader->at)) {
        reader->problem = "ends too early";
        return NULL;
    }
    const u8 *data = reader->at;
    reader->at += size;
    return size > 0 ? data : NULL;
}
static u32 read_u32(Reader *reader) {
    u32 value = 0;
    const void *data = read_bytes(reader, 1, sizeof value);
    if (data) memcpy(&value, data, sizeof value);
    return value;
}
static u64 read_u64(Reader *reader) {
    u64 value = 0;
    const void *data = read_bytes(reader, 1, sizeof value);
    if (data) memcpy(&value, data, sizeof value);
    return value;
}
// A text that ends where its length says; "" with a problem set otherwise.
static const char *read_string(Reader *reader) {
    u32 length = read_u32(reader);
    const char *text = read_bytes(reader, length + 1ull, 1);
    if (text && memchr(text, 0, length + 1ull) == text + length) return text;
    if (!reader->problem) reader->problem = "has a broken text";
    return "";
}
static bool reader_fail(Reader *reader, const char *problem) {
    if (!reader->problem) reader->problem = problem;
    return false;
}

static bool read_slots(Reader *reader, World *world) {
    u32 slots = read_u32(reader);
    if (slots == 0 || slots > ENTITY_CAP) return reader_fail(reader, "has a wrong slot count");
    const u8 *generation = read_bytes(reader, slots - 1, sizeof *world->generation);
    const u8 *alive = read_bytes(reader, slots - 1, sizeof *world->alive);
    if (reader->problem) return false;
    // Spawning in a fresh world hands out 1, 2, 3 ...: the arrays grow to just what is needed.
    for (u32 i = 1; i < slots; i++) LUZ_ASSERT(ENTITY_INDEX(world_spawn(world)) == i);
    u32 dead = 0;
    world->entities_alive = 0;
    for (u32 i = 1; i < slots; i++) {
        u16 value;
        memcpy(&value, generation + (i - 1) * sizeof value, sizeof value);
        bool lives = alive[i - 1] == 1;
        if (alive[i - 1] > 1 || value == 0 || value > GENERATION_RETIRED ||
            (lives && value == GENERATION_RETIRED))
            return reader_fail(reader, "has a wrong entity");
        world->generation[i] = value;
        world->alive[i] = lives;
        world->entities_alive += lives;
        dead += !lives && value != GENERATION_RETIRED;
    }
    // The stack must hold exactly the dead ones: as many, each dead, none twice. "None twice" is
    // checked by using alive[] as a mark (2 = on the stack), taken back below.
    bool ok = read_u32(reader) == dead;
    const u8 *stack = read_bytes(reader, ok ? dead : 0, sizeof(u32));
    for (u32 i = 0; ok && !reader->problem && i < dead; i++) {
        u32 slot;
        memcpy(&slot, stack + i * sizeof slot, sizeof slot);
        ok = slot != 0 && slot < slots && world->alive[slot] == 0 &&
             world->generation[slot] != GENERATION_RETIRED;
        if (!ok) break;
        world->alive[slot] = 2;
        world->free_slots[world->free_count++] = slot;
    }
    for (u32 i = 0; i < world->free_count; i++) world->alive[world->free_slots[i]] = 0;
    return ok ? !reader->problem : reader_fail(reader, "has a wrong list of free entities");
}

static bool read_names(Reader *reader, World *world) {
    u32 count = read_u32(reader), previous = 0;
    for (u32 i = 0; i < count && !reader->problem; i++) {
        u32 index = read_u32(reader);
        const char *name = read_string(reader);
        if (reader->problem) break;
        // Ascending indices: nobody has two names.
        if (index <= previous || index >= world->entity_slots || !world->alive[index] || !name[0])
            return reader_fail(reader, "has a wrong name");
        world_set_name(world, (u32)world->generation[index] << ENTITY_INDEX_BITS | index, name);
        previous = index;
    }
    return !reader->problem;
}

static bool read_points(Reader *reader, World *world) {
    u32 list_count = read_u32(reader);
    const u8 *counts = read_bytes(reader, list_count, sizeof(u32));
    for (u32 i = 0; i < list_count && !reader->problem; i++) {
        u32 count;
        memcpy(&count, counts + (u64)i * sizeof count, sizeof count);
        const u8 *xyz = read_bytes(reader, count, 3 * sizeof(f32));
        if (reader->problem) break;
        u32 first = world->point_count;
        if (count > WORLD_POINTS_CAP - first) return reader_fail(reader, "has too many points");
        // The source is not aligned for f32: reserve with zeros would need a second pass, so the
        // copy goes through an aligned buffer of this list alone.
        f32 *aligned = malloc(MAX((u64)count, 1) * 3 * sizeof(f32));
        LUZ_ASSERT(aligned);
        if (count > 0) memcpy(aligned, xyz, (u64)count * 3 * sizeof(f32));
        u32 list = world_add_points(world, aligned, count);
        free(aligned);
        if (list == 0) return reader_fail(reader, "has too many point lists");
    }
    return !reader->problem;
}

// What the rest of the engine takes for granted about a column's values.
static bool values_fit(const World *world, const ColumnDesc *desc, const u8 *values, u32 count) {
    u32 limit;
    switch (desc->type) {
    case COLUMN_BOOL:
        limit = 1;
        break;
    case COLUMN_POINTS:
        limit = world->point_list_count - 1;
        break;
    case COLUMN_ENUM:
        limit = 0;
        for (const char *word = desc->unit; *word; word++) limit += *word == ' ';
        break;
    default:
        return true;
    }
    for (u32 i = 0; i < count; i++) {
        u32 value;
        memcpy(&value, values + (u64)i * sizeof value, sizeof value);
        if (value > limit) return false;
    }
    return true;
}

static bool read_columns(Reader *reader, World *world, Table *table, u32 rows, u32 columns) {
    u64 seen[TABLE_COLUMNS_CAP / 64] = {0}; // columns already filled, one bit each
    for (u32 i = 0; i < columns && !reader->problem; i++) {
        const char *name = read_string(reader);
        u32 type = read_u32(reader);
        const u8 *values = read_bytes(reader, rows, 4);
        if (reader->problem) break;
        i32 column = table ? table_find_column(table, name) : -1;
        if (column < 0 || (u32)table->desc->columns[column].type != type) {
            reader->dropped += table != NULL;
            continue;
        }
        u64 bit = 1ull << (column % 64), *word = &seen[column / 64];
        if (*word & bit) return reader_fail(reader, "has a column twice");
        *word |= bit;
        if (!values_fit(world, &table->desc->columns[column], values, rows))
            return reader_fail(reader, "has a value out of range");
        if (rows > 0) memcpy(table_columns(table)[column], values, (u64)rows * 4);
    }
    return !reader->problem;
}

static bool read_table(Reader *reader, World *world, u64 *seen) {
    const char *name = read_string(reader);
    u32 rows = read_u32(reader), columns = read_u32(reader);
    const u8 *entities = read_bytes(reader, rows, sizeof(Entity));
    if (reader->problem) return false;
    Table *table = world_find_table(world, name);
    if (!table) {
        reader->dropped++;
    } else {
        if (*seen & 1ull << table->id) return reader_fail(reader, "has a component twice");
        *seen |= 1ull << table->id;
        if (table->desc->singleton && rows > 1) return reader_fail(reader, "has two singletons");
        if (rows > world->entities_alive) return reader_fail(reader, "has too many rows");
        table_reserve(table, rows);
        for (u32 row = 0; row < rows; row++) {
            Entity entity;
            memcpy(&entity, entities + (u64)row * sizeof entity, sizeof entity);
            // An entity that is there twice gets its old row back instead of a new one.
            if (!world_alive(world, entity) || table_add(table, entity) != row)
                return reader_fail(reader, "has a row of a wrong entity");
        }
    }
    return read_columns(reader, world, table, rows, columns);
}

static bool read_world(Reader *reader, Bytes saved, World *world) {
    if (saved.size < SAVE_HEAD_SIZE) return reader_fail(reader, "is too short");
    if (read_u32(reader) != SAVE_MAGIC) return reader_fail(reader, "is no saved world");
    if (read_u32(reader) != SAVE_VERSION) return reader_fail(reader, "has another version");
    if (read_u64(reader) != saved.size) return reader_fail(reader, "has another length");
    u64 checksum = read_u64(reader);
    if (checksum != hash_bytes(reader->at, (u64)(reader->end - reader->at), 0))
        return reader_fail(reader, "has a wrong checksum");
    world->seed = read_u64(reader);
    world->tick = read_u32(reader);
    if (!read_slots(reader, world) || !read_names(reader, world) || !read_points(reader, world))
        return false;
    u32 component_count = read_u32(reader);
    u64 seen = 0; // one bit a component: WORLD_COMPONENTS_CAP = 64
    for (u32 i = 0; i < component_count; i++)
        if (!read_table(reader, world, &seen)) return false;
    if (reader->at != reader->end) return reader_fail(reader, "has something after its end");
    return !reader->problem;
}

_Static_assert(WORLD_COMPONENTS_CAP <= 64, "read_table marks components in 64 bits");

// Puts the contents of `fresh` into `world` and the other way round. The World and its Tables stay
// where they are, for whoever holds pointers to them.
static void world_swap(World *world, World *fresh) {
    World old = *world;
    *world = *fresh;
    *fresh = old;
    for (u32 i = 0; i < world->component_count; i++) {
        Table *ours = old.tables[i], *theirs = world->tables[i];
        u8 *a = (u8 *)ours, *b = (u8 *)theirs;
        for (u32 byte = 0; byte < ours->desc->table_size; byte++) {
            u8 swap = a[byte];
            a[byte] = b[byte];
            b[byte] = swap;
        }
        world->tables[i] = ours;
        fresh->tables[i] = theirs;
        ours->clock = &world->stamp;
        theirs->clock = &fresh->stamp;
    }
}

bool world_load(World *world, Bytes saved) {
    World *fresh = world_create(0);
    for (u32 i = COMPONENT_ENGINE_COUNT; i < world->component_count; i++)
        LUZ_ASSERT(world_register_component(fresh, world->tables[i]->desc) == i);
    // The next stamp of the old world: whoever compares stamps sees everything as changed.
    fresh->stamp = world->stamp + 1;
    for (u32 i = 0; i < fresh->component_count; i++)
        fresh->tables[i]->structure_stamp = fresh->tables[i]->newest_stamp = fresh->stamp;

    Reader reader = {.at = saved.data, .end = (const u8 *)saved.data + saved.size};
    bool ok = read_world(&reader, saved, fresh);
    if (ok) {
#ifdef LUZ_POISON
        world_check(fresh);
#endif
        world_swap(world, fresh);
        // One line for all: a stranger's block could name millions.
        if (reader.dropped > 0)
            LOG(NOTE, "saved world: %u unknown components or columns dropped", reader.dropped);
    } else {
        LOG(WORLD_LOAD, "saved world %s", reader.problem);
    }
    world_destroy(fresh);
    return ok;
}

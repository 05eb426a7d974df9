// pool.c: arrays of objects behind handles with generations.
//
// Data in: items of one size. Data out: ids (generation << 16 | index + 1). Called by every file
// here that creates objects. Does not own what the items refer to.
#include "gpu_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POOL_ITEMS_CAP 65535u // index + 1 fits 16 bits

static GpuPoolItem *pool_item(const GpuPool *pool, u32 index) {
    return (GpuPoolItem *)(void *)(pool->items + (u64)index * pool->item_size);
}

u32 gpu_pool_add(GpuPool *pool, const char *label, void **out) {
    LUZ_ASSERT(label && label[0]); // a label is mandatory
    u32 index;
    if (pool->first_free) {
        index = pool->first_free - 1;
        pool->first_free = pool_item(pool, index)->next_free;
    } else {
        if (pool->count == pool->cap) {
            u32 cap = MIN(MAX(pool->cap * 2, 64u), POOL_ITEMS_CAP);
            u8 *items = cap > pool->cap ? realloc(pool->items, (u64)cap * pool->item_size) : NULL;
            if (!items) {
                LOG(GPU_LIMIT, "no room for %s \"%s\": %u of them exist already", pool->what, label,
                    pool->alive_count);
                return 0;
            }
            pool->items = items;
            pool->cap = cap;
        }
        index = pool->count++;
        memset(pool_item(pool, index), 0, pool->item_size);
    }
    GpuPoolItem *item = pool_item(pool, index);
    u16 generation = (u16)(item->generation + 1);
    memset(item, 0, pool->item_size);
    item->generation = generation;
    item->alive = true;
    snprintf(item->label, sizeof item->label, "%s", label);
    pool->alive_count++;
    *out = item;
    return (u32)generation << 16 | (index + 1);
}

void *gpu_pool_get(const GpuPool *pool, u32 id) {
    u32 index = (id & 0xFFFF) - 1; // none (0) becomes an index beyond every count
    bool handle_is_alive = index < pool->count && pool_item(pool, index)->alive &&
                           pool_item(pool, index)->generation == id >> 16;
    LUZ_ASSERT(handle_is_alive);
    return pool_item(pool, index);
}

void gpu_pool_remove(GpuPool *pool, u32 id) {
    GpuPoolItem *item = gpu_pool_get(pool, id);
    item->alive = false;
    pool->alive_count--;
    // A slot whose generation would wrap is retired, so that no stale handle ever comes alive
    // again.
    if (item->generation == UINT16_MAX) return;
    item->next_free = pool->first_free;
    pool->first_free = id & 0xFFFF;
}

void *gpu_pool_at(const GpuPool *pool, u32 index) {
    GpuPoolItem *item = pool_item(pool, index);
    return item->alive ? item : NULL;
}

u32 gpu_pool_id_at(const GpuPool *pool, u32 index) {
    return (u32)pool_item(pool, index)->generation << 16 | (index + 1);
}

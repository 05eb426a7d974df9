// light_grid_fill.c: the lists of the light grid, from the boxes of cells that each light touches.
// Data in: a plan (boxes, where each list begins). Data out: a record per cell, and the lists.
// Called by: light_grid_build, packet_lists.c. Does not: decide what touches what, or count.
//
// Cells go by blocks: up to 128 columns of one row. A block's runs (a light and the columns it
// touches) are gathered in the order of the lights; run k is bit k of a row of bits per column. A
// run flips its bit at its first column and behind its last one, so that the bits of a column are
// those of the column before, flipped: two words a run, however wide it is. The set bits of eight
// runs then become eight indices at once: a table says which places are set, a shuffle brings those
// lights to the front, all eight are stored, and the list grows by as many as there are. A list is
// written from its beginning to its end, in order, so what is stored too much is written over by
// what follows; the end of a block, where other lists begin, is written index by index, and so is
// everything on machines without such a shuffle.
//
// Nothing is sorted, no cell has a cursor, and memory is written once, in order. A block is written
// by one job, so the number of threads does not matter.
#include "light_grid.h"
#include "../base/jobs.h"
#include "../base/simd.h"
#include <string.h>

#define BANDS_PER_THREAD 4 // jobs; each looks through all boxes
#define BANDS_MAX        16
#define BLOCK_SHIFT      7 // columns of a block, as a power of two; a column fits in a byte
#define BLOCK_COLUMNS    (1u << BLOCK_SHIFT)

typedef u32 u32x8 __attribute__((vector_size(32), aligned(32), may_alias));
typedef u32 u32x8_loose __attribute__((vector_size(32), aligned(4), may_alias));
typedef u64 u64x4 __attribute__((vector_size(32), aligned(32), may_alias));

typedef struct FillJob {
    const LightGridPlan *plan;
    u32 *indices;
    CellRecord *cells;
    u32 all_lights[LIGHT_CLASSES + 1]; // 0, then where the classes end, as light indices
    u32x8 places[256];                 // lane j: the place of the j-th set bit of a byte
    bool by_eight;
} FillJob;

typedef struct FillBlock {
    const FillJob *job;
    const u32 *list_first; // of the cells
    CellRecord *cells;
    const u32 *lights;  // of the runs
    const u16 *columns; // first | last << 8
    u32 column_count;
    u32 class_end[LIGHT_CLASSES]; // run
    u32 words;                    // of 64 runs, a column; a multiple of four
    u32 end;                      // index behind the block's lists
    u64 *bits;                    // [(column_count + 1) * words]
} FillBlock;

// ---- runs ----

// Appends the runs of the rows [row_begin, row_end).
static void gather_runs(const FillJob *job, u32 row_begin, u32 row_end) {
    const LightGridPlan *plan = job->plan;
    u32 *lights = plan->run_lights, blocks_x = plan->blocks_x, first_block = row_begin * blocks_x,
        block_count = (row_end - row_begin) * blocks_x;
    u16 *columns = plan->run_columns;
    // Where a block's runs of a class end is where those of the next one go.
    u32 *cursor = plan->run_end;
    memcpy(cursor + first_block, plan->run_first + first_block, block_count * sizeof *cursor);
    for (u32 class = 0, i = 0; class < LIGHT_CLASSES; class ++) {
        for (; i < job->all_lights[class + 1]; i++) {
            for (u32 b = plan->box_first[i]; b < plan->box_first[i + 1]; b++) {
                CellBox box = plan->boxes[b];
                if (box.row >= row_end) break;
                u32 y_begin = MAX(box.row, row_begin), y_end = MIN(box.row + box.rows, row_end);
                u32 last_block = box.x1 >> BLOCK_SHIFT, first = box.x0 & (BLOCK_COLUMNS - 1);
                for (u32 block = box.x0 >> BLOCK_SHIFT; block <= last_block; block++, first = 0) {
                    u32 last =
                        block < last_block ? BLOCK_COLUMNS - 1 : box.x1 & (BLOCK_COLUMNS - 1);
                    for (u32 y = y_begin; y < y_end; y++) {
                        u32 at = cursor[y * blocks_x + block]++;
                        lights[at] = i;
                        columns[at] = (u16)(first | last << 8);
                    }
                }
            }
        }
        if (class + 1 == LIGHT_CLASSES) break;
        u32 *next = cursor + plan->block_count;
        memcpy(next + first_block, cursor + first_block, block_count * sizeof *cursor);
        cursor = next;
    }
}

// ---- a block ----

static void flip_bits(const FillBlock *block) {
    u32 words = block->words, count = block->class_end[LIGHT_CLASSES - 1];
    memset(block->bits, 0, sizeof(u64) * words * (block->column_count + 1));
    for (u32 k = 0; k < count; k++) {
        u32 columns = block->columns[k];
        u64 bit = 1ull << (k & 63);
        block->bits[(columns & 255) * words + k / 64] ^= bit;
        block->bits[((columns >> 8) + 1) * words + k / 64] ^= bit;
    }
}

// at: where the list begins, and where its classes end.
static inline void write_record(CellRecord *cell, const u32 *at) {
    cell->list[0] = at[0];
    cell->list[1] = at[2] - at[0];
    cell->list[2] = at[4] - at[2];
    cell->list[3] = MIN(at[2] - at[1], 0xFFFF) | MIN(at[4] - at[3], 0xFFFF) << 16;
}

// What is stored too much for a word of 64 runs ends so far behind where its first index goes.
#define STORED_AHEAD (64 + 8)

// The lights of a word's set bits to indices[at...]; a macro, for the clones: see simd.h.
#define WRITE_WORD(word_, from_, bytes)                                                            \
    {                                                                                              \
        u64 word = word_;                                                                          \
        const u32 *from = from_;                                                                   \
        if (at + STORED_AHEAD > last_by_eight) {                                                   \
            for (; word; word &= word - 1) indices[at++] = from[__builtin_ctzll(word)];            \
        } else if (word) {                                                                         \
            _Pragma("GCC unroll 8") for (u32 byte = 0; byte < bytes; byte++, word >>= 8) {         \
                *(u32x8_loose *)(indices + at) = __builtin_shuffle(                                \
                    *(const u32x8_loose *)(from + byte * 8), places[word & 255]);                  \
                at += (u64)__builtin_popcountll(word & 255);                                       \
            }                                                                                      \
        }                                                                                          \
    }

static SIMD_CLONES void write_lists(const FillBlock *block) {
    const u32x8 *places = block->job->places;
    const u32 *lights = block->lights;
    u32 *indices = block->job->indices, words = block->words;
    u32 count = block->class_end[LIGHT_CLASSES - 1], last_bytes = (count % 64 + 7) / 8;
    u32 last_by_eight = block->job->by_eight ? block->end : 0;
    for (u32 x = 0; x < block->column_count; x++) {
        u64 *bits = block->bits + (u64)x * words;
        for (u32 w = 0; x > 0 && w < words; w += 4)
            *(u64x4 *)(bits + w) ^= *(const u64x4 *)(bits - words + w);
        u32 ends[LIGHT_CLASSES + 1] = {block->list_first[x]}, w = 0;
        if (ends[0] == UINT32_MAX) {
            write_record(&block->cells[x], block->job->all_lights);
            continue;
        }
        u64 at = ends[0];
        for (u32 class = 0; class < LIGHT_CLASSES; class ++) {
            u32 end = block->class_end[class];
            for (; w < end / 64; w++) WRITE_WORD(bits[w], lights + w * 64, 8);
            // The class ends within a word, which is written later: its part is counted now.
            u64 part = bits[w] & ((1ull << (end & 63)) - 1);
            ends[class + 1] = (u32)at + (u32)__builtin_popcountll(part);
        }
        if (last_bytes) WRITE_WORD(bits[w], lights + w * 64, last_bytes);
        write_record(&block->cells[x], ends);
    }
}

// Where the first list of a cell at or behind this one begins.
static u32 next_list(const LightGridPlan *plan, u32 cell) {
    while (cell < plan->cell_count && plan->list_first[cell] == UINT32_MAX) cell++;
    return cell < plan->cell_count ? plan->list_first[cell] : plan->index_count;
}

static void job_fill(void *context, u32 row_begin, u32 row_end, u32 thread_index) {
    const FillJob *job = context;
    const LightGridPlan *plan = job->plan;
    gather_runs(job, row_begin, row_end);
    u32 blocks_x = plan->blocks_x;
    for (u32 b = row_begin * blocks_x; b < row_end * blocks_x; b++) {
        u32 x = b % blocks_x * BLOCK_COLUMNS, cell = b / blocks_x * plan->tiles_x + x;
        u32 first = plan->run_first[b], columns = MIN(BLOCK_COLUMNS, plan->tiles_x - x);
        FillBlock block = {.job = job,
                           .list_first = plan->list_first + cell,
                           .cells = job->cells + cell,
                           .lights = plan->run_lights + first,
                           .columns = plan->run_columns + first,
                           .column_count = columns,
                           .words = ALIGN_UP(plan->run_first[b + 1] - first, 256) / 64,
                           .end = next_list(plan, cell + columns),
                           .bits = plan->block_bits + thread_index * plan->block_bits_stride};
        for (u32 class = 0; class < LIGHT_CLASSES; class ++)
            block.class_end[class] = plan->run_end[class * plan->block_count + b] - first;
        flip_bits(&block);
        write_lists(&block);
    }
}

// ---- the whole ----

// Counts the runs of blocks: a box is two steps of a difference, whose running sum down the rows is
// the count.
void light_grid_plan_fill(LightGridPlan *plan, Arena *scratch) {
    u32 rows = plan->tiles_y * plan->slices;
    u32 blocks_x = plan->blocks_x = (plan->tiles_x + BLOCK_COLUMNS - 1) >> BLOCK_SHIFT;
    u32 count = plan->block_count = blocks_x * rows, most = 0;
    u32 *first = plan->run_first = ARENA_PUSH(scratch, u32, count + blocks_x + 1);
    for (u32 i = 0; i < plan->box_first[plan->input.count]; i++) {
        CellBox box = plan->boxes[i];
        u32 *top = first + 1 + box.row * blocks_x, *under = top + box.rows * blocks_x;
        for (u32 x = box.x0 >> BLOCK_SHIFT; x <= (u32)box.x1 >> BLOCK_SHIFT; x++)
            top[x]++, under[x]--;
    }
    for (u32 b = blocks_x; b < count; b++) first[1 + b] += first[1 + b - blocks_x];
    for (u32 b = 0; b < count; b++) {
        most = MAX(most, first[b + 1]);
        first[b + 1] += first[b];
    }
    plan->run_end = ARENA_PUSH_UNSET(scratch, u32, (u64)count * LIGHT_CLASSES);
    // Eight more: lights are read eight at a time.
    plan->run_lights = ARENA_PUSH_UNSET(scratch, u32, (u64)first[count] + 8);
    plan->run_columns = ARENA_PUSH_UNSET(scratch, u16, first[count]);
    // One word more: that behind a class that ends with the last word is looked at.
    u64 words = ALIGN_UP((u64)most, 256) / 64 * (BLOCK_COLUMNS + 1) + 1;
    plan->block_bits_stride = ALIGN_UP(words, CACHE_LINE / sizeof(u64));
    plan->block_bits = arena_push_unset(
        scratch, sizeof(u64) * plan->block_bits_stride * jobs_thread_count(), CACHE_LINE);
}

void light_grid_fill(LightGridPlan *plan, CellRecord *cells, u32 *indices) {
    const LightGridInput *in = &plan->input;
    FillJob job = {.plan = plan,
                   .indices = indices,
                   .cells = cells,
                   .all_lights = {0, MIN(in->highlight_points, in->point_count), in->point_count,
                                  MIN(in->point_count + in->highlight_spots, in->count), in->count},
                   .by_eight = in->fill == GRID_FILL_AUTO ? SIMD_HAS_SHUFFLE
                                                          : in->fill == GRID_FILL_BY_EIGHT};
    for (u32 byte = 0; byte < COUNT_OF(job.places); byte++)
        for (u32 bit = 0, place = 0; bit < 8; bit++)
            if (byte >> bit & 1) job.places[byte][place++] = bit;
    if (plan->sharing)
        for (u32 i = 0; i < in->count; i++) indices[i] = i;
    u32 rows = plan->tiles_y * plan->slices, threads = jobs_thread_count();
    u32 bands = threads > 1 ? MIN(threads * BANDS_PER_THREAD, BANDS_MAX) : 1;
    jobs_for(rows, (rows + bands - 1) / bands, job_fill, &job);
}

// recording_internal.h: what writer, reader and check of recordings share: tags and column sums.
#ifndef LUZ_RECORDING_INTERNAL_H
#define LUZ_RECORDING_INTERNAL_H
#include "capture.h"
#include "chunk_file.h"

#define RECORDING_MAGIC   CHUNK_TAG('L', 'U', 'Z', 'R')
#define RECORDING_VERSION 1u
#define TAG_INFO          CHUNK_TAG('I', 'N', 'F', 'O')
#define TAG_INPUTS        CHUNK_TAG('I', 'N', 'P', 'T')
#define TAG_HASHES        CHUNK_TAG('H', 'A', 'S', 'H')
#define TAG_SUMS          CHUNK_TAG('S', 'U', 'M', 'S')
#define TAG_IMAGES        CHUNK_TAG('I', 'M', 'G', 'S')

#define RECORDING_IMAGES_MAX  8192u
#define RECORDING_SUMS_MAX    MIB(512) // later ticks are checked by their hash alone
#define RECORDING_COLUMNS_MAX 65535u   // of all tables together
#define INPUT_RUN_SIZE        16u      // bytes of a run in the file
#define THUMBNAIL_SIZE        (THUMBNAIL_WIDTH * THUMBNAIL_HEIGHT * 3)
#define IMAGE_RECORD_SIZE     (4u + 8u + THUMBNAIL_SIZE)

// Two sums over the rows of a column that together find one changed row without storing values:
//   s0 = sum of h(value_i), s1 = sum of (i + 1) h(value_i), both mod 2^64.
// If row i alone differs, then ds1 = (i + 1) ds0; and since h is a bijection, h(old) = h(new) - ds0
// gives the recorded value back, which for any other i would not be a 32-bit number.
typedef struct ColumnSum {
    u64 s0, s1;
} ColumnSum;

u64 column_sum_mix(u32 value);
// False if no 32-bit value mixes to this.
bool column_sum_unmix(u64 mixed, u32 *value);
ColumnSum column_sum(const u32 *values, u32 count);

// A table's columns as this folder counts them: those of its desc, then the entities of the rows.
static inline u32 sum_column_count(const Table *table) { return table->desc->column_count + 1; }
static inline const u32 *sum_column_values(const Table *table, u32 column) {
    return column < table->desc->column_count ? table_column(table, column) : table->entity;
}
static inline const char *sum_column_name(const Table *table, u32 column) {
    return column < table->desc->column_count ? table->desc->columns[column].name : "entity";
}

#endif

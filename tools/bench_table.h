// bench_table.h: the table of an experiment: printed, and written as CSV and charts into the
// directory of --plots.
//
//   BenchTable table;
//   bench_table_begin(&table, bench, "p2", "layout,bytes,ms");
//   bench_text(&table, "lean"); bench_number(&table, 8); bench_number(&table, 1.25); ...
//   bench_table_end(&table);   // prints, writes DIR/p2.csv
//
// Cells are filled row by row, each row in the order of the columns.
#ifndef LUZ_TOOL_BENCH_TABLE_H
#define LUZ_TOOL_BENCH_TABLE_H
#include "bench.h"
#include "plot.h"

#define BENCH_COLUMNS_CAP 24

typedef struct BenchCell {
    const char *text; // NULL = the number; NAN = empty
    f64 number;
} BenchCell;
typedef struct BenchTable {
    Bench *bench; // text lies in its arena
    const char *name;
    char *columns[BENCH_COLUMNS_CAP];
    u32 column_count;
    BenchCell *cells; // [cell_count], row by row
    u32 cell_count, cell_cap;
} BenchTable;

// columns: names separated by commas.
void bench_table_begin(BenchTable *table, Bench *bench, const char *name, const char *columns);
void bench_text(BenchTable *table, const char *format, ...) PRINTF_LIKE(2, 3);
void bench_number(BenchTable *table, f64 value);
// Frees the cells. False if the file cannot be written.
bool bench_table_end(BenchTable *table);
// RFC 4180, in malloc'd memory.
char *bench_table_csv(const BenchTable *table);
// As text with aligned columns, in malloc'd memory.
char *bench_table_aligned(const BenchTable *table);

// Writes DIR/name.png if --plots was given. False if that fails.
bool bench_plot(Bench *bench, const char *name, const PlotChart *charts, u32 count, u32 columns,
                u32 width, u32 height);
#endif

// bench_table.c: see bench_table.h. Data in: cells. Data out: text on stdout, files in --plots.
// Called by: the experiments. Does not: measure, or choose what is drawn.
#include "bench_table.h"
#include "../engine/base/file.h"
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bench_table_begin(BenchTable *table, Bench *bench, const char *name, const char *columns) {
    *table = (BenchTable){.bench = bench, .name = name};
    char *rest = arena_copy_string(&bench->arena, columns);
    for (char *column; (column = strsep(&rest, ","));) {
        LUZ_ASSERT(table->column_count < BENCH_COLUMNS_CAP);
        table->columns[table->column_count++] = column;
    }
}

static void add_cell(BenchTable *table, BenchCell cell) {
    if (table->cell_count == table->cell_cap) {
        table->cell_cap = MAX(table->cell_cap * 2, 64);
        table->cells = realloc(table->cells, table->cell_cap * sizeof(BenchCell));
        LUZ_ASSERT(table->cells);
    }
    table->cells[table->cell_count++] = cell;
}

void bench_text(BenchTable *table, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    add_cell(table, (BenchCell){.text = arena_copy_string(&table->bench->arena, text)});
}

void bench_number(BenchTable *table, f64 value) { add_cell(table, (BenchCell){.number = value}); }

typedef struct Text {
    char *data;
    u64 size, cap;
} Text;

static void put(Text *text, const char *what) {
    u64 length = strlen(what);
    if (text->size + length + 1 > text->cap) {
        text->cap = (text->size + length + 1) * 2;
        text->data = realloc(text->data, text->cap);
        LUZ_ASSERT(text->data);
    }
    memcpy(text->data + text->size, what, length + 1);
    text->size += length;
}

static void put_csv(Text *text, const char *cell) {
    if (!strpbrk(cell, ",\"\n\r")) {
        put(text, cell);
        return;
    }
    put(text, "\"");
    for (; *cell; cell++) put(text, *cell == '"' ? "\"\"" : (char[2]){*cell, 0});
    put(text, "\"");
}

static const char *cell_words(const BenchCell *cell, const char *number_format, char out[32]) {
    if (cell->text) return cell->text;
    out[0] = 0;
    if (isfinite(cell->number)) {
        // Whole numbers in full.
        bool whole = cell->number == floor(cell->number) && fabs(cell->number) < 1e9;
        snprintf(out, 32, whole ? "%.0f" : number_format, cell->number);
    }
    return out;
}

char *bench_table_csv(const BenchTable *table) {
    Text text = {0};
    char number[32];
    for (u32 c = 0; c < table->column_count; c++) {
        if (c) put(&text, ",");
        put_csv(&text, table->columns[c]);
    }
    put(&text, "\n");
    for (u32 i = 0; i < table->cell_count; i++) {
        if (i % table->column_count) put(&text, ",");
        put_csv(&text, cell_words(&table->cells[i], "%.6g", number));
        if (i % table->column_count == table->column_count - 1) put(&text, "\n");
    }
    return text.data;
}

char *bench_table_aligned(const BenchTable *table) {
    Text text = {0};
    char number[32], padded[600];
    u32 n = table->column_count, widths[BENCH_COLUMNS_CAP];
    bool left[BENCH_COLUMNS_CAP] = {0};
    for (u32 c = 0; c < n; c++) widths[c] = (u32)strlen(table->columns[c]);
    for (u32 i = 0; i < table->cell_count; i++) {
        u32 length = (u32)strlen(cell_words(&table->cells[i], "%.4g", number));
        widths[i % n] = MAX(widths[i % n], length);
        left[i % n] |= table->cells[i].text != NULL;
    }
    for (u32 i = 0; i < n + table->cell_count; i++) {
        u32 c = i % n;
        const char *words =
            i < n ? table->columns[c] : cell_words(&table->cells[i - n], "%.4g", number);
        snprintf(padded, sizeof padded, left[c] ? "%s%-*s" : "%s%*s", c ? "  " : "", (int)widths[c],
                 words);
        if (c == n - 1 && left[c]) snprintf(padded, sizeof padded, "  %s", words);
        put(&text, padded);
        if (c == n - 1) put(&text, "\n");
    }
    return text.data;
}

static char *plot_path(Bench *bench, const char *name, const char *extension) {
    char *path = arena_format(&bench->arena, "%s/%s.%s", bench->plots, name, extension);
    return path;
}

bool bench_table_end(BenchTable *table) {
    Bench *bench = table->bench;
    LUZ_ASSERT(table->cell_count % table->column_count == 0);
    bool ok = true;
    if (!bench->common.json) {
        char *aligned = bench_table_aligned(table);
        printf("\n%s\n%s", table->name, aligned);
        fflush(stdout);
        free(aligned);
    }
    if (bench->plots) {
        char *csv = bench_table_csv(table);
        ok = file_write(plot_path(bench, table->name, "csv"), csv, strlen(csv));
        free(csv);
    }
    free(table->cells);
    *table = (BenchTable){0};
    return ok;
}

bool bench_plot(Bench *bench, const char *name, const PlotChart *charts, u32 count, u32 columns,
                u32 width, u32 height) {
    return !bench->plots ||
           plot_write_png(plot_path(bench, name, "png"), charts, count, columns, width, height);
}

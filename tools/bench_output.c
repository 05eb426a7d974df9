// bench_output.c: what `luz bench` leaves behind: table, verdicts, JSON, CSV.
// Data in: results and verdicts. Data out: text. Called by: bench.c.
// Does not: tables of experiments (bench_table.c).
#include "bench.h"
#include "../engine/base/file.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bench_print_results(const Bench *bench) {
    int width = 34;
    for (u32 i = 0; i < bench->result_count; i++)
        if (!bench->results[i].in_table) width = MAX(width, (int)strlen(bench->results[i].what));
    const char *last = "";
    bool first = true;
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        if (r->in_table) continue;
        if (first)
            printf("%-10s  %-*s  %10s  %10s  %10s  %-4s  %s\n", "row", width, "what", "median",
                   "p10", "p90", "unit", "ratio");
        first = false;
        printf("%-10s  %-*s  %10.4g  %10.4g  %10.4g  %-4s", strcmp(last, r->id) ? r->id : "", width,
               r->what, r->median, r->p10, r->p90, r->unit);
        if (r->ratio > 0.0) printf("  %.2f", r->ratio);
        putchar('\n');
        last = r->id;
    }
}

void bench_print_verdicts(const Bench *bench) {
    if (bench->verdict_count) printf("\nwhat must show\n");
    for (u32 i = 0; i < bench->verdict_count; i++) {
        const BenchVerdict *v = &bench->verdicts[i];
        const char *sign = v->wish == BENCH_AT_LEAST ? ">=" : "<=";
        printf("%-6s  %-11s  %s: ", v->id, bench_verdict_ok(v) ? "ok" : "NOT reached", v->what);
        if (isnan(v->measured))
            printf("not measured");
        else
            printf("measured %.4g%s", v->measured, v->unit);
        printf(", wanted %s %.4g%s\n", sign, v->wanted, v->unit);
    }
}

void bench_print_json(const Bench *bench) {
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_text(&json, "build", luz_build_id);
    json_text(&json, "device", bench->has_device ? bench->headless.device : "");
    json_open_array(&json, "results");
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        json_open_flat_object(&json, NULL);
        json_text(&json, "row", r->id);
        json_text(&json, "what", r->what);
        json_f64(&json, "median", r->median);
        json_f64(&json, "p10", r->p10);
        json_f64(&json, "p90", r->p90);
        json_text(&json, "unit", r->unit);
        if (r->ratio > 0.0) json_f64(&json, "ratio", r->ratio);
        json_close(&json);
    }
    json_close(&json);
    json_open_array(&json, "verdicts");
    for (u32 i = 0; i < bench->verdict_count; i++) {
        const BenchVerdict *v = &bench->verdicts[i];
        json_open_flat_object(&json, NULL);
        json_text(&json, "row", v->id);
        json_text(&json, "what", v->what);
        json_bool(&json, "ok", bench_verdict_ok(v));
        json_f64(&json, "measured", v->measured);
        json_text(&json, "wish", v->wish == BENCH_AT_LEAST ? "at least" : "at most");
        json_f64(&json, "wanted", v->wanted);
        json_close(&json);
    }
    json_close(&json);
    json_close(&json);
    json_print(&json);
    json_free(&json);
}

bool bench_write_csv(const Bench *bench, const char *path) {
    u64 cap = 256 + (u64)bench->result_count * 256, used = 0;
    char *text = malloc(cap);
    LUZ_ASSERT(text);
    used += (u64)snprintf(text, cap, "row,what,median,p10,p90,unit,ratio\n");
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        used += (u64)snprintf(text + used, cap - used, "%s,\"%s\",%.6g,%.6g,%.6g,%s,%.4g\n", r->id,
                              r->what, r->median, r->p10, r->p90, r->unit, r->ratio);
    }
    bool ok = file_write(path, text, used);
    free(text);
    return ok;
}

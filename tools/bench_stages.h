// bench_stages.h: the light manager measured on one core, for the rows `manager` and `claims`.
#ifndef LUZ_TOOL_BENCH_STAGES_H
#define LUZ_TOOL_BENCH_STAGES_H
#include "bench.h"

// Medians in ms on one core; [0] = the cloister's 1,171 lights, [1] = the hall's 10,000.
typedef struct ManagerCost {
    f64 frame_ms[2]; // light manager, all stages with their share of deciding, and its light lists
    f64 lists_ms[2]; // light lists of every light in view, tiles of 16 px by rectangles
} ManagerCost;
bool bench_measure_manager(Bench *bench, const char *id, ManagerCost *cost);
bool bench_manager_verdicts(Bench *bench, const char *id);
#endif

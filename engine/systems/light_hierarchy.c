// light_hierarchy.c: see light_hierarchy.h.
// Data in: view-space spheres and cones. Data out: lights in Morton order, and nodes over runs of
// GRID_NODE_WIDTH of them, level by level (layout: GridNode in shaders/shared.h, the number of
// nodes by packet_tree_levels). Called by: packet_lists.c, tests. Does not: balance by cost:
// neighbours on the curve are near each other, and a tree of fixed shape needs no search and no
// pointers.
#include "light_hierarchy.h"
#include "../base/jobs.h"
#include <string.h>

#define LIGHTS_PER_JOB 1024
#define NODES_PER_JOB  256
#define MORTON_BITS    10 // an axis
#define DIGIT_BITS     10 // of the sort
#define NODE_LEAF      0x80000000u

typedef struct ViewBox {
    f32 low[3], high[3];
} ViewBox;

static ViewBox light_box(const LightGridInput *in, u32 i) {
    const f32 at[3] = {in->x[i], in->y[i], in->z[i]};
    ViewBox box;
    for (u32 a = 0; a < 3; a++)
        box.low[a] = at[a] - in->radius[i], box.high[a] = at[a] + in->radius[i];
    if (!light_is_cone(in, i)) return box;
    Cone cone = light_grid_cone(in, i);
    for (u32 a = 0; a < 3; a++) {
        f64 up[3] = {a == 0, a == 1, a == 2}, down[3] = {-up[0], -up[1], -up[2]};
        f32 above = (f32)(cone.tip[a] + cone_extent(&cone, up)),
            below = (f32)(cone.tip[a] - cone_extent(&cone, down));
        // A cone's third coordinate is depth, which looks the other way.
        box.low[a] = MAX(box.low[a], a < 2 ? below : -above);
        box.high[a] = MIN(box.high[a], a < 2 ? above : -below);
    }
    return box;
}

// ---- order ----

// Bits of a 10-bit number with two free places after each.
static u32 spread_bits(u32 x) {
    x = (x | x << 16) & 0x030000FF;
    x = (x | x << 8) & 0x0300F00F;
    x = (x | x << 4) & 0x030C30C3;
    return (x | x << 2) & 0x09249249;
}

// Codes of the lights' centres in the box of all centres, then a stable radix sort by them.
static void sort_lights(const LightGridInput *in, u32 begin, u32 end, u32 *order, Arena *arena) {
    u32 count = end - begin;
    if (count == 0) return;
    u64 mark = arena_mark(arena);
    const f32 *columns[3] = {in->x, in->y, in->z};
    f32 low[3], scale[3];
    for (u32 a = 0; a < 3; a++) {
        f32 high = low[a] = columns[a][begin];
        for (u32 i = begin; i < end; i++)
            low[a] = MIN(low[a], columns[a][i]), high = MAX(high, columns[a][i]);
        f32 size = high - low[a];
        scale[a] = size > 0.0f && size < 1e30f ? (1 << MORTON_BITS) / size : 0.0f;
    }
    u32 *codes[2], *lights[2];
    for (u32 k = 0; k < 2; k++) {
        codes[k] = ARENA_PUSH(arena, u32, count);
        lights[k] = ARENA_PUSH(arena, u32, count);
    }
    for (u32 i = 0; i < count; i++) {
        u32 code = 0;
        for (u32 a = 0; a < 3; a++) {
            f32 cell = (columns[a][begin + i] - low[a]) * scale[a];
            code |= spread_bits((u32)CLAMP(cell, 0.0f, (1 << MORTON_BITS) - 1)) << a;
        }
        codes[0][i] = code;
        lights[0][i] = begin + i;
    }
    u32 from = 0;
    for (u32 shift = 0; shift < 3 * MORTON_BITS; shift += DIGIT_BITS, from ^= 1) {
        u32 places[1 << DIGIT_BITS] = {0}, sum = 0;
        for (u32 i = 0; i < count; i++) places[codes[from][i] >> shift & ((1 << DIGIT_BITS) - 1)]++;
        for (u32 digit = 0; digit < COUNT_OF(places); digit++) {
            u32 here = places[digit];
            places[digit] = sum;
            sum += here;
        }
        for (u32 i = 0; i < count; i++) {
            u32 place = places[codes[from][i] >> shift & ((1 << DIGIT_BITS) - 1)]++;
            codes[from ^ 1][place] = codes[from][i];
            lights[from ^ 1][place] = lights[from][i];
        }
    }
    memcpy(order, lights[from], count * sizeof *order);
    arena_rewind(arena, mark);
}

// ---- nodes ----

typedef struct NodeJob {
    const LightGridInput *input;
    const u32 *order;
    GridNode *nodes;
    u32 node_first;               // of this level
    u32 child_first, child_count; // places in the order, or nodes of the level below
    bool leaves;
} NodeJob;

static void job_nodes(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const NodeJob *job = context;
    for (u32 j = begin; j < end; j++) {
        u32 first = j * GRID_NODE_WIDTH, count = MIN(GRID_NODE_WIDTH, job->child_count - first);
        first += job->child_first;
        ViewBox box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        for (u32 child = first; child < first + count; child++) {
            ViewBox part;
            if (job->leaves) {
                part = light_box(job->input, job->order[child]);
            } else {
                memcpy(part.low, job->nodes[child].low, sizeof part.low);
                memcpy(part.high, job->nodes[child].high, sizeof part.high);
            }
            for (u32 a = 0; a < 3; a++) {
                box.low[a] = MIN(box.low[a], part.low[a]);
                box.high[a] = MAX(box.high[a], part.high[a]);
            }
        }
        GridNode *node = &job->nodes[job->node_first + j];
        memcpy(node->low, box.low, sizeof box.low);
        memcpy(node->high, box.high, sizeof box.high);
        u32 bits = count | (job->leaves ? NODE_LEAF : 0);
        memcpy(&node->low[3], &first, sizeof first);
        memcpy(&node->high[3], &bits, sizeof bits);
    }
}

// From the leaves up: the levels lie in the other order.
static void build_tree(NodeJob *job, u32 root, u32 place, u32 light_count) {
    u32 sizes[PACKET_TREE_LEVELS_CAP], levels = packet_tree_levels(light_count, sizes);
    u32 node = root;
    for (u32 level = 0; level < levels; level++) node += sizes[level];
    job->child_first = place;
    job->child_count = light_count;
    job->leaves = true;
    for (u32 level = levels; level-- > 0;) {
        job->node_first = node -= sizes[level];
        jobs_for(sizes[level], NODES_PER_JOB, job_nodes, job);
        job->child_first = node;
        job->child_count = sizes[level];
        job->leaves = false;
    }
}

LightHierarchy light_hierarchy_build(const LightGridInput *input, Arena *arena) {
    u32 points = input->point_count, spots = input->count - points;
    u32 sizes[PACKET_TREE_LEVELS_CAP];
    LightHierarchy tree = {.light_count = input->count, .point_count = points};
    for (u32 i = 0, n = packet_tree_levels(points, sizes); i < n; i++) tree.spots_root += sizes[i];
    tree.node_count = tree.spots_root;
    for (u32 i = 0, n = packet_tree_levels(spots, sizes); i < n; i++) tree.node_count += sizes[i];
    tree.nodes = ARENA_PUSH(arena, GridNode, tree.node_count);
    tree.order = ARENA_PUSH(arena, u32, input->count);
    sort_lights(input, 0, points, tree.order, arena);
    sort_lights(input, points, input->count, tree.order + points, arena);
    NodeJob job = {.input = input, .order = tree.order, .nodes = tree.nodes};
    build_tree(&job, 0, 0, points);
    build_tree(&job, tree.spots_root, points, spots);
    if (spots == 0) tree.spots_root = 0;
    return tree;
}

// ---- walking ----

u32 light_hierarchy_find(const LightHierarchy *tree, bool spots, const f32 low[3],
                         const f32 high[3], u32 *out) {
    u32 class_count = spots ? tree->light_count - tree->point_count : tree->point_count;
    u32 stack[PACKET_TREE_LEVELS_CAP * GRID_NODE_WIDTH], depth = 0, found = 0;
    if (class_count) stack[depth++] = spots ? tree->spots_root : 0;
    while (depth > 0) {
        const GridNode *node = &tree->nodes[stack[--depth]];
        bool meets = true;
        for (u32 a = 0; a < 3; a++) meets &= node->low[a] <= high[a] && node->high[a] >= low[a];
        if (!meets) continue;
        u32 first, bits;
        memcpy(&first, &node->low[3], sizeof first);
        memcpy(&bits, &node->high[3], sizeof bits);
        u32 count = bits & ~NODE_LEAF;
        if (bits & NODE_LEAF)
            for (u32 child = 0; child < count; child++) out[found++] = first + child;
        else // the first child on top: places come out ascending
            for (u32 child = count; child-- > 0;) stack[depth++] = first + child;
    }
    return found;
}

// light_hierarchy.h: a tree of boxes over many lights, for who asks "which lights are near here"
// without a grid: the device's clusters. Points and spots have a tree each.
#ifndef LUZ_LIGHT_HIERARCHY_H
#define LUZ_LIGHT_HIERARCHY_H
#include "light_grid.h"

// With fewer lights than this a loop over all of them is as good.
#define LIGHT_HIERARCHY_FROM 1000u

typedef struct LightHierarchy {
    GridNode *nodes; // [node_count]: the points' tree, then the spots'; each from its root down
    u32 *order;      // [light count] light indices in Morton order: points, then spots
    u32 node_count, light_count, point_count;
    u32 spots_root; // node; 0 if there are no points
} LightHierarchy;

// View-space boxes of the input's spheres and cones. Memory from the arena.
LightHierarchy light_hierarchy_build(const LightGridInput *input, Arena *arena);
// Places in the order (ascending) of the points, or of the spots, below nodes whose boxes meet this
// one (view space). Returns how many; out has room for all of the class. For tests, and as the
// reference of shaders that walk it: each step of the loop takes one node.
u32 light_hierarchy_find(const LightHierarchy *hierarchy, bool spots, const f32 low[3],
                         const f32 high[3], u32 *out);
#endif

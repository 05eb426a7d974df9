// trace.h: a path tracer on the CPU: the picture that the engine's shortcuts are judged by.
//
// Data in: a packet (camera, lights, materials, all instances) and the assets: what the renderer
// gets. Data out: radiance a pixel, and the picture by the same exposure, tone mapping and gamma.
//
//   TraceScene scene;
//   if (!trace_scene_create(&scene, packet, assets, instance_flags, &arena)) ...;
//   trace_picture(&scene, &options, rgb, &arena, NULL, NULL);
//   trace_encode(packet, rgb, rgba);
//
// Random numbers are a function of (seed, pixel, sample, dimension): the same bits with any number
// of threads (engine/base/jobs.h). Made for the rows of `luz bench` and the tests; minutes a
// picture are fine.
//
// Does not: blended surfaces (rays pass through them), fog and heat, levels of detail other than
// those of the packet's draws.
#ifndef LUZ_TOOL_TRACE_H
#define LUZ_TOOL_TRACE_H
#include "../engine/asset/asset.h"
#include "../engine/frame/packet.h"

// Of an instance: who meets it beside the eye.
enum {
    TRACE_BOUNCES = 1 << 0, // light that goes from surface to surface
    TRACE_SHADOWS = 1 << 1, // rays to lights
};

typedef enum TraceShadows {
    TRACE_SHADOWS_LEVEL, // as the level says for the engine: what the eye sees by shadow maps and
                         // screen_shadow, what voxels would see by voxel_shadow
    TRACE_SHADOWS_ALL,   // as in nature
    TRACE_SHADOWS_NONE,
    TRACE_SHADOWS_COUNT
} TraceShadows;
#define TRACE_SHADOW_WORDS "level all none"

typedef struct TraceOptions {
    u32 samples; // a pixel
    u32 bounces; // surfaces that light visits beside the one that is seen; 0 = direct light
    TraceShadows shadows;
    f32 sky;         // factor on the sky that bounced rays reach
    f32 ambient;     // factor on the packet's constant ambient light
    f32 largest;     // radiance of one sample beyond this is cut ("fireflies"); 0 = never
    bool specular;   // highlights and mirrored light; else diffuse lobes alone
    bool highlights; // direct light has highlights even without `specular`
    bool smooth;     // samples are spread over the pixel; else all go through its middle, as raster
    u64 seed;
} TraceOptions;
#define TRACE_OPTIONS_DEFAULT                                                                      \
    { .samples = 64, .bounces = 8, .specular = true, .highlights = true, .seed = 1 }

typedef struct TraceNode {
    f32 low[3];
    u32 first; // of a leaf: its first triangle; else its first child, the other follows
    f32 high[3];
    u32 count; // triangles of a leaf, 0 = not a leaf
} TraceNode;
typedef struct TraceTriangle {
    f32 corner[3], edge1[3], edge2[3]; // world
    u32 instance;                      // of the scene
    u32 first_index;                   // into the mesh's indices
    u32 flags;                         // TRACE_*, and what else a ray asks
} TraceTriangle;
typedef struct TraceInstance {
    Mat34 world;
    u32 mesh, material, flags;
} TraceInstance;
typedef struct TraceLight {
    Vec3 position, direction; // direction: the way a spot shines; towards a directional one
    f32 color[3], highlight;
    f32 inverse_range2, cos_outer, edge;
    u32 kind;      // 0 point, 1 spot, 2 directional
    bool shadowed; // by the level's words
} TraceLight;
// A triangle that shines, for sampling.
typedef struct TraceEmitter {
    u32 triangle;
    f32 area, cumulative; // m2; share of all emitters' power up to and with this one
} TraceEmitter;

typedef struct TraceScene {
    const Packet *packet;
    const AssetStore *assets;
    const MaterialRecord *materials;
    const PacketMaterial *bindings;
    TraceInstance *instances;
    TraceTriangle *triangles; // in the order of the leaves
    TraceNode *nodes;         // [0] is the root
    TraceLight *seen_lights;  // of surfaces that the eye sees
    TraceLight *far_lights;   // of all others
    TraceEmitter *emitters;
    u32 *emitter_of; // [triangle_count] index, UINT32_MAX = does not shine
    u32 instance_count, triangle_count, node_count, seen_count, far_count, emitter_count;
} TraceScene;

// instance_flags: TRACE_* of each of the packet's view instances, NULL = all. Everything lies in
// the arena. False with a message (LOG) if there is too much of it.
bool trace_scene_create(TraceScene *scene, const Packet *packet, const AssetStore *assets,
                        const u8 *instance_flags, Arena *arena);

typedef struct TraceHit {
    f32 t, u, v;
    u32 triangle; // UINT32_MAX = none
} TraceHit;
// Nearest triangle of those with all of `flags` in front of `from`, t in units of `to`'s length.
// flags 0 is the eye: it also passes through the back of surfaces that have one side.
TraceHit trace_nearest(const TraceScene *scene, Vec3 from, Vec3 to, f32 t_max, u32 flags);
bool trace_blocked(const TraceScene *scene, Vec3 from, Vec3 to, f32 t_max, u32 flags);

// What a ray met.
typedef struct TraceSurface {
    Vec3 position, face; // face: unit normal of the triangle, towards the ray's origin
    Vec3 normal;         // of shading, as a fragment has it
    bool front;
    f32 albedo[3], emission[3];
    const MaterialRecord *material;
} TraceSurface;
// footprint_m: width that a pixel covers there; it chooses the textures' level.
TraceSurface trace_surface(const TraceScene *scene, const TraceHit *hit, Vec3 from, Vec3 to,
                           f32 footprint_m);
// Emission of a point of a triangle (barycentric u, v).
void trace_emission(const TraceScene *scene, u32 triangle, f32 u, f32 v, f32 out[3]);
bool trace_triangle_is_solid(const TraceScene *scene, const TraceTriangle *triangle, f32 u, f32 v);

typedef void (*TraceProgress)(void *user, u32 done, u32 total);
// rgb: [height * width * 3] radiance, rows from the top, as the engine's HDR target has it.
// scratch is used and given back.
void trace_picture(const TraceScene *scene, const TraceOptions *options, f32 *rgb, Arena *scratch,
                   TraceProgress progress, void *user);
// Radiance to the picture, as shaders/tonemap.frag does it.
void trace_encode(const Packet *packet, const f32 *rgb, u8 *rgba);

#endif

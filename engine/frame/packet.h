// packet.h: the frame packet: one relocatable block that says all about one frame.
//
// Data in: built by systems/packet_build.c from the world. Data out: read by render/ (which sees
// nothing else but the loaded assets) and written to frame files by capture/. Offsets, no pointers;
// const once built; the GPU records lie in it in the layout that shaders read (shaders/shared.h),
// so that an upload is a copy.
// Sections start on CACHE_LINE; offsets count from the start of the block.
#ifndef LUZ_PACKET_H
#define LUZ_PACKET_H
#include "../base/arena.h"
#include "../../shaders/shared.h"
#include "settings.h"
#ifdef __cplusplus
extern "C" {
#endif

#define PACKET_MAGIC   0x4B505A4Cu // "LZPK"
#define PACKET_VERSION 5u

typedef struct PacketSection {
    u32 offset, count;
} PacketSection; // bytes, elements

// One drawcall: instances [first, first + count) of the instance section.
typedef struct PacketDraw {
    u32 mesh;     // asset store id
    u32 material; // index into materials
    u32 first_instance, instance_count;
    u32 lod; // level of detail; a mesh that has fewer shows its last one
    // Forward paths: 1 = some of each instance's local light comes from the vertices (how much:
    // InstanceRecord.ids[2]), 2 = all of it does. Not of double-sided materials.
    u32 vertex_lit;
} PacketDraw;

// What the renderer needs of a material beside its MaterialRecord.
typedef struct PacketMaterial {
    u32 albedo_texture, normal_texture, emissive_texture; // asset store ids, 0 = none
    u32 alpha_mode;                                       // AlphaMode
    u32 double_sided;
    u32 emissive_pass; // 1: has an emissive texture, drawn additively after lighting
} PacketMaterial;

// Text over the picture, in internal pixels from the upper left.
typedef struct PacketText {
    f32 x_px, y_px, size_px;
    u32 color;          // RGBA8 sRGB, red in the low byte
    u32 offset, length; // into the characters section
} PacketText;

// One step of the post chain, in the order in which they run: those on radiance (fog, heat), then
// tone mapping, then gamma. Heat that lies outside the picture is not here.
typedef enum PostKind { // the words of the component post, in their order
    POST_FOG,           // 0..2 colour (radiance), 3 density 1/m, 4 start m, 5 height m (world y),
                        // 6 falloff 1/m
    POST_HEAT,          // 0..2 centre (world), 3 reach m, 4 shift px, 5 waves 1/m, 6 speed Hz,
                        // 7..10 the pixels that it can change: left, top, right, bottom
    POST_TONEMAP,
    POST_GAMMA,         // 0 exponent, 0 = the sRGB curve
    POST_KIND_COUNT
} PostKind;
typedef struct PacketPost {
    u32 kind; // PostKind
    f32 values[11];
} PacketPost;
#define PACKET_POSTS_CAP 64 // more is refused: each is a pass over the picture

// What the light manager did with a local light, for debug pictures (only if the view asks).
typedef enum LightFate {
    LIGHT_KEPT,
    LIGHT_OUTSIDE, // of the view
    LIGHT_OCCLUDED,
    LIGHT_MERGED,  // into another: this is one of the pair
    LIGHT_MERGER,  // the light that stands for a pair
    LIGHT_DROPPED, // too small or too faint
    LIGHT_OVER_BUDGET,
    LIGHT_FATE_COUNT
} LightFate;
typedef struct PacketLightMark {
    f32 position[3], range;      // world
    f32 direction[3], cos_outer; // spots; cos_outer < -1 = a point
    f32 weight;                  // 0..1 of its brightness that is shown
    f32 highlight;               // factor on its highlight
    u32 fate;                    // LightFate
    u32 light;                   // index into lights, UINT32_MAX = not there
} PacketLightMark;

typedef enum PacketFlags {
    PACKET_REVOXELISE = 1 << 0, // a dynamic instance changed since the last packet
    PACKET_RELIGHT = 1 << 1,    // a light or emission changed
    // The picture must not hang on what was drawn before: pictures that are hashed or kept. GI that
    // is spread over frames (gi.share, gi.feedback, policies) does all its work at once.
    PACKET_COLD = 1 << 2,
} PacketFlags;

// X(name, element type)
#define PACKET_SECTIONS(X)                                                                         \
    X(instances, InstanceRecord)     /* visible ones, in draw order; then shadow casters */        \
    X(opaque_draws, PacketDraw)      /* alpha mode opaque, near to far in bands */                 \
    X(mask_draws, PacketDraw)        /* alpha mode mask */                                         \
    X(blend_draws, PacketDraw)       /* alpha mode blend, far to near */                           \
    X(emissive_draws, PacketDraw)    /* those of the above with an emissive texture */             \
    X(shadow_draws, PacketDraw)      /* casters within the shadow map, opaque */                   \
    X(shadow_mask_draws, PacketDraw) /* casters, alpha mask */                                     \
    X(materials, MaterialRecord)                                                                   \
    X(material_bindings, PacketMaterial) /* same count */                                          \
    X(lights, LightRecord) /* by class (LIGHT_CLASSES), then one dummy that lights nothing */      \
    X(spots, SpotRecord)                                                                           \
    X(directionals, DirectionalRecord) /* frame.counts[2] of the screen, then those of the      */ \
                                       /* voxels alone: the screen has them as traced_lights    */ \
    X(cells, CellRecord)    /* light grid: tiles or clusters, from the upper left */               \
    X(light_indices, u32)   /* into lights: the cells' lists, then the hierarchy's order, if any */ \
    X(grid_nodes, GridNode) /* GPU clusters, many lights: hierarchy over that order */             \
    X(posts, PacketPost)                                                                           \
    X(light_marks, PacketLightMark) /* for debug pictures, else empty */                           \
    X(occluder_depths,                                                                             \
      f32) /* for its debug picture: counts.occluder_* size, metres, else empty */                 \
    X(gi_instances, InstanceRecord) /* of all that is voxelised, seen or not: static, dynamic */   \
    X(gi_static_draws, PacketDraw)  /* of these instances */                                       \
    X(gi_dynamic_draws, PacketDraw)                                                                \
    X(gi_lights, GiLightRecord) /* all local lights that affect GI, also outside the view */       \
    X(gi_lists, u32)  /* grid over the volume: offset, count of each cell; then light indices */   \
    X(traced_lights, TracedLightRecord) /* of the view: their shadows come from the voxels */      \
    X(texts, PacketText)                                                                           \
    X(characters, u8)

typedef struct PacketCounts {
    u32 lights_total, lights_visible, lights_shaded; // local lights: level, frustum, in lists
    // Light manager: what each stage took away, what it added.
    // lights_visible = occluded + merged + dropped + over budget + those of the level that are kept.
    u32 lights_occluded, lights_merged_pairs, lights_dropped, lights_over_budget;
    u32 lights_merged; // of the level, shown by nothing but the merger of their pair
    u32 lights_fading;                           // shown with less than their full brightness
    u32 lights_near, lights_between, lights_far; // levels of detail of those that are shaded
    f32 merge_error; // sum of the predicted errors of all merged pairs, 1 = white
    u32 occluders, occluder_width, occluder_height; // drawn into the CPU depth buffer; its size
    u32 drawables_occluded;
    u32 drawables_total, drawables_visible, shadow_casters;
    u32 triangles;                                     // of visible drawables
    u32 cell_count, cell_light_max, light_index_count; // of lists made on the CPU
    u32 cell_fallbacks; // cells that use the list of all lights because memory ran out
    u32 gi_lights, gi_light_indices; // local lights of the voxels, entries of their lists
    u32 lights_traced;               // local lights of the view among traced_lights
} PacketCounts;

// Global illumination as this packet wants it; params.enabled = 0: its sections are empty. What the
// voxels show hangs on these keys (hashes of contents) alone: as long as a key stays, so does what
// was made under it. The flags are raised by change stamps, and whenever surface_key or light_key
// differs from the previous packet's; a change that leaves no trace (there and back, a light that
// is off) raises a flag alone. Of the camera there is nothing in the keys but the places of nested
// grids and of the shadow map, which both move in steps.
typedef struct PacketGi {
    u64 static_key;  // grid, static instances, their meshes and materials, emission too
    u64 dynamic_key; // dynamic ones
    u64 light_key;   // lights, emission, parameters of lighting; the shadow map if voxels read it
    u64 surface_key; // both first ones without emission: what PACKET_REVOXELISE goes by
    GiParams params;
    GiRecord record;
} PacketGi;

typedef struct Packet {
    u32 magic, version;
    u64 size;                   // bytes, of the whole block
    u32 tick, flags;            // PacketFlags
    u32 width_px, height_px;    // internal resolution
    u32 shadow_size_px;         // 0 = no shadow map this frame
    u32 brdf_mask, attenuation; // specialisation: what this level uses
    u32 reserved;
    u64 shadow_key; // hash of all that the shadow map shows: unchanged = the old one serves
    RenderSettings settings;
    PacketCounts counts;
    FrameRecord frame;
    PacketGi gi;
#define X(name, Type) PacketSection name;
    PACKET_SECTIONS(X)
#undef X
} Packet;

// First element of a section: PACKET_DATA(packet, lights, LightRecord).
#define PACKET_DATA(packet, section, Type)                                                         \
    ((const Type *)((const u8 *)(packet) + (packet)->section.offset))

// Building: begin with all counts known, then fill the sections through PACKET_WRITE.
typedef struct PacketSizes {
#define X(name, Type) u32 name;
    PACKET_SECTIONS(X)
#undef X
} PacketSizes;
// Block in the arena with the sections laid out, zeroed except for the light indices.
Packet *packet_allocate(Arena *arena, const PacketSizes *sizes);
#define PACKET_WRITE(packet, section, Type) ((Type *)((u8 *)(packet) + (packet)->section.offset))

// Does a shadow map tell what directional 0 of the screen lights? (Voxels may be alone in having one.)
static inline bool packet_screen_shadow(const Packet *packet) {
    return packet->shadow_size_px > 0 && packet->frame.counts[2] > 0 &&
           PACKET_DATA(packet, directionals, DirectionalRecord)[0].color[3] > 0.0f;
}

// Is this block from a stranger safe to render? Checks magic, version, size, every section's range
// and alignment, every index (meshes < mesh_count, levels of detail, textures < texture_count,
// instances, materials, lights, tiles), finite matrices, resolution limits. Returns NULL if all is
// well, else a sentence.
const char *packet_validate(const void *block, u64 size, u32 mesh_count, u32 texture_count);

#define PACKET_SIDE_MAX 16384 // px

// Shape of the hierarchy over so many lights (grid_nodes): nodes of each level from the root down.
// Returns how many levels; 0 for no lights.
#define PACKET_TREE_LEVELS_CAP 12
u32 packet_tree_levels(u32 light_count, u32 sizes[PACKET_TREE_LEVELS_CAP]);

#ifdef __cplusplus
}
#endif
#endif

// shared_reflection.c: shaders/shared.h as C sees it against what the shaders were compiled to.
//
// The SPIR-V of every embedded shader is parsed (names, offsets, strides, bindings, specialisation
// constants) and compared with the C structs, the BINDING_ and the SPEC_ numbers. A struct that no
// shader uses fails too, unless it is listed: then nothing would have been compared.
#include "../test.h"
#include "../../engine/gpu/shader_blobs.h"
#include "../../shaders/shared.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- What C says ---

#define STRUCTS(X, M)                                                                              \
    X(FrameRecord,                                                                                 \
      M(FrameRecord, view_projection) M(FrameRecord, view) M(FrameRecord, shadow_matrix)           \
          M(FrameRecord, camera) M(FrameRecord, ray_right) M(FrameRecord, ray_up)                  \
              M(FrameRecord, ray_forward) M(FrameRecord, viewport) M(FrameRecord, ambient)         \
                  M(FrameRecord, sky_zenith) M(FrameRecord, sky_horizon)                           \
                      M(FrameRecord, attenuation) M(FrameRecord, shadow) M(FrameRecord, slices)    \
                          M(FrameRecord, vertex_lighting) M(FrameRecord, previous_view_projection) \
                              M(FrameRecord, common_lobes) M(FrameRecord, coding)                  \
                                  M(FrameRecord, counts) M(FrameRecord, counts2)                   \
                                      M(FrameRecord, counts3) M(FrameRecord, grid))                \
    X(InstanceRecord, M(InstanceRecord, world) M(InstanceRecord, ids))                             \
    X(MaterialRecord,                                                                              \
      M(MaterialRecord, albedo) M(MaterialRecord, specular) M(MaterialRecord, emissive)            \
          M(MaterialRecord, lobes) M(MaterialRecord, extra))                                       \
    X(LightRecord, M(LightRecord, position) M(LightRecord, color))                                 \
    X(SpotRecord, M(SpotRecord, direction) M(SpotRecord, edge))                                    \
    X(DirectionalRecord, M(DirectionalRecord, direction) M(DirectionalRecord, color))              \
    X(CellRecord, M(CellRecord, list))                                                             \
    X(TileDepthRecord, M(TileDepthRecord, range) M(TileDepthRecord, mask))                         \
    X(GridNode, M(GridNode, low) M(GridNode, high))                                                \
    X(GiRecord,                                                                                    \
      M(GiRecord, origin) M(GiRecord, dims) M(GiRecord, atlas) M(GiRecord, strength)               \
          M(GiRecord, cone) M(GiRecord, specular) M(GiRecord, scale) M(GiRecord, light_grid)       \
              M(GiRecord, light_grid_origin) M(GiRecord, light_grid_rate) M(GiRecord, probes)      \
                  M(GiRecord, probe_origin) M(GiRecord, trace) M(GiRecord, counts)                 \
                      M(GiRecord, show))                                                           \
    X(GiLightRecord, M(GiLightRecord, position) M(GiLightRecord, color)                            \
                         M(GiLightRecord, direction) M(GiLightRecord, extra))                      \
    X(TracedLightRecord, M(TracedLightRecord, light) M(TracedLightRecord, shadow))                 \
    X(GiDrawRecord, M(GiDrawRecord, mesh) M(GiDrawRecord, how))

typedef struct SharedMember {
    const char *name;
    u32 offset, size;
} SharedMember;
typedef struct SharedStruct {
    const char *name;
    u32 size;
    SharedMember members[24];
} SharedStruct;

static const SharedStruct structs[] = {
#define M(Struct, member) {#member, offsetof(Struct, member), sizeof(((Struct *)0)->member)},
#define X(Struct, ...)    {#Struct, sizeof(Struct), {__VA_ARGS__}},
    STRUCTS(X, M)
#undef X
#undef M
};

// Structs that no shader declares.
static const char *const unused_structs[] = {NULL};

// Which binding belongs to which block, or to which name of an image. Passes that make voxels have
// a set 0 of their own (BUILD_): what they share with others is named twice.
static const struct {
    const char *name;
    u32 set, binding;
} expected_bindings[] = {
    {"FrameBuffer", 0, BINDING_FRAME},
    {"MaterialBuffer", 0, BINDING_MATERIALS},
    {"DirectionalBuffer", 0, BINDING_DIRECTIONALS},
    {"LightPositions", 0, BINDING_LIGHT_POSITIONS},
    {"LightColors", 0, BINDING_LIGHT_COLORS},
    {"SpotBlock", 0, BINDING_SPOT_BLOCK},
    {"FlowBuffer", 0, BINDING_FLOW},
    {"LightBuffer", 0, BINDING_LIGHTS},
    {"SpotBuffer", 0, BINDING_SPOTS},
    {"CellBuffer", 0, BINDING_CELLS},
    {"IndexBuffer", 0, BINDING_LIGHT_INDICES},
    {"gbuffer_0", 0, BINDING_GBUFFER_0},
    {"gbuffer_1", 0, BINDING_GBUFFER_1},
    {"gbuffer_2", 0, BINDING_GBUFFER_2},
    {"gbuffer_3", 0, BINDING_GBUFFER_3},
    {"gbuffer_4", 0, BINDING_GBUFFER_4},
    {"palette", 0, BINDING_PALETTE},
    {"falloff", 0, BINDING_ATTENUATION},
    {"normal_z", 0, BINDING_NORMAL_Z},
    {"gbuffer_depth", 0, BINDING_DEPTH},
    {"shadow_map", 0, BINDING_SHADOW_MAP},
    {"ldr", 0, BINDING_LDR},
    {"accumulation", 0, BINDING_ACCUMULATION},
    {"atlas", 0, BINDING_OVERLAY},
    {"albedo_texture", 1, BINDING_ALBEDO_TEXTURE},
    {"normal_texture", 1, BINDING_NORMAL_TEXTURE},
    {"emissive_texture", 1, BINDING_EMISSIVE_TEXTURE},
    {"FrameBuffer", 0, BUILD_FRAME},
    {"GiFrameBuffer", 0, BUILD_FRAME},
    {"GiBuffer", 0, BUILD_GI},
    {"GiBuffer", 2, BINDING_GI},
    {"GiTracedBuffer", 2, BINDING_GI_TRACED},
    {"GiFlowBuffer", 0, BUILD_FLOW},
    {"GiFlowBuffer", 2, BINDING_GI_FLOW},
    {"GiMaterialBuffer", 0, BUILD_MATERIALS},
    {"GiDirectionalBuffer", 0, BUILD_DIRECTIONALS},
    {"GiVertexBuffer", 0, BUILD_VERTICES},
    {"GiIndexBuffer", 0, BUILD_MESH_INDICES},
    {"GiInstanceBuffer", 0, BUILD_INSTANCES},
    {"GiMaskBuffer", 0, BUILD_MASKS},
    {"GiMaskBuffer", 2, BINDING_GI_MASKS},
    {"GiRankBuffer", 0, BUILD_RANKS},
    {"GiRankBuffer", 2, BINDING_GI_RANKS},
    {"GiVoxelBuffer", 0, BUILD_VOXELS},
    {"GiAttributeBuffer", 0, BUILD_ATTRIBUTES},
    {"GiAttributeBuffer", 2, BINDING_GI_ATTRIBUTES},
    {"GiAloneBuffer", 2, BINDING_GI_ALONE},
    {"GiAccumulatorBuffer", 0, BUILD_ACCUMULATORS},
    {"GiRadianceBuffer", 0, BUILD_RADIANCE},
    {"GiRadiance2Buffer", 0, BUILD_RADIANCE_2},
    {"GiCounterBuffer", 0, BUILD_COUNTERS},
    {"GiLightBuffer", 0, BUILD_LIGHTS},
    {"GiListBuffer", 0, BUILD_LISTS},
    {"gi_shadow_map", 0, BUILD_SHADOW_MAP},
    {"gi_base", 0, BUILD_BASE},
    {"gi_base", 2, BINDING_GI_BASE},
    {"gi_atlas", 0, BUILD_ATLAS},
    {"gi_atlas", 2, BINDING_GI_ATLAS},
    {"gi_atlas_nearest_mip", 2, BINDING_GI_ATLAS_NEAREST_MIP},
    {"gi_probes", 0, BUILD_PROBES},
    {"gi_probes", 2, BINDING_GI_PROBES},
    {"gi_bricks", 0, BUILD_BRICKS},
    {"gi_bricks", 2, BINDING_GI_BRICKS},
};

// --- What SPIR-V says ---

enum {
    OP_NAME = 5,
    OP_MEMBER_NAME = 6,
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_TYPE_VECTOR = 23,
    OP_TYPE_MATRIX = 24,
    OP_TYPE_ARRAY = 28,
    OP_TYPE_RUNTIME_ARRAY = 29,
    OP_TYPE_STRUCT = 30,
    OP_TYPE_POINTER = 32,
    OP_CONSTANT = 43,
    OP_VARIABLE = 59,
    OP_DECORATE = 71,
    OP_MEMBER_DECORATE = 72,
    DECORATION_SPEC_ID = 1,
    DECORATION_ARRAY_STRIDE = 6,
    DECORATION_MATRIX_STRIDE = 7,
    DECORATION_BINDING = 33,
    DECORATION_DESCRIPTOR_SET = 34,
    DECORATION_OFFSET = 35,
};
#define MEMBERS_CAP 32
typedef struct Id {
    const char *name;
    u16 op;
    const u32 *words; // of the defining instruction
    u32 word_count;
    u32 array_stride, binding, set, spec_id;
    bool has_binding, has_spec_id;
    const char *member_names[MEMBERS_CAP];
    u32 member_offsets[MEMBERS_CAP], matrix_strides[MEMBERS_CAP];
    bool has_offsets;
} Id;
typedef struct Module {
    const char *name;
    Id *ids;
    u32 id_count;
} Module;

static Module parse(const ShaderBlob *blob) {
    u32 count = (u32)(blob->end - blob->words);
    assert_true(count > 5 && blob->words[0] == 0x07230203);
    Module module = {blob->name, calloc(blob->words[3], sizeof(Id)), blob->words[3]};
    for (u32 at = 5; at < count;) {
        const u32 *w = blob->words + at;
        u32 op = w[0] & 0xFFFF, length = w[0] >> 16;
        assert_true(length > 0 && at + length <= count);
        at += length;
        Id *id = length > 1 && w[1] < module.id_count ? &module.ids[w[1]] : NULL;
        switch (op) {
        case OP_NAME:
            id->name = (const char *)&w[2];
            break;
        case OP_MEMBER_NAME:
            if (w[2] < MEMBERS_CAP) id->member_names[w[2]] = (const char *)&w[3];
            break;
        case OP_DECORATE:
            if (w[2] == DECORATION_ARRAY_STRIDE) id->array_stride = w[3];
            if (w[2] == DECORATION_BINDING) id->binding = w[3], id->has_binding = true;
            if (w[2] == DECORATION_DESCRIPTOR_SET) id->set = w[3];
            if (w[2] == DECORATION_SPEC_ID) id->spec_id = w[3], id->has_spec_id = true;
            break;
        case OP_MEMBER_DECORATE:
            if (w[2] >= MEMBERS_CAP) break;
            if (w[3] == DECORATION_OFFSET) id->member_offsets[w[2]] = w[4], id->has_offsets = true;
            if (w[3] == DECORATION_MATRIX_STRIDE) id->matrix_strides[w[2]] = w[4];
            break;
        case OP_TYPE_INT:
        case OP_TYPE_FLOAT:
        case OP_TYPE_VECTOR:
        case OP_TYPE_MATRIX:
        case OP_TYPE_ARRAY:
        case OP_TYPE_RUNTIME_ARRAY:
        case OP_TYPE_STRUCT:
        case OP_TYPE_POINTER:
            id->op = (u16)op, id->words = w, id->word_count = length;
            break;
        case OP_CONSTANT:
        case OP_VARIABLE: // type, id
            id = &module.ids[w[2]];
            id->op = (u16)op, id->words = w, id->word_count = length;
            break;
        default:
            break;
        }
    }
    return module;
}

static u32 type_size(const Module *module, u32 type, u32 matrix_stride) {
    const Id *id = &module->ids[type];
    switch (id->op) {
    case OP_TYPE_INT:
    case OP_TYPE_FLOAT:
        return id->words[2] / 8;
    case OP_TYPE_VECTOR:
        return type_size(module, id->words[2], 0) * id->words[3];
    case OP_TYPE_MATRIX:
        return matrix_stride * id->words[3];
    case OP_TYPE_ARRAY:
        return id->array_stride * module->ids[id->words[3]].words[3];
    case OP_TYPE_STRUCT: { // of the last member's end; ours have no padding after it
        u32 last = id->word_count - 3;
        return id->member_offsets[last] +
               type_size(module, id->words[2 + last], id->matrix_strides[last]);
    }
    default:
        fail_msg("%s: a type that no shared struct has (op %u)", module->name, id->op);
    }
    return 0;
}

static const SharedStruct *shared_struct(const char *name) {
    for (u32 i = 0; name && i < COUNT_OF(structs); i++)
        if (strcmp(structs[i].name, name) == 0) return &structs[i];
    return NULL;
}

// glslang makes one type for use in memory (with offsets) and one for local copies (without).
static bool compare_struct(const Module *module, const Id *id) {
    const SharedStruct *c = shared_struct(id->name);
    if (id->op != OP_TYPE_STRUCT || !c || !id->has_offsets) return false;
    u32 member_count = id->word_count - 2, c_count = 0;
    while (c_count < COUNT_OF(c->members) && c->members[c_count].name) c_count++;
    if (member_count != c_count)
        fail_msg("%s: %s has %u members, %u in C", module->name, c->name, member_count, c_count);
    for (u32 m = 0; m < member_count; m++) {
        u32 size = type_size(module, id->words[2 + m], id->matrix_strides[m]);
        if (strcmp(id->member_names[m], c->members[m].name) != 0 ||
            id->member_offsets[m] != c->members[m].offset || size != c->members[m].size)
            fail_msg("%s: %s.%s at %u of %u bytes; C: .%s at %u of %u bytes", module->name, c->name,
                     id->member_names[m], id->member_offsets[m], size, c->members[m].name,
                     c->members[m].offset, c->members[m].size);
    }
    u32 last = c_count - 1;
    assert_int_equal(c->members[last].offset + c->members[last].size, c->size);
    return true;
}

TEST(shared_reflection, structs_agree_with_c) {
    bool found[COUNT_OF(structs)] = {false};
    for (u32 b = 0; b < shader_blob_count; b++) {
        Module module = parse(&shader_blobs[b]);
        for (u32 i = 0; i < module.id_count; i++)
            if (compare_struct(&module, &module.ids[i]))
                found[shared_struct(module.ids[i].name) - structs] = true;
        // Arrays of them step by the size of the C struct.
        for (u32 i = 0; i < module.id_count; i++) {
            const Id *id = &module.ids[i];
            if (id->op != OP_TYPE_RUNTIME_ARRAY && id->op != OP_TYPE_ARRAY) continue;
            const SharedStruct *c = shared_struct(module.ids[id->words[2]].name);
            if (c && id->array_stride && id->array_stride != c->size)
                fail_msg("%s: %s[] steps by %u, in C by %u", module.name, c->name, id->array_stride,
                         c->size);
        }
        free(module.ids);
    }
    for (u32 i = 0; i < COUNT_OF(structs); i++) {
        bool is_listed = false;
        for (const char *const *name = unused_structs; *name; name++)
            is_listed |= strcmp(*name, structs[i].name) == 0;
        if (!found[i] && !is_listed) fail_msg("%s is in no shader", structs[i].name);
        if (found[i] && is_listed)
            fail_msg("%s is in a shader: take it off the list", structs[i].name);
    }
}

static bool is_test_shader(const char *name) { return strncmp(name, "test_", 5) == 0; }

// A block's own name; of an image the variable's.
static const char *bound_name(const Module *module, const Id *variable) {
    const Id *pointer = &module->ids[variable->words[1]];
    const Id *type = &module->ids[pointer->words[3]];
    return type->op == OP_TYPE_STRUCT ? type->name : variable->name;
}

TEST(shared_reflection, bindings_agree_with_c) {
    static const u32 binding_counts[] = {BINDING_FRAME_COUNT, BINDING_MATERIAL_COUNT,
                                         BINDING_GI_COUNT};
    bool found[COUNT_OF(expected_bindings)] = {false};
    for (u32 b = 0; b < shader_blob_count; b++) {
        if (is_test_shader(shader_blobs[b].name)) continue; // they have their own
        Module module = parse(&shader_blobs[b]);
        for (u32 i = 0; i < module.id_count; i++) {
            const Id *variable = &module.ids[i];
            if (variable->op != OP_VARIABLE || !variable->has_binding) continue;
            const char *name = bound_name(&module, variable);
            if (variable->set >= COUNT_OF(binding_counts) ||
                variable->binding >= binding_counts[variable->set])
                fail_msg("%s: %s is at set %u, binding %u, which shared.h does not have",
                         module.name, name, variable->set, variable->binding);
            bool is_known = false, is_right = false;
            for (u32 e = 0; name && e < COUNT_OF(expected_bindings); e++) {
                if (strcmp(name, expected_bindings[e].name) != 0) continue;
                bool same = variable->set == expected_bindings[e].set &&
                            variable->binding == expected_bindings[e].binding;
                found[e] |= same;
                is_known = true;
                is_right |= same;
            }
            if (is_known && !is_right)
                fail_msg("%s: %s at set %u binding %u, not so in C", module.name, name,
                         variable->set, variable->binding);
        }
        free(module.ids);
    }
    for (u32 e = 0; e < COUNT_OF(expected_bindings); e++)
        if (!found[e]) fail_msg("%s is bound in no shader", expected_bindings[e].name);
}

TEST(shared_reflection, specialisation_constants_are_in_range) {
    for (u32 b = 0; b < shader_blob_count; b++) {
        if (is_test_shader(shader_blobs[b].name)) continue;
        Module module = parse(&shader_blobs[b]);
        for (u32 i = 0; i < module.id_count; i++)
            if (module.ids[i].has_spec_id && module.ids[i].spec_id >= SPEC_COUNT)
                fail_msg("%s: specialisation constant %u (%s) is not in shared.h", module.name,
                         module.ids[i].spec_id, module.ids[i].name ? module.ids[i].name : "?");
        free(module.ids);
    }
}

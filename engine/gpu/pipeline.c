// pipeline.c: shaders by name, pipelines from descs.
//
// Data in: GpuPipelineDesc, SPIR-V blobs. Data out: handles. Called by the renderer at load and by
// the shader reload. Does not: derive layouts from shaders (a test compares them), or warm up
// drivers that compile at the first use (the renderer does, with a progress bar).
//
// Every pipeline layout has the same push constant range (128 bytes, all stages), so that set 0
// stays bound across pipelines that agree on it.
#include "gpu_internal.h"
#include "../../shaders/shared.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- Shaders ---

u32 gpu_shader_find(Gpu *gpu, const char *name) {
    for (u32 i = 0; i < gpu->shader_count; i++)
        if (strcmp(gpu->shaders[i].name, name) == 0) return i;
    const ShaderBlob *blob = shader_blob_find(name);
    if (!blob) {
        LOG(SHADER_ERROR, "there is no shader \"%s\" among the %u of this build", name,
            shader_blob_count);
        return UINT32_MAX;
    }
    GpuShader *grown = realloc(gpu->shaders, (gpu->shader_count + 1) * sizeof *grown);
    if (!grown) return UINT32_MAX;
    gpu->shaders = grown;
    GpuShader *shader = &gpu->shaders[gpu->shader_count];
    *shader = (GpuShader){.words = blob->words,
                          .byte_count = (u32)((const u8 *)blob->end - (const u8 *)blob->words)};
    LUZ_ASSERT(strlen(name) < sizeof shader->name);
    snprintf(shader->name, sizeof shader->name, "%s", name);
    return gpu->shader_count++;
}

void gpu_shaders_destroy(Gpu *gpu) {
    for (u32 i = 0; i < gpu->shader_count; i++) free(gpu->shaders[i].owned);
    free(gpu->shaders);
    if (gpu->reload_arena.memory) arena_destroy(&gpu->reload_arena);
}

static bool shader_module(Gpu *gpu, const GpuShader *shader, VkShaderModule *module) {
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = shader->byte_count,
        .pCode = shader->words,
    };
    bool ok = GPU_CHECK(gpu, shader->name,
                        gpu->vk.vkCreateShaderModule(gpu->device, &info, NULL, module));
    if (ok)
        gpu_name_object(gpu, VK_OBJECT_TYPE_SHADER_MODULE, GPU_HANDLE(*module), "%s", shader->name);
    return ok;
}

// --- Vertex layouts ---

static const VkVertexInputAttributeDescription mesh_attributes[] = {
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(MeshVertex, position)},
    {1, 0, VK_FORMAT_R32_UINT, offsetof(MeshVertex, normal)},
    {2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(MeshVertex, uv)},
    {3, 0, VK_FORMAT_R32_UINT, offsetof(MeshVertex, tangent)},
    {4, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(MeshVertex, color)},
    {5, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(InstanceRecord, world[0])},
    {6, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(InstanceRecord, world[1])},
    {7, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(InstanceRecord, world[2])},
    {8, 1, VK_FORMAT_R32G32B32A32_UINT, offsetof(InstanceRecord, ids)},
};
static const VkVertexInputBindingDescription mesh_streams[] = {
    {0, sizeof(MeshVertex), VK_VERTEX_INPUT_RATE_VERTEX},
    {1, sizeof(InstanceRecord), VK_VERTEX_INPUT_RATE_INSTANCE},
};
static const VkVertexInputAttributeDescription ui_attributes[] = {
    {0, 0, VK_FORMAT_R32G32_SFLOAT, 0},
    {1, 0, VK_FORMAT_R32G32_SFLOAT, 8},
    {2, 0, VK_FORMAT_R8G8B8A8_UNORM, 16},
};
static const VkVertexInputBindingDescription ui_streams[] = {{0, 20, VK_VERTEX_INPUT_RATE_VERTEX}};
static const VkVertexInputAttributeDescription light_attributes[] = {
    {0, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(LightRecord, position)},
    {1, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(LightRecord, color)},
    {2, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(SpotRecord, direction)},
    {3, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(SpotRecord, edge)},
};
static const VkVertexInputBindingDescription light_streams[] = {
    {0, sizeof(LightRecord), VK_VERTEX_INPUT_RATE_INSTANCE},
    {1, sizeof(SpotRecord), VK_VERTEX_INPUT_RATE_INSTANCE},
};
static const VkVertexInputAttributeDescription volume_attributes[] = {
    {0, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(LightRecord, position)},
    {1, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(LightRecord, color)},
    {2, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(SpotRecord, direction)},
    {3, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(SpotRecord, edge)},
    {4, 2, VK_FORMAT_R32G32B32A32_SFLOAT, 0},
};
static const VkVertexInputBindingDescription volume_streams[] = {
    {0, sizeof(LightRecord), VK_VERTEX_INPUT_RATE_INSTANCE},
    {1, sizeof(SpotRecord), VK_VERTEX_INPUT_RATE_INSTANCE},
    {2, 16, VK_VERTEX_INPUT_RATE_VERTEX},
};
#define VERTEX_LAYOUT(name)                                                                        \
    { COUNT_OF(name##_streams), COUNT_OF(name##_attributes), name##_streams, name##_attributes }
static const struct {
    u32 stream_count, attribute_count;
    const VkVertexInputBindingDescription *streams;
    const VkVertexInputAttributeDescription *attributes;
} vertex_layouts[] = {
    [GPU_VERTEX_NONE] = {0},
    [GPU_VERTEX_MESH] = VERTEX_LAYOUT(mesh),
    [GPU_VERTEX_UI] = VERTEX_LAYOUT(ui),
    [GPU_VERTEX_LIGHT] = VERTEX_LAYOUT(light),
    [GPU_VERTEX_VOLUME] = VERTEX_LAYOUT(volume),
};

// --- Building ---

static bool build_graphics(Gpu *gpu, const GpuPipelineItem *item,
                           const VkPipelineShaderStageCreateInfo *stages, VkPipeline *out) {
    const GpuPipelineDesc *desc = &item->desc;
    VkPipelineVertexInputStateCreateInfo vertices = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = vertex_layouts[desc->vertex_layout].stream_count,
        .pVertexBindingDescriptions = vertex_layouts[desc->vertex_layout].streams,
        .vertexAttributeDescriptionCount = vertex_layouts[desc->vertex_layout].attribute_count,
        .pVertexAttributeDescriptions = vertex_layouts[desc->vertex_layout].attributes,
    };
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
    };
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1,
    };
    static const VkCullModeFlags culls[] = {[GPU_CULL_BACK] = VK_CULL_MODE_BACK_BIT,
                                            [GPU_CULL_NONE] = VK_CULL_MODE_NONE,
                                            [GPU_CULL_FRONT] = VK_CULL_MODE_FRONT_BIT};
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .depthClampEnable = desc->depth_clamp && gpu->info.depth_clamp,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = culls[desc->cull],
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE, // as seen: the viewport's height is negative
        .depthBiasEnable = desc->depth_bias != 0.0f || desc->depth_bias_slope != 0.0f,
        .depthBiasConstantFactor = desc->depth_bias,
        .depthBiasSlopeFactor = desc->depth_bias_slope,
        .lineWidth = 1.0f,
    };
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = (VkSampleCountFlagBits)MAX(desc->samples, 1u), // bit = count
    };
    bool marks = desc->stencil == GPU_STENCIL_MARK;
    VkStencilOpState count = {.compareOp = VK_COMPARE_OP_ALWAYS, .writeMask = 0xFF};
    VkStencilOpState count_back = count, count_front = count;
    count_back.depthFailOp = VK_STENCIL_OP_INCREMENT_AND_WRAP;
    count_front.depthFailOp = VK_STENCIL_OP_DECREMENT_AND_WRAP;
    // Whatever the depth says: what was marked is used up.
    VkStencilOpState take = {.compareOp = VK_COMPARE_OP_NOT_EQUAL,
                             .passOp = VK_STENCIL_OP_ZERO,
                             .depthFailOp = VK_STENCIL_OP_ZERO,
                             .compareMask = 0xFF,
                             .writeMask = 0xFF};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = desc->depth != GPU_DEPTH_NONE,
        .depthWriteEnable = desc->depth == GPU_DEPTH_WRITE,
        .depthCompareOp = desc->depth == GPU_DEPTH_EQUAL    ? VK_COMPARE_OP_EQUAL
                          : desc->depth == GPU_DEPTH_BEHIND ? VK_COMPARE_OP_LESS_OR_EQUAL
                                                            : VK_COMPARE_OP_GREATER_OR_EQUAL,
        .stencilTestEnable = desc->stencil != GPU_STENCIL_NONE,
        .front = marks ? count_front : take,
        .back = marks ? count_back : take,
    };
    VkPipelineColorBlendAttachmentState blends[GPU_TARGETS_CAP];
    VkFormat formats[GPU_TARGETS_CAP];
    for (u32 i = 0; i < desc->target_count; i++) {
        static const struct {
            VkBlendFactor source, there, there_alpha;
        } factors[] = {
            [GPU_BLEND_NONE] = {VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ZERO, VK_BLEND_FACTOR_ZERO},
            [GPU_BLEND_ADD] = {VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE},
            [GPU_BLEND_ALPHA] = {VK_BLEND_FACTOR_SRC_ALPHA, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                 VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA},
            [GPU_BLEND_SCALE_ADD] = {VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_SRC_ALPHA,
                                     VK_BLEND_FACTOR_ONE},
        };
        formats[i] = gpu_format_vk(gpu, desc->targets[i]);
        blends[i] = (VkPipelineColorBlendAttachmentState){
            .blendEnable = desc->blend != GPU_BLEND_NONE,
            .srcColorBlendFactor = factors[desc->blend].source,
            .dstColorBlendFactor = factors[desc->blend].there,
            // What SCALE_ADD says of opacity is a factor, not an opacity to add.
            .srcAlphaBlendFactor =
                desc->blend == GPU_BLEND_SCALE_ADD ? VK_BLEND_FACTOR_ZERO : VK_BLEND_FACTOR_ONE,
            .dstAlphaBlendFactor = factors[desc->blend].there_alpha,
            .colorWriteMask = marks ? 0 : 0xF,
        };
    }
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = desc->target_count,
        .pAttachments = blends,
    };
    VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates =
            (const VkDynamicState[]){VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR},
    };
    VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = desc->target_count,
        .pColorAttachmentFormats = formats,
        .depthAttachmentFormat = gpu_format_vk(gpu, desc->depth_format),
        .stencilAttachmentFormat = gpu_format_has_stencil(desc->depth_format)
                                       ? gpu_format_vk(gpu, desc->depth_format)
                                       : VK_FORMAT_UNDEFINED,
    };
    VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = desc->fragment ? 2 : 1, // depth-only pipelines may have no fragment shader
        .pStages = stages,
        .pVertexInputState = &vertices,
        .pInputAssemblyState = &assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &raster,
        .pMultisampleState = &samples,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = item->layout,
    };
    return GPU_CHECK(
        gpu, item->pool.label,
        gpu->vk.vkCreateGraphicsPipelines(gpu->device, gpu->pipeline_cache, 1, &info, NULL, out));
}

bool gpu_pipeline_build(Gpu *gpu, GpuPipelineItem *item, VkPipeline *out) {
    const GpuPipelineDesc *desc = &item->desc;
    VkSpecializationMapEntry entries[GPU_SPEC_CAP];
    for (u32 i = 0; i < desc->spec_count; i++) entries[i] = (VkSpecializationMapEntry){i, i * 4, 4};
    VkSpecializationInfo spec = {desc->spec_count, entries, desc->spec_count * 4, desc->spec};
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    VkPipelineShaderStageCreateInfo stages[2];
    u32 stage_count = item->is_compute || !desc->fragment ? 1 : 2;
    bool ok = true;
    for (u32 i = 0; i < stage_count && ok; i++) {
        ok = shader_module(gpu, &gpu->shaders[item->shaders[i]], &modules[i]);
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = item->is_compute ? VK_SHADER_STAGE_COMPUTE_BIT
                     : i == 0         ? VK_SHADER_STAGE_VERTEX_BIT
                                      : VK_SHADER_STAGE_FRAGMENT_BIT,
            .module = modules[i],
            .pName = "main",
            .pSpecializationInfo = &spec,
        };
    }
    if (ok && item->is_compute) {
        VkComputePipelineCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage = stages[0],
            .layout = item->layout,
        };
        ok = GPU_CHECK(gpu, item->pool.label,
                       gpu->vk.vkCreateComputePipelines(gpu->device, gpu->pipeline_cache, 1, &info,
                                                        NULL, out));
    } else if (ok) {
        ok = build_graphics(gpu, item, stages, out);
    }
    for (u32 i = 0; i < stage_count; i++)
        if (modules[i]) gpu->vk.vkDestroyShaderModule(gpu->device, modules[i], NULL);
    if (ok)
        gpu_name_object(gpu, VK_OBJECT_TYPE_PIPELINE, GPU_HANDLE(*out), "%s", item->pool.label);
    else
        *out = VK_NULL_HANDLE;
    return ok;
}

static bool pipeline_layout(Gpu *gpu, GpuPipelineItem *item) {
    VkDescriptorSetLayout sets[GPU_GROUPS_CAP];
    for (u32 i = 0; i < item->desc.layout_count; i++) {
        const GpuBindLayoutItem *layout =
            gpu_pool_get(&gpu->bind_layouts, item->desc.layouts[i].id);
        sets[i] = layout->layout;
    }
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = item->desc.layout_count,
        .pSetLayouts = sets,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &(VkPushConstantRange){GPU_STAGES, 0, GPU_PUSH_SIZE_MAX},
    };
    if (!GPU_CHECK(gpu, item->pool.label,
                   gpu->vk.vkCreatePipelineLayout(gpu->device, &info, NULL, &item->layout))) {
        item->layout = VK_NULL_HANDLE;
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_PIPELINE_LAYOUT, GPU_HANDLE(item->layout), "%s layout",
                    item->pool.label);
    return true;
}

static bool targets_are_possible(Gpu *gpu, const GpuPipelineDesc *desc) {
    for (u32 i = 0; i < desc->target_count; i++) {
        VkFormatProperties properties;
        vkGetPhysicalDeviceFormatProperties(gpu->physical, gpu_format_vk(gpu, desc->targets[i]),
                                            &properties);
        VkFormatFeatureFlags needed = VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT;
        if (desc->blend != GPU_BLEND_NONE) needed |= VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT;
        if ((properties.optimalTilingFeatures & needed) == needed) continue;
        LOG(GPU_LIMIT, "pipeline \"%s\": target %u of format %d cannot be %s on this device",
            desc->label, i, (int)desc->targets[i],
            desc->blend != GPU_BLEND_NONE ? "blended" : "drawn to");
        return false;
    }
    return true;
}

GpuPipeline gpu_create_pipeline(Gpu *gpu, const GpuPipelineDesc *desc) {
    LUZ_ASSERT((desc->compute != NULL) != (desc->vertex != NULL)); // one of the two kinds
    LUZ_ASSERT(desc->push_size <= GPU_PUSH_SIZE_MAX && desc->spec_count <= GPU_SPEC_CAP);
    LUZ_ASSERT(!desc->stencil || gpu_format_has_stencil(desc->depth_format));
    LUZ_ASSERT(desc->layout_count <= GPU_GROUPS_CAP && desc->target_count <= GPU_TARGETS_CAP);
    u32 shaders[2] = {0, 0};
    const char *names[2] = {desc->compute ? desc->compute : desc->vertex,
                            desc->compute ? NULL : desc->fragment};
    for (u32 i = 0; i < 2; i++)
        if (names[i] && (shaders[i] = gpu_shader_find(gpu, names[i])) == UINT32_MAX)
            return (GpuPipeline){0};
    if (!targets_are_possible(gpu, desc)) return (GpuPipeline){0};

    GpuPipelineItem *item;
    u32 id = gpu_pool_add(&gpu->pipelines, desc->label, (void **)&item);
    if (!id) return (GpuPipeline){0};
    item->is_compute = desc->compute != NULL;
    item->desc = *desc;
    // The caller's strings may go; which ones were there still tells the kind.
    item->desc.label = item->desc.vertex = item->desc.compute = NULL;
    item->desc.fragment = desc->fragment ? "" : NULL;
    item->shaders[0] = shaders[0];
    item->shaders[1] = shaders[1];
    if (!pipeline_layout(gpu, item) || !gpu_pipeline_build(gpu, item, &item->pipeline)) {
        gpu_destroy_pipeline(gpu, (GpuPipeline){id});
        return (GpuPipeline){0};
    }
    return (GpuPipeline){id};
}

void gpu_destroy_pipeline(Gpu *gpu, GpuPipeline pipeline) {
    if (!pipeline.id) return;
    GpuPipelineItem *item = gpu_pool_get(&gpu->pipelines, pipeline.id);
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_PIPELINE, GPU_HANDLE(item->pipeline));
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_PIPELINE_LAYOUT, GPU_HANDLE(item->layout));
    gpu_pool_remove(&gpu->pipelines, pipeline.id);
}

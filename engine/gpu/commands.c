// commands.c: what a frame records.
//
// Data in: handles and numbers of one frame. Data out: Vulkan commands in the frame's command
// buffer. Called by the passes. Keeps what is bound, to bind nothing twice, and no other state;
// does not order anything: barriers are the caller's (gpu_cmd_barriers).
#include "gpu_internal.h"
#include <string.h>

// --- Rendering ---

static VkRenderingAttachmentInfo attachment(const Gpu *gpu, const GpuTarget *target,
                                            bool is_swapchain) {
    const GpuTextureItem *texture = is_swapchain ? NULL : gpu_texture_get(gpu, target->texture);
    VkRenderingAttachmentInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = is_swapchain ? gpu->swap.views[gpu->swap.image_index] : texture->target_view,
        .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        .loadOp = target->clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
    };
    if (target->resolve.id) {
        bool is_depth = gpu_format_is_depth(texture->format);
        info.resolveMode = is_depth ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT : VK_RESOLVE_MODE_AVERAGE_BIT;
        info.resolveImageView = gpu_texture_get(gpu, target->resolve)->target_view;
        info.resolveImageLayout =
            gpu_usage_layout(is_depth ? GPU_USAGE_DEPTH_RESOLVE : GPU_USAGE_COLOR_TARGET, is_depth);
    }
    for (u32 i = 0; i < 4; i++) {
        if (texture && texture->format == GPU_FORMAT_R32U)
            info.clearValue.color.uint32[i] = (u32)target->clear_value[i];
        else
            info.clearValue.color.float32[i] = target->clear_value[i];
    }
    return info;
}

void gpu_cmd_begin_rendering(GpuCommands *cmd, const GpuRendering *rendering) {
    Gpu *gpu = cmd->gpu;
    LUZ_ASSERT(!cmd->is_rendering && rendering->target_count <= GPU_TARGETS_CAP);
    u32 width = rendering->width, height = rendering->height;
    VkRenderingAttachmentInfo colors[GPU_TARGETS_CAP], depth, stencil;
    bool has_stencil = false;
    u32 color_count = rendering->to_swapchain ? 1 : rendering->target_count;
    if (rendering->to_swapchain) {
        LUZ_ASSERT(gpu->swap.is_awaited); // acquired in this frame
        gpu_swapchain_to_color(gpu);
        width = width ? width : gpu->swap.width;
        height = height ? height : gpu->swap.height;
    }
    for (u32 i = 0; i < color_count; i++)
        colors[i] = attachment(gpu, &rendering->targets[i], rendering->to_swapchain);
    if (rendering->depth.texture.id) {
        depth = attachment(gpu, &rendering->depth, false);
        has_stencil =
            gpu_format_has_stencil(gpu_texture_get(gpu, rendering->depth.texture)->format);
        LUZ_ASSERT(!rendering->stencil || (has_stencil && rendering->depth_read_only));
        depth.imageLayout = gpu_usage_layout(rendering->stencil           ? GPU_USAGE_DEPTH_STENCIL
                                             : rendering->depth_read_only ? GPU_USAGE_DEPTH_TEST
                                                                          : GPU_USAGE_DEPTH_TARGET,
                                             true);
        depth.clearValue.depthStencil =
            (VkClearDepthStencilValue){rendering->depth.clear_value[0], 0};
        // Storing is a write, which a read-only depth must not see.
        if (rendering->depth_read_only) depth.storeOp = VK_ATTACHMENT_STORE_OP_NONE;
        // A stencil comes with its depth, so that pipelines need not tell passes apart; only a
        // rendering that asks for it finds anything there.
        stencil = depth;
        stencil.resolveMode = VK_RESOLVE_MODE_NONE;
        if (rendering->stencil) {
            stencil.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
            stencil.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
            stencil.clearValue.depthStencil = (VkClearDepthStencilValue){0.0f, 0};
        }
    }
    // Default size: that of the first target.
    if (!width || !height) {
        GpuTexture first = color_count ? rendering->targets[0].texture : rendering->depth.texture;
        const GpuTextureItem *texture = gpu_texture_get(gpu, first);
        width = texture->width;
        height = texture->height;
    }
    VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea = {{0, 0}, {width, height}},
        .layerCount = 1,
        .colorAttachmentCount = color_count,
        .pColorAttachments = colors,
        .pDepthAttachment = rendering->depth.texture.id ? &depth : NULL,
        .pStencilAttachment = has_stencil ? &stencil : NULL,
    };
    gpu->vk.vkCmdBeginRendering(cmd->buffer, &info);
    cmd->is_rendering = true;
    // Negative height: NDC y points up, and counter-clockwise stays front.
    VkViewport viewport = {0.0f, (f32)height, (f32)width, -(f32)height, 0.0f, 1.0f};
    gpu->vk.vkCmdSetViewport(cmd->buffer, 0, 1, &viewport);
    gpu_cmd_scissor(cmd, 0, 0, width, height);
}

void gpu_cmd_end_rendering(GpuCommands *cmd) {
    LUZ_ASSERT(cmd->is_rendering);
    cmd->gpu->vk.vkCmdEndRendering(cmd->buffer);
    cmd->is_rendering = false;
}

void gpu_cmd_scissor(GpuCommands *cmd, i32 x, i32 y, u32 width, u32 height) {
    // Negative offsets are not allowed: cut the rectangle instead.
    i64 x1 = MAX((i64)x + width, 0), y1 = MAX((i64)y + height, 0);
    i32 x0 = MAX(x, 0), y0 = MAX(y, 0);
    VkRect2D rect = {{x0, y0}, {(u32)MAX(x1 - x0, 0), (u32)MAX(y1 - y0, 0)}};
    cmd->gpu->vk.vkCmdSetScissor(cmd->buffer, 0, 1, &rect);
}

// --- Binding ---

void gpu_cmd_bind_pipeline(GpuCommands *cmd, GpuPipeline pipeline) {
    const GpuPipelineItem *item = gpu_pool_get(&cmd->gpu->pipelines, pipeline.id);
    cmd->layout = item->layout;
    memcpy(cmd->layouts, item->desc.layouts, sizeof cmd->layouts);
    cmd->push_size = item->desc.push_size;
    cmd->bind_point =
        item->is_compute ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_GRAPHICS;
    cmd->gpu->vk.vkCmdBindPipeline(cmd->buffer, cmd->bind_point, item->pipeline);
}

// Do the bound pipeline's layouts agree with those that a group was bound with, up to its own?
static bool agrees(const GpuCommands *cmd, const GpuBoundGroup *bound, u32 set) {
    for (u32 i = 0; i <= set; i++)
        if (bound->layouts[i].id != cmd->layouts[i].id) return false;
    return true;
}

// The software driver handles every binding of a set again when it is bound, and compares all
// uniform blocks with the last ones at the next draw: what is bound already stays.
void gpu_cmd_bind_group(GpuCommands *cmd, u32 set, GpuBindGroup group) {
    LUZ_ASSERT(cmd->layout && set < GPU_GROUPS_CAP);
    const GpuBindGroupItem *item = gpu_pool_get(&cmd->gpu->bind_groups, group.id);
    u32 slot = item->set_count > 1 ? cmd->gpu->frame_slot : 0;
    GpuBoundGroup *bound = cmd->bound[cmd->bind_point == VK_PIPELINE_BIND_POINT_COMPUTE];
    if (bound[set].set == item->sets[slot] && agrees(cmd, &bound[set], set)) return;
    // Sets whose layouts differ from this pipeline's are disturbed (Vulkan 1.3, 14.2.2).
    for (u32 i = 0; i < GPU_GROUPS_CAP; i++)
        if (i == set || !agrees(cmd, &bound[i], i)) bound[i].set = VK_NULL_HANDLE;
    bound[set].set = item->sets[slot];
    memcpy(bound[set].layouts, cmd->layouts, sizeof bound[set].layouts);
    cmd->gpu->vk.vkCmdBindDescriptorSets(cmd->buffer, cmd->bind_point, cmd->layout, set, 1,
                                         &item->sets[slot], 0, NULL);
}

void gpu_cmd_push(GpuCommands *cmd, const void *data, u32 size) {
    LUZ_ASSERT(cmd->layout && size <= cmd->push_size);
    cmd->gpu->vk.vkCmdPushConstants(cmd->buffer, cmd->layout, GPU_STAGES, 0, size, data);
}

void gpu_cmd_bind_vertices(GpuCommands *cmd, u32 stream, GpuBuffer vertices, u64 offset) {
    const GpuBufferItem *item = gpu_buffer_get(cmd->gpu, vertices);
    LUZ_ASSERT(item->vertex);
    offset += gpu_buffer_offset(cmd->gpu, item);
    cmd->gpu->vk.vkCmdBindVertexBuffers(cmd->buffer, stream, 1, &item->buffer, &offset);
}

void gpu_cmd_bind_indices(GpuCommands *cmd, GpuBuffer indices, bool are_u16) {
    const GpuBufferItem *item = gpu_buffer_get(cmd->gpu, indices);
    LUZ_ASSERT(item->index);
    cmd->gpu->vk.vkCmdBindIndexBuffer(cmd->buffer, item->buffer, gpu_buffer_offset(cmd->gpu, item),
                                      are_u16 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
}

// --- Work ---

void gpu_cmd_draw(GpuCommands *cmd, u32 vertex_count, u32 instance_count, u32 first_vertex,
                  u32 first_instance) {
    cmd->gpu->vk.vkCmdDraw(cmd->buffer, vertex_count, instance_count, first_vertex, first_instance);
}

void gpu_cmd_draw_indexed(GpuCommands *cmd, u32 index_count, u32 instance_count, u32 first_index,
                          i32 vertex_offset, u32 first_instance) {
    cmd->gpu->vk.vkCmdDrawIndexed(cmd->buffer, index_count, instance_count, first_index,
                                  vertex_offset, first_instance);
}

void gpu_cmd_dispatch(GpuCommands *cmd, u32 x, u32 y, u32 z) {
    cmd->gpu->vk.vkCmdDispatch(cmd->buffer, x, y, z);
}

void gpu_cmd_dispatch_indirect(GpuCommands *cmd, GpuBuffer buffer, u64 offset) {
    const GpuBufferItem *item = gpu_buffer_get(cmd->gpu, buffer);
    LUZ_ASSERT(item->indirect && offset + 12 <= item->size);
    cmd->gpu->vk.vkCmdDispatchIndirect(cmd->buffer, item->buffer,
                                       gpu_buffer_offset(cmd->gpu, item) + offset);
}

void gpu_cmd_copy_texture_to_buffer(GpuCommands *cmd, GpuTexture texture, GpuBuffer buffer) {
    const GpuTextureItem *from = gpu_texture_get(cmd->gpu, texture);
    const GpuBufferItem *to = gpu_buffer_get(cmd->gpu, buffer);
    LUZ_ASSERT((u64)from->width * from->height * from->depth * gpu_format_bytes(from->format) <=
               to->size);
    VkBufferImageCopy region = {
        .bufferOffset = gpu_buffer_offset(cmd->gpu, to),
        .imageSubresource = {gpu_format_aspect(from->format), 0, 0, 1},
        .imageExtent = {from->width, from->height, from->depth},
    };
    cmd->gpu->vk.vkCmdCopyImageToBuffer(
        cmd->buffer, from->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to->buffer, 1, &region);
}

void gpu_cmd_copy_mips_to_buffer(GpuCommands *cmd, GpuTexture texture, GpuBuffer buffer) {
    const GpuTextureItem *from = gpu_texture_get(cmd->gpu, texture);
    const GpuBufferItem *to = gpu_buffer_get(cmd->gpu, buffer);
    LUZ_ASSERT(gpu_texture_bytes(from) <= to->size);
    u64 offset = 0;
    for (u32 mip = 0; mip < from->mip_count; mip++) {
        VkExtent3D extent = {MAX(from->width >> mip, 1u), MAX(from->height >> mip, 1u),
                             MAX(from->depth >> mip, 1u)};
        VkBufferImageCopy region = {
            .bufferOffset = gpu_buffer_offset(cmd->gpu, to) + offset,
            .imageSubresource = {gpu_format_aspect(from->format), mip, 0, 1},
            .imageExtent = extent,
        };
        cmd->gpu->vk.vkCmdCopyImageToBuffer(
            cmd->buffer, from->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to->buffer, 1, &region);
        offset += (u64)extent.width * extent.height * extent.depth * gpu_format_bytes(from->format);
    }
}

void gpu_cmd_copy_buffer(GpuCommands *cmd, GpuBuffer from, u64 from_offset, GpuBuffer to,
                         u64 to_offset, u64 size) {
    const GpuBufferItem *source = gpu_buffer_get(cmd->gpu, from);
    const GpuBufferItem *target = gpu_buffer_get(cmd->gpu, to);
    LUZ_ASSERT(from_offset <= source->size && size <= source->size - from_offset);
    LUZ_ASSERT(to_offset <= target->size && size <= target->size - to_offset);
    VkBufferCopy region = {gpu_buffer_offset(cmd->gpu, source) + from_offset,
                           gpu_buffer_offset(cmd->gpu, target) + to_offset, size};
    cmd->gpu->vk.vkCmdCopyBuffer(cmd->buffer, source->buffer, target->buffer, 1, &region);
}

void gpu_cmd_fill_buffer(GpuCommands *cmd, GpuBuffer buffer, u64 offset, u64 size, u32 word) {
    const GpuBufferItem *item = gpu_buffer_get(cmd->gpu, buffer);
    LUZ_ASSERT(offset % 4 == 0 && size % 4 == 0);
    LUZ_ASSERT(offset <= item->size && size <= item->size - offset);
    if (size == 0) return;
    cmd->gpu->vk.vkCmdFillBuffer(cmd->buffer, item->buffer,
                                 gpu_buffer_offset(cmd->gpu, item) + offset, size, word);
}

void gpu_cmd_clear_texture(GpuCommands *cmd, GpuTexture texture) {
    const GpuTextureItem *item = gpu_texture_get(cmd->gpu, texture);
    LUZ_ASSERT(!gpu_format_is_depth(item->format));
    cmd->gpu->vk.vkCmdClearColorImage(
        cmd->buffer, item->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &(VkClearColorValue){{0}},
        1, &(VkImageSubresourceRange){VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1});
}

// --- Labels ---

void gpu_cmd_label_begin(GpuCommands *cmd, const char *name) {
    if (!cmd->gpu->has_debug_utils) return;
    VkDebugUtilsLabelEXT label = {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                  .pLabelName = name};
    vkCmdBeginDebugUtilsLabelEXT(cmd->buffer, &label);
}

void gpu_cmd_label_end(GpuCommands *cmd) {
    if (cmd->gpu->has_debug_utils) vkCmdEndDebugUtilsLabelEXT(cmd->buffer);
}

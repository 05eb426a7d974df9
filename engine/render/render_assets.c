// render_assets.c: the level's meshes and textures on the device.
//
// Data in: an AssetStore. Data out: one vertex and one index buffer with all meshes and
// their levels of detail, a texture an asset texture, bind groups per set of material textures.
// Called by renderer.c and passes.c. Does not stream: a level is uploaded once.
#include "render_internal.h"
#include "../base/log.h"
#include <string.h>

static GpuTexture texture_1x1(Gpu *gpu, const char *label, u32 rgba) {
    GpuTexture texture = gpu_create_texture(
        gpu,
        &(GpuTextureDesc){
            .label = label, .format = GPU_FORMAT_RGBA8, .width = 1, .height = 1, .sampled = true});
    if (texture.id) gpu_upload_texture(gpu, texture, &rgba, sizeof rgba);
    return texture;
}

bool render_assets_create(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    renderer->sampler_nearest = gpu_create_sampler(
        gpu, &(GpuSamplerDesc){.label = "nearest", .nearest = true, .nearest_mips = true});
    renderer->sampler_linear = gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "linear"});
    // The software driver pays for anisotropy by the sample; a GPU hardly does.
    f32 anisotropy = gpu_info(gpu)->is_software ? 0.0f : MIN(8.0f, gpu_info(gpu)->max_anisotropy);
    renderer->sampler_repeat =
        gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "repeat",
                                                  .repeat = true,
                                                  .anisotropy = anisotropy,
                                                  .nearest_mips = gpu_info(gpu)->is_software});
    renderer->sampler_shadow =
        gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "shadow", .compare_greater = true});
    renderer->white = texture_1x1(gpu, "white", 0xFFFFFFFFu);
    renderer->black = texture_1x1(gpu, "black", 0xFF000000u);
    renderer->flat_normal = texture_1x1(gpu, "flat normal", 0xFFFF8080u);
    return renderer->white.id && renderer->black.id && renderer->flat_normal.id &&
           renderer->sampler_shadow.id;
}

void render_assets_unload(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    for (u32 i = 0; i < renderer->material_group_count; i++)
        gpu_destroy_bind_group(gpu, renderer->material_groups[i].group);
    for (u32 i = 0; i < renderer->texture_count; i++)
        if (renderer->textures[i].id) gpu_destroy_texture(gpu, renderer->textures[i]);
    if (renderer->vertices.id) gpu_destroy_buffer(gpu, renderer->vertices);
    if (renderer->indices.id) gpu_destroy_buffer(gpu, renderer->indices);
    renderer->vertices = renderer->indices = (GpuBuffer){0};
    renderer->material_group_count = renderer->material_group_cap = 0;
    renderer->mesh_count = renderer->texture_count = 0;
    renderer->assets_stamp = 0;
    arena_reset(&renderer->arena);
}

void render_assets_destroy(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    render_assets_unload(renderer);
    GpuTexture textures[] = {renderer->white, renderer->black, renderer->flat_normal};
    for (u32 i = 0; i < COUNT_OF(textures); i++)
        if (textures[i].id) gpu_destroy_texture(gpu, textures[i]);
    GpuSampler samplers[] = {renderer->sampler_nearest, renderer->sampler_linear,
                             renderer->sampler_repeat, renderer->sampler_shadow};
    for (u32 i = 0; i < COUNT_OF(samplers); i++)
        if (samplers[i].id) gpu_destroy_sampler(gpu, samplers[i]);
}

static bool meshes_upload(Renderer *renderer, const AssetStore *assets) {
    Gpu *gpu = renderer->gpu;
    u64 vertex_count = 0, index_count = 0;
    for (u32 i = 0; i < assets->mesh_count; i++) {
        vertex_count += assets->meshes[i].vertex_count;
        index_count += assets->meshes[i].total_index_count;
    }
    if (vertex_count > INT32_MAX || index_count > UINT32_MAX) {
        LOG(RENDER_LIMIT, "meshes of the level: %llu vertices, %llu indices are more than 32 bits",
            (unsigned long long)vertex_count, (unsigned long long)index_count);
        return false;
    }
    renderer->mesh_count = assets->mesh_count;
    renderer->meshes = ARENA_PUSH(&renderer->arena, GpuMesh, MAX(assets->mesh_count, 1));
    renderer->vertices =
        gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "mesh vertices",
                                                .heap = "meshes",
                                                .vertex = true,
                                                .size = MAX(vertex_count, 1) * sizeof(MeshVertex)});
    renderer->indices =
        gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "mesh indices",
                                                .heap = "meshes",
                                                .index = true,
                                                .size = MAX(index_count, 1) * sizeof(u32)});
    if (!renderer->vertices.id || !renderer->indices.id) return false;
    u64 vertex = 0, index = 0;
    for (u32 i = 0; i < assets->mesh_count; i++) {
        const Mesh *mesh = &assets->meshes[i];
        if (mesh->vertex_count)
            gpu_upload_buffer(gpu, renderer->vertices, vertex * sizeof(MeshVertex), mesh->vertices,
                              (u64)mesh->vertex_count * sizeof(MeshVertex));
        if (mesh->total_index_count)
            gpu_upload_buffer(gpu, renderer->indices, index * sizeof(u32), mesh->indices,
                              (u64)mesh->total_index_count * sizeof(u32));
        GpuMesh *out = &renderer->meshes[i];
        *out = (GpuMesh){.lod_count = mesh->lod_count,
                         .vertex_offset = (i32)vertex,
                         .longest_edge = mesh_longest_edge(mesh),
                         .is_closed = mesh_is_closed(mesh)};
        for (u32 lod = 0; lod < mesh->lod_count; lod++) {
            out->lods[lod] = mesh->lods[lod];
            out->lods[lod].first_index += (u32)index;
        }
        vertex += mesh->vertex_count;
        index += mesh->total_index_count;
    }
    return true;
}

static bool textures_upload(Renderer *renderer, const AssetStore *assets) {
    bool all = true;
    renderer->texture_count = assets->texture_count;
    renderer->textures = ARENA_PUSH(&renderer->arena, GpuTexture, MAX(assets->texture_count, 1));
    for (u32 i = 1; i < assets->texture_count; i++) { // 0 is "none"
        const Texture *texture = &assets->textures[i];
        if (texture->width == 0 || texture->pixels == NULL) continue;
        u64 size = 0;
        for (u32 mip = 0, w = texture->width, h = texture->height; mip < texture->mip_count;
             mip++) {
            size += (u64)w * h * 4;
            w = MAX(w / 2, 1), h = MAX(h / 2, 1);
        }
        renderer->textures[i] = gpu_create_texture(
            renderer->gpu,
            &(GpuTextureDesc){.label = "level texture",
                              .format = texture->kind == TEXTURE_SRGB ? GPU_FORMAT_RGBA8_SRGB
                                                                      : GPU_FORMAT_RGBA8,
                              .width = texture->width,
                              .height = texture->height,
                              .mip_count = texture->mip_count,
                              .sampled = true});
        if (renderer->textures[i].id)
            gpu_upload_texture(renderer->gpu, renderer->textures[i], texture->pixels, size);
        else
            all = false;
    }
    return all;
}

bool renderer_set_assets(Renderer *renderer, const AssetStore *assets) {
    if (renderer->assets_stamp == assets->stamp) return true;
    gpu_wait_idle(renderer->gpu);
    render_assets_unload(renderer);
    renderer->shadow_key = 0;
    bool meshes = meshes_upload(renderer, assets);
    if (!meshes) renderer->mesh_count = 0;
    bool textures = textures_upload(renderer, assets);
    renderer->assets_stamp = assets->stamp;
    return meshes && textures;
}

static GpuTexture texture_or(const Renderer *renderer, u32 id, GpuTexture stand_in) {
    return id > 0 && id < renderer->texture_count && renderer->textures[id].id
               ? renderer->textures[id]
               : stand_in;
}

GpuBindGroup render_material_group(Renderer *renderer, const PacketMaterial *material) {
    for (u32 i = 0; i < renderer->material_group_count; i++) {
        const MaterialGroup *g = &renderer->material_groups[i];
        if (g->albedo == material->albedo_texture && g->normal == material->normal_texture &&
            g->emissive == material->emissive_texture)
            return g->group;
    }
    if (renderer->material_group_count == renderer->material_group_cap) {
        u32 cap = MAX(renderer->material_group_cap * 2, MATERIALS_CAP);
        MaterialGroup *groups = ARENA_PUSH(&renderer->arena, MaterialGroup, cap);
        if (renderer->material_group_count)
            memcpy(groups, renderer->material_groups,
                   renderer->material_group_count * sizeof *groups);
        renderer->material_groups = groups;
        renderer->material_group_cap = cap;
    }
    MaterialGroup *g = &renderer->material_groups[renderer->material_group_count++];
    *g = (MaterialGroup){
        material->albedo_texture, material->normal_texture, material->emissive_texture, {0}};
    g->group = gpu_create_bind_group(
        renderer->gpu,
        &(GpuBindGroupDesc){
            .label = "material",
            .layout = renderer->material_layout,
            .bindings = {
                [BINDING_ALBEDO_TEXTURE] = {.texture =
                                                texture_or(renderer, g->albedo, renderer->white),
                                            .sampler = renderer->sampler_repeat},
                [BINDING_NORMAL_TEXTURE] = {.texture = texture_or(renderer, g->normal,
                                                                  renderer->flat_normal),
                                            .sampler = renderer->sampler_repeat},
                [BINDING_EMISSIVE_TEXTURE] = {.texture = texture_or(renderer, g->emissive,
                                                                    renderer->black),
                                              .sampler = renderer->sampler_repeat},
            }});
    return g->group;
}

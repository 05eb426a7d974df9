// info.c: `luz info`: what is in a level, a model or a capture; or which device and settings there
// are. Data in: a file, or nothing. Data out: a table on stdout, or JSON. Does not: change
// anything; levels with errors are for `luz check`.
#include "../engine/capture/capture.h"
#include "headless.h"
#include <stdio.h>
#include <string.h>

#define INFO_ARENA_CAP GIB(8)

// The same facts as text or as JSON: rows of one table.
typedef struct Facts {
    Json json;
    bool as_json;
} Facts;

static void fact_text(Facts *facts, const char *name, const char *value) {
    json_text(&facts->json, name, value);
    if (!facts->as_json) printf("%-18s %s\n", name, value);
}

static void fact_u64(Facts *facts, const char *name, u64 value) {
    json_u64(&facts->json, name, value);
    if (!facts->as_json) printf("%-18s %llu\n", name, (unsigned long long)value);
}

static void fact_hash(Facts *facts, const char *name, u64 value) {
    json_hash(&facts->json, name, value);
    if (!facts->as_json) printf("%-18s %016llx\n", name, (unsigned long long)value);
}

static void fact_mib(Facts *facts, const char *name, u64 bytes) {
    json_u64(&facts->json, name, bytes);
    if (!facts->as_json) printf("%-18s %.1f MiB\n", name, (f64)bytes / (1 << 20));
}

static void fact_section(const Facts *facts, const char *title) {
    if (!facts->as_json) printf("\n%s\n", title);
}

// --- levels and models ---

static void info_assets(Facts *facts, const AssetStore *assets) {
    u64 triangles = 0, mesh_bytes = 0, texture_bytes = 0;
    for (u32 i = 1; i < assets->mesh_count; i++) {
        const Mesh *mesh = &assets->meshes[i];
        triangles += mesh->index_count / 3;
        mesh_bytes += (u64)mesh->vertex_count * sizeof(MeshVertex) + 4ull * mesh->total_index_count;
    }
    for (u32 i = 1; i < assets->texture_count; i++) {
        const Texture *texture = &assets->textures[i];
        u64 width = texture->width, height = texture->height;
        for (u32 mip = 0; mip < texture->mip_count; mip++) {
            texture_bytes += 4 * width * height;
            width = MAX(width / 2, 1), height = MAX(height / 2, 1);
        }
    }
    fact_u64(facts, "models", assets->model_count - 1);
    fact_u64(facts, "meshes", assets->mesh_count - 1);
    fact_u64(facts, "mesh_triangles", triangles);
    fact_mib(facts, "mesh_bytes", mesh_bytes);
    fact_u64(facts, "textures", assets->texture_count - 1);
    fact_mib(facts, "texture_bytes", texture_bytes);
}

static void info_lights(Facts *facts, const World *world) {
    const LightTable *lights = WORLD_TABLE(world, Light, light);
    u32 kinds[3] = {0}, fixed = 0;
    for (u32 i = 0; i < lights->table.count; i++) {
        kinds[MIN(lights->kind[i], LIGHT_DIRECTIONAL)]++;
        fixed += lights->is_static[i];
    }
    fact_u64(facts, "point_lights", kinds[LIGHT_POINT]);
    fact_u64(facts, "spot_lights", kinds[LIGHT_SPOT]);
    fact_u64(facts, "directional_lights", kinds[LIGHT_DIRECTIONAL]);
    fact_u64(facts, "static_lights", fixed);
}

static void info_bounds(Facts *facts, const World *world) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    f32 lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (u32 i = 0; i < d->table.count; i++) {
        const f32 center[3] = {d->bounds_x[i], d->bounds_y[i], d->bounds_z[i]};
        if (d->bounds_radius[i] < 0.0f) continue;
        for (u32 axis = 0; axis < 3; axis++) {
            lo[axis] = MIN(lo[axis], center[axis] - d->bounds_radius[i]);
            hi[axis] = MAX(hi[axis], center[axis] + d->bounds_radius[i]);
        }
    }
    if (!(lo[0] <= hi[0])) return;
    char text[128];
    snprintf(text, sizeof text, "%.2f %.2f %.2f to %.2f %.2f %.2f m", (f64)lo[0], (f64)lo[1],
             (f64)lo[2], (f64)hi[0], (f64)hi[1], (f64)hi[2]);
    fact_text(facts, "bounds", text);
}

static void info_names(Facts *facts, const Session *session) {
    const World *world = session->world;
    const Table *cameras = world->tables[COMPONENT_camera];
    char names[1024] = "";
    for (u32 i = 0; i < cameras->count; i++) {
        const char *name = world_name(world, cameras->entity[i]);
        u64 used = strlen(names);
        if (name[0]) snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", name);
    }
    fact_text(facts, "cameras", names);
    fact_section(facts, "files");
    json_open_array(&facts->json, "files");
    for (u32 i = 0; i < session->level.file_count; i++) {
        json_text(&facts->json, NULL, session->level.files[i]);
        if (!facts->as_json) printf("  %s\n", session->level.files[i]);
    }
    json_close(&facts->json);
}

static void info_tables(Facts *facts, const World *world) {
    fact_section(facts, "components");
    json_open_object(&facts->json, "components");
    for (u32 i = 0; i < world->component_count; i++) {
        const Table *table = world->tables[i];
        json_u64(&facts->json, table->desc->name, table->count);
        if (!facts->as_json && table->count)
            printf("  %-16s %6u  %s\n", table->desc->name, table->count, table->desc->help);
    }
    json_close(&facts->json);
}

static int info_level(const char *path, const ToolCommon *common, Facts *facts) {
    Session session;
    if (!session_create(&session, tool_session())) return TOOL_ENVIRONMENT;
    bool ok = headless_load(&session, path, common);
    if (ok) {
        fact_text(facts, "level", path);
        fact_text(facts, "title", session.level.title);
        fact_u64(facts, "seed", session.level.seed);
        fact_hash(facts, "content_hash", session.level.content_hash);
        fact_hash(facts, "world_hash", world_hash(session.world));
        fact_u64(facts, "entities", session.level.entity_count);
        info_bounds(facts, session.world);
        info_lights(facts, session.world);
        info_assets(facts, &session.assets);
        info_names(facts, &session);
        info_tables(facts, session.world);
    }
    session_destroy(&session);
    return ok ? TOOL_OK : TOOL_DIFFERENT;
}

// --- captures ---

static int info_recording(const char *path, Facts *facts, Arena *arena) {
    Recording recording;
    if (!recording_read(path, arena, &recording)) return TOOL_DIFFERENT;
    const RecordingInfo *info = &recording.info;
    char text[64];
    fact_text(facts, "recording", path);
    fact_text(facts, "level", info->level);
    fact_hash(facts, "level_hash", info->level_hash);
    fact_text(facts, "build", info->build_id);
    fact_text(facts, "device", info->device);
    fact_u64(facts, "seed", info->seed);
    fact_u64(facts, "ticks", recording.tick_count);
    snprintf(text, sizeof text, "%.1f s", (f64)recording.tick_count / TICK_RATE);
    fact_text(facts, "duration", text);
    fact_u64(facts, "images", recording.image_count);
    snprintf(text, sizeof text, "%ux%u", info->width_px, info->height_px);
    fact_text(facts, "size", text);
    char word[64];
    fact_text(facts, "path", settings_word("path", info->settings.path, word, sizeof word));
    fact_hash(facts, "start_hash", recording.start_hash);
    if (recording.tick_count)
        fact_hash(facts, "end_hash", recording.world_hashes[recording.tick_count - 1]);
    return TOOL_OK;
}

// What the light manager did.
static void info_frame_lights(Facts *facts, const PacketCounts *counts) {
    fact_u64(facts, "lights_total", counts->lights_total);
    fact_u64(facts, "lights_visible", counts->lights_visible);
    fact_u64(facts, "lights_occluded", counts->lights_occluded);
    fact_u64(facts, "lights_merged", counts->lights_merged);
    fact_u64(facts, "merged_pairs", counts->lights_merged_pairs);
    fact_u64(facts, "lights_dropped", counts->lights_dropped);
    fact_u64(facts, "over_budget", counts->lights_over_budget);
    fact_u64(facts, "lights_fading", counts->lights_fading);
    fact_u64(facts, "lights_shaded", counts->lights_shaded);
}

static void info_frame_gi(Facts *facts, const Packet *packet) {
    const GiRecord *record = &packet->gi.record;
    char text[96];
    snprintf(text, sizeof text, "%ux%ux%u, %u nested, %.3g m", record->dims[0], record->dims[1],
             record->dims[2], record->dims[3], (f64)record->origin[0][3]);
    fact_text(facts, "voxels", text);
    fact_u64(facts, "voxel_instances", packet->gi_instances.count);
    fact_u64(facts, "voxel_lights", packet->gi_lights.count);
    fact_u64(facts, "traced_lights", packet->traced_lights.count);
    fact_hash(facts, "static_key", packet->gi.static_key);
    fact_hash(facts, "dynamic_key", packet->gi.dynamic_key);
    fact_hash(facts, "light_key", packet->gi.light_key);
}

static int info_frame(const char *path, Facts *facts, Arena *arena) {
    AssetStore store;
    const Packet *packet;
    if (!frame_file_read(path, arena, &store, &packet)) return TOOL_DIFFERENT;
    char text[64];
    fact_text(facts, "frame", path);
    fact_u64(facts, "tick", packet->tick);
    snprintf(text, sizeof text, "%ux%u", packet->width_px, packet->height_px);
    fact_text(facts, "size", text);
    fact_text(facts, "path", settings_word("path", packet->settings.path, text, sizeof text));
    fact_mib(facts, "packet_bytes", packet->size);
    fact_u64(facts, "instances", packet->instances.count);
    fact_u64(facts, "materials", packet->materials.count);
    fact_u64(facts, "lights", packet->lights.count ? packet->lights.count - 1 : 0);
    fact_u64(facts, "directionals", packet->directionals.count);
    fact_u64(facts, "triangles", packet->counts.triangles);
    info_frame_lights(facts, &packet->counts);
    if (packet->gi.params.enabled) info_frame_gi(facts, packet);
    info_assets(facts, &store);
    asset_store_destroy(&store);
    return TOOL_OK;
}

// --- device ---

static void info_setting(Facts *facts, const RenderSettings *defaults, const SettingDesc *desc) {
    char range[512], initial[64];
    if (desc->type == SETTING_ENUM)
        snprintf(range, sizeof range, "%s", desc->words);
    else if (desc->type == SETTING_BOOL)
        snprintf(range, sizeof range, "on off");
    else
        snprintf(range, sizeof range, "%g..%g", desc->min, desc->max);
    setting_text(defaults, desc, initial, sizeof initial);
    json_open_flat_object(&facts->json, NULL);
    json_text(&facts->json, "name", desc->name);
    json_text(&facts->json, "group", setting_group_titles[desc->group]);
    json_text(&facts->json, "default", initial);
    json_text(&facts->json, "range", range);
    json_text(&facts->json, "help", desc->help);
    json_close(&facts->json);
    if (!facts->as_json)
        printf("  %-18s %s\n  %-18s %s; default %s\n", desc->name, desc->help, "", range, initial);
}

static void info_settings(Facts *facts) {
    RenderSettings defaults = settings_default();
    fact_section(facts, "settings (--set key=value)");
    json_open_array(&facts->json, "settings");
    for (u32 group = 0; group < SETTING_GROUP_COUNT; group++) {
        fact_section(facts, setting_group_titles[group]);
        for (u32 i = 0; i < render_setting_count; i++)
            if ((u32)render_setting_descs[i].group == group)
                info_setting(facts, &defaults, &render_setting_descs[i]);
    }
    json_close(&facts->json);
}

static int info_device(const ToolCommon *common, Facts *facts) {
    fact_text(facts, "version", LUZ_VERSION);
    fact_text(facts, "build", luz_build_id);
    Gpu *gpu = headless_gpu(common);
    if (gpu) {
        const GpuInfo *info = gpu_info(gpu);
        char text[600];
        fact_text(facts, "device", info->device_name);
        snprintf(text, sizeof text, "%s %s", info->driver_name, info->driver_info);
        fact_text(facts, "driver", text);
        // VK_API_VERSION_MAJOR and so on, which only gpu/ may name.
        snprintf(text, sizeof text, "%u.%u.%u", info->api_version >> 22 & 0x7F,
                 info->api_version >> 12 & 0x3FF, info->api_version & 0xFFF);
        fact_text(facts, "vulkan", text);
        fact_text(facts, "kind", info->is_software ? "software" : "hardware");
        fact_u64(facts, "subgroup_size", info->subgroup_size);
        fact_mib(facts, "max_storage_buffer", info->max_storage_buffer_size);
        fact_u64(facts, "max_texture_side", info->max_texture_side);
        fact_u64(facts, "max_anisotropy", (u64)info->max_anisotropy);
        fact_text(facts, "timestamps", info->timestamps ? "yes" : "no");
        fact_text(facts, "rgba32f_blend", info->rgba32f_blend ? "yes" : "no");
        gpu_destroy(gpu);
    } else {
        fact_text(facts, "device", "none");
    }
    info_settings(facts);
    return gpu ? TOOL_OK : TOOL_ENVIRONMENT;
}

// --- the command ---

static int info_any(const char *path, const ToolCommon *common, Facts *facts, Arena *arena) {
    if (!path) return info_device(common, facts);
    const char *dot = strrchr(path, '.');
    if (dot && strcmp(dot, ".luzr") == 0) return info_recording(path, facts, arena);
    if (dot && strcmp(dot, ".luzf") == 0) return info_frame(path, facts, arena);
    return info_level(path, common, facts);
}

static int info_run(int argc, char **argv) {
    ToolCommon common = {0};
    const ToolSpec spec = {
        .command = "info",
        .synopsis = "[LEVEL | MODEL | RECORDING.luzr | FRAME.luzf]",
        .about = "Tells what is in a file. Without one: version, device with its limits, and all "
                 "render\n"
                 "settings.",
        .positional_max = 1,
        .examples = "  luz info data/levels/cloister.toml\n"
                    "  luz info --device NVIDIA --json\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    tool_begin(&common);
    Arena arena;
    int result = TOOL_ENVIRONMENT;
    if (arena_create(&arena, "info", INFO_ARENA_CAP)) {
        Facts facts = {.json = json_begin(), .as_json = common.json};
        json_open_object(&facts.json, NULL);
        result = info_any(positional.count ? positional.items[0] : NULL, &common, &facts, &arena);
        json_close(&facts.json);
        if (common.json && result != TOOL_DIFFERENT) json_print(&facts.json);
        json_free(&facts.json);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_info = {"info", "tell what is in a file, or what the device can do",
                               info_run};

// replay_frame.c: `luz replay FRAME.luzf`: draws one captured frame, in any path.
// Data in: a frame file, settings to change. Data out: picture, hash.
// Does not: rebuild the packet: settings that shape it (light_limit, culling, scale) stay as
// captured.
#include "replay.h"
#include <stdio.h>

#define RELIST_ARENA_CAP GIB(1)

static int draw_frame(const ReplayOptions *options, const ToolCommon *common,
                      const AssetStore *store, const Packet *packet, Split *split,
                      const Packet *other, Arena *arena, Headless *headless) {
    if (!headless_open(headless, common)) return TOOL_ENVIRONMENT;
    RenderImage image;
    if (!renderer_set_assets(headless->renderer, store)) return TOOL_ENVIRONMENT;
    if (other) {
        if (!split_draw(split, headless->renderer, packet, other, arena)) return TOOL_ENVIRONMENT;
        image = split->image;
    } else if (!renderer_warm_up_path(headless->renderer, packet) ||
               !renderer_render_image(headless->renderer, packet, arena, &image)) {
        return TOOL_ENVIRONMENT;
    }
    if (options->out &&
        !image_write_png(options->out, image.rgba, image.width_px, image.height_px, 4))
        return TOOL_ENVIRONMENT;
    char word[64];
    settings_word("path", packet->settings.path, word, sizeof word);
    u32 messages = gpu_validation_message_count(headless->gpu);
    if (common->json) {
        Json json = json_begin();
        json_open_object(&json, NULL);
        json_text(&json, "frame", options->file);
        json_text(&json, "device", headless->device);
        json_text(&json, "path", word);
        json_u64(&json, "width", image.width_px);
        json_u64(&json, "height", image.height_px);
        json_u64(&json, "tick", packet->tick);
        json_hash(&json, "image_hash", image.hash);
        if (other) split_json(split, &json);
        json_u64(&json, "validation_messages", messages);
        json_close(&json);
        json_print(&json);
        json_free(&json);
    } else if (!common->quiet) {
        printf("%s: %ux%u, tick %u, path %s, image hash %016llx\n", options->file, image.width_px,
               image.height_px, packet->tick, word, (unsigned long long)image.hash);
        if (other) split_print(split);
    }
    if (messages) return tool_fail(TOOL_DIFFERENT, "replay", "%u validation messages", messages);
    return TOOL_OK;
}

// The frame drawn in the way of these settings, alone: nothing was drawn before it.
static const Packet *make_way(const Packet *packet, const RenderSettings *settings, Arena *arena,
                              Arena *scratch) {
    Packet *copy = (Packet *)packet_relist(packet, settings, arena, scratch);
    copy->flags |= PACKET_COLD;
    return copy;
}

int replay_frame(const ReplayOptions *options, const ToolCommon *common, Arena *arena) {
    AssetStore store;
    const Packet *packet;
    if (!frame_file_read(options->file, arena, &store, &packet)) return TOOL_DIFFERENT;
    RenderSettings settings = packet->settings;
    static Split split;
    const bool is_split = options->split.ways[0] != NULL;
    Arena scratch = {0};
    int result = TOOL_USAGE;
    if (headless_settings(&settings, options->path, options->view, &options->sets) &&
        (!is_split || split_begin(&split, &options->split, &settings, "replay")) &&
        arena_create(&scratch, "lists", RELIST_ARENA_CAP)) {
        Headless headless = {0};
        const Packet *a =
            make_way(packet, is_split ? &split.settings[0] : &settings, arena, &scratch);
        const Packet *b = is_split ? make_way(packet, &split.settings[1], arena, &scratch) : NULL;
        result = draw_frame(options, common, &store, a, &split, b, arena, &headless);
        headless_close(&headless);
        arena_destroy(&scratch);
    }
    asset_store_destroy(&store);
    return result;
}

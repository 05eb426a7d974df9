// replay.c: `luz replay`: plays a recording headless, as fast as it goes, and checks every tick.
// Data in: a .luzr (or .luzf: replay_frame.c), the level that it names. Data out: equal, or the
// first tick, table, column and row that differ; pictures of what differs. Does not: draw
// HUDs: pictures of a recording that had one differ.
#include "../engine/base/file.h"
#include "../engine/base/log.h"
#include "../engine/capture/image_compare.h"
#include "replay.h"
#include <stdio.h>
#include <string.h>

#define REPLAY_ARENA_CAP GIB(8)

typedef struct Replay {
    ReplayOptions options;
    ToolCommon common;
    Recording recording;
    Session session;
    Headless headless;
    SessionView view;
    bool draws, compares; // pictures at all; with the recorded hashes
    const char *note;     // why pictures are not compared
    u32 ticks_done, images_done, images_different;
    RecordingDifference difference; // text "" = none
    u64 image_hash;
} Replay;

// --- pictures ---

// Whether pictures are drawn and compared, and why not.
static int plan_images(Replay *replay) {
    const ReplayOptions *o = &replay->options;
    const RecordingInfo *info = &replay->recording.info;
    bool changed = o->path || o->view || o->preset || o->sets.count;
    bool wanted = replay->recording.image_count > 0 && !o->no_images;
    if (!wanted && !o->out) return TOOL_OK;
    if (!headless_open(&replay->headless, &replay->common)) {
        if (o->images || o->out) return TOOL_ENVIRONMENT;
        replay->note = "pictures are not checked: no GPU";
        return TOOL_OK;
    }
    char device[sizeof info->device];
    snprintf(device, sizeof device, "%.127s", replay->headless.device);
    if (wanted && changed)
        replay->note = "pictures are not checked: other settings than recorded";
    else if (wanted && strcmp(device, info->device) != 0 && !o->images)
        replay->note = "pictures are not checked: recorded on another device (--images forces it)";
    else
        replay->compares = wanted;
    replay->draws = replay->compares || o->out;
    return TOOL_OK;
}

// Recorded thumbnail, the same of now, and their difference side by side.
static bool write_thumbnails(const char *path, const u8 *recorded, const RenderImage *image,
                             Arena *arena) {
    enum { W = THUMBNAIL_WIDTH, H = THUMBNAIL_HEIGHT };
    u8 *now = arena_push(arena, W * H * 3, 16);
    image_reduce(image->rgba, image->width_px, image->height_px, now, W, H);
    u8 *strip = arena_push(arena, 3 * W * H * 3, 16);
    for (u32 y = 0; y < H; y++)
        for (u32 x = 0; x < W * 3; x++) {
            u64 from = ((u64)y * W + x / 3) * 3 + x % 3;
            u8 *row = strip + (u64)y * W * 9;
            i32 difference = ((i32)now[from] - (i32)recorded[from]) * 8;
            row[x] = recorded[from];
            row[W * 3 + x] = now[from];
            row[W * 6 + x] = (u8)CLAMP(difference < 0 ? -difference : difference, 0, 255);
        }
    return image_write_png(path, strip, W * 3, H, 3);
}

static bool write_difference(const Replay *replay, const RecordedImage *recorded,
                             const RenderImage *image, Arena *arena) {
    char path[4096];
    const char *directory = replay->options.diff;
    if (!file_make_directories(directory)) return false;
    snprintf(path, sizeof path, "%s/tick_%06u_now.png", directory, recorded->tick);
    if (!image_write_png(path, image->rgba, image->width_px, image->height_px, 4)) return false;
    snprintf(path, sizeof path, "%s/tick_%06u_recorded_now_difference.png", directory,
             recorded->tick);
    return write_thumbnails(path, recorded->thumbnail, image, arena);
}

static bool draw(Replay *replay, RenderImage *image) {
    session_frame_begin(&replay->session);
    const Packet *packet = session_packet(&replay->session, &replay->view);
    return packet &&
           renderer_render_image(replay->headless.renderer, packet, &replay->session.frame, image);
}

static int check_image(Replay *replay, u32 index) {
    const RecordedImage *recorded = &replay->recording.images[index];
    const u32 *shard = replay->options.shard;
    if (index % shard[1] != shard[0] - 1) return TOOL_OK;
    RenderImage image;
    if (!draw(replay, &image)) return TOOL_ENVIRONMENT;
    replay->images_done++;
    if (image.hash == recorded->hash) return TOOL_OK;
    if (replay->images_different++ == 0)
        snprintf(
            replay->difference.text, sizeof replay->difference.text,
            "tick %u: the world is equal, the picture differs (hash %016llx, recorded %016llx)",
            recorded->tick, (unsigned long long)image.hash, (unsigned long long)recorded->hash);
    replay->difference.tick = recorded->tick;
    replay->difference.row = ROW_NONE;
    if (replay->options.diff && !write_difference(replay, recorded, &image, &replay->session.frame))
        return TOOL_ENVIRONMENT;
    return TOOL_OK;
}

// --- ticks ---

// Pictures that show this tick; *next is the first that was not looked at.
static int check_images(Replay *replay, u32 tick, u32 *next) {
    const Recording *recording = &replay->recording;
    int result = TOOL_OK;
    for (; *next < recording->image_count && recording->images[*next].tick == tick; (*next)++)
        if (replay->compares && result == TOOL_OK) result = check_image(replay, *next);
    return result;
}

static int replay_ticks(Replay *replay, Arena *arena) {
    const Recording *recording = &replay->recording;
    Session *session = &replay->session;
    RecordingCheck *check = recording_check_create(recording, session->world, arena);
    Progress progress = progress_begin("replay", recording->tick_count, replay->common.quiet);
    int result = TOOL_OK;
    u32 next_image = 0;
    bool equal = recording_check_tick(check, 0, session->world, &replay->difference);
    if (equal) result = check_images(replay, 0, &next_image);
    for (u32 tick = 1; equal && result == TOOL_OK && tick <= recording->tick_count; tick++) {
        session_tick(session, recording->inputs[tick - 1]);
        equal = recording_check_tick(check, tick, session->world, &replay->difference);
        if (equal) result = check_images(replay, tick, &next_image);
        replay->ticks_done = tick;
        progress_set(&progress, tick, NULL);
    }
    progress_end(&progress);
    if (result != TOOL_OK) return result;
    if (replay->options.out) {
        RenderImage image;
        if (!draw(replay, &image) ||
            !image_write_png(replay->options.out, image.rgba, image.width_px, image.height_px, 4))
            return TOOL_ENVIRONMENT;
        replay->image_hash = image.hash;
    }
    return equal && replay->images_different == 0 ? TOOL_OK : TOOL_DIFFERENT;
}

// --- result ---

static void print_json(const Replay *replay) {
    const RecordingDifference *d = &replay->difference;
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_text(&json, "recording", replay->options.file);
    json_text(&json, "level", replay->recording.info.level);
    json_bool(&json, "ok", !d->text[0]);
    json_u64(&json, "ticks", replay->recording.tick_count);
    json_u64(&json, "ticks_checked", replay->ticks_done);
    json_u64(&json, "images", replay->recording.image_count);
    json_u64(&json, "images_checked", replay->images_done);
    json_u64(&json, "images_different", replay->images_different);
    if (replay->note) json_text(&json, "note", replay->note);
    if (replay->options.out) json_hash(&json, "image_hash", replay->image_hash);
    if (d->text[0]) {
        json_open_object(&json, "difference");
        json_u64(&json, "tick", d->tick);
        json_text(&json, "table", d->table);
        json_text(&json, "column", d->column);
        if (d->row != ROW_NONE) json_u64(&json, "row", d->row);
        json_text(&json, "text", d->text);
        json_close(&json);
    }
    json_close(&json);
    json_print(&json);
    json_free(&json);
}

static void print_result(const Replay *replay) {
    if (replay->common.json) {
        print_json(replay);
        return;
    }
    if (replay->note && !replay->common.quiet) printf("%s\n", replay->note);
    if (replay->difference.text[0])
        printf("%s: differs: %s\n", replay->options.file, replay->difference.text);
    else if (!replay->common.quiet)
        printf("%s: equal, %u ticks, %u images\n", replay->options.file, replay->ticks_done,
               replay->images_done);
    if (replay->images_different > 1)
        printf("%u of %u pictures differ\n", replay->images_different, replay->images_done);
}

static int replay_recording(Replay *replay, Arena *arena) {
    const ReplayOptions *o = &replay->options;
    if (!recording_read(o->file, arena, &replay->recording)) return TOOL_DIFFERENT;
    const RecordingInfo *info = &replay->recording.info;
    const char *level = o->level ? o->level : info->level;
    if (!headless_load(&replay->session, level, &replay->common)) {
        return tool_fail(TOOL_DIFFERENT, "replay",
                         "the level '%s' of the recording cannot be loaded (--level names another)",
                         level);
    }
    if (replay->session.level.content_hash != info->level_hash)
        LOG(CAPTURE_MISMATCH, "'%s' or a file of it has changed since the recording", level);
    replay->view.settings = info->settings;
    replay->view.cold = true;
    if (o->preset && !settings_set_preset(&replay->view.settings, o->preset)) return TOOL_USAGE;
    if (!headless_settings(&replay->view.settings, o->path, o->view, &o->sets)) return TOOL_USAGE;
    u32 size[2] = {MAX(info->width_px, 1), MAX(info->height_px, 1)}, internal[2];
    headless_internal_size(&replay->view.settings, size, internal);
    replay->view.width_px = internal[0];
    replay->view.height_px = internal[1];
    int result = plan_images(replay);
    if (result != TOOL_OK) return result;
    if (replay->draws) {
        session_frame_begin(&replay->session);
        const Packet *packet = session_packet(&replay->session, &replay->view);
        if (!renderer_set_assets(replay->headless.renderer, &replay->session.assets) ||
            !renderer_warm_up_path(replay->headless.renderer, packet))
            return TOOL_ENVIRONMENT;
    }
    result = replay_ticks(replay, arena);
    if (result == TOOL_OK || result == TOOL_DIFFERENT) print_result(replay);
    u32 messages = replay->headless.gpu ? gpu_validation_message_count(replay->headless.gpu) : 0;
    if (messages) return tool_fail(TOOL_DIFFERENT, "replay", "%u validation messages", messages);
    return result;
}

// --- the command ---

static int replay_run(int argc, char **argv) {
    static Replay replay;
    replay = (Replay){.options = {.shard = {1, 1}, .split = SPLIT_OPTIONS_DEFAULT}};
    ReplayOptions *o = &replay.options;
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &o->out, "FILE", "picture of the frame, or of the last tick"},
        {"path", 'p', OPTION_TEXT, &o->path, "P", "draw with another path"},
        {"view", 0, OPTION_TEXT, &o->view, "V", "draw another view"},
        {"preset", 0, OPTION_TEXT, &o->preset, "NAME", headless_preset_help()},
        {"set", 0, OPTION_LIST, &o->sets, "KEY=VALUE", "another render setting, repeatable"},
        SPLIT_TOOL_OPTIONS(o->split),
        {"level", 0, OPTION_TEXT, &o->level, "LEVEL",
         "play this level instead of the recorded one"},
        {"images", 0, OPTION_FLAG, &o->images, NULL, "check pictures on any device"},
        {"no-images", 0, OPTION_FLAG, &o->no_images, NULL, "check the world only (needs no GPU)"},
        {"diff", 0, OPTION_TEXT, &o->diff, "DIR", "write pictures that differ there"},
        {"shard", 0, OPTION_SHARD, &o->shard, "I/N",
         "check only every Nth picture, from the Ith on"},
    };
    const ToolSpec spec = {
        .command = "replay",
        .synopsis = "RECORDING.luzr | FRAME.luzf [options]",
        .about =
            "Plays a recording without a window and compares the world after every tick, and the\n"
            "pictures if they were made on the same device. Names the first tick, table, column\n"
            "and row that differ. A frame file is drawn, in any path.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = 1,
        .examples = "  luz replay walk.luzr\n"
                    "  luz replay walk.luzr --images --diff out/diff --shard 2/4\n"
                    "  luz replay frame.luzf --path forward -o frame.png\n"
                    "  luz replay frame.luzf --split forward deferred -o split.png\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &replay.common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (o->images && o->no_images)
        return tool_fail(TOOL_USAGE, "replay", "--images and --no-images contradict each other");
    o->file = positional.items[0];
    const char *dot = strrchr(o->file, '.');
    bool is_frame = dot && strcmp(dot, ".luzf") == 0;
    if (o->split.mode && !o->split.ways[0])
        return tool_fail(TOOL_USAGE, "replay", "--split-mode goes with --split A B");
    if (o->preset && is_frame)
        return tool_fail(TOOL_USAGE, "replay", "--preset is for recordings: a frame is what it is");
    if (o->split.ways[0] && !is_frame)
        return tool_fail(TOOL_USAGE, "replay", "--split is for frames (.luzf)");
    tool_begin(&replay.common);
    int result = TOOL_ENVIRONMENT;
    Arena arena;
    if (arena_create(&arena, "replay", REPLAY_ARENA_CAP)) {
        if (is_frame)
            result = replay_frame(o, &replay.common, &arena);
        else if (session_create(&replay.session, tool_session()))
            result = replay_recording(&replay, &arena);
        headless_close(&replay.headless);
        session_destroy(&replay.session);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_replay = {"replay", "verify a recording, or draw a captured frame",
                                 replay_run};

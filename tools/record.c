// record.c: `luz record`: a recording made without a window, by a script of inputs.
// Data in: a level, a script. Data out: a .luzr file. Does not: know HUDs: its pictures have none.
#include "../engine/base/log.h"
#include "../engine/capture/capture.h"
#include "headless.h"
#include "script.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define RECORD_ARENA_CAP GIB(1)

typedef struct RecordOptions {
    const char *out, *script, *path, *preset;
    f64 seconds;
    u32 size[2], image_every, seed;
    ToolList sets;
} RecordOptions;

typedef struct Record {
    RecordOptions options;
    ToolCommon common;
    const char *level;
    Session session;
    Headless headless;
    SessionView view;
    Script script;
    u32 tick_count;
} Record;

static RecordingInfo record_info(const Record *record) {
    const Session *session = &record->session;
    RecordingInfo info = {.level_hash = session->level.content_hash,
                          .seed = session->world->seed,
                          .width_px = record->options.size[0],
                          .height_px = record->options.size[1],
                          .settings = record->view.settings};
    snprintf(info.level, sizeof info.level, "%s", record->level);
    snprintf(info.build_id, sizeof info.build_id, "%s", luz_build_id);
    snprintf(info.device, sizeof info.device, "%.127s", record->headless.device);
    return info;
}

static bool record_image(Record *record, RecordingWriter *writer, u32 tick, bool *warm) {
    session_frame_begin(&record->session);
    const Packet *packet = session_packet(&record->session, &record->view);
    if (!*warm && !renderer_warm_up_path(record->headless.renderer, packet)) return false;
    *warm = true;
    RenderImage image;
    if (!renderer_render_image(record->headless.renderer, packet, &record->session.frame, &image))
        return false;
    recording_writer_image(writer, tick, image.hash, image.rgba, image.width_px, image.height_px);
    return true;
}

static int record_ticks(Record *record) {
    Session *session = &record->session;
    RecordingInfo info = record_info(record);
    RecordingWriter *writer = recording_writer_create(&info, session->world);
    Progress progress = progress_begin("recording", record->tick_count, record->common.quiet);
    bool ok = true, warm = false;
    u32 every = record->options.image_every;
    for (u32 tick = 1; ok && tick <= record->tick_count; tick++) {
        Input input = script_input(&record->script, tick - 1);
        session_tick(session, input);
        recording_writer_tick(writer, input, session->world);
        if (every && tick % every == 0) ok = record_image(record, writer, tick, &warm);
        progress_set(&progress, tick, NULL);
    }
    progress_end(&progress);
    if (!ok) {
        recording_writer_cancel(writer);
        return TOOL_ENVIRONMENT;
    }
    if (!recording_writer_finish(writer, record->options.out)) return TOOL_ENVIRONMENT;
    u32 images = every ? record->tick_count / every : 0;
    u64 hash = world_hash(session->world);
    if (record->common.json) {
        Json json = json_begin();
        json_open_object(&json, NULL);
        json_text(&json, "recording", record->options.out);
        json_u64(&json, "ticks", record->tick_count);
        json_u64(&json, "images", images);
        json_hash(&json, "world_hash", hash);
        json_close(&json);
        json_print(&json);
        json_free(&json);
    } else if (!record->common.quiet) {
        printf("%s: %u ticks, %u images, world hash %016llx\n", record->options.out,
               record->tick_count, images, (unsigned long long)hash);
    }
    return TOOL_OK;
}

static int record_level(Record *record, Arena *arena) {
    const RecordOptions *o = &record->options;
    if (strlen(record->level) >= sizeof((RecordingInfo *)0)->level)
        return tool_fail(TOOL_USAGE, "record", "the level's path is too long");
    if (!script_load(&record->script, o->script, o->seed, arena)) return TOOL_DIFFERENT;
    f64 ticks = record->script.tick_count ? record->script.tick_count : 20 * TICK_RATE;
    if (o->seconds != 0.0) ticks = floor(o->seconds * TICK_RATE + 0.5);
    if (ticks < 1.0 || ticks > RECORDING_TICKS_MAX)
        return tool_fail(TOOL_USAGE, "record", "--seconds must be from one tick to four hours");
    record->tick_count = (u32)ticks;
    if (!headless_load(&record->session, record->level, &record->common)) return TOOL_DIFFERENT;
    u32 internal[2];
    headless_internal_size(&record->view.settings, o->size, internal);
    record->view.width_px = internal[0];
    record->view.height_px = internal[1];
    if (o->image_every) {
        if (!headless_open(&record->headless, &record->common))
            return tool_fail(TOOL_ENVIRONMENT, "record",
                             "no device for pictures; --image-every 0 records without");
        if (!renderer_set_assets(record->headless.renderer, &record->session.assets))
            return TOOL_ENVIRONMENT;
    }
    return record_ticks(record);
}

static int record_run(int argc, char **argv) {
    static Record record;
    record =
        (Record){.options = {.script = "walk", .size = {640, 360}, .image_every = 120, .seed = 1},
                 .view = {.settings = settings_default(), .cold = true}};
    RecordOptions *o = &record.options;
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &o->out, "FILE", "the recording (.luzr)"},
        {"script", 0, OPTION_TEXT, &o->script, "S",
         "\"walk\" (default), or a text of lines \"TICKS WORD...\":\n"
         "forward back left right up down [=0..127], turn= pitch=\n"
         "(degrees a second), run jump fly use fire; # comments"},
        {"seconds", 0, OPTION_F64, &o->seconds, "S", "length; default: the script's, or 20"},
        {"seed", 0, OPTION_U32, &o->seed, "N", "of the walk, default 1"},
        {"image-every", 0, OPTION_U32, &o->image_every, "N",
         "hash and thumbnail of every Nth tick's picture,\ndefault 120; 0 = none (needs no GPU)"},
        {"size", 's', OPTION_SIZE, &o->size, "WxH", "of the pictures, default 640x360"},
        {"path", 'p', OPTION_TEXT, &o->path, "P", "forward, deferred or tiled_deferred"},
        {"preset", 0, OPTION_TEXT, &o->preset, "NAME", headless_preset_help()},
        {"set", 0, OPTION_LIST, &o->sets, "KEY=VALUE", "a render setting, repeatable"},
    };
    const ToolSpec spec = {
        .command = "record",
        .synopsis = "LEVEL -o OUT.luzr [options]",
        .about =
            "Plays a level by a script and records it: inputs, a hash of the world after every\n"
            "tick, pictures now and then. `luz replay` verifies it.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = 1,
        .examples = "  luz record data/levels/cloister.toml -o walk.luzr --seconds 20\n"
                    "  luz record level.toml -o path.luzr --script path.txt --image-every 0\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &record.common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (!o->out) return tool_fail(TOOL_USAGE, "record", "-o FILE.luzr is missing");
    if (o->preset && !settings_set_preset(&record.view.settings, o->preset)) return TOOL_USAGE;
    if (!headless_settings(&record.view.settings, o->path, NULL, &o->sets)) return TOOL_USAGE;
    record.level = positional.items[0];
    tool_begin(&record.common);
    int result = TOOL_ENVIRONMENT;
    Arena arena;
    if (arena_create(&arena, "record", RECORD_ARENA_CAP)) {
        if (session_create(&record.session, tool_session())) result = record_level(&record, &arena);
        headless_close(&record.headless);
        session_destroy(&record.session);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_record = {"record", "play a level by a script and record it", record_run};

// reference.c: `luz reference`: a level as a path tracer on the CPU sees it.
// Data in: a level, camera, settings, ticks. Data out: a PNG of the same size, exposure and tone
// mapping as `luz shot` writes, to be compared with `luz compare`. Does not: need a GPU.
#include "reference.h"
#include "../engine/base/clock.h"
#include "headless.h"
#include <stdio.h>
#include <string.h>

#define REFERENCE_ARENA_CAP GIB(32)
#define BOUNCES_MAX         64
#define SAMPLES_MAX         (1u << 20)

typedef struct ReferenceOptions {
    const char *out, *camera, *shadows;
    u32 size[2], tick, samples, bounces, seed;
    f64 sky, ambient, largest;
    bool smooth, diffuse_only;
    ToolList sets;
} ReferenceOptions;

static void show_progress(void *user, u32 done, u32 total) {
    Progress *progress = user;
    progress->total = total;
    progress_set(progress, done, NULL);
}

// The word's place among words separated by blanks, UINT32_MAX = not there.
static u32 find_word(const char *words, const char *word) {
    u64 length = strlen(word);
    for (u32 i = 0; *words; i++) {
        u64 here = strcspn(words, " ");
        if (here == length && strncmp(words, word, length) == 0) return i;
        words += here + (words[here] == ' ');
    }
    return UINT32_MAX;
}

static int draw_level(const ReferenceOptions *o, const char *level, const ToolCommon *common,
                      SessionView *view, TraceOptions *options, Session *session) {
    if (!headless_load(session, level, common)) return TOOL_DIFFERENT;
    u32 internal[2];
    headless_internal_size(&view->settings, o->size, internal);
    view->camera = headless_camera(session, o->camera);
    view->width_px = internal[0];
    view->height_px = internal[1];
    session_advance(session, o->tick);
    const GiTable *gi = WORLD_TABLE(session->world, Gi, gi);
    if (o->sky < 0.0) options->sky = gi->table.count ? gi->sky[0] : 0.0f;
    const PostTable *posts = WORLD_TABLE(session->world, Post, post);
    for (u32 i = 0; i < posts->table.count && !common->quiet; i++)
        if (posts->kind[i] <= POST_HEAT && view->settings.post) {
            fprintf(stderr, "luz reference: the level's fog and heat are left out; draw the other "
                            "picture with --set post=off\n");
            break;
        }
    Arena arena;
    if (!arena_create(&arena, "reference", REFERENCE_ARENA_CAP)) return TOOL_ENVIRONMENT;
    RenderImage image = {0};
    f64 start_ms = clock_now_ms();
    int result = TOOL_USAGE; // no such camera: said by the session
    Progress progress = progress_begin("tracing", 1, common->quiet);
    bool drawn = reference_draw(session, view, options, show_progress, &progress, &arena, &image);
    progress_end(&progress);
    if (drawn) {
        result = TOOL_OK;
        if (!image_write_png(o->out, image.rgba, image.width_px, image.height_px, 4))
            result = TOOL_ENVIRONMENT;
    }
    if (result == TOOL_OK && common->json) {
        Json json = json_begin();
        json_open_object(&json, NULL);
        json_text(&json, "picture", o->out);
        json_u64(&json, "samples", options->samples);
        json_u64(&json, "bounces", options->bounces);
        json_f64(&json, "seconds", (clock_now_ms() - start_ms) / 1000.0);
        json_hash(&json, "image_hash", image.hash);
        json_close(&json);
        json_print(&json);
        json_free(&json);
    } else if (result == TOOL_OK && !common->quiet) {
        printf("%s: %ux%u, tick %u, %u samples, %u bounces, %.1f s, image hash %016llx\n", o->out,
               image.width_px, image.height_px, o->tick, options->samples, options->bounces,
               (clock_now_ms() - start_ms) / 1000.0, (unsigned long long)image.hash);
    }
    arena_destroy(&arena);
    return result;
}

static int reference_run(int argc, char **argv) {
    static Session session;
    ToolCommon common = {0};
    TraceOptions trace = TRACE_OPTIONS_DEFAULT;
    SessionView view = {.settings = settings_default()};
    ReferenceOptions o = {.size = {640, 360},
                          .samples = trace.samples,
                          .bounces = trace.bounces,
                          .seed = (u32)trace.seed,
                          .sky = -1.0,
                          .ambient = -1.0,
                          .shadows = "level"};
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &o.out, "FILE", "the picture (PNG)"},
        {"size", 's', OPTION_SIZE, &o.size, "WxH", "default 640x360"},
        {"camera", 'c', OPTION_TEXT, &o.camera, "NAME",
         "default: \"main\", else the first, else the player"},
        {"tick", 0, OPTION_U32, &o.tick, "N", "simulate N ticks (1/60 s) first"},
        {"samples", 'n', OPTION_U32, &o.samples, "N", "paths a pixel, default 64"},
        {"bounces", 'b', OPTION_U32, &o.bounces, "B",
         "surfaces that light visits beside the one that is seen, default 8;\n"
         "0 = direct light, without what shining surfaces give"},
        {"shadows", 0, OPTION_TEXT, &o.shadows, "WORD",
         "level (as its lights say for the engine; default), all, none"},
        {"sky", 0, OPTION_F64, &o.sky, "X",
         "factor on the sky's light, default: the level's gi.sky"},
        {"ambient", 0, OPTION_F64, &o.ambient, "X",
         "factor on constant ambient light, default: 1 with --bounces 0, else 0"},
        {"diffuse", 0, OPTION_FLAG, &o.diffuse_only, NULL,
         "light bounces by diffuse lobes alone; highlights of lamps stay"},
        {"smooth", 0, OPTION_FLAG, &o.smooth, NULL,
         "paths are spread over a pixel; else through its middle, as raster"},
        {"largest", 0, OPTION_F64, &o.largest, "X", "cut off samples brighter than this; 0 = none"},
        {"seed", 0, OPTION_U32, &o.seed, "N", "of the random numbers"},
        {"set", 0, OPTION_LIST, &o.sets, "KEY=VALUE", "a render setting, repeatable"},
    };
    const ToolSpec spec = {
        .command = "reference",
        .synopsis = "LEVEL -o OUT.png [options]",
        .about = "Draws a level by tracing paths on the CPU: what the engine's global illumination "
                 "is\ncompared with. Materials, lamps, exposure and tone mapping are the engine's "
                 "own. The same\noptions give the same bits on every run.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = 1,
        .examples = "  luz reference data/levels/cornell.toml -o ref.png --samples 256\n"
                    "  luz shot data/levels/cornell.toml -o gi.png --size 640x360\n"
                    "  luz compare ref.png gi.png --ssim 0.9\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (!o.out) return tool_fail(TOOL_USAGE, "reference", "nothing to write: give -o FILE");
    u32 shadows = find_word(TRACE_SHADOW_WORDS, o.shadows);
    if (shadows == UINT32_MAX)
        return tool_fail(TOOL_USAGE, "reference",
                         "option '--shadows' expects one of: " TRACE_SHADOW_WORDS);
    if (o.bounces > BOUNCES_MAX || o.samples < 1 || o.samples > SAMPLES_MAX)
        return tool_fail(TOOL_USAGE, "reference", "at most %u bounces; 1 to %u samples",
                         BOUNCES_MAX, SAMPLES_MAX);
    if (!headless_settings(&view.settings, NULL, NULL, &o.sets)) return TOOL_USAGE;
    trace.samples = o.samples;
    trace.bounces = o.bounces;
    trace.shadows = (TraceShadows)shadows;
    trace.sky = (f32)MAX(o.sky, 0.0);
    trace.ambient = o.ambient >= 0.0 ? (f32)o.ambient : o.bounces == 0 ? 1.0f : 0.0f;
    trace.largest = (f32)o.largest;
    trace.specular = !o.diffuse_only;
    trace.smooth = o.smooth;
    trace.seed = o.seed;
    tool_begin(&common);
    int result = TOOL_ENVIRONMENT;
    if (session_create(&session, tool_session()))
        result = draw_level(&o, positional.items[0], &common, &view, &trace, &session);
    session_destroy(&session);
    tool_end();
    return result;
}

const ToolCommand tool_reference = {"reference", "draw a level by tracing paths on the CPU",
                                    reference_run};

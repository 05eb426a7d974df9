// includes.c: the arrows between the rooms only point down, checked on every source file.
// Data in: the sources below engine/, game/ and tools/, as text. Data out: one line for each
// include that should not be there. Called by: the runner. Does not: preprocess; an include counts
// also where an #if hides it.
#include "../test.h"
#include "../../engine/base/file.h"
#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

// The design's table: who may use whom, with what those use in turn spelt out. Two rows go beyond
// it, still downwards: systems/ needs meshes (bounds, collision), capture/ packs them into frame
// files. shaders/shared.h is limits and layouts without code: whoever draws may have it.
enum {
    BASE = 1 << 0,
    WORLD = 1 << 1,
    ASSET = 1 << 2,
    FRAME = 1 << 3,
    GPU = 1 << 4,
    LEVEL = 1 << 5,
    SYSTEMS = 1 << 6,
    RENDER = 1 << 7,
    CAPTURE = 1 << 8,
    APP = 1 << 9,
    FACE = 1 << 10,   // engine/luz.h
    SHARED = 1 << 11, // shaders/shared.h, which is C and GLSL
    GAME = 1 << 12,
    TOOLS = 1 << 13,
    GENERATORS = 1 << 14, // tools that stand alone
    ENGINE = BASE | WORLD | ASSET | FRAME | GPU | LEVEL | SYSTEMS | RENDER | CAPTURE | APP | SHARED,
};

typedef struct Room {
    const char *folder;
    u32 id, may_use;
} Room;

static const Room rooms[] = {
    {"engine/base", BASE, 0},
    {"engine/world", WORLD, BASE},
    {"engine/asset", ASSET, BASE | SHARED},
    {"engine/frame", FRAME, BASE | SHARED},
    {"engine/gpu", GPU, BASE | SHARED},
    {"engine/level", LEVEL, WORLD | ASSET | BASE | SHARED},
    {"engine/systems", SYSTEMS, WORLD | FRAME | ASSET | BASE | SHARED},
    {"engine/render", RENDER, FRAME | ASSET | GPU | BASE | SHARED},
    {"engine/capture", CAPTURE, FRAME | WORLD | ASSET | BASE | SHARED},
    {"engine/app", APP, ENGINE & ~APP},
    {"engine", FACE, ENGINE}, // files directly in engine/
    {"shaders", SHARED, 0},
    {"game", GAME, FACE},
    {"tools", TOOLS, ENGINE | FACE},
    {"tools/make_assets", GENERATORS, 0},
};

// Libraries that one room hides from the others. A prefix of the name between <> or "".
static const struct {
    const char *prefix;
    u32 rooms;
} libraries[] = {
    {"vulkan/", GPU},   {"volk.h", GPU}, {"vk_mem_alloc.h", GPU}, {"glslang/", GPU},
    {"GLFW/", APP},     {"imgui", APP},  {"tiny_gltf.h", ASSET},  {"glm/", ASSET},
    {"toml++/", LEVEL}, {"cglm/", BASE},
};

static const char *const cpp_files[] = {"engine/asset/gltf.cpp", "engine/app/debug_ui.cpp",
                                        "engine/gpu/shader_compile.cpp"};

typedef struct Report {
    u32 files, includes, problems, level_cpp_files;
    bool quiet; // the self-test wants numbers, not lines
    char last[1024];
} Report;

static void report_problem(Report *report, const char *path, u32 line, const char *text) {
    report->problems++;
    snprintf(report->last, sizeof report->last, "%.300s:%u: %.600s", path, line, text);
    if (!report->quiet) print_error("%s\n", report->last);
}

static bool has_prefix(const char *text, const char *prefix) {
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

// The room with the longest folder that holds the path; NULL for none. A path in a folder of
// engine/ that is no room has none: engine/ itself takes only files.
static const Room *room_of(const char *path) {
    const Room *best = NULL;
    for (u32 i = 0; i < COUNT_OF(rooms); i++) {
        u64 length = strlen(rooms[i].folder);
        if (has_prefix(path, rooms[i].folder) && path[length] == '/' &&
            (!best || length > strlen(best->folder)))
            best = &rooms[i];
    }
    if (best && best->id == FACE && strchr(path + strlen("engine/"), '/')) return NULL;
    return best;
}

// "engine/world/a.h" + "../base/b.h" -> "engine/base/b.h". False if it leaves the repository.
static bool resolve(const char *from, const char *name, char *out, u64 out_cap) {
    char text[1024];
    const char *slash = strrchr(from, '/');
    snprintf(text, sizeof text, "%.*s/%s", slash ? (int)(slash - from) : 0, from, name);
    out[0] = 0;
    char *state = NULL;
    for (char *part = strtok_r(text, "/", &state); part; part = strtok_r(NULL, "/", &state)) {
        if (strcmp(part, ".") == 0) continue;
        if (strcmp(part, "..") == 0) {
            char *last = strrchr(out, '/');
            if (!out[0]) return false;
            *(last ? last : out) = 0;
            continue;
        }
        u64 used = strlen(out);
        if (used + strlen(part) + 2 > out_cap) return false;
        snprintf(out + used, out_cap - used, "%s%s", used ? "/" : "", part);
    }
    return true;
}

// "base/log.h" or <engine/luz.h>: a name that only an -I flag could find.
static bool is_rootless(const char *name) {
    for (u32 i = 0; i < COUNT_OF(rooms); i++) {
        const char *folder = rooms[i].folder, *slash = strchr(folder, '/');
        const char *names[2] = {folder, slash ? slash + 1 : folder};
        for (u32 k = 0; k < 2; k++)
            if (has_prefix(name, names[k]) && name[strlen(names[k])] == '/') return true;
    }
    return false;
}

static void check_include(Report *report, const char *path, u32 line, const char *name,
                          bool quoted) {
    const Room *room = room_of(path);
    char text[512];
    report->includes++;
    for (u32 i = 0; i < COUNT_OF(libraries); i++) {
        if (!has_prefix(name, libraries[i].prefix) || (libraries[i].rooms & room->id)) continue;
        snprintf(text, sizeof text, "%s may not include <%.300s>", room->folder, name);
        report_problem(report, path, line, text);
        return;
    }
    // Only luz.h and luz.c lie where a folder's name is the relative path.
    if (is_rootless(name) && !(quoted && room->id == FACE)) {
        snprintf(text, sizeof text, "write \"%.300s\" relative to this file", name);
        report_problem(report, path, line, text);
        return;
    }
    if (!quoted) return; // any other library
    char target[1024];
    const Room *used = resolve(path, name, target, sizeof target) ? room_of(target) : NULL;
    bool allowed = used && (used == room || (used->id & room->may_use));
    if (used && used->id == FACE && strcmp(target, "engine/luz.h") != 0) allowed = used == room;
    if (used && used->id == SHARED && strcmp(target, "shaders/shared.h") != 0) allowed = false;
    if (allowed) return;
    snprintf(text, sizeof text, "%s may not include \"%.300s\"", room->folder, name);
    report_problem(report, path, line, text);
}

static void check_text(Report *report, const char *path, const char *text) {
    report->files++;
    if (!room_of(path)) {
        report_problem(report, path, 1, "lies in no room");
        return;
    }
    for (u32 line = 1; text[0]; line++) {
        const char *at = text + strspn(text, " \t");
        u64 length = strcspn(text, "\n");
        if (at[0] == '#') {
            at++;
            at += strspn(at, " \t");
            if (has_prefix(at, "include")) {
                at += strlen("include");
                at += strspn(at, " \t");
                char name[512], close = at[0] == '<' ? '>' : '"';
                u64 end = at[0] == '<' || at[0] == '"' ? strcspn(at + 1, "<>\"\n") : 0;
                if (end == 0 || at[1 + end] != close || end >= sizeof name) {
                    report_problem(report, path, line, "an include that this test cannot read");
                } else {
                    snprintf(name, sizeof name, "%.*s", (int)end, at + 1);
                    check_include(report, path, line, name, close == '"');
                }
            }
        }
        text += length + (text[length] == '\n');
    }
}

// C++ only where a library forces it: the named files, and one of level/'s choice.
static void check_language(Report *report, const char *path) {
    const char *dot = strrchr(path, '.');
    static const char *const cpp_endings[] = {".cpp", ".cc", ".cxx", ".hpp", ".hh", ".inl"};
    bool is_cpp = false;
    for (u32 i = 0; i < COUNT_OF(cpp_endings); i++)
        if (dot && strcmp(dot, cpp_endings[i]) == 0) is_cpp = true;
    if (!is_cpp) return;
    for (u32 i = 0; i < COUNT_OF(cpp_files); i++)
        if (strcmp(path, cpp_files[i]) == 0) return;
    if (has_prefix(path, "engine/level/") && strcmp(dot, ".cpp") == 0 &&
        ++report->level_cpp_files == 1)
        return;
    report_problem(report, path, 1, "C++ is for the files that a library forces");
}

static void check_folder(Report *report, Arena *arena, const char *folder) {
    DIR *directory = opendir(folder);
    if (!directory) fail_msg("cannot read %s: is the working directory the repository?", folder);
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (entry->d_name[0] == '.') continue;
        char path[1024];
        struct stat info;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        assert_int_equal(lstat(path, &info), 0);
        if (S_ISDIR(info.st_mode)) check_folder(report, arena, path);
        const char *dot = strrchr(entry->d_name, '.');
        if (!S_ISREG(info.st_mode) || !dot) continue;
        check_language(report, path);
        if (dot[1] != 'c' && dot[1] != 'h') continue; // .c .cpp .h
        u64 mark = arena_mark(arena);
        Bytes text;
        assert_true(file_read(path, MIB(16), arena, &text));
        check_text(report, path, text.data);
        arena_rewind(arena, mark);
    }
    closedir(directory);
}

TEST(includes, point_down_the_table) {
    Arena arena;
    Report report = {0};
    assert_true(arena_create(&arena, "sources", MIB(32)));
    check_folder(&report, &arena, "engine");
    check_folder(&report, &arena, "game");
    check_folder(&report, &arena, "tools");
    arena_destroy(&arena);
    assert_true(report.files >= 30 && report.includes >= 100); // it did look
    assert_int_equal(report.problems, 0);
}

// ---- the scanner itself, on made-up text ----

static u32 problems_of(const char *path, const char *text) {
    Report report = {.quiet = true};
    check_text(&report, path, text);
    return report.problems;
}

TEST(includes, scanner_accepts_what_the_table_allows) {
    static const char *const good[][2] = {
        {"engine/base/a.c", "#include \"a.h\"\n#include <stdio.h>\n#include <cglm/mat4.h>\n"},
        {"engine/world/a.c", "#include \"../base/log.h\"\n#include \"./table.h\"\n"},
        {"engine/gpu/a.h", "#include <vulkan/vulkan.h>\n  #  include <volk.h>"},
        {"engine/systems/a.c", "#include \"../world/world.h\"\n#include \"../frame/packet.h\"\n"},
        {"engine/asset/a.h", "#include \"../../shaders/shared.h\"\n"},
        {"engine/app/a.c", "#include <GLFW/glfw3.h>\n#include \"../render/render.h\"\n"},
        {"engine/luz.h", "#include \"app/app.h\"\n#include \"base/log.h\"\n"},
        {"tools/a.c", "#include \"../engine/luz.h\"\n#include \"../engine/gpu/gpu.h\"\n"},
        {"tools/make_assets/a.c", "#include \"glb.h\"\n"},
        {"game/a.c", "#include \"../engine/luz.h\"\n#include \"door.h\"\n"},
        {"game/a.c", "// #include \"../engine/gpu/gpu.h\"\nconst char *s = \"#include <volk.h>\";"},
        {"game/a.c", ""},
    };
    for (u32 i = 0; i < COUNT_OF(good); i++)
        if (problems_of(good[i][0], good[i][1]) != 0) fail_msg("%s: %s", good[i][0], good[i][1]);
}

TEST(includes, scanner_refuses_arrows_that_point_up) {
    static const char *const bad[][2] = {
        {"engine/base/a.c", "#include \"../world/world.h\"\n"},
        {"engine/base/a.c", "#include \"../../shaders/shared.h\"\n"},
        {"engine/world/a.c", "int x;\n#include \"../asset/asset.h\"\n"},
        {"engine/frame/a.c", "#include \"../world/world.h\"\n"},
        {"engine/render/a.c", "#include \"../world/world.h\"\n"},
        {"engine/render/a.c", "\t# include\t<vulkan/vulkan.h>\n"},
        {"engine/render/a.c", "#include \"volk.h\"\n"},
        {"engine/capture/a.c", "#include \"../render/render.h\"\n"},
        {"engine/gpu/a.c", "#include \"../asset/asset.h\"\n"},
        {"engine/gpu/a.c", "#include <GLFW/glfw3.h>"},
        {"engine/systems/a.c", "#include \"../systems/../level/level.h\"\n"},
        {"engine/app/a.c", "#include \"../luz.h\"\n"},
        {"engine/luz.c", "#include \"../game/door.h\"\n"},
        {"engine/luz.c", "#include <volk.h>\n"},
        {"engine/app/a.c", "#include \"../../game/door.h\"\n"},
        {"engine/app/a.c", "#include \"../../tools/tool.h\"\n"},
        {"engine/app/a.c", "#include \"../../shaders/pbr.glsl\"\n"},
        {"game/a.c", "#include \"../engine/world/world.h\"\n"},
        {"game/a.c", "#include \"../engine/luz.c\"\n"},
        {"game/a.c", "#include \"../engine/base/../luz_internal.h\"\n"},
        {"game/a.c", "#include <engine/luz.h>\n"},
        {"game/a.c", "#include \"world/world.h\"\n"},
        {"game/a.c", "#include \"../../../elsewhere.h\"\n"},
        {"game/a.c", "#include \"../tests/test.h\"\n"},
        {"game/a.c", "#include HEADER\n"},
        {"game/a.c", "#include \"../engine/luz.h>\n"},
        {"tools/make_assets/a.c", "#include \"../tool.h\"\n"},
        {"engine/attic/a.c", "int x;\n"}, // a folder that is no room
    };
    for (u32 i = 0; i < COUNT_OF(bad); i++)
        if (problems_of(bad[i][0], bad[i][1]) != 1) fail_msg("%s: %s", bad[i][0], bad[i][1]);
    Report report = {.quiet = true};
    check_text(&report, "game/a.c", "\n\n#include <volk.h>\n#include <volk.h>\n");
    assert_int_equal(report.problems, 2);
    assert_string_equal(report.last, "game/a.c:4: game may not include <volk.h>");
}

TEST(includes, scanner_knows_where_cpp_may_be) {
    static const struct {
        const char *path;
        u32 problems;
    } cases[] = {
        {"engine/base/a.c", 0},
        {"engine/base/a.cpp", 1},
        {"engine/asset/gltf.cpp", 0},
        {"engine/asset/other.cpp", 1},
        {"engine/level/toml.cpp", 0},
        {"engine/level/parse.cpp", 0},
        {"engine/level/parse.cc", 1},
        {"engine/app/debug_ui.cpp", 0},
        {"engine/gpu/shader_compile.cpp", 0},
        {"game/main.cpp", 1},
        {"tools/a.hpp", 1},
    };
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        Report report = {.quiet = true};
        check_language(&report, cases[i].path);
        assert_int_equal(report.problems, cases[i].problems);
    }
    Report report = {.quiet = true};
    check_language(&report, "engine/level/toml.cpp");
    check_language(&report, "engine/level/second.cpp");
    assert_int_equal(report.problems, 1); // one is enough
}

// level_errors.c: levels with mistakes: each is found, at its place, in one run.
#include "level_common.h"
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct Mistake {
    const char *text; // of the line's mistake
    u32 line, column;
    const char *message; // part of it
    const char *hint;    // part of it, or NULL
} Mistake;

// Every line's expected place is written by hand: the test would not notice a wrong one otherwise.
static const char many_mistakes[] =
    /*  1 */ "[levle]\n"
             /*  2 */ "[level]\n"
             /*  3 */ "titel = \"x\"\n"
             /*  4 */ "seed = 1.5\n"
             /*  5 */ "[environment]\n"
             /*  6 */ "ambient = \"#12345\"\n"
             /*  7 */ "exposure = -1\n"
             /*  8 */ "attenuation = \"inverse_squared\"\n"
             /*  9 */ "shadow_size = 8192\n"
             /* 10 */ "[[model]]\n"
             /* 11 */ "name = \"ball\"\n"
             /* 12 */ "shape = \"shpere\"\n"
             /* 13 */ "[[model]]\n"
             /* 14 */ "name = \"ball\"\n"
             /* 15 */ "shape = \"cube\"\n"
             /* 16 */ "[[model]]\n"
             /* 17 */ "name = \"away\"\n"
             /* 18 */ "file = \"../secret.glb\"\n"
             /* 19 */ "[[model]]\n"
             /* 20 */ "name = \"none\"\n"
             /* 21 */ "file = \"models/none.glb\"\n"
             /* 22 */ "[[model]]\n"
             /* 23 */ "name = \"empty\"\n"
             /* 24 */ "[[material]]\n"
             /* 25 */ "albedo = [0.5, 0.5]\n"
             /* 26 */ "[[material]]\n"
             /* 27 */ "name = \"m\"\n"
             /* 28 */ "albedo_texture = \"none.png\"\n"
             /* 29 */ "albedo = [0.5, 2, 0.5]\n"
             /* 30 */ "double_sided = 1\n"
             /* 31 */ "[[prefab]]\n"
             /* 32 */ "name = \"p\"\n"
             /* 33 */ "[[prefab.entity]]\n"
             /* 34 */ "name = \"root\"\n"
             /* 35 */ "[[prefab.entity]]\n"
             /* 36 */ "parent = \"rot\"\n"
             /* 37 */ "[[prefab.entity]]\n"
             /* 38 */ "prefab = \"p\"\n"
             /* 39 */ "[[entity]]\n"
             /* 40 */ "name = \"a\"\n"
             /* 41 */ "light = { intensty = 5, kind = \"spto\" }\n"
             /* 42 */ "transform.position = \"here\"\n"
             /* 43 */ "transform.rotation = [1, 2, 3, 4]\n"
             /* 44 */ "lihgt.range = 3\n"
             /* 45 */ "instance.model = \"bal\"\n"
             /* 46 */ "prefab = \"q\"\n"
             /* 47 */ "parent = \"b\"\n"
             /* 48 */ "[[entity]]\n"
             /* 49 */ "name = \"a\"\n"
             /* 50 */ "parent = \"nobody\"\n"
             /* 51 */ "door = { lamp = \"c\", lock = 101, offset = \"x\" }\n"
             /* 52 */ "[[entity]]\n"
             /* 53 */ "name = \"b\"\n"
             /* 54 */ "parent = \"a\"\n"
             /* 55 */ "repeat = { row = { count = 0, step = [1, 0, 0] }, rng = {} }\n"
             /* 56 */ "[[entity]]\n"
             /* 57 */ "name = \"c\"\n"
             /* 58 */ "repeat.ring = { count = 3 }\n"
             /* 59 */ "vary = { light.color = { chose = [] }, orbit.phase = { min = 9, max = 1 } "
             "}\n"
             /* 60 */ "position = [0, 0, 0]\n"
             /* 61 */ "walker = true\n"
             /* 62 */ "environment = {}\n"
             /* 63 */ "light.color = \"é\"  \n"
             /* 64 */ "path.points = [[0, 0, 0], [1, 2]]\n";

static const Mistake mistakes[] = {
    {"", 1, 2, "unknown table 'levle'", "did you mean 'level'?"},
    {"", 3, 1, "unknown key 'titel' of level", "did you mean 'title'?"},
    {"", 4, 8, "level.seed: expected an integer, got a number", NULL},
    {"", 6, 11, "environment.ambient: '#12345' is not a colour", "#rrggbb"},
    {"", 7, 12, "environment.exposure: -1 is out of range 0 to 1000", NULL},
    {"", 8, 15, "'inverse_squared' is not one of inverse_square, window, polynomial",
     "did you mean 'inverse_square'?"},
    {"", 9, 15, "environment.shadow_size: 8192 is out of range 64 to 4096", NULL},
    {"", 12, 9, "there is no shape 'shpere'", "did you mean 'sphere'?"},
    {"", 14, 8, "a model is already named 'ball' (line 11)", NULL},
    {"", 18, 8, "model.file: '../secret.glb' leaves the data root", "data root"},
    {"", 21, 8, "model.file: 'models/none.glb' below ", NULL},
    {"", 22, 1, "neither file nor shape", "write"},
    {"", 24, 1, "the material has no name", NULL},
    {"", 25, 10, "material.albedo: expected 3 numbers, got 2", NULL},
    {"", 28, 18, "material.albedo_texture: 'none.png' below ", NULL},
    {"", 29, 16, "material.albedo: 2 is out of range 0 to 1", NULL},
    {"", 30, 16, "material.double_sided: expected true or false, got an integer", NULL},
    {"", 36, 10, "no entity of this prefab is named 'rot'", "did you mean 'root'?"},
    {"", 38, 10, "prefab 'p' contains itself", NULL},
    {"", 41, 11, "unknown key 'intensty' of light", "did you mean 'intensity'?"},
    {"", 41, 32, "light.kind: 'spto' is not one of point, spot, directional",
     "did you mean 'spot'?"},
    {"", 42, 22, "transform.position: expected a list of 3 numbers, got a string", NULL},
    {"", 43, 22, "transform.rotation: expected 3 numbers, got 4", NULL},
    {"", 44, 1, "unknown component 'lihgt'", "did you mean 'light'?"},
    {"", 45, 18, "no model is named 'bal'", "did you mean 'ball'?"},
    {"", 46, 10, "no prefab is named 'q'", "did you mean 'p'?"},
    {"", 49, 8, "an entity is already named 'a' (line 40)", NULL},
    {"", 50, 10, "no entity is named 'nobody'", NULL},
    {"", 54, 10, "'a' makes a circle of parents", NULL},
    {"", 51, 29, "door.lock: 101 is out of range 0 to 100", NULL},
    {"", 51, 43, "door.offset: expected an integer, got a string", NULL},
    {"", 55, 28, "row.count: 0 is out of range 1 to 200000", NULL},
    {"", 55, 51, "unknown key 'rng' of repeat", "did you mean 'ring'?"},
    {"", 58, 8, "ring needs 'radius'", NULL},
    {"", 59, 26, "unknown key 'chose' of vary.light.color", "did you mean 'choose'?"},
    {"", 59, 16, "light.color: needs 'choose', or 'min' and 'max'", NULL},
    {"", 59, 62, "orbit.phase: min 9 is above max 1", NULL},
    {"", 60, 1, "unknown component 'position'", "did you mean 'transform.position'?"},
    {"", 61, 10, "walker: expected a table", "walker = {}"},
    {"", 62, 1, "an entity cannot have 'environment'", "at the top"},
    {"", 63, 15, "light.color: 'é' is not a colour", NULL},
    {"", 64, 27, "path.points: expected 3 numbers, got 2", NULL},
};

static const Diagnostic *find(const Diagnostics *diagnostics, const Mistake *mistake) {
    for (u32 i = 0; i < diagnostics->count; i++) {
        const Diagnostic *d = &diagnostics->items[i];
        if (d->line == mistake->line && d->column == mistake->column &&
            strstr(d->text, mistake->message))
            return d;
    }
    return NULL;
}

TEST(level, all_mistakes_are_found_at_their_places) {
    TestLevel level;
    test_level_load(&level, many_mistakes);
    assert_false(level.is_good);
    u32 missed = 0;
    for (u32 i = 0; i < COUNT_OF(mistakes); i++) {
        const Diagnostic *d = find(level.diagnostics, &mistakes[i]);
        if (d && d->is_error && (!mistakes[i].hint || strstr(d->hint, mistakes[i].hint))) continue;
        fprintf(stderr, "missed: %u:%u %s\n", mistakes[i].line, mistakes[i].column,
                mistakes[i].message);
        missed++;
    }
    if (missed || level.diagnostics->error_count != COUNT_OF(mistakes))
        diagnostics_print(level.diagnostics, stderr);
    assert_int_equal(missed, 0);
    assert_int_equal(level.diagnostics->error_count, COUNT_OF(mistakes)); // and nothing else
    for (u32 i = 1; i < level.diagnostics->count; i++)
        assert_true(level.diagnostics->items[i - 1].line <= level.diagnostics->items[i].line);
    test_level_close(&level);
}

// One mistake a level: what the long list cannot hold at the same time.
static const Mistake single[] = {
    {"[level]\nseed = 1\nseed = 2\n", 3, 8, "cannot redefine", NULL},
    {"x = [1,\n", 1, 8, "end-of-file", NULL},
    {"[[entity]]\nlight = { kind = \"spot\", }\n", 2, 26, "dangling comma", NULL},
    {"[entity]\nname = \"x\"\n", 1, 2, "entity: expected a list of tables, got a table",
     "[[entity]]"},
    {"[light]\n", 1, 2, "unknown table 'light'", "[[entity]]"},
    {"[[environment]]\n", 1, 1, "environment: expected a table, got a list", NULL},
    {"entity = [1]\n", 1, 11, "entity: expected a table, got an integer", NULL},
    {"[[entity]]\nname = \"\"\n", 2, 8, "name must not be empty", NULL},
    {"[[entity]]\nname = \"a\"\nparent = \"a\"\n", 3, 10, "circle of parents", NULL},
    {"[[entity]]\nlight.intensity = nan\n", 2, 19, "light.intensity: the number is not finite",
     NULL},
    {"[[entity]]\nlight.intensity = 1e60\n", 2, 19, "not finite", NULL},
    {"[[entity]]\ndoor.lock = 1.0\n", 2, 13, "door.lock: expected an integer", NULL},
    {"[[entity]]\ndoor.lamp = \"q\"\n[[entity]]\nname = \"q\"\n", 2, 13, "entity 'q' has no light",
     NULL},
    {"[[entity]]\nname = \"a.1\"\n[[entity]]\nname = \"a\"\nrepeat.row = { count = 2, step = [0, "
     "0, "
     "1] }\n",
     4, 8, "an entity is already named 'a.1' (line 2)", NULL},
    {"[[entity]]\nrepeat.grid = { count = [100, 100, 100], step = [1, 1, 1] }\n", 2, 25,
     "grid.count: 1000000 copies, the limit is 200000", NULL},
    {"[[entity]]\nrepeat = [{ row = { count = 1000, step = [0, 0, 1] } }, { row = { count = 1000, "
     "step = [0, 1, 0] } }]\n",
     2, 1, "repeat: 1000000 copies, the limit is 200000", NULL},
    {"[[entity]]\nrepeat.row = { count = 150000, step = [0, 0, 1] }\n[[entity]]\nrepeat.row = { "
     "count = 150000, step = [0, 0, 1] }\n",
     4, 1, "the level has 300000 entities, the limit is 200000", NULL},
    {"[[entity]]\nrepeat.scatter = { count = 2, min = [0, 1, 0], max = [1, 0, 1] }\n", 2, 8,
     "scatter: min is above max", NULL},
    {"[[entity]]\nvary.instance.model = { min = 1, max = 2 }\n", 2, 25, "only numbers have a range",
     "choose"},
    {"[[entity]]\nvary.camera.fov = { choose = [50, 500] }\n", 2, 35, "out of range 5 to 150",
     NULL},
    {"[[entity]]\nvary.camera.fov = 3\n", 2, 19, "vary.camera.fov: expected a table", "min"},
    {"[[prefab]]\nname = \"p\"\n", 1, 1, "the prefab has no entity", "[[prefab.entity]]"},
    {"[[prefab]]\nname = \"p\"\n[[prefab.entity]]\nparent = \"x\"\n", 4, 1,
     "the root of a prefab cannot have 'parent'", NULL},
    {"[[prefab]]\nname = \"p\"\nlight = {}\n[[prefab.entity]]\n", 3, 1,
     "unknown key 'light' of prefab", "[[prefab.entity]]"},
    {"[[prefab]]\nname = \"p\"\n[[prefab.entity]]\n[[prefab.entity]]\nprefab = \"r\"\n"
     "[[prefab]]\nname = \"r\"\n[[prefab.entity]]\nprefab = \"p\"\n",
     9, 10, "prefab 'p' contains itself by way of 'r'", NULL},
    {"[[material]]\nname = \"no/such\"\n", 2, 8, "no model has a material 'no/such'", NULL},
    {"[[model]]\nname = \"x\"\nshape = \"cube\"\ntube = 0.1\n", 4, 1, "only a torus has a tube",
     NULL},
    {"[[model]]\nname = \"x\"\nshape = \"cube\"\nfile = \"x.glb\"\n", 3, 1,
     "a file or a shape, not both", NULL},
    {"[[entity]]\ndrawable = {}\n", 2, 1, "an entity cannot have 'drawable'", NULL},
    {"[[entity]]\nname = \"\\u0000\"\n", 2, 8, "zero character", NULL},
    {"# é\n[[entity]]\nname = \"é\"\nparent = \"ü\"\n", 4, 10, "no entity is named 'ü'",
     "did you mean 'é'?"},
    {"level = { title = \"é\", sed = 1 }\n", 1, 25, "unknown key 'sed' of level", "seed"},
};

TEST(level, single_mistakes) {
    u32 missed = 0;
    for (u32 i = 0; i < COUNT_OF(single); i++) {
        TestLevel level;
        test_level_load(&level, single[i].text);
        const Diagnostic *d = find(level.diagnostics, &single[i]);
        if (!d || !d->is_error || (single[i].hint && !strstr(d->hint, single[i].hint))) {
            fprintf(stderr, "missed: %u:%u %s\nin:\n%s\ngot:\n", single[i].line, single[i].column,
                    single[i].message, single[i].text);
            diagnostics_print(level.diagnostics, stderr);
            missed++;
        }
        test_level_close(&level);
    }
    assert_int_equal(missed, 0);
}

TEST(level, diagnostics_print_source_caret_and_hint) {
    TestLevel level;
    test_level_load(&level, "[[entity]]\n\tlight = { intensty = 5 }\n");
    char text[512], expected[512];
    diagnostic_format(&level.diagnostics->items[0], text, sizeof text);
    snprintf(expected, sizeof expected,
             "%s/test.toml:2:12: error: unknown key 'intensty' of light\n"
             "   light = { intensty = 5 }\n"
             "             ^~~~~~~~ did you mean 'intensity'?\n",
             test_temp_dir());
    assert_string_equal(text, expected);
    diagnostic_format(&level.diagnostics->items[0], text, 10); // cut, not overrun
    assert_int_equal(strlen(text), 9);
    test_level_close(&level);
}

TEST(level, caret_in_a_long_line) {
    static char text[4000];
    u32 size = (u32)snprintf(text, sizeof text, "[[entity]]\nname = \"");
    memset(text + size, 'x', 100);
    snprintf(text + size + 100, sizeof text - size - 100, "\"%400sbad = 1\n", "");
    TestLevel level;
    test_level_load(&level, text);
    const Diagnostic *d = &level.diagnostics->items[0];
    assert_false(level.is_good);
    assert_int_equal(d->line, 2);
    assert_true(strlen(d->source) <= 160);
    assert_int_equal(strncmp(d->source + d->caret, "b", 1), 0);
    test_level_close(&level);
}

TEST(level, unused_prefab_and_empty_instance_are_warnings) {
    TestLevel level;
    test_level_load(&level,
                    "[[prefab]]\nname = \"p\"\n[[prefab.entity]]\n[[entity]]\ninstance = {}\n");
    assert_true(level.is_good);
    assert_int_equal(level.diagnostics->warning_count, 2);
    assert_false(level.diagnostics->items[0].is_error);
    assert_non_null(strstr(level.diagnostics->items[0].text, "'p' is not used"));
    assert_non_null(strstr(level.diagnostics->items[1].text, "no model"));
    test_level_close(&level);
}

TEST(level, more_mistakes_than_are_stored_are_counted) {
    static char text[LEVEL_DIAGNOSTICS_MAX * 40 * 2];
    u32 size = 0;
    for (u32 i = 0; i < LEVEL_DIAGNOSTICS_MAX + 50; i++)
        size += (u32)snprintf(text + size, sizeof text - size, "[[entity]]\nbad%u = 1\n", i);
    TestLevel level;
    test_level_load(&level, text);
    assert_int_equal(level.diagnostics->count, LEVEL_DIAGNOSTICS_MAX);
    assert_int_equal(level.diagnostics->error_count, LEVEL_DIAGNOSTICS_MAX + 50);
    test_level_close(&level);
}

TEST(level, material_limit_is_named) {
    static char text[1 << 16];
    u32 size = (u32)snprintf(text, sizeof text, "[[model]]\nname = \"c\"\nshape = \"cube\"\n");
    for (u32 i = 0; i <= LEVEL_MATERIALS_MAX; i++)
        size += (u32)snprintf(text + size, sizeof text - size,
                              "[[material]]\nname = \"m%u\"\n[[entity]]\ninstance = { model = "
                              "\"c\", material = \"m%u\" }\n",
                              i, i);
    TestLevel level;
    test_level_load(&level, text);
    assert_int_equal(level.diagnostics->error_count, 1);
    assert_non_null(strstr(level.diagnostics->items[0].text, "257 materials, the limit is 256"));
    test_level_close(&level);
}

// What is wrong with a whole file has no line to show; a damaged line does no harm to a terminal.
TEST(level, diagnostics_show_only_what_there_is) {
    char text[512];
    TestLevel level;
    test_level_load_good(&level, "");
    assert_false(level_load(&level.root, "none.toml", level.world, &level.store, &level.arena,
                            &level.info, level.diagnostics));
    diagnostic_format(&level.diagnostics->items[0], text, sizeof text);
    assert_non_null(strstr(text, "none.toml: error: the level cannot be read: "));
    assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1);
    test_level_close(&level);

    static const char bytes[] = "x = '\xc3\xa4\xc2\x9b\xe2\x82' \x1b[2J\n";
    test_level_load_bytes(&level, "raw.toml", bytes, sizeof bytes - 1);
    assert_false(level.is_good);
    assert_string_equal(level.diagnostics->items[0].source, "x = '\xc3\xa4?"
                                                            "?"
                                                            "?"
                                                            "?"
                                                            "'  [2J");
    test_level_close(&level);
}

TEST(level, absent_files_and_paths_that_climb) {
    TestLevel level;
    test_level_load_good(&level, "");
    Diagnostics *d = level.diagnostics;
    assert_false(level_load(&level.root, "none.toml", level.world, &level.store, &level.arena,
                            &level.info, d));
    assert_int_equal(d->error_count, 1);
    assert_non_null(strstr(d->items[0].text, "cannot be read"));
    assert_false(level_load(&level.root, "../../../etc/passwd", level.world, &level.store,
                            &level.arena, &level.info, d));
    assert_int_equal(d->error_count, 1);
    test_level_close(&level);
    // In a key: plain, absolute, in the middle, and by a link.
    static const char *const paths[] = {"../a.png", "/etc/passwd", "x/../../a.png", "a/..",
                                        "out/passwd"};
    assert_int_equal(symlink("/etc", test_temp_path("out")), 0);
    for (u32 i = 0; i < COUNT_OF(paths); i++) {
        char text[160];
        snprintf(text, sizeof text, "[[material]]\nname = \"m\"\nalbedo_texture = \"%s\"\n",
                 paths[i]);
        test_level_load(&level, text);
        assert_false(level.is_good);
        assert_int_equal(level.diagnostics->items[0].line, 3);
        assert_non_null(strstr(level.diagnostics->items[0].text, "leaves the data root"));
        test_level_close(&level);
    }
    assert_int_equal(mkdir(test_temp_path("folder"), 0700), 0);
    test_level_load(&level, "[[model]]\nname = \"m\"\nfile = \"folder\"\n");
    assert_int_equal(level.diagnostics->error_count, 1);
    assert_non_null(strstr(level.diagnostics->items[0].text, "is a directory"));
    test_level_close(&level);
}

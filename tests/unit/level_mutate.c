// level_mutate.c: a few thousand damaged levels: each loads or is refused with diagnostics, nothing
// else. Same text, same verdict; formatting what parses keeps its verdict. Fixed seed, so a failure
// repeats.
#include "level_common.h"
#include "../../engine/base/log.h"
#include "../../engine/base/random.h"
#include "../../engine/level/level_format.h"
#include <stdio.h>
#include <unistd.h>

static const char seed_text[] =
    "[level]\nseed = 7\ntitle = \"T\"\n[environment]\nambient = \"#0b1020\"\n"
    "[[model]]\nname = \"ball\"\nshape = \"cube\"\n"
    "[[material]]\nname = \"brass\"\nalbedo = [0.4, 0.3, 0.1]\n[[material]]\nname = "
    "\"ball/cube\"\npower = 3\n"
    "[[prefab]]\nname = \"lamp\"\n[[prefab.entity]]\ninstance.model = \"ball\"\n"
    "[[prefab.entity]]\nname = \"glow\"\nlight = { color = \"#fa4\", intensity = 5 }\n"
    "[[prefab.entity]]\nparent = \"glow\"\nprefab = \"bulb\"\n"
    "[[prefab]]\nname = \"bulb\"\n[[prefab.entity]]\nflicker = {}\n"
    "[[entity]]\nname = \"a\"\nprefab = \"lamp\"\nparent = \"b\"\n"
    "repeat = [{ ring = { count = 4, radius = 5 } }, { row = { count = 2, step = [1, 0, 0] } }]\n"
    "vary = { transform.scale = { min = 0.5, max = 2 }, light.kind = { choose = [\"spot\"] } }\n"
    "[[entity]]\nname = \"b\"\ninstance = { model = \"ball\", material = \"brass\" }\n"
    "repeat.scatter = { count = 3, seed = 1, min = [0, 0, 0], max = [1, 1, 1] }\n"
    "[[entity]]\nname = \"c\"\nparent = \"a.1\"\npath.points = [[0, 0, 0], [1, 2, 3]]\n"
    "repeat.grid = { count = [2, 1, 2], step = [1, 1, 1] }\n";

static const char *const words[] = {
    "\"",     "[",      "]",      "{",    "}",     "=",        ".",        "\n",    "#",    "'",
    "\"\"\"", "[[",     "]]",     "0",    "-1",    "1e9",      "nan",      "true",  "é",    "\\",
    "entity", "prefab", "parent", "name", "\"a\"", "\"lamp\"", "\"bulb\"", "count", "99999"};

typedef struct Mutant {
    char *text;
    u32 size, cap, round, counter;
} Mutant;

static u32 draw(Mutant *m, u32 below) { return random_u32(42, m->round, m->counter++) % below; }

// Puts `with` in the place of [at, at + size).
static void replace(Mutant *m, u32 at, u32 size, const char *with, u32 with_size) {
    char copy[256];
    with_size = MIN(with_size, (u32)sizeof copy);
    if (m->size - size + with_size >= m->cap) return;
    memcpy(copy, with, with_size); // it may lie in the text itself
    memmove(m->text + at + with_size, m->text + at + size, m->size - at - size);
    memcpy(m->text + at, copy, with_size);
    m->size = m->size - size + with_size;
}

// A word or number at or behind a place, or a line: where it begins and its length.
static u32 find_run(const Mutant *m, u32 at, bool is_line, u32 *size) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";
    while (is_line && at > 0 && m->text[at - 1] != '\n') at--;
    while (!is_line && at > 0 && m->text[at] && strchr(letters, m->text[at])) at--;
    while (!is_line && at < m->size && !(m->text[at] && strchr(letters, m->text[at]))) at++;
    u32 end = at;
    while (is_line ? end < m->size && m->text[end] != '\n'
                   : end < m->size && m->text[end] && strchr(letters, m->text[end]))
        end++;
    *size = MIN(end + is_line, m->size) - at;
    return at;
}

// One damaged copy: 1 or 2 edits: a byte changed, a piece removed, something put in; a word put in
// the place of another (mistakes of meaning, in good syntax); a line removed or moved.
static u32 mutate(u32 round, char *out, u32 cap) {
    Mutant m = {.text = out, .size = sizeof seed_text - 1, .cap = cap - 1, .round = round};
    memcpy(out, seed_text, m.size);
    u32 edits = 1 + draw(&m, 2);
    for (u32 i = 0; i < edits && m.size > 1; i++) {
        u32 at = draw(&m, m.size), from = draw(&m, m.size), length = 1 + draw(&m, 12);
        u32 size, from_size;
        const char *word = words[draw(&m, COUNT_OF(words))];
        switch (draw(&m, 8)) {
        case 0:
            m.text[at] = (char)draw(&m, 256);
            break;
        case 1:
            replace(&m, at, MIN(length, m.size - at), "", 0);
            break;
        case 2:
            replace(&m, at, 0, word, (u32)strlen(word));
            break;
        case 3:
            at = find_run(&m, at, true, &size);
            replace(&m, at, size, "", 0);
            break;
        case 4:
            at = find_run(&m, at, true, &size);
            from = find_run(&m, from, true, &from_size);
            replace(&m, at, 0, m.text + from, from_size);
            break;
        default:
            at = find_run(&m, at, false, &size);
            from = find_run(&m, from, false, &from_size);
            replace(&m, at, size, m.text + from, from_size);
        }
    }
    out[m.size] = 0;
    return m.size;
}

// A new file each time, without file_write's care: writing thousands over each other, the file
// system would wait for the disk.
static void write_plain(const char *text, u64 size) {
    unlink(test_temp_path("m.toml"));
    FILE *file = fopen(test_temp_path("m.toml"), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    fclose(file);
}

TEST(level, survives_mutations) {
    static char text[8192];
    static Diagnostics diagnostics;
    Arena arena;
    AssetStore store;
    FileRoot root;
    log_set_level(LOG_SEVERITY_NONE);
    assert_true(arena_create(&arena, "test", GIB(1)) && asset_store_create(&store));
    assert_true(file_root_open(&root, test_temp_dir()));
    u32 good = 0, bad = 0, meaning = 0;
    for (u32 round = 0; round < 2000; round++) {
        u32 size = mutate(round, text, sizeof text);
        write_plain(text, size);
        World *world = test_level_world();
        LevelInfo info;
        bool is_good = level_load(&root, "m.toml", world, &store, &arena, &info, &diagnostics);
        assert_int_equal(is_good, diagnostics.error_count == 0);
        world_check(world);
        for (u32 i = 0; i < diagnostics.count; i++) {
            char line[1024];
            diagnostic_format(&diagnostics.items[i], line, sizeof line);
            assert_true(diagnostics.items[i].line >= 1 && diagnostics.items[i].column >= 1);
        }
        good += is_good;
        bad += !is_good;
        meaning += !is_good && world->tables[COMPONENT_environment]->count > 0;
        world_destroy(world);
        arena_reset(&arena);
    }
    fprintf(stderr, "%u good, %u bad, %u of them beyond the syntax\n", good, bad, meaning);
    // Both kinds must be there, or the test tests nothing.
    assert_true(good > 50 && bad > 1000 && meaning > 500);
    file_root_close(&root);
    asset_store_destroy(&store);
    arena_destroy(&arena);
}

TEST(level, formatting_mutations_keeps_their_verdict) {
    static char text[8192];
    static Diagnostics diagnostics;
    Arena arena;
    AssetStore store;
    FileRoot root;
    log_set_level(LOG_SEVERITY_NONE);
    assert_true(arena_create(&arena, "test", GIB(2)) && asset_store_create(&store));
    assert_true(file_root_open(&root, test_temp_dir()));
    u32 compared = 0;
    for (u32 round = 5000; round < 5600; round++) {
        mutate(round, text, sizeof text);
        const char *out, *again;
        arena_reset(&arena);
        if (strlen(text) == 0 || !level_format_text(text, &arena, &out)) continue;
        assert_true(level_format_text(out, &arena, &again));
        assert_string_equal(out, again);
        u64 hashes[2];
        u32 errors[2];
        for (u32 i = 0; i < 2; i++) {
            const char *version = i ? out : text;
            write_plain(version, strlen(version));
            World *world = test_level_world();
            LevelInfo info;
            level_load(&root, "m.toml", world, &store, &arena, &info, &diagnostics);
            errors[i] = diagnostics.error_count;
            hashes[i] = world_hash(world);
            world_destroy(world);
        }
        assert_int_equal(errors[0], errors[1]);
        assert_true(hashes[0] == hashes[1]);
        compared++;
    }
    assert_true(compared > 100);
    file_root_close(&root);
    asset_store_destroy(&store);
    arena_destroy(&arena);
}

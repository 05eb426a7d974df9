// level_format.c: `luz fmt`: what it changes, and that it changes nothing else.
#include "level_common.h"
#include "../../engine/level/level_format.h"
#include "../../engine/level/toml.h"
#include <stdio.h>

static void expect(const char *text, const char *expected) {
    Arena arena;
    assert_true(arena_create(&arena, "test", GIB(1)));
    const char *out, *again;
    assert_true(level_format_text(text, &arena, &out));
    assert_string_equal(out, expected);
    assert_true(level_format_text(out, &arena, &again));
    assert_string_equal(out, again);
    arena_destroy(&arena);
}

TEST(level_format, spaces_indentation_and_blank_lines) {
    expect("", "");
    expect("\n\n\n", "");
    expect("\n\n  a=1\n\n\n\n b  =  2   \n\n", "a = 1\n\nb = 2\n");
    expect("a=1", "a = 1\n");
    expect("a=1\r\nb=2\r\n", "a = 1\nb = 2\n");
    expect("[ level ]\nx . \"y z\" . w=1\n[[ e . f ]]\n[[e.f]]\n",
           "[level]\nx.\"y z\".w = 1\n\n[[e.f]]\n\n[[e.f]]\n");
    expect("a={b=1,c=[ 1,2 ,[3]],d={},e=[{f='x'}]}\n",
           "a = { b = 1, c = [1, 2, [3]], d = {}, e = [{ f = 'x' }] }\n");
    expect("a = [\n1,\n  # c\n\n\n[2,\n3],\n]\n",
           "a = [\n    1,\n    # c\n\n    [2,\n        3],\n]\n");
    expect("t = 1979-05-27 07:32:00\nf = -1.5e+3\n", "t = 1979-05-27 07:32:00\nf = -1.5e+3\n");
}

TEST(level_format, comments_stay_with_what_they_belong_to) {
    expect("# top\n# more\n[level]   \nseed=1# s\n# of the entity\n[[entity]]  # e\n",
           "# top\n# more\n[level]\nseed = 1 # s\n\n# of the entity\n[[entity]]  # e\n");
    expect("[a]\n# lone\n\n[b]\n", "[a]\n# lone\n\n[b]\n");
    expect("[a]\nb = 1   # column\nc = 22  # column\n",
           "[a]\nb = 1   # column\nc = 22  # column\n");
    expect("   # only\n", "# only\n");
}

TEST(level_format, strings_are_untouched) {
    static const char text[] =
        "a = \"  =  # [ \\\" \"\nb = '  \\'\nc = \"\"\"\n  x = [ \n\n\n  \\\"\"\" \"\"\"\n"
        "d = '''\n  # no comment  \n'''\n\"=#\" = 1\n";
    expect(text, text);
}

TEST(level_format, refuses_what_is_not_toml) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    const char *out = "x";
    static const char *const bad[] = {"a = ",      "[",     "a = 1\na = 2\n",
                                      "a = [1,\n", "é = 1", "a b = 1"};
    for (u32 i = 0; i < COUNT_OF(bad); i++) {
        assert_false(level_format_text(bad[i], &arena, &out));
        assert_null(out);
    }
    arena_destroy(&arena);
}

static void expect_equal(const TomlNode *a, const TomlNode *b) {
    assert_int_equal(a->type, b->type);
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->key != NULL, b->key != NULL);
    if (a->key) assert_string_equal(a->key, b->key);
    if (a->type == TOML_STRING) assert_string_equal(a->string, b->string);
    if (a->type == TOML_INTEGER) assert_true(a->integer == b->integer);
    if (a->type == TOML_FLOAT) assert_memory_equal(&a->number, &b->number, sizeof a->number);
    if (a->type == TOML_BOOLEAN) assert_int_equal(a->boolean, b->boolean);
    if (a->type != TOML_ARRAY && a->type != TOML_TABLE) return;
    const TomlNode *x = a->first, *y = b->first;
    for (; x && y; x = x->next, y = y->next) expect_equal(x, y);
    assert_true(!x && !y);
}

// Text with random space where TOML allows it: same tree after formatting, same text whatever it
// was.
TEST(level_format, keeps_the_meaning_of_scrambled_text) {
    static const char *const tokens[] = {"# c\n",
                                         "[",
                                         "a",
                                         "]",
                                         "\n",
                                         "k",
                                         "=",
                                         "{",
                                         "x",
                                         ".",
                                         "y",
                                         "=",
                                         "1",
                                         ",",
                                         "z",
                                         "=",
                                         "[",
                                         "1.5",
                                         ",",
                                         "'q # '",
                                         ",",
                                         "[",
                                         "true",
                                         "]",
                                         "]",
                                         "}",
                                         "\n",
                                         "m",
                                         "=",
                                         "[",
                                         "{",
                                         "v",
                                         "=",
                                         "2",
                                         "}",
                                         ",",
                                         "\"\"\" a\n  b \"\"\"",
                                         "]",
                                         "\n",
                                         "[[",
                                         "l",
                                         "]]",
                                         "\n",
                                         "n",
                                         "=",
                                         "0x1F",
                                         "\n"};
    Arena arena;
    assert_true(arena_create(&arena, "test", GIB(1)));
    char *first = NULL;
    u32 random = 12345;
    for (u32 round = 0; round < 300; round++) {
        char text[1024];
        u32 size = 0;
        for (u32 i = 0; i < COUNT_OF(tokens); i++) {
            random = random * 1664525u + 1013904223u;
            static const char *const spaces[] = {"", " ", "\t", "   "};
            const char *space = round ? spaces[random >> 30] : " ";
            size += (u32)snprintf(text + size, sizeof text - size, "%s%s", space, tokens[i]);
        }
        const char *out;
        TomlNode *before, *after;
        TomlError error;
        assert_true(toml_parse(text, size, &arena, &before, &error));
        assert_true(level_format_text(text, &arena, &out));
        assert_true(toml_parse(out, strlen(out), &arena, &after, &error));
        expect_equal(before, after);
        if (!first) first = strdup(out);
        assert_string_equal(out, first);
        arena_reset(&arena);
    }
    free(first);
    arena_destroy(&arena);
}

TEST(level_format, written_levels_are_already_in_form) {
    TestLevel level;
    test_level_load_good(&level,
                         "[[model]]\nname = \"a\"\nshape = \"torus\"\n[[entity]]\nname = \"x\"\n"
                         "instance.model = \"a\"\npath.points = [[1, 2, 3]]\nwalker = {}\n");
    const char *out, *text = level_write(level.world, &level.store, &level.arena);
    assert_true(level_format_text(text, &level.arena, &out));
    assert_string_equal(out, text);
    test_level_close(&level);
}

// level_toml.c: the C face of the TOML parser: order, places, and hostile text.
#include "level_common.h"
#include "../../engine/level/suggest.h"
#include "../../engine/level/toml.h"
#include <stdio.h>

typedef struct Parsed {
    Arena arena;
    TomlNode *root;
    TomlError error;
    bool is_good;
} Parsed;

static void parse(Parsed *parsed, const char *text, u64 size) {
    memset(parsed, 0, sizeof *parsed);
    assert_true(arena_create(&parsed->arena, "toml", GIB(2)));
    parsed->is_good = toml_parse(text, size, &parsed->arena, &parsed->root, &parsed->error);
    assert_int_equal(parsed->is_good, parsed->root != NULL);
}

TEST(toml, keeps_the_order_of_the_file_and_byte_columns) {
    static const char text[] = "z = \"é\" # ü\n"
                               "a = [1, 2.5, true, \"é\", 1979-05-27]\n"
                               "t.\"é\".b = { y = 1, x = 2 }\n"
                               "s = \"\"\"\nlong\n\"\"\"\n"
                               "[[l]]\n[[l]]\nk = 1\n[c]\n";
    Parsed p;
    parse(&p, text, sizeof text - 1);
    assert_true(p.is_good);
    static const char *const keys[] = {"z", "a", "t", "s", "l", "c"};
    u32 i = 0;
    for (const TomlNode *node = p.root->first; node; node = node->next)
        assert_string_equal(node->key, keys[i++]);
    assert_int_equal(i, p.root->count);
    const TomlNode *z = toml_find(p.root, "z");
    assert_int_equal(z->place.column, 5);
    assert_int_equal(z->place.length, 4);
    assert_string_equal(z->string, "é");
    const TomlNode *a = toml_find(p.root, "a");
    assert_int_equal(a->count, 5);
    const TomlNode *date = a->first->next->next->next->next;
    assert_int_equal(date->type, TOML_DATE);
    assert_int_equal(date->place.line, 2);
    assert_int_equal(date->place.column, 26);
    const TomlNode *t = toml_find(p.root, "t");
    assert_string_equal(t->first->key, "é");
    assert_int_equal(t->first->key_place.column, 3);
    assert_int_equal(t->first->key_place.length, 4);
    assert_string_equal(t->first->first->first->key, "y");
    const TomlNode *l = toml_find(p.root, "l");
    assert_int_equal(l->count, 2);
    assert_int_equal(l->first->next->place.line, 8);
    assert_string_equal(toml_find(p.root, "s")->string, "long\n");
    assert_null(toml_find(p.root, "q"));
    arena_destroy(&p.arena);
}

static void refuse(const char *text, u64 size, const char *message) {
    Parsed p;
    parse(&p, text, size);
    if (p.is_good || !strstr(p.error.text, message))
        fprintf(stderr, "wanted '%s', got '%s'\n", message, p.error.text);
    assert_false(p.is_good);
    assert_non_null(strstr(p.error.text, message));
    assert_true(p.error.place.line >= 1 && p.error.place.column >= 1 && p.error.place.length >= 1);
    assert_int_equal(arena_mark(&p.arena), 0); // nothing stays
    arena_destroy(&p.arena);
}

static char *repeat(const char *head, const char *unit, u32 count, const char *tail, u64 *size) {
    u64 unit_size = strlen(unit), head_size = strlen(head);
    *size = head_size + unit_size * count + strlen(tail);
    char *text = malloc(*size + 1), *at = text + head_size;
    memcpy(text, head, head_size);
    for (u32 i = 0; i < count; i++, at += unit_size) memcpy(at, unit, unit_size);
    strcpy(at, tail);
    return text;
}

TEST(toml, hostile_text_is_refused) {
    refuse("a = 1\0b = 2\n", 12, "zero byte");
    refuse("# \0\n", 4, "zero byte");
    refuse("a = \"x\0y\"\n", 10, "zero byte");
    refuse("a = \"\\u0000\"\n", 13, "zero character");
    refuse("\"\\u0000\" = 1\n", 13, "zero character");
    refuse("\xC3\xA9 = 1\n", 7, "only ASCII");
    refuse("a = \"\xFF\"\n", 8, "");
    refuse("a = '''\n", 8, "");
    refuse("a = \"\\\n", 7, "");
    refuse("\x01", 1, "");
    u64 size;
    char *text = repeat("a", ".a", 1000000, " = 1\n", &size);
    refuse(text, size, "more than 32 parts");
    free(text);
    text = repeat("[a", " .a", 1000000, "]\n", &size);
    refuse(text, size, "more than 32 parts");
    free(text);
    text = repeat("[a", ".\"a\"", 40, "]\n", &size);
    refuse(text, size, "more than 32 parts");
    free(text);
    text = repeat("a = ", "[", 1000000, "", &size);
    refuse(text, size, "nested more than 64");
    free(text);
    text = repeat("a = ", "{a=", 1000000, "", &size);
    refuse(text, size, "nested more than 64");
    free(text);
    text = repeat("a = [", "1,", 2000001, "]", &size);
    refuse(text, size, "more than 2000000 values");
    free(text);
}

TEST(toml, dots_in_strings_comments_and_numbers_are_free) {
    static const char text[] =
        "# ........................................................\n"
        "a = \"........................................................\"\n"
        "b = '''\n.......................................................'''\n"
        "c = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, "
        "9.0,"
        "1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, "
        "9.0]\n"
        "d = \"\\\"[[[[\" # [[[[[[\n";
    Parsed p;
    parse(&p, text, sizeof text - 1);
    assert_true(p.is_good);
    arena_destroy(&p.arena);
}

TEST(toml, a_level_of_20_mb_is_refused) {
    u64 size;
    char *text = repeat("", "# twenty bytes here\n", 1 << 20, "", &size);
    TestLevel level;
    test_level_load_bytes(&level, "large.toml", text, size);
    assert_false(level.is_good);
    assert_int_equal(level.diagnostics->error_count, 1);
    assert_non_null(strstr(level.diagnostics->items[0].text, "cannot be read"));
    test_level_close(&level);
    free(text);
}

TEST(suggest, distance_counts_edits) {
    static const struct {
        const char *a, *b;
        u32 distance;
    } cases[] = {
        {"", "", 0},
        {"a", "", 1},
        {"light", "light", 0},
        {"lihgt", "light", 1},
        {"Light", "light", 0},
        {"ligt", "light", 1},
        {"lights", "light", 1},
        {"kitten", "sitting", 3},
        {"ca", "abc", 3},
    };
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        assert_int_equal(suggest_distance(cases[i].a, cases[i].b, 5), cases[i].distance);
        assert_int_equal(suggest_distance(cases[i].b, cases[i].a, 5), cases[i].distance);
    }
    assert_int_equal(suggest_distance("kitten", "sitting", 2), 3); // above the limit: limit + 1
}

TEST(suggest, nearest_word_wins_and_far_ones_do_not) {
    static const char *const words[] = {"position", "rotation", "scale", "range", "rate"};
    static const struct {
        const char *word, *best;
    } cases[] = {
        {"positoin", "position"}, {"rotaton", "rotation"}, {"scal", "scale"}, {"rat", "rate"},
        {"pos", "position"},      {"colour", NULL},        {"x", NULL},       {"", NULL}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        Suggestion s = suggest_begin(cases[i].word);
        for (u32 k = 0; k < COUNT_OF(words); k++) suggest_offer(&s, words[k]);
        if (cases[i].best) {
            assert_non_null(s.best);
            assert_string_equal(s.best, cases[i].best);
        } else {
            assert_null(s.best);
        }
    }
}

// tool_args.c: the option parser of the toolbox.
#include "../test.h"
#include "../../tools/args.c"
#include "../../engine/base/log.h"

typedef struct Options {
    bool flag;
    const char *text;
    u32 number, size[2], shard[2];
    f64 real;
    ToolList list;
    const char *pair[2];
} Options;

static ToolParse parse(Options *out, ToolCommon *common, ToolList *positional, int argc,
                       const char **argv) {
    *out = (Options){0};
    *common = (ToolCommon){0};
    const ToolOption options[] = {
        {"flag", 'f', OPTION_FLAG, &out->flag, NULL, "a flag"},
        {"text", 'o', OPTION_TEXT, &out->text, "T", "a text"},
        {"number", 0, OPTION_U32, &out->number, "N", "a number"},
        {"real", 0, OPTION_F64, &out->real, "X", "a real"},
        {"size", 0, OPTION_SIZE, &out->size, "WxH", "a size"},
        {"shard", 0, OPTION_SHARD, &out->shard, "I/N", "a shard"},
        {"set", 0, OPTION_LIST, &out->list, "K=V", "many"},
        {"both", 0, OPTION_PAIR, &out->pair, "A B", "two"},
    };
    const ToolSpec spec = {.command = "test",
                           .synopsis = "A [B]",
                           .about = "about",
                           .options = options,
                           .option_count = COUNT_OF(options),
                           .positional_min = 1,
                           .positional_max = 2};
    return tool_parse(&spec, argc, (char **)(uintptr_t)argv, common, positional);
}

#define PARSE(...)                                                                                 \
    parse(&o, &common, &positional, (int)COUNT_OF(((const char *[]){"test", __VA_ARGS__})),        \
          (const char *[]){"test", __VA_ARGS__, NULL})

TEST(tool_args, all_types) {
    Options o;
    ToolCommon common;
    ToolList positional;
    assert_int_equal(PARSE("a", "-f", "--text", "x y", "--number=42", "--real", "-1.5e3", "--size",
                           "640x360", "--shard", "2/3", "--set", "a=b", "--set=c=d", "b",
                           "--threads", "2", "--device=NV", "--json", "-q", "--validation"),
                     PARSE_RUN);
    assert_true(o.flag);
    assert_string_equal(o.text, "x y");
    assert_int_equal(o.number, 42);
    assert_true(o.real == -1500.0);
    assert_int_equal(o.size[0], 640);
    assert_int_equal(o.size[1], 360);
    assert_int_equal(o.shard[0], 2);
    assert_int_equal(o.shard[1], 3);
    assert_int_equal(o.list.count, 2);
    assert_string_equal(o.list.items[1], "c=d");
    assert_int_equal(positional.count, 2);
    assert_string_equal(positional.items[1], "b");
    assert_int_equal(common.threads, 2);
    assert_string_equal(common.device, "NV");
    assert_true(common.json && common.quiet && common.validation);
}

TEST(tool_args, two_values) {
    Options o;
    ToolCommon common;
    ToolList positional;
    assert_int_equal(PARSE("--both", "a=b", "c", "x"), PARSE_RUN);
    assert_string_equal(o.pair[0], "a=b");
    assert_string_equal(o.pair[1], "c");
    assert_int_equal(positional.count, 1);
    assert_int_equal(PARSE("x", "--both=a", "b", "--both", "c", "d"), PARSE_RUN);
    assert_string_equal(o.pair[0], "c");
    assert_string_equal(o.pair[1], "d");
    assert_int_equal(PARSE("x", "--both", "a"), PARSE_ERROR);
    assert_int_equal(PARSE("x", "--both=a"), PARSE_ERROR);
    assert_int_equal(PARSE("x", "--both"), PARSE_ERROR);
}

TEST(tool_args, refuses) {
    Options o;
    ToolCommon common;
    ToolList positional;
    assert_int_equal(PARSE("a", "--number"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--number", "x"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--number", "-1"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--number", "4294967296"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--number", "12x"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--number", ""), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--real", "nan"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--size", "640"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--size", "0x10"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--size", "640x99999"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--shard", "4/3"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--shard", "0/3"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--flag=1"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "--flga"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "-x"), PARSE_ERROR);
    assert_int_equal(PARSE("a", "b", "c"), PARSE_ERROR);
    assert_int_equal(PARSE("--flag"), PARSE_ERROR); // nothing positional
}

TEST(tool_args, dashes_and_help) {
    Options o;
    ToolCommon common;
    ToolList positional;
    assert_int_equal(PARSE("--", "-f", "--text"), PARSE_RUN);
    assert_string_equal(positional.items[0], "-f");
    assert_false(o.flag);
    assert_int_equal(PARSE("-"), PARSE_RUN);
    assert_string_equal(positional.items[0], "-");
    assert_int_equal(PARSE("a", "--wrong", "--help"), PARSE_HELP);
    assert_int_equal(PARSE("--", "--help"), PARSE_RUN);
}

TEST(tool_args, suggests) {
    const char *const words[] = {"shot", "replay", "compare", "info"};
    assert_string_equal(tool_suggest("shto", words, 4), "shot");
    assert_string_equal(tool_suggest("comp", words, 4), "compare");
    assert_string_equal(tool_suggest("reply", words, 4), "replay");
    assert_null(tool_suggest("xyzzy", words, 4));
}

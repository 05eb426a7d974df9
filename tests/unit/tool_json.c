// tool_json.c: the JSON writer of the toolbox.
#include "../test.h"
#include "../../tools/json.c"

static void assert_text(const char *value, const char *expected) {
    Json json = json_begin();
    json_text(&json, NULL, value);
    assert_string_equal(json.text, expected);
    json_free(&json);
}

TEST(tool_json, escapes) {
    assert_text("", "\"\"");
    assert_text("a \"b\" \\ /", "\"a \\\"b\\\" \\\\ /\"");
    assert_text("line\nand\ttab", "\"line\\nand\\ttab\"");
    assert_text("\x01\x1f\x7f", "\"\\u0001\\u001f\\u007f\"");
    assert_text("caf\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x92\xA1",
                "\"caf\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x92\xA1\"");
    // Not UTF-8: lone bytes, overlong, a surrogate, beyond the last character, cut off.
    assert_text("\xFF", "\"\xEF\xBF\xBD\"");
    assert_text("\xC0\xAF", "\"\xEF\xBF\xBD\xEF\xBF\xBD\"");
    assert_text("\xED\xA0\x80", "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"");
    assert_text("\xF4\x90\x80\x80", "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"");
    assert_text("\xE2\x82", "\"\xEF\xBF\xBD\xEF\xBF\xBD\"");
}

TEST(tool_json, structure) {
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_u64(&json, "n", 18446744073709551615ull);
    json_f64(&json, "x", 0.5);
    json_f64(&json, "inf", 1.0 / 0.0);
    json_bool(&json, "yes", true);
    json_hash(&json, "hash", 0xABCull);
    json_open_array(&json, "empty");
    json_close(&json);
    json_open_flat_array(&json, "flat");
    json_u64(&json, NULL, 1);
    json_open_object(&json, NULL);
    json_u64(&json, "a", 2);
    json_close(&json);
    json_close(&json);
    json_open_object(&json, "o");
    json_text(&json, "k", "v");
    json_close(&json);
    json_close(&json);
    assert_string_equal(json.text, "{\n"
                                   "  \"n\": 18446744073709551615,\n"
                                   "  \"x\": 0.5,\n"
                                   "  \"inf\": null,\n"
                                   "  \"yes\": true,\n"
                                   "  \"hash\": \"0000000000000abc\",\n"
                                   "  \"empty\": [],\n"
                                   "  \"flat\": [1, {\"a\": 2}],\n"
                                   "  \"o\": {\n"
                                   "    \"k\": \"v\"\n"
                                   "  }\n"
                                   "}");
    json_free(&json);
}

// tool_script.c: input scripts of `luz record`.
#include "../test.h"
#include "../../tools/script.c"

static bool load(Script *script, const char *text, Arena *arena) {
    const char *path = test_temp_path("script.txt");
    assert_true(file_write(path, text, strlen(text)));
    return script_load(script, path, 1, arena);
}

TEST(tool_script, steps) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    Script script;
    assert_true(load(&script,
                     "# a walk\n\n10 forward run # on\r\n  6 turn=90 left=64\n2 fly use jump\n",
                     &arena));
    assert_int_equal(script.tick_count, 18);
    for (u32 tick = 0; tick < 10; tick++) {
        Input input = script_input(&script, tick);
        assert_int_equal(input.move_z, 127);
        assert_int_equal(input.buttons, INPUT_RUN);
        assert_int_equal(input.look_x, 0);
    }
    i32 turned = 0;
    for (u32 tick = 10; tick < 16; tick++) {
        Input input = script_input(&script, tick);
        assert_int_equal(input.move_x, -64);
        turned += input.look_x;
    }
    assert_int_equal(turned, 900); // a tenth of a second
    assert_int_equal(script_input(&script, 16).buttons, INPUT_FLY | INPUT_USE | INPUT_JUMP);
    assert_int_equal(script_input(&script, 17).buttons, INPUT_JUMP);
    Input after = script_input(&script, 18), nothing = {0};
    assert_memory_equal(&after, &nothing, sizeof after);
    arena_destroy(&arena);
}

TEST(tool_script, odd_rates_add_up) {
    i32 sum = 0;
    for (u32 tick = 0; tick < 600; tick++) sum += look_step(-1234, tick);
    assert_int_equal(sum, -12340);
}

TEST(tool_script, mistakes) {
    static const char *const texts[] = {"",
                                        "forward\n",
                                        "0 forward\n",
                                        "-3 forward\n",
                                        "5 fwd\n",
                                        "5 turn\n",
                                        "5 run=1\n",
                                        "5 forward=200\n",
                                        "5 turn=x\n",
                                        "5 turn=1e9\n",
                                        "99999999999 forward\n"};
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    log_set_level(LOG_SEVERITY_NONE);
    Script script;
    for (u32 i = 0; i < COUNT_OF(texts); i++)
        if (load(&script, texts[i], &arena)) fail_msg("accepted: %s", texts[i]);
    char text[256];
    assert_false(load(&script, "5 forward\n5 forwrad\n", &arena));
    log_last_error(text, sizeof text);
    assert_non_null(strstr(text, "script.txt:2: unknown word 'forwrad'"));
    assert_non_null(strstr(text, "did you mean 'forward'"));
    arena_destroy(&arena);
}

TEST(tool_script, the_walk_walks) {
    Script script;
    assert_true(script_load(&script, "walk", 3, NULL));
    u32 forward = 0;
    i32 pitch = 0;
    for (u32 tick = 0; tick < 1200; tick++) {
        Input a = script_input(&script, tick), b = script_input(&script, tick);
        assert_memory_equal(&a, &b, sizeof a);
        forward += a.move_z > 0;
        pitch += a.look_y;
        assert_in_range(pitch + 2000, 0, 4000); // looks ahead, more or less
    }
    assert_in_range(forward, 600, 1200);
}

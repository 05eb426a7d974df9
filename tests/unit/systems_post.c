// systems_post.c: the post chain in a packet: its order, what each step's numbers are, what heat
// can touch.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <math.h>

static Entity add_post(SystemsFixture *f, u32 kind, i32 order, f32 x, f32 y, f32 z) {
    Entity entity = world_spawn(f->world);
    TransformTable *transforms = FIXTURE_TABLE(f, Transform, transform);
    u32 place = FIXTURE_ADD(f, transform, entity);
    transforms->x[place] = x, transforms->y[place] = y, transforms->z[place] = z;
    PostTable *posts = FIXTURE_TABLE(f, Post, post);
    u32 row = FIXTURE_ADD(f, post, entity);
    posts->kind[row] = kind;
    posts->order[row] = order;
    return entity;
}

static const Packet *packet_of(SystemsFixture *f) {
    arena_rewind(&f->arenas.frame, 0);
    systems_settle(&f->systems, &f->context);
    const Packet *packet = fixture_packet(f, ENTITY_NONE, settings_default(), 640, 360, 0);
    assert_null(packet_validate(packet, packet->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    return packet;
}

TEST(systems_post, a_level_without_any_has_tone_mapping_and_gamma) {
    SystemsFixture *f = systems_fixture_create(1);
    const Packet *packet = packet_of(f);
    const PacketPost *posts = PACKET_DATA(packet, posts, PacketPost);
    assert_int_equal(packet->posts.count, 2);
    assert_int_equal(posts[0].kind, POST_TONEMAP);
    assert_int_equal(posts[1].kind, POST_GAMMA);
    assert_true(posts[1].values[0] == 0.0f);
    systems_fixture_destroy(f);
}

TEST(systems_post, words_of_the_column_are_the_kinds) {
    const ColumnDesc *kind = &post_component.columns[0];
    assert_string_equal(kind->name, "kind");
    assert_string_equal(kind->unit, "fog heat tonemap gamma");
    assert_int_equal(kind->max, POST_KIND_COUNT - 1);
}

// Stage, then order, then row, whatever the rows' sequence.
TEST(systems_post, order) {
    for (u32 round = 0; round < 20; round++) {
        SystemsFixture *f = systems_fixture_create(1);
        u64 draw = 0;
        u32 count = 3 + random_u32(0x9057, round, draw++) % 12, expected[POST_KIND_COUNT] = {0};
        for (u32 i = 0; i < count; i++) {
            u32 kind = random_u32(0x9057, round, draw++) % POST_KIND_COUNT;
            Entity e =
                add_post(f, kind, (i32)(random_u32(0x9057, round, draw++) % 4) - 2, 0, 0, -5);
            // The row, to be found again in the packet.
            PostTable *t = FIXTURE_TABLE(f, Post, post);
            u32 row = FIXTURE_ROW(f, post, e);
            t->color_r[row] = (f32)i, t->scale[row] = (f32)(i + 1), t->gamma[row] = (f32)i;
            expected[kind]++;
        }
        const Packet *packet = packet_of(f);
        const PacketPost *posts = PACKET_DATA(packet, posts, PacketPost);
        u32 found[POST_KIND_COUNT] = {0};
        const PostTable *t = FIXTURE_TABLE(f, Post, post);
        i32 last_order = INT32_MIN;
        u32 last_stage = 0, last_row = 0;
        for (u32 i = 0; i < packet->posts.count; i++) {
            found[posts[i].kind]++;
            u32 stage = posts[i].kind <= POST_HEAT ? 0 : posts[i].kind;
            assert_true(stage >= last_stage);
            if (!expected[posts[i].kind] || posts[i].kind == POST_TONEMAP) continue;
            u32 row =
                posts[i].kind == POST_HEAT ? (u32)posts[i].values[5] - 1 : (u32)posts[i].values[0];
            if (stage != last_stage) last_order = INT32_MIN, last_stage = stage;
            assert_true(t->order[row] > last_order ||
                        (t->order[row] == last_order && row > last_row));
            last_order = t->order[row], last_row = row;
        }
        for (u32 kind = 0; kind < POST_KIND_COUNT; kind++)
            assert_int_equal(found[kind],
                             kind < POST_TONEMAP ? expected[kind] : MAX(expected[kind], 1));
        systems_fixture_destroy(f);
    }
}

TEST(systems_post, heat_is_there_only_where_it_is_seen) {
    SystemsFixture *f = systems_fixture_create(1); // the camera looks along -z from the origin
    Entity heat = add_post(f, POST_HEAT, 0, 0, 0, -10);
    PostTable *t = FIXTURE_TABLE(f, Post, post);
    u32 row = FIXTURE_ROW(f, post, heat);
    t->reach[row] = 1, t->amount[row] = 4;
    const Packet *packet = packet_of(f);
    const PacketPost *post = PACKET_DATA(packet, posts, PacketPost);
    assert_int_equal(packet->posts.count, 3);
    assert_int_equal(post->kind, POST_HEAT);
    assert_true(post->values[2] == -10.0f && post->values[3] == 1.0f);
    assert_true(post->values[4] == 2.0f); // px of 720, in a picture of 360
    // About the middle; 1 m at 10 m and 60 degrees is 31 px, and the margin 4.
    assert_true(post->values[7] > 280 && post->values[9] < 360 && post->values[9] > 350);
    assert_true(post->values[8] > 140 && post->values[10] < 220);
    TransformTable *transforms = FIXTURE_TABLE(f, Transform, transform);
    u32 place = FIXTURE_ROW(f, transform, heat);
    static const f32 unseen[][3] = {{0, 0, 10}, {30, 0, -10}, {0, -30, -10}, {0, 0, 1.2f}};
    for (u32 i = 0; i < COUNT_OF(unseen); i++) {
        transforms->x[place] = unseen[i][0];
        transforms->y[place] = unseen[i][1];
        transforms->z[place] = unseen[i][2];
        table_touch(&transforms->table, place);
        assert_int_equal(packet_of(f)->posts.count, 2);
    }
    // The camera is in it: the whole picture.
    transforms->x[place] = transforms->y[place] = transforms->z[place] = 0;
    table_touch(&transforms->table, place);
    packet = packet_of(f);
    post = PACKET_DATA(packet, posts, PacketPost);
    assert_int_equal(packet->posts.count, 3);
    assert_true(post->values[7] == 0 && post->values[8] == 0);
    assert_true(post->values[9] == 640 && post->values[10] == 360);
    systems_fixture_destroy(f);
}

TEST(systems_post, more_than_a_packet_may_hold) {
    SystemsFixture *f = systems_fixture_create(1);
    for (u32 i = 0; i < PACKET_POSTS_CAP + 5; i++) add_post(f, POST_FOG, (i32)i, 0, 0, 0);
    const Packet *packet = packet_of(f);
    const PacketPost *posts = PACKET_DATA(packet, posts, PacketPost);
    assert_int_equal(packet->posts.count, PACKET_POSTS_CAP);
    assert_int_equal(posts[PACKET_POSTS_CAP - 2].kind, POST_TONEMAP);
    assert_int_equal(posts[PACKET_POSTS_CAP - 1].kind, POST_GAMMA);
    systems_fixture_destroy(f);
}

// What comes from a file is checked.
TEST(systems_post, damaged_steps_are_refused) {
    SystemsFixture *f = systems_fixture_create(1);
    add_post(f, POST_HEAT, 0, 0, 0, -5);
    Packet *packet = (Packet *)(uintptr_t)packet_of(f);
    PacketPost *posts = PACKET_WRITE(packet, posts, PacketPost), kept = posts[0];
    const struct {
        u32 kind, index;
        f32 value;
    } damage[] = {{POST_KIND_COUNT, 0, 0}, {UINT32_MAX, 0, 0},     {POST_HEAT, 3, NAN},
                  {POST_HEAT, 7, 1e9f},    {POST_HEAT, 10, -1e9f}, {POST_FOG, 3, INFINITY}};
    for (u32 i = 0; i < COUNT_OF(damage); i++) {
        posts[0] = kept;
        posts[0].kind = damage[i].kind;
        posts[0].values[damage[i].index] = damage[i].value;
        assert_non_null(
            packet_validate(packet, packet->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    }
    posts[0] = kept;
    assert_null(packet_validate(packet, packet->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    systems_fixture_destroy(f);
}

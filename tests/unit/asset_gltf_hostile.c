// asset_gltf_hostile.c: files made to do harm are refused with a message and leave the store as it
// was; a few thousand random changes of a good file never crash.
#include "asset_fixture.h"
#include "../../engine/asset/asset_internal.h"
#include "../../engine/asset/gltf_raw.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SEED 4711

static void assert_glb_refused(AssetFixture *f, const char *json, const void *bin, u64 bin_size,
                               const char *words) {
    StoreShape before = fixture_shape(f);
    u32 id = fixture_load_glb(f, json, bin, bin_size);
    if (id) print_error("accepted: %s\n", json);
    ASSERT_REFUSED(f, before, id, words);
}

// One place of the good triangle changed, and what must be said about it.
typedef struct Change {
    const char *from, *to, *words;
} Change;

static void assert_changes_refused(const Change *changes, u32 count) {
    AssetFixture *f = fixture_open();
    for (u32 i = 0; i < count; i++)
        assert_glb_refused(f, fixture_replace(TRIANGLE_JSON, changes[i].from, changes[i].to),
                           &triangle_bin, sizeof triangle_bin, changes[i].words);
    fixture_close(f);
}

#define VIEW0 "{\"buffer\":0,\"byteLength\":36}"
#define ACC0  "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define ACC1  "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}"

TEST(asset_gltf_hostile, views_and_buffers) {
    static const Change changes[] = {
        {VIEW0, "{\"buffer\":7,\"byteLength\":36}", "bufferView 0: there is no buffer 7"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":45}", "beyond buffer 0"},
        {VIEW0, "{\"buffer\":0,\"byteOffset\":40,\"byteLength\":36}", "beyond buffer 0"},
        {VIEW0, "{\"buffer\":0,\"byteOffset\":4294967295,\"byteLength\":36}", "beyond buffer 0"},
        {VIEW0, "{\"buffer\":0,\"byteOffset\":18446744073709551600,\"byteLength\":36}",
         "byteOffset"},
        {VIEW0, "{\"buffer\":0,\"byteOffset\":-4,\"byteLength\":36}", "byteOffset is not"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":0}", "beyond buffer 0"},
        {VIEW0, "{\"buffer\":-1,\"byteLength\":36}", "buffer is not"},
        {VIEW0, "{\"buffer\":4294967296,\"byteLength\":36}", "buffer is not"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":-12}", "byteStride is not"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":1e30}", "byteStride is not"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":4}", "byteStride 4"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":4294967292}", "byteStride"},
        {VIEW0, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":16}", "accessor 0: 3 elements"},
        {"{\"byteLength\":44}", "{\"byteLength\":4000000000}", "byteLength"},
        {"{\"byteLength\":44}", "{\"byteLength\":0}", ""},
        {"\"buffers\":[{\"byteLength\":44}]", "\"buffers\":[]", "no buffer 0"},
        {"\"buffers\":[{\"byteLength\":44}]", "\"buffers\":[7]", ""},
    };
    assert_changes_refused(changes, COUNT_OF(changes));
}

TEST(asset_gltf_hostile, accessors) {
    static const Change changes[] = {
        {ACC0, "{\"bufferView\":9,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}",
         "accessor 0: there is no bufferView 9"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
         "accessor 0: 4 elements lie beyond"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5126,\"count\":0,\"type\":\"VEC3\"}",
         "count 0"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5126,\"count\":4294967295,\"type\":\"VEC3\"}",
         "count 4294967295"},
        {ACC0, "{\"componentType\":5126,\"count\":60000000,\"type\":\"VEC3\"}", "vertices"},
        {ACC0,
         "{\"bufferView\":0,\"componentType\":5126,\"count\":18446744073709551615,"
         "\"type\":\"VEC3\"}",
         "count"},
        {ACC0,
         "{\"bufferView\":0,\"byteOffset\":4,\"componentType\":5126,\"count\":3,"
         "\"type\":\"VEC3\"}",
         "accessor 0: 3 elements"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5130,\"count\":3,\"type\":\"VEC3\"}",
         "componentType 5130"},
        {ACC0, "{\"bufferView\":0,\"componentType\":1,\"count\":3,\"type\":\"VEC3\"}",
         "componentType"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC9\"}", "type"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}",
         "POSITION has an unsupported type"},
        {ACC0, "{\"bufferView\":0,\"componentType\":5123,\"count\":3,\"type\":\"VEC3\"}",
         "POSITION has an unsupported type"},
        {ACC1, "{\"bufferView\":1,\"componentType\":5123,\"count\":2,\"type\":\"SCALAR\"}",
         "2 corners"},
        {ACC1, "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\"}",
         "indices have an unsupported type"},
        {ACC1,
         "{\"bufferView\":0,\"byteOffset\":8,\"componentType\":5125,\"count\":3,"
         "\"type\":\"SCALAR\"}",
         "accessor 1: index 1065353216"},
        {"\"indices\":1", "\"indices\":5", "accessor"},
        {"\"indices\":1", "\"indices\":-7", "indices is not"},
        {"\"POSITION\":0", "\"POSITION\":12", "POSITION names no accessor"},
        {"\"POSITION\":0", "\"POSITION\":-3", "POSITION names no accessor"},
        {"\"POSITION\":0", "\"POSITION\":0,\"NORMAL\":1", "NORMAL has an unsupported type"},
        {"\"POSITION\":0", "\"POSITION\":0,\"TANGENT\":99", "TANGENT names no accessor"},
        {"\"indices\":1", "\"indices\":1,\"material\":3", "no material 3"},
        {"\"indices\":1", "\"indices\":1,\"mode\":7", "mode 7"},
    };
    assert_changes_refused(changes, COUNT_OF(changes));
}

#define SPARSE(count, iview, ioffset, itype, vview, voffset)                                       \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{"          \
    "\"count\":" count ",\"indices\":{\"bufferView\":" iview ",\"byteOffset\":" ioffset            \
    ",\"componentType\":" itype "},\"values\":{\"bufferView\":" vview ",\"byteOffset\":" voffset   \
    "}}}"

TEST(asset_gltf_hostile, sparse_accessors) {
    static const Change changes[] = {
        {ACC0, SPARSE("9", "1", "0", "5123", "0", "0"), "9 sparse values"},
        {ACC0, SPARSE("0", "1", "0", "5123", "0", "0"), "0 sparse values"},
        {ACC0, SPARSE("3", "8", "0", "5123", "0", "0"), "no bufferView"},
        {ACC0, SPARSE("3", "1", "2", "5123", "0", "0"), "sparse part lies beyond"},
        {ACC0, SPARSE("3", "1", "0", "5125", "0", "0"), "sparse part lies beyond"},
        {ACC0, SPARSE("3", "1", "0", "5123", "0", "4"), "sparse part lies beyond"},
        {ACC0, SPARSE("3", "1", "0", "5123", "0", "2147483647"), "sparse part lies beyond"},
        {ACC0, SPARSE("3", "1", "0", "5126", "0", "0"), "sparse indices of type 5126"},
        {ACC0, SPARSE("2", "0", "14", "5123", "0", "0"), "out of order"},
    };
    assert_changes_refused(changes, COUNT_OF(changes));
}

TEST(asset_gltf_hostile, nodes_and_scenes) {
    static const Change changes[] = {
        {"{\"mesh\":0}", "{\"mesh\":4}", "node 0: there is no mesh 4"},
        {"{\"mesh\":0}", "{\"mesh\":-2}", "mesh is not"},
        {"{\"mesh\":0}", "{\"camera\":0}", "no camera 0"},
        {"{\"mesh\":0}", "{\"skin\":0}", "no skin 0"},
        {"{\"mesh\":0}", "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}", "no light"},
        {"{\"mesh\":0}", "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":-1}}}", "no light"},
        {"{\"mesh\":0}", "{\"children\":[3]}", "no child 3"},
        {"{\"mesh\":0}", "{\"children\":[-1]}", "no child -1"},
        {"{\"mesh\":0}", "{\"children\":[0]}", "cycle"},
        {"{\"mesh\":0}", "{},{\"children\":[2]},{\"children\":[1]}", "cycle"},
        {"{\"mesh\":0}", "{\"children\":[1,2]},{\"children\":[2]},{}", "two parents"},
        {"{\"mesh\":0}", "{\"children\":[1]},{\"children\":[0]}", "cycle"},
        {"{\"nodes\":[0]}", "{\"nodes\":[0,0]}", "names node 0 twice"},
        {"{\"nodes\":[0]}", "{\"nodes\":[5]}", "node 5 does not exist"},
        {"{\"nodes\":[0]}", "{\"nodes\":[-1]}", "does not exist"},
        {"\"scene\":0", "\"scene\":6", "no scene 6"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"matrix\":[1,0,0]}", "wrong length"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"translation\":[1,2]}", "wrong length"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"translation\":[1e300,0,0]}", "node 0"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"translation\":[1e999,0,0]}", "out_of_range"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1e12,1,1]}", "over 1e9"},
        {"\"version\":\"2.0\"", "\"version\":\"1.0\"", "asset.version"},
        {"\"version\":\"2.0\"", "\"version\":\"2.0\",\"minVersion\":\"2.1\"", "minVersion"},
        {"\"asset\":{\"version\":\"2.0\"}", "\"asset\":{}", "asset"},
        {"\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0",
         "requires the extension KHR_draco"},
        {"\"indices\":1", "\"indices\":1},{\"attributes\":5", "attributes"},
    };
    assert_changes_refused(changes, COUNT_OF(changes));
}

TEST(asset_gltf_hostile, materials_lights_and_cameras) {
    static const Change changes[] = {
        {"\"scene\":0", "\"materials\":[{\"normalTexture\":{\"index\":0}}],\"scene\":0",
         "material 0: there is no texture 0"},
        {"\"scene\":0", "\"materials\":[{\"emissiveFactor\":[1,2]}],\"scene\":0", "emissiveFactor"},
        {"\"scene\":0", "\"materials\":[{\"alphaMode\":\"HOLES\"}],\"scene\":0", "alphaMode"},
        {"\"scene\":0", "\"materials\":[{\"alphaCutoff\":1e300}],\"scene\":0", "not finite"},
        {"\"scene\":0", "\"textures\":[{\"source\":3}],\"scene\":0", "texture 0"},
        {"\"scene\":0", "\"textures\":[{\"sampler\":3}],\"scene\":0", "texture 0"},
        {"\"scene\":0", "\"images\":[{\"bufferView\":12}],\"scene\":0", "image"},
        {"\"scene\":0",
         "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":4,"
         "\"znear\":1}}],\"scene\":0",
         "camera 0"},
        {"\"scene\":0",
         "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\","
         "\"intensity\":-1}]}},\"scene\":0",
         "light 0"},
        {"\"scene\":0",
         "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\","
         "\"spot\":{\"innerConeAngle\":2}}]}},\"scene\":0",
         "light 0: cone"},
        {"\"scene\":0",
         "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"sun\"}]}}"
         ",\"scene\":0",
         "light 0: unknown type"},
    };
    assert_changes_refused(changes, COUNT_OF(changes));
}

TEST(asset_gltf_hostile, vertex_data_is_looked_at) {
    AssetFixture *f = fixture_open();
    static const f32 bad[] = {NAN, INFINITY, -INFINITY, 1e30f};
    for (u32 i = 0; i < COUNT_OF(bad); i++) {
        TriangleBin bin = triangle_bin;
        bin.positions[2][1] = bad[i];
        assert_glb_refused(f, TRIANGLE_JSON, &bin, sizeof bin, "accessor 0: element 2");
    }
    TriangleBin bin = triangle_bin;
    bin.indices[1] = 3;
    assert_glb_refused(f, TRIANGLE_JSON, &bin, sizeof bin, "index 3 (element 1) of 3");
    bin.indices[1] = 0xFFFF; // a restart in other worlds
    assert_glb_refused(f, TRIANGLE_JSON, &bin, sizeof bin, "index 65535");
    fixture_close(f);
}

// A view beyond its buffer that only an image uses: the parser hands out what lies there.
TEST(asset_gltf_hostile, images_beyond_their_buffer) {
    AssetFixture *f = fixture_open();
    static const char *const views[] = {"\"byteOffset\":4000000000,\"byteLength\":36",
                                        "\"byteOffset\":40,\"byteLength\":4000000",
                                        "\"byteLength\":45"};
    for (u32 i = 0; i < COUNT_OF(views); i++) {
        const char *json = fixture_replace(TRIANGLE_JSON, "\"byteLength\":36", views[i]);
        json = fixture_replace(json, "\"scene\":0,",
                               "\"scene\":0,\"images\":[{\"bufferView\":0}],"
                               "\"textures\":[{\"source\":0}],\"materials\":[{\"normalTexture\":{"
                               "\"index\":0}}],");
        assert_glb_refused(f, json, &triangle_bin, sizeof triangle_bin, "beyond buffer 0");
    }
    fixture_close(f);
}

// ---- text ----

static char *nested(const char *head, const char *open, u32 levels, const char *close,
                    const char *tail) {
    u64 size = strlen(head) + levels * (strlen(open) + strlen(close)) + strlen(tail) + 1;
    char *text = malloc(size), *at = text;
    at += sprintf(at, "%s", head);
    for (u32 i = 0; i < levels; i++) at += sprintf(at, "%s", open);
    for (u32 i = 0; i < levels; i++) at += sprintf(at, "%s", close);
    sprintf(at, "%s", tail);
    return text;
}

static void assert_text_refused(AssetFixture *f, char *text, const char *words) {
    StoreShape before = fixture_shape(f);
    ASSERT_REFUSED(f, before, fixture_load_text(f, text), words);
    free(text);
}

TEST(asset_gltf_hostile, deep_nesting) {
    AssetFixture *f = fixture_open();
    const char *head = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
    assert_text_refused(f, nested(head, "[", 20000, "]", "}"), "nested deeper");
    assert_text_refused(f, nested(head, "{\"a\":", 20000, "}", "}"), "nested deeper");
    assert_text_refused(f, nested("", "[", 20000, "", ""), "nested deeper");
    char *fine = nested(head, "[", 60, "]", "}");
    assert_int_not_equal(fixture_load_text(f, fine), 0);
    free(fine);
    // Brackets in strings do not nest.
    char *quoted =
        nested("{\"asset\":{\"version\":\"2.0\",\"generator\":\"\\\"", "[", 1000, "", "\"}}");
    assert_int_not_equal(fixture_load_text(f, quoted), 0);
    free(quoted);
    fixture_close(f);
}

static char *repeated(const char *head, const char *element, u32 count, const char *tail) {
    u64 length = strlen(element), size = strlen(head) + count * (length + 1) + strlen(tail) + 1;
    char *text = malloc(size), *at = text;
    at += sprintf(at, "%s", head);
    for (u32 i = 0; i < count; i++) {
        if (i) *at++ = ',';
        memcpy(at, element, length);
        at += length;
    }
    sprintf(at, "%s", tail);
    return text;
}

TEST(asset_gltf_hostile, huge_counts) {
    AssetFixture *f = fixture_open();
    const char *start = "{\"asset\":{\"version\":\"2.0\"},\"materials\":[";
    assert_text_refused(f, repeated(start, "{}", 255, "]}"), "more than 254 materials");
    char *most = repeated(start, "{}", 254, "]}");
    assert_int_not_equal(fixture_load_text(f, most), 0);
    free(most);
    assert_text_refused(f, repeated("{\"mater\\u0069als\":[", "{}", 255, "]}"), "escape");
    assert_text_refused(f, repeated("{\"meshes\":[", "{}", 65537, "]}"), "more than 65536 meshes");
    assert_text_refused(f, repeated("{\"extras\":[", "1", (1 << 23) + 1, "]}"), "values");
    assert_text_refused(f, repeated("{\"x\":[", "{}", (1 << 20) + 1, "]}"), "objects");
    // Each buffer without a uri would be a copy of the chunk.
    u64 bin_size = MIB(4);
    u8 *bin = calloc(1, bin_size);
    char *buffers = repeated("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[",
                             "{\"byteLength\":4194304}", 200, "]}");
    assert_glb_refused(f, buffers, bin, bin_size, "200 buffers");
    free(buffers);
    free(bin);
    fixture_close(f);
}

TEST(asset_gltf_hostile, texts_that_are_no_gltf) {
    AssetFixture *f = fixture_open();
    static const char *const texts[] = {"",
                                        "{",
                                        "}",
                                        "[]",
                                        "null",
                                        "\"",
                                        "{\"asset\":",
                                        "{\"asset\":{\"version\":\"2.0\"}",
                                        "\xFF\xFE{}",
                                        "{\"asset\":{\"version\":\"2.0\xFF\"}}",
                                        "]]]]]]]]{",
                                        "{\"asset\":{\"version\":2}}",
                                        "glTF"};
    for (u32 i = 0; i < COUNT_OF(texts); i++) {
        StoreShape before = fixture_shape(f);
        ASSERT_REFUSED(f, before, fixture_load_text(f, texts[i]), "model_");
    }
    StoreShape before = fixture_shape(f);
    ASSERT_REFUSED(f, before, asset_load_model(&f->store, &f->root, "no such file"), "no such");
    ASSERT_REFUSED(f, before, asset_load_model(&f->store, &f->root, "../outside.glb"), "outside");
    fixture_close(f);
}

TEST(asset_gltf_hostile, containers) {
    AssetFixture *f = fixture_open();
    u64 size;
    const u8 *good = fixture_make_glb(TRIANGLE_JSON, &triangle_bin, sizeof triangle_bin, &size);
    u8 *glb = malloc(size);
    for (u64 cut = 4; cut < size; cut += 13) { // cut off, with a header that knows
        memcpy(glb, good, size);
        u32 length = (u32)cut;
        if (cut >= 12) memcpy(glb + 8, &length, 4);
        StoreShape before = fixture_shape(f);
        ASSERT_REFUSED(f, before, fixture_load_bytes(f, glb, cut), "model_");
    }
    u32 json_size, bin_at;
    memcpy(&json_size, good + 12, 4);
    bin_at = 20 + json_size;
    const struct {
        u32 at, value;
    } changes[] = {{4, 1},
                   {8, (u32)size + 4},
                   {8, 12},
                   {12, 0xFFFFFFF0},
                   {12, 4},
                   {16, 0x004E4942},
                   {bin_at, 52},
                   {bin_at, 44 + 8},
                   {bin_at, 0xFFFFFFFC},
                   {bin_at, 0},
                   {bin_at + 4, 0x12345678}};
    for (u32 i = 0; i < COUNT_OF(changes); i++) {
        memcpy(glb, good, size);
        memcpy(glb + changes[i].at, &changes[i].value, 4);
        StoreShape before = fixture_shape(f);
        ASSERT_REFUSED(f, before, fixture_load_bytes(f, glb, size), "model_");
    }
    free(glb);
    fixture_close(f);
}

// ---- names of files ----

static const char *buffer_from(const char *uri) {
    const char *field = fixture_replace("\"buffers\":[{\"uri\":\"U\",", "U", uri);
    return fixture_replace(TRIANGLE_JSON, "\"buffers\":[{", field);
}

static const char *image_from(const char *uri) {
    return fixture_replace("{\"asset\":{\"version\":\"2.0\"},\"images\":[{\"uri\":\"U\"}]}", "U",
                           uri);
}

TEST(asset_gltf_hostile, uris_that_break_out) {
    AssetFixture *f = fixture_open();
    // Secrets around the root, which is the folder `inside`.
    assert_true(file_make_directories(test_temp_path("inside/sub")));
    fixture_write("secret.bin", &triangle_bin, sizeof triangle_bin);
    fixture_write("inside/a.bin", &triangle_bin, sizeof triangle_bin);
    assert_int_equal(symlink("../secret.bin", test_temp_path("inside/link.bin")), 0);
    assert_int_equal(mkfifo(test_temp_path("inside/fifo.bin"), 0600), 0);
    file_root_close(&f->root);
    assert_true(file_root_open(&f->root, test_temp_path("inside")));

    static const struct {
        const char *uri;
        bool image_too; // refused for an image as well, not merely missing
    } names[] = {{"../secret.bin", true},
                 {"sub/../../secret.bin", true},
                 {"..%2fsecret.bin", true},
                 {"%2e%2e%2fsecret.bin", true},
                 {"%2E%2E/secret.bin", true},
                 {"/etc/passwd", true},
                 {"%2fetc%2fpasswd", true},
                 {"a.bin%00.png", true},
                 {"a.bin\\u0000", true},
                 {"..\\\\secret.bin", true},
                 {"..%5csecret.bin", true},
                 {"a%zz.bin", true},
                 {"a.bin%", true},
                 {"a%0a.bin", true},
                 {"file:///etc/passwd", false},
                 {"http://example.org/a.bin", false},
                 {"data:text/html,hello", false},
                 {"link.bin", false},
                 {"fifo.bin", false},
                 {"sub", false},
                 {"absent.bin", false},
                 {"..%252fsecret.bin", false}};
    for (u32 i = 0; i < COUNT_OF(names); i++) {
        const char *texts[2] = {buffer_from(names[i].uri), image_from(names[i].uri)};
        for (u32 k = 0; k < (names[i].image_too ? 2 : 1); k++) {
            FILE *file = fopen(test_temp_path("inside/m.gltf"), "wb");
            fwrite(texts[k], 1, strlen(texts[k]), file);
            fclose(file);
            StoreShape before = fixture_shape(f);
            u32 id = asset_load_model(&f->store, &f->root, "m.gltf");
            if (id) print_error("accepted: %s\n", names[i].uri);
            ASSERT_REFUSED(f, before, id, "m.gltf: ");
        }
    }
    fixture_close(f);
}

// ---- random changes ----

TEST(asset_gltf_hostile, random_changes_do_no_harm) {
    AssetFixture *f = fixture_open();
    // A file with one of everything: geometry, sparse part, material, image, light, camera.
    const char *json = fixture_replace(
        TRIANGLE_JSON, "\"scene\":0,",
        "\"scene\":0,\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{"
        "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"intensity\":5}]}},"
        "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":1}}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},"
        "\"metallicRoughnessTexture\":{\"index\":0}},\"normalTexture\":{\"index\":0}}],"
        "\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":2}],");
    json = fixture_replace(json, "{\"mesh\":0}",
                           "{\"mesh\":0,\"camera\":0,\"children\":[1]},{\"rotation\":[0,0,0,1],"
                           "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}");
    json = fixture_replace(json, "\"indices\":1", "\"indices\":1,\"material\":0");
    json = fixture_replace(json, ACC0, SPARSE("2", "1", "0", "5123", "0", "0"));
    u8 bin[256] = {0}, pixels[4 * 4 * 4];
    memset(pixels, 77, sizeof pixels);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 4, 4, 4));
    Bytes png;
    assert_true(file_root_read(&f->root, "t.png", KIB(64), &f->store.scratch, &png));
    assert_true(png.size <= sizeof bin - 44);
    memcpy(bin, &triangle_bin, 44);
    memcpy(bin + 44, png.data, png.size);
    char view[128];
    snprintf(view, sizeof view, ",{\"buffer\":0,\"byteOffset\":44,\"byteLength\":%u}]",
             (u32)png.size);
    arena_reset(&f->store.scratch);
    json = fixture_replace(json, "\"byteLength\":6}]",
                           fixture_replace("\"byteLength\":6}]", "]", view));
    json = fixture_replace(json, "\"byteLength\":44", "\"byteLength\":256");
    u64 size;
    const u8 *good = fixture_make_glb(json, bin, sizeof bin, &size);
    assert_int_not_equal(fixture_load_bytes(f, good, size), 0);

    u8 *glb = malloc(size);
    u32 accepted = 0;
    // Written over and over in place: making the file anew each time takes the disk 4 ms.
    FILE *mutant = fopen(test_temp_path("mutant"), "w+b");
    assert_non_null(mutant);
    for (u32 round = 0; round < 3000; round++) {
        memcpy(glb, good, size);
        for (u32 k = 0; k <= round % 3; k++) {
            u32 where = random_u32(SEED, 0, round * 4 + k) % (u32)size;
            u32 how = random_u32(SEED, 1, round * 4 + k);
            static const u8 tempting[] = "0123456789-,:{}[]\"e.";
            if (how % 2)
                glb[where] = (u8)(how >> 8);
            else
                glb[where] = tempting[(how >> 8) % (sizeof tempting - 1)];
        }
        StoreMark mark = store_mark(&f->store);
        rewind(mutant);
        assert_true(fwrite(glb, 1, size, mutant) == size && fflush(mutant) == 0);
        u32 id = asset_load_model(&f->store, &f->root, "mutant");
        if (!id && !f->text[LOG_ASSET_MODEL][0]) fail_msg("round %u: refused in silence", round);
        accepted += id != 0;
        f->text[LOG_ASSET_MODEL][0] = 0;
        store_rewind(&f->store, mark);
    }
    assert_true(accepted > 100 && accepted < 2900); // both ways were tried
    fclose(mutant);
    free(glb);
    fixture_close(f);
}

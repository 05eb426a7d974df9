// asset_gltf.c: valid glTF files of all supported kinds give the right models.
#include "asset_fixture.h"
#include "../../engine/asset/asset_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const Model *model_of(AssetFixture *f, u32 id) {
    if (id == 0) print_error("refused: %s\n", f->text[LOG_ASSET_MODEL]);
    assert_int_not_equal(id, 0);
    return &f->store.models[id];
}

static const Mesh *mesh_of(AssetFixture *f, const Model *model, u32 part) {
    return &f->store.meshes[model->parts[part].mesh];
}

static void assert_triangle(AssetFixture *f, const Model *model) {
    assert_int_equal(model->part_count, 1);
    const Mesh *mesh = mesh_of(f, model, 0);
    assert_true(mesh->vertex_count == 3 && mesh->index_count == 3);
    assert_true(model->min.x == 0 && model->max.x == 1 && model->max.y == 1 && model->max.z == 0);
    Vec3 p[3];
    for (u32 k = 0; k < 3; k++) p[k] = mesh_position(mesh, 0, k);
    assert_true(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])).z > 0.99f);
    assert_true(asset_unpack_normal(mesh->vertices[0].normal).z > 0.999f); // made: flat
}

TEST(asset_gltf, a_glb_is_read) {
    AssetFixture *f = fixture_open();
    const Model *model =
        model_of(f, fixture_load_glb(f, TRIANGLE_JSON, &triangle_bin, sizeof triangle_bin));
    assert_triangle(f, model);
    assert_int_equal(model->material_count, 1);
    assert_string_equal(model->materials[0].name, "default");
    assert_int_equal(f->id_count[LOG_ASSET_MODEL_WARNING], 0);
    fixture_close(f);
}

static const char *with_uri(const char *uri) {
    const char *field = fixture_replace("\"buffers\":[{\"uri\":\"U\",", "U", uri);
    return fixture_replace(TRIANGLE_JSON, "\"buffers\":[{", field);
}

TEST(asset_gltf, text_with_embedded_and_external_buffers_is_read) {
    AssetFixture *f = fixture_open();
    const char *embedded = with_uri(fixture_data_uri(&triangle_bin, sizeof triangle_bin));
    assert_triangle(f, model_of(f, fixture_load_text(f, embedded)));
    fixture_write("my triangle.bin", &triangle_bin, sizeof triangle_bin);
    u32 outside = fixture_load_text(f, with_uri("my%20triangle.bin"));
    assert_triangle(f, model_of(f, outside));
    // The hash covers what the file refers to.
    TriangleBin other = triangle_bin;
    other.positions[1][0] = 2;
    fixture_write("my triangle.bin", &other, sizeof other);
    u32 changed = fixture_load_text(f, with_uri("my%20triangle.bin"));
    assert_true(model_of(f, outside)->content_hash != model_of(f, changed)->content_hash);
    fixture_close(f);
}

TEST(asset_gltf, the_same_path_is_the_same_model) {
    AssetFixture *f = fixture_open();
    u64 size;
    const u8 *glb = fixture_make_glb(TRIANGLE_JSON, &triangle_bin, sizeof triangle_bin, &size);
    fixture_write("t.glb", glb, size);
    u32 a = asset_load_model(&f->store, &f->root, "t.glb");
    StoreShape before = fixture_shape(f);
    assert_int_equal(asset_load_model(&f->store, &f->root, "t.glb"), a);
    StoreShape after = fixture_shape(f);
    assert_memory_equal(&before, &after, sizeof before);
    assert_string_equal(f->store.models[a].name, "t.glb");
    fixture_close(f);
}

TEST(asset_gltf, models_in_folders_find_their_files) {
    AssetFixture *f = fixture_open();
    char folder[300];
    snprintf(folder, sizeof folder, "%s", test_temp_path("models"));
    assert_true(file_make_directories(folder));
    fixture_write("models/a.bin", &triangle_bin, sizeof triangle_bin);
    fixture_write("b.bin", &triangle_bin, sizeof triangle_bin);
    const char *near = with_uri("a.bin");
    fixture_write("models/near.gltf", near, strlen(near));
    const char *up = with_uri("../b.bin"); // leaves the folder, not the root
    fixture_write("models/up.gltf", up, strlen(up));
    assert_triangle(f, model_of(f, asset_load_model(&f->store, &f->root, "models/near.gltf")));
    assert_triangle(f, model_of(f, asset_load_model(&f->store, &f->root, "models/up.gltf")));
    fixture_close(f);
}

// ---- nodes ----

#define NODE_TO_TWO                                                                                \
    "\"nodes\":[{\"children\":[1,2],\"translation\":[10,0,0]},"                                    \
    "{\"mesh\":0,\"scale\":[2,2,2],\"rotation\":[0,0,0.70710678,0.70710678]},"                     \
    "{\"mesh\":0,\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,5,0,1]}],"

TEST(asset_gltf, meshes_are_shared_and_placed) {
    AssetFixture *f = fixture_open();
    const char *json = fixture_replace(TRIANGLE_JSON, "\"nodes\":[{\"mesh\":0}],", NODE_TO_TWO);
    const Model *model = model_of(f, fixture_load_glb(f, json, &triangle_bin, sizeof triangle_bin));
    assert_int_equal(model->part_count, 2);
    assert_int_equal(model->parts[0].mesh, model->parts[1].mesh);
    Vec3 p = mat34_point(&model->parts[0].local, vec3(1, 0, 0)); // x turned to y, doubled
    ASSERT_NEAR(p.x, 10, 1e-5);
    ASSERT_NEAR(p.y, 2, 1e-5);
    p = mat34_point(&model->parts[1].local, vec3(1, 0, 0));
    ASSERT_NEAR(p.x, 11, 1e-5);
    ASSERT_NEAR(p.y, 5, 1e-5);
    ASSERT_NEAR(model->min.x, 8, 1e-5);
    ASSERT_NEAR(model->max.y, 6, 1e-5);
    fixture_close(f);
}

TEST(asset_gltf, mirrored_nodes_get_a_mesh_of_their_own) {
    AssetFixture *f = fixture_open();
    const char *json = fixture_replace(
        TRIANGLE_JSON, "\"nodes\":[{\"mesh\":0}],",
        "\"nodes\":[{\"children\":[1,2,3]},{\"mesh\":0},{\"mesh\":0,\"scale\":[1,-2,1]},"
        "{\"mesh\":0,\"scale\":[-1,1,1]}],");
    const Model *model = model_of(f, fixture_load_glb(f, json, &triangle_bin, sizeof triangle_bin));
    assert_int_equal(model->part_count, 3);
    assert_int_not_equal(model->parts[0].mesh, model->parts[1].mesh);
    assert_int_equal(model->parts[1].mesh, model->parts[2].mesh);
    for (u32 i = 0; i < 3; i++) {
        const ModelPart *part = &model->parts[i];
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++)
            p[k] = mat34_point(&part->local, mesh_position(mesh_of(f, model, i), 0, k));
        Vec3 face = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
        Vec3 normal = mat34_vector(&part->local,
                                   asset_unpack_normal(mesh_of(f, model, i)->vertices[0].normal));
        assert_true(vec3_dot(face, normal) > 0); // culling and lighting agree again
        assert_true(face.z > 0.9f);              // z was never mirrored
    }
    ASSERT_NEAR(model->min.y, -2, 1e-6);
    ASSERT_NEAR(model->min.x, -1, 1e-6);
    fixture_close(f);
}

TEST(asset_gltf, files_without_scenes_show_all_roots) {
    AssetFixture *f = fixture_open();
    const char *json =
        fixture_replace(TRIANGLE_JSON, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],", "");
    json = fixture_replace(json, "{\"mesh\":0}", "{\"mesh\":0},{\"mesh\":0}");
    assert_int_equal(
        model_of(f, fixture_load_glb(f, json, &triangle_bin, sizeof triangle_bin))->part_count, 2);
    fixture_close(f);
}

// ---- attributes ----

typedef struct Rich {
    f32 positions[4][3];
    f32 normals[4][3];
    u16 uvs[4][2];
    u8 colors[4][4];
    u8 strip[4];
    u32 sparse_index[1];
    f32 sparse_value[3];
} Rich;

#define RICH_JSON                                                                                  \
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"      \
    "\"meshes\":[{\"primitives\":[{\"mode\":5,\"material\":0,\"indices\":4,\"attributes\":{"       \
    "\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"COLOR_0\":3}}]}],"                             \
    "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"metallicFactor\":0}}],"            \
    "\"accessors\":["                                                                              \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{"          \
    "\"count\":1,\"indices\":{\"bufferView\":5,\"componentType\":5125},"                           \
    "\"values\":{\"bufferView\":6}}},"                                                             \
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                     \
    "{\"bufferView\":2,\"componentType\":5123,\"normalized\":true,\"count\":4,"                    \
    "\"type\":\"VEC2\"},"                                                                          \
    "{\"bufferView\":3,\"componentType\":5121,\"normalized\":true,\"count\":4,"                    \
    "\"type\":\"VEC4\"},"                                                                          \
    "{\"bufferView\":4,\"componentType\":5121,\"count\":4,\"type\":\"SCALAR\"}],"                  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"                                           \
    "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":48},"                                          \
    "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":16,\"byteStride\":4},"                         \
    "{\"buffer\":0,\"byteOffset\":112,\"byteLength\":16},"                                         \
    "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":4},"                                          \
    "{\"buffer\":0,\"byteOffset\":132,\"byteLength\":4},"                                          \
    "{\"buffer\":0,\"byteOffset\":136,\"byteLength\":12}],"                                        \
    "\"buffers\":[{\"byteLength\":148}]}"

static const Rich rich = {
    .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}}, // the last is replaced: sparse
    .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
    .uvs = {{0, 65535}, {65535, 65535}, {0, 0}, {65535, 0}},
    .colors = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 51}},
    .strip = {0, 1, 2, 3},
    .sparse_index = {3},
    .sparse_value = {1, 1, 0}};

static const MeshVertex *vertex_at(const Mesh *mesh, f32 x, f32 y) {
    for (u32 i = 0; i < mesh->vertex_count; i++)
        if (mesh->vertices[i].position[0] == x && mesh->vertices[i].position[1] == y)
            return &mesh->vertices[i];
    fail_msg("no vertex at %g %g", (f64)x, (f64)y);
    return NULL;
}

TEST(asset_gltf, strips_sparse_colours_and_short_uvs_are_read) {
    AssetFixture *f = fixture_open();
    const Model *model = model_of(f, fixture_load_glb(f, RICH_JSON, &rich, sizeof rich));
    const Mesh *mesh = mesh_of(f, model, 0);
    assert_true(mesh->vertex_count == 4 && mesh->index_count == 6 && mesh->has_color);
    assert_int_equal(vertex_at(mesh, 0, 0)->color, 0xFF0000FF);
    assert_int_equal(vertex_at(mesh, 1, 1)->color, 0x33FFFFFF);
    ASSERT_NEAR(vertex_at(mesh, 1, 1)->uv[0], 1, 0);
    ASSERT_NEAR(vertex_at(mesh, 1, 1)->uv[1], 0, 0);
    for (u32 t = 0; t < 2; t++) { // both triangles of the strip face the same way
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) p[k] = mesh_position(mesh, t, k);
        assert_true(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])).z > 0.9f);
        assert_int_equal(mesh_corner(mesh, t, 0)->tangent >> 31, 0);
    }
    assert_int_equal(model->material_count, 1); // no part needs the default
    fixture_close(f);
}

TEST(asset_gltf, fans_lists_and_lines) {
    AssetFixture *f = fixture_open();
    const char *fan = fixture_replace(RICH_JSON, "\"mode\":5", "\"mode\":6");
    const Model *model = model_of(f, fixture_load_glb(f, fan, &rich, sizeof rich));
    assert_int_equal(mesh_of(f, model, 0)->index_count, 6);
    const char *lines = fixture_replace(RICH_JSON, "\"mode\":5", "\"mode\":1");
    model = model_of(f, fixture_load_glb(f, lines, &rich, sizeof rich));
    assert_int_equal(model->part_count, 0);
    ASSERT_SAID(f, ASSET_MODEL_WARNING, "holds nothing");
    fixture_close(f);
}

TEST(asset_gltf, texture_transforms_are_baked) {
    AssetFixture *f = fixture_open();
    const char *json =
        fixture_replace(RICH_JSON, "\"metallicFactor\":0",
                        "\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0,\"extensions\":{"
                        "\"KHR_texture_transform\":{\"offset\":[0.5,0.25],\"scale\":[2,3],"
                        "\"rotation\":1.57079633}}}");
    json = fixture_replace(json, "\"accessors\":",
                           "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"no.png\"}],"
                           "\"accessors\":");
    const Model *model = model_of(f, fixture_load_glb(f, json, &rich, sizeof rich));
    // uv (1, 0) scaled to (2, 0), turned by a quarter (u' = c u + s v, v' = -s u + c v), moved.
    const MeshVertex *v = vertex_at(mesh_of(f, model, 0), 1, 1);
    ASSERT_NEAR(v->uv[0], 0.5, 1e-5);
    ASSERT_NEAR(v->uv[1], -1.75, 1e-5);
    fixture_close(f);
}

// ---- materials ----

#define MATERIALS_JSON(materials, images)                                                          \
    "{\"asset\":{\"version\":\"2.0\"},\"materials\":[" materials "],"                              \
    "\"textures\":[{\"source\":0},{\"source\":1}],\"images\":[" images "]}"

TEST(asset_gltf, materials_are_translated) {
    AssetFixture *f = fixture_open();
    const Model *model = model_of(
        f,
        fixture_load_text(
            f,
            "{\"asset\":{\"version\":\"2.0\"},\"materials\":["
            "{\"name\":\"gold\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.8,0.4,0.5],"
            "\"metallicFactor\":0.75,\"roughnessFactor\":0.5},\"doubleSided\":true},"
            "{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,\"emissiveFactor\":[1,0.5,0],"
            "\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},"
            "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":7.5},"
            "\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularColorFactor\":[1,2,0]}}},"
            "{\"alphaMode\":\"BLEND\",\"extensions\":{\"KHR_materials_unlit\":{}}}]}"));
    assert_int_equal(model->material_count, 3);
    const ModelMaterial *gold = &model->materials[0], *glow = &model->materials[1];
    assert_string_equal(gold->name, "gold");
    assert_true(gold->double_sided && !glow->double_sided);
    ASSERT_NEAR(gold->albedo[1], 0.8 * 0.25, 1e-6);
    ASSERT_NEAR(gold->albedo[3], 0.5, 1e-6);
    ASSERT_NEAR(gold->specular[2], 0.04 + (0.4 - 0.04) * 0.75, 1e-6);
    ASSERT_NEAR(gold->power, 30, 1e-3); // a = 1/4
    assert_int_equal(glow->alpha_mode, 1);
    assert_string_equal(glow->name, "material 1");
    ASSERT_NEAR(glow->alpha_cutoff, 0.25, 1e-6);
    ASSERT_NEAR(glow->power, 2048, 0);
    ASSERT_NEAR(glow->emissive[1], 0.5, 1e-6);
    ASSERT_NEAR(glow->emissive_strength, 7.5, 1e-6);
    ASSERT_NEAR(glow->specular[0], 0.02, 1e-6);
    ASSERT_NEAR(glow->specular[1], 0.04, 1e-6);
    ASSERT_NEAR(glow->specular[2], 0, 1e-6);
    assert_int_equal(model->materials[2].alpha_mode, 2);
    assert_true(f->id_count[LOG_ASSET_MODEL_WARNING] >= 1);
    fixture_close(f);
}

TEST(asset_gltf, images_are_shared_and_metal_is_averaged) {
    AssetFixture *f = fixture_open();
    u8 pixels[8 * 8 * 4];
    for (u32 i = 0; i < sizeof pixels; i += 4) // half the roughness, a quarter of the metal
        pixels[i] = 9, pixels[i + 1] = 128, pixels[i + 2] = i % 16 ? 0 : 255, pixels[i + 3] = 255;
    assert_true(image_write_png(test_temp_path("a b.png"), pixels, 8, 8, 4));
    const char *json =
        MATERIALS_JSON("{\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":{\"index\":1}}},"
                       "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},"
                       "\"normalTexture\":{\"index\":1}},"
                       "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}},"
                       "\"emissiveTexture\":{\"index\":0},\"emissiveFactor\":[1,1,1]}",
                       "{\"uri\":\"a%20b.png\"},{\"uri\":\"a%20b.png\"}");
    const Model *model = model_of(f, fixture_load_text(f, json));
    const ModelMaterial *m = model->materials;
    f32 metal = 0.25f;
    ASSERT_NEAR(m[0].albedo[0], 1 - metal, 1e-3);
    ASSERT_NEAR(m[0].specular[0], 0.04 + 0.96 * metal, 1e-3);
    f64 a = pow(128.0 / 255, 2);
    ASSERT_NEAR(m[0].power, 2 / (a * a) - 2, 0.01);
    assert_int_equal(m[0].albedo_texture, 0);
    assert_true(m[1].albedo_texture > 1 && m[1].normal_texture > 1);
    assert_true(m[1].albedo_texture != m[1].normal_texture);
    assert_int_equal(m[2].emissive_texture, m[1].albedo_texture);
    assert_int_equal(f->store.textures[m[1].normal_texture].kind, TEXTURE_LINEAR);
    assert_int_equal(f->store.textures[m[1].albedo_texture].kind, TEXTURE_SRGB);
    assert_int_equal(f->store.texture_count, 2 + 3);

    // Another file with the same pictures brings none; with other pictures under their name, all.
    u32 albedo = m[1].albedo_texture, normal = m[1].normal_texture;
    m = model_of(f, fixture_load_text(f, json))->materials;
    assert_int_equal(f->store.texture_count, 2 + 3);
    assert_true(f->store.model_count == 3 && m[1].normal_texture == normal);
    assert_true(m[1].albedo_texture == albedo && m[2].emissive_texture == albedo);
    pixels[0]++;
    assert_true(image_write_png(test_temp_path("a b.png"), pixels, 8, 8, 4));
    m = model_of(f, fixture_load_text(f, json))->materials;
    assert_true(m[1].albedo_texture >= 5 && m[1].normal_texture >= 5);
    fixture_close(f);
}

TEST(asset_gltf, missing_and_damaged_images_are_checkers) {
    AssetFixture *f = fixture_open();
    fixture_write("bad.png", "\x89PNG\r\n\x1a\n and no more", 20);
    const char *json =
        MATERIALS_JSON("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},"
                       "\"normalTexture\":{\"index\":0}},"
                       "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1},"
                       "\"metallicRoughnessTexture\":{\"index\":0}}}",
                       "{\"uri\":\"absent.png\"},{\"uri\":\"bad.png\"}");
    const Model *model = model_of(f, fixture_load_text(f, json));
    assert_int_equal(model->materials[0].albedo_texture, ASSET_TEXTURE_CHECKER);
    assert_int_equal(model->materials[0].normal_texture, 0);
    assert_int_equal(model->materials[1].albedo_texture, ASSET_TEXTURE_CHECKER);
    assert_int_equal(f->id_count[LOG_ASSET_IMAGE], 2);
    assert_int_equal(f->id_count[LOG_FILE_OPEN] + f->id_count[LOG_FILE_READ], 0);
    json = fixture_replace(json, "absent.png", "https://example.org/a.png");
    assert_int_not_equal(fixture_load_text(f, json), 0);
    json = fixture_replace(json, "https://example.org/a.png", "data:image/webp;base64,AAAA");
    assert_int_not_equal(fixture_load_text(f, json), 0);
    fixture_close(f);
}

// A picture whose header is whole and whose pixels are not: found while decoding.
TEST(asset_gltf, an_image_damaged_inside_is_a_checker) {
    AssetFixture *f = fixture_open();
    u8 pixels[16 * 16 * 4];
    memset(pixels, 200, sizeof pixels);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 16, 16, 4));
    Bytes png;
    assert_true(file_root_read(&f->root, "t.png", MIB(1), &f->store.scratch, &png));
    fixture_write("t.png", png.data, png.size - 40);
    arena_reset(&f->store.scratch);
    const char *json =
        MATERIALS_JSON("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}",
                       "{\"uri\":\"t.png\"},{\"uri\":\"t.png\"}");
    const Model *model = model_of(f, fixture_load_text(f, json));
    const Texture *t = &f->store.textures[model->materials[0].albedo_texture];
    assert_ptr_equal(t->pixels, f->store.textures[ASSET_TEXTURE_CHECKER].pixels);
    assert_int_equal(f->id_count[LOG_ASSET_IMAGE], 1);
    fixture_load_text(f, json); // nothing of it is shared
    assert_int_equal(f->id_count[LOG_ASSET_IMAGE], 2);
    fixture_close(f);
}

TEST(asset_gltf, images_in_buffer_views_are_read) {
    AssetFixture *f = fixture_open();
    u8 pixels[4 * 4 * 4], bin[1024] = {0};
    memset(pixels, 90, sizeof pixels);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 4, 4, 4));
    Bytes png;
    assert_true(file_root_read(&f->root, "t.png", MIB(1), &f->store.scratch, &png));
    assert_true(png.size < 1000);
    memcpy(bin + 4, png.data, png.size);
    char json[1024];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"pbrMetallicRoughness\":{"
             "\"baseColorTexture\":{\"index\":0}}}],\"textures\":[{\"source\":0}],"
             "\"images\":[{\"bufferView\":0,\"mimeType\":\"image/png\"}],\"bufferViews\":[{"
             "\"buffer\":0,\"byteOffset\":4,\"byteLength\":%u}],"
             "\"buffers\":[{\"byteLength\":1024}]}",
             (u32)png.size);
    arena_reset(&f->store.scratch);
    const Model *model = model_of(f, fixture_load_glb(f, json, bin, sizeof bin));
    const Texture *t = &f->store.textures[model->materials[0].albedo_texture];
    assert_true(t->width == 4 && t->pixels[0] == 90 && t->has_alpha);
    assert_int_equal(f->id_count[LOG_ASSET_IMAGE], 0);
    fixture_close(f);
}

// ---- lights, cameras, what is ignored ----

TEST(asset_gltf, lights_and_cameras_are_placed) {
    AssetFixture *f = fixture_open();
    const Model *model = model_of(
        f,
        fixture_load_text(
            f,
            "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"],"
            "\"extensionsRequired\":[\"KHR_lights_punctual\"],"
            "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
            "{\"type\":\"point\",\"name\":\"lamp\",\"color\":[1,0.5,0.25],\"intensity\":80,"
            "\"range\":12},{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.2,"
            "\"outerConeAngle\":0.6}},{\"type\":\"directional\"}]}},"
            "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.9,\"znear\":0.05}},"
            "{\"type\":\"orthographic\",\"orthographic\":{\"xmag\":1,\"ymag\":1,\"znear\":0.1,"
            "\"zfar\":10}}],\"scenes\":[{\"nodes\":[0,1,2,3,4]}],\"nodes\":["
            "{\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
            "{\"name\":\"torch\",\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},"
            "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}},"
            "{\"camera\":0,\"translation\":[0,0,9]},{\"camera\":1}]}"));
    assert_true(model->light_count == 3 && model->camera_count == 1 && model->part_count == 0);
    const ModelLight *lamp = &model->lights[0], *torch = &model->lights[1];
    assert_string_equal(lamp->name, "lamp");
    assert_true(lamp->kind == 0 && lamp->intensity == 80 && lamp->range == 12);
    assert_true(lamp->color[1] == 0.5f && mat34_translation(&lamp->local).z == 3);
    assert_string_equal(torch->name, "torch");
    ASSERT_NEAR(torch->inner_rad, 0.2, 1e-6);
    ASSERT_NEAR(torch->outer_rad, 0.6, 1e-6);
    assert_true(torch->color[0] == 1 && torch->range == 0);
    assert_int_equal(model->lights[2].kind, 2);
    ASSERT_NEAR(model->cameras[0].fov_y_rad, 0.9, 1e-6);
    ASSERT_NEAR(mat34_translation(&model->cameras[0].local).z, 9, 0);
    ASSERT_SAID(f, ASSET_MODEL_WARNING, "orthographic");
    fixture_close(f);
}

TEST(asset_gltf, skins_morphs_and_animations_are_remarked) {
    AssetFixture *f = fixture_open();
    const char *json = fixture_replace(TRIANGLE_JSON, "\"indices\":1",
                                       "\"indices\":1,\"targets\":[{\"POSITION\":0}]");
    json = fixture_replace(json, "\"scene\":0,",
                           "\"skins\":[{\"joints\":[0]}],\"animations\":[{\"channels\":[{"
                           "\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                           "\"samplers\":[{\"input\":0,\"output\":0}]}],\"scene\":0,");
    model_of(f, fixture_load_glb(f, json, &triangle_bin, sizeof triangle_bin));
    assert_int_equal(f->id_count[LOG_ASSET_MODEL_WARNING], 3 + 1); // the parser's own
    fixture_close(f);
}

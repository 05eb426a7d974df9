// systems_coding.c: what a packet says for the G-buffer's codings and the look-ups: common lobes,
// reach of coded distances, the polynomial's table.
#include "../test.h"
#include "systems_fixture.h"
#include <math.h>
#include <stdio.h>

// Count drawables, each with its own place along -z from 5 m on, all of one material.
static void spawn_row(SystemsFixture *f, Entity material, u32 count) {
    DrawableTable *drawables = FIXTURE_TABLE(f, Drawable, drawable);
    for (u32 i = 0; i < count; i++) {
        Entity entity = fixture_spawn_mesh(f, MESH_CUBE, vec3((f32)i, 0, -5), vec3(1, 1, 1), 0, 0);
        for (u32 row = 0; row < drawables->table.count; row++)
            if (drawables->owner[row] == entity) drawables->material[row] = material;
    }
}

static Entity spawn_camera(SystemsFixture *f) {
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    return camera;
}

static Entity spawn_lobe(SystemsFixture *f, Brdf brdf, DiffuseLobe diffuse, AlphaMode mode) {
    Entity entity = fixture_spawn_material(f, mode, 0);
    MaterialTable *materials = FIXTURE_TABLE(f, Material, material);
    u32 row = FIXTURE_ROW(f, material, entity);
    materials->brdf[row] = brdf;
    materials->diffuse[row] = diffuse;
    materials->diffuse_roughness[row] = 0.5f;
    materials->fresnel[row] = brdf == BRDF_PHONG;
    return entity;
}

TEST(systems_coding, common_lobes_are_those_of_most_drawables) {
    SystemsFixture *f = systems_fixture_create(3);
    Entity camera = spawn_camera(f);
    Entity plain = spawn_lobe(f, BRDF_LAMBERT, DIFFUSE_LAMBERT, ALPHA_OPAQUE);
    Entity phong = spawn_lobe(f, BRDF_PHONG, DIFFUSE_OREN_NAYAR, ALPHA_OPAQUE);
    Entity blinn = spawn_lobe(f, BRDF_BLINN_PHONG, DIFFUSE_LAMBERT, ALPHA_OPAQUE);
    Entity glass = spawn_lobe(f, BRDF_BLINN_PHONG_NORMALIZED, DIFFUSE_OREN_NAYAR, ALPHA_BLEND);

    // A level without a highlight.
    spawn_row(f, plain, 4);
    systems_settle(&f->systems, &f->context);
    const FrameRecord *frame = &fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame;
    assert_true(frame->common_lobes[0] == (f32)BRDF_LAMBERT && frame->common_lobes[2] == 1.0f);

    // Most are Lambert, which says nothing about highlights; blended ones do not count.
    spawn_row(f, phong, 2);
    spawn_row(f, blinn, 3);
    spawn_row(f, glass, 9);
    systems_settle(&f->systems, &f->context);
    frame = &fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame;
    assert_true(frame->common_lobes[0] == (f32)BRDF_BLINN_PHONG);
    assert_true(frame->common_lobes[1] == 0.0f && frame->common_lobes[2] == 1.0f &&
                frame->common_lobes[3] == 0.0f);

    // Now the one with Oren-Nayar and Fresnel leads.
    spawn_row(f, phong, 5);
    systems_settle(&f->systems, &f->context);
    frame = &fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame;
    assert_true(frame->common_lobes[0] == (f32)BRDF_PHONG && frame->common_lobes[1] == 1.0f);
    ASSERT_NEAR(frame->common_lobes[2], 1.0 - 0.5 * 0.25 / (0.25 + 0.33), 1e-6);
    ASSERT_NEAR(frame->common_lobes[3], 0.45 * 0.25 / (0.25 + 0.09), 1e-6);

    // Turning away changes nothing: the level decides, not the view.
    FIXTURE_TABLE(f, Transform, transform)->yaw[FIXTURE_ROW(f, transform, camera)] = 180;
    systems_settle(&f->systems, &f->context);
    frame = &fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame;
    assert_true(frame->common_lobes[0] == (f32)BRDF_PHONG);
    systems_fixture_destroy(f);
}

TEST(systems_coding, coded_distances_reach_what_is_seen) {
    static const f32 distances[] = {0.4f, 3.0f, 7.5f, 100.0f, 1000.0f, 5000.0f};
    for (u32 i = 0; i < COUNT_OF(distances); i++) {
        SystemsFixture *f = systems_fixture_create(4);
        Entity camera = spawn_camera(f);
        fixture_spawn_mesh(f, MESH_CUBE, vec3(0, 0, -distances[i]), vec3(0.1f, 0.1f, 0.1f), 0, 0);
        systems_settle(&f->systems, &f->context);
        f32 reach = fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame.coding[0];
        assert_true(reach >= distances[i]);
        assert_true(reach <= MAX(2.0f * (distances[i] + 0.2f), 1.0f));
        assert_true(exp2(round(log2((f64)reach))) == (f64)reach);
        systems_fixture_destroy(f);
    }
}

// As render/lookups.c fills the table and shaders/light.glsl reads it, but with linear
// interpolation in double: 256 texels are enough for any polynomial from 1 cm to 1 km.
TEST(systems_coding, the_polynomial_fits_its_table) {
    static const f32 cases[][3] = {
        {1, 0, 1}, {1, 0.7f, 1.8f},  {0.2f, 0, 4},  {1, 2, 0}, {3, 0, 0},        {0, 1, 0.5f},
        {0, 0, 1}, {1000, 1, 0.01f}, {0.01f, 5, 9}, {0, 2, 0}, {1, 0.001f, 0.2f}};
    for (u32 c = 0; c < COUNT_OF(cases); c++) {
        SystemsFixture *f = systems_fixture_create(5);
        Entity camera = spawn_camera(f);
        Entity entity = fixture_spawn(f, vec3(0, 0, 0));
        FIXTURE_ADD(f, environment, entity);
        EnvironmentTable *environment = FIXTURE_TABLE(f, Environment, environment);
        u32 row = FIXTURE_ROW(f, environment, entity);
        environment->attenuation_constant[row] = cases[c][0];
        environment->attenuation_linear[row] = cases[c][1];
        environment->attenuation_quadratic[row] = cases[c][2];
        systems_settle(&f->systems, &f->context);
        const FrameRecord *frame = &fixture_packet(f, camera, settings_default(), 64, 64, 0)->frame;
        f64 k[3] = {(f64)frame->attenuation[0], (f64)frame->attenuation[1],
                    (f64)frame->attenuation[2]};
        f64 scale = (f64)frame->attenuation[3], factor = (f64)frame->coding[1], worst = 0;
        assert_true((f32)k[0] == cases[c][0]);
        assert_true(scale > 0.0 && factor > 0.0);
        f64 table[256];
        for (u32 i = 0; i < 256; i++) {
            f64 t = i / 255.0, rest = 1.0 - t, along = t * scale;
            table[i] = (k[0] * rest * rest + k[1] * along * rest + k[2] * along * along) * factor;
            assert_true(table[i] >= 0.0 && table[i] <= 1.0 + 1e-6); // fits a half
        }
        for (u32 i = 0; i <= 500; i++) {
            f64 d = exp2(log2(0.01) + i / 500.0 * (log2(1000.0) - log2(0.01)));
            f64 rest = scale / (d + scale), at = (1.0 - rest) * 255.0;
            u32 texel = MIN((u32)at, 254);
            f64 value = table[texel] + (table[texel + 1] - table[texel]) * (at - texel);
            f64 looked_up = rest * rest * factor / value;
            f64 exact = 1.0 / (k[0] + k[1] * d + k[2] * d * d);
            worst = fmax(worst, fabs(looked_up / exact - 1.0));
        }
        printf("    %g + %g d + %g d^2: off by %.4f %% at most, scale %g m\n", k[0], k[1], k[2],
               worst * 100.0, scale);
        assert_true(worst < 0.005);
        systems_fixture_destroy(f);
    }
}

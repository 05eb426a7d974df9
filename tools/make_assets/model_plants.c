// Plants: cypress, rose bush, ivy. A dark solid core gives the silhouette, alpha-masked cards the
// edge; the cards take the crown's normals, so that they are lit as one body.
//
// Data in: fixed seeds. Data out: filled models, origin at the foot. Called through model.c.
#include "models.h"
#include "noise.h"

static float pick(int i, int salt, uint32_t seed) {
    return noise_random((uint32_t)i, (uint32_t)salt, seed);
}

// The core's radius along the height, a flame shape.
static float cypress_radius(float t) {
    return 0.62f * powf(float_clamp(t * 4, 0, 1), 0.6f) * powf(1 - t, 0.62f);
}

static Vec3 cypress_point(const void *context, float u, float v) {
    (void)context;
    float angle = u * 2 * PI_F, y = 0.5f + 5.9f * v;
    float dent = noise_value3(cosf(angle) * 2 + 7, y * 1.6f, sinf(angle) * 2 + 7, 41);
    float r = 0.80f * cypress_radius(v) * (0.72f + 0.5f * dent);
    return vec3(r * cosf(angle), y, -r * sinf(angle));
}

void model_make_tree(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_BARK);
    Vec2 trunk[4] = {{0.24f, -0.05f}, {0.15f, 0.16f}, {0.12f, 0.5f}, {0.1f, 0.8f}};
    shape_turn(&s, trunk, 4, 6);
    soup_use(&s, MAT_HEDGE);
    soup_smooth(&s, 80);
    shape_surface(&s, cypress_point, NULL, 9, 9, vec2(4, 8));
    soup_use(&s, MAT_LEAF_CYPRESS);
    uint32_t first = s.triangle_count;
    const int cards = 96;
    for (int i = 0; i < cards; i++) {
        float t = ((float)i + 0.5f) / (float)cards;
        float angle = (float)i * 2.39996f, y = 0.55f + 5.5f * powf(t, 1.08f);
        float r = cypress_radius((y - 0.5f) / 5.9f) * 0.86f;
        float size = 0.40f + 0.26f * (1 - t) + 0.1f * pick(i, 1, 42);
        Vec3 out = vec3(cosf(angle), 0, -sinf(angle));
        Vec3 right = vec3(-out.z, 0, out.x);
        float turn = (pick(i, 2, 42) - 0.5f) * 1.4f;
        right = vec3_add(vec3_scale(right, cosf(turn)), vec3_scale(out, sinf(turn)));
        Vec3 up = vec3_normalize(vec3_add(vec3(0, 1, 0), vec3_scale(out, 0.22f)));
        Vec3 c = vec3(out.x * r, y + size * 0.35f, out.z * r);
        shape_card(&s, c, vec3_scale(right, size * 0.62f), vec3_scale(up, size));
    }
    for (int i = 0; i < 3; i++) { // the tip
        float a = (float)i * PI_F / 3;
        shape_card(&s, vec3(0, 6.35f, 0), vec3(0.26f * cosf(a), 0, 0.26f * sinf(a)),
                   vec3(0, 0.55f, 0));
    }
    soup_set_crown_normals(&s, first, vec3(0, 2.6f, 0), 0.15f);
    // Upright: a crown this slender is lit from the side.
    for (uint32_t i = first * 3; i < s.triangle_count * 3; i++) {
        Vec3 p = s.position[i];
        s.normal[i] = vec3_normalize(vec3(p.x, 0.22f, p.z));
    }
    model_add_soup(m, "tree", &s);
}

static Vec3 bush_point(const void *context, float u, float v) {
    (void)context;
    float angle = u * 2 * PI_F, lat = (v - 0.5f) * PI_F;
    Vec3 d = vec3(cosf(angle) * cosf(lat), sinf(lat), -sinf(angle) * cosf(lat));
    float r = 0.36f * (0.75f + 0.5f * noise_value3(d.x * 2 + 5, d.y * 2 + 5, d.z * 2 + 5, 43));
    return vec3(d.x * r, 0.5f + d.y * r * 1.05f, d.z * r);
}

void model_make_bush(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_HEDGE);
    shape_tube(&s, vec3(0, -0.03f, 0), vec3(0.02f, 0.42f, 0.03f), 0.05f, 0.04f, 4, false);
    soup_smooth(&s, 80);
    shape_surface(&s, bush_point, NULL, 7, 5, vec2(3, 1.5f));
    soup_use(&s, MAT_LEAF_ROSE);
    uint32_t first = s.triangle_count;
    for (int i = 0; i < 24; i++) {
        float angle = (float)i * 2.39996f, h = ((float)i + 0.5f) / 24;
        float lat = asinf(h * 1.5f - 0.5f);
        Vec3 d = vec3(cosf(angle) * cosf(lat), sinf(lat), -sinf(angle) * cosf(lat));
        Vec3 right = vec3_normalize(vec3_cross(vec3(0.1f, 1, 0.2f), d));
        Vec3 up = vec3_cross(d, right);
        // Tilted off the surface, so that no two cards lie in one plane.
        up = vec3_normalize(vec3_mad(up, d, (pick(i, 1, 44) - 0.3f) * 0.9f));
        float size = 0.24f + 0.09f * pick(i, 2, 44);
        shape_card(&s, vec3_add(vec3(0, 0.52f, 0), vec3_scale(d, 0.38f)), vec3_scale(right, size),
                   vec3_scale(up, size));
    }
    soup_set_crown_normals(&s, first, vec3(0, 0.4f, 0), 0.25f);
    model_add_soup(m, "bush", &s);
}

// A curtain of ivy, 1.6 m wide and 2.4 m high, that hangs in front of a wall at z = 0 (facing -z),
// origin at its top edge.
void model_make_ivy(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_LEAF_IVY);
    for (int i = 0; i < 34; i++) {
        float t = ((float)i + 0.5f) / 34, half = 0.75f * (1 - 0.75f * t * t);
        float x = (pick(i, 1, 45) * 2 - 1) * half;
        float size = 0.34f - 0.1f * t + 0.06f * pick(i, 2, 45);
        float lean = 0.06f + 0.18f * pick(i, 3, 45), spin = (pick(i, 4, 45) - 0.5f) * 0.7f;
        Vec3 up = vec3(sinf(spin), cosf(spin), lean);
        Vec3 right = vec3(-cosf(spin), sinf(spin), (pick(i, 5, 45) - 0.5f) * 0.6f);
        shape_card(&s, vec3(x, -0.12f - 2.05f * t, -0.05f - 0.05f * pick(i, 6, 45)),
                   vec3_scale(right, size), vec3_scale(up, size));
    }
    for (uint32_t i = 0; i < s.triangle_count * 3; i++) {
        Vec3 p = s.position[i];
        s.normal[i] = vec3_normalize(vec3(p.x * 0.5f, 0.25f, -1));
    }
    model_add_soup(m, "ivy", &s);
}

// systems_occlusion.c: what the occlusion buffer hides is hidden: against rays through boxes and
// triangles; the pyramids say what the texels say; near planes; joined polygons.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/occlusion.h"
#include <stdio.h>
#include <string.h>

#define NEAR_M 0.1f

static Entity spawn_occluder(SystemsFixture *f, u64 seed, u32 i, f32 spread) {
    Entity e = fixture_spawn(f, vec3(random_range(seed, 1, i, -spread, spread),
                                     random_range(seed, 2, i, -spread * 0.5f, spread * 0.5f),
                                     random_range(seed, 3, i, -1.8f * spread, 0.2f * spread)));
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 place = FIXTURE_ROW(f, transform, e), row = FIXTURE_ADD(f, occluder, e);
    t->yaw[place] = random_range(seed, 4, i, 0, 360);
    t->pitch[place] = random_range(seed, 5, i, -40, 40);
    t->scale_x[place] = random_range(seed, 6, i, 0.5f, 2);
    OccluderTable *o = FIXTURE_TABLE(f, Occluder, occluder);
    o->size_x[row] = random_range(seed, 7, i, 0.5f, 9);
    o->size_y[row] = random_range(seed, 8, i, 0.5f, 9);
    o->size_z[row] = random_range(seed, 9, i, 0.1f, 3);
    o->center_y[row] = random_range(seed, 10, i, -1, 1);
    return e;
}

// Does the segment from the eye to a point pass through any box? Slabs, in each box's own space.
static bool boxes_block(const SystemsFixture *f, Vec3 eye, Vec3 point) {
    const OccluderTable *o = FIXTURE_TABLE(f, Occluder, occluder);
    const TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    for (u32 row = 0; row < o->table.count; row++) {
        Mat34 m;
        columns_get_mat34(&t->w00, table_row(&t->table, o->table.entity[row]), m.m);
        Mat34 inverse = mat34_inverse(m);
        Vec3 a = mat34_point(&inverse, eye), b = mat34_point(&inverse, point);
        f64 from[3] = {a.x, a.y, a.z}, to[3] = {b.x, b.y, b.z}, low = 0, high = 1;
        f64 size[3] = {o->size_x[row], o->size_y[row], o->size_z[row]};
        f64 center[3] = {o->center_x[row], o->center_y[row], o->center_z[row]};
        for (u32 k = 0; k < 3; k++) {
            f64 d = to[k] - from[k], t0 = (center[k] - size[k] * 0.5 - from[k]) / d,
                t1 = (center[k] + size[k] * 0.5 - from[k]) / d;
            low = MAX(low, MIN(t0, t1)), high = MIN(high, MAX(t0, t1));
        }
        if (low < high) return true;
    }
    return false;
}

static Vec3 point_in_sphere(u64 seed, u32 stream, u32 i, Vec3 center, f32 radius) {
    for (u32 k = 0;; k++) {
        Vec3 p = {random_range(seed, stream, i * 64 + k * 3, -1, 1),
                  random_range(seed, stream, i * 64 + k * 3 + 1, -1, 1),
                  random_range(seed, stream, i * 64 + k * 3 + 2, -1, 1)};
        if (vec3_dot(p, p) <= 1.0f) return vec3_add(center, vec3_scale(p, radius));
    }
}

// In the picture, in front of the near plane?
static bool in_view(const PacketView *v, Vec3 p) {
    Vec3 d = vec3_sub(p, v->position);
    f32 z = vec3_dot(d, v->forward);
    return z > v->near && fabsf(vec3_dot(d, v->right)) < z * v->tan_x &&
           fabsf(vec3_dot(d, v->up)) < z * v->tan_y;
}

static Entity spawn_camera(SystemsFixture *f, u64 seed, u32 i) {
    Entity e =
        fixture_spawn(f, vec3(random_range(seed, 20, i, -3, 3), random_range(seed, 21, i, -2, 2),
                              random_range(seed, 22, i, -3, 3)));
    u32 row = FIXTURE_ADD(f, camera, e);
    FIXTURE_TABLE(f, Camera, camera)->near[row] = NEAR_M;
    FIXTURE_TABLE(f, Camera, camera)->fov[row] = random_range(seed, 23, i, 30, 100);
    FIXTURE_TABLE(f, Transform, transform)->yaw[FIXTURE_ROW(f, transform, e)] =
        random_range(seed, 24, i, -40, 40);
    return e;
}

TEST(systems_occlusion, what_is_hidden_no_ray_reaches) {
    const u64 seed = 0x0CC1;
    u32 hidden = 0, tested = 0;
    printf("seed %llx\n", (unsigned long long)seed);
    for (u32 round = 0; round < 60; round++) {
        SystemsFixture *f = systems_fixture_create(5);
        // In every third round the eye stands among the boxes: many cross the near plane.
        for (u32 i = 0; i < 12; i++)
            spawn_occluder(f, seed + round, i, round % 3 == 0 ? 4.0f : 14.0f);
        Entity camera = spawn_camera(f, seed, round);
        systems_settle(&f->systems, &f->context);
        PacketView view = packet_make_view(f->world, camera, 320, round % 2 ? 180 : 480);
        OcclusionBuffer *buffer =
            occlusion_draw(f->world, &f->assets, NULL, &view, &f->arenas.scratch);
        for (u32 i = 0; i < 400; i++) {
            Vec3 c = {random_range(seed + round, 30, i, -20, 20),
                      random_range(seed + round, 31, i, -9, 9),
                      random_range(seed + round, 32, i, -35, 2)};
            f32 radius = random_range(seed + round, 33, i, 0.05f, 2.0f);
            tested++;
            if (!occlusion_hides_sphere(buffer, c, radius)) continue;
            hidden++;
            for (u32 k = 0; k < 60; k++) {
                Vec3 p = point_in_sphere(seed + round, 34 + i, k, c, radius);
                if (in_view(&view, p)) assert_true(boxes_block(f, view.position, p));
            }
        }
        systems_fixture_destroy(f);
    }
    printf("    %u of %u spheres hidden\n", hidden, tested);
    assert_true(hidden > tested / 20);
}

// The rectangle texel by texel, from the definition.
static bool naive_hides(const OcclusionBuffer *b, Vec3 center, f32 radius) {
    const PacketView *v = &b->view;
    Vec3 d = vec3_sub(center, v->position);
    f32 z = vec3_dot(d, v->forward), nearest = z - radius, x0, x1, y0, y1;
    if (nearest <= v->near) return false;
    if (!sphere_bounds_axis(vec3_dot(d, v->right), -z, radius, v->near, 1 / v->tan_x, &x0, &x1) ||
        !sphere_bounds_axis(vec3_dot(d, v->up), -z, radius, v->near, 1 / v->tan_y, &y0, &y1))
        return false;
    f64 w = b->width[0], h = b->height[0];
    for (u32 y = 0; y < b->height[0]; y++)
        for (u32 x = 0; x < b->width[0]; x++) {
            // Texels that the rectangle overlaps by more than the code's slack.
            if ((x + 1 - 0.01) / w * 2 - 1 < (f64)x0 || (x + 0.01) / w * 2 - 1 > (f64)x1 ||
                1 - (y + 1 - 0.01) / h * 2 > (f64)y1 || 1 - (y + 0.01) / h * 2 < (f64)y0)
                continue;
            if (b->low[0][y * b->width[0] + x] * nearest <= 1.0f) return false;
        }
    return true;
}

TEST(systems_occlusion, pyramids_say_what_texels_say) {
    const u64 seed = 0x0CC2;
    u32 hidden = 0, differ = 0, total = 0;
    for (u32 round = 0; round < 12; round++) {
        SystemsFixture *f = systems_fixture_create(5);
        for (u32 i = 0; i < 16; i++) spawn_occluder(f, seed + round, i, 14.0f);
        Entity camera = spawn_camera(f, seed, round);
        systems_settle(&f->systems, &f->context);
        PacketView view = packet_make_view(f->world, camera, 333, 191);
        OcclusionBuffer *b = occlusion_draw(f->world, &f->assets, NULL, &view, &f->arenas.scratch);
        for (u32 i = 0; i < 400; i++, total++) {
            Vec3 c = {random_range(seed + round, 30, i, -20, 20),
                      random_range(seed + round, 31, i, -9, 9),
                      random_range(seed + round, 32, i, -35, 2)};
            f32 radius = random_range(seed + round, 33, i, 0.05f, 2.0f);
            bool fast = occlusion_hides_sphere(b, c, radius), slow = naive_hides(b, c, radius);
            if (fast) assert_true(slow); // slack may only keep more
            hidden += slow;
            differ += fast != slow;
        }
        systems_fixture_destroy(f);
    }
    printf("    %u of %u hidden, %u kept by slack\n", hidden, total, differ);
    assert_true(hidden > 200 && differ * 50 < hidden);
}

TEST(systems_occlusion, eye_inside_and_at_the_wall) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity wall = fixture_spawn(f, vec3(0, 0, -2));
    u32 row = FIXTURE_ADD(f, occluder, wall);
    OccluderTable *o = FIXTURE_TABLE(f, Occluder, occluder);
    o->size_x[row] = 200, o->size_y[row] = 200, o->size_z[row] = 1;
    Entity camera = fixture_spawn(f, vec3(0, 0, 0));
    FIXTURE_ADD(f, camera, camera);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    static const struct {
        f32 eye_z;
        bool hides;
    } cases[] = {
        {5, true},      {0, true},   {-1.3f, true},   {-1.405f, false}, // near plane inside
        {-1.6f, false}, {-2, false}, {-2.45f, false}, {-3, false}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        t->z[FIXTURE_ROW(f, transform, camera)] = cases[i].eye_z;
        table_touch(&t->table, FIXTURE_ROW(f, transform, camera));
        systems_settle(&f->systems, &f->context);
        PacketView view = packet_make_view(f->world, camera, 64, 64);
        OcclusionBuffer *b = occlusion_draw(f->world, &f->assets, NULL, &view, &f->arenas.scratch);
        assert_int_equal(occlusion_hides_sphere(b, vec3(0, 0, -8), 1), cases[i].hides);
        assert_false(occlusion_hides_sphere(b, vec3(0, 0, cases[i].eye_z), 0.5f));
        // Nothing in front of the wall, and nothing that reaches through it.
        assert_false(occlusion_hides_sphere(b, vec3(0, 0, -1.2f), 0.2f));
        assert_false(occlusion_hides_sphere(b, vec3(0, 0, -2.0f), 0.6f));
    }
    systems_fixture_destroy(f);
}

// ---- meshes ----

static bool triangles_block(const Mesh *mesh, const Mat34 *place, Vec3 eye, Vec3 point) {
    Vec3 d = vec3_sub(point, eye);
    for (u32 i = 0; i + 2 < mesh->index_count; i += 3) {
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) {
            const f32 *v = mesh->vertices[mesh->indices[i + k]].position;
            p[k] = mat34_point(place, vec3(v[0], v[1], v[2]));
        }
        Vec3 e1 = vec3_sub(p[1], p[0]), e2 = vec3_sub(p[2], p[0]), q = vec3_cross(d, e2);
        f32 det = vec3_dot(e1, q);
        if (det <= 0.0f) continue; // seen from behind: not drawn
        Vec3 s = vec3_sub(eye, p[0]), r = vec3_cross(s, e1);
        f32 u = vec3_dot(s, q) / det, v = vec3_dot(d, r) / det, w = vec3_dot(e2, r) / det;
        // A ray along an edge of two triangles must not slip through.
        if (u >= -1e-4f && v >= -1e-4f && u + v <= 1.0001f && w > 0.0f && w < 1.0f) return true;
    }
    return false;
}

static void occlude_by_mesh(SystemsFixture *f, Entity entity) {
    u32 row = FIXTURE_ADD(f, occluder, entity); // may move the columns
    FIXTURE_TABLE(f, Occluder, occluder)->shape[row] = OCCLUDER_MESH;
}

TEST(systems_occlusion, meshes_hide_as_their_triangles_do) {
    const u64 seed = 0x0CC3;
    AssetStore store;
    assert_true(asset_store_create(&store));
    static const ShapeDesc shapes[] = {{.shape = SHAPE_CUBE},
                                       {.shape = SHAPE_CYLINDER, .segments = 12},
                                       {.shape = SHAPE_ICOSAHEDRON},
                                       {.shape = SHAPE_CUBE, .inverted = true},
                                       {.shape = SHAPE_PLANE, .segments = 4}};
    u32 hidden_by[COUNT_OF(shapes)] = {0};
    for (u32 s = 0; s < COUNT_OF(shapes); s++) {
        u32 model = asset_generate_model(&store, &shapes[s]);
        u32 mesh = store.models[model].parts[0].mesh;
        for (u32 round = 0; round < 12; round++) {
            SystemsFixture *f = systems_fixture_create(5);
            f->context.assets = &store;
            Entity e = fixture_spawn_mesh(f, mesh, vec3(0, 0, -8), vec3(9, 7, 3), (f32)round * 29,
                                          COLLISION_NONE);
            TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
            t->pitch[FIXTURE_ROW(f, transform, e)] = s == 4 ? 70.0f : 10.0f;
            occlude_by_mesh(f, e);
            DrawableTable *d = FIXTURE_TABLE(f, Drawable, drawable);
            systems_settle(&f->systems, &f->context);
            PacketView view = packet_make_view(f->world, ENTITY_NONE, 160, 90);
            OcclusionBuffer *b = occlusion_draw(f->world, &store, NULL, &view, &f->arenas.scratch);
            Mat34 place;
            columns_get_mat34(&d->w00, 0, place.m);
            for (u32 i = 0; i < 300; i++) {
                Vec3 c = {random_range(seed, 1, i, -9, 9), random_range(seed, 2, i, -6, 6),
                          random_range(seed, 3, i, -30, -1)};
                f32 radius = random_range(seed, 4, i, 0.05f, 1.0f);
                if (!occlusion_hides_sphere(b, c, radius)) continue;
                hidden_by[s]++;
                for (u32 k = 0; k < 40; k++) {
                    Vec3 p = point_in_sphere(seed + i, 5, k, c, radius);
                    if (in_view(&view, p))
                        assert_true(triangles_block(&store.meshes[mesh], &place, view.position, p));
                }
            }
            systems_fixture_destroy(f);
        }
    }
    printf("    hidden: cube %u cylinder %u icosahedron %u inverted %u plane %u\n", hidden_by[0],
           hidden_by[1], hidden_by[2], hidden_by[3], hidden_by[4]);
    for (u32 s = 0; s < COUNT_OF(shapes); s++) assert_true(hidden_by[s] > 20);
    asset_store_destroy(&store);
}

TEST(systems_occlusion, coplanar_triangles_are_joined) {
    AssetStore store;
    assert_true(asset_store_create(&store));
    static const struct {
        ShapeDesc desc;
        u32 polygons, points; // of the largest polygon
    } cases[] = {{{.shape = SHAPE_CUBE}, 6, 4},
                 {{.shape = SHAPE_PLANE, .segments = 1}, 1, 4},
                 {{.shape = SHAPE_ICOSAHEDRON}, 20, 3},
                 // Eight sides; caps are fans around a middle, of which half stays convex.
                 {{.shape = SHAPE_CYLINDER, .segments = 8}, 14, 6}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        SystemsFixture *f = systems_fixture_create(5);
        u32 model = asset_generate_model(&store, &cases[i].desc);
        u32 mesh = store.models[model].parts[0].mesh;
        Entity e = fixture_spawn_mesh(f, mesh, vec3(0, 0, 0), vec3(1, 1, 1), 0, COLLISION_NONE);
        occlude_by_mesh(f, e);
        OccluderPolygons *p =
            occluder_polygons_build(f->world, &store, &f->arenas.level, &f->arenas.scratch);
        u32 most = 0;
        for (u32 k = 0; k < p->polygon_count; k++) most = MAX(most, p->begin[k + 1] - p->begin[k]);
        printf("    shape %u: %u polygons, up to %u points\n", i, p->polygon_count, most);
        assert_int_equal(p->polygon_count, cases[i].polygons);
        assert_int_equal(most, cases[i].points);
        assert_int_equal(f->arenas.scratch.used, 0);
        systems_fixture_destroy(f);
    }
    asset_store_destroy(&store);
}

TEST(systems_occlusion, packets_leave_hidden_things_out) {
    const u64 seed = 0x0CC4;
    u64 sizes[3];
    for (u32 run = 0; run < 3; run++) {
        jobs_start(run + 1);
        SystemsFixture *f = systems_fixture_create(5);
        fixture_fill(f, seed, 1500);
        for (u32 i = 0; i < 12; i++) spawn_occluder(f, seed, i, 10.0f);
        systems_settle(&f->systems, &f->context);
        RenderSettings settings = settings_default();
        settings.view = VIEW_OCCLUDERS;
        const Packet *on = fixture_packet(f, ENTITY_NONE, settings, 320, 180, 0);
        assert_null(packet_validate(on, on->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
        assert_true(on->counts.occluders > 3);
        assert_int_equal(on->occluder_depths.count,
                         on->counts.occluder_width * on->counts.occluder_height);
        assert_int_equal(on->counts.occluder_width, OCCLUSION_WIDTH);
        assert_int_equal(on->counts.occluder_height, 144);
        settings.occlusion = 0;
        const Packet *off = fixture_packet(f, ENTITY_NONE, settings, 320, 180, 0);
        assert_int_equal(off->counts.lights_occluded, 0);
        assert_int_equal(off->counts.drawables_occluded, 0);
        assert_int_equal(off->occluder_depths.count, 0);
        assert_true(on->counts.lights_occluded > 50 && on->counts.drawables_occluded > 20);
        assert_int_equal(on->counts.drawables_visible + on->counts.drawables_occluded,
                         off->counts.drawables_visible);
        sizes[run] = on->size;
        systems_fixture_destroy(f);
        jobs_stop();
    }
    assert_true(sizes[0] == sizes[1] && sizes[1] == sizes[2]);
}

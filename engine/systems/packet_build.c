// packet_build.c: the world as one frame sees it, in one block of memory.
// Data in: the world after a tick, the loaded assets, a camera, settings, texts. Data out: a
// packet (frame/packet.h). Called by: shells, tools and tests, once a frame, main thread. Does
// not: change the world, keep anything between frames, or know a GPU.
//
// Everything is collected in scratch memory first, then the packet is laid out once, and the large
// arrays (instances, light lists) are written right into it. The same world and desc give the same
// bytes with any number of threads.
#include "gi.h"
#include "packet_lists.h"
#include "occlusion.h"
#include "../base/clock.h"
#include "../base/hash.h"
#include <string.h>

// ---- view ----

PacketView packet_make_view(const World *world, Entity camera, u32 width_px, u32 height_px) {
    const TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    const CameraTable *cameras = WORLD_TABLE(world, Camera, camera);
    u32 place = table_row(&transforms->table, camera);
    u32 lens = table_row(&cameras->table, camera);
    Mat34 matrix = mat34_identity();
    if (place != ROW_NONE) columns_get_mat34(&transforms->w00, place, matrix.m);
    f32 fov_deg = 60.0f;
    PacketView view = {.near = 0.1f, .height_px = (f32)height_px};
    if (lens != ROW_NONE) {
        fov_deg = CLAMP(cameras->fov[lens], 1.0f, 170.0f);
        view.near = CLAMP(cameras->near[lens], 1e-4f, 1e3f);
    }
    f32 fov_rad = DEG_TO_RAD(fov_deg), aspect = (f32)width_px / (f32)height_px;

    // A camera below a scaled parent must not scale the world: only directions are taken.
    const f32 *m = matrix.m;
    view.position = mat34_translation(&matrix);
    view.forward = vec3_normalize(vec3(-m[2], -m[6], -m[10]));
    view.right = vec3_normalize(vec3_cross(view.forward, vec3(m[1], m[5], m[9])));
    if (!(vec3_dot(view.forward, view.forward) > 0.5f && vec3_dot(view.right, view.right) > 0.5f))
        view.forward = vec3(0, 0, -1), view.right = vec3(1, 0, 0); // a flattened matrix
    view.up = vec3_cross(view.right, view.forward);
    view.tan_y = det_tan(fov_rad * 0.5f);
    view.tan_x = view.tan_y * aspect;

    Vec3 r = view.right, u = view.up, f = view.forward, p = view.position;
    view.view = (Mat4){{r.x, u.x, -f.x, 0, r.y, u.y, -f.y, 0, r.z, u.z, -f.z, 0, -vec3_dot(r, p),
                        -vec3_dot(u, p), vec3_dot(f, p), 1}};
    view.view_projection =
        mat4_mul(mat4_perspective_reversed(fov_rad, aspect, view.near), view.view);
    view.frustum = frustum_from_matrix(&view.view_projection);
    return view;
}

static void set_vec4(f32 *out, f32 x, f32 y, f32 z, f32 w) {
    out[0] = x, out[1] = y, out[2] = z, out[3] = w;
}

static void write_frame(FrameRecord *frame, const PacketBuildDesc *desc, const PacketView *view,
                        const LightParts *lights, const GiParams *gi, const Environment *e) {
    Vec3 right = vec3_scale(view->right, view->tan_x), up = vec3_scale(view->up, view->tan_y);
    Vec3 p = view->position, f = view->forward;
    f32 width = (f32)desc->width_px, height = (f32)desc->height_px, glow = e->ambient_intensity;
    if (gi->enabled) glow *= gi->ambient; // bounced light takes its place
    // The shader's clock wraps once an hour: more digits would only make it step.
    f32 time_s = (f32)(desc->world->tick % (3600u * TICK_RATE)) / TICK_RATE;
    memcpy(frame->view_projection, view->view_projection.m, sizeof frame->view_projection);
    memcpy(frame->view, view->view.m, sizeof frame->view);
    memcpy(frame->previous_view_projection,
           desc->previous_view_projection ? desc->previous_view_projection
                                          : view->view_projection.m,
           sizeof frame->previous_view_projection);
    set_vec4(frame->camera, p.x, p.y, p.z, view->near);
    set_vec4(frame->ray_right, right.x, right.y, right.z, 0);
    set_vec4(frame->ray_up, up.x, up.y, up.z, 0);
    set_vec4(frame->ray_forward, f.x, f.y, f.z, 0);
    set_vec4(frame->viewport, width, height, 1.0f / width, 1.0f / height);
    set_vec4(frame->ambient, e->ambient_r * glow, e->ambient_g * glow, e->ambient_b * glow,
             e->exposure * desc->settings.exposure);
    set_vec4(frame->sky_zenith, e->sky_zenith_r, e->sky_zenith_g, e->sky_zenith_b, e->stars);
    set_vec4(frame->sky_horizon, e->sky_horizon_r, e->sky_horizon_g, e->sky_horizon_b, time_s);
    set_vec4(frame->attenuation, e->attenuation_constant, e->attenuation_linear,
             e->attenuation_quadratic, 0);
    frame->vertex_lighting[0] = lights->vertex_lighting;
    frame->counts[0] = lights->point_count;
    frame->counts[1] = lights->spot_count;
    frame->counts[2] = lights->screen_directional_count;
    frame->counts2[2] = lights->point_count + lights->spot_count;
    frame->counts2[3] = desc->world->tick;
    frame->counts3[0] = lights->point_highlights;
    frame->counts3[1] = lights->spot_highlights;
}

// ---- codings ----

// What the tabulated polynomial needs (render/lookups.c): attenuation.w, the distance at which it
// has bent half-way, and coding.y, 1 / a bound of (1-t)^2 (kc + kl d + kq d^2) for t in 0..1.
static void write_falloff(FrameRecord *frame) {
    f32 c = frame->attenuation[0], l = frame->attenuation[1], q = frame->attenuation[2];
    f32 scale = 0.1f; // of q alone: the curve is steep near the light
    if (c > 0.0f && q > 0.0f)
        scale = (sqrtf(l * l + 4.0f * c * q) - l) / (2.0f * q); // l d + q d^2 = c
    else if (l > 0.0f)
        scale = c > 0.0f ? c / l : q > 0.0f ? l / q : 1.0f;
    else if (c > 0.0f)
        scale = 1e6f; // a constant: t stays at 0
    scale = CLAMP(scale, 1e-3f, 1e6f);
    f32 bound = c + l * scale * 0.25f + q * scale * scale;
    frame->attenuation[3] = scale;
    frame->coding[1] = bound > 0.0f ? 1.0f / bound : 1.0f;
}

// Reach of coded distances: the power of two that covers all that the view draws opaquely. One of
// its visible drawables' spheres decides, so it steps rarely.
static f32 coding_reach(const DrawableTable *d, const DrawLists *draws, const PacketView *view) {
    f32 farthest = 0.0f, reach = 1.0f;
    for (u32 i = 0; i < draws->row_count; i++) {
        u32 row = draws->rows[i];
        Vec3 to = {d->bounds_x[row] - view->position.x, d->bounds_y[row] - view->position.y,
                   d->bounds_z[row] - view->position.z};
        farthest = MAX(farthest, vec3_length(to) + d->bounds_radius[row]);
    }
    while (reach < farthest && reach < 1e9f) reach *= 2.0f;
    return reach;
}

// ---- culling ----

typedef struct RowList {
    u32 *rows;
    u32 count;
} RowList;

static RowList cull_drawables(const World *world, const Frustum *frustum, Arena *scratch) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    RowList list = {ARENA_PUSH(scratch, u32, ALIGN_UP(d->table.count, SIMD_WIDTH)), 0};
    list.count = cull_spheres(frustum, d->bounds_x, d->bounds_y, d->bounds_z, d->bounds_radius,
                              d->table.count, list.rows);
    return list;
}

// Takes those behind occluders out of the list; returns how many.
static u32 hide_drawables(const World *world, const OcclusionBuffer *occlusion, RowList *list,
                          Arena *scratch) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    u32 before = list->count;
    list->count = occlusion_cull(occlusion, d->bounds_x, d->bounds_y, d->bounds_z, d->bounds_radius,
                                 list->rows, list->count, scratch);
    return before - list->count;
}

// ---- the packet ----

typedef struct Parts {
    PacketView view;
    OcclusionBuffer *occlusion; // NULL = there are no occluders, or they are switched off
    u32 drawables_occluded;
    GiParts gi;
    LightParts lights;
    FrameRecord frame;
    LightLists lists;
    MaterialPalette *palette;
    DrawLists draws, shadow;
    ShadowFit shadow_fit;
    PostParts posts;
    u32 shadow_size_px, emissive_count, character_count;
} Parts;

static bool draw_is_emissive(const MaterialPalette *palette, const PacketDraw *draw) {
    return palette->bindings[draw->material].emissive_pass;
}

static void write_draws(Packet *packet, const Parts *parts) {
    PacketDraw *out[3] = {PACKET_WRITE(packet, opaque_draws, PacketDraw),
                          PACKET_WRITE(packet, mask_draws, PacketDraw),
                          PACKET_WRITE(packet, blend_draws, PacketDraw)};
    PacketDraw *emissive = PACKET_WRITE(packet, emissive_draws, PacketDraw);
    for (u32 alpha = 0; alpha < 3; alpha++) {
        for (u32 i = 0; i < parts->draws.counts[alpha]; i++) {
            const PacketDraw *draw = &parts->draws.lists[alpha][i];
            out[alpha][i] = *draw;
            if (draw_is_emissive(parts->palette, draw)) *emissive++ = *draw;
        }
    }
    PacketDraw *shadow[2] = {PACKET_WRITE(packet, shadow_draws, PacketDraw),
                             PACKET_WRITE(packet, shadow_mask_draws, PacketDraw)};
    for (u32 alpha = 0; alpha < 2; alpha++) {
        for (u32 i = 0; i < parts->shadow.counts[alpha]; i++) {
            shadow[alpha][i] = parts->shadow.lists[alpha][i];
            shadow[alpha][i].first_instance += parts->draws.row_count;
        }
    }
}

// All that a shadow map's texels follow from.
static u64 hash_shadow(const Packet *packet, const Parts *parts, u64 store_stamp) {
    const InstanceRecord *instances =
        PACKET_DATA(packet, instances, InstanceRecord) + parts->draws.row_count;
    u64 key = hash_bytes(packet->frame.shadow_matrix, sizeof packet->frame.shadow_matrix,
                         store_stamp ^ packet->shadow_size_px);
    key = hash_bytes(instances, (u64)parts->shadow.row_count * sizeof *instances, key);
    // Draws without first_instance, which hangs on how many instances the view has.
    const PacketSection lists[2] = {packet->shadow_draws, packet->shadow_mask_draws};
    for (u32 list = 0; list < 2; list++) {
        const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + lists[list].offset);
        for (u32 i = 0; i < lists[list].count; i++) {
            const PacketMaterial *binding = &parts->palette->bindings[draws[i].material];
            f32 cutoff = parts->palette->records[draws[i].material].albedo[3];
            u32 words[7] = {list,
                            draws[i].mesh,
                            draws[i].lod,
                            draws[i].instance_count,
                            binding->double_sided,
                            binding->albedo_texture};
            memcpy(&words[6], &cutoff, sizeof cutoff);
            key = hash_bytes(words, sizeof words, key);
        }
    }
    return key;
}

static void write_shadow(Packet *packet, const Parts *parts, const Environment *environment,
                         u64 store_stamp) {
    packet->shadow_size_px = parts->shadow_size_px;
    memcpy(packet->frame.shadow_matrix, mat4_identity().m, sizeof packet->frame.shadow_matrix);
    if (parts->shadow_size_px == 0) return;
    const ShadowFit *fit = &parts->shadow_fit;
    Mat4 matrix = shadow_fit_matrix(fit);
    memcpy(packet->frame.shadow_matrix, matrix.m, sizeof matrix.m);
    // Offset along the normal: what a slanted surface rises over one and a half texels at 45
    // degrees; the bias takes half a texel off the rest, in units of the depth range.
    set_vec4(packet->frame.shadow, 1.0f / (f32)parts->shadow_size_px, 1.5f * fit->texel_m,
             environment->shadow_distance, 0.5f * fit->texel_m / (fit->front - fit->rear));
    PACKET_WRITE(packet, directionals, DirectionalRecord)
    [parts->lights.shadow_index].color[3] = 1.0f;
    packet->shadow_key = hash_shadow(packet, parts, store_stamp);
}

static void write_texts(Packet *packet, const PacketBuildDesc *desc) {
    PacketText *out = PACKET_WRITE(packet, texts, PacketText);
    u8 *characters = PACKET_WRITE(packet, characters, u8);
    u32 offset = 0;
    for (u32 i = 0; i < desc->text_count; i++) {
        const PacketText2D *text = &desc->texts[i];
        u32 length = (u32)strlen(text->text);
        out[i] = (PacketText){text->x_px, text->y_px, text->size_px, text->color, offset, length};
        memcpy(characters + offset, text->text, length);
        offset += length;
    }
}

static void write_gi(Packet *packet, const PacketBuildDesc *desc, const Parts *parts) {
    const GiParts *gi = &parts->gi;
    const DrawLists *still = &gi->draws[0], *moving = &gi->draws[1];
    packet->gi.params = gi->params;
    packet->gi.record = gi->record;
    if (!gi->params.enabled) return;
    packet->gi.record.counts[0] = packet->traced_lights.count;
    packet->gi.record.counts[1] = packet->gi_instances.count;
    InstanceRecord *instances = PACKET_WRITE(packet, gi_instances, InstanceRecord);
    packet_write_instances(desc->world, still, instances);
    packet_write_instances(desc->world, moving, instances + still->row_count);
    PacketDraw *draws = PACKET_WRITE(packet, gi_dynamic_draws, PacketDraw);
    memcpy(PACKET_WRITE(packet, gi_static_draws, PacketDraw), still->lists[0],
           still->counts[0] * sizeof *draws);
    for (u32 i = 0; i < moving->counts[0]; i++) {
        draws[i] = moving->lists[0][i];
        draws[i].first_instance += still->row_count;
    }
    gi_write_keys(packet, desc->assets->stamp);
}

static u32 occluder_texels(const PacketBuildDesc *desc, const OcclusionBuffer *buffer) {
    bool shown = buffer && desc->settings.view == VIEW_OCCLUDERS;
    return shown ? buffer->width[0] * buffer->height[0] : 0;
}

// Depth in metres, 0 = nothing.
static void write_occluders(Packet *packet, const OcclusionBuffer *buffer) {
    f32 *out = PACKET_WRITE(packet, occluder_depths, f32);
    for (u32 i = 0; i < packet->occluder_depths.count; i++)
        out[i] = buffer->low[0][i] > 1e-9f ? 1.0f / buffer->low[0][i] : 0.0f;
    if (!buffer) return;
    packet->counts.occluders = buffer->occluders;
    packet->counts.occluder_width = buffer->width[0];
    packet->counts.occluder_height = buffer->height[0];
}

static Packet *write_packet(const PacketBuildDesc *desc, const Parts *parts,
                            const Environment *environment, Arena *out) {
    const LightParts *lights = &parts->lights;
    u32 light_count = lights->point_count + lights->spot_count;
    PacketSizes sizes = {
        .instances = parts->draws.row_count + parts->shadow.row_count,
        .opaque_draws = parts->draws.counts[ALPHA_OPAQUE],
        .mask_draws = parts->draws.counts[ALPHA_MASK],
        .blend_draws = parts->draws.counts[ALPHA_BLEND],
        .emissive_draws = parts->emissive_count,
        .shadow_draws = parts->shadow.counts[ALPHA_OPAQUE],
        .shadow_mask_draws = parts->shadow.counts[ALPHA_MASK],
        .materials = parts->palette->count,
        .material_bindings = parts->palette->count,
        .lights = light_count + 1,
        .spots = lights->spot_count,
        .directionals = lights->directional_count,
        .cells = parts->lists.cell_count,
        .light_indices = parts->lists.index_count,
        .grid_nodes = parts->lists.node_count,
        .gi_instances = parts->gi.draws[0].row_count + parts->gi.draws[1].row_count,
        .gi_static_draws = parts->gi.draws[0].counts[0],
        .gi_dynamic_draws = parts->gi.draws[1].counts[0],
        .gi_lights = lights->gi_count,
        .gi_lists = parts->gi.list_count,
        .traced_lights = lights->traced_count,
        .light_marks = lights->mark_count,
        .occluder_depths = occluder_texels(desc, parts->occlusion),
        .posts = parts->posts.count,
        .texts = desc->text_count,
        .characters = parts->character_count,
    };
    Packet *packet = packet_allocate(out, &sizes);
    packet->tick = desc->world->tick;
    packet->width_px = desc->width_px;
    packet->height_px = desc->height_px;
    packet->brdf_mask = parts->palette->brdf_mask;
    packet->attenuation = environment->attenuation;
    packet->settings = desc->settings;
    packet->frame = parts->frame;
    memcpy(packet->frame.common_lobes, parts->palette->common_lobes,
           sizeof packet->frame.common_lobes);
    packet->frame.coding[0] =
        coding_reach(WORLD_TABLE(desc->world, Drawable, drawable), &parts->draws, &parts->view);
    write_falloff(&packet->frame);
    packet->frame.counts2[0] = sizes.materials;
    packet->frame.counts2[1] = sizes.instances;

    InstanceRecord *instances = PACKET_WRITE(packet, instances, InstanceRecord);
    packet_write_instances(desc->world, &parts->draws, instances);
    packet_write_instances(desc->world, &parts->shadow, instances + parts->draws.row_count);
    write_draws(packet, parts);
#define COPY(section, Type, from)                                                                  \
    memcpy(PACKET_WRITE(packet, section, Type), from, (u64)sizes.section * sizeof(Type))
    COPY(materials, MaterialRecord, parts->palette->records);
    COPY(material_bindings, PacketMaterial, parts->palette->bindings);
    COPY(lights, LightRecord, lights->lights);
    COPY(spots, SpotRecord, lights->spots);
    COPY(directionals, DirectionalRecord, lights->directionals);
    COPY(gi_lights, GiLightRecord, lights->gi_lights);
    if (sizes.gi_lists) COPY(gi_lists, u32, parts->gi.lists);
    COPY(traced_lights, TracedLightRecord, lights->traced);
    COPY(light_marks, PacketLightMark, lights->marks);
    COPY(posts, PacketPost, parts->posts.posts);
#undef COPY
    write_shadow(packet, parts, environment, desc->assets->stamp);
    write_gi(packet, desc, parts);
    packet->flags = gi_find_flags(desc->world, &packet->gi, desc->previous_gi, desc->last_stamp);
    if (desc->cold) packet->flags |= PACKET_COLD;
    write_texts(packet, desc);
    packet->counts = (PacketCounts){
        .lights_total = lights->total,
        .lights_visible = lights->visible,
        .lights_occluded = lights->occluded,
        .lights_merged_pairs = lights->merged_pairs,
        .lights_merged = lights->merged,
        .lights_dropped = lights->dropped,
        .lights_over_budget = lights->over_budget,
        .lights_fading = lights->fading,
        .lights_near = lights->near,
        .lights_between = lights->between,
        .lights_far = lights->far,
        .merge_error = lights->merge_error,
        .drawables_occluded = parts->drawables_occluded,
        .drawables_total = WORLD_TABLE(desc->world, Drawable, drawable)->table.count,
        .drawables_visible = parts->draws.row_count,
        .shadow_casters = parts->shadow.row_count,
        .triangles = parts->draws.triangles,
        .gi_lights = lights->gi_count,
        .gi_light_indices = parts->gi.list_index_count,
        .lights_traced = lights->traced_local,
    };
    write_occluders(packet, parts->occlusion);
    return packet;
}

static void collect_gi(const PacketBuildDesc *desc, Parts *parts, Arena *scratch) {
    GiParts *gi = &parts->gi;
    if (!gi->params.enabled) return;
    for (u32 i = 0; i < 2; i++)
        gi->draws[i] = packet_collect_voxelised(desc->world, desc->assets, parts->palette,
                                                i ? VOXEL_DYNAMIC : VOXEL_STATIC, scratch);
    GiLists lists =
        gi_lists_make(&gi->record, parts->lights.gi_lights, parts->lights.gi_count, scratch);
    gi->lists = lists.words;
    gi->list_count = lists.count;
    gi->list_index_count = lists.index_count;
}

static f32 lap_ms(f64 *start_ms) {
    f64 now = clock_now_ms(), lap = now - *start_ms;
    *start_ms = now;
    return (f32)lap;
}

const Packet *packet_build(const PacketBuildDesc *given, Arena *out, Arena *scratch,
                           PacketBuildTimes *times) {
    PacketBuildDesc desc = *given;
    settings_clamp(&desc.settings);
    desc.width_px = CLAMP(desc.width_px, 1, PACKET_SIDE_MAX);
    desc.height_px = CLAMP(desc.height_px, 1, PACKET_SIDE_MAX);
    u64 mark = arena_mark(scratch);
    f64 clock_ms = clock_now_ms();
    PacketBuildTimes laps = {0};
    Environment environment = environment_read(desc.world);
    Parts parts = {.view =
                       packet_make_view(desc.world, desc.camera, desc.width_px, desc.height_px)};
    for (u32 i = 0; i < desc.text_count; i++)
        parts.character_count += (u32)strlen(desc.texts[i].text);

    Frustum everywhere = {.count = 0};
    if (desc.settings.occlusion) {
        const OccluderPolygons *polygons =
            desc.light_manager ? light_manager_polygons(desc.light_manager) : NULL;
        parts.occlusion = occlusion_draw(desc.world, desc.assets, polygons, &parts.view, scratch);
    }
    laps.occluders_ms = lap_ms(&clock_ms);
    RowList visible = cull_drawables(
        desc.world, desc.settings.mesh_culling ? &parts.view.frustum : &everywhere, scratch);
    if (desc.settings.mesh_culling)
        parts.drawables_occluded = hide_drawables(desc.world, parts.occlusion, &visible, scratch);
    laps.cull_ms = laps.occluders_ms + lap_ms(&clock_ms);

    parts.gi = gi_begin_packet(&desc, &parts.view);
    laps.gi_ms = lap_ms(&clock_ms);
    parts.lights =
        packet_collect_lights(&desc, &parts.view, parts.occlusion, &parts.gi.params, scratch);
    laps.lights_ms = lap_ms(&clock_ms);
    memcpy(laps.light_stage_ms, parts.lights.stage_ms, sizeof laps.light_stage_ms);
    write_frame(&parts.frame, &desc, &parts.view, &parts.lights, &parts.gi.params, &environment);
    parts.posts = packet_collect_posts(&desc, &parts.view, scratch);
    parts.palette = packet_collect_materials(desc.world, scratch);
    parts.view.vertex_lighting = parts.lights.vertex_lighting;
    parts.draws = packet_collect_draws(&desc, &parts.view, parts.palette, visible.rows,
                                       visible.count, NULL, scratch);
    for (u32 alpha = 0; alpha < 3; alpha++)
        for (u32 i = 0; i < parts.draws.counts[alpha]; i++)
            parts.emissive_count += draw_is_emissive(parts.palette, &parts.draws.lists[alpha][i]);
    if (parts.lights.casts_shadow && desc.settings.shadows) {
        parts.shadow_size_px = CLAMP(environment.shadow_size, 64, 4096);
        parts.shadow_fit = shadow_fit_view(&parts.view, parts.lights.shadow_direction,
                                           environment.shadow_distance, parts.shadow_size_px);
        RowList casters = cull_drawables(desc.world, &parts.shadow_fit.frustum, scratch);
        parts.shadow = packet_collect_draws(&desc, &parts.view, parts.palette, casters.rows,
                                            casters.count, &parts.shadow_fit, scratch);
        shadow_fit_casters(&parts.shadow_fit, WORLD_TABLE(desc.world, Drawable, drawable),
                           parts.shadow.rows, parts.shadow.row_count);
    }
    laps.pack_ms = lap_ms(&clock_ms);
    collect_gi(&desc, &parts, scratch);
    laps.gi_ms += lap_ms(&clock_ms);
    parts.lists = light_lists_plan(&parts.frame, parts.lights.lights, parts.lights.spots,
                                   &desc.settings, parts.draws.counts[ALPHA_BLEND] > 0, scratch);
    laps.grid_ms = lap_ms(&clock_ms);
    Packet *packet = write_packet(&desc, &parts, &environment, out);
    laps.pack_ms += lap_ms(&clock_ms);
    light_lists_write(&parts.lists, packet);
    laps.grid_ms += lap_ms(&clock_ms);
    if (times) *times = laps;
    arena_rewind(scratch, mark);
    return packet;
}

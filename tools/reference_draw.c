// reference_draw.c: a session's view as the path tracer sees it.
// Data in: a session, a view. Data out: the picture. Called by: reference.c, bench_gi.c, tests.
// Does not: decide how many samples are enough.
#include "reference.h"

void reference_settings(RenderSettings *settings) {
    settings->mesh_culling = settings->occlusion = settings->manager = 0;
    settings->light_culling = settings->merge = settings->drop = settings->light_lod = 0;
    settings->vertex_lighting = 0;
    settings->lod_error_px = 0.0f;
}

u8 *reference_flags(const World *world, const Packet *packet, Arena *arena) {
    const DrawableTable *drawables = WORLD_TABLE(world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const InstanceRecord *records = PACKET_DATA(packet, instances, InstanceRecord);
    u8 *flags = ARENA_PUSH(arena, u8, packet->instances.count);
    for (u32 i = 0; i < packet->instances.count; i++) {
        u32 row = table_row(&drawables->table, records[i].ids[1]);
        u32 owner =
            row == ROW_NONE ? ROW_NONE : table_row(&instances->table, drawables->owner[row]);
        if (owner == ROW_NONE) continue;
        // What is not voxelised gives the engine no light and takes none.
        if (instances->voxel_mode[owner] == VOXEL_NONE) continue;
        flags[i] = TRACE_BOUNCES;
        if (instances->casts_shadow[owner]) flags[i] |= TRACE_SHADOWS;
    }
    return flags;
}

bool reference_draw(Session *session, const SessionView *view, const TraceOptions *options,
                    TraceProgress progress, void *user, Arena *arena, RenderImage *out) {
    session_frame_begin(session);
    SessionView seen = *view;
    reference_settings(&seen.settings);
    const Packet *packet = session_packet(session, &seen);
    if (!packet) return false;
    TraceScene scene;
    const u8 *flags = reference_flags(session->world, packet, arena);
    if (!trace_scene_create(&scene, packet, &session->assets, flags, arena)) return false;
    u64 pixels = (u64)packet->width_px * packet->height_px;
    out->width_px = packet->width_px;
    out->height_px = packet->height_px;
    out->rgba = ARENA_PUSH(arena, u8, 4 * pixels);
    f32 *rgb = ARENA_PUSH(arena, f32, 3 * pixels);
    trace_picture(&scene, options, rgb, arena, progress, user);
    trace_encode(packet, rgb, out->rgba);
    out->hash = render_image_hash(out->rgba, out->width_px, out->height_px);
    return true;
}

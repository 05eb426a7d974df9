// packet_post.c: the level's post chain as the steps that one picture runs.
// Data in: rows of `post`, their entities' places, the view. Data out: PacketPost in scratch.
// Called by: packet_build.c. Does not: draw (render/post.c), or drop a step for the setting `post`:
// so one packet can be drawn with and without.
#include "packet_parts.h"
#include "../base/log.h"
#include "../base/sphere_bounds.h"

#define AMOUNT_HEIGHT_PX 720.0f // the picture that the column `amount` means

// Steps on radiance first, then tone mapping, then gamma.
static u32 stage_of(u32 kind) { return kind < POST_TONEMAP ? 0 : kind; }

// The pixels that heat can change. False: none of this picture.
static bool heat_rect(const PacketView *view, const PacketBuildDesc *desc, Vec3 center,
                      PacketPost *post) {
    f32 width = (f32)desc->width_px, height = (f32)desc->height_px;
    const f32 *m = view->view.m;
    f32 x = m[0] * center.x + m[4] * center.y + m[8] * center.z + m[12];
    f32 y = m[1] * center.x + m[5] * center.y + m[9] * center.z + m[13];
    f32 z = m[2] * center.x + m[6] * center.y + m[10] * center.z + m[14];
    f32 left, right, bottom, top, reach = post->values[3];
    if (!sphere_bounds_axis(x, z, reach, view->near, 1.0f / view->tan_x, &left, &right) ||
        !sphere_bounds_axis(y, z, reach, view->near, 1.0f / view->tan_y, &bottom, &top))
        return false;
    // A moved pixel is read up to the shift away, and with its neighbours.
    f32 margin = post->values[4] + 2.0f;
    post->values[7] = MAX((left * 0.5f + 0.5f) * width - margin, 0.0f);
    post->values[8] = MAX((0.5f - top * 0.5f) * height - margin, 0.0f);
    post->values[9] = MIN((right * 0.5f + 0.5f) * width + margin, width);
    post->values[10] = MIN((0.5f - bottom * 0.5f) * height + margin, height);
    return true;
}

// False: this step changes nothing in this picture.
static bool make_post(const PacketBuildDesc *desc, const PacketView *view, const PostTable *table,
                      u32 row, PacketPost *post) {
    f32 *v = post->values;
    *post = (PacketPost){.kind = MIN(table->kind[row], POST_KIND_COUNT - 1)};
    switch ((PostKind)post->kind) {
    case POST_FOG:
        v[0] = table->color_r[row], v[1] = table->color_g[row], v[2] = table->color_b[row];
        v[3] = table->density[row], v[4] = table->start[row];
        v[5] = table->height[row], v[6] = table->falloff[row];
        return v[3] > 0.0f;
    case POST_HEAT: {
        const TransformTable *transforms = WORLD_TABLE(desc->world, Transform, transform);
        u32 place = table_row(&transforms->table, table->table.entity[row]);
        Mat34 world = mat34_identity();
        if (place != ROW_NONE) columns_get_mat34(&transforms->w00, place, world.m);
        Vec3 center = mat34_translation(&world);
        v[0] = center.x, v[1] = center.y, v[2] = center.z, v[3] = table->reach[row];
        v[4] = table->amount[row] * (f32)desc->height_px / AMOUNT_HEIGHT_PX;
        v[5] = table->scale[row], v[6] = table->speed[row];
        return v[4] > 0.0f && v[3] > 0.0f && heat_rect(view, desc, center, post);
    }
    case POST_GAMMA:
        v[0] = table->gamma[row];
        return true;
    case POST_TONEMAP:
    case POST_KIND_COUNT:
        break;
    }
    return true;
}

PostParts packet_collect_posts(const PacketBuildDesc *desc, const PacketView *view,
                               Arena *scratch) {
    const PostTable *table = WORLD_TABLE(desc->world, Post, post);
    u32 count = table->table.count, kinds = 0;
    // Two more: tone mapping and gamma are always there.
    PostParts parts = {ARENA_PUSH(scratch, PacketPost, count + 2), 0};
    i32 *orders = ARENA_PUSH(scratch, i32, count + 2);
    for (u32 row = 0; row < count; row++) {
        PacketPost post;
        if (!make_post(desc, view, table, row, &post)) continue;
        // Insertion keeps rows of equal order as they stand.
        u32 at = parts.count++, stage = stage_of(post.kind);
        while (at > 0) {
            u32 before = stage_of(parts.posts[at - 1].kind);
            if (before < stage || (before == stage && orders[at - 1] <= table->order[row])) break;
            parts.posts[at] = parts.posts[at - 1];
            orders[at] = orders[at - 1];
            at--;
        }
        parts.posts[at] = post;
        orders[at] = table->order[row];
        kinds |= 1u << post.kind;
    }
    if (!(kinds & 1u << POST_TONEMAP)) {
        u32 at = parts.count++;
        while (at > 0 && parts.posts[at - 1].kind == POST_GAMMA) {
            parts.posts[at] = parts.posts[at - 1];
            at--;
        }
        parts.posts[at] = (PacketPost){.kind = POST_TONEMAP};
    }
    if (!(kinds & 1u << POST_GAMMA)) parts.posts[parts.count++] = (PacketPost){.kind = POST_GAMMA};
    // The last ones are tone mapping and gamma: the radiance steps beyond the limit go.
    if (parts.count > PACKET_POSTS_CAP) {
        u32 extra = parts.count - PACKET_POSTS_CAP;
        parts.posts += extra;
        parts.count -= extra;
        LOG(DEBUG_NOTE, "a picture has %u steps of post chain at most: the first %u are left out",
            PACKET_POSTS_CAP, extra);
    }
    return parts;
}

#version 460
// gi_view_voxels.frag: the voxels from the camera: the first one that each pixel's ray meets, or
// (GI_STEP 1) a level of filtered radiance, one cell after another.
#extension GL_GOOGLE_include_directive : require
#define GI_SCREEN
#include "common.glsl"
#include "gi.glsl"
#include "gi_view_ray.glsl"

layout(set = 2, binding = BINDING_GI_IRRADIANCE) uniform sampler3D gi_irradiance;
layout(set = 2, binding = BINDING_GI_VISIBILITY) uniform sampler3D gi_visibility;

layout(location = 0) out vec4 out_color;

// GiShow of frame/settings.h.
const uint SHOW_RADIANCE = 0u, SHOW_ALBEDO = 1u, SHOW_NORMAL = 2u, SHOW_EMISSION = 3u,
           SHOW_STATIC = 4u, SHOW_VISIBILITY = 5u, SHOW_IRRADIANCE = 6u;
const vec3 NOTHING = vec3(0.02, 0.02, 0.05);

// Block of the side that a ray which travels along an axis meets.
uint met_block(uint axis, vec3 direction) {
    float along = axis == 0u ? direction.x : axis == 1u ? direction.y : direction.z;
    return 2u * axis + (along > 0.0 ? 1u : 0u);
}

vec3 voxel_radiance(ivec3 place, uint block) {
    vec4 texel;
    if (GI_FACES == 0u) {
        texel = texelFetch(gi_base, gi_base_texel(place), 0);
    } else {
        int x = place.x + int(GI_DIRECTIONS == 1u ? 0u : block * gi.atlas.x);
        texel = texelFetch(gi_atlas, ivec3(x, place.yz), 0);
    }
    texel = gi_decode(texel);
    return texel.rgb / max(texel.a, 1e-2);
}

vec3 voxel_color(ivec3 place, uint slot, uint block, bool is_solid) {
    uint show = gi.show.x;
    bool is_there = slot != GI_NO_SLOT;
    uint held = is_there ? slot : 0u;
    vec4 albedo = unpackUnorm4x8(gi_attribute(held, GI_ATTRIBUTE_ALBEDO));
    vec3 color = view_radiance(voxel_radiance(place, block));
    color = show == SHOW_ALBEDO ? srgb_encode_fast(albedo.rgb) : color;
    vec3 normal = gi_unpack_normal(gi_attribute(held, GI_ATTRIBUTE_NORMAL));
    color = show == SHOW_NORMAL ? normal * 0.5 + 0.5 : color;
    vec3 emission = gi_unpack_emission(gi_attribute(held, GI_ATTRIBUTE_EMISSION));
    color = show == SHOW_EMISSION ? view_radiance(emission) : color;
    uint bit = gi_bit(uvec3(place));
    vec3 kind = gi_has(GI_MASK_STATIC, bit) ? vec3(0.35, 0.75, 0.35) : vec3(1.0, 0.6, 0.15);
    color = show == SHOW_STATIC ? (is_solid ? vec3(0.3, 0.45, 0.95) : kind) : color;
    color = show == SHOW_VISIBILITY ? vec3(texelFetch(gi_visibility, place, 0).x) : color;
    vec4 arriving = texelFetch(gi_irradiance, place, 0);
    color = show == SHOW_IRRADIANCE ? view_radiance(arriving.rgb / max(arriving.a, 1e-2)) : color;
    // It found no room: nothing is known of it.
    return is_there || is_solid ? color : vec3(1.0, 0.0, 1.0);
}

vec3 first_voxel(vec3 eye, vec3 ray) {
    uint axis;
    vec2 range = view_grid(eye, ray, axis);
    ViewWalk walk = view_walk(eye, ray, 1.0, vec3(gi_flow.dims.xyz), range.x, axis);
    bool hit = false, is_solid = false;
    for (uint i = 0u; i < VIEW_STEPS && walk.t < range.y && !hit; i++) {
        uint bit = gi_bit(uvec3(walk.place) + uvec3(0u, 0u, gi_flow.dims.z * walk.cascade));
        hit = gi_occupied(bit);
        // What fills closed meshes shows where their surface was cut away by the camera.
        if ((GI_VISIBILITY & GI_VISIBILITY_SOLID) != 0u) {
            is_solid = !hit && gi_has(GI_MASK_SOLID, bit);
            hit = hit || is_solid;
        }
        ViewWalk next = walk;
        view_next(next);
        if (hit) next = walk;
        walk = next;
        range.y = view_is_inside(walk) ? range.y : -1.0;
    }
    if (!hit) return NOTHING;
    axis = walk.axis;
    ivec3 place = ivec3(walk.place) + ivec3(0, 0, int(gi.dims.z * walk.cascade));
    uint slot = gi_slot(gi_bit(uvec3(place)));
    vec3 color = voxel_color(place, slot, met_block(axis, ray), is_solid);
    // Sides told apart, and the rim of each a little darker, unless voxels are as small as pixels.
    float side = axis == 1u ? 1.0 : axis == 0u ? 0.9 : 0.8;
    vec3 inside = gi_to_voxels(eye + ray * walk.t, walk.cascade) - walk.place;
    vec3 rim = min(inside, 1.0 - inside);
    rim = mix(rim, vec3(1.0), equal(uvec3(axis), uvec3(0u, 1u, 2u)));
    float pixel = walk.t * length(frame.ray_right.xyz) * frame.viewport.z * 2.0 /
                  gi.origin[walk.cascade].w;
    bool is_rim = min(min(rim.x, rim.y), rim.z) < max(0.04, 0.5 * pixel) && pixel < 0.15;
    return color * side * (is_rim ? 0.72 : 1.0);
}

vec3 filtered_cells(vec3 eye, vec3 ray) {
    uint axis;
    vec2 range = view_grid(eye, ray, axis);
    uint level = min(gi_flow.show.y - 1u, gi_flow.atlas.w - 1u);
    uint block = GI_DIRECTIONS == 1u ? 0u : gi_flow.show.z;
    ivec3 cells = max(ivec3(gi_flow.atlas.xyz) >> int(level), ivec3(1));
    float side = float(gi_flow.dims.y) / float(cells.y);
    vec4 sum = vec4(0.0);
    ViewWalk walk = view_walk(eye, ray, side, vec3(cells), range.x, axis);
    for (uint i = 0u; i < VIEW_STEPS && walk.t < range.y && sum.a < 0.98; i++) {
        ivec3 texel = ivec3(walk.place);
        texel += ivec3(cells.x * int(block), 0, cells.z * int(walk.cascade));
        // The eye may stand in a coarse cell: what is closer than half of one is passed over.
        float shown = walk.t > 0.5 * side * gi_flow.origin[walk.cascade].w ? 1.0 : 0.0;
        vec4 met = texelFetch(gi_atlas, texel, int(level));
        if (GI_FACES != 0u) met = gi_solid(met, 1.0);
        sum += gi_decode(met) * ((1.0 - sum.a) * shown);
        view_next(walk);
        range.y = view_is_inside(walk) ? range.y : -1.0;
    }
    return view_radiance(sum.rgb) + NOTHING * (1.0 - sum.a);
}

void main() {
    vec3 eye = flow.camera.xyz, ray = view_ray(gl_FragCoord.xy);
    out_color = vec4(GI_STEP == 0u ? first_voxel(eye, ray) : filtered_cells(eye, ray), 1.0);
}

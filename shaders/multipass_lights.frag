#version 460
// multipass_lights.frag: path `multipass`: one group of lights, added to what is there. Always as
// many as a group holds, so that the loop has no condition; places after the last light take the
// dummy, which lights nothing. Points and spots (SPOTS) are groups of their own. Only the owner of a
// pixel is lit (multipass_base.frag): another surface may lie in the same plane.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"
#include "light.glsl"
#include "multipass_owner.glsl"

layout(push_constant) uniform Group {
    uint first, end; // light indices
    uint dummy;
} group;

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;
layout(location = 5) in vec3 in_position;


layout(set = 0, binding = BINDING_HDR_OTHER) uniform sampler2D hdr_other; // owners
layout(location = 0) out vec4 out_color;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    Surface s = surface_make(in_position, normal, albedo.rgb, in_material);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < MULTIPASS_LIGHTS; i++) {
        uint at = group.first + i, index = at < group.end ? at : group.dummy;
        if (SPOTS != 0u) {
            // The dummy is no spot: any record will do.
            uint spot = min(at, group.end - 1u) - flow.counts.x;
            sum += light_spot(s, light_position(index), light_color(index), spot_direction(spot),
                              spot_edge(spot));
        } else {
            sum += light_point(s, light_position(index), light_color(index));
        }
    }
    bool owns = texelFetch(hdr_other, ivec2(gl_FragCoord.xy), 0) == pixel_owner();
    out_color = vec4(owns ? sum * palette_emissive(in_material).w : vec3(0.0), 0.0);
}

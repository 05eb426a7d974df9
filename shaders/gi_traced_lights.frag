#version 460
// gi_traced_lights.frag: lights whose shadows come from the voxels, added to the lit picture.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"
#include "gi_traced.glsl"

layout(location = 0) out vec4 out_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    // As rays (specification of voxel GI, 4) two voxels out: in a corner the other wall is near.
    vec3 sum = gi_traced_light(gbuffer_surface(g), gi_start(g), GI_START + 1.0,
                               g.depth > 0.0);
    out_color = vec4(g.depth > 0.0 ? sum * gbuffer_receives(g) : vec3(0.0), 0.0);
}

#version 460
// lines.frag: triangles of debug drawings in pixels. u: depth (reversed) of what they stand for,
// dimmed where a surface lies before it; u < 0: nothing can.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D depth_texture;
layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 0) out vec4 out_color;

void main() {
    float surface = texelFetch(depth_texture, ivec2(gl_FragCoord.xy), 0).r;
    bool hidden = in_uv.x >= 0.0 && in_uv.x < surface;
    out_color = vec4(in_color.rgb, in_color.a * (hidden ? 0.25 : 1.0));
}

#version 460
// overlay.frag: UI triangles with an atlas; u < 0 means plain colour (text of the packet).
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
layout(set = 0, binding = BINDING_OVERLAY) uniform sampler2D atlas;
layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 0) out vec4 out_color;

void main() {
    vec4 texel = texture(atlas, in_uv);
    out_color = in_color * (in_uv.x < 0.0 ? vec4(1.0) : texel);
}

// multipass_owner.glsl: which triangle of which drawable this fragment is of: where several lie in
// one plane, only the one that the base pass left in the picture is lit.
#ifndef MULTIPASS_OWNER_GLSL
#define MULTIPASS_OWNER_GLSL

layout(location = 8) flat in uint in_entity;

// 20 bits of the entity's index and 24 of the triangle, in four halves that hold whole numbers up to
// 2,048.
vec4 pixel_owner() {
    uint entity = in_entity & 0xFFFFFu, triangle = uint(gl_PrimitiveID);
    return vec4(uvec4(entity, entity >> 11 | triangle << 9, triangle >> 2, triangle >> 13) & 2047u);
}
#endif

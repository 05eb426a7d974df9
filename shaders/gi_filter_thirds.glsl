// gi_filter_thirds.glsl: what lies between two levels of the atlas, so that cones read it as one: the
// finer level, blended with the next one as the sampler would at a lod a third (of odd levels two
// thirds) of the way, at the middle of each of the finer one's texels. It goes to the upper half of the
// finer level along z. What is read between middles is then all but the same: the coarser level bends
// there a bit earlier. GI_STEP: the finer level's number & 1.
// Included by gi_filter_thirds.comp and gi_filter_thirds_byte.comp.
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 8, local_size_y = 4, local_size_z = 2) in;

layout(set = 0, binding = BUILD_MIP_SOURCE, GI_STORAGE_FORMAT) uniform image3D finer;
layout(set = 0, binding = BUILD_MIP_TARGET, GI_STORAGE_FORMAT) uniform readonly image3D coarser;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID), size = imageSize(finer) / ivec3(1, 1, 2);
    if (any(greaterThanEqual(texel, size))) return;
    int width = size.x / 6, block = texel.x / width;
    ivec3 place = ivec3(texel.x - block * width, texel.yz);
    // A texel's middle is a quarter of the coarser ones' width off the middle of the one it is in.
    ivec3 own = place >> 1, last = max(ivec3(width, size.yz) >> 1, ivec3(1)) - 1;
    ivec3 next = clamp(own + (place & 1) * 2 - 1, ivec3(0), last);
    vec4 blurred = vec4(0.0);
    for (int i = 0; i < 8; i++) {
        bvec3 is_next = notEqual(ivec3(i) & ivec3(1, 2, 4), ivec3(0));
        vec3 weight = mix(vec3(0.75), vec3(0.25), is_next);
        ivec3 at = mix(own, next, is_next);
        at.x += block * (last.x + 1);
        blurred += imageLoad(coarser, at) * (weight.x * weight.y * weight.z);
    }
    float share = GI_STEP == 0u ? 1.0 / 3.0 : 2.0 / 3.0;
    imageStore(finer, texel + ivec3(0, 0, size.z), mix(imageLoad(finer, texel), blurred, share));
}

// gi_gather.glsl: indirect light that arrives at an occupied voxel: six diffuse cones (gi_cones.glsl)
// about its mean normal; where normals cancel out, or with faces apart several surfaces meet, about
// the axes of the faces that it has.
// The includer has included gi.glsl with GI_BUILD.
#ifndef GI_GATHER_GLSL
#define GI_GATHER_GLSL
#include "gi_voxel.glsl"
#include "gi_cones.glsl"

layout(std140, set = 0, binding = BUILD_FRAME) uniform GiFrameBuffer { FrameRecord gi_frame; };

const uint GATHER_MEAN = 6u; // after the faces 0..5: about the mean normal

// Faces to gather for, as bits. A voxel has up to six, most have one.
uint gather_faces(bool is_there) {
    uint faces = 0u;
    for (uint f = 0u; f < 6u; f++) faces |= voxel_face(f) > 0.0 ? 1u << f : 0u;
    bool by_mean = normal != vec3(0.0) && (GI_FACES == 0u || facet >= 0.5);
    faces = by_mean ? 1u << GATHER_MEAN : faces;
    return is_there ? faces : 0u;
}

vec3 gather_axis(uint face) {
    float side = (face & 1u) == 0u ? 1.0 : -1.0;
    vec3 axis = vec3(face < 2u ? side : 0.0, face >= 2u && face < 4u ? side : 0.0,
                     face >= 4u ? side : 0.0);
    return face == GATHER_MEAN ? normal : axis;
}

// Irradiance / pi at one of them.
vec3 gather(uint face) {
    vec3 axis = gather_axis(face);
    return gi_hemisphere(voxel_front(axis), axis, vec2(0.0), GI_START, gi_reach(), 6u,
                         gi_frame.sky_zenith.rgb * gi.scale.y,
                         gi_frame.sky_horizon.rgb * gi.scale.y)
        .light;
}
#endif

// gi_voxel.glsl: an occupied voxel as the passes see it that light it: where it is, where it faces.
// The includer has included gi.glsl with GI_BUILD.
#ifndef GI_VOXEL_GLSL
#define GI_VOXEL_GLSL

// A mean normal shorter than this tells nothing: codes of 10 bits are off by up to 0.002.
const float GI_NORMAL_SHORTEST = 1.0 / 32.0;
// Faces with this share of the surface and more count in full.
const float GI_FACE_WHOLE = 1.0 / 16.0;

vec3 position, normal; // world, its middle; normal: unit, or 0 where normals cancel out
uint cascade;
// What its faces +x +y +z and -x -y -z count. apart: 1, down to 0 for faces that the surface hardly
// has. shared: sum 1; normal^2 on the side of the normal, without one each face's share.
vec3 ahead, behind;

void voxel_load(uint slot) {
    uvec3 place = gi_unpack_place(gi_voxels[slot]);
    cascade = GI_CASCADES > 1u ? place.z / gi.dims.z : 0u;
    vec3 middle = vec3(place.xy, place.z - cascade * gi.dims.z) + 0.5;
    position = gi_to_world(middle, cascade);
    vec3 mean = gi_unpack_normal(gi_attribute(slot, GI_ATTRIBUTE_NORMAL));
    float size = length(mean);
    bool agrees = size >= GI_NORMAL_SHORTEST;
    normal = agrees ? mean / size : vec3(0.0);
    uvec2 faces = uvec2(gi_attribute(slot, GI_ATTRIBUTE_FACES_0),
                        gi_attribute(slot, GI_ATTRIBUTE_FACES_1));
    ahead = vec3(gi_face(faces, 0u), gi_face(faces, 2u), gi_face(faces, 4u));
    behind = vec3(gi_face(faces, 1u), gi_face(faces, 3u), gi_face(faces, 5u));
    if (GI_FACES != 0u) {
        ahead = min(ahead * (1.0 / GI_FACE_WHOLE), vec3(1.0));
        behind = min(behind * (1.0 / GI_FACE_WHOLE), vec3(1.0));
    } else {
        float sum = max(dot(ahead + behind, vec3(1.0)), 1e-3);
        vec3 weight = normal * normal;
        ahead = agrees ? mix(vec3(0.0), weight, greaterThan(normal, vec3(0.0))) : ahead / sum;
        behind = agrees ? mix(vec3(0.0), weight, lessThan(normal, vec3(0.0))) : behind / sum;
    }
}

// Slots that there are; those of lanes beyond do not count.
uint voxel_count() {
    return min(gi_counters[GI_COUNTER_STATIC] + gi_counters[GI_COUNTER_DYNAMIC],
               gi_flow.counts.z);
}
// What face f (0..5) counts.
float voxel_face(uint f) {
    vec3 side = (f & 1u) == 0u ? ahead : behind;
    return f < 2u ? side.x : f < 4u ? side.y : side.z;
}
vec3 voxel_albedo(uint slot) {
    return unpackUnorm4x8(gi_attribute(slot, GI_ATTRIBUTE_ALBEDO)).rgb;
}
#endif

// gi_voxel.glsl: an occupied voxel as the passes see it that light it: where it is, where it faces.
// The includer has included gi.glsl with GI_BUILD.
#ifndef GI_VOXEL_GLSL
#define GI_VOXEL_GLSL

// A mean normal shorter than this tells nothing: codes of 10 bits are off by up to 0.002.
const float GI_NORMAL_SHORTEST = 1.0 / 32.0;
// Faces with this share of the surface and more count in full.
const float GI_FACE_WHOLE = 1.0 / 16.0;
// The backs of a voxel's surface count by this part of their share: the dark ends of what they blend
// with cost each gathering light, and so each bounce (test gi_walls.white_furnace); with half and less,
// more than 0.1 % comes through walls of three voxels (test gi_leaks.sealed_rooms).
const float GI_BACKS = 0.6;
// Albedo that counts at most for light that goes round and round: a closed room of perfectly white
// walls would grow ever brighter.
const float FEEDBACK_ALBEDO = 0.95;

vec3 position, normal; // world, its middle; normal: unit, or 0 where normals cancel out
float facet;           // apart: 1 where one surface fills it, facing the normal; 0 at edges and corners
uint cascade;
// What its faces +x +y +z and -x -y -z count. apart: 1, down to 0 for faces that the surface hardly
// has. shared: sum 1; normal^2 on the side of the normal, without one each face's share.
vec3 ahead, behind;
// apart: densities of the faces +x +y +z and -x -y -z, seen from their side: where the surface faces
// away it is dark, not clear.
vec3 dense_ahead, dense_behind;

// Is the next voxel towards that side (1, -1) of each axis occupied? 1 or 0; 0 beyond the box.
vec3 voxel_beside(uvec3 place, int side) {
    vec3 found = vec3(0.0);
    uint low = cascade * gi.dims.z;
    ivec3 last = ivec3(gi.dims.xyz) - 1;
    for (int axis = 0; axis < 3; axis++) {
        ivec3 at = ivec3(place.xy, place.z - low);
        at[axis] = clamp(at[axis] + side, 0, last[axis]);
        bool is_other = at != ivec3(place.xy, place.z - low);
        bool is_there = gi_occupied(gi_bit(uvec3(at) + uvec3(0u, 0u, low)));
        found[axis] = is_other && is_there ? 1.0 : 0.0;
    }
    return found;
}

void voxel_load(uint slot) {
    uvec3 place = gi_unpack_place(gi_voxels[slot]);
    cascade = GI_CASCADES > 1u ? place.z / gi.dims.z : 0u;
    vec3 middle = vec3(place.xy, place.z - cascade * gi.dims.z) + 0.5;
    position = gi_to_world(middle, cascade);
    vec3 mean = gi_unpack_normal(gi_attribute(slot, GI_ATTRIBUTE_NORMAL));
    float size = length(mean);
    bool agrees = size >= GI_NORMAL_SHORTEST;
    normal = agrees ? mean / size : vec3(0.0);
    facet = clamp(size * 8.0 - 6.4, 0.0, 1.0);
    uvec2 faces = uvec2(gi_attribute(slot, GI_ATTRIBUTE_FACES_0),
                        gi_attribute(slot, GI_ATTRIBUTE_FACES_1));
    ahead = vec3(gi_face(faces, 0u), gi_face(faces, 2u), gi_face(faces, 4u));
    behind = vec3(gi_face(faces, 1u), gi_face(faces, 3u), gi_face(faces, 5u));
    if (GI_FACES != 0u) {
        // The back of a face is dark. A ray that meets the front of a surface lying aslant passes backs
        // along another axis, and should see little of them.
        vec3 backs_ahead = behind * GI_BACKS, backs_behind = ahead * GI_BACKS;
        ahead = min(ahead * (1.0 / GI_FACE_WHOLE), vec3(1.0));
        behind = min(behind * (1.0 / GI_FACE_WHOLE), vec3(1.0));
        dense_ahead = max(ahead, backs_ahead);
        dense_behind = max(behind, backs_behind);
        // The inside of a solid.
        if (ahead + behind == vec3(0.0)) dense_ahead = dense_behind = vec3(1.0);
        // Two bodies touch, a wall stands on a floor: opposite faces cancel out, and what is left of
        // the normal lies across. What faces an occupied voxel then lies between the two and is
        // hidden, though the voxel's outer side sees the light; lit, it would shine into the room.
        vec3 touches = agrees ? min(ahead, behind) * step(abs(normal), vec3(0.3)) : vec3(0.0);
        ahead *= 1.0 - ceil(touches) * voxel_beside(place, 1);
        behind *= 1.0 - ceil(touches) * voxel_beside(place, -1);
    } else {
        float sum = max(dot(ahead + behind, vec3(1.0)), 1e-3);
        vec3 weight = normal * normal;
        ahead = agrees ? mix(vec3(0.0), weight, greaterThan(normal, vec3(0.0))) : ahead / sum;
        behind = agrees ? mix(vec3(0.0), weight, lessThan(normal, vec3(0.0))) : behind / sum;
    }
}

// Before the voxel, towards a unit vector: as far off as a voxel is thick along it, beyond all voxels
// that the same plane passes through.
vec3 voxel_front(vec3 axis) {
    float thickness = dot(abs(axis), vec3(1.0));
    return position + axis * (gi.cone.w * gi.origin[cascade].w * thickness);
}

// Slots that there are; those of lanes beyond do not count.
uint voxel_count() {
    return min(gi_counters[GI_COUNTER_STATIC] + gi_counters[GI_COUNTER_DYNAMIC],
               gi_flow.counts.z);
}
float voxel_side(uint f, vec3 positive, vec3 negative) {
    vec3 side = (f & 1u) == 0u ? positive : negative;
    return f < 2u ? side.x : f < 4u ? side.y : side.z;
}
// What face f (0..5) counts, and how dense it is.
float voxel_face(uint f) { return voxel_side(f, ahead, behind); }
float voxel_density(uint f) { return voxel_side(f, dense_ahead, dense_behind); }
vec3 voxel_albedo(uint slot) {
    return unpackUnorm4x8(gi_attribute(slot, GI_ATTRIBUTE_ALBEDO)).rgb;
}
#endif

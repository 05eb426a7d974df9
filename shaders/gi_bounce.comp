#version 460
// gi_bounce.comp: one bounce more (specification of voxel GI, 7): what each occupied voxel gathers by
// its diffuse cones is added to what it sends out. One invocation a slot; base volume and atlas are
// read, RADIANCE is added to. Step 1: what they hold has many bounces (feedback).
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
#include "gi_gather.glsl"
layout(local_size_x = 64) in;

const uint STEP_FEEDBACK = 1u;

void main() {
    uint slot = gl_GlobalInvocationID.x, count = voxel_count();
    if (slot >= count) return;
    voxel_load(slot);
    vec3 albedo = voxel_albedo(slot);
    if (GI_STEP == STEP_FEEDBACK) albedo = min(albedo, vec3(FEEDBACK_ALBEDO));
    vec3 sum = vec3(0.0);
    // Each lane takes its own next face: as many rounds as the richest voxel has faces. The loop ends
    // with its test, which saves a round (gi_cones.glsl).
    uint faces = gather_faces(true);
    if (faces != 0u) for (;;) {
        uint face = uint(findLSB(faces));
        faces &= faces - 1u;
        vec3 light = albedo * gather(face);
        if (GI_FACES != 0u) {
            uint first = face == GATHER_MEAN ? 0u : face, last = face == GATHER_MEAN ? 5u : face;
            for (uint f = first; f <= last; f++) {
                vec4 sent = gi_load_radiance(slot, f);
                sent.rgb += light * voxel_face(f);
                gi_store_radiance(slot, f, sent);
            }
        } else {
            sum += light * (face == GATHER_MEAN ? 1.0 : voxel_face(face));
        }
        if (faces == 0u) break;
    }
    if (GI_FACES == 0u) {
        vec4 sent = gi_load_radiance(slot, 0u);
        sent.rgb += sum;
        gi_store_radiance(slot, 0u, sent);
    }
}

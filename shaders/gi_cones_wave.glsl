// gi_cones_wave.glsl: a subgroup of eight lanes traces eight cones side by side.
// Included by gi_cones.glsl for who defines GI_WAVE; the rules for cones are there.
//
// Samples of neighbouring pixels' cones lie within a texel or two of each other: most of a subgroup
// blends the same texels, which the software driver's sampler fetches and unpacks for each lane anew,
// and that is most of what tracing costs it. Here the lanes fetch them together, a corner each, and
// take from each other what they weigh for themselves. Where a subgroup's samples lie in several
// cells, or travel into different octants, it goes through them one by one. Same samples, same
// weights; sums differ by rounding.
//
// Every lane must call these functions, with cones of the same width and first length: who takes no
// part is told by is_on, or by an end before the start.

// Why not subgroupMin: subgroups.glsl.
uint wave_least(uint v) {
    v = min(v, subgroupShuffleXor(v, 1u));
    v = min(v, subgroupShuffleXor(v, 2u));
    return min(v, subgroupShuffleXor(v, 4u));
}
bool wave_any(bool b) { return wave_least(b ? 0u : 1u) == 0u; }

vec3 gi_wave_texels = vec3(gi.atlas.xyz); // of the finest level

const uint WAVE_NONE = 0xffffffffu;

// The corners' sum. Each lane holds the one whose bits (x 1, y 2, z 4) are its number's, and takes
// those whose bits differ from it by 0..7 from the lanes that differ so: the weights are in that order.
vec4 wave_blend(vec4 texel, vec4 near, vec4 far) {
    vec4 other = subgroupShuffleXor(texel, 4u);
    return texel * near.x + subgroupShuffleXor(texel, 1u) * near.y +
           subgroupShuffleXor(texel, 2u) * near.z + subgroupShuffleXor(texel, 3u) * near.w +
           other * far.x + subgroupShuffleXor(other, 1u) * far.y +
           subgroupShuffleXor(other, 2u) * far.z + subgroupShuffleXor(other, 3u) * far.w;
}

// gi_cone_atlas of a whole level, or (layer 1) of what lies between it and the next; both are the
// same for all lanes.
vec4 gi_wave_atlas(vec3 q, bool is_on, float level, float layer, GiAxes axes) {
    vec3 size = max(gi_wave_texels * gi_exp2_whole(-level), vec3(1.0));
    vec3 p = clamp(q * size - 0.5, vec3(0.0), size - 1.0), low = floor(p), high = p - low;
    uvec3 cell = uvec3(low), side = uvec3(axes.block) & 1u;
    uint key = cell.x | cell.y << 8 | cell.z << 16 | side.x << 24 | side.y << 25 | side.z << 26;
    uint lane = gl_SubgroupInvocationID;
    ivec3 corner = ivec3(lane & 1u, lane >> 1 & 1u, (lane >> 2) + uint(layer * size.z));
    int width = int(size.x);
    // Weights of the lane's own corner along each axis, and of the other one.
    vec3 own = mix(1.0 - high, high, bvec3(lane & 1u, lane & 2u, lane & 4u)), other = 1.0 - own;
    vec2 wx = vec2(own.x, other.x);
    vec4 wxy = vec4(wx * own.y, wx * other.y);
    vec4 near = wxy * own.z, far = wxy * other.z, sum = vec4(0.0);
    uint next = wave_least(is_on ? key : WAVE_NONE);
    for (;;) {
        ivec3 at = ivec3(uvec3(next, next >> 8, next >> 16) & 255u) + corner;
        ivec3 x = at.x + width * ivec3(next >> 24 & 1u, 2u + (next >> 25 & 1u),
                                       4u + (next >> 26 & 1u));
        vec4 tx = texelFetch(gi_atlas, ivec3(x.x, at.yz), int(level));
        vec4 ty = texelFetch(gi_atlas, ivec3(x.y, at.yz), int(level));
        vec4 tz = texelFetch(gi_atlas, ivec3(x.z, at.yz), int(level));
        vec4 s = wave_blend(tx, near, far) * axes.weight.x +
                 wave_blend(ty, near, far) * axes.weight.y +
                 wave_blend(tz, near, far) * axes.weight.z;
        sum = key == next ? s : sum;
        next = wave_least(is_on && key > next ? key : WAVE_NONE);
        if (next == WAVE_NONE) break;
    }
    return sum;
}

// gi_cone_single of shared faces with levels between levels: every lod is whole or a third.
GiCone gi_cone_wave(vec3 start, vec3 direction, float tan_half, float t, float reach) {
    GiCone cone = GiCone(vec4(0.0), 0.0, 0.0);
    GiAxes axes = gi_axes(direction);
    float voxel = max(gi_finest.w, 1e-9), width = 2.0 * tan_half, factor = gi_cone_factor();
    float lambda = gi_lambda * voxel, last_level = gi_atlas_last;
    float growth = gi_cone_growth(width * factor), rise = log2(growth);
    vec3 q = (start - gi_finest.xyz) / voxel * gi_per_voxel, dq = direction * gi_per_voxel;
    float end = min(reach, gi_exit(start, direction)) / voxel;
    bool is_on = t < end;
    for (;;) {
        vec4 s = gi_base_fetch(q + dq * t);
        if (is_on) gi_cone_add(cone, s, 1.0, 1.0 / (1.0 + lambda * t));
        t = width * t > 0.999 ? t * growth : t + factor;
        is_on = is_on && t < end && cone.light.a < GI_OPAQUE;
        if (width * t >= 1.001 || !wave_any(is_on)) break;
    }
    for (;;) {
        vec3 at = q + dq * t;
        vec4 s = mix(gi_base_fetch(at), gi_wave_atlas(at, is_on, 0.0, 0.0, axes),
                     log2(max(width * t, 1.0)));
        if (is_on) gi_cone_add(cone, s, 1.0, 1.0 / (1.0 + lambda * t));
        t *= growth;
        is_on = is_on && t < end && cone.light.a < GI_OPAQUE;
        if (width * t >= 1.999 || !wave_any(is_on)) break;
    }
    for (float lod = log2(width * t) - 1.0;; lod += rise) {
        float whole = floor(lod + 0.1);
        float layer = lod - whole > 0.1 && whole < last_level ? 1.0 : 0.0;
        float level = clamp(whole, 0.0, last_level);
        vec4 s = gi_wave_atlas(q + dq * t, is_on, level, layer, axes);
        if (is_on) gi_cone_add(cone, s, 1.0, 1.0 / (1.0 + lambda * t));
        t *= growth;
        is_on = is_on && t < end && cone.light.a < GI_OPAQUE;
        if (!wave_any(is_on)) break;
    }
    gi_cone_end(cone);
    return cone;
}

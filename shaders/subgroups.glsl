// subgroups.glsl: extensions of shaders that work by subgroups; the first thing they include.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

// Reductions by halves, for compute shaders with all lanes on: the software driver makes a loop over
// the lanes of subgroupMin and its like (70 instructions), and one instruction of a shuffle.
#define WAVE_REDUCE(name, Type, op)                                                                \
    Type name(Type v) {                                                                            \
        for (uint step = 1u; step < gl_SubgroupSize; step <<= 1u)                                  \
            v = op(v, subgroupShuffleXor(v, step));                                                \
        return v;                                                                                  \
    }
WAVE_REDUCE(wave_min, vec3, min)
WAVE_REDUCE(wave_max, vec3, max)
#undef WAVE_REDUCE
// The same of a ballot.
uvec4 wave_ballot(bool hit) {
    if (gl_SubgroupSize > 32u) return subgroupBallot(hit);
    uint bits = hit ? 1u << gl_SubgroupInvocationID : 0u;
    for (uint step = 1u; step < gl_SubgroupSize; step <<= 1u) bits |= subgroupShuffleXor(bits, step);
    return uvec4(bits, 0u, 0u, 0u);
}

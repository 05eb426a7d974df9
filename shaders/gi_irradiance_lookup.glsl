// gi_irradiance_lookup.glsl: what voxels say of a surface (diffuse = voxels; gi_irradiance.comp): the
// filtered mean of the eight voxels around, of those that are there. One read a pixel.
// Include gi.glsl with GI_SCREEN first. What it cannot tell: both sides of a wall thinner than a
// voxel have one number; surfaces that are not voxelised find none and stay dark.
#ifndef GI_IRRADIANCE_LOOKUP_GLSL
#define GI_IRRADIANCE_LOOKUP_GLSL

layout(set = 2, binding = BINDING_GI_IRRADIANCE) uniform sampler3D gi_irradiance;

// Voxels that a surface looks up before itself: those behind it, of another room, count less.
const float GI_IRRADIANCE_OFFSET = 0.25;

// Light that arrives at a surface: irradiance / pi.
vec3 gi_irradiance_light(vec3 world, vec3 normal) {
    uint cascade = min(gi_cascade(world, 0.0), GI_CASCADES - 1u);
    vec3 half_texel = 0.5 / vec3(gi.dims.xyz);
    vec3 p = gi_to_voxels(world, cascade) + normal * GI_IRRADIANCE_OFFSET;
    vec3 q = clamp(p / vec3(gi.dims.xyz), half_texel, 1.0 - half_texel);
    if (GI_CASCADES > 1u) q.z = (q.z + float(cascade)) / float(GI_CASCADES);
    vec4 sum = textureLod(gi_irradiance, q, 0.0);
    return sum.rgb / max(sum.a, 1.0 / 256.0);
}
#endif

// gi_cones.glsl: cones through the voxels: the one way in which bounces, probes and the screen
// gather light. Include gi.glsl first (with GI_BUILD or GI_SCREEN); gi_sky and what calls it also
// need a FrameRecord `frame`.
//
// A cone (Crassin et al. 2011, "Interactive indirect illumination using voxel cone tracing"; values:
// specification of voxel GI, 6) starts a voxel from its apex. At length t it is 2 tan(a / 2) t wide,
// at least a voxel; the voxels are read filtered over that width, composited front to back, and t
// grows by the width times the step factor, until nothing shines through, the cone left the box, or
// its reach ends.
//
// The software driver sets the shape: only the exit of a loop saves work, and the reads are most of
// the work. So a cone through one cascade is three loops that read ever coarser: where it is
// narrower than a voxel the base alone (1 read), up to two voxels base and the finest level of the
// atlas (4 reads of one level each), from there on the atlas (3 reads of two levels, or of one where
// the lod is whole: see gi_cone_growth; with the usual cones the lods between are made ahead, as
// levels of their own: GI_READ_THIRDS). What does not change along a cone is made before, and all that
// steers a loop comes from gi_flow. Loops end with their test: one at the head runs the body once more,
// with all lanes off, and most cones have one sample in each of the first two loops.
//
// With faces apart walls hold light back. What is blended must lie within the cone: texels narrower
// than it, with the usual step factor a fifth of its width (linear filtering reaches 1.5 of them to
// each side: wider ones show what lies beside the walls that the cone passed). What texels hold is a
// density (gi.glsl): of samples up to a texel apart those about a wall add up to the whole of it,
// wherever they lie, and those about something sparse to no more. Surfaces must be opaque at any
// angle: a ray crosses |d| faces a texel of an axis that its direction has d of, so that is what the
// axis' block counts, not d squared (gi_axes). Smaller steps leak less.
#ifndef GI_CONES_GLSL
#define GI_CONES_GLSL

const float GI_START = 1.0;  // voxels from the apex to the first sample
const float GI_OPAQUE = 0.95; // as good as 1
const float GI_CLOSER = 2.0 / 3.0; // on the step factor
const float GI_FINER = 2.0 / 3.0;  // texels as wide as so many steps
const float GI_CLOSEST = GI_FACES != 0u ? 1.0 / 3.0 : 0.0; // voxels, a step at least

// What steers cones, read before all loops (why: gi.glsl).
vec4 gi_outer = gi_flow.origin[max(GI_CASCADES, 1u) - 1u]; // of the coarsest cascade
vec4 gi_finest = gi_flow.origin[0];
vec3 gi_outer_extent = vec3(gi_flow.dims.xyz) * gi_outer.w; // m
vec4 gi_cone_flow = gi_flow.cone;
float gi_lambda = gi_flow.strength.y;
vec3 gi_per_voxel = 1.0 / gi_dims;

struct GiCone {
    vec4 light;      // rgb premultiplied radiance, a opacity
    float occlusion; // opacity, what is far counting less: 1 / (1 + lambda t)
    float steps;     // samples taken, for the picture of them
};

// Radiance of the sky as cones see it.
#define GI_SKY(frame, direction)                                                                   \
    (mix((frame).sky_horizon.rgb, (frame).sky_zenith.rgb, sqrt(clamp((direction).y, 0.0, 1.0))) *  \
     gi.scale.y)

float gi_voxel_of(uint cascade) {
    return GI_CASCADES == 1u ? gi_finest.w : gi_flow.origin[cascade].w;
}

// The width that a sample has at least, m: a voxel of its cascade, and towards the border of one
// that others lie around growing to a voxel of the next: what is read on both sides of the border is
// then blurred alike.
float gi_grain(vec3 world, uint cascade) {
    float voxel = gi_voxel_of(cascade);
    if (GI_CASCADES == 1u || cascade + 1u >= GI_CASCADES) return voxel;
    vec3 middle = 0.5 * gi_dims * voxel;
    vec3 from = abs(world - gi.origin[cascade].xyz - middle) / middle; // 1 at the border
    return voxel * (1.0 + clamp(max(max(from.x, from.y), from.z) * 3.0 - 1.6, 0.0, 1.0));
}

// That of the finest cascade which has room at a place.
float gi_voxel_at(vec3 world) {
    if (GI_CASCADES == 1u) return gi_finest.w;
    return gi_grain(world, min(gi_cascade(world, gi_finest.w), GI_CASCADES - 1u));
}

// Where cones of a surface start: offset voxels off it; a voxel counts as thick as it is along the
// normal, so that all voxels that a plane passes through are as far behind the start.
vec3 gi_start_at(vec3 position, vec3 normal) {
    float thickness = dot(abs(normal), vec3(1.0));
    return position + normal * (gi.cone.w * gi_voxel_at(position) * thickness);
}

// Length in m at which a ray leaves the box of the coarsest cascade; not positive if it misses it.
float gi_exit(vec3 start, vec3 direction) {
    vec3 safe = mix(direction, vec3(1e-9), lessThan(abs(direction), vec3(1e-9)));
    vec3 inverse = 1.0 / safe, to_low = (gi_outer.xyz - start) * inverse;
    vec3 to_high = to_low + gi_outer_extent * inverse;
    vec3 near = min(to_low, to_high), far = max(to_low, to_high);
    float enter = max(max(near.x, near.y), near.z), leave = min(min(far.x, far.y), far.z);
    return enter < leave && enter <= 0.0 ? leave : 0.0;
}

// Length of a step over the width there (but at least GI_CLOSEST).
float gi_cone_factor() {
    return GI_FACES != 0u ? gi_cone_flow.y * GI_CLOSER : gi_cone_flow.y;
}
// Lod of a sample of this diameter (voxels, at least 1).
float gi_cone_lod(float diameter) {
    float width = GI_FACES != 0u ? diameter * min(gi_cone_factor(), 1.0) * GI_FINER : diameter;
    return max(log2(width), 0.0);
}

// way: texels that the sample stands for, of densities.
void gi_cone_add(inout GiCone cone, vec4 s, float way, float falloff) {
    if (GI_FACES != 0u) s = gi_solid(s, way);
    float seen = 1.0 - cone.light.a;
    cone.light += s * seen;
    cone.occlusion += s.a * seen * falloff;
    cone.steps += 1.0;
}

// What the loops stopped for counts as opaque: a uniformly lit opaque wall keeps its radiance.
void gi_cone_end(inout GiCone cone) {
    float whole = cone.light.a > GI_OPAQUE ? 1.0 / cone.light.a : 1.0;
    cone.light *= whole;
    cone.light.rgb = gi_decode(cone.light).rgb;
}

// Undecoded levels of the atlas at q (0..1 of the box), with one cascade: y and z end at the
// picture's border, where the sampler clamps; blocks lie side by side along x. layer: of
// GI_READ_THIRDS, 0 = the levels, 0.5 = what lies between them. is_whole (a constant): no level that
// is read lies between two.
vec4 gi_cone_atlas(vec3 q, float level, float layer, bool is_whole, GiAxes axes) {
    if (GI_DIRECTIONS == 1u) return gi_atlas_fetch(q, level, is_whole);
    float texels = gi_exp2_whole(ceil(level)), half_texel = texels * gi_atlas_half_texel.x;
    if (GI_MIPS == GI_READ_THIRDS) {
        float edge = texels * gi_atlas_half_texel.z;
        q.z = clamp(q.z, edge, 1.0 - edge) * 0.5 + layer;
    }
    vec3 x = (axes.block + clamp(q.x, half_texel, 1.0 - half_texel)) * (1.0 / 6.0);
    return gi_axes_blend(gi_atlas_fetch(vec3(x.x, q.yz), level, is_whole),
                         gi_atlas_fetch(vec3(x.y, q.yz), level, is_whole),
                         gi_atlas_fetch(vec3(x.z, q.yz), level, is_whole), axes);
}

// Factor from one length of a cone to the next. Rounded, if that changes it by little, so that the
// lods of samples rise by sixths and are whole every so often: a whole one is read from one level.
float gi_cone_growth(float step) {
    float rise = log2(1.0 + step), sixths = floor(rise * 6.0 + 0.5) * (1.0 / 6.0);
    return exp2(abs(sixths - rise) < 0.04 * rise ? sixths : rise);
}
// Length in voxels of a wide cone's first sample, as a share of GI_START: where it is a voxel wide.
float gi_cone_first(float tan_half) { return clamp(0.5 / tan_half, 0.75, 1.25); }

// has_thirds (a constant): every lod is whole or an odd number of thirds, which GI_READ_THIRDS has
// made ahead.
GiCone gi_cone_single(vec3 start, vec3 direction, float tan_half, float t, float end,
                      bool has_thirds) {
    bool is_nearest = GI_MIPS == GI_READ_NEAREST, is_whole = is_nearest || has_thirds;
    GiCone cone = GiCone(vec4(0.0), 0.0, 0.0);
    GiAxes axes = gi_axes(direction);
    float voxel = gi_finest.w, width = 2.0 * tan_half;
    float factor = gi_cone_factor();
    float lambda = gi_lambda * voxel, last_level = gi_atlas_last;
    vec3 q = (start - gi_finest.xyz) / voxel * gi_per_voxel, dq = direction * gi_per_voxel;
    if (GI_FACES == 0u) {
        float growth = gi_cone_growth(width * factor), rise = log2(growth);
        float narrow_end = min(end, 1.001 / width), near_end = min(end, 1.999 / width);
        bool goes_on = t < narrow_end;
        if (goes_on) for (;;) {
            gi_cone_add(cone, gi_base_fetch(q + dq * t), 1.0, 1.0 / (1.0 + lambda * t));
            t = width * t > 0.999 ? t * growth : t + factor;
            if (t >= narrow_end || cone.light.a >= GI_OPAQUE) break;
        }
        goes_on = t < near_end && cone.light.a < GI_OPAQUE;
        if (goes_on) for (;;) {
            vec3 at = q + dq * t;
            float share = log2(max(width * t, 1.0));
            if (GI_MIPS == GI_READ_NEAREST) share = floor(share + 0.5);
            vec4 s = mix(gi_base_fetch(at), gi_cone_atlas(at, 0.0, 0.0, true, axes), share);
            gi_cone_add(cone, s, 1.0, 1.0 / (1.0 + lambda * t));
            t *= growth;
            if (t >= near_end || cone.light.a >= GI_OPAQUE) break;
        }
        goes_on = t < end && cone.light.a < GI_OPAQUE;
        if (goes_on) for (float lod = log2(width * t) - 1.0;; lod += rise) {
            float whole = floor(lod + (has_thirds ? 0.1 : 0.5)), layer = 0.0;
            float level = is_whole || abs(lod - whole) < 0.01 ? whole : lod;
            if (has_thirds) layer = lod - whole > 0.1 && whole < last_level ? 0.5 : 0.0;
            level = min(level, last_level);
            gi_cone_add(cone, gi_cone_atlas(q + dq * t, level, layer, is_whole, axes), 1.0,
                        1.0 / (1.0 + lambda * t));
            t *= growth;
            if (t >= end || cone.light.a >= GI_OPAQUE) break;
        }
        gi_cone_end(cone);
        return cone;
    }
    float seen = 0.0; // a sample stands for the way since the one before
    if (t < end) for (;;) {
        float diameter = max(width * t, 1.0);
        float level = min(gi_cone_lod(diameter) - gi_atlas_lod(), last_level);
        if (GI_MIPS == GI_READ_NEAREST) level = floor(level + 0.5);
        gi_cone_add(cone, gi_cone_atlas(q + dq * t, level, 0.0, is_nearest, axes),
                    (t - seen) * exp2(-level), 1.0 / (1.0 + lambda * t));
        seen = t;
        t += max(diameter * factor, GI_CLOSEST);
        if (t >= end || cone.light.a >= GI_OPAQUE) break;
    }
    gi_cone_end(cone);
    return cone;
}

// Through several cascades: from the finest that has room for the cone where it is to the coarsest.
// Lengths in m. fades (a constant): a sample close to the end counts by the share of its step before
// it; of cones that end at a light there would be rings where their number of steps changes.
GiCone gi_cone_cascades(vec3 start, vec3 direction, float tan_half, float t, float end,
                        bool fades) {
    GiCone cone = GiCone(vec4(0.0), 0.0, 0.0);
    GiAxes axes = gi_axes(direction);
    float width = 2.0 * tan_half, factor = gi_cone_factor();
    float lambda = gi_lambda, seen = 0.0;
    if (t < end) for (;;) {
        vec3 at = start + direction * t;
        uint cascade = min(gi_cascade(at, width * t), GI_CASCADES - 1u);
        float voxel = gi_voxel_of(cascade);
        float diameter = max(width * t, gi_grain(at, cascade));
        float lod = gi_cone_lod(diameter / voxel);
        vec4 s = gi_sample(gi_to_voxels(at, cascade), cascade, lod, axes);
        float step = max(diameter * factor, GI_CLOSEST * voxel);
        if (fades) s *= clamp((end - t) / step, 0.0, 1.0);
        gi_cone_add(cone, s, (t - seen) / voxel * exp2(-lod), 1.0 / (1.0 + lambda * t));
        seen = t;
        t += step;
        if (t >= end || cone.light.a >= GI_OPAQUE) break;
    }
    float whole = cone.light.a > GI_OPAQUE ? 1.0 / cone.light.a : 1.0;
    cone.light *= whole;
    return cone;
}

// start: world; direction: unit; first: length of the first sample in voxels of the start's cascade
// (GI_START); reach: m, nothing is traced if it is not positive; has_thirds: see gi_cone_single.
GiCone gi_cone(vec3 start, vec3 direction, float tan_half, float first, float reach,
               bool has_thirds) {
    float end = min(reach, gi_exit(start, direction));
    if (GI_CASCADES == 1u) {
        // Lanes that a fragment shader runs beside its pixels read 0 from storage buffers on the
        // software driver. They must trace nothing: steps of no length would not end before the
        // driver's limit of iterations does, which the pixels beside them share.
        float voxel = max(gi_finest.w, 1e-9);
        return gi_cone_single(start, direction, tan_half, first, end / voxel, has_thirds);
    }
    return gi_cone_cascades(start, direction, tan_half, first * gi_voxel_at(start), end, false);
}
GiCone gi_cone(vec3 start, vec3 direction, float tan_half, float first, float reach) {
    return gi_cone(start, direction, tan_half, first, reach, false);
}

// Opacity of a cone towards a light, arguments as for gi_cone.
float gi_shadow_cone(vec3 start, vec3 direction, float tan_half, float first, float reach) {
    float end = min(reach, gi_exit(start, direction));
    return gi_cone_cascades(start, direction, tan_half, first * gi_voxel_at(start), end, true)
        .light.a;
}

#ifdef GI_WAVE
#include "gi_cones_wave.glsl"
#endif

// The level's longest distance, m.
float gi_reach() { return gi_cone_flow.z > 0.0 ? gi_cone_flow.z : 1e9; }

// Six cones over the hemisphere about a normal: one along it, five 60 degrees away and 72 degrees
// apart; shares 1/4 and five of 3/20 (cosine weights: pi/4 and 3 pi/20 over pi).
//
// The five hang on a vector that no wall is likely to be perpendicular to: two almost equal normals
// give almost equal cones, except close to that vector itself.
const vec3 GI_TANGENT_POLE = vec3(0.267261242, 0.534522484, 0.801783726);

// With faces apart a cone's samples are a fifth as wide as the cone: six of them miss much of the
// hemisphere. So they turn about in it: what counts by the cosine is even over the disk below the
// hemisphere (Malley's method: Pharr et al., Physically Based Rendering, 3rd ed., 13.6.3), of which
// the cone along the normal has the inner half's quarter, each other one a fifth of the ring around
// it. A lean is a place in the part of each, -1..1 twice; places that are even there make directions
// that are even over the hemisphere. 0, 0: the axes.
// One of 16 leans, for a rank.
vec2 gi_lean_of(uint rank) { return vec2(rank & 3u, rank >> 2) * 0.5 - 0.75; }
// Turn of each of the five, for a lean.y of -0.75, -0.25, 0, 0.25 or 0.75 times 36 degrees.
vec2 gi_lean_turn(float lean) {
    vec2 turn = abs(lean) > 0.5 ? vec2(0.891006524, 0.453990500) : vec2(0.987688341, 0.156434465);
    return lean == 0.0 ? vec2(1.0, 0.0) : vec2(turn.x, lean < 0.0 ? -turn.y : turn.y);
}

struct GiHemisphere {
    vec3 light;       // mean radiance, cosine weighted: irradiance / pi
    float visibility; // 1 - mean occlusion
    float steps;
};
// lean: faces apart; count: cones, 6, or 0 for none; zenith, horizon: radiance of the sky, or 0.
GiHemisphere gi_hemisphere(vec3 start, vec3 normal, vec2 lean, float first, float reach, uint count,
                           vec3 zenith, vec3 horizon) {
    GiHemisphere sum = GiHemisphere(vec3(0.0), 1.0, 0.0);
    vec3 u = cross(normal, GI_TANGENT_POLE);
    u *= inversesqrt(max(dot(u, u), 1e-12));
    vec3 v = cross(normal, u);
    vec2 turn = vec2(1.0, 0.0);
    float tan_half = gi_cone_flow.x;
    vec2 inner = 0.5 * lean * sqrt(1.0 - 0.5 * lean.yx * lean.yx); // of the disk: of the first
    float far2 = lean.x == 0.0 ? 0.75 : 0.625 + 0.375 * lean.x;
    vec2 ring = sqrt(vec2(far2, 1.0 - far2));
    vec3 along = u * inner.x + v * inner.y + normal * sqrt(1.0 - dot(inner, inner));
    if (GI_FACES != 0u) turn = gi_lean_turn(lean.y);
    if (GI_FACES == 0u) first *= gi_cone_first(tan_half);
    bool is_on = count > 0u;
#ifdef GI_WAVE
    if (GI_WAVES != 0u) { // all lanes go through the cones that one of them wants
        reach = is_on ? reach : 0.0;
        count = wave_any(is_on) ? 6u : 1u;
    }
#endif
    if (count > 0u) for (uint i = 0u;;) {
        bool is_first = i == 0u;
        vec3 around = u * turn.x + v * turn.y;
        vec3 direction = is_first ? normal : normal * 0.5 + around * 0.866025404;
        if (GI_FACES != 0u) direction = is_first ? along : normal * ring.y + around * ring.x;
        float share = is_first ? 0.25 : 0.15;
        // The first of the five starts there: no turn after the one along the normal.
        const vec2 step = vec2(0.309016994, 0.951056516);
        vec2 turned = vec2(turn.x * step.x - turn.y * step.y, turn.x * step.y + turn.y * step.x);
        turn = is_first ? turn : turned;
        GiCone cone;
#ifdef GI_WAVE
        if (GI_WAVES != 0u)
            cone = gi_cone_wave(start, direction, tan_half, first, reach);
        else
#endif
            cone = gi_cone(start, direction, tan_half, first, reach, GI_MIPS == GI_READ_THIRDS);
        vec3 sky = mix(horizon, zenith, sqrt(clamp(direction.y, 0.0, 1.0)));
        sum.light += (cone.light.rgb + sky * max(1.0 - cone.light.a, 0.0)) * share;
        sum.visibility -= cone.occlusion * share;
        sum.steps += cone.steps;
        if (++i >= count) break;
    }
    sum.visibility = clamp(sum.visibility, 0.0, 1.0);
    if (GI_WAVES != 0u && !is_on) sum = GiHemisphere(vec3(0.0), 1.0, 0.0);
    return sum;
}
#endif

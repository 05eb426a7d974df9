// gi_screen.glsl: indirect light of one pixel, for gi_trace.comp and for gi_compose.frag where traced
// pixels do not fit.
#ifndef GI_SCREEN_GLSL
#define GI_SCREEN_GLSL
#define GI_SCREEN
#include "gbuffer.glsl"
#include "gi.glsl"
#include "gi_cones.glsl"
#include "gi_place.glsl"
#include "gi_pixel.glsl"
#include "gi_irradiance_lookup.glsl"
#include "gi_probe_lookup.glsl"

// tan of half the aperture of the cone that stands for a highlight. A Phong lobe of power n keeps
// 1 - 0.244 of its light within cos^(n + 1) = 0.244 (Uludag 2014, "Hi-Z screen-space cone-traced
// reflections", GPU Pro 5); a lobe about the half vector is a Phong lobe of a quarter of the power
// about the mirrored view (Lengyel; the half vector turns half as fast).
float gi_specular_tan(Surface s) {
    float power = uint(s.lobes.x) == LOBE_PHONG ? s.power : 0.25 * s.power;
    float cosine2 = exp2(2.0 * log2(0.244) / (power + 1.0));
    return max(sqrt(max(1.0 - cosine2, 0.0) / cosine2), gi.specular.x);
}

vec3 gi_start(GbufferPixel g) { return gi_start_at(g.position, g.normal); }

// Dithering goes by a fixed pattern of 4 x 4 pixels, their ranks 0..15 (Bayer 1973).
uint gi_rank_of(uvec2 pixel) {
    uint x = pixel.x ^ pixel.y, y = pixel.y;
    return (x & 1u) << 3 | (y & 1u) << 2 | (x & 2u) | (y & 2u) >> 1;
}

// Length of a diffuse cone's first sample, in voxels. Dithered: up to a quarter of a step off, so that
// samples of neighbouring pixels lie at different lengths.
float gi_first(uvec2 pixel) {
    if ((GI_FEATURES & GI_FEATURE_DITHER) == 0u) return GI_START;
    uint rank = gi_rank_of(pixel);
    float step = max(2.0 * gi_flow.cone.x * GI_START, 1.0) * gi_flow.cone.y;
    return GI_START + step * ((float(rank) + 0.5) * (1.0 / 32.0) - 0.25);
}

// The diffuse cones' lean. Dithered, each of 16 pixels has another, and gi_smooth.comp takes the
// pixels' mean (interleaved sampling: Keller and Heidrich 2001). The wide samples of shared faces
// need none.
vec2 gi_lean(uvec2 pixel) {
    if ((GI_FEATURES & GI_FEATURE_DITHER) == 0u || GI_FACES == 0u) return vec2(0.0);
    return gi_lean_of(gi_rank_of(pixel));
}

// is_on: false traces nothing (loops of no rounds: a branch would not save the work).
// lean: gi_lean, or 0 for a pixel by itself.
GiPixel gi_trace_pixel(GbufferPixel g, Surface s, uvec2 pixel, vec2 lean, bool is_on) {
    GiPixel result = GiPixel(vec4(0.0, 0.0, 0.0, 1.0), vec4(0.0));
    vec3 zenith = frame.sky_zenith.rgb * gi.scale.y, horizon = frame.sky_horizon.rgb * gi.scale.y;
    vec3 start = gi_start(g);
    float first = gi_first(pixel);
    if (GI_DIFFUSE == 2u) {
        vec4 probes = gi_probe_light(g.position, g.normal, is_on ? 8u : 0u);
        result.diffuse.rgb = probes.rgb;
        if ((GI_FEATURES & GI_FEATURE_AO) != 0u)
            result.diffuse.a = mix(gi.strength.z, 1.0, probes.a);
    } else if (GI_DIFFUSE == 1u || (GI_FEATURES & GI_FEATURE_AO) != 0u) {
        GiHemisphere sum =
            gi_hemisphere(start, g.normal, lean, first, gi_reach(), is_on ? 6u : 0u, zenith, horizon);
        if (GI_DIFFUSE == 1u) result.diffuse.rgb = sum.light;
        if ((GI_FEATURES & GI_FEATURE_AO) != 0u)
            result.diffuse.a = mix(gi.strength.z, 1.0, sum.visibility);
    }
    if (GI_DIFFUSE == 3u) result.diffuse.rgb = gi_irradiance_light(g.position, g.normal);
    if (gi_has_specular()) {
        vec3 color = gi_specular_color(s);
        bool shines = is_on && max(max(color.r, color.g), color.b) > 0.0;
        vec3 mirrored = reflect(-s.view, g.normal);
        // Interpolated normals may mirror the view into the surface.
        mirrored = normalize(mirrored + g.normal * max(-dot(mirrored, g.normal), 0.0) * 2.0);
        GiCone cone =
            gi_cone(start, mirrored, gi_specular_tan(s), GI_START, shines ? gi_reach() : 0.0);
        vec3 sky = mix(horizon, zenith, sqrt(clamp(mirrored.y, 0.0, 1.0)));
        vec3 light = cone.light.rgb + sky * max(1.0 - cone.light.a, 0.0);
        result.specular = shines ? vec4(light, 1.0) : vec4(0.0);
    }
    return result;
}
#endif

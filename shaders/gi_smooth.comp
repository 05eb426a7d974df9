#version 460
// gi_smooth.comp: dithered cones' light (gi_lean): the mean over the 4 x 4 pattern about each traced
// pixel. 5 x 5 taps of which the outermost count half hold each of the 16 ranks alike. Taps on other
// surfaces do not count.
#extension GL_GOOGLE_include_directive : require
#define GI_SCREEN
#include "gbuffer.glsl"
#include "gi.glsl"
#include "gi_place.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 2, binding = BINDING_GI_TRACE_RAW) uniform sampler2D trace_raw;
layout(set = 2, binding = BINDING_GI_TRACE_0_STORAGE, rgba16f) writeonly uniform image2D trace_0;

void main() {
    ivec2 last = ivec2(gi.trace.xy) - 1, traced = ivec2(gl_GlobalInvocationID.xy);
    ivec2 own = min(traced, last);
    GbufferPixel g = gbuffer_read(gi_traced_pixel(own));
    Place place = place_of(gi_traced_pixel(own), g);
    float tolerance = place_tolerance(g), height = dot(place.normal, place.at);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 tap = clamp(own + ivec2(x, y), ivec2(0), last), pixel = gi_traced_pixel(tap);
            float w = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0) *
                      place_fits(place_of(pixel, gbuffer_read(pixel)), place.normal, height,
                                 tolerance);
            sum += texelFetch(trace_raw, tap, 0) * w;
            weight += w;
        }
    if (traced == own) // the sky fits nothing, and nobody reads it
        imageStore(trace_0, traced, weight > 0.0 ? sum / weight : vec4(0.0, 0.0, 0.0, 1.0));
}

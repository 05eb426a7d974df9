// gi_place.glsl: which pixel a traced one stands for, and whether two show the same surface. Include
// gbuffer.glsl and gi.glsl with GI_SCREEN first.
#ifndef GI_PLACE_GLSL
#define GI_PLACE_GLSL

ivec2 gi_traced_pixel(ivec2 traced) {
    ivec2 pixel = (traced << GI_RESOLUTION) + ((1 << GI_RESOLUTION) >> 1);
    return min(pixel, ivec2(frame.viewport.xy) - 1);
}

// The surface that a pixel shows, as much as it takes to compare two. A pixel's place is seen from
// the eye; the sky has no normal.
struct Place {
    vec3 at, normal;
};
Place place_of(ivec2 pixel, GbufferPixel g) {
    vec3 at = pixel_ray(pixel) * (frame.camera.w / max(g.depth, 1e-9));
    return Place(at, g.depth > 0.0 ? g.normal : vec3(0.0));
}

// What a metre between two planes counts: a quarter of a voxel is nothing, or two pixels where these
// are larger.
float place_tolerance(GbufferPixel g) {
    float footprint = frame.camera.w / max(g.depth, 1e-9) * length(frame.ray_right.xyz) *
                      frame.viewport.z * 2.0;
    return 1.0 / max(0.25 * gi.origin[0].w, 2.0 * footprint);
}
// How well a place lies in a plane (height: over the eye) and faces its way, 0..1.
float place_fits(Place place, vec3 normal, float height, float tolerance) {
    float distance = abs(dot(normal, place.at) - height);
    return clamp(2.0 - distance * tolerance, 0.0, 1.0) *
           clamp(dot(normal, place.normal) * 4.0 - 3.0, 0.0, 1.0);
}
#endif

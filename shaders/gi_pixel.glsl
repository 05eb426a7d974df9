// gi_pixel.glsl: indirect light of one pixel, and what of it a surface mirrors. Include gbuffer.glsl
// and gi.glsl with GI_SCREEN first.
#ifndef GI_PIXEL_GLSL
#define GI_PIXEL_GLSL

struct GiPixel {
    vec4 diffuse;  // rgb without albedo, w ambient visibility
    vec4 specular; // rgb without the specular colour, w 1 = traced
};

// Colour that a mirrored cone counts with. The lobe's share of a uniform light: its normalised form
// is (n + 8) / (8 pi) (Akenine-Moller et al., Real-Time Rendering, 3rd ed., eq. 7.49); a mirror's
// half vector is the normal, so that is where Fresnel's term is taken.
vec3 gi_specular_color(Surface s) {
    float whole = min(s.lobes.y * (8.0 * PI) / (s.power + 8.0), 1.0);
    vec3 color = s.specular * (whole / max(s.lobes.y, 1e-6));
    if ((BRDF_MASK & BRDF_MASK_FRESNEL) != 0u) {
        float x = 1.0 - clamp(s.n_dot_v, 0.0, 1.0), x2 = x * x;
        color += (vec3(whole) - color) * (x2 * x2 * x * s.fresnel);
    }
    return color;
}

bool gi_has_specular() {
    return (GI_FEATURES & GI_FEATURE_SPECULAR) != 0u && (BRDF_MASK & 14u) != 0u;
}
#endif

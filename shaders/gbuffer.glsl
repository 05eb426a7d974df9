// gbuffer.glsl: the layouts of the G-buffer, writing and reading side by side, chosen by LAYOUT
// (specification of direct lighting, section 2; what each target is: render/layouts.c).
//
// All lighting passes see one GbufferPixel and three functions over it, so that they know no
// layout. Layouts with a material index leave the attributes to the palette; the others carry
// specular colour, power and so on themselves, and lose the lobe: the level's most common one
// (frame.common_lobes) stands for all. Position comes from what the layout itself says, so that
// its error shows; the depth buffer only tells background from surface.
// GBUFFER_WRITES is defined by gbuffer.frag: its targets must not be declared as textures too.
#ifndef GBUFFER_GLSL
#define GBUFFER_GLSL
#include "light.glsl"

// Normalisation of the common lobe at a power (make_material of systems/packet_draws.c).
float common_normalisation(float power) {
    uint kind = uint(frame.common_lobes.x);
    return kind == 0u ? 0.0 : kind == 3u ? (power + 8.0) / (8.0 * PI) : 1.0;
}

vec2 view_xy(vec3 normal) {
    return vec2(dot(vec3(frame.view[0].x, frame.view[1].x, frame.view[2].x), normal),
                dot(vec3(frame.view[0].y, frame.view[1].y, frame.view[2].y), normal));
}
vec3 view_to_world(vec3 v) { return v * mat3(frame.view); } // its inverse is its transpose

// How far a point moved over the picture since the last frame, in shares of it; of the camera's
// motion (packets do not say where instances were).
vec2 camera_motion(vec3 position) {
    vec4 now = frame.view_projection * vec4(position, 1.0);
    vec4 before = frame.previous_view_projection * vec4(position, 1.0);
    return (now.xy / now.w - before.xy / max(before.w, 1e-6)) * vec2(0.5, -0.5);
}

#ifdef GBUFFER_WRITES

// Colour of the highlight for a layout that does not say which lobe it is: the common one, made as
// strong as the material's own.
vec4 common_specular(uint material) {
    vec4 specular = palette_specular(material);
    float shared_lobe = common_normalisation(specular.w);
    float factor = shared_lobe > 0.0 ? palette_lobes(material).y / shared_lobe : 0.0;
    return vec4(specular.rgb * factor, specular.w);
}
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// position: world; direction: along the normal, of any length. Targets beyond the layout's are left 0.
void gbuffer_write(vec3 position, vec3 direction, vec3 albedo, uint material, out vec4 t[5]) {
    for (uint i = 0u; i < 5u; i++) t[i] = vec4(0.0);
    vec3 eye = position - frame.camera.xyz;
    vec4 indexed = vec4(albedo8_encode(albedo), float(material) / 255.0);
    if (LAYOUT == GBUFFER_LAYOUT_LEAN) {
        t[0] = indexed;
        t[1].xy = oct_encode(direction) * 0.5 + 0.5; // the length cancels
        return;
    }
    vec3 normal = direction * inversesqrt(max(dot(direction, direction), 1e-20));
    if (LAYOUT == GBUFFER_LAYOUT_WIDE) {
        t[0] = vec4(position, 1.0);
        t[1] = vec4(normal, 0.0);
        t[2] = indexed;
        return;
    }
    if (LAYOUT == GBUFFER_LAYOUT_PACKED) {
        t[0] = vec4(signed8_encode(view_xy(normal)), distance16_encode(length(eye), frame.coding.x));
        t[1] = indexed;
        return;
    }
    if (LAYOUT == GBUFFER_LAYOUT_PACKED24) {
        t[0] = vec4(signed8_encode(view_xy(normal)), 0.0, 0.0);
        t[1] = vec4(distance24_encode(length(eye), frame.coding.x), 0.0);
        t[2] = indexed;
        return;
    }
    vec4 emissive = palette_emissive(material);
    vec3 accumulated = emissive.rgb + albedo * frame.ambient.rgb;
    if (LAYOUT == GBUFFER_LAYOUT_HALF5) {
        vec4 specular = palette_specular(material);
        t[0] = vec4(eye, 1.0);
        t[1] = vec4(normal, specular.w);
        t[2] = vec4(albedo, float(material));
        t[3] = vec4(specular.rgb, palette_extra(material).x);
        t[4] = vec4(accumulated, emissive.w);
        return;
    }
    vec4 specular = common_specular(material);
    if (LAYOUT == GBUFFER_LAYOUT_KILLZONE2) {
        t[0] = light8_encode(accumulated);
        t[1].xy = view_xy(normal);
        t[2] = vec4(motion8_encode(camera_motion(position)),
                    emissive.w > 0.0 ? power8_encode(specular.w) : 0.0,
                    sqrt(min(luminance(specular.rgb), 1.0)));
        t[3] = vec4(albedo8_encode(albedo), SHADOW != 0u ? shadow_visibility(position, normal) : 1.0);
    }
    if (LAYOUT == GBUFFER_LAYOUT_STARCRAFT2) {
        t[0] = emissive;
        t[1] = vec4(normal, dot(eye, frame.ray_forward.xyz));
        t[2] = vec4(albedo, 1.0); // nothing occludes ambient light yet
        t[3] = specular;
    }
    if (LAYOUT == GBUFFER_LAYOUT_IL) {
        t[0] = vec4(albedo, emissive.w);
        t[1] = vec4(view_xy(normal), specular.w, luminance(specular.rgb));
        t[2].xy = vec2(oren_nayar_encode(palette_lobes(material).zw),
                       dot(eye, frame.ray_forward.xyz));
        t[3] = vec4(accumulated, 0.0); // w: 1 where a lightmap is in it
    }
}

#else

layout(set = 0, binding = BINDING_GBUFFER_0) uniform sampler2D gbuffer_0;
layout(set = 0, binding = BINDING_GBUFFER_1) uniform sampler2D gbuffer_1;
layout(set = 0, binding = BINDING_GBUFFER_2) uniform sampler2D gbuffer_2;
layout(set = 0, binding = BINDING_GBUFFER_3) uniform sampler2D gbuffer_3;
layout(set = 0, binding = BINDING_GBUFFER_4) uniform sampler2D gbuffer_4;
layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D gbuffer_depth;
layout(set = 0, binding = BINDING_NORMAL_Z) uniform sampler2D normal_z;

struct GbufferPixel {
    vec3 albedo, normal, position; // world
    float depth;                   // of the depth buffer; 0 = background
    uint material;                 // palette row, of layouts with an index (else 0)
    // The rest is of layouts that carry it; see gbuffer_surface.
    vec4 specular;     // rgb, w power
    vec2 oren_nayar;   // A, B
    float fresnel;
    vec3 accumulated;  // radiance that no light adds to: emission, ambient light
    float receives;    // 1 = local and directional lights count
    float sun;         // visibility of directional 0
    vec2 motion;       // see camera_motion
};

// z by arithmetic, or from a table that the two bytes index.
vec3 facing8_decode(vec2 t) {
    vec2 xy = signed8_decode(t);
    float z = NORMAL_LOOKUP != 0u ? texelFetch(normal_z, ivec2(t * 255.0 + 0.5), 0).x
                                  : facing_z(xy);
    return view_to_world(facing_decode(xy, z));
}
vec3 facing_world(vec2 xy) { return view_to_world(facing_decode(xy, facing_z(xy))); }

// Through a pixel, 1 m along the view's direction.
vec3 pixel_ray(ivec2 pixel) {
    vec2 ndc = vec2((float(pixel.x) + 0.5) * frame.viewport.z * 2.0 - 1.0,
                    1.0 - (float(pixel.y) + 0.5) * frame.viewport.w * 2.0);
    return frame.ray_right.xyz * ndc.x + frame.ray_up.xyz * ndc.y + frame.ray_forward.xyz;
}

// depth: what the depth buffer holds there.
GbufferPixel gbuffer_read_at(ivec2 pixel, float depth) {
    GbufferPixel g;
    g.depth = depth;
    g.material = 0u;
    g.specular = vec4(0.0, 0.0, 0.0, 1.0);
    g.oren_nayar = frame.common_lobes.zw;
    g.fresnel = frame.common_lobes.y;
    g.accumulated = vec3(0.0);
    g.receives = 1.0;
    g.sun = 1.0;
    g.motion = vec2(0.0);
    if (LAYOUT == GBUFFER_LAYOUT_LEAN) {
        vec4 indexed = texelFetch(gbuffer_0, pixel, 0);
        g.albedo = albedo8_decode(indexed.rgb);
        g.material = uint(indexed.a * 255.0 + 0.5);
        g.normal = oct_decode(texelFetch(gbuffer_1, pixel, 0).xy * 2.0 - 1.0);
        g.position = position_from_depth(vec2(pixel) + 0.5, g.depth);
    }
    if (LAYOUT == GBUFFER_LAYOUT_WIDE) {
        g.position = texelFetch(gbuffer_0, pixel, 0).xyz;
        g.normal = texelFetch(gbuffer_1, pixel, 0).xyz;
        vec4 indexed = texelFetch(gbuffer_2, pixel, 0);
        g.albedo = albedo8_decode(indexed.rgb);
        g.material = uint(indexed.a * 255.0 + 0.5);
    }
    if (LAYOUT == GBUFFER_LAYOUT_PACKED) {
        vec4 geometry = texelFetch(gbuffer_0, pixel, 0), indexed = texelFetch(gbuffer_1, pixel, 0);
        g.normal = facing8_decode(geometry.xy);
        g.position = frame.camera.xyz + normalize(pixel_ray(pixel)) *
                                            distance16_decode(geometry.zw, frame.coding.x);
        g.albedo = albedo8_decode(indexed.rgb);
        g.material = uint(indexed.a * 255.0 + 0.5);
    }
    if (LAYOUT == GBUFFER_LAYOUT_PACKED24) {
        vec4 indexed = texelFetch(gbuffer_2, pixel, 0);
        g.normal = facing8_decode(texelFetch(gbuffer_0, pixel, 0).xy);
        g.position = frame.camera.xyz +
                     normalize(pixel_ray(pixel)) *
                         distance24_decode(texelFetch(gbuffer_1, pixel, 0).xyz, frame.coding.x);
        g.albedo = albedo8_decode(indexed.rgb);
        g.material = uint(indexed.a * 255.0 + 0.5);
    }
    if (LAYOUT == GBUFFER_LAYOUT_HALF5) {
        vec4 normal = texelFetch(gbuffer_1, pixel, 0), albedo = texelFetch(gbuffer_2, pixel, 0);
        vec4 specular = texelFetch(gbuffer_3, pixel, 0), light = texelFetch(gbuffer_4, pixel, 0);
        g.position = frame.camera.xyz + texelFetch(gbuffer_0, pixel, 0).xyz;
        g.normal = normalize(normal.xyz);
        g.albedo = albedo.rgb;
        g.material = uint(albedo.a + 0.5);
        g.specular = vec4(specular.rgb, normal.w);
        g.fresnel = specular.w;
        g.accumulated = light.rgb;
        g.receives = light.w;
    }
    if (LAYOUT == GBUFFER_LAYOUT_KILLZONE2) {
        vec4 shine = texelFetch(gbuffer_2, pixel, 0), albedo = texelFetch(gbuffer_3, pixel, 0);
        g.accumulated = light8_decode(texelFetch(gbuffer_0, pixel, 0));
        g.normal = facing_world(texelFetch(gbuffer_1, pixel, 0).xy);
        g.position = position_from_depth(vec2(pixel) + 0.5, g.depth);
        g.motion = motion8_decode(shine.xy);
        g.receives = shine.z > 0.0 ? 1.0 : 0.0;
        g.specular = vec4(vec3(shine.w * shine.w), power8_decode(shine.z));
        g.albedo = albedo8_decode(albedo.rgb);
        g.sun = albedo.a;
    }
    if (LAYOUT == GBUFFER_LAYOUT_STARCRAFT2) {
        vec4 light = texelFetch(gbuffer_0, pixel, 0), geometry = texelFetch(gbuffer_1, pixel, 0);
        vec4 albedo = texelFetch(gbuffer_2, pixel, 0);
        g.normal = normalize(geometry.xyz);
        g.position = frame.camera.xyz + pixel_ray(pixel) * geometry.w;
        g.albedo = albedo.rgb;
        g.accumulated = light.rgb + albedo.rgb * frame.ambient.rgb * albedo.a;
        g.receives = light.w;
        g.specular = texelFetch(gbuffer_3, pixel, 0);
    }
    if (LAYOUT == GBUFFER_LAYOUT_IL) {
        vec4 albedo = texelFetch(gbuffer_0, pixel, 0), geometry = texelFetch(gbuffer_1, pixel, 0);
        vec2 pair = texelFetch(gbuffer_2, pixel, 0).xy;
        g.albedo = albedo.rgb;
        g.receives = albedo.a;
        g.normal = facing_world(geometry.xy);
        g.specular = vec4(vec3(geometry.w), geometry.z);
        g.oren_nayar = oren_nayar_decode(pair.x);
        g.position = frame.camera.xyz + pixel_ray(pixel) * pair.y;
        g.accumulated = texelFetch(gbuffer_3, pixel, 0).rgb;
    }
    return g;
}
GbufferPixel gbuffer_read(ivec2 pixel) {
    return gbuffer_read_at(pixel, texelFetch(gbuffer_depth, pixel, 0).x);
}

// What lights shine on.
Surface gbuffer_surface(GbufferPixel g) {
    if (LAYOUT < GBUFFER_LAYOUT_HALF5)
        return surface_make(g.position, g.normal, g.albedo, g.material);
    vec4 lobes = LAYOUT == GBUFFER_LAYOUT_HALF5
                     ? palette_lobes(g.material)
                     : vec4(frame.common_lobes.x, common_normalisation(g.specular.w), g.oren_nayar);
    return surface_from(g.position, g.normal, g.albedo, g.specular, lobes, g.fresnel);
}

// Factor on what lights add: 0 of surfaces that receive no light.
float gbuffer_receives(GbufferPixel g) {
    return LAYOUT < GBUFFER_LAYOUT_HALF5 ? palette_emissive(g.material).w : g.receives;
}

// Outgoing radiance; local: the sum over local lights.
vec3 gbuffer_radiance(GbufferPixel g, Surface s, vec3 local) {
    if (LAYOUT < GBUFFER_LAYOUT_HALF5)
        return light_base(s, g.albedo, g.material) + local * palette_emissive(g.material).w;
    float sun = LAYOUT == GBUFFER_LAYOUT_KILLZONE2 ? g.sun : sun_visibility(s);
    return g.accumulated + (light_directionals(s, sun) + local) * g.receives;
}
#endif
#endif

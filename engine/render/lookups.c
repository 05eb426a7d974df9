// lookups.c: textures that answer instead of arithmetic or a buffer: falloff of lights, z of
// two-number normals, the material palette (specification of direct lighting, sections 1 and 2).
//
// Data in: a packet (which attenuation, materials). Data out: three textures, made when a setting
// first asks for one, filled again when what they hold changed; the white stand-in is bound until
// then. Called by: frame_upload.c once a frame. The reading side: falloff_texel (light.glsl),
// palette_texel (common.glsl), facing8_decode (gbuffer.glsl).
#include "render_internal.h"
#include "../base/hash.h"
#include <math.h>
#include <string.h>

// Packet.attenuation (Attenuation of world/components.h, as light.glsl counts them).
enum { ATTENUATION_INVERSE_SQUARE, ATTENUATION_WINDOW, ATTENUATION_POLYNOMIAL };
#define FALLOFF_TEXELS  256
#define NORMAL_Z_SIDE   256
#define PALETTE_MEMBERS (sizeof(MaterialRecord) / sizeof(vec4))

static bool texture_ensure(Renderer *renderer, GpuTexture *texture, const char *label,
                           GpuFormat format, u32 width, u32 height) {
    if (texture->id) return true;
    *texture = gpu_create_texture(
        renderer->gpu,
        &(GpuTextureDesc){
            .label = label, .format = format, .width = width, .height = height, .sampled = true});
    renderer->frame_group_stale = true;
    return texture->id != 0;
}

// Round to nearest even; for values that a half can hold, from 0 to 65,504.
static u16 half_from_f32(f32 value) {
    u32 bits;
    // Numbers below 2^-14 have no exponent of their own: 2^-24 is the unit there.
    if (value < 0x1p-14f) return (u16)lrintf(value * 0x1p24f);
    memcpy(&bits, &value, sizeof bits);
    bits += 0xFFF + ((bits >> 13) & 1);
    return (u16)((bits - (112u << 23)) >> 13);
}

// The table is linear between its texels, whose centres are x = 0 .. 1, so it holds what has
// little curvature, and the shader does the rest:
//   window          1 - x, x = d^2 / R^2                      the factor itself
//   inverse square  1 - x^2                                   squared, times 1 / d^2
//   polynomial      (1-t)^2 (kc + kl d + kq d^2) * coding.y,  t = d / (d + attenuation.w): a
//                   parabola in t; the factor is window * (1-t)^2 * coding.y over it
// The error of linear filtering is h^2 / 8 times the curvature, h = 1 / 255: below 2e-5 of the
// largest value; a half adds 2.5e-4 of the value.
static f32 falloff_value(const Packet *packet, f32 x) {
    if (packet->attenuation == ATTENUATION_WINDOW) return 1.0f - x;
    if (packet->attenuation == ATTENUATION_INVERSE_SQUARE) return 1.0f - x * x;
    const f32 *k = packet->frame.attenuation;
    f32 rest = 1.0f - x, along = x * k[3];
    return (k[0] * rest * rest + k[1] * along * rest + k[2] * along * along) *
           packet->frame.coding[1];
}

static bool falloff_update(Renderer *renderer, const Packet *packet) {
    if (!texture_ensure(renderer, &renderer->falloff, "falloff", GPU_FORMAT_RG16F, FALLOFF_TEXELS,
                        1))
        return false;
    u64 key = hash_bytes(packet->frame.attenuation, sizeof packet->frame.attenuation,
                         packet->attenuation + 1);
    if (renderer->falloff_key == key) return true;
    u16 texels[FALLOFF_TEXELS][2] = {0};
    for (u32 i = 0; i < FALLOFF_TEXELS; i++) {
        f32 value = falloff_value(packet, (f32)i / (FALLOFF_TEXELS - 1));
        texels[i][0] = half_from_f32(CLAMP(value, 0.0f, 1.0f));
    }
    gpu_upload_texture(renderer->gpu, renderer->falloff, texels, sizeof texels);
    renderer->falloff_key = key;
    return true;
}

// Row y, column x: the bytes of a normal's y and x (signed8_encode of coding.glsl).
static bool normal_z_update(Renderer *renderer) {
    if (renderer->normal_z.id) return true;
    if (!texture_ensure(renderer, &renderer->normal_z, "normal z", GPU_FORMAT_R32F, NORMAL_Z_SIDE,
                        NORMAL_Z_SIDE))
        return false;
    static f32 texels[NORMAL_Z_SIDE][NORMAL_Z_SIDE];
    for (i32 row = 0; row < NORMAL_Z_SIDE; row++)
        for (i32 column = 0; column < NORMAL_Z_SIDE; column++) {
            f32 x = (f32)(column - 128) / 127.0f, y = (f32)(row - 128) / 127.0f;
            texels[row][column] = sqrtf(MAX(1.0f - x * x - y * y, 0.0f));
        }
    gpu_upload_texture(renderer->gpu, renderer->normal_z, texels, sizeof texels);
    return true;
}

static bool palette_update(Renderer *renderer, const Packet *packet) {
    if (!texture_ensure(renderer, &renderer->palette, "palette", GPU_FORMAT_RGBA32F,
                        PALETTE_MEMBERS, MATERIALS_CAP))
        return false;
    static MaterialRecord texels[MATERIALS_CAP]; // the members are the texels of a row
    u64 size = (u64)packet->materials.count * sizeof *texels;
    const MaterialRecord *materials = PACKET_DATA(packet, materials, MaterialRecord);
    u64 key = hash_bytes(materials, size, packet->materials.count + 1);
    if (renderer->palette_key == key) return true;
    memset(texels, 0, sizeof texels);
    memcpy(texels, materials, size);
    gpu_upload_texture(renderer->gpu, renderer->palette, texels, sizeof texels);
    renderer->palette_key = key;
    return true;
}

bool lookups_update(Renderer *renderer, const Packet *packet) {
    const RenderSettings *settings = &packet->settings;
    return (!settings->attenuation_lookup || falloff_update(renderer, packet)) &&
           (!settings->normal_lookup || normal_z_update(renderer)) &&
           (settings->palette != PALETTE_TEXTURE || palette_update(renderer, packet));
}

void lookups_destroy(Renderer *renderer) {
    GpuTexture *textures[] = {&renderer->falloff, &renderer->normal_z, &renderer->palette};
    for (u32 i = 0; i < COUNT_OF(textures); i++) {
        if (textures[i]->id) gpu_destroy_texture(renderer->gpu, *textures[i]);
        *textures[i] = (GpuTexture){0};
    }
    renderer->falloff_key = renderer->palette_key = 0;
}

// gltf_material.c: glTF materials and their images to the engine's terms.
//
// Data in: checked GltfRaw. Data out: textures in the store (one per image and kind, decoded by all
// threads; what another model has brought already is shared), model->materials. Called by
// asset_load_model. Does not: refuse a model for a missing or damaged picture: a warning, and the
// checker takes its place (flat, for normal maps).
//
// The engine shades with a diffuse colour, a specular colour and a power. Metallic-roughness maps
// to these as: specular = mix(0.04, base, metallic), diffuse = base * (1 - metallic),
// power = 2 / a^2 - 2 with a = roughness^2 (Walter et al. 2007 by way of Karis 2013). There are no
// textures for metal and roughness: their mean becomes a factor.
#include "gltf_raw.h"
#include "../base/hash.h"
#include "../base/jobs.h"
#include "../base/log.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIELECTRIC    0.04f
#define ROUGHNESS_MIN 0.05f
#define POWER_MAX     2048.0f
#define MEAN_SIDE     64 // px; the size at which metal and roughness are averaged

typedef enum Use { USE_SRGB, USE_LINEAR, USE_MEAN, USE_COUNT } Use;

typedef struct Decode {
    Bytes file;
    u64 hash;           // of the file's bytes and the largest side
    u32 image, texture; // texture 0: USE_MEAN, pixels in scratch
    u32 width, height;
    TextureKind kind;
    u8 *pixels;
    bool failed;
    char why[ASSET_MESSAGE_CAP];
} Decode;

typedef struct Builder {
    AssetStore *store;
    GltfFiles *files;
    const GltfRaw *raw;
    const char *path;
    u32 *texture_of[2];    // [USE_SRGB, USE_LINEAR][image]: texture id, 0 none
    f32 (*mean_of)[4];     // [image]: mean of USE_MEAN, 0..1 each; negative: none
    bool *used[USE_COUNT]; // [image]
    Decode *decodes;
    u32 decode_count;
    u64 pixels_left;
} Builder;

// ---- images ----

static i32 image_of(const GltfRaw *raw, const GltfTextureRef *ref) {
    return ref->texture < 0 ? -1 : raw->textures[ref->texture].image;
}

static void mark_used(Builder *b, const GltfTextureRef *ref, Use use) {
    i32 image = image_of(b->raw, ref);
    if (image >= 0) b->used[use][image] = true;
}

static bool image_bytes(Builder *b, u32 image, Bytes *out, char *why) {
    const GltfImage *i = &b->raw->images[image];
    *out = i->view >= 0 ? gltf_view_bytes(b->raw, i->view) : i->bytes;
    if (out->size) return true;
    char name[GLTF_PATH_CAP];
    if (i->uri.size == 0) {
        snprintf(why, ASSET_MESSAGE_CAP, "no bytes");
        return false;
    }
    return gltf_uri_decode(b->files, i->uri, name, why) == GLTF_URI_OK &&
           gltf_files_read(b->files, name, strlen(name), out, why);
}

static void miss(const Builder *b, u32 image, const char *why) {
    LOG(ASSET_IMAGE, "%s: image %u: %s", b->path, image, why);
}

// Reserves memory for every use of an image, so that decoding needs no lock. False: a limit.
static bool plan_image(Builder *b, u32 image, char *why) {
    char reason[ASSET_MESSAGE_CAP] = "";
    u32 width, height;
    Bytes file;
    bool wanted = false;
    for (u32 use = 0; use < USE_COUNT; use++) wanted |= b->used[use][image];
    if (!wanted) return true;
    if (b->used[USE_SRGB][image]) b->texture_of[USE_SRGB][image] = ASSET_TEXTURE_CHECKER;
    if (!image_bytes(b, image, &file, reason) || !image_probe(file, &width, &height, reason)) {
        miss(b, image, reason);
        return true;
    }
    u64 hash = hash_bytes(file.data, file.size, b->store->texture_side_cap);
    for (u32 use = 0; use < USE_COUNT; use++) {
        if (!b->used[use][image]) continue;
        TextureKind kind = use == USE_SRGB ? TEXTURE_SRGB : TEXTURE_LINEAR;
        if (use != USE_MEAN) {
            b->texture_of[use][image] = store_find_texture(b->store, hash, kind);
            if (b->texture_of[use][image]) continue;
        }
        u64 pixel_count = (u64)width * height;
        if (pixel_count > b->pixels_left) {
            snprintf(why, ASSET_MESSAGE_CAP, "its images have more than %llu pixels",
                     (unsigned long long)GLTF_PIXELS_MAX);
            return false;
        }
        b->pixels_left -= pixel_count;
        Decode *d = &b->decodes[b->decode_count++];
        *d = (Decode){.file = file,
                      .hash = hash,
                      .image = image,
                      .width = width,
                      .height = height,
                      .kind = kind};
        u32 cap = b->store->texture_side_cap;
        image_fit(&d->width, &d->height, use == USE_MEAN ? MIN(cap, MEAN_SIDE) : cap);
        if (use == USE_MEAN) {
            d->pixels = scratch_try_push(&b->store->scratch, (u64)d->width * d->height, 4);
        } else {
            d->texture =
                store_reserve_texture(b->store, d->width, d->height, d->kind, true, &d->pixels);
            b->texture_of[use][image] = d->texture;
        }
        if (!d->pixels) {
            snprintf(why, ASSET_MESSAGE_CAP, "image %u: no room for it", image);
            return false;
        }
    }
    return true;
}

// A job: writes its own slots only.
static void decode_range(void *context, u32 begin, u32 end, u32 thread_index) {
    Builder *b = context;
    (void)thread_index;
    for (u32 i = begin; i < end; i++) {
        Decode *d = &b->decodes[i];
        d->failed = !image_decode(d->file, d->width, d->height, d->kind, d->pixels, d->why);
        if (d->failed || !d->texture) continue;
        image_build_mips(d->pixels, d->width, d->height, d->kind);
        b->store->textures[d->texture].has_alpha =
            image_has_alpha(d->pixels, (u64)d->width * d->height);
    }
}

static void find_mean(const Decode *d, f32 mean[4]) {
    u64 sum[4] = {0}, count = (u64)d->width * d->height;
    for (u64 i = 0; i < count; i++)
        for (u32 c = 0; c < 4; c++) sum[c] += d->pixels[i * 4 + c];
    for (u32 c = 0; c < 4; c++) mean[c] = (f32)((f64)sum[c] / (f64)count / 255.0);
}

static void take_results(Builder *b) {
    for (u32 i = 0; i < b->decode_count; i++) {
        const Decode *d = &b->decodes[i];
        if (d->failed) miss(b, d->image, d->why);
        if (!d->texture) {
            if (!d->failed) find_mean(d, b->mean_of[d->image]);
        } else if (d->failed) {
            // The slot is reserved already: it shows the checker's pixels.
            b->store->textures[d->texture] = b->store->textures[ASSET_TEXTURE_CHECKER];
            if (d->kind == TEXTURE_LINEAR) b->texture_of[USE_LINEAR][d->image] = 0;
        } else {
            store_share_texture(b->store, d->texture, d->hash);
        }
    }
}

static bool load_images(Builder *b, char *why) {
    const GltfRaw *raw = b->raw;
    Arena *scratch = &b->store->scratch;
    u64 count = MAX(raw->image_count, 1);
    bool ok = true;
    for (u32 use = 0; use < USE_COUNT; use++)
        ok = ok && (b->used[use] = scratch_try_push(scratch, count, sizeof(bool)));
    for (u32 use = 0; use < 2; use++)
        ok = ok && (b->texture_of[use] = scratch_try_push(scratch, count, sizeof(u32)));
    ok = ok && (b->mean_of = scratch_try_push(scratch, count, sizeof *b->mean_of));
    ok = ok && (b->decodes = scratch_try_push(scratch, count * USE_COUNT, sizeof *b->decodes));
    if (!ok) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u images", raw->image_count);
        return false;
    }
    for (u32 i = 0; i < raw->image_count; i++) b->mean_of[i][0] = -1;
    for (u32 i = 0; i < raw->material_count; i++) {
        const GltfMaterial *m = &raw->materials[i];
        mark_used(b, &m->base_texture, USE_SRGB);
        mark_used(b, &m->emissive_texture, USE_SRGB);
        mark_used(b, &m->normal_texture, USE_LINEAR);
        mark_used(b, &m->metallic_roughness_texture, USE_MEAN);
    }
    for (u32 i = 0; i < raw->image_count; i++)
        if (!plan_image(b, i, why)) return false;
    jobs_for(b->decode_count, 1, decode_range, b);
    take_results(b);
    return true;
}

// ---- materials ----

// Texture id of a reference. A texture without an image (a format of an extension) shows the
// checker, a missing normal map is flat.
static u32 texture_id(const Builder *b, const GltfTextureRef *ref, Use use) {
    if (ref->texture < 0) return 0;
    i32 image = image_of(b->raw, ref);
    if (image >= 0) return b->texture_of[use][image];
    return use == USE_SRGB ? ASSET_TEXTURE_CHECKER : 0;
}

// Mean colour of a texture, linear: its last mip.
static void mean_color(const Texture *t, f32 out[3]) {
    u64 size = image_mips_size(t->width, t->height, t->mip_count);
    const u8 *last = t->pixels + size - 4;
    for (u32 c = 0; c < 3; c++) out[c] = srgb_to_linear((f32)last[c] / 255.0f);
}

static void convert_material(const Builder *b, const GltfMaterial *m, u32 index,
                             ModelMaterial *out) {
    Arena *arena = &b->store->arena;
    *out = (ModelMaterial){.name = m->name[0] ? arena_copy_string(arena, m->name)
                                              : arena_format(arena, "material %u", index),
                           .emissive_strength = MAX(m->emissive_strength, 0.0f),
                           .alpha_mode = m->alpha_mode,
                           .alpha_cutoff = f32_saturate(m->cutoff),
                           .double_sided = m->double_sided,
                           .albedo_texture = texture_id(b, &m->base_texture, USE_SRGB),
                           .normal_texture = texture_id(b, &m->normal_texture, USE_LINEAR),
                           .emissive_texture = texture_id(b, &m->emissive_texture, USE_SRGB)};

    f32 metallic = f32_saturate(m->metallic), roughness = f32_saturate(m->roughness);
    i32 image = image_of(b->raw, &m->metallic_roughness_texture);
    if (image >= 0 && b->mean_of[image][0] >= 0) {
        roughness *= b->mean_of[image][1]; // green
        metallic *= b->mean_of[image][2];  // blue
    }
    // A metal's specular colour is its base colour; of a texture only the mean can be kept.
    f32 mean[3] = {1, 1, 1};
    if (out->albedo_texture && metallic > 0.0f)
        mean_color(&b->store->textures[out->albedo_texture], mean);
    for (u32 c = 0; c < 3; c++) {
        f32 base = f32_saturate(m->base[c]);
        f32 dielectric = f32_saturate(DIELECTRIC * MAX(m->specular_color[c], 0.0f)) *
                         f32_saturate(m->specular_factor);
        out->albedo[c] = base * (1.0f - metallic);
        out->specular[c] = f32_lerp(dielectric, base * mean[c], metallic);
        out->emissive[c] = f32_saturate(m->emissive[c]);
    }
    out->albedo[3] = f32_saturate(m->base[3]);
    f32 a = MAX(roughness, ROUGHNESS_MIN);
    a *= a;
    out->power = CLAMP(2.0f / (a * a) - 2.0f, 1.0f, POWER_MAX);
}

static bool same_mapping(const GltfTextureRef *a, const GltfTextureRef *b) {
    return a->texture < 0 || b->texture < 0 ||
           (a->set == b->set && a->offset[0] == b->offset[0] && a->offset[1] == b->offset[1] &&
            a->scale[0] == b->scale[0] && a->scale[1] == b->scale[1] &&
            a->rotation_rad == b->rotation_rad);
}

static void remark(const Builder *b) {
    u32 unlit = 0, specular = 0, scaled = 0, mapped = 0;
    for (u32 i = 0; i < b->raw->material_count; i++) {
        const GltfMaterial *m = &b->raw->materials[i];
        unlit += m->unlit;
        specular += m->has_specular_textures;
        scaled += m->normal_texture.texture >= 0 && m->normal_scale != 1.0f;
        mapped += !same_mapping(&m->base_texture, &m->normal_texture) ||
                  !same_mapping(&m->base_texture, &m->emissive_texture) ||
                  !same_mapping(&m->normal_texture, &m->emissive_texture);
    }
    if (unlit) LOG(ASSET_MODEL_WARNING, "%s: %u unlit materials are lit here", b->path, unlit);
    if (specular)
        LOG(ASSET_MODEL_WARNING, "%s: specular textures of %u materials are ignored", b->path,
            specular);
    if (scaled)
        LOG(ASSET_MODEL_WARNING, "%s: the normal scale of %u materials is ignored", b->path,
            scaled);
    if (mapped)
        LOG(ASSET_MODEL_WARNING,
            "%s: %u materials map their textures in different ways; all "
            "follow the base colour",
            b->path, mapped);
}

// Not glTF's own default (a rough white metal, black without surroundings to reflect).
static ModelMaterial default_material(void) {
    return (ModelMaterial){.name = "default",
                           .albedo = {0.8f, 0.8f, 0.8f, 1},
                           .specular = {DIELECTRIC, DIELECTRIC, DIELECTRIC},
                           .power = 32,
                           .emissive_strength = 1,
                           .alpha_cutoff = 0.5f};
}

bool gltf_build_materials(AssetStore *store, GltfFiles *files, const GltfRaw *raw, const char *path,
                          Model *model, char *why) {
    Builder b = {.store = store, .files = files, .raw = raw, .path = path};
    b.pixels_left = GLTF_PIXELS_MAX;
    if (!load_images(&b, why)) return false;
    bool default_used = raw->material_count == 0;
    for (u32 i = 0; i < raw->primitive_count; i++) default_used |= raw->primitives[i].material < 0;
    u32 count = raw->material_count + default_used;
    ModelMaterial *materials = ARENA_PUSH(&store->arena, ModelMaterial, count);
    for (u32 i = 0; i < raw->material_count; i++)
        convert_material(&b, &raw->materials[i], i, &materials[i]);
    if (default_used) materials[count - 1] = default_material();
    model->materials = materials;
    model->material_count = count;
    remark(&b);
    return true;
}

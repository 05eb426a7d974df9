// Texture cache: runs a painter, derives normals from its heights, encodes. See texture.h.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include "texture.h"

#include "paint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct TextureRow {
    const char *name;
    void (*paint)(Canvas *c);
    int size;
    float tile_m;
    int quality;        // JPEG quality of the albedo
    int normal_quality; // 0: flat, no normal image
    bool masked;        // albedo as PNG with alpha
} TextureRow;

static const TextureRow ROWS[TEXTURE_COUNT] = {
    [TEXTURE_ASHLAR] = {"ashlar", paint_ashlar, 512, 2.0f, 86, 86, false},
    [TEXTURE_CARVED] = {"carved", paint_carved, 256, 1.0f, 86, 86, false},
    [TEXTURE_FLOOR] = {"floor", paint_floor, 512, 1.5f, 86, 86, false},
    [TEXTURE_ROOF] = {"roof", paint_roof, 512, 1.5f, 84, 86, false},
    [TEXTURE_GRAVEL] = {"gravel", paint_gravel, 512, 1.2f, 80, 82, false},
    [TEXTURE_GRASS] = {"grass", paint_grass, 512, 1.6f, 80, 80, false},
    [TEXTURE_HEDGE] = {"hedge", paint_hedge, 256, 0.8f, 84, 84, false},
    [TEXTURE_BARK] = {"bark", paint_bark, 128, 0.6f, 84, 86, false},
    [TEXTURE_WOOD] = {"wood", paint_wood, 512, 1.2f, 86, 86, false},
    [TEXTURE_IRON] = {"iron", paint_iron, 128, 0.25f, 86, 88, false},
    [TEXTURE_WATER] = {"water", paint_water, 256, 1.1f, 88, 90, false},
    [TEXTURE_LEAF_CYPRESS] = {"leaf_cypress", paint_leaf_cypress, 256, 0.8f, 0, 0, true},
    [TEXTURE_LEAF_ROSE] = {"leaf_rose", paint_leaf_rose, 256, 0.6f, 0, 0, true},
    [TEXTURE_LEAF_IVY] = {"leaf_ivy", paint_leaf_ivy, 256, 0.6f, 0, 0, true},
    [TEXTURE_LEAF_FERN] = {"leaf_fern", paint_leaf_fern, 256, 0.6f, 0, 0, true},
    [TEXTURE_GLASS_LANCET] = {"glass_lancet", paint_glass_lancet, 256, 1.0f, 90, 88, false},
    [TEXTURE_GLASS_ROSE] = {"glass_rose", paint_glass_rose, 512, 4.0f, 88, 0, false},
    [TEXTURE_TAPESTRY] = {"tapestry", paint_tapestry, 256, 2.0f, 88, 84, false},
};

static EncodedTexture cache[TEXTURE_COUNT];

// ---- brushes shared by the painters -------------------------------------------------------------

void canvas_set(Canvas *c, int x, int y, Vec3 rgb, float height) {
    size_t i = (size_t)y * (size_t)c->size + (size_t)x;
    c->rgb[i * 3] = rgb.x;
    c->rgb[i * 3 + 1] = rgb.y;
    c->rgb[i * 3 + 2] = rgb.z;
    c->height[i] = height;
}

static void blur_rows(const float *in, float *out, int n, int reach, size_t along, size_t across) {
    for (int line = 0; line < n; line++) {
        const float *row = in + (size_t)line * across;
        float sum = 0;
        for (int k = -reach; k <= reach; k++) sum += row[(size_t)((k + n) % n) * along];
        for (int i = 0; i < n; i++) {
            out[(size_t)line * across + (size_t)i * along] = sum / (float)(2 * reach + 1);
            sum += row[(size_t)((i + reach + 1) % n) * along];
            sum -= row[(size_t)((i - reach + n) % n) * along];
        }
    }
}

void canvas_shade_cavities(Canvas *c, int reach, float amount) {
    size_t n = (size_t)c->size, count = n * n;
    float *a = malloc(count * sizeof *a), *b = malloc(count * sizeof *b);
    if (!a || !b) abort();
    blur_rows(c->height, a, c->size, reach, 1, n);
    blur_rows(a, b, c->size, reach, n, 1);
    for (size_t i = 0; i < count; i++) {
        float k = 1 + float_clamp((c->height[i] - b[i]) * amount, -0.62f, 0.22f);
        for (int ch = 0; ch < 3; ch++) c->rgb[i * 3 + (size_t)ch] *= k;
    }
    free(a);
    free(b);
}

void canvas_leaf(Canvas *c, const LeafBrush *leaf, bool wrap) {
    float dx = cosf(leaf->angle), dy = sinf(leaf->angle);
    int reach = (int)(leaf->length + leaf->width) + 2, n = c->size;
    for (int oy = -reach; oy <= reach; oy++) {
        for (int ox = -reach; ox <= reach; ox++) {
            int px = (int)floorf(leaf->x) + ox, py = (int)floorf(leaf->y) + oy;
            float rx = (float)px + 0.5f - leaf->x, ry = (float)py + 0.5f - leaf->y;
            float t = (rx * dx + ry * dy) / leaf->length;
            float side = (-rx * dy + ry * dx) / (leaf->width * 0.5f);
            if (t < 0 || t > 1) continue;
            float profile = sqrtf(float_clamp(4 * t * (1 - t), 0, 1));
            profile *= 1 - leaf->tip * t * t;
            if (fabsf(side) > profile) continue;
            if (wrap) {
                px = (px % n + n) % n;
                py = (py % n + n) % n;
            } else if (px < 0 || py < 0 || px >= n || py >= n) {
                continue;
            }
            float rib = fabsf(side) < 0.14f ? 0.86f : 1.0f;
            float rim = 1 - 0.25f * (side / (profile + 0.01f)) * (side / (profile + 0.01f));
            float h = leaf->height + leaf->bulge * (sinf(t * PI_F) * rim - (rib < 1 ? 0.15f : 0));
            size_t i = (size_t)py * (size_t)n + (size_t)px;
            if (c->alpha[i] > 0 && c->height[i] > h) continue;
            canvas_set(c, px, py,
                       vec3_scale(vec3_lerp(leaf->root, leaf->end, t), rib * (0.85f + 0.15f * rim)),
                       h);
            c->alpha[i] = 1;
        }
    }
}

// ---- encoding -----------------------------------------------------------------------------------

static void append_bytes(void *context, void *data, int size) {
    EncodedImage *e = context;
    e->bytes = realloc(e->bytes, e->size + (size_t)size);
    if (!e->bytes) abort();
    memcpy(e->bytes + e->size, data, (size_t)size);
    e->size += (size_t)size;
}

static unsigned char to_byte(float v) { return (unsigned char)(float_clamp(v, 0, 1) * 255 + 0.5f); }

// Masked images bleed their colour outwards, so that filtering at the cut finds no black rim.
static void bleed_colors(Canvas *c) {
    int n = c->size;
    size_t count = (size_t)n * (size_t)n;
    unsigned char *known = malloc(count), *fresh = malloc(count);
    if (!known || !fresh) abort();
    Vec3 mean = vec3(0, 0, 0);
    float total = 0;
    for (size_t i = 0; i < count; i++) {
        known[i] = c->alpha[i] > 0;
        if (!known[i]) continue;
        mean = vec3_add(mean, vec3(c->rgb[i * 3], c->rgb[i * 3 + 1], c->rgb[i * 3 + 2]));
        total++;
    }
    mean = vec3_scale(mean, total > 0 ? 1 / total : 0);
    for (int pass = 0; pass < 4; pass++) {
        memcpy(fresh, known, count);
        for (int y = 0; y < n; y++) {
            for (int x = 0; x < n; x++) {
                size_t i = (size_t)(y * n + x);
                for (int k = 0; k < 4 && !fresh[i]; k++) {
                    int nx = x + (k == 0) - (k == 1), ny = y + (k == 2) - (k == 3);
                    if (nx < 0 || ny < 0 || nx >= n || ny >= n) continue;
                    size_t j = (size_t)(ny * n + nx);
                    if (!known[j]) continue;
                    memcpy(c->rgb + i * 3, c->rgb + j * 3, 3 * sizeof(float));
                    fresh[i] = 1;
                }
            }
        }
        memcpy(known, fresh, count);
    }
    for (size_t i = 0; i < count; i++) {
        if (known[i]) continue;
        c->rgb[i * 3] = mean.x;
        c->rgb[i * 3 + 1] = mean.y;
        c->rgb[i * 3 + 2] = mean.z;
    }
    free(known);
    free(fresh);
}

static void encode_albedo(const TextureRow *row, Canvas *c, EncodedImage *out) {
    int n = c->size, channels = row->masked ? 4 : 3;
    unsigned char *px = malloc((size_t)n * (size_t)n * 4);
    if (!px) abort();
    if (row->masked) bleed_colors(c);
    for (int i = 0; i < n * n; i++) {
        for (int ch = 0; ch < 3; ch++) px[i * channels + ch] = to_byte(c->rgb[i * 3 + ch]);
        if (!row->masked) continue;
        px[i * channels + 3] = c->alpha[i] > 0 ? 255 : 0;
        // Fewer distinct colours: a quarter of the bytes, and nobody sees it on leaves.
        for (int ch = 0; ch < 3; ch++) px[i * channels + ch] &= 0xF8;
    }
    if (row->masked) {
        stbi_write_png_compression_level = 16;
        stbi_write_png_to_func(append_bytes, out, n, n, 4, px, n * 4);
        out->mime = "image/png";
    } else {
        stbi_write_jpg_to_func(append_bytes, out, n, n, 3, px, row->quality);
        out->mime = "image/jpeg";
    }
    free(px);
}

static void encode_normal(const TextureRow *row, const Canvas *c, EncodedImage *out) {
    int n = c->size;
    float texel_m = c->tile_m / (float)n;
    unsigned char *px = malloc((size_t)n * (size_t)n * 3);
    if (!px) abort();
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            const float *h = c->height;
            float right = h[y * n + (x + 1) % n], left = h[y * n + (x + n - 1) % n];
            float below = h[((y + 1) % n) * n + x], above = h[((y + n - 1) % n) * n + x];
            // Green points up in the image, where v grows in the soup and rows shrink.
            Vec3 d = vec3_normalize(
                vec3((left - right) / (2 * texel_m), (below - above) / (2 * texel_m), 1));
            unsigned char *p = px + (y * n + x) * 3;
            p[0] = to_byte(d.x * 0.5f + 0.5f);
            p[1] = to_byte(d.y * 0.5f + 0.5f);
            p[2] = to_byte(d.z * 0.5f + 0.5f);
        }
    }
    stbi_write_jpg_to_func(append_bytes, out, n, n, 3, px, row->normal_quality);
    out->mime = "image/jpeg";
    free(px);
}

const EncodedTexture *texture_get(int texture) {
    if (texture < 0 || texture >= TEXTURE_COUNT) return NULL;
    EncodedTexture *t = cache + texture;
    if (t->albedo.bytes) return t;
    const TextureRow *row = ROWS + texture;
    size_t count = (size_t)row->size * (size_t)row->size;
    Canvas c = {row->size, row->tile_m, calloc(count * 3, sizeof(float)),
                calloc(count, sizeof(float)), calloc(count, sizeof(float))};
    if (!c.rgb || !c.height || !c.alpha) abort();
    row->paint(&c);
    t->name = row->name;
    encode_albedo(row, &c, &t->albedo);
    if (row->normal_quality) encode_normal(row, &c, &t->normal);
    free(c.rgb);
    free(c.height);
    free(c.alpha);
    return t;
}

void texture_free_all(void) {
    for (int i = 0; i < TEXTURE_COUNT; i++) {
        free(cache[i].albedo.bytes);
        free(cache[i].normal.bytes);
    }
    memset(cache, 0, sizeof cache);
}

static bool dump_image(const char *folder, const char *name, const char *plane,
                       const EncodedImage *e) {
    if (!e->bytes) return true;
    char path[512];
    snprintf(path, sizeof path, "%s/%s_%s%s", folder, name, plane,
             strcmp(e->mime, "image/png") ? ".jpg" : ".png");
    FILE *f = fopen(path, "wb");
    if (!f) return false;
    bool ok = fwrite(e->bytes, 1, e->size, f) == e->size;
    return fclose(f) == 0 && ok;
}

bool texture_dump(const char *folder) {
    for (int i = 0; i < TEXTURE_COUNT; i++) {
        const EncodedTexture *t = texture_get(i);
        printf("texture %-14s %7zu + %7zu bytes\n", t->name, t->albedo.size, t->normal.size);
        if (!dump_image(folder, t->name, "albedo", &t->albedo)) return false;
        if (!dump_image(folder, t->name, "normal", &t->normal)) return false;
    }
    return true;
}

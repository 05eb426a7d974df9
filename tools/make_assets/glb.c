// Writer of binary glTF 2.0: see glb.h. The JSON is short and regular, so it is printed directly.
#include "glb.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Buffer {
    char *data;
    size_t size, cap;
} Buffer;

static void buffer_append(Buffer *b, const void *data, size_t size) {
    if (b->size + size > b->cap) {
        b->cap = (b->size + size) * 2 + 1024;
        b->data = realloc(b->data, b->cap);
        if (!b->data) abort();
    }
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

static void buffer_pad(Buffer *b, char with) {
    while (b->size % 4) buffer_append(b, &with, 1);
}

__attribute__((format(printf, 2, 3))) static void buffer_print(Buffer *b, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (n < 0 || n >= (int)sizeof text) abort();
    buffer_append(b, text, (size_t)n);
}

// All that is collected while meshes are written; lists are JSON fragments.
typedef struct Writer {
    Buffer bin, views, accessors, meshes;
    int view_count, accessor_count;
    int material_index[MAT_COUNT];       // -1: unused
    int texture_index[TEXTURE_COUNT][2]; // image of albedo, of normals
    int material_count;
} Writer;

enum { TARGET_VERTICES = 34962, TARGET_INDICES = 34963, TARGET_NONE = 0 };

static int write_view(Writer *w, const void *data, size_t size, int target) {
    buffer_pad(&w->bin, 0);
    buffer_print(&w->views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu",
                 w->view_count ? "," : "", w->bin.size, size);
    if (target) buffer_print(&w->views, ",\"target\":%d", target);
    buffer_print(&w->views, "}");
    buffer_append(&w->bin, data, size);
    return w->view_count++;
}

static int write_accessor(Writer *w, const void *data, size_t size, int target, int component,
                          uint32_t count, const char *type, const char *bounds) {
    int view = write_view(w, data, size, target);
    buffer_print(&w->accessors,
                 "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%u,\"type\":\"%s\"%s}",
                 w->accessor_count ? "," : "", view, component, count, type, bounds);
    return w->accessor_count++;
}

// The vertices that one material uses lie together, because soup_build goes by material.
static void write_primitive(Writer *w, const Mesh *m, int material, bool first) {
    const uint32_t *indices = m->indices + m->first[material];
    uint32_t index_count = m->count[material], lo = UINT32_MAX, hi = 0;
    for (uint32_t i = 0; i < index_count; i++) {
        if (indices[i] < lo) lo = indices[i];
        if (indices[i] > hi) hi = indices[i];
    }
    uint32_t n = hi - lo + 1;
    float *scratch = malloc((size_t)n * 4 * sizeof(float));
    void *packed = malloc((size_t)index_count * sizeof(uint32_t));
    if (!scratch || !packed) abort();
    Vec3 min = m->vertices[lo].position, max = min;
    for (uint32_t i = 0; i < n; i++) {
        Vec3 p = m->vertices[lo + i].position;
        min = vec3(fminf(min.x, p.x), fminf(min.y, p.y), fminf(min.z, p.z));
        max = vec3(fmaxf(max.x, p.x), fmaxf(max.y, p.y), fmaxf(max.z, p.z));
        memcpy(scratch + i * 3, &p, sizeof p);
    }
    char bounds[256];
    snprintf(bounds, sizeof bounds, ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]",
             (double)min.x, (double)min.y, (double)min.z, (double)max.x, (double)max.y,
             (double)max.z);
    int position =
        write_accessor(w, scratch, (size_t)n * 12, TARGET_VERTICES, 5126, n, "VEC3", bounds);
    for (uint32_t i = 0; i < n; i++) memcpy(scratch + i * 3, &m->vertices[lo + i].normal, 12);
    int normal = write_accessor(w, scratch, (size_t)n * 12, TARGET_VERTICES, 5126, n, "VEC3", "");
    for (uint32_t i = 0; i < n; i++) memcpy(scratch + i * 4, m->vertices[lo + i].tangent, 16);
    int tangent = write_accessor(w, scratch, (size_t)n * 16, TARGET_VERTICES, 5126, n, "VEC4", "");
    for (uint32_t i = 0; i < n; i++) memcpy(scratch + i * 2, &m->vertices[lo + i].uv, 8);
    int uv = write_accessor(w, scratch, (size_t)n * 8, TARGET_VERTICES, 5126, n, "VEC2", "");
    bool small = n <= 65535;
    for (uint32_t i = 0; i < index_count; i++) {
        if (small)
            ((uint16_t *)packed)[i] = (uint16_t)(indices[i] - lo);
        else
            ((uint32_t *)packed)[i] = indices[i] - lo;
    }
    bool tinted = false;
    for (uint32_t i = 0; i < n; i++) tinted |= m->vertices[lo + i].tint != TINT_NONE;
    char colors[32] = "";
    if (tinted) {
        for (uint32_t i = 0; i < n; i++) memcpy(scratch + i, &m->vertices[lo + i].tint, 4);
        snprintf(colors, sizeof colors, "\"COLOR_0\":%d,",
                 write_accessor(w, scratch, (size_t)n * 4, TARGET_VERTICES, 5121, n, "VEC4",
                                ",\"normalized\":true"));
    }
    int list = write_accessor(w, packed, (size_t)index_count * (small ? 2 : 4), TARGET_INDICES,
                              small ? 5123 : 5125, index_count, "SCALAR", "");
    if (w->material_index[material] < 0) w->material_index[material] = w->material_count++;
    buffer_print(&w->meshes,
                 "%s{\"attributes\":{\"POSITION\":%d,\"NORMAL\":%d,\"TANGENT\":%d,%s"
                 "\"TEXCOORD_0\":%d},\"indices\":%d,\"material\":%d}",
                 first ? "" : ",", position, normal, tangent, colors, uv, list,
                 w->material_index[material]);
    free(scratch);
    free(packed);
}

// Adds an image and its texture (same number); returns that number.
static int write_image(Writer *w, Buffer *images, Buffer *textures, int *count,
                       const EncodedImage *e, const char *name, const char *plane) {
    int view = write_view(w, e->bytes, e->size, TARGET_NONE);
    const char *comma = *count ? "," : "";
    buffer_print(images, "%s{\"name\":\"%s_%s\",\"mimeType\":\"%s\",\"bufferView\":%d}", comma,
                 name, plane, e->mime, view);
    buffer_print(textures, "%s{\"sampler\":0,\"source\":%d}", comma, *count);
    return (*count)++;
}

static void write_material(Writer *w, Buffer *out, const Material *m) {
    int albedo = m->texture >= 0 ? w->texture_index[m->texture][0] : -1;
    int normal = m->texture >= 0 ? w->texture_index[m->texture][1] : -1;
    buffer_print(out, "{\"name\":\"%s\",\"pbrMetallicRoughness\":{", m->name);
    if (albedo >= 0) buffer_print(out, "\"baseColorTexture\":{\"index\":%d},", albedo);
    buffer_print(out,
                 "\"baseColorFactor\":[%.6g,%.6g,%.6g,1],\"metallicFactor\":%.6g,"
                 "\"roughnessFactor\":%.6g}",
                 (double)m->color[0], (double)m->color[1], (double)m->color[2], (double)m->metallic,
                 (double)m->roughness);
    if (normal >= 0) buffer_print(out, ",\"normalTexture\":{\"index\":%d}", normal);
    if (m->emissive[0] + m->emissive[1] + m->emissive[2] > 0) {
        buffer_print(out, ",\"emissiveFactor\":[%.6g,%.6g,%.6g]", (double)m->emissive[0],
                     (double)m->emissive[1], (double)m->emissive[2]);
        if (m->emissive_textured && albedo >= 0)
            buffer_print(out, ",\"emissiveTexture\":{\"index\":%d}", albedo);
        buffer_print(out,
                     ",\"extensions\":{\"KHR_materials_emissive_strength\":"
                     "{\"emissiveStrength\":%.6g}}",
                     (double)m->emissive_strength);
    }
    if (m->masked)
        buffer_print(out, ",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.5,\"doubleSided\":true");
    buffer_print(out, "}");
}

static void write_materials(Writer *w, Buffer *json) {
    Buffer images = {0}, textures = {0}, materials = {0};
    int image_count = 0;
    bool emissive = false;
    for (int i = 0; i < MAT_COUNT; i++) {
        const Material *m = material_get(i);
        if (w->material_index[i] < 0 || m->texture < 0) continue;
        int *index = w->texture_index[m->texture];
        if (index[0] >= 0) continue;
        const EncodedTexture *t = texture_get(m->texture);
        index[0] = write_image(w, &images, &textures, &image_count, &t->albedo, t->name, "albedo");
        if (t->normal.bytes)
            index[1] =
                write_image(w, &images, &textures, &image_count, &t->normal, t->name, "normal");
    }
    for (int number = 0; number < w->material_count; number++) {
        for (int i = 0; i < MAT_COUNT; i++) {
            if (w->material_index[i] != number) continue;
            const Material *m = material_get(i);
            if (number) buffer_print(&materials, ",");
            write_material(w, &materials, m);
            emissive |= m->emissive_strength > 0;
        }
    }
    if (emissive) buffer_print(json, ",\"extensionsUsed\":[\"KHR_materials_emissive_strength\"]");
    buffer_print(json, ",\"materials\":[");
    buffer_append(json, materials.data, materials.size);
    buffer_print(json, "]");
    if (image_count) {
        // 9729 linear, 9987 linear with mipmaps, 10497 repeat
        buffer_print(json, ",\"samplers\":[{\"magFilter\":9729,\"minFilter\":9987,"
                           "\"wrapS\":10497,\"wrapT\":10497}],\"images\":[");
        buffer_append(json, images.data, images.size);
        buffer_print(json, "],\"textures\":[");
        buffer_append(json, textures.data, textures.size);
        buffer_print(json, "]");
    }
    free(images.data);
    free(textures.data);
    free(materials.data);
}

static void write_nodes(const Model *m, Buffer *json) {
    buffer_print(json, ",\"scene\":0,\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < m->node_count; i++) buffer_print(json, "%s%d", i ? "," : "", i);
    buffer_print(json, "]}],\"nodes\":[");
    for (int i = 0; i < m->node_count; i++) {
        const ModelNode *n = m->nodes + i;
        buffer_print(json, "%s{\"name\":\"%s\",\"mesh\":%d", i ? "," : "", n->name, n->mesh);
        if (vec3_length(n->position) > 0)
            buffer_print(json, ",\"translation\":[%.9g,%.9g,%.9g]", (double)n->position.x,
                         (double)n->position.y, (double)n->position.z);
        if (n->yaw_deg != 0) {
            double half = (double)n->yaw_deg * 3.14159265358979 / 360;
            buffer_print(json, ",\"rotation\":[0,%.9g,0,%.9g]", sin(half), cos(half));
        }
        buffer_print(json, "}");
    }
    buffer_print(json, "]");
}

static bool write_file(const char *path, Buffer *json, Buffer *bin) {
    buffer_pad(json, ' ');
    buffer_pad(bin, 0);
    uint32_t header[5] = {0x46546C67u, 2, (uint32_t)(28 + json->size + bin->size),
                          (uint32_t)json->size, 0x4E4F534Au};
    uint32_t chunk[2] = {(uint32_t)bin->size, 0x004E4942u};
    FILE *f = fopen(path, "wb");
    if (!f) return false;
    bool ok = fwrite(header, sizeof header, 1, f) == 1 &&
              fwrite(json->data, json->size, 1, f) == 1 && fwrite(chunk, sizeof chunk, 1, f) == 1 &&
              fwrite(bin->data, bin->size, 1, f) == 1;
    return fclose(f) == 0 && ok;
}

size_t glb_write(const Model *m, const char *path) {
    Writer w = {0};
    for (int i = 0; i < MAT_COUNT; i++) w.material_index[i] = -1;
    for (int i = 0; i < TEXTURE_COUNT; i++) w.texture_index[i][0] = w.texture_index[i][1] = -1;
    for (int i = 0; i < m->mesh_count; i++) {
        bool first = true;
        buffer_print(&w.meshes, "%s{\"name\":\"%s\",\"primitives\":[", i ? "," : "",
                     m->mesh_names[i]);
        for (int mat = 0; mat < MAT_COUNT; mat++) {
            if (!m->meshes[i].count[mat]) continue;
            write_primitive(&w, m->meshes + i, mat, first);
            first = false;
        }
        buffer_print(&w.meshes, "]}");
    }
    Buffer json = {0};
    buffer_print(&json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"luz make_assets\"}");
    write_materials(&w, &json);
    write_nodes(m, &json);
    buffer_print(&json, ",\"meshes\":[");
    buffer_append(&json, w.meshes.data, w.meshes.size);
    buffer_print(&json, "],\"accessors\":[");
    buffer_append(&json, w.accessors.data, w.accessors.size);
    buffer_print(&json, "],\"bufferViews\":[");
    buffer_append(&json, w.views.data, w.views.size);
    buffer_pad(&w.bin, 0);
    buffer_print(&json, "],\"buffers\":[{\"byteLength\":%zu}]}", w.bin.size);
    size_t size = write_file(path, &json, &w.bin) ? 28 + json.size + w.bin.size : 0;
    Buffer *all[5] = {&json, &w.bin, &w.views, &w.accessors, &w.meshes};
    for (int i = 0; i < 5; i++) free(all[i]->data);
    return size;
}

// gltf_read.c: accessors to plain arrays.
//
// Data in: GltfRaw that gltf_check accepted: every byte touched here lies within its buffer. Data
// out: floats and indices, with sparse parts applied, each value checked. Called by
// gltf_mesh.c and gltf_material.c. Does not: assume alignment (bytes are copied out one by one).
#include "gltf_raw.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT = 5126 };

Bytes gltf_view_bytes(const GltfRaw *raw, i32 view) {
    const GltfView *v = &raw->views[view];
    return (Bytes){(const u8 *)raw->buffers[v->buffer].data + v->offset, v->length};
}

static u32 load_integer(const u8 *at, u32 type) {
    u16 half;
    u32 word;
    switch (type) {
    case UNSIGNED_BYTE:
        return at[0];
    case UNSIGNED_SHORT:
        memcpy(&half, at, 2);
        return half;
    default:
        memcpy(&word, at, 4);
        return word;
    }
}

// glTF 2.0, 3.6.2.3: normalised integers; signed ones reach -1 at two values.
static f32 load_float(const u8 *at, u32 type, bool normalized) {
    f32 value;
    int16_t half;
    switch (type) {
    case BYTE:
        value = (f32)(int8_t)at[0];
        return normalized ? fmaxf(value / 127, -1) : value;
    case UNSIGNED_BYTE:
        return normalized ? (f32)at[0] / 255 : (f32)at[0];
    case SHORT:
        memcpy(&half, at, 2);
        return normalized ? fmaxf((f32)half / 32767, -1) : (f32)half;
    case UNSIGNED_SHORT:
        value = (f32)load_integer(at, type);
        return normalized ? value / 65535 : value;
    case UNSIGNED_INT:
        return (f32)load_integer(at, type);
    default:
        memcpy(&value, at, 4);
        return value;
    }
}

static bool read_element(const GltfAccessor *a, i32 accessor, u64 element, const u8 *at, u32 width,
                         f32 *out, char *why) {
    u32 size = gltf_component_size(a->component_type);
    for (u32 k = 0; k < MIN(width, a->rows); k++) {
        f32 value = load_float(at + k * size, a->component_type, a->normalized);
        if (!(fabsf(value) <= GLTF_COORDINATE_MAX)) {
            snprintf(why, ASSET_MESSAGE_CAP,
                     "accessor %d: element %llu is not a finite number "
                     "under 1e9",
                     accessor, (unsigned long long)element);
            return false;
        }
        out[k] = value;
    }
    return true;
}

bool gltf_read_floats(const GltfRaw *raw, i32 accessor, u32 width, void *out, u64 stride,
                      char *why) {
    const GltfAccessor *a = &raw->accessors[accessor];
    u32 size = gltf_element_size(a);
    u8 *row = out;
    if (a->view >= 0) {
        const GltfView *view = &raw->views[a->view];
        const u8 *at = (const u8 *)gltf_view_bytes(raw, a->view).data + a->offset;
        u64 step = view->stride ? view->stride : size;
        for (u64 i = 0; i < a->count; i++)
            if (!read_element(a, accessor, i, at + i * step, width,
                              (f32 *)(void *)(row + i * stride), why))
                return false;
    } else {
        for (u64 i = 0; i < a->count; i++)
            memset(row + i * stride, 0, MIN(width, a->rows) * sizeof(f32));
    }
    if (!a->sparse) return true;
    const u8 *indices =
        (const u8 *)gltf_view_bytes(raw, a->sparse_index_view).data + a->sparse_index_offset;
    const u8 *values =
        (const u8 *)gltf_view_bytes(raw, a->sparse_value_view).data + a->sparse_value_offset;
    u32 index_size = gltf_component_size(a->sparse_index_type);
    for (u64 i = 0; i < (u64)a->sparse_count; i++) {
        u32 element = load_integer(indices + i * index_size, a->sparse_index_type);
        if (!read_element(a, accessor, element, values + i * size, width,
                          (f32 *)(void *)(row + element * stride), why))
            return false;
    }
    return true;
}

static bool check_index(u32 index, u32 vertex_count, i32 accessor, u64 element, char *why) {
    if (index < vertex_count) return true;
    snprintf(why, ASSET_MESSAGE_CAP, "accessor %d: index %u (element %llu) of %u vertices",
             accessor, index, (unsigned long long)element, vertex_count);
    return false;
}

bool gltf_read_indices(const GltfRaw *raw, i32 accessor, u32 vertex_count, u32 *out, char *why) {
    const GltfAccessor *a = &raw->accessors[accessor];
    u32 size = gltf_component_size(a->component_type);
    if (a->view >= 0) {
        const GltfView *view = &raw->views[a->view];
        const u8 *at = (const u8 *)gltf_view_bytes(raw, a->view).data + a->offset;
        u64 step = view->stride ? view->stride : size;
        for (u64 i = 0; i < a->count; i++) out[i] = load_integer(at + i * step, a->component_type);
    } else {
        memset(out, 0, a->count * sizeof *out);
    }
    if (a->sparse) {
        const u8 *indices =
            (const u8 *)gltf_view_bytes(raw, a->sparse_index_view).data + a->sparse_index_offset;
        const u8 *values =
            (const u8 *)gltf_view_bytes(raw, a->sparse_value_view).data + a->sparse_value_offset;
        u32 index_size = gltf_component_size(a->sparse_index_type);
        for (u64 i = 0; i < (u64)a->sparse_count; i++)
            out[load_integer(indices + i * index_size, a->sparse_index_type)] =
                load_integer(values + i * size, a->component_type);
    }
    for (u64 i = 0; i < a->count; i++)
        if (!check_index(out[i], vertex_count, accessor, i, why)) return false;
    return true;
}

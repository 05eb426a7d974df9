// gltf_check.c: the importer's referee: what passes here can be built without another look.
//
// Data in: GltfRaw as parsed. Data out: true, and every node's parent; or false and a sentence that
// names the element. Called by asset_load_model. Does not: read vertex data (gltf_read.c checks
// values while it reads them: indices, finite numbers).
//
// After it: every index is -1 where that is allowed or below its array's count; every accessor,
// sparse part and view lies within its buffer; attribute types and counts fit together; nodes are
// trees of bounded depth; numbers of materials, lights, cameras and matrices are finite.
#include "gltf_raw.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT = 5126 };

PRINTF_LIKE(2, 3) static bool refuse(char *why, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(why, ASSET_MESSAGE_CAP, format, list);
    va_end(list);
    return false;
}

static bool index_ok(i32 index, u32 count, bool may_be_absent) {
    return index < 0 ? may_be_absent && index == -1 : (u32)index < count;
}

static bool finite_array(const f32 *values, u32 count) {
    for (u32 i = 0; i < count; i++)
        if (!isfinite(values[i])) return false;
    return true;
}

u32 gltf_component_size(u32 component_type) {
    switch (component_type) {
    case BYTE:
    case UNSIGNED_BYTE:
        return 1;
    case SHORT:
    case UNSIGNED_SHORT:
        return 2;
    case UNSIGNED_INT:
    case FLOAT:
        return 4;
    default:
        return 0;
    }
}

u32 gltf_element_size(const GltfAccessor *accessor) {
    u32 column = gltf_component_size(accessor->component_type) * accessor->rows;
    return accessor->columns == 1 ? column : (u32)ALIGN_UP(column, 4) * accessor->columns;
}

// ---- the file as a whole ----

static const char *const supported_extensions[] = {
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_specular",
    "KHR_materials_unlit", "KHR_texture_transform"};

static bool check_asset(const GltfRaw *raw, char *why) {
    const char *version = raw->min_version[0] ? raw->min_version : raw->version;
    if (strncmp(raw->version, "2.", 2) != 0)
        return refuse(why, "asset.version is '%.20s', not 2.x", raw->version);
    if (raw->min_version[0] && strcmp(version, "2.0") != 0)
        return refuse(why, "asset.minVersion is '%.20s', over 2.0", version);
    for (u32 i = 0; i < raw->required_count; i++) {
        bool known = false;
        for (u32 k = 0; k < COUNT_OF(supported_extensions); k++)
            known |= strcmp(raw->required[i], supported_extensions[k]) == 0;
        if (!known) return refuse(why, "it requires the extension %.80s", raw->required[i]);
    }
    return true;
}

// ---- views and accessors ----

static bool check_views(const GltfRaw *raw, char *why) {
    for (u32 i = 0; i < raw->view_count; i++) {
        const GltfView *v = &raw->views[i];
        if (!index_ok(v->buffer, raw->buffer_count, false))
            return refuse(why, "bufferView %u: there is no buffer %d", i, v->buffer);
        u64 size = raw->buffers[v->buffer].size;
        if (v->length == 0 || v->offset > size || v->length > size - v->offset)
            return refuse(why, "bufferView %u: bytes %llu + %llu lie beyond buffer %d (%llu)", i,
                          (unsigned long long)v->offset, (unsigned long long)v->length, v->buffer,
                          (unsigned long long)size);
    }
    return true;
}

// `count` elements of `size` bytes, `stride` apart from `offset` on, within a view.
static bool fits_view(const GltfView *view, u64 offset, u64 count, u64 stride, u64 size) {
    if (offset > view->length || size > view->length - offset) return false;
    return (count - 1) <= (view->length - offset - size) / stride; // no product to overflow
}

static u32 sparse_index(const u8 *at, u32 type) {
    if (type == UNSIGNED_BYTE) return at[0];
    if (type == UNSIGNED_SHORT) return (u32)at[0] | (u32)at[1] << 8;
    return (u32)at[0] | (u32)at[1] << 8 | (u32)at[2] << 16 | (u32)at[3] << 24;
}

static bool check_sparse(const GltfRaw *raw, u32 i, char *why) {
    const GltfAccessor *a = &raw->accessors[i];
    if (a->sparse_count < 1 || (u64)a->sparse_count > a->count)
        return refuse(why, "accessor %u: %lld sparse values for %llu elements", i,
                      (long long)a->sparse_count, (unsigned long long)a->count);
    u32 type = a->sparse_index_type, size = gltf_component_size(type);
    if (type != UNSIGNED_BYTE && type != UNSIGNED_SHORT && type != UNSIGNED_INT)
        return refuse(why, "accessor %u: sparse indices of type %u", i, type);
    if (!index_ok(a->sparse_index_view, raw->view_count, false) ||
        !index_ok(a->sparse_value_view, raw->view_count, false))
        return refuse(why, "accessor %u: its sparse part names no bufferView", i);
    const GltfView *view = &raw->views[a->sparse_index_view];
    u64 count = (u64)a->sparse_count;
    if (a->sparse_index_offset < 0 || a->sparse_value_offset < 0 ||
        !fits_view(view, (u64)a->sparse_index_offset, count, size, size) ||
        !fits_view(&raw->views[a->sparse_value_view], (u64)a->sparse_value_offset, count,
                   gltf_element_size(a), gltf_element_size(a)))
        return refuse(why, "accessor %u: its sparse part lies beyond a bufferView", i);
    const u8 *at =
        (const u8 *)raw->buffers[view->buffer].data + view->offset + a->sparse_index_offset;
    for (u64 k = 0; k < count; k++) {
        u32 index = sparse_index(at + k * size, type);
        if (index >= a->count || (k && index <= sparse_index(at + (k - 1) * size, type)))
            return refuse(why, "accessor %u: sparse index %u is out of range or out of order", i,
                          index);
    }
    return true;
}

static bool check_accessors(const GltfRaw *raw, char *why) {
    for (u32 i = 0; i < raw->accessor_count; i++) {
        const GltfAccessor *a = &raw->accessors[i];
        u32 size = gltf_element_size(a);
        if (size == 0) return refuse(why, "accessor %u: componentType %u", i, a->component_type);
        if (a->count == 0 || a->count > ASSET_INDICES_MAX)
            return refuse(why, "accessor %u: count %llu is not within 1..%u", i,
                          (unsigned long long)a->count, ASSET_INDICES_MAX);
        if (!index_ok(a->view, raw->view_count, true))
            return refuse(why, "accessor %u: there is no bufferView %d", i, a->view);
        if (a->view >= 0) {
            const GltfView *view = &raw->views[a->view];
            u64 stride = view->stride ? view->stride : size;
            if (stride < size || stride > 252)
                return refuse(why,
                              "accessor %u: byteStride %llu of bufferView %d is under the "
                              "element's %u bytes or over 252",
                              i, (unsigned long long)stride, a->view, size);
            if (!fits_view(view, a->offset, a->count, stride, size))
                return refuse(why, "accessor %u: %llu elements lie beyond bufferView %d", i,
                              (unsigned long long)a->count, a->view);
        }
        if (a->sparse && !check_sparse(raw, i, why)) return false;
    }
    return true;
}

// ---- meshes ----

// What an attribute may be: components, and integer types besides float.
static bool check_attribute(const GltfRaw *raw, u32 primitive, const char *name, i32 accessor,
                            u32 rows_min, u32 rows_max, bool unsigned_too, u64 count, char *why) {
    if (accessor == GLTF_ABSENT) return true;
    if (!index_ok(accessor, raw->accessor_count, false))
        return refuse(why, "primitive %u: %s names no accessor", primitive, name);
    const GltfAccessor *a = &raw->accessors[accessor];
    bool integer = (a->component_type == UNSIGNED_BYTE || a->component_type == UNSIGNED_SHORT) &&
                   a->normalized;
    if (a->columns != 1 || a->rows < rows_min || a->rows > rows_max ||
        !(a->component_type == FLOAT || (unsigned_too && integer)))
        return refuse(why, "primitive %u: %s has an unsupported type (accessor %d)", primitive,
                      name, accessor);
    if (a->count != count)
        return refuse(why, "primitive %u: %s has %llu elements, POSITION %llu (accessor %d)",
                      primitive, name, (unsigned long long)a->count, (unsigned long long)count,
                      accessor);
    return true;
}

static bool check_primitive(const GltfRaw *raw, u32 i, u64 *vertices, u64 *indices, char *why) {
    const GltfPrimitive *p = &raw->primitives[i];
    if (!index_ok(p->material, raw->material_count, true))
        return refuse(why, "primitive %u: there is no material %d", i, p->material);
    if (p->mode < 0 || p->mode > 6) return refuse(why, "primitive %u: mode %d", i, p->mode);
    if (p->position != GLTF_ABSENT && !index_ok(p->position, raw->accessor_count, false))
        return refuse(why, "primitive %u: POSITION names no accessor", i);
    u64 count = p->position == GLTF_ABSENT ? 0 : raw->accessors[p->position].count;
    if (p->position != GLTF_ABSENT &&
        (!check_attribute(raw, i, "POSITION", p->position, 3, 3, false, count, why) ||
         !check_attribute(raw, i, "NORMAL", p->normal, 3, 3, false, count, why) ||
         !check_attribute(raw, i, "TANGENT", p->tangent, 4, 4, false, count, why) ||
         !check_attribute(raw, i, "TEXCOORD_0", p->uv[0], 2, 2, true, count, why) ||
         !check_attribute(raw, i, "TEXCOORD_1", p->uv[1], 2, 2, true, count, why) ||
         !check_attribute(raw, i, "COLOR_0", p->color, 3, 4, true, count, why)))
        return false;
    if (!index_ok(p->indices, raw->accessor_count, true))
        return refuse(why, "primitive %u: indices name no accessor", i);
    if (p->indices >= 0) {
        const GltfAccessor *a = &raw->accessors[p->indices];
        bool whole = a->component_type == UNSIGNED_BYTE || a->component_type == UNSIGNED_SHORT ||
                     a->component_type == UNSIGNED_INT;
        if (!whole || a->rows != 1 || a->columns != 1)
            return refuse(why, "primitive %u: indices have an unsupported type (accessor %d)", i,
                          p->indices);
    }
    u64 corners = p->indices >= 0 ? raw->accessors[p->indices].count : count;
    if (p->position != GLTF_ABSENT && p->mode == 4 && corners % 3)
        return refuse(why, "primitive %u: %llu corners do not make triangles", i,
                      (unsigned long long)corners);
    *vertices += count;
    *indices += corners * (p->mode > 4 ? 3 : 1); // strips and fans become lists
    if (*vertices > ASSET_VERTICES_MAX)
        return refuse(why, "more than %u vertices", ASSET_VERTICES_MAX);
    if (*indices > ASSET_INDICES_MAX) return refuse(why, "more than %u indices", ASSET_INDICES_MAX);
    return true;
}

static bool check_meshes(const GltfRaw *raw, char *why) {
    u64 vertices = 0, indices = 0;
    if (raw->primitive_count > ASSET_PARTS_MAX)
        return refuse(why, "more than %u primitives", ASSET_PARTS_MAX);
    for (u32 i = 0; i < raw->primitive_count; i++)
        if (!check_primitive(raw, i, &vertices, &indices, why)) return false;
    return true;
}

// ---- nodes ----

static bool check_node(const GltfRaw *raw, u32 i, char *why) {
    const GltfNode *n = &raw->nodes[i];
    if (n->malformed) return refuse(why, "node %u: a transform of a wrong length", i);
    if (!finite_array(n->local, 16)) return refuse(why, "node %u: its transform is not finite", i);
    if (!index_ok(n->mesh, raw->mesh_count, true))
        return refuse(why, "node %u: there is no mesh %d", i, n->mesh);
    if (!index_ok(n->camera, raw->camera_count, true))
        return refuse(why, "node %u: there is no camera %d", i, n->camera);
    if (!index_ok(n->light, raw->light_count, true))
        return refuse(why, "node %u: there is no light %d", i, n->light);
    if (!index_ok(n->skin, raw->skin_count, true))
        return refuse(why, "node %u: there is no skin %d", i, n->skin);
    return true;
}

static bool check_nodes(GltfRaw *raw, char *why) {
    for (u32 i = 0; i < raw->node_count; i++) {
        if (!check_node(raw, i, why)) return false;
        const i32 *children = raw->children + raw->nodes[i].first_child;
        for (u32 k = 0; k < raw->nodes[i].child_count; k++) {
            if (!index_ok(children[k], raw->node_count, false))
                return refuse(why, "node %u: there is no child %d", i, children[k]);
            if (raw->nodes[children[k]].parent >= 0)
                return refuse(why, "node %d has two parents, %d and %u", children[k],
                              raw->nodes[children[k]].parent, i);
            raw->nodes[children[k]].parent = (i32)i;
        }
    }
    // One parent each, so walking up ends at a root, or never: in a cycle.
    for (u32 i = 0; i < raw->node_count; i++) {
        u32 depth = 0;
        for (i32 up = raw->nodes[i].parent; up >= 0; up = raw->nodes[up].parent)
            if (++depth > ASSET_NODE_DEPTH_MAX)
                return refuse(why, "node %u is in a cycle or deeper than %d levels", i,
                              ASSET_NODE_DEPTH_MAX);
    }
    if (raw->scene != -1 && !index_ok(raw->scene, raw->scene_count, false))
        return refuse(why, "there is no scene %d", raw->scene);
    for (u32 i = 0; i < raw->root_count; i++) {
        if (!index_ok(raw->roots[i], raw->node_count, false))
            return refuse(why, "the scene's node %d does not exist", raw->roots[i]);
        if (raw->nodes[raw->roots[i]].parent >= 0)
            return refuse(why, "the scene's node %d is another node's child", raw->roots[i]);
        if (raw->nodes[raw->roots[i]].parent == GLTF_PARENT_SCENE)
            return refuse(why, "the scene names node %d twice", raw->roots[i]);
        raw->nodes[raw->roots[i]].parent = GLTF_PARENT_SCENE;
    }
    return true;
}

// ---- materials, textures, lights, cameras ----

static bool check_texture_ref(const GltfRaw *raw, u32 material, const GltfTextureRef *ref,
                              char *why) {
    if (!index_ok(ref->texture, raw->texture_count, true))
        return refuse(why, "material %u: there is no texture %d", material, ref->texture);
    for (u32 i = 0; i < 2; i++)
        if (!(fabsf(ref->offset[i]) <= GLTF_COORDINATE_MAX) ||
            !(fabsf(ref->scale[i]) <= GLTF_COORDINATE_MAX) || !(fabsf(ref->rotation_rad) <= 1e4f))
            return refuse(why, "material %u: a texture transform is out of range", material);
    return true;
}

static bool check_materials(const GltfRaw *raw, char *why) {
    for (u32 i = 0; i < raw->material_count; i++) {
        const GltfMaterial *m = &raw->materials[i];
        if (!finite_array(m->base, 4) || !finite_array(m->emissive, 3) ||
            !finite_array(m->specular_color, 3) || !isfinite(m->metallic) ||
            !isfinite(m->roughness) || !isfinite(m->emissive_strength) || !isfinite(m->cutoff) ||
            !isfinite(m->specular_factor) || !isfinite(m->normal_scale))
            return refuse(why, "material %u: a number is not finite", i);
        if (m->alpha_mode > 2) return refuse(why, "material %u: unknown alphaMode", i);
        if (!check_texture_ref(raw, i, &m->base_texture, why) ||
            !check_texture_ref(raw, i, &m->metallic_roughness_texture, why) ||
            !check_texture_ref(raw, i, &m->normal_texture, why) ||
            !check_texture_ref(raw, i, &m->emissive_texture, why))
            return false;
    }
    for (u32 i = 0; i < raw->texture_count; i++)
        if (!index_ok(raw->textures[i].image, raw->image_count, true) ||
            !index_ok(raw->textures[i].sampler, raw->sampler_count, true))
            return refuse(why, "texture %u: its image or sampler does not exist", i);
    return true;
}

static bool check_images(const GltfRaw *raw, const GltfFiles *files, char *why) {
    char name[GLTF_PATH_CAP], reason[ASSET_MESSAGE_CAP];
    for (u32 i = 0; i < raw->image_count; i++) {
        if (!index_ok(raw->images[i].view, raw->view_count, true))
            return refuse(why, "image %u: there is no bufferView %d", i, raw->images[i].view);
        // An unknown scheme is a missing image; a name that breaks out is not an accident.
        if (raw->images[i].uri.size &&
            gltf_uri_decode(files, raw->images[i].uri, name, reason) == GLTF_URI_BAD)
            return refuse(why, "image %u: %.200s", i, reason);
    }
    for (u32 i = 0; i < raw->buffer_count; i++)
        if (raw->buffer_uris[i].size &&
            gltf_uri_decode(files, raw->buffer_uris[i], name, reason) != GLTF_URI_OK)
            return refuse(why, "buffer %u: %.200s", i, reason);
    return true;
}

static bool check_lights_and_cameras(const GltfRaw *raw, char *why) {
    for (u32 i = 0; i < raw->light_count; i++) {
        const GltfLight *l = &raw->lights[i];
        bool numbers = finite_array(l->color, 3) && isfinite(l->intensity) && isfinite(l->range);
        if (l->malformed || !numbers || l->color[0] < 0 || l->color[1] < 0 || l->color[2] < 0 ||
            l->intensity < 0 || l->range < 0)
            return refuse(why, "light %u: colour, intensity or range are not numbers over 0", i);
        if (l->kind > 2) return refuse(why, "light %u: unknown type", i);
        if (l->kind == 1 &&
            !(l->inner_rad >= 0 && l->inner_rad < l->outer_rad && l->outer_rad <= PI_F / 2 + 1e-4f))
            return refuse(why, "light %u: cone angles are not 0 <= inner < outer <= 90 degrees", i);
    }
    for (u32 i = 0; i < raw->camera_count; i++) {
        const GltfCamera *c = &raw->cameras[i];
        if (c->perspective &&
            !(c->fov_y_rad > 0 && c->fov_y_rad < PI_F && c->near > 0 && isfinite(c->near)))
            return refuse(why, "camera %u: yfov or znear is out of range", i);
    }
    return true;
}

bool gltf_check(GltfRaw *raw, const GltfFiles *files, char *why) {
    return check_asset(raw, why) && check_views(raw, why) && check_accessors(raw, why) &&
           check_images(raw, files, why) && check_materials(raw, why) && check_meshes(raw, why) &&
           check_nodes(raw, why) && check_lights_and_cameras(raw, why);
}

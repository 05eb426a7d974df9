// gltf_model.c: asset_load_model: from a path to a model in the store.
//
// Data in: a path below a root. Data out: a model with parts, materials, lights and cameras in
// model space; or a message and a store as it was. Called by levels and tools. Does not: play
// animations, bend skins or morphs (one warning each), or know the world.
#include "gltf_raw.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct Placed {
    u32 node;
    Mat34 world; // node to model space
} Placed;

typedef struct Placement {
    Placed *placed; // nodes of the scene, parents before children
    u32 count;
    u32 part_count, light_count, camera_count, orthographic_count;
} Placement;

static bool transform_ok(const Mat34 *m) {
    for (u32 i = 0; i < 12; i++)
        if (!(fabsf(m->m[i]) <= GLTF_COORDINATE_MAX)) return false;
    return true;
}

static bool mirrors(const Mat34 *m) {
    Vec3 x = {m->m[0], m->m[4], m->m[8]}, y = {m->m[1], m->m[5], m->m[9]},
         z = {m->m[2], m->m[6], m->m[10]};
    // Unit axes: the sign must survive very small and very large scales.
    return vec3_dot(vec3_cross(vec3_normalize(x), vec3_normalize(y)), vec3_normalize(z)) < 0.0f;
}

static bool place(Placement *p, const GltfRaw *raw, u32 node, const Mat34 *parent, char *why) {
    Mat34 local = mat34_from_columns(raw->nodes[node].local);
    Placed *out = &p->placed[p->count++];
    *out = (Placed){node, parent ? mat34_mul(*parent, local) : local};
    if (transform_ok(&out->world)) return true;
    snprintf(why, ASSET_MESSAGE_CAP, "node %u: its place is over 1e9", node);
    return false;
}

// Breadth first, the list being its own queue. Every node has one parent (gltf_check), so none
// comes twice and the list has room for all.
static bool place_nodes(Placement *p, const GltfRaw *raw, Arena *scratch, char *why) {
    p->placed = scratch_try_push(scratch, MAX(raw->node_count, 1), sizeof *p->placed);
    if (!p->placed) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u nodes", raw->node_count);
        return false;
    }
    for (u32 i = 0; i < raw->root_count; i++)
        if (!place(p, raw, (u32)raw->roots[i], NULL, why)) return false;
    // A file without scenes is a library of nodes: all of it is shown.
    for (u32 i = 0; raw->scene_count == 0 && i < raw->node_count; i++)
        if (raw->nodes[i].parent == -1 && !place(p, raw, i, NULL, why)) return false;
    for (u32 i = 0; i < p->count; i++) {
        const GltfNode *n = &raw->nodes[p->placed[i].node];
        for (u32 k = 0; k < n->child_count; k++)
            if (!place(p, raw, (u32)raw->children[n->first_child + k], &p->placed[i].world, why))
                return false;
    }
    return true;
}

// Primitives that some node of the scene shows.
static void mark_wanted(const Placement *p, const GltfRaw *raw, u32 *mesh_of) {
    for (u32 i = 0; i < p->count; i++) {
        const GltfNode *n = &raw->nodes[p->placed[i].node];
        if (n->mesh < 0) continue;
        const GltfMesh *mesh = &raw->meshes[n->mesh];
        if (mesh->primitive_count && mesh_of[mesh->first_primitive]) continue;
        for (u32 k = 0; k < mesh->primitive_count; k++) mesh_of[mesh->first_primitive + k] = 1;
    }
}

static bool count_placed(Placement *p, const GltfRaw *raw, const u32 *mesh_of, char *why) {
    for (u32 i = 0; i < p->count; i++) {
        const GltfNode *n = &raw->nodes[p->placed[i].node];
        if (n->light >= 0) p->light_count++;
        if (n->camera >= 0 && raw->cameras[n->camera].perspective) p->camera_count++;
        if (n->camera >= 0 && !raw->cameras[n->camera].perspective) p->orthographic_count++;
        if (n->mesh < 0) continue;
        const GltfMesh *mesh = &raw->meshes[n->mesh];
        for (u32 k = 0; k < mesh->primitive_count; k++)
            p->part_count += mesh_of[mesh->first_primitive + k] != 0;
        // Tested at every node: primitives and nodes are limited, their product could wrap.
        if (p->part_count > ASSET_PARTS_MAX) break;
    }
    if (p->part_count <= ASSET_PARTS_MAX && p->light_count <= ASSET_LIGHTS_MAX) return true;
    snprintf(why, ASSET_MESSAGE_CAP, "more than %u parts or %u lights", ASSET_PARTS_MAX,
             ASSET_LIGHTS_MAX);
    return false;
}

static bool build_parts(AssetStore *store, const GltfRaw *raw, const Placement *p,
                        const u32 *mesh_of, Model *model, char *why) {
    ModelPart *parts = ARENA_PUSH(&store->arena, ModelPart, p->part_count);
    u32 *mirrored = scratch_try_push(&store->scratch, MAX(raw->primitive_count, 1), sizeof(u32));
    u32 count = 0;
    for (u32 i = 0; mirrored && i < p->count; i++) {
        const GltfNode *n = &raw->nodes[p->placed[i].node];
        const GltfMesh *mesh = n->mesh >= 0 ? &raw->meshes[n->mesh] : NULL;
        bool mirror = mesh && mirrors(&p->placed[i].world);
        for (u32 k = 0; mesh && k < mesh->primitive_count; k++) {
            u32 primitive = mesh->first_primitive + k;
            if (!mesh_of[primitive]) continue;
            ModelPart *part = &parts[count++];
            i32 material = raw->primitives[primitive].material;
            *part = (ModelPart){mesh_of[primitive],
                                material >= 0 ? (u32)material : model->material_count - 1,
                                p->placed[i].world};
            if (mirror) {
                if (!mirrored[primitive])
                    mirrored[primitive] = mesh_add_mirrored(store, mesh_of[primitive]);
                if (!mirrored[primitive]) {
                    snprintf(why, ASSET_MESSAGE_CAP, "no room for a mirrored mesh");
                    return false;
                }
                part->mesh = mirrored[primitive];
                for (u32 row = 0; row < 3; row++) part->local.m[row * 4] *= -1.0f;
            }
            model_grow_bounds(model, &store->meshes[part->mesh], &part->local, count == 1);
        }
    }
    model->parts = parts;
    model->part_count = count;
    return true;
}

static const char *name_or(Arena *arena, const char *name, const char *node, const char *what,
                           u32 index) {
    const char *best = name[0] ? name : node;
    return best[0] ? arena_copy_string(arena, best) : arena_format(arena, "%s %u", what, index);
}

static void build_lights_and_cameras(AssetStore *store, const GltfRaw *raw, const Placement *p,
                                     Model *model) {
    Arena *arena = &store->arena;
    ModelLight *lights = ARENA_PUSH(arena, ModelLight, p->light_count);
    ModelCamera *cameras = ARENA_PUSH(arena, ModelCamera, p->camera_count);
    model->lights = lights;
    model->cameras = cameras;
    for (u32 i = 0; i < p->count; i++) {
        const GltfNode *n = &raw->nodes[p->placed[i].node];
        if (n->light >= 0) {
            const GltfLight *l = &raw->lights[n->light];
            lights[model->light_count] =
                (ModelLight){.name = name_or(arena, l->name, n->name, "light", model->light_count),
                             .kind = l->kind,
                             .color = {l->color[0], l->color[1], l->color[2]},
                             .intensity = l->intensity,
                             .range = l->range,
                             .inner_rad = l->inner_rad,
                             .outer_rad = MIN(l->outer_rad, PI_F / 2),
                             .local = p->placed[i].world};
            model->light_count++;
        }
        if (n->camera >= 0 && raw->cameras[n->camera].perspective) {
            const GltfCamera *c = &raw->cameras[n->camera];
            cameras[model->camera_count] = (ModelCamera){
                .name = name_or(arena, c->name, n->name, "camera", model->camera_count),
                .fov_y_rad = c->fov_y_rad,
                .near = c->near,
                .local = p->placed[i].world};
            model->camera_count++;
        }
    }
}

static void remark(const GltfRaw *raw, const Placement *p, const char *path) {
    if (raw->remark[0]) LOG(ASSET_MODEL_WARNING, "%s: %s", path, raw->remark);
    if (raw->skin_count) LOG(ASSET_MODEL_WARNING, "%s: skins are ignored", path);
    if (raw->animation_count) LOG(ASSET_MODEL_WARNING, "%s: animations are ignored", path);
    if (p->orthographic_count)
        LOG(ASSET_MODEL_WARNING, "%s: orthographic cameras are left out", path);
    if (!p->part_count && !p->light_count && !p->camera_count)
        LOG(ASSET_MODEL_WARNING, "%s: its scene holds nothing", path);
}

static u32 build_model(AssetStore *store, GltfFiles *files, const GltfRaw *raw, const char *path,
                       char *why) {
    Model model = {0};
    Placement p = {0};
    u32 *mesh_of = scratch_try_push(&store->scratch, MAX(raw->primitive_count, 1), sizeof(u32));
    if (!mesh_of) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u primitives", raw->primitive_count);
        return 0;
    }
    if (!place_nodes(&p, raw, &store->scratch, why)) return 0;
    mark_wanted(&p, raw, mesh_of);
    if (!gltf_build_meshes(store, raw, path, mesh_of, why) ||
        !count_placed(&p, raw, mesh_of, why) ||
        !gltf_build_materials(store, files, raw, path, &model, why))
        return 0;
    // Parts, lights, cameras and their names are small beside what limits allow: one test for all.
    if (!arena_can_push(&store->arena,
                        p.part_count * sizeof(ModelPart) +
                            (u64)p.light_count * (sizeof(ModelLight) + 256) +
                            (u64)p.camera_count * (sizeof(ModelCamera) + 256) + KIB(64),
                        64)) {
        snprintf(why, ASSET_MESSAGE_CAP, "the store is full");
        return 0;
    }
    if (!build_parts(store, raw, &p, mesh_of, &model, why)) return 0;
    build_lights_and_cameras(store, raw, &p, &model);
    model.name = arena_copy_string(&store->arena, path);
    model.content_hash = files->hash;
    u32 id = store_add_model(store, &model);
    if (id)
        remark(raw, &p, path);
    else
        snprintf(why, ASSET_MESSAGE_CAP, "a limit of the store is reached");
    return id;
}

static u32 load(AssetStore *store, const FileRoot *root, const char *path, char *why) {
    GltfFiles files = {.root = root, .scratch = &store->scratch, .bytes_left = ASSET_FILE_SIZE_MAX};
    const char *name;
    Bytes file, json;
    bool binary;
    GltfRaw raw;
    if (strlen(path) >= GLTF_PATH_CAP) {
        snprintf(why, ASSET_MESSAGE_CAP, "the path is longer than %d bytes", GLTF_PATH_CAP);
        return 0;
    }
    file_split_path(path, files.directory, sizeof files.directory, &name);
    if (strcmp(files.directory, ".") == 0) files.directory[0] = 0;
    if (!file_root_read(root, path, ASSET_FILE_SIZE_MAX, &store->scratch, &file)) {
        log_last_error(why, ASSET_MESSAGE_CAP);
        return 0;
    }
    files.bytes_left -= file.size;
    files.hash = hash_bytes(file.data, file.size, 0);
    if (!gltf_scan(file, &json, &binary, why) || !gltf_parse(file, json, binary, &files, &raw, why))
        return 0;
    u32 id = gltf_check(&raw, &files, why) ? build_model(store, &files, &raw, path, why) : 0;
    gltf_free(&raw);
    return id;
}

u32 asset_load_model(AssetStore *store, const FileRoot *root, const char *path) {
    u32 found = store_find_model(store, path);
    if (found) return found;
    char why[ASSET_MESSAGE_CAP] = "";
    StoreMark mark = store_mark(store);
    u32 id = load(store, root, path, why);
    if (id) {
        arena_rewind(&store->scratch, mark.scratch);
    } else {
        LOG(ASSET_MODEL, "%s: %s", path, why[0] ? why : "cannot be loaded");
        store_rewind(store, mark);
    }
    return id;
}

// gltf.cpp: parses glTF with tinygltf into the plain arrays of gltf_raw.h.
//
// Data in: a file that gltf_scan accepted. Data out: GltfRaw in scratch memory; numbers and
// indices as written, node transforms as matrices (GLM). Called by asset_load_model. Does not:
// check indices and ranges (gltf_check.c), decode images, let an exception out, or let the parser
// touch the file system: its callbacks end in gltf_files_read.
//
// The packaged library is used as it is: no TINYGLTF_ macro may be defined here, they would
// change the layout of its classes.
#include "gltf_raw.h"
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <tiny_gltf.h>
#include <cstdio>
#include <cstring>
#include <new>

namespace {

struct NoMemory {};

struct Reader {
    Arena *arena;
    const tinygltf::Model *model;
    GltfRaw *raw;

    template <typename T> T *array(u64 count) {
        void *memory = scratch_try_push(arena, count ? count : 1, sizeof(T));
        if (!memory) throw NoMemory();
        return static_cast<T *>(memory);
    }
    const char *text(const std::string &s) {
        if (!arena_can_push(arena, s.size() + 1, 1)) throw NoMemory();
        return gltf_copy_text(arena, s.data(), s.size());
    }
};

Bytes bytes_of(const std::string &s) { return Bytes{s.data(), s.size()}; }
Bytes bytes_of(const std::vector<unsigned char> &v) { return Bytes{v.data(), v.size()}; }

// ---- callbacks ----

bool file_exists(const std::string &, void *) { return true; } // reading answers for both
std::string expand_path(const std::string &path, void *) { return path; }

bool read_whole_file(std::vector<unsigned char> *out, std::string *error, const std::string &name,
                     void *user) {
    GltfFiles *files = static_cast<GltfFiles *>(user);
    char why[ASSET_MESSAGE_CAP] = "";
    u64 mark = arena_mark(files->scratch);
    Bytes bytes;
    bool ok = gltf_files_read(files, name.data(), name.size(), &bytes, why);
    if (ok) {
        const unsigned char *data = static_cast<const unsigned char *>(bytes.data);
        out->assign(data, data + bytes.size);
    } else {
        *error = why;
    }
    arena_rewind(files->scratch, mark);
    return ok;
}

bool write_whole_file(std::string *, const std::string &, const std::vector<unsigned char> &,
                      void *) {
    return false;
}

// Stores bytes and nothing else. Those of a buffer view are taken later, after the view has been
// checked: here they may lie beyond the buffer.
bool store_image(tinygltf::Image *image, const int, std::string *, std::string *, int, int,
                 const unsigned char *bytes, int size, void *) {
    image->as_is = true;
    if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

// ---- extensions ----

const tinygltf::Value *find_extension(const tinygltf::ExtensionMap &extensions, const char *name) {
    auto it = extensions.find(name);
    return it != extensions.end() && it->second.IsObject() ? &it->second : nullptr;
}

bool has_number(const tinygltf::Value *object, const char *key) {
    return object && object->Has(key) && object->Get(key).IsNumber();
}

f32 number(const tinygltf::Value *object, const char *key, f32 otherwise) {
    return has_number(object, key) ? f32(object->Get(key).GetNumberAsDouble()) : otherwise;
}

// A whole number that may be an index: anything else becomes one that no array has.
i32 index_number(const tinygltf::Value *object, const char *key) {
    double value = object->Get(key).GetNumberAsDouble();
    return value >= 0 && value < double(INT32_MAX) ? i32(value) : INT32_MAX;
}

void numbers(const tinygltf::Value *object, const char *key, int count, f32 *out) {
    if (!object || !object->Has(key)) return;
    const tinygltf::Value &list = object->Get(key);
    if (!list.IsArray() || list.ArrayLen() != size_t(count)) return;
    for (int i = 0; i < count; i++)
        if (list.Get(i).IsNumber()) out[i] = f32(list.Get(i).GetNumberAsDouble());
}

// ---- sections ----

void read_buffers(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.buffer_count = u32(m.buffers.size());
    raw.buffers = r.array<Bytes>(raw.buffer_count);
    raw.buffer_uris = r.array<Bytes>(raw.buffer_count);
    for (u32 i = 0; i < raw.buffer_count; i++) {
        raw.buffers[i] = bytes_of(m.buffers[i].data);
        if (!tinygltf::IsDataURI(m.buffers[i].uri)) raw.buffer_uris[i] = bytes_of(m.buffers[i].uri);
    }
    raw.view_count = u32(m.bufferViews.size());
    raw.views = r.array<GltfView>(raw.view_count);
    for (u32 i = 0; i < raw.view_count; i++) {
        const tinygltf::BufferView &v = m.bufferViews[i];
        raw.views[i] = GltfView{v.buffer, v.byteOffset, v.byteLength, v.byteStride};
    }
}

void read_accessors(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.accessor_count = u32(m.accessors.size());
    raw.accessors = r.array<GltfAccessor>(raw.accessor_count);
    for (u32 i = 0; i < raw.accessor_count; i++) {
        const tinygltf::Accessor &a = m.accessors[i];
        GltfAccessor &out = raw.accessors[i];
        out.view = a.bufferView;
        out.offset = a.byteOffset;
        out.count = a.count;
        out.component_type = u32(a.componentType);
        // The library's type numbers: 1 scalar is 65, vectors 2 to 4, matrices 34 to 36.
        out.columns =
            a.type >= TINYGLTF_TYPE_MAT2 && a.type <= TINYGLTF_TYPE_MAT4 ? u32(a.type - 32) : 1;
        out.rows = a.type == TINYGLTF_TYPE_SCALAR ? 1 : out.columns > 1 ? out.columns : u32(a.type);
        out.normalized = a.normalized;
        out.sparse = a.sparse.isSparse;
        if (!out.sparse) continue; // the fields below are not initialised then
        out.sparse_count = a.sparse.count;
        out.sparse_index_view = a.sparse.indices.bufferView;
        out.sparse_index_offset = a.sparse.indices.byteOffset;
        out.sparse_index_type = u32(a.sparse.indices.componentType);
        out.sparse_value_view = a.sparse.values.bufferView;
        out.sparse_value_offset = a.sparse.values.byteOffset;
    }
}

void read_images(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.image_count = u32(m.images.size());
    raw.images = r.array<GltfImage>(raw.image_count);
    for (u32 i = 0; i < raw.image_count; i++)
        raw.images[i] = GltfImage{bytes_of(m.images[i].image), m.images[i].bufferView,
                                  bytes_of(m.images[i].uri)};
    raw.texture_count = u32(m.textures.size());
    raw.textures = r.array<GltfTexture>(raw.texture_count);
    for (u32 i = 0; i < raw.texture_count; i++)
        raw.textures[i] = GltfTexture{m.textures[i].source, m.textures[i].sampler};
}

template <typename Info> GltfTextureRef texture_ref(const Info &info) {
    GltfTextureRef ref = {};
    ref.texture = info.index;
    ref.set = info.texCoord;
    ref.scale[0] = ref.scale[1] = 1;
    const tinygltf::Value *t = find_extension(info.extensions, "KHR_texture_transform");
    if (!t) return ref;
    ref.has_transform = true;
    numbers(t, "offset", 2, ref.offset);
    numbers(t, "scale", 2, ref.scale);
    ref.rotation_rad = number(t, "rotation", 0);
    if (has_number(t, "texCoord")) ref.set = index_number(t, "texCoord");
    return ref;
}

void read_material(Reader &r, const tinygltf::Material &m, GltfMaterial &out) {
    const tinygltf::PbrMetallicRoughness &pbr = m.pbrMetallicRoughness;
    out.name = r.text(m.name);
    for (u32 i = 0; i < 4; i++)
        out.base[i] = pbr.baseColorFactor.size() == 4 ? f32(pbr.baseColorFactor[i]) : 1;
    for (u32 i = 0; i < 3; i++)
        out.emissive[i] = m.emissiveFactor.size() == 3 ? f32(m.emissiveFactor[i]) : 0;
    out.metallic = f32(pbr.metallicFactor);
    out.roughness = f32(pbr.roughnessFactor);
    out.normal_scale = f32(m.normalTexture.scale);
    out.cutoff = f32(m.alphaCutoff);
    out.alpha_mode = m.alphaMode == "OPAQUE"  ? 0
                     : m.alphaMode == "MASK"  ? 1
                     : m.alphaMode == "BLEND" ? 2
                                              : 3;
    out.double_sided = m.doubleSided;
    out.base_texture = texture_ref(pbr.baseColorTexture);
    out.metallic_roughness_texture = texture_ref(pbr.metallicRoughnessTexture);
    out.normal_texture = texture_ref(m.normalTexture);
    out.emissive_texture = texture_ref(m.emissiveTexture);

    out.unlit = m.extensions.count("KHR_materials_unlit") > 0;
    out.emissive_strength = number(find_extension(m.extensions, "KHR_materials_emissive_strength"),
                                   "emissiveStrength", 1);
    const tinygltf::Value *specular = find_extension(m.extensions, "KHR_materials_specular");
    out.specular_factor = number(specular, "specularFactor", 1);
    out.specular_color[0] = out.specular_color[1] = out.specular_color[2] = 1;
    numbers(specular, "specularColorFactor", 3, out.specular_color);
    out.has_specular_textures =
        specular && (specular->Has("specularTexture") || specular->Has("specularColorTexture"));
}

i32 attribute(const tinygltf::Primitive &p, const char *name) {
    auto it = p.attributes.find(name);
    if (it == p.attributes.end()) return GLTF_ABSENT;
    return it->second < 0 ? INT32_MAX : it->second; // written and negative: not absent but wrong
}

void read_meshes(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.mesh_count = u32(m.meshes.size());
    raw.meshes = r.array<GltfMesh>(raw.mesh_count);
    for (u32 i = 0; i < raw.mesh_count; i++) {
        raw.meshes[i] = GltfMesh{raw.primitive_count, u32(m.meshes[i].primitives.size())};
        raw.primitive_count += raw.meshes[i].primitive_count;
    }
    raw.primitives = r.array<GltfPrimitive>(raw.primitive_count);
    GltfPrimitive *out = raw.primitives;
    for (const tinygltf::Mesh &mesh : m.meshes)
        for (const tinygltf::Primitive &p : mesh.primitives) {
            out->position = attribute(p, "POSITION");
            out->normal = attribute(p, "NORMAL");
            out->tangent = attribute(p, "TANGENT");
            out->color = attribute(p, "COLOR_0");
            out->uv[0] = attribute(p, "TEXCOORD_0");
            out->uv[1] = attribute(p, "TEXCOORD_1");
            out->indices = p.indices;
            out->material = p.material;
            out->mode = p.mode;
            out->morphs = !p.targets.empty();
            out++;
        }
}

bool length_is(const std::vector<double> &v, size_t length) {
    return v.empty() || v.size() == length;
}

void read_node(Reader &r, const tinygltf::Node &n, GltfNode &out) {
    out.name = r.text(n.name);
    out.mesh = n.mesh;
    out.camera = n.camera;
    out.skin = n.skin;
    out.light = -1;
    out.parent = -1;
    const tinygltf::Value *light = find_extension(n.extensions, "KHR_lights_punctual");
    if (has_number(light, "light")) out.light = index_number(light, "light");
    out.malformed = !length_is(n.matrix, 16) || !length_is(n.translation, 3) ||
                    !length_is(n.rotation, 4) || !length_is(n.scale, 3);
    if (out.malformed) return;
    glm::dmat4 local(1.0);
    if (!n.matrix.empty()) {
        local = glm::make_mat4(n.matrix.data());
    } else {
        if (!n.translation.empty())
            local = glm::translate(local, glm::dvec3(glm::make_vec3(n.translation.data())));
        if (!n.rotation.empty()) {
            glm::dquat q(n.rotation[3], n.rotation[0], n.rotation[1], n.rotation[2]);
            double length = glm::length(q);
            if (length > 0) local *= glm::mat4_cast(q / length);
        }
        if (!n.scale.empty()) local = glm::scale(local, glm::dvec3(glm::make_vec3(n.scale.data())));
    }
    for (int c = 0; c < 4; c++)
        for (int row = 0; row < 4; row++) out.local[c * 4 + row] = f32(local[c][row]);
}

void read_nodes(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.node_count = u32(m.nodes.size());
    raw.nodes = r.array<GltfNode>(raw.node_count);
    u64 child_count = 0;
    for (const tinygltf::Node &n : m.nodes) child_count += n.children.size();
    raw.children = r.array<i32>(child_count);
    for (u32 i = 0; i < raw.node_count; i++) {
        const tinygltf::Node &n = m.nodes[i];
        read_node(r, n, raw.nodes[i]);
        raw.nodes[i].first_child = raw.child_count;
        raw.nodes[i].child_count = u32(n.children.size());
        for (int child : n.children) raw.children[raw.child_count++] = child;
    }
    raw.scene_count = u32(m.scenes.size());
    raw.scene = m.defaultScene;
    u32 shown = raw.scene < 0 ? 0 : u32(raw.scene);
    if (shown >= m.scenes.size()) {
        raw.roots = r.array<i32>(0);
        return; // no scene, or an index that gltf_check refuses
    }
    const std::vector<int> &roots = m.scenes[shown].nodes;
    raw.root_count = u32(roots.size());
    raw.roots = r.array<i32>(raw.root_count);
    for (u32 i = 0; i < raw.root_count; i++) raw.roots[i] = roots[i];
}

void read_lights_and_cameras(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.camera_count = u32(m.cameras.size());
    raw.cameras = r.array<GltfCamera>(raw.camera_count);
    for (u32 i = 0; i < raw.camera_count; i++) {
        const tinygltf::Camera &c = m.cameras[i];
        raw.cameras[i] = GltfCamera{r.text(c.name), c.type == "perspective",
                                    f32(c.perspective.yfov), f32(c.perspective.znear)};
    }
    raw.light_count = u32(m.lights.size());
    raw.lights = r.array<GltfLight>(raw.light_count);
    for (u32 i = 0; i < raw.light_count; i++) {
        const tinygltf::Light &l = m.lights[i];
        GltfLight &out = raw.lights[i];
        out.name = r.text(l.name);
        out.kind = l.type == "point" ? 0 : l.type == "spot" ? 1 : l.type == "directional" ? 2 : 3;
        out.malformed = !length_is(l.color, 3);
        for (u32 c = 0; c < 3; c++) out.color[c] = l.color.size() == 3 ? f32(l.color[c]) : 1;
        out.intensity = f32(l.intensity);
        out.range = f32(l.range);
        out.inner_rad = f32(l.spot.innerConeAngle);
        out.outer_rad = f32(l.spot.outerConeAngle);
    }
}

void read_all(Reader &r) {
    const tinygltf::Model &m = *r.model;
    GltfRaw &raw = *r.raw;
    raw.version = r.text(m.asset.version);
    raw.min_version = r.text(m.asset.minVersion);
    raw.required_count = u32(m.extensionsRequired.size());
    raw.required = r.array<const char *>(raw.required_count);
    for (u32 i = 0; i < raw.required_count; i++) raw.required[i] = r.text(m.extensionsRequired[i]);
    read_buffers(r);
    read_accessors(r);
    read_images(r);
    raw.material_count = u32(m.materials.size());
    raw.materials = r.array<GltfMaterial>(raw.material_count);
    for (u32 i = 0; i < raw.material_count; i++) read_material(r, m.materials[i], raw.materials[i]);
    read_meshes(r);
    read_nodes(r);
    read_lights_and_cameras(r);
    raw.skin_count = u32(m.skins.size());
    raw.animation_count = u32(m.animations.size());
    raw.sampler_count = u32(m.samplers.size());
}

std::string first_line(const std::string &text) { return text.substr(0, text.find('\n')); }

void explain(Arena *arena, const std::string &error, char *why) {
    std::string line = first_line(error);
    if (line.empty()) line = "the parser refuses it without a word";
    u64 mark = arena_mark(arena);
    std::snprintf(why, ASSET_MESSAGE_CAP, "%s",
                  arena_can_push(arena, 256, 1) ? gltf_copy_text(arena, line.data(), line.size())
                                                : "no memory");
    arena_rewind(arena, mark);
}

bool parse(Bytes file, Bytes json, bool binary, GltfFiles *files, GltfRaw *raw, char *why) {
    tinygltf::TinyGLTF loader;
    tinygltf::FsCallbacks callbacks = {};
    callbacks.FileExists = file_exists;
    callbacks.ExpandFilePath = expand_path;
    callbacks.ReadWholeFile = read_whole_file;
    callbacks.WriteWholeFile = write_whole_file;
    callbacks.user_data = files;
    loader.SetFsCallbacks(callbacks);
    loader.SetImageLoader(store_image, nullptr);

    tinygltf::Model *model = new tinygltf::Model;
    raw->owner = model;
    std::string error, warning; // a warning is an image that is not there: said when it is missed
    bool ok = binary ? loader.LoadBinaryFromMemory(model, &error, &warning,
                                                   static_cast<const unsigned char *>(file.data),
                                                   unsigned(file.size), "")
                     : loader.LoadASCIIFromString(model, &error, &warning,
                                                  static_cast<const char *>(json.data),
                                                  unsigned(json.size), "");
    // The parser drops some objects that it cannot read and goes on with only a line in `error`.
    // That may be a primitive; but about skins and animations, which are not used, it also
    // complains without reason (inverseBindMatrices are optional), so there it is a remark.
    bool unused_parts = !model->skins.empty() || !model->animations.empty();
    if (!ok || (!error.empty() && !unused_parts)) {
        explain(files->scratch, error, why);
        return false;
    }
    Reader reader = {files->scratch, model, raw};
    raw->remark = reader.text(first_line(error));
    read_all(reader);
    return true;
}

} // namespace

extern "C" bool gltf_parse(Bytes file, Bytes json, bool binary, GltfFiles *files, GltfRaw *raw,
                           char *why) {
    std::memset(raw, 0, sizeof *raw);
    try {
        if (parse(file, json, binary, files, raw, why)) return true;
    } catch (const NoMemory &) {
        std::snprintf(why, ASSET_MESSAGE_CAP, "no memory for its tables");
    } catch (const std::bad_alloc &) {
        std::snprintf(why, ASSET_MESSAGE_CAP, "no memory to parse it");
    } catch (const std::exception &e) {
        std::snprintf(why, ASSET_MESSAGE_CAP, "%.200s", e.what());
    } catch (...) {
        std::snprintf(why, ASSET_MESSAGE_CAP, "the parser failed");
    }
    gltf_free(raw);
    return false;
}

extern "C" void gltf_free(GltfRaw *raw) {
    delete static_cast<tinygltf::Model *>(raw->owner);
    raw->owner = nullptr;
}

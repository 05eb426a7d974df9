// gi_vox.glsl: triangles and voxels: which voxels a triangle touches, and what it leaves in them.
// Included by the raster way (gi_vox.vert, gi_vox.frag), the compute way (gi_vox.comp) and
// gi_solid.comp.
//
// Both ways ask vox_touches, and the first one alone, whether a triangle touches a voxel: rasterising
// or walking only proposes candidates. All that decides is `precise` and in one order, so the ways
// agree to the bit, and so does the twin on the CPU (tests/gpu/voxel_twin.c).
//
// The test is that of Akenine-Moller 2001 (13 axes), with intervals made once a triangle as
// Schwarz and Seidel 2010 do. An interval of the three corners is valid along any axis, so a normal
// that rounding bent (slivers) loses nothing. Boxes are closed, and larger by a slack that is more
// than rounding can lose: what touches a voxel in exact arithmetic is found.
#ifndef GI_VOX_GLSL
#define GI_VOX_GLSL
#define GI_BUILD
#include "gi.glsl"

layout(constant_id = SPEC_ALPHA_MASK) const uint ALPHA_MASK = 0;
// Bit 0: albedo texture; 2: emissive texture; 3: emits light.
layout(constant_id = SPEC_TEXTURES) const uint TEXTURES = 15;

layout(std140, set = 0, binding = BUILD_MATERIALS) uniform GiMaterialBuffer {
    MaterialRecord gi_materials[MATERIALS_CAP];
};
layout(std430, set = 0, binding = BUILD_VERTICES) readonly buffer GiVertexBuffer {
    uint gi_vertices[]; // MeshVertex
};
layout(std430, set = 0, binding = BUILD_MESH_INDICES) readonly buffer GiIndexBuffer {
    uint gi_mesh_indices[];
};
layout(std430, set = 0, binding = BUILD_INSTANCES) readonly buffer GiInstanceBuffer {
    InstanceRecord gi_instances[];
};
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; };

uint draw_layer() { return draw.how.x & GI_DRAW_DYNAMIC; }
uint draw_cascade() { return draw.how.x >> GI_DRAW_CASCADE_SHIFT & 3u; }

// --- The triangle ---

const uint VERTEX_WORDS = 8u;

uint vox_vertex(uint triangle, uint corner) {
    return (gi_mesh_indices[draw.mesh.x + triangle * 3u + corner] + draw.mesh.y) * VERTEX_WORDS;
}

vec3 vox_world(uint vertex, uint instance) {
    precise vec4 x = gi_instances[instance].world[0], y = gi_instances[instance].world[1],
                 z = gi_instances[instance].world[2];
    precise vec3 p = uintBitsToFloat(
        uvec3(gi_vertices[vertex], gi_vertices[vertex + 1u], gi_vertices[vertex + 2u]));
    precise vec3 sum = vec3(x.x, y.x, z.x) * p.x;
    precise vec3 add_y = vec3(x.y, y.y, z.y) * p.y;
    precise vec3 add_z = vec3(x.z, y.z, z.z) * p.z;
    sum = sum + add_y;
    sum = sum + add_z;
    sum = sum + vec3(x.w, y.w, z.w);
    return sum;
}

float largest(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

// Corners in voxels of the cascade, and how far rounding may have moved anything, in voxels.
struct VoxCorners {
    vec3 a, b, c;
    float slack;
};

VoxCorners vox_corners(vec3 a, vec3 b, vec3 c) {
    vec4 grid = gi_flow.origin[draw_cascade()];
    precise float inverse = 1.0 / grid.w;
    precise float reach = max(max(largest(a), largest(b)), largest(c)) * inverse;
    precise vec3 va = (a - grid.xyz) * inverse;
    precise vec3 vb = (b - grid.xyz) * inverse;
    precise vec3 vc = (c - grid.xyz) * inverse;
    reach = max(reach, max(max(largest(va), largest(vb)), largest(vc)));
    precise float slack = reach * 9.5367431640625e-7 + 0.0009765625;
    return VoxCorners(va, vb, vc, slack);
}

// Axes are turned (and not mirrored) so that z is the one along which the triangle is projected.
vec3 vox_turn(vec3 p, uint axis) { return axis == 0u ? p.yzx : axis == 1u ? p.zxy : p; }
ivec3 vox_turn_back(ivec3 p, uint axis) { return axis == 0u ? p.zxy : axis == 1u ? p.yzx : p; }

struct VoxTriangle {
    uint axis;
    vec3 a, b, c;        // turned, as all that follows
    vec3 e0, e1, e2, n;  // edges, normal (not unit)
    ivec3 low, high;     // voxels that the triangle's box touches; none if any low > high
    vec3 low0, high0, low1, high1, low2, high2; // across each edge, see vox_across
    float low_n, high_n; // along the normal
    // What bounds z over a column of voxels: a slab whose z is the largest component.
    vec3 slab;
    float slab_low, slab_high, slab_margin;
};

// p along the three axes that are perpendicular to e and to x, y, z: components of p x e.
vec3 vox_across(vec3 e, vec3 p) {
    precise vec3 s = p.yzx * e.zxy;
    precise vec3 t = p.zxy * e.yzx;
    precise vec3 q = s - t;
    return q;
}
float vox_along(vec3 n, vec3 p) {
    precise float s = n.x * p.x;
    precise float t = n.y * p.y;
    precise float u = n.z * p.z;
    s = s + t;
    s = s + u;
    return s;
}
// So small that products vanish: as good as nothing, on devices that flush denormals and on others.
vec3 vox_steady(vec3 v) { return largest(v) < 1e-18 ? vec3(0.0) : v; }

VoxTriangle vox_triangle(VoxCorners corners) {
    VoxTriangle t;
    precise vec3 e0 = corners.b - corners.a;
    precise vec3 e1 = corners.c - corners.b;
    precise vec3 e2 = corners.a - corners.c;
    e0 = vox_steady(e0);
    e1 = vox_steady(e1);
    e2 = vox_steady(e2);
    precise vec3 n = vox_across(e1, e0); // e0 x e1
    n = vox_steady(n);
    // The axis: the largest of the normal; of a sliver, whose normal is noise, the one after the
    // largest of its longest edge.
    vec3 flat_n = abs(n);
    uint axis = flat_n.x >= flat_n.y && flat_n.x >= flat_n.z ? 0u : flat_n.y >= flat_n.z ? 1u : 2u;
    float l0 = largest(e0), l1 = largest(e1), l2 = largest(e2);
    uint longest = l0 >= l1 && l0 >= l2 ? 0u : l1 >= l2 ? 1u : 2u;
    vec3 edge = longest == 0u ? e0 : longest == 1u ? e1 : e2;
    precise float thin = largest(edge) * largest(edge);
    thin = thin * 0.001953125;
    bool is_sliver = largest(n) <= thin;
    vec3 flat_e = abs(edge);
    uint edge_axis = flat_e.x >= flat_e.y && flat_e.x >= flat_e.z ? 1u
                     : flat_e.y >= flat_e.z                       ? 2u
                                                                  : 0u;
    t.axis = is_sliver ? edge_axis : axis;
    t.a = vox_turn(corners.a, t.axis);
    t.b = vox_turn(corners.b, t.axis);
    t.c = vox_turn(corners.c, t.axis);
    t.e0 = vox_turn(e0, t.axis);
    t.e1 = vox_turn(e1, t.axis);
    t.e2 = vox_turn(e2, t.axis);
    t.n = vox_turn(n, t.axis);
    // The box: voxel v touches [low, high] if v <= high and v + 1 >= low.
    vec3 dims = vox_turn(vec3(gi_flow.dims.xyz), t.axis);
    precise vec3 low = min(min(t.a, t.b), t.c) - corners.slack;
    precise vec3 high = max(max(t.a, t.b), t.c) + corners.slack;
    t.low = ivec3(clamp(ceil(low) - 1.0, vec3(0.0), dims));
    t.high = ivec3(clamp(floor(high), vec3(-1.0), dims - 1.0));
    // Intervals, enlarged by half a voxel and the slack.
    precise float h = 0.5 + corners.slack;
    precise vec3 p, q, r;
    r = h * (abs(t.e0.yzx) + abs(t.e0.zxy));
    p = vox_across(t.e0, t.a);
    q = vox_across(t.e0, t.c);
    precise vec3 low0 = min(p, q) - r, high0 = max(p, q) + r;
    r = h * (abs(t.e1.yzx) + abs(t.e1.zxy));
    p = vox_across(t.e1, t.b);
    q = vox_across(t.e1, t.a);
    precise vec3 low1 = min(p, q) - r, high1 = max(p, q) + r;
    r = h * (abs(t.e2.yzx) + abs(t.e2.zxy));
    p = vox_across(t.e2, t.c);
    q = vox_across(t.e2, t.b);
    precise vec3 low2 = min(p, q) - r, high2 = max(p, q) + r;
    t.low0 = low0;
    t.high0 = high0;
    t.low1 = low1;
    t.high1 = high1;
    t.low2 = low2;
    t.high2 = high2;
    precise float na = vox_along(t.n, t.a), nb = vox_along(t.n, t.b), nc = vox_along(t.n, t.c);
    precise float rn = abs(t.n.x) + abs(t.n.y);
    rn = rn + abs(t.n.z);
    rn = rn * h;
    precise float low_n = min(min(na, nb), nc) - rn, high_n = max(max(na, nb), nc) + rn;
    t.low_n = low_n;
    t.high_n = high_n;
    // A sliver's slab is that across its longest edge: (0, e.z, -e.y).
    vec3 turned = longest == 0u ? t.e0 : longest == 1u ? t.e1 : t.e2;
    float edge_low = longest == 0u ? t.low0.x : longest == 1u ? t.low1.x : t.low2.x;
    float edge_high = longest == 0u ? t.high0.x : longest == 1u ? t.high1.x : t.high2.x;
    t.slab = is_sliver ? vec3(0.0, turned.z, -turned.y) : t.n;
    t.slab_low = is_sliver ? edge_low : t.low_n;
    t.slab_high = is_sliver ? edge_high : t.high_n;
    t.slab_margin = corners.slack * 4.0 + 0.015625;
    return t;
}

bool vox_is_empty(VoxTriangle t) { return any(greaterThan(t.low, t.high)); }
uint vox_columns(VoxTriangle t) {
    return uint(t.high.x - t.low.x + 1) * uint(t.high.y - t.low.y + 1);
}
// Is the triangle of a size that this draw is for?
bool vox_is_wanted(VoxTriangle t) {
    return (draw.how.x & (vox_columns(t) > GI_LARGE_COLUMNS ? GI_DRAW_LARGE : GI_DRAW_SMALL)) != 0u;
}

// Does the triangle touch the voxel (turned, within low and high)?
bool vox_touches(VoxTriangle t, ivec3 v) {
    precise vec3 p = vec3(v) + 0.5;
    vec3 q0 = vox_across(t.e0, p), q1 = vox_across(t.e1, p), q2 = vox_across(t.e2, p);
    float qn = vox_along(t.n, p);
    return all(greaterThanEqual(q0, t.low0)) && all(lessThanEqual(q0, t.high0)) &&
           all(greaterThanEqual(q1, t.low1)) && all(lessThanEqual(q1, t.high1)) &&
           all(greaterThanEqual(q2, t.low2)) && all(lessThanEqual(q2, t.high2)) &&
           qn >= t.low_n && qn <= t.high_n;
}

// Candidates: z of a column of voxels, from x to y (none if x > y). What it leaves out touches
// nothing.
ivec2 vox_column(VoxTriangle t, ivec2 column) {
    vec2 center = vec2(column) + 0.5;
    // The three axes of vox_touches that do not hang on z.
    vec3 across = vec3(center.x * t.e0.y - center.y * t.e0.x, center.x * t.e1.y - center.y * t.e1.x,
                       center.x * t.e2.y - center.y * t.e2.x);
    vec3 low = vec3(t.low0.z, t.low1.z, t.low2.z), high = vec3(t.high0.z, t.high1.z, t.high2.z);
    vec3 margin = (high - low) * 1e-3;
    bool is_near = all(greaterThanEqual(across, low - margin)) &&
                   all(lessThanEqual(across, high + margin));
    float inverse = abs(t.slab.z) > 1e-18 ? 1.0 / t.slab.z : 0.0;
    float base = t.slab.x * center.x + t.slab.y * center.y;
    float z0 = (t.slab_low - base) * inverse, z1 = (t.slab_high - base) * inverse;
    float z_low = inverse == 0.0 ? -1.0 : min(z0, z1) - 0.5 - t.slab_margin;
    float z_high = inverse == 0.0 ? 4096.0 : max(z0, z1) - 0.5 + t.slab_margin;
    int first = max(t.low.z, int(ceil(clamp(z_low, -1.0, 4096.0))));
    int last = min(t.high.z, int(floor(clamp(z_high, -1.0, 4096.0))));
    return ivec2(first, is_near ? last : first - 1);
}

// --- What falls into a voxel ---

// Of the three corners.
struct VoxCodes {
    uvec3 normals, colors; // as MeshVertex has them
    vec2 uv0, uv1, uv2;
};
VoxCodes vox_codes(uvec3 vertices) {
    VoxCodes c;
    c.normals = uvec3(gi_vertices[vertices.x + 3u], gi_vertices[vertices.y + 3u],
                      gi_vertices[vertices.z + 3u]);
    c.colors = uvec3(gi_vertices[vertices.x + 7u], gi_vertices[vertices.y + 7u],
                     gi_vertices[vertices.z + 7u]);
    c.uv0 = uintBitsToFloat(uvec2(gi_vertices[vertices.x + 4u], gi_vertices[vertices.x + 5u]));
    c.uv1 = uintBitsToFloat(uvec2(gi_vertices[vertices.y + 4u], gi_vertices[vertices.y + 5u]));
    c.uv2 = uintBitsToFloat(uvec2(gi_vertices[vertices.z + 4u], gi_vertices[vertices.z + 5u]));
    return c;
}

// What a fragment takes from its triangle, as far as it is needed. All that is read is read before
// loops over voxels: within them the software driver reads buffers lane by lane.
struct VoxSurface {
    vec3 n0, n1, n2; // unit normals of the corners
    vec3 yz, zx, xy; // the instance's cofactors, which turn normals
    vec4 c0, c1, c2; // colours
    vec2 uv0, uv1, uv2;
    vec4 factor; // MaterialRecord.albedo
    vec3 emissive, glow;
};

// Does a fragment need its surface? Marking does only for holes in masked materials.
bool vox_needs_surface() { return GI_STEP != 0u || ALPHA_MASK != 0u; }

// Weights of the corners at the triangle's point nearest to the voxel's centre: barycentric
// coordinates of the centre's foot, cut to the triangle.
vec3 vox_weights(VoxTriangle t, ivec3 v) {
    precise vec3 p = vec3(v) + 0.5;
    p = p - t.a;
    precise vec3 f = -t.e2;
    precise float d00 = vox_along(t.e0, t.e0), d01 = vox_along(t.e0, f), d11 = vox_along(f, f);
    precise float d20 = vox_along(p, t.e0), d21 = vox_along(p, f);
    precise float x = d00 * d11, y = d01 * d01;
    precise float area = x - y;
    precise float inverse = area > 1e-12 ? 1.0 / area : 0.0;
    x = d11 * d20;
    y = d01 * d21;
    precise float w1 = (x - y) * inverse;
    x = d00 * d21;
    y = d01 * d20;
    precise float w2 = (x - y) * inverse;
    precise float w0 = 1.0 - w1;
    w0 = w0 - w2;
    w0 = clamp(w0, 0.0, 1.0);
    w1 = clamp(w1, 0.0, 1.0);
    w2 = clamp(w2, 0.0, 1.0);
    precise float sum = w0 + w1;
    sum = sum + w2;
    return vec3(w0 / sum, w1 / sum, w2 / sum);
}

vec3 vox_oct_decode(uint code) {
    precise vec2 e = unpackSnorm2x16(code);
    precise float z = 1.0 - abs(e.x);
    z = z - abs(e.y);
    precise float fold = max(-z, 0.0);
    precise vec3 n = vec3(e.x + (e.x >= 0.0 ? -fold : fold), e.y + (e.y >= 0.0 ? -fold : fold), z);
    return n;
}
vec3 vox_normalize(vec3 v) {
    precise float square = vox_along(v, v);
    precise float inverse = square > 1e-24 ? 1.0 / sqrt(square) : 0.0;
    precise vec3 n = v * inverse;
    return n;
}
vec3 vox_mix(vec3 a, vec3 b, vec3 c, vec3 w) {
    precise vec3 s = a * w.x;
    precise vec3 t = b * w.y;
    precise vec3 u = c * w.z;
    s = s + t;
    s = s + u;
    return s;
}

// World normal at the point, turned by the cofactors as those of the picture are (mesh.glsl).
vec3 vox_normal(VoxSurface s, vec3 w) {
    vec3 n = vox_mix(s.n0, s.n1, s.n2, w);
    return vox_normalize(vec3(vox_along(s.yz, n), vox_along(s.zx, n), vox_along(s.xy, n)));
}

VoxSurface vox_surface(VoxCodes codes, uint instance) {
    VoxSurface s;
    s.n0 = vox_normalize(vox_oct_decode(codes.normals.x));
    s.n1 = vox_normalize(vox_oct_decode(codes.normals.y));
    s.n2 = vox_normalize(vox_oct_decode(codes.normals.z));
    vec3 x = gi_instances[instance].world[0].xyz, y = gi_instances[instance].world[1].xyz,
         z = gi_instances[instance].world[2].xyz;
    s.yz = vox_across(z, y);
    s.zx = vox_across(x, z);
    s.xy = vox_across(y, x);
    s.c0 = unpackUnorm4x8(codes.colors.x);
    s.c1 = unpackUnorm4x8(codes.colors.y);
    s.c2 = unpackUnorm4x8(codes.colors.z);
    s.uv0 = codes.uv0;
    s.uv1 = codes.uv1;
    s.uv2 = codes.uv2;
    uint material = gi_instances[instance].ids.x;
    s.factor = gi_materials[material].albedo;
    s.emissive = (TEXTURES & 8u) != 0u ? gi_materials[material].emissive.rgb : vec3(0.0);
    s.glow = (TEXTURES & 4u) != 0u ? gi_materials[material].extra.yzw : vec3(0.0);
    return s;
}
layout(set = 1, binding = BINDING_ALBEDO_TEXTURE) uniform sampler2D albedo_texture;
layout(set = 1, binding = BINDING_EMISSIVE_TEXTURE) uniform sampler2D emissive_texture;

// The whole level of a texture of this size whose texels come nearest to a voxel: by the areas of
// the triangle in texels and in voxels.
float vox_level(VoxTriangle t, VoxSurface s, ivec2 size) {
    precise vec2 u = (s.uv1 - s.uv0) * vec2(size), v = (s.uv2 - s.uv0) * vec2(size);
    precise float x = u.x * v.y, y = u.y * v.x;
    precise float texels = abs(x - y);
    precise float voxels = sqrt(vox_along(t.n, t.n));
    precise float ratio = max(texels, 1e-9) / max(voxels, 1e-9);
    precise float level = floor(0.5 * log2(ratio) + 0.5);
    return clamp(level, 0.0, 15.0);
}

vec2 vox_uv(VoxSurface s, vec3 w) {
    precise vec2 a = s.uv0 * w.x, b = s.uv1 * w.y, c = s.uv2 * w.z;
    precise vec2 uv = a + b;
    uv = uv + c;
    return uv;
}

struct VoxFragment {
    vec3 albedo, normal, emission;
    bool is_there; // not a hole in a masked material
};

VoxFragment vox_fragment(VoxTriangle t, VoxSurface s, ivec3 v) {
    VoxFragment f;
    vec3 w = vox_weights(t, v);
    vec2 uv = vox_uv(s, w);
    vec4 texel = vec4(1.0);
    if ((TEXTURES & 1u) != 0u)
        texel = textureLod(albedo_texture, uv, vox_level(t, s, textureSize(albedo_texture, 0)));
    precise vec3 color = vox_mix(s.c0.rgb, s.c1.rgb, s.c2.rgb, w);
    precise float alpha = texel.a * vox_mix(s.c0.aaa, s.c1.aaa, s.c2.aaa, w).x;
    f.is_there = ALPHA_MASK == 0u || alpha >= s.factor.w;
    precise vec3 albedo = texel.rgb * s.factor.rgb;
    albedo = albedo * color;
    f.albedo = albedo;
    f.normal = vox_normal(s, w);
    precise vec3 emission = vec3(0.0);
    if ((TEXTURES & 8u) != 0u) emission = s.emissive;
    if ((TEXTURES & 4u) != 0u) {
        float level = vox_level(t, s, textureSize(emissive_texture, 0));
        precise vec3 glow = textureLod(emissive_texture, uv, level).rgb * s.glow;
        emission = emission + glow;
    }
    f.emission = emission;
    return f;
}

// --- Marks and sums ---

uvec3 vox_place(VoxTriangle t, ivec3 v) {
    uvec3 place = uvec3(vox_turn_back(v, t.axis));
    place.z += gi_flow.dims.z * draw_cascade();
    return place;
}

void vox_add(uint at, uint value) {
    if (value != 0u) atomicAdd(gi_accumulators[at], value);
}
uint vox_quantum(float value, float steps) {
    precise float scaled = clamp(value, 0.0, 1.0) * steps;
    scaled = scaled + 0.5;
    return uint(scaled);
}

void vox_accumulate(uint slot, VoxFragment f) {
    uint bits = draw.how.x >> GI_DRAW_BITS_SHIFT & 15u;
    float steps = float((1u << bits) - 1u);
    uint at = slot * GI_SUM_WORDS;
    atomicAdd(gi_accumulators[at + GI_SUM_COUNT], 1u);
    bool two_sided = (draw.how.x & GI_DRAW_TWO_SIDED) != 0u;
    for (uint i = 0u; i < 3u; i++) {
        vox_add(at + GI_SUM_ALBEDO + i, vox_quantum(f.albedo[i], steps));
        precise float coded = f.normal[i] * 0.5;
        coded = coded + 0.5;
        vox_add(at + GI_SUM_NORMAL + i, vox_quantum(coded, steps));
        float plus = two_sided ? abs(f.normal[i]) : f.normal[i];
        float minus = two_sided ? abs(f.normal[i]) : -f.normal[i];
        vox_add(at + GI_SUM_FACES + 2u * i, vox_quantum(plus, steps));
        vox_add(at + GI_SUM_FACES + 2u * i + 1u, vox_quantum(minus, steps));
        if ((TEXTURES & 12u) != 0u) {
            // Twice the bits, in two words.
            precise float share = f.emission[i] / max(uintBitsToFloat(draw.how.z), 1e-30);
            uint whole = vox_quantum(share, float((1u << 2u * bits) - 1u));
            whole = min(whole, (1u << 2u * bits) - 1u);
            vox_add(at + GI_SUM_EMISSION_LOW + i, whole & ((1u << bits) - 1u));
            vox_add(at + GI_SUM_EMISSION_HIGH + i, whole >> bits);
        }
    }
}

// Slots of the layer in the accumulators' window that is open, and how many the layer has.
uint vox_layer_count() {
    return gi_counters[draw_layer() == 0u ? GI_COUNTER_STATIC : GI_COUNTER_DYNAMIC];
}
bool vox_window_is_empty() { return GI_STEP != 0u && vox_layer_count() <= draw.how.y; }

// A triangle touches a voxel: step 0 marks it, step 1 adds to it.
void vox_emit(VoxTriangle t, VoxSurface s, ivec3 v) {
    uint bit = gi_bit(vox_place(t, v)), single = 1u << (bit & 31u);
    uint layer = draw_layer(), word = gi_mask_word(layer, bit);
    if (GI_STEP == 0u) {
        // What is static stays so.
        uint taken = gi_masks[word] | gi_masks[gi_mask_word(GI_MASK_STATIC, bit)];
        bool is_there = (taken & single) == 0u;
        if (ALPHA_MASK != 0u) is_there = is_there && vox_fragment(t, s, v).is_there;
        if (is_there) atomicOr(gi_masks[word], single);
    } else {
        uint mask = gi_masks[word], first = layer == 0u ? 0u : gi_counters[GI_COUNTER_STATIC];
        uint slot = gi_rank(layer, bit);
        uint in_window = slot - first - draw.how.y;
        VoxFragment f = vox_fragment(t, s, v);
        if ((mask & single) != 0u && f.is_there && in_window < GI_WINDOW_SLOTS &&
            slot < gi_flow.counts.z)
            vox_accumulate(in_window, f);
    }
}
#endif

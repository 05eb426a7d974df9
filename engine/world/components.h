// components.h: the engine's own components, each declared once (see table.h for the list form).
//
// Data in level units: metres, degrees, seconds, linear colour, candela-like intensity (irradiance
// at distance d is color * intensity / d^2). Derived columns (empty key) say who writes them.
#ifndef LUZ_COMPONENTS_H
#define LUZ_COMPONENTS_H
#include "table.h"
#ifdef __cplusplus
extern "C" {
#endif

#define COLUMNS_VEC3_(C, a, b, c, unit, initial, key, min, max, help) \
    C(F32, a, unit, initial, key "[0]", min, max, help)               \
    C(F32, b, unit, initial, key "[1]", min, max, help)               \
    C(F32, c, unit, initial, key "[2]", min, max, help)
#define COLUMNS_DERIVED3_(C, a, b, c, unit, help) \
    C(F32, a, unit, 0, "", 0, 0, help)            \
    C(F32, b, unit, 0, "", 0, 0, help)            \
    C(F32, c, unit, 0, "", 0, 0, help)
#define COLUMNS_MAT34_(C, p, help)                                                          \
    C(F32, p##00, "", 1, "", 0, 0, help) C(F32, p##01, "", 0, "", 0, 0, help)               \
    C(F32, p##02, "", 0, "", 0, 0, help) C(F32, p##03, "m", 0, "", 0, 0, help)              \
    C(F32, p##10, "", 0, "", 0, 0, help) C(F32, p##11, "", 1, "", 0, 0, help)               \
    C(F32, p##12, "", 0, "", 0, 0, help) C(F32, p##13, "m", 0, "", 0, 0, help)              \
    C(F32, p##20, "", 0, "", 0, 0, help) C(F32, p##21, "", 0, "", 0, 0, help)               \
    C(F32, p##22, "", 1, "", 0, 0, help) C(F32, p##23, "m", 0, "", 0, 0, help)

// Where an entity is. World = parent's world * T(position + offset) * Ry * Rx * Rz * S.
// The key "parent" of level text (beside the component tables) fills `parent`.
#define TRANSFORM_COLUMNS(C)                                                                      \
    COLUMNS_VEC3_(C, x, y, z, "m", 0, "position", -1e5, 1e5, "position in the parent's space")    \
    COLUMNS_VEC3_(C, pitch, yaw, roll, "deg", 0, "rotation", -36000, 36000,                       \
                  "rotation about x, y, z; applied y, then x, then z")                            \
    COLUMNS_VEC3_(C, scale_x, scale_y, scale_z, "", 1, "scale", -1e4, 1e4, "scale")               \
    C(ENTITY, parent, "transform", 0, "", 0, 0, "transform is relative to this entity")           \
    COLUMNS_DERIVED3_(C, offset_x, offset_y, offset_z, "m", "animate: added to the position")     \
    COLUMNS_MAT34_(C, w, "transform: world matrix, 3 rows of 4")

// A model placed in the world. Its parts become rows of `drawable` (entities of their own).
#define INSTANCE_COLUMNS(C)                                                                       \
    C(ENTITY, model, "model", 0, "model", 0, 0, "what to draw")                                   \
    C(ENTITY, material, "material", 0, "material", 0, 0, "replaces the model's own materials")    \
    C(ENUM, voxel_mode, "none static dynamic", 1, "voxel_mode", 0, 2, "how it enters the voxels") \
    C(BOOL, casts_shadow, "", 1, "casts_shadow", 0, 1, "drawn into shadow maps")                  \
    C(ENUM, collision, "none mesh box", 0, "collision", 0, 2, "what a walker bumps into")         \
    C(BOOL, visible, "", 1, "visible", 0, 1, "drawn at all")

// One mesh with one material: what culling and drawing see. Made from instances by level/ (the
// entity has no transform: owner's world * local gives its own).
#define DRAWABLE_COLUMNS(C)                                                                       \
    C(ENTITY, owner, "instance", 0, "", 0, 0, "entity with transform and instance")               \
    C(U32, mesh, "", 0, "", 0, 0, "mesh id of the asset store")                                   \
    C(ENTITY, material, "material", 0, "", 0, 0, "entity with the material")                      \
    COLUMNS_MAT34_(C, l, "part's matrix in its model, 3 rows of 4")                               \
    COLUMNS_MAT34_(C, w, "transform: world matrix, 3 rows of 4")                                  \
    C(F32, bounds_x, "m", 0, "", 0, 0, "bounds: sphere's centre, world")                          \
    C(F32, bounds_y, "m", 0, "", 0, 0, "bounds: sphere's centre, world")                          \
    C(F32, bounds_z, "m", 0, "", 0, 0, "bounds: sphere's centre, world")                          \
    C(F32, bounds_radius, "m", 0, "", 0, 0, "bounds: radius; negative = hidden")

// A light. Points and spots have an inverse-square falloff windowed to `range` by default.
// Directional and spot lights shine along the entity's -z.
#define LIGHT_COLUMNS(C)                                                                          \
    C(ENUM, kind, "point spot directional", 0, "kind", 0, 2, "type of light")                     \
    C(F32, color_r, "linear", 1, "color[0]", 0, 1000, "colour")                                   \
    C(F32, color_g, "linear", 1, "color[1]", 0, 1000, "colour")                                   \
    C(F32, color_b, "linear", 1, "color[2]", 0, 1000, "colour")                                   \
    C(F32, intensity, "cd", 1, "intensity", 0, 1e6, "candela (lux for directional)")              \
    C(F32, range, "m", 0, "range", 0, 1e4, "reach; 0 = where it falls below 1/256")               \
    C(F32, inner_angle, "deg", 20, "inner_angle", 0, 89, "spot: half-angle of the full cone")     \
    C(F32, outer_angle, "deg", 35, "outer_angle", 0.1, 89, "spot: half-angle of the edge")        \
    C(BOOL, casts_shadow, "", 0, "casts_shadow", 0, 1, "has a shadow map (directional)")          \
    C(BOOL, is_static, "", 0, "static", 0, 1, "never moves or changes")                           \
    C(BOOL, affects_gi, "", 1, "affects_gi", 0, 1, "lights the voxels")                           \
    C(F32, priority, "", 1, "priority", 0, 100,                                                   \
      "weight under a light budget; 100 = pinned: never merged, dropped or faded")                \
    C(ENUM, voxel_shadow, "auto none shadow_map ray soft_ray", 0, "voxel_shadow", 0, 4,           \
      "how voxels ask whether they see it (auto: its shadow map; ray if screen_shadow is cone or volume; else none)")                  \
    C(ENUM, screen_shadow, "map cone volume", 0, "screen_shadow", 0, 2,                           \
      "shadow on surfaces: its shadow map, a cone through the voxels, or what the voxels see")    \
    C(F32, shadow_aperture, "deg", 5, "shadow_aperture", 0.1, 90, "cone: full opening angle")     \
    C(F32, shadow_softness, "", 1, "shadow_softness", 0, 100, "cone: factor on what it meets")    \
    COLUMNS_DERIVED3_(C, x, y, z, "m", "transform: world position")                               \
    COLUMNS_DERIVED3_(C, dir_x, dir_y, dir_z, "", "transform: unit direction it shines, world")   \
    C(F32, reach, "m", 0, "", 0, 0, "transform: range in use")                                    \
    C(F32, gain, "", 1, "", 0, 0, "animate: factor on the intensity")

// Animations of lights and instances; each adds to transform.offset or multiplies light.gain.
#define ORBIT_COLUMNS(C)                                                                          \
    COLUMNS_VEC3_(C, radius_x, radius_y, radius_z, "m", 1, "radius", 0, 1e4,                      \
                  "half-axes of a slow closed curve about the position")                          \
    C(F32, period, "s", 8, "period", 0.05, 1e5, "time of one round")                              \
    C(F32, phase, "deg", 0, "phase", -36000, 36000, "where it starts")
#define PATH_COLUMNS(C)                                                                           \
    C(POINTS, points, "m", 0, "points", 0, 0, "closed Catmull-Rom curve of offsets")              \
    C(F32, period, "s", 8, "period", 0.05, 1e5, "time of one round")                              \
    C(F32, phase, "deg", 0, "phase", -36000, 36000, "where it starts")
#define FLICKER_COLUMNS(C)                                                                        \
    C(F32, amount, "", 0.3, "amount", 0, 1, "share of the intensity that comes and goes")         \
    C(F32, rate, "Hz", 8, "rate", 0.01, 30, "how fast")
#define PULSE_COLUMNS(C)                                                                          \
    C(F32, amount, "", 0.5, "amount", 0, 1, "share of the intensity that comes and goes")         \
    C(F32, period, "s", 2, "period", 0.05, 1e5, "time of one swell")                              \
    C(F32, phase, "deg", 0, "phase", -36000, 36000, "where it starts")

#define CAMERA_COLUMNS(C)                                                                         \
    C(F32, fov, "deg", 60, "fov", 5, 150, "vertical field of view")                               \
    C(F32, near, "m", 0.1, "near", 0.001, 10, "near plane (there is no far plane)")

// One who walks or flies by input; its camera is the entity's own.
#define WALKER_COLUMNS(C)                                                                         \
    C(F32, speed, "m/s", 3.2, "speed", 0, 100, "walking speed")                                   \
    C(F32, height, "m", 1.75, "height", 0.3, 10, "height of the body, eyes 0.12 below the top")   \
    C(F32, radius, "m", 0.3, "radius", 0.05, 3, "radius of the body")                             \
    C(BOOL, fly, "", 0, "fly", 0, 1, "free flight, no collision")                                 \
    COLUMNS_DERIVED3_(C, velocity_x, velocity_y, velocity_z, "m/s", "walk: velocity")             \
    C(BOOL, grounded, "", 0, "", 0, 1, "walk: stands on something")

// A model file or a generated shape. Filled from [[model]] of level text.
#define MODEL_COLUMNS(C)                                                                          \
    C(U32, model, "", 0, "", 0, 0, "model id of the asset store")                                 \
    C(ENTITY, first_material, "material", 0, "", 0, 0,                                            \
      "its materials are entities with consecutive indices from here, in the file's order")

#define MATERIAL_COLUMNS(C)                                                                       \
    C(F32, albedo_r, "linear", 0.8, "albedo[0]", 0, 1, "diffuse reflectance")                     \
    C(F32, albedo_g, "linear", 0.8, "albedo[1]", 0, 1, "diffuse reflectance")                     \
    C(F32, albedo_b, "linear", 0.8, "albedo[2]", 0, 1, "diffuse reflectance")                     \
    C(F32, specular_r, "linear", 0.04, "specular[0]", 0, 1, "specular colour")                    \
    C(F32, specular_g, "linear", 0.04, "specular[1]", 0, 1, "specular colour")                    \
    C(F32, specular_b, "linear", 0.04, "specular[2]", 0, 1, "specular colour")                    \
    C(F32, power, "", 32, "power", 1, 2048, "specular power (2/a^2 - 2, a = roughness^2)")        \
    C(F32, emissive_r, "linear", 0, "emissive[0]", 0, 1, "emitted colour")                        \
    C(F32, emissive_g, "linear", 0, "emissive[1]", 0, 1, "emitted colour")                        \
    C(F32, emissive_b, "linear", 0, "emissive[2]", 0, 1, "emitted colour")                        \
    C(F32, emissive_strength, "", 1, "emissive_strength", 0, 1e5, "factor on it (radiance)")      \
    C(ENUM, brdf, "lambert phong blinn_phong blinn_phong_normalized", 3, "brdf", 0, 3,            \
      "specular lobe (lambert = none)")                                                           \
    C(ENUM, diffuse, "lambert oren_nayar", 0, "diffuse", 0, 1, "diffuse lobe")                    \
    C(F32, diffuse_roughness, "rad", 0.5, "diffuse_roughness", 0, 1.5, "Oren-Nayar sigma")        \
    C(BOOL, fresnel, "", 0, "fresnel", 0, 1, "Schlick Fresnel on the specular lobe")              \
    C(ENUM, alpha_mode, "opaque mask blend", 0, "alpha_mode", 0, 2, "how alpha is used")          \
    C(F32, alpha_cutoff, "", 0.5, "alpha_cutoff", 0, 1, "mask: below this is a hole")             \
    C(BOOL, double_sided, "", 0, "double_sided", 0, 1, "back faces are drawn")                    \
    C(BOOL, receives_dynamic_light, "", 1, "receives_dynamic_light", 0, 1, "lit by lights")       \
    C(TEXTURE, albedo_texture, "srgb", 0, "albedo_texture", 0, 0, "colour and alpha")             \
    C(TEXTURE, normal_texture, "linear", 0, "normal_texture", 0, 0, "tangent-space normals")      \
    C(TEXTURE, emissive_texture, "srgb", 0, "emissive_texture", 0, 0, "emitted colour")

// The level as a whole.
#define ENVIRONMENT_COLUMNS(C)                                                                    \
    C(F32, ambient_r, "linear", 0.03, "ambient[0]", 0, 100, "light from everywhere")              \
    C(F32, ambient_g, "linear", 0.03, "ambient[1]", 0, 100, "light from everywhere")              \
    C(F32, ambient_b, "linear", 0.03, "ambient[2]", 0, 100, "light from everywhere")              \
    C(F32, ambient_intensity, "", 1, "ambient_intensity", 0, 1000, "factor on it")                \
    C(F32, sky_zenith_r, "linear", 0.02, "sky_zenith[0]", 0, 100, "sky above")                    \
    C(F32, sky_zenith_g, "linear", 0.03, "sky_zenith[1]", 0, 100, "sky above")                    \
    C(F32, sky_zenith_b, "linear", 0.06, "sky_zenith[2]", 0, 100, "sky above")                    \
    C(F32, sky_horizon_r, "linear", 0.05, "sky_horizon[0]", 0, 100, "sky at the horizon")         \
    C(F32, sky_horizon_g, "linear", 0.06, "sky_horizon[1]", 0, 100, "sky at the horizon")         \
    C(F32, sky_horizon_b, "linear", 0.09, "sky_horizon[2]", 0, 100, "sky at the horizon")         \
    C(F32, stars, "", 0, "stars", 0, 10, "brightness of stars")                                   \
    C(F32, exposure, "", 1, "exposure", 0, 1000, "factor before tone mapping")                    \
    C(ENUM, attenuation, "inverse_square window polynomial", 0, "attenuation", 0, 2,              \
      "falloff of point and spot lights")                                                         \
    C(F32, attenuation_constant, "", 1, "attenuation_constant", 0, 1000, "polynomial: kc")        \
    C(F32, attenuation_linear, "1/m", 0, "attenuation_linear", 0, 1000, "polynomial: kl")         \
    C(F32, attenuation_quadratic, "1/m2", 1, "attenuation_quadratic", 0, 1000, "polynomial: kq")  \
    C(F32, shadow_distance, "m", 40, "shadow_distance", 1, 1000, "reach of shadows from the camera") \
    C(U32, shadow_size, "px", 1024, "shadow_size", 64, 4096, "side of the shadow map")            \
    C(F32, gravity, "m/s2", 9.81, "gravity", 0, 100, "pull on walkers")

// How the light manager simplifies (specification of direct lighting, section 5). Pixels are those of
// a picture 720 px high, so that a larger picture shows the same lights.
#define LIGHT_MANAGER_COLUMNS(C)                                                                  \
    C(F32, lod_near, "m", 20, "lod_near", 0, 1e5, "nearer lights have full highlights")           \
    C(F32, lod_far, "m", 40, "lod_far", 0, 1e5, "farther lights have none")                       \
    C(F32, merge_distance, "m", 15, "merge_distance", 0, 1e5, "nearer lights are never merged")   \
    C(F32, merge_error, "", 0.02, "merge_error", 0, 1, "largest predicted error of a merged pair, 1 = white") \
    C(F32, drop_area, "px2", 16, "drop_area", 0, 1e6, "lights that cover less fade out")          \
    C(F32, drop_contribution, "", 0.00390625, "drop_contribution", 0, 1, "fainter lights fade out, 1 = white") \
    C(U32, budget, "", 0, "budget", 0, 4096, "lights that a region of 64 px may have; 0 = any")   \
    C(F32, vertex_lighting, "m", 0, "vertex_lighting", 0, 1e5,                                    \
      "forward paths: surfaces beyond are lit per vertex; 0 = never")

// Global illumination from voxels (specification of voxel GI; what each does: frame/settings.h, whose
// settings of the same names can overrule these while running).
#define GI_COLUMNS(C)                                                                             \
    C(BOOL, enabled, "", 1, "enabled", 0, 1, "light bounces")                                     \
    COLUMNS_VEC3_(C, size_x, size_y, size_z, "m", 0, "size", 0, 1e5, "box that is voxelised; 0 = all") \
    COLUMNS_VEC3_(C, center_x, center_y, center_z, "m", 0, "center", -1e5, 1e5, "its middle, if it has a size") \
    C(ENUM, grid, "32 64 128 256 512", 1, "grid", 0, 4, "voxels along the longest side")          \
    C(U32, cascades, "", 1, "cascades", 1, 3, "nested grids about the camera, each of twice the reach") \
    C(ENUM, format, "half byte", 0, "format", 0, 1, "numbers that radiance is kept in")           \
    C(F32, byte_radiance, "", 4, "byte_radiance", 0.01, 1e5, "format byte: radiance beyond is cut") \
    C(ENUM, voxeliser, "auto raster compute", 0, "voxeliser", 0, 2, "how triangles become voxels") \
    C(BOOL, solid, "", 0, "solid", 0, 1, "closed meshes are filled")                              \
    C(ENUM, policy, "on_change every_frame every_n never", 0, "policy", 0, 3,                     \
      "when moving things are voxelised again")                                                   \
    C(U32, every_n, "ticks", 4, "every_n", 1, 3600, "policy every_n: once in so many ticks")      \
    C(ENUM, cosine, "average weighted", 1, "cosine", 0, 1, "how a voxel's surface faces a light") \
    C(F32, hit, "", 1, "hit", 0, 1, "soft rays: what a voxel in the way takes; 1 = all")          \
    C(ENUM, faces, "shared apart", 0, "faces", 0, 1, "one radiance a voxel, or one a face")       \
    C(ENUM, filter, "directional isotropic", 0, "filter", 0, 1, "how coarser levels are made")    \
    C(U32, bounces, "", 2, "bounces", 1, 2, "1 = light, surface, eye; 2 = one surface more")      \
    C(BOOL, feedback, "", 0, "feedback", 0, 1, "more bounces, one a frame")                       \
    C(ENUM, diffuse, "none cones probes voxels", 1, "diffuse", 0, 3, "where indirect diffuse comes from") \
    C(BOOL, specular, "", 1, "specular", 0, 1, "a cone along the mirrored view")                  \
    C(BOOL, ao, "", 1, "ao", 0, 1, "ambient occlusion by the diffuse cones")                      \
    C(BOOL, cone_shadows, "", 1, "cone_shadows", 0, 1, "lights with screen_shadow cone or volume have it") \
    C(ENUM, resolution, "full half quarter", 0, "resolution", 0, 2, "of the traced picture")      \
    C(BOOL, dither, "", 0, "dither", 0, 1, "neighbouring cones differ, and are smoothed: against bands and blotches")     \
    C(ENUM, mips, "linear nearest", 0, "mips", 0, 1, "cones blend two levels, or take the nearer") \
    C(U32, share, "", 1, "share", 1, 64, "probes, and with feedback the voxels that they light: one in so many anew each tick")       \
    C(F32, probe_spacing, "m", 1, "probe_spacing", 0.05, 100, "probes: distance to the next")     \
    C(F32, strength, "", 1, "strength", 0, 100, "factor on indirect light")                       \
    C(F32, ao_lambda, "1/m", 1, "ao_lambda", 0, 100, "how fast occluders lose weight with distance") \
    C(F32, ao_floor, "", 0, "ao_floor", 0, 1, "what is left in the darkest corner")               \
    C(F32, step_factor, "", 0.5, "step_factor", 0.1, 2.5, "step of a cone / its diameter there")  \
    C(F32, diffuse_aperture, "deg", 60, "diffuse_aperture", 10, 120, "full opening angle of the diffuse cones") \
    C(F32, specular_aperture, "deg", 1, "specular_aperture", 1, 90, "smallest opening angle of specular cones") \
    C(F32, distance, "m", 0, "distance", 0, 1e5, "reach of cones; 0 = through the whole grid")    \
    C(F32, offset, "", 1, "offset", 0, 4, "voxels from a surface to the start of its cones")      \
    C(F32, sky, "", 0, "sky", 0, 100, "factor on the sky that cones reach")                       \
    C(F32, ambient, "", 0, "ambient", 0, 100, "factor on the constant ambient light, which GI replaces")

// Something large that hides what is behind it, for the light manager's culling.
#define OCCLUDER_COLUMNS(C)                                                                       \
    C(ENUM, shape, "box mesh", 0, "shape", 0, 1, "a box about the entity, or its instance's triangles") \
    COLUMNS_VEC3_(C, size_x, size_y, size_z, "m", 1, "size", 0, 1e4, "box: side lengths")         \
    COLUMNS_VEC3_(C, center_x, center_y, center_z, "m", 0, "center", -1e5, 1e5, "box: its middle, in the entity's space")

// A step of the post chain. Those on radiance (fog, heat) come first, then tone mapping, then gamma;
// within these they run by `order`, equal ones as they stand in the level. A level without any has
// tone mapping and gamma.
#define POST_COLUMNS(C)                                                                           \
    C(ENUM, kind, "fog heat tonemap gamma", 0, "kind", 0, 3, "what it does")                      \
    C(I32, order, "", 0, "order", -1000, 1000, "smaller ones run first")                       \
    COLUMNS_VEC3_(C, color_r, color_g, color_b, "linear", 0.5, "color", 0, 100, "fog: its colour") \
    C(F32, density, "1/m", 0.02, "density", 0, 10, "fog: share that a metre takes")               \
    C(F32, start, "m", 0, "start", 0, 1e5, "fog: where it begins")                                \
    C(F32, height, "m", 0, "height", -1e5, 1e5, "fog: level of its thickest layer")               \
    C(F32, falloff, "1/m", 0, "falloff", 0, 100, "fog: how fast it thins out above; 0 = everywhere") \
    C(F32, amount, "px", 2, "amount", 0, 100, "heat: how far the picture shifts, in px of 720")   \
    C(F32, scale, "1/m", 4, "scale", 0.01, 100, "heat: waves per metre")                          \
    C(F32, speed, "Hz", 1, "speed", 0, 100, "heat: how fast they rise")                           \
    C(F32, reach, "m", 3, "reach", 0.01, 1e4, "heat: radius about the entity")                     \
    C(F32, gamma, "", 0, "gamma", 0, 4, "gamma: exponent; 0 = the sRGB curve")

// X(Name, name, COLUMNS, singleton, help)
#define ENGINE_COMPONENTS(X)                                                                      \
    X(Transform, transform, TRANSFORM_COLUMNS, false, "place, rotation and size")                 \
    X(Instance, instance, INSTANCE_COLUMNS, false, "a model placed in the world")                 \
    X(Drawable, drawable, DRAWABLE_COLUMNS, false, "one mesh with one material (derived)")        \
    X(Light, light, LIGHT_COLUMNS, false, "a light")                                              \
    X(Orbit, orbit, ORBIT_COLUMNS, false, "moves on a closed curve")                              \
    X(Path, path, PATH_COLUMNS, false, "moves through points")                                    \
    X(Flicker, flicker, FLICKER_COLUMNS, false, "light burns unsteadily")                         \
    X(Pulse, pulse, PULSE_COLUMNS, false, "light swells and fades")                               \
    X(Camera, camera, CAMERA_COLUMNS, false, "a view")                                            \
    X(Walker, walker, WALKER_COLUMNS, false, "walks or flies by input")                           \
    X(Model, model, MODEL_COLUMNS, false, "a model file or generated shape (derived)")            \
    X(Material, material, MATERIAL_COLUMNS, false, "a surface")                                   \
    X(Environment, environment, ENVIRONMENT_COLUMNS, true, "the level as a whole")                \
    X(LightManager, light_manager, LIGHT_MANAGER_COLUMNS, true, "how lights are simplified")      \
    X(Gi, gi, GI_COLUMNS, true, "global illumination")                                            \
    X(Occluder, occluder, OCCLUDER_COLUMNS, false, "hides lights behind it")                      \
    X(Post, post, POST_COLUMNS, false, "a step of the post chain")

enum {
#define X(Name, name, ...) COMPONENT_##name,
    ENGINE_COMPONENTS(X)
#undef X
        COMPONENT_ENGINE_COUNT
};
#define X(Name, name, COLUMNS, ...) TABLE_STRUCT(Name, COLUMNS)
ENGINE_COMPONENTS(X)
#undef X
#define X(Name, name, ...) extern const ComponentDesc name##_component;
ENGINE_COMPONENTS(X)
#undef X

typedef enum LightKind { LIGHT_POINT, LIGHT_SPOT, LIGHT_DIRECTIONAL } LightKind;
typedef enum VoxelShadow { // the column's words after auto
    VOXEL_SHADOW_NONE,
    VOXEL_SHADOW_MAP,
    VOXEL_SHADOW_RAY,
    VOXEL_SHADOW_SOFT_RAY
} VoxelShadow;
typedef enum ScreenShadow {
    SCREEN_SHADOW_MAP,
    SCREEN_SHADOW_CONE,
    SCREEN_SHADOW_VOLUME
} ScreenShadow;
typedef enum VoxelMode { VOXEL_NONE, VOXEL_STATIC, VOXEL_DYNAMIC } VoxelMode;
typedef enum CollisionMode { COLLISION_NONE, COLLISION_MESH, COLLISION_BOX } CollisionMode;
typedef enum Brdf { BRDF_LAMBERT, BRDF_PHONG, BRDF_BLINN_PHONG, BRDF_BLINN_PHONG_NORMALIZED } Brdf;
typedef enum DiffuseLobe { DIFFUSE_LAMBERT, DIFFUSE_OREN_NAYAR } DiffuseLobe;
typedef enum OccluderShape { OCCLUDER_BOX, OCCLUDER_MESH } OccluderShape;
typedef enum AlphaMode { ALPHA_OPAQUE, ALPHA_MASK, ALPHA_BLEND } AlphaMode;
typedef enum Attenuation {
    ATTENUATION_INVERSE_SQUARE,
    ATTENUATION_WINDOW,
    ATTENUATION_POLYNOMIAL
} Attenuation;

// A row's matrix columns (p00..p23 are consecutive) as one Mat34 and back. `first` is the
// address of the table's pointer to column p00.
static inline void columns_get_mat34(f32 *const *first, u32 row, f32 out[12]) {
    for (u32 i = 0; i < 12; i++) out[i] = first[i][row];
}
static inline void columns_set_mat34(f32 *const *first, u32 row, const f32 in[12]) {
    for (u32 i = 0; i < 12; i++) first[i][row] = in[i];
}

#ifdef __cplusplus
}
#endif
#endif

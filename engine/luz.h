// luz.h: the public face of luz, a small data-oriented engine for scenes with thousands of moving
// lights. A program includes this header and nothing else; it links libluz.a.
//
// --- A whole program ---
//
//   #include "luz.h"
//   int main(void) { return luz_run(&(LuzDesc){.level = "data/levels/cloister.toml"}); }
//
// This opens a window (or, without a display, writes a tour of the level's cameras to out/tour),
// walks, reloads the level when its file is saved, and quits with Escape. H lists the keys.
//
// --- Step by step ---
//
// 1. A component of your own is a list of columns; from it come the table, the level's keys with
//    their checks, saving, hashing and the schema (world/table.h):
//
//        #define SPIN_COLUMNS(C) C(F32, speed, "deg/s", 90, "speed", -720, 720, "how fast it is")
//        TABLE_STRUCT(Spin, SPIN_COLUMNS)                  // struct SpinTable { ... f32 *speed; }
//        COMPONENT_DEFINE(Spin, spin, SPIN_COLUMNS, false, "turns about y")
//
//    In a level:  [[entity]]  instance = { model = "gate" }  spin = { speed = 45 }
//
// 2. A system is a function over whole tables, 60 times a second. It may use + - * / sqrt and the
//    det_ functions (base/maths.h), random numbers from base/random.h and the world's tick; nothing
//    else, and never the clock: so a recording replays bit for bit.
//
//        static void system_spin(SystemContext *context) {
//            SpinTable *spins = (SpinTable *)world_find_table(context->world, "spin");
//            TransformTable *places = WORLD_TABLE(context->world, Transform, transform);
//            for (u32 i = 0; i < spins->table.count; i++) {
//                u32 row = table_row(&places->table, spins->table.entity[i]);
//                if (row == ROW_NONE) continue;
//                places->yaw[row] += spins->speed[i] * TICK_SECONDS;
//                table_touch(&places->table, row);            // what depends on it will follow
//            }
//        }
//
// 3. Name both in the desc and run:
//
//        static const ComponentDesc *const components[] = {&spin_component};
//        static const SystemPlacement systems[] = {{{"spin", "spin", "transform", system_spin}}};
//        LuzDesc desc = {.title = "gates", .level = "gates.toml",
//                        .components = components, .component_count = 1,
//                        .systems = systems, .system_count = 1};
//        LuzOptions options;
//        int code = luz_options(argc, argv, &desc, &options); // --size, --set, --headless, ...
//        return code == LUZ_GO_ON ? luz_run(&desc) : code;
//
// 4. Without a level file, `fill` makes the world from code (world/world.h, asset/asset.h):
//
//        static bool fill(World *world, AssetStore *assets, void *user) {
//            Entity lamp = world_spawn(world);
//            TransformTable *places = WORLD_TABLE(world, Transform, transform);
//            LightTable *lights = WORLD_TABLE(world, Light, light);
//            places->y[table_add(&places->table, lamp)] = 2.0f;
//            lights->intensity[table_add(&lights->table, lamp)] = 40.0f;
//            return true;
//        }
//
//    luz_add_shape and luz_add_model put things into it in one call.
//
// 5. A program that wants its own loop opens a Luz and steps and draws it by hand:
//
//        Luz *luz = luz_open(&desc);
//        for (u32 i = 0; luz && i < 600; i++) luz_step(luz, (Input){.move_z = 127});
//        if (luz) luz_draw_png(luz, NULL, 640, 360, "far.png");
//        luz_close(luz);
//
// --- Defaults: what a zero in LuzDesc (app/app.h: AppDesc) means ---
//
//   title          "luz"                          settings       settings_default(): tiled deferred
//   level          none: `fill` makes the world   width, height  1280 x 720
//   camera         the player's eyes              threads        all cores
//   device         discrete, integrated, then     out_directory  "out"
//                  software                       seconds        never ends by itself
//   validation     off                            hud, key, on_load, user   none
//   fixed_resolution  off: on a software driver a window's resolution follows the frame time
//
// The player is the entity called "spawn", else a new one at the camera "main", else one that sees
// everything from afar. It walks by Input (world/input.h).
//
// --- What luz does not do ---
//
// Sound, networks, skeletal animation, scripting, physics beyond walking and bumping. One level at
// a time, one window, one thread that calls these functions. No Vulkan name reaches a program.
#ifndef LUZ_H
#define LUZ_H
#include "app/app.h"
#include "app/options.h"
#include "base/base.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/jobs.h"
#include "base/log.h"
#include "base/maths.h"
#include "base/random.h"
#include "capture/capture.h"
#include "level/level.h"
#include "render/render.h"
#include "systems/systems.h"
#include "world/world.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef App Luz;
typedef AppDesc LuzDesc;
typedef AppHud LuzHud;
typedef AppOptions LuzOptions;

#define LUZ_GO_ON OPTIONS_GO_ON

// Everything: opens, runs in a window (or headless), closes. Returns the program's exit code:
// 0 well, 1 failed, 2 wrong command line, 3 no device or files that cannot be written (messages on
// stderr).
int luz_run(const LuzDesc *desc);
// Reads the common options (--help lists them) over what is in the desc. LUZ_GO_ON, or the exit
// code of a program that is to end now. `options` must live as long as the desc.
int luz_options(int argc, char **argv, LuzDesc *desc, LuzOptions *options);

// By hand: threads, world and level now, a device at the first picture. NULL with messages.
Luz *luz_open(const LuzDesc *desc);
void luz_close(Luz *luz); // NULL is fine
// Another level. False with messages: the old one stays.
bool luz_load(Luz *luz, const char *path);
// One 60 Hz tick.
void luz_step(Luz *luz, Input input);
// Draws what a camera sees (NULL = the player's eyes). Pixels are valid until the next call of
// luz_draw or luz_step. False with messages.
bool luz_draw(Luz *luz, const char *camera, u32 width_px, u32 height_px, RenderImage *out);
bool luz_draw_png(Luz *luz, const char *camera, u32 width_px, u32 height_px, const char *path);

World *luz_world(Luz *luz); // NULL before a level is loaded; another one after each load
Session *luz_session(Luz *luz);
RenderSettings *luz_settings(Luz *luz);
// A line on the screen for some seconds.
void luz_say(Luz *luz, const char *format, ...) PRINTF_LIKE(2, 3);
// Looks through a camera by name; NULL = the player's eyes.
void luz_set_camera(Luz *luz, const char *name);

// For `fill`: an entity with a transform and an instance of a generated shape in one colour, or of
// a model file (path from the working directory). ENTITY_NONE with messages at a limit.
Entity luz_add_shape(World *world, AssetStore *assets, const char *name, const ShapeDesc *shape,
                     Vec3 position, Vec3 scale, Vec3 color);
Entity luz_add_model(World *world, AssetStore *assets, const char *name, const char *path,
                     Vec3 position, f32 yaw_deg);
Entity luz_add_light(World *world, const char *name, Vec3 position, Vec3 color, f32 intensity_cd);
Entity luz_add_camera(World *world, const char *name, Vec3 position, f32 yaw_deg, f32 pitch_deg);

#ifdef __cplusplus
}
#endif
#endif

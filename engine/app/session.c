// session.c: a level that runs: loading, ticking, packets.
// Data in: a level's path, inputs, views. Data out: a world that advances, frame packets,
// diagnostics. Called by: the window shell, the headless shell, the tools, tests.
// Does not: open a window, know a GPU, print diagnostics. Hot reload: session_reload.c.
#include "session.h"
#include "../base/clock.h"
#include "../base/log.h"
#include "../systems/light_manager.h"
#include "session_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SESSION_FRAME_CAP   GIB(4)
#define SESSION_SCRATCH_CAP GIB(4)
#define SESSION_LEVEL_CAP   GIB(4)

// The camera's default field of view, for standing off from a model.
#define PLAYER_FIT_FOV_DEG 60.0f

// --- creation ---

static bool session_register_systems(Session *session) {
    systems_create(&session->systems);
    for (u32 i = 0; i < session->desc.system_count; i++) {
        const SystemPlacement *placement = &session->desc.systems[i];
        const char *before = placement->before ? placement->before : "walk";
        if (!systems_insert(&session->systems, before, &placement->system)) {
            LOG(WORLD_LIMIT, "system '%s' cannot be placed before '%s'", placement->system.name,
                before);
            return false;
        }
    }
    return true;
}

bool session_create(Session *session, const SessionDesc *desc) {
    *session = (Session){.desc = *desc, .root = {.fd = -1}};
    bool ok = arena_create(&session->frame, "session frame", SESSION_FRAME_CAP) &&
              arena_create(&session->scratch, "session scratch", SESSION_SCRATCH_CAP) &&
              arena_create(&session->level_arena[0], "session level 0", SESSION_LEVEL_CAP) &&
              arena_create(&session->level_arena[1], "session level 1", SESSION_LEVEL_CAP) &&
              session_register_systems(session);
    session->light_manager = light_manager_create();
    if (!ok) session_destroy(session);
    return ok;
}

static void session_forget_refused(Session *session) {
    free(session->refused_stamps);
    session->refused_files = NULL;
    session->refused_stamps = NULL;
    session->refused_count = 0;
}

static void session_unload(Session *session) {
    session_forget_refused(session);
    if (!session->world) return;
    if (session->collision) collision_destroy(session->collision);
    asset_store_destroy(&session->assets);
    world_destroy(session->world);
    free(session->file_stamps);
    file_root_close(&session->root);
    session->collision = NULL;
    session->world = NULL;
    session->file_stamps = NULL;
}

void session_destroy(Session *session) {
    session_unload(session);
    light_manager_destroy(session->light_manager);
    Arena *arenas[] = {&session->frame, &session->scratch, &session->level_arena[0],
                       &session->level_arena[1]};
    for (u32 i = 0; i < COUNT_OF(arenas); i++)
        if (arenas[i]->memory) arena_destroy(arenas[i]);
    *session = (Session){.root = {.fd = -1}};
}

// --- the player ---

static void row_copy(Table *table, u32 to, u32 from) {
    void **columns = table_columns(table);
    for (u32 c = 0; c < table->desc->column_count; c++) {
        u32 *values = columns[c];
        values[to] = values[from];
    }
    table_touch(table, to);
}

// A new entity at a camera; the camera's parent comes along, so a player may ride.
static Entity player_at_camera(World *world, Entity camera) {
    Entity player = world_spawn(world);
    if (player == ENTITY_NONE) return player;
    Table *tables[] = {world->tables[COMPONENT_transform], world->tables[COMPONENT_camera]};
    for (u32 i = 0; i < COUNT_OF(tables); i++) {
        u32 to = table_add(tables[i], player);
        u32 from = camera == ENTITY_NONE ? ROW_NONE : table_row(tables[i], camera);
        if (from != ROW_NONE) row_copy(tables[i], to, from);
    }
    table_add(world->tables[COMPONENT_walker], player);
    return player;
}

// A model without any camera: stand off far enough to see all of it, flying.
static void player_fit(World *world, Entity player) {
    DrawableTable *drawables = WORLD_TABLE(world, Drawable, drawable);
    Vec3 lo = vec3(INFINITY, INFINITY, INFINITY), hi = vec3(-INFINITY, -INFINITY, -INFINITY);
    for (u32 i = 0; i < drawables->table.count; i++) {
        f32 r = drawables->bounds_radius[i];
        if (r < 0.0f) continue;
        lo.x = MIN(lo.x, drawables->bounds_x[i] - r), hi.x = MAX(hi.x, drawables->bounds_x[i] + r);
        lo.y = MIN(lo.y, drawables->bounds_y[i] - r), hi.y = MAX(hi.y, drawables->bounds_y[i] + r);
        lo.z = MIN(lo.z, drawables->bounds_z[i] - r), hi.z = MAX(hi.z, drawables->bounds_z[i] + r);
    }
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    WalkerTable *walkers = WORLD_TABLE(world, Walker, walker);
    u32 t = table_row(&transforms->table, player), w = table_row(&walkers->table, player);
    walkers->fly[w] = 1;
    table_touch(&walkers->table, w);
    if (!(lo.x <= hi.x)) return; // nothing to see: stay at the origin
    Vec3 center = vec3_scale(vec3_add(lo, hi), 0.5f);
    f32 radius = 0.5f * vec3_length(vec3_sub(hi, lo));
    // The sphere of that radius fills the picture's height; corners of boxes seldom reach it.
    f32 distance = 0.85f * radius / det_sin(DEG_TO_RAD(PLAYER_FIT_FOV_DEG) * 0.5f);
    const f32 pitch = -20.0f, yaw = 30.0f;
    f32 level_distance = distance * det_cos(DEG_TO_RAD(pitch));
    transforms->x[t] = center.x + level_distance * det_sin(DEG_TO_RAD(yaw));
    transforms->y[t] = center.y - distance * det_sin(DEG_TO_RAD(pitch));
    transforms->z[t] = center.z + level_distance * det_cos(DEG_TO_RAD(yaw));
    transforms->pitch[t] = pitch;
    transforms->yaw[t] = yaw;
    table_touch(&transforms->table, t);
}

static bool level_has_ground(const World *world) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    for (u32 i = 0; i < instances->table.count; i++)
        if (instances->collision[i] != COLLISION_NONE) return true;
    return false;
}

static void session_place_player(Session *session) {
    World *world = session->world;
    Entity spawn = world_find(world, "spawn");
    if (spawn != ENTITY_NONE) {
        table_add(world->tables[COMPONENT_transform], spawn);
        table_add(world->tables[COMPONENT_camera], spawn);
        table_add(world->tables[COMPONENT_walker], spawn);
        session->player = spawn;
        return;
    }
    const Table *cameras = world->tables[COMPONENT_camera];
    Entity camera = world_find(world, "main");
    if (camera == ENTITY_NONE || table_row(cameras, camera) == ROW_NONE)
        camera = cameras->count > 0 ? cameras->entity[0] : ENTITY_NONE;
    session->player = player_at_camera(world, camera);
    if (session->player == ENTITY_NONE) return;
    WalkerTable *walkers = WORLD_TABLE(world, Walker, walker);
    // A model that somebody just looks at has no floor to stand on.
    if (!level_has_ground(world)) walkers->fly[table_row(&walkers->table, session->player)] = 1;
    if (camera == ENTITY_NONE) {
        session_settle(session); // bounds are derived
        player_fit(world, session->player);
    }
}

// --- loading ---

static SystemContext session_context(Session *session, Input input) {
    return (SystemContext){.world = session->world,
                           .assets = &session->assets,
                           .collision = session->collision,
                           .input = input,
                           .scratch = &session->scratch,
                           .user = session->desc.user};
}

void session_settle(Session *session) {
    SystemContext context = session_context(session, (Input){0});
    systems_settle(&session->systems, &context);
}

static void session_report(Diagnostics *diagnostics, const char *file, const char *text) {
    Diagnostic *item = &diagnostics->items[diagnostics->count++];
    *item = (Diagnostic){.is_error = true, .file = file, .text = text};
    item->hint = item->source = "";
    item->length = 1;
    diagnostics->error_count++;
}

// The level's files as they are now. Those that were watched before keep the stamp from before
// the load, so that an edit during the load is seen at the next poll.
static u64 *session_stamp_files(const Session *session, const FileRoot *root,
                                const LevelInfo *info) {
    u64 *stamps = calloc(MAX(info->file_count, 1), sizeof *stamps);
    LUZ_ASSERT(stamps);
    for (u32 i = 0; i < info->file_count; i++) {
        u32 old = 0, old_count = session->stamps_before_load ? session->level.file_count : 0;
        while (old < old_count && strcmp(session->level.files[old], info->files[i]) != 0) old++;
        stamps[i] = old < old_count ? session->stamps_before_load[old]
                                    : file_root_stamp(root, info->files[i]);
    }
    return stamps;
}

// Everything about a level that is not in use yet.
typedef struct LoadedLevel {
    World *world;
    AssetStore assets;
    FileRoot root;
    LevelInfo info;
} LoadedLevel;

// The arena and the diagnostics of the level to come.
static Arena *session_begin_load(Session *session) {
    Arena *arena = &session->level_arena[1 - session->level_slot];
    session_forget_refused(session); // the names are in this arena
    arena_reset(arena);
    session->diagnostics = ARENA_PUSH(arena, Diagnostics, 1);
    session->diagnostics->arena = arena;
    return arena;
}

// An empty world with all components, and an empty store. `name` is for messages.
static bool loaded_level_create(Session *session, const char *name, LoadedLevel *out) {
    if (!asset_store_create(&out->assets)) {
        session_report(session->diagnostics, name, "out of memory");
        return false;
    }
    if (session->desc.texture_side_cap)
        out->assets.texture_side_cap = session->desc.texture_side_cap;
    out->world = world_create(0);
    for (u32 i = 0; i < session->desc.component_count; i++) {
        if (world_register_component(out->world, session->desc.components[i]) != UINT32_MAX)
            continue;
        session_report(session->diagnostics, name, "too many components");
        return false;
    }
    return true;
}

static void loaded_level_destroy(LoadedLevel *level) {
    if (level->world) world_destroy(level->world);
    if (level->assets.arena.memory) asset_store_destroy(&level->assets);
    file_root_close(&level->root);
}

static bool session_load_fresh(Session *session, const char *root_path, const char *relative,
                               LoadedLevel *out) {
    Arena *arena = session_begin_load(session);
    *out = (LoadedLevel){.root = {.fd = -1}};
    if (!file_root_open(&out->root, root_path)) {
        session_report(session->diagnostics, arena_copy_string(arena, root_path),
                       "the level's directory cannot be opened");
        return false;
    }
    bool ok = loaded_level_create(session, arena_copy_string(arena, relative), out) &&
              level_load(&out->root, relative, out->world, &out->assets, arena, &out->info,
                         session->diagnostics);
    if (!ok) loaded_level_destroy(out);
    return ok;
}

// The loaded level takes the place of the old one.
static void session_adopt(Session *session, const LoadedLevel *fresh, u64 *file_stamps,
                          const char *root_path, const char *relative, const PlayerPlace *place) {
    session_unload(session);
    session->level_slot = 1 - session->level_slot;
    session->world = fresh->world;
    session->assets = fresh->assets;
    session->root = fresh->root;
    session->level = fresh->info;
    session->file_stamps = file_stamps;
    session->packet_stamp = 0;
    session->world->seed = fresh->info.seed;
    snprintf(session->root_path, sizeof session->root_path, "%s", root_path);
    snprintf(session->level_path, sizeof session->level_path, "%s", relative);
    // The new world has a stamp clock of its own.
    memset(session->systems.last_stamp, 0, sizeof session->systems.last_stamp);
    session_place_player(session);
    if (place) player_place_restore(session, place);
    session_settle(session);
    session->collision = collision_create(session->world, &session->assets);
    if (session->desc.on_load) {
        session->desc.on_load(session, session->desc.user);
        session_settle(session); // what it added has derived columns as well
    }
    // The state begins here, not with the first packet: it must not hang on when that is asked for.
    session->packet_camera = ENTITY_NONE;
    light_manager_cut(session->light_manager, session->world, &session->assets, session->player,
                      &session->scratch);
}

bool session_load_below(Session *session, const char *root_path, const char *relative,
                        const PlayerPlace *place) {
    LoadedLevel fresh;
    if (!session_load_fresh(session, root_path, relative, &fresh)) {
        session->refused_files = fresh.info.files;
        session->refused_count = fresh.info.file_count;
        return false;
    }
    u64 *stamps = session_stamp_files(session, &fresh.root, &fresh.info);
    session_adopt(session, &fresh, stamps, root_path, relative, place);
    return true;
}

bool session_fill(Session *session, SessionFill fill, void *user) {
    session_begin_load(session);
    LoadedLevel fresh = {.root = {.fd = -1}};
    bool ok =
        loaded_level_create(session, "(code)", &fresh) && fill(fresh.world, &fresh.assets, user);
    if (!ok) {
        loaded_level_destroy(&fresh);
        return false;
    }
    fresh.info.seed = fresh.world->seed;
    fresh.info.entity_count = fresh.world->entities_alive;
    session_adopt(session, &fresh, NULL, "", "", NULL);
    return true;
}

bool session_load(Session *session, const char *path) {
    char root[sizeof session->root_path], relative[sizeof session->level_path];
    session->stamps_before_load = NULL;
    if (level_find_root(path, root, sizeof root, relative, sizeof relative))
        return session_load_below(session, root, relative, NULL);
    Arena *arena = session_begin_load(session);
    session_report(session->diagnostics, arena_copy_string(arena, path),
                   "no such level, or its path is too long");
    return false;
}

// --- running ---

void session_tick(Session *session, Input input) {
    f64 start = clock_now_ms();
    SystemContext context = session_context(session, input);
    systems_tick(&session->systems, &context);
    // The camera of the last packet; before the first one the player's.
    Entity camera = session->packet_camera ? session->packet_camera : session->player;
    light_manager_tick(session->light_manager, session->world, &session->assets, camera,
                       &session->scratch);
    session->tick_ms = (f32)(clock_now_ms() - start);
}

void session_advance(Session *session, u32 tick_count) {
    for (u32 i = 0; i < tick_count; i++) session_tick(session, (Input){0});
}

void session_frame_begin(Session *session) { arena_reset(&session->frame); }

Entity session_camera(const Session *session, const char *name) {
    if (!session->world) return ENTITY_NONE;
    if (!name) return session->player;
    Entity camera = world_find(session->world, name);
    if (camera == ENTITY_NONE) return ENTITY_NONE;
    bool has_camera = table_row(session->world->tables[COMPONENT_camera], camera) != ROW_NONE;
    return has_camera ? camera : ENTITY_NONE;
}

static void session_report_cameras(const Session *session, const char *wanted) {
    const Table *cameras = session->world->tables[COMPONENT_camera];
    char names[512] = "";
    u64 used = 0;
    for (u32 i = 0; i < cameras->count && used + 1 < sizeof names; i++) {
        const char *name = world_name(session->world, cameras->entity[i]);
        if (!name[0]) continue;
        int put = snprintf(names + used, sizeof names - used, "%s'%s'", used ? ", " : "", name);
        used += put > 0 ? (u64)put : 0;
    }
    LOG(USAGE, "no camera '%s' in '%s'; there %s %s", wanted, session->level_path,
        used ? "are" : "is", used ? names : "none with a name");
}

// Without leaving a trace in the session: what was there before this packet is there afterwards.
static const Packet *build_packet(Session *session, const SessionView *view, Entity *out_camera) {
    if (!session->world) return NULL;
    Entity camera = session_camera(session, view->camera);
    if (camera == ENTITY_NONE && view->camera) {
        session_report_cameras(session, view->camera);
        return NULL;
    }
    if (!light_manager_knows(session->light_manager, session->world, camera))
        light_manager_cut(session->light_manager, session->world, &session->assets, camera,
                          &session->scratch);
    PacketBuildDesc desc = {.world = session->world,
                            .assets = &session->assets,
                            .camera = camera,
                            .settings = view->settings,
                            .width_px = view->width_px,
                            .height_px = view->height_px,
                            .texts = view->texts,
                            .text_count = view->text_count,
                            .last_stamp = session->packet_stamp,
                            .light_manager = session->light_manager,
                            .previous_gi = session->packet_stamp ? &session->packet_gi : NULL,
                            .cold = view->cold};
    // After a cut to another camera nothing has moved on the picture.
    if (session->packet_stamp && session->packet_camera == camera)
        desc.previous_view_projection = session->packet_view_projection.m;
    *out_camera = camera;
    return packet_build(&desc, &session->frame, &session->scratch, &session->packet_times);
}

const Packet *session_packet(Session *session, const SessionView *view) {
    Entity camera;
    const Packet *packet = build_packet(session, view, &camera);
    if (!packet) return NULL;
    // What somebody changes after this packet has a later stamp than what it shows.
    session->packet_camera = camera;
    memcpy(session->packet_view_projection.m, packet->frame.view_projection,
           sizeof session->packet_view_projection.m);
    session->packet_gi = packet->gi;
    session->packet_stamp = session->world->stamp;
    world_advance_stamp(session->world);
    return packet;
}

bool session_packet_split(Session *session, const SessionView *view, const RenderSettings *other,
                          const Packet **a, const Packet **b) {
    SessionView other_view = *view;
    other_view.settings = *other;
    other_view.settings.scale = view->settings.scale;
    // B first: the session remembers A, as if B had never been.
    Entity camera;
    *b = build_packet(session, &other_view, &camera);
    *a = *b ? session_packet(session, view) : NULL;
    return *a != NULL;
}

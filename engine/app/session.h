// session.h: a level that runs, without a window and without a GPU: world, assets, systems,
// collision, files watched. The window shell, the headless shell and the tools share it.
//
//   Session session;
//   session_create(&session, &(SessionDesc){0});
//   if (session_load(&session, "data/levels/cloister.toml")) { session_tick(&session, input); ...
//       const Packet *packet = session_packet(&session, &(SessionView){.camera = "main", ...}); }
#ifndef LUZ_SESSION_H
#define LUZ_SESSION_H
#include "../level/level.h"
#include "../systems/systems.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct Session Session;
typedef struct SystemPlacement { System system; const char *before; } SystemPlacement;
typedef struct SessionDesc {
    const ComponentDesc *const *components; // the game's, registered after the engine's
    u32 component_count;
    const SystemPlacement *systems;         // the game's; before NULL = before "walk"
    u32 system_count;
    void *user;                             // SystemContext.user
    u32 texture_side_cap;                   // 0 = ASSET_TEXTURE_SIDE_CAP
    // Called when a level has been loaded or reloaded (world filled, tick 0, derived columns set).
    void (*on_load)(Session *session, void *user);
} SessionDesc;

// The project's own components and systems, for the toolbox: a game that defines this has its levels
// checked, drawn, recorded and replayed by `luz` as well as by itself (build.sh links all of the
// game but its main.c into `luz`). Weak: without a game its address is NULL.
extern const SessionDesc luz_project __attribute__((weak));

struct Session {
    SessionDesc desc;
    Arena frame, scratch;    // frame: reset by session_packet's caller (session_frame_begin)
    Arena level_arena[2];    // the level in use and the one being loaded
    u32 level_slot;
    World *world;            // NULL until a level is loaded
    AssetStore assets;
    SystemTable systems;
    CollisionWorld *collision;
    LightManagerState *light_manager; // what is merged and dropped: advances with the ticks
    FileRoot root;
    char root_path[1024], level_path[1024]; // level_path is below the root
    LevelInfo level;
    Diagnostics *diagnostics; // of the newest load; LevelInfo and this live in level_arena
    u64 *file_stamps;         // of level.files, for hot reload
    const u64 *stamps_before_load; // private: the same, taken just before a reload
    // Of a reload that failed: its files (in level_arena) and their stamps. A file that a broken
    // level names and the old one did not may be what mends it.
    const char **refused_files;
    u64 *refused_stamps;
    u32 refused_count;
    // Has a walker: entity "spawn", else a new one at camera "main", else at the first camera, else
    // where it sees the whole level (flying).
    Entity player;
    u32 packet_stamp;         // world stamp of the last packet
    Entity packet_camera;     // of the last packet, and its matrix
    Mat4 packet_view_projection;
    PacketGi packet_gi;
    PacketBuildTimes packet_times;
    f32 tick_ms;
};

bool session_create(Session *session, const SessionDesc *desc);
void session_destroy(Session *session);
// Loads a level (.toml, .gltf, .glb) named on the command line. On failure the old level stays and
// session->diagnostics tell why (they are not printed here).
bool session_load(Session *session, const char *path);
// Fills an empty world (all components registered) from code instead of text; the rest goes as for a
// level: player, derived columns, collision, on_load. False if fill says so: the old level stays.
typedef bool (*SessionFill)(World *world, AssetStore *assets, void *user);
bool session_fill(Session *session, SessionFill fill, void *user);
// Loads the same level again if one of its files changed on disk; the player keeps place and view.
// Returns 0 nothing changed, 1 reloaded, -1 errors (the old level stays).
int session_poll_reload(Session *session);
void session_tick(Session *session, Input input);
// Runs n ticks without input.
void session_advance(Session *session, u32 tick_count);

typedef struct SessionView {
    const char *camera;   // name of an entity with a camera; NULL = the player's
    RenderSettings settings;
    u32 width_px, height_px; // internal resolution
    const PacketText2D *texts;
    u32 text_count;
    bool cold; // a picture that is hashed or kept: it must not hang on earlier ones (PACKET_COLD)
} SessionView;
void session_frame_begin(Session *session); // resets the frame arena
// Built in session->frame. NULL if there is no such camera (LOG USAGE lists those there are).
const Packet *session_packet(Session *session, const SessionView *view);
// Two packets of the same moment for a split picture: `a` as session_packet makes it, `b` of the
// other settings but of a's resolution. False if there is no such camera.
bool session_packet_split(Session *session, const SessionView *view, const RenderSettings *other,
                          const Packet **a, const Packet **b);
// The camera entity for a name (NULL = player), or ENTITY_NONE.
Entity session_camera(const Session *session, const char *name);

#ifdef __cplusplus
}
#endif
#endif

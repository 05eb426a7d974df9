// level.h: level text to world, with all diagnostics in one run; world columns to JSON schema.
//
// A level is TOML 1.0 (format: see the header of level_read.c and data/level.schema.json), or a
// .gltf/.glb file, which is a level with one instance and that file's lights and cameras. Loading
// fills a fresh world and a fresh asset store, or reports and leaves both for the caller to throw
// away: a level with an error never loads by half.
#ifndef LUZ_LEVEL_H
#define LUZ_LEVEL_H
#include "../asset/asset.h"
#include "../world/world.h"
#ifdef __cplusplus
extern "C" {
#endif

#define LEVEL_TEXT_SIZE_MAX    MIB(16)
#define LEVEL_ENTITIES_MAX     200000 // after repetition
#define LEVEL_MATERIALS_MAX    256    // material palette of a level (8 bits in the G-buffer)
#define LEVEL_DIAGNOSTICS_MAX  1000   // more are counted, not stored
#define LEVEL_NAME_MAX         127    // bytes of a name
#define LEVEL_POINTS_MAX       65536  // of one list of points
#define LEVEL_PREFAB_DEPTH_MAX 32     // prefabs within prefabs

typedef struct Diagnostic {
    bool is_error; // else a warning
    const char *file;
    u32 line, column;   // 1-based; column counts bytes; 0: the file as a whole
    const char *text;   // "unknown key 'intensty'"
    const char *hint;   // "did you mean 'intensity'?" or ""
    const char *source; // the line's text; of a very long line the part around the place
    u32 caret;          // 0-based byte in source where the marked text begins
    u32 length;         // of the marked text, at least 1
} Diagnostic;

typedef struct Diagnostics {
    Arena *arena; // owner of the texts
    Diagnostic items[LEVEL_DIAGNOSTICS_MAX];
    u32 count, error_count, warning_count; // counts go on beyond the cap
} Diagnostics;

typedef struct LevelInfo {
    char title[128];
    u64 seed;
    u64 content_hash; // of the text and of all files that it loaded
    u32 entity_count;
    // Files that the level was made from, relative to the root: what hot reload watches.
    const char **files;
    u32 file_count;
} LevelInfo;

// Reads path (below root) into a fresh world and store. The world has all components registered
// (a component that is not, is an unknown key). Texts live in arena. False if any error was found
// (diagnostics tell); warnings alone are true. Parts of models become drawable rows, files'
// materials become material entities named "model/material".
bool level_load(const FileRoot *root, const char *path, World *world, AssetStore *store,
                Arena *arena, LevelInfo *info, Diagnostics *diagnostics);

// "file:line:column: error: text\n  source\n  ^~~~ hint\n" of one diagnostic into out; without a
// source line "file:line:column: error: text; hint\n", about a whole file "file: error: text\n".
void diagnostic_format(const Diagnostic *diagnostic, char *out, u64 out_cap);
// All of them to a stream, with a closing line "3 errors, 1 warning".
void diagnostics_print(const Diagnostics *diagnostics, void *file_stream);

// JSON schema (draft 2020-12) of the level format from the registered components. Zero-terminated.
const char *level_schema(const World *world, Arena *arena);
// Level text of a world's entities (comments are lost: fmt edits text in place instead).
const char *level_write(const World *world, const AssetStore *store, Arena *arena);

// The data root for a level named on the command line: the nearest ancestor directory called
// "data" (levels of the project), else the file's own directory. relative gets the path below it.
bool level_find_root(const char *path, char *root, u64 root_cap, char *relative, u64 relative_cap);

// Spawns a model's entity and, right behind it, its materials' (consecutive indices, see the model
// component). name NULL = none.
Entity level_spawn_model(World *world, const AssetStore *store, u32 model, const char *name);
// Adds drawable rows for an entity with an instance row (its model set), as level_load does.
// For games that spawn instances while running.
void level_spawn_drawables(World *world, const AssetStore *store, Entity entity);

#ifdef __cplusplus
}
#endif
#endif

// file.h: whole files in and out, and reading that cannot leave a root directory.
//
// A FileRoot is an open directory. Everything a level, model or capture names is read through
// one: openat2(RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS), regular files only, with a size cap, so
// "../", absolute paths, links that lead out, FIFOs and devices are refused (LOG FILE_*), also on
// kernels without openat2 (then: component-wise openat with O_NOFOLLOW).
#ifndef LUZ_FILE_H
#define LUZ_FILE_H
#include "arena.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct FileRoot {
    int fd;          // -1 = closed
    char path[1024]; // as given, for messages
} FileRoot;

bool file_root_open(FileRoot *root, const char *directory);
void file_root_close(FileRoot *root);
// Reads a file below the root into the arena, with a terminating zero after `size` bytes (not
// counted). False with a log line if it is absent, outside, not regular, or over max_size.
bool file_root_read(const FileRoot *root, const char *path, u64 max_size, Arena *arena, Bytes *out);
// NULL if path names a regular file below the root, else why it cannot be read: "leaves the data
// root", "is a directory", ... No log line.
const char *file_root_problem(const FileRoot *root, const char *path);
// Modification stamp (ns) and size of a file below the root; 0 if absent.
u64 file_root_stamp(const FileRoot *root, const char *path);

// The same for a path the user typed (no root): relative to the working directory.
bool file_read(const char *path, u64 max_size, Arena *arena, Bytes *out);
// Writes to path.tmp, fsyncs, renames: a full disk or a crash never leaves half a file.
bool file_write(const char *path, const void *data, u64 size);
u64 file_stamp(const char *path);
bool file_exists(const char *path);
bool file_make_directories(const char *path);
// Splits "a/b/c.toml" into directory "a/b" ("." if none) and name "c.toml".
void file_split_path(const char *path, char *directory, u64 directory_cap, const char **name);

#ifdef __cplusplus
}
#endif
#endif

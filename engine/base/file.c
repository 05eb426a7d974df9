// file.c: whole files in and out, and a reader that cannot leave its root.
// Data in: paths. Data out: bytes in an arena, or a file on disk that is complete or unchanged.
// Called by: levels, assets, captures, tools. Does not: stream, watch, or map files.
//
// Opening below a root is the kernel's work (openat2 with RESOLVE_BENEATH: no race between check
// and use). Where it is missing (old kernel, strict seccomp) every component is opened with
// O_NOFOLLOW instead; then links are refused altogether, also those that stay inside.
#include "file.h"
#include "log.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// NONBLOCK: opening a FIFO must fail the "regular file" test, not wait for a writer.
#define READ_FLAGS (O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)
#define PATH_CAP   4096 // bytes, PATH_MAX of the kernel

// Cleared at the first ENOSYS or EPERM; tests clear it to take the other way.
bool file_root_use_openat2 = true;

static bool path_is_relative(const char *path) { return path[0] != 0 && path[0] != '/'; }

// ---- below a root ----

// "a/./b/../c" -> "a/c". Sound only where no component is a link, as O_NOFOLLOW makes sure.
// False: it climbs out of the root, or is too long.
static bool path_normalize(const char *path, char *out, u64 out_cap) {
    u64 used = 0;
    while (*path) {
        u64 length = strcspn(path, "/");
        if (length == 2 && path[0] == '.' && path[1] == '.') {
            if (used == 0) return false;
            while (used > 0 && out[used - 1] != '/') used--;
            if (used > 0) used--; // the slash
        } else if (length > 0 && !(length == 1 && path[0] == '.')) {
            if (used + length + 2 > out_cap) return false;
            if (used > 0) out[used++] = '/';
            memcpy(out + used, path, length);
            used += length;
        }
        path += length;
        while (*path == '/') path++;
    }
    out[used] = 0;
    return used > 0;
}

// A file descriptor or -1 with errno; EXDEV and ELOOP mean "outside" (as from openat2).
static int open_beneath_by_component(int root_fd, const char *path) {
    char clean[PATH_CAP];
    if (!path_is_relative(path) || !path_normalize(path, clean, sizeof clean)) {
        errno = EXDEV;
        return -1;
    }
    int directory = root_fd;
    for (char *name = clean;;) {
        char *slash = strchr(name, '/');
        if (slash) *slash = 0;
        int flags = slash ? O_PATH | O_DIRECTORY | O_CLOEXEC : READ_FLAGS;
        int fd = openat(directory, name, flags | O_NOFOLLOW);
        int error = errno;
        // O_DIRECTORY | O_NOFOLLOW on a link says ENOTDIR; both must read as "outside".
        struct stat info;
        if (fd < 0 && error == ENOTDIR &&
            fstatat(directory, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(info.st_mode))
            error = ELOOP;
        if (directory != root_fd) close(directory);
        if (fd < 0 || !slash) {
            errno = error;
            return fd;
        }
        directory = fd;
        name = slash + 1;
    }
}

static int open_beneath(int root_fd, const char *path) {
    if (root_fd < 0) {
        errno = EBADF;
        return -1;
    }
    if (file_root_use_openat2) {
        struct open_how how = {.flags = READ_FLAGS,
                               .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
        long fd;
        u32 tries = 0;
        // EAGAIN: a rename elsewhere raced with the ".." check of the kernel; it asks for a retry.
        do fd = syscall(SYS_openat2, root_fd, path, &how, sizeof how);
        while (fd < 0 && errno == EAGAIN && ++tries < 32);
        if (fd >= 0 || (errno != ENOSYS && errno != EPERM)) return (int)fd;
        file_root_use_openat2 = false;
    }
    return open_beneath_by_component(root_fd, path);
}

bool file_root_open(FileRoot *root, const char *directory) {
    root->fd = -1;
    snprintf(root->path, sizeof root->path, "%s", directory); // for messages: may be cut
    root->fd = open(directory, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (root->fd >= 0) return true;
    LOG(FILE_OPEN, "directory '%s': %s", directory, strerror(errno));
    return false;
}

void file_root_close(FileRoot *root) {
    if (root->fd >= 0) close(root->fd);
    root->fd = -1;
}

// ---- reading ----

static const char *irregular(const struct stat *info) {
    if (S_ISREG(info->st_mode)) return NULL;
    return S_ISDIR(info->st_mode) ? "is a directory" : "is not a regular file";
}

// Reads an open file and closes it. `where` and `path` are for messages.
static bool read_and_close(int fd, const char *where, const char *path, u64 max_size, Arena *arena,
                           Bytes *out) {
    struct stat info;
    u64 mark = arena_mark(arena);
    const char *problem = NULL;
    u64 size = 0;
    if (fstat(fd, &info) != 0) {
        problem = strerror(errno);
    } else if ((problem = irregular(&info))) {
        // nothing to read
    } else if ((u64)info.st_size > max_size || !arena_can_push(arena, (u64)info.st_size + 1, 16)) {
        problem = "is too large";
    } else {
        u64 expected = (u64)info.st_size;
        u8 *data = arena_push(arena, expected + 1, 16);
        // What is appended while we read is left for the next time; what was cut off is missed.
        while (size < expected) {
            ssize_t got = read(fd, data + size, (size_t)(expected - size));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) problem = strerror(errno);
            if (got <= 0) break;
            size += (u64)got;
        }
        data[size] = 0;
        *out = (Bytes){data, size};
    }
    close(fd);
    if (!problem) return true;
    arena_rewind(arena, mark);
    *out = (Bytes){0};
    LOG(FILE_READ, "'%s%s%s' %s", where, where[0] ? "/" : "", path, problem);
    return false;
}

bool file_root_read(const FileRoot *root, const char *path, u64 max_size, Arena *arena,
                    Bytes *out) {
    *out = (Bytes){0};
    int fd = open_beneath(root->fd, path);
    if (fd >= 0) return read_and_close(fd, root->path, path, max_size, arena, out);
    if (errno == EXDEV || errno == ELOOP)
        LOG(FILE_OUTSIDE_ROOT, "'%s' leaves the data root '%s'", path, root->path);
    else
        LOG(FILE_OPEN, "'%s' below '%s': %s", path, root->path, strerror(errno));
    return false;
}

const char *file_root_problem(const FileRoot *root, const char *path) {
    int fd = open_beneath(root->fd, path);
    if (fd < 0 && (errno == EXDEV || errno == ELOOP)) return "leaves the data root";
    if (fd < 0) return errno == ENOENT ? "is not there" : strerror(errno);
    struct stat info;
    const char *problem = fstat(fd, &info) == 0 ? irregular(&info) : strerror(errno);
    close(fd);
    return problem;
}

bool file_read(const char *path, u64 max_size, Arena *arena, Bytes *out) {
    *out = (Bytes){0};
    int fd = open(path, READ_FLAGS);
    if (fd >= 0) return read_and_close(fd, "", path, max_size, arena, out);
    LOG(FILE_OPEN, "'%s': %s", path, strerror(errno));
    return false;
}

// Time and size in one number: an edit within the clock's resolution shows by its size.
static u64 stamp_of(const struct stat *info) {
    if (!S_ISREG(info->st_mode)) return 0;
    u64 ns = (u64)info->st_mtim.tv_sec * 1000000000ull + (u64)info->st_mtim.tv_nsec;
    u64 stamp = ns + (u64)info->st_size * 0x9E3779B97F4A7C15ull;
    return stamp ? stamp : 1;
}

// No log line: callers poll, and an absent file is an answer.
u64 file_root_stamp(const FileRoot *root, const char *path) {
    int fd = open_beneath(root->fd, path);
    if (fd < 0) return 0;
    struct stat info;
    u64 stamp = fstat(fd, &info) == 0 ? stamp_of(&info) : 0;
    close(fd);
    return stamp;
}

u64 file_stamp(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 ? stamp_of(&info) : 0;
}

bool file_exists(const char *path) { return access(path, F_OK) == 0; }

// ---- writing ----

static bool write_all(int fd, const u8 *data, u64 size) {
    for (u64 written = 0; written < size;) {
        ssize_t put = write(fd, data + written, (size_t)MIN(size - written, GIB(1)));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return false;
        written += (u64)put;
    }
    return true;
}

// A device or a pipe (/dev/null, /dev/stdout, process substitution) is written to in place:
// renaming a file over it would replace it.
static bool write_in_place(const char *path, const void *data, u64 size) {
    int fd = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd < 0) return false;
    bool ok = write_all(fd, data, size);
    int error = errno;
    close(fd);
    errno = error;
    return ok;
}

// The new file appears under its name complete, with the old one's permissions, or not at all.
static bool write_by_rename(const char *path, const struct stat *old, const void *data, u64 size) {
    char temporary[PATH_CAP];
    if (snprintf(temporary, sizeof temporary, "%s.tmp", path) >= (int)sizeof temporary) {
        errno = ENAMETOOLONG;
        return false;
    }
    unlink(temporary); // a rest of a crash; EXCL then keeps us from writing through a link
    int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) return false;
    bool ok = (!old || fchmod(fd, old->st_mode & 07777) == 0) && write_all(fd, data, size) &&
              fsync(fd) == 0;
    int error = errno;
    if (close(fd) != 0 && ok) {
        ok = false;
        error = errno;
    }
    if (ok && rename(temporary, path) != 0) {
        ok = false;
        error = errno;
    }
    if (!ok) unlink(temporary);
    errno = error;
    return ok;
}

bool file_write(const char *path, const void *data, u64 size) {
    struct stat old;
    bool exists = stat(path, &old) == 0, ok;
    // A link is followed once here: the file behind it is replaced, the link stays.
    char *target = exists ? realpath(path, NULL) : NULL;
    if (exists && S_ISDIR(old.st_mode)) {
        errno = EISDIR;
        ok = false;
    } else if (exists && !S_ISREG(old.st_mode)) {
        ok = write_in_place(path, data, size);
    } else {
        ok = write_by_rename(target ? target : path, exists ? &old : NULL, data, size);
    }
    if (!ok && errno == ENOENT)
        LOG(FILE_WRITE, "'%s': its directory is not there", path);
    else if (!ok)
        LOG(FILE_WRITE, "'%s': %s", path, strerror(errno));
    free(target);
    return ok;
}

bool file_make_directories(const char *path) {
    char part[PATH_CAP];
    u64 length = strlen(path);
    bool ok = length > 0 && length < sizeof part;
    if (!ok) errno = ENAMETOOLONG;
    // Every prefix that ends before a slash, then the whole.
    for (u64 i = 1; ok && i <= length; i++) {
        if (path[i] != '/' && path[i] != 0) continue;
        memcpy(part, path, i);
        part[i] = 0;
        ok = mkdir(part, 0777) == 0 || errno == EEXIST;
    }
    struct stat info; // EEXIST may have meant a file
    if (ok && !(stat(path, &info) == 0 && S_ISDIR(info.st_mode))) {
        errno = ENOTDIR;
        ok = false;
    }
    if (!ok) LOG(FILE_WRITE, "directory '%s': %s", path, strerror(errno));
    return ok;
}

void file_split_path(const char *path, char *directory, u64 directory_cap, const char **name) {
    LUZ_ASSERT(directory_cap >= 2);
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    u64 length = slash ? (u64)(slash - path) : 0;
    if (slash == path) length = 1; // "/c.toml" lies in "/"
    // A directory that does not fit becomes "": opening it fails, which the caller reports.
    if (!slash)
        snprintf(directory, (size_t)directory_cap, ".");
    else if (length < directory_cap)
        snprintf(directory, (size_t)directory_cap, "%.*s", (int)length, path);
    else
        directory[0] = 0;
}

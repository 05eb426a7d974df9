// base_file.c: reading below a root refuses what leaves it; writing is all or nothing.
// Every refusal is tried with the kernel's openat2 and with the way around it.
#include "../test.h"
#include "../../engine/base/file.h"
#include "../../engine/base/log.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern bool file_root_use_openat2; // of file.c, here to try both ways

typedef struct Fixture {
    Arena arena;
    FileRoot root; // TEMP/root
} Fixture;

// TEMP/secret, and below TEMP/root: plain, empty, sub/deep/leaf, links in and out, a FIFO.
static void fixture_create(Fixture *f) {
    char path[1200];
    assert_true(arena_create(&f->arena, "files", MIB(16)));
    snprintf(path, sizeof path, "%s/root/sub/deep", test_temp_dir());
    assert_true(file_make_directories(path));
    assert_true(file_write(test_temp_path("secret"), "secret", 6));
    assert_true(file_write(test_temp_path("root/plain"), "plain text", 10));
    assert_true(file_write(test_temp_path("root/empty"), "", 0));
    assert_true(file_write(test_temp_path("root/sub/deep/leaf"), "leaf", 4));
    assert_int_equal(symlink("../secret", test_temp_path("root/link_out")), 0);
    assert_int_equal(symlink("/etc/passwd", test_temp_path("root/link_absolute")), 0);
    assert_int_equal(symlink("..", test_temp_path("root/directory_out")), 0);
    assert_int_equal(symlink("plain", test_temp_path("root/link_in")), 0);
    assert_int_equal(symlink("loop", test_temp_path("root/loop")), 0);
    assert_int_equal(symlink("sub", test_temp_path("root/directory_in")), 0);
    assert_int_equal(mkfifo(test_temp_path("root/fifo"), 0600), 0);
    assert_true(file_root_open(&f->root, test_temp_path("root")));
    log_set_level(LOG_SEVERITY_NONE);
}

static void fixture_destroy(Fixture *f) {
    file_root_close(&f->root);
    arena_destroy(&f->arena);
}

static void assert_reads(Fixture *f, const char *path, const char *text) {
    Bytes bytes;
    assert_true(file_root_read(&f->root, path, KIB(1), &f->arena, &bytes));
    assert_int_equal(bytes.size, strlen(text));
    assert_string_equal((const char *)bytes.data, text); // there is a zero behind it
    assert_int_not_equal(file_root_stamp(&f->root, path), 0);
}

static void assert_refuses(Fixture *f, const char *path, LogId id) {
    Bytes bytes = {"x", 1};
    u64 used = f->arena.used;
    log_reset_counts();
    assert_false(file_root_read(&f->root, path, KIB(1), &f->arena, &bytes));
    if (log_count(id) != 1) fail_msg("'%s' did not log %s", path, log_id_name(id));
    assert_null(bytes.data);
    assert_int_equal(f->arena.used, used);
    assert_int_equal(file_root_stamp(&f->root, path), 0);
    assert_int_equal(log_count(id), 1); // a stamp is silent
}

static void try_everything(bool use_openat2) {
    Fixture f;
    fixture_create(&f);
    file_root_use_openat2 = use_openat2;
    assert_reads(&f, "plain", "plain text");
    assert_reads(&f, "empty", "");
    assert_reads(&f, "sub/deep/leaf", "leaf");
    assert_reads(&f, "./sub//deep/./leaf", "leaf");
    assert_reads(&f, "sub/../plain", "plain text");

    assert_refuses(&f, "../secret", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "sub/../../secret", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "sub/deep/../../../secret", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "..", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "/etc/passwd", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "link_out", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "link_absolute", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "directory_out/secret", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "loop", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "fifo", LOG_FILE_READ); // and does not wait for a writer
    assert_refuses(&f, "sub", LOG_FILE_READ);
    assert_refuses(&f, "absent", LOG_FILE_OPEN);
    assert_refuses(&f, "absent/leaf", LOG_FILE_OPEN);
    assert_refuses(&f, "plain/leaf", LOG_FILE_OPEN);
    fixture_destroy(&f);
}

TEST(file, root_refuses_what_leaves_it) {
    file_root_use_openat2 = true;
    try_everything(true);
}
TEST(file, root_refuses_what_leaves_it_without_openat2) { try_everything(false); }

TEST(file, links_that_stay_inside) {
    Fixture f;
    fixture_create(&f);
    assert_reads(&f, "plain", "plain text"); // finds out whether openat2 works here
    if (file_root_use_openat2) {
        assert_reads(&f, "link_in", "plain text");
        assert_reads(&f, "directory_in/deep/leaf", "leaf");
    }
    file_root_use_openat2 = false; // then links are refused altogether
    assert_refuses(&f, "link_in", LOG_FILE_OUTSIDE_ROOT);
    assert_refuses(&f, "directory_in/deep/leaf", LOG_FILE_OUTSIDE_ROOT);
    fixture_destroy(&f);
}

TEST(file, magic_links_are_refused) {
    FileRoot root;
    Arena arena;
    Bytes bytes;
    assert_true(arena_create(&arena, "files", MIB(1)));
    assert_true(file_root_open(&root, "/proc/self"));
    log_set_level(LOG_SEVERITY_NONE);
    assert_false(file_root_read(&root, "exe", GIB(1), &arena, &bytes));
    assert_false(file_root_read(&root, "cwd/build.sh", GIB(1), &arena, &bytes));
    assert_int_equal(log_count(LOG_FILE_OUTSIDE_ROOT), 2);
    file_root_close(&root);
    arena_destroy(&arena);
}

TEST(file, size_limits) {
    Fixture f;
    Bytes bytes;
    fixture_create(&f);
    log_reset_counts();
    assert_true(file_root_read(&f.root, "plain", 10, &f.arena, &bytes));
    assert_false(file_root_read(&f.root, "plain", 9, &f.arena, &bytes));
    assert_false(file_read(test_temp_path("root/plain"), 9, &f.arena, &bytes));
    assert_int_equal(truncate(test_temp_path("root/empty"), 1ll << 40), 0);       // sparse, 1 TiB
    assert_false(file_root_read(&f.root, "empty", UINT64_MAX, &f.arena, &bytes)); // arena too small
    assert_int_equal(log_count(LOG_FILE_READ), 3);
    fixture_destroy(&f);
}

TEST(file, a_closed_root_reads_nothing) {
    Fixture f;
    fixture_create(&f);
    file_root_close(&f.root);
    file_root_close(&f.root); // harmless
    assert_int_equal(f.root.fd, -1);
    assert_refuses(&f, "plain", LOG_FILE_OPEN);
    log_reset_counts();
    assert_false(file_root_open(&f.root, test_temp_path("nowhere")));
    assert_false(file_root_open(&f.root, test_temp_path("secret"))); // no directory
    assert_int_equal(log_count(LOG_FILE_OPEN), 2);
    arena_destroy(&f.arena);
}

TEST(file, stamp_follows_changes) {
    Fixture f;
    fixture_create(&f);
    const char *path = test_temp_path("root/plain");
    u64 before = file_stamp(path);
    assert_true(before == file_root_stamp(&f.root, "plain"));
    assert_true(file_write(path, "plain text!", 11));
    assert_true(file_stamp(path) != before);
    struct timespec times[2] = {{1, 0}, {1, 5}}; // same size, other time
    before = file_stamp(path);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    assert_true(file_stamp(path) != before);
    assert_int_equal(file_stamp(test_temp_path("absent")), 0);
    assert_int_equal(file_stamp(test_temp_dir()), 0);
    fixture_destroy(&f);
}

static void assert_content(Arena *arena, const char *path, const char *text) {
    Bytes bytes;
    assert_true(file_read(path, KIB(64), arena, &bytes));
    assert_string_equal((const char *)bytes.data, text);
}

TEST(file, write_replaces_atomically) {
    Fixture f;
    fixture_create(&f);
    const char *path = test_temp_path("root/plain");
    struct stat before, after;
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(stat(path, &before), 0);
    int old = open(path, O_RDONLY | O_CLOEXEC);
    assert_true(file_write(path, "new", 3));
    assert_content(&f.arena, path, "new");
    assert_int_equal(stat(path, &after), 0);
    assert_int_equal(after.st_mode, before.st_mode);
    assert_true(after.st_ino != before.st_ino); // another file: readers of the old one keep it
    char text[16] = "";
    assert_int_equal(read(old, text, sizeof text), 10);
    close(old);
    assert_false(file_exists(test_temp_path("root/plain.tmp")));
    // A rest of a crash, even a link that leads elsewhere, does no harm.
    assert_int_equal(symlink("../secret", test_temp_path("root/plain.tmp")), 0);
    assert_true(file_write(path, "newer", 5));
    assert_content(&f.arena, path, "newer");
    assert_content(&f.arena, test_temp_path("secret"), "secret");
    // A link as the target stays a link; what it names is replaced.
    assert_true(file_write(test_temp_path("root/link_in"), "by link", 7));
    assert_content(&f.arena, path, "by link");
    struct stat link;
    assert_int_equal(lstat(test_temp_path("root/link_in"), &link), 0);
    assert_true(S_ISLNK(link.st_mode));
    fixture_destroy(&f);
}

TEST(file, write_failures_leave_the_old_file) {
    Fixture f;
    fixture_create(&f);
    log_reset_counts();
    assert_false(file_write(test_temp_path("nowhere/file"), "x", 1));
    assert_false(file_write(test_temp_path("root/sub"), "x", 1)); // a directory
    assert_int_equal(log_count(LOG_FILE_WRITE), 2);
    // The temporary name is taken by a directory: nothing can be written, the old text stays.
    assert_int_equal(mkdir(test_temp_path("root/plain.tmp"), 0700), 0);
    assert_false(file_write(test_temp_path("root/plain"), "x", 1));
    assert_content(&f.arena, test_temp_path("root/plain"), "plain text");
    // Devices are written to, not replaced.
    struct stat null;
    assert_true(file_write("/dev/null", "x", 1));
    assert_int_equal(stat("/dev/null", &null), 0);
    assert_true(S_ISCHR(null.st_mode));
    // A full disk.
    if (access("/dev/full", W_OK) == 0) assert_false(file_write("/dev/full", "x", 1));
    fixture_destroy(&f);
}

TEST(file, permissions_are_respected) {
    if (geteuid() == 0) TEST_SKIP("root may do everything");
    Fixture f;
    fixture_create(&f);
    assert_int_equal(chmod(test_temp_path("root/plain"), 0), 0);
    assert_refuses(&f, "plain", LOG_FILE_OPEN);
    assert_int_equal(chmod(test_temp_path("root/sub"), 0500), 0);
    assert_false(file_write(test_temp_path("root/sub/new"), "x", 1));
    assert_false(file_exists(test_temp_path("root/sub/new")));
    fixture_destroy(&f);
}

TEST(file, makes_directories) {
    log_set_level(LOG_SEVERITY_NONE);
    assert_true(file_make_directories(test_temp_path("a/b/c")));
    assert_true(file_make_directories(test_temp_path("a/b/c/")));
    assert_true(file_exists(test_temp_path("a/b/c")));
    assert_true(file_write(test_temp_path("a/file"), "", 0));
    assert_false(file_make_directories(test_temp_path("a/file")));
    assert_false(file_make_directories(test_temp_path("a/file/below")));
    assert_false(file_make_directories(""));
}

TEST(file, splits_paths) {
    static const struct {
        const char *path, *directory, *name;
    } cases[] = {{"a/b/c.toml", "a/b", "c.toml"},
                 {"c.toml", ".", "c.toml"},
                 {"/c", "/", "c"},
                 {"a/", "a", ""},
                 {"", ".", ""},
                 {"/a/b", "/a", "b"}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        char directory[16];
        const char *name;
        file_split_path(cases[i].path, directory, sizeof directory, &name);
        assert_string_equal(directory, cases[i].directory);
        assert_string_equal(name, cases[i].name);
    }
    char tiny[3];
    const char *name;
    file_split_path("long/name", tiny, sizeof tiny, &name);
    assert_string_equal(tiny, ""); // rather nothing than another directory
    assert_string_equal(name, "name");
}

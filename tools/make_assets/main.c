// make_assets: writes every model of the demo levels as .glb files.
//
// Data in: nothing but the command line. Data out: DIR/NAME.glb, a line per model. Run by hand
// when a model changes; the files are kept with the levels, so a build never needs this program.
// The same source gives the same bytes in every run. It does not write levels.
//
//   cc -std=c17 -D_GNU_SOURCE -O2 -ffp-contract=off tools/make_assets/*.c -lm -o make_assets
#include "glb.h"

#include <stdio.h>
#include <string.h>

static int print_help(int status) {
    printf("usage: make_assets [--out DIR] [--only NAME] [--textures DIR] [--help]\n"
           "  --out DIR       folder of the .glb files (default data/models)\n"
           "  --only NAME     make one model\n"
           "  --textures DIR  write the painted textures as images instead, to look at\n"
           "models:");
    for (const ModelRow *row = MODEL_TABLE; row->name; row++) printf(" %s", row->name);
    printf("\n");
    return status;
}

int main(int argc, char **argv) {
    const char *out = "data/models", *only = NULL, *textures = NULL;
    for (int i = 1; i < argc; i++) {
        const char **value = !strcmp(argv[i], "--out")        ? &out
                             : !strcmp(argv[i], "--only")     ? &only
                             : !strcmp(argv[i], "--textures") ? &textures
                                                              : NULL;
        if (!value || i + 1 >= argc) return print_help(strcmp(argv[i], "--help") ? 2 : 0);
        *value = argv[++i];
    }
    if (textures) {
        bool ok = texture_dump(textures);
        texture_free_all();
        if (!ok) fprintf(stderr, "make_assets: cannot write into %s\n", textures);
        return ok ? 0 : 1;
    }
    size_t total = 0;
    int made = 0;
    for (const ModelRow *row = MODEL_TABLE; row->name; row++) {
        if (only && strcmp(only, row->name)) continue;
        Model m = {0};
        row->make(&m);
        char path[1024];
        snprintf(path, sizeof path, "%s/%s.glb", out, row->name);
        size_t size = glb_write(&m, path);
        if (!size) {
            fprintf(stderr, "make_assets: cannot write %s\n", path);
            return 1;
        }
        printf("%-16s %6u triangles %8zu bytes\n", row->name, model_triangle_count(&m), size);
        fflush(stdout);
        total += size;
        made++;
        model_free(&m);
    }
    texture_free_all();
    if (!made) {
        fprintf(stderr, "make_assets: no model is called %s\n", only ? only : "");
        return 2;
    }
    printf("%-16s %6d models    %8zu bytes\n", "total", made, total);
    return 0;
}

// split.c: the two ways of `--split` as settings, pictures and numbers.
// Data in: options, two packets of one view. Data out: a joint picture, differences. Called by:
// shot.c, replay_frame.c. Does not: make packets, or draw side by side (render/split.c).
#include "split.h"
#include <stdio.h>
#include <string.h>

static bool parse_mode(const char *text, u32 *out) {
    const char *word = SPLIT_MODE_WORDS;
    for (u32 i = 0; i < SPLIT_MODE_COUNT; i++) {
        u64 length = strcspn(word, " ");
        if (strlen(text) == length && memcmp(text, word, length) == 0) {
            *out = i;
            return true;
        }
        word += length + 1;
    }
    return false;
}

bool split_begin(Split *split, const SplitOptions *options, const RenderSettings *base,
                 const char *command) {
    *split = (Split){0};
    split->view = (SplitView){
        .at = (f32)options->at, .label_a = split->labels[0], .label_b = split->labels[1]};
    if (!(options->at >= 0.0 && options->at <= 1.0)) {
        tool_fail(0, command, "--split-at goes from 0 to 1, not %g", options->at);
        return false;
    }
    if (options->mode && !parse_mode(options->mode, &split->view.mode)) {
        tool_fail(0, command, "--split-mode is one of: " SPLIT_MODE_WORDS "; not '%s'",
                  options->mode);
        return false;
    }
    for (u32 i = 0; i < 2; i++) {
        split->settings[i] = *base;
        snprintf(split->labels[i], sizeof split->labels[i], "%s", options->ways[i]);
        if (!settings_set_list(&split->settings[i], options->ways[i])) return false;
    }
    if (split->settings[0].scale != base->scale || split->settings[1].scale != base->scale) {
        tool_fail(0, command, "both ways have one size: give scale with --set, not in --split");
        return false;
    }
    return true;
}

bool split_draw(Split *split, Renderer *renderer, const Packet *a, const Packet *b, Arena *arena) {
    if (!renderer_render_image(renderer, a, arena, &split->ways[0]) ||
        !renderer_render_image(renderer, b, arena, &split->ways[1]) ||
        !renderer_render_split(renderer, a, b, &split->view, arena, &split->image))
        return false;
    split->difference = image_compare(split->ways[0].rgba, split->ways[1].rgba,
                                      split->image.width_px, split->image.height_px, arena);
    return true;
}

void split_print(const Split *split) {
    const ImageDifference *d = &split->difference;
    printf("A %s, image hash %016llx\nB %s, image hash %016llx\n", split->labels[0],
           (unsigned long long)split->ways[0].hash, split->labels[1],
           (unsigned long long)split->ways[1].hash);
    printf("difference: max %u of 255 at %u,%u, mean %.4f, %u pixels, SSIM %.6f, FLIP %.6f\n",
           d->max, d->max_x, d->max_y, d->mean, d->different_pixels, d->ssim, d->flip);
}

void split_json(const Split *split, Json *json) {
    const ImageDifference *d = &split->difference;
    json_open_object(json, "split");
    json_text(json, "a", split->labels[0]);
    json_text(json, "b", split->labels[1]);
    json_hash(json, "a_hash", split->ways[0].hash);
    json_hash(json, "b_hash", split->ways[1].hash);
    json_u64(json, "max", d->max);
    json_u64(json, "max_x", d->max_x);
    json_u64(json, "max_y", d->max_y);
    json_f64(json, "mean", d->mean);
    json_u64(json, "different_pixels", d->different_pixels);
    json_f64(json, "ssim", d->ssim);
    json_f64(json, "flip", d->flip);
    json_close(json);
}

// hud.c: title, hints and a line of numbers.
//
// Data in: what the engine tells about the last second. Data out: lines of text in window pixels.
// Called by: the engine, once a frame. Does not: change anything.
#include "hud.h"

#define MARGIN_PX     14.0f
#define TITLE_SIZE_PX 39.0f // texts are sharp at multiples of 13
#define TEXT_SIZE_PX  13.0f
#define LINE_PX       18.0f

#define WARM_WHITE 0xD8ECFFu // RGB, red in the low byte

// Seconds: the title fades away first, then the hints.
#define TITLE_UNTIL 4.0f
#define HINTS_UNTIL 9.0f
#define FADE        1.5f

static u32 faded(u32 rgb, f32 seconds, f32 until) {
    f32 alpha = f32_saturate((until + FADE - seconds) / FADE);
    return rgb | (u32)(alpha * 255.0f) << 24;
}

u32 hud_lines(const LuzHud *hud, PacketText2D *out, u32 cap, void *user) {
    (void)user;
    if (cap < 4) return 0;
    u32 count = 0;
    f32 seconds = (f32)hud->seconds, height = (f32)hud->height_px;
    if (seconds < TITLE_UNTIL + FADE)
        out[count++] =
            (PacketText2D){MARGIN_PX, height * 0.16f, TITLE_SIZE_PX,
                           faded(WARM_WHITE, seconds, TITLE_UNTIL), hud->session->level.title};
    if (seconds < HINTS_UNTIL + FADE) {
        u32 color = faded(WARM_WHITE, seconds, HINTS_UNTIL);
        f32 y = height * 0.16f + TITLE_SIZE_PX + LINE_PX;
        out[count++] = (PacketText2D){MARGIN_PX, y, TEXT_SIZE_PX, color,
                                      "W A S D and the mouse to walk, shift to run"};
        out[count++] =
            (PacketText2D){MARGIN_PX, y + LINE_PX, TEXT_SIZE_PX, color,
                           "1 to 8 to light in another way, T for a tour, H for all keys"};
    }
    char path[32];
    settings_word("path", hud->settings->path, path, sizeof path);
    const char *line = arena_format(hud->arena, "%.0f fps  %s  %u of %u lights", (f64)hud->fps,
                                    path, hud->counts->lights_shaded, hud->counts->lights_total);
    out[count++] = (PacketText2D){MARGIN_PX, height - MARGIN_PX - TEXT_SIZE_PX, TEXT_SIZE_PX,
                                  WARM_WHITE | 0xB0u << 24, line};
    return count;
}

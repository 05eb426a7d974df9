// debug_ui.h: texts and the debug panel over the window, behind a C face (Dear ImGui inside).
//
// Use: debug_ui_create after the window's own callbacks are set (they are chained);
// debug_ui_upload for each new renderer; then each frame debug_ui_frame, whose overlay goes to
// renderer_draw. The panel reads and changes an App's settings, camera and pause; nothing else.
#ifndef LUZ_DEBUG_UI_H
#define LUZ_DEBUG_UI_H
#include "app.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct DebugUi DebugUi;
struct GLFWwindow;

DebugUi *debug_ui_create(struct GLFWwindow *window);
void debug_ui_destroy(DebugUi *ui); // NULL is fine
// The font atlas.
bool debug_ui_upload(DebugUi *ui, Renderer *renderer);
// The overlay of this frame: app_texts, and the panel if app->panel. Valid until the next call.
// pointer: the mouse is a pointer, not a look.
const Overlay *debug_ui_frame(DebugUi *ui, App *app, u32 width_px, u32 height_px, bool pointer);
// The panel is using them: not for the game.
bool debug_ui_wants_mouse(const DebugUi *ui);
bool debug_ui_wants_keyboard(const DebugUi *ui);

#ifdef __cplusplus
}
#endif
#endif

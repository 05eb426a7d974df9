// hud.h: the few words over the picture: a title that fades, hints, and what is being drawn.
#ifndef GAME_HUD_H
#define GAME_HUD_H
#include "../engine/luz.h"

u32 hud_lines(const LuzHud *hud, PacketText2D *out, u32 cap, void *user);
#endif

// reference.h: a level's path-traced picture, as `luz reference` and the rows of `luz bench` make
// it.
#ifndef LUZ_TOOL_REFERENCE_H
#define LUZ_TOOL_REFERENCE_H
#include "../engine/app/session.h"
#include "../engine/render/render.h"
#include "trace.h"

// Settings under which a packet holds the whole level: nothing culled, merged, dropped or
// simplified.
void reference_settings(RenderSettings *settings);
// What of the packet's instances light and shadows meet: TRACE_* by voxel_mode and casts_shadow. In
// the arena.
u8 *reference_flags(const World *world, const Packet *packet, Arena *arena);
// The picture of a view at the session's tick; pixels, triangles and all else lie in the arena.
// Resets the session's frame arena. False if there is no such camera, or too many triangles (LOG).
bool reference_draw(Session *session, const SessionView *view, const TraceOptions *options,
                    TraceProgress progress, void *user, Arena *arena, RenderImage *out);
#endif

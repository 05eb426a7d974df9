// tour.h: the component `tour`: a camera that visits all named cameras of the level, in name order.
//
// tour_on_load gives every level one, called TOUR_CAMERA, unless its author wrote an own:
//     [[entity]]  name = "tour"  camera = {}  transform = {}  tour = { leg = 6, stay = 2 }
#ifndef GAME_TOUR_H
#define GAME_TOUR_H
#include "../engine/luz.h"

#define TOUR_CAMERA "tour"

#define TOUR_COLUMNS(C)                                                                            \
    C(F32, leg, "s", 5, "leg", 0.1, 1000, "time from one camera to the next")                      \
    C(F32, stay, "s", 2, "stay", 0, 1000, "time at each camera")

TABLE_STRUCT(Tour, TOUR_COLUMNS)
extern const ComponentDesc tour_component;

void system_tour(SystemContext *context);
void tour_on_load(Session *session);
#endif

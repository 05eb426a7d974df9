// The makers of the models, one line each; model.c lists them in its table. Each fills an empty
// Model, in metres, y up, origin where the level places it.
#ifndef MAKE_ASSETS_MODELS_H
#define MAKE_ASSETS_MODELS_H

#include "model.h"

// model_walk.c: pieces of the covered walk; x along the walk, z = 0 at the garden, outwards +z
void model_make_bay(Model *m);
void model_make_bay_open(Model *m);
void model_make_corner(Model *m);

// model_wall.c: outer wall pieces of 3 m at z = 4 of a bay
void model_make_wall(Model *m);
void model_make_wall_window(Model *m);
void model_make_wall_door(Model *m);

// model_chapter.c, model_facade.c
void model_make_chapter_house(Model *m);
void model_make_facade(Model *m);

// model_garden.c, model_surroundings.c
void model_make_garden(Model *m);
void model_make_surroundings(Model *m);
void model_make_moon(Model *m);

// model_fountain.c
void model_make_fountain(Model *m);

// model_plants.c
void model_make_tree(Model *m);
void model_make_bush(Model *m);
void model_make_ivy(Model *m);

// model_furniture.c
void model_make_bench(Model *m);
void model_make_urn(Model *m);
void model_make_statue(Model *m);
void model_make_door_leaf(Model *m);

// model_lights.c
void model_make_lantern_post(Model *m);
void model_make_lantern_hanging(Model *m);
void model_make_torch(Model *m);
void model_make_brazier(Model *m);
void model_make_candle(Model *m);
void model_make_candles(Model *m);
void model_make_crystal(Model *m);
void model_make_firefly(Model *m);
void model_make_light_box(Model *m);

// model_teapot.c
void model_make_teapot(Model *m);

#endif

// Measures that the pieces of the covered walk share, in metres; x along the walk, the garden at
// z = 0, the outer wall's inner face at z = 4. Read by model_walk.c, model_wall.c and the
// buildings that lean against the walk.
#ifndef MAKE_ASSETS_WALK_H
#define MAKE_ASSETS_WALK_H

#define WALK_BAY        3.0f  // length of a bay
#define WALK_DEPTH      4.0f  // garden edge to outer wall
#define WALK_ARCADE     0.47f // inner face of the arcade wall
#define WALK_WALL_BACK  4.6f  // outer face of the outer wall
#define WALK_SPRING     2.4f  // springing of the vault
#define WALK_RISE       1.5f
#define WALK_POINTED    0.22f
#define WALK_WALL_TOP   5.7f
#define WALK_EAVES_Y    3.72f // roof surface at the eaves
#define WALK_EAVES_Z    (-0.45f)
#define WALK_ROOF_SLOPE 0.33f
#define WALK_ROOF_END   4.05f

static inline float walk_roof_y(float z) {
    return WALK_EAVES_Y + WALK_ROOF_SLOPE * (z - WALK_EAVES_Z);
}

#endif

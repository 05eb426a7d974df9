// Writer of binary glTF 2.0.
//
// Data in: a Model. Data out: one .glb file with meshes, nodes, the materials that are used and
// their images embedded. Called by main.c. It writes no animation, no cameras, no lights.
#ifndef MAKE_ASSETS_GLB_H
#define MAKE_ASSETS_GLB_H

#include "model.h"

// Returns the file's size in bytes, 0 if it could not be written.
size_t glb_write(const Model *m, const char *path);

#endif

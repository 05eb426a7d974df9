// Model: what one .glb file holds, and the list of all models.
//
// Data in: soups of triangles. Data out: meshes and nodes for the writer (glb.h). Called by the
// model_*.c files and by main.c. A node only moves and turns: no scale, so loaders stay simple.
#ifndef MAKE_ASSETS_MODEL_H
#define MAKE_ASSETS_MODEL_H

#include "materials.h"
#include "mesh.h"
#include "shapes.h"

#define MODEL_MESHES_MAX 16
#define MODEL_NODES_MAX  96

typedef struct ModelNode {
    const char *name;
    int mesh;
    Vec3 position;
    float yaw_deg;
} ModelNode;

typedef struct Model {
    Mesh meshes[MODEL_MESHES_MAX];
    const char *mesh_names[MODEL_MESHES_MAX];
    int mesh_count;
    ModelNode nodes[MODEL_NODES_MAX];
    int node_count;
} Model;

// Builds the soup into a mesh and frees the soup. `name` must outlive the model. Returns its index.
int model_add_mesh(Model *m, const char *name, Soup *soup, float crease_deg);
void model_add_node(Model *m, const char *name, int mesh, Vec3 position, float yaw_deg);

// The common case: one mesh at the origin.
void model_add_soup(Model *m, const char *name, Soup *soup);

// Triangles as drawn, with shared meshes counted once per node.
uint32_t model_triangle_count(const Model *m);
void model_free(Model *m);

// Every model of the levels: name.glb and what makes it. Ends with a NULL name.
typedef struct ModelRow {
    const char *name;
    void (*make)(Model *m);
} ModelRow;
extern const ModelRow MODEL_TABLE[];

#endif

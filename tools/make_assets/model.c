// Models: bookkeeping of meshes and nodes, and the table of what is made. See model.h.
#include "model.h"

#include "models.h"

#include <stdlib.h>
#include <string.h>

const ModelRow MODEL_TABLE[] = {
    {"bay", model_make_bay},
    {"bay_open", model_make_bay_open},
    {"corner", model_make_corner},
    {"wall", model_make_wall},
    {"wall_window", model_make_wall_window},
    {"wall_door", model_make_wall_door},
    {"chapter_house", model_make_chapter_house},
    {"facade", model_make_facade},
    {"garden", model_make_garden},
    {"surroundings", model_make_surroundings},
    {"moon", model_make_moon},
    {"fountain", model_make_fountain},
    {"tree", model_make_tree},
    {"bush", model_make_bush},
    {"ivy", model_make_ivy},
    {"bench", model_make_bench},
    {"urn", model_make_urn},
    {"statue", model_make_statue},
    {"lantern_post", model_make_lantern_post},
    {"lantern_hanging", model_make_lantern_hanging},
    {"torch", model_make_torch},
    {"brazier", model_make_brazier},
    {"candle", model_make_candle},
    {"candles", model_make_candles},
    {"crystal", model_make_crystal},
    {"door_leaf", model_make_door_leaf},
    {"firefly", model_make_firefly},
    {"light_box", model_make_light_box},
    {"teapot", model_make_teapot},
    {NULL, NULL},
};

int model_add_mesh(Model *m, const char *name, Soup *soup, float crease_deg) {
    if (m->mesh_count == MODEL_MESHES_MAX) abort();
    m->meshes[m->mesh_count] = soup_build(soup, crease_deg);
    m->mesh_names[m->mesh_count] = name;
    soup_free(soup);
    return m->mesh_count++;
}

void model_add_node(Model *m, const char *name, int mesh, Vec3 position, float yaw_deg) {
    if (m->node_count == MODEL_NODES_MAX) abort();
    m->nodes[m->node_count++] = (ModelNode){name, mesh, position, yaw_deg};
}

// Below 45 degrees an octagon keeps its edges; above 36 a ten-sided shaft is round.
void model_add_soup(Model *m, const char *name, Soup *soup) {
    model_add_node(m, name, model_add_mesh(m, name, soup, 40), vec3(0, 0, 0), 0);
}

uint32_t model_triangle_count(const Model *m) {
    uint32_t count = 0;
    for (int i = 0; i < m->node_count; i++) count += m->meshes[m->nodes[i].mesh].index_count / 3;
    return count;
}

void model_free(Model *m) {
    for (int i = 0; i < m->mesh_count; i++) mesh_free(m->meshes + i);
    memset(m, 0, sizeof *m);
}

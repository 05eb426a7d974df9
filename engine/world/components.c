// components.c: the descriptions of the engine's own components.
// Data in: the column lists of components.h. Data out: one const ComponentDesc each
// (transform_component, light_component, ...). Called by: world_create, which registers them in
// the order of ENGINE_COMPONENTS. Does not: hold any code; a component is data.
#include "components.h"

#define X(Name, name, COLUMNS, singleton, help)                                                    \
    COMPONENT_DEFINE(Name, name, COLUMNS, singleton, help)
ENGINE_COMPONENTS(X)
#undef X

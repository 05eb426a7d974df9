// light_manager.c: the light manager's decisions in time; light_manager.h says what for.
// Data in: the world after a tick, the camera. Data out: per light entity the share of its
// brightness that is shown, its partner, and where both are going. Called by: the session (ticks,
// cuts), packet_lights.c (reads). Does not: cull for the picture, or see settings.
//
// Keyed by entity, so rows may move. One slot for each entity index; a slot that another generation
// left is as good as empty.
#include "light_manager.h"
#include "light_manager_state.h"
#include <stdlib.h>
#include <string.h>

LightManagerState *light_manager_create(void) {
    LightManagerState *state = calloc(1, sizeof *state);
    LUZ_ASSERT(state);
    LUZ_ASSERT(arena_create(&state->polygon_arena, "occluder polygons", GIB(1)));
    LUZ_ASSERT(arena_create(&state->surface_arena, "light surfaces", GIB(1)));
    return state;
}

void light_manager_destroy(LightManagerState *state) {
    if (!state) return;
    arena_destroy(&state->polygon_arena);
    arena_destroy(&state->surface_arena);
    free(state->slots);
    free(state);
}

LightManagerState *light_manager_clone(const LightManagerState *state) {
    LightManagerState *clone = light_manager_create();
    Arena polygon_arena = clone->polygon_arena, surface_arena = clone->surface_arena;
    *clone = *state;
    clone->polygon_arena = polygon_arena;
    clone->surface_arena = surface_arena;
    clone->polygons = NULL; // a step makes them again
    clone->surfaces = NULL;
    clone->polygons_stamp = clone->surfaces_stamp = 0;
    clone->slots = malloc(MAX(state->slot_count, 1) * sizeof *state->slots);
    LUZ_ASSERT(clone->slots);
    if (state->slot_count)
        memcpy(clone->slots, state->slots, state->slot_count * sizeof *state->slots);
    return clone;
}

void light_manager_delay(LightManagerState *state, u32 ticks) { state->tick += ticks; }

bool light_manager_knows(const LightManagerState *state, const World *world, Entity camera) {
    return state->decided && state->camera == camera && world->tick >= state->tick &&
           world->tick - state->tick < LIGHT_MANAGER_STEP;
}

const LightSlot *light_slot(const LightManagerState *state, Entity entity) {
    u32 index = ENTITY_INDEX(entity);
    if (index >= state->slot_count || state->slots[index].entity != entity) return NULL;
    return &state->slots[index];
}

f32 light_manager_weight(const LightManagerState *state, const World *world, Entity light) {
    const LightSlot *slot = light_slot(state, light);
    return slot ? light_slot_weight(slot, world->tick - state->tick) : 1.0f;
}

Entity light_manager_partner(const LightManagerState *state, const World *world, Entity light,
                             f32 *weight) {
    const LightSlot *slot = light_slot(state, light);
    *weight = 0.0f;
    if (!slot || !slot->partner) return ENTITY_NONE;
    *weight = light_slot_pair_weight(slot, world->tick - state->tick);
    return slot->partner;
}

const OccluderPolygons *light_manager_polygons(const LightManagerState *state) {
    return state->polygons;
}

// ---- a step ----

static void grow_slots(LightManagerState *state, u32 count) {
    if (count <= state->slot_count) return;
    u32 wanted = MAX(count, state->slot_count * 2);
    state->slots = realloc(state->slots, wanted * sizeof *state->slots);
    LUZ_ASSERT(state->slots);
    memset(state->slots + state->slot_count, 0,
           (wanted - state->slot_count) * sizeof *state->slots);
    state->slot_count = wanted;
}

// Brings the slots to the tick of now, gives new lights one, ends pairs that have faded out or lost
// a partner. held: the partners' rows.
static void advance_slots(LightManagerState *state, const LightTable *light, u32 ticks, u32 *held) {
    for (u32 row = 0; row < light->table.count; row++) {
        Entity entity = light->table.entity[row];
        LightSlot *slot = &state->slots[ENTITY_INDEX(entity)];
        if (slot->entity != entity) {
            *slot = (LightSlot){.entity = entity, .weight = 1.0f, .target = 1.0f};
            continue;
        }
        f32 weight = light_slot_weight(slot, ticks);
        slot->pair_weight = light_slot_pair_weight(slot, ticks);
        slot->weight = weight;
    }
    for (u32 row = 0; row < light->table.count; row++) {
        held[row] = ROW_NONE;
        LightSlot *slot = &state->slots[ENTITY_INDEX(light->table.entity[row])];
        if (!slot->partner) continue;
        u32 other = table_row(&light->table, slot->partner);
        const LightSlot *back = light_slot(state, slot->partner);
        bool whole = other != ROW_NONE && back && back->partner == slot->entity;
        if (whole && (slot->pair_weight > 0.0f || slot->pair_target > 0.0f)) {
            held[row] = other;
            continue;
        }
        slot->partner = ENTITY_NONE; // the other one does the same when its row comes
        slot->pair_weight = slot->pair_target = 0.0f;
    }
    // A pair is held by both or by none, whichever row was seen first.
    for (u32 row = 0; row < light->table.count; row++)
        if (held[row] != ROW_NONE && held[held[row]] != row) held[row] = ROW_NONE;
}

static void refresh_polygons(LightManagerState *state, const World *world, const AssetStore *assets,
                             Arena *scratch) {
    const Table *occluders = world->tables[COMPONENT_occluder];
    u64 stamp = assets->stamp ^ (u64)occluders->newest_stamp << 32 ^ occluders->count;
    if (state->polygons && state->polygons_stamp == stamp) return;
    arena_reset(&state->polygon_arena);
    state->polygons = occluder_polygons_build(world, assets, &state->polygon_arena, scratch);
    state->polygons_stamp = stamp;
}

// Once a level: what stands still does so.
static void refresh_surfaces(LightManagerState *state, const World *world,
                             const AssetStore *assets) {
    if (state->surfaces_stamp == assets->stamp && state->surfaces) return;
    arena_reset(&state->surface_arena);
    state->surfaces = light_surfaces_build(world, assets, &state->surface_arena);
    state->surfaces_stamp = assets->stamp;
}

// Rows that the reference view shows, ascending.
static u32 *visible_rows(const LightManagerState *state, const World *world,
                         const AssetStore *assets, const LightScene *scene, u32 *count,
                         Arena *scratch) {
    const LightCandidates *c = &scene->candidates;
    u32 *rows = ARENA_PUSH(scratch, u32, ALIGN_UP(scene->count, SIMD_WIDTH));
    *count = cull_spheres(&scene->view.frustum, c->x, c->y, c->z, c->radius, scene->count, rows);
    const OcclusionBuffer *buffer =
        occlusion_draw(world, assets, state->polygons, &scene->view, scratch);
    *count = occlusion_cull(buffer, c->x, c->y, c->z, c->radius, rows, *count, scratch);
    return rows;
}

static void step(LightManagerState *state, const World *world, const AssetStore *assets,
                 Entity camera, bool at_once, Arena *scratch) {
    const LightTable *light = WORLD_TABLE(world, Light, light);
    u64 mark = arena_mark(scratch);
    grow_slots(state, world->entity_slots);
    refresh_polygons(state, world, assets, scratch);
    refresh_surfaces(state, world, assets);
    u32 *held = NULL;
    if (!at_once) {
        held = ARENA_PUSH(scratch, u32, light->table.count);
        advance_slots(state, light, world->tick - state->tick, held);
    }
    LightCandidates candidates = light_candidates(light, 1.0f, scratch);
    LightScene scene = light_scene_make(world, camera, &candidates);
    scene.surfaces = state->surfaces;
    LightDecideDesc desc = {
        .held = held, .merge = true, .drop = true, .budget = scene.config.budget};
    desc.rows = visible_rows(state, world, assets, &scene, &desc.row_count, scratch);
    LightDecision d = light_decide(&scene, &desc, state->stage_ms, scratch);
    for (u32 row = 0; row < light->table.count; row++) {
        LightSlot *slot = &state->slots[ENTITY_INDEX(light->table.entity[row])];
        if (at_once) *slot = (LightSlot){.entity = light->table.entity[row]};
        slot->partner =
            d.partner[row] == ROW_NONE ? ENTITY_NONE : light->table.entity[d.partner[row]];
        slot->target = d.weight[row];
        slot->pair_target = d.pair_weight[row];
        slot->pair_error = d.pair_error[row];
        slot->fate = d.fate[row];
        // A pair and its two lights take each other's place: what one loses the other gains.
        // Anything else goes, or comes, without a substitute.
        u32 other = d.partner[row];
        slot->takes_place =
            other != ROW_NONE && MIN(d.weight[row], d.weight[other]) + d.pair_weight[row] > 0.999f;
        slot->in_step = slot->takes_place && slot->target + slot->pair_target == 1.0f &&
                        fabsf(slot->weight + slot->pair_weight - 1.0f) < 1e-5f;
        if (!at_once && (slot->weight != slot->target || slot->pair_weight != slot->pair_target))
            slot->tail =
                light_fade_tail(light_fade_brightest(&scene, row, other, slot->takes_place));
        if (!at_once) continue;
        slot->weight = slot->target;
        slot->pair_weight = slot->pair_target;
    }
    state->decided = true;
    state->camera = camera;
    state->tick = world->tick;
    arena_rewind(scratch, mark);
}

void light_manager_cut(LightManagerState *state, const World *world, const AssetStore *assets,
                       Entity camera, Arena *scratch) {
    step(state, world, assets, camera, true, scratch);
}

void light_manager_tick(LightManagerState *state, const World *world, const AssetStore *assets,
                        Entity camera, Arena *scratch) {
    bool follows = state->decided && state->camera == camera && world->tick >= state->tick &&
                   world->tick - state->tick <= LIGHT_MANAGER_STEP;
    // Steps fall on fixed ticks, so that they do not hang on when a cut was.
    if (follows && world->tick % LIGHT_MANAGER_STEP != 0) return;
    step(state, world, assets, camera, !follows, scratch);
}

// walk.c: one who walks, jumps, climbs steps or flies, moved by the tick's input.
// Data in: Input, walker, camera's own transform, the collision world, gravity. Data out: transform
// position (of the eyes), pitch and yaw; walker.velocity, grounded, fly. Called by: the system
// table, before transform. Does not: follow a parent (walkers are roots), push things, or smooth
// the camera. Deterministic: + - * / sqrt and det_ functions, contacts in a fixed order.
//
// A body is an upright capsule. A tick's way is cut into steps of at most half its radius, and
// after each step it is pushed out of what it touches, deepest contact first: so nothing is
// tunnelled through, however fast. Three kinds of contact:
//   floor   under the foot, and the face is not too steep: lifted straight up until it stands
//   slope   under the foot, but too steep: pushed away sideways, so that it cannot be climbed
//   wall    everything else: pushed out along the contact's normal
// A step that is higher than the capsule's round bottom lifts is tried in a second way: up, along,
// down; the way that gets farther is taken.
#include "collision.h"
#include "environment.h"
#include <math.h>

#define EYES_BELOW_TOP_M 0.12f
#define STEP_HEIGHT_M    0.35f
#define FLOOR_COS        0.642787610f // 50 degrees
#define JUMP_SPEED       4.5f         // m/s
#define RUN_FACTOR       1.8f
#define FLY_FACTOR       2.5f
#define PITCH_MAX_DEG    89.0f
#define TOUCH_M          1e-4f // overlap that is left alone: a gap of twice the radius lets through
#define PUSHES_MAX       12
#define DROP_STEP_MIN_M  1e-3f
#define STEPS_MAX        256
#define FALL_SPEED_MAX   55.0f // m/s
#define GROUND_GRIP      0.25f // share of the wanted change of speed that a tick gives
#define AIR_GRIP         0.04f
#define STOP_SPEED       0.02f // m/s; slower is standing

typedef struct Body {
    Vec3 feet; // lowest point of the capsule
    Vec3 velocity;
    f32 radius, height;
    f32 floor_y;   // where the newest floor touched it
    bool grounded; // a floor held it
    bool blocked;  // a wall or slope turned it
    bool squeezed; // it began the tick where there is no room
} Body;

static Capsule body_capsule(const Body *body) {
    f32 top = MAX(body->height - body->radius, body->radius);
    return (Capsule){vec3(body->feet.x, body->feet.y + body->radius, body->feet.z),
                     vec3(body->feet.x, body->feet.y + top, body->feet.z), body->radius};
}

static Vec3 without_into(Vec3 v, Vec3 normal) {
    f32 into = vec3_dot(v, normal);
    return into < 0.0f ? vec3_sub(v, vec3_scale(normal, into)) : v;
}

// Moves the body out of one contact and takes from velocity and *way what goes into the obstacle.
static void push_out(Body *body, const Contact *contact, Vec3 *way, bool plainly) {
    Vec3 n = contact->normal, foot = {body->feet.x, body->feet.y + body->radius, body->feet.z};
    Vec3 from = vec3_sub(foot, contact->point); // obstacle to the lower ball's centre
    f32 level2 = from.x * from.x + from.z * from.z, radius = body->radius;
    bool under_foot = contact->at_foot && n.y > 0.0f && level2 < radius * radius;
    if (under_foot && contact->facing.y >= FLOOR_COS &&
        contact->point.y - body->feet.y <= STEP_HEIGHT_M) {
        body->floor_y = contact->point.y;
        body->feet.y = contact->point.y + sqrtf(radius * radius - level2) - radius;
        if (body->velocity.y <= 0.0f) body->grounded = true;
        body->velocity.y = MAX(body->velocity.y, 0.0f);
        way->y = MAX(way->y, 0.0f);
        return;
    }
    body->blocked = true;
    Vec3 level = vec3_normalize(vec3(n.x, 0.0f, n.z));
    f32 length = sqrtf(level2);
    // Between two slopes that lean on each other, sideways pushes never end: then plainly.
    if (under_foot && !plainly && length > 0.1f * radius) {
        f32 wanted = sqrtf(MAX(radius * radius - from.y * from.y, 0.0f));
        body->feet = vec3_add(body->feet, vec3_scale(level, MAX(wanted - length, 0.0f)));
        // Falling goes on along the slope; only what climbs it is taken away.
        body->velocity = without_into(body->velocity, level);
        *way = without_into(*way, level);
        return;
    }
    body->feet = vec3_add(body->feet, vec3_scale(n, contact->depth));
    body->velocity = without_into(body->velocity, n);
    *way = without_into(*way, n);
}

// False if obstacles push against each other: there is no room here.
static bool settle_contacts(Body *body, const NearShapes *shapes, Vec3 *way) {
    for (u32 i = 0; i < PUSHES_MAX; i++) {
        Capsule capsule = body_capsule(body);
        Contact contact = collision_deepest(shapes, &capsule);
        if (contact.depth <= TOUCH_M) return true;
        push_out(body, &contact, way, i >= PUSHES_MAX / 2);
    }
    return false;
}

// Goes a way, sliding along what it meets.
static void move(Body *body, const NearShapes *shapes, Vec3 way) {
    f32 step_m = body->radius * 0.5f, length = vec3_length(way);
    u32 steps = length > step_m ? MIN((u32)(length / step_m) + 1, STEPS_MAX) : 1;
    Vec3 step = vec3_scale(way, 1.0f / (f32)steps);
    for (u32 i = 0; i < steps; i++) {
        Vec3 before = body->feet;
        body->feet = vec3_add(body->feet, step);
        if (settle_contacts(body, shapes, &step)) continue;
        // Squeezing on would end inside of something. A body that is inside already (a door
        // closed over it) takes what the pushes give.
        body->blocked = true;
        if (body->squeezed) continue;
        body->feet = before;
        return;
    }
}

// Lowers the body onto the highest floor within `distance`. False (untouched) if there is none, or
// something else is in the way. The foot is round: beside the edge of a step it must come to rest
// before it is beside the riser, so a lowering that ends there is tried again in halves.
static bool drop(Body *body, const NearShapes *shapes, f32 distance) {
    Body probe = *body;
    probe.grounded = false;
    probe.velocity.y = 0.0f; // one who rises is not held by floors
    f32 lowest = body->feet.y - distance, step = body->radius * 0.5f;
    while (probe.feet.y > lowest && step > DROP_STEP_MIN_M) {
        Body next = probe;
        Vec3 nowhere = {0, 0, 0};
        next.blocked = false;
        next.feet.y = MAX(next.feet.y - step, lowest);
        bool room = settle_contacts(&next, shapes, &nowhere);
        if (next.grounded && room) {
            body->feet = next.feet;
            body->floor_y = next.floor_y;
            body->grounded = true;
            return true;
        }
        if (next.blocked || !room)
            step *= 0.5f;
        else
            probe = next;
    }
    return false;
}

// Up, along, down. False (body untouched) if that does not end on a floor farther on.
static bool climb_step(Body *body, const NearShapes *shapes, const Body *start, Vec3 way) {
    Body climber = *start;
    climber.velocity.y = 0.0f;
    move(&climber, shapes, vec3(0, STEP_HEIGHT_M, 0));
    f32 raised = climber.feet.y - start->feet.y;
    if (!(raised > TOUCH_M)) return false;
    climber.velocity = vec3(start->velocity.x, 0.0f, start->velocity.z);
    climber.blocked = false;
    move(&climber, shapes, way);
    // The round foot is lifted by edges on its way: what counts is how high it found its floor.
    if (!drop(&climber, shapes, raised)) return false;
    if (climber.floor_y > start->feet.y + STEP_HEIGHT_M + TOUCH_M) return false;
    f32 plain = (body->feet.x - start->feet.x) * way.x + (body->feet.z - start->feet.z) * way.z;
    f32 climbed =
        (climber.feet.x - start->feet.x) * way.x + (climber.feet.z - start->feet.z) * way.z;
    if (!(climbed > plain + 1e-3f * vec3_dot(way, way))) return false;
    *body = climber;
    return true;
}

// ---- input ----

typedef struct Wish {
    Vec3 way;  // unit at most; level for walking
    f32 speed; // m/s
    bool jump;
} Wish;

static Wish read_wish(const Input *input, f32 yaw_deg, f32 pitch_deg, f32 speed, bool fly) {
    f32 yaw = DEG_TO_RAD(yaw_deg), pitch = fly ? DEG_TO_RAD(pitch_deg) : 0.0f;
    f32 sin_yaw = det_sin(yaw), cos_yaw = det_cos(yaw), cos_pitch = det_cos(pitch);
    Vec3 forward = {-sin_yaw * cos_pitch, det_sin(pitch), -cos_yaw * cos_pitch};
    Vec3 right = {cos_yaw, 0.0f, -sin_yaw};
    Vec3 way = vec3_add(vec3_scale(right, (f32)input->move_x / 127.0f),
                        vec3_scale(forward, (f32)input->move_z / 127.0f));
    if (fly) way.y += (f32)input->move_y / 127.0f;
    f32 length = vec3_length(way);
    if (length > 1.0f) way = vec3_scale(way, 1.0f / length);
    if (input->buttons & INPUT_RUN) speed *= RUN_FACTOR;
    if (fly) speed *= FLY_FACTOR;
    return (Wish){way, speed, (input->buttons & INPUT_JUMP) != 0};
}

static f32 wrap_deg(f32 angle) {
    while (angle >= 180.0f) angle -= 360.0f;
    while (angle < -180.0f) angle += 360.0f;
    return angle;
}

// ---- one walker's tick ----

static void walk(Body *body, CollisionWorld *collision, const World *world, const Wish *wish,
                 f32 gravity, Arena *scratch) {
    bool stood = body->grounded;
    Vec3 wanted = vec3_scale(wish->way, wish->speed), *v = &body->velocity;
    f32 grip = stood ? GROUND_GRIP : AIR_GRIP;
    v->x += (wanted.x - v->x) * grip;
    v->z += (wanted.z - v->z) * grip;
    if (wanted.x == 0.0f && wanted.z == 0.0f && v->x * v->x + v->z * v->z < STOP_SPEED * STOP_SPEED)
        v->x = v->z = 0.0f;
    bool jumps = stood && wish->jump;
    if (jumps) v->y = JUMP_SPEED;
    if (!stood || jumps) v->y = MAX(v->y - gravity * TICK_SECONDS, -FALL_SPEED_MAX);
    if (stood && !jumps) v->y = 0.0f;
    // A tick's way fits into STEPS_MAX steps, so that a step stays shorter than the radius.
    f32 fastest = (f32)(STEPS_MAX - 1) * 0.5f * body->radius * TICK_RATE, speed = vec3_length(*v);
    if (speed > fastest) *v = vec3_scale(*v, fastest / speed);

    Vec3 way = vec3_scale(*v, TICK_SECONDS);
    f32 reach = vec3_length(way) + body->radius + STEP_HEIGHT_M + 0.1f;
    Vec3 low = {body->feet.x - reach, body->feet.y - reach, body->feet.z - reach};
    Vec3 high = {body->feet.x + reach, body->feet.y + body->height + reach, body->feet.z + reach};
    NearShapes shapes = collision_gather(collision, world, low, high, scratch);

    Vec3 nowhere = {0, 0, 0};
    body->squeezed = !settle_contacts(body, &shapes, &nowhere); // what moved in since the last tick
    const Body start = *body;
    body->grounded = body->blocked = false;
    move(body, &shapes, way);
    Vec3 level_way = {way.x, 0.0f, way.z};
    bool goes = vec3_dot(level_way, level_way) > 0.0f;
    if (stood && !jumps && body->blocked && goes) climb_step(body, &shapes, &start, level_way);
    // A walker who stood stays on the ground over edges and down steps.
    if (stood && !jumps && !body->grounded) drop(body, &shapes, STEP_HEIGHT_M);
    // Standing still on a slope: what is left of the iteration must not creep.
    Vec3 moved = vec3_sub(body->feet, start.feet);
    if (stood && !goes && body->grounded && vec3_dot(moved, moved) < 1e-3f * 1e-3f)
        body->feet = start.feet;
}

static void store_f32(f32 *column, f32 value, bool *changed) {
    *changed |= *column != value;
    *column = value;
}

static void update_walker(SystemContext *context, u32 row, f32 gravity) {
    World *world = context->world;
    WalkerTable *w = WORLD_TABLE(world, Walker, walker);
    TransformTable *t = WORLD_TABLE(world, Transform, transform);
    Entity entity = w->table.entity[row];
    u32 place = table_row(&t->table, entity);
    if (place == ROW_NONE) return;
    const Input *input = &context->input;
    bool walker_changed = false, moved = false;
    if (input->buttons & INPUT_FLY) {
        w->fly[row] = !w->fly[row];
        walker_changed = true;
    }
    // Yaw to the right turns clockwise seen from above: against the sense of a rotation about +y.
    f32 yaw = t->yaw[place], pitch = t->pitch[place];
    if (input->look_x != 0) yaw = wrap_deg(yaw - (f32)input->look_x * 0.01f);
    if (input->look_y != 0)
        pitch = CLAMP(pitch + (f32)input->look_y * 0.01f, -PITCH_MAX_DEG, PITCH_MAX_DEG);
    bool fly = w->fly[row] || !context->collision;
    Wish wish = read_wish(input, yaw, pitch, w->speed[row], fly);

    // `position` is where the eyes are.
    Vec3 eyes = {t->x[place], t->y[place], t->z[place]};
    f32 eye_height = MAX(w->height[row] - EYES_BELOW_TOP_M, w->height[row] * 0.5f);
    Body body = {.feet = {eyes.x, eyes.y - eye_height, eyes.z},
                 .velocity = {w->velocity_x[row], w->velocity_y[row], w->velocity_z[row]},
                 .radius = MIN(w->radius[row], w->height[row] * 0.5f),
                 .height = w->height[row],
                 .grounded = w->grounded[row] != 0};
    if (fly) {
        body.velocity = vec3_scale(wish.way, wish.speed);
        body.grounded = false;
        eyes = vec3_add(eyes, vec3_scale(body.velocity, TICK_SECONDS));
    } else {
        Vec3 spawn = collision_spawn(context->collision, entity, eyes);
        Vec3 feet = body.feet;
        walk(&body, context->collision, world, &wish, gravity, context->scratch);
        // Differences, not feet + height: who stands still keeps every bit.
        eyes = vec3_add(eyes, vec3_sub(body.feet, feet));
        if (eyes.y < collision_floor_y(context->collision)) {
            eyes = spawn;
            body.velocity = vec3(0, 0, 0);
            body.grounded = false;
        }
    }
    store_f32(&t->x[place], eyes.x, &moved);
    store_f32(&t->y[place], eyes.y, &moved);
    store_f32(&t->z[place], eyes.z, &moved);
    store_f32(&t->yaw[place], yaw, &moved);
    store_f32(&t->pitch[place], pitch, &moved);
    store_f32(&w->velocity_x[row], body.velocity.x, &walker_changed);
    store_f32(&w->velocity_y[row], body.velocity.y, &walker_changed);
    store_f32(&w->velocity_z[row], body.velocity.z, &walker_changed);
    walker_changed |= w->grounded[row] != (u32)body.grounded;
    w->grounded[row] = body.grounded;
    if (moved) table_touch(&t->table, place);
    if (walker_changed) table_touch(&w->table, row);
}

void system_walk(SystemContext *context) {
    const WalkerTable *walkers = WORLD_TABLE(context->world, Walker, walker);
    if (walkers->table.count == 0) return;
    f32 gravity = environment_read(context->world).gravity;
    for (u32 row = 0; row < walkers->table.count; row++) update_walker(context, row, gravity);
}

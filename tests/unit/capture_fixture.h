// capture_fixture.h: a small world that runs by inputs, to be recorded and replayed without a
// level.
#ifndef LUZ_TEST_CAPTURE_FIXTURE_H
#define LUZ_TEST_CAPTURE_FIXTURE_H
#include "../test.h"
#include "../../engine/capture/capture.h"

#define FIXTURE_LIGHTS 6 // named "light 0" ...

typedef struct CaptureWorld {
    World *world;
    Entity lights[FIXTURE_LIGHTS];
} CaptureWorld;

CaptureWorld capture_world_create(void);
// One tick: every light moves by the input; some rows come and go.
void capture_world_tick(CaptureWorld *fixture, Input input);
// Different in every tick, with runs of equal ones in between.
Input capture_input(u32 tick);
RecordingInfo capture_info(void);
// Records so many ticks, with a picture every 50th.
void capture_record(const char *path, u32 tick_count);

typedef void (*CaptureChange)(CaptureWorld *fixture);
// Replays, applies the change after tick `at` was simulated, and returns the first difference; text
// "" = none.
RecordingDifference capture_replay(const Recording *recording, u32 at, CaptureChange change,
                                   Arena *arena);

// Whole files.
u8 *capture_read_bytes(const char *path, u64 *size); // malloc
void capture_write_bytes(const char *path, const u8 *bytes, u64 size);
#endif

// light_fade.c: the pace at which shares of brightness move to what was decided.
// Data in: a share, its target, how bright a pixel it can make. Data out: the share some ticks
// later. Called by: light_manager.c (steps), packet_lights.c (frames between steps). Does not:
// decide anything.
//
// What a pixel shows of radiance x is f(x) = sRGB(x / (1 + x)). However bright it is,
// x f'(x) <= 0.186: a change of x by its part r changes the picture by 47 r of 255 at most. So
// where every share changes by a part of itself, a pixel's change has a bound that hangs neither on
// how near a light is to its surface nor on how many lights change together: their sum changes by
// no more than that part of itself. A share that moves evenly in time has no such bound: a lamp
// that touches its wall goes from white to black in the last tick.
//
// A part of itself never reaches nothing. Where a light's brightest pixel is nearly dark, the
// square root of its share moves evenly instead, which ends.
//
// When a merged light takes the place of a pair, what one loses the other gains, and the same has
// to hold for both: the smaller of the two sets the pace, and the shares rise and fall in an S.
#include "light_manager_state.h"

// Radiance below which a light's brightest pixel may change by a larger part: there a tick changes
// it by 1 / 255.
#define FADE_DARK 0.01f
// Of the square root: a share is gone in 12 ticks at the fastest, a pair merged in 17.
#define FADE_TAIL_MAX (1.0f / 12)
// Its square is what a share next to one can change by, as a float.
#define FADE_TAIL_MIN 3e-4f

f32 light_fade_tail(f32 brightest) {
    f32 tail = 0.5f * LIGHT_FADE_RATE * sqrtf(FADE_DARK / MAX(brightest, 1e-6f));
    return MIN(tail, FADE_TAIL_MAX);
}

f32 light_fade_brightest(const LightScene *scene, u32 row, u32 other, bool takes_place) {
    f32 brightest = light_brightest(scene, row);
    if (other != ROW_NONE) brightest = MAX(brightest, light_brightest(scene, other));
    if (!takes_place) return brightest;
    // The picture changes by the difference alone. Factor: white surfaces, as above. In one order,
    // so that both partners' slots say the same to the last bit.
    f32 peak = light_merge_peak(scene, MIN(row, other), MAX(row, other));
    return MIN(brightest, 2.0f * peak);
}

f32 light_share_step(f32 share, f32 target, f32 tail, bool takes_place) {
    if (share == target) return share;
    bool rises = target > share;
    if (takes_place) tail = MAX(tail, FADE_TAIL_MIN);
    // Seen from the smaller side.
    bool mirrored = takes_place && share >= 0.5f;
    f32 q = mirrored ? 1.0f - share : share, root = sqrtf(q);
    if (rises != mirrored)
        q = MAX(q * (1.0f + LIGHT_FADE_RATE), (root + tail) * (root + tail));
    else
        q = root > tail ? MIN(q / (1.0f + LIGHT_FADE_RATE), (root - tail) * (root - tail)) : 0.0f;
    share = mirrored ? 1.0f - q : q;
    return rises ? MIN(share, target) : MAX(share, target);
}

static f32 fade(const LightSlot *slot, f32 from, f32 target, u32 ticks) {
    for (u32 i = 0; i < ticks && from != target; i++)
        from = light_share_step(from, target, slot->tail, slot->takes_place);
    return from;
}

f32 light_slot_weight(const LightSlot *slot, u32 ticks) {
    // The sum is one to the last bit, however often they turn round.
    if (slot->in_step) return 1.0f - light_slot_pair_weight(slot, ticks);
    return fade(slot, slot->weight, slot->target, ticks);
}

f32 light_slot_pair_weight(const LightSlot *slot, u32 ticks) {
    return fade(slot, slot->pair_weight, slot->pair_target, ticks);
}

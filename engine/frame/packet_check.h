// packet_check.h: parts of packet_validate. Private to engine/frame/.
#ifndef LUZ_PACKET_CHECK_H
#define LUZ_PACKET_CHECK_H
#include "packet.h"

static inline bool floats_finite(const void *data, u64 count) {
    // An f32 is finite unless all its exponent bits are set: integer compares, no branches.
    const u32 *bits = (const u32 *)data;
    u32 bad = 0;
    for (u64 i = 0; i < count; i++) bad |= (bits[i] & 0x7F800000u) == 0x7F800000u;
    return !bad;
}

// packet_gi.c: all of global illumination, of a packet whose layout and materials are good.
const char *packet_check_gi(const Packet *packet, u32 mesh_count);
#endif

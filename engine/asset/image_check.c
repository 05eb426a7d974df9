// image_check.c: looks at a JPEG's segments before the decoder does.
//
// Data in: a file's bytes. Data out: whether its tables and scans are of sizes that the decoder
// (stb_image 2.27) survives. Called by image_probe. Does not: decode, or judge the picture.
//
// Why: that decoder copies a Huffman table's lengths into 257 bytes without looking whether the
// 16 counts add up to more, and it decodes as many scans as a progressive file cares to hold,
// each over the whole image. Other damage it refuses by itself.
#include "asset_internal.h"
#include <stdio.h>

#define JPEG_SCANS_MAX   256 // real progressive files have about ten
#define HUFFMAN_SYMBOLS  256
#define MARKER_EOI       0xD9
#define MARKER_SOS       0xDA
#define MARKER_DHT       0xC4
#define MARKER_RST_FIRST 0xD0
#define MARKER_SOI       0xD8

typedef struct Cursor {
    const u8 *data;
    u64 at, size;
} Cursor;

static u32 next_byte(Cursor *c) { return c->at < c->size ? c->data[c->at++] : 0; }

static u32 next_u16(Cursor *c) {
    u32 high = next_byte(c);
    return high << 8 | next_byte(c);
}

// The tables of one DHT segment, read in the decoder's own way: its loop trusts the counts and
// looks at the length only when a table is done.
static bool check_huffman_tables(Cursor *c, char *why) {
    i64 left = (i64)next_u16(c) - 2;
    while (left > 0) {
        next_byte(c); // class and slot
        u32 symbols = 0;
        for (u32 i = 0; i < 16; i++) symbols += next_byte(c);
        if (symbols > HUFFMAN_SYMBOLS) {
            snprintf(why, ASSET_MESSAGE_CAP, "a Huffman table of %u symbols", symbols);
            return false;
        }
        c->at = MIN(c->at + symbols, c->size);
        left -= 17 + (i64)symbols;
    }
    if (left == 0) return true;
    snprintf(why, ASSET_MESSAGE_CAP, "a Huffman segment of a wrong length");
    return false;
}

bool image_check_jpeg(Bytes file, char *why) {
    Cursor c = {file.data, 0, file.size};
    u32 scans = 0;
    while (c.at < c.size) {
        // To the next marker: over entropy-coded bytes, padding, stuffed FF 00 and restarts.
        if (next_byte(&c) != 0xFF) continue;
        u32 marker = next_byte(&c);
        while (marker == 0xFF && c.at < c.size) marker = next_byte(&c);
        if (marker == MARKER_EOI) break;
        if (marker == 0 || (marker >= MARKER_RST_FIRST && marker <= MARKER_SOI)) continue;
        if (marker == MARKER_SOS && ++scans > JPEG_SCANS_MAX) {
            snprintf(why, ASSET_MESSAGE_CAP, "more than %u scans", JPEG_SCANS_MAX);
            return false;
        }
        if (marker == MARKER_DHT) {
            if (!check_huffman_tables(&c, why)) return false;
            continue;
        }
        u32 length = next_u16(&c);
        if (length < 2) {
            snprintf(why, ASSET_MESSAGE_CAP, "a segment of %u bytes", length);
            return false;
        }
        c.at = MIN(c.at + length - 2, c.size);
    }
    return true;
}

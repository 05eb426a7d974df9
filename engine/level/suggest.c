// suggest.c: edit distance and the choice of the nearest word.
// Data in: a wrong word and candidates. Data out: the nearest one, if it is near enough to be
// meant. Called by the level readers for every unknown key, word and name. Does not: allocate, or
// look at words longer than SUGGEST_WORD_MAX (the cost of a hostile file stays bounded).
#include "suggest.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 32) : c; }

// Optimal string alignment (Damerau-Levenshtein without edits of edited pairs), three rows.
u32 suggest_distance(const char *a, const char *b, u32 limit) {
    u32 a_count = (u32)strnlen(a, SUGGEST_WORD_MAX + 1);
    u32 b_count = (u32)strnlen(b, SUGGEST_WORD_MAX + 1);
    u32 difference = a_count > b_count ? a_count - b_count : b_count - a_count;
    if (a_count > SUGGEST_WORD_MAX || b_count > SUGGEST_WORD_MAX || difference > limit)
        return limit + 1;
    u8 rows[3][SUGGEST_WORD_MAX + 1];
    u8 *before = rows[0], *last = rows[1], *row = rows[2];
    for (u32 j = 0; j <= b_count; j++) last[j] = (u8)j;
    for (u32 i = 1; i <= a_count; i++) {
        row[0] = (u8)i;
        u32 row_best = i;
        for (u32 j = 1; j <= b_count; j++) {
            char ca = lower(a[i - 1]), cb = lower(b[j - 1]);
            u32 best = last[j - 1] + (ca != cb);
            best = MIN(best, last[j] + 1u);
            best = MIN(best, row[j - 1] + 1u);
            if (i > 1 && j > 1 && ca == lower(b[j - 2]) && cb == lower(a[i - 2]))
                best = MIN(best, before[j - 2] + 1u);
            row[j] = (u8)best;
            row_best = MIN(row_best, best);
        }
        if (row_best > limit) return limit + 1;
        u8 *spare = before;
        before = last;
        last = row;
        row = spare;
    }
    return last[b_count] > limit ? limit + 1 : last[b_count];
}

Suggestion suggest_begin(const char *word) {
    u32 limit = (u32)CLAMP(strnlen(word, SUGGEST_WORD_MAX) / 3, 1, 3);
    return (Suggestion){.word = word, .best = NULL, .best_distance = limit + 1};
}

void suggest_offer(Suggestion *suggestion, const char *candidate) {
    if (suggestion->best_distance == 0) return;
    u32 limit = suggestion->best_distance - 1;
    u32 distance = suggest_distance(suggestion->word, candidate, limit);
    if (distance <= limit) {
        suggestion->best = candidate;
        suggestion->best_distance = distance;
    } else if (!suggestion->best) {
        // An abbreviation: as far away as a candidate can be, so that any better one replaces it.
        u64 count = strnlen(suggestion->word, SUGGEST_WORD_MAX);
        if (count >= 3 && strncasecmp(suggestion->word, candidate, count) == 0)
            suggestion->best = candidate;
    }
}

const char *suggest_hint(const Suggestion *suggestion, char *out, u64 out_cap) {
    if (suggestion->best) {
        snprintf(out, out_cap, "did you mean '%s'?", suggestion->best);
    } else {
        out[0] = 0;
    }
    return out;
}

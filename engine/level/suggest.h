// suggest.h: "did you mean ...?": the nearest of some known words.
#ifndef LUZ_SUGGEST_H
#define LUZ_SUGGEST_H
#include "../base/base.h"
#ifdef __cplusplus
extern "C" {
#endif

#define SUGGEST_WORD_MAX 64 // longer words get no suggestion

typedef struct Suggestion {
    const char *word; // what was written
    const char *best; // nearest candidate so far, or NULL
    u32 best_distance;
} Suggestion;

// Number of single-character edits (insert, delete, replace, swap of neighbours) between a and b,
// upper and lower case being equal: the optimal string alignment distance.
// limit + 1 as soon as it is above limit. Words longer than SUGGEST_WORD_MAX: limit + 1.
u32 suggest_distance(const char *a, const char *b, u32 limit);

// Use: begin with the wrong word, offer each known word, then read `best`. Of equals the first
// offered wins. A candidate is near if a third of the word's letters (at least 1, at most 3) are
// wrong, or if it starts with the word (3 letters or more).
Suggestion suggest_begin(const char *word);
void suggest_offer(Suggestion *suggestion, const char *candidate);
// "did you mean 'x'?" into out, or "" if nothing was near. Returns out.
const char *suggest_hint(const Suggestion *suggestion, char *out, u64 out_cap);

#ifdef __cplusplus
}
#endif
#endif

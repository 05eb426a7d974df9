// session_internal.h: what session.c and session_reload.c share and nobody else sees.
#ifndef LUZ_SESSION_INTERNAL_H
#define LUZ_SESSION_INTERNAL_H
#include "session.h"

#define PLAYER_COLUMNS_CAP 64

// Where a player is and what it does: the values of its transform and walker rows.
typedef struct PlayerPlace {
    bool valid;
    u32 transform[PLAYER_COLUMNS_CAP], walker[PLAYER_COLUMNS_CAP];
} PlayerPlace;

void player_place_save(const Session *session, PlayerPlace *out);
// Puts the values into the rows of the session's new player.
void player_place_restore(Session *session, const PlayerPlace *place);

// session_load with the root known; place may be NULL.
bool session_load_below(Session *session, const char *root_path, const char *relative,
                        const PlayerPlace *place);
// Derived columns without advancing time.
void session_settle(Session *session);
#endif

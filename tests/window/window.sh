#!/usr/bin/env bash
# window.sh DEMO DIRECTORY: plays the demo in a window as a person would: keys, mouse, edits.
#
# Data in: the program, a directory for its files, a display ($DISPLAY). Data out: exit status 0 if
# everything was seen to happen, else 1 after a line that says what was not. Called by window.c
# under xvfb-run. What the game does is read from its --status file; every wait polls and has a
# limit, so a slow machine only takes longer.
set -u
demo=$1 work=$2
level=$work/room.toml status=$work/status.json log=$work/demo.log
here=$(dirname "${BASH_SOURCE[0]}")
pid=""

finish() { # exit status
    [ -n "$pid" ] && kill "$pid" 2>/dev/null
    exit "$1"
}
fail() {
    echo "window test: $*"
    echo "--- status: $(cat "$status" 2>/dev/null)"
    echo "--- output of the demo:"
    tail -n 40 "$log"
    finish 1
}

# A field of the status line: a word, a number, or the inside of [..] or "..".
field() {
    sed -n "s/.*\"$1\": \(\"\([^\"]*\)\"\|\[\([^]]*\)\]\|\([^,}]*\)\).*/\2\3\4/p" "$status" \
        2>/dev/null
}
axis() { field position | cut -d, -f"$1"; }
# Floating point comparison: is EXPRESSION
is() { awk "BEGIN { exit !($*) }"; }

wait_for() { # seconds, what, command ...
    local limit=$((SECONDS + $1)) what=$2
    shift 2
    until "$@"; do
        kill -0 "$pid" 2>/dev/null || fail "the demo ended while waiting for: $what"
        [ $SECONDS -ge $limit ] && fail "waited in vain for: $what"
        sleep 0.1
    done
}
field_is() { [ "$(field "$1")" = "$2" ]; }
ticking() { is "${1:-0} < $(field tick)+0"; }

cp "$here/room.toml" "$level"
"$demo" --level "$level" --size 640x360 --validation --status "$status" --out "$work/out" \
    >"$log" 2>&1 &
pid=$!

find_window() {
    window=$(xdotool search --onlyvisible --name '^luz' 2>/dev/null | head -n 1)
    [ -n "$window" ]
}
wait_for 60 "a window" find_window
wait_for 120 "the first ticks" ticking 5
field_is size "640, 360" || fail "size is $(field size), not 640, 360"

# --- walking and turning ---
x=$(axis 1) z=$(axis 3)
moved() { is "($(axis 1)-($x))^2 + ($(axis 3)-($z))^2 > 0.25"; }
xdotool keydown w
wait_for 30 "a walk of half a metre" moved
xdotool keyup w
yaw=$(field yaw)
turned() {
    xdotool mousemove_relative -- 40 0
    is "($(field yaw)-($yaw))^2 > 25"
}
wait_for 30 "a turn by the mouse" turned

# --- paths ---
for choice in 1:forward 2:multipass 3:deferred 4:deferred_volumes 5:tiled_deferred \
    6:tiled_forward 7:clustered_deferred 8:clustered_forward; do
    xdotool key "${choice%%:*}"
    wait_for 30 "path ${choice#*:}" field_is path "${choice#*:}"
done

# --- resizing ---
xdotool windowsize "$window" 800 450
wait_for 30 "a window of 800 x 450" field_is size "800, 450"
xdotool windowsize "$window" 333 217
wait_for 30 "a window of 333 x 217" field_is size "333, 217"
xdotool windowsize "$window" 640 360
wait_for 30 "a window of 640 x 360" field_is size "640, 360"

# --- hot reload: a good edit, a broken one, a mended one ---
lights=$(field lights)
sed -i 's/count = 12/count = 20/' "$level"
wait_for 10 "eight lights more" field_is lights $((lights + 8))
cp "$level" "$work/good.toml"
sed -i 's/intensity = 6/intensty = 6/' "$level"
has_error() { field errors | grep -q "intensty"; }
wait_for 10 "an error on the screen" has_error
field_is lights $((lights + 8)) || fail "a broken edit changed the level"
tick=$(field tick)
wait_for 10 "the old level to go on" ticking "$tick"
rm "$level"
tick=$(field tick)
wait_for 10 "the old level to go on without its file" ticking $((tick + 30))
cp "$work/good.toml" "$level"
wait_for 10 "the error to go" field_is errors ""

# --- panel, help, cameras, pause ---
xdotool key F1
wait_for 10 "the panel" field_is panel true
xdotool key F1
wait_for 10 "the panel to close" field_is panel false
xdotool key h F2 h
xdotool key p
wait_for 10 "a pause" field_is paused true
xdotool key p
wait_for 10 "the end of the pause" field_is paused false
xdotool key F2 F2 F2

# --- two ways beside each other ---
field_is split false || fail "the picture is split at the start"
xdotool key x
wait_for 30 "a split picture" field_is split true
xdotool key bracketleft bracketleft
wait_for 10 "the line to move left" field_is split_at 0.40
xdotool key bracketright
wait_for 10 "the line to move right" field_is split_at 0.45
xdotool key n
wait_for 30 "the difference" field_is split_mode 1
xdotool key n
wait_for 30 "a band of the difference" field_is split_mode 2
xdotool key n
wait_for 30 "the line again" field_is split_mode 0
tick=$(field tick)
wait_for 30 "a split picture to go on" ticking "$tick"
xdotool key F1 # frees the pointer
wait_for 10 "the panel" field_is panel true
xdotool mousemove --window "$window" 288 300 sleep 0.3 mousedown 1 sleep 0.3 \
    mousemove --window "$window" 160 300 sleep 0.3 mouseup 1
wait_for 10 "the mouse to drag the line" field_is split_at 0.25
xdotool key F1
wait_for 10 "the panel to close" field_is panel false
xdotool key x
wait_for 30 "one picture" field_is split false

# --- files: screenshot, frame, recording ---
xdotool key F12
wait_for 20 "a screenshot" test -s "$work/out/screenshot_000.png"
xdotool key F6
wait_for 20 "a frame file" test -s "$work/out/frame_000.luzf"
xdotool key F5
wait_for 20 "a recording" field_is recording true
xdotool keydown d
wait_for 20 "some recorded ticks" ticking 20
xdotool keyup d
xdotool key F5
wait_for 20 "the recording's end" field_is recording false
test -s "$work/out/recording_000.luzr" || fail "no recording was written"

# --- the picture ---
import -window root "$work/root.png" || fail "no picture of the screen"
measure() { convert "$work/root.png" -crop 640x360+0+0 -colorspace Gray -format "%[fx:$1]" info:; }
mean=$(measure mean)
is "$mean > 0.01" || fail "the window is black (mean $mean)"
spread=$(measure standard_deviation)
is "$spread > 0.01" || fail "the window shows one colour (deviation $spread)"

# --- leaving: Escape frees the mouse, Escape again quits ---
field_is validation 0 || fail "$(field validation) messages of the validation layer"
gone() {
    xdotool key Escape 2>/dev/null
    sleep 0.3
    ! kill -0 "$pid" 2>/dev/null
}
limit=$((SECONDS + 30))
until gone; do [ $SECONDS -ge $limit ] && fail "Escape does not quit"; done
wait "$pid"
code=$?
pid=""
[ $code -eq 0 ] || fail "the demo ended with $code"
grep -q "GPU_VALIDATION" "$log" && fail "messages of the validation layer"

# --- the recording replays, tick for tick, without a window ---
timeout 120 "$demo" --replay "$work/out/recording_000.luzr" --headless >"$work/replay.log" 2>&1 || {
    cat "$work/replay.log"
    fail "the recording does not replay"
}
finish 0

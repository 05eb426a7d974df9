// controls_glfw.c: mouse and gamepad, read once a frame.
//
// Data in: GLFW's cursor position and gamepad state. Data out: pending looks, axes and buttons in
// Controls. Called by: window.c. Does not: read keys (they come as events, so that none is lost).
#include "controls_glfw.h"

void controls_device_capture(ControlsDevice *device, GLFWwindow *window, bool capture) {
    device->captured = capture;
    device->has_last = false;
    glfwSetInputMode(window, GLFW_CURSOR, capture ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported())
        glfwSetInputMode(window, GLFW_RAW_MOUSE_MOTION, capture ? GLFW_TRUE : GLFW_FALSE);
}

static void poll_mouse(ControlsDevice *device, GLFWwindow *window, Controls *controls) {
    f64 x, y;
    glfwGetCursorPos(window, &x, &y);
    if (device->has_last)
        controls_look(controls, (x - device->last_x) * MOUSE_DEG_PER_PX,
                      (device->last_y - y) * MOUSE_DEG_PER_PX);
    device->last_x = x;
    device->last_y = y;
    device->has_last = true;
}

static void poll_gamepad(Controls *controls) {
    GLFWgamepadstate state = {0};
    bool found = false;
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST && !found; id++)
        found = glfwJoystickIsGamepad(id) && glfwGetGamepadState(id, &state);
    if (!found) {
        // Unplugged in mid-walk: nobody goes on walking.
        state = (GLFWgamepadstate){0};
        state.axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER] = state.axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER] =
            -1;
    }
    const f32 *axes = state.axes;
    // Triggers rest at -1.
    f32 rise = (axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER] + 1.0f) * 0.5f;
    f32 sink = (axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER] + 1.0f) * 0.5f;
    controls->pad_move[0] = controls_stick(axes[GLFW_GAMEPAD_AXIS_LEFT_X]);
    controls->pad_move[1] = controls_stick(rise) - controls_stick(sink);
    controls->pad_move[2] = -controls_stick(axes[GLFW_GAMEPAD_AXIS_LEFT_Y]);
    controls->pad_look[0] = controls_stick(axes[GLFW_GAMEPAD_AXIS_RIGHT_X]);
    controls->pad_look[1] = -controls_stick(axes[GLFW_GAMEPAD_AXIS_RIGHT_Y]);
    static const struct {
        u8 pad;
        u32 button;
    } buttons[] = {
        {GLFW_GAMEPAD_BUTTON_A, INPUT_JUMP},         {GLFW_GAMEPAD_BUTTON_LEFT_BUMPER, INPUT_RUN},
        {GLFW_GAMEPAD_BUTTON_LEFT_THUMB, INPUT_RUN}, {GLFW_GAMEPAD_BUTTON_Y, INPUT_FLY},
        {GLFW_GAMEPAD_BUTTON_X, INPUT_USE},          {GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER, INPUT_FIRE},
    };
    u32 held = 0;
    for (u32 i = 0; i < COUNT_OF(buttons); i++)
        if (state.buttons[buttons[i].pad] == GLFW_PRESS) held |= buttons[i].button;
    controls_pad_buttons(controls, held);
}

void controls_device_poll(ControlsDevice *device, GLFWwindow *window, Controls *controls) {
    if (device->captured) poll_mouse(device, window, controls);
    poll_gamepad(controls);
}

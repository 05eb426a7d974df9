// controls_glfw.h: mouse and gamepad of a GLFW window into Controls. Only window.c includes it.
#ifndef LUZ_CONTROLS_GLFW_H
#define LUZ_CONTROLS_GLFW_H
#define GLFW_INCLUDE_NONE
#include "controls.h"
#include <GLFW/glfw3.h>

#define MOUSE_DEG_PER_PX 0.10

typedef struct ControlsDevice {
    bool captured; // the mouse looks
    bool has_last; // the first position after a capture is no movement
    f64 last_x, last_y;
} ControlsDevice;

// The mouse looks (cursor hidden, raw motion where there is such), or is a pointer again.
void controls_device_capture(ControlsDevice *device, GLFWwindow *window, bool capture);
// Once a frame, after glfwPollEvents. Keys come by window.c's key callback.
void controls_device_poll(ControlsDevice *device, GLFWwindow *window, Controls *controls);
#endif

// volk.c: the one place where volk, the loader of Vulkan's functions, is compiled.
#define VOLK_IMPLEMENTATION
#include <volk.h>

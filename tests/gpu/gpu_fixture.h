// gpu_fixture.h: what the tests of the GPU layer share: a validated device on the software driver,
// and one frame that is waited for.
#ifndef LUZ_GPU_FIXTURE_H
#define LUZ_GPU_FIXTURE_H
#include "../test.h"
#include "../../engine/gpu/gpu.h"
#include "../../engine/base/log.h"
#include "../../shaders/shared.h"

// Every user has this driver, and only it gives the same bits everywhere.
void gpu_fixture_pin_driver(void);
// With core and synchronisation validation. Skips the test if there is no device at all.
Gpu *gpu_fixture_create(const char *label);
Gpu *gpu_fixture_create_desc(GpuDesc desc);
// Asserts that the validation layer had nothing to say, and that all named heaps but staging are
// empty (the test has to destroy what it made).
void gpu_fixture_destroy(Gpu *gpu);

GpuBuffer gpu_fixture_readback(Gpu *gpu, u64 size);
// A compute pipeline of test_buffer.comp's kind: layout of these kinds, 16 bytes of push constants.
GpuPipeline gpu_fixture_compute(Gpu *gpu, const char *shader, GpuBindLayout layout, u32 spec_count,
                                const u32 *spec);
GpuBindLayout gpu_fixture_layout(Gpu *gpu, GpuBindingKind first, GpuBindingKind second, u32 count);
// Moves a texture to a usage in a frame of its own.
void gpu_fixture_texture_to(Gpu *gpu, GpuTexture texture, GpuUsage from, GpuUsage to);
#endif

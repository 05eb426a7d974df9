// depth_read.glsl: the depth buffer, of one or (MULTISAMPLED defined) of SAMPLES samples a pixel.
#ifdef MULTISAMPLED
layout(set = 0, binding = BINDING_DEPTH_MS) uniform sampler2DMS depth_ms;
float depth_read(ivec2 pixel, uint at) { return texelFetch(depth_ms, pixel, int(at)).x; }
#else
layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D gbuffer_depth;
float depth_read(ivec2 pixel, uint at) { return texelFetch(gbuffer_depth, pixel, 0).x; }
#endif

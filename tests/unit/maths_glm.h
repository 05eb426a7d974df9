// maths_glm.h: an independent second opinion on matrices: GLM (C++), behind C functions.
#ifndef LUZ_TEST_MATHS_GLM_H
#define LUZ_TEST_MATHS_GLM_H
#ifdef __cplusplus
extern "C" {
#endif
// All matrices are column-major float[16].
void oracle_mul(const float a[16], const float b[16], float out[16]);
void oracle_inverse(const float a[16], float out[16]);
void oracle_transpose(const float a[16], float out[16]);
void oracle_mul_vec4(const float a[16], const float v[4], float out[4]);
// Right-handed, depth 0..1, not reversed.
void oracle_ortho(float left, float right, float bottom, float top, float near_z, float far_z,
                  float out[16]);
void oracle_perspective(float fov_y_rad, float aspect, float near_z, float far_z, float out[16]);
// translate * rotate y * rotate x * rotate z * scale, angles in degrees.
void oracle_trs(const float position[3], const float rotation_deg[3], const float scale[3],
                float out[16]);
float oracle_srgb_to_linear(float encoded);
#ifdef __cplusplus
}
#endif
#endif

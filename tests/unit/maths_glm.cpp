// maths_glm.cpp: GLM as the oracle of base_maths.c.
// Data in, data out: column-major floats. Called by: tests. Does not: share code with the engine.
#define GLM_FORCE_RADIANS
#include "maths_glm.h"
#include <cstring>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/color_space.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

static void put(const glm::mat4 &m, float out[16]) {
    std::memcpy(out, glm::value_ptr(m), 16 * sizeof(float));
}

void oracle_mul(const float a[16], const float b[16], float out[16]) {
    put(glm::make_mat4(a) * glm::make_mat4(b), out);
}
void oracle_inverse(const float a[16], float out[16]) {
    // In double: the oracle should be better than what it judges.
    put(glm::mat4(glm::inverse(glm::dmat4(glm::make_mat4(a)))), out);
}
void oracle_transpose(const float a[16], float out[16]) {
    put(glm::transpose(glm::make_mat4(a)), out);
}
void oracle_mul_vec4(const float a[16], const float v[4], float out[4]) {
    glm::vec4 r = glm::make_mat4(a) * glm::make_vec4(v);
    std::memcpy(out, glm::value_ptr(r), sizeof r);
}
void oracle_ortho(float left, float right, float bottom, float top, float near_z, float far_z,
                  float out[16]) {
    put(glm::orthoRH_ZO(left, right, bottom, top, near_z, far_z), out);
}
void oracle_perspective(float fov_y_rad, float aspect, float near_z, float far_z, float out[16]) {
    put(glm::perspectiveRH_ZO(fov_y_rad, aspect, near_z, far_z), out);
}
void oracle_trs(const float position[3], const float rotation_deg[3], const float scale[3],
                float out[16]) {
    glm::dmat4 m = glm::translate(glm::dmat4(1), glm::dvec3(glm::make_vec3(position)));
    m = glm::rotate(m, glm::radians((double)rotation_deg[1]), glm::dvec3(0, 1, 0));
    m = glm::rotate(m, glm::radians((double)rotation_deg[0]), glm::dvec3(1, 0, 0));
    m = glm::rotate(m, glm::radians((double)rotation_deg[2]), glm::dvec3(0, 0, 1));
    put(glm::mat4(glm::scale(m, glm::dvec3(glm::make_vec3(scale)))), out);
}
float oracle_srgb_to_linear(float encoded) {
    return (float)glm::convertSRGBToLinear(glm::dvec3(encoded)).x;
}

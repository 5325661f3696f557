/* A controller in miniature with the contract of emitted C, written by hand for the tests of the proofs. */
#ifndef HOVER_H
#define HOVER_H

#include <stdint.h>

typedef struct {
    float g1;
    float g2;
    float r;
} hover_input_t;

typedef struct {
    float i1;
    float i2;
} hover_output_t;

typedef struct {
    float last_g1;
    float last_g2;
    float last_r;
    uint32_t bad_g1;
    uint32_t bad_g2;
    uint32_t latched;
    float xi;
    float v;
    float safe_i1;
    float safe_i2;
} hover_state_t;

void hover_init(hover_state_t *state);
uint32_t hover_step(hover_state_t *state, const hover_input_t *in, hover_output_t *out);

#endif

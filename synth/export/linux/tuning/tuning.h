/* Files of parameters: the constants of the controller that are tuned on the running machine, and their check. */
#ifndef TUNING_H
#define TUNING_H

#include <stddef.h>

#include "stage.h"

/* Read a file, `name = value` a line, the check last, and let the controller's own function judge it. Return 0, or -1
 * after a message, with `parameters` unchanged. */
int tuning_read(const char *path, stage_parameters_t *parameters, char *message, size_t size);

/* Write a new file that reads back to the same bits. Return 0, or an errno. */
int tuning_write(const char *path, const stage_parameters_t *parameters);

/* Print the check and the values, `separator` before each. Return 0, or -1 where they do not fit. */
int tuning_text(const stage_parameters_t *parameters, const char *separator, char *text, size_t size);

/* 1 for the values of the declared design. */
int tuning_is_default(const stage_parameters_t *parameters);

#endif

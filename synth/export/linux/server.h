/* Commands over a Unix socket that serves its owner alone: a line in, a line out. */
#ifndef SERVER_H
#define SERVER_H

#include "exchange.h"

/* Make the socket and start the thread that serves it. Return 0, or -1 after a message. */
int server_start(const char *path, exchange_t *exchange);

/* End the thread and remove the socket. */
void server_finish(void);

/* The names of the bits of a fault word, with commas; "-" for none. */
void fault_text(uint32_t faults, char *text, size_t size);

#endif

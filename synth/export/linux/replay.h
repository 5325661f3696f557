/* The vectors of the emitted steps, bit for bit: what was verified is what runs here. */
#ifndef REPLAY_H
#define REPLAY_H

/* Replay every step from `folder`/<name>.bin. Return 0 where all bits of outputs and fault words are equal. */
int replay(const char *folder);

#endif

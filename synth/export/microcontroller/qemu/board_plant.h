#ifndef BOARD_PLANT_H
#define BOARD_PLANT_H

/* Put the simulated plant to where the stage starts. */
void board_start(void);

#endif

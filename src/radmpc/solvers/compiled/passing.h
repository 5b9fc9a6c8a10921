/* What moves along a route cost where another vehicle passes by. */
#ifndef RADMPC_PASSING_H
#define RADMPC_PASSING_H

#include <stddef.h>

/* A route, by places at even distances, and where somebody else is at each step: (places, 2), (steps + 1, 2) [m]. */
typedef struct {
    int places, steps, moves; /* moves by 0, 1, ... places from each */
    const double *route, *path;
    double apart, touching; /* distance to keep, and below which no move is possible [m] */
    double price;           /* of a meter that is missed */
    int is_along;           /* whether distances count all along a move, not only where it ends */
} Passing;

/* The steps and places from which any move costs something, and what each costs, (count, moves). */
typedef struct {
    long long *steps, *places;
    double *costs;
    size_t count, room;
} Costs;

/* 0 where there is no memory; what it fills is to be freed by `costs_free` in any case. */
int passing_measure(const Passing *passing, Costs *into);
void costs_free(Costs *costs);

#endif

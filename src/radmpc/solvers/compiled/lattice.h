/* Values over a lattice of positions and displacements, and the slack that obstacles leave there. */
#ifndef RADMPC_LATTICE_H
#define RADMPC_LATTICE_H

#include <stddef.h>

/* Numbered by displacement along each axis, then by row and column of the position. */
typedef struct {
    int width;         /* displacements along each axis, an odd number */
    int rows, columns; /* positions along each axis */
    float infeasible;  /* value of what is not allowed */
} Lattice;

/* Positions from a row and column to below others. */
typedef struct {
    int row, row_end, column, column_end;
} Box;

/* A half-plane a x + b y <= c at the begin of a displacement, or at its end. */
typedef struct {
    double a, b, c;
} HalfPlane;

/* What bounds the end points of displacements from a position, by alternatives. */
typedef struct {
    int count;
    const HalfPlane *here, *ahead;
    const double *x, *y;             /* (rows), (columns) */
    const double *x_ahead, *y_ahead; /* (rows + width - 1), (columns + width - 1): from the least displacement on */
    double longest[2];               /* displacement along each axis [m] */
    double least, little;            /* slack below which it is blocked, and below which it is near [m] */
} Obstacle;

/* Displacements that are near an obstacle: a bit where blocked, else its number and slack. */
typedef struct {
    unsigned char *bits;
    unsigned *numbers;
    float *values;
    size_t count, room;
    int is_blocked;
} Slacks;

/* 0 where there is no memory; what it fills is to be freed by `slacks_free` in any case. */
int lattice_measure(const Lattice *lattice, const Obstacle *obstacle, Slacks *into);
void slacks_free(Slacks *slacks);

/* The least value over all last displacements along an axis, by next one; beside the box nothing is read
 * or written. */
void lattice_change(const Lattice *lattice, const Box *box, const float *values, const float *table, int axis,
                    float *into);

/* What a move costs besides the displacement. */
typedef struct {
    const float *risks;
    const unsigned char *blocked; /* a bit each */
    float weight, most;           /* cost of risk, and the risk that is allowed */
    float late;                   /* cost of ending outside of a box */
    Box in_time;
} Toll;

/* Values at the positions that displacements lead to, from a box to a box: only that is written. 0 where there is no
 * memory. */
int lattice_move(const Lattice *lattice, const Box *from, const Box *to, const Toll *toll, const float *values,
                 float *into);

#endif

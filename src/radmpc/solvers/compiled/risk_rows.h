/* Chance rows in a linear program: tangents to their risk, which a column each allocates. */
#ifndef RADMPC_RISK_ROWS_H
#define RADMPC_RISK_ROWS_H

#include "lp.h"
#include "rating.h"

/* One row of the linear program that is part of a chance row; a tangent, if that has noise. */
typedef struct {
    int number, next; /* its number there; the next part of the same chance row, -1: none */
    double lower, clearance;
} RowPart;

/* A proven bound of some blocks: its row, and whether it is of a block. */
typedef struct {
    const int *rows;
    const char *has_block; /* (count, num_blocks) */
    int count, num_blocks;
} BoundRows;

typedef struct {
    Lp *lp;
    const Ratings *ratings;
    const double *deviations;
    const int *blocks; /* of the decision variables */
    BoundRows bounds;
    int num_columns, budget_row;
    double unit, price, row_scale, row_cap;
    double floor, flat; /* clearances: the least, and from which on a tangent is no use */
    const double *first_clearances, *first_slopes, *first_heights;
    int num_first;

    int *head;   /* first part of each chance row, -1 where it has none */
    int *column; /* of each event, -1 where it has none */
    char *is_active, *is_target;
    int *active, num_active, *target, num_target;
    RowPart *parts;
    int num_parts, part_room;
    double *dense, *values; /* a row over the columns; its entries */
    double *entries;        /* those of a tangent */
    int *touched, num_touched;
    double *missing;
    int *noisy;
} RiskRows;

int risk_rows_reserve(RiskRows *rows);
void risk_rows_release(RiskRows *rows);

/* Have alternatives on, and no others; -1 without memory, 0 (and nothing done) where the linear
 * program has more rows than `crowd` and `crowd_each` per row wanted. */
int risk_rows_activate(RiskRows *rows, int count, const int *alternatives, int crowd, int crowd_each);

/* Add tangents where columns underestimate the risk of active rows, if by more than `tolerance`
 * [units] in all; -1 without memory, else how many. */
int risk_rows_refine(RiskRows *rows, const double *clearances, const double *point, double tolerance);

#endif

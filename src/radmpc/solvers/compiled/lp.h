/* A linear program with bounded columns, grown by rows and columns, solved warm.
 *
 *     min c.x   over   L <= A x <= U,  l <= x <= u
 *
 * A basis is held as the rows that are active (at one of their bounds) and as many columns that are
 * basic (between theirs); all other columns are at a bound. With M = A[active, basic] only the
 * inverse of M is kept: few rows of such programs are active at a vertex, however many there are.
 */
#ifndef RADMPC_LP_H
#define RADMPC_LP_H

#include <math.h>
#include <stddef.h>

#define AT_LOWER (-1)
#define AT_UPPER (-2)
#define INACTIVE (-1)

typedef enum { LP_OPTIMAL = 0, LP_INFEASIBLE = 1, LP_CUTOFF = 2, LP_FAILED = 3, LP_NO_MEMORY = 4 } Outcome;

/* The entries of one row (indices are columns), or of one column (indices are rows). */
typedef struct {
    int *indices;
    double *values;
    int size, room;
} Entries;

/* A basis that was begun with, to begin with again. */
typedef struct {
    int asked, size, room; /* rows asked for (-1: none), rows that were independent */
    int *rows, *columns;   /* as asked for */
    int *active, *basic;   /* as factored */
    double *inverse;       /* (size, size) */
} Saved;

typedef struct {
    int num_columns, column_room;
    double *cost, *lower, *upper;
    double *x, *reduced, *along; /* values, reduced costs, a row of the tableau */
    double *shift;               /* by how much values change */
    int *column_at;              /* a position among the basic ones, AT_LOWER or AT_UPPER */
    Entries *columns;

    int num_rows, row_room;
    Entries *rows;
    double *row_lower, *row_upper, *row_scale;
    double *activity;
    int *row_at; /* a position among the active ones, or INACTIVE */
    char *at_upper;
    int *on; /* rows that bound anything */
    int num_on;

    int size, basis_room; /* active rows, and basic columns */
    int *active, *basic;
    double *inverse;     /* (basic, active), `basis_room` apart */
    double *multipliers; /* of the active rows */
    double *row_side, *column_side, *spare; /* vectors of `size` */

    double *candidate_ratio, *candidate_pivot;
    int *candidate;
    int candidate_room;

    Saved saved;
    double tolerance; /* of feasibility, primal and dual */
    int is_contradictory;
    long pivots;
    int is_exact; /* whether values are those of the inverse, not moved along since */
    int updates; /* since the inverse was computed anew */
} Lp;

/* memory.c: programs and what they hold */
Lp *lp_new(int num_columns, const double *cost, const double *lower, const double *upper, double tolerance);
void lp_free(Lp *lp);
int lp_add_row(Lp *lp, int size, const int *columns, const double *values, double lower, double upper);
int lp_add_column(Lp *lp, double cost, double upper, int size, const int *rows, const double *values);
int lp_reserve_basis(Lp *lp, int size);
void lp_leave_basis(Lp *lp);
int lp_begin_with(Lp *lp, int size, const int *rows, const int *columns);

/* basis.c: the inverse, changed by one exchange at a time */
double *lp_inverse_row(const Lp *lp, int position);
void lp_times_inverse(const Lp *lp, const double *by_column, double *by_row);
void lp_inverse_times(const Lp *lp, const double *by_row, double *by_column);
void lp_swap_columns(Lp *lp, int position, int column, const double *column_side);
void lp_swap_rows(Lp *lp, int position, int row, const double *row_side);
int lp_extend(Lp *lp, int row, int column, const double *row_side, const double *column_side, double pivot);
void lp_shrink(Lp *lp, int column_position, int row_position);
int lp_factor(Lp *lp);
double lp_column_in_active(const Lp *lp, int column, int row, double *by_row);

/* vertex.c: values and prices of a basis */
int lp_is_fixed(const Lp *lp, int row);
double lp_bound_of(const Lp *lp, int row);
void lp_price(Lp *lp);
int lp_make_dual_feasible(Lp *lp);
void lp_compute_vertex(Lp *lp);
double lp_cost_of_vertex(const Lp *lp);
void lp_move(Lp *lp, int column, double by);
double lp_residual(const Lp *lp);

/* ratio.c: what leaves, and what enters */
/* What leaves: the basic column or the row that is farthest beyond a bound. */
typedef struct {
    int is_row, index; /* a row, or the position of a basic column */
    double missing;    /* > 0: must grow; < 0: must shrink */
} Leaving;

Leaving lp_choose_leaving(const Lp *lp);
void lp_compute_tableau_row(Lp *lp, Leaving leaving);
int lp_gather_candidates(Lp *lp, double sign, double smallest);
int lp_choose_entering(Lp *lp, int count, double slope, int *num_passed);

/* dual.c: the search for a vertex */
Outcome lp_solve(Lp *lp, double cutoff, long most, double *bound);

/* proof.c: what multipliers prove */
double lp_proven(const Lp *lp, int count, const int *rows, const double *multipliers, int with_cost,
                 double *scratch);

#endif

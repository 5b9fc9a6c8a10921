/* The dual simplex method for bounded variables, with a long step ratio test.
 *
 * Columns are bounded, so that any basis becomes dual feasible once every other column is at the
 * bound that its reduced cost asks for (Koberstein 2005, section 4); only rows with one bound may
 * have a multiplier of the wrong sign, and are then left. */
#include "lp.h"

#include <stdlib.h>
#include <string.h>

#define BEYOND 1e-7       /* share of the cutoff by which the search goes beyond it, to prove it */
#define SMALL 1e-9        /* entries of a tableau row that are none, in units of the row's norm */
#define WEAK_PIVOT 1e-6   /* pivots for which the inverse is first computed anew */
#define DRIFT 1e-7        /* relative error of a pivot from which on it is, too */
#define MOST_UPDATES 120  /* exchanges after which it is in any case */
#define MOST_RETURNS 12   /* times that a vertex may prove to be none */

/* Move what was passed to its other bound; basic columns follow. */
static void move_passed(Lp *lp, int count, int num_passed) {
    if (!num_passed) return;
    memset(lp->spare, 0, (size_t)lp->size * sizeof *lp->spare);
    for (int c = count - num_passed; c < count; c++) {
        int index = lp->candidate[c];
        if (index < 0) {
            int row = lp->active[-1 - index];
            double range = lp->row_upper[row] - lp->row_lower[row];
            lp->spare[-1 - index] += lp->at_upper[row] ? -range : range;
            lp->at_upper[row] = !lp->at_upper[row];
            continue;
        }
        double range = lp->upper[index] - lp->lower[index];
        double by = lp->column_at[index] == AT_LOWER ? range : -range;
        lp->column_at[index] = by > 0.0 ? AT_UPPER : AT_LOWER;
        const Entries *entries = &lp->columns[index];
        for (int e = 0; e < entries->size; e++) {
            int at = lp->row_at[entries->indices[e]];
            if (at >= 0) lp->spare[at] -= entries->values[e] * by;
        }
        lp_move(lp, index, by);
    }
    lp_inverse_times(lp, lp->spare, lp->column_side);
    for (int p = 0; p < lp->size; p++) lp_move(lp, lp->basic[p], lp->column_side[p]);
}

/* Whether the rows of what leaves prove that there is no point: it can move no further. */
static int is_proven_infeasible(Lp *lp, Leaving leaving, double *scratch) {
    int count = lp->size + leaving.is_row;
    int *rows = malloc((size_t)(count + 1) * sizeof *rows);
    double *ray = malloc((size_t)(count + 1) * sizeof *ray);
    int is_proven = 0;
    if (rows && ray) {
        double sign = leaving.missing > 0.0 ? 1.0 : -1.0;
        for (int i = 0; i < lp->size; i++) {
            rows[i] = lp->active[i];
            ray[i] = -sign * lp->row_side[i];
        }
        if (leaving.is_row) {
            rows[lp->size] = leaving.index;
            ray[lp->size] = sign;
        }
        is_proven = lp_proven(lp, count, rows, ray, 0, scratch) > 0.0;
    }
    free(rows);
    free(ray);
    return is_proven;
}

/* What is left to be moved of what leaves. */
static double missing_of(const Lp *lp, Leaving leaving) {
    int to_upper = leaving.missing < 0.0;
    if (leaving.is_row)
        return (to_upper ? lp->row_upper : lp->row_lower)[leaving.index] - lp->activity[leaving.index];
    int column = lp->basic[leaving.index];
    return (to_upper ? lp->upper : lp->lower)[column] - lp->x[column];
}

/* Exchange what leaves for what enters; 0 where the pivot cannot be trusted, -1 without memory. */
static int exchange(Lp *lp, Leaving leaving, int entering, int count, int num_passed) {
    double *by_column = lp->shift; /* how basic columns follow what enters, by position */
    double pivot = entering >= 0 ? lp->along[entering] : lp->row_side[-1 - entering];
    int row = entering >= 0 ? -1 : -1 - entering;
    move_passed(lp, count, num_passed);
    if (entering >= 0) {
        double entry = lp_column_in_active(lp, entering, leaving.is_row ? leaving.index : -1, lp->spare);
        lp_inverse_times(lp, lp->spare, lp->column_side);
        double other = leaving.is_row ? entry : -lp->column_side[leaving.index];
        for (int i = 0; leaving.is_row && i < lp->size; i++) other -= lp->row_side[i] * lp->spare[i];
        if (fabs(other - pivot) > DRIFT * (fabs(pivot) + 1e-3) && lp->updates) return 0;
        pivot = other;
        for (int p = 0; p < lp->size; p++) by_column[p] = -lp->column_side[p];
    } else {
        for (int p = 0; p < lp->size; p++) by_column[p] = lp_inverse_row(lp, p)[row];
    }
    if (pivot == 0.0) return 0;
    double by = missing_of(lp, leaving) / pivot;
    for (int p = 0; p < lp->size; p++) lp_move(lp, lp->basic[p], by * by_column[p]);
    if (entering >= 0) lp_move(lp, entering, by);
    else lp->activity[lp->active[row]] = lp_bound_of(lp, lp->active[row]) + by;
    double step = (entering >= 0 ? lp->reduced[entering] : lp->multipliers[row]) / pivot;
    if (step != 0.0) {
        for (int j = 0; j < lp->num_columns; j++)
            if (lp->column_at[j] < 0) lp->reduced[j] -= step * lp->along[j];
        for (int i = 0; i < lp->size; i++) lp->multipliers[i] -= step * lp->row_side[i];
    }
    int to_upper = leaving.missing < 0.0;
    if (leaving.is_row) lp->at_upper[leaving.index] = (char)to_upper;
    if (leaving.is_row && entering >= 0) {
        if (!lp_extend(lp, leaving.index, entering, lp->row_side, lp->column_side, pivot)) return -1;
        lp->multipliers[lp->size - 1] = step;
    } else if (leaving.is_row) {
        lp_swap_rows(lp, row, leaving.index, lp->row_side);
        lp->multipliers[row] = step;
    } else {
        int column = lp->basic[leaving.index];
        if (entering >= 0) {
            lp_swap_columns(lp, leaving.index, entering, lp->column_side);
        } else {
            lp_shrink(lp, leaving.index, row);
            lp->multipliers[row] = lp->multipliers[lp->size];
        }
        lp->column_at[column] = to_upper ? AT_UPPER : AT_LOWER;
        lp->x[column] = to_upper ? lp->upper[column] : lp->lower[column];
        lp->reduced[column] = step;
    }
    if (entering >= 0) lp->reduced[entering] = 0.0;
    lp->is_exact = 0;
    return 1;
}

static int begin(Lp *lp) {
    lp->num_on = 0;
    for (int i = 0; i < lp->num_rows; i++)
        if (isfinite(lp->row_lower[i]) || isfinite(lp->row_upper[i])) lp->on[lp->num_on++] = i;
    return lp_reserve_basis(lp, lp->size + 1);
}

/* Compute the inverse anew and begin where that leads. */
static int begin_again(Lp *lp) {
    if (!lp_factor(lp) || !lp_make_dual_feasible(lp)) return 0;
    lp_compute_vertex(lp);
    return 1;
}

static Outcome search(Lp *lp, double cutoff, long most, double *scratch, double *bound) {
    double stop = cutoff + BEYOND * fabs(cutoff);
    int returns = 0;
    if (!lp_make_dual_feasible(lp)) {
        /* An unbounded column wants to grow: no active rows, then, as costs are mostly >= 0. */
        lp_leave_basis(lp);
        if (!lp_make_dual_feasible(lp)) return LP_FAILED;
    }
    lp_compute_vertex(lp);
    for (long last = lp->pivots + most; lp->pivots < last;) {
        if (lp->updates > MOST_UPDATES && !begin_again(lp)) return LP_FAILED;
        if (isfinite(stop) && lp_cost_of_vertex(lp) >= stop) {
            *bound = lp_proven(lp, lp->size, lp->active, lp->multipliers, 1, scratch);
            if (*bound >= cutoff) {
                return LP_CUTOFF;
            }
            stop = INFINITY;
        }
        Leaving leaving = lp_choose_leaving(lp);
        if (leaving.index < 0) {
            if (!lp->is_exact) {
                /* Values were moved along: as they are by the inverse. */
                lp_compute_vertex(lp);
                continue;
            }
            if (lp->updates && lp_residual(lp) > lp->tolerance) {
                if (++returns > MOST_RETURNS || !begin_again(lp)) return LP_FAILED;
                continue;
            }
            lp_price(lp);
            double cost = lp_cost_of_vertex(lp);
            *bound = lp_proven(lp, lp->size, lp->active, lp->multipliers, 1, scratch);
            int is_tight = cost - *bound <= 1e-6 * fmax(1.0, fabs(cost)) || !isfinite(*bound);
            if (is_tight || ++returns > MOST_RETURNS) return LP_OPTIMAL;
            if (!begin_again(lp)) return LP_FAILED;
            continue;
        }
        lp_compute_tableau_row(lp, leaving);
        double norm = leaving.is_row ? 1.0 / lp->row_scale[leaving.index] : 1.0;
        int count = lp_gather_candidates(lp, leaving.missing > 0.0 ? 1.0 : -1.0, SMALL * norm);
        int passed = 0;
        int best = lp_choose_entering(lp, count, fabs(leaving.missing), &passed);
        if (best < 0) {
            if (is_proven_infeasible(lp, leaving, scratch)) {
                *bound = INFINITY;
                return LP_INFEASIBLE;
            }
            if (!lp->updates || ++returns > MOST_RETURNS || !begin_again(lp)) return LP_FAILED;
            continue;
        }
        int is_weak = lp->candidate_pivot[best] < WEAK_PIVOT * norm && lp->updates;
        int done = is_weak ? 0 : exchange(lp, leaving, lp->candidate[best], count, passed);
        if (done < 0) return LP_NO_MEMORY;
        if (!done) {
            if (++returns > MOST_RETURNS || !begin_again(lp)) return LP_FAILED;
            continue;
        }
        lp->pivots++;
    }
    return LP_FAILED;
}

Outcome lp_solve(Lp *lp, double cutoff, long most, double *bound) {
    *bound = -INFINITY;
    if (lp->is_contradictory) {
        *bound = INFINITY;
        return LP_INFEASIBLE;
    }
    double *scratch = malloc(2 * ((size_t)lp->num_columns + 1) * sizeof *scratch);
    if (!scratch || !begin(lp)) {
        free(scratch);
        return LP_NO_MEMORY;
    }
    Outcome outcome = search(lp, cutoff, most, scratch, bound);
    if (outcome == LP_FAILED) {
        double best = lp_proven(lp, 0, NULL, NULL, 1, scratch);
        if (best > *bound) *bound = best;
        lp_leave_basis(lp);
    }
    free(scratch);
    return outcome;
}

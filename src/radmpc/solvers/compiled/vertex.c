/* The vertex of a basis: multipliers and reduced costs, values and activities. */
#include "lp.h"

#include <string.h>

int lp_is_fixed(const Lp *lp, int row) { return lp->row_lower[row] == lp->row_upper[row]; }

double lp_bound_of(const Lp *lp, int row) {
    return lp->at_upper[row] ? lp->row_upper[row] : lp->row_lower[row];
}

/* Compute multipliers and reduced costs from the inverse. */
void lp_price(Lp *lp) {
    for (int p = 0; p < lp->size; p++) lp->column_side[p] = lp->cost[lp->basic[p]];
    lp_times_inverse(lp, lp->column_side, lp->multipliers);
    memcpy(lp->reduced, lp->cost, (size_t)lp->num_columns * sizeof(double));
    for (int i = 0; i < lp->size; i++) {
        double y = lp->multipliers[i];
        if (y == 0.0) continue;
        const Entries *row = &lp->rows[lp->active[i]];
        for (int e = 0; e < row->size; e++) lp->reduced[row->indices[e]] -= y * row->values[e];
    }
    for (int p = 0; p < lp->size; p++) lp->reduced[lp->basic[p]] = 0.0;
}

/* Whether an active row may stay so; moved to its other bound where that is the right one. */
static int is_held(Lp *lp, int position) {
    int row = lp->active[position];
    if (lp_is_fixed(lp, row)) return 1;
    double y = lp->multipliers[position];
    int has_lower = isfinite(lp->row_lower[row]), has_upper = isfinite(lp->row_upper[row]);
    if (!has_lower && !has_upper) return 0;
    if (lp->at_upper[row] ? !has_upper : !has_lower) lp->at_upper[row] = !lp->at_upper[row];
    int is_wrong = lp->at_upper[row] ? y > lp->tolerance : y < -lp->tolerance;
    if (!is_wrong) return 1;
    if (!has_lower || !has_upper) return 0;
    lp->at_upper[row] = !lp->at_upper[row];
    return 1;
}

/* Leave rows that are off or have a multiplier of the wrong sign, then put every column at the
 * bound that its reduced cost asks for; 0 where there is none. */
int lp_make_dual_feasible(Lp *lp) {
    lp_price(lp);
    for (int i = 0; i < lp->size;) {
        if (is_held(lp, i)) {
            i++;
            continue;
        }
        int best = 0;
        for (int p = 1; p < lp->size; p++)
            if (fabs(lp_inverse_row(lp, p)[i]) > fabs(lp_inverse_row(lp, best)[i])) best = p;
        int column = lp->basic[best];
        lp_shrink(lp, best, i);
        lp->column_at[column] = AT_LOWER;
        lp_price(lp);
        i = 0;
    }
    for (int j = 0; j < lp->num_columns; j++) {
        int *at = &lp->column_at[j];
        if (*at >= 0) continue;
        if (lp->reduced[j] > lp->tolerance) *at = AT_LOWER;
        if (lp->reduced[j] < -lp->tolerance) *at = AT_UPPER;
        if (*at == AT_LOWER && !isfinite(lp->lower[j])) *at = AT_UPPER;
        if (*at == AT_UPPER && !isfinite(lp->upper[j])) {
            if (!isfinite(lp->lower[j]) || lp->reduced[j] < -lp->tolerance) return 0;
            *at = AT_LOWER;
        }
    }
    return 1;
}

/* Four sums at a time: one waits for the addition before it. */
static double activity_of(const Lp *lp, int row) {
    const Entries *entries = &lp->rows[row];
    const int *columns = entries->indices;
    const double *values = entries->values, *x = lp->x;
    double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
    int e = 0;
    for (; e + 4 <= entries->size; e += 4) {
        a += values[e] * x[columns[e]];
        b += values[e + 1] * x[columns[e + 1]];
        c += values[e + 2] * x[columns[e + 2]];
        d += values[e + 3] * x[columns[e + 3]];
    }
    for (; e < entries->size; e++) a += values[e] * x[columns[e]];
    return (a + b) + (c + d);
}

/* Compute the vertex. */
void lp_compute_vertex(Lp *lp) {
    for (int j = 0; j < lp->num_columns; j++)
        lp->x[j] = lp->column_at[j] >= 0             ? 0.0
                   : lp->column_at[j] == AT_LOWER ? lp->lower[j]
                                                    : lp->upper[j];
    for (int i = 0; i < lp->size; i++)
        lp->row_side[i] = lp_bound_of(lp, lp->active[i]) - activity_of(lp, lp->active[i]);
    lp_inverse_times(lp, lp->row_side, lp->column_side);
    for (int p = 0; p < lp->size; p++) lp->x[lp->basic[p]] = lp->column_side[p];
    for (int o = 0; o < lp->num_on; o++) {
        int i = lp->on[o];
        lp->activity[i] = lp->row_at[i] == INACTIVE ? activity_of(lp, i) : lp_bound_of(lp, i);
    }
    lp->is_exact = 1;
}

double lp_cost_of_vertex(const Lp *lp) {
    double cost = 0.0;
    for (int j = 0; j < lp->num_columns; j++) cost += lp->cost[j] * lp->x[j];
    return cost;
}

/* Move a column's value, and the rows along. */
void lp_move(Lp *lp, int column, double by) {
    if (by == 0.0) return;
    const Entries *entries = &lp->columns[column];
    lp->x[column] += by;
    for (int e = 0; e < entries->size; e++) lp->activity[entries->indices[e]] += entries->values[e] * by;
}

/* How far the vertex is from the bounds of its active rows at the most. */
double lp_residual(const Lp *lp) {
    double largest = 0.0;
    for (int i = 0; i < lp->size; i++) {
        double miss = fabs(activity_of(lp, lp->active[i]) - lp_bound_of(lp, lp->active[i]));
        if (!(miss <= largest)) largest = miss;
    }
    return largest;
}


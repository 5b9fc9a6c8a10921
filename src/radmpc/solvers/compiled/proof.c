/* What multipliers of rows prove, whatever they came from and however they were rounded. */
#include "lp.h"

#include <float.h>
#include <string.h>

/* For any y and r = c - y A,
 *
 *     min c.x  >=  sum_i y_i (L_i if y_i > 0 else U_i) + sum_j min(r_j l_j, r_j u_j)
 *
 * (Neumaier and Shcherbina 2004), lowered by twice what the evaluation may round. Multipliers on an
 * infinite bound prove nothing and are left out. `scratch` holds two numbers per column. */
double lp_proven(const Lp *lp, int count, const int *rows, const double *multipliers, int with_cost,
                 double *scratch) {
    double *by_column = scratch, *magnitude = scratch + lp->num_columns;
    memset(scratch, 0, 2 * (size_t)lp->num_columns * sizeof *scratch);
    double value = 0.0, size = 0.0;
    long terms = 8 + lp->num_columns;
    for (int i = 0; i < count; i++) {
        double y = multipliers[i];
        double bound = y > 0.0 ? lp->row_lower[rows[i]] : lp->row_upper[rows[i]];
        if (y == 0.0 || !isfinite(bound)) continue;
        value += y * bound;
        size += fabs(y * bound);
        const Entries *row = &lp->rows[rows[i]];
        for (int e = 0; e < row->size; e++) {
            double term = y * row->values[e];
            by_column[row->indices[e]] += term;
            magnitude[row->indices[e]] += fabs(term);
        }
        terms++;
    }
    for (int j = 0; j < lp->num_columns; j++) {
        double cost = with_cost ? lp->cost[j] : 0.0;
        double reduced = cost - by_column[j];
        if (reduced == 0.0 && magnitude[j] == 0.0) continue;
        double largest = fmax(fabs(lp->lower[j]), fabs(lp->upper[j]));
        value += fmin(reduced * lp->lower[j], reduced * lp->upper[j]);
        size += (fabs(cost) + magnitude[j]) * largest;
    }
    value -= (double)terms * DBL_EPSILON * size;
    return isfinite(value) ? value : -INFINITY;
}

/* Which column or row leaves a bound behind, and which takes its place. */
#include "lp.h"

#include <string.h>

Leaving lp_choose_leaving(const Lp *lp) {
    Leaving found = {0, -1, 0.0};
    double largest = 0.0;
    for (int p = 0; p < lp->size; p++) {
        int j = lp->basic[p];
        double missing = lp->x[j] < lp->lower[j] ? lp->lower[j] - lp->x[j]
                         : lp->x[j] > lp->upper[j] ? lp->upper[j] - lp->x[j]
                                                   : 0.0;
        if (fabs(missing) <= lp->tolerance || fabs(missing) <= largest) continue;
        largest = fabs(missing);
        found = (Leaving){0, p, missing};
    }
    for (int o = 0; o < lp->num_on; o++) {
        int i = lp->on[o];
        if (lp->row_at[i] != INACTIVE) continue;
        double at = lp->activity[i];
        double missing = at < lp->row_lower[i]   ? lp->row_lower[i] - at
                         : at > lp->row_upper[i] ? lp->row_upper[i] - at
                                                 : 0.0;
        if (fabs(missing) <= lp->tolerance) continue;
        double scaled = fabs(missing) * lp->row_scale[i];
        if (scaled <= largest) continue;
        largest = scaled;
        found = (Leaving){1, i, missing};
    }
    return found;
}

/* Compute what leaves as a function of what does not: of columns in `along`, of the bounds of active
 * rows in `row_side`. */
void lp_compute_tableau_row(Lp *lp, Leaving leaving) {
    double *along = lp->along, *by_row = lp->row_side;
    memset(along, 0, (size_t)lp->num_columns * sizeof *along);
    if (leaving.is_row) {
        const Entries *row = &lp->rows[leaving.index];
        for (int e = 0; e < row->size; e++) along[row->indices[e]] += row->values[e];
        for (int p = 0; p < lp->size; p++) lp->spare[p] = along[lp->basic[p]];
        lp_times_inverse(lp, lp->spare, by_row);
    } else {
        memcpy(by_row, lp_inverse_row(lp, leaving.index), (size_t)lp->size * sizeof *by_row);
    }
    for (int i = 0; i < lp->size; i++) {
        double share = by_row[i];
        if (share == 0.0) continue;
        const Entries *row = &lp->rows[lp->active[i]];
        for (int e = 0; e < row->size; e++) along[row->indices[e]] -= share * row->values[e];
    }
}

/* Gather what may enter: what can move so that what leaves moves to its bound. Rows count from -1
 * down, by position. */
int lp_gather_candidates(Lp *lp, double sign, double smallest) {
    int count = 0;
    for (int j = 0; j < lp->num_columns; j++) {
        double pivot = sign * lp->along[j];
        int at = lp->column_at[j];
        if (at >= 0 || fabs(pivot) <= smallest || lp->lower[j] == lp->upper[j]) continue;
        if (at == AT_LOWER ? pivot < 0.0 : pivot > 0.0) continue;
        double cost = at == AT_LOWER ? lp->reduced[j] : -lp->reduced[j];
        lp->candidate[count] = j;
        lp->candidate_pivot[count] = fabs(pivot);
        lp->candidate_ratio[count++] = fmax(cost, 0.0);
    }
    for (int i = 0; i < lp->size; i++) {
        int row = lp->active[i];
        double pivot = sign * lp->row_side[i];
        if (fabs(pivot) <= smallest || lp_is_fixed(lp, row)) continue;
        if (lp->at_upper[row] ? pivot > 0.0 : pivot < 0.0) continue;
        double cost = lp->at_upper[row] ? -lp->multipliers[i] : lp->multipliers[i];
        lp->candidate[count] = -1 - i;
        lp->candidate_pivot[count] = fabs(pivot);
        lp->candidate_ratio[count++] = fmax(cost, 0.0);
    }
    return count;
}

/* Choose what enters, the largest pivot among those whose dual is about to change sign first
 * (Harris 1973); what is passed moves to its other bound. Returns its place among the candidates,
 * -1 where all can be passed: then no point satisfies the rows. */
int lp_choose_entering(Lp *lp, int count, double slope, int *num_passed) {
    int last = count;
    while (last > 0) {
        double least = INFINITY;
        int first = -1;
        for (int c = 0; c < last; c++) {
            double ratio = (lp->candidate_ratio[c] + lp->tolerance) / lp->candidate_pivot[c];
            if (ratio < least) least = ratio, first = c;
        }
        if (first < 0) return -1; /* no ratio is a number */
        int best = -1;
        for (int c = 0; c < last; c++)
            if (lp->candidate_ratio[c] <= least * lp->candidate_pivot[c] &&
                (best < 0 || lp->candidate_pivot[c] > lp->candidate_pivot[best]))
                best = c;
        /* Beside large costs the tolerance is nothing, and a ratio times its pivot may be rounded down. */
        if (best < 0) best = first;
        int index = lp->candidate[best];
        int row = index < 0 ? lp->active[-1 - index] : 0;
        double range = index < 0 ? lp->row_upper[row] - lp->row_lower[row]
                                 : lp->upper[index] - lp->lower[index];
        slope -= lp->candidate_pivot[best] * range;
        if (!(slope > 0.0)) {
            *num_passed = count - last;
            return best;
        }
        last--;
        double pivot = lp->candidate_pivot[best], ratio = lp->candidate_ratio[best];
        lp->candidate[best] = lp->candidate[last];
        lp->candidate_pivot[best] = lp->candidate_pivot[last];
        lp->candidate_ratio[best] = lp->candidate_ratio[last];
        lp->candidate[last] = index;
        lp->candidate_pivot[last] = pivot;
        lp->candidate_ratio[last] = ratio;
    }
    return -1;
}


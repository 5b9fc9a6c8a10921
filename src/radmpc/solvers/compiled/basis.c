/* The inverse of M = A[active, basic], changed by one exchange at a time.
 *
 * Sums go over rows of the inverse, in an order that does not depend on the processor: results are
 * the same on every machine with the same arithmetic.
 */
#include "lp.h"

#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__) && defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__)
#define FASTEST __attribute__((target_clones("avx2", "default")))
#else
#define FASTEST
#endif

/* target += factor * source */
FASTEST static void add_scaled(double *restrict target, double factor, const double *restrict source, int count) {
    for (int i = 0; i < count; i++) target[i] += factor * source[i];
}

FASTEST static double dot(const double *restrict a, const double *restrict b, int count) {
    double part[4] = {0.0, 0.0, 0.0, 0.0};
    int i = 0;
    for (; i + 4 <= count; i += 4)
        for (int l = 0; l < 4; l++) part[l] += a[i + l] * b[i + l];
    double rest = 0.0;
    for (; i < count; i++) rest += a[i] * b[i];
    return ((part[0] + part[1]) + (part[2] + part[3])) + rest;
}

double *lp_inverse_row(const Lp *lp, int position) {
    return lp->inverse + (size_t)position * (size_t)lp->basis_room;
}

/* Row vector times inverse: `by_column` over the basic columns, the result over the active rows. */
void lp_times_inverse(const Lp *lp, const double *by_column, double *by_row) {
    memset(by_row, 0, (size_t)lp->size * sizeof *by_row);
    for (int p = 0; p < lp->size; p++)
        if (by_column[p] != 0.0) add_scaled(by_row, by_column[p], lp_inverse_row(lp, p), lp->size);
}

/* Inverse times column vector: `by_row` over the active rows, the result over the basic columns. */
void lp_inverse_times(const Lp *lp, const double *by_row, double *by_column) {
    for (int p = 0; p < lp->size; p++) by_column[p] = dot(lp_inverse_row(lp, p), by_row, lp->size);
}

/* Write the entries of a column in active rows; return that in another row. */
double lp_column_in_active(const Lp *lp, int column, int row, double *by_row) {
    const Entries *entries = &lp->columns[column];
    double found = 0.0;
    memset(by_row, 0, (size_t)lp->size * sizeof *by_row);
    for (int e = 0; e < entries->size; e++) {
        int at = lp->row_at[entries->indices[e]];
        if (at >= 0) by_row[at] += entries->values[e];
        else if (entries->indices[e] == row) found += entries->values[e];
    }
    return found;
}

/* A column becomes basic in the place of another; `column_side` is the inverse times it. */
void lp_swap_columns(Lp *lp, int position, int column, const double *column_side) {
    double *pivot_row = lp_inverse_row(lp, position);
    double scale = 1.0 / column_side[position];
    for (int i = 0; i < lp->size; i++) pivot_row[i] *= scale;
    for (int p = 0; p < lp->size; p++)
        if (p != position && column_side[p] != 0.0)
            add_scaled(lp_inverse_row(lp, p), -column_side[p], pivot_row, lp->size);
    lp->basic[position] = column;
    lp->column_at[column] = position;
    lp->updates++;
}

/* A row becomes active in the place of another; `row_side` is its part over the basic columns times
 * the inverse. */
void lp_swap_rows(Lp *lp, int position, int row, const double *row_side) {
    double scale = 1.0 / row_side[position];
    for (int p = 0; p < lp->size; p++) {
        double *inverse = lp_inverse_row(lp, p);
        double share = inverse[position] * scale;
        if (share == 0.0) continue;
        add_scaled(inverse, -share, row_side, lp->size);
        inverse[position] = share;
    }
    lp->row_at[lp->active[position]] = INACTIVE;
    lp->active[position] = row;
    lp->row_at[row] = position;
    lp->updates++;
}

/* A row becomes active and a column basic; `pivot` is what M is bordered with, less what the rest
 * of it explains (the Schur complement). */
int lp_extend(Lp *lp, int row, int column, const double *row_side, const double *column_side, double pivot) {
    int last = lp->size;
    double scale = 1.0 / pivot;
    for (int p = 0; p < last; p++) {
        double *inverse = lp_inverse_row(lp, p);
        double share = column_side[p] * scale;
        if (share != 0.0) add_scaled(inverse, share, row_side, last);
        inverse[last] = -share;
    }
    double *added = lp_inverse_row(lp, last);
    for (int i = 0; i < last; i++) added[i] = -row_side[i] * scale;
    added[last] = scale;
    lp->active[last] = row;
    lp->basic[last] = column;
    lp->row_at[row] = last;
    lp->column_at[column] = last;
    lp->size++;
    lp->updates++;
    return lp_reserve_basis(lp, lp->size + 1);
}

/* A column is no longer basic, nor a row active. Where the column is then is the caller's to say. */
void lp_shrink(Lp *lp, int column_position, int row_position) {
    int last = lp->size - 1;
    double *pivot_row = lp_inverse_row(lp, column_position);
    double scale = 1.0 / pivot_row[row_position];
    for (int p = 0; p <= last; p++) {
        if (p == column_position) continue;
        double *inverse = lp_inverse_row(lp, p);
        double share = inverse[row_position] * scale;
        if (share != 0.0) add_scaled(inverse, -share, pivot_row, lp->size);
    }
    lp->row_at[lp->active[row_position]] = INACTIVE;
    if (column_position != last) {
        memcpy(pivot_row, lp_inverse_row(lp, last), (size_t)lp->size * sizeof *pivot_row);
        lp->basic[column_position] = lp->basic[last];
        lp->column_at[lp->basic[column_position]] = column_position;
    }
    if (row_position != last) {
        for (int p = 0; p < last; p++) {
            double *inverse = lp_inverse_row(lp, p);
            inverse[row_position] = inverse[last];
        }
        lp->active[row_position] = lp->active[last];
        lp->row_at[lp->active[row_position]] = row_position;
    }
    lp->size = last;
    lp->updates++;
}

/* Compute the inverse anew: row by row, each with the basic column that leaves the largest pivot.
 * Rows that depend on others are left inactive, and columns without a row nonbasic. 0: no memory. */
int lp_factor(Lp *lp) {
    int count = lp->size;
    if (!lp_reserve_basis(lp, count + 1)) return 0;
    int *rows = malloc((size_t)(2 * count + 1) * sizeof *rows);
    if (!rows) return 0;
    int *columns = rows + count;
    memcpy(rows, lp->active, (size_t)count * sizeof *rows);
    memcpy(columns, lp->basic, (size_t)count * sizeof *columns);
    for (int p = 0; p < count; p++) {
        lp->row_at[rows[p]] = INACTIVE;
        lp->column_at[columns[p]] = AT_LOWER;
    }
    lp->size = 0;
    double *left = lp->along; /* of the row at hand, what the rest does not explain */
    for (int t = 0; t < count; t++) {
        const Entries *row = &lp->rows[rows[t]];
        double *row_side = lp->row_side, *column_side = lp->column_side, *part = lp->spare;
        memset(left, 0, (size_t)lp->num_columns * sizeof *left);
        double size = 0.0;
        for (int e = 0; e < row->size; e++) left[row->indices[e]] = row->values[e];
        for (int p = 0; p < lp->size; p++) part[p] = left[lp->basic[p]];
        lp_times_inverse(lp, part, row_side);
        for (int i = 0; i < lp->size; i++) {
            if (row_side[i] == 0.0) continue;
            const Entries *other = &lp->rows[lp->active[i]];
            for (int e = 0; e < other->size; e++)
                left[other->indices[e]] -= row_side[i] * other->values[e];
        }
        int best = -1;
        double largest = 0.0;
        for (int c = 0; c < count; c++) {
            if (columns[c] < 0) continue;
            double magnitude = fabs(left[columns[c]]);
            if (magnitude > largest) largest = magnitude, best = c;
        }
        for (int e = 0; e < row->size; e++) size = fmax(size, fabs(row->values[e]));
        if (best < 0 || largest <= 1e-10 * size) continue;
        int column = columns[best];
        columns[best] = -1;
        lp_column_in_active(lp, column, -1, part);
        lp_inverse_times(lp, part, column_side);
        if (!lp_extend(lp, rows[t], column, row_side, column_side, left[column])) {
            free(rows);
            return 0;
        }
    }
    for (int c = 0; c < count; c++)
        if (columns[c] >= 0 && !isfinite(lp->lower[columns[c]])) lp->column_at[columns[c]] = AT_UPPER;
    lp->updates = 0;
    free(rows);
    return 1;
}

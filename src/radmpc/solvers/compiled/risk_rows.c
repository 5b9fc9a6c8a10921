/* Chance rows switched on and off, and tangents added where their risk is underestimated. */
#include "risk_rows.h"

#include <stdlib.h>
#include <string.h>

#define APART 1e-4 /* least distance of two tangents of a row [standard deviations]; see lp.py */

int risk_rows_reserve(RiskRows *rows) {
    size_t count = (size_t)rows->ratings->num_rows + 1, events = (size_t)rows->ratings->num_events + 1;
    size_t columns = (size_t)rows->num_columns + 1;
    rows->head = malloc(count * sizeof *rows->head);
    rows->column = malloc(events * sizeof *rows->column);
    rows->is_active = calloc(count, 1);
    rows->is_target = calloc(count, 1);
    rows->active = malloc(count * sizeof *rows->active);
    rows->target = malloc(count * sizeof *rows->target);
    rows->dense = calloc(columns, sizeof *rows->dense);
    rows->values = malloc(columns * sizeof *rows->values);
    rows->entries = malloc(columns * sizeof *rows->entries);
    rows->touched = malloc(columns * sizeof *rows->touched);
    rows->missing = malloc(count * sizeof *rows->missing);
    rows->noisy = malloc(count * sizeof *rows->noisy);
    if (!rows->head || !rows->column || !rows->is_active || !rows->is_target || !rows->active || !rows->target ||
        !rows->dense || !rows->values || !rows->entries || !rows->touched || !rows->missing || !rows->noisy)
        return 0;
    for (size_t i = 0; i < count; i++) rows->head[i] = -1;
    for (size_t e = 0; e < events; e++) rows->column[e] = -1;
    return 1;
}

void risk_rows_release(RiskRows *rows) {
    void *all[] = {rows->head,  rows->column, rows->is_active, rows->is_target, rows->active, rows->target, rows->dense,
                   rows->values, rows->entries, rows->touched, rows->missing,   rows->noisy,  rows->parts};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

/* Write a chance row over the decision variables into `touched` and `values`; return its right side. */
static double spread_out(RiskRows *rows, int row) {
    const Ratings *r = rows->ratings;
    double right = r->offsets[row];
    int first = rows->num_columns, last = -1;
    for (int e = r->normals.starts[row]; e < r->normals.starts[row + 1]; e++) {
        int output = r->normals.indices[e];
        double factor = r->normals.values[e];
        right -= factor * r->constant[output];
        for (int f = r->outputs.starts[output]; f < r->outputs.starts[output + 1]; f++) {
            int column = r->outputs.indices[f];
            rows->dense[column] += factor * r->outputs.values[f];
            first = column < first ? column : first;
            last = column > last ? column : last;
        }
    }
    rows->num_touched = 0;
    for (int column = first; column <= last; column++) {
        if (rows->dense[column] == 0.0) continue;
        rows->touched[rows->num_touched] = column;
        rows->values[rows->num_touched++] = rows->dense[column];
        rows->dense[column] = 0.0;
    }
    return right;
}

/* Whether all columns that the row at hand touches belong to a bound's blocks. */
static int is_within(const RiskRows *rows, int bound) {
    const char *has_block = rows->bounds.has_block + (size_t)bound * (size_t)rows->bounds.num_blocks;
    for (int t = 0; t < rows->num_touched; t++)
        if (!has_block[rows->blocks[rows->touched[t]]]) return 0;
    return 1;
}

/* The column of a row's event, appended if it has none; -1 without memory. */
static int risk_column(RiskRows *rows, int row) {
    int *column = &rows->column[rows->ratings->events[row]];
    if (*column >= 0) return *column;
    int count = 0, *numbers = malloc(((size_t)rows->bounds.count + 1) * sizeof *numbers);
    double *values = malloc(((size_t)rows->bounds.count + 1) * sizeof *values);
    int is_made = numbers && values;
    for (int b = 0; is_made && b < rows->bounds.count; b++) {
        if (!is_within(rows, b)) continue;
        numbers[count] = rows->bounds.rows[b];
        values[count++] = rows->row_scale * rows->price;
    }
    if (is_made) {
        numbers[count] = rows->budget_row;
        values[count++] = 1.0;
        is_made = lp_add_column(rows->lp, rows->price, rows->row_cap / rows->unit, count, numbers, values);
    }
    free(numbers);
    free(values);
    if (is_made) *column = rows->lp->num_columns - 1;
    return *column;
}

static int add_part(RiskRows *rows, int row, double lower, double clearance) {
    if (rows->num_parts == rows->part_room) {
        int room = rows->part_room ? 2 * rows->part_room : 64;
        RowPart *larger = realloc(rows->parts, (size_t)room * sizeof *larger);
        if (!larger) return 0;
        rows->parts = larger;
        rows->part_room = room;
    }
    rows->parts[rows->num_parts] = (RowPart){rows->lp->num_rows - 1, rows->head[row], lower, clearance};
    rows->head[row] = rows->num_parts++;
    return 1;
}

/* Add a tangent `t + slope q >= height` of the row that was spread out. */
static int add_tangent(RiskRows *rows, int row, double right, int column, double clearance, double slope,
                       double height) {
    int size = rows->num_touched;
    double steepness = slope / rows->deviations[row], lower = height - steepness * right;
    double *entries = rows->entries;
    for (int t = 0; t < size; t++) entries[t] = -steepness * rows->values[t];
    entries[size] = 1.0;
    rows->touched[size] = column;
    return lp_add_row(rows->lp, size + 1, rows->touched, entries, lower, INFINITY) &&
           add_part(rows, row, lower, clearance);
}

/* Append a chance row, switched on. */
static int add_row(RiskRows *rows, int row) {
    double right = spread_out(rows, row);
    if (rows->deviations[row] > 0.0) {
        int column = risk_column(rows, row);
        if (column < 0) return 0;
        for (int k = 0; k < rows->num_first; k++)
            if (!add_tangent(rows, row, right, column, rows->first_clearances[k], rows->first_slopes[k],
                             rows->first_heights[k]))
                return 0;
        return 1;
    }
    for (int t = 0; t < rows->num_touched; t++) rows->values[t] = -rows->values[t];
    return lp_add_row(rows->lp, rows->num_touched, rows->touched, rows->values, -right, INFINITY) &&
           add_part(rows, row, -right, INFINITY);
}

static void turn(RiskRows *rows, int row, int is_on) {
    for (int p = rows->head[row]; p >= 0; p = rows->parts[p].next) {
        rows->lp->row_lower[rows->parts[p].number] = is_on ? rows->parts[p].lower : -INFINITY;
        rows->lp->row_upper[rows->parts[p].number] = INFINITY;
    }
}

static int by_number(const void *one, const void *other) { return *(const int *)one - *(const int *)other; }

int risk_rows_activate(RiskRows *rows, int count, const int *alternatives, int crowd, int crowd_each) {
    const Ratings *r = rows->ratings;
    rows->num_target = 0;
    for (int a = 0; a < count; a++) {
        for (int e = r->row_starts[alternatives[a]]; e < r->row_starts[alternatives[a] + 1]; e++) {
            int row = r->rows[e];
            if (rows->is_target[row]) continue;
            rows->is_target[row] = 1;
            rows->target[rows->num_target++] = row;
        }
    }
    int is_crowded = rows->lp->num_rows > crowd + (long long)crowd_each * rows->num_target;
    for (int i = 0; !is_crowded && i < rows->num_active; i++) {
        int row = rows->active[i];
        if (rows->is_target[row]) continue;
        turn(rows, row, 0);
        rows->is_active[row] = 0;
    }
    for (int i = 0; i < rows->num_target; i++) rows->is_target[rows->target[i]] = 0;
    if (is_crowded) return 0;
    /* Rows enter in the order of their numbers, whatever chose them. */
    qsort(rows->target, (size_t)rows->num_target, sizeof *rows->target, by_number);
    for (int i = 0; i < rows->num_target; i++) {
        int row = rows->target[i];
        if (rows->is_active[row]) continue;
        if (rows->head[row] >= 0)
            turn(rows, row, 1);
        else if (!add_row(rows, row))
            return -1;
        rows->is_active[row] = 1;
    }
    int *before = rows->active;
    rows->active = rows->target;
    rows->num_active = rows->num_target;
    rows->target = before;
    return 1;
}

/* Whether a row has a tangent close by. */
static int has_near(const RiskRows *rows, int row, double clearance) {
    for (int p = rows->head[row]; p >= 0; p = rows->parts[p].next)
        if (fabs(rows->parts[p].clearance - clearance) <= APART) return 1;
    return 0;
}

int risk_rows_refine(RiskRows *rows, const double *clearances, const double *point, double tolerance) {
    const Ratings *r = rows->ratings;
    int count = 0, added = 0;
    double total = 0.0;
    for (int i = 0; i < rows->num_active; i++) {
        int row = rows->active[i];
        if (!(rows->deviations[row] > 0.0)) continue;
        double risk = tail_probability(r, clearances[row]) / rows->unit;
        double missing = fmax(risk - point[rows->column[r->events[row]]], 0.0);
        rows->noisy[count] = row;
        rows->missing[count++] = missing;
        total += missing;
    }
    if (!(total > tolerance)) return 0;
    for (int i = 0; i < count; i++) {
        int row = rows->noisy[i];
        if (!(rows->missing[i] > 0.25 * tolerance / count && clearances[row] < rows->flat)) continue;
        double at = fmax(clearances[row], rows->floor);
        if (has_near(rows, row, at)) continue;
        double slope = tail_density(r, at) / rows->unit, height = tail_probability(r, at) / rows->unit + slope * at;
        double right = spread_out(rows, row);
        if (!add_tangent(rows, row, right, rows->column[r->events[row]], at, slope, height)) return -1;
        added++;
    }
    return added;
}

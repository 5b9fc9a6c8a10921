/* Programs, what they hold, and bases that were set aside. */
#include "lp.h"

#include <stdlib.h>
#include <string.h>

/* Give an array another length; 0 where there is no memory. */
#define RESIZE(array, count)                                                                        \
    do {                                                                                            \
        void *larger = realloc((array), (size_t)(count) * sizeof *(array));                        \
        if (!larger) return 0;                                                                      \
        (array) = larger;                                                                           \
    } while (0)

static int reserve_columns(Lp *lp, int count) {
    if (count <= lp->column_room) return 1;
    int room = count + count / 2 + 32;
    RESIZE(lp->cost, room);
    RESIZE(lp->lower, room);
    RESIZE(lp->upper, room);
    RESIZE(lp->x, room);
    RESIZE(lp->reduced, room);
    RESIZE(lp->along, room);
    RESIZE(lp->shift, room);
    RESIZE(lp->column_at, room);
    RESIZE(lp->columns, room);
    lp->column_room = room;
    return 1;
}

static int reserve_rows(Lp *lp, int count) {
    if (count <= lp->row_room) return 1;
    int room = count + count / 2 + 64;
    RESIZE(lp->rows, room);
    RESIZE(lp->row_lower, room);
    RESIZE(lp->row_upper, room);
    RESIZE(lp->row_scale, room);
    RESIZE(lp->activity, room);
    RESIZE(lp->row_at, room);
    RESIZE(lp->at_upper, room);
    RESIZE(lp->on, room);
    lp->row_room = room;
    return 1;
}

static int reserve_candidates(Lp *lp, int count) {
    if (count <= lp->candidate_room) return 1;
    int room = count + count / 2;
    RESIZE(lp->candidate, room);
    RESIZE(lp->candidate_ratio, room);
    RESIZE(lp->candidate_pivot, room);
    lp->candidate_room = room;
    return 1;
}

int lp_reserve_basis(Lp *lp, int size) {
    if (!reserve_candidates(lp, lp->num_columns + size + 1)) return 0;
    if (size <= lp->basis_room) return 1;
    /* Rows of the inverse stay a multiple of eight numbers apart. */
    int room = (size + size / 2 + 16 + 7) & ~7;
    double *inverse = malloc((size_t)room * (size_t)room * sizeof *inverse);
    if (!inverse) return 0;
    for (int i = 0; i < lp->size; i++)
        memcpy(inverse + (size_t)i * room, lp->inverse + (size_t)i * lp->basis_room,
               (size_t)lp->size * sizeof *inverse);
    free(lp->inverse);
    lp->inverse = inverse;
    RESIZE(lp->active, room);
    RESIZE(lp->basic, room);
    RESIZE(lp->multipliers, room);
    RESIZE(lp->row_side, room);
    RESIZE(lp->column_side, room);
    RESIZE(lp->spare, room);
    lp->basis_room = room;
    return 1;
}

static int append_entry(Entries *entries, int index, double value) {
    if (entries->size == entries->room) {
        int room = entries->room ? 2 * entries->room : 16;
        RESIZE(entries->indices, room);
        RESIZE(entries->values, room);
        entries->room = room;
    }
    entries->indices[entries->size] = index;
    entries->values[entries->size++] = value;
    return 1;
}

static int append_column(Lp *lp, double cost, double lower, double upper) {
    if (!reserve_columns(lp, lp->num_columns + 1)) return 0;
    int j = lp->num_columns++;
    lp->cost[j] = cost;
    lp->lower[j] = lower;
    lp->upper[j] = upper;
    lp->column_at[j] = isfinite(lower) ? AT_LOWER : AT_UPPER;
    lp->columns[j] = (Entries){0};
    lp->is_contradictory |= lower > upper;
    return 1;
}

Lp *lp_new(int num_columns, const double *cost, const double *lower, const double *upper, double tolerance) {
    Lp *lp = calloc(1, sizeof *lp);
    if (!lp) return NULL;
    lp->tolerance = tolerance;
    lp->saved.asked = -1;
    int is_made = reserve_columns(lp, num_columns) && reserve_rows(lp, 1) && lp_reserve_basis(lp, 8);
    for (int j = 0; is_made && j < num_columns; j++)
        is_made = append_column(lp, cost[j], lower[j], upper[j]);
    if (is_made) return lp;
    lp_free(lp);
    return NULL;
}

void lp_free(Lp *lp) {
    if (!lp) return;
    for (int i = 0; i < lp->num_rows; i++) {
        free(lp->rows[i].indices);
        free(lp->rows[i].values);
    }
    for (int j = 0; j < lp->num_columns; j++) {
        free(lp->columns[j].indices);
        free(lp->columns[j].values);
    }
    void *arrays[] = {lp->cost,       lp->lower,      lp->upper,    lp->x,
                      lp->reduced,    lp->along,      lp->column_at, lp->rows,
                      lp->shift,      lp->columns,
                      lp->row_lower,  lp->row_upper,  lp->row_scale, lp->activity,
                      lp->row_at,     lp->at_upper,   lp->on,        lp->active,
                      lp->basic,      lp->inverse,    lp->multipliers, lp->row_side,
                      lp->column_side, lp->spare,     lp->candidate, lp->candidate_ratio,
                      lp->candidate_pivot, lp->saved.active, lp->saved.basic, lp->saved.rows,
                      lp->saved.inverse, lp->saved.columns};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    free(lp);
}

int lp_add_row(Lp *lp, int size, const int *columns, const double *values, double lower, double upper) {
    if (!reserve_rows(lp, lp->num_rows + 1)) return 0;
    int i = lp->num_rows;
    Entries *row = &lp->rows[i];
    *row = (Entries){0};
    lp->num_rows++;
    RESIZE(row->indices, size ? size : 1);
    RESIZE(row->values, size ? size : 1);
    row->room = size ? size : 1;
    double square = 0.0;
    for (int e = 0; e < size; e++) {
        if (values[e] == 0.0) continue;
        if (!append_entry(row, columns[e], values[e])) return 0;
        if (!append_entry(&lp->columns[columns[e]], i, values[e])) return 0;
        square += values[e] * values[e];
    }
    lp->row_lower[i] = lower;
    lp->row_upper[i] = upper;
    lp->row_scale[i] = square > 0.0 ? 1.0 / sqrt(square) : 1.0;
    lp->row_at[i] = INACTIVE;
    lp->at_upper[i] = 0;
    lp->is_contradictory |= lower > upper;
    return 1;
}

int lp_add_column(Lp *lp, double cost, double upper, int size, const int *rows, const double *values) {
    if (!append_column(lp, cost, 0.0, upper)) return 0;
    int j = lp->num_columns - 1;
    for (int e = 0; e < size; e++)
        if (!append_entry(&lp->rows[rows[e]], j, values[e]) || !append_entry(&lp->columns[j], rows[e], values[e]))
            return 0;
    return 1;
}

void lp_leave_basis(Lp *lp) {
    for (int p = 0; p < lp->size; p++) {
        lp->row_at[lp->active[p]] = INACTIVE;
        lp->column_at[lp->basic[p]] = AT_LOWER;
    }
    lp->size = lp->updates = 0;
}

static void enter_basis(Lp *lp, int size, const int *active, const int *basic) {
    lp->size = size;
    for (int p = 0; p < size; p++) {
        lp->active[p] = active[p];
        lp->basic[p] = basic[p];
        lp->row_at[active[p]] = p;
        lp->column_at[basic[p]] = p;
    }
}

static int save_basis(Lp *lp, int size, const int *rows, const int *columns) {
    Saved *saved = &lp->saved;
    saved->asked = -1;
    if (size > saved->room || !saved->rows) {
        int room = lp->basis_room;
        RESIZE(saved->rows, room);
        RESIZE(saved->columns, room);
        RESIZE(saved->active, room);
        RESIZE(saved->basic, room);
        RESIZE(saved->inverse, (size_t)room * (size_t)room);
        saved->room = room;
    }
    memcpy(saved->rows, rows, (size_t)size * sizeof *rows);
    memcpy(saved->columns, columns, (size_t)size * sizeof *columns);
    saved->size = lp->size;
    for (int p = 0; p < lp->size; p++) {
        saved->active[p] = lp->active[p];
        saved->basic[p] = lp->basic[p];
        memcpy(saved->inverse + (size_t)p * lp->size, lp_inverse_row(lp, p),
               (size_t)lp->size * sizeof(double));
    }
    saved->asked = size;
    return 1;
}

int lp_begin_with(Lp *lp, int size, const int *rows, const int *columns) {
    const Saved *saved = &lp->saved;
    if (!lp_reserve_basis(lp, size + 1)) return 0;
    lp_leave_basis(lp);
    for (int j = 0; j < lp->num_columns; j++)
        lp->column_at[j] = isfinite(lp->lower[j]) ? AT_LOWER : AT_UPPER;
    /* Siblings of a search begin where their parent ended: factored once. */
    if (saved->rows && saved->asked == size &&
        !memcmp(saved->rows, rows, (size_t)size * sizeof *rows) &&
        !memcmp(saved->columns, columns, (size_t)size * sizeof *columns)) {
        enter_basis(lp, saved->size, saved->active, saved->basic);
        for (int p = 0; p < lp->size; p++)
            memcpy(lp_inverse_row(lp, p), saved->inverse + (size_t)p * lp->size,
                   (size_t)lp->size * sizeof(double));
        return 1;
    }
    enter_basis(lp, size, rows, columns);
    return lp_factor(lp) && save_basis(lp, size, rows, columns);
}

/* Dynamic programming over a lattice of positions and displacements: see the Python files that use it. */
#include "lattice.h"

#include <math.h>
#include <stdlib.h>

static size_t at(const Lattice *lattice, int i, int j, int row) {
    return (((size_t)i * (size_t)lattice->width + (size_t)j) * (size_t)lattice->rows + (size_t)row) *
           (size_t)lattice->columns;
}

static void fill(const Lattice *lattice, const Box *box, float *into) {
    for (int number = 0; number < lattice->width * lattice->width; number++)
        for (int row = box->row; row < box->row_end; row++) {
            float *target = into + at(lattice, 0, number, row);
            for (int c = box->column; c < box->column_end; c++) target[c] = lattice->infeasible;
        }
}

void lattice_change(const Lattice *lattice, const Box *box, const float *values, const float *table, int axis,
                    float *into) {
    int width = lattice->width, count = box->column_end - box->column;
    fill(lattice, box, into);
    for (int after = 0; after < width; after++)
        for (int before = 0; before < width; before++) {
            float cost = table[after * width + before];
            if (!(cost < lattice->infeasible)) continue;
            for (int other = 0; other < width; other++)
                for (int row = box->row; row < box->row_end; row++) {
                    size_t since = axis ? at(lattice, other, before, row) : at(lattice, before, other, row);
                    size_t until = axis ? at(lattice, other, after, row) : at(lattice, after, other, row);
                    const float *restrict source = values + since + box->column;
                    float *restrict target = into + until + box->column;
                    for (int c = 0; c < count; c++) {
                        float value = source[c] + cost;
                        target[c] = value < target[c] ? value : target[c];
                    }
                }
        }
}

static int larger(int a, int b) { return a > b ? a : b; }
static int smaller(int a, int b) { return a < b ? a : b; }

static int is_set(const unsigned char *bits, size_t number) { return bits[number >> 3] >> (7 - (number & 7)) & 1; }

/* Move along one displacement, from a row to a row. */
static void move_row(const Lattice *lattice, const Toll *toll, const float *values, size_t number, int count,
                     float outside, const float *is_late, float *into) {
    for (int c = 0; c < count; c++) {
        size_t n = number + (size_t)c;
        float risk = toll->risks[n], value = values[n] + toll->weight * risk;
        if (value >= 0.5f * lattice->infeasible || risk > toll->most || is_set(toll->blocked, n)) continue;
        into[c] = value + (outside > is_late[c] ? outside : is_late[c]);
    }
}

int lattice_move(const Lattice *lattice, const Box *from, const Box *to, const Toll *toll, const float *values,
                 float *into) {
    int width = lattice->width, reach = width / 2;
    fill(lattice, to, into);
    float *is_late = malloc(((size_t)lattice->columns + 1) * sizeof *is_late);
    if (!is_late) return 0;
    for (int c = 0; c < lattice->columns; c++)
        is_late[c] = c >= toll->in_time.column && c < toll->in_time.column_end ? 0.0f : toll->late;
    for (int i = 0; i < width; i++)
        for (int j = 0; j < width; j++) {
            int down = i - reach, right = j - reach;
            int first = larger(from->column, to->column - right);
            int last = smaller(from->column_end, to->column_end - right);
            int end = smaller(from->row_end, to->row_end - down);
            if (last <= first) continue;
            for (int row = larger(from->row, to->row - down); row < end; row++) {
                int ahead = row + down;
                float outside = ahead >= toll->in_time.row && ahead < toll->in_time.row_end ? 0.0f : toll->late;
                move_row(lattice, toll, values, at(lattice, i, j, row) + (size_t)first, last - first, outside,
                         is_late + first + right, into + at(lattice, i, j, ahead) + first + right);
            }
        }
    free(is_late);
    return 1;
}

void slacks_free(Slacks *slacks) {
    free(slacks->bits);
    free(slacks->numbers);
    free(slacks->values);
}

static int keep(Slacks *into, size_t number, double slack) {
    if (into->count == into->room) {
        size_t room = into->room ? 2 * into->room : 1024;
        unsigned *numbers = realloc(into->numbers, room * sizeof *numbers);
        if (numbers) into->numbers = numbers;
        float *values = realloc(into->values, room * sizeof *values);
        if (values) into->values = values;
        if (!numbers || !values) return 0;
        into->room = room;
    }
    into->numbers[into->count] = (unsigned)number;
    into->values[into->count++] = (float)slack;
    return 1;
}

/* No calls, as fmin and fmax are: nothing here is NaN. */
static double least_of(double a, double b) { return a < b ? a : b; }
static double most_of(double a, double b) { return a > b ? a : b; }

static double room_at(const HalfPlane *plane, double x, double y) { return plane->c - plane->a * x - plane->b * y; }

static double span(const HalfPlane *plane, const double *longest) {
    return fabs(plane->a) * longest[0] + fabs(plane->b) * longest[1];
}

/* A row of positions: the columns from which some displacement leads near, by how much each alternative is clear
 * here, what is best at the end of a displacement, and what each alternative leaves there by column. */
typedef struct {
    int first, last;
    double *now, *best, *across;
} Row;

/* Look along a row, and note how clear its positions are. */
static void look(const Lattice *lattice, const Obstacle *obstacle, int row, Row *into) {
    into->first = lattice->columns;
    into->last = 0;
    for (int column = 0; column < lattice->columns; column++) {
        double x = obstacle->x[row], y = obstacle->y[column], rough = -INFINITY;
        for (int m = 0; m < obstacle->count; m++) {
            const HalfPlane *here = &obstacle->here[m], *ahead = &obstacle->ahead[m];
            double room = room_at(here, x, y);
            into->now[m * lattice->columns + column] = room;
            double slack = least_of(room - span(here, obstacle->longest),
                                    room_at(ahead, x, y) - span(ahead, obstacle->longest));
            rough = most_of(rough, slack);
        }
        if (!(rough < obstacle->little)) continue;
        into->first = smaller(into->first, column);
        into->last = column + 1;
    }
}

/* Measure one displacement from a row of positions; the best alternative counts. */
static void measure(const Lattice *lattice, const Obstacle *obstacle, int j, double x, Row *row) {
    int columns = lattice->columns, along = columns + lattice->width - 1;
    double *restrict best = row->best;
    for (int c = row->first; c < row->last; c++) best[c] = -INFINITY;
    for (int m = 0; m < obstacle->count; m++) {
        double beyond = obstacle->ahead[m].c - obstacle->ahead[m].a * x;
        const double *restrict now = row->now + m * columns, *restrict across = row->across + m * along + j;
        for (int c = row->first; c < row->last; c++) {
            double room = beyond - across[c];
            room = now[c] < room ? now[c] : room;
            best[c] = best[c] > room ? best[c] : room;
        }
    }
}

static int sort(const Obstacle *obstacle, size_t number, const Row *row, Slacks *into) {
    for (int c = row->first; c < row->last; c++) {
        double best = row->best[c];
        if (!(best < obstacle->little)) continue;
        size_t n = number + (size_t)c;
        if (best < obstacle->least) {
            into->bits[n >> 3] |= (unsigned char)(0x80 >> (n & 7));
            into->is_blocked = 1;
        } else if (!keep(into, n, best)) {
            return 0;
        }
    }
    return 1;
}

int lattice_measure(const Lattice *lattice, const Obstacle *obstacle, Slacks *into) {
    int width = lattice->width, columns = lattice->columns, along = columns + width - 1;
    size_t all = at(lattice, width, 0, 0), count = (size_t)obstacle->count + 1;
    double *room = malloc(((size_t)columns * count + (size_t)along * count) * sizeof *room);
    Row row = {0, 0, room, room ? room + (size_t)columns * (count - 1) : NULL, room ? room + (size_t)columns * count : NULL};
    *into = (Slacks){calloc(all / 8 + 1, 1), NULL, NULL, 0, 0, 0};
    int is_done = into->bits && room;
    for (int m = 0; is_done && m < obstacle->count; m++)
        for (int c = 0; c < along; c++) row.across[m * along + c] = obstacle->ahead[m].b * obstacle->y_ahead[c];
    for (int r = 0; is_done && r < lattice->rows; r++) {
        look(lattice, obstacle, r, &row);
        for (int number = 0; row.first < row.last && is_done && number < width * width; number++) {
            measure(lattice, obstacle, number % width, obstacle->x_ahead[r + number / width], &row);
            is_done = sort(obstacle, at(lattice, 0, number, r), &row, into);
        }
    }
    free(room);
    return is_done;
}

/* What moves along a route cost where another vehicle passes by: see the Python file that uses it. */
#include "passing.h"

#include <math.h>
#include <stdlib.h>

void costs_free(Costs *costs) {
    free(costs->steps);
    free(costs->places);
    free(costs->costs);
}

static int make_room(Costs *costs, int moves) {
    if (costs->count < costs->room) return 1;
    size_t room = costs->room ? 2 * costs->room : 64;
    long long *steps = realloc(costs->steps, room * sizeof *steps);
    if (steps) costs->steps = steps;
    long long *places = realloc(costs->places, room * sizeof *places);
    if (places) costs->places = places;
    double *values = realloc(costs->costs, room * (size_t)moves * sizeof *values);
    if (values) costs->costs = values;
    if (!steps || !places || !values) return 0;
    costs->room = room;
    return 1;
}

/* The squared distance of the origin from a point, or from the way between two. */
static double square_from(const double *begin, const double *end, int is_along) {
    double x = end[0], y = end[1];
    if (is_along) {
        double along[2] = {x - begin[0], y - begin[1]};
        double square = along[0] * along[0] + along[1] * along[1];
        double ahead = -(begin[0] * along[0] + begin[1] * along[1]);
        double share = square > 0.0 ? ahead / square : 0.0;
        share = share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share;
        x = begin[0] + share * along[0];
        y = begin[1] + share * along[1];
    }
    return x * x + y * y;
}

/* What the moves from a place cost; whether any does. */
static int measure(const Passing *passing, const double *begin, int place, const double *ahead, double *costs) {
    double near = passing->apart * passing->apart;
    int costs_any = 0;
    for (int move = 0; move < passing->moves; move++) {
        int last = place + move < passing->places ? place + move : passing->places - 1;
        double end[2] = {passing->route[2 * last] - ahead[0], passing->route[2 * last + 1] - ahead[1]};
        double square = square_from(begin, end, passing->is_along);
        costs[move] = 0.0;
        if (!(square < near)) continue;
        double distance = sqrt(square);
        costs[move] = distance < passing->touching ? INFINITY : passing->price * (passing->apart - distance);
        costs_any |= costs[move] > 0.0;
    }
    return costs_any;
}

/* What two places in a row are apart at most: where the route turns between them it is less than usual. */
static double widest(const Passing *passing) {
    double most = 0.0;
    for (const double *here = passing->route; here < passing->route + 2 * (passing->places - 1); here += 2) {
        double apart = hypot(here[2] - here[0], here[3] - here[1]);
        most = apart > most ? apart : most;
    }
    return most;
}

int passing_measure(const Passing *passing, Costs *into) {
    *into = (Costs){0};
    if (passing->places < 1) return 1;
    const double *route = passing->route;
    double spacing = widest(passing);
    for (int step = 0; step < passing->steps; step++) {
        const double *here = passing->path + 2 * step, *ahead = here + 2;
        double reach = passing->apart + passing->moves * spacing + hypot(ahead[0] - here[0], ahead[1] - here[1]);
        for (int place = 0; place < passing->places; place++) {
            double begin[2] = {route[2 * place] - here[0], route[2 * place + 1] - here[1]};
            double square = begin[0] * begin[0] + begin[1] * begin[1];
            if (square >= reach * reach) {
                /* From place to place a route comes nearer by what they are apart at most. */
                double skipped = spacing > 0.0 ? floor((sqrt(square) - reach) / spacing) : 0.0;
                if (skipped > 1.0) place += skipped < passing->places ? (int)skipped - 1 : passing->places;
                continue;
            }
            if (!make_room(into, passing->moves)) return 0;
            if (!measure(passing, begin, place, ahead, into->costs + into->count * (size_t)passing->moves)) continue;
            into->steps[into->count] = step;
            into->places[into->count++] = place;
        }
    }
    return 1;
}

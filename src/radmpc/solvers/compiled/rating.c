/* Points rated by their true risks, and the avoidance that a search branches on. */
#include "rating.h"

#include <math.h>
#include <string.h>

#define CONTACT 1e-9 /* slack down to which a row without noise holds [m]; see gaussian.py */

/* The continued fraction of the incomplete beta function, by Lentz's method (DLMF 8.17.22). */
static double beta_fraction(double a, double b, double x) {
    const double tiny = 1e-300;
    double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (fabs(d) < tiny ? tiny : d);
    double found = d;
    for (int m = 1; m <= 400; m++) {
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1.0 + even * d;
        c = 1.0 + even / c;
        d = 1.0 / (fabs(d) < tiny ? tiny : d);
        c = fabs(c) < tiny ? tiny : c;
        found *= d * c;
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1.0 + odd * d;
        c = 1.0 + odd / c;
        d = 1.0 / (fabs(d) < tiny ? tiny : d);
        c = fabs(c) < tiny ? tiny : c;
        double change = d * c;
        found *= change;
        if (fabs(change - 1.0) < 1e-15) break;
    }
    return found;
}

double log_beta(double a, double b) { return lgamma(a) + lgamma(b) - lgamma(a + b); }

static double incomplete_beta(double a, double b, double x, double log_whole) {
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    double front = exp(a * log(x) + b * log1p(-x) - log_whole);
    if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
    return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

/* The probability that a standard normal deviate, or Student's t with so many degrees of freedom,
 * exceeds a clearance. */
double tail_probability(const Ratings *ratings, double clearance) {
    if (!ratings->samples) return 0.5 * erfc(clearance * 0.70710678118654752440);
    if (isinf(clearance)) return clearance > 0.0 ? 0.0 : 1.0;
    double n = ratings->samples, share = n / (n + clearance * clearance);
    double beyond = 0.5 * incomplete_beta(0.5 * n, 0.5, share, ratings->log_beta);
    return clearance >= 0.0 ? beyond : 1.0 - beyond;
}

double tail_density(const Ratings *ratings, double clearance) {
    if (!ratings->samples) return exp(-0.5 * clearance * clearance) * 0.39894228040143267794;
    double n = ratings->samples;
    return exp(-0.5 * (n + 1.0) * log1p(clearance * clearance / n) - ratings->log_beta) / sqrt(n);
}

static void multiply(const Matrix *matrix, int count, const double *by, double *into) {
    for (int i = 0; i < count; i++) {
        double sum = 0.0;
        for (int e = matrix->starts[i]; e < matrix->starts[i + 1]; e++)
            sum += matrix->values[e] * by[matrix->indices[e]];
        into[i] = sum;
    }
}

/* Rows of one event are neighbors within an alternative, and are charged once, at the largest. */
static double risk_of(const Ratings *ratings, const double *clearances, int alternative) {
    int row = ratings->row_starts[alternative], last = ratings->row_starts[alternative + 1];
    double risk = 0.0;
    while (row < last) {
        int event = ratings->events[ratings->rows[row]];
        double least = INFINITY;
        for (; row < last && ratings->events[ratings->rows[row]] == event; row++)
            least = fmin(least, clearances[ratings->rows[row]]);
        risk += tail_probability(ratings, least);
    }
    return risk;
}

/* The risk of a selection, rows of one event charged once however often they are chosen. */
static void add_up(Ratings *ratings, Rated *into) {
    double *clearest = ratings->event_clearances; /* NaN: not chosen yet */
    int count = 0;
    into->risk = into->largest = 0.0;
    if (ratings->is_distinct) {
        for (int v = 0; v < ratings->num_avoidances; v++) {
            into->risk += into->cheapest[v];
            into->largest = fmax(into->largest, into->cheapest[v]);
        }
        return;
    }
    for (int v = 0; v < ratings->num_avoidances; v++) {
        int alternative = (int)into->selection[v];
        if (alternative < 0) {
            into->risk = into->largest = INFINITY;
            continue;
        }
        for (int r = ratings->row_starts[alternative]; r < ratings->row_starts[alternative + 1]; r++) {
            int row = ratings->rows[r], event = ratings->events[row];
            if (isnan(clearest[event])) {
                ratings->chosen[count++] = event;
                clearest[event] = into->clearances[row];
            }
            clearest[event] = fmin(clearest[event], into->clearances[row]);
        }
    }
    for (int c = 0; c < count; c++) {
        double risk = tail_probability(ratings, clearest[ratings->chosen[c]]);
        clearest[ratings->chosen[c]] = NAN;
        into->risk += risk;
        into->largest = fmax(into->largest, risk);
    }
}

/* Whether a Gaussian tail at `least` is certainly above `count` tails at `other` or farther out: for
 * the hazard rate is at least the clearance, ln Q(b) - ln Q(a) >= (a^2 - b^2) / 2 from 0 <= b to a. */
static int is_worse(double least, double other, double log_count) {
    double from = fmax(least, 0.0);
    return other > from && other * other - from * from >= 2.0 * log_count;
}

/* Rate one avoidance: its best alternative, and by how much each misses the reference. */
static void rate_avoidance(const Ratings *ratings, int avoidance, Rated *into) {
    size_t begin = (size_t)avoidance * (size_t)ratings->width;
    const int *alternatives = ratings->table + begin;
    double *shortfall = into->shortfall + begin, *least = ratings->least;
    double cheapest = INFINITY, clearest = -INFINITY, log_count = 0.0;
    int selected = -1, first = -1;
    for (int a = 0; a < ratings->width; a++) {
        shortfall[a] = INFINITY;
        least[a] = NAN;
        if (alternatives[a] < 0) continue;
        int row_end = ratings->row_starts[alternatives[a] + 1];
        double worst = -INFINITY, closest = INFINITY;
        for (int r = ratings->row_starts[alternatives[a]]; r < row_end; r++) {
            int row = ratings->rows[r];
            worst = fmax(worst, ratings->deviations[row] * ratings->reference - ratings->slacks[row]);
            closest = fmin(closest, into->clearances[row]);
        }
        shortfall[a] = worst;
        least[a] = closest;
        if (first < 0 || closest > clearest) clearest = closest, first = a;
    }
    int count = 0;
    if (first >= 0) {
        selected = alternatives[first];
        cheapest = risk_of(ratings, into->clearances, selected);
        count = ratings->row_starts[selected + 1] - ratings->row_starts[selected];
        log_count = log(count);
    }
    /* No other is cheaper than the clearest of all rows alone. */
    for (int a = 0; count > 1 && a < ratings->width; a++) {
        if (a == first || isnan(least[a])) continue;
        if (!ratings->samples && is_worse(least[a], clearest, log_count)) continue;
        if (tail_probability(ratings, least[a]) >= cheapest) continue;
        double risk = risk_of(ratings, into->clearances, alternatives[a]);
        if (risk >= cheapest) continue;
        cheapest = risk;
        selected = alternatives[a];
    }
    into->cheapest[avoidance] = cheapest;
    into->selection[avoidance] = selected;
}

void ratings_rate(Ratings *ratings, const double *z, Rated *into) {
    double *at = ratings->at, *slacks = ratings->slacks;
    multiply(&ratings->outputs, ratings->num_outputs, z, at);
    for (int i = 0; i < ratings->num_outputs; i++) at[i] += ratings->constant[i];
    multiply(&ratings->normals, ratings->num_rows, at, slacks);
    for (int i = 0; i < ratings->num_rows; i++) {
        slacks[i] = ratings->offsets[i] - slacks[i];
        double deviation = ratings->deviations[i], certain = slacks[i] >= -CONTACT ? INFINITY : -INFINITY;
        into->clearances[i] = deviation > 0.0 ? slacks[i] * (1.0 / deviation) : certain;
    }
    for (int v = 0; v < ratings->num_avoidances; v++) rate_avoidance(ratings, v, into);
    add_up(ratings, into);
}

int choose_avoidance(int count, int width, const double *shortfall, const double *cheapest, const char *is_decided,
                     const double *weights, int by_weight, const double *factors, int *is_blunt) {
    double second_weight = factors[0], missing_factor = factors[1], missing_length = factors[2];
    int violated = -1, risky = -1;
    double most = -INFINITY, worst = 0.0;
    for (int v = 0; v < count; v++) {
        if (is_decided[v]) continue;
        const double *row = shortfall + (size_t)v * (size_t)width;
        double least = INFINITY, second = INFINITY;
        for (int a = 0; a < width; a++) {
            if (row[a] < least) {
                second = least;
                least = row[a];
            } else if (row[a] < second) {
                second = row[a];
            }
        }
        if (cheapest[v] > worst) worst = cheapest[v], risky = v;
        if (!(least > 0.0)) continue;
        if (!isfinite(second)) second = missing_factor * least + missing_length;
        double merit = by_weight ? least * weights[v] : least + second_weight * second;
        if (violated < 0 || merit > most) most = merit, violated = v;
    }
    *is_blunt = violated >= 0;
    return violated >= 0 ? violated : risky;
}

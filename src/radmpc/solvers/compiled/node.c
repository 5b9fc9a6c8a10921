/* One node of a search at a price of risk; `RiskTree._solve` in Python does the same, line by line. */
#include "node.h"

#include <stdlib.h>
#include <string.h>

int nodes_reserve(Nodes *nodes) {
    const Ratings *r = nodes->ratings;
    size_t avoidances = (size_t)r->num_avoidances + 1;
    nodes->rated.clearances = malloc(((size_t)r->num_rows + 1) * sizeof(double));
    nodes->rated.cheapest = malloc(avoidances * sizeof(double));
    nodes->rated.selection = malloc(avoidances * sizeof(long long));
    nodes->is_decided = malloc(avoidances);
    return nodes->rated.clearances && nodes->rated.cheapest && nodes->rated.selection && nodes->is_decided;
}

void nodes_release(Nodes *nodes) {
    void *all[] = {nodes->rated.clearances, nodes->rated.cheapest, nodes->rated.selection, nodes->is_decided};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

/* The value from which on a node cannot matter. */
static double cutoff_of(const Nodes *nodes, const Node *node) {
    if (!node->has_plan) return INFINITY;
    return node->value - nodes->gap * nodes->inside * fmax(fabs(node->value), nodes->scale);
}

/* The difference of values that counts as none. */
static double negligible(const Nodes *nodes, double value) {
    return nodes->tie * nodes->gap * fmax(value < INFINITY ? fabs(value) : 0.0, nodes->scale);
}

/* The value of the point that was rated last, kept if it is the best; INFINITY where it is no candidate. */
static double take(Nodes *nodes, const double *point, Node *node) {
    const RiskRows *rows = nodes->rows;
    const Rated *rated = &nodes->rated;
    if (rated->largest > nodes->most_of_row || rated->risk > nodes->most_risk) return INFINITY;
    double cost = 0.0;
    for (int j = 0; j < rows->num_columns; j++) cost += rows->lp->cost[j] * point[j];
    double value = cost + rows->price * rated->risk / rows->unit;
    if (!(value < node->value)) return value;
    memcpy(nodes->best_point, point, (size_t)rows->num_columns * sizeof(double));
    memcpy(nodes->best_selection, rated->selection, (size_t)nodes->ratings->num_avoidances * sizeof(long long));
    node->value = value;
    node->cost = cost;
    node->risk = rated->risk;
    node->has_plan = node->is_better = 1;
    return value;
}

/* Add tangents where chosen rows risk more than the program says; how many, -1 without memory. */
static int refine(Nodes *nodes, const double *point, double tolerance) {
    RiskRows *rows = nodes->rows;
    const double *clearances = nodes->rated.clearances;
    /* What risk is worth nothing may be underestimated, unless it is beyond the budget. */
    int added = rows->price > 0.0 ? risk_rows_refine(rows, clearances, point, tolerance / rows->price) : 0;
    if (added || !(nodes->rated.risk > nodes->most_risk && nodes->missing < INFINITY)) return added;
    return risk_rows_refine(rows, clearances, point, nodes->missing);
}

static void decide(Nodes *nodes, int count, const int *chosen) {
    memset(nodes->is_decided, 0, (size_t)nodes->ratings->num_avoidances);
    for (int i = 0; i < count; i++)
        if (!nodes->is_refined[chosen[i]]) nodes->is_decided[nodes->owners[chosen[i]]] = 1;
}

NodeState nodes_solve(Nodes *nodes, int count, const int *chosen, Node *node) {
    RiskRows *rows = nodes->rows;
    Ratings *r = nodes->ratings;
    Lp *lp = rows->lp;
    decide(nodes, count, chosen);
    for (node->attempt = 0; node->attempt < nodes->rounds; node->attempt++) {
        double proven, cutoff = cutoff_of(nodes, node), far = cutoff + nodes->headroom * fabs(cutoff);
        long most = nodes->pivots + (long)nodes->pivots_each * (lp->num_rows + lp->num_columns);
        Outcome outcome = lp_solve(lp, far, most, &proven);
        node->solves++;
        if (outcome == LP_NO_MEMORY) return NODE_NO_MEMORY;
        if (outcome == LP_FAILED) return NODE_UNSOLVED;
        if (outcome != LP_OPTIMAL && count) nodes->weights[nodes->owners[chosen[count - 1]]] += 1.0;
        node->bound = fmax(node->bound, proven);
        if (outcome == LP_INFEASIBLE) return NODE_DROPPED;
        if (outcome == LP_CUTOFF || node->bound >= cutoff) return NODE_PARKED;
        ratings_rate(r, lp->x, &nodes->rated);
        double worth = take(nodes, lp->x, node), epsilon = negligible(nodes, fmin(worth, node->value));
        if (worth - node->bound <= epsilon) return NODE_PARKED;
        int is_blunt, by_weight = !node->has_plan || r->width == 1;
        node->avoidance =
            choose_avoidance(r->num_avoidances, r->width, nodes->rated.shortfall, nodes->rated.cheapest,
                             nodes->is_decided, nodes->weights, by_weight, nodes->factors, &is_blunt);
        /* Far from any plan, an exact account of the risks chosen so far can wait. */
        if (node->attempt < (is_blunt ? 1 : nodes->rounds - 1)) {
            int added = refine(nodes, lp->x, (is_blunt ? 3.0 : 0.5) * epsilon);
            if (added < 0) return NODE_NO_MEMORY;
            if (added) continue;
        }
        return node->avoidance < 0 ? NODE_PARKED : NODE_OPEN;
    }
    return NODE_PARKED;
}

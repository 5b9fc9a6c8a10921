/* One node of a search at a price of risk: its linear program, as often as tangents are missing. */
#ifndef RADMPC_NODE_H
#define RADMPC_NODE_H

#include "risk_rows.h"

/* What all nodes of a search have in common. */
typedef struct {
    RiskRows *rows;
    Ratings *ratings;
    const int *owners;      /* the avoidance of each alternative */
    const char *is_refined; /* whether others refine it: their avoidance is not decided yet */
    double *weights;        /* of avoidances: how often their alternatives failed */
    const double *factors;  /* as in `choose_avoidance` */
    double *best_point;     /* the best point of the node, and its alternatives */
    long long *best_selection;
    double gap, scale; /* of the search */
    double inside;     /* share of the gap by which the cutoff lies below the incumbent */
    double headroom;   /* share of the cutoff by which linear programs run beyond it */
    double tie;        /* share of the gap within which values count as equal */
    double most_risk, most_of_row;
    double missing; /* units that may be missing where a point risks more than `most_risk`; INFINITY: as anywhere */
    int rounds, pivots, pivots_each;
    Rated rated; /* the last point */
    char *is_decided;
} Nodes;

/* NODE_CROWDED: nothing was done, as there are too many rows. NODE_UNSOLVED: a linear program is
 * left to another solver. */
typedef enum { NODE_OPEN, NODE_PARKED, NODE_DROPPED, NODE_CROWDED, NODE_UNSOLVED, NODE_NO_MEMORY } NodeState;

typedef struct {
    double bound, value; /* of the node; of the incumbent, INFINITY without one */
    double cost, risk;   /* of the best point, if it is the incumbent */
    int has_plan, is_better;
    int avoidance, solves, attempt;
} Node;

int nodes_reserve(Nodes *nodes);
void nodes_release(Nodes *nodes);

/* Solve a node of alternatives that are switched on, from its bound and the incumbent's value. */
NodeState nodes_solve(Nodes *nodes, int count, const int *chosen, Node *node);

#endif

/* A disjunctive chance-constrained program laid out for rating points by their true risks. */
#ifndef RADMPC_RATING_H
#define RADMPC_RATING_H

typedef struct {
    const int *starts, *indices;
    const double *values;
} Matrix;

typedef struct {
    int num_columns, num_outputs, num_rows, num_alternatives, num_avoidances, width, num_events;
    int samples;               /* degrees of freedom of Student's t; 0: Gaussian */
    double log_beta;           /* of half of them, and a half */
    Matrix outputs, normals;   /* outputs over the point, rows over the outputs */
    const double *constant, *offsets, *deviations;
    double reference;          /* clearance that shortfalls are measured from */
    const int *table;                /* alternatives of each avoidance, `width` apart, -1 where none */
    const int *row_starts, *rows, *events;
    double *at, *slacks;       /* outputs and rows of the last point */
    double *least;             /* clearances of the alternatives of one avoidance */
    int is_distinct;          /* one row per alternative and event: risks add up */
    double *event_clearances; /* least of chosen rows */
    int *chosen;              /* events */
} Ratings;

/* By how much avoidances miss the reference, and the risks of their best alternatives. */
typedef struct {
    double *clearances; /* (num_rows) */
    double *cheapest;   /* (num_avoidances) */
    long long *selection;
    double *shortfall; /* (num_avoidances, width) */
    double risk, largest;
} Rated;

void ratings_rate(Ratings *ratings, const double *z, Rated *into);
double log_beta(double a, double b);

/* The probability that a deviation exceeds a clearance, and its density there. */
double tail_probability(const Ratings *ratings, double clearance);
double tail_density(const Ratings *ratings, double clearance);

/* The avoidance to branch on, -1 where none is left; whether it misses the reference. */
int choose_avoidance(int count, int width, const double *shortfall, const double *cheapest, const char *is_decided,
                     const double *weights, int by_weight, const double *factors, int *is_blunt);

#endif

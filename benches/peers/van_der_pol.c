/* The least an FMU can be: the van der Pol oscillator, x0' = x1, x1' = mu (1 - x0^2) x1 - x0, by forward Euler.
 *
 * Only what the bench calls is here, for FMI 2.0 and 3.0 alike: no checks, no log, no states to save. It shows what a
 * call costs when next to nothing is done in it. */

#include <stddef.h>
#include <stdlib.h>

#define STEP 1e-2

typedef struct {
    double x[2];
    double mu;
    double time;
} Model;

static void rates(const Model *m, double dx[2]) {
    dx[0] = m->x[1];
    dx[1] = m->mu * ((1.0 - m->x[0] * m->x[0]) * m->x[1]) - m->x[0];
}

static int step(Model *m, double from, double size) {
    long n = (long)(size / STEP + 0.5);
    double dx[2];
    for (long i = 0; i < n; i++) {
        rates(m, dx);
        m->x[0] += STEP * dx[0];
        m->x[1] += STEP * dx[1];
    }
    m->time = from + size;
    return 0;
}

static void *make(void) {
    Model *m = calloc(1, sizeof(Model));
    if (m) {
        m->x[0] = 2.0;
        m->mu = 1.0;
    }
    return m;
}

/* 0 and 1 are the states, 2 is mu. */
static double *variable(Model *m, unsigned reference) {
    return reference < 2 ? &m->x[reference] : &m->mu;
}

static int get(Model *m, const unsigned *references, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) values[i] = *variable(m, references[i]);
    return 0;
}

static int set(Model *m, const unsigned *references, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) *variable(m, references[i]) = values[i];
    return 0;
}

static int set_states(Model *m, const double *x) {
    m->x[0] = x[0];
    m->x[1] = x[1];
    return 0;
}

static int get_states(Model *m, double *x) {
    x[0] = m->x[0];
    x[1] = m->x[1];
    return 0;
}

/* FMI 2.0 */

typedef struct {
    int flags[5];
    double next_event_time;
} EventInfo;

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const void *functions,
                      int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)functions, (void)visible, (void)logging;
    return make();
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int defined, double tolerance, double start, int stops, double stop) {
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->time = start;
    return 0;
}
int fmi2EnterInitializationMode(void *c) { return (void)c, 0; }
int fmi2ExitInitializationMode(void *c) { return (void)c, 0; }
int fmi2NewDiscreteStates(void *c, EventInfo *info) {
    (void)c;
    for (int i = 0; i < 5; i++) info->flags[i] = 0;
    return 0;
}
int fmi2EnterContinuousTimeMode(void *c) { return (void)c, 0; }
int fmi2SetTime(void *c, double time) { return ((Model *)c)->time = time, 0; }
int fmi2SetContinuousStates(void *c, const double *x, size_t n) { return (void)n, set_states(c, x); }
int fmi2GetContinuousStates(void *c, double *x, size_t n) { return (void)n, get_states(c, x); }
int fmi2GetDerivatives(void *c, double *dx, size_t n) { return (void)n, rates(c, dx), 0; }
int fmi2DoStep(void *c, double from, double size, int no_set_state) { return (void)no_set_state, step(c, from, size); }
int fmi2GetReal(void *c, const unsigned *r, size_t n, double *values) { return get(c, r, n, values); }
int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *values) { return set(c, r, n, values); }

/* FMI 3.0 */

typedef unsigned char Boolean;

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, Boolean visible,
                                  Boolean logging, Boolean events, Boolean early, const unsigned *required,
                                  size_t n_required, void *environment, void *log, void *update) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)early;
    (void)required, (void)n_required, (void)environment, (void)log, (void)update;
    return make();
}
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, Boolean visible,
                                   Boolean logging, void *environment, void *log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    return make();
}
void fmi3FreeInstance(void *c) { free(c); }
int fmi3EnterInitializationMode(void *c, Boolean defined, double tolerance, double start, Boolean stops, double stop) {
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->time = start;
    return 0;
}
int fmi3ExitInitializationMode(void *c) { return (void)c, 0; }
int fmi3UpdateDiscreteStates(void *c, Boolean *need, Boolean *terminate, Boolean *nominals, Boolean *values,
                             Boolean *defined, double *next) {
    (void)c, (void)next;
    *need = *terminate = *nominals = *values = *defined = 0;
    return 0;
}
int fmi3EnterContinuousTimeMode(void *c) { return (void)c, 0; }
int fmi3SetTime(void *c, double time) { return ((Model *)c)->time = time, 0; }
int fmi3SetContinuousStates(void *c, const double *x, size_t n) { return (void)n, set_states(c, x); }
int fmi3GetContinuousStates(void *c, double *x, size_t n) { return (void)n, get_states(c, x); }
int fmi3GetContinuousStateDerivatives(void *c, double *dx, size_t n) { return (void)n, rates(c, dx), 0; }
int fmi3DoStep(void *c, double from, double size, Boolean no_set_state, Boolean *event, Boolean *terminate,
               Boolean *early, double *last) {
    (void)no_set_state;
    *event = *terminate = *early = 0;
    *last = from + size;
    return step(c, from, size);
}
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *values, size_t n_values) {
    return (void)n_values, get(c, r, n, values);
}
int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *values, size_t n_values) {
    return (void)n_values, set(c, r, n, values);
}

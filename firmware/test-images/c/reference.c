/* The thermal half and the sample half for three axes, as docs/mathematics.md says it, in plain C.
 *
 * It is what the core is compared with: the same outputs bit by bit, and the instructions that a
 * compiler of C takes for them. So it branches where a reader of the document would, and computes
 * nothing that the branch taken does not need.
 *
 * PREFIX comes before every name, so that two compilations of this file can be in one image.
 */
#include <float.h>
#include <stdbool.h>
#include <stdint.h>

/* Of the compiler itself: no library is needed. */
float fabsf(float);

#define JOIN(a, b) a##b
#define NAME(prefix, name) JOIN(prefix, name)
#define FN(name) NAME(PREFIX, name)

#define AXES 3
#define PLAYS 2
#define BLOCK 8

/* Flags of the status. */
#define TEMPERATURE_INVALID (1u << 0)
#define TEMPERATURE_SPIKE (1u << 1)
#define TEMPERATURE_LOST (1u << 2)
#define SETTLING (1u << 3)
#define INTERVAL_INVALID (1u << 4)
#define TEMPERATURE_CLAMPED (1u << 5)
#define RATE_CLAMPED (1u << 6)
#define LAG_CLAMPED (1u << 8)
#define HISTORY_UNKNOWN (1u << 9)
#define TEMPERATURE_JUMPED (1u << 10)

/* Times are counted in ticks of 10 us; sums of many short times in float would stand still. */
#define TICKS_PER_S 1e5f
#define LONGEST_TIMER_S 2e4f
#define LONGEST_TIME INT32_MAX
#define START_S 120.0f
#define LEAST_MEMORY_S 60.0f
#define FADE_S 60.0f
#define LEAST_SLEW_C 2e-5f
/* No ramp is longer [samples], so one that is late by this is late for ever. */
#define FAR_BEYOND 0x10000

struct settings {
    float sensor_min_c, sensor_max_c, spike_gate_c, max_slew_c_per_min, hold_s, heal_s, tau_s, kappa;
    float rate_min_c_per_min, rate_max_c_per_min, reference_c, tau2_s, kappa2, lag2_min_c, lag2_max_c;
    float half_width_c[PLAYS], play_kappa, play_kappa2;
    float least_divisor, rate_start, lag2_start_min, play_start_min;
};

struct terms {
    float a[3], r[2], s[2];
};

/* A table as the core has it, in one piece; filled by the caller. */
struct table {
    struct settings settings;
    float first_edge_c, cells_per_c, t_min_c, t_max_c;
    float play_gains[PLAYS][AXES];
    const struct terms (*cells)[AXES];
};

/* A table with what follows from its settings. */
struct model {
    struct table table;
    float sensor_middle_c, sensor_reach_c;
    int32_t hold_ticks, restart_ticks, heal_ticks, settling_ticks;
    float slew_c_per_tick, per_tau_hz, per_tau2_hz, tau_min, shift_min, play_shift_min, least_memory;
    int32_t start_ticks, known_ticks;
    float known_c;
    bool has_lag2;
};

struct interval {
    int32_t ticks;
    bool has_passed;
    uint16_t status;
    /* How far a reading may be from the last one to agree with it [degC]; below zero, not at all. */
    float near_c;
    float alpha, alpha2, rate_gain_per_min, slew_c, fade;
};

/* A first-order filter; `remainder` is what rounding left out of `value`. */
struct filter {
    float value, remainder;
};

struct point {
    float effective_c, rate_c_per_min, lag2_c, plays_c[PLAYS];
    uint32_t status;
};

/* One of two rooms for a ramp. */
struct ramp {
    int32_t left;
    uint16_t samples, status;
    float end[AXES], slope[AXES];
};

struct unit {
    const struct model *model;
    /* Conditioning. */
    int32_t age, settled;
    uint32_t rejected, restarts;
    float temp_c, anchor_c;
    bool is_jumping, has_jumped;
    /* Rate. */
    struct filter filtered, memory;
    float gain;
    /* History. */
    struct filter filtered2;
    float temp2_c, drag_c, contacts_c[PLAYS];
    int32_t since_loss;
    float low_c, high_c;
    /* What comes out. */
    int32_t starting;
    float weight;
    struct point point;
    float end[AXES];
    uint16_t samples_per_update;
    float updates_per_sample;
    /* To the sample half; the lowest bit says which room is valid. */
    volatile uint32_t sequence;
    struct ramp ramps[2];
};

struct inputs {
    struct interval interval;
    float temp_c;
    float raw[AXES];
};

struct outputs {
    float compensated[AXES];
    float block[BLOCK][AXES];
};

/* All that a thermal update puts out, to be compared. */
struct outcome {
    float end[AXES], slope[AXES];
    float effective_c, rate_c_per_min, lag2_c, plays_c[PLAYS];
    uint32_t samples, ramp_status, point_status, rejected, restarts;
};

/* A temperature to go on with. */
struct conditioned {
    float temp_c;
    /* The change from the one before [degC]; if it is no movement of the part, the filter is shifted. */
    float change_c;
    bool is_shift, is_lost, is_first, was_unseen;
    uint32_t status;
};

/* The caller has memory of these sizes [bytes]. */
typedef char model_fits[sizeof(struct model) <= 256 ? 1 : -1];
typedef char unit_fits[sizeof(struct unit) <= 256 ? 1 : -1];
typedef char inputs_fit[sizeof(struct inputs) == 48 ? 1 : -1];

static int32_t later(int32_t time, int32_t ticks)
{
    return time > LONGEST_TIME - ticks ? LONGEST_TIME : time + ticks;
}

static float limited(float value, float most)
{
    return value > most ? most : value < -most ? -most : value;
}

static float at_least(float value, float least)
{
    return value > least ? value : least;
}

static float clamped(float value, float min, float max, uint32_t flag, uint32_t *status)
{
    if (value < min) {
        *status |= flag;
        return min;
    }
    if (value > max) {
        *status |= flag;
        return max;
    }
    return value;
}

/* Takes an input; returns how far the filter lagged behind it. */
static float lag(struct filter *filter, float alpha, float input)
{
    float before = filter->value;
    float lag = (input - before) - filter->remainder;
    float increment = alpha * lag + filter->remainder;
    filter->value = before + increment;
    filter->remainder = increment - (filter->value - before);
    return lag;
}

static bool is_possible(const struct model *m, float temp_c)
{
    return fabsf(temp_c - m->sensor_middle_c) <= m->sensor_reach_c;
}

static void reject(struct unit *u)
{
    int32_t healing = u->age > LONGEST_TIME - u->model->heal_ticks
                          ? INT32_MIN
                          : -u->model->heal_ticks - u->age;
    if (u->settled > healing)
        u->settled = healing;
    u->rejected++;
}

/* A reading that the part cannot have reached, or after a loss one that does not agree with the one
 * before: rejected. */
static bool is_rejected(const struct interval *dt, bool was_lost, float change_c, float way_c,
                        float gate_c)
{
    if (was_lost)
        return change_c > dt->near_c;
    return way_c > gate_c || change_c > gate_c;
}

static struct conditioned condition(struct unit *u, const struct interval *dt, float temp_c)
{
    const struct model *m = u->model;
    bool was_lost = u->age > m->hold_ticks;
    bool is_first = u->age == LONGEST_TIME;
    int32_t age = later(u->age, dt->ticks);
    struct conditioned c = {.is_lost = age > m->hold_ticks, .was_unseen = age > m->hold_ticks};

    if (!is_possible(m, temp_c)) {
        c.status = TEMPERATURE_INVALID;
        reject(u);
        u->age = age;
    } else if (!dt->has_passed) {
        reject(u);
        u->age = age;
        /* Once the temperature is lost, the next one may confirm it. */
        if (c.is_lost) {
            c.is_shift = true;
            c.change_c = temp_c - u->temp_c;
            u->temp_c = temp_c;
        }
    } else {
        float change_c = temp_c - u->temp_c, way_c = temp_c - u->anchor_c;
        float change_size_c = fabsf(change_c), way_size_c = fabsf(way_c);
        float reach_c = m->slew_c_per_tick * (float)age;
        float gate_c = m->table.settings.spike_gate_c + reach_c;
        bool is_beyond = way_size_c > gate_c;
        bool is_fresh = change_size_c > dt->near_c || age > m->restart_ticks;
        if (is_beyond && !is_first)
            u->is_jumping = true;
        if (is_rejected(dt, was_lost, change_size_c, way_size_c, gate_c)) {
            c.status = TEMPERATURE_SPIKE;
            reject(u);
            u->age = age;
            if (was_lost && !is_beyond)
                u->is_jumping = false;
            /* The next one may confirm it. */
            if (c.is_lost) {
                u->temp_c = temp_c;
                c.is_shift = is_fresh;
                c.change_c = change_c;
            }
        } else {
            c.is_lost = false;
            c.is_first = is_first;
            u->age = 0;
            u->temp_c = temp_c;
            if (is_fresh) {
                c.is_shift = true;
                c.change_c = change_c;
                u->settled = -m->settling_ticks;
                u->restarts++;
            } else {
                u->settled = later(u->settled, dt->ticks);
            }
            if (u->is_jumping && way_size_c > dt->near_c)
                u->has_jumped = true;
            u->is_jumping = false;
            /* The anchor follows no faster than the part can. */
            if (was_lost)
                u->anchor_c = temp_c;
            else
                u->anchor_c += limited(way_c, at_least(reach_c, dt->slew_c));
        }
    }
    if (c.is_lost)
        c.status |= TEMPERATURE_LOST;
    if (u->settled < 0)
        c.status |= SETTLING;
    if (u->has_jumped)
        c.status |= TEMPERATURE_JUMPED;
    c.temp_c = u->temp_c;
    return c;
}

/* Rate of temperature [degC/min], without limits. */
static float rate(struct unit *u, const struct interval *dt, const struct conditioned *c)
{
    if (c->is_shift)
        u->filtered.value += c->change_c;
    float lag_c = lag(&u->filtered, dt->alpha, c->temp_c);
    lag(&u->memory, dt->alpha, 1.0f);
    float memory = at_least(u->memory.value, u->model->least_memory);
    u->gain = at_least(u->gain * (2.0f - memory * u->gain), 1.0f);
    return lag_c * dt->rate_gain_per_min * u->gain;
}

/* Second lag [degC], without limits. */
static float lag2(struct unit *u, const struct interval *dt, const struct conditioned *c, bool starts,
                  float start_c)
{
    float alpha2 = dt->alpha2;
    if (c->is_lost) {
        alpha2 = 0.0f;
    } else if (c->is_first) {
        alpha2 = 1.0f;
        u->temp2_c += c->temp_c - u->temp2_c;
    } else {
        u->temp2_c += limited(c->temp_c - u->temp2_c, dt->slew_c);
    }
    float lag_c = lag(&u->filtered2, alpha2, u->temp2_c) * (1.0f - alpha2);
    if (!starts)
        return lag_c;
    u->filtered2.value = u->temp2_c - start_c;
    return start_c;
}

static void plays(struct unit *u, const struct interval *dt, const struct conditioned *c, float target_c,
                  bool starts, float start_c, float plays_c[PLAYS])
{
    const struct model *m = u->model;
    const struct settings *s = &m->table.settings;
    float way_c = target_c - u->drag_c;
    starts |= c->is_first;
    bool is_catching_up = !starts && fabsf(way_c) > dt->slew_c;
    if (starts)
        u->drag_c += way_c;
    else if (!c->is_lost)
        u->drag_c += limited(way_c, dt->slew_c);

    for (int play = 0; play < PLAYS; play++) {
        float half_width_c = s->half_width_c[play];
        float contact_c = u->contacts_c[play];
        if (starts)
            contact_c = u->drag_c - limited(start_c, half_width_c);
        if (contact_c < u->drag_c - half_width_c)
            contact_c = u->drag_c - half_width_c;
        else if (contact_c > u->drag_c + half_width_c)
            contact_c = u->drag_c + half_width_c;
        u->contacts_c[play] = contact_c;
        plays_c[play] = u->drag_c - contact_c;
    }

    /* Of a loss: time since then, and the way since the rate has settled again. */
    if (c->was_unseen)
        u->since_loss = 0;
    else if (u->since_loss >= m->settling_ticks || !is_catching_up)
        u->since_loss = later(u->since_loss, dt->ticks);
    if (u->since_loss < m->settling_ticks) {
        u->low_c = u->drag_c;
        u->high_c = u->drag_c;
    } else if (u->drag_c < u->low_c) {
        u->low_c = u->drag_c;
    } else if (u->drag_c > u->high_c) {
        u->high_c = u->drag_c;
    }
}

static uint32_t bias(struct unit *u, const struct point *point, float bias[AXES])
{
    const struct table *t = &u->model->table;
    uint32_t status = point->status;
    float temp_c = clamped(point->effective_c, t->t_min_c, t->t_max_c, TEMPERATURE_CLAMPED, &status);
    float place = (temp_c - t->first_edge_c) * t->cells_per_c;
    uint32_t cell = (uint32_t)place;
    float z = place - (float)cell;
    for (int axis = 0; axis < AXES; axis++) {
        const struct terms *k = &t->cells[cell][axis];
        float sum = (k->a[0] + z * (k->a[1] + z * k->a[2])) + point->rate_c_per_min * (k->r[0] + z * k->r[1]);
        sum += point->lag2_c * (k->s[0] + z * k->s[1]);
        for (int play = 0; play < PLAYS; play++)
            sum += t->play_gains[play][axis] * point->plays_c[play];
        bias[axis] = sum;
    }
    return status;
}

static void update(struct unit *u, const struct interval *dt, float temp_c)
{
    const struct model *m = u->model;
    const struct settings *s = &m->table.settings;
    struct conditioned c = condition(u, dt, temp_c);
    uint32_t status = dt->status | c.status;
    float rate_c_per_min = clamped(rate(u, dt, &c), s->rate_min_c_per_min, s->rate_max_c_per_min, RATE_CLAMPED, &status);

    /* A unit that is switched on in a ramp has been in it. */
    bool starts = false;
    if (u->starting < 0) {
        u->starting += dt->ticks;
        starts = u->starting >= 0 && !c.is_lost;
    }
    if (starts) {
        rate_c_per_min = clamped(s->rate_start * rate_c_per_min, s->rate_min_c_per_min, s->rate_max_c_per_min, 0, &status);
        u->filtered.value = c.temp_c - m->tau_min * rate_c_per_min;
        u->memory.value = 1.0f;
    }
    float start2_c = s->lag2_start_min * rate_c_per_min;
    float lag2_c = clamped(lag2(u, dt, &c, starts, start2_c), s->lag2_min_c, s->lag2_max_c, m->has_lag2 ? LAG_CLAMPED : 0, &status);

    /* While the temperature is lost, rate and history fade out. */
    u->weight += limited((c.is_lost ? 0.0f : 1.0f) - u->weight, dt->fade);

    float measured_c = c.temp_c - m->shift_min * rate_c_per_min - s->kappa2 * lag2_c;
    float way_c = (c.is_lost ? s->reference_c : measured_c) - u->point.effective_c;
    u->point.effective_c += limited(way_c, dt->slew_c);

    float drag_c = c.temp_c - m->play_shift_min * rate_c_per_min - s->play_kappa2 * lag2_c;
    float plays_c[PLAYS];
    plays(u, dt, &c, drag_c, starts, s->play_start_min * rate_c_per_min, plays_c);

    if (fabsf(way_c) > dt->near_c || u->weight < 1.0f || u->starting < 0)
        status |= SETTLING;
    if (u->high_c - u->low_c < m->known_c || u->since_loss < m->known_ticks)
        status |= HISTORY_UNKNOWN;
    u->point.rate_c_per_min = rate_c_per_min * u->weight;
    u->point.lag2_c = lag2_c * u->weight;
    for (int play = 0; play < PLAYS; play++)
        u->point.plays_c[play] = plays_c[play] * u->weight;
    u->point.status = status;
}

/* The thermal half: takes a temperature and publishes the ramp to its bias. */
void FN(thermal)(struct unit *restrict u, const struct inputs *restrict in, struct outputs *restrict out)
{
    (void)out;
    update(u, &in->interval, in->temp_c);
    const struct ramp *former = &u->ramps[u->sequence & 1];
    struct ramp *ramp = &u->ramps[(u->sequence + 1) & 1];
    float end[AXES];
    uint32_t status = bias(u, &u->point, end);
    /* A ramp that comes early begins with a step. */
    if (2 * former->left > former->samples)
        status |= INTERVAL_INVALID;
    ramp->left = u->samples_per_update;
    ramp->samples = u->samples_per_update;
    ramp->status = (uint16_t)status;
    for (int axis = 0; axis < AXES; axis++) {
        ramp->slope[axis] = (end[axis] - u->end[axis]) * u->updates_per_sample;
        ramp->end[axis] = end[axis];
        u->end[axis] = end[axis];
    }
    /* The interrupt sees the change of the number last. */
    __asm volatile("" ::: "memory");
    u->sequence = u->sequence + 1;
}

/* The sample half: one gyro sample. */
void FN(subtract)(struct unit *restrict u, const struct inputs *restrict in, struct outputs *restrict out)
{
    struct ramp *ramp = &u->ramps[u->sequence & 1];
    int32_t left = ramp->left - 1;
    if (left >= -FAR_BEYOND)
        ramp->left = left;
    float to_end = left > 0 ? (float)left : 0.0f;
    for (int axis = 0; axis < AXES; axis++)
        out->compensated[axis] = in->raw[axis] - (ramp->end[axis] - ramp->slope[axis] * to_end);
}

/* The sample half: a block, which gets the bias of its middle. */
void FN(block8)(struct unit *restrict u, const struct inputs *restrict in, struct outputs *restrict out)
{
    (void)in;
    struct ramp *ramp = &u->ramps[u->sequence & 1];
    int32_t left = ramp->left - BLOCK;
    if (left >= -FAR_BEYOND)
        ramp->left = left;
    float middle = (float)left + 0.5f * (BLOCK - 1);
    float to_end = middle > 0.0f ? middle : 0.0f;
    float bias[AXES];
    for (int axis = 0; axis < AXES; axis++)
        bias[axis] = ramp->end[axis] - ramp->slope[axis] * to_end;
    for (int sample = 0; sample < BLOCK; sample++)
        for (int axis = 0; axis < AXES; axis++)
            out->block[sample][axis] -= bias[axis];
}

/* Nothing: what a call of the others costs by itself. */
void FN(empty)(struct unit *restrict u, const struct inputs *restrict in, struct outputs *restrict out)
{
    (void)u;
    (void)in;
    (void)out;
}

/* Flags of the sample half, as of the last gyro sample. */
uint32_t FN(status)(const struct unit *u)
{
    const struct ramp *ramp = &u->ramps[u->sequence & 1];
    bool is_late = ramp->samples > 0 && ramp->left + ramp->samples < 0;
    return ramp->status | (is_late ? INTERVAL_INVALID : 0);
}

void FN(outcome)(const struct unit *u, struct outcome *o)
{
    const struct ramp *ramp = &u->ramps[u->sequence & 1];
    const struct point *p = &u->point;
    for (int axis = 0; axis < AXES; axis++) {
        o->end[axis] = ramp->end[axis];
        o->slope[axis] = ramp->slope[axis];
    }
    o->effective_c = p->effective_c;
    o->rate_c_per_min = p->rate_c_per_min;
    o->lag2_c = p->lag2_c;
    for (int play = 0; play < PLAYS; play++)
        o->plays_c[play] = p->plays_c[play];
    o->samples = ramp->samples;
    o->ramp_status = ramp->status;
    o->point_status = p->status;
    o->rejected = u->rejected;
    o->restarts = u->restarts;
}

static int32_t ticks(float time_s)
{
    return (int32_t)(time_s * TICKS_PER_S + 0.5f);
}

void FN(model)(struct model *m, const struct table *table)
{
    const struct settings *s = &table->settings;
    m->table = *table;
    m->sensor_middle_c = 0.5f * (s->sensor_min_c + s->sensor_max_c);
    m->sensor_reach_c = at_least(fabsf(s->sensor_min_c - m->sensor_middle_c),
                                 fabsf(s->sensor_max_c - m->sensor_middle_c));
    m->hold_ticks = ticks(s->hold_s);
    m->restart_ticks = ticks(0.5f * s->tau_s);
    m->heal_ticks = ticks(s->heal_s);
    m->settling_ticks = ticks(3.0f * s->tau_s);
    m->slew_c_per_tick = s->max_slew_c_per_min / (60.0f * TICKS_PER_S);
    m->per_tau_hz = 1.0f / s->tau_s;
    m->per_tau2_hz = 1.0f / s->tau2_s;
    m->tau_min = s->tau_s / 60.0f;
    m->shift_min = s->kappa * s->tau_s / 60.0f;
    m->play_shift_min = s->play_kappa * s->tau_s / 60.0f;
    float least = at_least(LEAST_MEMORY_S / s->tau_s, s->least_divisor);
    m->least_memory = least < 1.0f ? least : 1.0f;
    m->start_ticks = s->rate_start == 0.0f ? 0 : ticks(START_S);
    m->has_lag2 = s->lag2_min_c < 0.0f || s->lag2_max_c > 0.0f;
    float known_s = 3.0f * s->tau2_s < LONGEST_TIMER_S ? 3.0f * s->tau2_s : LONGEST_TIMER_S;
    m->known_ticks = m->has_lag2 ? ticks(known_s) : 0;
    m->known_c = 2.0f * at_least(s->half_width_c[0], s->half_width_c[1]);
}

void FN(interval)(struct interval *i, const struct model *m, float dt_s)
{
    const struct settings *s = &m->table.settings;
    bool has_passed = dt_s > 0.0f;
    float real_s = has_passed ? dt_s : 0.0f;
    float longest_s = 0.5f * s->tau_s;
    bool is_gap = real_s > longest_s;
    float used_s = is_gap ? longest_s : real_s;
    float x = used_s * m->per_tau_hz;
    float alpha_per_x = 1.0f
        - x * (1.0f / 2.0f) * (1.0f - x * (1.0f / 3.0f) * (1.0f - x * (1.0f / 4.0f) * (1.0f - x * 0.2f)));
    float x2 = real_s * m->per_tau2_hz;
    float slew_c = s->max_slew_c_per_min * used_s * (1.0f / 60.0f);
    if (has_passed && slew_c < LEAST_SLEW_C)
        slew_c = LEAST_SLEW_C;
    float all_ticks = real_s * TICKS_PER_S + 0.5f;
    i->ticks = all_ticks < 2147483648.0f ? (int32_t)all_ticks : LONGEST_TIME;
    i->has_passed = has_passed;
    i->status = is_gap || !has_passed ? INTERVAL_INVALID : 0;
    i->near_c = has_passed ? s->spike_gate_c + slew_c : -1.0f;
    i->alpha = is_gap ? 1.0f : x * alpha_per_x;
    i->alpha2 = x2 > 0.5f ? 1.0f : x2 * (1.0f - x2 * (1.0f / 2.0f) * (1.0f - x2 * (1.0f / 3.0f)));
    i->rate_gain_per_min = is_gap ? 0.0f : 60.0f * m->per_tau_hz * alpha_per_x;
    i->slew_c = slew_c;
    i->fade = real_s * (1.0f / FADE_S);
}

/* A unit whose part has been at this temperature for long. */
static void at(struct unit *u, float temp_c)
{
    const struct model *m = u->model;
    u->settled = 0;
    u->rejected = 0;
    u->restarts = 0;
    u->temp_c = u->anchor_c = u->temp2_c = u->drag_c = temp_c;
    u->is_jumping = u->has_jumped = false;
    u->filtered = u->filtered2 = (struct filter){temp_c, 0.0f};
    u->memory = (struct filter){0.0f, 0.0f};
    u->gain = 1.0f / m->least_memory;
    for (int play = 0; play < PLAYS; play++)
        u->contacts_c[play] = temp_c;
    u->starting = -m->start_ticks;
    u->since_loss = LONGEST_TIME;
    u->low_c = -FLT_MAX;
    u->high_c = FLT_MAX;
    u->point = (struct point){.effective_c = temp_c};
    u->age = 0;
    u->weight = 1.0f;
}

/* A unit that has not seen a temperature: the constant bias is taken out. */
static void lost(struct unit *u)
{
    at(u, u->model->table.settings.reference_c);
    u->age = LONGEST_TIME;
    u->weight = 0.0f;
}

/* As after power-on. */
void FN(unit)(struct unit *u, const struct model *m, uint16_t samples_per_update)
{
    *u = (struct unit){.model = m};
    lost(u);
    u->samples_per_update = samples_per_update;
    u->updates_per_sample = 1.0f / (float)samples_per_update;
    u->ramps[0].status = TEMPERATURE_LOST;
    bias(u, &u->point, u->end);
}

/* Starts at the first temperature; it is published with the update that follows. */
void FN(start)(struct unit *u, float temp_c)
{
    if (is_possible(u->model, temp_c)) {
        at(u, temp_c);
        u->settled = -u->model->settling_ticks;
        u->restarts = 1;
    } else {
        lost(u);
        reject(u);
    }
    bias(u, &u->point, u->end);
}

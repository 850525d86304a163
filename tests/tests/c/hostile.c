/* Every function of AXES axes over hostile samples; prints a hash of all that comes out.

   The samples and the table are made here, and in hostile.rs by the same rules. */
#include "tempco.h"

#ifdef POSIX
#include <stdio.h>
static void print(const char *text)
{
    fputs(text, stdout);
}
static void print_word(uint32_t word)
{
    printf("%08x ", (unsigned)word);
}
#else
#include "startup.h"
void SysTick_Handler(void)
{
}
#endif

/* A fault on purpose: 1 changes a coefficient, 2 swaps two arguments. */
#ifndef FAULT
#define FAULT 0
#endif

#define PASTE_(axes, name) tempco##axes##_##name
#define PASTE(axes, name) PASTE_(axes, name)
#define T(name) PASTE(AXES, name)

enum { CELLS = 9, SAMPLES_PER_UPDATE = 8, LONGEST_BLOCK = 40 };

/* xorshift64* of Vigna (2016), its upper half. */
static uint64_t state = 0x9e3779b97f4a7c15u;

static uint32_t bits(void)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 0x2545f4914f6cdd1du) >> 32);
}

typedef union {
    float number;
    uint32_t word;
} both_t;

static float of_word(uint32_t word)
{
    both_t both;
    both.word = word;
    return both.number;
}

/* Evenly from -1 to 1. */
static float even(void)
{
    return (float)(int32_t)bits() * of_word(0x30000000u); /* 2^-31 */
}

/* One in eight is anything, or what breaks things. */
static float spoil(float good)
{
    static const uint32_t special[8] = {0x7f800000u, 0xff800000u, 0x7fc00000u, 0xff800001u,
                                        0x80000000u, 0x00000001u, 0x7f7fffffu, 0x33800000u};
    switch (bits() % 16u) {
    case 0:
        return of_word(bits());
    case 1:
        return of_word(special[bits() % 8u]);
    default:
        return good;
    }
}

static uint64_t hash = 0xcbf29ce484222325u;

static void take(uint32_t word)
{
    hash = (hash ^ word) * 0x100000001b3u;
}

/* One NaN is as good as another: processors make different ones. */
static void take_float(float number)
{
    both_t both;
    both.number = number;
    take(number != number ? 0x7fc00000u : both.word);
}

static void take_floats(const float *numbers, int count)
{
    int at;
    for (at = 0; at < count; at++) {
        take_float(numbers[at]);
    }
}

static void take_point(const tempco_point_t *point)
{
    take_float(point->effective_c);
    take_float(point->rate_c_per_min);
    take_float(point->lag2_c);
    take_floats(point->plays_c, 2);
    take(point->status);
}

static void take_ramp(const T(ramp_t) *ramp)
{
    take_floats(ramp->end, AXES);
    take_floats(ramp->slope, AXES);
    take(ramp->samples);
    take(ramp->status);
}

static tempco_terms_t cells[CELLS * AXES];
static tempco_channel_t channel = {
    {-60.0f, 150.0f, 2.0f, 30.0f, 60.0f, 10.0f, 90.0f, 0.5f, -8.0f,  9.0f, 20.0f, 400.0f,
     0.25f,  -3.0f,  4.0f, 0.5f,  2.0f,  0.75f, -0.5f, 0.7f, 1.25f, -2.0f, 0.125f},
    -40.0f, 85.0f, -35.0f, 80.0f, 0.0f,
    CELLS,
    AXES,
    {{0.0f, 0.0f, 0.0f, 0.0f, {0.0f, 0.0f}}},
    cells,
};
static T(table_t) table;
static T(thermal_t) thermal;
static T(ramps_t) ramps;
static T(pulse_ramps_t) pulse_ramps;
static T(pulses_t) pulses;
static T(compensator_t) compensator;
static const float pulses_per_unit[6] = {0.5f, -1.5f, 4.0f, 20.0f, 0.001f, 1.0f};

static void make_channel(void)
{
    int cell, term, axis;
    for (cell = 0; cell < CELLS * AXES; cell++) {
        for (term = 0; term < 3; term++) {
            cells[cell].a[term] = even();
        }
        for (term = 0; term < 2; term++) {
            cells[cell].r[term] = even();
        }
        for (term = 0; term < 2; term++) {
            cells[cell].s[term] = even();
        }
    }
    for (axis = 0; axis < AXES; axis++) {
        channel.axes[axis].play_gains[0] = even();
        channel.axes[axis].play_gains[1] = even();
    }
#if FAULT == 1
    cells[4 * AXES].a[1] *= 1.0f + 1.0f / 8388608.0f;
#endif
}

static int set_up(void)
{
    make_channel();
    return tempco_abi_version() != TEMPCO_ABI_VERSION
        || T(table_from_channel)(&table, &channel) != TEMPCO_OK
        || T(thermal_init)(&thermal, &table, SAMPLES_PER_UPDATE) != TEMPCO_OK
        || T(ramps_init)(&ramps) != TEMPCO_OK || T(pulse_ramps_init)(&pulse_ramps) != TEMPCO_OK
        || T(pulses_init)(&pulses, &pulse_ramps) != TEMPCO_OK
        || T(compensator_init)(&compensator, &table) != TEMPCO_OK;
}

static void publish(const T(ramp_t) *ramp)
{
    take_ramp(ramp);
    T(publish)(&ramps, ramp);
    T(pulse_publish)(&pulse_ramps, ramp, pulses_per_unit);
}

static void update(const tempco_interval_t *interval, float temp_c)
{
    T(ramp_t) ramp;
    tempco_point_t point;
    T(thermal_update)(&thermal, interval, temp_c, &ramp);
    publish(&ramp);
    T(thermal_point)(&thermal, &point);
    take_point(&point);
    take(T(thermal_rejected)(&thermal));
}

static void sample(const tempco_interval_t *interval, float temp_c)
{
    float raw[AXES], corrected[AXES];
    int32_t counts[AXES];
    T(output_t) out;
    int axis;
    for (axis = 0; axis < AXES; axis++) {
        raw[axis] = spoil(even());
        corrected[axis] = raw[axis];
        counts[axis] = (int32_t)bits();
    }
    T(step)(&compensator, interval, temp_c, raw, &out);
    take_floats(out.compensated, AXES);
    take_floats(out.bias, AXES);
    take_point(&out.point);
    take(out.status);
    take(tempco_raw_status(raw, AXES));
#if FAULT == 2
    T(correct)(&ramps, raw);
#else
    T(correct)(&ramps, corrected);
#endif
    take_floats(corrected, AXES);
    take(T(status)(&ramps));
    T(pulses_correct)(&pulses, counts);
    for (axis = 0; axis < AXES; axis++) {
        take((uint32_t)counts[axis]);
    }
    take(T(pulses_status)(&pulses));
}

static void block(void)
{
    static float samples[LONGEST_BLOCK][AXES];
    const uint16_t count = (uint16_t)(bits() % (LONGEST_BLOCK + 1u));
    uint32_t at;
    int axis;
    for (at = 0; at < count; at++) {
        for (axis = 0; axis < AXES; axis++) {
            samples[at][axis] = spoil(even());
        }
    }
    T(correct_block)(&ramps, samples, count);
    for (at = 0; at < count; at++) {
        take_floats(samples[at], AXES);
    }
}

int main(void)
{
    T(ramp_t) ramp;
    float temp_c = 20.0f, step_c = 0.0f;
    uint32_t number;
    if (set_up()) {
        print("not set up\n");
        return 1;
    }
    T(thermal_constant)(&table, &ramp);
    publish(&ramp);
    for (number = 0; number < SAMPLES; number++) {
        tempco_interval_t interval;
        float dt_s = 0.1f, reading_c;
        if (number % 4096u == 0) {
            /* Now and then the unit is switched on again. */
            const float start_c = spoil(temp_c);
            T(thermal_start)(&thermal, start_c, &ramp);
            publish(&ramp);
            T(start)(&compensator, start_c);
        }
        if (number % 512u == 0) {
            step_c = 0.0625f * even();
        }
        temp_c += step_c;
        if (temp_c < -50.0f || temp_c > 100.0f) {
            temp_c = 20.0f;
        }
        if (number / 4096u % 4u == 2) {
            dt_s = 0.125f + 0.0625f * even();
        } else if (number / 4096u % 4u == 3) {
            dt_s = spoil(0.1f);
        }
        T(interval_init)(&interval, &table, dt_s);
        reading_c = spoil(temp_c);
        if (number % SAMPLES_PER_UPDATE == 0 && bits() % 16u != 0) {
            update(&interval, reading_c);
        }
        sample(&interval, reading_c);
        if (number % 16u == 0) {
            block();
        }
    }
    print("hash ");
    print_word((uint32_t)(hash >> 32));
    print_word((uint32_t)hash);
    print("\n");
    return 0;
}

/* tempco.h: the tempco core in C99 and C++17.

   Removes the thermal part of a gyroscope's bias, sample by sample, in fixed time. The core is a
   static library without a heap, globals or locks; this header declares it.

   Number of axes. One table serves the axes that share a temperature: 1, 2, 3 or 6 of them. The
   functions of each number have its prefix: tempco1_, tempco2_, tempco3_, tempco6_. They differ in
   nothing else, so tempco_axes.h declares them once, as TEMPCO_N(name).

   Two halves. The thermal half runs in the main loop, 1 to 100 times a second, and turns each
   temperature into a ramp of the bias. The sample half runs in the sampling interrupt and subtracts
   along the ramp. Between them is a buffer without a lock:

       main loop                                   interrupt
       tempco3_thermal_update -> tempco3_publish -> tempco3_correct

   Where temperature and gyro are sampled together, tempco3_step does both.

   Objects. The caller owns all memory: an object is a variable of a type below, static or on the
   stack. Its contents are private. It is made by its _init function, may not be copied or moved
   while another object uses it, and needs no end. Every function is re-entrant: it touches its
   arguments only. One object must not be in two functions at once, except a buffer of ramps, see
   publish.

   Set-up functions return 0 or a negative code. They check that pointers are not null and are
   aligned, and all contents. A pointer to anything else is undefined, as ever in C. An object whose
   set-up failed is not written.

   The other functions check nothing: pointers must be those of objects that were set up. Numbers
   may be anything, NaN included: the outcome is finite where gyro samples are, and says in its
   status what was wrong.

   Timing. Figures are instructions executed on a Cortex-M4F (archive thumbv7em-none-eabihf), three
   axes, with the return, without the call. "Always" is: the same number for every input. Stack is in
   bytes, with all that a function calls, on the same processor.

   Context. "Main loop": one thread of execution, or a low-priority task. "Interrupt": the one
   sampling interrupt of the same core. "Any": wherever you like. */
#ifndef TEMPCO_H
#define TEMPCO_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of the interface: sizes of objects and meanings of functions. */
#define TEMPCO_ABI_VERSION 1u

/* The version that the archive was made with. Compare it once with TEMPCO_ABI_VERSION: a header and
   an archive of different versions must not be mixed.
   Context: any. Timing: 4. Stack: 8. */
uint32_t tempco_abi_version(void);

/* Codes of set-up functions. */
enum {
    TEMPCO_OK = 0,
    TEMPCO_E_NULL = -1,         /* a pointer is null */
    TEMPCO_E_ALIGNMENT = -2,    /* an object, or an image, is not aligned */
    TEMPCO_E_SHORT = -3,        /* the bytes end within the image */
    TEMPCO_E_MAGIC = -4,        /* the bytes are no image */
    TEMPCO_E_VERSION = -5,      /* layout or equations of another version */
    TEMPCO_E_CRC = -6,          /* the image was damaged */
    TEMPCO_E_FIELD = -7,        /* a field is out of range, or fields do not agree */
    TEMPCO_E_SHAPE = -8,        /* no such channel, or another number of axes */
    TEMPCO_E_SETTING = -9,      /* a setting, edge or gain is not finite or out of range */
    TEMPCO_E_CELLS = -10,       /* no cells, or too many */
    TEMPCO_E_COEFFICIENT = -11, /* a coefficient is not finite or beyond 1e20 */
    TEMPCO_E_AXIS = -12,        /* a number of an axis is not finite or below zero */
    TEMPCO_E_JUMP = -13,        /* the bias jumps between cells of a continuous image */
    TEMPCO_E_OTHER = -99        /* refused for another reason */
};

/* A code in words: a constant string, never null, also for codes that are none.
   Context: any. Timing: 8 to 20. Stack: 8. */
const char *tempco_strerror(int32_t code);

/* Flags of a sample, in a status of 16 bits. */
enum {
    TEMPCO_STATUS_TEMPERATURE_INVALID = 0x0001, /* not finite, or the sensor cannot report it: held */
    TEMPCO_STATUS_TEMPERATURE_SPIKE = 0x0002,   /* changed too fast: the last good one is held */
    TEMPCO_STATUS_TEMPERATURE_LOST = 0x0004,    /* none for the hold time: constant bias only */
    TEMPCO_STATUS_SETTLING = 0x0008,            /* soon after a start, or after a bad temperature */
    TEMPCO_STATUS_INTERVAL_INVALID = 0x0010,    /* no time passed, too much, or an early or late ramp */
    TEMPCO_STATUS_TEMPERATURE_CLAMPED = 0x0020, /* outside the calibrated range: its end is used */
    TEMPCO_STATUS_RATE_CLAMPED = 0x0040,        /* the same of the rate of temperature */
    TEMPCO_STATUS_RAW_INVALID = 0x0080,         /* a gyro sample is NaN or infinite */
    TEMPCO_STATUS_LAG_CLAMPED = 0x0100,         /* outside the calibrated range, the second lag */
    TEMPCO_STATUS_HISTORY_UNKNOWN = 0x0200,     /* the temperature was lost, and history counts */
    TEMPCO_STATUS_TEMPERATURE_JUMPED = 0x0400   /* since the start it jumped further than a part can */
};

/* The name of the lowest flag that is set, such as "settling"; "ok" for 0, "unknown" for a bit
   without a meaning. A constant string. To name all flags, clear the lowest one and ask again:
   status &= status - 1.
   Context: any. Timing: 20. Stack: 8. */
const char *tempco_status_name(uint16_t status);

/* What a monitor acts on. */
enum {
    TEMPCO_VALID = 0,    /* no flag */
    TEMPCO_DEGRADED = 1, /* compensated with stale, clamped or still settling thermal data */
    TEMPCO_INVALID = 2   /* the constant bias only, or the gyro sample is not a number */
};

/* The class of a status.
   Context: any. Timing: 11. Stack: 8. */
int32_t tempco_validity(uint16_t status);

/* TEMPCO_STATUS_RAW_INVALID if one of count gyro samples is NaN or infinite, else 0. The correct
   functions do not look at samples: a NaN passes through, and harms no later one.
   Precondition: raw points to count values.
   Context: interrupt. Timing: 27 for three values, always. Stack: 8. */
uint16_t tempco_raw_status(const float *raw, size_t count);

/* Coefficients of one axis in one cell, lowest power first, with z from 0 at the cold edge of the
   cell to 1 at its hot edge: bias = a[0] + a[1] z + a[2] z^2 + rate (r[0] + r[1] z)
   + lag2 (s[0] + s[1] z). */
typedef struct {
    float a[3]; /* unit of the axis */
    float r[2]; /* unit of the axis per degC/min */
    float s[2]; /* unit of the axis per degC */
} tempco_terms_t;

/* Settings of the thermal path; docs/formats.md explains each. */
typedef struct {
    float sensor_min_c;
    float sensor_max_c;
    float spike_gate_c;
    float max_slew_c_per_min;
    float hold_s;
    float heal_s;
    float tau_s;
    float kappa;
    float rate_min_c_per_min;
    float rate_max_c_per_min;
    float reference_c;
    float tau2_s;
    float kappa2;
    float lag2_min_c;
    float lag2_max_c;
    float half_width1_c;
    float half_width2_c;
    float play_kappa;
    float play_kappa2;
    float least_divisor;
    float rate_start;
    float lag2_start_min;
    float play_start_min;
} tempco_thermal_t;

/* One axis; a number that is not known or not used is 0. */
typedef struct {
    float scale_factor_arcsec; /* per pulse */
    float row_noise;           /* standard deviation of fitted rows; unit of the axis */
    float row_noise_interval_s;
    float rezero_limit;  /* unit of the axis */
    float play_gains[2]; /* unit of the axis per degC */
} tempco_axis_t;

/* One temperature channel, as table.h has it. */
typedef struct {
    tempco_thermal_t thermal;
    float first_edge_c; /* cold edge of the first cell */
    float last_edge_c;  /* hot edge of the last cell; all cells have the same width */
    float t_min_c;      /* calibrated range, to which temperatures are clamped */
    float t_max_c;
    float period_s; /* time between two temperatures of the fit; 0: not known */
    uint32_t cell_count;
    uint32_t axis_count;
    tempco_axis_t axes[6];       /* those there are, then zeros */
    const tempco_terms_t *cells; /* all axes of the coldest cell, then all of the next */
} tempco_channel_t;

/* What an image says of itself. */
typedef struct {
    char serial[33];               /* of the unit, ended by zeros */
    uint8_t units[6];              /* of each axis: 1 deg/h, 2 deg/s, 3 rad/s, 4 pulses/s, 5 m/s^2, 6 g */
    uint8_t reserved;              /* 0 */
    float scale_factors_arcsec[6]; /* per pulse; 0: not known */
    uint32_t table_crc;            /* by which the set is recognised; also in coefficients.json */
    uint32_t channels;             /* temperature channels */
    uint32_t axes;                 /* axes of each channel */
} tempco_image_info_t;

/* Reads what an image says of itself, and checks its CRCs; the tables are checked when they are
   taken. Look at serial and units before you use a table: a bias in deg/h must not be taken from
   samples in deg/s.
   image: aligned to 4 bytes, length bytes; what lies behind the image is passed over.
   Context: main loop. Timing: 32750 for an image of 3476 bytes (38 cells). Stack: 1832. */
int32_t tempco_image_info(tempco_image_info_t *info, const void *image, size_t length);

/* Bytes of an object: fixed ones, pointers, and some for each axis; a multiple of 8. */
#define TEMPCO_WORDS_(fixed, pointers, per_axis, axes) \
    (((fixed) + (pointers) * sizeof(void *) + (per_axis) * (axes) + 7u) / 8u)

/* The time between two thermal updates, turned into factors. */
typedef struct {
    uint64_t private_[5];
} tempco_interval_t;

/* Where the bias model was evaluated. */
typedef struct {
    float effective_c;    /* lag-compensated temperature, degC */
    float rate_c_per_min; /* rate of temperature, within the calibrated range, degC/min */
    float lag2_c;         /* second lag, within the calibrated range, degC */
    float plays_c[2];     /* what each play (backlash) is behind, degC */
    uint16_t status;      /* flags of the temperature */
    uint16_t reserved;    /* 0 */
} tempco_point_t;

#define TEMPCO_AXES_ 1
#define TEMPCO_N(name) tempco1_##name
#include "tempco_axes.h"

#define TEMPCO_AXES_ 2
#define TEMPCO_N(name) tempco2_##name
#include "tempco_axes.h"

#define TEMPCO_AXES_ 3
#define TEMPCO_N(name) tempco3_##name
#include "tempco_axes.h"

#define TEMPCO_AXES_ 6
#define TEMPCO_N(name) tempco6_##name
#include "tempco_axes.h"

#ifdef __cplusplus
}
#endif

#endif

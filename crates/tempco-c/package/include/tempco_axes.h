/* tempco_axes.h: the objects and functions of one number of axes. tempco.h includes it for each
   number; do not include it yourself. TEMPCO_N(correct) stands for tempco1_correct,
   tempco2_correct, tempco3_correct and tempco6_correct, TEMPCO_AXES_ for the number.

   Biases and gyro samples are in the unit of the axis that the table was fitted in: deg/h, deg/s,
   rad/s, pulses/s, m/s^2 or g. Temperatures are in degC. */

/* A checked table. Its cells stay in the image, or where table.h has them. Constant after set-up:
   any number of objects may use it. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(184u, 3u, 8u, TEMPCO_AXES_)];
} TEMPCO_N(table_t);

/* The thermal half: the state of the thermal path. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(136u, 1u, 4u, TEMPCO_AXES_)];
} TEMPCO_N(thermal_t);

/* The buffer between the halves: room for two ramps. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(20u, 0u, 16u, TEMPCO_AXES_)];
} TEMPCO_N(ramps_t);

/* The same, for whole pulses. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(20u, 0u, 16u, TEMPCO_AXES_)];
} TEMPCO_N(pulse_ramps_t);

/* The sample half of whole pulses: what is carried from sample to sample. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(0u, 1u, 4u, TEMPCO_AXES_)];
} TEMPCO_N(pulses_t);

/* The single step. */
typedef struct {
    uint64_t private_[TEMPCO_WORDS_(104u, 1u, 0u, TEMPCO_AXES_)];
} TEMPCO_N(compensator_t);

/* A straight line of the bias over the gyro samples until the next thermal update:
   bias of the n-th sample, counted from 1 = end - slope * max(samples - n, 0). */
typedef struct {
    float end[TEMPCO_AXES_];   /* bias at the end, and from there on */
    float slope[TEMPCO_AXES_]; /* per gyro sample */
    uint16_t samples;          /* 1 to 65535; 0: a level bias that no other one is due after */
    uint16_t status;           /* flags of the thermal update */
} TEMPCO_N(ramp_t);

/* A compensated sample with what led to it. */
typedef struct {
    float compensated[TEMPCO_AXES_]; /* raw - bias */
    float bias[TEMPCO_AXES_];        /* always finite */
    tempco_point_t point;
    uint16_t status;
    uint16_t reserved; /* 0 */
} TEMPCO_N(output_t);

/* Set-up. All return 0 or a code. Context: main loop, before the interrupt is enabled. */

/* A table from a flash image, which is checked and used in place: integrity by its CRCs, then the
   contents.
   image: aligned to 4 bytes; it must neither change nor go away while the table is in use.
   length: bytes there are; what lies behind the image is passed over.
   channel: number of the temperature channel, from 0.
   TEMPCO_E_SHAPE: the channel has another number of axes than this function is for.
   Timing: 111533 for an image of 3476 bytes (38 cells). Stack: 2688. */
int32_t TEMPCO_N(table_from_image)(TEMPCO_N(table_t) *table, const void *image, size_t length,
                                   uint32_t channel);

/* A table from a constant of table.h: &tempco_channels[number]. The constant must neither change
   nor go away while the table is in use.
   TEMPCO_E_SHAPE: the channel has another number of axes than this function is for.
   Timing: 9942 for 38 cells. Stack: 600. */
int32_t TEMPCO_N(table_from_channel)(TEMPCO_N(table_t) *table, const tempco_channel_t *channel);

/* The factors of a time between two thermal updates, for the settings of a table.
   dt_s: seconds. Zero, negative and NaN count as no time, and the temperature that comes with them
   is not accepted; longer than half the table's tau_s restarts the estimator. Both are flagged.
   A fixed rate takes one object, a varying one a new value before each update: that is allowed in
   the main loop at any time, and costs no division.
   Timing: 115. Stack: 16. */
int32_t TEMPCO_N(interval_init)(tempco_interval_t *interval, const TEMPCO_N(table_t) *table,
                                float dt_s);

/* A thermal half that has not seen a temperature.
   samples_per_update: gyro samples between two thermal updates, 1 to 65535 (0 counts as 1).
   Timing: 190. Stack: 128. */
int32_t TEMPCO_N(thermal_init)(TEMPCO_N(thermal_t) *thermal, const TEMPCO_N(table_t) *table,
                               uint16_t samples_per_update);

/* A buffer before the first ramp: no bias, and TEMPCO_STATUS_TEMPERATURE_LOST.
   Timing: 69. Stack: 24. */
int32_t TEMPCO_N(ramps_init)(TEMPCO_N(ramps_t) *ramps);

/* The same, for whole pulses. Timing: 69. Stack: 24. */
int32_t TEMPCO_N(pulse_ramps_init)(TEMPCO_N(pulse_ramps_t) *ramps);

/* The one reader of a buffer of pulses. Timing: 17. Stack: 8. */
int32_t TEMPCO_N(pulses_init)(TEMPCO_N(pulses_t) *pulses, TEMPCO_N(pulse_ramps_t) *ramps);

/* A compensator that has not seen a temperature: it applies the constant bias.
   Timing: 52. Stack: 8. */
int32_t TEMPCO_N(compensator_init)(TEMPCO_N(compensator_t) *compensator,
                                   const TEMPCO_N(table_t) *table);

/* The thermal half. Context: main loop. Precondition: objects that were set up; ramp and point
   point to a structure each. */

/* The constant bias, to be published before the first temperature: that at the table's reference
   temperature.
   Timing: 125. Stack: 120. */
void TEMPCO_N(thermal_constant)(const TEMPCO_N(table_t) *table, TEMPCO_N(ramp_t) *ramp);

/* Starts at the first temperature after power-on (degC), without ramping to it. Publish this ramp,
   or only that of an update that follows at once. Take care that the temperature is good, such as
   the median of several: one that the sensor can report is accepted.
   Timing: 188 to 190. Stack: 128. */
void TEMPCO_N(thermal_start)(TEMPCO_N(thermal_t) *thermal, float temp_c, TEMPCO_N(ramp_t) *ramp);

/* Takes a temperature (degC; NaN where there is none), interval after the last one: all the thermal
   work. Each ramp begins where the one before ends.
   Timing: 594, always. Stack: 144. */
void TEMPCO_N(thermal_update)(TEMPCO_N(thermal_t) *thermal, const tempco_interval_t *interval,
                              float temp_c, TEMPCO_N(ramp_t) *ramp);

/* Where the model was evaluated at the last update. Timing: 11. Stack: 16. */
void TEMPCO_N(thermal_point)(const TEMPCO_N(thermal_t) *thermal, tempco_point_t *point);

/* Temperatures rejected since the start; wraps at 2^32. Timing: 4. Stack: 8. */
uint32_t TEMPCO_N(thermal_rejected)(const TEMPCO_N(thermal_t) *thermal);

/* Makes a ramp the valid one, from the next gyro sample on.
   A ramp that comes while the former one has more than half of its samples left makes a step, and
   TEMPCO_STATUS_INTERVAL_INVALID goes with it. A level bias (samples = 0) may come at any time.
   One place of the program publishes into a buffer, and one interrupt of the same core reads it, at
   any time: no lock is needed. Two writers, two readers, or a reader on another core are not
   provided for.
   Timing: 46, always. Stack: 32. */
void TEMPCO_N(publish)(TEMPCO_N(ramps_t) *ramps, const TEMPCO_N(ramp_t) *ramp);

/* The same, for whole pulses.
   pulses_per_unit: what one unit of each axis is in pulses per gyro sample. For deg/h it is
   1 / (scale factor in arcsec/pulse * sample rate in Hz). A bias beyond 15 pulses per sample counts
   as 15, and one that is not a number as none; the resolution is 2^-26 pulses per sample.
   Timing: 133. Stack: 24. */
void TEMPCO_N(pulse_publish)(TEMPCO_N(pulse_ramps_t) *ramps, const TEMPCO_N(ramp_t) *ramp,
                             const float pulses_per_unit[TEMPCO_AXES_]);

/* The sample half. Context: interrupt. Precondition: objects that were set up; samples point to as
   many values as there are axes. No branch depends on the data, nor on a new ramp. */

/* Takes the bias out of one gyro sample, in place. The first sample after a publication takes the
   new ramp over. Where the next ramp is late the bias stays.
   Timing: 37, always. Stack: 8. */
void TEMPCO_N(correct)(TEMPCO_N(ramps_t) *ramps, float sample[TEMPCO_AXES_]);

/* Takes the bias out of count gyro samples, as a FIFO holds them, in place. The ramp advances once,
   and all get the bias of the middle of the block: the mean of what they would get one by one.
   count: 0 to 65535; 0 does nothing.
   Timing: 109 for 8 samples; depends on count alone. Stack: 16. */
void TEMPCO_N(correct_block)(TEMPCO_N(ramps_t) *ramps, float (*samples)[TEMPCO_AXES_],
                             uint16_t count);

/* Flags of the temperature, the range, and early or late ramps, as of the last gyro sample; of the
   samples themselves see tempco_raw_status.
   Timing: 18, always. Stack: 8. */
uint16_t TEMPCO_N(status)(TEMPCO_N(ramps_t) *ramps);

/* Takes the bias out of the pulses of one gyro sample, in place: whole pulses in and out, integers
   only. What a sample does not put out is carried to the next one, so that the sum stays right to
   half a pulse. A difference beyond 32 bits wraps.
   Timing: 43, always. Stack: 24. */
void TEMPCO_N(pulses_correct)(TEMPCO_N(pulses_t) *pulses, int32_t sample[TEMPCO_AXES_]);

/* The flags, as TEMPCO_N(status). Timing: 17, always. Stack: 8. */
uint16_t TEMPCO_N(pulses_status)(const TEMPCO_N(pulses_t) *pulses);

/* The single step, where temperature and gyro are sampled together. Context: one thread of
   execution, main loop or interrupt. Precondition: objects that were set up; raw points to as many
   values as there are axes, output to a structure. */

/* Starts at the first temperature after power-on (degC), without ramping to it.
   Timing: 57 to 59. Stack: 48. */
void TEMPCO_N(start)(TEMPCO_N(compensator_t) *compensator, float temp_c);

/* Takes a temperature (degC; NaN where there is none) and a gyro sample per axis, interval after
   the last ones.
   Timing: 589, always. Stack: 176. */
void TEMPCO_N(step)(TEMPCO_N(compensator_t) *compensator, const tempco_interval_t *interval,
                    float temp_c, const float raw[TEMPCO_AXES_], TEMPCO_N(output_t) *output);

#undef TEMPCO_AXES_
#undef TEMPCO_N

/* A gyro unit without an operating system, in C99 and C++17.

   SysTick stands for the interrupt of a gyro's FIFO: it takes a block of samples, removes the bias
   and puts them out. The main loop is the thermal task: it takes a temperature ten times a second.
   Gyro and thermometer are stand-ins, so that what comes out is known. */
#include "startup.h"
#include "table.h"

enum {
    BLOCK = 8,               /* samples in the FIFO when the interrupt comes */
    BLOCKS_PER_UPDATE = 25,  /* 2000 samples and 10 temperatures per second */
    UPDATES = 40             /* four seconds */
};

/* Caller-owned: nothing of tempco is allocated. */
static tempco3_table_t table;
static tempco3_thermal_t thermal;
static tempco3_ramps_t ramps; /* from the main loop to the interrupt */

static volatile uint32_t blocks;
static float output[3]; /* the last sample, for whoever sends it on */
static uint16_t output_status;

/* The gyro's FIFO. */
static void read_fifo(float samples[BLOCK][3])
{
    int sample, axis;
    for (sample = 0; sample < BLOCK; sample++) {
        for (axis = 0; axis < 3; axis++) {
            samples[sample][axis] = 0.25f * (float)(axis + 1);
        }
    }
}

/* The thermometer: it warms up by 1.2 degC/min; one reading in ten is missing. */
static float read_temperature(uint32_t update)
{
    static const float step_c = 0.002f;
    const float nan = 0.0f / (update % 10u == 9u ? 0.0f : 1.0f);
    return 24.5f + step_c * (float)update + nan;
}

/* The sampling interrupt. */
void SysTick_Handler(void)
{
    float samples[BLOCK][3];
    uint16_t status = 0;
    int sample;

    read_fifo(samples);
    for (sample = 0; sample < BLOCK; sample++) {
        status = (uint16_t)(status | tempco_raw_status(samples[sample], 3));
    }
    tempco3_correct_block(&ramps, samples, BLOCK);
    status = (uint16_t)(status | tempco3_status(&ramps));
    output[0] = samples[BLOCK - 1][0];
    output[1] = samples[BLOCK - 1][1];
    output[2] = samples[BLOCK - 1][2];
    output_status = status;
    blocks = blocks + 1;
}

/* All that is checked once. */
static int32_t set_up(tempco_interval_t *interval)
{
    int32_t code;
    if (tempco_abi_version() != TEMPCO_ABI_VERSION) {
        return TEMPCO_E_OTHER;
    }
    code = tempco3_table_from_channel(&table, &tempco_channels[0]);
    if (code == TEMPCO_OK) {
        code = tempco3_interval_init(interval, &table, 0.1f);
    }
    if (code == TEMPCO_OK) {
        code = tempco3_thermal_init(&thermal, &table, BLOCK * BLOCKS_PER_UPDATE);
    }
    if (code == TEMPCO_OK) {
        code = tempco3_ramps_init(&ramps);
    }
    return code;
}

int main(void)
{
    tempco_interval_t interval;
    tempco3_ramp_t ramp;
    uint32_t update, left;
    const int32_t code = set_up(&interval);

    if (code != TEMPCO_OK) {
        print(tempco_strerror(code));
        print("\n");
        return 1;
    }
    tempco3_thermal_start(&thermal, read_temperature(0), &ramp);
    for (update = 0; update < UPDATES; update++) {
        tempco3_thermal_update(&thermal, &interval, read_temperature(update), &ramp);
        tempco3_publish(&ramps, &ramp);
        if (update == 0) {
            start_systick(25000000 / 250); /* a block every 4 ms */
        }
        while (blocks < (update + 1) * BLOCKS_PER_UPDATE) {
            wait_for_interrupt();
        }
    }
    stop_systick();

    print("x y z ");
    print_float(output[0]);
    print_float(output[1]);
    print_float(output[2]);
    for (left = output_status; left != 0; left &= left - 1u) {
        print(tempco_status_name((uint16_t)left));
        print(left & (left - 1u) ? "+" : "\n");
    }
    return tempco_validity(output_status) == TEMPCO_INVALID;
}

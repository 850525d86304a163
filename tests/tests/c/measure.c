/* Calls every function of three axes, for who counts their instructions. */
#include "image.h"
#include "startup.h"
#include "table.h"

void SysTick_Handler(void)
{
}

static float of_word(uint32_t word)
{
    union {
        uint32_t word;
        float number;
    } both;
    both.word = word;
    return both.number;
}

static tempco3_table_t table;
static tempco3_thermal_t thermal;
static tempco3_ramps_t ramps;
static tempco3_pulse_ramps_t pulse_ramps;
static tempco3_pulses_t pulses;
static tempco3_compensator_t compensator;
static tempco_interval_t interval;
static tempco_image_info_t info;

static int set_up(void)
{
    return tempco_abi_version() != TEMPCO_ABI_VERSION
        || tempco_image_info(&info, image, sizeof image) != TEMPCO_OK
        || tempco3_table_from_image(&table, image, sizeof image, 0) != TEMPCO_OK
        || tempco3_table_from_channel(&table, &tempco_channels[0]) != TEMPCO_OK
        || tempco3_interval_init(&interval, &table, 0.1f) != TEMPCO_OK
        || tempco3_thermal_init(&thermal, &table, 200) != TEMPCO_OK
        || tempco3_ramps_init(&ramps) != TEMPCO_OK
        || tempco3_pulse_ramps_init(&pulse_ramps) != TEMPCO_OK
        || tempco3_pulses_init(&pulses, &pulse_ramps) != TEMPCO_OK
        || tempco3_compensator_init(&compensator, &table) != TEMPCO_OK;
}

static void both_halves(float temp_c)
{
    static const float pulses_per_unit[3] = {0.5f, 1.0f, -2.0f};
    static float block[8][3];
    float sample[3] = {0.25f, 0.5f, 0.75f};
    int32_t counts[3] = {1, -2, 3};
    tempco3_ramp_t ramp;
    tempco3_output_t out;
    tempco_point_t point;

    sample[1] = temp_c;
    tempco3_thermal_update(&thermal, &interval, temp_c, &ramp);
    tempco3_publish(&ramps, &ramp);
    tempco3_pulse_publish(&pulse_ramps, &ramp, pulses_per_unit);
    tempco3_thermal_point(&thermal, &point);
    tempco3_correct(&ramps, sample);
    tempco3_correct_block(&ramps, block, 8);
    tempco3_pulses_correct(&pulses, counts);
    print_word(tempco3_status(&ramps) | tempco3_pulses_status(&pulses));
    tempco3_step(&compensator, &interval, temp_c, sample, &out);
    print_word((uint32_t)tempco_raw_status(sample, 3) + out.status);
}

int main(void)
{
    static const uint32_t temps_c[6] = {0x41c80000u, 0x41c8cccdu, 0x7fc00000u,
                                        0x7f800000u, 0xff7fffffu, 0x42c80000u};
    static const uint16_t statuses[3] = {0x0000u, 0x0400u, 0x8004u};
    tempco3_ramp_t ramp;
    int number;
    if (set_up()) {
        return 1;
    }
    tempco3_thermal_constant(&table, &ramp);
    for (number = 0; number < 2; number++) {
        const float start_c = number == 0 ? of_word(0x7fc00000u) : 25.0f;
        tempco3_thermal_start(&thermal, start_c, &ramp);
        tempco3_start(&compensator, start_c);
    }
    for (number = 0; number < 6; number++) {
        both_halves(of_word(temps_c[number]));
    }
    print_word(tempco3_thermal_rejected(&thermal));
    for (number = 0; number < 3; number++) {
        print(tempco_status_name(statuses[number]));
        print_word((uint32_t)tempco_validity(statuses[number]));
        print(tempco_strerror(-99 * number));
    }
    return 0;
}

/* The least that firmware calls, for who looks at the size. IMAGE: with a flash image. */
#include "startup.h"
#include "tempco.h"

volatile float thermometer;
volatile float gyro[3];

static tempco3_table_t table;
static tempco3_thermal_t thermal;
static tempco3_ramps_t ramps;

/* The linker says where they are, as they are not part of the program. */
extern const tempco_channel_t channel;
extern const uint32_t image[];

void SysTick_Handler(void)
{
    float sample[3];
    sample[0] = gyro[0];
    sample[1] = gyro[1];
    sample[2] = gyro[2];
    tempco3_correct(&ramps, sample);
    gyro[0] = sample[0];
    gyro[1] = sample[1];
    gyro[2] = sample[2];
}

int main(void)
{
    tempco_interval_t interval;
    tempco3_ramp_t ramp;
#ifdef IMAGE
    int32_t code = tempco3_table_from_image(&table, image, 26624, 0);
#else
    int32_t code = tempco3_table_from_channel(&table, &channel);
#endif
    code |= tempco3_interval_init(&interval, &table, 0.1f);
    code |= tempco3_thermal_init(&thermal, &table, 200);
    code |= tempco3_ramps_init(&ramps);
    if (code != TEMPCO_OK) {
        return 1;
    }
    tempco3_thermal_start(&thermal, thermometer, &ramp);
    for (;;) {
        tempco3_thermal_update(&thermal, &interval, thermometer, &ramp);
        tempco3_publish(&ramps, &ramp);
        wait_for_interrupt();
    }
}

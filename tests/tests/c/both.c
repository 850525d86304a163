/* Calls this library and another one in Rust. */
#include "tempco.h"

#ifdef POSIX
#include <stdio.h>
static void print(const char *text)
{
    fputs(text, stdout);
}
#else
#include "startup.h"
void SysTick_Handler(void)
{
}
#endif

extern int32_t other(float number);

int main(void)
{
    tempco1_ramps_t ramps;
    float sample[1] = {0.5f};
    if (tempco1_ramps_init(&ramps) != TEMPCO_OK) {
        return 1;
    }
    tempco1_correct(&ramps, sample);
    print(sample[0] > 0.25f ? "tempco 1 " : "tempco 0 ");
    print(other(0.25f) == 0 ? "other 0\n" : "other 1\n");
    return 0;
}

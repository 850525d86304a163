/* Start-up, SysTick and semihosting of a Cortex-M4F, without a C library. */
#include "startup.h"

int main(void);

extern uint32_t stack_top[], data_begin[], data_end[], data_source[], bss_begin[], bss_end[];

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define SYSTICK_CONTROL REGISTER(0xe000e010u)
#define SYSTICK_RELOAD REGISTER(0xe000e014u)
#define SYSTICK_VALUE REGISTER(0xe000e018u)
#define COPROCESSORS REGISTER(0xe000ed88u)

static uint32_t semihosting(uint32_t operation, const void *parameter)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = parameter;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void leave(int code)
{
    /* ADP_Stopped_ApplicationExit and the code. */
    const uint32_t parameter[2] = {0x20026u, (uint32_t)code};
    for (;;) {
        semihosting(0x20u, parameter);
    }
}

static void fault(void)
{
    print("fault\n");
    leave(99);
}

static void reset(void)
{
    /* Volatile: else the compiler makes calls of the C library of the loops. */
    volatile uint32_t *to;
    const uint32_t *from = data_source;
    for (to = data_begin; to != data_end; to++) {
        *to = *from++;
    }
    for (to = bss_begin; to != bss_end; to++) {
        *to = 0;
    }
    COPROCESSORS |= 0xfu << 20; /* the FPU */
    __asm__ volatile("dsb\n isb" ::: "memory");
    leave(main());
}

typedef void handler(void);

__attribute__((section(".vectors"), used)) static handler *const vectors[16] = {
    (handler *)(uintptr_t)stack_top,
    reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault,
    SysTick_Handler,
};

void start_systick(uint32_t cycles)
{
    SYSTICK_RELOAD = cycles - 1u;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 7; /* on, with its interrupt, by the processor's clock */
}

void stop_systick(void)
{
    SYSTICK_CONTROL = 0;
}

uint32_t systick_left(void)
{
    return SYSTICK_VALUE;
}

void wait_for_interrupt(void)
{
    __asm__ volatile("wfi" ::: "memory");
}

void print(const char *text)
{
    semihosting(4u, text);
}

void print_word(uint32_t word)
{
    char text[10];
    int digit;
    for (digit = 0; digit < 8; digit++) {
        text[digit] = "0123456789abcdef"[(word >> (28 - 4 * digit)) & 15u];
    }
    text[8] = ' ';
    text[9] = 0;
    print(text);
}

void print_float(float number)
{
    union {
        float number;
        uint32_t bits;
    } both;
    both.number = number;
    print_word(both.bits);
}

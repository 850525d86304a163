/* What the program needs of the board: Arm's MPS2 with the AN386 image, as QEMU has it. */
#ifndef STARTUP_H
#define STARTUP_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* SysTick's interrupt, of the program. */
void SysTick_Handler(void);

/* Lets SysTick come every so many cycles of the processor. */
void start_systick(uint32_t cycles);
void stop_systick(void);
/* The cycles that SysTick has left. */
uint32_t systick_left(void);
/* Sleeps until an interrupt has come. */
void wait_for_interrupt(void);

/* To the debugger, by semihosting. */
void print(const char *text);
/* A number in full: its bits as eight hexadecimal digits, and a blank. */
void print_float(float number);
void print_word(uint32_t word);

#ifdef __cplusplus
}
#endif

#endif

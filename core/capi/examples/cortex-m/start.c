/* Reset of a Cortex-M with a floating-point unit: switch the unit on, then the C library's start-up. */
#include <stdint.h>

extern uint32_t __StackTop;
void _start(void);

void start(void) {
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: full access to the coprocessors 10 and 11 */
  __asm volatile("dsb\n\tisb");
  _start();
}

static void stop(void) {
  for (;;) {
  }
}

struct vectors {
  uint32_t *stack;
  void (*handlers[15])(void);
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    &__StackTop, {start, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0, stop, stop}};

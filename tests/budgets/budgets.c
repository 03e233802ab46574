/* What the online stage costs on a Cortex-M: instructions by the board's 25 MHz timer (QEMU with -icount shift=6 spends
   64 ns an instruction), and stack by painting it. Prints one line "name value" a figure. */
#include <capsule.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

extern const unsigned char capsule_file[], capsule_file_end[];
extern uint32_t __StackLimit;

static capsule_model model;
static capsule_workspace workspace;
static float points[8192];

enum { PAINTED = 48 * 1024, COLOUR = 0x5a5a5a5a };

#define TIMER ((volatile uint32_t *)0x40000000)

static uint32_t ticks(void) { return TIMER[1]; }

static void check(capsule_status status) {
  if (status != CAPSULE_STATUS_OK) {
    printf("failed: %s\n", capsule_status_text(status));
    exit(1);
  }
}

/* Paints the stack below this frame. */
static __attribute__((noinline)) uint32_t *paint(void) {
  uint32_t *here = __builtin_frame_address(0);
  uint32_t *top = here - 16;
  for (uint32_t *word = top - PAINTED / 4; word < top; word++) *(volatile uint32_t *)word = COLOUR;
  return top;
}

static __attribute__((noinline)) uint32_t used(const uint32_t *top) {
  const uint32_t *word = top - PAINTED / 4;
  while (word < top && *word == COLOUR) word++;
  return 4 * (uint32_t)(top - word);
}

static uint32_t overhead;
static uint32_t deepest;

/* Prints what a piece of work took, and keeps the deepest stack. */
#define MEASURE(name, work)                                                   \
  do {                                                                        \
    uint32_t *top = paint();                                                  \
    uint32_t before = ticks();                                                \
    work;                                                                     \
    uint32_t spent = before - ticks() - overhead;                             \
    uint32_t stack = used(top);                                               \
    if (stack > deepest) deepest = stack;                                     \
    printf(name "_instructions %lu\n", (unsigned long)(spent * 5ull / 8));    \
    printf(name "_stack_bytes %lu\n", (unsigned long)stack);                  \
  } while (0)

static void query(uint32_t method, float capillary_number, float confinement, float t) {
  const float parameters[] = {capillary_number, confinement};
  const capsule_query asked = {.parameters = parameters, .parameter_count = 2, .method = method};
  capsule_observables observables;
  check(capsule_prepare(&model, &workspace, &asked, NULL, NULL));
  check(capsule_observables_at(&model, &workspace, t, &observables, NULL));
}

int main(void) {
  TIMER[2] = 0xffffffff;
  TIMER[1] = 0xffffffff;
  TIMER[0] = 1;
  uint32_t before = ticks();
  overhead = before - ticks();

  size_t count;
  float number;
  capsule_membrane membrane;
  MEASURE("open", check(capsule_open(&model, sizeof model, capsule_file, capsule_file_end - capsule_file, NULL)));
  MEASURE("initialise", check(capsule_initialise(&workspace, sizeof workspace, NULL)));
  MEASURE("observables", query(CAPSULE_METHOD_DIRECT, 0.083f, 0.873f, 3.3f));
  MEASURE("again", query(CAPSULE_METHOD_DIRECT, 0.083f, 0.873f, 3.31f));
  MEASURE("outline", check(capsule_outline_at(&model, &workspace, 3.31f, CAPSULE_OUTLINE_MIDPLANE,
                                           CAPSULE_FRAME_LABORATORY, points, 8192, &count, NULL)));
  MEASURE("volume", check(capsule_volume_at(&model, &workspace, 3.31f, &number, NULL)));
  MEASURE("membrane", check(capsule_membrane_at(&model, &workspace, 3.31f, points, 8192, &membrane, NULL)));
  MEASURE("expected_error", check(capsule_expected_error_at(&model, &workspace, 3.31f, &number, NULL)));
  MEASURE("positions", check(capsule_positions_at(&model, &workspace, 3.31f, CAPSULE_FRAME_CENTROID, NULL, 0, points, 8192,
                                               &count, NULL)));
  MEASURE("velocities", check(capsule_velocities_at(&model, &workspace, 3.31f, CAPSULE_FRAME_CENTROID, NULL, 0, points,
                                                 8192, &count, NULL)));
  MEASURE("dynamics_start", query(CAPSULE_METHOD_PAPER, 0.083f, 0.873f, 0.0f));
  MEASURE("dynamics", query(CAPSULE_METHOD_PAPER, 0.083f, 0.874f, 9.9f));
  printf("stack_bytes %lu\n", (unsigned long)deepest);
  return 0;
}

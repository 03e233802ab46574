/* Cost of the online stage on a Cortex-M, through the C interface: instructions by the board's 25 MHz timer (QEMU with
   -icount shift=6 spends 64 ns on each), and stack by painting it below the frame of the caller. Prints a line
   "name value" for each figure. */
#include <capsule.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

extern const unsigned char capsule_file[], capsule_file_end[];

static capsule_model model;
static capsule_workspace workspace;
static capsule_description about;
static float numbers[3 * 4096];
static size_t count;
static capsule_observables observables;
static capsule_membrane membrane;

enum { PAINTED = 64 * 1024, COLOUR = 0x5a5a5a5a };

/* Control, value and reload of the board's first timer, which counts down. */
#define TIMER ((volatile uint32_t *)0x40000000)

static uint32_t deepest;

static void check(capsule_status status) {
  if (status != CAPSULE_STATUS_OK) {
    printf("failed: %s\n", capsule_status_text(status));
    exit(1);
  }
}

/* Runs a piece of work; returns its instructions. Its stack is all below this function's frame. */
static __attribute__((noinline)) uint32_t spend(void (*work)(void), uint32_t *stack) {
  volatile uint32_t *top;
  __asm volatile("mov %0, sp" : "=r"(top));
  for (volatile uint32_t *word = top - PAINTED / 4; word < top; word++) *word = COLOUR;
  const uint32_t before = TIMER[1];
  work();
  const uint32_t ticks = before - TIMER[1];
  volatile uint32_t *word = top - PAINTED / 4;
  while (word < top && *word == COLOUR) word++;
  *stack = 4 * (uint32_t)(top - word);
  if (*stack > deepest) deepest = *stack;
  return (uint32_t)(ticks * 5ull / 8);
}

/* Runs a piece of work and prints what it took. */
static void measure(const char *name, void (*work)(void)) {
  uint32_t stack;
  const uint32_t instructions = spend(work, &stack);
  printf("%s_instructions %lu\n%s_stack_bytes %lu\n", name, (unsigned long)instructions, name, (unsigned long)stack);
}

static uint32_t extrapolate;

static void prepare(uint32_t by, float capillary_number, float radius) {
  const float parameters[] = {capillary_number, radius};
  const capsule_query query = {
      .parameters = parameters, .parameter_count = 2, .method = by, .extrapolate = extrapolate};
  capsule_domain domain;
  check(capsule_prepare(&model, &workspace, &query, &domain, NULL));
  if ((domain == CAPSULE_DOMAIN_INSIDE) == (extrapolate != 0)) {
    printf("failed: the query is in another domain\n");
    exit(1);
  }
}

static void observe(float t) { check(capsule_observables_at(&model, &workspace, t, &observables, NULL)); }

static void open_model(void) {
  check(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), NULL));
}

static void initialise(void) { check(capsule_initialise(&workspace, sizeof workspace, NULL)); }

/* Where the model has the most modes; what a query to the observables costs is the median of spread.c. */
static void query_to_observables(void) {
  prepare(CAPSULE_METHOD_DIRECT, 0.06f, 0.95f);
  observe(3.3f);
}

static void same_interval(void) { observe(3.31f); }

static void outline(void) {
  check(capsule_outline_at(&model, &workspace, 3.3f, CAPSULE_OUTLINE_MIDPLANE, CAPSULE_FRAME_LABORATORY, numbers,
                           3 * 4096, &count, NULL));
}

static void query_to_outline(void) {
  prepare(CAPSULE_METHOD_DIRECT, 0.06f, 0.951f);
  outline();
}

static void expected_error(void) { check(capsule_expected_error_at(&model, &workspace, 3.3f, numbers, NULL)); }

static void volume(void) { check(capsule_volume_at(&model, &workspace, 3.3f, numbers, NULL)); }

static void membrane_totals(void) {
  check(capsule_membrane_at(&model, &workspace, 3.3f, numbers, 3 * 4096, &membrane, NULL));
}

static void positions(void) {
  check(capsule_positions_at(
      &model, &workspace, 3.3f, CAPSULE_FRAME_CENTROID, NULL, 0, numbers, 3 * 4096, &count, NULL));
}

static void velocities(void) {
  check(capsule_velocities_at(&model, &workspace, 3.3f, CAPSULE_FRAME_CENTROID, NULL, 0, numbers, 3 * 4096, &count,
                              NULL));
}

static void dynamics_start(void) {
  prepare(CAPSULE_METHOD_PAPER, 0.06f, 0.95f);
  observe(0.0f);
}

static void dynamics(void) {
  prepare(CAPSULE_METHOD_PAPER, 0.06f, 0.951f);
  observe(about.end_time);
}

static void error_bound(void) {
  const capsule_status status = capsule_error_bound_at(&model, &workspace, 3.3f, numbers, NULL);
  if (!extrapolate || status != CAPSULE_STATUS_NO_BOUND) check(status);
}

static void centroid(void) { check(capsule_centroid_at(&model, &workspace, 3.3f, numbers, NULL)); }

static void advance(void) {
  uint32_t done = 0;
  while (!done) check(capsule_advance(&model, &workspace, 3.3f, 1000, &done, NULL));
}

static void observables_first(void) { observe(3.3f); }

static uint32_t method;
static float capillary_number = 0.06f, confinement = 0.952f;

static void prepare_anew(void) { prepare(method, capillary_number, confinement += 1e-4f); }

/* Each question as the first one of a query: then it does all the work that they share. */
static void ask_in_every_order(const char *name) {
  static void (*const questions[])(void) = {observables_first, outline,   expected_error, error_bound, centroid, volume,
                                            membrane_totals,   positions, velocities,     advance};
  const uint32_t before = deepest;
  uint32_t stack;
  deepest = 0;
  for (size_t i = 0; i < sizeof questions / sizeof *questions; i++) {
    spend(prepare_anew, &stack);
    spend(questions[i], &stack);
  }
  printf("%s_stack_bytes %lu\n", name, (unsigned long)deepest);
  if (before > deepest) deepest = before;
}

int main(void) {
  TIMER[2] = TIMER[1] = 0xffffffff;
  TIMER[0] = 1;
  measure("open", open_model);
  const uint32_t of_open = deepest;
  deepest = 0;
  check(capsule_describe(&model, &about, NULL));
  measure("initialise", initialise);
  measure("dear_observables", query_to_observables);
  measure("same_interval", same_interval);
  measure("outline", query_to_outline);
  measure("outline_alone", outline);
  measure("expected_error", expected_error);
  measure("volume", volume);
  measure("membrane", membrane_totals);
  measure("positions", positions);
  measure("velocities", velocities);
  measure("dynamics_start", dynamics_start);
  measure("dynamics", dynamics);
  method = CAPSULE_METHOD_DIRECT;
  ask_in_every_order("direct");
  method = CAPSULE_METHOD_PAPER;
  ask_in_every_order("paper");
  /* Just beyond the steady limit, where every answer waits for a check of the whole surface. */
  extrapolate = 1;
  capillary_number = 0.076f;
  confinement = 1.1f;
  ask_in_every_order("extrapolated_paper");
  method = CAPSULE_METHOD_DIRECT;
  ask_in_every_order("extrapolated_direct");
  printf("online_stack_bytes %lu\n", (unsigned long)deepest);
  printf("stack_bytes %lu\n", (unsigned long)(deepest > of_open ? deepest : of_open));
  return 0;
}

/* How much the cost of a query spreads: instructions of many queries, one in a line, as in budgets.c. Random places in the
   sampled domain, and places chosen to be costly: samples, the clusters' border, corners, and what lies close to them. */
#include <capsule.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

extern const unsigned char capsule_file[], capsule_file_end[];

static capsule_model model;
static capsule_workspace workspace;
static capsule_description about;
static capsule_observables observables;

/* Control, value and reload of the board's first timer, which counts down. */
#define TIMER ((volatile uint32_t *)0x40000000)

static void check(capsule_status status) {
  if (status != CAPSULE_STATUS_OK) {
    printf("failed: %s\n", capsule_status_text(status));
    exit(1);
  }
}

/* A number from 0 to 1: xorshift (Marsaglia, 2003). */
static float random_number(void) {
  static uint32_t state = 2463534242u;
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return (float)(state >> 8) / 16777216.0f;
}

/* A query to the observables of one instant. Where no steady state exists it is extrapolated, at the same cost. */
static void ask(const char *name, uint32_t method, float capillary_number, float confinement, float t) {
  const float parameters[] = {capillary_number, confinement};
  const capsule_query query = {.parameters = parameters, .parameter_count = 2, .method = method, .extrapolate = 1};
  const uint32_t before = TIMER[1];
  const capsule_status prepared = capsule_prepare(&model, &workspace, &query, NULL, NULL);
  const capsule_status status =
      prepared == CAPSULE_STATUS_OK ? capsule_observables_at(&model, &workspace, t, &observables, NULL) : prepared;
  const uint32_t ticks = before - TIMER[1];
  /* Far outside, weights that do not sum to 1 are an answer too. */
  if (status != CAPSULE_STATUS_WEIGHTS && status != CAPSULE_STATUS_NOT_FINITE && status != CAPSULE_STATUS_OUTSIDE_DOMAIN) check(status);
  printf("%s %lu\n", name, (unsigned long)(ticks * 5ull / 8));
}

int main(void) {
  TIMER[2] = TIMER[1] = 0xffffffff;
  TIMER[0] = 1;
  check(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), NULL));
  check(capsule_initialise(&workspace, sizeof workspace, NULL));
  check(capsule_describe(&model, &about, NULL));
  capsule_parameter range[2];
  for (size_t i = 0; i < 2; i++) check(capsule_describe_parameter(&model, i, &range[i], NULL));
  const float least[] = {(float)range[0].least, (float)range[1].least};
  const float width[] = {(float)range[0].greatest - least[0], (float)range[1].greatest - least[1]};

  for (int i = 0; i < RANDOM; i++) {
    const float ca = least[0] + random_number() * width[0], confinement = least[1] + random_number() * width[1];
    ask("random", CAPSULE_METHOD_DIRECT, ca, confinement, random_number() * about.end_time);
  }
  /* A grid that meets the corners, the edges, the clusters' border and samples; each place also a little beside. */
  const float beside[] = {0, 1e-6f, -1e-6f, 1e-3f, -1e-3f};
  for (int i = 0; i <= 12; i++)
    for (int j = 0; j <= 12; j++)
      for (int k = 0; k < 5; k++) {
        const float ca = least[0] + width[0] * (float)i / 12 + beside[k] * width[0];
        const float confinement = least[1] + width[1] * (float)j / 12 + beside[k] * width[1];
        ask("adversarial", CAPSULE_METHOD_DIRECT, ca, confinement, i % 3 ? about.end_time * (float)j / 12 : 0.0f);
      }
  /* Parameters far outside, the ends of what is accepted. */
  const float far[] = {2e-6f, 1e-3f, 1, 1e3f, 1e6f};
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++) ask("adversarial", CAPSULE_METHOD_DIRECT, far[i], far[j], about.end_time);
  for (int i = 0; i < RANDOM / 250; i++) {
    const float ca = least[0] + random_number() * width[0], confinement = least[1] + random_number() * width[1];
    ask("paper", CAPSULE_METHOD_PAPER, ca, confinement, about.end_time);
  }
  return 0;
}

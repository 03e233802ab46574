/* How much the cost of a query spreads: instructions of many queries, one in a line, as in budgets.c. Random places in
   the sampled domain, and places chosen to be costly: samples, the clusters' border, corners, and what lies close to
   them. */
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

/* A query to the observables of one instant. Returns whether it was asked: within the sampled domain, or outside of it
   where it is extrapolated. */
static int ask(const char *name, uint32_t method, uint32_t extrapolate, float capillary_number, float confinement,
               float t) {
  const float parameters[] = {capillary_number, confinement};
  const capsule_query query = {
      .parameters = parameters, .parameter_count = 2, .method = method, .extrapolate = extrapolate};
  capsule_domain domain;
  const uint32_t before = TIMER[1];
  const capsule_status prepared = capsule_prepare(&model, &workspace, &query, &domain, NULL);
  const capsule_status status =
      prepared == CAPSULE_STATUS_OK ? capsule_observables_at(&model, &workspace, t, &observables, NULL) : prepared;
  const uint32_t ticks = before - TIMER[1];
  if ((domain == CAPSULE_DOMAIN_INSIDE) == (extrapolate != 0)) return 0;
  /* Far outside, weights that do not sum to 1 and shapes that no capsule has are answers too. */
  const int refused = status == CAPSULE_STATUS_WEIGHTS || status == CAPSULE_STATUS_NOT_FINITE ||
                      status == CAPSULE_STATUS_OUTSIDE_DOMAIN || status == CAPSULE_STATUS_IMPOSSIBLE_SHAPE;
  if (!extrapolate || !refused) check(status);
  printf("%s %lu\n", name, (unsigned long)(ticks * 5ull / 8));
  return 1;
}

/* So many queries at random places and instants. */
static void ask_randomly(const char *name, uint32_t method, uint32_t extrapolate, int count,
                         const capsule_parameter *range) {
  while (count > 0) {
    float place[2];
    for (int d = 0; d < 2; d++)
      place[d] = (float)range[d].least + random_number() * (float)(range[d].greatest - range[d].least);
    const float t = method == CAPSULE_METHOD_PAPER ? about.end_time : random_number() * about.end_time;
    count -= ask(name, method, extrapolate, place[0], place[1], t);
  }
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

  ask_randomly("random", CAPSULE_METHOD_DIRECT, 0, RANDOM, range);
  /* A grid that meets the corners, the edges, the clusters' border and samples; each place also a little beside. */
  const float beside[] = {0, 1e-6f, -1e-6f, 1e-3f, -1e-3f};
  for (int i = 0; i <= 12; i++)
    for (int j = 0; j <= 12; j++)
      for (int k = 0; k < 5; k++) {
        const float ca = least[0] + width[0] * (float)i / 12 + beside[k] * width[0];
        const float confinement = least[1] + width[1] * (float)j / 12 + beside[k] * width[1];
        ask("adversarial", CAPSULE_METHOD_DIRECT, 0, ca, confinement, i % 3 ? about.end_time * (float)j / 12 : 0.0f);
      }
  /* Outside the whole surface is checked first: just beyond the domain, and at the ends of what is accepted. */
  ask_randomly("extrapolated", CAPSULE_METHOD_DIRECT, 1, RANDOM / 10, range);
  const float far[] = {2e-6f, 1e-3f, 1, 1e3f, 1e6f};
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++) ask("extrapolated", CAPSULE_METHOD_DIRECT, 1, far[i], far[j], about.end_time);
  ask_randomly("paper", CAPSULE_METHOD_PAPER, 0, RANDOM / 250, range);
  return 0;
}

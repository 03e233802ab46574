/* A computation in slices: between two of them a control loop runs, which must not wait for the paper's method to learn
   its local model and to step to the instant. The answer is the same as without interruption. */
#include "example.h"

static capsule_model model;
static capsule_workspace workspace;

int main(void) {
  capsule_error error;
  must(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), &error), &error);
  must(capsule_initialise(&workspace, sizeof workspace, &error), &error);
  const float parameters[] = {0.06f, 0.95f}, others[] = {0.04f, 0.95f};
  const capsule_query query = {.parameters = parameters, .parameter_count = 2, .method = CAPSULE_METHOD_PAPER};
  const capsule_query other = {.parameters = others, .parameter_count = 2, .method = CAPSULE_METHOD_PAPER};
  const float t = 2.5f;

  must(capsule_prepare(&model, &workspace, &query, NULL, &error), &error);
  unsigned long loops = 0;
  for (uint32_t done = 0; !done; loops++) {
    must(capsule_advance(&model, &workspace, t, 20, &done, &error), &error);
    /* Here the control loop does its work. */
  }
  capsule_observables sliced, whole;
  must(capsule_observables_at(&model, &workspace, t, &sliced, &error), &error);
  printf("%lu slices: length %.9g\n", loops, (double)sliced.axial_length);

  must(capsule_prepare(&model, &workspace, &other, NULL, &error), &error);
  must(capsule_prepare(&model, &workspace, &query, NULL, &error), &error);
  must(capsule_observables_at(&model, &workspace, t, &whole, &error), &error);
  printf("at once: length %.9g\n", (double)whole.axial_length);
  return sliced.axial_length == whole.axial_length && loops > 1 ? 0 : 1;
}

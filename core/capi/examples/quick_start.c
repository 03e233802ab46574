/* From a model in read-only memory to the shape of a capsule. */
#include "example.h"

static capsule_model model;
static capsule_workspace workspace;

int main(void) {
  capsule_error error;

  /* Once: check the file, describe it, make the workspace. */
  must(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), &error), &error);
  must(capsule_initialise(&workspace, sizeof workspace, &error), &error);
  capsule_description about;
  must(capsule_describe(&model, &about, &error), &error);
  printf("capsule-rom %s, ", capsule_version());
  printf("model %08lx: %lu nodes, t up to %g\n", (unsigned long)about.digest, (unsigned long)about.nodes,
         (double)about.end_time);
  for (size_t i = 0; i < about.parameter_count; i++) {
    capsule_parameter parameter;
    must(capsule_describe_parameter(&model, i, &parameter, &error), &error);
    printf("  %.*s from %g to %g\n", (int)parameter.name_length, parameter.name, parameter.least, parameter.greatest);
  }

  /* For each capsule: its parameters. */
  const float parameters[] = {0.10f, 0.90f}; /* capillary number, confinement */
  const capsule_query query = {.parameters = parameters, .parameter_count = 2};
  must(capsule_prepare(&model, &workspace, &query, NULL, &error), &error);

  /* For each instant: what is needed of it. */
  capsule_observables shape;
  must(capsule_observables_at(&model, &workspace, 3.0f, &shape, &error), &error);
  printf("length %.9g, half width %.9g, rear depth %.9g, velocity %.9g\n", (double)shape.axial_length,
         (double)shape.half_width, (double)shape.rear_depth, (double)shape.velocity);
  float expected;
  must(capsule_expected_error_at(&model, &workspace, 3.0f, &expected, &error), &error);
  printf("expected error %.9g of the radius, against the full-order model (%.*s, B = %g G_s a^2)\n", (double)expected,
         (int)about.law_length, about.law, (double)about.bending_stiffness);

  static float outline[2 * 256];
  size_t count;
  must(capsule_outline_at(&model, &workspace, 3.0f, CAPSULE_OUTLINE_MIDPLANE, CAPSULE_FRAME_CENTROID, outline,
                          sizeof outline / sizeof *outline, &count, &error),
       &error);
  printf("outline of %lu points from (%.9g, %.9g) to (%.9g, %.9g)\n", (unsigned long)(count / 2), (double)outline[0],
         (double)outline[1], (double)outline[count - 2], (double)outline[count - 1]);

  /* Errors come with figures. */
  if (capsule_outline_at(&model, &workspace, 3.0f, CAPSULE_OUTLINE_MIDPLANE, CAPSULE_FRAME_CENTROID, outline, 10,
                         &count, &error) != CAPSULE_STATUS_OK)
    explain(&error);
  const float too_soft[] = {0.90f, 0.90f};
  const capsule_query refused = {.parameters = too_soft, .parameter_count = 2};
  if (capsule_prepare(&model, &workspace, &refused, NULL, &error) != CAPSULE_STATUS_OK) explain(&error);
  return 0;
}

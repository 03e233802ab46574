/* Buffers as long as the model needs, all of them static: capsule_model.h, written by `capsule-rom header`, has the
   dimensions of the model. The compiler finds a model that does not fit. */
#include "example.h"
#include <assert.h>
#include <capsule_model.h>

static_assert(CAPSULE_MODEL_MODES <= CAPSULE_MAX_MODES, "the workspace holds fewer modes than the model has");
static_assert(CAPSULE_MODEL_NEIGHBOURS <= CAPSULE_MAX_NEIGHBOURS, "the workspace holds fewer samples than take part");
#ifndef CAPSULE_DIRECT
static_assert(CAPSULE_MODEL_LOCAL_MODES <= CAPSULE_MAX_LOCAL_MODES, "the workspace holds fewer local modes");
#endif

static capsule_model model;
static capsule_workspace workspace;
static float outline[2 * CAPSULE_MODEL_MIDPLANE_POINTS];
static float positions[3 * CAPSULE_MODEL_NODES];
static float scratch[3 * CAPSULE_MODEL_SECTOR_NODES];

/* What the linker has to find room for: here a board with 128 KiB, half of it for other work. */
enum { BYTES = sizeof model + sizeof workspace + sizeof outline + sizeof positions + sizeof scratch };
static_assert(BYTES <= 80 * 1024, "the buffers take more memory than is left");

int main(void) {
  capsule_error error;
  must(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), &error), &error);
  must(capsule_initialise(&workspace, sizeof workspace, &error), &error);
  capsule_description about;
  must(capsule_describe(&model, &about, &error), &error);
  if (about.digest != CAPSULE_MODEL_DIGEST) {
    printf("capsule_model.h is that of model %08lx, and this is model %08lx\n", (unsigned long)CAPSULE_MODEL_DIGEST,
           (unsigned long)about.digest);
    return 1;
  }

  const float parameters[] = {0.10f, 0.90f};
  const capsule_query query = {.parameters = parameters, .parameter_count = CAPSULE_MODEL_PARAMETERS};
  must(capsule_prepare(&model, &workspace, &query, NULL, &error), &error);
  size_t points, nodes;
  must(capsule_outline_at(&model, &workspace, CAPSULE_MODEL_END_TIME, CAPSULE_OUTLINE_MIDPLANE, CAPSULE_FRAME_CENTROID,
                          outline, sizeof outline / sizeof *outline, &points, &error),
       &error);
  must(capsule_positions_at(&model, &workspace, CAPSULE_MODEL_END_TIME, CAPSULE_FRAME_CENTROID, NULL, 0, positions,
                            sizeof positions / sizeof *positions, &nodes, &error),
       &error);
  capsule_membrane membrane;
  must(capsule_membrane_at(&model, &workspace, CAPSULE_MODEL_END_TIME, scratch, sizeof scratch / sizeof *scratch,
                           &membrane, &error),
       &error);
  printf("outline from x = %.9g, last node at x = %.9g, area %.9g (%s)\n", (double)outline[0],
         (double)positions[nodes - 3], (double)membrane.area, CAPSULE_MODEL_LAW);
  /* No buffer is longer than its answer. */
  return points == sizeof outline / sizeof *outline && nodes == sizeof positions / sizeof *positions ? 0 : 1;
}

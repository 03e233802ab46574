/* An instrument that measures the capillary number and the confinement of what passes, frame by frame, and needs the
   shape and the velocity of a capsule with these parameters at once. A frame outside the model is told apart. */
#include "example.h"

enum { FRAMES = 24 };

static capsule_model model;
static capsule_workspace workspace;

/* Readings of the camera and the pump for a frame: here, a flow that increases slowly until the domain ends. */
static void measure(int frame, float parameters[2]) {
  parameters[0] = 0.02f + 0.008f * (float)frame;
  parameters[1] = 0.80f + 0.02f * (float)(frame % 4);
}

int main(void) {
  capsule_error error;
  must(capsule_open(&model, sizeof model, capsule_file, (size_t)(capsule_file_end - capsule_file), &error), &error);
  must(capsule_initialise(&workspace, sizeof workspace, &error), &error);
  int answered = 0;
  for (int frame = 0; frame < FRAMES; frame++) {
    float parameters[2];
    measure(frame, parameters);
    const capsule_query query = {.parameters = parameters, .parameter_count = 2, .method = CAPSULE_METHOD_DIRECT};
    capsule_domain domain;
    capsule_status status = capsule_prepare(&model, &workspace, &query, &domain, &error);
    capsule_observables shape;
    if (status == CAPSULE_STATUS_OK) status = capsule_observables_at(&model, &workspace, 2.0f, &shape, &error);
    printf("frame %2d: Ca %.3f, a/l %.2f: ", frame, (double)parameters[0], (double)parameters[1]);
    if (status == CAPSULE_STATUS_OK) {
      printf("length %.9g, velocity %.9g\n", (double)shape.axial_length, (double)shape.velocity);
      answered++;
    } else {
      explain(&error);
    }
  }
  printf("%d of %d frames answered\n", answered, FRAMES);
  return answered > 0 ? 0 : 1;
}

/* Two models at once. Each may have a workspace of its own; they may also share one, where memory is scarce: then a
   query is prepared again after the other model was asked, and an instant of the other model's query is refused. */
#include "example.h"

static capsule_model models[2];
static capsule_workspace workspaces[2];

static const float parameters[] = {0.05f, 0.85f};
static const capsule_query query = {.parameters = parameters, .parameter_count = 2, .method = CAPSULE_METHOD_DIRECT};

static float length(const capsule_model *model, capsule_workspace *workspace) {
  capsule_error error;
  capsule_observables shape;
  must(capsule_prepare(model, workspace, &query, NULL, &error), &error);
  must(capsule_observables_at(model, workspace, 1.0f, &shape, &error), &error);
  return shape.axial_length;
}

int main(void) {
  capsule_error error;
  const size_t sizes[] = {(size_t)(capsule_file_end - capsule_file), (size_t)(second_file_end - second_file)};
  must(capsule_open(&models[0], sizeof models[0], capsule_file, sizes[0], &error), &error);
  must(capsule_open(&models[1], sizeof models[1], second_file, sizes[1], &error), &error);
  float apart[2], shared[2];
  for (int i = 0; i < 2; i++) {
    must(capsule_initialise(&workspaces[i], sizeof workspaces[i], &error), &error);
    apart[i] = length(&models[i], &workspaces[i]);
    printf("model %d: length %.9g\n", i, (double)apart[i]);
  }
  for (int i = 0; i < 2; i++) shared[i] = length(&models[i], &workspaces[0]);
  printf("with one workspace: %s\n", apart[0] == shared[0] && apart[1] == shared[1] ? "the same" : "different");

  capsule_description about[2];
  must(capsule_describe(&models[0], &about[0], &error), &error);
  must(capsule_describe(&models[1], &about[1], &error), &error);
  float centroid;
  if (about[0].digest != about[1].digest &&
      capsule_centroid_at(&models[0], &workspaces[0], 1.0f, &centroid, &error) != CAPSULE_STATUS_OK)
    explain(&error);
  return apart[0] == shared[0] && apart[1] == shared[1] ? 0 : 1;
}

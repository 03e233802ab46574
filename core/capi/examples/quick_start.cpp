// From a model in read-only memory to the shape of a capsule, in C++17.
#include <capsule.hpp>
#include <cstdio>

extern "C" const unsigned char capsule_file[], capsule_file_end[];

int main() {
  const capsule::Model model(capsule_file, static_cast<std::size_t>(capsule_file_end - capsule_file));
  static capsule::Workspace workspace;
  capsule::Evaluator evaluator(model, workspace);

  // For each capsule: capillary number and confinement.
  evaluator.prepare({0.10f, 0.90f});

  // For each instant: only the quantities that are used.
  const capsule_observables shape = evaluator.observables(3.0f);
  std::printf("length %.9g, half width %.9g, rear depth %.9g, velocity %.9g\n", double(shape.axial_length),
              double(shape.half_width), double(shape.rear_depth), double(shape.velocity));
  if (const auto bound = evaluator.error_bound(3.0f)) std::printf("error below %.9g of the radius\n", double(*bound));

  // A failure is thrown, with its figures.
  try {
    evaluator.prepare({0.15f, 1.10f});
  } catch (const capsule::Error &error) {
    std::printf("%s: found %g, greatest %g\n", error.what(), error.failure().found, error.failure().greatest);
  }
  return 0;
}

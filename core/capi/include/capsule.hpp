/* capsule-rom for C++17: the C interface with C++'s types. It adds no code of its own: no heap, no global state.

     capsule::Model model(bytes, length);
     capsule::Workspace workspace;
     capsule::Evaluator evaluator(model, workspace);
     evaluator.prepare({0.10f, 0.90f});
     float length = evaluator.observables(3.0f).axial_length;

   A call that fails throws capsule::Error. Without exceptions (-fno-exceptions) it calls CAPSULE_FAIL(error), which a
   program may define before it includes this and which must not return; std::abort() is the default. */
#ifndef CAPSULE_HPP
#define CAPSULE_HPP

#include "capsule.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <optional>
#include <string_view>

namespace capsule {

/* A failed call, with its figures (`failure()`). */
class Error : public std::exception {
 public:
  explicit Error(const capsule_error &failure) noexcept : failure_(failure) {}
  const char *what() const noexcept override { return capsule_status_text(failure_.status); }
  const capsule_error &failure() const noexcept { return failure_; }
  capsule_status status() const noexcept { return failure_.status; }

 private:
  capsule_error failure_;
};

#if defined(__cpp_exceptions) && !defined(CAPSULE_FAIL)
#define CAPSULE_FAIL(error) throw ::capsule::Error(error)
#elif !defined(CAPSULE_FAIL)
#define CAPSULE_FAIL(error) (static_cast<void>(error), std::abort())
#endif

namespace detail {
inline void check(capsule_status status, const capsule_error &error) {
  if (status != CAPSULE_STATUS_OK) CAPSULE_FAIL(error);
}
}  // namespace detail

/* An opened model. The file's bytes stay where they are, unchanged, as long as the model is used. */
class Model {
 public:
  Model(const void *file, std::size_t length) {
    capsule_error error;
    detail::check(capsule_open(&model_, sizeof model_, file, length, &error), error);
  }

  capsule_description description() const {
    capsule_description description;
    capsule_error error;
    detail::check(capsule_describe(&model_, &description, &error), error);
    return description;
  }

  capsule_parameter parameter(std::size_t index) const {
    capsule_parameter parameter;
    capsule_error error;
    detail::check(capsule_describe_parameter(&model_, index, &parameter, &error), error);
    return parameter;
  }

  const capsule_model *get() const noexcept { return &model_; }

 private:
  capsule_model model_;
};

/* Storage for one query at a time. It is large (CAPSULE_WORKSPACE_SIZE bytes): a static object on a microcontroller. */
class Workspace {
 public:
  Workspace() {
    capsule_error error;
    detail::check(capsule_initialise(&workspace_, sizeof workspace_, &error), error);
  }

  capsule_workspace *get() noexcept { return &workspace_; }

 private:
  capsule_workspace workspace_;
};

/* Options of a query; the defaults are those of the C interface. */
struct Options {
  capsule_method method = CAPSULE_METHOD_DEFAULT;
  bool extrapolate = false;
  float step = 0.0f;
};

/* Answers queries with a model and a workspace, both of which outlive it. Lengths are in l, velocities in V, t in
   l/V. */
class Evaluator {
 public:
  Evaluator(const Model &model, Workspace &workspace) noexcept : model_(model.get()), workspace_(workspace.get()) {}

  /* Prepares a query; its parameters are in the model's order (Ca, a/l). */
  capsule_domain prepare(std::initializer_list<float> parameters, const Options &options = {}) {
    return prepare(parameters.begin(), parameters.size(), options);
  }

  capsule_domain prepare(const float *parameters, std::size_t count, const Options &options = {}) {
    const capsule_query query = {parameters, count, options.method, options.extrapolate ? 1u : 0u, options.step};
    capsule_domain domain;
    capsule_error error;
    detail::check(capsule_prepare(model_, workspace_, &query, &domain, &error), error);
    return domain;
  }

  /* Does at most `pieces` pieces of the work at an instant; true when nothing is left. */
  bool advance(float t, std::size_t pieces) {
    std::uint32_t done;
    capsule_error error;
    detail::check(capsule_advance(model_, workspace_, t, pieces, &done, &error), error);
    return done != 0;
  }

  capsule_observables observables(float t) {
    capsule_observables observables;
    capsule_error error;
    detail::check(capsule_observables_at(model_, workspace_, t, &observables, &error), error);
    return observables;
  }

  float expected_error(float t) { return number(capsule_expected_error_at, t); }
  float centroid(float t) { return number(capsule_centroid_at, t); }
  float volume(float t) { return number(capsule_volume_at, t); }

  /* The bound that 95 of 100 errors are below; none outside the sampled domain. */
  std::optional<float> error_bound(float t) {
    float bound;
    capsule_error error;
    const capsule_status status = capsule_error_bound_at(model_, workspace_, t, &bound, &error);
    if (status == CAPSULE_STATUS_NO_BOUND) return std::nullopt;
    detail::check(status, error);
    return bound;
  }

  /* Points x, r, x, r, ... of an outline into `points` of `capacity` numbers; returns how many numbers were written. */
  std::size_t outline(float t, capsule_outline outline, capsule_frame frame, float *points, std::size_t capacity) {
    std::size_t count;
    capsule_error error;
    detail::check(capsule_outline_at(model_, workspace_, t, outline, frame, points, capacity, &count, &error), error);
    return count;
  }

  /* Positions x, y, z, ... of all nodes; returns how many numbers were written. */
  std::size_t positions(float t, capsule_frame frame, float *positions, std::size_t capacity) {
    return this->positions(t, frame, nullptr, 0, positions, capacity);
  }

  /* Positions of `node_count` nodes of a list. */
  std::size_t positions(float t, capsule_frame frame, const std::uint16_t *nodes, std::size_t node_count,
                        float *positions, std::size_t capacity) {
    std::size_t count;
    capsule_error error;
    detail::check(capsule_positions_at(model_, workspace_, t, frame, nodes, node_count, positions, capacity, &count,
                                       &error),
                  error);
    return count;
  }

  /* Velocities of all nodes, like the positions. */
  std::size_t velocities(float t, capsule_frame frame, float *velocities, std::size_t capacity) {
    return this->velocities(t, frame, nullptr, 0, velocities, capacity);
  }

  std::size_t velocities(float t, capsule_frame frame, const std::uint16_t *nodes, std::size_t node_count,
                         float *velocities, std::size_t capacity) {
    std::size_t count;
    capsule_error error;
    detail::check(capsule_velocities_at(model_, workspace_, t, frame, nodes, node_count, velocities, capacity, &count,
                                        &error),
                  error);
    return count;
  }

  /* Totals of the membrane; `scratch` holds three numbers for each of the model's sector nodes. */
  capsule_membrane membrane(float t, float *scratch, std::size_t capacity) {
    capsule_membrane membrane;
    capsule_error error;
    detail::check(capsule_membrane_at(model_, workspace_, t, scratch, capacity, &membrane, &error), error);
    return membrane;
  }

 private:
  template <typename Call>
  float number(Call call, float t) {
    float number;
    capsule_error error;
    detail::check(call(model_, workspace_, t, &number, &error), error);
    return number;
  }

  const capsule_model *model_;
  capsule_workspace *workspace_;
};

/* The constitutive law of the full-order model that errors are measured against. */
inline std::string_view law(const capsule_description &description) {
  return std::string_view(description.law, description.law_length);
}

}  // namespace capsule

#endif  /* CAPSULE_HPP */

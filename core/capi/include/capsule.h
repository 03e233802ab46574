/* capsule-rom: from capillary number and confinement to the motion of a microcapsule in a square channel.

   No heap, no global state. Lengths are in l (half the channel's side), velocities in V (mean velocity of the
   undisturbed flow), time in l/V. Single precision.

     capsule_open        a model file in memory -> capsule_model
     capsule_initialise  memory -> capsule_workspace
     capsule_prepare     parameters -> the workspace is ready for any instant
     capsule_..._at      what is asked at an instant; it computes that and nothing else

   Every function returns a status; capsule_status_text() says it in words. The last parameter, `error`, may be null;
   else every call fills it, with the figures of the failure or with zeros. Pointers may not be null unless it is said;
   null, misaligned, short and overlapping ones are refused. Where `error` itself is misaligned, or shares memory with
   another argument or with the model's file, the call is refused and `error` is left as it was.

   Where a call fails, nothing else is written, but for the `domain` of capsule_prepare, the `scratch` of
   capsule_membrane_at and a model that did not open. A buffer is written as far as the answer goes, and not beyond.

   libcapsule_direct.a is without the paper's method, in half the workspace and four fifths of the code. A program that
   links it defines CAPSULE_DIRECT before it includes this.

   A model file's bytes stay where they are, unchanged, as long as its model is used. Calls that share a model only may
   run at the same time; calls that share a workspace may not. */

#ifndef CAPSULE_H
#define CAPSULE_H

/* Generated from the Rust sources by `cargo xtask header`. Do not edit. */

#include <stddef.h>
#include <stdint.h>

// Version of the library.
#define CAPSULE_VERSION "0.1.0"
#define CAPSULE_VERSION_MAJOR 0
#define CAPSULE_VERSION_MINOR 1
#define CAPSULE_VERSION_PATCH 0

// The most modes of a field that a workspace holds, the translation included.
#define CAPSULE_MAX_MODES 129

#if !defined(CAPSULE_DIRECT)
// The most local modes of a field that a workspace holds.
#define CAPSULE_MAX_LOCAL_MODES 16
#endif

#if defined(CAPSULE_DIRECT)
// None, as the library is without the paper's method.
#define CAPSULE_MAX_LOCAL_MODES 0
#endif

// The most samples that take part in a query.
#define CAPSULE_MAX_NEIGHBOURS 32

#if !defined(CAPSULE_DIRECT)
// Words of eight bytes in a workspace.
#define CAPSULE_WORKSPACE_WORDS 3410
#endif

#if defined(CAPSULE_DIRECT)
// Words of eight bytes in a workspace.
#define CAPSULE_WORKSPACE_WORDS 1578
#endif

// Bytes of a workspace.
#define CAPSULE_WORKSPACE_SIZE (CAPSULE_WORKSPACE_WORDS * 8)

// Alignment of a workspace.
#define CAPSULE_WORKSPACE_ALIGNMENT 8

// Words of eight bytes in a model.
#define CAPSULE_MODEL_WORDS 828

// Bytes of a model.
#define CAPSULE_MODEL_SIZE (CAPSULE_MODEL_WORDS * 8)

// Alignment of a model.
#define CAPSULE_MODEL_ALIGNMENT 8

// Outcome of a call.
enum capsule_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  CAPSULE_STATUS_OK = 0,
  // A pointer is null.
  CAPSULE_STATUS_NULL = 1,
  // A pointer is not aligned for what it points to.
  CAPSULE_STATUS_MISALIGNED = 2,
  // A buffer is too short: `found` entries or bytes, `least` are needed.
  CAPSULE_STATUS_SHORT = 3,
  // Two of the pointers point to the same memory, one to write to points into the model's file, or a buffer goes
  // beyond the end of memory.
  CAPSULE_STATUS_OVERLAP = 4,
  // The model was not opened.
  CAPSULE_STATUS_NO_MODEL = 5,
  // The workspace was not initialised.
  CAPSULE_STATUS_NO_WORKSPACE = 6,
  // A method, frame, outline or index that does not exist: `found`, it must be at most `greatest`.
  CAPSULE_STATUS_CHOICE = 7,
  // The number of parameters is not the model's: `found`, `least` are needed.
  CAPSULE_STATUS_PARAMETER_COUNT = 8,
  // The file is truncated: `found` bytes, `least` are needed.
  CAPSULE_STATUS_TRUNCATED = 20,
  // The file is no model: it does not start with "CROM".
  CAPSULE_STATUS_MAGIC = 21,
  // The file has the format `found`; this library knows `greatest`.
  CAPSULE_STATUS_VERSION = 22,
  // The file is damaged: its CRC-32 is `found`, `least` was written.
  CAPSULE_STATUS_CHECKSUM = 23,
  // The file does not decode as its format says.
  CAPSULE_STATUS_UNDECODABLE = 24,
  // `found` bytes follow the end of the model.
  CAPSULE_STATUS_TRAILING_BYTES = 25,
  // The file contradicts itself in `what`: `found`.
  CAPSULE_STATUS_INCONSISTENT = 26,
  // The model has `found` of `what`; the workspace holds `greatest`.
  CAPSULE_STATUS_CAPACITY = 40,
  // `what` is `found`; it must be between `least` and `greatest`.
  CAPSULE_STATUS_VALUE = 41,
  // The parameters lie outside the sampled domain: `what` is `found`.
  CAPSULE_STATUS_OUTSIDE_DOMAIN = 42,
  // No steady state exists at the parameters: `found` is beyond the limit `greatest`.
  CAPSULE_STATUS_BEYOND_STEADY_LIMIT = 43,
  // The samples near the query are too close to each other: their weights sum to `found` instead of 1.
  CAPSULE_STATUS_WEIGHTS = 44,
  // No query was prepared with this model in this workspace.
  CAPSULE_STATUS_NOT_PREPARED = 45,
  // Node `found` does not exist: the model has `greatest` nodes.
  CAPSULE_STATUS_UNKNOWN_NODE = 46,
  // The result is not finite: the parameters are too far from all samples.
  CAPSULE_STATUS_NOT_FINITE = 47,
  // The mechanics of the membrane is not that of the model: it needs the neo-Hookean law and a stress-free sphere.
  CAPSULE_STATUS_UNSUPPORTED_REFERENCE = 48,
  // The model has no such outline.
  CAPSULE_STATUS_NO_OUTLINE = 49,
  // The answer is extrapolated: no bound of its error is known.
  CAPSULE_STATUS_NO_BOUND = 50,
  // No capsule has the extrapolated shape: `what` is `found`, it must be between `least` and `greatest`.
  CAPSULE_STATUS_IMPOSSIBLE_SHAPE = 51,
  // An error that this version of the interface has no name for.
  CAPSULE_STATUS_OTHER = 99,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum capsule_status capsule_status;
#else
typedef uint32_t capsule_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Method that answers a query.
enum capsule_method
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // As the model's author chose.
  CAPSULE_METHOD_DEFAULT = 0,
  // Interpolated coefficients evaluated at the instant: fast.
  CAPSULE_METHOD_DIRECT = 1,
  // The published algorithm: a local basis, a learned manifold, steps in time.
  CAPSULE_METHOD_PAPER = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum capsule_method capsule_method;
#else
typedef uint32_t capsule_method;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Where parameters lie.
enum capsule_domain
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Within the sampled ranges and below the steady limit.
  CAPSULE_DOMAIN_INSIDE = 0,
  // Within the sampled ranges, where no steady state exists.
  CAPSULE_DOMAIN_BEYOND_STEADY_LIMIT = 1,
  // Outside the sampled ranges.
  CAPSULE_DOMAIN_OUTSIDE = 2,
  // Within the ranges of scattered samples, but far from all of them.
  CAPSULE_DOMAIN_FAR_FROM_SAMPLES = 3,
  // Not found, as the call failed before it looked.
  CAPSULE_DOMAIN_UNKNOWN = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum capsule_domain capsule_domain;
#else
typedef uint32_t capsule_domain;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Frame of reference.
enum capsule_frame
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // At rest with the duct; the capsule starts at x = 0.
  CAPSULE_FRAME_LABORATORY = 0,
  // Moving with the capsule's centroid.
  CAPSULE_FRAME_CENTROID = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum capsule_frame capsule_frame;
#else
typedef uint32_t capsule_frame;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A section of the capsule.
enum capsule_outline
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // z = 0, y >= 0: parallel to two walls.
  CAPSULE_OUTLINE_MIDPLANE = 0,
  // y = z >= 0: through two corners.
  CAPSULE_OUTLINE_DIAGONAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum capsule_outline capsule_outline;
#else
typedef uint32_t capsule_outline;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// An opened model. The file's bytes stay where they are.
typedef struct capsule_model {
  // For the library.
  uint64_t opaque[CAPSULE_MODEL_WORDS];
} capsule_model;

// The cause of a failure, with its figures. A field that the status does not mention is zero.
typedef struct capsule_error {
  // The status that the call returned.
  capsule_status status;
  // Name of what was wrong: `what_length` characters without a terminating zero, in the library or in the model's
  // file, or null.
  const char *what;
  // Length of `what`.
  size_t what_length;
  // The figure that was found.
  double found;
  // The least that would be right.
  double least;
  // The greatest that would be right.
  double greatest;
} capsule_error;

// Description of a model.
typedef struct capsule_description {
  // CRC-32 of the file's content: identifies the model.
  uint32_t digest;
  // Number of parameters.
  size_t parameter_count;
  // Nodes of the surface.
  size_t nodes;
  // Nodes that are stored; symmetry gives the others.
  size_t sector_nodes;
  // Points of the outline `CAPSULE_OUTLINE_MIDPLANE`.
  size_t midplane_points;
  // Points of the outline `CAPSULE_OUTLINE_DIAGONAL`.
  size_t diagonal_points;
  // The last instant that can be asked for, in l/V; the first is 0.
  float end_time;
  // The method that `CAPSULE_METHOD_DEFAULT` stands for.
  capsule_method method;
  // Constitutive law of the membrane in the full-order model that errors are measured against: `law_length`
  // characters without a terminating zero, in the file's bytes.
  const char *law;
  // Length of `law`.
  size_t law_length;
  // Bending stiffness of that model, in G_s a^2; negative where it is not known.
  float bending_stiffness;
} capsule_description;

// A parameter and the range in which it was sampled.
typedef struct capsule_parameter {
  // Name: `name_length` characters without a terminating zero, in the file's bytes.
  const char *name;
  // Length of `name`.
  size_t name_length;
  // Least sampled value.
  double least;
  // Greatest sampled value.
  double greatest;
} capsule_parameter;

// Storage for one query at a time.
typedef struct capsule_workspace {
  // For the library.
  uint64_t opaque[CAPSULE_WORKSPACE_WORDS];
} capsule_workspace;

// A query. Zeros stand for the defaults.
typedef struct capsule_query {
  // The parameters, in the model's order: for a capsule in the channel Ca, then a/l.
  const float *parameters;
  // Number of parameters.
  size_t parameter_count;
  // A `capsule_method`.
  uint32_t method;
  // Not zero: answer outside the sampled domain too.
  uint32_t extrapolate;
  // Step of the paper's method; 0 for a thousandth of the end time.
  float step;
} capsule_query;

// Scalars of an instant: lengths in l, velocity in V.
typedef struct capsule_observables {
  // Extent along the channel.
  float axial_length;
  // Greatest distance from the axis towards a wall.
  float half_width;
  // Greatest distance from the axis towards a corner.
  float half_diagonal;
  // Depth of the cavity at the rear.
  float rear_depth;
  // Velocity of the centroid.
  float velocity;
  // Position of the centroid in the laboratory frame.
  float centroid;
} capsule_observables;

// Totals of the membrane.
typedef struct capsule_membrane {
  // Area, in l^2.
  float area;
  // Elastic energy, in G_s l^2.
  float energy;
  // Additional pressure drop that the capsule causes, in mu V/l.
  float pressure_drop;
} capsule_membrane;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of this library, such as "0.1.0": a program compares it with the `CAPSULE_VERSION` that it was compiled
// with.
const char *capsule_v1_version(void);

// The meaning of a status, as a sentence that ends with a zero.
const char *capsule_v1_status_text(uint32_t status);

// Opens the model file of `length` bytes: checks it, and fills `model`, of which `size` is `sizeof *model`. Nothing is
// copied: the bytes are read where they lie, fastest if that is at a multiple of 16.
capsule_status capsule_v1_open(struct capsule_model *model,
                               size_t size,
                               const void *file,
                               size_t length,
                               struct capsule_error *error);

// Describes a model.
capsule_status capsule_v1_describe(const struct capsule_model *model,
                                   struct capsule_description *description,
                                   struct capsule_error *error);

// Name and range of parameter number `index`.
capsule_status capsule_v1_describe_parameter(const struct capsule_model *model,
                                             size_t index,
                                             struct capsule_parameter *parameter,
                                             struct capsule_error *error);

// Makes an empty workspace of memory, of which `size` is `sizeof *workspace`.
capsule_status capsule_v1_initialise(struct capsule_workspace *workspace, size_t size, struct capsule_error *error);

// Prepares a query; nothing is done if it is the one already prepared. `domain` may be null, else it says where the
// parameters lie, also where they are refused, and `CAPSULE_DOMAIN_UNKNOWN` where the call fails before it looks.
// Where a pointer is refused, it is left as it was.
capsule_status capsule_v1_prepare(const struct capsule_model *model,
                                  struct capsule_workspace *workspace,
                                  const struct capsule_query *query,
                                  capsule_domain *domain,
                                  struct capsule_error *error);

// Does at most `pieces` pieces of the work that everything at the instant `t` waits for, and sets `done` to 1 when
// nothing is left, else to 0: for callers who must not be kept long. A piece is a snapshot, a row or a mode of a local
// basis, or a step in time, of the paper's method; the direct method has no such work. What is asked at an instant
// does what is left of it.
capsule_status capsule_v1_advance(const struct capsule_model *model,
                                  struct capsule_workspace *workspace,
                                  float t,
                                  size_t pieces,
                                  uint32_t *done,
                                  struct capsule_error *error);

// Lengths and velocity at the instant `t`, in l/V, of the prepared query.
capsule_status capsule_v1_observables_at(const struct capsule_model *model,
                                         struct capsule_workspace *workspace,
                                         float t,
                                         struct capsule_observables *observables,
                                         struct capsule_error *error);

// Expected modified Hausdorff distance at the instant `t` to the full-order model (with the law and the bending
// stiffness of the description), laboratory frame, as a fraction of the radius a; to other people's data the mean
// distance of the nodes. Outside the sampled domain it is a guess.
capsule_status capsule_v1_expected_error_at(const struct capsule_model *model,
                                            struct capsule_workspace *workspace,
                                            float t,
                                            float *expected_error,
                                            struct capsule_error *error);

// The bound that 95 of 100 errors are below at the instant `t`, like the expected error. Outside the sampled domain,
// where `capsule_v1_prepare` says another domain than `CAPSULE_DOMAIN_INSIDE`, none is known:
// `CAPSULE_STATUS_NO_BOUND`.
capsule_status capsule_v1_error_bound_at(const struct capsule_model *model,
                                         struct capsule_workspace *workspace,
                                         float t,
                                         float *error_bound,
                                         struct capsule_error *error);

// Position of the centroid at the instant `t`, laboratory frame, in l.
capsule_status capsule_v1_centroid_at(const struct capsule_model *model,
                                      struct capsule_workspace *workspace,
                                      float t,
                                      float *centroid,
                                      struct capsule_error *error);

// Enclosed volume at the instant `t`, in l^3.
capsule_status capsule_v1_volume_at(const struct capsule_model *model,
                                    struct capsule_workspace *workspace,
                                    float t,
                                    float *volume,
                                    struct capsule_error *error);

// An outline (a `capsule_outline`) at the instant `t` in a frame (a `capsule_frame`): points x, r, x, r, ... in l,
// from the front pole to the rear pole. `points` has room for `capacity` numbers; `count` is set to how many were
// written.
capsule_status capsule_v1_outline_at(const struct capsule_model *model,
                                     struct capsule_workspace *workspace,
                                     float t,
                                     uint32_t outline,
                                     uint32_t frame,
                                     float *points,
                                     size_t capacity,
                                     size_t *count,
                                     struct capsule_error *error);

// Positions of nodes at the instant `t` in a frame (a `capsule_frame`): x, y, z, x, y, z, ... in l. `nodes` lists
// `node_count` of them; null asks for all. `positions` has room for `capacity` numbers; `count` is set to how many
// were written.
capsule_status capsule_v1_positions_at(const struct capsule_model *model,
                                       struct capsule_workspace *workspace,
                                       float t,
                                       uint32_t frame,
                                       const uint16_t *nodes,
                                       size_t node_count,
                                       float *positions,
                                       size_t capacity,
                                       size_t *count,
                                       struct capsule_error *error);

// Velocities of nodes at the instant `t`, in V; otherwise as the positions.
capsule_status capsule_v1_velocities_at(const struct capsule_model *model,
                                        struct capsule_workspace *workspace,
                                        float t,
                                        uint32_t frame,
                                        const uint16_t *nodes,
                                        size_t node_count,
                                        float *velocities,
                                        size_t capacity,
                                        size_t *count,
                                        struct capsule_error *error);

// Totals of the membrane at the instant `t`. `scratch` has room for `capacity` numbers, three for each of the model's
// sector nodes.
capsule_status capsule_v1_membrane_at(const struct capsule_model *model,
                                      struct capsule_workspace *workspace,
                                      float t,
                                      float *scratch,
                                      size_t capacity,
                                      struct capsule_membrane *membrane,
                                      struct capsule_error *error);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

/* Plain names of the functions of this version. */
#define capsule_version capsule_v1_version
#define capsule_status_text capsule_v1_status_text
#define capsule_open capsule_v1_open
#define capsule_describe capsule_v1_describe
#define capsule_describe_parameter capsule_v1_describe_parameter
#define capsule_initialise capsule_v1_initialise
#define capsule_prepare capsule_v1_prepare
#define capsule_advance capsule_v1_advance
#define capsule_observables_at capsule_v1_observables_at
#define capsule_expected_error_at capsule_v1_expected_error_at
#define capsule_error_bound_at capsule_v1_error_bound_at
#define capsule_centroid_at capsule_v1_centroid_at
#define capsule_volume_at capsule_v1_volume_at
#define capsule_outline_at capsule_v1_outline_at
#define capsule_positions_at capsule_v1_positions_at
#define capsule_velocities_at capsule_v1_velocities_at
#define capsule_membrane_at capsule_v1_membrane_at

#endif  /* CAPSULE_H */

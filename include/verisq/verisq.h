/// The library from C, and from whatever language can call C: models, maps of points, single distances, pairs.
///
/// A function that can fail returns VERISQ_OK or what was wrong, and never lets an exception out. `error` may be NULL;
/// else it receives the line that a user can act on. Results are written where VERISQ_OK is returned, and only there.
/// Pointers to handles, results and text are not NULL unless said. docs/library.md §4 shows a program.
#ifndef VERISQ_VERISQ_H
#define VERISQ_VERISQ_H

// C has neither `using` nor the other headers. NOLINTBEGIN(modernize-deprecated-headers,modernize-use-using)
#include <stddef.h>
#include <stdint.h>

#include <verisq/version.hpp>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum verisq_code {
  VERISQ_OK = 0,
  VERISQ_FAILURE = 1, /**< the library, a device, memory or the file system failed */
  VERISQ_INPUT = 2    /**< a file or a value that the caller can correct */
} verisq_code;

/** What was wrong, as one line that ends with a 0; what does not fit is cut off. After VERISQ_OK it is empty. */
typedef struct verisq_error {
  verisq_code code;
  char message[1024];
} verisq_error;

/** lo <= exact value <= hi; either may be infinite. */
typedef struct verisq_enclosure {
  double lo;
  double hi;
} verisq_enclosure;

/** The version of the library that runs; VERISQ_VERSION is that of the header. */
const char* verisq_version(void);

/* Models. ---------------------------------------------------------------------------------------------------------- */

/** A model without intervals, immutable: any number of threads may ask it. */
typedef struct verisq_model verisq_model;

/** From a file of the format verisq-model/1 (docs/formats.md §2). `*model` is freed by verisq_model_free. */
verisq_code verisq_model_read(const char* path, verisq_model** model, verisq_error* error);
/** From `length` bytes of JSON; `name` stands for the file in messages. */
verisq_code verisq_model_parse(const char* json, size_t length, const char* name, verisq_model** model,
                               verisq_error* error);
/** NULL is nothing to free. A mapper does not need its model any more. */
void verisq_model_free(verisq_model* model);

/** Radius of a sphere that contains the model, rounded up. The programs' default tolerance is 1e-6 times this. */
double verisq_model_bounding_radius(const verisq_model* model);

/* Single distances, proven by the host. ---------------------------------------------------------------------------- */

/** The signed distance of a point to the model, negative inside, to a width of `tolerance` where the method reaches it
 *  (0: as tight as it gets). VERISQ_INPUT for a point that is not finite, a tolerance below 0 or NaN. */
verisq_code verisq_point_distance(const verisq_model* model, const double point[3], double tolerance,
                                  verisq_enclosure* distance, verisq_error* error);

typedef enum verisq_proximity {
  VERISQ_SEPARATED = 0,   /**< proven disjoint: lo > 0 */
  VERISQ_OVERLAPPING = 1, /**< proven to have a common point */
  VERISQ_UNDECIDED = 2    /**< neither: lo = 0 */
} verisq_proximity;

/** x -> R x + t. The quaternion (w, x, y, z) need not have length 1, but must not be 0. */
typedef struct verisq_pose {
  double translation[3];
  double quaternion[4];
} verisq_pose;

/** The distance of A and of B moved by `pose_of_b` (NULL: not at all) after its primitives' own poses; 0 where they
 *  meet. Unions of convex primitives are enclosed as tightly as the method gives, others until `tolerance` is reached.
 *  VERISQ_INPUT for a pose that is none, a tolerance below 0 or NaN, and a model that is proven to have no point. */
verisq_code verisq_model_distance(const verisq_model* a, const verisq_model* b, const verisq_pose* pose_of_b,
                                  double tolerance, verisq_enclosure* distance, verisq_proximity* proximity,
                                  verisq_error* error);

/* Maps of points, proven by an OpenCL device and the host. --------------------------------------------------------- */

/** A model made ready for maps: device tested, kernels compiled. One map at a time. */
typedef struct verisq_mapper verisq_mapper;

typedef struct verisq_map_options {
  double tolerance;    /**< rows at most as wide are verified; 0 asks for the tightest */
  double point_radius; /**< each point is any within this of the one given */
  const char* device;  /**< "auto" (also NULL), "host", an index or a part of a device's name */
  /** Polled between chunks unless NULL, with `context`; what is not 0 ends the map early. */
  int (*interrupted)(void* context);
  void* context;
} verisq_map_options;

/** `options` may be NULL: a tolerance of 1e-6 times the bounding radius, on what "auto" finds. `*mapper` is freed by
 *  verisq_mapper_free. VERISQ_INPUT for options that are none, or where no device matches. */
verisq_code verisq_mapper_create(const verisq_model* model, const verisq_map_options* options, verisq_mapper** mapper,
                                 verisq_error* error);
void verisq_mapper_free(verisq_mapper* mapper);

typedef enum verisq_status {
  VERISQ_DEVICE_VERIFIED = 0, /**< at most the tolerance wide, proven by the device */
  VERISQ_HOST_VERIFIED = 1,   /**< the same, proven by the host */
  VERISQ_WIDE = 2             /**< valid, but wider */
} verisq_status;

/** Coordinate k of point i is first[k][i * stride[k]]. A stride counts numbers, not bytes, and may be negative or 0.
 *  Points as they are, x y z x y z …: first = {p, p + 1, p + 2}, stride = {3, 3, 3}. */
typedef struct verisq_points {
  size_t count;
  const double* first[3];
  ptrdiff_t stride[3];
} verisq_points;

/** Row i: lo[i * stride_lo], hi[i * stride_hi], a verisq_status in status[i * stride_status]. They share memory neither
 *  with each other nor with points. */
typedef struct verisq_rows {
  double* lo;
  double* hi;
  uint8_t* status;
  ptrdiff_t stride_lo;
  ptrdiff_t stride_hi;
  ptrdiff_t stride_status;
} verisq_rows;

typedef struct verisq_map_summary {
  uint64_t points; /**< rows written; fewer than asked for where interrupted */
  uint64_t device_verified;
  uint64_t host_verified;
  uint64_t wide;
  verisq_enclosure minimum; /**< encloses the smallest distance of all rows; of no row [inf, inf] */
  double largest_width;
  int interrupted;
} verisq_map_summary;

/** Encloses the signed distance of each point. `summary` may be NULL. Where it fails, what the rows hold is not
 *  specified. VERISQ_INPUT for a point that is not finite, and for columns that are NULL or share memory. */
verisq_code verisq_map_points(verisq_mapper* mapper, const verisq_points* points, const verisq_rows* rows,
                              verisq_map_summary* summary, verisq_error* error);

#ifdef __cplusplus
}
#endif
// NOLINTEND(modernize-deprecated-headers,modernize-use-using)

#endif

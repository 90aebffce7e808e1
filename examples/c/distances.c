/// Distances from C: a map of three points, one point by the host alone, and two models. Run where examples/ is:
/// cc -std=c11 examples/c/distances.c $(pkg-config --cflags --libs verisq-core) -o distances && ./distances
#include <stdio.h>
#include <verisq/verisq.h>

enum { count = 3 };

static const double points[count][3] = {{10.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 20.0, 5.0}};

static int map_points(const verisq_model* soap, verisq_error* error) {
  const verisq_map_options options = {.tolerance = 1e-9, .device = "host"};
  verisq_mapper* mapper = NULL;
  if (verisq_mapper_create(soap, &options, &mapper, error) != VERISQ_OK) return 0;
  double lo[count];
  double hi[count];
  uint8_t status[count];
  const double* const first = points[0];
  const verisq_points columns = {count, {first, first + 1, first + 2}, {3, 3, 3}};
  const verisq_rows rows = {lo, hi, status, 1, 1, 1};
  verisq_map_summary summary;
  const verisq_code code = verisq_map_points(mapper, &columns, &rows, &summary, error);
  verisq_mapper_free(mapper);
  if (code != VERISQ_OK) return 0;
  for (int i = 0; i < count; ++i) printf("point %d: [%.9g, %.9g]\n", i, lo[i], hi[i]);
  printf("%d of %d rows are wide\n", (int)summary.wide, count);
  return 1;
}

static int single_distances(const verisq_model* soap, const verisq_model* capsule, verisq_error* error) {
  verisq_enclosure point;
  if (verisq_point_distance(soap, points[0], 1e-12, &point, error) != VERISQ_OK) return 0;
  printf("the first alone: [%.9g, %.9g]\n", point.lo, point.hi);
  const verisq_pose aside = {{200.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  verisq_enclosure pair;
  verisq_proximity proximity;
  if (verisq_model_distance(capsule, soap, &aside, 1e-9, &pair, &proximity, error) != VERISQ_OK) return 0;
  printf("two models, %s: [%.9g, %.9g]\n", proximity == VERISQ_SEPARATED ? "separated" : "not proven separated",
         pair.lo, pair.hi);
  return 1;
}

int main(void) {
  verisq_error error = {VERISQ_OK, ""};
  verisq_model* soap = NULL;
  verisq_model* capsule = NULL;
  const int done = verisq_model_read("examples/soap.json", &soap, &error) == VERISQ_OK &&
                   verisq_model_read("examples/capsule.json", &capsule, &error) == VERISQ_OK &&
                   map_points(soap, &error) && single_distances(soap, capsule, &error);
  if (!done) fprintf(stderr, "distances: %s\n", error.message);
  verisq_model_free(capsule);
  verisq_model_free(soap);
  return done ? 0 : 1;
}

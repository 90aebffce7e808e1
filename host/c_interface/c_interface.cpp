/// The C interface: each function calls its counterpart of the C++ library, and turns exceptions into a code and a
/// line.
#include <verisq/verisq.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/model.hpp>

#include "host/errors/refusal.hpp"

struct verisq_model {
  explicit verisq_model(verisq::Model read) : model(std::move(read)), distance(model) {}

  verisq::Model model;
  verisq::SignedDistance distance;
};

struct verisq_mapper {
  verisq::PointMapper mapper;
};

namespace {

using verisq::Error;
using verisq::ErrorKind;
using verisq::refuse;

static_assert(VERISQ_DEVICE_VERIFIED == static_cast<int>(verisq::Status::device_verified));
static_assert(VERISQ_HOST_VERIFIED == static_cast<int>(verisq::Status::host_verified));
static_assert(VERISQ_WIDE == static_cast<int>(verisq::Status::wide));
static_assert(VERISQ_SEPARATED == static_cast<int>(verisq::Proximity::separated));
static_assert(VERISQ_OVERLAPPING == static_cast<int>(verisq::Proximity::overlapping));
static_assert(VERISQ_UNDECIDED == static_cast<int>(verisq::Proximity::undecided));

verisq_code told(verisq_error* error, verisq_code code, std::string_view message) {
  if (error != nullptr) {
    error->code = code;
    const std::size_t length = std::min(message.size(), sizeof error->message - 1);
    *std::copy_n(message.data(), length, error->message) = '\0';
  }
  return code;
}

/// Runs the work; no exception leaves this function.
template <class Work>
verisq_code answer(verisq_error* error, const Work& work) noexcept {
  try {
    work();
    return told(error, VERISQ_OK, "");
  } catch (const Error& thrown) {
    return told(error, thrown.kind() == ErrorKind::input ? VERISQ_INPUT : VERISQ_FAILURE, thrown.what());
  } catch (const std::bad_alloc&) {
    return told(error, VERISQ_FAILURE, "out of memory");
  } catch (const std::exception& thrown) {
    return told(error, VERISQ_FAILURE, thrown.what());
  } catch (...) {
    return told(error, VERISQ_FAILURE, "an error of unknown kind");
  }
}

/// False for NaN, too.
void require_at_least_0(double value, const char* name) {
  if (!(value >= 0.0 && std::isfinite(value))) refuse(std::string(name) + " is not finite or below 0");
}

bool all_finite(const double* numbers, std::size_t count) {
  return std::all_of(numbers, numbers + count, [](double number) { return std::isfinite(number); });
}

verisq::Pose pose_of(const verisq_pose& pose) {
  const auto& [t, q] = pose;
  if (!all_finite(t, 3) || !all_finite(q, 4)) refuse("the pose is not finite");
  if (std::all_of(q, q + 4, [](double number) { return number == 0.0; })) refuse("the pose's quaternion is zero");
  return {.translation = {t[0], t[1], t[2]}, .quaternion = {q[0], q[1], q[2], q[3]}};
}

verisq_enclosure in_c(const verisq::Enclosure& enclosure) {
  return {enclosure.lo, enclosure.hi};
}

struct FoundDistance {
  verisq::Enclosure distance;
  verisq::Proximity proximity;
};

FoundDistance distance_of(const verisq::Model& a, const verisq::Model& b, const verisq::Pose& pose, double tolerance) {
  if (verisq::is_union_of_convex(a) && verisq::is_union_of_convex(b)) {
    const auto found = verisq::PairDistance(a, b)(pose);
    return {found.distance, found.proximity};
  }
  const auto found = verisq::ModelSearch(a, b)(pose, {.tolerance = tolerance});
  return {found.distance, found.proximity};
}

double default_tolerance(const verisq::Model& model) {
  return 1e-6 * verisq::bounding_radius(model);
}

verisq::MapOptions options_of(const verisq::Model& model, const verisq_map_options* given) {
  if (given == nullptr) return {.tolerance = default_tolerance(model)};
  require_at_least_0(given->tolerance, "the tolerance");
  require_at_least_0(given->point_radius, "the points' radius");
  verisq::MapOptions options{.tolerance = given->tolerance, .point_radius = given->point_radius};
  if (given->device != nullptr) options.device = given->device;
  if (given->interrupted != nullptr) {
    options.interrupted = [poll = given->interrupted, context = given->context] { return poll(context) != 0; };
  }
  return options;
}

verisq::PointColumns columns_of(const verisq_points& points) {
  const auto& [count, first, stride] = points;
  if (count > 0 && std::any_of(first, first + 3, [](const double* column) { return column == nullptr; })) {
    refuse("a column of the points is NULL");
  }
  return {count, {first[0], stride[0]}, {first[1], stride[1]}, {first[2], stride[2]}};
}

verisq::ResultColumns columns_of(const verisq_rows& rows, std::size_t count) {
  if (count > 0 && (rows.lo == nullptr || rows.hi == nullptr || rows.status == nullptr)) {
    refuse("a column of the rows is NULL");
  }
  // A Status is a byte, which may lie in any memory of bytes.
  return {count,
          {rows.lo, rows.stride_lo},
          {rows.hi, rows.stride_hi},
          {reinterpret_cast<verisq::Status*>(rows.status), rows.stride_status}};
}

verisq_map_summary in_c(const verisq::MapSummary& summary) {
  return {.points = summary.points,
          .device_verified = summary.device_verified,
          .host_verified = summary.host_verified,
          .wide = summary.wide,
          .minimum = {summary.minimum_lo, summary.minimum_hi},
          .largest_width = summary.largest_width,
          .interrupted = summary.interrupted ? 1 : 0};
}

}  // namespace

const char* verisq_version(void) {
  return VERISQ_VERSION;
}

verisq_code verisq_model_read(const char* path, verisq_model** model, verisq_error* error) {
  return answer(error, [&] { *model = new verisq_model(verisq::read_model(path)); });
}

verisq_code verisq_model_parse(const char* json, size_t length, const char* name, verisq_model** model,
                               verisq_error* error) {
  return answer(error, [&] { *model = new verisq_model(verisq::parse_model({json, length}, name)); });
}

void verisq_model_free(verisq_model* model) {
  delete model;
}

double verisq_model_bounding_radius(const verisq_model* model) {
  return verisq::bounding_radius(model->model);
}

verisq_code verisq_point_distance(const verisq_model* model, const double point[3], double tolerance,
                                  verisq_enclosure* distance, verisq_error* error) {
  return answer(error, [&] {
    require_at_least_0(tolerance, "the tolerance");
    if (!all_finite(point, 3)) refuse("the point is not finite");
    *distance = in_c(model->distance({point[0], point[1], point[2]}, tolerance));
  });
}

verisq_code verisq_model_distance(const verisq_model* a, const verisq_model* b, const verisq_pose* pose_of_b,
                                  double tolerance, verisq_enclosure* distance, verisq_proximity* proximity,
                                  verisq_error* error) {
  return answer(error, [&] {
    require_at_least_0(tolerance, "the tolerance");
    const verisq::Pose pose = pose_of_b == nullptr ? verisq::Pose{} : pose_of(*pose_of_b);
    const FoundDistance found = distance_of(a->model, b->model, pose, tolerance);
    *distance = in_c(found.distance);
    *proximity = static_cast<verisq_proximity>(found.proximity);
  });
}

verisq_code verisq_mapper_create(const verisq_model* model, const verisq_map_options* options, verisq_mapper** mapper,
                                 verisq_error* error) {
  return answer(error, [&] {
    *mapper = new verisq_mapper{verisq::PointMapper(model->model, options_of(model->model, options))};
  });
}

void verisq_mapper_free(verisq_mapper* mapper) {
  delete mapper;
}

verisq_code verisq_map_points(verisq_mapper* mapper, const verisq_points* points, const verisq_rows* rows,
                              verisq_map_summary* summary, verisq_error* error) {
  return answer(error, [&] {
    const verisq::MapSummary found = mapper->mapper.map(columns_of(*points), columns_of(*rows, points->count));
    if (summary != nullptr) *summary = in_c(found);
  });
}

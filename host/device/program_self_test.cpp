/// This file implements program_self_test.hpp.
#include "host/device/program_self_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>
#include <verisq/map.hpp>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/point_pipe.hpp"
#include "host/device/query_batches.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/points.hpp"
#include "verisq/distance.hpp"
#include "verisq/mesh.hpp"

namespace verisq::device {
namespace {

class Draws {
 public:
  double between(double a, double b) { return a + (b - a) * unit_(generator_); }
  double sign() { return unit_(generator_) < 0.5 ? -1.0 : 1.0; }
  /// Between this size and a thousand times as much, evenly by the logarithm.
  double up_to_thousand_times(double size) { return size * std::pow(10.0, between(0.0, 3.0)); }

 private:
  std::mt19937_64 generator_{47};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

double signed_power(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

// About on the surface of the solid of Eq. (1), before taper, bend and pose.
Point on_surface(const Superquadric& solid, Draws& draws) {
  const double eta = draws.between(-0.5, 0.5) * std::numbers::pi;
  const double omega = draws.between(-1.0, 1.0) * std::numbers::pi;
  const auto& [a, e, taper] = solid;
  const double section = signed_power(std::cos(eta), e[0]);
  return {a[0] * section * signed_power(std::cos(omega), e[1]), a[1] * section * signed_power(std::sin(omega), e[1]),
          a[2] * signed_power(std::sin(eta), e[0])};
}

Point tapered(const Superquadric& solid, const Point& p) {
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  const double height = solid.semi_axes[2];
  const double z = (p[2] - k * height) / (1.0 - k * p[2] / height);
  const double wider = 1.0 + k * z / height;
  return {wider * p[0], wider * p[1], z};
}

// The bent point, as include/verisq/model.hpp defines it.
Point bent(const Bend& bend, const Point& p) {
  const double k = bend.curvature;
  const double angle = bend.angle_degrees * std::numbers::pi / 180.0;
  const double r = p[0] * std::cos(angle) + p[1] * std::sin(angle);
  const double s = p[1] * std::cos(angle) - p[0] * std::sin(angle);
  const double turn = k * p[2];
  // 1/k - (1/k - r) cos kz without a difference of large numbers.
  const double half = std::sin(0.5 * turn);
  const double bent_r = 2.0 * half * half / k + r * std::cos(turn);
  const double bent_z = std::sin(turn) / k - r * std::sin(turn);
  return {bent_r * std::cos(angle) - s * std::sin(angle), bent_r * std::sin(angle) + s * std::cos(angle), bent_z};
}

// The relative distance of a point from the centre, by its turn: 1 is on the surface.
double share_of_reach(std::size_t turn, Draws& draws) {
  switch (turn % 8) {
    case 0: return 1.0;
    case 1: return 1.0 + draws.sign() * 1e-9;
    case 2: return 1.0 + draws.up_to_thousand_times(1e-4);
    case 3: return 1.0 - draws.up_to_thousand_times(1e-4);
    case 4: return draws.between(0.0, 0.9);
    case 5:
    case 6: return draws.between(1.1, 4.0);
    default: return draws.up_to_thousand_times(4.0);
  }
}

Point sample_point(const Primitive& primitive, std::size_t turn, Draws& draws) {
  const Superquadric& solid = primitive.superquadric;
  Point p = tapered(solid, on_surface(solid, draws));
  const double share = share_of_reach(turn, draws);
  for (double& x : p) x *= share;
  const bool bends = is_bent(primitive) && share <= 1.5;  // farther out bends turn over
  return posed(bends ? bent(*primitive.bend, p) : p, primitive.pose);
}

/// Points on, near, inside, around and far from the model's primitives, which take turns.
std::vector<Point> sample_points(const Model& model, std::size_t count) {
  Draws draws;
  std::vector<Point> points;
  const std::size_t primitives = model.primitives.size();
  for (std::size_t n = 0; n < count; ++n)
    points.push_back(sample_point(model.primitives[n % primitives], n / primitives, draws));
  return points;
}

}  // namespace

std::vector<Enclosure> distances_by_host(const Model& model, std::span<const Point> points, double tolerance) {
  const SignedDistance distance(model);
  std::vector<Enclosure> found(points.size());
  in_parallel(points.size(), [&](std::size_t n) { found[n] = distance(points[n], tolerance); });
  return found;
}

namespace {

/// A convex solid of general shape and place, and another that overlaps it, in units of `unit`.
Primitive sample_solid(double unit) {
  return {
      "", {{unit, 1.5 * unit, 0.6 * unit}, {0.4, 1.2}}, {{0.3 * unit, -0.1 * unit, 0.2 * unit}, {0.8, 0.1, 0.6, -0.2}}};
}

Primitive other_sample_solid(double unit) {
  return {"",
          {{0.7 * unit, 0.5 * unit, 1.1 * unit}, {1.0, 0.7}},
          {{-0.6 * unit, 0.9 * unit, 0.4 * unit}, {0.2, -0.5, 0.4, 1.0}}};
}

/// The union of the primitives.
Model sample_model(std::vector<Primitive> primitives) {
  return {"", std::move(primitives), {}};
}

// Neither whole vectors nor many: the host proves each.
constexpr std::size_t triangles_of_model = 67;
constexpr std::size_t poses_of_pair = 45;
constexpr double narrow_part = 1e-6;  // of the model's radius

template <class Query>
std::vector<Enclosure> answers(Batch<Query>& batch, const std::vector<Query>& queries) {
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> none;
  batch.submit(queries);
  batch.collect(enclosures, none);
  return enclosures;
}

// Triangles from each point to the next ones, or to points a few sizes of the solid away, so that some meet the model
// and others do not.
std::vector<Triangle> sample_triangles(const Model& model) {
  const std::vector<Point> points = sample_points(model, triangles_of_model + 2);
  const double size = model.primitives.front().superquadric.semi_axes[0];
  std::vector<Triangle> triangles;
  for (std::size_t n = 0; n < triangles_of_model; ++n) {
    Triangle triangle{points[n], points[n + 1], points[n + 2]};
    if (n % 4 != 0) {
      const double edge = size * (n % 4 == 1 ? 1e-3 : 0.4);
      triangle[1] = {points[n][0] + edge, points[n][1] - 0.3 * edge, points[n][2] + 0.2 * edge};
      triangle[2] = {points[n][0] - 0.1 * edge, points[n][1] + 0.9 * edge, points[n][2] - 0.5 * edge};
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

std::vector<Pose> sample_poses(const Model& model) {
  std::vector<Pose> poses;
  for (const Point& point : sample_points(model, poses_of_pair)) {
    const double turn = 0.1 * static_cast<double>(poses.size());
    poses.push_back({point, {1.0, turn, -0.5 * turn, 0.7}});
  }
  return poses;
}

}  // namespace

std::string first_fault_of_triangles(const Device& device, const cl::Program& program) {
  for (const Model& model :
       {sample_model({sample_solid(48.0)}), sample_model({other_sample_solid(1.0), sample_solid(1.0)})}) {
    const std::vector<Triangle> triangles = sample_triangles(model);
    const TriangleDistance distance(model);
    std::vector<Enclosure> of_host(triangles.size());
    in_parallel(triangles.size(), [&](std::size_t n) { of_host[n] = distance(triangles[n]); });
    const auto batch = triangle_batch(device, program, model, false);
    std::string found =
        contradiction(answers(*batch, triangles), of_host, narrow_part * bounding_radius(model), triangles.size() / 2);
    if (!found.empty()) return found;
  }
  return {};
}

std::string first_fault_of_poses(const Device& device, const cl::Program& program, PoseDistances& of_host) {
  const Model a = sample_model({sample_solid(48.0), other_sample_solid(48.0)});
  for (const Model& b :
       {sample_model({other_sample_solid(30.0)}), sample_model({sample_solid(20.0), other_sample_solid(20.0)})}) {
    const std::vector<Pose> poses = sample_poses(a);
    const auto batch = pose_batch(device, program, a, b);
    std::string found =
        contradiction(answers(*batch, poses), of_host(a, b, poses), narrow_part * bounding_radius(a), poses.size() / 3);
    if (!found.empty()) return found;
  }
  return {};
}

namespace {

// More than a block of rows, and neither whole blocks nor whole vectors, so that writes behind the last point are
// found.
constexpr std::size_t sampled_rows = rows_of_block + 83;
constexpr std::size_t distinct_points = 72;

struct Answer {
  std::vector<MapResult> rows;
  std::vector<RowSums> sums;
  bool refused = false;
};

// Points and rows in columns of unlike strides.
class Apart {
 public:
  explicit Apart(std::span<const Point> points)
      : size_(points.size()), x_(size_), y_(2 * size_), z_(size_), los_(size_), his_(2 * size_), status_(3 * size_) {
    for (std::size_t n = 0; n < size_; ++n) {
      x_[n] = points[n][0];
      y_[2 * n] = points[n][1];
      z_[size_ - 1 - n] = points[n][2];
    }
  }

  [[nodiscard]] PointColumns points() const { return {size_, {x_.data(), 1}, {y_.data(), 2}, {&z_.back(), -1}}; }
  [[nodiscard]] ResultColumns rows() { return {size_, {&los_.back(), -1}, {his_.data(), 2}, {status_.data(), 3}}; }

 private:
  std::size_t size_;
  std::vector<double> x_, y_, z_, los_, his_;
  std::vector<Status> status_;
};

// One chunk in the caller's memory, as a pipe has it.
class SampleChunk {
 public:
  SampleChunk(const Device& device, const DeviceModel& model)
      : queue_(device),
        memory_(shares_memory(device) ? shared_memory(device) : copied_memory(device, queue_, model.chunk_size)),
        totals_(device, queue_, model.chunk_size) {}

  [[nodiscard]] ChunkQueue& queue() { return queue_; }
  [[nodiscard]] const RowTotals& totals() const { return totals_; }

  /// Calls `enqueue` with the bound chunk. If `apart`, coordinates and ends are columns of their own, of unlike
  /// strides, some backwards: kernels must support any memory.
  Answer operator()(std::span<const Point> points, bool apart, const std::function<void(const BoundChunk&)>& enqueue) {
    const std::size_t size = points.size();
    Answer answer{std::vector<MapResult>(size, {{0.0, 0.0}, Status::host_verified}), {}};
    Apart columns(points);
    const PointColumns taken = apart ? columns.points() : PointColumns(points);
    const ResultColumns given = apart ? columns.rows() : ResultColumns(answer.rows);
    const BoundChunk bound = memory_->bind(queue_, taken, given);
    enqueue(bound);
    memory_->fetch(queue_);
    totals_.fetch(queue_, size);
    queue_.finish();
    memory_->deliver();
    memory_->release();
    for (std::size_t n = 0; n < size; ++n) answer.rows[n] = given[n];
    answer.sums = totals_.of_blocks();
    answer.refused = totals_.refused();
    if (answer.refused) totals_.forget_refusal(queue_);
    return answer;
  }

 private:
  ChunkQueue queue_;
  std::unique_ptr<HostMemory> memory_;
  RowTotals totals_;
};

// ---- the host's rows

// As tight as methods get, as defined by RowCriterion.
bool is_tightest(const RowCriterion& criterion, const Point& point, const Enclosure& row) {
  if (row.hi < 0.0) return verified(row, criterion.inside);
  return verified(row, criterion.outside * std::max(verify::largest_coordinate(point), criterion.radius));
}

void add(RowSums& sums, const MapResult& row, bool open) {
  const Enclosure& distance = row.distance;
  if (open) {
    ++sums.open;
    if (!(distance.lo > 0.0)) ++sums.open_inside;
    return;
  }
  sums.minimum_lo = std::min(sums.minimum_lo, distance.lo);
  sums.minimum_hi = std::min(sums.minimum_hi, distance.hi);
  sums.largest_width = std::max(sums.largest_width, distance.width());
  if (row.status == Status::device_verified) ++sums.verified;
  if (row.status == Status::wide) ++sums.wide;
  if (row.status == Status::wide && distance.lo < 0.0) ++sums.wide_inside;
}

bool same(const RowSums& a, const RowSums& b) {
  return a.minimum_lo == b.minimum_lo && a.minimum_hi == b.minimum_hi && a.largest_width == b.largest_width &&
         a.verified == b.verified && a.wide == b.wide && a.wide_inside == b.wide_inside && a.open == b.open &&
         a.open_inside == b.open_inside;
}

// The first row whose status, or block whose sums, its own enclosures contradict.
std::string false_verdict(std::span<const Point> points, const Answer& answer, const RowCriterion& criterion) {
  std::vector<RowSums> sums(blocks_of(points.size()), {infinity, infinity, 0.0, 0, 0, 0, 0, 0});
  for (std::size_t n = 0; n < points.size(); ++n) {
    const MapResult& row = answer.rows[n];
    const bool tightest = is_tightest(criterion, points[n], row.distance);
    const bool good = verified(row.distance, criterion.tolerance) || (criterion.tolerance == 0.0 && tightest);
    if (row.status != (good ? Status::device_verified : Status::wide))
      return fmt::format("row {} with [{}, {}] and a tolerance of {} is called {}", n, row.distance.lo, row.distance.hi,
                         criterion.tolerance, to_string(row.status));
    add(sums[n / rows_of_block], row, !good && !tightest);
  }
  for (std::size_t block = 0; block < sums.size(); ++block)
    if (!same(answer.sums[block], sums[block]))
      return fmt::format("the sums of block {} are not those of its rows", block);
  return {};
}

// ---- samples

struct Samples {
  Model model;
  double radius;
  std::vector<Point> points;
  std::vector<Enclosure> of_host;  // of the first of the points, which come again and again
};

Samples samples_of(const Model& model) {
  const double radius = bounding_radius(model);
  Samples samples{model, radius, sample_points(model, distinct_points), {}};
  samples.of_host = distances_by_host(model, samples.points, 1e-7 * radius);
  return samples;
}

std::vector<Point> repeated(std::span<const Point> points, std::size_t count) {
  std::vector<Point> all;
  for (std::size_t n = 0; n < count; ++n) all.push_back(points[n % points.size()]);
  return all;
}

/// Makes rows of the bound points, as many as there are.
using Launch = std::function<Answer(std::span<const Point>, bool apart, const RowCriterion&)>;

// `wanted` is the number of first points whose rows must be as narrow as the criterion requires: the points outside.
std::string fault(const Samples& samples, const RowCriterion& criterion, bool apart, std::size_t wanted,
                  const Launch& launch) {
  const std::vector<Point> points = repeated(samples.points, sampled_rows);
  const Answer answer = launch(points, apart, criterion);
  if (answer.refused) return "points that are finite were refused";
  std::vector<Enclosure> of_device;
  std::vector<Enclosure> of_host;
  for (std::size_t n = 0; n < sampled_rows; ++n) {
    of_device.push_back(answer.rows[n].distance);
    of_host.push_back(samples.of_host[n % samples.of_host.size()]);
  }
  const std::string found = contradiction(of_device, of_host, 1e-6 * samples.radius, wanted);
  return found.empty() ? false_verdict(points, answer, criterion) : found;
}

// A single coordinate that is not finite must be reported, wherever it is.
std::string silence(const Samples& samples, const RowCriterion& criterion, const Launch& launch) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<Point> points = repeated(samples.points, sampled_rows);
    points[sampled_rows / 4 * i][i] = i == 1 ? infinity : nan;
    if (!launch(points, false, criterion).refused)
      return fmt::format("a point whose coordinate {} is not finite was taken", i);
  }
  return {};
}

// Tries criteria of all kinds: rows come out verified, wide for good, and open.
std::string fault_by_criteria(const Model& model, std::size_t wanted, const Launch& launch) {
  const Samples samples = samples_of(model);
  const double r = samples.radius;
  const RowCriterion usual{1e-6 * r, -1.0, 1e-12, r};
  const RowCriterion tightest{0.0, 2e-9 * r, 1e-14, r};
  const RowCriterion unattained{1e-17 * r, 2e-9 * r, 1e-12, r};
  bool apart = false;
  for (const RowCriterion& criterion : {usual, tightest, unattained}) {
    std::string found = fault(samples, criterion, apart, wanted, launch);
    if (!found.empty()) return found;
    apart = !apart;
  }
  return silence(samples, usual, launch);
}

Primitive with_taper(Primitive primitive, double taper) {
  primitive.superquadric.taper = taper;
  return primitive;
}

// Ordinary ones, and one so small that distances to it leave the normal numbers.
std::vector<Model> single_solids(bool tapered) {
  std::vector<Model> models;
  for (const double unit : {48.0, 0x1p-1000}) {
    models.push_back(sample_model({tapered ? with_taper(sample_solid(unit), 2.5) : sample_solid(unit)}));
  }
  return models;
}

DeviceModel uploaded_sample(const Device& device, const Model& model) {
  DeviceModel uploaded(device, model);
  uploaded.chunk_size = rows_side_by_side;
  return uploaded;
}

}  // namespace

std::string first_fault_in_steps(const Device& device, const PointPrograms& programs) {
  const bool tapered = programs.tapered.has_value();
  std::vector<Model> models = single_solids(tapered);
  if (!tapered) models.push_back(sample_model({sample_solid(1.0), other_sample_solid(1.0)}));
  for (const Model& model : models) {
    const DeviceModel uploaded = uploaded_sample(device, model);
    const Launch launch = [&](std::span<const Point> points, bool apart, const RowCriterion& criterion) {
      SampleChunk chunk(device, uploaded);
      RowsInSteps steps(device, programs, uploaded, chunk.queue(), criterion, chunk.totals());
      return chunk(points, apart,
                   [&](const BoundChunk& bound) { steps.enqueue(chunk.queue(), bound, points.size(), true); });
    };
    std::string found = fault_by_criteria(model, sampled_rows / 2, launch);
    if (!found.empty()) return found;
  }
  return {};
}

std::string first_fault_at_once(const Device& device, const cl::Program& program, bool tapered) {
  for (const Model& model : single_solids(tapered)) {
    const DeviceModel uploaded = uploaded_sample(device, model);
    const Launch launch = [&](std::span<const Point> points, bool apart, const RowCriterion& criterion) {
      SampleChunk chunk(device, uploaded);
      RowsAtOnce at_once(device, program, uploaded, criterion, chunk.totals());
      return chunk(points, apart,
                   [&](const BoundChunk& bound) { at_once.enqueue(chunk.queue(), bound, points.size()); });
    };
    std::string found = fault_by_criteria(model, sampled_rows / 3, launch);
    if (!found.empty()) return found;
  }
  return {};
}

namespace {

constexpr std::size_t points_of_solid = 61;
// The model is the caller's, and may be hard: more than points far from it cannot be expected.
constexpr double sample_tolerance = 1e-3;  // of the model's radius

}  // namespace

std::string first_fault_of_solid(const Device& device, const SolidPrograms& programs, const Model& model) {
  const double searched = sample_tolerance * bounding_radius(model);
  const std::vector<Point> points = sample_points(model, points_of_solid);
  const auto batch = solid_batch(device, programs, model, searched);
  std::vector<Enclosure> of_device;
  std::vector<Certificate> none;
  batch->submit(points);
  batch->collect(of_device, none);
  return contradiction(of_device, distances_by_host(model, points, searched), searched, points.size() / 8);
}

std::string samples_of_solid(const Model& model) {
  std::string samples = "kernels of a model's own tree, primitives ";
  for (const Primitive& primitive : model.primitives) {
    const bool tapered = is_tapered(primitive.superquadric);
    samples += is_bent(primitive) ? (tapered ? 'B' : 'b') : (tapered ? 'C' : 'c');
  }
  return samples;
}

void require_sound(const Device& device, const cl::Program& program, std::string_view samples,
                   const std::function<std::string()>& first_fault) {
  const std::string identity_of_program = program_identity(device.device, program);
  std::string key;  // empty where another run may get another binary
  if (!identity_of_program.empty())
    key = fmt::format("sampled kernels {}\n{}\n{}\n{}\n{}", VERISQ_PROGRAM_SELF_TEST_DIGEST, identity(device.device),
                      device.vector_width, samples, identity_of_program);
  const std::string failure = remembered_failure(key, first_fault);
  if (!failure.empty()) throw RefusedDevice(device.name, fmt::format("{}: {}", samples, failure));
}

std::string contradiction(std::span<const Enclosure> of_device, std::span<const Enclosure> of_host, double narrow,
                          std::size_t wanted) {
  std::size_t count = 0;
  for (std::size_t n = 0; n < of_device.size(); ++n) {
    const auto& [lo, hi] = of_device[n];
    const Enclosure& proven = of_host[n];
    // False for NaN.
    const bool meet = lo <= hi && lo <= proven.hi && hi >= proven.lo;
    if (!meet) return fmt::format("sample {} gave [{}, {}], the host proves [{}, {}]", n, lo, hi, proven.lo, proven.hi);
    if (hi - lo <= narrow) ++count;
  }
  if (count >= wanted) return {};
  return fmt::format("{} of {} samples gave enclosures as narrow as {}, of {} expected", count, of_device.size(),
                     narrow, wanted);
}

}  // namespace verisq::device

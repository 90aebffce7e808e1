/// This file implements the evaluation of candidates on a device: ordered points, chunks of candidates, reductions.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/plan/pose_search.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

using fit_search::Candidate;
using fit_search::Evaluation;
using fit_search::PointDistance;
using fit_search::PoseCell;

// The counterpart of `scaled_superquadric` in kernels/signed_distance_gradient.clh. Only the primitive's proposing
// parameters are set, and those that bound a tapered one to nearest: nothing is proven here.
struct ScaledPrimitive {
  PrimitiveParameters parameters;
  double unit;
};

// The sums of a candidate, as kernels/pose_objective.cl orders them; three a primitive follow.
constexpr std::size_t objective_column = 0;
constexpr std::size_t bound_column = 1;
constexpr std::size_t pose_gradient_column = 2;
constexpr std::size_t smallest_distance_column = 8;
constexpr std::size_t columns_of_pose = 9;

constexpr std::size_t distance_columns = 8;  // distance, normal, primitive, size gradient

// A launch stays short enough for an interrupt to be noticed: some 10^7 distances a second on two processor cores, a
// hundred times that on a graphics processor.
constexpr std::size_t distances_of_processor_launch = 2'000'000;
constexpr std::size_t distances_of_launch = 100'000'000;
constexpr std::size_t distances_of_first_launch = 1'000'000;
constexpr std::size_t partial_numbers_of_launch = std::size_t{1} << 23U;  // 64 MiB

// Vectors of points a work-item: many for a processor, which has few cores; still enough work-items for one candidate.
constexpr std::size_t vectors_of_processor_slice = 8;
constexpr std::size_t points_of_slice = 2;

// Slices that a graphics processor's work-item sums: sums of sums follow. A processor's sums all, which are few.
constexpr std::size_t slices_of_block = 64;

// Beyond, Newton's method often fails. A smaller exponent gives a larger solid: penetrations are overestimated.
constexpr double largest_exponent = 1.95;

// The bounding parameters of kernels/tapered_enclosure.clh, here to nearest. An exponent of the dual norm is finite:
// exponents are below 2.
void set_taper_to_nearest(PrimitiveParameters& parameters, double taper) {
  double squares = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    parameters.inverse_axes_up[i] = 1.0 / parameters.semi_axes[i];
    squares += parameters.semi_axes[i] * parameters.semi_axes[i];
  }
  for (std::size_t i = 0; i < 2; ++i) {
    parameters.p_down[i] = parameters.p[i];
    parameters.inverse_p_up[i] = parameters.inverse_p[i];
    parameters.inverse_conjugate_up[i] = 1.0 - parameters.inverse_p[i];
    parameters.conjugate_down[i] = 1.0 / parameters.inverse_conjugate_up[i];
  }
  const double k = (taper - 1.0) / (taper + 1.0);
  const double fall = 1.0 - k * k;
  parameters.containment_up = 1.0;
  parameters.circumradius_up = std::sqrt(squares);
  parameters.reach_up = parameters.circumradius_up * (1.0 + std::abs(k));
  parameters.taper = k;
  parameters.fall_down = fall;
  parameters.fall_up = fall;
  parameters.log_fall = std::log(fall);
  parameters.focus = k * parameters.semi_axes[2];
}

ScaledPrimitive scaled(const Primitive& primitive) {
  ScaledPrimitive out{};
  PrimitiveParameters& parameters = out.parameters;
  const auto& semi_axes = primitive.superquadric.semi_axes;
  const auto& exponents = primitive.superquadric.exponents;
  const int scale = -std::ilogb(*std::max_element(semi_axes.begin(), semi_axes.end()));
  const auto rotation = rotation_matrix(primitive.pose.quaternion);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) parameters.rotation[3 * i + k] = std::ldexp(rotation[3 * k + i], scale);
    parameters.translation[i] = primitive.pose.translation[i];
    parameters.semi_axes[i] = std::ldexp(semi_axes[i], scale);
    parameters.log_axes[i] = std::log(parameters.semi_axes[i]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const double exponent = std::min(exponents[i], largest_exponent);
    parameters.p[i] = 2.0 / exponent;
    parameters.inverse_p[i] = exponent / 2.0;
  }
  if (is_tapered(primitive.superquadric)) set_taper_to_nearest(parameters, primitive.superquadric.taper);
  out.unit = std::ldexp(1.0, -scale);
  return out;
}

// Reorders `indices` such that runs of `run` and more points lie close together: halves along the longest side of their
// box, again and again. Lanes of a vector then mostly agree on the primitive that decides.
void order_spatially(std::span<std::size_t> indices, std::span<const Point> points, std::size_t run) {
  if (indices.size() <= run) return;
  Point lower = points[indices.front()];
  Point upper = lower;
  for (const std::size_t i : indices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], points[i][axis]);
      upper[axis] = std::max(upper[axis], points[i][axis]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (upper[axis] - lower[axis] > upper[longest] - lower[longest]) longest = axis;
  const std::size_t half = (indices.size() / run + 1) / 2 * run;
  std::nth_element(indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(half), indices.end(),
                   [&](std::size_t a, std::size_t b) {
                     return std::pair(points[a][longest], a) < std::pair(points[b][longest], b);
                   });
  order_spatially(indices.first(half), points, run);
  order_spatially(indices.subspan(half), points, run);
}

// Every stride-th point on the device, in spatial order; lanes beyond the last point repeat it with weight 0.
struct DevicePoints {
  DevicePoints(const Device& device, std::span<const Point> points, std::span<const double> weights, std::size_t step)
      : stride(step), order((points.size() + step - 1) / step) {
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i * step;
    const auto width = static_cast<std::size_t>(device.vector_width);
    order_spatially(order, points, width);
    groups = (order.size() + width - 1) / width;
    std::vector<double> column(groups * width);
    const auto uploaded = [&](const auto& number) {
      for (std::size_t n = 0; n < column.size(); ++n) column[n] = number(n);
      return cl::Buffer(device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, column.size() * sizeof(double),
                        column.data());
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coordinates[axis] = uploaded([&](std::size_t n) { return points[order[std::min(n, order.size() - 1)]][axis]; });
    }
    point_weights = uploaded([&](std::size_t n) { return n < order.size() ? weights[order[n]] : 0.0; });
  }

  std::size_t stride;
  std::vector<std::size_t> order;  // indices of the points
  std::size_t groups;              // vectors
  std::array<cl::Buffer, 3> coordinates;
  cl::Buffer point_weights;
};

// Room for the candidates of one launch, and their sums.
struct Chunk {
  Chunk(ChunkQueue& queue, std::size_t launch_capacity, std::size_t primitives_of_candidate, std::size_t slices,
        std::size_t blocks)
      : capacity(launch_capacity),
        primitives_of_each(primitives_of_candidate),
        columns(columns_of_pose + 3 * primitives_of_candidate),
        primitives(queue.numbers(capacity * primitives_of_each * sizeof(ScaledPrimitive) / sizeof(double))),
        pivots(queue.numbers(capacity * 3)),
        partials(queue.numbers(capacity * slices * columns)),
        sums(queue.numbers(capacity * blocks * columns)),
        pivot_column(capacity * 3),
        sum_column(capacity * columns) {}

  std::size_t capacity;
  std::size_t primitives_of_each;
  std::size_t columns;
  cl::Buffer primitives;
  cl::Buffer pivots;
  cl::Buffer partials;
  cl::Buffer sums;
  std::vector<ScaledPrimitive> primitive_column;
  std::vector<double> pivot_column;
  std::vector<double> sum_column;
};

Evaluation evaluation_of(std::span<const double> sums, std::size_t primitives) {
  Evaluation evaluation{sums[objective_column], {}, {}, sums[smallest_distance_column], sums[bound_column]};
  std::copy_n(sums.begin() + pose_gradient_column, 6, evaluation.pose_gradient.begin());
  for (std::size_t i = 0; i < primitives; ++i) {
    const auto by_axes = sums.subspan(columns_of_pose + 3 * i, 3);
    evaluation.size_gradient.push_back({by_axes[0], by_axes[1], by_axes[2]});
  }
  return evaluation;
}

std::string_view objective_sources(bool tapered) {
  return tapered ? kernels::embedded_tapered_pose_objective_sources() : kernels::embedded_pose_objective_sources();
}

// The kernels for candidates in the memory that `model_memory_option` names, for primitives with or without tapers.
struct Kernels {
  Kernels(const Device& device, const std::string& memory_option, bool tapered_ones)
      : memory(memory_option),
        tapered(tapered_ones),
        program(build_program(device.context, device.device, device.vector_width, objective_sources(tapered), memory)),
        pose_objective(program, objective_sources(tapered), "pose_objective"),
        sum_slices(program, objective_sources(tapered), "sum_slices"),
        pose_distance(program, objective_sources(tapered), "pose_distance") {}

  std::string memory;
  bool tapered;
  cl::Program program;
  NamedKernel pose_objective;
  NamedKernel sum_slices;
  NamedKernel pose_distance;
};

class DeviceCandidateEvaluator final : public fit_search::CandidateEvaluator {
 public:
  DeviceCandidateEvaluator(const Device& device, std::span<const Point> points, std::span<const double> weights)
      : device_(device),
        points_(points.begin(), points.end()),
        weights_(weights.begin(), weights.end()),
        pace_(is_processor() ? LaunchPace(distances_of_processor_launch, distances_of_processor_launch)
                             : LaunchPace(distances_of_launch, distances_of_first_launch)),
        queue_(device) {}

  void evaluate(std::span<const Candidate> candidates, const Fitness& fitness, const PoseCell& cell, std::size_t stride,
                std::vector<Evaluation>& evaluations) override {
    evaluations.clear();
    evaluations.reserve(candidates.size());
    if (candidates.empty()) return;
    reporting_failures(device_.name, [&] {
      prepare(stride, candidates.front());
      set_arguments(fitness, cell);
      for (std::size_t first = 0; first < candidates.size();) {
        const std::size_t most = candidates_of_launch();
        const auto part = candidates.subspan(first, std::min(most, candidates.size() - first));
        first += part.size();
        upload(part);
        const double seconds = launch(part.size());
        pace_.took(part.size() == most ? pace_.size() : part.size() * distances_of_candidate(), seconds);
        const std::span<const double> sums = chunk_->sum_column;
        for (std::size_t n = 0; n < part.size(); ++n) {
          evaluations.push_back(
              evaluation_of(sums.subspan(n * chunk_->columns, chunk_->columns), chunk_->primitives_of_each));
        }
      }
    });
  }

  void distances(const Candidate& candidate, std::vector<PointDistance>& distances) override {
    reporting_failures(device_.name, [&] {
      prepare(1, candidate);
      upload({&candidate, 1});
      const std::vector<double> columns = launch_distances();
      const std::size_t capacity = columns.size() / distance_columns;
      distances.resize(points_.size());
      for (std::size_t n = 0; n < distances.size(); ++n) {
        const auto number = [&](std::size_t column) { return columns[column * capacity + n]; };
        distances[selected_->order[n]] = {number(0),
                                          {number(1), number(2), number(3)},
                                          static_cast<std::uint32_t>(number(4)),
                                          {number(5), number(6), number(7)}};
      }
    });
  }

 private:
  [[nodiscard]] bool is_processor() const { return device_.vector_width > 1; }

  // Vectors of points, and how many a launch may measure, decide how candidates are cut into work: the sums depend on
  // the former alone.
  void prepare(std::size_t stride, const Candidate& first) {
    const std::size_t primitives = first.primitives.size();
    const bool tapered =
        std::ranges::any_of(first.primitives, [](const Primitive& p) { return is_tapered(p.superquadric); });
    const bool compiled = kernels_ && kernels_->tapered == tapered;
    if (compiled && selected_ && selected_->stride == stride && chunk_ && chunk_->primitives_of_each == primitives)
      return;
    if (!selected_ || selected_->stride != stride) selected_.emplace(device_, points_, weights_, stride);
    const std::size_t vectors_of_slice = is_processor() ? vectors_of_processor_slice : points_of_slice;
    slices_ = (selected_->groups + vectors_of_slice - 1) / vectors_of_slice;
    const std::string memory = model_memory_option(device_, primitives * sizeof(ScaledPrimitive));
    if (!compiled || memory != kernels_->memory) kernels_.emplace(device_, memory, tapered);
    block_ = is_processor() ? slices_ : slices_of_block;
    chunk_.emplace(queue_, chunk_capacity(primitives), primitives, slices_, blocks_of(slices_));
    NamedKernel& objective = kernels_->pose_objective;
    objective.set("slices", slices_);
    objective.set("groups", selected_->groups);
    objective.set(coordinate_arguments, selected_->coordinates);
    objective.set("weights", selected_->point_weights);
    objective.set("primitives", chunk_->primitives);
    objective.set("count", primitives);
    objective.set("pivots", chunk_->pivots);
    objective.set("partials", chunk_->partials);
    kernels_->sum_slices.set("columns", chunk_->columns);
    kernels_->sum_slices.set("block", block_);
  }

  [[nodiscard]] std::size_t blocks_of(std::size_t slices) const { return (slices + block_ - 1) / block_; }

  [[nodiscard]] std::size_t distances_of_candidate() const {
    return selected_->order.size() * chunk_->primitives_of_each;
  }

  [[nodiscard]] std::size_t candidates_of_launch() const {
    return std::clamp<std::size_t>(pace_.size() / std::max<std::size_t>(1, distances_of_candidate()), 1,
                                   chunk_->capacity);
  }

  // At least one, however many points there are.
  [[nodiscard]] std::size_t chunk_capacity(std::size_t primitives) const {
    const std::size_t distances = is_processor() ? distances_of_processor_launch : distances_of_launch;
    const std::size_t columns = columns_of_pose + 3 * primitives;
    const std::size_t capacity =
        std::min(distances / (selected_->order.size() * primitives), partial_numbers_of_launch / (slices_ * columns));
    // All candidates of a launch share the constant memory, unless not even one has room there.
    const std::size_t in_constant_memory = device_.constant_memory / (primitives * sizeof(ScaledPrimitive));
    const bool constant = kernels_->memory.empty();
    return std::max<std::size_t>(1, constant ? std::min(capacity, in_constant_memory) : capacity);
  }

  void set_arguments(const Fitness& fitness, const PoseCell& cell) {
    kernels_->pose_objective.set("target", fitness.target);
    kernels_->pose_objective.set("scale", fitness.scale);
    kernels_->pose_objective.set("cell_translation", cell.translation);
    kernels_->pose_objective.set("cell_rotation", cell.rotation);
  }

  void upload(std::span<const Candidate> candidates) {
    Chunk& chunk = *chunk_;
    chunk.primitive_column.clear();
    for (std::size_t n = 0; n < candidates.size(); ++n) {
      for (const Primitive& primitive : candidates[n].primitives) chunk.primitive_column.push_back(scaled(primitive));
      std::copy(candidates[n].pivot.begin(), candidates[n].pivot.end(), &chunk.pivot_column[3 * n]);
    }
    static_assert(sizeof(ScaledPrimitive) % sizeof(double) == 0);
    queue_.write(chunk.primitives, std::span(reinterpret_cast<const double*>(chunk.primitive_column.data()),
                                             chunk.primitive_column.size() * sizeof(ScaledPrimitive) / sizeof(double)));
    queue_.write(chunk.pivots, std::span(chunk.pivot_column).first(3 * candidates.size()));
  }

  // Returns the seconds that the kernels took.
  double launch(std::size_t candidates) {
    Chunk& chunk = *chunk_;
    kernels_->pose_objective.set("candidates", candidates);
    kernels_->sum_slices.set("candidates", candidates);
    // A vector work-item is long: one a work-group lets the cores share them evenly.
    const std::size_t work_items = candidates * slices_;
    is_processor() ? queue_.launch(kernels_->pose_objective, work_items, 1)
                   : queue_.launch(kernels_->pose_objective, work_items);
    queue_.read(enqueue_sums(candidates), std::span(chunk.sum_column).first(candidates * chunk.columns));
    return seconds_of(queue_.finish());
  }

  // Returns where the sums over all slices will be: each pass overwrites what the pass before has read.
  const cl::Buffer& enqueue_sums(std::size_t candidates) {
    std::array<const cl::Buffer*, 2> buffers{&chunk_->partials, &chunk_->sums};
    for (std::size_t slices = slices_;; slices = blocks_of(slices)) {
      kernels_->sum_slices.set("slices", slices);
      kernels_->sum_slices.set("partials", *buffers[0]);
      kernels_->sum_slices.set("sums", *buffers[1]);
      queue_.launch(kernels_->sum_slices, candidates * blocks_of(slices) * chunk_->columns);
      if (blocks_of(slices) == 1) return *buffers[1];
      std::swap(buffers[0], buffers[1]);
    }
  }

  std::vector<double> launch_distances() {
    const std::size_t capacity = selected_->groups * static_cast<std::size_t>(device_.vector_width);
    const cl::Buffer buffer = queue_.numbers(distance_columns * capacity);
    std::vector<double> columns(distance_columns * capacity);
    kernels_->pose_distance.set("groups", selected_->groups);
    kernels_->pose_distance.set("capacity", capacity);
    kernels_->pose_distance.set(coordinate_arguments, selected_->coordinates);
    kernels_->pose_distance.set("primitives", chunk_->primitives);
    kernels_->pose_distance.set("count", chunk_->primitives_of_each);
    kernels_->pose_distance.set("columns", buffer);
    queue_.launch(kernels_->pose_distance, selected_->groups);
    queue_.read(buffer, columns);
    queue_.finish();
    return columns;
  }

  Device device_;
  std::vector<Point> points_;
  std::vector<double> weights_;
  LaunchPace pace_;  // in distances
  ChunkQueue queue_;
  std::optional<Kernels> kernels_;
  std::optional<DevicePoints> selected_;
  std::size_t slices_ = 0;
  std::size_t block_ = 1;  // slices that a work-item sums
  std::optional<Chunk> chunk_;
};

}  // namespace

std::unique_ptr<fit_search::CandidateEvaluator> device_candidate_evaluator(const Device& device,
                                                                           std::span<const Point> points,
                                                                           std::span<const double> weights) {
  return reporting_failures(device.name, [&]() -> std::unique_ptr<fit_search::CandidateEvaluator> {
    return std::make_unique<DeviceCandidateEvaluator>(device, points, weights);
  });
}

}  // namespace verisq::device

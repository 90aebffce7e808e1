/// The batches of query_batches.hpp for models with bends or set operations.
#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/program_self_test.hpp"
#include "host/device/query_batches.hpp"
#include "host/device/solid_model.hpp"
#include "host/threads/parallel.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/numbers/points.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_triangle_distance.hpp"

namespace verisq::device {
namespace {

// Cubes that are split for a query; then it is left to the host. The hardest that still pay take some hundreds. A
// graphics processor takes a tenth of a millisecond and more for each, and is not to be occupied by one launch for
// long.
constexpr cl_uint round_limit_of_processor = 4096;
constexpr cl_uint round_limit = 512;

// Lanes of a processor's work-item share a block of points about a bent primitive, one vector of which lies on one side
// of it. A graphics processor's work-item owns one point.
constexpr std::size_t points_of_vector_work_item = 512;

// The results for each primitive on its own.
constexpr std::array<std::string_view, 5> part_arguments{"part_los", "part_his", "normal_xs", "normal_ys", "normal_zs"};
// Results for points whose nearest point may lie on an edge.
constexpr std::array<std::string_view, 5> edge_arguments{"others", "edges", "foot_xs", "foot_ys", "foot_zs"};
constexpr std::array<std::string_view, 3> centre_arguments{"centre_xs", "centre_ys", "centre_zs"};

SolidPrograms tried_programs(const Device& device, const Model& model) {
  return reporting_failures(device.name, [&] {
    SolidPrograms programs{build_program(device.context, device.device, solid_vector_width(device), solid_source(model),
                                         box_primitives_memory(device, model)),
                           {}};
    if (!std::ranges::all_of(model.primitives, is_bent))
      programs.convex = point_programs(device, "", verify::has_taper(model));
    require_sound(device, programs.own, samples_of_solid(model),
                  [&] { return first_fault_of_solid(device, programs, model); });
    return programs;
  });
}

// Uploaded twice: the first primitive of a model is evaluated at all points, later ones at those to which they may be
// nearest.
cl::Buffer uploaded_alone(const Device& device, const Primitive& primitive, int scale) {
  const PrimitiveParameters parameters = primitive_parameters(primitive, scale);
  std::array both{parameters, parameters};
  return {device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof(both), both.data()};
}

struct Part {
  bool bent;
  bool tapered;
  bool holds_balls;
  cl::Buffer convex;  // PrimitiveParameters
};

// The data that all slots share.
struct SolidModel {
  SolidModel(const Device& device, const SolidPrograms& of_model, const Model& model)
      : size(device, model),
        programs(of_model),
        box_primitives(uploaded_box_primitives(device, model, size.scale_exponent)),
        root(root_cube(model, size.scale_exponent)) {
    const ModelTerms terms = model_terms(model);
    for (const Primitive& primitive : model.primitives)
      parts.push_back({is_bent(primitive), is_tapered(primitive.superquadric),
                       !is_bent(primitive) && holds_balls(terms, parts.size()),
                       uploaded_alone(device, primitive, size.scale_exponent)});
  }

  DeviceModel size;
  SolidPrograms programs;
  cl::Buffer box_primitives;
  verify::Cube root;
  std::vector<Part> parts;
};

// One chunk on its way through the device: enclosures for each convex primitive on its own, then the search.
class SolidSlot : public ChunkSlot {
 public:
  /// For the collected chunk, `directions` receives those of its points, unless null.
  SolidSlot(const Device& device, const SolidModel& model, double tolerance,
            std::optional<SolidDirections> evidence_of_directions, std::shared_ptr<std::vector<Point>> directions)
      : ChunkSlot(device, model.size),
        solid_width_(static_cast<std::size_t>(solid_vector_width(device))),
        parts_(model.parts),
        box_primitives_(model.box_primitives),
        points_{{queue_.numbers(capacity_), queue_.numbers(capacity_), queue_.numbers(capacity_)},
                queue_.numbers(capacity_)},
        bent_groups_per_block_(solid_width_ > 1 ? points_of_vector_work_item / solid_width_ : 1),
        bent_distance_(model.programs.own, kernels::embedded_bent_distance(), "bent_distance"),
        set_feet_(model.programs.own, kernels::embedded_set_bounds(), "set_feet"),
        set_bounds_(model.programs.own, kernels::embedded_set_bounds(), "set_bounds"),
        solid_distance_(model.programs.own, kernels::embedded_solid_distance(), "solid_distance"),
        evidence_of_directions_(std::move(evidence_of_directions)),
        directions_(std::move(directions)) {
    if (model.programs.convex) {
      convex_distance_.emplace(device, *model.programs.convex, queue_, capacity_, scale_.to_device(tolerance));
    }
    const double own_tolerance = std::max(scale_.to_device(tolerance), smallest_tolerance);
    for (cl::Buffer& evidence : per_primitive_) evidence = queue_.numbers(capacity_ * count_);
    views_ = views_of_primitives(per_primitive_, count_, capacity_);
    for (cl::Buffer& end : result_) end = queue_.numbers(capacity_);
    for (cl::Buffer& column : edges_) column = queue_.numbers(capacity_);
    for (cl::Buffer& column : centres_) column = queue_.numbers(capacity_ * count_);
    wanted_balls_ = queue_.numbers(capacity_ * count_);
    for (cl::Buffer& column : of_balls_) column = queue_.numbers(capacity_);
    ball_his_ = queue_.numbers(capacity_ * count_);
    for (NamedKernel* const kernel : {&bent_distance_, &set_feet_, &set_bounds_, &solid_distance_}) {
      kernel->set(coordinate_arguments, points_.coordinates);
      kernel->set("primitives", box_primitives_);
    }
    for (NamedKernel* const kernel : {&set_feet_, &set_bounds_}) {
      kernel->set(edge_arguments, edges_);
      kernel->set(centre_arguments, centres_);
    }
    for (NamedKernel* const kernel : {&set_feet_, &set_bounds_, &solid_distance_}) {
      kernel->set("stride", capacity_);
      kernel->set(enclosure_arguments, result_);
    }
    for (NamedKernel* const kernel : {&set_feet_, &solid_distance_}) {
      kernel->set("tolerance", own_tolerance);
      kernel->set(part_arguments, per_primitive_);
    }
    bent_distance_.set("groups_per_block", static_cast<cl_uint>(bent_groups_per_block_));
    listed_ = queue_.numbers(capacity_ / 2 + 1);  // as 32-bit numbers
    bent_distance_.set("listed", listed_);
    set_feet_.set("wanted_balls", wanted_balls_);
    set_bounds_.set("ball_his", ball_his_);
    solid_distance_.set("root_x", model.root.centre[0]);
    solid_distance_.set("root_y", model.root.centre[1]);
    solid_distance_.set("root_z", model.root.centre[2]);
    solid_distance_.set("root_half_width", model.root.half_width);
    solid_distance_.set("round_limit", width_ > 1 ? round_limit_of_processor : round_limit);
    for (auto& column : columns_) column.resize(capacity_);
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    for (std::size_t i = 0; i < 3; ++i) {
      fill(columns_[i], [&](std::size_t n) { return scale_.to_device(points[n][i]); });
      queue_.write(points_.coordinates[i], std::span(columns_[i]).first(padded()));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].bent ? enqueue_bent(i) : enqueue_convex(i);
    enqueue_bounds();
    solid_distance_.set("count", size_);
    width_ > 1 ? queue_.launch(solid_distance_, size_, searches_per_group) : queue_.launch(solid_distance_, size_);
    enclosures_.read(queue_, result_, size_);
    if (directions_)
      evidence_of_directions_->read(queue_, views_, {edges_[1], {edges_[2], edges_[3], edges_[4]}}, size_);
    queue_.flush();
  }

  // There are no certificates. Precondition: finished.
  void certify(std::span<const Enclosure> enclosures, std::vector<Certificate>& /*certificates*/) const {
    if (!directions_) return;
    directions_->clear();
    for (std::size_t n = 0; n < size_; ++n) {
      const Enclosure distance{scale_.to_device(enclosures[n].lo), scale_.to_device(enclosures[n].hi)};
      directions_->push_back((*evidence_of_directions_)(n, {columns_[0][n], columns_[1][n], columns_[2][n]}, distance));
    }
  }

 private:
  static constexpr double smallest_tolerance = 0x1p-40;  // cubes are not split below
  static constexpr std::size_t searches_per_group = 16;  // long work-items: small groups keep cores busy

  // Each primitive on its own: results of other primitives do not matter to a tree of set operations.
  void enqueue_convex(std::size_t i) { enqueue_convex(points_, {parts_[i].convex, 0, parts_[i].tapered}, views_[i]); }

  void enqueue_convex(const ConvexDistance::Points& points, const ConvexDistance::Primitive& primitive,
                      const EvidenceBuffers& evidence) {
    convex_distance_->enqueue_distances(queue_, points, primitive, groups(), evidence);
    convex_distance_->enqueue_depths(queue_, points, primitive, groups(), evidence);
  }

  void enqueue_bent(std::size_t i) {
    const std::size_t vectors = padded() / solid_width_;
    bent_distance_.set("groups", vectors);
    bent_distance_.set("index", i);
    bent_distance_.set(evidence_arguments, views_[i]);
    // A vector work-item with a block is long: one a work-group lets the cores share them evenly.
    const std::size_t blocks = (vectors + bent_groups_per_block_ - 1) / bent_groups_per_block_;
    bent_groups_per_block_ > 1 ? queue_.launch(bent_distance_, blocks, 1) : queue_.launch(bent_distance_, blocks);
  }

  // The bounds without a search: feet are proposed, balls about them proven, then bounds.
  void enqueue_bounds() {
    const std::size_t vectors = padded() / solid_width_;
    set_feet_.set("groups", vectors);
    queue_.launch(set_feet_, vectors);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (parts_[i].holds_balls) enqueue_balls(i);
    set_bounds_.set("groups", vectors);
    queue_.launch(set_bounds_, vectors);
  }

  // Processes the centres of balls as points, if one is needed. Of the results the upper ends are kept.
  void enqueue_balls(std::size_t i) {
    const auto window = [&](const cl::Buffer& column) { return windows(column, count_, capacity_)[i]; };
    of_balls_[1] = window(ball_his_);
    const ConvexDistance::Points centres{{window(centres_[0]), window(centres_[1]), window(centres_[2])},
                                         window(wanted_balls_)};
    enqueue_convex(centres, {parts_[i].convex, 1, parts_[i].tapered}, of_balls_);
  }

  std::size_t solid_width_;  // of the kernels of the model's own program
  // Kernels do not keep the buffers that they are given.
  std::vector<Part> parts_;
  cl::Buffer box_primitives_;
  ConvexDistance::Points points_;
  std::optional<ConvexDistance> convex_distance_;  // nothing where all are bent
  std::size_t bent_groups_per_block_;
  cl::Buffer listed_;
  NamedKernel bent_distance_;
  NamedKernel set_feet_;
  NamedKernel set_bounds_;
  NamedKernel solid_distance_;
  EvidenceBuffers per_primitive_;  // primitive by primitive
  std::array<cl::Buffer, 5> edges_;
  // Primitive by primitive: centres of balls, infinity where one is wanted, and upper ends of their signed distances.
  std::array<cl::Buffer, 3> centres_;
  cl::Buffer wanted_balls_;
  cl::Buffer ball_his_;
  EvidenceBuffers of_balls_;
  std::array<cl::Buffer, 2> result_;
  std::vector<EvidenceBuffers> views_;  // windows of those, one for each primitive
  std::array<std::vector<double>, 3> columns_;
  std::optional<SolidDirections> evidence_of_directions_;  // where directions are wanted
  std::shared_ptr<std::vector<Point>> directions_;
};

std::unique_ptr<Batch<Point>> batch_of(const Device& device, const SolidPrograms& programs, const Model& model,
                                       double tolerance, const std::shared_ptr<std::vector<Point>>& directions) {
  return reporting_failures(device.name, [&] {
    const SolidModel uploaded(device, programs, model);
    std::optional<SolidDirections> evidence;
    if (directions) evidence.emplace(model, uploaded.size.scale_exponent, uploaded.size.chunk_size);
    std::vector<SolidSlot> slots;
    slots.reserve(2);
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, uploaded, tolerance, evidence, directions);
    return std::unique_ptr<Batch<Point>>(
        std::make_unique<ChunkPipeline<Point, SolidSlot>>(device.name, uploaded.size.chunk_size, std::move(slots)));
  });
}

}  // namespace

std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const Model& model, double tolerance) {
  return batch_of(device, tried_programs(device, model), model, tolerance, nullptr);
}

std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const SolidPrograms& programs, const Model& model,
                                          double tolerance) {
  return batch_of(device, programs, model, tolerance, nullptr);
}

namespace {

DirectedBatch directed_solid_batch(const Device& device, const Model& model, double tolerance) {
  const auto directions = std::make_shared<std::vector<Point>>();
  DirectedBatch batch{nullptr, directions};
  batch.points = batch_of(device, tried_programs(device, model), model, tolerance, directions);
  return batch;
}

using verify::TriangleBranchAndBound;
using Answer = TriangleBranchAndBound::Answer;

constexpr std::size_t largest_chunk = rows_side_by_side;  // each asks for many points
constexpr std::size_t most_points = 1U << 16U;            // of a triangle; then it is left to the host
constexpr double share_of_points = 0.25;                  // of the tolerance, where a point takes a search
constexpr std::size_t triangles_a_task = 64;              // of a thread

class SolidTriangleBatch final : public Batch<Triangle> {
 public:
  SolidTriangleBatch(DirectedBatch batch, const Model& model, double tolerance, std::function<bool()> stop)
      : points_(std::move(batch.points)),
        directions_(std::move(batch.directions)),
        extent_(verify::extent_of(model)),
        tolerance_(tolerance),
        stop_(std::move(stop)) {}

  [[nodiscard]] std::size_t capacity() const override { return largest_chunk; }
  [[nodiscard]] double device_seconds() const override { return points_->device_seconds(); }

  void submit(std::span<const Triangle> queries) override { waiting_.emplace_back(queries.begin(), queries.end()); }

  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) override {
    const std::vector<Triangle> triangles = std::move(waiting_.front());
    waiting_.pop_front();
    certificates.clear();
    std::vector<TriangleBranchAndBound> searches;
    searches.reserve(triangles.size());
    for (const Triangle& triangle : triangles) searches.emplace_back(triangle, extent_, tolerance_);
    search(searches);
    enclosures.clear();
    for (const TriangleBranchAndBound& each : searches) enclosures.push_back(each.enclosure());
  }

  void discard() override {
    waiting_.clear();
    points_->discard();
  }

 private:
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

  void search(std::vector<TriangleBranchAndBound>& searches) {
    std::vector<TriangleBranchAndBound*> asking;
    asking.reserve(searches.size());
    for (TriangleBranchAndBound& each : searches) asking.push_back(&each);
    while (!asking.empty() && !stopped()) {
      answer(asking);
      std::erase_if(
          asking, [](const TriangleBranchAndBound* each) { return each->finished() || each->asked() >= most_points; });
    }
  }

  // Each task with its points: those that its triangles request, one triangle after the other.
  struct Task {
    std::vector<Point> points;
    std::vector<std::size_t> counts;
  };

  void answer(std::span<TriangleBranchAndBound* const> asking) {
    std::vector<Task> tasks((asking.size() + triangles_a_task - 1) / triangles_a_task);
    const auto triangles_of = [&](std::size_t task) {
      const std::size_t first = task * triangles_a_task;
      return asking.subspan(first, std::min(triangles_a_task, asking.size() - first));
    };
    in_parallel(tasks.size(), [&](std::size_t i) {
      for (TriangleBranchAndBound* const each : triangles_of(i)) {
        const std::size_t before = tasks[i].points.size();
        each->ask(tasks[i].points);
        tasks[i].counts.push_back(tasks[i].points.size() - before);
      }
    });
    std::vector<Point> points;
    std::vector<std::size_t> firsts;
    for (const Task& task : tasks) {
      firsts.push_back(points.size());
      points.insert(points.end(), task.points.begin(), task.points.end());
    }
    const std::vector<Answer> answers = answers_to(points);
    in_parallel(tasks.size(), [&](std::size_t i) {
      std::size_t first = firsts[i];
      const auto triangles = triangles_of(i);
      for (std::size_t n = 0; n < triangles.size(); ++n) {
        triangles[n]->answer(std::span(answers).subspan(first, tasks[i].counts[n]));
        first += tasks[i].counts[n];
      }
    });
  }

  // Two chunks in flight: one is prepared while the other is worked on.
  [[nodiscard]] std::vector<Answer> answers_to(const std::span<const Point> asked) {
    std::span<const Point> points = asked;
    std::vector<Answer> answers;
    answers.reserve(points.size());
    std::vector<Enclosure> found;
    std::vector<Certificate> none;
    std::size_t in_flight = 0;
    const auto collect = [&] {
      points_->collect(found, none);
      for (std::size_t i = 0; i < found.size(); ++i) answers.push_back({found[i], (*directions_)[i]});
      --in_flight;
    };
    while (!points.empty()) {
      if (in_flight == 2) collect();
      const std::size_t count = std::min(points_->capacity(), points.size());
      points_->submit(points.first(count));
      points = points.subspan(count);
      ++in_flight;
    }
    while (in_flight > 0) collect();
    for (std::size_t i = 0; i < answers.size(); ++i)
      if (!verify::is_finite(asked[i])) answers[i] = {{-infinity, infinity}};
    return answers;
  }

  std::unique_ptr<Batch<Point>> points_;
  std::shared_ptr<const std::vector<Point>> directions_;
  verify::SolidExtent extent_;
  double tolerance_;
  std::function<bool()> stop_;
  std::deque<std::vector<Triangle>> waiting_;
};

}  // namespace

std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model, double tolerance,
                                                      const std::function<bool()>& stop) {
  return std::make_unique<SolidTriangleBatch>(directed_solid_batch(device, model, share_of_points * tolerance), model,
                                              tolerance, stop);
}

}  // namespace verisq::device

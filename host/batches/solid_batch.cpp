/// This file implements the streaming of points through the branch and bound of a device.
#include "host/batches/solid_batch.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_slot.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/kernel_arguments.hpp"
#include "host/batches/model_source.hpp"
#include "host/batches/model_terms.hpp"
#include "host/batches/primitive_parameters.hpp"
#include "host/batches/solid_directions.hpp"
#include "host/batches/solid_model.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

// Cubes that are split for a query; then it is left to the host. The hardest that still pay take some hundreds. A
// graphics processor takes a tenth of a millisecond and more for each, and is not to be occupied by one launch for
// long.
constexpr cl_uint round_limit_of_processor = 4096;
constexpr cl_uint round_limit = 512;

// Lanes of a processor's work-item share a block of points about a bent primitive, one vector of which lies on one side
// of it; a graphics processor's work-item owns one point.
constexpr std::size_t block_points_of_vector_work_item = 512;

// What is known of each primitive on its own.
constexpr std::array<std::string_view, 5> part_arguments{"part_los", "part_his", "normal_xs", "normal_ys", "normal_zs"};
// Of points whose nearest one may lie on an edge.
constexpr std::array<std::string_view, 5> edge_arguments{"others", "edges", "foot_xs", "foot_ys", "foot_zs"};
constexpr std::array<std::string_view, 3> centre_arguments{"centre_xs", "centre_ys", "centre_zs"};

cl::Program solid_program(const Device& device, const Model& model) {
  return build_program(device.context, device.device, solid_vector_width(device), solid_source(model),
                       box_primitives_memory(device, model));
}

// Twice: the first of a model is evaluated at all points, later ones at those that they may be nearest to.
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

// What all slots share.
struct SolidModel {
  SolidModel(const Device& device, const Model& model)
      : size(device, model),
        program(solid_program(device, model)),
        box_primitives(uploaded_box_primitives(device, model, size.scale_exponent)),
        root(root_cube(model, size.scale_exponent)) {
    const ModelTerms terms = model_terms(model);
    for (const Primitive& primitive : model.primitives)
      parts.push_back({is_bent(primitive), is_tapered(primitive.superquadric),
                       !is_bent(primitive) && holds_balls(terms, parts.size()),
                       uploaded_alone(device, primitive, size.scale_exponent)});
    if (!std::ranges::all_of(parts, &Part::bent)) convex_programs = point_programs(device, "", size.has_tapered());
  }

  DeviceModel size;
  cl::Program program;
  std::optional<PointPrograms> convex_programs;  // nothing where all are bent
  cl::Buffer box_primitives;
  verify::Cube root;
  std::vector<Part> parts;
};

// One chunk on its way through the device: enclosures for each convex primitive on its own, then the search.
class SolidSlot : public ChunkSlot {
 public:
  /// Of the chunk that is collected, `directions` get those of its points, unless null.
  SolidSlot(const Device& device, const SolidModel& model, double tolerance,
            std::optional<SolidDirections> evidence_of_directions, std::shared_ptr<std::vector<Point>> directions)
      : ChunkSlot(device, model.size),
        solid_width_(static_cast<std::size_t>(solid_vector_width(device))),
        parts_(model.parts),
        box_primitives_(model.box_primitives),
        points_{{queue_.numbers(capacity_), queue_.numbers(capacity_), queue_.numbers(capacity_)},
                queue_.numbers(capacity_)},
        bent_groups_per_block_(solid_width_ > 1 ? block_points_of_vector_work_item / solid_width_ : 1),
        bent_distance_(model.program, kernels::embedded_bent_distance(), "bent_distance"),
        set_feet_(model.program, kernels::embedded_set_bounds(), "set_feet"),
        set_bounds_(model.program, kernels::embedded_set_bounds(), "set_bounds"),
        solid_distance_(model.program, kernels::embedded_solid_distance(), "solid_distance"),
        evidence_of_directions_(std::move(evidence_of_directions)),
        directions_(std::move(directions)) {
    if (model.convex_programs) {
      convex_distance_.emplace(device, *model.convex_programs, queue_, capacity_, scale_.to_device(tolerance));
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

  // No certificates. Precondition: finished.
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

  // On its own: what was found for other primitives says nothing about a tree of set operations.
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

  // What needs no search: feet are proposed, balls about them proven, then bounds.
  void enqueue_bounds() {
    const std::size_t vectors = padded() / solid_width_;
    set_feet_.set("groups", vectors);
    queue_.launch(set_feet_, vectors);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (parts_[i].holds_balls) enqueue_balls(i);
    set_bounds_.set("groups", vectors);
    queue_.launch(set_bounds_, vectors);
  }

  // Centres of balls as points, where one is wanted. Of what is found about them their upper ends are kept.
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

std::unique_ptr<Batch<Point>> batch_of(const Device& device, const Model& model, double tolerance,
                                       const std::shared_ptr<std::vector<Point>>& directions) {
  return reporting_failures(device.name, [&] {
    const SolidModel uploaded(device, model);
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
  return batch_of(device, model, tolerance, nullptr);
}

DirectedBatch directed_solid_batch(const Device& device, const Model& model, double tolerance) {
  const auto directions = std::make_shared<std::vector<Point>>();
  DirectedBatch batch{nullptr, directions};
  batch.points = batch_of(device, model, tolerance, directions);
  return batch;
}

}  // namespace verisq::device

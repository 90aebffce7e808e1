/// This file implements query_batches.hpp.
#include "host/device/query_batches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/program_self_test.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/certified_distance.hpp"

namespace verisq::device {
namespace {

constexpr std::array<std::string_view, 3> escape_arguments{"escape_xs", "escape_ys", "escape_zs"};

}  // namespace

PointKernels::PointKernels(const Device& device, const PointPrograms& programs, const DeviceModel& model,
                           ChunkQueue& queue, double tolerance)
    : count_(model.count),
      primitives_(model.primitives),
      tapered_(model.tapered),
      points_{{queue.numbers(model.chunk_size), queue.numbers(model.chunk_size), queue.numbers(model.chunk_size)},
              queue.numbers(model.chunk_size)},
      convex_distance_(device, programs, queue, model.chunk_size, tolerance),
      union_distance_(programs.untapered, kernels::embedded_point_sources(), "union_distance") {
  const std::size_t capacity = model.chunk_size;
  for (cl::Buffer& evidence : per_primitive_) evidence = queue.numbers(capacity * count_);
  ends_[0] = count_ > 1 ? queue.numbers(capacity) : per_primitive_[0];
  ends_[1] = count_ > 1 ? queue.numbers(capacity) : per_primitive_[1];
  for (cl::Buffer& escape : escapes_) escape = queue.numbers(count_ > 1 ? capacity : 1);

  union_distance_.set("stride", capacity);
  union_distance_.set(coordinate_arguments, points_.coordinates);
  union_distance_.set("primitives", primitives_);
  union_distance_.set("count", count_);
  union_distance_.set(evidence_arguments, per_primitive_);
  union_distance_.set(union_arguments, ends_);
  union_distance_.set(escape_arguments, escapes_);
  views_ = views_of_primitives(per_primitive_, count_, capacity);
}

void PointKernels::enqueue(ChunkQueue& queue, std::size_t groups) {
  enqueue_distances(queue, groups);
  enqueue_depths(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_outside(ChunkQueue& queue, std::size_t groups) {
  enqueue_distances(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_inside(ChunkQueue& queue, std::size_t groups) {
  enqueue_depths(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_distances(ChunkQueue& queue, std::size_t groups) {
  for (std::size_t index = 0; index < count_; ++index)
    convex_distance_.enqueue_distances(queue, points_, {primitives_, index, tapered_[index]}, groups, views_[index]);
}

void PointKernels::enqueue_depths(ChunkQueue& queue, std::size_t groups) {
  for (std::size_t index = 0; index < count_; ++index)
    convex_distance_.enqueue_depths(queue, points_, {primitives_, index, tapered_[index]}, groups, views_[index]);
}

void PointKernels::enqueue_union(ChunkQueue& queue, std::size_t groups) {
  if (count_ == 1) return;
  union_distance_.set("groups", groups);
  queue.launch(union_distance_, groups);
}

namespace {

bool usable(const Point& v) {
  return std::all_of(v.begin(), v.end(), [](double c) { return std::isfinite(c); }) &&
         std::any_of(v.begin(), v.end(), [](double c) { return c != 0.0; });
}

/// A vector along `v` whose length is the distance: the point less it is the closest one (see Certificate). Kernels
/// give normals any length.
Point as_long_as(double distance, const Point& v) {
  const double scale = distance / std::hypot(v[0], v[1], v[2]);
  const Point scaled{scale * v[0], scale * v[1], scale * v[2]};
  return distance > 0.0 && usable(scaled) ? scaled : v;
}

}  // namespace

CertificateAssembly::CertificateAssembly(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const verify::PosedSuperquadric proof(primitive);
    const Point origin = verify::rounded(verify::midpoint(proof.motion().translation));
    spheres_.push_back({origin, proof.radius().upper().to_double(verify::Direction::up)});
  }
}

// Computed to nearest, with room for rounding: in close cases the normal is kept.
bool CertificateAssembly::clear_of_sphere(const Point& point, double distance, const Sphere& sphere) {
  const double from_centre =
      std::hypot(point[0] - sphere.centre[0], point[1] - sphere.centre[1], point[2] - sphere.centre[2]);
  return from_centre - sphere.radius > distance + 1e-12 * (from_centre + sphere.radius);
}

Certificate CertificateAssembly::operator()(const Point& point, const Enclosure& distance,
                                            const Evidence& evidence) const {
  const auto& primitives = evidence.primitives;
  const auto nearest =
      std::min_element(primitives.begin(), primitives.end(), [](const auto& a, const auto& b) { return a.hi < b.hi; });
  const auto first = static_cast<std::uint32_t>(nearest - primitives.begin());
  const Point normal = usable(nearest->normal) ? as_long_as(nearest->hi, nearest->normal) : Point{};
  Certificate certificate{{{first, normal}}, {}};
  if (distance.lo > 0.0) {
    for (std::uint32_t i = 0; i < primitives.size(); ++i) {
      if (i == first || !usable(primitives[i].normal) || clear_of_sphere(point, distance.lo, spheres_[i])) continue;
      certificate.normals.push_back({i, primitives[i].normal});
    }
  } else if (primitives.size() > 1 && std::isfinite(distance.lo) && usable(evidence.escape)) {
    certificate.escape = evidence.escape;
  }
  return certificate;
}

Certificate certificate_of(const TriangleEvidence& evidence) {
  const auto nearest = std::min_element(evidence.begin(), evidence.end(),
                                        [](const auto& a, const auto& b) { return a.bounds.hi < b.bounds.hi; });
  const auto first = static_cast<std::uint32_t>(nearest - evidence.begin());
  Certificate certificate{{{first, nearest->bounds.normal}}, {}, nearest->weights};
  for (std::uint32_t i = 0; i < evidence.size(); ++i) {
    if (i != first && usable(evidence[i].bounds.normal)) certificate.normals.push_back({i, evidence[i].bounds.normal});
  }
  return certificate;
}

namespace {

constexpr std::size_t numbers_per_primitive = 4;  // of its evidence: upper end and normal

// One chunk on its way through the device.
class PointSlot : public ChunkSlot {
 public:
  // `assembly`: nothing unless certificates are requested.
  PointSlot(const Device& device, const PointPrograms& programs, const DeviceModel& model, double tolerance,
            std::optional<CertificateAssembly> assembly)
      : ChunkSlot(device, model),
        assembly_(std::move(assembly)),
        kernels_(device, programs, model, queue_, scale_.to_device(tolerance)) {
    for (auto& column : columns_) column.resize(capacity_);
    if (assembly_) evidence_.resize(capacity_ * (numbers_per_primitive * count_ + 3));
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    for (std::size_t i = 0; i < 3; ++i) {
      fill(columns_[i], [&](std::size_t n) { return scale_.to_device(points[n][i]); });
      queue_.write(kernels_.coordinates()[i], std::span(columns_[i]).first(padded()));
    }
    kernels_.enqueue(queue_, groups());
    enclosures_.read(queue_, kernels_.ends(), size_);
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
  }

  // Fills `certificates` if they were requested. Precondition: finished.
  void certify(std::span<const Enclosure> enclosures, std::vector<Certificate>& certificates) const {
    if (!assembly_) return;
    Evidence evidence;
    evidence.primitives.resize(count_);
    for (std::size_t n = 0; n < size_; ++n) {
      for (std::size_t index = 0; index < count_; ++index) {
        const double* const column = evidence_.data() + index * numbers_per_primitive * capacity_ + n;
        evidence.primitives[index] = {scale_.to_model(column[0]), in_model_units(column + capacity_)};
      }
      evidence.escape = in_model_units(evidence_.data() + count_ * numbers_per_primitive * capacity_ + n);
      const Point point{scale_.to_model(columns_[0][n]), scale_.to_model(columns_[1][n]),
                        scale_.to_model(columns_[2][n])};
      certificates.push_back((*assembly_)(point, enclosures[n], evidence));
    }
  }

 private:
  // Upper ends and normals of every primitive, then the escapes.
  void read_evidence() {
    double* column = evidence_.data();
    const auto read = [&](const cl::Buffer& buffer) {
      queue_.read(buffer, {column, size_});
      column += capacity_;
    };
    for (const EvidenceBuffers& evidence : kernels_.evidence())
      for (std::size_t i = 1; i < evidence.size(); ++i) read(evidence[i]);
    if (count_ > 1)
      for (const cl::Buffer& escape : kernels_.escapes()) read(escape);
  }

  [[nodiscard]] Point in_model_units(const double* x) const {
    return {scale_.to_model(x[0]), scale_.to_model(x[capacity_]), scale_.to_model(x[2 * capacity_])};
  }

  std::optional<CertificateAssembly> assembly_;
  PointKernels kernels_;
  std::array<std::vector<double>, 3> columns_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

std::unique_ptr<Batch<Point>> pipeline(const Device& device, const PointPrograms& programs, const Model& model,
                                       const DeviceModel& uploaded, double tolerance, bool certificates) {
  std::optional<CertificateAssembly> assembly;
  if (certificates) assembly.emplace(model);
  std::vector<PointSlot> slots;
  slots.reserve(2);
  for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, programs, uploaded, tolerance, assembly);
  auto batch = std::make_unique<ChunkPipeline<Point, PointSlot>>(device.name, uploaded.chunk_size, std::move(slots));
  batch->warm_up({far_away(uploaded), 0.0, 0.0});
  return batch;
}

}  // namespace

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const Model& model, double tolerance,
                                          bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    return pipeline(device, point_programs(device, uploaded.memory, uploaded.has_tapered()), model, uploaded, tolerance,
                    certificates);
  });
}

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const cl::Program& program, const Model& model,
                                          double tolerance, bool certificates) {
  return reporting_failures(device.name, [&] {
    return pipeline(device, program, model, DeviceModel(device, model), tolerance, certificates);
  });
}

namespace {

constexpr std::size_t coordinates = 9;  // of a triangle: x, y, z of each corner

// The outputs of triangle_distance for one primitive.
constexpr std::array<std::string_view, 7> output_arguments{"los",       "his",       "normal_xs", "normal_ys",
                                                           "normal_zs", "weights_1", "weights_2"};
constexpr std::size_t outputs = output_arguments.size();
using Outputs = std::array<cl::Buffer, outputs>;

// One chunk on its way through the device.
class TriangleSlot : public ChunkSlot {
 public:
  TriangleSlot(const Device& device, const cl::Program& program, const DeviceModel& model, bool certificates)
      : ChunkSlot(device, model),
        primitives_(model.primitives),
        triangle_distance_(program, kernels::embedded_triangle_sources(), "triangle_distance"),
        union_distance_(program, kernels::embedded_triangle_sources(), "triangle_union_distance"),
        corners_(queue_.numbers(coordinates * capacity_)),
        nearest_(queue_.numbers(capacity_)),
        views_(count_),
        columns_(coordinates * capacity_) {
    for (std::size_t i = 0; i < outputs; ++i) {
      per_primitive_[i] = queue_.numbers(capacity_ * count_);
      const std::vector<cl::Buffer> columns = windows(per_primitive_[i], count_, capacity_);
      for (std::size_t index = 0; index < count_; ++index) views_[index][i] = columns[index];
    }
    for (std::size_t i = 0; i < 2; ++i) result_[i] = count_ > 1 ? queue_.numbers(capacity_) : per_primitive_[i];
    triangle_distance_.set("stride", capacity_);
    triangle_distance_.set("corners", corners_);
    triangle_distance_.set("primitives", primitives_);
    triangle_distance_.set("nearest", nearest_);
    union_distance_.set("stride", capacity_);
    union_distance_.set("count", count_);
    union_distance_.set(enclosure_arguments, std::array{per_primitive_[0], per_primitive_[1]});
    union_distance_.set(union_arguments, result_);
    if (certificates) evidence_.resize((outputs - 1) * count_ * capacity_);
  }

  void start(std::span<const Triangle> triangles) {
    size_ = triangles.size();
    upload(triangles);
    for (std::size_t index = 0; index < count_; ++index) launch_primitive(index);
    if (count_ > 1) {
      union_distance_.set("groups", groups());
      queue_.launch(union_distance_, groups());
    }
    enclosures_.read(queue_, result_, size_);
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
  }

  // Fills `certificates` if they were requested. Precondition: finished.
  void certify(std::span<const Enclosure> /*enclosures*/, std::vector<Certificate>& certificates) const {
    if (evidence_.empty()) return;
    TriangleEvidence evidence(count_);
    for (std::size_t n = 0; n < size_; ++n) {
      for (std::size_t index = 0; index < count_; ++index) {
        const double* const first = evidence_.data() + index * (outputs - 1) * capacity_ + n;
        const auto column = [&](std::size_t i) { return first[i * capacity_]; };
        const auto length = [&](std::size_t i) { return scale_.to_model(column(i)); };
        evidence[index] = {{length(0), {length(1), length(2), length(3)}}, {column(4), column(5)}};
      }
      certificates.push_back(certificate_of(evidence));
    }
  }

 private:
  void upload(std::span<const Triangle> triangles) {
    for (std::size_t c = 0; c < coordinates; ++c) {
      const std::span column = std::span(columns_).subspan(c * capacity_, padded());
      fill(column, [&](std::size_t n) { return scale_.to_device(triangles[n][c / 3][c % 3]); });
      queue_.write(corners_, column, c * capacity_);
    }
  }

  void launch_primitive(std::size_t index) {
    triangle_distance_.set("groups", groups());
    triangle_distance_.set("index", index);
    triangle_distance_.set(output_arguments, views_[index]);
    queue_.launch(triangle_distance_, groups());
  }

  // All outputs but the lower ends.
  void read_evidence() {
    double* column = evidence_.data();
    for (const Outputs& view : views_) {
      for (std::size_t i = 1; i < outputs; ++i, column += capacity_) queue_.read(view[i], {column, size_});
    }
  }

  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  NamedKernel triangle_distance_;
  NamedKernel union_distance_;
  cl::Buffer corners_;
  cl::Buffer nearest_;
  Outputs per_primitive_;
  std::array<cl::Buffer, 2> result_;
  std::vector<Outputs> views_;  // windows of those, one for each primitive
  std::vector<double> columns_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

std::unique_ptr<Batch<Triangle>> batch_of(const Device& device, const cl::Program& program, const DeviceModel& uploaded,
                                          bool certificates) {
  std::vector<TriangleSlot> slots;
  slots.reserve(2);
  for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, uploaded, certificates);
  auto pipeline =
      std::make_unique<ChunkPipeline<Triangle, TriangleSlot>>(device.name, uploaded.chunk_size, std::move(slots));
  const double x = far_away(uploaded);
  pipeline->warm_up({Point{x, 0.0, 0.0}, Point{x, x, 0.0}, Point{x, 0.0, x}});
  return pipeline;
}

}  // namespace

std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const Model& model, bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_triangle_sources(), uploaded.memory);
    require_sound(device, program, "kernels of triangles", [&] { return first_fault_of_triangles(device, program); });
    return batch_of(device, program, uploaded, certificates);
  });
}

std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const cl::Program& program, const Model& model,
                                                bool certificates) {
  return reporting_failures(device.name,
                            [&] { return batch_of(device, program, DeviceModel(device, model), certificates); });
}

namespace {

constexpr std::size_t numbers_per_pose = 12;  // the rotation row by row, the translation

// One chunk on its way through the device.
class PoseSlot : public ChunkSlot {
 public:
  PoseSlot(const Device& device, const cl::Program& program, const DeviceModel& both, std::size_t primitives_of_a)
      : ChunkSlot(device, both),
        primitives_of_a_(primitives_of_a),
        primitives_(both.primitives),
        pair_distance_(program, kernels::embedded_pair_sources(), "pair_distance"),
        poses_(queue_.numbers(numbers_per_pose * capacity_)),
        result_{queue_.numbers(capacity_), queue_.numbers(capacity_)},
        columns_(numbers_per_pose * capacity_) {
    pair_distance_.set("stride", capacity_);
    pair_distance_.set("poses", poses_);
    pair_distance_.set("primitives", primitives_);
    pair_distance_.set(enclosure_arguments, result_);
  }

  void start(std::span<const Pose> poses) {
    size_ = poses.size();
    upload(poses);
    pair_distance_.set("groups", groups());
    for (std::size_t a = 0; a < primitives_of_a_; ++a) {
      for (std::size_t b = primitives_of_a_; b < count_; ++b) {
        pair_distance_.set("index_a", a);
        pair_distance_.set("index_b", b);
        pair_distance_.set("first", a == 0 && b == primitives_of_a_ ? 1U : 0U);
        queue_.launch(pair_distance_, groups());
      }
    }
    enclosures_.read(queue_, result_, size_);
    queue_.flush();
  }

 private:
  void upload(std::span<const Pose> poses) {
    std::vector<std::array<double, 9>> rotations;
    for (const Pose& pose : poses) rotations.push_back(rotation_matrix(pose.quaternion));
    for (std::size_t i = 0; i < numbers_per_pose; ++i) {
      const std::span column = std::span(columns_).subspan(i * capacity_, padded());
      if (i < 9) {
        fill(column, [&](std::size_t n) { return rotations[n][i]; });
      } else {
        fill(column, [&](std::size_t n) { return scale_.to_device(poses[n].translation[i - 9]); });
      }
      queue_.write(poses_, column, i * capacity_);
    }
  }

  std::size_t primitives_of_a_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  NamedKernel pair_distance_;
  cl::Buffer poses_;
  std::array<cl::Buffer, 2> result_;
  std::vector<double> columns_;
};

std::unique_ptr<Batch<Pose>> batch_of(const Device& device, const cl::Program& program, const DeviceModel& both,
                                      std::size_t primitives_of_a) {
  std::vector<PoseSlot> slots;
  slots.reserve(2);
  for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, both, primitives_of_a);
  auto pipeline = std::make_unique<ChunkPipeline<Pose, PoseSlot>>(device.name, both.chunk_size, std::move(slots));
  pipeline->warm_up(Pose{{far_away(both), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
  return pipeline;
}

}  // namespace

std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const Model& a, const Model& b, PoseDistances& of_host) {
  return reporting_failures(device.name, [&] {
    const DeviceModel both(device, joined(a, b));
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_pair_sources(), both.memory);
    require_sound(device, program, "kernels of pairs", [&] { return first_fault_of_poses(device, program, of_host); });
    return batch_of(device, program, both, a.primitives.size());
  });
}

std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const cl::Program& program, const Model& a,
                                        const Model& b) {
  return reporting_failures(
      device.name, [&] { return batch_of(device, program, DeviceModel(device, joined(a, b)), a.primitives.size()); });
}

}  // namespace verisq::device

/// This file implements the streaming of points through a device.
#include "host/device/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "host/device/certificate_assembly.hpp"
#include "host/device/primitive_parameters.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

// Long against a launch, short against a mesh, so that work overlaps; other devices want more work-items at a time.
constexpr std::size_t points_per_processor_chunk = 1U << 14U;
constexpr std::size_t points_per_chunk = 1U << 18U;
constexpr std::size_t primitives_per_full_chunk = 8;  // larger models take smaller chunks: memory stays bounded
constexpr std::size_t smallest_chunk = 1U << 10U;
constexpr std::size_t chunk_alignment = 1U << 10U;  // keeps windows of device buffers aligned for any device
constexpr std::size_t scratch_per_point = 8;        // SCRATCH_SIZE in kernels/interior_depth.cl

// Interior search: lanes of a processor's work-item share a block of points, so that none idles; a graphics
// processor's work-item owns one point.
constexpr std::size_t block_points_of_vector_work_item = 512;

// The branch and bound's limit: below this width, relative to the largest semi-axis, it would take ever more cells.
constexpr double smallest_interior_tolerance = 0x1p-30;

constexpr std::size_t group_size = 32;

constexpr std::size_t numbers_per_primitive = 4;  // of its evidence: upper end and normal

constexpr int largest_scaled_exponent = 300;
constexpr double far_away = 0x1p20;  // in units of the largest semi-axis, about

std::size_t chunk_points(std::size_t primitives, int vector_width) {
  const std::size_t full = vector_width > 1 ? points_per_processor_chunk : points_per_chunk;
  const std::size_t wanted =
      std::max(smallest_chunk, full * primitives_per_full_chunk / std::max(primitives, primitives_per_full_chunk));
  return wanted - wanted % chunk_alignment;
}

// x 2^exponent rounded down where it underflows or overflows; `factor` is 2^exponent.
double scaled_down(double x, double factor) {
  const double y = x * factor;
  const double back = y / factor;
  if (back == x || std::isnan(x)) return y;
  if (std::isinf(y)) return y > 0.0 ? std::numeric_limits<double>::max() : y;
  return back > x ? std::nextafter(y, -std::numeric_limits<double>::infinity()) : y;
}
double scaled_up(double x, double factor) {
  return -scaled_down(-x, factor);
}

// One chunk on its way through the device: its own queue, so that its transfers overlap with the other's kernels.
class Slot {
 public:
  Slot(const Device& device, const cl::Buffer& primitives, std::size_t count, std::size_t capacity, double tolerance,
       int scale, bool certificates)
      : width_(device.vector_width),
        capacity_(capacity),
        count_(count),
        factor_(std::ldexp(1.0, scale)),
        queue_(device.context, device.device, CL_QUEUE_PROFILING_ENABLE),
        primitives_(primitives),
        point_distance_(device.program, "point_distance"),
        interior_depth_(device.program, "interior_depth"),
        union_distance_(device.program, "union_distance") {
    const auto numbers = [&](std::size_t n) {
      const cl::Buffer buffer(device.context, CL_MEM_READ_WRITE, n * sizeof(double));
      queue_.enqueueFillBuffer(buffer, 0.0, 0, n * sizeof(double));  // otherwise the first launches wait for memory
      return buffer;
    };
    for (int i = 0; i < 3; ++i) coordinates_[i] = numbers(capacity);
    for (int i = 0; i < 5; ++i) per_primitive_[i] = numbers(capacity * count);
    nearest_ = numbers(capacity);
    scratch_ = numbers(capacity * scratch_per_point);
    result_[0] = count > 1 ? numbers(capacity) : per_primitive_[0];
    result_[1] = count > 1 ? numbers(capacity) : per_primitive_[1];
    for (cl::Buffer& escape : escape_) escape = numbers(count > 1 ? capacity : 1);
    groups_per_block_ = width_ > 1 ? block_points_of_vector_work_item / width_ : 1;

    bind_coordinates(point_distance_, 1);
    point_distance_.setArg(4, primitives_);
    point_distance_.setArg(6, nearest_);
    bind_coordinates(interior_depth_, 2);
    interior_depth_.setArg(1, static_cast<cl_uint>(groups_per_block_));
    interior_depth_.setArg(5, primitives_);
    interior_depth_.setArg(7, tolerance);
    interior_depth_.setArg(8, scratch_);
    bind_coordinates(union_distance_, 2);
    union_distance_.setArg(1, static_cast<cl_ulong>(capacity));
    union_distance_.setArg(5, primitives_);
    union_distance_.setArg(6, static_cast<cl_uint>(count));
    for (cl_uint i = 0; i < 5; ++i) union_distance_.setArg(7 + i, per_primitive_[i]);
    union_distance_.setArg(12, result_[0]);
    union_distance_.setArg(13, result_[1]);
    for (cl_uint i = 0; i < 3; ++i) union_distance_.setArg(14 + i, escape_[i]);
    for (auto& column : columns_) column.resize(capacity);
    los_.resize(capacity);
    his_.resize(capacity);
    if (certificates) evidence_.resize(capacity * (numbers_per_primitive * count + 3));
    make_views();
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    const std::size_t groups = (size_ + width_ - 1) / width_;
    for (int i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < size_; ++n) columns_[i][n] = points[n][i] * factor_;
      // Lanes beyond the last point repeat it.
      std::fill(columns_[i].begin() + size_, columns_[i].begin() + groups * width_, columns_[i][size_ - 1]);
      queue_.enqueueWriteBuffer(coordinates_[i], CL_FALSE, 0, groups * width_ * sizeof(double), columns_[i].data());
    }
    kernels_.clear();
    for (std::size_t index = 0; index < count_; ++index) enqueue_primitive(index, groups);
    if (count_ > 1) {
      union_distance_.setArg(0, static_cast<cl_ulong>(groups));
      enqueue(union_distance_, groups, group_size);
    }
    queue_.enqueueReadBuffer(result_[0], CL_FALSE, 0, size_ * sizeof(double), los_.data());
    queue_.enqueueReadBuffer(result_[1], CL_FALSE, 0, size_ * sizeof(double), his_.data());
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
  }

  void finish(std::vector<Enclosure>& enclosures, double& seconds) {
    queue_.finish();
    for (const cl::Event& kernel : kernels_)
      seconds += 1e-9 * static_cast<double>(kernel.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                            kernel.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    enclosures.resize(size_);
    for (std::size_t n = 0; n < size_; ++n)
      enclosures[n] = {scaled_down(los_[n], 1.0 / factor_), scaled_up(his_[n], 1.0 / factor_)};
  }

  // Precondition: finished, and certificates were asked for.
  void certify(const CertificateAssembly& assembly, std::span<const Enclosure> enclosures,
               std::vector<Certificate>& certificates) const {
    Evidence evidence;
    evidence.primitives.resize(count_);
    for (std::size_t n = 0; n < size_; ++n) {
      for (std::size_t index = 0; index < count_; ++index) {
        const double* const column = evidence_.data() + index * numbers_per_primitive * capacity_ + n;
        evidence.primitives[index] = {column[0] / factor_, in_model_units(column + capacity_)};
      }
      evidence.escape = in_model_units(evidence_.data() + count_ * numbers_per_primitive * capacity_ + n);
      const Point point{columns_[0][n] / factor_, columns_[1][n] / factor_, columns_[2][n] / factor_};
      certificates.push_back(assembly(point, enclosures[n], evidence));
    }
  }

 private:
  void bind_coordinates(cl::Kernel& kernel, cl_uint first) const {
    for (cl_uint i = 0; i < 3; ++i) kernel.setArg(first + i, coordinates_[i]);
  }

  // Upper ends and normals of every primitive, then the escapes.
  void read_evidence() {
    double* column = evidence_.data();
    const auto read = [&](const cl::Buffer& buffer) {
      queue_.enqueueReadBuffer(buffer, CL_FALSE, 0, size_ * sizeof(double), column);
      column += capacity_;
    };
    for (const auto& view : views_)
      for (std::size_t i = 1; i < view.size(); ++i) read(view[i]);
    if (count_ > 1)
      for (const cl::Buffer& escape : escape_) read(escape);
  }

  [[nodiscard]] Point in_model_units(const double* x) const {
    return {x[0] / factor_, x[capacity_] / factor_, x[2 * capacity_] / factor_};
  }

  // A window of each per-primitive array for every primitive.
  void make_views() {
    views_.resize(count_);
    for (std::size_t index = 0; index < count_; ++index)
      for (int i = 0; i < 5; ++i) {
        const cl_buffer_region region{index * capacity_ * sizeof(double), capacity_ * sizeof(double)};
        views_[index][i] =
            count_ == 1 ? per_primitive_[i]
                        : per_primitive_[i].createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region);
      }
  }

  void enqueue_primitive(std::size_t index, std::size_t groups) {
    point_distance_.setArg(0, static_cast<cl_ulong>(groups));
    point_distance_.setArg(5, static_cast<cl_uint>(index));
    interior_depth_.setArg(0, static_cast<cl_ulong>(groups));
    interior_depth_.setArg(6, static_cast<cl_uint>(index));
    for (cl_uint i = 0; i < 5; ++i) {
      point_distance_.setArg(7 + i, views_[index][i]);
      interior_depth_.setArg(9 + i, views_[index][i]);
    }
    enqueue(point_distance_, groups, group_size);
    // A vector work-item is long here: one a work-group lets the cores share them evenly.
    enqueue(interior_depth_, (groups + groups_per_block_ - 1) / groups_per_block_, width_ > 1 ? 1 : group_size);
  }

  void enqueue(const cl::Kernel& kernel, std::size_t work_items, std::size_t local) {
    cl::Event event;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((work_items + local - 1) / local * local),
                                cl::NDRange(local), nullptr, &event);
    kernels_.push_back(std::move(event));
  }

  std::size_t width_;
  std::size_t capacity_;
  std::size_t count_;
  double factor_;  // 2^scale: products with it are exact but for underflow, which the kernels allow for
  cl::CommandQueue queue_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  cl::Buffer nearest_;
  cl::Buffer scratch_;
  cl::Kernel point_distance_;
  cl::Kernel interior_depth_;
  cl::Kernel union_distance_;
  std::array<cl::Buffer, 3> coordinates_;
  std::array<cl::Buffer, 5> per_primitive_;  // lower ends, upper ends, normals x, y, z: primitive by primitive
  std::array<cl::Buffer, 2> result_;
  std::array<cl::Buffer, 3> escape_;
  std::vector<std::array<cl::Buffer, 5>> views_;
  std::size_t groups_per_block_ = 1;
  std::size_t size_ = 0;
  std::array<std::vector<double>, 3> columns_;
  std::vector<double> los_;
  std::vector<double> his_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
  std::vector<cl::Event> kernels_;
};

Error opencl_failure(const Device& device, const cl::Error& error) {
  return Error(ErrorKind::failure,
               fmt::format("{}: {} failed with OpenCL error {}", device.name, error.what(), error.err()));
}

}  // namespace

struct Batch::State {
  Device device;
  std::optional<CertificateAssembly> certificates;  // nothing unless asked for
  std::size_t capacity;
  std::vector<Slot> slots;
  std::deque<std::size_t> in_flight{};
  std::size_t next = 0;
  double seconds = 0.0;
};

bool within_device_range(const Model& model) {
  const int scale = scale_exponent(model);
  if (std::abs(scale) > 1000) return false;
  const auto in_range = [scale](double x, int lowest) {
    return x == 0.0 || (std::ilogb(x) + scale <= largest_scaled_exponent && std::ilogb(x) + scale >= lowest);
  };
  return std::all_of(model.primitives.begin(), model.primitives.end(), [&](const Primitive& primitive) {
    const auto& axes = primitive.superquadric.semi_axes;
    const auto& shift = primitive.pose.translation;
    const auto& exponents = primitive.superquadric.exponents;
    return std::all_of(axes.begin(), axes.end(), [&](double a) { return in_range(a, -largest_scaled_exponent); }) &&
           std::all_of(shift.begin(), shift.end(), [&](double t) { return in_range(t, -2000); }) &&
           std::all_of(exponents.begin(), exponents.end(), [](double e) { return e >= 0x1p-30; });
  });
}

Batch::Batch(const Device& device, const Model& model, double tolerance, bool certificates) {
  try {
    const int scale = scale_exponent(model);
    std::vector<PrimitiveParameters> parameters;
    for (const Primitive& primitive : model.primitives) parameters.push_back(primitive_parameters(primitive, scale));
    const cl::Buffer primitives(device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                                parameters.size() * sizeof(PrimitiveParameters), parameters.data());
    const std::size_t capacity = chunk_points(parameters.size(), device.vector_width);
    const double scaled_tolerance = std::max(std::ldexp(tolerance, scale), smallest_interior_tolerance);
    state_ = std::make_unique<State>(State{device, {}, capacity, {}});
    if (certificates) state_->certificates.emplace(model);
    state_->slots.reserve(2);
    for (int slot = 0; slot < 2; ++slot)
      state_->slots.emplace_back(device, primitives, parameters.size(), capacity, scaled_tolerance, scale,
                                 certificates);
    warm_up(std::ldexp(far_away, -scale));
  } catch (const cl::Error& error) {
    throw opencl_failure(device, error);
  }
}

// OpenCL implementations put off the end of compilation and the allocation of buffers to the first launch: a chunk of
// points far away makes them do it now.
void Batch::warm_up(double distance) {
  const std::vector<Point> points(state_->capacity, Point{distance, 0.0, 0.0});
  for (std::size_t slot = 0; slot < state_->slots.size(); ++slot) submit(points);
  discard();
  state_->seconds = 0.0;
}

Batch::~Batch() = default;

std::size_t Batch::capacity() const {
  return state_->capacity;
}

double Batch::device_seconds() const {
  return state_->seconds;
}

void Batch::submit(std::span<const Point> points) {
  try {
    state_->slots[state_->next].start(points);
  } catch (const cl::Error& error) {
    throw opencl_failure(state_->device, error);
  }
  state_->in_flight.push_back(state_->next);
  state_->next = 1 - state_->next;
}

void Batch::collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) {
  Slot& oldest = state_->slots[state_->in_flight.front()];
  state_->in_flight.pop_front();
  try {
    oldest.finish(enclosures, state_->seconds);
  } catch (const cl::Error& error) {
    throw opencl_failure(state_->device, error);
  }
  certificates.clear();
  if (state_->certificates) oldest.certify(*state_->certificates, enclosures, certificates);
}

void Batch::discard() {
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> certificates;
  while (!state_->in_flight.empty()) collect(enclosures, certificates);
}

}  // namespace verisq::device

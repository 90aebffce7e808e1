/// This file implements the rounds of an octree on a device: two lists of cubes, which change places after each level.
#include "host/octree/device_octree_front.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/model_source.hpp"
#include "host/batches/primitive_parameters.hpp"
#include "host/batches/solid_model.hpp"
#include "host/opencl/named_kernel.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/sets/octree_cube.hpp"

namespace verisq::device {
namespace {

// Cubes that are split between two looks at Ctrl-C: tens of milliseconds on a processor.
constexpr std::size_t primitives_of_full_chunk = std::size_t{1} << 17U;
constexpr std::size_t smallest_chunk = std::size_t{1} << 12U;
constexpr unsigned position_bits = 21;
constexpr unsigned children = 8;
constexpr std::size_t most_siblings = 8;  // a work-item works on one cube: more lanes than children are of no use

int octree_vector_width(const Device& device) {
  return std::min(device.vector_width, static_cast<int>(most_siblings));
}

struct Decisions {
  cl_uint black, white;
};

cl::Program octree_program(const Device& device, const Model& model, const std::string& extra_options) {
  // Of one primitive there is nothing to simplify.
  std::string options = fmt::format("{} {}", box_primitives_memory(device, model), extra_options);
  if (model.primitives.size() == 1) options += " -DNO_SIMPLIFICATION";
  return build_program(device.context, device.device, octree_vector_width(device),
                       model_source(model, kernels::embedded_octree()), options);
}

OctreeCube unpacked(cl_ulong position, int level) {
  constexpr cl_ulong mask = (cl_ulong{1} << position_bits) - 1;
  return {{static_cast<std::uint32_t>(position & mask), static_cast<std::uint32_t>(position >> position_bits & mask),
           static_cast<std::uint32_t>(position >> 2 * position_bits)},
          static_cast<std::uint8_t>(level),
          CubeColour::gray};
}

// Positions and what is decided in each; grows, and forgets what it held.
class CubeList {
 public:
  explicit CubeList(const cl::Context& context) : context_(context) { reserve(1); }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    capacity_ = capacity;
    positions = cl::Buffer(context_, CL_MEM_READ_WRITE, capacity * sizeof(cl_ulong));
    decisions = cl::Buffer(context_, CL_MEM_READ_WRITE, capacity * sizeof(Decisions));
  }

  cl::Buffer positions;
  cl::Buffer decisions;

 private:
  cl::Context context_;
  std::size_t capacity_ = 0;
};

class DeviceFront final : public OctreeFront {
 public:
  DeviceFront(const Device& device, const Model& model, const OctreeRoot& root, const std::string& extra_options)
      : name_(device.name),
        context_(device.context),
        queue_(device.context, device.device, CL_QUEUE_PROFILING_ENABLE),
        group_size_(usual_group_size(device)),
        split_cubes_(octree_program(device, model, extra_options), kernels::embedded_octree(), "split_cubes"),
        root_(root),
        scale_(scale_exponent(model)),
        primitives_(uploaded_box_primitives(device, model, scale_)),
        counts_(context_, CL_MEM_READ_WRITE, 3 * sizeof(cl_uint)),
        chunk_(std::max(smallest_chunk, primitives_of_full_chunk / model.primitives.size())),
        colours_(context_, CL_MEM_READ_WRITE, chunk_ * sizeof(cl_uchar2)),
        current_(context_),
        next_(context_) {
    restart();
    // OpenCL implementations put off the end of compilation to the first launch.
    next_.reserve(children);
    split_chunk(0, 0, 1, 0);
    restart();
  }

  void restart() override {
    reporting_failures(name_, [&] {
      constexpr cl_ulong root_position = 0;
      constexpr Decisions nothing{0, 0};
      queue_.enqueueWriteBuffer(current_.positions, CL_TRUE, 0, sizeof root_position, &root_position);
      queue_.enqueueWriteBuffer(current_.decisions, CL_TRUE, 0, sizeof nothing, &nothing);
    });
    undecided_ = 1;
    seconds_ = 0.0;
  }

  [[nodiscard]] std::size_t undecided() const override { return undecided_; }
  [[nodiscard]] double device_seconds() const override { return seconds_; }

  SplitLevel split(int level, const OctreeOptions& options, const OctreeSink& sink) override {
    return reporting_failures(name_, [&] { return split_level(level, options, sink); });
  }

  void deliver_undecided(int level, const OctreeSink& sink) override {
    reporting_failures(name_, [&] { deliver_from(0, level, sink); });
  }

 private:
  SplitLevel split_level(int level, const OctreeOptions& options, const OctreeSink& sink) {
    next_.reserve(std::min(options.budget, children * undecided_));
    SplitLevel result;
    std::size_t done = 0;
    std::size_t produced = 0;
    while (done < undecided_ && !options.interrupted()) {
      const std::size_t count = std::min({chunk_, undecided_ - done, (options.budget - produced) / children});
      if (count == 0) break;
      const std::array<cl_uint, 3> counts = split_chunk(level, done, count, produced);
      result.children.gray += counts[0];
      result.children.black += counts[1];
      result.children.white += counts[2];
      if (sink) deliver_decided(level, done, count, sink);
      produced += counts[0];
      done += count;
      options.progress(level, done, undecided_);
    }
    result.unsplit = undecided_ - done;
    deliver_from(done, level, sink);
    std::swap(current_, next_);
    undecided_ = produced;
    return result;
  }

  // The gray, black and white children.
  std::array<cl_uint, 3> split_chunk(int level, std::size_t begin, std::size_t count, std::size_t produced) {
    const auto corner = [&](std::size_t axis) { return std::ldexp(root_.centre[axis] - root_.half_width, scale_); };
    split_cubes_.set("count", count);
    split_cubes_.set("begin", begin);
    split_cubes_.set("corner_x", corner(0));
    split_cubes_.set("corner_y", corner(1));
    split_cubes_.set("corner_z", corner(2));
    split_cubes_.set("child_half_width", std::ldexp(root_.half_width, scale_ - level - 1));
    split_cubes_.set("positions", current_.positions);
    split_cubes_.set("decisions", current_.decisions);
    split_cubes_.set("primitives", primitives_);
    split_cubes_.set("next_begin", produced);
    split_cubes_.set("next_positions", next_.positions);
    split_cubes_.set("next_decisions", next_.decisions);
    split_cubes_.set("counts", counts_);
    split_cubes_.set("colours", colours_);
    split_cubes_.set("sums", cl::Local((group_size_ + 1) * sizeof(cl_uint)));

    std::array<cl_uint, 3> counts{};
    queue_.enqueueFillBuffer(counts_, cl_uint{0}, 0, sizeof counts);
    const std::size_t work_items = (count + group_size_ - 1) / group_size_ * group_size_;
    cl::Event event;
    queue_.enqueueNDRangeKernel(split_cubes_.kernel(), cl::NullRange, cl::NDRange(work_items), cl::NDRange(group_size_),
                                nullptr, &event);
    queue_.enqueueReadBuffer(counts_, CL_TRUE, 0, sizeof counts, counts.data());
    seconds_ += 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                           event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    return counts;
  }

  void deliver_decided(int level, std::size_t begin, std::size_t count, const OctreeSink& sink) {
    read_positions(begin, count);
    child_colours_.resize(count);
    queue_.enqueueReadBuffer(colours_, CL_TRUE, 0, count * sizeof(cl_uchar2), child_colours_.data());
    leaves_.clear();
    for (std::size_t n = 0; n < count; ++n) {
      const OctreeCube parent = unpacked(positions_[n], level);
      for (unsigned child = 0; child < children; ++child) {
        const bool black = (child_colours_[n].s[0] >> child & 1) != 0;
        const bool white = (child_colours_[n].s[1] >> child & 1) != 0;
        if (!black && !white) continue;
        OctreeCube& cube = leaves_.emplace_back(verify::child_of(parent, child));
        cube.colour = black ? CubeColour::black : CubeColour::white;
      }
    }
    sink(leaves_);
  }

  void deliver_from(std::size_t begin, int level, const OctreeSink& sink) {
    if (!sink) return;
    for (; begin < undecided_; begin += chunk_) {
      const std::size_t count = std::min(chunk_, undecided_ - begin);
      read_positions(begin, count);
      leaves_.clear();
      for (std::size_t n = 0; n < count; ++n) leaves_.push_back(unpacked(positions_[n], level));
      sink(leaves_);
    }
  }

  void read_positions(std::size_t begin, std::size_t count) {
    positions_.resize(count);
    queue_.enqueueReadBuffer(current_.positions, CL_TRUE, begin * sizeof(cl_ulong), count * sizeof(cl_ulong),
                             positions_.data());
  }

  std::string name_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::size_t group_size_;
  NamedKernel split_cubes_;
  OctreeRoot root_;
  int scale_;  // numbers of the device are model units times 2^scale_: exact, as the model is within its range
  cl::Buffer primitives_;
  cl::Buffer counts_;
  std::size_t chunk_;
  cl::Buffer colours_;
  CubeList current_;
  CubeList next_;
  std::size_t undecided_ = 0;
  double seconds_ = 0.0;
  std::vector<cl_ulong> positions_;
  std::vector<cl_uchar2> child_colours_;
  std::vector<OctreeCube> leaves_;
};

}  // namespace

std::unique_ptr<OctreeFront> octree_front(const Device& device, const Model& model, const OctreeRoot& root,
                                          const std::string& extra_options) {
  return reporting_failures(device.name, [&]() -> std::unique_ptr<OctreeFront> {
    return std::make_unique<DeviceFront>(device, model, root, extra_options);
  });
}

}  // namespace verisq::device

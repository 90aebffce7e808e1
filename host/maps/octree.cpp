/// This file implements octree.hpp.
#include "host/maps/octree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/program_self_test.hpp"
#include "host/device/solid_model.hpp"
#include "host/threads/parallel.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/octree.hpp"

namespace verisq {
namespace {

constexpr std::size_t chunk = 256;  // parents between two looks at the clock and at Ctrl-C

class HostFront final : public OctreeFront {
 public:
  HostFront(const Model& model, const OctreeRoot& root) : root_(root), colours_(model) { restart(); }

  void restart() override { cubes_.assign(1, colours_.root()); }
  [[nodiscard]] std::size_t undecided() const override { return cubes_.size(); }

  SplitLevel split(int level, const OctreeOptions& options, const OctreeSink& sink) override {
    SplitLevel result;
    std::vector<verify::UndecidedCube> next;
    std::vector<std::array<verify::UndecidedCube, 8>> children;
    std::size_t done = 0;
    while (done < cubes_.size() && !options.interrupted()) {
      const std::size_t room = (options.budget - next.size()) / 8;
      const std::size_t count = std::min({chunk, cubes_.size() - done, room});
      if (count == 0) break;
      children.resize(count);
      in_parallel(count, [&](std::size_t n) { children[n] = colours_(root_, cubes_[done + n]); });
      for (const auto& siblings : children) take(siblings, next, result.children);
      if (sink) sink(leaves_);
      leaves_.clear();
      done += count;
      options.progress(level, done, cubes_.size());
    }
    result.unsplit = cubes_.size() - done;
    cubes_.erase(cubes_.begin(), cubes_.begin() + static_cast<std::ptrdiff_t>(done));
    deliver_undecided(level, sink);
    cubes_ = std::move(next);
    return result;
  }

  void deliver_undecided(int /*level*/, const OctreeSink& sink) override {
    if (!sink || cubes_.empty()) return;
    leaves_.clear();
    for (const verify::UndecidedCube& cube : cubes_) leaves_.push_back(cube.cube);
    sink(leaves_);
    leaves_.clear();
  }

 private:
  void take(const std::array<verify::UndecidedCube, 8>& siblings, std::vector<verify::UndecidedCube>& undecided,
            OctreeLevel& counts) {
    for (const verify::UndecidedCube& child : siblings) {
      switch (child.cube.colour) {
        case CubeColour::black: ++counts.black; break;
        case CubeColour::white: ++counts.white; break;
        case CubeColour::gray:
          ++counts.gray;
          undecided.push_back(child);
          continue;
      }
      leaves_.push_back(child.cube);
    }
  }

  OctreeRoot root_;
  verify::SiblingColours colours_;
  std::vector<verify::UndecidedCube> cubes_;
  std::vector<OctreeCube> leaves_;
};

std::unique_ptr<OctreeFront> host_octree_front(const Model& model, const OctreeRoot& root) {
  return std::make_unique<HostFront>(model, root);
}

}  // namespace
}  // namespace verisq

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
  // For a single primitive there is nothing to simplify.
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

// The positions and decided colours of cubes; grows, and forgets its contents.
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
  DeviceFront(const Device& device, const cl::Program& program, const Model& model, const OctreeRoot& root)
      : name_(device.name),
        context_(device.context),
        queue_(device.context, device.device, CL_QUEUE_PROFILING_ENABLE),
        group_size_(usual_group_size(device)),
        split_cubes_(program, kernels::embedded_octree(), "split_cubes"),
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

// ---- samples

constexpr int sampled_levels = 3;
constexpr std::size_t sampled_cubes = 40;

// The cubes of the first levels: the decided ones, then the others.
std::vector<OctreeCube> first_cubes(OctreeFront& front) {
  std::vector<OctreeCube> cubes;
  const OctreeSink sink = [&](std::span<const OctreeCube> found) {
    cubes.insert(cubes.end(), found.begin(), found.end());
  };
  front.restart();
  int level = 0;
  for (; level < sampled_levels && front.undecided() > 0; ++level) (void)front.split(level, {}, sink);
  front.deliver_undecided(level, sink);
  front.restart();
  return cubes;
}

// Exact: sums of powers of 8.
double share_of_root(std::span<const OctreeCube> cubes, bool decided_alone) {
  double share = 0.0;
  for (const OctreeCube& cube : cubes)
    if (!decided_alone || cube.colour != CubeColour::gray) share += std::ldexp(1.0, -3 * cube.level);
  return share;
}

// A ball about the centre lies in the cube, which a black cube has inside of the solid, and a white one outside.
bool contradicts(const Enclosure& of_centre, CubeColour colour, double half_width) {
  return colour == CubeColour::black ? of_centre.lo > -half_width : of_centre.hi < half_width;
}

/// The first cube of the first levels whose colour contradicts the host's distance of its centre, or a message that far
/// less of the root is decided than by the host. Empty if neither is found.
std::string first_false_colour(OctreeFront& front, const Model& model, const OctreeRoot& root) {
  std::vector<OctreeCube> cubes = first_cubes(front);
  if (share_of_root(cubes, false) != 1.0) return "the cubes of the first levels are not all of the root";
  const std::vector<OctreeCube> of_host = first_cubes(*host_octree_front(model, root));
  if (share_of_root(cubes, true) < 0.5 * share_of_root(of_host, true))
    return fmt::format("{} of the root is decided, {} by the host", share_of_root(cubes, true),
                       share_of_root(of_host, true));
  std::erase_if(cubes, [](const OctreeCube& cube) { return cube.colour == CubeColour::gray; });
  const SignedDistance distance(model);
  const std::size_t step = cubes.size() / sampled_cubes + 1;
  for (std::size_t n = 0; n < cubes.size(); n += step) {
    const verify::Cube at = verify::cube_of(root, cubes[n]);
    const Enclosure of_centre = distance(at.centre, 0.5 * at.half_width);
    if (contradicts(of_centre, cubes[n].colour, at.half_width))
      return fmt::format("a cube of level {} about ({}, {}, {}) is called {}; the host proves [{}, {}] of its centre",
                         cubes[n].level, at.centre[0], at.centre[1], at.centre[2],
                         cubes[n].colour == CubeColour::black ? "black" : "white", of_centre.lo, of_centre.hi);
  }
  return {};
}

}  // namespace

std::unique_ptr<OctreeFront> octree_front(const Device& device, const Model& model, const OctreeRoot& root,
                                          const std::string& extra_options) {
  return reporting_failures(device.name, [&] {
    const cl::Program program = octree_program(device, model, extra_options);
    auto front = octree_front(device, program, model, root);
    require_sound(device, program, "octree, " + samples_of_solid(model),
                  [&] { return first_false_colour(*front, model, root); });
    return front;
  });
}

std::unique_ptr<OctreeFront> octree_front(const Device& device, const cl::Program& program, const Model& model,
                                          const OctreeRoot& root) {
  return reporting_failures(device.name, [&]() -> std::unique_ptr<OctreeFront> {
    return std::make_unique<DeviceFront>(device, program, model, root);
  });
}

}  // namespace verisq::device

namespace verisq {
namespace {

using Clock = std::chrono::steady_clock;

void check(const Model& model, const OctreeOptions& options) {
  if (has_mesh(model) && options.device != "auto" && options.device != "host")
    throw Error(ErrorKind::input, "octree: the host colours meshes: no other device yet");
  if (options.depth < 0 || options.depth > deepest_octree_level)
    throw Error(ErrorKind::input,
                fmt::format("octree: depth {} is not in 0 to {}", options.depth, deepest_octree_level));
  if (!(options.tolerance >= 0.0))
    throw Error(ErrorKind::input, fmt::format("octree: tolerance {} is not a number of at least 0", options.tolerance));
  if (options.budget == 0) throw Error(ErrorKind::input, "octree: a budget of 0 cubes has no room for the root");
}

}  // namespace

struct OctreeBuilder::State {
  State(const Model& model, const OctreeOptions& given) : options(given), root(verify::octree_root(model)) {
    if (options.device != "host" && !has_mesh(model)) use_device(model);
    if (!front) front = host_octree_front(model, root);
  }

  void use_device(const Model& model) {
    device::Selection selection = device::select_device(options.device, options.interrupted);
    notice = selection.notice;
    if (!selection.device) return;
    for (std::string reason : {device::why_not_on_devices(model), device::why_not_compiled(model)}) {
      if (reason.empty()) continue;
      notice = std::move(reason);
      return;
    }
    const auto make = [model, at = root](const device::Device& device) {
      return device::octree_front(device, model, at);
    };
    front = made_ready(selection, options.device, options.interrupted, make);
    notice = selection.notice;
    if (front) name = selection.device->name;
  }

  OctreeOptions options;
  OctreeRoot root;
  std::string name = "host";
  std::string notice;
  std::unique_ptr<OctreeFront> front;
};

OctreeBuilder::OctreeBuilder(const Model& model, const OctreeOptions& options) {
  verify::require_valid_with_meshes(model);
  check(model, options);
  state_ = hidden<State>(model, options);
}

OctreeSummary OctreeBuilder::build(const OctreeSink& sink) {
  const auto& [options, root, name, notice, front] = *state_;
  OctreeSummary summary;
  summary.root = root;
  summary.device = name;
  summary.notice = notice;
  const auto start = Clock::now();
  front->restart();
  summary.levels.push_back({.gray = front->undecided()});
  summary.volume = verify::volume(root, summary.levels);

  for (int level = 0; level < options.depth && front->undecided() > 0 && !verified(summary.volume, options.tolerance) &&
                      !summary.budget_hit && !summary.interrupted;
       ++level) {
    const std::size_t undecided = front->undecided();
    const SplitLevel split = front->split(level, options, sink);
    summary.interrupted = split.unsplit > 0 && options.interrupted();
    summary.budget_hit = split.unsplit > 0 && !summary.interrupted;
    summary.coloured += 8 * (undecided - split.unsplit);
    if (split.unsplit == undecided) break;  // there is no further level
    summary.levels.back().gray = split.unsplit;
    summary.levels.push_back(split.children);
    summary.volume = verify::volume(root, summary.levels);
  }
  const auto deepest = static_cast<int>(summary.levels.size()) - 1;
  if (sink && front->undecided() > 0) front->deliver_undecided(deepest, sink);
  summary.device_seconds = front->device_seconds();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return summary;
}

}  // namespace verisq

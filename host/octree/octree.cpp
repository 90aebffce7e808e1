/// This file implements the breadth-first growth of an octree, whoever colours its cubes.
#include "verisq/octree.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "host/batches/device_model.hpp"
#include "host/batches/model_source.hpp"
#include "host/device/device.hpp"
#include "host/octree/device_octree_front.hpp"
#include "host/octree/octree_front.hpp"
#include "verify/sets/octree_cube.hpp"
#include "verisq/error.hpp"

namespace verisq {
namespace {

using Clock = std::chrono::steady_clock;

void check(const OctreeOptions& options) {
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
    if (options.device != "host") use_device(model);
    if (!front) front = host_octree_front(model, root);
  }

  void use_device(const Model& model) {
    const device::Selection selection = device::select_device(options.device);
    notice = selection.notice;
    if (!selection.device) return;
    for (std::string reason : {device::why_not_on_devices(model), device::why_not_compiled(model)}) {
      if (reason.empty()) continue;
      notice = std::move(reason);
      return;
    }
    name = selection.device->name;
    front = device::octree_front(*selection.device, model, root);
  }

  OctreeOptions options;
  OctreeRoot root;
  std::string name = "host";
  std::string notice;
  std::unique_ptr<OctreeFront> front;
};

OctreeBuilder::OctreeBuilder(const Model& model, const OctreeOptions& options) {
  check(options);
  state_ = std::make_unique<State>(model, options);
}
OctreeBuilder::~OctreeBuilder() = default;
OctreeBuilder::OctreeBuilder(OctreeBuilder&&) noexcept = default;
OctreeBuilder& OctreeBuilder::operator=(OctreeBuilder&&) noexcept = default;

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

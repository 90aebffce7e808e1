/// This file implements the front on the host: cubes in parallel, one by one.
#include <algorithm>

#include "host/octree/octree_front.hpp"
#include "host/threads/parallel.hpp"
#include "verify/sets/octree_cube.hpp"

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

}  // namespace

std::unique_ptr<OctreeFront> host_octree_front(const Model& model, const OctreeRoot& root) {
  return std::make_unique<HostFront>(model, root);
}

}  // namespace verisq

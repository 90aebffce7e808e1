/// This file implements the rounds in which the triangles of a chunk ask for points, and a device answers.
#include "host/batches/solid_triangle_batch.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "host/batches/solid_batch.hpp"
#include "host/threads/parallel.hpp"
#include "verify/sets/solid_extent.hpp"
#include "verify/sets/triangle_branch_and_bound.hpp"

namespace verisq::device {
namespace {

using verify::TriangleBranchAndBound;

constexpr std::size_t largest_chunk = std::size_t{1} << 14U;
constexpr std::size_t most_points = 2048;     // of a triangle; then it is left to the host
constexpr double share_of_points = 0.25;      // of the tolerance, where a point takes a search
constexpr std::size_t triangles_a_task = 64;  // of a thread

// Points of many triangles; the first of each triangle has its index in `firsts`.
struct Round {
  std::vector<Point> points;
  std::vector<std::size_t> firsts;
};

class SolidTriangleBatch final : public Batch<Triangle> {
 public:
  SolidTriangleBatch(std::unique_ptr<Batch<Point>> points, const verify::SolidExtent& extent, double tolerance,
                     std::function<bool()> out_of_time)
      : points_(std::move(points)), extent_(extent), tolerance_(tolerance), out_of_time_(std::move(out_of_time)) {}

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
  [[nodiscard]] bool out_of_time() const { return out_of_time_ && out_of_time_(); }

  void search(std::vector<TriangleBranchAndBound>& searches) {
    std::vector<TriangleBranchAndBound*> asking;
    for (TriangleBranchAndBound& each : searches) asking.push_back(&each);
    while (!asking.empty() && !out_of_time()) {
      answer(asking);
      std::erase_if(
          asking, [](const TriangleBranchAndBound* each) { return each->finished() || each->asked() >= most_points; });
    }
  }

  void answer(std::span<TriangleBranchAndBound* const> asking) {
    Round round;
    for (TriangleBranchAndBound* const each : asking) {
      round.firsts.push_back(round.points.size());
      each->ask(round.points);
    }
    round.firsts.push_back(round.points.size());
    const std::vector<Enclosure> distances = distances_of(round.points);
    const std::size_t tasks = (asking.size() + triangles_a_task - 1) / triangles_a_task;
    in_parallel(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(asking.size(), (task + 1) * triangles_a_task);
      for (std::size_t i = task * triangles_a_task; i < end; ++i) {
        const std::size_t count = round.firsts[i + 1] - round.firsts[i];
        asking[i]->answer(std::span(distances).subspan(round.firsts[i], count));
      }
    });
  }

  // Two chunks in flight: one is prepared while the other is worked on.
  [[nodiscard]] std::vector<Enclosure> distances_of(std::span<const Point> points) {
    std::vector<Enclosure> distances;
    distances.reserve(points.size());
    std::vector<Enclosure> found;
    std::vector<Certificate> none;
    std::size_t in_flight = 0;
    const auto collect = [&] {
      points_->collect(found, none);
      distances.insert(distances.end(), found.begin(), found.end());
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
    return distances;
  }

  std::unique_ptr<Batch<Point>> points_;
  verify::SolidExtent extent_;
  double tolerance_;
  std::function<bool()> out_of_time_;
  std::deque<std::vector<Triangle>> waiting_;
};

}  // namespace

std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model, double tolerance,
                                                      const std::function<bool()>& out_of_time) {
  return std::make_unique<SolidTriangleBatch>(solid_batch(device, model, share_of_points * tolerance),
                                              verify::extent_of(model), tolerance, out_of_time);
}

}  // namespace verisq::device

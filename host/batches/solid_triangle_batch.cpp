/// This file implements the rounds in which the triangles of a chunk ask for points, and a device answers.
#include "host/batches/solid_triangle_batch.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "host/batches/rows_side_by_side.hpp"
#include "host/batches/solid_batch.hpp"
#include "host/threads/parallel.hpp"
#include "verify/sets/solid_extent.hpp"
#include "verify/sets/triangle_branch_and_bound.hpp"

namespace verisq::device {
namespace {

using verify::TriangleBranchAndBound;
using Answer = TriangleBranchAndBound::Answer;

constexpr std::size_t largest_chunk = rows_side_by_side;  // each asks for many points
constexpr std::size_t most_points = 1U << 16U;            // of a triangle; then it is left to the host
constexpr double share_of_points = 0.25;                  // of the tolerance, where a point takes a search
constexpr std::size_t triangles_a_task = 64;              // of a thread

class SolidTriangleBatch final : public Batch<Triangle> {
 public:
  SolidTriangleBatch(DirectedBatch batch, const Model& model, double tolerance, std::function<bool()> out_of_time)
      : points_(std::move(batch.points)),
        directions_(std::move(batch.directions)),
        extent_(verify::extent_of(model)),
        tolerance_(tolerance),
        out_of_time_(std::move(out_of_time)) {}

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
    asking.reserve(searches.size());
    for (TriangleBranchAndBound& each : searches) asking.push_back(&each);
    while (!asking.empty() && !out_of_time()) {
      answer(asking);
      std::erase_if(
          asking, [](const TriangleBranchAndBound* each) { return each->finished() || each->asked() >= most_points; });
    }
  }

  // Each task with its points: those that its triangles ask for, one triangle after the other.
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
  [[nodiscard]] std::vector<Answer> answers_to(std::span<const Point> points) {
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
    return answers;
  }

  std::unique_ptr<Batch<Point>> points_;
  std::shared_ptr<const std::vector<Point>> directions_;
  verify::SolidExtent extent_;
  double tolerance_;
  std::function<bool()> out_of_time_;
  std::deque<std::vector<Triangle>> waiting_;
};

}  // namespace

std::unique_ptr<Batch<Triangle>> solid_triangle_batch(const Device& device, const Model& model, double tolerance,
                                                      const std::function<bool()>& out_of_time) {
  return std::make_unique<SolidTriangleBatch>(directed_solid_batch(device, model, share_of_points * tolerance), model,
                                              tolerance, out_of_time);
}

}  // namespace verisq::device

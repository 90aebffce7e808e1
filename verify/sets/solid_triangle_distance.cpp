/// The public entry: parts of the triangle, and the host's own signed distances of their points.
#include <optional>
#include <vector>

#include "verify/sets/covered_triangle.hpp"
#include "verify/sets/solid_extent.hpp"
#include "verify/sets/triangle_branch_and_bound.hpp"
#include "verisq/signed_distance.hpp"
#include "verisq/triangle_search.hpp"

namespace verisq {

namespace {

constexpr std::size_t most_points = 4096;
constexpr double share_of_points = 0.125;       // of the tolerance, where a point takes a search
constexpr double share_of_proposal = 1.0 / 16;  // of the tolerance, where a cover proves the rest

std::vector<std::optional<TriangleDistance>> convex_primitives(const Model& model) {
  std::vector<std::optional<TriangleDistance>> result(model.primitives.size());
  for (std::size_t i = 0; i < model.primitives.size(); ++i) {
    if (!is_bent(model.primitives[i])) result[i].emplace(Model{"", {model.primitives[i]}});
  }
  return result;
}

}  // namespace

struct TriangleSearch::State {
  explicit State(const Model& model)
      : distance(model),
        extent(verify::extent_of(model)),
        convex(convex_primitives(model)),
        search(model),
        checker(model) {}

  /// Until the tolerance is reached, the budget spent, or `over` says so.
  [[nodiscard]] verify::TriangleBranchAndBound searched(const Triangle& triangle, double tolerance,
                                                        const std::function<bool()>& over) const {
    verify::TriangleBranchAndBound result(triangle, extent, tolerance);
    std::vector<Point> points;
    std::vector<verify::TriangleBranchAndBound::Answer> answers;
    while (!result.finished() && result.asked() < most_points && !over()) {
      points.clear();
      answers.clear();
      result.ask(points);
      for (const Point& point : points) answers.push_back({distance(point, share_of_points * tolerance, over)});
      result.answer(answers);
    }
    return result;
  }

  SignedDistance distance;
  verify::SolidExtent extent;
  std::vector<std::optional<TriangleDistance>> convex;  ///< of each primitive alone that is not bent
  verify::SolidDistance search;
  verify::ExactChecker checker;
};

TriangleSearch::TriangleSearch(const Model& model) : state_(std::make_unique<State>(model)) {}

TriangleSearch::~TriangleSearch() = default;
TriangleSearch::TriangleSearch(TriangleSearch&&) noexcept = default;
TriangleSearch& TriangleSearch::operator=(TriangleSearch&&) noexcept = default;

Enclosure TriangleSearch::operator()(const Triangle& triangle, double tolerance,
                                     const std::function<bool()>& interrupted) const {
  return state_->searched(triangle, tolerance, [&] { return interrupted && interrupted(); }).enclosure();
}

CertifiedEnclosure TriangleSearch::certified(const Triangle& triangle, double tolerance,
                                             const std::function<bool()>& interrupted) const {
  const auto over = [&] { return interrupted && interrupted(); };
  const auto nearest = state_->searched(triangle, share_of_proposal * tolerance, over).nearest();
  if (!nearest) return {{0.0, infinity}, {}};
  return verify::covered({state_->convex, state_->search, state_->checker}, triangle, *nearest, tolerance, over);
}

}  // namespace verisq

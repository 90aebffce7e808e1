/// The public entry: parts of the triangle, and the host's own signed distances of their points.
#include <algorithm>
#include <vector>

#include "verify/sets/solid_extent.hpp"
#include "verify/sets/triangle_branch_and_bound.hpp"
#include "verisq/signed_distance.hpp"
#include "verisq/triangle_search.hpp"

namespace verisq {

namespace {

constexpr std::size_t most_points = 4096;
constexpr double share_of_points = 0.125;  // of the tolerance, where a point takes a search

}  // namespace

struct TriangleSearch::State {
  explicit State(const Model& model) : distance(model), extent(verify::extent_of(model)) {}

  SignedDistance distance;
  verify::SolidExtent extent;
};

TriangleSearch::TriangleSearch(const Model& model) : state_(std::make_unique<State>(model)) {}

TriangleSearch::~TriangleSearch() = default;
TriangleSearch::TriangleSearch(TriangleSearch&&) noexcept = default;
TriangleSearch& TriangleSearch::operator=(TriangleSearch&&) noexcept = default;

Enclosure TriangleSearch::operator()(const Triangle& triangle, double tolerance,
                                     const std::function<bool()>& interrupted) const {
  const auto over = [&] { return interrupted && interrupted(); };
  verify::TriangleBranchAndBound search(triangle, state_->extent, tolerance);
  std::vector<Point> points;
  std::vector<verify::TriangleBranchAndBound::Answer> answers;
  while (!search.finished() && search.asked() < most_points && !over()) {
    points.clear();
    answers.clear();
    search.ask(points);
    for (const Point& point : points) answers.push_back({state_->distance(point, share_of_points * tolerance, over)});
    search.answer(answers);
  }
  return search.enclosure();
}

}  // namespace verisq

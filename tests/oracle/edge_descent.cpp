/// Projected gradients on intersections of boundaries.
#include "tests/oracle/edge_descent.hpp"

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <vector>

#include "tests/oracle/approach.hpp"

namespace verisq::oracle {

namespace {

constexpr double activity = 0.3;  ///< |g - 1| of boundaries that count as near
constexpr int steps = 25;
constexpr int halvings = 6;
constexpr int restorations = 4;

[[nodiscard]] Eigen::Vector3d vector(const Point& x) {
  return {x[0], x[1], x[2]};
}

[[nodiscard]] Point point(const Eigen::Vector3d& x) {
  return {x[0], x[1], x[2]};
}

/// {x : g_i(x) = 1 for all i}, its normals by differences over `spacing`.
class Edge {
 public:
  Edge(std::vector<const PlacedPrimitive*> boundaries, double spacing)
      : boundaries_(std::move(boundaries)), spacing_(spacing) {}

  /// Normals as rows.
  [[nodiscard]] Eigen::MatrixXd normals(const Eigen::Vector3d& x) const {
    Eigen::MatrixXd rows(boundaries_.size(), 3);
    for (std::size_t i = 0; i < boundaries_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d shift = spacing_ * Eigen::Vector3d::Unit(axis);
        rows(static_cast<Eigen::Index>(i), axis) = (excess(i, x + shift) - excess(i, x - shift)) / (2 * spacing_);
      }
    }
    return rows;
  }

  /// Newton's method with the least change.
  [[nodiscard]] Eigen::Vector3d restored(Eigen::Vector3d x) const {
    for (int i = 0; i < restorations; ++i) {
      Eigen::VectorXd values(boundaries_.size());
      for (std::size_t k = 0; k < boundaries_.size(); ++k) values[static_cast<Eigen::Index>(k)] = excess(k, x);
      x -= normals(x).completeOrthogonalDecomposition().solve(values);
    }
    return x;
  }

  /// What v has along the edge.
  [[nodiscard]] Eigen::Vector3d tangential(const Eigen::Vector3d& x, const Eigen::Vector3d& v) const {
    const Eigen::MatrixXd rows = normals(x);
    return v - rows.completeOrthogonalDecomposition().solve(rows * v);
  }

 private:
  [[nodiscard]] double excess(std::size_t i, const Eigen::Vector3d& x) const {
    return boundaries_[i]->norm().gauge(boundaries_[i]->own(point(x))) - 1;
  }

  std::vector<const PlacedPrimitive*> boundaries_;
  double spacing_;
};

[[nodiscard]] Eigen::Vector3d descended(const Edge& edge, const Eigen::Vector3d& q, Eigen::Vector3d x) {
  x = edge.restored(x);
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector3d towards = edge.tangential(x, q - x);
    const double distance = (x - q).norm();
    double share = 1.0;
    Eigen::Vector3d next = x;
    for (int k = 0; k < halvings && !((next - q).norm() < distance); ++k, share /= 2) {
      next = edge.restored(x + share * towards);
    }
    if (!((next - q).norm() < distance)) return x;
    x = next;
  }
  return x;
}

/// By `offset` along each normal or, where its bit in `sides` is 0, against it.
[[nodiscard]] Eigen::Vector3d off_boundaries(const Eigen::MatrixXd& normals, unsigned sides, double offset) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    shift += ((sides >> i & 1) != 0 ? offset : -offset) * normals.row(i).transpose();
  }
  return shift;
}

}  // namespace

Point slid_along_edges(const PlacedModel& model, Membership set, const Point& q, const Point& start) {
  const double size = model.bounding_ball().radius;
  std::vector<const PlacedPrimitive*> near;
  for (const PlacedPrimitive& p : model.primitives()) {
    if (std::abs(p.norm().gauge(p.own(start)) - 1) < activity) near.push_back(&p);
  }
  Point best = start;
  const auto consider = [&](const Eigen::Vector3d& x) {
    const Point candidate = point(x);
    if (length(difference(candidate, q)) < length(difference(best, q)) && model(candidate) == set) best = candidate;
  };
  for (unsigned choice = 1; choice < 1U << near.size(); ++choice) {
    if (std::popcount(choice) > 3) continue;
    std::vector<const PlacedPrimitive*> chosen;
    for (std::size_t i = 0; i < near.size(); ++i) {
      if ((choice >> i & 1) != 0) chosen.push_back(near[i]);
    }
    const Edge edge(chosen, 1e-7 * size);
    const Eigen::Vector3d x = descended(edge, vector(q), vector(start));
    if (!x.allFinite()) continue;
    const Eigen::MatrixXd normals = edge.normals(x).rowwise().normalized();
    // Off the boundaries, to either side of each.
    for (const double offset : {1e-10 * size, 1e-8 * size, 1e-6 * size}) {
      for (unsigned sides = 0; sides < 1U << chosen.size(); ++sides) {
        consider(x + off_boundaries(normals, sides, offset));
      }
    }
  }
  return best;
}

}  // namespace verisq::oracle

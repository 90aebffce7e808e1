/// The peer: closest points by IPOPT, the interior point method that the paper compares with (its references 7 and 41).
///
/// Minimises |q - x|² subject to F(x) <= 1, and |x - y|² subject to F_A(x) <= 1 and F_B(y) <= 1, with F as in Eq. (1).
/// Exact gradients; IPOPT's default options and tolerances (1e-8), with the linear solver that Debian builds it for
/// (MUMPS). One core, no verification.
#pragma once

#include <memory>
#include <optional>
#include <verisq/model.hpp>

namespace verisq::bench {

enum class IpoptHessian {
  exact,
  limited_memory,  ///< IPOPT's own approximation: for exponents above 1, where exact second derivatives are unbounded
};

struct IpoptClosestPoint {
  double distance;
  Point on_solid;  ///< in the solid's frame
};

class IpoptPointDistance {
 public:
  /// Throws std::runtime_error when IPOPT cannot be started.
  IpoptPointDistance(const Superquadric& solid, IpoptHessian hessian);
  ~IpoptPointDistance();

  /// Nothing where IPOPT does not report success. Precondition: the point is outside.
  [[nodiscard]] std::optional<IpoptClosestPoint> operator()(const Point& point);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct IpoptClosestPair {
  double distance;
  Point on_a;  ///< in A's frame
  Point on_b;  ///< in B's frame
};

class IpoptPairDistance {
 public:
  /// Throws std::runtime_error when IPOPT cannot be started.
  IpoptPairDistance(const Superquadric& a, const Superquadric& b, IpoptHessian hessian);
  ~IpoptPairDistance();

  /// Nothing where IPOPT does not report success. Precondition: the solids are disjoint.
  [[nodiscard]] std::optional<IpoptClosestPair> operator()(const Pose& pose_of_b);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::bench

/// Both problems as one: minimise |M1 x1 + ... + c|² over a point x_i of each solid, each in the solid's own frame.
#include "bench/peer_ipopt.hpp"

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <stdexcept>
#include <vector>

#include "bench/approximate_motion.hpp"
#include "bench/implicit_superquadric.hpp"

namespace verisq::bench {
namespace {

using Ipopt::Index;
using Ipopt::Number;

/// A solid and how its points enter the difference whose length is the distance.
struct Member {
  ImplicitSuperquadric solid;
  Eigen::Matrix3d map;
  Eigen::Vector3d start;
};

/// Variables: three coordinates a member. Constraints: one a member, F(x_i) <= 1. All derivatives are dense but for
/// those of one member's constraint by another's coordinates.
class ClosestPointsProblem : public Ipopt::TNLP {
 public:
  ClosestPointsProblem(std::vector<Member> members, const Eigen::Vector3d& offset)
      : members_(std::move(members)), offset_(offset) {}

  /// Of the solution: a point for each member, or none before success.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& solution() const { return solution_; }
  [[nodiscard]] double distance() const { return difference(solution_.front().data()).norm(); }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag, IndexStyleEnum& index_style) override {
    m = count();
    n = 3 * m;
    nnz_jac_g = 3 * m;
    nnz_h_lag = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l, Number* g_u) override {
    std::fill_n(x_l, n, -unbounded);
    std::fill_n(x_u, n, unbounded);
    std::fill_n(g_l, m, -unbounded);
    std::fill_n(g_u, m, 1.0);
    return true;
  }

  bool get_starting_point(Index, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    for (const Member& member : members_) x = std::copy_n(member.start.data(), 3, x);
    return true;
  }

  bool eval_f(Index, const Number* x, bool, Number& value) override {
    value = difference(x).squaredNorm();
    return true;
  }

  bool eval_grad_f(Index, const Number* x, bool, Number* gradient) override {
    const Eigen::Vector3d at = difference(x);
    for (Index i = 0; i < count(); ++i) coordinates(gradient, i) = 2.0 * member(i).map.transpose() * at;
    return true;
  }

  bool eval_g(Index, const Number* x, bool, Index, Number* values) override {
    for (Index i = 0; i < count(); ++i) values[i] = member(i).solid.value(coordinates(x, i));
    return true;
  }

  bool eval_jac_g(Index, const Number* x, bool, Index, Index, Index* row, Index* column, Number* values) override {
    for (Index i = 0; i < count(); ++i) {
      if (values != nullptr) {
        coordinates(values, i) = member(i).solid.gradient(coordinates(x, i));
        continue;
      }
      for (Index axis = 3 * i; axis < 3 * i + 3; ++axis) {
        row[axis] = i;
        column[axis] = axis;
      }
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number objective_factor, Index, const Number* multipliers, bool, Index,
              Index* row, Index* column, Number* values) override {
    Eigen::MatrixXd hessian;
    if (values != nullptr) hessian = lagrangian_hessian(n, x, objective_factor, multipliers);
    Index entry = 0;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j <= i; ++j, ++entry) {
        if (values != nullptr) {
          values[entry] = hessian(i, j);
        } else {
          row[entry] = i;
          column[entry] = j;
        }
      }
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn, Index, const Number* x, const Number*, const Number*, Index,
                         const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    solution_.clear();
    for (Index i = 0; i < count(); ++i) solution_.emplace_back(coordinates(x, i));
  }

 private:
  static constexpr Number unbounded = 2e19;  // IPOPT takes 1e19 and more for infinity

  static Eigen::Map<const Eigen::Vector3d> coordinates(const Number* x, Index i) {
    return Eigen::Map<const Eigen::Vector3d>(x + 3 * i);
  }
  static Eigen::Map<Eigen::Vector3d> coordinates(Number* x, Index i) { return Eigen::Map<Eigen::Vector3d>(x + 3 * i); }

  [[nodiscard]] Index count() const { return static_cast<Index>(members_.size()); }
  [[nodiscard]] const Member& member(Index i) const { return members_[static_cast<std::size_t>(i)]; }

  [[nodiscard]] Eigen::Vector3d difference(const Number* x) const {
    Eigen::Vector3d sum = offset_;
    for (Index i = 0; i < count(); ++i) sum += member(i).map * coordinates(x, i);
    return sum;
  }

  [[nodiscard]] Eigen::MatrixXd lagrangian_hessian(Index n, const Number* x, Number objective_factor,
                                                   const Number* multipliers) const {
    Eigen::MatrixXd hessian(n, n);
    for (Index i = 0; i < count(); ++i) {
      for (Index j = 0; j < count(); ++j)
        hessian.block<3, 3>(3 * i, 3 * j) = 2.0 * objective_factor * member(i).map.transpose() * member(j).map;
      hessian.block<3, 3>(3 * i, 3 * i) += multipliers[i] * member(i).solid.hessian(coordinates(x, i));
    }
    return hessian;
  }

  std::vector<Member> members_;
  Eigen::Vector3d offset_;
  std::vector<Eigen::Vector3d> solution_;
};

/// One application for all queries: reading the options is no part of a query.
Ipopt::SmartPtr<Ipopt::IpoptApplication> quiet_application(IpoptHessian hessian) {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  if (hessian == IpoptHessian::limited_memory)
    application->Options()->SetStringValue("hessian_approximation", "limited-memory");
  application->Options()->SetIntegerValue("print_level", 0);
  application->Options()->SetStringValue("sb", "yes");  // no banner
  if (application->Initialize("") != Ipopt::Solve_Succeeded) throw std::runtime_error("IPOPT cannot be started");
  return application;
}

/// Whether IPOPT met its own tolerance; its "acceptable level" (1e-6) counts as failure.
bool solved(Ipopt::IpoptApplication& application, const Ipopt::SmartPtr<ClosestPointsProblem>& problem) {
  return application.OptimizeTNLP(GetRawPtr(problem)) == Ipopt::Solve_Succeeded && !problem->solution().empty();
}

}  // namespace

struct IpoptPointDistance::State {
  ImplicitSuperquadric solid;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application;
};

IpoptPointDistance::IpoptPointDistance(const Superquadric& solid, IpoptHessian hessian)
    : state_(std::make_unique<State>(ImplicitSuperquadric(solid), quiet_application(hessian))) {}
IpoptPointDistance::~IpoptPointDistance() = default;

std::optional<IpoptClosestPoint> IpoptPointDistance::operator()(const Point& query) {
  const Eigen::Vector3d q = vector(query);
  const Member member{state_->solid, Eigen::Matrix3d::Identity(), state_->solid.interior_point(q)};
  const Ipopt::SmartPtr<ClosestPointsProblem> problem = new ClosestPointsProblem({member}, -q);
  if (!solved(*state_->application, problem)) return std::nullopt;
  return IpoptClosestPoint{problem->distance(), point(problem->solution()[0])};
}

struct IpoptPairDistance::State {
  ImplicitSuperquadric a;
  ImplicitSuperquadric b;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application;
};

IpoptPairDistance::IpoptPairDistance(const Superquadric& a, const Superquadric& b, IpoptHessian hessian)
    : state_(std::make_unique<State>(ImplicitSuperquadric(a), ImplicitSuperquadric(b), quiet_application(hessian))) {}
IpoptPairDistance::~IpoptPairDistance() = default;

std::optional<IpoptClosestPair> IpoptPairDistance::operator()(const Pose& pose_of_b) {
  const ApproximateMotion motion(pose_of_b);
  const Eigen::Vector3d to_a = -motion.rotation.transpose() * motion.translation;
  const Member a{state_->a, Eigen::Matrix3d::Identity(), state_->a.interior_point(motion.translation)};
  const Member b{state_->b, -motion.rotation, state_->b.interior_point(to_a)};
  const Ipopt::SmartPtr<ClosestPointsProblem> problem = new ClosestPointsProblem({a, b}, -motion.translation);
  if (!solved(*state_->application, problem)) return std::nullopt;
  return IpoptClosestPair{problem->distance(), point(problem->solution()[0]), point(problem->solution()[1])};
}

}  // namespace verisq::bench

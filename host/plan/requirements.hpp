/// What is asked of a fit besides its objective: contact, size, constraints of the pose, sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/mesh.hpp>

#include "host/plan/candidate_evaluation.hpp"
#include "verisq/fit.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

// How large an implant's parts are.

/// To nearest, in cubes of the model unit. Proportional to each semi-axis.
[[nodiscard]] double volume(const Superquadric& solid);

// Shares of the cavity's area that have to be in contact, as a term of the search's objective.

/// A share is a sum over points: each counts from 1 to 0 as its distance grows past the contact's, smoothly within a
/// tenth of the fitness' scale to either side. What is missing costs more than F could gain by it.
class ContactAim {
 public:
  ContactAim() = default;
  /// `weight`: of all points of the cavity. The contacts must outlive it.
  ContactAim(std::span<const FitContact> contacts, double scale, double weight, const MakeEvaluator& make_evaluator);

  /// The same with wider steps: points farther off tell where to go.
  [[nodiscard]] ContactAim widened(double factor) const;
  [[nodiscard]] bool asks() const { return !contacts_.empty(); }

  /// What all contact that is missing costs at most.
  [[nodiscard]] double most() const { return cost_ * static_cast<double>(contacts_.size()); }
  /// The cost, negative, and its derivatives. Returns the shares that are missing, of all ranges.
  double add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  struct Contact {
    const FitContact* asked;
    double weight;  ///< of all its points
    std::shared_ptr<CandidateEvaluator> evaluator;
  };

  [[nodiscard]] double share(const Contact& contact, std::span<const PointDistance> distances) const;
  void add_derivatives(Evaluation& evaluation, const Contact& contact, double by_share, const Candidate& candidate,
                       std::span<const PointDistance> distances) const;

  std::vector<Contact> contacts_;
  double reach_ = 0.0;
  double cost_ = 0.0;
};

// What is asked of the pose itself, as the search sees it: how much is left to the ends of each range.

/// A row for every finite end of a constraint's range.
class PoseConstraints {
 public:
  /// Of one implant of the series. Space and constraints must outlive it.
  PoseConstraints(const CandidateSpace& space, std::span<const FitConstraint> constraints, std::size_t implant);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// At least 0 where the end is kept, in the constraint's units.
  [[nodiscard]] std::vector<double> slack(std::span<const double> parameters) const;
  /// Derivatives of the slack by all parameters, row by row: by central differences.
  [[nodiscard]] std::vector<double> jacobian(std::span<const double> parameters) const;
  /// The sum of what is missing.
  [[nodiscard]] double violation(std::span<const double> parameters) const;

 private:
  struct Row {
    const FitConstraint* constraint;
    bool upper;
  };

  const CandidateSpace& space_;
  std::size_t implant_;
  std::vector<Row> rows_;
};

// Lets the size of an implant count for more than F does.

class SizeAim {
 public:
  /// Sizes do not count.
  SizeAim() = default;
  /// From the least sizes to the largest, the objective gains a hundred times the weight of all points: F, which is at
  /// most that weight, decides where sizes differ by less than about a hundredth of their range.
  SizeAim(const CandidateSpace& space, double weight);

  /// What it adds at most.
  [[nodiscard]] double most() const { return most_; }
  /// What it adds for these sizes.
  [[nodiscard]] double value(std::span<const Primitive> primitives) const;
  /// The value and its derivatives by semi-axes.
  void add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  double least_size_ = 0.0;
  double most_ = 0.0;
  double per_size_ = 0.0;
};

// Whether points lie inside a closed surface, in floating point: fast enough for every pose that a search looks at.

/// By rays along z, which meet the triangles of one column of a grid over the x-y plane alone. A ray that grazes an
/// edge may be told wrongly: nothing is proven.
class InsideTest {
 public:
  /// The mesh, closed over its rims. Precondition: as closing_over_rims.
  explicit InsideTest(const Mesh& mesh);

  [[nodiscard]] bool operator()(const Point& point) const;

 private:
  [[nodiscard]] std::size_t column(double along, std::size_t axis) const;
  void add(std::uint32_t triangle);

  std::vector<Triangle> triangles_;
  Point lower_{};
  Point upper_{};
  std::vector<std::vector<std::uint32_t>> columns_;
};

// On which side of the cavity's surface the parts of an implant have to be, as the search sees it: by sample points.

class SideRequirements {
 public:
  /// Of an implant that may be anywhere.
  SideRequirements() = default;
  /// One a primitive. `inside` must outlive it.
  SideRequirements(const InsideTest& inside, std::span<const SurfaceSide> required);

  /// How many samples lie on the wrong side: the centres of primitives and the ends of their axes, drawn in a little.
  [[nodiscard]] std::size_t misplaced(const Candidate& candidate) const;

 private:
  const InsideTest* inside_ = nullptr;
  std::vector<SurfaceSide> required_;
};

// All that is asked of a candidate besides the limit of penetration.

struct Requirements {
  SideRequirements sides;
  PoseConstraints constraints;
  ContactAim contacts = {};
  SizeAim size = {};

  /// What size and contact make of the objective at most.
  [[nodiscard]] double most() const { return size.most() + contacts.most(); }

  /// 0 where all but contact is kept: the samples misplaced, and what is missing of the constraints in their units.
  [[nodiscard]] double broken(std::span<const double> parameters, const Candidate& candidate) const {
    return static_cast<double>(sides.misplaced(candidate)) + constraints.violation(parameters);
  }
};

}  // namespace verisq::fit_search

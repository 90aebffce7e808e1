/// The requirements on a fit besides its objective: contact, size, constraints of the pose, sides.
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

// The sizes of an implant's parts.

/// Rounded to nearest, in cubes of the model unit. Proportional to each semi-axis.
[[nodiscard]] double volume(const Superquadric& solid);

// Shares of the cavity's area that must be in contact, as a term of the search's objective.

/// A share is a sum over points. Each counts from 1 to 0 as its distance grows past the contact's distance, smoothly
/// within a tenth of the fitness' scale to either side. A missing share costs more than F could gain by it.
class ContactAim {
 public:
  ContactAim() = default;
  /// `weight` is that of all points of the cavity. The contacts must outlive this.
  ContactAim(std::span<const FitContact> contacts, double scale, double weight, const MakeEvaluator& make_evaluator);

  /// The same with wider steps: points farther off show the direction to go.
  [[nodiscard]] ContactAim widened(double factor) const;
  [[nodiscard]] bool asks() const { return !contacts_.empty(); }

  /// An upper bound of the cost of all missing contact.
  [[nodiscard]] double most() const { return cost_ * static_cast<double>(contacts_.size()); }
  /// Adds the cost, which is negative, and its derivatives. Returns the sum of the missing shares of all ranges.
  double add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  struct Contact {
    const FitContact* asked;
    double weight;  ///< weight of all its points
    std::shared_ptr<CandidateEvaluator> evaluator;
  };

  [[nodiscard]] double share(const Contact& contact, std::span<const PointDistance> distances) const;
  void add_derivatives(Evaluation& evaluation, const Contact& contact, double by_share, const Candidate& candidate,
                       std::span<const PointDistance> distances) const;

  std::vector<Contact> contacts_;
  double reach_ = 0.0;
  double cost_ = 0.0;
};

// The requirements on the pose itself, as the search uses them: the distance to the ends of each range.

/// A row for every finite end of a constraint's range.
class PoseConstraints {
 public:
  /// Constraints for one implant of the series. Space and constraints must outlive this.
  PoseConstraints(const CandidateSpace& space, std::span<const FitConstraint> constraints, std::size_t implant);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// At least 0 if the end is kept, in the constraint's units.
  [[nodiscard]] std::vector<double> slack(std::span<const double> parameters) const;
  /// Derivatives of the slack by all parameters, row by row: by central differences.
  [[nodiscard]] std::vector<double> jacobian(std::span<const double> parameters) const;
  /// The sum of the amounts by which ends are missed.
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
  /// From the least sizes to the largest, the objective gains a hundred times the weight of all points. F is at most
  /// that weight, so it decides if sizes differ by less than about a hundredth of their range.
  SizeAim(const CandidateSpace& space, double weight);

  /// An upper bound of the amount that it adds.
  [[nodiscard]] double most() const { return most_; }
  /// The amount that it adds for these sizes.
  [[nodiscard]] double value(std::span<const Primitive> primitives) const;
  /// The value and its derivatives by semi-axes.
  void add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  double least_size_ = 0.0;
  double most_ = 0.0;
  double per_size_ = 0.0;
};

// A test whether points lie inside a closed surface, in floating point: fast enough for every pose that a search
// evaluates.

/// By rays along z, which meet only the triangles of one column of a grid over the x-y plane. A ray that grazes an edge
/// may give a wrong answer: nothing is proven.
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

// The side of the cavity's surface on which each part of an implant must be, as the search uses it: by sample points.

class SideRequirements {
 public:
  /// Requirements for an implant that may be anywhere.
  SideRequirements() = default;
  /// One side for each primitive. `inside` must outlive this.
  SideRequirements(const InsideTest& inside, std::span<const SurfaceSide> required);

  /// The number of samples on the wrong side: the centres of primitives and the ends of their axes, drawn in a little.
  [[nodiscard]] std::size_t misplaced(const Candidate& candidate) const;

 private:
  const InsideTest* inside_ = nullptr;
  std::vector<SurfaceSide> required_;
};

// All requirements on a candidate besides the limit of penetration.

struct Requirements {
  SideRequirements sides;
  PoseConstraints constraints;
  ContactAim contacts = {};
  SizeAim size = {};

  /// An upper bound of the terms that size and contact add to the objective.
  [[nodiscard]] double most() const { return size.most() + contacts.most(); }

  /// 0 if all requirements but contact are kept; else the number of misplaced samples plus the constraints' violation
  /// in their units.
  [[nodiscard]] double broken(std::span<const double> parameters, const Candidate& candidate) const {
    return static_cast<double>(sides.misplaced(candidate)) + constraints.violation(parameters);
  }
};

}  // namespace verisq::fit_search

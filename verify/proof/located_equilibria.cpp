/// This file implements located_equilibria.hpp.
#include "verify/proof/located_equilibria.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "verify/proof/body_at_rest.hpp"

namespace verisq::verify {
namespace {

/// About 0, wider than `errors`, so that an operator may map it into itself.
PreciseBox inflated(const PreciseBox& errors) {
  constexpr double factor = 1.25;
  constexpr double share_of_largest = 0x1p-40;  // an error of one component reaches others
  constexpr double least = 0x1p-1000;
  double largest = 0.0;
  std::vector<double> sizes;
  for (const PreciseInterval& error : errors) {
    sizes.push_back(abs(error).upper().to_double(Direction::up));
    largest = std::max(largest, sizes.back());
  }
  PreciseBox wide;
  for (const double size : sizes) {
    const Real radius(factor * size + share_of_largest * largest + least);
    wide.emplace_back(-radius, radius);
  }
  return wide;
}

}  // namespace

std::optional<ApproximateMatrix> approximate_inverse(ApproximateMatrix m) {
  const std::size_t size = m.size();
  ApproximateMatrix inverse(size, std::vector<double>(size, 0.0));
  for (std::size_t i = 0; i < size; ++i) inverse[i][i] = 1.0;
  for (std::size_t column = 0; column < size; ++column) {
    std::size_t pivot = column;
    for (std::size_t i = column; i < size; ++i) {
      if (std::fabs(m[i][column]) > std::fabs(m[pivot][column])) pivot = i;
    }
    if (!(std::fabs(m[pivot][column]) > 0.0)) return std::nullopt;
    std::swap(m[column], m[pivot]);
    std::swap(inverse[column], inverse[pivot]);
    for (std::size_t i = 0; i < size; ++i) {
      const double share = m[i][column] / m[column][column];
      if (i == column || share == 0.0) continue;
      for (std::size_t k = 0; k < size; ++k) {
        m[i][k] -= share * m[column][k];
        inverse[i][k] -= share * inverse[column][k];
      }
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (double& entry : inverse[i]) entry /= m[i][i];
    if (!std::ranges::all_of(inverse[i], [](double entry) { return std::isfinite(entry); })) return std::nullopt;
  }
  return inverse;
}

std::optional<FixedPoints> fixed_points(const PreciseBox& z, const std::vector<PreciseBox>& c) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  const auto image_of = [&](const PreciseBox& x) {
    PreciseBox image;
    for (std::size_t i = 0; i < z.size(); ++i) image.push_back(z[i] + dot(c[i], x));
    return image;
  };
  PreciseBox errors = z;
  for (int i = 0; i < most_inflations; ++i) {
    const PreciseBox wide = inflated(errors);
    errors = image_of(wide);
    if (!lies_inside(errors, wide)) continue;
    for (int k = 0; k < refinements; ++k) errors = image_of(errors);
    return FixedPoints{wide, errors};
  }
  return std::nullopt;
}

namespace {

/// The components of the balance, one for each unknown; then the parts of an equilibrium.
template <class T>
std::vector<T> components(const StandingBody& body, const std::vector<T>& parameters, const std::vector<T>& unknowns) {
  Posture<T> posture{unknowns.front(), {}};
  for (const stance::Body& part : body.model.bodies) {
    for (const stance::Joint& joint : part.joints) posture.joints.push_back(T(exact(joint.position)));
  }
  std::vector<T> errors;  // of the joints sought
  for (std::size_t i = 0; i < body.joints.size(); ++i) {
    T& position = posture.joints[body.joints[i]];
    errors.push_back(unknowns[i + 1] - position);
    position = unknowns[i + 1];
  }
  BodyAtRest<T> at = body_at_rest<T>(body.model, parameters, posture, body.reference);
  constexpr std::size_t turns_of_root = 2;
  std::vector<T> list{at.force, at.moment_z, at.moment_x};
  for (std::size_t i = turns_of_root; i < errors.size(); ++i) {
    const std::size_t joint = body.joints[i];
    list.push_back(at.torques[joint] + T(exact(body.stiffness[joint])) * errors[i]);
  }
  list.insert(list.end(), at.penetrations.begin(), at.penetrations.end());
  list.insert(list.end(), at.forces.begin(), at.forces.end());
  list.push_back(at.pressure_x);
  list.push_back(at.pressure_z);
  list.push_back(at.height_of_root);
  list.insert(list.end(), at.torques.begin(), at.torques.end());
  return list;
}

/// The same components with derivatives by the unknowns, then by the uncertain parameters that are no points.
std::vector<Differentiated> derivatives(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures,
                                        std::span<const std::uint32_t> variables) {
  const std::size_t count = postures.size() + variables.size();
  std::vector<Differentiated> parameters(box.begin(), box.end());
  for (std::size_t k = 0; k < variables.size(); ++k) {
    Differentiated& parameter = parameters[variables[k]];
    parameter = Differentiated::variable(parameter.value, postures.size() + k, count);
  }
  std::vector<Differentiated> unknowns;
  for (std::size_t i = 0; i < postures.size(); ++i) unknowns.push_back(Differentiated::variable(postures[i], i, count));
  std::vector<Differentiated> result = components<Differentiated>(body, parameters, unknowns);
  for (Differentiated& component : result) component.by.resize(count, PreciseInterval(0));
  return result;
}

}  // namespace

std::optional<LocatedEquilibria> LocatedEquilibria::in(const StandingBody& body, const PreciseBox& box,
                                                       const PreciseBox& postures) {
  LocatedEquilibria located(body, box, postures);
  if (!located.locate(postures)) return std::nullopt;
  return located;
}

PreciseBox LocatedEquilibria::ranges() const {
  PreciseBox result = line_;
  for (std::size_t i = 0; i < unknowns(); ++i) result[i] += errors_[i];
  for (std::size_t c = unknowns(); c < over_.size(); ++c) {
    PreciseInterval range = at_[c] + dot(by_unknowns(c), errors_);
    for (std::size_t k = 0; k < variables_.size(); ++k) range += along_line(c, k) * deviations_[k];
    result.push_back(range);
  }
  return result;
}

std::optional<PreciseBox> LocatedEquilibria::derivatives_by(std::size_t k) const {
  PreciseBox missing;
  for (std::size_t c = 0; c < unknowns(); ++c) missing.push_back(along_line(c, k));
  const auto beside_line = fixed_points(preconditioned(missing), rest_);
  if (!beside_line) return std::nullopt;
  PreciseBox result;
  for (std::size_t i = 0; i < unknowns(); ++i) result.push_back(beside_line->found[i] + exact(slopes_[i][k]));
  for (std::size_t c = unknowns(); c < over_.size(); ++c)
    result.push_back(along_line(c, k) + dot(by_unknowns(c), beside_line->found));
  return result;
}

PreciseBox LocatedEquilibria::about(const PreciseBox& part) const {
  PreciseBox result;
  for (std::size_t i = 0; i < unknowns(); ++i) {
    PreciseInterval side = exact(middle_[i]) + errors_[i] + (errors_[i] - errors_[i]);
    for (std::size_t k = 0; k < variables_.size(); ++k)
      side += exact(slopes_[i][k]) * (part[variables_[k]] - exact(middle_of(box_[variables_[k]])));
    result.push_back(side);
  }
  return result;
}

LocatedEquilibria::LocatedEquilibria(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures)
    : box_(box), middle_(middles_of(postures)) {
  for (const std::uint32_t k : body.uncertain) {
    if (box[k].lower() < box[k].upper()) variables_.push_back(k);
  }
  over_ = derivatives(body, box, postures, variables_);
  at_ = components<PreciseInterval>(body, middle_parameters(), exact(middle_));
}

PreciseBox LocatedEquilibria::middle_parameters() const {
  PreciseBox result = box_;
  for (const std::uint32_t k : variables_) result[k] = exact(middle_of(box_[k]));
  return result;
}

PreciseInterval LocatedEquilibria::along_line(std::size_t c, std::size_t k) const {
  PreciseInterval result = by_variable(c, k);
  for (std::size_t i = 0; i < unknowns(); ++i) result += by_unknowns(c)[i] * exact(slopes_[i][k]);
  return result;
}

PreciseBox LocatedEquilibria::preconditioned(const PreciseBox& v) const {
  PreciseBox result;
  for (const std::vector<double>& row : inverse_) result.push_back(-dot(row, v));
  return result;
}

bool LocatedEquilibria::locate(const PreciseBox& postures) {
  ApproximateMatrix jacobian;
  for (std::size_t i = 0; i < unknowns(); ++i) {
    const std::span<const PreciseInterval> row = by_unknowns(i);
    jacobian.push_back(middles_of(row));
  }
  std::optional<ApproximateMatrix> inverse = approximate_inverse(std::move(jacobian));
  if (!inverse) return false;
  inverse_ = *std::move(inverse);
  set_slopes();
  for (std::size_t i = 0; i < unknowns(); ++i) {
    PreciseBox row;
    for (std::size_t j = 0; j < unknowns(); ++j) {
      PreciseInterval entry = i == j ? 1 : 0;
      for (std::size_t k = 0; k < unknowns(); ++k) entry -= exact(inverse_[i][k]) * by_unknowns(k)[j];
      row.push_back(entry);
    }
    rest_.push_back(std::move(row));
  }
  for (const std::uint32_t k : variables_) deviations_.push_back(box_[k] - exact(middle_of(box_[k])));
  PreciseBox missing;  // on the line, for all parameters of the box, by the mean value theorem
  for (std::size_t c = 0; c < unknowns(); ++c) {
    PreciseInterval sum = at_[c];
    for (std::size_t k = 0; k < variables_.size(); ++k) sum += along_line(c, k) * deviations_[k];
    missing.push_back(sum);
  }
  const auto errors = fixed_points(preconditioned(missing), rest_);
  if (!errors) return false;
  errors_ = errors->found;
  PreciseBox reached;
  for (std::size_t i = 0; i < unknowns(); ++i) {
    PreciseInterval side = exact(middle_[i]);
    for (std::size_t k = 0; k < variables_.size(); ++k) side += exact(slopes_[i][k]) * deviations_[k];
    line_.push_back(side);
    reached.push_back(side + errors->tried[i]);
  }
  // The line, and the errors about it, must lie where the derivatives are enclosed.
  return lies_within(line_, postures) && lies_within(reached, postures);
}

void LocatedEquilibria::set_slopes() {
  for (const std::vector<double>& row : inverse_) {
    std::vector<double> slopes;
    for (std::size_t k = 0; k < variables_.size(); ++k) {
      double sum = 0.0;
      for (std::size_t c = 0; c < unknowns(); ++c) sum -= row[c] * middle_of(by_variable(c, k));
      slopes.push_back(std::isfinite(sum) ? sum : 0.0);
    }
    slopes_.push_back(std::move(slopes));
  }
}

}  // namespace verisq::verify

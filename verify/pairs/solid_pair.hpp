/// Two models of any kind, one of which is moved, and what single evaluations prove about their distance.
#pragma once

#include <vector>

#include "verify/pairs/posed_sections.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// A model's places, and its primitives' sections.
struct SolidParts {
  explicit SolidParts(const Model& model)
      : places(model), primitives(model.primitives), sections(model.primitives.begin(), model.primitives.end()) {}

  ExactChecker places;
  std::vector<Primitive> primitives;
  std::vector<PosedSections> sections;
};

/// A and B moved. Both must outlive this.
class SolidPair {
 public:
  SolidPair(const SolidParts& a, const SolidParts& b, const Pose& pose) : a_(&a), b_(&b), motion_(pose) {}

  /// What the certificate proves, as PairChecker says.
  [[nodiscard]] Enclosure proven_distance(const PairCertificate& certificate) const;

 private:
  using Section = PosedSections::Section;

  [[nodiscard]] bool share(const Point& x) const;
  [[nodiscard]] double upper(const std::array<Point, 2>& near_points) const;
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;
  [[nodiscard]] double lower_by(const DividedSeparation& separation) const;

  const SolidParts* a_;
  const SolidParts* b_;
  RigidMotion motion_;  ///< from the frame of model B to that of model A
};

}  // namespace verisq::verify

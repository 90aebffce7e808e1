/// Two models of any kind, one of which moves, and what single evaluations prove about their distance.
#pragma once

#include <vector>

#include "verify/pairs/posed_sections.hpp"
#include "verify/pairs/short_motion.hpp"
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

/// A, and B that moves for a short time. Both must outlive this.
class SolidPair {
 public:
  SolidPair(const SolidParts& a, const SolidParts& b, const ShortMotion& motion)
      : a_(&a), b_(&b), motion_(motion), pose_(motion.pose()) {}

  /// What the certificate proves of the distance at the moment, as PairChecker says.
  [[nodiscard]] Enclosure at_moment(const PairCertificate& certificate) const;

  /// The certificate proves that the distance is no less at any time of the motion. Rounded down; may be negative.
  [[nodiscard]] double lower(const PairCertificate& certificate) const;

 private:
  using Section = PosedSections::Section;

  [[nodiscard]] bool share(const Point& x) const;
  [[nodiscard]] double upper(const std::array<Point, 2>& near_points) const;
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;
  [[nodiscard]] double lower_by(const DividedSeparation& separation) const;

  const SolidParts* a_;
  const SolidParts* b_;
  ShortMotion motion_;
  RigidMotion pose_;  ///< from the frame of model B to that of model A, at the moment
};

}  // namespace verisq::verify

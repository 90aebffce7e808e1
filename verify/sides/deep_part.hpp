/// The points of a primitive that lie deeper in it than a limit: that triangles keep off them, that its centre is one,
/// that they are connected (docs/mathematics.md §22).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "verify/pairs/posed_sections.hpp"
#include "verify/proposals/nearest_normal.hpp"
#include "verify/proposals/section_mapping.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// All that is said is proven in 127-bit interval arithmetic; false says nothing. Immutable: safe to ask from many
/// threads.
class DeepPart {
 public:
  /// Preconditions: limit finite, at least 0; of a bend that it keeps off its centre and is less than a full turn.
  DeepPart(const Primitive& primitive, double limit);

  /// That no point of the triangles lies deeper in the primitive. False, too, where that takes too many half-spaces:
  /// the fewer the nearer those triangles are to each other. Precondition: finite.
  [[nodiscard]] bool keeps_off(std::span<const Triangle> triangles) const;

  /// That the centre, where the pose takes the origin, lies deeper.
  [[nodiscard]] bool holds_centre() const;

  [[nodiscard]] bool is_connected() const;

 private:
  using Plain = Coordinates<double>;

  /// In the primitive's own frame, enclosed and about.
  struct Corner {
    PreciseVector exact;
    Plain about;
  };
  using Corners = std::vector<Corner>;

  /// Whole triangles, or a part of one, and the points of the primitive between two heights.
  struct Case {
    Corners corners;  ///< of each triangle three, one after the other
    PosedSections::Section section;
  };
  using Halves = std::optional<std::array<Case, 2>>;

  [[nodiscard]] bool are_apart(const Case& part) const;
  [[nodiscard]] PosedSections::Section widened(const PosedSections::Section& section) const;
  [[nodiscard]] Halves halves(const Case& part) const;
  /// Nothing where none is about to separate them.
  [[nodiscard]] std::optional<Point> proposed_normal(const Corners& corners,
                                                     const SectionMapping::Section& section) const;
  [[nodiscard]] Plain normal_near(const Plain& x) const;

  Primitive primitive_;
  double limit_;
  PosedSections sections_;
  SectionMapping mapping_;
  NearestNormal nearest_;
  double focus_;   ///< along z, about: of the unbent solid
  double beyond_;  ///< how much the height before the bend may change on a way as long as `limit_`
};

}  // namespace verisq::verify

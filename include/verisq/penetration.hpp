/// How deep two solids reach into each other: enclosed penetration depths, and what proves them again.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// The penetration depth is the length of the shortest translation of B that leaves no common point of the interiors of
// A and B (docs/mathematics.md §30). It is 0 of solids that are apart, or only touch.

/// Bounds the depth of two convex primitives from below: a closed surface of points of A - B about the origin.
struct DifferenceSurface {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  Mesh surface;             ///< in the own frame of A's primitive
  std::vector<Point> on_a;  ///< for each vertex p a point a of A's primitive, in its own frame: a - p lies in B's
};

/// A ball in a solid.
struct InnerBall {
  Point centre;   ///< in the model's own frame
  double radius;  ///< as far as `proof` proves it
  Certificate proof;
};

/// B's translation that parts it from A, as far as `proof` proves.
struct PartingTranslation {
  Point translation;  ///< in the frame of A, after the pose
  PairCertificate proof;
};

/// The proof of an enclosure of a penetration depth. The upper end is the better one of `direction` and `parting`, the
/// lower end the better one of `surface` and `balls`, or 0.
struct PenetrationCertificate {
  /// In the frame of A: B is moved along it until a plane at a right angle to it has A on one side, B on the other.
  Point direction = {};
  std::optional<PartingTranslation> parting = {};
  std::optional<DifferenceSurface> surface = {};
  /// A ball in A and one in B: the solids cannot be parted before these.
  std::optional<std::array<InnerBall, 2>> balls = {};
};

/// An enclosure that its certificate proves.
struct CertifiedPenetration {
  Enclosure depth;
  PenetrationCertificate certificate;
};

/// Proves penetration depths again from their certificates, by MPFR alone. Immutable after construction: safe to call
/// from many threads.
class PenetrationChecker {
 public:
  /// Throws Error(input) as PairChecker does.
  PenetrationChecker(const Model& a, const Model& b);

  /// Returns what the certificate proves about the penetration depth of A and of B moved by `pose`, whatever it holds:
  /// [0, infinity] if it proves nothing. Once `interrupted`, polled unless empty, says so, less is proven.
  [[nodiscard]] Enclosure prove(const Pose& pose, const PenetrationCertificate& certificate,
                                const std::function<bool()>& interrupted = {}) const;

  /// Judges a claim about this depth: never `proved` for an enclosure that does not contain it. `unproved` says nothing
  /// once interrupted. Precondition: `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Pose& pose, const Enclosure& claimed,
                                   const PenetrationCertificate& certificate,
                                   const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

struct PenetrationOptions {
  double tolerance;  ///< in model units: stop at this width; 0: at that of rounding errors
  /// In the frame of A, a point of both solids if one is known: where the search for inner balls begins.
  std::optional<Point> common = {};
  std::function<bool()> interrupted = {};  ///< polled; true ends the search
};

/// Encloses penetration depths of two exact models of any kind. Immutable after construction: safe to call from many
/// threads.
class PenetrationDepth {
 public:
  /// Throws Error(input) as PairChecker does.
  PenetrationDepth(const Model& a, const Model& b);

  /// Encloses the penetration depth of A and of B moved by `pose`: what the certificate proves. Two convex solids:
  /// works until the enclosure is at most the tolerance wide, or out of its budget of triangles, as where the solids
  /// are alike and have about the same centre. Other solids: valid, and as a rule wide. Once interrupted what is proven
  /// by then.
  [[nodiscard]] CertifiedPenetration operator()(const Pose& pose, const PenetrationOptions& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

}  // namespace verisq

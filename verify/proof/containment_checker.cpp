/// The unions of side_checker.hpp, and the ContainmentChecker of recovery.hpp.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <verisq/clearance.hpp>
#include <verisq/error.hpp>

#include "verify/proof/check_steps.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verify/proof/side_checker.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

void Nerve::Rank::add(Chain chain) {
  while (!chain.empty()) {
    const auto [found, is_new] = by_last_.try_emplace(chain.back(), chain);
    if (is_new) return;
    Chain sum;
    std::ranges::set_symmetric_difference(chain, found->second, std::back_inserter(sum));
    chain = std::move(sum);
  }
}

Nerve::Nerve(std::size_t bodies, const std::function<bool(std::size_t, std::size_t)>& may_meet)
    : bodies_(bodies), may_meet_(bodies * bodies) {
  for (std::size_t i = 0; i < bodies; ++i)
    for (std::size_t j = i + 1; j < bodies; ++j) may_meet_[i * bodies + j] = may_meet(i, j);
  Rank boundaries;
  for (std::uint32_t i = 0; i < bodies; ++i)
    for (std::uint32_t j = i + 1; j < bodies; ++j)
      for (std::uint32_t k = j + 1; this->may_meet(i, j) && k < bodies; ++k)
        if (this->may_meet(i, k) && this->may_meet(j, k)) threes_.push_back({i, j, k});
  for (const Three& group : threes_) boundaries.add(boundary(group));
  cycles_ = threes_.size() - boundaries();
}

std::vector<Nerve::Four> Nerve::fours() const {
  std::vector<Four> groups;
  for (const auto& [i, j, k] : threes_)
    for (std::uint32_t l = k + 1; l < bodies_; ++l)
      if (may_meet(i, l) && may_meet(j, l) && may_meet(k, l)) groups.push_back({i, j, k, l});
  return groups;
}

/// The boundary of a group of three: its pairs, numbered i + bodies * j.
Nerve::Chain Nerve::boundary(const Three& group) const {
  const auto pair = [this](std::uint32_t i, std::uint32_t j) { return static_cast<std::uint32_t>(i + bodies_ * j); };
  Chain chain{pair(group[0], group[1]), pair(group[0], group[2]), pair(group[1], group[2])};
  std::ranges::sort(chain);
  return chain;
}

/// Adds the boundary of the four: its groups of three, by their places. Four bodies with a common point may meet in
/// pairs: their groups of three are among the nerve's groups.
void Nerve::add(const Four& common) {
  Chain chain;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    Three face{};
    for (std::size_t i = 0, k = 0; i < 4; ++i)
      if (i != left_out) face[k++] = common[i];
    const auto place = std::ranges::lower_bound(threes_, face);
    if (place == threes_.end() || *place != face) {
      throw Error(ErrorKind::failure, "four solids have a common point, and two of them are proven to be apart");
    }
    chain.push_back(static_cast<std::uint32_t>(place - threes_.begin()));
  }
  std::ranges::sort(chain);
  filled_.add(std::move(chain));
}

namespace {

/// Pairs (i, j), i < j, that are proven to have no common point: by the spheres about them, or by a separation.
std::vector<bool> apart(const Model& model, std::span<const Separation> separations) {
  const PosedPrimitives posed(model);
  const PosedPairs pairs(posed, posed, Pose{});
  const std::size_t count = model.primitives.size();
  std::vector<bool> result(count * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) result[i * count + j] = pairs.lower_by_spheres(i, j) > 0.0;
  for (const Separation& separation : separations) {
    const std::size_t i = separation.primitive_a;
    const std::size_t j = separation.primitive_b;
    if (i < j && j < count && pairs(i, j).distance(separation).lo > 0.0) result[i * count + j] = true;
  }
  return result;
}

bool ascend(const Nerve::Four& group, std::size_t count) {
  return group[0] < group[1] && group[1] < group[2] && group[2] < group[3] && group[3] < count;
}

}  // namespace

bool is_without_cavities(std::span<const Primitive> primitives, const ContainmentCertificate& certificate,
                         const std::function<bool()>& interrupted) {
  const std::size_t count = primitives.size();
  if (count == 1) return true;  // the image of a ball under a continuous map with a continuous inverse
  if (std::ranges::any_of(primitives, is_bent)) return false;
  if (count < 4) return true;  // a sphere in a complex takes four vertices
  const std::vector<bool> are_apart = apart({"", {primitives.begin(), primitives.end()}, {}}, certificate.apart);
  Nerve nerve(count, [&](std::size_t i, std::size_t j) { return !are_apart[i * count + j]; });
  std::vector<PosedSuperquadric> posed;
  for (const Primitive& primitive : primitives) posed.emplace_back(primitive);
  for (const auto& [group, point] : certificate.common) {
    if (nerve.is_without_cavities() || interrupted()) break;
    if (!ascend(group, count)) continue;
    if (std::ranges::all_of(group, [&, &at = point](std::uint32_t i) { return posed[i].contains(precise(at)); }))
      nerve.add(group);
  }
  return !interrupted() && nerve.is_without_cavities();
}

namespace {

/// A point of a triangle: an interval, for a midpoint of binary64 numbers need not be one.
struct Corner {
  PreciseVector exact;
  Point about;               ///< the same, rounded: decides which side is longest, and proves nothing
  std::vector<bool> bodies;  ///< the bodies that are proven to contain it
};

struct Piece {
  std::array<Corner, 3> corners;
  int halvings = 0;
};

/// Smaller pieces differ by rounding alone.
constexpr int most_halvings = 60;
/// A triangle that takes more pieces is left unproved.
constexpr std::size_t most_pieces = 1U << 14U;

Corner corner_at(const PreciseVector& exact, const Point& about, std::span<const PosedSuperquadric> bodies) {
  Corner corner{exact, about, {}};
  for (const PosedSuperquadric& body : bodies) corner.bodies.push_back(!body.misses(exact) && body.contains(exact));
  return corner;
}

bool is_in_some(const Corner& corner) {
  return std::ranges::find(corner.bodies, true) != corner.bodies.end();
}

/// A convex body contains the triangle of three of its points.
bool is_in_one(const Piece& piece) {
  const auto& [a, b, c] = piece.corners;
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    if (a.bodies[k] && b.bodies[k] && c.bodies[k]) return true;
  }
  return false;
}

/// Returns i where the longest side leads from corner i to the next one.
std::size_t longest_side(const Piece& piece) {
  const auto length = [&](std::size_t i) {
    const Point& from = piece.corners[i].about;
    const Point& to = piece.corners[(i + 1) % 3].about;
    return std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  };
  const std::array<double, 3> lengths{length(0), length(1), length(2)};
  return static_cast<std::size_t>(std::ranges::max_element(lengths) - lengths.begin());
}

Corner middle_of(const Corner& a, const Corner& b, std::span<const PosedSuperquadric> bodies) {
  const PreciseInterval half{Real(0.5)};
  PreciseVector exact = a.exact;
  Point about{};
  for (std::size_t k = 0; k < 3; ++k) {
    exact[k] = half * (a.exact[k] + b.exact[k]);
    about[k] = 0.5 * a.about[k] + 0.5 * b.about[k];
  }
  return corner_at(exact, about, bodies);
}

}  // namespace

bool lies_in_union(const Triangle& triangle, std::span<const PosedSuperquadric> bodies,
                   const std::function<bool()>& interrupted) {
  const auto corner = [&](std::size_t i) { return corner_at(precise(triangle[i]), triangle[i], bodies); };
  std::vector<Piece> open{{{corner(0), corner(1), corner(2)}}};
  // If no body contains a point, every piece about the point stays open.
  if (!std::ranges::all_of(open.back().corners, is_in_some)) return false;
  for (std::size_t pieces = 0; !open.empty(); ++pieces) {
    if (pieces == most_pieces || interrupted()) return false;
    const Piece piece = std::move(open.back());
    open.pop_back();
    if (is_in_one(piece)) continue;
    if (piece.halvings == most_halvings) return false;
    const std::size_t from = longest_side(piece);
    const std::size_t to = (from + 1) % 3;
    const Corner middle = middle_of(piece.corners[from], piece.corners[to], bodies);
    if (!is_in_some(middle)) return false;
    for (const std::size_t moved : {from, to}) {
      Piece half = piece;
      half.corners[moved] = middle;
      ++half.halvings;
      open.push_back(std::move(half));
    }
  }
  return true;
}

}  // namespace verisq::verify

namespace verisq {

struct ContainmentChecker::State {
  State(const Model& m, const Mesh& s) : model(m), mesh(s), sides(m, s, 0.0), surface(verify::triangles_of(s)) {}

  Model model;
  Mesh mesh;
  SideChecker sides;
  verify::ClosedSurface surface;
};

ContainmentChecker::ContainmentChecker(const Model& model, const Mesh& mesh) {
  verify::require_valid(model);
  if (model.csg) throw Error(ErrorKind::input, "containment: the model has set operations, not primitives alone");
  state_ = hidden<State>(model, mesh);
  if (state_->sides.rims() > 0) throw Error(ErrorKind::input, "containment: the mesh is not closed");
}

namespace {

/// The side proves that the interior of each primitive does not meet the mesh, and it contains the primitive's centre.
/// Parity decides whether the centre lies in the mesh's solid. Winding numbers cannot decide it if the mesh crosses
/// itself: there it may wind twice, or in the opposite sense.
ContainmentFinding checked_within(const Model& model, const SideChecker& sides, const verify::ClosedSurface& surface,
                                  const CheckOptions& options) {
  for (std::uint32_t k = 0; k < model.primitives.size(); ++k) {
    const SideFinding finding = sides({k, SurfaceSide::inside}, options);
    if (options.interrupted()) return {Verdict::unproved, "interrupted"};
    const std::optional<bool> odd = surface.odd(model.primitives[k].pose.translation);
    const std::string name = name_of_primitive(model, k);
    if (odd == false) return {Verdict::refuted, fmt::format("{}: its centre lies outside the mesh", name)};
    if (finding != SideFinding::kept) return {Verdict::unproved, fmt::format("{}: {}", name, to_string(finding))};
    if (!odd) return {Verdict::unproved, fmt::format("{}: its centre is too near the mesh", name)};
  }
  return {Verdict::proved, ""};
}

ContainmentFinding checked_around(const Model& model, const Mesh& mesh, const ContainmentCertificate& certificate,
                                  const CheckOptions& options) {
  if (std::ranges::any_of(model.primitives, is_bent)) return {Verdict::unproved, "a primitive is bent"};
  std::vector<verify::PosedSuperquadric> bodies;
  for (const Primitive& primitive : model.primitives) bodies.emplace_back(primitive);
  std::atomic<std::size_t> inside = 0;
  verify::CheckSteps(mesh.triangles.size(), options).each(mesh.triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    if (lies_in_union({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, bodies, options.interrupted)) ++inside;
  });
  if (options.interrupted()) return {Verdict::unproved, "interrupted"};
  if (inside != mesh.triangles.size())
    return {Verdict::unproved,
            fmt::format("{} of {} triangles", mesh.triangles.size() - inside, mesh.triangles.size())};
  if (!verify::is_without_cavities(model.primitives, certificate, options.interrupted))
    return {Verdict::unproved, "the union of the primitives may have cavities"};
  return {Verdict::proved, ""};
}

}  // namespace

ContainmentFinding ContainmentChecker::operator()(Containment claim, const ContainmentCertificate& certificate,
                                                  const CheckOptions& options) const {
  return claim == Containment::within ? checked_within(state_->model, state_->sides, state_->surface, options)
                                      : checked_around(state_->model, state_->mesh, certificate, options);
}

}  // namespace verisq

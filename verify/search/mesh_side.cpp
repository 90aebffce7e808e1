/// This file implements mesh_side.hpp.
#include "verify/search/mesh_side.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/side_checker.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/search/pair_projection.hpp"
#include "verisq/distance.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t pieces_a_task = 256;
/// A piece smaller than this is not halved any more: the remaining width is rounding.
constexpr double smallest_in_displacements = 8.0;

/// A part of a triangle and, solid by solid, the signed distances at its corners and its centre.
struct OpenPiece {
  Triangle corners;
  std::uint32_t triangle;
  std::uint8_t halvings = 0;
  std::array<std::vector<Enclosure>, 3> at_corners;
  std::vector<Enclosure> at_centre = {};
};

enum class Finding : std::uint8_t { open, settled, astray };

/// The pieces for some of the solids: any of these solids settles a piece.
class SidePieces {
 public:
  SidePieces(const Mesh& mesh, SolidSide side, const SideSearch& search, std::span<const std::size_t> solids,
             MeshSide& found)
      : mesh_(mesh), side_(side), search_(search), solids_(solids), found_(found), states_(mesh.triangles.size()) {}

  /// The finding for each triangle.
  std::vector<Finding> operator()() {
    if (!ask_vertices()) return states_;
    open_triangles();
    at_vertices_ = {};
    while (!open_.empty()) {
      if (!ask_centres()) return states_;
      judge();
      if (!halve()) return states_;
    }
    return states_;
  }

 private:
  /// False where it ended early.
  [[nodiscard]] bool ask(std::size_t solid, std::span<const Point> points, std::vector<Enclosure>& rows) {
    rows.assign(points.size(), {-infinity, infinity});
    if (points.empty()) return true;
    found_.ended = found_.ended || search_.ended() || found_.samples + points.size() > search_.most_samples ||
                   !search_.to_solids[solid](points, rows);
    found_.samples += points.size();
    return !found_.ended;
  }

  [[nodiscard]] bool ask_vertices() {
    at_vertices_.resize(solids_.size());
    for (std::size_t k = 0; k < solids_.size(); ++k)
      if (!ask(solids_[k], mesh_.vertices, at_vertices_[k])) return false;
    return true;
  }

  /// An upper bound of how far a sample is astray: beyond the solid that contains it, or beyond the nearest of all.
  [[nodiscard]] double excess(std::span<const Enclosure> rows) const {
    double least_low = infinity;
    double least_high = infinity;
    for (const Enclosure& row : rows) {
      least_low = std::min(least_low, row.lo);
      least_high = std::min(least_high, row.hi);
    }
    return side_ == SolidSide::outside ? -least_low : least_high;
  }

  /// Proven to be on the wrong side.
  [[nodiscard]] bool is_astray(std::span<const Enclosure> rows) const {
    if (side_ == SolidSide::outside)
      return std::ranges::any_of(rows, [](const Enclosure& row) { return row.hi < 0.0; });
    return std::ranges::all_of(rows, [](const Enclosure& row) { return row.lo > 0.0; });
  }

  void open_triangles() {
    std::vector<std::vector<Enclosure>> rows(mesh_.vertices.size());
    std::vector<bool> astray(mesh_.vertices.size());
    for (std::size_t v = 0; v < rows.size(); ++v) {
      for (std::size_t k = 0; k < solids_.size(); ++k) rows[v].push_back(at_vertices_[k][v]);
      astray[v] = is_astray(rows[v]);
    }
    note_corners(astray, rows);
    for (std::uint32_t n = 0; n < mesh_.triangles.size(); ++n) {
      const auto& [a, b, c] = mesh_.triangles[n];
      const OpenPiece piece{.corners = {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]},
                            .triangle = n,
                            .at_corners = {rows[a], rows[b], rows[c]}};
      if (astray[a] || astray[b] || astray[c])
        states_[n] = Finding::astray;
      else if (settled_by_corners(piece))
        states_[n] = Finding::settled;
      else
        open_.push_back(piece);
    }
    count_open();
  }

  /// Vertices that no triangle uses are ignored.
  void note_corners(std::vector<bool> astray, const std::vector<std::vector<Enclosure>>& rows) {
    for (const auto& triangle : mesh_.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (astray[corner]) found_.astray.push_back({mesh_.vertices[corner], excess(rows[corner])});
        astray[corner] = false;
      }
    }
  }

  /// For a whole triangle, whose corners are exact.
  [[nodiscard]] bool settled_by_corners(const OpenPiece& piece) const {
    const double longest = shape_of(piece.corners, displacement(piece.corners)).longest;
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const std::array corners{piece.at_corners[0][k], piece.at_corners[1][k], piece.at_corners[2][k]};
      // No point is farther from a corner than the longest side, and the distance changes by no more than the point
      // moves.
      const bool outside = std::ranges::any_of(corners, [&](const Enclosure& row) { return row.lo > longest; });
      const bool inside = std::ranges::any_of(corners, [&](const Enclosure& row) { return row.hi < -longest; });
      const bool between = search_.convex[solids_[k]] &&
                           std::ranges::all_of(corners, [](const Enclosure& row) { return row.hi <= 0.0; });
      if (side_ == SolidSide::outside ? outside : inside || between) return true;
    }
    return false;
  }

  [[nodiscard]] bool ask_centres() {
    std::vector<Point> centres(open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) centres[i] = centre(open_[i].corners);
    std::vector<Enclosure> rows;
    for (OpenPiece& piece : open_) piece.at_centre.clear();
    for (const std::size_t solid : solids_) {
      if (!ask(solid, centres, rows)) return false;
      for (std::size_t i = 0; i < open_.size(); ++i)
        open_[i].at_centre.push_back(widened(rows[i], displacement_of(open_[i].triangle)));
    }
    for (std::size_t i = 0; i < open_.size(); ++i)
      if (is_astray(open_[i].at_centre)) found_.astray.push_back({centres[i], excess(open_[i].at_centre)});
    return true;
  }

  [[nodiscard]] double displacement_of(std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return displacement({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]});
  }

  /// A signed distance that vanishes nowhere on a piece, which is connected, has one sign there.
  [[nodiscard]] bool is_settled(const OpenPiece& piece) const {
    const PieceShape shape = shape_of(piece.corners, displacement_of(piece.triangle));
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const Enclosure& at_centre = piece.at_centre[k];
      if (side_ == SolidSide::outside ? !(at_centre.lo > 0.0) : !(at_centre.hi < 0.0)) continue;
      const TrianglePiece of_solid{
          .corners = piece.corners,
          .triangle = piece.triangle,
          .halvings = piece.halvings,
          .convex = search_.convex[solids_[k]],
          .at_corners = {piece.at_corners[0][k], piece.at_corners[1][k], piece.at_corners[2][k]},
          .at_centre = at_centre};
      if (distances_on(of_solid, shape).range.lo > 0.0) return true;
    }
    return false;
  }

  /// Drops the settled pieces, and the other parts of triangles that are astray.
  void judge() {
    std::vector<Finding> findings(open_.size(), Finding::open);
    const std::size_t tasks = (open_.size() + pieces_a_task - 1) / pieces_a_task;
    search_.in_parallel(tasks, [&](std::size_t task) {
      for (std::size_t i = task * pieces_a_task; i < std::min(open_.size(), (task + 1) * pieces_a_task); ++i) {
        if (is_astray(open_[i].at_centre))
          findings[i] = Finding::astray;
        else if (is_settled(open_[i]))
          findings[i] = Finding::settled;
      }
    });
    std::vector<OpenPiece> left;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (findings[i] == Finding::astray) states_[open_[i].triangle] = Finding::astray;
      if (findings[i] == Finding::open) left.push_back(std::move(open_[i]));
    }
    std::erase_if(left, [this](const OpenPiece& piece) { return states_[piece.triangle] == Finding::astray; });
    // Whatever is not open any more, and not astray, is settled.
    for (Finding& state : states_)
      if (state == Finding::open) state = Finding::settled;
    open_ = std::move(left);
    count_open();
  }

  void count_open() {
    for (const OpenPiece& piece : open_) states_[piece.triangle] = Finding::open;
  }

  /// False where it ended early, or nothing can be halved any more.
  [[nodiscard]] bool halve() {
    std::vector<LongestSide> sides(open_.size());
    std::vector<Point> middles(open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const double off = displacement_of(open_[i].triangle);
      if (open_[i].halvings >= most_halvings_of_piece ||
          !(shape_of(open_[i].corners, off).radius > smallest_in_displacements * off))
        return false;
      sides[i] = longest_side(open_[i].corners);
      middles[i] = sides[i].middle;
    }
    std::vector<std::vector<Enclosure>> at_middles(open_.size());
    std::vector<Enclosure> rows;
    for (const std::size_t solid : solids_) {
      if (!ask(solid, middles, rows)) return false;
      for (std::size_t i = 0; i < open_.size(); ++i)
        at_middles[i].push_back(widened(rows[i], displacement_of(open_[i].triangle)));
    }
    std::vector<OpenPiece> parts;
    parts.reserve(2 * open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      OpenPiece& piece = open_[i];
      ++piece.halvings;
      OpenPiece other = piece;
      piece.corners[sides[i].to] = other.corners[sides[i].from] = middles[i];
      piece.at_corners[sides[i].to] = other.at_corners[sides[i].from] = at_middles[i];
      parts.push_back(std::move(piece));
      parts.push_back(std::move(other));
    }
    open_ = std::move(parts);
    return true;
  }

  const Mesh& mesh_;
  SolidSide side_;
  const SideSearch& search_;
  std::span<const std::size_t> solids_;
  MeshSide& found_;
  std::vector<std::vector<Enclosure>> at_vertices_;  // solid by solid
  std::vector<Finding> states_;                      // of the triangles
  std::vector<OpenPiece> open_;
};

/// The finding of both: a triangle is settled if both settle it.
Finding worse(Finding a, Finding b) {
  if (a == Finding::astray || b == Finding::astray) return Finding::astray;
  return a == Finding::open || b == Finding::open ? Finding::open : Finding::settled;
}

}  // namespace

MeshSide mesh_side(const Mesh& mesh, SolidSide side, const SideSearch& search) {
  MeshSide found;
  std::vector<std::size_t> solids(search.to_solids.size());
  for (std::size_t k = 0; k < solids.size(); ++k) solids[k] = k;
  // Outside of all means outside of each; inside means inside of any.
  const std::size_t at_once = side == SolidSide::outside ? 1 : solids.size();
  std::vector<Finding> states(mesh.triangles.size(), Finding::settled);
  for (std::size_t k = 0; k < solids.size(); k += at_once) {
    const std::vector<Finding> own = SidePieces(mesh, side, search, std::span(solids).subspan(k, at_once), found)();
    for (std::size_t n = 0; n < states.size(); ++n) states[n] = worse(states[n], own[n]);
  }
  found.proven = static_cast<std::uint64_t>(std::ranges::count(states, Finding::settled));
  found.refuted = static_cast<std::uint64_t>(std::ranges::count(states, Finding::astray));
  found.undecided = static_cast<std::uint64_t>(std::ranges::count(states, Finding::open));
  return found;
}

namespace {

/// Rounded to nearest: for a proposal.
PlacedSuperquadric placed_in_model(const PosedSuperquadric& posed) {
  const auto nearest = [](const PreciseInterval& x) { return static_cast<double>(x.lower().to_long_double()); };
  PlacedSuperquadric placed{.solid = posed.superquadric(), .rotation = {}, .offset = {}};
  for (int i = 0; i < 3; ++i) {
    placed.offset[i] = nearest(posed.motion().translation[i]);
    for (int j = 0; j < 3; ++j) placed.rotation(i, j) = nearest(posed.motion().rotation(i, j));
  }
  return placed;
}

/// A point of all four that is found and proven to be one.
std::optional<Point> common_point_of(const Nerve::Four& group, std::span<const PosedSuperquadric> posed) {
  std::vector<PlacedSuperquadric> placed;
  for (const std::uint32_t i : group) placed.push_back(placed_in_model(posed[i]));
  const std::optional<Eigen::Vector3d> found = common_point(placed);
  if (!found) return std::nullopt;
  const Point point{(*found)[0], (*found)[1], (*found)[2]};
  const bool is_common = std::ranges::all_of(group, [&](std::uint32_t i) { return posed[i].contains(point); });
  return is_common ? std::optional(point) : std::nullopt;
}

}  // namespace

ContainmentCertificate certified_union(std::span<const Primitive> primitives, const std::function<bool()>& ended) {
  ContainmentCertificate certificate;
  if (primitives.size() < 4 || std::ranges::any_of(primitives, is_bent)) return certificate;
  Nerve nerve(primitives.size(), [&](std::size_t i, std::size_t j) {
    const PairDistance distance(Model{"", {primitives[i]}, {}}, Model{"", {primitives[j]}, {}});
    const ModelDistance found = distance();
    if (found.proximity != Proximity::separated) return true;
    for (Separation separation : found.certificate.separations) {
      separation.primitive_a = static_cast<std::uint32_t>(i);
      separation.primitive_b = static_cast<std::uint32_t>(j);
      certificate.apart.push_back(separation);
    }
    return false;
  });
  std::vector<PosedSuperquadric> posed;
  for (const Primitive& primitive : primitives) posed.emplace_back(primitive);
  for (const Nerve::Four& group : nerve.fours()) {
    if (nerve.is_without_cavities() || ended()) break;
    const std::optional<Point> point = common_point_of(group, posed);
    if (!point) continue;
    certificate.common.push_back({group, *point});
    nerve.add(group);
  }
  return certificate;
}

}  // namespace verisq::verify

/// Divides triangles generation by generation, and requests certificates of the points that this needs.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/errors/refusal.hpp"
#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/model_distances.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/deviation.hpp"

namespace verisq {
namespace {

using verify::Direction;
using verify::TrianglePiece;
using verify::WeightedCell;

constexpr std::size_t samples_at_a_time = 256;
constexpr std::size_t bytes_of_divided_triangle = 50;  // of a certificate file, without samples
constexpr std::size_t bytes_of_told_vertex = 6;
/// A piece smaller than this is not halved any more: the remaining width is rounding.
constexpr double smallest_halved = 8.0;  // in displacements
/// The open part of triangles is reduced by this factor while the claims are not reached.
constexpr double narrower = 0.7;
constexpr double least_of_width = 1e-3;

/// A triangle or a part of it, with the data that bound its distances.
struct TrianglePart {
  TrianglePiece piece;
  WeightedCell cell;
  double radius;
  PieceProof proof = PieceProof::corners;
  CertifiedEnclosure sample = {};  ///< unless corners are enough
  std::size_t first_half = 0;      ///< of two halves that follow each other, if it is halved
};

class ContactProver {
 public:
  /// All must outlive this.
  ContactProver(const Mesh& mesh, const ContactTerms& terms, const CertifiedSamples& samples,
                const SeenInterruption& interrupted)
      : mesh_(mesh), terms_(terms), samples_(samples), interrupted_(interrupted) {}

  /// Each vertex by its own certificate, or by that of its teller.
  template <class Progress>
  void certify_vertices(std::span<const std::uint32_t> tellers, const Progress& progress) {
    vertices_.resize(tellers.size());
    std::vector<std::uint32_t> own;
    for (std::uint32_t v = 0; v < tellers.size(); ++v) {
      vertices_[v].told_by = tellers[v];
      if (tellers[v] == v) own.push_back(v);
    }
    in_parallel_steps(own.size(), samples_at_a_time, interrupted_, progress,
                      [&](std::size_t i) { vertices_[own[i]].own = at(mesh_.vertices[own[i]]); });
    for (const VertexProof& vertex : vertices_) bytes_ += vertex.own ? size_of(*vertex.own) : bytes_of_told_vertex;
  }

  /// Until of each region as much is known as was `found`, or the file would be too large.
  template <class Progress>
  void divide(std::span<const AreaWithin> found, std::size_t bytes, const Progress& progress) {
    add_triangles();
    shares_of_width_.assign(found.size(), 1.0);
    while (!interrupted_() && bytes_ < bytes) {
      double reached = 1.0;
      const std::vector<std::size_t> chosen = chosen_for(found, reached);
      progress(reached);
      if (chosen.empty()) return;
      refine(chosen);
    }
  }

  /// The certificate of all divided parts. Leaves nothing behind.
  [[nodiscard]] ContactCertificate certificate() {
    ContactCertificate certificate{.vertices = std::move(vertices_), .triangles = {}, .surface = {}};
    for (std::uint32_t n = 0; n < mesh_.triangles.size(); ++n) {
      if (parts_[n].proof == PieceProof::corners) continue;
      certificate.triangles.push_back({n, {}});
      append(parts_[n], certificate.triangles.back().proof);
    }
    return certificate;
  }

 private:
  struct RefinedPart {
    TrianglePart part;
    std::optional<std::array<TrianglePart, 2>> halves;
  };

  [[nodiscard]] CertifiedEnclosure at(const Point& x) const {
    return samples_.at(x, [this] { return interrupted_(); });
  }

  /// The row of a vertex, as the checker computes it.
  [[nodiscard]] Enclosure row(std::uint32_t vertex) const {
    const auto& [own, told_by] = vertices_[vertex];
    if (own) return own->distance;
    const auto& teller = vertices_[told_by].own;
    if (!teller) return {-infinity, infinity};  // interrupted
    return verify::widened(teller->distance, verify::distance_up(mesh_.vertices[told_by], mesh_.vertices[vertex]));
  }

  void add_triangles() {
    parts_.reserve(mesh_.triangles.size());
    for (std::uint32_t n = 0; n < mesh_.triangles.size(); ++n) {
      const auto& [a, b, c] = mesh_.triangles[n];
      const Triangle corners{mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
      displacements_.push_back(verify::displacement(corners));
      areas_.push_back(verify::area_of(corners));
      parts_.push_back(by_corners({.corners = corners, .triangle = n, .at_corners = {row(a), row(b), row(c)}}));
    }
  }

  [[nodiscard]] verify::PieceShape shape_of(const TrianglePiece& piece) const {
    return verify::shape_of(piece.corners, displacements_[piece.triangle]);
  }

  void bound(TrianglePart& part, const verify::PieceShape& shape) const {
    const verify::PieceDistances distances = distances_on(part.piece, shape);
    const Enclosure& area = areas_[part.piece.triangle];
    const double share = std::ldexp(1.0, -part.piece.halvings);
    part.radius = shape.radius;
    part.cell = {{multiply(area.lo, share, Direction::down), multiply(area.hi, share, Direction::up)},
                 distances.range,
                 distances.mean,
                 distances.affine};
  }

  [[nodiscard]] TrianglePart by_corners(TrianglePiece piece) const {
    const verify::PieceShape shape = shape_of(piece);
    piece.convex = samples_.convex();
    piece.at_centre = at_centre_by_corners(piece, shape);
    TrianglePart part{.piece = piece, .cell = {}, .radius = 0.0};
    bound(part, shape);
    return part;
  }

  [[nodiscard]] double open_in(const TrianglePart& part) const {
    const Enclosure within = part_up_to(part.cell, terms_.distance);
    return part.cell.weight.hi * (within.hi - within.lo);
  }

  /// Bounds the part by its corners and its centroid.
  void add_centre(TrianglePart& part) const {
    const double off = displacements_[part.piece.triangle];
    const verify::PieceShape shape = shape_of(part.piece);
    const Point centre = verify::centre(part.piece.corners);
    part.proof = PieceProof::centre;
    part.sample = at(centre);
    const Enclosure widened = verify::widened(part.sample.distance, off);
    const Enclosure known = part.piece.at_centre;
    part.piece.at_centre = {std::max(widened.lo, known.lo), std::min(widened.hi, known.hi)};
    bound(part, shape);
    if (part.piece.convex || !(open_in(part) > 0.0)) return;
    TrianglePart convex = part;
    convex.piece.convex =
        samples_.is_one_convex(centre, reach_of(part.piece.at_centre, shape, off), convex.sample.certificate);
    if (!convex.piece.convex) return;
    bound(convex, shape);
    if (open_in(convex) < open_in(part)) part = std::move(convex);
  }

  /// Halves the part from the middle of its longest side to the corner across.
  [[nodiscard]] std::array<TrianglePart, 2> halve(TrianglePart& part) const {
    const verify::LongestSide side = verify::longest_side(part.piece.corners);
    part.proof = PieceProof::halved;
    part.sample = at(side.middle);
    const double off = displacements_[part.piece.triangle];
    const auto halves = verify::halves(part.piece, side, verify::widened(part.sample.distance, off));
    return {by_corners(halves[0]), by_corners(halves[1])};
  }

  /// Returns whether one more sample may improve its bounds: smaller pieces are bounded no better than the samples are
  /// known.
  [[nodiscard]] bool is_open(const TrianglePart& part) const {
    if (part.proof == PieceProof::halved) return false;
    if (part.proof == PieceProof::corners) return true;
    return part.piece.halvings < verify::most_halvings_of_piece && part.radius > part.sample.distance.width() &&
           part.radius > smallest_halved * displacements_[part.piece.triangle];
  }

  [[nodiscard]] std::size_t region_of(const TrianglePart& part) const {
    return terms_.regions == 0 ? 0 : terms_.region_of[part.piece.triangle];
  }

  [[nodiscard]] std::vector<std::size_t> chosen_for(std::span<const AreaWithin> found, double& reached) {
    std::vector<std::vector<std::size_t>> leaves(found.size());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i].proof != PieceProof::halved) leaves[region_of(parts_[i])].push_back(i);
    }
    std::vector<bool> chosen(parts_.size(), false);
    for (std::size_t r = 0; r < found.size(); ++r)
      reached = std::min(reached, choose_for(leaves[r], found[r], shares_of_width_[r], chosen));
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i]) indices.push_back(i);
    }
    return indices;
  }

  /// Chooses the leaves with the least known share in contact; returns how near the known share is to the found one.
  /// The claims must not only be as narrow, but also contain the proven enclosure. While they do not, the enclosure
  /// must be narrower, by `share_of_width`.
  [[nodiscard]] double choose_for(std::span<const std::size_t> leaves, const AreaWithin& found, double& share_of_width,
                                  std::vector<bool>& chosen) const {
    std::vector<WeightedCell> cells;
    for (const std::size_t i : leaves) cells.push_back(parts_[i].cell);
    const AreaWithin known = verify::area_within(cells, terms_.distance);
    if (known.share.lo >= found.share.lo && known.share.hi <= found.share.hi) return 1.0;
    std::vector<std::pair<double, std::size_t>> widths;
    double open = 0.0;
    for (const std::size_t i : leaves) {
      const double width = open_in(parts_[i]);
      open += width;
      if (width > 0.0 && is_open(parts_[i])) widths.emplace_back(width, i);
    }
    const double allowed = found.share.width() * found.area.hi;
    while (share_of_width > least_of_width && open <= share_of_width * allowed) share_of_width *= narrower;
    // The others keep no more than half of the allowed width open.
    verify::choose_widest(widths, 2.0 * share_of_width * allowed, chosen);
    return open > 0.0 ? std::min(1.0, share_of_width * allowed / open) : 1.0;
  }

  void refine(std::span<const std::size_t> chosen) {
    std::vector<RefinedPart> refined(chosen.size());
    in_parallel_steps(
        chosen.size(), samples_at_a_time, interrupted_, [](double) {},
        [&](std::size_t i) {
          TrianglePart part = parts_[chosen[i]];
          if (part.proof == PieceProof::corners) {
            add_centre(part);
            refined[i] = {std::move(part), std::nullopt};
          } else {
            const std::array<TrianglePart, 2> halves = halve(part);
            refined[i] = {std::move(part), halves};
          }
        });
    if (interrupted_()) return;
    for (std::size_t i = 0; i < chosen.size(); ++i) replace(parts_[chosen[i]], std::move(refined[i]));
  }

  void replace(TrianglePart& part, RefinedPart refined) {
    const bool is_whole_triangle = part.piece.halvings == 0 && part.proof == PieceProof::corners;
    bytes_ += size_of(refined.part.sample) + (is_whole_triangle ? bytes_of_divided_triangle : 0);
    if (part.proof == PieceProof::centre) bytes_ -= size_of(part.sample);
    part = std::move(refined.part);
    if (!refined.halves) return;
    part.first_half = parts_.size();
    for (TrianglePart& half : *refined.halves) parts_.push_back(std::move(half));
  }

  /// Appends the part in preorder.
  void append(TrianglePart& part, TriangleProof& proof) {
    proof.pieces.push_back(part.proof);
    if (part.proof != PieceProof::corners) proof.samples.push_back(std::move(part.sample));
    if (part.proof != PieceProof::halved) return;
    append(parts_[part.first_half], proof);
    append(parts_[part.first_half + 1], proof);
  }

  const Mesh& mesh_;
  const ContactTerms& terms_;
  const CertifiedSamples& samples_;
  const SeenInterruption& interrupted_;
  std::vector<VertexProof> vertices_;
  std::vector<double> displacements_;  ///< of each triangle
  std::vector<Enclosure> areas_;       ///< for each triangle
  std::vector<TrianglePart> parts_;    ///< all triangles, then halves
  std::vector<double> shares_of_width_;
  std::size_t bytes_ = 0;  ///< size of the file, about
};

/// One flag for each primitive, if the model's surface is asked for.
std::vector<bool> counted_of(const Model& model, const ContactAreaOptions& options) {
  if (!options.of_model) return {};
  return options.counted.empty() ? std::vector<bool>(model.primitives.size(), true) : options.counted;
}

/// About, for the choice of vertices; nothing where they cannot be had.
std::vector<Enclosure> approximate_distances(const Model& model, const Mesh& mesh, const ContactAreaOptions& options) {
  std::vector<Enclosure> rows(mesh.vertices.size(), {-infinity, infinity});
  const MappedDistances to_model(
      model, {.tolerance = contact_tolerance(model), .device = options.device, .interrupted = options.interrupted});
  if (!to_model(mesh.vertices, rows)) rows.assign(mesh.vertices.size(), {-infinity, infinity});
  return rows;
}

/// The cover of the model's own surface; its share shall be as narrow as in `found`.
SurfaceCover cover_of(const Model& model, const Mesh& mesh, const AreaWithin& found, const ContactAreaOptions& options,
                      std::size_t bytes, const SeenInterruption& interrupted) {
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  const PatchPlacer placer(model, interrupted);
  const double allowed = std::max(options.share_width, found.share.width());
  const CoverGoal choose = [&](std::span<const WeightedCell> cells, std::vector<bool>& chosen) {
    verify::choose_for_share(cells, verify::area_within(cells, options.distance), options.distance, allowed, chosen);
  };
  const std::vector<bool> counted = counted_of(model, options);
  return certified_cover({.model = model,
                          .triangles = tree,
                          .placer = placer,
                          .counted = counted,
                          .largest = infinity,
                          .choose = choose,
                          .bytes = bytes,
                          .interrupted = interrupted},
                         octants_of(model, counted));
}

/// Both claims contain the exact values, and so does their hull.
ContactClaim claim_between(const AreaWithin& found, const AreaWithin& proven) {
  const ContactClaim a = claim_of(found);
  const ContactClaim b = claim_of(proven);
  return {hull(a.area, b.area), hull(a.within, b.within), hull(a.percent, b.percent)};
}

}  // namespace

CertifiedContact certified_contact(const Model& model, const Mesh& mesh, const ContactAreas& found,
                                   const ContactAreaOptions& options, const std::function<void(double)>& progress,
                                   std::size_t bytes) {
  check_mesh(mesh);
  if (mesh.triangles.empty()) refuse("the mesh has no triangles");
  check_regions(mesh, options.region_of, options.regions);
  if (found.by_region.size() != options.regions)
    refuse(fmt::format("areas of {} regions are found, of {}", found.by_region.size(), options.regions));
  CertifiedContact result{.terms = {options.distance, options.region_of, options.regions, counted_of(model, options)},
                          .claims = {},
                          .certificate = {},
                          .proven = {}};
  result.proven.interrupted = true;
  const SeenInterruption interrupted(options.interrupted);
  const auto part_of_progress = [&progress](double from, double to) {
    return [&progress, from, to](double done) { progress(from + (to - from) * done); };
  };
  const CertifiedSamples samples(model, contact_tolerance(model));
  ContactProver prover(mesh, result.terms, samples, interrupted);
  prover.certify_vertices(
      tellers(mesh, approximate_distances(model, mesh, options), options.distance, samples.tolerance()),
      part_of_progress(0.0, 0.3));
  if (interrupted()) return result;
  const std::vector<AreaWithin> whole{found.of_mesh};
  const std::size_t bytes_of_each = found.of_model ? bytes / 2 : bytes;
  prover.divide(options.regions == 0 ? whole : found.by_region, bytes_of_each, part_of_progress(0.3, 0.8));
  if (interrupted()) return result;
  result.certificate = prover.certificate();
  if (found.of_model)
    result.certificate.surface = cover_of(model, mesh, *found.of_model, options, bytes_of_each, interrupted);
  if (interrupted()) return result;
  result.proven = ContactChecker(model)(mesh, result.terms, result.certificate,
                                        {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                         .interrupted = [&interrupted] { return interrupted(); },
                                         .progress = part_of_progress(0.8, 1.0)});
  if (result.proven.interrupted) return result;
  result.claims.of_mesh = claim_between(found.of_mesh, result.proven.of_mesh);
  for (std::size_t r = 0; r < found.by_region.size(); ++r)
    result.claims.by_region.push_back(claim_between(found.by_region[r], result.proven.by_region[r]));
  if (found.of_model) result.claims.of_model = claim_between(*found.of_model, *result.proven.of_model);
  return result;
}

}  // namespace verisq

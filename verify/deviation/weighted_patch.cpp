/// The distances of the two flat triangles' points, moved to the patch.
#include "verify/deviation/weighted_patch.hpp"

#include <algorithm>
#include <array>

#include "verify/deviation/triangle_piece.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

/// One triangle alone is asked about where it is nearer than so many radii of the piece: elsewhere distances alone do.
constexpr double thin_in_radii = 4.0;

PieceDistances on_half(const Triangle& half, const std::array<Enclosure, 3>& at_corners,
                       const TriangleTree& triangles) {
  const double off = displacement(half);
  const PieceShape shape = shape_of(half, off);
  const Point middle = centre(half);
  const TriangleTree::Nearest nearest = triangles.nearest(middle);
  TrianglePiece piece{.corners = half, .triangle = 0, .at_corners = at_corners};
  piece.at_centre = widened(nearest.distance, off);
  // Where one triangle alone is near, the distance is that from a convex set: another one is no nearer to any point
  // of the piece than the first is, if it is farther from the middle than that by two radii.
  if (nearest.distance.hi < thin_in_radii * shape.radius) {
    const double reach =
        add(add(piece.at_centre.hi, off, Direction::up), multiply(2.0, shape.radius, Direction::up), Direction::up);
    piece.convex = triangles.alone(middle, reach, nearest.triangle);
  }
  return distances_on(piece, shape);
}

/// Distances that are off by no more.
Enclosure beyond(const Enclosure& distances, double off) {
  return {std::max(0.0, subtract(distances.lo, off, Direction::down)), add(distances.hi, off, Direction::up)};
}

}  // namespace

WeightedCell weighted_patch(const Patch& patch, const PatchArea& area, const TriangleTree& triangles,
                            const Enclosure& known) {
  std::array<Enclosure, 4> at_corners{};
  for (std::size_t i = 0; i < 4; ++i) at_corners[i] = triangles.nearest(patch.corners[i]).distance;
  const auto [first, second] = patch.halves();
  const PieceDistances one = on_half(first, {at_corners[0], at_corners[1], at_corners[3]}, triangles);
  const PieceDistances other = on_half(second, {at_corners[0], at_corners[2], at_corners[3]}, triangles);
  const Enclosure flat{std::min(one.range.lo, other.range.lo), std::max(one.range.hi, other.range.hi)};
  const auto what = [] { return "distances on a patch"; };
  // Where sizes leave binary64 nothing is known: what is no number would be taken for a contradiction.
  if (!(patch.thickness < infinity) || !(flat.hi < infinity)) return {area.area, known, known};
  WeightedCell cell{area.area, intersection(known, beyond(flat, patch.thickness), what), {}};
  cell.mean = cell.range;

  // With shares distributed evenly the mean is that of both halves; with the patch's density it is off by the
  // covariance, at most a quarter of the product of both ranges (Grüss).
  const double width = subtract(cell.range.hi, cell.range.lo, Direction::up);
  const double off = add(area.correspondence,
                         multiply(0.25, multiply(area.unevenness, width, Direction::up), Direction::up), Direction::up);
  if (!(off < width) || !(one.mean.hi < infinity) || !(other.mean.hi < infinity)) return cell;
  const Enclosure even{0.5 * add(one.mean.lo, other.mean.lo, Direction::down),
                       0.5 * add(one.mean.hi, other.mean.hi, Direction::up)};
  cell.mean = intersection(cell.range, beyond(even, off), what);
  return cell;
}

/// Without an area from below the patch may reach into others that count all of theirs (PatchedSurface::area).
WeightedCell on_boundary(WeightedCell patch, bool whole, double largest) {
  if (!whole) patch.weight.lo = 0.0;
  if (!(patch.weight.lo > 0.0)) patch.mean = patch.range;
  for (Enclosure* const e : {&patch.range, &patch.mean}) e->hi = std::min(e->hi, largest);
  return patch;
}

}  // namespace verisq::verify

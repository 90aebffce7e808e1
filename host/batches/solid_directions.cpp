/// This file implements the choice of the primitive, or of the edge, that has the nearest point.
#include "host/batches/solid_directions.hpp"

#include <algorithm>
#include <cmath>

#include "host/batches/box_primitive_parameters.hpp"

namespace verisq::device {
namespace {

constexpr double no_edge = -1.0;          // as in kernels/set_bounds.cl
constexpr double nearly_the_same = 1e-9;  // of a distance, in units of the model's size

// By the transpose.
Point turned_back(const std::array<double, 9>& r, const Point& v) {
  return {r[0] * v[0] + r[3] * v[1] + r[6] * v[2], r[1] * v[0] + r[4] * v[1] + r[7] * v[2],
          r[2] * v[0] + r[5] * v[1] + r[8] * v[2]};
}

Point times(double s, const Point& v) {
  return {s * v[0], s * v[1], s * v[2]};
}

}  // namespace

SolidDirections::SolidDirections(const Model& model, int scale_exponent, std::size_t capacity) : capacity_(capacity) {
  for (const Primitive& primitive : model.primitives) {
    const BoxPrimitiveParameters parameters = box_primitive_parameters(primitive, scale_exponent);
    Rotation frame{};
    std::ranges::copy(parameters.frame, frame.begin());
    frames_.push_back(frame);
  }
  evidence_.resize(frames_.size() * columns_of_primitive * capacity_);
  for (std::vector<double>& column : edges_) column.resize(capacity_);
}

std::span<double> SolidDirections::column(std::size_t primitive, std::size_t index) {
  return std::span(evidence_).subspan((primitive * columns_of_primitive + index) * capacity_, capacity_);
}

double SolidDirections::number(std::size_t primitive, std::size_t index, std::size_t n) const {
  return evidence_[(primitive * columns_of_primitive + index) * capacity_ + n];
}

void SolidDirections::read(ChunkQueue& queue, std::span<const EvidenceBuffers> primitives, const Edges& edges,
                           std::size_t size) {
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for (std::size_t k = 0; k < columns_of_primitive; ++k) queue.read(primitives[i][k], column(i, k).first(size));
  queue.read(edges.names, std::span(edges_[0]).first(size));
  for (std::size_t k = 0; k < 3; ++k) queue.read(edges.feet[k], std::span(edges_[k + 1]).first(size));
}

// Normals lead out of primitives; a signed distance is that of a primitive or, where one is cut away, minus that.
Point SolidDirections::operator()(std::size_t n, const Point& at, const Enclosure& distance) const {
  const double middle = 0.5 * distance.lo + 0.5 * distance.hi;
  double least = distance.width() + nearly_the_same;
  Point direction{};
  const auto offer = [&](double signed_distance, double sign, const Point& outward) {
    const double off = std::abs(sign * signed_distance - middle);
    if (!(off < least)) return;
    least = off;
    direction = times(sign, outward);
  };
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    // The end that the nearest point found proves.
    const double own = number(i, 1, n) > 0.0 ? number(i, 1, n) : number(i, 0, n);
    const Point outward = turned_back(frames_[i], {number(i, 2, n), number(i, 3, n), number(i, 4, n)});
    offer(own, 1.0, outward);
    offer(own, -1.0, outward);
  }
  if (edges_[0][n] == no_edge) return direction;
  const Point way{at[0] - edges_[1][n], at[1] - edges_[2][n], at[2] - edges_[3][n]};
  const double length = std::hypot(way[0], way[1], way[2]);
  offer(length, middle < 0.0 ? -1.0 : 1.0, way);
  return direction;
}

}  // namespace verisq::device

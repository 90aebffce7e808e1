/// Unions of superquadrics for a cloud or a mesh: fitted, and grown one by one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

#include "host/prepare/surface_distance.hpp"
#include "host/prepare/surface_samples.hpp"
#include "verify/proof/triangle_tree.hpp"

namespace verisq::recovery {

// Several shapes at once: their union's surface through the samples of a surface, its inside where the inside is.

/// The samples that the union is to match. Inside and outside may be empty: for clouds they are not known.
struct UnionSamples {
  std::vector<Eigen::Vector3d> surface;
  std::vector<Eigen::Vector3d> inside;
  std::vector<Eigen::Vector3d> outside;
  /// For each sample outside: its distance from the surface beyond the resolution of a grid. A primitive that reaches
  /// it is too long by that, however thin it is.
  std::vector<double> beyond;
};

struct UnionOptions {
  Family family = Family::plain;
  double size = 0.0;           ///< size of the cloud, a length
  double outlier_ratio = 0.0;  ///< like MixtureTerms::ratio at a noise of `noise`; 0: squares alone
  double noise = 1.0;
  /// Points of cones and edges of wedges reach far out of a solid between the samples of the space: less than 2 has
  /// none.
  double largest_exponent = recovery::largest_exponent;
  double inside_weight = 1.0;   ///< weight of a sample inside, where one of the surface has 1
  double outside_weight = 1.0;  ///< weight of a sample outside
};

/// The signed distance of a union is the least of its primitives' distances. Its square is summed over the samples of
/// the surface and, if the sign is wrong, over those inside and outside. Each sample depends on one primitive, so steps
/// are taken primitive by primitive.
class UnionFit {
 public:
  /// `samples` must stay.
  UnionFit(const UnionSamples& samples, const UnionOptions& options, std::vector<Shape> shapes);

  /// A step of each of the primitives, in turn; the cost does not grow. False when none gained a relative 1e-7.
  bool sweep(std::span<const std::size_t> primitives);
  bool sweep();

  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }
  [[nodiscard]] const UnionOptions& options() const { return options_; }
  [[nodiscard]] const UnionSamples& samples() const { return *samples_; }

  /// Sets the parameters that the next sweeps change.
  void vary(Family family) { options_.family = family; }
  void allow_exponents(double largest) { options_.largest_exponent = largest; }
  void replace(std::size_t primitive, const Shape& shape);
  void add(const Shape& shape);
  void remove(std::size_t primitive);

  /// For all samples, surface before inside before outside: the union's distance, and the primitive that decides it.
  [[nodiscard]] std::vector<double> distances() const;
  [[nodiscard]] std::vector<std::size_t> owners() const;
  /// The contribution of a sample at that distance of the union: its distance, or 0 if the sign is right; for a sample
  /// outside, `beyond` is added.
  [[nodiscard]] double residual(std::size_t sample, double distance) const;

 private:
  void measure(const Shape& shape, std::vector<double>& distances) const;
  [[nodiscard]] double cost_with(const std::vector<double>& others, const std::vector<double>& own) const;
  [[nodiscard]] std::vector<double> others_of(std::size_t primitive) const;
  bool step(std::size_t primitive);
  template <int N>
  bool step_of(std::size_t primitive);
  void refresh();

  const UnionSamples* samples_;
  UnionOptions options_;
  std::vector<PointBlock> blocks_;
  std::size_t count_ = 0;
  std::vector<Shape> shapes_;
  std::vector<std::vector<double>> distances_;  ///< by primitive, then by sample
  std::vector<double> damping_;
  double cost_ = 0.0;
};

// Samples of the space about a closed mesh, for the fit of a union.

/// Adds a grid's points inside and outside; `tree` is of the mesh's triangles. Precondition: a closed mesh.
void add_space(const Mesh& mesh, const verify::TriangleTree& tree, UnionSamples& samples);

// Unions with one primitive after the other: each time the best of many ways to divide a primitive, or to add one.

/// The fit with one primitive more, refined. Deterministic; candidates share the processors. `interrupted` ends it
/// early, with the best fit by then.
[[nodiscard]] UnionFit grown(const UnionFit& fit, const std::function<bool()>& interrupted);

/// The fit with as many primitives: one is added, and the one that is then missed least is removed. It may be worse for
/// that. Precondition: at least two.
[[nodiscard]] UnionFit exchanged(const UnionFit& fit, const std::function<bool()>& interrupted);

/// Sweeps and alternatives of single primitives until nothing is gained.
[[nodiscard]] UnionFit refined(UnionFit fit, int sweeps, const std::function<bool()>& interrupted);

}  // namespace verisq::recovery

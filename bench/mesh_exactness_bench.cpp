/// Are signs and distances of points to closed meshes right? `mesh_exactness_bench POINTS [MESH...]`: POINTS about each
/// hard mesh of the tests, and about each MESH, against exact answers. Exact are a winding number by CGAL's predicates,
/// squared distances in integers, and, where the mesh is embedded, CGAL's side of a mesh in its exact kernel. Beside:
/// how often CGAL in binary64, and the sign of a pseudonormal, are wrong about the same points. The exit status is 0
/// only if nothing of ours is wrong, undecided off the surface, or without the exact distance.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/oracle/exact_mesh.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/closed_mesh.hpp"

namespace verisq::bench {
namespace {

using Side = verify::ClosedMesh::Side;

/// CGAL's tree of the triangles, in one of its kernels.
template <class Kernel>
class CgalTree {
 public:
  using Triangles = std::vector<typename Kernel::Triangle_3>;
  using Place = typename Triangles::const_iterator;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Place>>>;

  explicit CgalTree(std::span<const Triangle> triangles) {
    for (const auto& [a, b, c] : triangles) triangles_.emplace_back(at(a), at(b), at(c));
    tree_.rebuild(triangles_.begin(), triangles_.end());
    tree_.accelerate_distance_queries();
  }

  static typename Kernel::Point_3 at(const Point& x) { return {x[0], x[1], x[2]}; }

  [[nodiscard]] const Tree& tree() const { return tree_; }
  [[nodiscard]] std::size_t number_of(Place place) const {
    return static_cast<std::size_t>(place - triangles_.begin());
  }

 private:
  Triangles triangles_;
  Tree tree_;
};

/// Precondition: no degenerate triangles.
class ExactAnswers {
 public:
  explicit ExactAnswers(std::span<const Triangle> triangles)
      : triangles_(triangles.begin(), triangles.end()), tree_(triangles) {
    const CGAL::Bbox_3 box = tree_.tree().bbox();
    for (int i = 0; i < 3; ++i) {
      size_ = std::max(size_, box.max(i) - box.min(i));
      largest_ = std::max({largest_, box.max(i), -box.min(i)});
    }
  }

  /// By the triangles that meet a cube about the point. The cube holds a ball as large as the distance. A closest point
  /// is off by some units in the last place of the coordinates, which are 1e-16 of them; the margin is 1e-9.
  [[nodiscard]] oracle::Fraction squared_distance(const Point& point) const {
    const double about = std::sqrt(tree_.tree().squared_distance(Tree::at(point)));
    const double half = about * (1.0 + 1e-9) + 1e-9 * largest_;
    const auto& [x, y, z] = point;
    std::vector<Tree::Place> met;
    tree_.tree().all_intersected_primitives(CGAL::Bbox_3(x - half, y - half, z - half, x + half, y + half, z + half),
                                            std::back_inserter(met));
    std::vector<Triangle> near;
    for (const Tree::Place place : met) near.push_back(triangles_[tree_.number_of(place)]);
    if (near.empty()) throw std::runtime_error("no triangle is as near as the nearest");
    return oracle::ExactMesh(near).squared_distance(point);
  }

  /// By the crossings of a segment to a point beyond the box. All signs are exact. Precondition: off the surface.
  [[nodiscard]] int winding_number(const Point& point) {
    for (int attempt = 0; attempt < 100; ++attempt) {
      if (const std::optional<int> found = crossings(point, beyond(point))) return *found;
    }
    throw std::runtime_error("every segment meets a side");
  }

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Tree = CgalTree<Kernel>;

  Point beyond(const Point& point) {
    const CGAL::Bbox_3 box = tree_.tree().bbox();
    std::normal_distribution<double> normal;
    Point to{normal(random_), normal(random_), normal(random_)};
    const double length = std::hypot(to[0], to[1], to[2]);
    double way = 2.0 * size_;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      way += std::max({0.0, box.min(i) - point[k], point[k] - box.max(i)}) + size_;
    }
    for (std::size_t i = 0; i < 3; ++i) to[i] = point[i] + to[i] / length * way;
    return to;
  }

  /// Nothing where the segment meets a side.
  [[nodiscard]] std::optional<int> crossings(const Point& from, const Point& to) const {
    const Kernel::Point_3 p = Tree::at(from);
    const Kernel::Point_3 q = Tree::at(to);
    std::vector<Tree::Place> met;
    tree_.tree().all_intersected_primitives(Kernel::Segment_3(p, q), std::back_inserter(met));
    int sum = 0;
    for (const Tree::Place place : met) {
      const auto& [a, b, c] = std::array{place->vertex(0), place->vertex(1), place->vertex(2)};
      const std::array sides{CGAL::orientation(p, q, a, b), CGAL::orientation(p, q, b, c),
                             CGAL::orientation(p, q, c, a)};
      const CGAL::Orientation before = CGAL::orientation(a, b, c, p);
      if (std::ranges::count(sides, CGAL::COPLANAR) > 0 || before == CGAL::COPLANAR) return std::nullopt;
      if (CGAL::orientation(a, b, c, q) == CGAL::COPLANAR) return std::nullopt;
      sum += before == CGAL::POSITIVE ? -1 : 1;
    }
    return sum;
  }

  std::vector<Triangle> triangles_;
  Tree tree_;
  double size_ = 0.0;
  double largest_ = 0.0;  ///< coordinate
  std::mt19937_64 random_{7};
};

/// CGAL's side of a mesh, by the parity of crossings. It asks for no edges: each triangle has corners of its own.
template <class Kernel>
class CgalSide {
 public:
  explicit CgalSide(std::span<const Triangle> triangles) : mesh_(separate(triangles)), side_(mesh_) {}

  [[nodiscard]] Side operator()(const Point& point) const {
    switch (side_(CgalTree<Kernel>::at(point))) {
      case CGAL::ON_BOUNDED_SIDE: return Side::inside;
      case CGAL::ON_UNBOUNDED_SIDE: return Side::outside;
      default: return Side::on_surface;
    }
  }

 private:
  using SurfaceMesh = CGAL::Surface_mesh<typename Kernel::Point_3>;

  static SurfaceMesh separate(std::span<const Triangle> triangles) {
    SurfaceMesh mesh;
    for (const auto& [a, b, c] : triangles) {
      mesh.add_face(mesh.add_vertex(CgalTree<Kernel>::at(a)), mesh.add_vertex(CgalTree<Kernel>::at(b)),
                    mesh.add_vertex(CgalTree<Kernel>::at(c)));
    }
    return mesh;
  }

  SurfaceMesh mesh_;
  CGAL::Side_of_triangle_mesh<SurfaceMesh, Kernel> side_;
};

Point difference(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double length(const Point& x) {
  return std::hypot(x[0], x[1], x[2]);
}

void add(Point& sum, const Point& x, double share) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] += share * x[i];
}

/// Baerentzen and Aanaes, Signed distance computation using the angle weighted pseudonormal (2005), as libigl's
/// pseudonormal_test has it: in binary64, the feature by barycentric coordinates below 1e-12.
class PseudonormalSign {
 public:
  explicit PseudonormalSign(const Mesh& mesh)
      : corners_(verify::corners_by_place(mesh)),
        triangles_(verify::triangles_of(mesh)),
        of_corner_(mesh.vertices.size()),
        tree_(triangles_) {
    for (std::size_t n = 0; n < triangles_.size(); ++n) {
      const auto& [a, b, c] = triangles_[n];
      const Point x = difference(b, a);
      const Point y = difference(c, a);
      Point normal{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
      const double size = length(normal);
      for (double& coordinate : normal) coordinate /= size;
      of_face_.push_back(normal);
      for (std::size_t k = 0; k < 3; ++k) {
        add(of_corner_[corners_[n][k]], normal, angle(triangles_[n], k));
        add(of_side_[side(n, k)], normal, 1.0);
      }
    }
  }

  [[nodiscard]] Side operator()(const Point& point) const {
    const auto [at, place] = tree_.tree().closest_point_and_primitive(CgalTree<Kernel>::at(point));
    const Point closest{at.x(), at.y(), at.z()};
    return dot(difference(point, closest), normal_at(closest, tree_.number_of(place))) >= 0.0 ? Side::outside
                                                                                              : Side::inside;
  }

 private:
  using Kernel = CGAL::Simple_cartesian<double>;

  static double angle(const Triangle& triangle, std::size_t k) {
    const Point x = difference(triangle[(k + 1) % 3], triangle[k]);
    const Point y = difference(triangle[(k + 2) % 3], triangle[k]);
    return std::acos(std::clamp(dot(x, y) / (length(x) * length(y)), -1.0, 1.0));
  }

  /// Opposite to the corner.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> side(std::size_t n, std::size_t k) const {
    return std::minmax(corners_[n][(k + 1) % 3], corners_[n][(k + 2) % 3]);
  }

  static std::array<double, 3> barycentric(const Point& x, const Triangle& triangle) {
    const Point ab = difference(triangle[1], triangle[0]);
    const Point ac = difference(triangle[2], triangle[0]);
    const Point ax = difference(x, triangle[0]);
    const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), xb = dot(ax, ab), xc = dot(ax, ac);
    const double whole = bb * cc - bc * bc;
    const double v = (cc * xb - bc * xc) / whole;
    const double w = (bb * xc - bc * xb) / whole;
    return {1.0 - v - w, v, w};
  }

  [[nodiscard]] const Point& normal_at(const Point& closest, std::size_t n) const {
    constexpr double small = 1e-12;
    const std::array<double, 3> shares = barycentric(closest, triangles_[n]);
    const auto is_small = [](double share) { return share <= small; };
    const auto count = std::ranges::count_if(shares, is_small);
    if (count == 2)
      return of_corner_[corners_[n][static_cast<std::size_t>(std::ranges::find_if_not(shares, is_small) -
                                                             shares.begin())]];
    if (count == 1)
      return of_side_.at(side(n, static_cast<std::size_t>(std::ranges::find_if(shares, is_small) - shares.begin())));
    return of_face_[n];
  }

  std::vector<verify::Corners> corners_;
  std::vector<Triangle> triangles_;
  std::vector<Point> of_face_;
  std::vector<Point> of_corner_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Point> of_side_;
  CgalTree<Kernel> tree_;
};

struct Counts {
  std::size_t points = 0;
  std::size_t on_surface = 0;
  std::size_t wrong = 0;
  std::size_t undecided = 0;       ///< off the surface, in an enclosure of both signs
  std::size_t escapes = 0;         ///< the exact distance lies in no enclosure
  std::size_t contradictions = 0;  ///< of the two exact sides
  std::size_t cgal_wrong = 0;
  std::size_t pseudonormal_wrong = 0;

  [[nodiscard]] bool ours_are_right() const { return wrong + undecided + escapes + contradictions == 0; }
};

Enclosure magnitude(const verify::ClosedMesh::Distance& found) {
  const Enclosure& distance = found.signed_distance;
  return found.side == Side::inside ? Enclosure{-distance.hi, -distance.lo} : distance;
}

void report(const std::string& name, const char* fault, const Point& point, const Enclosure& distance) {
  fmt::print("{}: {} at ({:a}, {:a}, {:a}): [{:a}, {:a}]\n", name, fault, point[0], point[1], point[2], distance.lo,
             distance.hi);
}

/// Embedded: no triangles meet but in common corners, and each has the solid on one side.
Counts counted(const std::string& name, const Mesh& mesh, const verify::ClosedMesh& solid, std::size_t points) {
  const std::vector<Triangle> triangles = verify::triangles_of(mesh);
  const bool embedded = solid.facts().depth_is_exact();
  ExactAnswers exact(triangles);
  std::optional<CgalSide<CGAL::Exact_predicates_exact_constructions_kernel>> cgal_exact;
  std::optional<CgalSide<CGAL::Simple_cartesian<double>>> cgal;
  if (embedded) {
    cgal_exact.emplace(triangles);
    cgal.emplace(triangles);
  }
  const PseudonormalSign pseudonormal(mesh);
  testing::PlacesAboutMesh places(mesh, 1);
  Counts counts{.points = points};
  for (std::size_t n = 0; n < points; ++n) {
    const Point point = places.next();
    const verify::ClosedMesh::Distance found = solid.signed_distance(point);
    const oracle::Fraction squared = exact.squared_distance(point);
    const bool is_off = squared.numerator != 0;
    const Side inside_or_out = is_off && exact.winding_number(point) != 0 ? Side::inside : Side::outside;
    const Side side = is_off ? inside_or_out : Side::on_surface;
    counts.on_surface += is_off ? 0 : 1;
    const bool is_right = found.side == side;
    const bool is_open = is_off && found.signed_distance.lo < 0.0 && found.signed_distance.hi > 0.0;
    const bool is_held = holds_root(magnitude(found), squared);
    counts.wrong += is_right ? 0 : 1;
    counts.undecided += is_open ? 1 : 0;
    counts.escapes += is_held ? 0 : 1;
    if (!is_right) report(name, "wrong side", point, found.signed_distance);
    if (!is_held) report(name, "escape", point, found.signed_distance);
    if (embedded) {
      counts.contradictions += (*cgal_exact)(point) == side ? 0 : 1;
      counts.cgal_wrong += (*cgal)(point) == side ? 0 : 1;
    }
    counts.pseudonormal_wrong += is_off && pseudonormal(point) != side ? 1 : 0;
  }
  return counts;
}

void print_row(const std::string& name, const verify::ClosedMesh& solid, const Counts& counts) {
  const bool embedded = solid.facts().depth_is_exact();
  const std::string cgal = embedded ? std::to_string(counts.cgal_wrong) : "-";
  const std::string contradictions = embedded ? std::to_string(counts.contradictions) : "-";
  fmt::print("{:20} {:>9} {:>8} {:>8} {:>10} {:>6} {:>9} {:>7} {:>14} {:>12} {:>13}\n", name, solid.facts().triangles,
             solid.facts().unclean, counts.points, counts.on_surface, counts.wrong, counts.undecided, counts.escapes,
             contradictions, cgal, counts.pseudonormal_wrong);
  std::fflush(stdout);
}

bool is_right_about(const std::string& name, const Mesh& mesh, std::size_t points) {
  const verify::ClosedMesh solid(mesh);
  if (solid.facts().degenerate > 0) {
    fmt::print("{:20} left out: CGAL's predicates ask for triangles that are not degenerate\n", name);
    return true;
  }
  const Counts counts = counted(name, mesh, solid, points);
  print_row(name, solid, counts);
  return counts.ours_are_right();
}

int run(std::span<char*> arguments) {
  std::size_t points = 0;
  const std::string_view count = arguments.size() > 1 ? arguments[1] : "";
  if (std::from_chars(count.data(), count.data() + count.size(), points).ptr != count.data() + count.size() ||
      points == 0) {
    fmt::print(stderr, "usage: mesh_exactness_bench POINTS [MESH...]\n");
    return 2;
  }
  fmt::print("{:20} {:>9} {:>8} {:>8} {:>10} {:>6} {:>9} {:>7} {:>14} {:>12} {:>13}\n", "", "triangles", "unclean",
             "points", "on surface", "wrong", "undecided", "escapes", "contradictions", "CGAL double", "pseudonormal");
  bool all_right = true;
  for (const testing::MeshScene& scene : testing::mesh_scenes()) {
    if (scene.name == "huge" || scene.name == "tiny") continue;  // beyond the oracle's integers
    all_right = is_right_about(scene.name, scene.mesh, points) && all_right;
  }
  for (const char* const file : arguments.subspan(2))
    all_right = is_right_about(std::filesystem::path(file).stem(), read_mesh(file), points) && all_right;
  return all_right ? 0 : 1;
}

}  // namespace
}  // namespace verisq::bench

int main(int count, char** values) {
  return verisq::bench::run({values, static_cast<std::size_t>(count)});
}

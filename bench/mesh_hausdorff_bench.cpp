/// How far do the surfaces of two closed meshes lie apart? `mesh_hausdorff_bench MODEL MESH SAMPLES [TOLERANCE]`: what
/// `deviation` proves of both surfaces to TOLERANCE (0.001), beside SAMPLES random points of each, uniform by area, and
/// CGAL's bounded_error_Hausdorff_distance with that bound. The exit status is 0 only if no sample lies beyond an
/// enclosure, and means and percentiles of the samples agree with the enclosures, up to four of their standard
/// deviations.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "verify/proof/triangle_tree.hpp"
#include "verify/search/closed_mesh.hpp"

namespace verisq::bench {
namespace {

constexpr std::array percents{50.0, 95.0};
constexpr double deviations = 4.0;  ///< of a mean or a rank by random samples

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Random points of the triangles, uniform by area.
class Samples {
 public:
  explicit Samples(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    std::vector<double> areas;
    for (const auto& [a, b, c] : triangles_) {
      const Point x{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const Point y{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      areas.push_back(std::hypot(x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]));
    }
    choice_ = std::discrete_distribution<std::size_t>(areas.begin(), areas.end());
  }

  Point operator()() {
    const auto& [a, b, c] = triangles_[choice_(random_)];
    double u = share_(random_);
    double v = share_(random_);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    Point point;
    for (std::size_t i = 0; i < 3; ++i) point[i] = a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]);
    return point;
  }

 private:
  std::vector<Triangle> triangles_;
  std::mt19937_64 random_{11};
  std::discrete_distribution<std::size_t> choice_;
  std::uniform_real_distribution<double> share_{0.0, 1.0};
};

/// Distances of samples of one mesh from the surface of the other, in order.
std::vector<double> sampled_distances(const Mesh& from, const Mesh& to, std::size_t count) {
  Samples samples(verify::triangles_of(from));
  const verify::ClosedMesh solid(to);
  constexpr std::size_t most = 100'000;  // at once
  std::vector<double> distances;
  while (distances.size() < count) {
    std::vector<Point> points(std::min(most, count - distances.size()));
    for (Point& point : points) point = samples();
    std::vector<verify::ClosedMesh::Distance> found(points.size());
    solid.signed_distances(points, found);
    for (const auto& distance : found)
      distances.push_back(std::abs(0.5 * distance.signed_distance.lo + 0.5 * distance.signed_distance.hi));
  }
  std::ranges::sort(distances);
  return distances;
}

bool overlap(const Enclosure& proven, double lo, double hi) {
  return proven.lo <= hi && lo <= proven.hi;
}

/// One line of the table; what the samples leave open is [lo, hi].
bool row(const std::string& name, const Enclosure& proven, double sampled, double lo, double hi) {
  const bool agree = overlap(proven, lo, hi);
  fmt::print("{:32} [{:.9f}, {:.9f}] {:14.9f}  {}\n", name, proven.lo, proven.hi, sampled, agree ? "" : "DISAGREES");
  return agree;
}

bool compare(const std::string& name, const DistanceStatistics& proven, std::span<const double> sorted) {
  const auto count = static_cast<double>(sorted.size());
  // Samples are points of a triangle to rounding.
  const double rounding = 1e-12 * (1.0 + sorted.back());
  bool agree = row(name + ", largest", proven.largest, sorted.back(), sorted.back() - rounding, infinity);
  if (proven.mean) {
    double sum = 0.0;
    for (const double distance : sorted) sum += distance;
    const double mean = sum / count;
    double squares = 0.0;
    for (const double distance : sorted) squares += (distance - mean) * (distance - mean);
    const double open = deviations * std::sqrt(squares) / count;
    agree = row(name + ", mean", *proven.mean, mean, mean - open, mean + open) && agree;
  }
  const auto at_rank = [&](double rank) {
    return sorted[static_cast<std::size_t>(std::clamp(rank, 0.0, count - 1.0))];
  };
  for (std::size_t k = 0; k < proven.percentiles.size(); ++k) {
    const double share = percents[k] / 100.0;
    const double open = deviations * std::sqrt(share * (1.0 - share) * count);
    agree = row(fmt::format("{}, {} %", name, percents[k]), proven.percentiles[k], at_rank(share * count),
                at_rank(share * count - open), at_rank(share * count + open)) &&
            agree;
  }
  return agree;
}

using CgalPoint = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<CgalPoint>;

CgalMesh cgal_mesh(const Mesh& mesh) {
  std::vector<CgalPoint> points;
  for (const auto& [x, y, z] : mesh.vertices) points.emplace_back(x, y, z);
  std::vector<std::vector<std::size_t>> polygons;
  for (const auto& [a, b, c] : mesh.triangles) polygons.push_back({a, b, c});
  CgalMesh result;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, polygons, result);
  return result;
}

void print_cgal(const Mesh& model, const Mesh& mesh, double tolerance) {
  const CgalMesh a = cgal_mesh(model);
  const CgalMesh b = cgal_mesh(mesh);
  for (const bool from_mesh : {true, false}) {
    double found = 0.0;
    const double seconds = seconds_of([&] {
      found = CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
          from_mesh ? b : a, from_mesh ? a : b, tolerance);
    });
    fmt::print("CGAL, {:26} {:.9f} in {:.2f} s\n", from_mesh ? "from mesh, largest" : "from model, largest", found,
               seconds);
  }
}

int run(std::span<char*> arguments) {
  if (arguments.size() < 4) {
    fmt::print(stderr, "usage: mesh_hausdorff_bench MODEL MESH SAMPLES [TOLERANCE]\n");
    return 2;
  }
  const Model model = read_model(arguments[1]);
  const Mesh& of_model = *model.primitives.at(0).mesh;
  const Mesh mesh = read_mesh(arguments[2]);
  const auto count = static_cast<std::size_t>(std::stoull(arguments[3]));
  DeviationOptions options;
  options.tolerance = arguments.size() > 4 ? std::stod(arguments[4]) : 0.001;
  options.device = "host";
  options.percentiles = {};
  options.statistics_of_surface = false;
  Deviation largest;
  const double seconds = seconds_of([&] { largest = deviation(model, mesh, options); });
  options.percentiles.assign(percents.begin(), percents.end());
  options.statistics_of_surface = true;
  options.statistics_of_model = true;
  options.tolerance.reset();
  Deviation found;
  const double seconds_of_all = seconds_of([&] { found = deviation(model, mesh, options); });
  fmt::print("largest distances to the tolerance in {:.2f} s, all statistics to 5 % in {:.2f} s\n", seconds,
             seconds_of_all);
  const std::vector<double> from_mesh = sampled_distances(mesh, of_model, count);
  const std::vector<double> from_model = sampled_distances(of_model, mesh, count);
  fmt::print("{:32} {:28} {:>14}\n", "", "proven", "sampled");
  bool agree = compare("from mesh", *found.from_mesh, from_mesh);
  agree = compare("from model", *found.from_model, from_model) && agree;
  const double sampled = std::max(from_mesh.back(), from_model.back());
  agree =
      row("Hausdorff, to the tolerance", *largest.hausdorff, sampled, sampled - 1e-12 * (1.0 + sampled), infinity) &&
      agree;
  print_cgal(of_model, mesh, largest.hausdorff->width());
  return agree ? 0 : 1;
}

}  // namespace
}  // namespace verisq::bench

int main(int count, char** values) {
  return verisq::bench::run({values, static_cast<std::size_t>(count)});
}

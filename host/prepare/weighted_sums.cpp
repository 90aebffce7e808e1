/// Loops over lanes that compilers turn into vectors; sums stay apart by lane until the end.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "host/prepare/surface_distance.hpp"
#include "host/prepare/surface_samples.hpp"

// If the compiler makes several versions of a function, the program uses the widest that its processor supports.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define VERISQ_WIDEST_VECTORS [[gnu::target_clones("default", "avx2", "avx512f")]]
#else
#define VERISQ_WIDEST_VECTORS
#endif

namespace verisq::recovery {
namespace {

using Lane = std::array<double, lanes>;

constexpr double no_likelihood = 650.0;  // e to the negative of what is beyond counts for nothing

struct Placement {
  explicit Placement(const Shape& shape) {
    for (int i = 0; i < 3; ++i) {
      centre[i] = shape.centre[i];
      for (int j = 0; j < 3; ++j) rotation[i][j] = shape.rotation(j, i);
    }
  }
  std::array<double, 3> centre{};
  std::array<std::array<double, 3>, 3> rotation{};  ///< rows: the shape's axes
};

/// A point of the shape's own frame.
struct OwnPoint {
  double x, y, z;
};

[[gnu::always_inline]] inline OwnPoint own_point(const Placement& place, const PointBlock& block, std::size_t lane) {
  const double dx = block.x[lane] - place.centre[0];
  const double dy = block.y[lane] - place.centre[1];
  const double dz = block.z[lane] - place.centre[2];
  return {place.rotation[0][0] * dx + place.rotation[0][1] * dy + place.rotation[0][2] * dz,
          place.rotation[1][0] * dx + place.rotation[1][1] * dy + place.rotation[1][2] * dz,
          place.rotation[2][0] * dx + place.rotation[2][1] * dy + place.rotation[2][2] * dz};
}

struct Rows {
  alignas(64) std::array<Lane, straight_parameters> row;
  alignas(64) std::array<Lane, straight_parameters> weighted;
  alignas(64) Lane distance;
  alignas(64) Lane weight;
  alignas(64) Lane cost;
};

struct LaneSums {
  alignas(64) Lane cost{};
  alignas(64) Lane weights{};
  alignas(64) Lane squares{};
  alignas(64) std::array<Lane, straight_parameters> gradient{};
  alignas(64) std::array<Lane, straight_parameters*(straight_parameters + 1) / 2> matrix{};
};

[[gnu::always_inline]] inline void fill_rows(const PointBlock& block, const GaugeConstants& gauge,
                                             const Placement& place, double by_taper, const MixtureTerms& terms,
                                             Rows& rows) {
  for (std::size_t l = 0; l < lanes; ++l) {
    const OwnPoint own = own_point(place, block, l);
    const double x = own.x;
    const double y = own.y;
    const double z = own.z;
    const GaugeAt at = gauge_at<true>(gauge, x, y, z);
    const double scale = 1.0 / at.length;
    const double distance = at.value * scale;
    const double likelihood = fast_exponential(-std::min(terms.precision * distance * distance, no_likelihood));
    const double sum = likelihood + terms.ratio;
    const double weight = block.present[l] * likelihood / sum;
    rows.cost[l] = -block.present[l] * fast_logarithm(sum);
    rows.weight[l] = weight;
    rows.distance[l] = distance;
    rows.row[0][l] = -at.x * scale;
    rows.row[1][l] = -at.y * scale;
    rows.row[2][l] = -at.z * scale;
    rows.row[3][l] = (at.y * z - at.z * y) * scale;
    rows.row[4][l] = (at.z * x - at.x * z) * scale;
    rows.row[5][l] = (at.x * y - at.y * x) * scale;
    rows.row[6][l] = at.by_x * scale;
    rows.row[7][l] = at.by_y * scale;
    rows.row[8][l] = at.by_z * scale;
    rows.row[9][l] = at.by_along * scale;
    rows.row[10][l] = at.by_section * scale;
    rows.row[11][l] = at.by_taper * scale * by_taper;
    for (std::size_t i = 0; i < straight_parameters; ++i) rows.weighted[i][l] = rows.row[i][l] * weight;
  }
}

VERISQ_WIDEST_VECTORS
void add_blocks(std::span<const PointBlock> blocks, const GaugeConstants& gauge, const Placement& place,
                double by_taper, const MixtureTerms& terms, double* distances, LaneSums& result) {
  const GaugeConstants own_gauge = gauge;  // local, so that nothing else can be in the same memory
  const Placement own_place = place;
  const MixtureTerms own_terms = terms;
  Rows rows;
  LaneSums sums;
  PointBlock own_block;
  for (const PointBlock& block : blocks) {
    own_block = block;
    fill_rows(own_block, own_gauge, own_place, by_taper, own_terms, rows);
    for (std::size_t l = 0; l < lanes; ++l) {
      distances[l] = rows.distance[l];
      sums.cost[l] += rows.cost[l];
      sums.weights[l] += rows.weight[l];
      sums.squares[l] += rows.weight[l] * rows.distance[l] * rows.distance[l];
    }
    distances += lanes;
    std::size_t entry = 0;
    for (std::size_t i = 0; i < straight_parameters; ++i) {
      for (std::size_t l = 0; l < lanes; ++l) sums.gradient[i][l] += rows.weighted[i][l] * rows.distance[l];
      for (std::size_t j = i; j < straight_parameters; ++j, ++entry)
        for (std::size_t l = 0; l < lanes; ++l) sums.matrix[entry][l] += rows.weighted[i][l] * rows.row[j][l];
    }
  }
  result = sums;
}

VERISQ_WIDEST_VECTORS
void fill_distances(std::span<const PointBlock> blocks, const GaugeConstants& gauge, const Placement& place,
                    double* distances) {
  for (const PointBlock& block : blocks) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const OwnPoint own = own_point(place, block, l);
      const GaugeAt at = gauge_at<false>(gauge, own.x, own.y, own.z);
      distances[l] = at.value / at.length;
    }
    distances += lanes;
  }
}

struct MixtureLanes {
  alignas(64) Lane cost{};
  alignas(64) Lane weights{};
  alignas(64) Lane squares{};
};

VERISQ_WIDEST_VECTORS
void add_mixture(std::span<const PointBlock> blocks, const MixtureTerms& terms, const double* distances,
                 MixtureLanes& result) {
  MixtureLanes sums;
  alignas(64) Lane distance;
  const double precision = terms.precision;
  const double ratio = terms.ratio;
  for (const PointBlock& block : blocks) {
    for (std::size_t l = 0; l < lanes; ++l) distance[l] = distances[l];
    for (std::size_t l = 0; l < lanes; ++l) {
      const double square = distance[l] * distance[l];
      const double likelihood = fast_exponential(-std::min(precision * square, no_likelihood));
      const double sum = likelihood + ratio;
      const double weight = block.present[l] * likelihood / sum;
      sums.cost[l] -= block.present[l] * fast_logarithm(sum);
      sums.weights[l] += weight;
      sums.squares[l] += weight * square;
    }
    distances += lanes;
  }
  result = sums;
}

struct ExtentLanes {
  alignas(64) std::array<Lane, 3> lowest;
  alignas(64) std::array<Lane, 3> highest;
};

VERISQ_WIDEST_VECTORS
void add_extent(std::span<const PointBlock> blocks, const Placement& place, const double* distances, double farthest,
                ExtentLanes& result) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Placement own_place = place;
  ExtentLanes lanes_of;
  for (std::size_t i = 0; i < 3; ++i) {
    lanes_of.lowest[i].fill(infinity);
    lanes_of.highest[i].fill(-infinity);
  }
  PointBlock own_block;
  alignas(64) std::array<Lane, 3> own;
  alignas(64) Lane beyond;  // 0, or infinite for those that do not count
  for (const PointBlock& block : blocks) {
    own_block = block;
    for (std::size_t l = 0; l < lanes; ++l) {
      const OwnPoint point = own_point(own_place, own_block, l);
      own[0][l] = point.x;
      own[1][l] = point.y;
      own[2][l] = point.z;
      beyond[l] = std::abs(distances[l]) > farthest || own_block.present[l] == 0.0 ? infinity : 0.0;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const double low = own[i][l] + beyond[l];
        const double high = own[i][l] - beyond[l];
        lanes_of.lowest[i][l] = low < lanes_of.lowest[i][l] ? low : lanes_of.lowest[i][l];
        lanes_of.highest[i][l] = high > lanes_of.highest[i][l] ? high : lanes_of.highest[i][l];
      }
    }
    distances += lanes;
  }
  result = lanes_of;
}

/// Arrays of one coordinate each: compilers vectorise a loop of any length over them best.
VERISQ_WIDEST_VECTORS
std::int64_t count_within(const double* x, const double* y, const double* z, std::size_t size, const double* centre,
                          double squared_radius) {
  const double centre_x = centre[0];
  const double centre_y = centre[1];
  const double centre_z = centre[2];
  std::int64_t count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double dx = centre_x - x[i];
    const double dy = centre_y - y[i];
    const double dz = centre_z - z[i];
    count += dx * dx + (dy * dy + dz * dz) < squared_radius ? 1 : 0;
  }
  return count;
}

double total(const Lane& lane) {
  double sum = 0.0;
  for (const double value : lane) sum += value;
  return sum;
}

}  // namespace

std::vector<PointBlock> blocks_of(std::span<const Eigen::Vector3d> points) {
  std::vector<PointBlock> blocks((points.size() + lanes - 1) / lanes);
  for (std::size_t i = 0; i < blocks.size() * lanes; ++i) {
    const Eigen::Vector3d& point = points[std::min(i, points.size() - 1)];
    PointBlock& block = blocks[i / lanes];
    block.x[i % lanes] = point[0];
    block.y[i % lanes] = point[1];
    block.z[i % lanes] = point[2];
    block.present[i % lanes] = i < points.size() ? 1.0 : 0.0;
  }
  return blocks;
}

std::vector<std::int64_t> counts_within(std::span<const Eigen::Vector3d> points, double squared_radius) {
  const auto coordinate = [points](int axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    return values;
  };
  const std::vector<double> x = coordinate(0);
  const std::vector<double> y = coordinate(1);
  const std::vector<double> z = coordinate(2);
  std::vector<std::int64_t> counts;
  counts.reserve(points.size());
  for (const Eigen::Vector3d& point : points)
    counts.push_back(count_within(x.data(), y.data(), z.data(), points.size(), point.data(), squared_radius));
  return counts;
}

WeightedSums weighted_sums(std::span<const PointBlock> blocks, const Shape& shape, bool tapers,
                           const MixtureTerms& terms, std::span<double> distances) {
  LaneSums lane_sums;
  add_blocks(blocks, GaugeConstants(shape), Placement(shape), tapers ? 1.0 : 0.0, terms, distances.data(), lane_sums);
  WeightedSums sums;
  sums.mixture = {total(lane_sums.cost), total(lane_sums.weights), total(lane_sums.squares)};
  std::size_t entry = 0;
  for (std::size_t i = 0; i < straight_parameters; ++i) {
    sums.gradient[i] = total(lane_sums.gradient[i]);
    for (std::size_t j = i; j < straight_parameters; ++j) sums.matrix[i][j] = total(lane_sums.matrix[entry++]);
  }
  return sums;
}

void distances_to(std::span<const PointBlock> blocks, const Shape& shape, std::span<double> distances) {
  fill_distances(blocks, GaugeConstants(shape), Placement(shape), distances.data());
}

Eigen::Vector3d extent_of(std::span<const PointBlock> blocks, const Shape& shape, std::span<const double> distances,
                          double farthest) {
  ExtentLanes found;
  add_extent(blocks, Placement(shape), distances.data(), farthest, found);
  Eigen::Vector3d extent;
  for (int i = 0; i < 3; ++i)
    extent[i] = *std::ranges::max_element(found.highest[i]) - *std::ranges::min_element(found.lowest[i]);
  return extent;
}

MixtureSums mixture_sums(std::span<const PointBlock> blocks, const MixtureTerms& terms,
                         std::span<const double> distances) {
  MixtureLanes sums;
  add_mixture(blocks, terms, distances.data(), sums);
  return {total(sums.cost), total(sums.weights), total(sums.squares)};
}

}  // namespace verisq::recovery

#include "host/recovery/single_recovery.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>
#include <cstdlib>
#include <cstdio>
#include <vector>

namespace verisq::recovery {
namespace {
double env(const char* n, double d) { const char* s = std::getenv(n); return s ? std::atof(s) : d; }

struct Cloud {
  Eigen::Vector3d mean;
  Eigen::Matrix3d frame;
  double size;
  double area_over_volume;
};

Eigen::Matrix3d right_handed(Eigen::Matrix3d m) {
  if (m.determinant() < 0) m.col(2) *= -1.0;
  return m;
}

/// Half widths of the middle 96 % in a frame, and the middle
void extents(std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& frame, double cut, Eigen::Vector3d& centre,
             Eigen::Vector3d& half) {
  std::vector<double> v(points.size());
  Eigen::Vector3d c;
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < points.size(); ++k) v[k] = frame.col(i).dot(points[k]);
    const auto drop = static_cast<std::ptrdiff_t>(cut * static_cast<double>(v.size()));
    std::nth_element(v.begin(), v.begin() + drop, v.end());
    const double lo = v[drop];
    std::nth_element(v.begin(), v.end() - 1 - drop, v.end());
    const double hi = *(v.end() - 1 - drop);
    c[i] = 0.5 * (lo + hi);
    half[i] = std::max(0.5 * (hi - lo), 1e-12);
  }
  centre = frame * c;
}


/// Points whose neighbourhoods are as dense as those on a surface
std::vector<Eigen::Vector3d> dense_points(std::span<const Eigen::Vector3d> points) {
  const std::size_t n = points.size();
  std::vector<double> d(n);
  std::vector<double> radius;
  const std::size_t probes = std::min<std::size_t>(n, 40);
  const std::size_t k = std::min<std::size_t>(n - 1, 9);
  for (std::size_t i = 0; i < probes; ++i) {
    for (std::size_t j = 0; j < n; ++j) d[j] = (points[i] - points[j]).squaredNorm();
    std::nth_element(d.begin(), d.begin() + k, d.end());
    radius.push_back(d[k]);
  }
  std::nth_element(radius.begin(), radius.begin() + probes / 2, radius.end());
  const double limit = radius[probes / 2];
  std::vector<int> count(n);
  for (std::size_t i = 0; i < n; ++i) {
    int c = 0;
    for (std::size_t j = 0; j < n; ++j) c += (points[i] - points[j]).squaredNorm() < limit;
    count[i] = c;
  }
  std::vector<int> sorted = count;
  std::nth_element(sorted.begin(), sorted.begin() + n * 3 / 4, sorted.end());
  const double least = env("DENSE", 0.4) * sorted[n * 3 / 4];
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < n; ++i)
    if (count[i] >= least) kept.push_back(points[i]);
  return kept;
}

/// Solids that look alike in another parametrisation.
void add_neighbours(const Shape& s, std::span<const Eigen::Vector3d> points, const Mixture& mix, std::vector<Shape>& out, bool clip) {
  const auto turned = [](Shape q) {
    q.rotation = q.rotation * Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const double a = std::sqrt(q.axes[0] * q.axes[1]) * std::sqrt(2.0) * std::exp2(-0.5 * q.exponents[1]);
    q.axes[0] = q.axes[1] = a;
    q.exponents[1] = 2.0 - q.exponents[1];
    return q;
  };
  const auto relabelled = [](const Shape& q, int z) {
    Shape r = q;
    r.rotation << q.rotation.col((z + 1) % 3), q.rotation.col((z + 2) % 3), q.rotation.col(z);
    r.axes = {q.axes[(z + 1) % 3], q.axes[(z + 2) % 3], q.axes[z]};
    r.exponents = {q.exponents[1], q.exponents[0]};
    return r;
  };
  out.push_back(turned(s));
  for (int z = 0; z < 2; ++z) {
    out.push_back(relabelled(s, z));
    out.push_back(turned(out.back()));
  }
  for (int z = 0; z < 2; ++z) out.push_back(relabelled(turned(s), z));
  for (auto& q : out) q.exponents = q.exponents.cwiseMax(smallest_exponent).cwiseMin(1.99);
  if (!clip) return;
  // where points end before the shape does: the shape that ends with them
  const DistanceToShape distance(s, Family::plain);
  Eigen::Vector3d lo = Eigen::Vector3d::Constant(1e300), hi = -lo;
  for (const auto& p : points) {
    if (std::abs(distance.value(p)) > 3 * mix.noise) continue;
    const Eigen::Vector3d q = s.rotation.transpose() * (p - s.centre);
    lo = lo.cwiseMin(q);
    hi = hi.cwiseMax(q);
  }
  for (int i = 0; i < 3; ++i) {
    if (hi[i] - lo[i] > 1.8 * s.axes[i]) continue;
    Shape q = s;
    q.axes[i] = 0.5 * (hi[i] - lo[i]);
    q.centre += s.rotation.col(i) * (0.5 * (hi[i] + lo[i]));
    if (!(q.axes[i] > 0)) continue;
    out.push_back(q);
    Shape h = s;  // half way
    h.axes[i] = 0.5 * (q.axes[i] + s.axes[i]);
    h.centre = 0.5 * (q.centre + s.centre);
    out.push_back(h);
  }
}

bool alike(const MixtureFit& a, const MixtureFit& b) {
  return std::abs(a.cost - b.cost) < 1e-2 * (1 + std::abs(a.cost)) && (a.shape.centre - b.shape.centre).norm() < 1e-2 * a.shape.axes.maxCoeff() &&
         std::abs(a.shape.axes.prod() / b.shape.axes.prod() - 1) < 2e-2 && ((a.shape.rotation.transpose()*b.shape.rotation).cwiseAbs().colwise().maxCoeff().minCoeff() > 0.999) &&
         std::abs(std::abs(a.shape.rotation.col(2).dot(b.shape.rotation.col(2))) - 1) < 1e-2;
}

}  // namespace

MixtureFit recover_single(std::span<const Eigen::Vector3d> points, const SingleOptions& options) {
  std::mt19937_64 random(options.seed);
  std::vector<Eigen::Vector3d> shuffled(points.begin(), points.end());
  for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[random() % i]);
  const std::vector<Eigen::Vector3d> dense = dense_points(std::span(shuffled).first(std::min<std::size_t>(1000, shuffled.size())));
  const std::size_t few = std::min<std::size_t>(dense.size(), (std::size_t)env("FEW", 150));
  const std::span<const Eigen::Vector3d> part(dense.data(), few);

  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : dense) mean += p;
  mean /= static_cast<double>(dense.size());
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  for (const auto& p : dense) cov += (p - mean) * (p - mean).transpose();
  const Eigen::Matrix3d frame =
      right_handed(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cov / dense.size()).eigenvectors());
  Eigen::Vector3d box_centre, half;
  extents(dense, frame, 0.01, box_centre, half);
  const double size = half.maxCoeff();
  MixtureOptions m{.family = options.family,
                   .size = size,
                   .area_over_volume = (half[0] * half[1] + half[1] * half[2] + half[2] * half[0]) * 4.0 /
                                       (8.0 * half[0] * half[1] * half[2]),
                   .least_noise = env("FLOOR", 3e-3) * size,
                   .iterations = (int)env("ITER", 14),
                   .precision = 1e-3};
  const auto better = [](const auto& a, const auto& b) { return a.cost < b.cost; };
  std::vector<MixtureFit> found;
  const auto add = [&](const MixtureFit& f) {
    for (auto& g : found)
      if (alike(f, g)) {
        if (f.cost < g.cost) g = f;
        return;
      }
    found.push_back(f);
  };
  const Mixture first{.noise = env("SIG", 0.1) * size, .outliers = 0.1};
  for (int z = 0; z < 3; ++z)
    for (int turn = 0; turn < 2; ++turn) {
      Eigen::Matrix3d axes;
      axes << frame.col((z + 1) % 3), frame.col((z + 2) % 3), frame.col(z);
      if (turn) axes = axes * Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      Shape start;
      start.rotation = axes;
      extents(dense, axes, 0.01, start.centre, start.axes);
      start.exponents = {env("E1", 1.0), env("E2", 1.0)};
      add(fit_mixture(part, start, first, m));
    }
  const int rounds = (int)env("ROUNDS", 3);
  std::stable_sort(found.begin(), found.end(), better);
  for (int round = 0; round < rounds; ++round) {
    const MixtureFit best = found[0];
    std::vector<Shape> next;
    add_neighbours(best.shape, part, best.mixture, next, env("CLIP", 1));
    for (const Shape& s : next)
      add(fit_mixture(part, s, {std::max(best.mixture.noise, env("SIG2", 0.03) * size), best.mixture.outliers}, m));
    std::stable_sort(found.begin(), found.end(), better);
    if (found[0].cost > best.cost - 0.1) break;
  }
  m.iterations = 30;
  m.precision = 1e-4;
  const std::size_t keep = std::min<std::size_t>(found.size(), (std::size_t)env("KEEP", 3));
  MixtureFit best{};
  for (std::size_t i = 0; i < keep; ++i) {
    const MixtureFit f = fit_mixture(shuffled, found[i].shape, found[i].mixture, m);
    if (i == 0 || f.cost < best.cost) best = f;
  }
  for (int round = 0; round < (int)env("FROUNDS", 0); ++round) {
    std::vector<Shape> next;
    add_neighbours(best.shape, shuffled, best.mixture, next, env("CLIP", 1));
    const double before = best.cost;
    for (const Shape& s : next) {
      const MixtureFit f = fit_mixture(shuffled, s, {std::max(best.mixture.noise, env("SIG2", 0.03) * size), best.mixture.outliers}, m);
      if (f.cost < best.cost) best = f;
    }
    if (best.cost > before - 0.1) break;
  }
  m.precision = 1e-9;
  while (best.mixture.noise <= m.least_noise * 1.01 && m.least_noise > 1e-13 * size) {
    m.least_noise *= 0.03;
    const MixtureFit f = fit_mixture(shuffled, best.shape, best.mixture, m);
    if (f.mixture.outliers > best.mixture.outliers + 0.05) break;
    best = f;
  }
  return best;
}

}  // namespace verisq::recovery

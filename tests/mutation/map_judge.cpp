/// This file implements the comparison of maps with the truth and with what their certificates prove.
#include "tests/mutation/map_judge.hpp"

#include <fmt/format.h>

#include <cmath>
#include <verisq/distance.hpp>

#include "host/device/query_batches.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::mutation {
namespace {

constexpr double inside_tolerance = 1e-7;  // of the truth, relative to the model's radius: tighter takes long

std::vector<CertifiedEnclosure> mapped(const CompiledKernels& kernels, const Scene& scene) {
  const auto batch = device::point_batch(kernels, kernels.program, scene.model, scene.tolerance, true);
  batch->submit(scene.points);
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> certificates;
  batch->collect(enclosures, certificates);
  std::vector<CertifiedEnclosure> rows;
  for (std::size_t i = 0; i < enclosures.size(); ++i) rows.push_back({enclosures[i], certificates[i]});
  return rows;
}

bool has_nan(const Enclosure& e) {
  return std::isnan(e.lo) || std::isnan(e.hi);
}

// Readers of maps refuse what is not a number.
bool proves(const Checker& check, const Point& point, const CertifiedEnclosure& row) {
  return !has_nan(row.distance) && check(point, row.distance, row.certificate).verdict == Verdict::proved;
}

// Whether no number is in both.
bool disjoint(const Enclosure& a, const Enclosure& b) {
  return has_nan(a) || a.lo > b.hi || a.hi < b.lo || a.lo > a.hi;
}

// Claims no more than `proved` does, by the same certificate.
bool follows_from(const CertifiedEnclosure& row, const CertifiedEnclosure& proved) {
  return row.distance.lo <= proved.distance.lo && row.distance.hi >= proved.distance.hi &&
         row.certificate == proved.certificate;
}

std::string described(const Scene& scene, std::size_t i, const Enclosure& claimed, const Enclosure& truth) {
  const Point& x = scene.points[i];
  return fmt::format("{}: ({:.17g}, {:.17g}, {:.17g}) gave [{:.17g}, {:.17g}], the truth is in [{:.17g}, {:.17g}]",
                     scene.name, x[0], x[1], x[2], claimed.lo, claimed.hi, truth.lo, truth.hi);
}

}  // namespace

MapJudge::MapJudge(std::vector<Scene> scenes) {
  for (Scene& scene : scenes) {
    std::vector<Enclosure> truth(scene.points.size());
    const SignedDistance host(scene.model);
    in_parallel(truth.size(), [&](std::size_t i) {
      truth[i] = host(scene.points[i], inside_tolerance * bounding_radius(scene.model));
      if (truth[i].lo > 0.0) truth[i] = host(scene.points[i], 0.0);
    });
    Checker check(scene.model);
    scenes_.push_back({std::move(scene), std::move(check), std::move(truth)});
  }
}

std::vector<MapJudge::AcceptedMap> MapJudge::accepted(const CompiledKernels& true_kernels) const {
  std::vector<AcceptedMap> maps;
  for (const KnownScene& known : scenes_) {
    AcceptedMap& map = maps.emplace_back();
    for (CertifiedEnclosure& row : mapped(true_kernels, known.scene)) map.push_back({std::move(row), false});
    in_parallel(map.size(),
                [&](std::size_t i) { map[i].proved = proves(known.check, known.scene.points[i], map[i].row); });
  }
  return maps;
}

Judgement MapJudge::operator()(const CompiledKernels& kernels, std::span<const AcceptedMap> accepted) const {
  Judgement judgement;
  std::vector<std::vector<CertifiedEnclosure>> maps;
  for (std::size_t k = 0; k < scenes_.size(); ++k) {
    const auto& [scene, check, truth] = scenes_[k];
    maps.push_back(mapped(kernels, scene));
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const CertifiedEnclosure& row = maps.back()[i];
      if (!accepted[k][i].proved || !disjoint(row.distance, truth[i])) continue;
      ++judgement.false_rows;
      if (!proves(check, scene.points[i], row)) ++judgement.unproved_rows;
      if (judgement.first.empty()) judgement.first = described(scene, i, row.distance, truth[i]);
    }
  }
  if (judgement.false_rows > 0) return judgement;
  for (std::size_t k = 0; k < scenes_.size(); ++k) {
    const auto& [scene, check, truth] = scenes_[k];
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const CertifiedEnclosure& row = maps[k][i];
      const auto& [honest, proved] = accepted[k][i];
      if (!proved || follows_from(row, honest) || proves(check, scene.points[i], row)) continue;
      return {0, 1, described(scene, i, row.distance, truth[i])};
    }
  }
  return judgement;
}

}  // namespace verisq::mutation

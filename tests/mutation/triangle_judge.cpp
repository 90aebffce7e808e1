/// This file implements the launches of the triangle kernels and the comparison.
#include "tests/mutation/triangle_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <verisq/checker.hpp>

#include "host/device/query_batches.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/in_parallel.hpp"

namespace verisq::mutation {
namespace {

using oracle::Real;

/// What the kernels say about one triangle.
struct Row {
  Enclosure distance;
  std::vector<Enclosure> of_primitives;
  device::TriangleEvidence evidence;
};

constexpr std::size_t outputs = 7;  // lower and upper ends, normals x, y, z, weights 1 and 2

Columns corner_columns(const std::vector<Triangle>& triangles, std::size_t length) {
  Columns columns(9);
  for (std::size_t n = 0; n < length; ++n)
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].push_back(triangles[std::min(n, triangles.size() - 1)][c / 3][c % 3]);
  return columns;
}

/// Launched as host/device/query_batches.cpp does.
std::vector<Row> mapped(const CompiledKernels& kernels, const TriangleScene& scene) {
  const std::size_t count = scene.model.primitives.size();
  const std::size_t length = padded(scene.triangles.size(), kernels);
  const cl::NDRange groups(length / static_cast<std::size_t>(kernels.vector_width));
  const cl::CommandQueue queue(kernels.context, kernels.device);
  const cl::Buffer corners = uploaded(kernels, corner_columns(scene.triangles, length));
  const cl::Buffer primitives = uploaded(kernels, scene.model.primitives);
  const cl::Buffer nearest = zeros(kernels, length);
  std::vector<std::array<cl::Buffer, outputs>> of_primitive(count);
  std::array<Columns, outputs> found;
  for (cl_uint index = 0; index < count; ++index) {
    cl::Kernel kernel(kernels.program, "triangle_distance");
    kernel.setArg(0, cl_ulong{groups[0]});
    kernel.setArg(1, cl_ulong{length});
    kernel.setArg(2, corners);
    kernel.setArg(3, primitives);
    kernel.setArg(4, index);
    kernel.setArg(5, nearest);
    for (cl_uint i = 0; i < outputs; ++i) kernel.setArg(6 + i, of_primitive[index][i] = zeros(kernels, length));
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, groups);
    for (std::size_t i = 0; i < outputs; ++i) found[i].push_back(read(queue, of_primitive[index][i], length));
  }
  // A kernel does not keep the buffers that it is given.
  const std::array all{uploaded(kernels, found[0]), uploaded(kernels, found[1])};
  const std::array ends{zeros(kernels, length), zeros(kernels, length)};
  cl::Kernel of_union(kernels.program, "triangle_union_distance");
  of_union.setArg(0, cl_ulong{groups[0]});
  of_union.setArg(1, cl_ulong{length});
  of_union.setArg(2, static_cast<cl_uint>(count));
  of_union.setArg(3, all[0]);
  of_union.setArg(4, all[1]);
  of_union.setArg(5, ends[0]);
  of_union.setArg(6, ends[1]);
  queue.enqueueNDRangeKernel(of_union, cl::NullRange, groups);
  const std::vector<double> los = read(queue, ends[0], length);
  const std::vector<double> his = read(queue, ends[1], length);
  std::vector<Row> rows;
  for (std::size_t n = 0; n < scene.triangles.size(); ++n) {
    Row& row = rows.emplace_back(Row{{los[n], his[n]}, {}, {}});
    for (std::size_t k = 0; k < count; ++k) {
      const auto number = [&](std::size_t i) { return found[i][k][n]; };
      row.of_primitives.push_back({number(0), number(1)});
      row.evidence.push_back({{number(1), {number(2), number(3), number(4)}}, {number(5), number(6)}});
    }
  }
  return rows;
}

/// NaN misses everything.
bool misses(const Enclosure& claimed, const Real& lower, const Real& upper) {
  return !(claimed.lo <= upper && claimed.hi >= lower);
}

/// Weights beside an upper end that are no point's.
bool outside_triangle(double hi, const std::array<double, 2>& weights) {
  if (hi == INFINITY) return false;
  return !(weights[0] >= 0.0 && weights[1] >= 0.0 && Real(weights[0]) + Real(weights[1]) <= 1);
}

std::string described(const TriangleScene& scene, std::size_t n, std::string_view what, const Enclosure& claimed,
                      const Real& lower, const Real& upper) {
  return fmt::format("{}, triangle {}, {}: [{:.17g}, {:.17g}], the truth is in [{}, {}]", scene.name, n, what,
                     claimed.lo, claimed.hi, oracle::text(lower), oracle::text(upper));
}

/// What is false in one row, or nothing.
std::string fault_of(const TriangleScene& scene, std::size_t n, const Row& row,
                     const std::vector<oracle::TriangleReference>& references) {
  Real lower = references.front().lower;
  Real upper = references.front().upper;
  for (std::size_t k = 0; k < references.size(); ++k) {
    const auto& reference = references[k];
    lower = std::min(lower, reference.lower);
    upper = std::min(upper, reference.upper);
    if (misses(row.of_primitives[k], reference.lower, reference.upper))
      return described(scene, n, "a primitive", row.of_primitives[k], reference.lower, reference.upper);
    if (outside_triangle(row.of_primitives[k].hi, row.evidence[k].weights))
      return fmt::format("{}, triangle {}: weights {:.17g}, {:.17g}", scene.name, n, row.evidence[k].weights[0],
                         row.evidence[k].weights[1]);
  }
  return misses(row.distance, lower, upper) ? described(scene, n, "the union", row.distance, lower, upper) : "";
}

bool proves(const Checker& check, const Triangle& triangle, const Row& row) {
  if (std::isnan(row.distance.lo) || std::isnan(row.distance.hi)) return false;
  return check(triangle, row.distance, certificate_of(row.evidence)).verdict == Verdict::proved;
}

}  // namespace

TriangleJudge::TriangleJudge(std::vector<TriangleScene> scenes) {
  for (TriangleScene& scene : scenes) {
    std::vector<std::vector<oracle::TriangleReference>> references(scene.triangles.size());
    oracle::in_parallel(references.size(), [&](std::size_t n) {
      for (const Primitive& p : scene.model.primitives)
        references[n].push_back(
            oracle::reference_distance(oracle::PosedSolid(p.superquadric, p.pose), scene.triangles[n]));
    });
    Checker check(scene.model);
    scenes_.push_back({std::move(scene), std::move(check), std::move(references)});
  }
}

std::string TriangleJudge::false_claim(const CompiledKernels& kernels) const {
  for (const auto& [scene, check, references] : scenes_) {
    const std::vector<Row> rows = mapped(kernels, scene);
    for (std::size_t n = 0; n < rows.size(); ++n) {
      std::string fault = fault_of(scene, n, rows[n], references[n]);
      if (!fault.empty()) return fault;
    }
  }
  return {};
}

std::string TriangleJudge::unproved_row(const CompiledKernels& kernels, const CompiledKernels& true_kernels) const {
  for (const auto& [scene, check, references] : scenes_) {
    const std::vector<Row> rows = mapped(kernels, scene);
    const std::vector<Row> true_rows = mapped(true_kernels, scene);
    for (std::size_t n = 0; n < rows.size(); ++n) {
      const Triangle& triangle = scene.triangles[n];
      if (proves(check, triangle, rows[n]) || !proves(check, triangle, true_rows[n])) continue;
      return fmt::format("{}, triangle {}: [{:.17g}, {:.17g}] is not proved", scene.name, n, rows[n].distance.lo,
                         rows[n].distance.hi);
    }
  }
  return {};
}

}  // namespace verisq::mutation

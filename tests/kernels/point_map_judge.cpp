/// This file implements both ways from points to rows, and the comparison of all that they write.
#include "tests/kernels/point_map_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/point_pipe.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/maps/certified_rows.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/kernels/kernel_launch.hpp"
#include "verisq/distance.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t vectors = 2;  // of a work-item

struct Scene {
  std::size_t size;
  double unit;  // of the solid and the points
  double tolerance;
  std::array<Layout, 3> points;
  std::array<Layout, 2> ends;
  Layout status;
  std::size_t local;  // work-items a work-group
  bool finite;
};

struct Written {
  std::vector<double> ends;
  std::vector<std::uint8_t> status;
  std::vector<RowSums> sums;
  std::vector<cl_uint> refused{0};

  bool operator==(const Written& other) const {
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a.front())) == 0;
    };
    return same(ends, other.ends) && same(status, other.status) && same(refused, other.refused) &&
           std::ranges::equal(sums, other.sums, [](const RowSums& a, const RowSums& b) {
             return a.minimum_lo == b.minimum_lo && a.minimum_hi == b.minimum_hi &&
                    a.largest_width == b.largest_width && a.verified == b.verified && a.wide == b.wide &&
                    a.wide_inside == b.wide_inside && a.open == b.open && a.open_inside == b.open_inside;
           });
  }
};

Primitive solid_of(double unit) {
  return {
      "", {{unit, 1.5 * unit, 0.6 * unit}, {1.0, 1.2}}, {{0.3 * unit, -0.1 * unit, 0.2 * unit}, {0.8, 0.0, 0.6, 0.0}}};
}

std::array<std::vector<double>, 3> points_of(const Scene& scene) {
  std::mt19937_64 generator(scene.size);
  std::uniform_real_distribution<double> within(-3.0, 3.0);
  std::size_t length = 0;
  for (const Layout& layout : scene.points) length = std::max(length, extent(layout, scene.size));
  std::array<std::vector<double>, 3> memories;
  for (std::vector<double>& memory : memories) {
    memory.resize(length);
    for (double& x : memory) x = within(generator) * scene.unit * (generator() % 10 == 0 ? 1e-2 : 1.0);
  }
  if (!scene.finite) memories[scene.size % 3][place(scene.points[scene.size % 3], scene.size / 2)] = NAN;
  return memories;
}

class Both {
 public:
  Both(const Device& device, const cl::Program& program, const Scene& scene)
      : program_(program),
        scene_(scene),
        launcher_(device),
        model_{"", {solid_of(scene.unit)}},
        scale_(scale_exponent(model_)),
        width_(static_cast<std::size_t>(device.vector_width)),
        padded_((scene.size + width_ - 1) / width_ * width_),
        groups_((scene.size + vectors * width_ * scene.local - 1) / (vectors * width_ * scene.local)) {
    const PrimitiveParameters parameters = primitive_parameters(model_.primitives.front(), scale_exponent(model_));
    primitives_ = launcher_.uploaded(std::vector<PrimitiveParameters>{parameters});
    const auto memories = points_of(scene);
    for (std::size_t i = 0; i < 3; ++i) points_[i] = launcher_.uploaded(memories[i]);
  }

  Written at_once() {
    begin();
    NamedKernel kernel(program_, kernels::embedded_point_map(), "point_map");
    set_points(kernel);
    kernel.set("primitives", primitives_);
    set_rows(kernel);
    kernel.set("vectors", vectors);
    launcher_.launch(kernel, groups_, scene_.local);
    return written();
  }

  Written in_steps(const cl::Program& steps) {
    begin();
    const auto column = [&] { return launcher_.uploaded(std::vector<double>(padded_)); };
    const std::array<cl::Buffer, 3> columns{column(), column(), column()};
    const std::array<cl::Buffer, 5> evidence{column(), column(), column(), column(), column()};
    const std::array<cl::Buffer, 2> found{evidence[0], evidence[1]};
    NamedKernel first(steps, kernels::embedded_point_sources(), "point_columns");
    set_points(first);
    first.set("vectors", vectors);
    first.set(coordinate_arguments, columns);
    launcher_.launch(first, (padded_ / width_ + vectors - 1) / vectors, 1);

    const cl::Buffer listed = column();
    const cl::Buffer nearest = column();
    NamedKernel second(steps, kernels::embedded_point_sources(), "point_distance");
    second.set("groups", padded_ / width_);
    second.set("groups_per_block", std::size_t{1});
    second.set(coordinate_arguments, columns);
    second.set("primitives", primitives_);
    second.set("index", std::size_t{0});
    second.set("listed", listed);
    second.set("nearest", nearest);
    second.set(evidence_arguments, evidence);
    launcher_.launch(second, padded_ / width_, 1);

    NamedKernel third(steps, kernels::embedded_point_sources(), "point_rows");
    third.set(coordinate_arguments, columns);
    third.set(union_arguments, found);
    set_rows(third);
    third.set("vectors", vectors);
    launcher_.launch(third, groups_, scene_.local);
    return written();
  }

 private:
  void begin() {
    result_ = {};
    result_.ends.assign(std::max(extent(scene_.ends[0], scene_.size), extent(scene_.ends[1], scene_.size)) + 1, -7.0);
    result_.status.assign(extent(scene_.status, scene_.size) + 1, 77);
    result_.sums.resize(groups_);
    ends_ = launcher_.uploaded(result_.ends);
    status_ = launcher_.uploaded(result_.status);
    sums_ = launcher_.uploaded(result_.sums);
    refused_ = launcher_.uploaded(result_.refused);
  }

  Written written() {
    launcher_.download(ends_, result_.ends);
    launcher_.download(status_, result_.status);
    launcher_.download(sums_, result_.sums);
    launcher_.download(refused_, result_.refused);
    return result_;
  }

  void set_points(NamedKernel& kernel) {
    constexpr std::array axes{"x", "y", "z"};
    kernel.set("size", scene_.size);
    kernel.set("factor", scale_.factor());
    for (std::size_t i = 0; i < 3; ++i) set(kernel, axes[i], points_[i], scene_.points[i]);
    kernel.set("refused", refused_);
  }

  void set_rows(NamedKernel& kernel) {
    const double radius = bounding_radius(model_);
    kernel.set("size", scene_.size);
    kernel.set("factor", scale_.factor());
    kernel.set("inverse", scale_.inverse());
    kernel.set("tolerance", scene_.tolerance * scene_.unit);
    kernel.set("inside", tightest_inside * radius);
    kernel.set("outside", tightest_outside);
    kernel.set("radius", radius);
    set(kernel, "lo", ends_, scene_.ends[0]);
    set(kernel, "hi", ends_, scene_.ends[1]);
    set(kernel, "status", status_, scene_.status);
    kernel.set("sums", sums_);
    kernel.set("of_items", cl::Local(scene_.local * sizeof(RowSums)));
  }

  cl::Program program_;
  Scene scene_;
  Launcher launcher_;
  Model model_;
  Scale scale_;
  std::size_t width_, padded_, groups_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_, ends_, status_, sums_, refused_;
  std::array<cl::Buffer, 3> points_;
  Written result_;
};

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  std::size_t turn = 0;
  for (const std::size_t size : {1U, 3U, 16U, 67U, 150U}) {
    const std::size_t last = size - 1;
    const std::array<std::array<Layout, 3>, 3> points{{{{{0, 3}, {1, 3}, {2, 3}}},
                                                       {{{0, 1}, {size, 1}, {2 * size, 1}}},
                                                       {{{5 * last, -5}, {1 + 5 * last, -5}, {2, 7}}}}};
    const std::array<std::array<Layout, 3>, 3> rows{
        {{{{0, 1}, {size, 1}, {0, 1}}}, {{{0, 3}, {1, 3}, {16, 24}}}, {{{2 * last, -2}, {1, 2}, {3 * last, -3}}}}};
    for (const double unit : {1.0, 0x1p-300, 48.0}) {
      for (const double tolerance : {0.0, 1e-14, 1e-5}) {
        for (const bool finite : {true, false}) {
          const auto& [lo, hi, status] = rows[turn % rows.size()];
          const std::size_t local = turn % 2 == 0 ? 1 : 4;
          all.push_back({size, unit, tolerance, points[turn % points.size()], {lo, hi}, status, local, finite});
          ++turn;
        }
      }
    }
  }
  return all;
}

}  // namespace

std::string false_point_map(const Device& device, const cl::Program& program) {
  const cl::Program steps =
      build_program(device.context, device.device, device.vector_width, kernels::embedded_point_sources());
  for (const Scene& scene : scenes()) {
    Both both(device, program, scene);
    if (both.at_once() == both.in_steps(steps)) continue;
    return fmt::format("{} points, unit {}, tolerance {}, finite {}: not what is found in steps", scene.size,
                       scene.unit, scene.tolerance, scene.finite);
  }
  return {};
}

}  // namespace verisq::device

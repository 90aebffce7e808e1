/// This file implements the launches of the lemmas, and the comparison with what is known.
#include "tests/mutation/depth_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/launch.hpp"

namespace verisq::mutation {
namespace {

constexpr double slack = 1e-12;           // of what is computed here, relatively
constexpr double metric_slack = 1e-10;    // of excesses, whose arguments binary64 rounds
constexpr double gradient_slack = 1e-13;  // of powers of quotients

constexpr const char* examination = R"(
ALWAYS_INLINE interval number_at(global const double* given, ulong stride, uint column, ulong group) {
  const real x = LOAD(group, given + column * stride);
  return interval_of(x, x);
}
ALWAYS_INLINE interval ends_at(global const double* given, ulong stride, uint column, ulong group) {
  return interval_of(LOAD(group, given + column * stride), LOAD(group, given + (column + 1) * stride));
}
kernel void examine_metrics(ulong groups, ulong stride, global const double* given, double curvature,
                            global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const unbent c = unbend(number_at(given, stride, 0, group), number_at(given, stride, 1, group), curvature);
  const unbent q = unbend(number_at(given, stride, 2, group), number_at(given, stride, 3, group), curvature);
  const ball_metric m = metric_of_ball(LOAD(group, given + 4 * stride), q, c, curvature);
  STORE(m.stretch, group, results);
  STORE(m.tau, group, results + stride);
  STORE(m.reach.x, group, results + 2 * stride);
  STORE(m.reach.y, group, results + 3 * stride);
  STORE(m.reach.z, group, results + 4 * stride);
  STORE(TO_REAL(m.valid), group, results + 5 * stride);
  STORE(middle_of(c.z) - middle_of(q.z), group, results + 6 * stride);
}
kernel void examine_seconds(ulong groups, ulong stride, global const double* given,
                            constant const box_primitive* primitives, uint count, uint by_profile,
                            global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  constant const box_primitive* p = primitives + group % count;
  const interval3 at = {ends_at(given, stride, 0, group), ends_at(given, stride, 2, group),
                        ends_at(given, stride, 4, group)};
  const real a = LOAD(group, given + 6 * stride);
  STORE(by_profile ? second_derivative_by_profile_up(at, a, p) : second_derivative_up(ratios_in(at, p), a, p), group,
        results);
}
kernel void examine_ways(ulong groups, ulong stride, global const double* given,
                         constant const box_primitive* primitives, uint count, uint by_profile,
                         global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  interval at[9];
  for (uint i = 0; i < 9; ++i) at[i] = number_at(given, stride, i, group);
  const interval3 c = {at[0], at[1], at[2]};
  const interval3 q = {at[3], at[4], at[5]};
  const vector3 reach = {at[6].hi, at[7].hi, at[8].hi};
  const real stretch = LOAD(group, given + 9 * stride);
  STORE(weighted_second_derivative_up(c, q, reach, stretch, by_profile, primitives + group % count), group, results);
}
kernel void examine_gradients(ulong groups, ulong stride, global const double* given,
                              constant const box_primitive* primitives, uint count, uint by_profile,
                              global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  constant const box_primitive* p = primitives + group % count;
  const interval3 at = {ends_at(given, stride, 0, group), ends_at(given, stride, 2, group),
                        ends_at(given, stride, 4, group)};
  const boundary_function found = by_profile ? profile_at(at, p) : gauge_square_at(at, p);
  STORE(found.gradient.x.lo, group, results);
  STORE(found.gradient.x.hi, group, results + stride);
  STORE(found.gradient.y.lo, group, results + 2 * stride);
  STORE(found.gradient.y.hi, group, results + 3 * stride);
  STORE(found.gradient.z.lo, group, results + 4 * stride);
  STORE(found.gradient.z.hi, group, results + 5 * stride);
  STORE(found.twice_up, group, results + 6 * stride);
}
kernel void examine_balls(ulong groups, ulong stride, global const double* given,
                          constant const box_primitive* primitives, uint count, uint by_profile,
                          global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  constant const box_primitive* p = primitives + group % count;
  interval at[6];
  for (uint i = 0; i < 6; ++i) at[i] = number_at(given, stride, i, group);
  const vector3 q = {at[0].lo, at[1].lo, at[2].lo};
  const vector3 border = {at[3].lo, at[4].lo, at[5].lo};
  const unbent q_0 = unbend(at[0], at[2], p->curvature);
  const unbent x = unbend(at[3], at[5], p->curvature);
  const unbent_ball ball = ball_in_own_axes(q, q_0, border, x, p);
  STORE(TO_REAL(function_stays_below(ball, by_profile, p)), group, results);
}
)";

/// Column by column.
template <class Case>
Columns columns_of(const std::vector<Case>& cases) {
  Columns columns(cases.front().given.size());
  for (const Case& one : cases)
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(one.given[c]);
  return columns;
}

class Launcher {
 public:
  Launcher(const CompiledKernels& kernels, const DepthSolids& solids)
      : kernels_(kernels),
        queue_(kernels.context, kernels.device),
        count_(static_cast<cl_uint>(solids.of_lemmas)),
        primitives_(device::uploaded_box_primitives(kernels, Model{"", solids.all, {}}, 0)) {}

  [[nodiscard]] Columns metrics(const std::vector<MetricCase>& cases) const {
    const std::size_t length = cases.size();
    const cl::Buffer results = zeros(kernels_, 7 * length);
    run("examine_metrics", length, groups_of(length), cl_ulong{length}, uploaded(kernels_, columns_of(cases)),
        metric_curvature, results);
    return split(results, 7, length);
  }

  /// What a kernel with the usual arguments makes of the cases of all solids, in so many columns.
  template <class Case>
  [[nodiscard]] Columns of_solids(const char* name, const std::vector<Case>& cases, bool by_profile,
                                  std::size_t columns) const {
    const std::size_t length = cases.size();
    const cl::Buffer results = zeros(kernels_, columns * length);
    run(name, length, groups_of(length), cl_ulong{length}, uploaded(kernels_, columns_of(cases)), primitives_, count_,
        static_cast<cl_uint>(by_profile), results);
    return split(results, columns, length);
  }

  [[nodiscard]] std::vector<Enclosure> depths(const std::vector<DepthCase>& cases, std::size_t solid) const {
    const std::size_t length = cases.size();
    std::array<cl::Buffer, 3> axes;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> column;
      column.reserve(length);
      for (const DepthCase& one : cases) column.push_back(one.point[k]);
      axes[k] = uploaded(kernels_, Columns{column});
    }
    std::array<cl::Buffer, 5> results;
    for (cl::Buffer& column : results) column = zeros(kernels_, length);
    run("bent_distance", length, groups_of(length), groups_per_block, axes[0], axes[1], axes[2], primitives_,
        static_cast<cl_uint>(solid), zeros(kernels_, length), results[0], results[1], results[2], results[3],
        results[4]);
    const std::vector<double> los = read(queue_, results[0], length);
    const std::vector<double> his = read(queue_, results[1], length);
    std::vector<Enclosure> found;
    for (std::size_t n = 0; n < length; ++n) found.push_back({los[n], his[n]});
    return found;
  }

 private:
  /// Vectors hold cases of one solid. Precondition: `compiled` and the cases agree.
  [[nodiscard]] cl_ulong groups_of(std::size_t length) const {
    return length / static_cast<std::size_t>(kernels_.vector_width);
  }

  [[nodiscard]] Columns split(const cl::Buffer& buffer, std::size_t count, std::size_t length) const {
    const std::vector<double> numbers = read(queue_, buffer, count * length);
    Columns columns;
    for (std::size_t c = 0; c < count; ++c)
      columns.emplace_back(numbers.begin() + static_cast<std::ptrdiff_t>(c * length),
                           numbers.begin() + static_cast<std::ptrdiff_t>((c + 1) * length));
    return columns;
  }

  template <class... Arguments>
  void run(const char* name, std::size_t length, const Arguments&... arguments) const {
    cl::Kernel kernel(kernels_.program, name);
    cl_uint next = 0;
    (kernel.setArg(next++, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups_of(length)));
    queue_.finish();  // a kernel does not keep the buffers that it is given
  }

  const CompiledKernels& kernels_;
  cl::CommandQueue queue_;
  cl_uint count_;
  cl::Buffer primitives_;
};

/// `found` is a row of examine_metrics.
std::string metric_fault(const MetricCase& known, const std::array<double, 7>& found) {
  const auto [stretch, tau, reach_x, reach_y, reach_z, valid, apart] = found;
  if (valid == 0.0) return {};
  if (!(std::fabs(apart - known.apart) < 1.0)) return "c a whole turn away";
  if (!(stretch > 0.0 && tau >= 0.0 && tau < 1.0)) return fmt::format("stretch {}, tau {}", stretch, tau);
  if (!(reach_x >= known.reach_r && reach_y >= known.reach_r)) return fmt::format("reach in r or s {}", reach_x);
  if (!(reach_z >= known.reach_z)) return fmt::format("reach in z {:.17g} of {:.17g}", reach_z, known.reach_z);
  for (const MetricCase::Point& x : known.points) {
    const double square = x.across + stretch * stretch * x.along;
    if (!(x.excess >= (1.0 - tau) * square - metric_slack * square))
      return fmt::format("excess {:.17g} of a step with {:.17g}", x.excess, (1.0 - tau) * square);
  }
  return {};
}

std::string metrics_fault(const Launcher& launcher, const std::vector<MetricCase>& cases) {
  const Columns found = launcher.metrics(cases);
  for (std::size_t n = 0; n < cases.size(); ++n) {
    std::array<double, 7> row{};
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = found[c][n];
    const std::string fault = metric_fault(cases[n], row);
    if (!fault.empty()) return fmt::format("metric {} of {:.17g}: {}", n, fmt::join(cases[n].given, ", "), fault);
  }
  return {};
}

/// NaN is no bound.
std::string seconds_fault(const Launcher& launcher, const std::vector<SecondCase>& cases, bool by_profile) {
  const std::vector<double> found = launcher.of_solids("examine_seconds", cases, by_profile, 1).front();
  for (std::size_t n = 0; n < cases.size(); ++n)
    if (!(found[n] >= (1.0 - slack) * cases[n].largest))
      return fmt::format("second derivative {} of {:.17g}: {:.17g} is above {:.17g}", n,
                         fmt::join(cases[n].given, ", "), cases[n].largest, found[n]);
  return {};
}

std::string ways_fault(const Launcher& launcher, const std::vector<WayCase>& cases, bool by_profile) {
  const std::vector<double> found = launcher.of_solids("examine_ways", cases, by_profile, 1).front();
  for (std::size_t n = 0; n < cases.size(); ++n)
    if (!(found[n] >= (1.0 - slack) * cases[n].weighted))
      return fmt::format("way {} of {:.17g}: {:.17g} is above {:.17g}", n, fmt::join(cases[n].given, ", "),
                         cases[n].weighted, found[n]);
  return {};
}

std::string gradients_fault(const Launcher& launcher, const std::vector<GradientCase>& cases, bool by_profile) {
  const Columns found = launcher.of_solids("examine_gradients", cases, by_profile, 7);
  for (std::size_t n = 0; n < cases.size(); ++n) {
    const GradientCase& known = cases[n];
    for (std::size_t i = 0; i < 3; ++i) {
      const double lo = found[2 * i][n];
      const double hi = found[2 * i + 1][n];
      const double slack_of_both = gradient_slack * (std::fabs(known.least[i]) + std::fabs(known.largest[i]));
      if (!(lo <= known.least[i] + slack_of_both && hi >= known.largest[i] - slack_of_both))
        return fmt::format("gradient {}, {} of {:.17g}: [{:.17g}, {:.17g}], the truth is [{:.17g}, {:.17g}]", n, i,
                           fmt::join(known.given, ", "), lo, hi, known.least[i], known.largest[i]);
    }
    if (!(found[6][n] >= known.twice - gradient_slack * std::max(1.0, std::fabs(known.twice))))
      return fmt::format("twice the value {} of {:.17g}: {:.17g} is above {:.17g}", n, fmt::join(known.given, ", "),
                         known.twice, found[6][n]);
  }
  return {};
}

std::string function_fault(const Launcher& launcher, const FunctionCases& cases, bool by_profile) {
  std::string fault = seconds_fault(launcher, cases.seconds, by_profile);
  if (fault.empty()) fault = ways_fault(launcher, cases.ways, by_profile);
  if (fault.empty()) fault = gradients_fault(launcher, cases.gradients, by_profile);
  return fault.empty() || !by_profile ? fault : "profile: " + fault;
}

std::string balls_fault(const Launcher& launcher, const std::vector<BallCase>& cases, bool by_profile) {
  const std::vector<double> found = launcher.of_solids("examine_balls", cases, by_profile, 1).front();
  for (std::size_t n = 0; n < cases.size(); ++n)
    if (found[n] != 0.0 && cases[n].outside)
      return fmt::format("ball {} of {:.17g} is not inside", n, fmt::join(cases[n].given, ", "));
  return {};
}

std::string depths_fault(const Launcher& launcher, const std::vector<DepthCase>& cases, std::size_t solid) {
  const std::vector<Enclosure> found = launcher.depths(cases, solid);
  for (std::size_t n = 0; n < cases.size(); ++n)
    if (!(-found[n].hi <= (1.0 + slack) * cases[n].most && -found[n].lo >= (1.0 - slack) * cases[n].least))
      return fmt::format("depth of ({:.17g}) in solid {}: [{:.17g}, {:.17g}], the truth is in [{:.17g}, {:.17g}]",
                         fmt::join(cases[n].point, ", "), solid, found[n].lo, found[n].hi, -cases[n].most,
                         -cases[n].least);
  return {};
}

double share(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
}

}  // namespace

DepthJudge::DepthJudge(Tapers tapers) : tapers_(tapers), solids_(depth_solids(tapers)), cases_(solids_) {}

std::string DepthJudge::sources() const {
  const bool tapered = tapers_ == Tapers::some;
  const auto shown =
      std::ranges::find(solids_.all, tapered, [](const Primitive& p) { return is_tapered(p.superquadric); });
  const std::string_view bent = tapered ? kernels::embedded_tapered_bent_distance() : kernels::embedded_bent_distance();
  return device::model_source(Model{"", {*shown}, {}}, std::string(bent) + examination);
}

std::string DepthJudge::false_claim(const CompiledKernels& kernels) const {
  const Launcher launcher(kernels, solids_);
  std::string fault = metrics_fault(launcher, cases_.metrics);
  for (const bool by_profile : {false, true}) {
    if (tapers_ == Tapers::some && !by_profile) continue;
    if (fault.empty()) fault = function_fault(launcher, by_profile ? cases_.of_profile : cases_.of_gauge, by_profile);
    if (fault.empty()) fault = balls_fault(launcher, cases_.balls, by_profile);
  }
  for (std::size_t i = 0; i < solids_.all.size() && fault.empty(); ++i)
    fault = depths_fault(launcher, cases_.depths[i], i);
  return fault;
}

DepthJudge::Shares DepthJudge::shares(const CompiledKernels& kernels) const {
  const Launcher launcher(kernels, solids_);
  const std::vector<double> valid = launcher.metrics(cases_.metrics)[5];
  const auto balls = [&](bool by_profile) {
    return launcher.of_solids("examine_balls", cases_.balls, by_profile, 1).front();
  };
  std::size_t inside = 0;
  for (const BallCase& ball : cases_.balls) inside += ball.outside ? 0 : 1;
  std::size_t known = 0;
  std::size_t tight = 0;
  for (std::size_t i = 0; i < solids_.all.size(); ++i) {
    const std::vector<Enclosure> found = launcher.depths(cases_.depths[i], i);
    for (std::size_t n = 0; n < found.size(); ++n) {
      if (cases_.depths[i][n].least == 0.0) continue;
      ++known;
      tight += found[n].width() < 1e-9 ? 1 : 0;
    }
  }
  const auto all = [](const std::vector<double>& masks) {
    return masks.size() - static_cast<std::size_t>(std::count(masks.begin(), masks.end(), 0.0));
  };
  return {share(all(valid), valid.size()), share(all(balls(false)), inside), share(all(balls(true)), inside),
          share(tight, known)};
}

}  // namespace verisq::mutation

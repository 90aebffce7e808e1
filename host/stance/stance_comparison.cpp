/// This file implements the comparison with the paper and the samples of stance_results.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <utility>
#include <verisq/error.hpp>

#include "host/stance/stance_results.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {
namespace {

using verify::Direction;

constexpr std::array<std::string_view, 4> row_names{"w1", "w2", "w4", "w6"};
constexpr std::array<std::size_t, 4> row_components{0, 1, 3, 5};

/// Constants that the paper does not give; flags.
enum Reconstructed : unsigned {
  none = 0,
  gravity = 1,
  legs = 2,          ///< their mass, 30.82 kg
  feet = 4,          ///< place of the feet: with the pelvis's frame, the legs' first moment of mass, 1.3865 kg m
  femur = 8,         ///< mass of the femur, 10.34 kg
  hips = 16,         ///< 0.0795 m to each side
  pelvis_frame = 32  ///< 0.05 m behind the reference point
};

constexpr std::array<std::pair<unsigned, std::string_view>, 6> reconstructed_names{{
    {gravity, "gravity"},
    {legs, "mass of the legs"},
    {feet, "place of the feet"},
    {femur, "mass of the femur"},
    {hips, "place of the hips"},
    {pelvis_frame, "place of the pelvis's frame"},
}};

std::vector<std::string_view> names_of(unsigned constants) {
  std::vector<std::string_view> names;
  for (const auto& [flag, name] : reconstructed_names) {
    if ((constants & flag) != 0) names.push_back(name);
  }
  return names;
}

/// The value that the paper prints, and the value that, by the audit, it should have printed.
struct Printed {
  std::optional<Hundredths> cell;
  std::optional<Hundredths> corrected = {};
  std::string_view reason = {};
};

template <std::size_t Columns>
struct PrintedTable {
  std::string_view title;
  std::array<std::string_view, Columns> columns;
  std::array<std::array<Printed, Columns>, 4> rows;
  std::array<std::array<unsigned, Columns>, 4> reconstructed;
};

constexpr Printed range(double lo, double hi) {
  return {Hundredths{lo, hi}};
}

constexpr Printed number(double value) {
  return range(value, value);
}

constexpr Printed misprinted(Hundredths cell, Hundredths corrected, std::string_view reason) {
  return {cell, corrected, reason};
}

constexpr Printed mislabelled(double value) {
  return misprinted({value, value}, {value, value},
                    "the column is the derivative by the mass of one femur, mf, not by Fx");
}

constexpr PrintedTable<3> table_2{
    "Table 2: wrench",
    {"all", "mp, px, Fx", "nominal"},
    {{{range(0, 20000), range(0, 20000), range(9999, 10000)},
      {range(-94000, -59569), range(-91500, -62069), range(-76785, -76784)},
      {range(-3189, 3189), number(0), number(0)},
      {range(-5017, 4549), range(-5017, 4549), range(133, 134)}}},
    {{{none, none, none},
      {gravity | legs, gravity | legs, gravity | legs},
      {gravity, none, none},
      {gravity | legs | feet | pelvis_frame, gravity | legs | feet | pelvis_frame,
       gravity | legs | feet | pelvis_frame}}},
};

constexpr PrintedTable<3> table_3{
    "Table 3: sensitivity over mp, px, Fx",
    {"d/dmp", "d/dpx", "d/dFx"},
    {{{number(0), number(0), range(99, 100)},
      {range(-981, -980), Printed{}, number(0)},
      {number(0), number(0), number(0)},
      {misprinted({-982, 50}, {-99, 50}, "the lower end is a misprint of -0.982"), range(-63766, -34334), number(0)}}},
    {{{none, none, none}, {gravity, none, none}, {none, none, none}, {gravity | pelvis_frame, gravity, none}}},
};

constexpr PrintedTable<4> table_4{
    "Table 4: nominal sensitivity and reference uncertainty",
    {"d/dmp", "d/dpx", "d/dFx", "r"},
    {{{number(0), number(0), mislabelled(0), range(0, 20000)},
      {number(-981), number(0), mislabelled(-981),
       misprinted({44443, 73844}, {44478, 73909}, "no enclosure: takes 9.80 where |dw2/dmp| is 9.81")},
      {number(0), number(0), mislabelled(78), number(807)},
      {number(-25), number(-49050), mislabelled(50), range(3844, 7047)}}},
    {{{none, none, none, none},
      {gravity, none, gravity, gravity | femur},
      {none, none, gravity | hips, gravity | femur | hips},
      {gravity | pelvis_frame, gravity, gravity | pelvis_frame, gravity | femur | pelvis_frame}}},
};

bool within_a_hundredth(const Hundredths& a, const Hundredths& b) {
  return std::abs(a.lo - b.lo) <= 1.0 && std::abs(a.hi - b.hi) <= 1.0;
}

CellVerdict verdict(const Printed& printed, const Hundredths& ours) {
  if (!printed.cell) return CellVerdict::unprinted;
  if (within_a_hundredth(ours, printed.corrected.value_or(*printed.cell))) {
    return printed.corrected ? CellVerdict::misprint : CellVerdict::match;
  }
  return CellVerdict::differs;
}

Cell compare(std::string_view row, std::string_view column, const Printed& printed, unsigned reconstructed,
             const Enclosure& enclosure) {
  const Hundredths ours = rounded_outward(enclosure);
  const CellVerdict found = verdict(printed, ours);
  return {row,
          column,
          ours,
          printed.cell ? text(*printed.cell) : "",
          found,
          found == CellVerdict::misprint ? printed.reason : "",
          names_of(reconstructed)};
}

/// `columns` are the enclosures of all six components, one array a column.
template <std::size_t Columns>
PaperTable compare(const PrintedTable<Columns>& printed, const std::array<WrenchEnclosure, Columns>& columns) {
  PaperTable table{printed.title, {}};
  for (std::size_t row = 0; row < row_names.size(); ++row) {
    for (std::size_t column = 0; column < Columns; ++column) {
      table.cells.push_back(compare(row_names[row], printed.columns[column], printed.rows[row][column],
                                    printed.reconstructed[row][column], columns[column][row_components[row]]));
    }
  }
  return table;
}

std::uint32_t parameter(const Model& model, std::string_view name) {
  const auto found = std::ranges::find(model.parameters, name, &Parameter::name);
  if (found == model.parameters.end()) {
    throw Error(ErrorKind::input,
                fmt::format("the tables of the paper need a parameter '{}', which the model lacks", name));
  }
  return static_cast<std::uint32_t>(found - model.parameters.begin());
}

/// A sensitivity's magnitude as the paper rounds it before it multiplies: up to the second digit. The rounding of
/// decimals to binary64 (9.81 is 9.8100000000000005) must not raise it. This repeats the paper's arithmetic and proves
/// nothing.
double printed_magnitude(const Enclosure& sensitivity) {
  constexpr double forgiven = 1e-6;  // hundredths
  const double magnitude = std::max(std::abs(sensitivity.lo), std::abs(sensitivity.hi));
  return std::ceil(100.0 * magnitude - forgiven) / 100.0;
}

/// r as the paper computes it: the sum of printed, rounded sensitivities times the ranges of the parameters.
WrenchEnclosure paper_reference_uncertainty(const Model& model, std::span<const std::uint32_t> parameters,
                                            std::span<const WrenchEnclosure> sensitivities) {
  WrenchEnclosure sum{};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Enclosure& range = model.parameters[parameters[k]].range;
    for (std::size_t component = 0; component < wrench_size; ++component) {
      const double magnitude = printed_magnitude(sensitivities[k][component]);
      auto& [lo, hi] = sum[component];
      lo = verify::add(lo, verify::multiply(magnitude, range.lo, Direction::down), Direction::down);
      hi = verify::add(hi, verify::multiply(magnitude, range.hi, Direction::up), Direction::up);
    }
  }
  return sum;
}

PaperTable wrench_table(const Model& model, UncertainSet chosen) {
  std::vector<std::uint32_t> all(model.parameters.size());
  std::iota(all.begin(), all.end(), 0U);
  return compare<3>(
      table_2, {wrench(model, all, Mode::paper), wrench(model, chosen, Mode::paper), wrench(model, {}, Mode::paper)});
}

}  // namespace

std::string_view word(CellVerdict verdict) {
  switch (verdict) {
    case CellVerdict::match: return "match";
    case CellVerdict::misprint: return "misprint in the paper";
    case CellVerdict::differs: return "differs";
    case CellVerdict::unprinted: break;
  }
  return "not printed";
}

std::vector<std::string_view> reconstructed_constants() {
  return names_of(gravity | legs | feet | femur | hips | pelvis_frame);
}

Hundredths rounded_outward(const Enclosure& enclosure) {
  // Rounding down and down again is a lower bound, and loses nothing but where the product just missed a whole number.
  return {std::floor(verify::multiply(enclosure.lo, 100.0, Direction::down)),
          std::ceil(verify::multiply(enclosure.hi, 100.0, Direction::up))};
}

std::string text(const Hundredths& cell) {
  // No negative zero. The nearest binary64 of a whole number of hundredths prints as these, below 2^53.
  const auto digits = [](double hundredths) { return fmt::format("{:.2f}", hundredths / 100.0 + 0.0); };
  if (cell.lo == cell.hi) return digits(cell.lo);
  return fmt::format("[{}, {}]", digits(cell.lo), digits(cell.hi));
}

bool PaperReport::all_explained() const {
  return std::ranges::all_of(tables, [](const PaperTable& table) {
    return std::ranges::none_of(table.cells, [](const Cell& cell) { return cell.verdict == CellVerdict::differs; });
  });
}

PaperReport compare_with_paper(const Model& model) {
  const std::uint32_t mp = parameter(model, "mp");
  const std::uint32_t px = parameter(model, "px");
  const std::uint32_t fx = parameter(model, "Fx");
  const std::uint32_t mf = parameter(model, "mf");
  const std::array chosen{mp, px, fx};
  const auto over_ranges = [&](std::uint32_t by) { return sensitivity(model, chosen, by, Mode::paper); };
  const auto nominal = [&](std::uint32_t by) { return sensitivity(model, {}, by, Mode::paper); };

  const std::array summed{mp, px, mf, fx};
  const std::array sensitivities{nominal(mp), nominal(px), nominal(mf), nominal(fx)};
  const auto r = paper_reference_uncertainty(model, summed, sensitivities);
  return {{wrench_table(model, chosen), compare<3>(table_3, {over_ranges(mp), over_ranges(px), over_ranges(fx)}),
           compare<4>(table_4, {sensitivities[0], sensitivities[1], sensitivities[2], r})},
          reference_uncertainty(model, {}, summed, Mode::paper)};
}

namespace {

constexpr std::uint64_t chunk_size = 1024;

void extend(Enclosure& hull, double value) {
  hull = {std::min(hull.lo, value), std::max(hull.hi, value)};
}

/// The model with all parameters exact.
Model at(const Model& model, std::span<const double> parameters) {
  Model point = model;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    point.parameters[i].nominal = parameters[i];
    point.parameters[i].range = {parameters[i], parameters[i]};
  }
  return point;
}

std::vector<double> nominal_values(const Model& model) {
  std::vector<double> values;
  for (const Parameter& parameter : model.parameters) values.push_back(parameter.nominal);
  return values;
}

/// The data that the threads share.
class Collection {
 public:
  Collection(std::size_t components, const SampleOptions& options) : options_(options) {
    samples_.hull.assign(components, {infinity, -infinity});
  }

  [[nodiscard]] bool ended() {
    const std::lock_guard lock(mutex_);
    return samples_.escape || (options_.interrupted && options_.interrupted());
  }

  void add(const Samples& chunk) {
    const std::lock_guard lock(mutex_);
    samples_.count += chunk.count;
    for (std::size_t k = 0; k < chunk.hull.size(); ++k) {
      extend(samples_.hull[k], chunk.hull[k].lo);
      extend(samples_.hull[k], chunk.hull[k].hi);
    }
    if (!samples_.escape) samples_.escape = chunk.escape;
    if (options_.progress) options_.progress(samples_.count);
  }

  [[nodiscard]] const Samples& samples() const { return samples_; }

 private:
  const SampleOptions& options_;
  std::mutex mutex_;
  Samples samples_{};
};

class Sampler {
 public:
  Sampler(const Model& model, UncertainSet uncertain, const Sampled& sampled)
      : model_(model), uncertain_(uncertain), sampled_(sampled) {}

  /// Ends at the first escape.
  [[nodiscard]] Samples chunk(std::uint64_t seed, std::uint64_t count) const {
    std::mt19937_64 generator(seed);
    Samples samples{0, std::vector<Enclosure>(sampled_.claimed.size(), {infinity, -infinity}), std::nullopt};
    std::vector<double> parameters = nominal_values(model_);
    while (samples.count < count && !samples.escape) {
      draw(generator, parameters);
      add(parameters, samples);
      ++samples.count;
    }
    return samples;
  }

 private:
  void draw(std::mt19937_64& generator, std::vector<double>& parameters) const {
    for (const std::uint32_t i : uncertain_) {
      const auto& [lo, hi] = model_.parameters[i].range;
      parameters[i] = std::clamp(lo + (hi - lo) * std::uniform_real_distribution<double>()(generator), lo, hi);
    }
  }

  void add(std::span<const double> parameters, Samples& samples) const {
    const std::vector<double> values = sampled_.evaluate(parameters);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Enclosure& claimed = sampled_.claimed[k];
      if (!claimed.contains(values[k])) {
        const Enclosure exact = sampled_.enclose(parameters)[k];
        if (!(exact.lo <= claimed.hi && claimed.lo <= exact.hi)) {
          samples.escape = {k, exact, {parameters.begin(), parameters.end()}};
          return;
        }
      }
      extend(samples.hull[k], std::clamp(values[k], claimed.lo, claimed.hi));
    }
  }

  const Model& model_;
  UncertainSet uncertain_;
  const Sampled& sampled_;
};

}  // namespace

Sampled sampled_wrench_of(const Model& model, std::vector<Enclosure> claimed) {
  return {std::move(claimed),
          [&model](std::span<const double> parameters) {
            const auto values = sampled_wrench(model, parameters);
            return std::vector<double>(values.begin(), values.end());
          },
          [&model](std::span<const double> parameters) {
            const auto values = wrench(at(model, parameters), {}, Mode::tight);
            return std::vector<Enclosure>(values.begin(), values.end());
          }};
}

Sampled sampled_accelerations_of(const Model& model, const Instant& instant, std::vector<Enclosure> claimed) {
  return {std::move(claimed),
          [&](std::span<const double> parameters) { return sampled_accelerations(model, instant, parameters); },
          [&](std::span<const double> parameters) {
            return accelerations(at(model, parameters), {}, instant, {.cells = 1});
          }};
}

Samples take_samples(const Model& model, UncertainSet uncertain, const Sampled& sampled, const SampleOptions& options) {
  const Sampler sampler(model, uncertain, sampled);
  Collection collection(sampled.claimed.size(), options);
  const std::uint64_t chunks = options.count / chunk_size + (options.count % chunk_size > 0 ? 1 : 0);
  // In blocks: once the work is ended, no more than a block of chunks must be skipped.
  constexpr std::uint64_t block = 4096;
  for (std::uint64_t first = 0; first < chunks && !collection.ended(); first += std::min(block, chunks - first)) {
    in_parallel(std::min(block, chunks - first), [&](std::size_t i) {
      if (collection.ended()) return;
      const std::uint64_t done = (first + i) * chunk_size;
      collection.add(sampler.chunk(first + i, std::min<std::uint64_t>(chunk_size, options.count - done)));
    });
  }
  return collection.samples();
}

double filled_part(const Enclosure& hull, const Enclosure& claimed) {
  if (claimed.lo == claimed.hi) return 1.0;
  return std::clamp(hull.width() / claimed.width(), 0.0, 1.0);
}

}  // namespace verisq::stance

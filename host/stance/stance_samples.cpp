/// Chunks of samples on all processors, each with its own generator, so that the result knows nothing of threads.
#include "host/stance/stance_samples.hpp"

#include <algorithm>
#include <mutex>
#include <random>

#include "host/threads/parallel.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {
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

/// What the threads share.
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
  // In blocks: once it is ended, no more than a block of chunks is left to be passed over.
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

/// This file implements the limits as lines of text.
#include "bench/gpu_fitness/resource_limits.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <istream>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace verisq::bench {
namespace {

// How far below its limit a kernel may stay: less is no gain that anybody would miss.
constexpr unsigned slack_of_registers = 8;
constexpr unsigned slack_of_bytes = 64;

struct Figure {
  std::string_view name;
  unsigned KernelResources::*value;
  unsigned slack;
};

constexpr std::array<Figure, 3> figures{{{"registers", &KernelResources::registers, slack_of_registers},
                                         {"spilled bytes", &KernelResources::spilled_bytes, slack_of_bytes},
                                         {"bytes of stack", &KernelResources::stack_bytes, slack_of_bytes}}};

const MeasuredKernel* counterpart(const MeasuredKernel& kernel, std::span<const MeasuredKernel> others) {
  const auto found = std::ranges::find_if(others, [&](const MeasuredKernel& other) {
    return other.target == kernel.target && other.resources.kernel == kernel.resources.kernel;
  });
  return found == others.end() ? nullptr : &*found;
}

std::string name_of(const MeasuredKernel& kernel) {
  return fmt::format("{} for {}", kernel.resources.kernel, kernel.target);
}

MeasuredKernel limit_in(const std::string& line) {
  MeasuredKernel limit;
  std::istringstream words(line);
  char comma = 0;
  std::getline(words, limit.target, ',');
  std::getline(words, limit.resources.kernel, ',');
  words >> limit.resources.registers >> comma >> limit.resources.spilled_bytes >> comma >> limit.resources.stack_bytes;
  if (!words) throw std::runtime_error("no limit of a kernel: " + line);
  return limit;
}

}  // namespace

std::vector<MeasuredKernel> read_limits(std::istream& file) {
  std::vector<MeasuredKernel> limits;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line.front() != '#') limits.push_back(limit_in(line));
  return limits;
}

void write_limits(std::ostream& file, std::span<const MeasuredKernel> kernels) {
  for (const MeasuredKernel& kernel : kernels) {
    const KernelResources& own = kernel.resources;
    fmt::print(file, "{},{},{},{},{}\n", kernel.target, own.kernel, own.registers, own.spilled_bytes, own.stack_bytes);
  }
}

std::vector<std::string> contradictions(std::span<const MeasuredKernel> measured,
                                        std::span<const MeasuredKernel> limits) {
  std::vector<std::string> lines;
  for (const MeasuredKernel& kernel : measured) {
    const MeasuredKernel* const limit = counterpart(kernel, limits);
    if (limit == nullptr) {
      lines.push_back(name_of(kernel) + " has no limit");
      continue;
    }
    for (const Figure& figure : figures) {
      const unsigned own = kernel.resources.*figure.value;
      const unsigned most = limit->resources.*figure.value;
      if (own > most)
        lines.push_back(fmt::format("{}: {} {}, of which {} are allowed", name_of(kernel), own, figure.name, most));
      if (own + figure.slack < most)
        lines.push_back(fmt::format("{}: {} {}: lower the limit of {}", name_of(kernel), own, figure.name, most));
    }
  }
  for (const MeasuredKernel& limit : limits) {
    const bool compiled = std::ranges::find(measured, limit.target, &MeasuredKernel::target) != measured.end();
    if (compiled && counterpart(limit, measured) == nullptr) lines.push_back(name_of(limit) + ": no such kernel");
  }
  return lines;
}

}  // namespace verisq::bench

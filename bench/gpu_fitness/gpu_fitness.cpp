/// Compiles every kernel for graphics processors, without one, prints what it takes there, and compares that with
/// committed limits:
///   gpu_fitness LIMITS.csv [--write]
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/gpu_fitness/gpu_compiler.hpp"
#include "bench/gpu_fitness/kernel_programs.hpp"
#include "bench/gpu_fitness/resource_limits.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::bench {
namespace {

// Another release of ptxas allots registers otherwise.
constexpr std::string_view release_of_limits = "13.0";

// In the order of targets and programs.
std::vector<MeasuredKernel> measured_kernels(const std::vector<KernelProgram>& programs,
                                             const std::vector<GpuTarget>& targets) {
  std::vector<std::vector<KernelResources>> found(targets.size() * programs.size());
  in_parallel(found.size(),
              [&](std::size_t i) { found[i] = compiled(programs[i % programs.size()], targets[i / programs.size()]); });
  std::vector<MeasuredKernel> kernels;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const KernelResources& resources : found[i]) kernels.push_back({targets[i / programs.size()].name, resources});
  return kernels;
}

std::vector<std::string> defects_of(const std::vector<KernelProgram>& programs) {
  std::vector<std::vector<std::string>> found(programs.size());
  in_parallel(programs.size(), [&](std::size_t i) { found[i] = defects_of_arithmetic(programs[i]); });
  std::vector<std::string> all;
  for (const std::vector<std::string>& defects : found) all.insert(all.end(), defects.begin(), defects.end());
  return all;
}

void print(std::span<const MeasuredKernel> kernels) {
  fmt::print("{:8} {:24} {:>9} {:>8} {:>8} {:>10}\n", "target", "kernel", "registers", "spilled", "stack", "occupancy");
  for (const auto& [target, own] : kernels)
    fmt::print("{:8} {:24} {:>9} {:>6} B {:>6} B {:>8.0f} %\n", target, own.kernel, own.registers, own.spilled_bytes,
               own.stack_bytes, 100.0 * own.occupancy);
}

std::vector<GpuTarget> targets_of_compilers(std::string_view release) {
  std::vector<GpuTarget> targets;
  std::ranges::copy_if(gpu_targets(), std::back_inserter(targets),
                       [&](const GpuTarget& target) { return !target.nvidia || !release.empty(); });
  return targets;
}

// Without the kernels whose figures depend on a compiler of another release.
std::vector<MeasuredKernel> comparable(const std::vector<MeasuredKernel>& kernels, std::string_view release) {
  if (release == release_of_limits) return kernels;
  std::vector<MeasuredKernel> rest;
  std::ranges::copy_if(kernels, std::back_inserter(rest),
                       [](const MeasuredKernel& kernel) { return !kernel.target.starts_with("sm_"); });
  return rest;
}

std::vector<MeasuredKernel> limits_in(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return read_limits(file);
}

// What the compilers here cannot say stays.
void replace_limits(const std::string& path, const std::vector<MeasuredKernel>& measured) {
  std::vector<MeasuredKernel> kernels = measured;
  std::ranges::copy_if(limits_in(path), std::back_inserter(kernels), [&](const MeasuredKernel& limit) {
    return std::ranges::find(measured, limit.target, &MeasuredKernel::target) == measured.end();
  });
  std::ofstream file(path);
  file << "# target, kernel, registers, spilled bytes, bytes of stack: written by `./run gpu-fitness --write`\n";
  write_limits(file, kernels);
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

int compare(const std::string& path, std::span<const MeasuredKernel> kernels,
            const std::vector<KernelProgram>& programs) {
  std::vector<std::string> wrong = contradictions(kernels, limits_in(path));
  const std::vector<std::string> defects = defects_of(programs);
  wrong.insert(wrong.end(), defects.begin(), defects.end());
  for (const std::string& line : wrong) fmt::print("gpu_fitness: {}\n", line);
  if (wrong.empty()) fmt::print("all within the limits of {}; fp64 operations rounded to nearest\n", path);
  return wrong.empty() ? 0 : 1;
}

int run(const std::string& limits, bool write) {
  const std::string release = ptxas_release();
  const std::vector<KernelProgram> programs = kernel_programs(VERISQ_EXAMPLES);
  const std::vector<MeasuredKernel> kernels = measured_kernels(programs, targets_of_compilers(release));
  print(kernels);
  if (release != release_of_limits)
    fmt::print("NVIDIA: {}; the limits are those of ptxas {}\n",
               release.empty() ? "no ptxas here" : fmt::format("ptxas {} here", release), release_of_limits);
  if (!write) return compare(limits, comparable(kernels, release), programs);
  replace_limits(limits, comparable(kernels, release));
  return 0;
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    const bool write = arguments.size() == 2 && arguments[1] == "--write";
    if (arguments.size() == (write ? 2 : 1)) return verisq::bench::run(arguments[0], write);
    fmt::print(stderr, "usage: gpu_fitness LIMITS.csv [--write]\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "gpu_fitness: {}\n", error.what());
  }
  return 2;
}

/// This file implements the reading of assembly and of reports.
#include "bench/gpu_fitness/kernel_resources.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

namespace verisq::bench {
namespace {

constexpr unsigned bytes_of_register = 4;

// A processor of compute capability 9.0 (CUDA programming guide, technical specifications).
constexpr unsigned registers_of_processor = 65'536;
constexpr unsigned warps_of_processor = 64;
constexpr unsigned threads_of_warp = 32;
constexpr unsigned granularity_of_registers = 8;

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

// What follows `head` in the line, where it begins so.
std::optional<std::string_view> after(std::string_view line, std::string_view head) {
  if (!line.starts_with(head)) return std::nullopt;
  return trimmed(line.substr(head.size()));
}

// The number that ends just before `words`, or begins just behind them.
std::optional<unsigned> number_before(std::string_view line, std::string_view words) {
  const std::size_t end = line.find(words);
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t begin = line.find_last_not_of("0123456789", end - 1) + 1;
  unsigned number = 0;
  std::from_chars(line.data() + begin, line.data() + end, number);
  return number;
}

unsigned number_in(std::string_view text) {
  unsigned number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::vector<KernelResources> values(const std::map<std::string, KernelResources>& kernels) {
  std::vector<KernelResources> result;
  result.reserve(kernels.size());
  for (const auto& [name, resources] : kernels) result.push_back(resources);
  return result;
}

KernelResources& named(std::map<std::string, KernelResources>& kernels, std::string_view name) {
  KernelResources& resources = kernels[std::string(name)];
  resources.kernel = name;
  return resources;
}

double occupancy_of(unsigned registers) {
  const unsigned granted = std::max(1U, (registers + granularity_of_registers - 1) / granularity_of_registers);
  const unsigned warps = registers_of_processor / (threads_of_warp * granularity_of_registers * granted);
  return static_cast<double>(std::min(warps, warps_of_processor)) / warps_of_processor;
}

}  // namespace

std::vector<KernelResources> resources_in_amdgcn_assembly(std::string_view assembly, unsigned most_waves) {
  std::map<std::string, KernelResources> kernels;
  KernelResources* own = nullptr;  // of the kernel that the lines speak of
  for (const std::string_view whole_line : lines_of(assembly)) {
    const std::string_view line = trimmed(whole_line);
    if (const auto kernel = after(line, ".amdhsa_kernel ")) own = &named(kernels, *kernel);
    if (line == "; Function info:") own = nullptr;  // of a function that kernels call, which theirs contains
    // Four blanks: names of arguments stand farther in.
    if (const auto kernel = after(whole_line, "    .name: ")) own = &named(kernels, *kernel);
    if (own == nullptr) continue;
    if (const auto number = after(line, "; NumVgprs: ")) own->registers = number_in(*number);
    if (const auto number = after(line, "; TotalNumVgprs: ")) own->registers = number_in(*number);
    if (const auto number = after(line, "; ScratchSize: ")) own->stack_bytes = number_in(*number);
    if (const auto number = after(line, "; Occupancy: "))
      own->occupancy = static_cast<double>(number_in(*number)) / most_waves;
    if (const auto number = after(line, ".vgpr_spill_count: "))
      own->spilled_bytes = bytes_of_register * number_in(*number);
  }
  return values(kernels);
}

std::vector<KernelResources> resources_in_ptxas_report(std::string_view report) {
  std::map<std::string, KernelResources> kernels;
  KernelResources* own = nullptr;
  for (const std::string_view line : lines_of(report)) {
    constexpr std::string_view entry = "Compiling entry function '";
    if (const std::size_t at = line.find(entry); at != std::string_view::npos) {
      const std::string_view name = line.substr(at + entry.size());
      own = &named(kernels, name.substr(0, name.find('\'')));
    }
    if (own == nullptr) continue;
    // Of the kernel and of each function that it calls.
    if (const auto bytes = number_before(line, " bytes spill stores")) own->spilled_bytes += *bytes;
    if (const auto count = number_before(line, " registers")) {
      own->registers = *count;
      own->occupancy = occupancy_of(*count);
    }
    if (const auto bytes = number_before(line, " bytes cumulative stack size")) own->stack_bytes = *bytes;
  }
  return values(kernels);
}

std::vector<std::string> unrounded_instructions(std::string_view ptx) {
  constexpr std::array<std::string_view, 13> operations{"add.",  "sub.",   "mul.", "fma.", "mad.", "div.", "rcp.",
                                                        "sqrt.", "rsqrt.", "ex2.", "lg2.", "sin.", "cos."};
  std::vector<std::string> found;
  for (const std::string_view whole_line : lines_of(ptx)) {
    const std::string_view line = trimmed(whole_line);
    const std::string_view instruction = line.substr(0, line.find_first_of(" \t"));
    const bool on_numbers = instruction.ends_with(".f64") || instruction.ends_with(".f32");
    const bool rounds = std::ranges::any_of(operations, [&](auto name) { return instruction.starts_with(name); });
    if (on_numbers && rounds && instruction.find(".rn.") == std::string_view::npos) found.emplace_back(instruction);
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::size_t fused_operations(std::string_view ptx) {
  std::size_t count = 0;
  for (const std::string_view line : lines_of(ptx))
    count += static_cast<std::size_t>(trimmed(line).starts_with("fma."));
  return count;
}

}  // namespace verisq::bench

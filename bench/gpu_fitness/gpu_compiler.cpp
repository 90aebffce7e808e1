/// This file implements the calls of the compilers.
#include "bench/gpu_fitness/gpu_compiler.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/child_process.hpp"
#include "bench/scratch_folder.hpp"

namespace verisq::bench {
namespace {

const std::filesystem::path libclc = "/usr/lib/clc";  // of Debian's packages

// The newest that clang 15 knows; ptxas compiles it for any later processor.
constexpr std::string_view ptx_processor = "sm_80";

constexpr unsigned most_waves_of_cdna = 8;
constexpr unsigned most_waves_of_rdna = 16;

// Where the path has the program; empty where it has none.
std::string path_of(std::string_view program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const auto candidate = std::filesystem::path(folder) / program; std::filesystem::exists(candidate))
      return candidate.string();
  return {};
}

std::string clang() {
  std::string path = path_of(clang_program);
  if (path.empty()) throw std::runtime_error(fmt::format("{0} is not installed: apt-get install {0}", clang_program));
  if (!std::filesystem::exists(libclc))
    throw std::runtime_error(fmt::format("{0} is not installed: apt-get install {0}", libclc_package));
  return path;
}

std::string contents(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string output_of(const std::vector<std::string>& command, const std::string& what) {
  const ChildReport report = run_child(command, Captured::output_and_errors);
  if (report.exit_status != 0)
    throw std::runtime_error(fmt::format("{} does not compile ({}):\n{}", what, command.front(), report.output));
  return report.output;
}

struct CodeGeneration {
  std::string triple;
  std::vector<std::string> options;
};

// As host/device/program.cpp has programs compiled, for one query a work-item; the assembly goes to `file`.
void compile(const KernelProgram& program, const CodeGeneration& code, const ScratchFolder& folder,
             const std::string& file) {
  const std::string source = folder.file("source.cl");
  std::ofstream(source) << program.source;
  std::vector<std::string> command{clang(), "-x", "cl", "-cl-std=CL1.2", "-DVECTOR_WIDTH=1", "-O3", "-S", "-nogpulib"};
  command.insert(command.end(), {"-target", code.triple});
  const std::string library = libclc / (code.triple + ".bc");
  command.insert(command.end(), {"-Xclang", "-mlink-builtin-bitcode", "-Xclang", library});
  command.insert(command.end(), code.options.begin(), code.options.end());
  std::istringstream options(program.options);
  for (std::string option; options >> option;) command.push_back(option);
  command.insert(command.end(), {source, "-o", file});
  output_of(command, program.name);
}

std::string ptx_of(const KernelProgram& program, const ScratchFolder& folder, std::vector<std::string> options = {}) {
  options.insert(options.end(), {"-Xclang", "-target-cpu", "-Xclang", std::string(ptx_processor)});
  const std::string file = folder.file("assembly.ptx");
  compile(program, {"nvptx64--nvidiacl", std::move(options)}, folder, file);
  return file;
}

// One folder a compilation: several run at a time.
std::string folder_name(const KernelProgram& program, std::string_view target) {
  return fmt::format("gpu_fitness_{}_{}", program.name, target);
}

}  // namespace

const std::vector<GpuTarget>& gpu_targets() {
  static const std::vector<GpuTarget> targets{{"gfx90a", false}, {"gfx1030", false}, {"sm_90", true}};
  return targets;
}

std::string ptxas_release() {
  const std::string ptxas = path_of("ptxas");
  if (ptxas.empty()) return {};
  const std::string words = run_child({ptxas, "--version"}).output;
  constexpr std::string_view head = "release ";
  const std::size_t at = words.find(head);
  if (at == std::string::npos) return {};
  const std::string release = words.substr(at + head.size());
  return release.substr(0, release.find_first_not_of("0123456789."));
}

std::vector<KernelResources> compiled(const KernelProgram& program, const GpuTarget& target) {
  const ScratchFolder folder(folder_name(program, target.name));
  if (target.nvidia) {
    const std::string ptx = ptx_of(program, folder);
    return resources_in_ptxas_report(
        output_of({path_of("ptxas"), "-v", "-arch=" + target.name, ptx, "-o", folder.file("binary")}, program.name));
  }
  const std::string assembly = folder.file("assembly.s");
  compile(program, {"amdgcn--amdhsa", {"-mcpu=" + target.name}}, folder, assembly);
  return resources_in_amdgcn_assembly(contents(assembly),
                                      target.name.starts_with("gfx9") ? most_waves_of_cdna : most_waves_of_rdna);
}

std::vector<std::string> defects_of_arithmetic(const KernelProgram& program) {
  const ScratchFolder folder(folder_name(program, "arithmetic"));
  const std::string ptx = contents(ptx_of(program, folder));
  std::vector<std::string> defects;
  for (const std::string& instruction : unrounded_instructions(ptx))
    defects.push_back(fmt::format("{}: {} is not rounded to nearest, or may be contracted", program.name, instruction));
  const std::string uncontracted = contents(ptx_of(program, folder, {"-ffp-contract=off"}));
  if (fused_operations(ptx) != fused_operations(uncontracted))
    defects.push_back(fmt::format("{}: {} fused operations, {} where contraction is forbidden", program.name,
                                  fused_operations(ptx), fused_operations(uncontracted)));
  return defects;
}

}  // namespace verisq::bench

/// The programs and kernels of device.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <mutex>

#include "host/device/device.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

std::optional<cl::Program> from_binary(const cl::Context& context, const cl::Device& device, const std::string& binary,
                                       const std::string& options) {
  try {
    const cl::Program::Binaries binaries{std::vector<unsigned char>(binary.begin(), binary.end())};
    cl::Program program(context, {device}, binaries);
    program.build({device}, options.c_str());
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;  // a binary that the driver takes no more: compile again
  }
}

cl::Program from_sources(const cl::Context& context, const cl::Device& device, std::string_view sources,
                         const std::string& options) {
  cl::Program program(context, std::string(sources));
  try {
    program.build({device}, options.c_str());
  } catch (const cl::Error& error) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: kernels do not compile ({}, {}): {}", identity(device), error.what(), error.err(),
                            program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device)));
  }
  return program;
}

std::string options_of(int vector_width, const std::string& extra_options) {
  // Never -cl-unsafe-math-optimizations, -cl-mad-enable, -cl-denorms-are-zero: docs/rounding.md §1.
  const std::string options = fmt::format("-cl-std=CL1.2 -DVECTOR_WIDTH={}", vector_width);
  return extra_options.empty() ? options : options + " " + extra_options;
}

bool driver_keeps_binaries(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return platform.getInfo<CL_PLATFORM_NAME>() == "Portable Computing Language";
}

// The programs that this process compiled last. A driver compiles, or loads, a program in a quarter of a second: as
// long as a map of a few thousand points takes. A second mapper takes the program of the first.
class CompiledPrograms {
 public:
  // Never destroyed: a compilation that was given up may end while the process exits.
  static CompiledPrograms& of_process() {
    static auto* const programs = new CompiledPrograms;  // NOLINT(cppcoreguidelines-*): locked, and never destroyed
    return *programs;
  }

  std::optional<cl::Program> find(const cl::Context& context, std::string_view sources, std::string_view options) {
    const std::lock_guard lock(mutex_);
    for (const Compiled& known : programs_) {
      if (known.context() == context() && known.options == options && known.sources == sources) return known.program;
    }
    return std::nullopt;
  }

  void keep(const cl::Context& context, std::string_view sources, std::string_view options,
            const cl::Program& program) {
    const std::lock_guard lock(mutex_);
    programs_.push_back({context, std::string(sources), std::string(options), program});
    if (programs_.size() > most_programs) programs_.pop_front();
  }

 private:
  struct Compiled {
    cl::Context context;
    std::string sources;
    std::string options;
    cl::Program program;
  };

  static constexpr std::size_t most_programs = 32;  // more than a device has kinds of maps

  std::mutex mutex_;
  std::deque<Compiled> programs_;
};

}  // namespace

std::string identity(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return fmt::format("{} / {} / {}", device.getInfo<CL_DEVICE_NAME>(), platform.getInfo<CL_PLATFORM_VERSION>(),
                     device.getInfo<CL_DRIVER_VERSION>());
}

LoadedProgram load_program(const cl::Context& context, const cl::Device& device, int vector_width,
                           std::string_view sources, const std::string& extra_options) {
  const std::string options = options_of(vector_width, extra_options);
  const std::string key = fmt::format("program\n{}\n{}\n{}", identity(device), options, sources);
  if (auto binary = cached(key))
    if (auto program = from_binary(context, device, *binary, options)) return {*program, std::move(*binary)};
  const cl::Program program = from_sources(context, device, sources, options);
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.empty() || binaries.front().empty()) return {program, {}};
  std::string binary(binaries.front().begin(), binaries.front().end());
  store_in_cache(key, binary);
  return {program, std::move(binary)};
}

cl::Program build_program(const cl::Context& context, const cl::Device& device, int vector_width,
                          std::string_view sources, const std::string& extra_options) {
  const std::string options = options_of(vector_width, extra_options);
  CompiledPrograms& compiled = CompiledPrograms::of_process();
  if (auto program = compiled.find(context, sources, options)) return *std::move(program);
  const cl::Program program = driver_keeps_binaries(device)
                                  ? from_sources(context, device, sources, options)
                                  : load_program(context, device, vector_width, sources, extra_options).program;
  compiled.keep(context, sources, options, program);
  return program;
}

std::string program_identity(const cl::Device& device, const cl::Program& program) {
  if (driver_keeps_binaries(device))
    return fmt::format("{}\n{}", program.getBuildInfo<CL_PROGRAM_BUILD_OPTIONS>(device),
                       program.getInfo<CL_PROGRAM_SOURCE>());
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.empty() || binaries.front().empty()) return {};
  const std::string binary(binaries.front().begin(), binaries.front().end());
  return fmt::format("binary of {} bytes, CRC-64 {:016x}", binary.size(), checksum(binary));
}

namespace {

constexpr std::string_view white_space = " \t\r\n";

// The text between the parentheses after `kernel void NAME`; empty if there is no such kernel.
std::string_view parameters_of(std::string_view source, const std::string& name) {
  const std::string head = "kernel void " + name + "(";
  const std::size_t at = source.find(head);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = source.substr(at + head.size());
  return rest.substr(0, rest.find(')'));
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(white_space);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(white_space) + 1 - first);
}

}  // namespace

NamedKernel::Argument NamedKernel::parsed(std::string_view parameter) {
  const std::size_t end_of_type = parameter.find_last_of(" \t\r\n*") + 1;
  const std::string_view type = trimmed(parameter.substr(0, end_of_type));
  Argument argument{std::string(parameter.substr(end_of_type)), Type::other};
  if (type.ends_with('*'))
    argument.type = type.starts_with("local ") ? Type::local_space : Type::buffer;
  else if (type == "double")
    argument.type = Type::real;
  else if (type == "uint")
    argument.type = Type::count32;
  else if (type == "ulong")
    argument.type = Type::count64;
  return argument;
}

NamedKernel::NamedKernel(const cl::Program& program, std::string_view source, const std::string& name)
    : name_(name), kernel_(program, name.c_str()) {
  std::string_view rest = parameters_of(source, name);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    arguments_.push_back(parsed(trimmed(rest.substr(0, comma))));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  const auto count = kernel_.getInfo<CL_KERNEL_NUM_ARGS>();
  if (arguments_.size() != count)
    throw Error(ErrorKind::failure,
                fmt::format("kernel {} has {} arguments, its source declares {}", name_, count, arguments_.size()));
}

cl_uint NamedKernel::position(std::string_view argument, std::initializer_list<Type> types) const {
  const auto found = std::ranges::find(arguments_, argument, &Argument::name);
  if (found == arguments_.end() || std::ranges::find(types, found->type) == types.end())
    throw Error(ErrorKind::failure, fmt::format("kernel {} has no argument {} of that type", name_, argument));
  return static_cast<cl_uint>(found - arguments_.begin());
}

void NamedKernel::set(std::string_view argument, const cl::Buffer& buffer) {
  kernel_.setArg(position(argument, {Type::buffer}), buffer);
}

void NamedKernel::set(std::string_view argument, const cl::LocalSpaceArg& size) {
  kernel_.setArg(position(argument, {Type::local_space}), size);
}

void NamedKernel::set_real(std::string_view argument, double number) {
  kernel_.setArg(position(argument, {Type::real}), number);
}

void NamedKernel::set_count(std::string_view argument, std::uint64_t count) {
  const cl_uint at = position(argument, {Type::count32, Type::count64});
  if (arguments_[at].type == Type::count64)
    kernel_.setArg(at, cl_ulong{count});
  else if (count <= std::numeric_limits<cl_uint>::max())
    kernel_.setArg(at, static_cast<cl_uint>(count));
  else
    throw Error(ErrorKind::failure,
                fmt::format("kernel {}: {} is too much for its argument {}", name_, count, argument));
}

}  // namespace verisq::device

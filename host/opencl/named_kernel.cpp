/// This file implements the reading of a kernel's parameters from its source.
#include "host/opencl/named_kernel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "verisq/error.hpp"

namespace verisq::device {
namespace {

constexpr std::string_view white_space = " \t\r\n";

// What stands between the parentheses after `kernel void NAME`; empty where there is no such kernel.
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

/// Linux names the running program's file, beside which the other one is built and installed.
#include "host/command_line/surface_program.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <verisq/error.hpp>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

void declare_surface_program(Options& options, SurfaceProgramArguments& arguments) {
  options.take_all(arguments.all);
}

ExitStatus run_surface_program(const SurfaceProgramArguments& arguments) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "verisq-surface";
  std::vector<std::string> words{name_of_caller, "surface"};
  words.insert(words.end(), arguments.all.begin(), arguments.all.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  if (errno == ENOENT) {
    refuse(fmt::format("surface: {} is not there; it is built where CGAL is (Debian: libcgal-dev)", program.string()));
  }
  throw Error(ErrorKind::failure,
              fmt::format("{}: cannot start: {}", program.string(), std::generic_category().message(errno)));
}

}  // namespace verisq::command_line

/// `verisq surface` of a program built without CGAL.
#include <CLI/CLI.hpp>
#include <verisq/error.hpp>

#include "host/command_line/surface_command.hpp"

namespace verisq::command_line {

const CLI::App& declare_surface(CLI::App& program, SurfaceArguments& /*arguments*/) {
  CLI::App& surface =
      *program.add_subcommand("surface", "Closed oriented surface from points (not in this build: it needs CGAL)");
  surface.prefix_command();  // whatever follows, the answer is the same
  surface.set_help_flag();
  return surface;
}

ExitStatus run_surface(const SurfaceArguments& /*arguments*/) {
  throw Error(ErrorKind::input,
              "surface: this program was built without CGAL; install it (Debian: libcgal-dev) and build again");
}

}  // namespace verisq::command_line

/// The program `verisq-check`: `verisq check` and nothing else, so that users of a checked map need to trust no more
/// than is linked here.
#include "host/command_line/run.hpp"

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const Program program{.name = "verisq-check",
                        .description = "Prove a finished map again from its certificates, by MPFR alone"};
  return run_program(program, check_command(), argc, argv);
}

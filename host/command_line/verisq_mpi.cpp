/// The program `verisq-mpi`: commands of `verisq` for all ranks of an MPI job. A program of its own, so that no other
/// command is linked with MPI, whose library takes longer to start than a small map.
#include <array>

#include "host/command_line/run_program.hpp"
#include "host/command_line/shared_batch_command.hpp"
#include "host/command_line/shared_command.hpp"
#include "host/command_line/shared_insert_command.hpp"
#include "host/command_line/shared_map_command.hpp"

namespace {

constexpr const char* closing_words =
    "Run it by mpirun or srun:\n"
    "  mpirun -n 64 verisq-mpi map --model stem.json --points samples.npy -o distances.npy\n"
    "  mpirun -n 64 verisq-mpi insert --implant stem.json --mesh femur.ply --along 0,0,-1 --length 100 -o way.npy\n"
    "  mpirun -n 64 verisq-mpi batch cohort.csv -o cohort\n"
    "A batch shares cases of any command: fits, recoveries, whatever `verisq batch` runs.\n"
    "Exit status: that of the command of `verisq`.\n"
    "`verisq-mpi COMMAND --help` explains a command.";

}  // namespace

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const verisq::mpi::Session session(argc, argv);
  const std::array commands{
      shared_command("map", "One map, of points or triangles, whose rows all ranks share", session, declare_shared_map,
                     run_shared_map),
      shared_command("insert", "How deep an implant cuts on its way in, whose rows all ranks share", session,
                     declare_shared_insert, run_shared_insert),
      shared_command("batch", "The cases of a cohort, any command each, which all ranks share", session,
                     declare_shared_batch, run_shared_batch),
  };
  const Program program{.name = "verisq-mpi",
                        .description = "verisq-mpi: one large job, done by all ranks of an MPI job.",
                        .closing_words = closing_words};
  return run_program(program, commands, argc, argv);
}

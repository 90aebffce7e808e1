/// The two stages of the path.
#include "tests/oracle/closest_pair.hpp"

namespace verisq::oracle {

namespace {

/// What the path in double reached: the start itself where it got nowhere.
struct Reached {
  std::vector<Real> variables;
  Real mu;
};

[[nodiscard]] Reached rough_path(const DistanceProgram<double>& program, double size) {
  const double first = std::max(size, length(program.origin));
  CentralPath<double> path(program, program.start, first);
  bool centred = path.centre();
  std::vector<double> w = centred ? path.variables() : program.start;
  const double goal = 1e-8 * size;
  while (centred && path.mu() > goal && path.advance(goal)) w = path.variables();
  return {{w.begin(), w.end()}, centred ? path.mu() : first};
}

using Finished = std::function<bool(const PathPoint&)>;

/// False where the path cannot be reached from `start`.
bool exact_path(const DistanceProgram<Real>& program, const Reached& start, const Real& goal,
                const Finished& finished) {
  CentralPath<Real> path(program, start.variables, start.mu);
  if (!path.centre()) return false;
  while (!finished({path.variables(), path.outstanding()}) && path.mu() > goal && path.advance(goal)) continue;
  return true;
}

}  // namespace

void follow_path(const TwoPrograms& programs, const Real& size, const Finished& finished) {
  const Real goal = size * Real(1e-32);
  if (exact_path(programs.exact, rough_path(programs.rough, size.convert_to<double>()), goal, finished)) return;
  (void)exact_path(programs.exact, {programs.exact.start, size + length(programs.exact.origin)}, goal, finished);
}

}  // namespace verisq::oracle

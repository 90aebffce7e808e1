/// Halves cells until the checker's own look settles each.
#include "verify/sets/cover_search.hpp"

namespace verisq::verify {

std::optional<std::vector<bool>> cover_of(const EmptyNeighbourhood& neighbourhood, std::size_t most,
                                          const std::function<bool()>& interrupted) {
  std::vector<bool> bits;
  std::vector<EmptyNeighbourhood::Cell> open{neighbourhood.whole()};
  while (!open.empty()) {
    const EmptyNeighbourhood::Cell cell = open.back();
    open.pop_back();
    const bool settled = neighbourhood.is_empty(cell);
    bits.push_back(!settled);
    if (settled) continue;
    const auto halves = neighbourhood.halves(cell);
    if (bits.size() + open.size() + 2 > most || !halves || interrupted()) return std::nullopt;
    open.push_back((*halves)[1]);
    open.push_back((*halves)[0]);
  }
  return bits;
}

namespace {

std::optional<EmptyRadius> empty_at(const CoverQuestion& question, double radius, std::size_t most,
                                    const std::function<bool()>& interrupted) {
  if (!(radius > 0.0)) return std::nullopt;
  const std::vector<Normal> normals = question.telling(radius);
  const auto cover = cover_of(question.neighbourhood(radius, normals), most, interrupted);
  if (!cover) return std::nullopt;
  return EmptyRadius{radius, normals, *cover};
}

}  // namespace

std::optional<EmptyRadius> empty_radius(const CoverQuestion& question, double distance, double tolerance,
                                        const std::function<bool()>& interrupted) {
  constexpr double first_share = 0x1p-45;
  constexpr double share_of_one_cell = 1.0 / 64;
  if (auto found = empty_at(question, distance * (1.0 - first_share), 1, interrupted)) return found;
  if (auto found = empty_at(question, distance - share_of_one_cell * tolerance, 1, interrupted)) return found;
  for (double gap = 0.98 * tolerance; gap < distance; gap *= 16.0) {
    if (interrupted()) return std::nullopt;
    if (auto found = empty_at(question, distance - gap, question.most_cells, interrupted)) return found;
  }
  return std::nullopt;
}

}  // namespace verisq::verify

/// Head and neck are balls and rods as a rule, whose centres lie on the axes that count.
#include "host/features/implant_points.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace verisq::features {
namespace {

void choose(ImplantPoints& chosen, const NamedLandmark& landmark, const std::vector<NamedCentre>& centres,
            const std::string& asked, const char* usual) {
  std::optional<Point>& point = chosen.points.*landmark.point;
  if (asked.empty() && point) {
    chosen.notes.push_back(fmt::format("{}: as its file names it", landmark.name));
    return;
  }
  const auto found = std::ranges::find(centres, asked.empty() ? usual : asked, &NamedCentre::name);
  if (found == centres.end()) return;
  point = found->centre;
  chosen.notes.push_back(fmt::format("{}: the centre of its primitive \"{}\"", landmark.name, found->name));
}

}  // namespace

ImplantPoints implant_points(const FemurLandmarks& named, const std::vector<NamedCentre>& centres,
                             const HeadAndNeck& asked) {
  ImplantPoints chosen{named, {}};
  choose(chosen, named_landmarks[0], centres, asked.head, "head");
  choose(chosen, named_landmarks[1], centres, asked.neck, "neck");
  return chosen;
}

}  // namespace verisq::features

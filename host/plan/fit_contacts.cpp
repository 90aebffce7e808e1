/// Areas of the bone are areas of its vertices; a triangle belongs to the area of two of its corners.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/errors/refusal.hpp"
#include "host/plan/fit_problem.hpp"
#include "verisq/device.hpp"

namespace verisq::planning {
namespace {

constexpr std::string_view whole = "contact";
constexpr std::string_view of_area = "contact:";
constexpr std::string_view of_implant = "implant_contact";
/// The widths of a share without a requirement, and of one with a requirement; and the number of samples that it may
/// take.
constexpr double share_width = 0.005;
constexpr double asked_share_width = 0.001;
constexpr std::uint64_t most_samples = std::uint64_t{1} << 19U;
/// The number of samples of an area, for the search, about.
constexpr double samples_of_contact = 4096.0;

std::optional<std::size_t> area_named(const FitProblem& problem, std::string_view name) {
  const auto found = std::ranges::find(problem.cavity.areas, name, &Area::name);
  if (found == problem.cavity.areas.end()) return std::nullopt;
  return static_cast<std::size_t>(found - problem.cavity.areas.begin());
}

/// The area of each triangle; for three different areas the first corner's.
std::vector<std::uint32_t> area_of_triangles(const FitProblem& problem) {
  std::vector<std::uint32_t> areas;
  areas.reserve(problem.mesh.triangles.size());
  for (const auto& [a, b, c] : problem.mesh.triangles) {
    const auto& area_of = problem.cavity.area_of;
    areas.push_back(area_of[b] == area_of[c] ? area_of[b] : area_of[a]);
  }
  return areas;
}

std::vector<bool> primitives_with_a_side(const FitProblem& problem, std::size_t implant) {
  std::vector<bool> counted;
  if (problem.options.sides.empty()) return counted;
  for (const SurfaceSide side : problem.options.sides[implant]) counted.push_back(side == SurfaceSide::inside);
  if (std::ranges::find(counted, true) != counted.end()) return counted;
  for (std::size_t k = 0; k < counted.size(); ++k)
    counted[k] = problem.options.sides[implant][k] == SurfaceSide::outside;
  return std::ranges::find(counted, true) != counted.end() ? counted : std::vector<bool>();
}

bool asks_of_implant(const FitProblem& problem) {
  return problem.implant_contact ||
         std::ranges::find(problem.contacts, of_implant, &KeptFeature::name) != problem.contacts.end();
}

/// Rounded to nearest.
double area(const Point& a, const Point& b, const Point& c) {
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
  }
  return 0.5 * std::hypot(normal[0], normal[1], normal[2]);
}

/// The centres of k^2 equal parts of a triangle.
void add_parts(const Triangle& corners, double of_triangle, int k, FitContact& contact) {
  const auto add = [&](double along_b, double along_c) {
    Point point;
    for (std::size_t i = 0; i < 3; ++i) {
      const double origin = corners[0][i];
      point[i] = origin + along_b / (3 * k) * (corners[1][i] - origin) + along_c / (3 * k) * (corners[2][i] - origin);
    }
    contact.points.push_back(point);
    contact.weights.push_back(of_triangle / (k * k));
  };
  for (int i = 0; i < k; ++i) {
    for (int j = 0; i + j < k; ++j) {
      add(3 * i + 1, 3 * j + 1);
      if (i + j + 1 < k) add(3 * i + 2, 3 * j + 2);
    }
  }
}

/// Samples about evenly over the triangles of one area, or of all; none if there are no triangles.
void sample(const FitProblem& problem, const std::optional<std::size_t>& of, FitContact& contact) {
  const std::vector<std::uint32_t> area_of = area_of_triangles(problem);
  std::vector<std::pair<Triangle, double>> triangles;
  double total = 0.0;
  for (std::size_t n = 0; n < area_of.size(); ++n) {
    if (of && area_of[n] != *of) continue;
    const auto& [a, b, c] = problem.mesh.triangles[n];
    const Triangle corners{problem.mesh.vertices[a], problem.mesh.vertices[b], problem.mesh.vertices[c]};
    triangles.emplace_back(corners, area(corners[0], corners[1], corners[2]));
    total += triangles.back().second;
  }
  for (const auto& [corners, of_triangle] : triangles) {
    const double parts = samples_of_contact * of_triangle / total;
    add_parts(corners, of_triangle, std::max(1, static_cast<int>(std::ceil(std::sqrt(parts)))), contact);
  }
}

}  // namespace

std::vector<FitContact> contacts_of(const FitProblem& problem) {
  std::vector<FitContact> contacts;
  for (const KeptFeature& kept : problem.contacts) {
    if (kept.name == of_implant) continue;
    std::optional<std::size_t> of;
    if (kept.name != whole) of = area_named(problem, std::string_view(kept.name).substr(of_area.size()));
    FitContact contact{.name = kept.name,
                       .points = {},
                       .weights = {},
                       .distance = contact_distance(problem),
                       .share = {kept.range.lo / 100.0, kept.range.hi / 100.0}};
    sample(problem, of, contact);
    if (!contact.points.empty()) contacts.push_back(std::move(contact));
  }
  return contacts;
}

bool is_contact(std::string_view name) {
  return name == whole || name == of_implant || name.starts_with(of_area);
}

bool is_contact_of_implant(std::string_view name) {
  return name == of_implant;
}

void check_contacts(const FitProblem& problem) {
  if (problem.implant_contact && problem.mesh.triangles.empty())
    refuse("`implant_contact`: needs a mesh with triangles");
  for (const KeptFeature& kept : problem.contacts) {
    if (problem.mesh.triangles.empty()) refuse(fmt::format("`keep` {}: needs a mesh with triangles", kept.name));
    if (!kept.name.starts_with(of_area)) continue;
    const std::string name = kept.name.substr(of_area.size());
    if (area_named(problem, name)) continue;
    std::vector<std::string> known;
    for (const Area& area : problem.cavity.areas) known.push_back(area.name);
    refuse(fmt::format("`keep` {}: no area has the name {}; known are {}", on_one_line(kept.name), quotation(name),
                       quotation(known)));
  }
}

double contact_distance(const FitProblem& problem) {
  return problem.options.fitness.serves.hi;
}

std::optional<Enclosure> share_named(const FitProblem& problem, const ContactAreas& contact, std::string_view name) {
  if (name == whole) return contact.of_mesh.share;
  if (name == of_implant) return contact.of_model ? std::optional(contact.of_model->share) : std::nullopt;
  const std::optional<std::size_t> area = area_named(problem, name.substr(of_area.size()));
  return area ? std::optional(contact.by_region[*area].share) : std::nullopt;
}

ContactAreaOptions contact_options(const FitProblem& problem, std::size_t implant,
                                   const std::function<bool()>& interrupted) {
  return {.distance = contact_distance(problem),
          .share_width = problem.contacts.empty() ? share_width : asked_share_width,
          .region_of = area_of_triangles(problem),
          .regions = static_cast<std::uint32_t>(problem.cavity.areas.size()),
          .of_model = asks_of_implant(problem),
          .counted = primitives_with_a_side(problem, implant),
          .most_samples = most_samples,
          .device = problem.options.device,
          .interrupted = interrupted};
}

std::optional<ContactAreas> proven_contact(const FitProblem& problem, std::size_t implant, const Model& posed,
                                           const MapOptions& options) {
  if (problem.mesh.triangles.empty()) return std::nullopt;
  return contact_areas(posed, problem.mesh,
                       contact_options(problem, implant, either(options.interrupted, options.out_of_time)));
}

}  // namespace verisq::planning

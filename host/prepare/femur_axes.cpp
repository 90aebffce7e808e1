/// The axes of a femur, and its landmarks and features, enclosed.
#include "host/prepare/femur_axes.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/errors/refusal.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/prepare/femur.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/proof/closed_surface.hpp"

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
  chosen.notes.push_back(fmt::format("{}: the centre of its primitive {}", landmark.name, quotation(found->name)));
}

}  // namespace

ImplantPoints implant_points(const FemurLandmarks& named, const std::vector<NamedCentre>& centres,
                             const HeadAndNeck& asked) {
  ImplantPoints chosen{named, {}};
  choose(chosen, named_landmarks[0], centres, asked.head, "head");
  choose(chosen, named_landmarks[1], centres, asked.neck, "neck");
  return chosen;
}

namespace {

using Eigen::Vector3d;

constexpr double rod_radius = 1.0;  // mm

struct Line {
  const char* name;
  std::optional<Point> FemurLandmarks::*from;
  std::optional<Point> FemurLandmarks::*to;
  double beyond;  // mm at both ends
};

constexpr std::array lines{
    Line{"neck axis", &FemurLandmarks::neck_centre, &FemurLandmarks::head_centre, 45.0},
    Line{"shaft axis", &FemurLandmarks::shaft_distal, &FemurLandmarks::shaft_proximal, 60.0},
    Line{"posterior condylar line", &FemurLandmarks::lateral_posterior_condyle,
         &FemurLandmarks::medial_posterior_condyle, 25.0},
    Line{"transepicondylar line", &FemurLandmarks::lateral_epicondyle, &FemurLandmarks::medial_epicondyle, 15.0},
};

Primitive rod(const char* name, const Vector3d& from, const Vector3d& to, double beyond) {
  const Vector3d middle = 0.5 * (from + to);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from);
  return {name,
          {{rod_radius, rod_radius, 0.5 * (to - from).norm() + beyond}, {0.1, 1.0}},
          {point_of(middle), {turn.w(), turn.x(), turn.y(), turn.z()}}};
}

}  // namespace

Model drawn_axes(const FemurLandmarks& landmarks) {
  Model model{"mm", {}, {}};
  if (landmarks.head_centre && landmarks.head_radius) {
    const double r = *landmarks.head_radius;
    model.primitives.push_back({drawn_head, {{r, r, r}, {1.0, 1.0}}, {*landmarks.head_centre}});
  }
  for (const auto& [name, from, to, beyond] : lines) {
    const std::optional<Point>& start = landmarks.*from;
    const std::optional<Point>& end = landmarks.*to;
    if (start && end && *start != *end)
      model.primitives.push_back(rod(name, vector_of(*start), vector_of(*end), beyond));
  }
  return model;
}

namespace {

using Eigen::Vector3d;

constexpr double head_share = 1.15;  // of its radius: its rim, where the neck begins
constexpr double neck_share = 0.9;

Vector3d centroid(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return (vector_of(mesh.vertices[triangle[0]]) + vector_of(mesh.vertices[triangle[1]]) +
          vector_of(mesh.vertices[triangle[2]])) /
         3.0;
}

}  // namespace

Regions femur_regions(const Mesh& mesh, const FemurLandmarks& landmarks) {
  const auto& [head_centre, head_radius, neck_centre, proximal, distal, a, b, c, d] = landmarks;
  if (!head_centre || !head_radius || !neck_centre || !proximal || !distal)
    throw Error(ErrorKind::input,
                "landmarks: regions need head_centre, head_radius, neck_centre and both of the shaft");
  const Vector3d head = vector_of(*head_centre);
  const Vector3d neck = (vector_of(*neck_centre) - head).normalized();  // towards the shaft
  const Vector3d low = vector_of(*distal);
  const Vector3d up = (vector_of(*proximal) - low).normalized();
  const double top = up.dot(vector_of(*proximal) - low);
  // The neck ends where its axis passes the shaft's.
  const Vector3d medial = (head - low) - up.dot(head - low) * up;
  const double towards_shaft = -neck.dot(medial.normalized());
  const double neck_length = towards_shaft > 0.0 ? medial.norm() / towards_shaft - *head_radius : 0.0;
  enum Region : std::uint32_t { of_head, of_neck, of_trochanters, of_shaft, of_condyles };
  Regions regions{{"head", "neck", "trochanters", "shaft", a ? "condyles" : "below the shaft"}, {}};
  for (const auto& triangle : mesh.triangles) {
    const Vector3d x = centroid(mesh, triangle);
    const double along_neck = neck.dot(x - head);
    const double from_neck = ((x - head) - along_neck * neck).norm();
    const double height = up.dot(x - low);
    Region region = of_trochanters;
    if ((x - head).norm() <= head_share * *head_radius) {
      region = of_head;
    } else if (height < 0.0) {
      region = of_condyles;
    } else if (height <= top) {
      region = of_shaft;
    } else if (along_neck > 0.0 && along_neck < neck_length && from_neck <= neck_share * *head_radius) {
      region = of_neck;
    }
    regions.of_triangles.push_back(region);
  }
  return regions;
}

Regions parts_along(const Mesh& mesh, std::uint32_t count) {
  std::vector<Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), vector_of);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(surface_moments(vertices, mesh).covariance());
  Vector3d axis = solver.eigenvectors().col(2);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;
  double lowest = infinity;
  double highest = -infinity;
  for (const Vector3d& x : vertices) {
    lowest = std::min(lowest, axis.dot(x));
    highest = std::max(highest, axis.dot(x));
  }
  const double step = (highest - lowest) / count;
  Regions regions;
  for (std::uint32_t i = 0; i < count; ++i)
    regions.names.push_back(fmt::format("{:.5g} to {:.5g}", i * step, (i + 1) * step));
  for (const auto& triangle : mesh.triangles) {
    const double place = (axis.dot(centroid(mesh, triangle)) - lowest) / step;
    regions.of_triangles.push_back(std::min(count - 1, static_cast<std::uint32_t>(std::max(0.0, place))));
  }
  return regions;
}

}  // namespace verisq::features

namespace verisq {
namespace {

using Eigen::Vector3d;

double area_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vector3d a = vector_of(mesh.vertices[triangle[0]]);
  return 0.5 * (vector_of(mesh.vertices[triangle[1]]) - a).cross(vector_of(mesh.vertices[triangle[2]]) - a).norm();
}

struct Box {
  Vector3d lowest = Vector3d::Constant(infinity);
  Vector3d highest = Vector3d::Constant(-infinity);

  void add(const Vector3d& x) {
    lowest = lowest.cwiseMin(x);
    highest = highest.cwiseMax(x);
  }
  [[nodiscard]] bool contains(const Box& other) const {
    return (lowest.array() <= other.lowest.array()).all() && (highest.array() >= other.highest.array()).all();
  }
  [[nodiscard]] double size() const { return (highest - lowest).norm(); }
};

Box box_of(const Mesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t i : triangle) box.add(vector_of(mesh.vertices[i]));
  }
  return box;
}

/// The largest of the mesh's connected parts, outward. Small crumbs and inner parts, such as a canal, are left out; a
/// second bone is refused.
Mesh one_bone(const Mesh& mesh) {
  const std::vector<std::uint32_t> part = verify::connected_parts(mesh);
  std::vector<double> area(mesh.vertices.size(), 0.0);
  std::vector<Box> boxes(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    area[part[triangle[0]]] += area_of(mesh, triangle);
    for (const std::uint32_t i : triangle) boxes[part[i]].add(vector_of(mesh.vertices[i]));
  }
  const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(area) - area.begin());
  constexpr double crumb = 0.25;  // of the bone's size
  for (std::uint32_t i = 0; i < area.size(); ++i) {
    if (i == largest || area[i] == 0.0 || boxes[largest].contains(boxes[i])) continue;
    if (boxes[i].size() > crumb * boxes[largest].size()) refuse("mesh: holds several bones; give one of them");
  }
  Mesh bone{mesh.vertices, {}};
  for (const auto& triangle : mesh.triangles) {
    if (part[triangle[0]] == largest) bone.triangles.push_back(triangle);
  }
  if (volume_sign(bone) < 0) {
    for (auto& triangle : bone.triangles) std::swap(triangle[1], triangle[2]);
  }
  // Vertices of the other parts lie on no section, but in the extent.
  std::vector<std::uint32_t> place(mesh.vertices.size(), 0);
  Mesh result;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    if (part[i] != largest) continue;
    place[i] = static_cast<std::uint32_t>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[i]);
  }
  for (const auto& [a, b, c] : bone.triangles) result.triangles.push_back({place[a], place[b], place[c]});
  return result;
}

/// The direction in which the surface spreads most, of length 1; refuses a surface without one.
Vector3d long_axis(const Mesh& mesh) {
  std::vector<Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), vector_of);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(surface_moments(vertices, mesh).covariance());
  constexpr double least_ratio = 1.5;  // of the spreads along the two longest axes
  if (!(solver.eigenvalues()[2] > least_ratio * least_ratio * solver.eigenvalues()[1]))
    refuse("mesh: has no long axis: it is no femur with a shaft");
  return solver.eigenvectors().col(2);
}

/// Towards the end that the head is nearer to.
Vector3d towards_head(const Mesh& mesh, const Vector3d& axis, const Vector3d& head) {
  double lowest = infinity;
  double highest = -infinity;
  for (const Point& x : mesh.vertices) {
    lowest = std::min(lowest, axis.dot(vector_of(x)));
    highest = std::max(highest, axis.dot(vector_of(x)));
  }
  return axis.dot(head) < 0.5 * (lowest + highest) ? Vector3d(-axis) : axis;
}

void check_size(const Mesh& mesh) {
  constexpr std::size_t fewest_triangles = 100;
  if (mesh.triangles.empty()) refuse("mesh: has no triangles: features are those of a surface");
  if (mesh.triangles.size() < fewest_triangles)
    refuse(fmt::format("mesh: {} triangles are too few for a femur", mesh.triangles.size()));
  const double size = box_of(mesh).size();
  constexpr double shortest = 60.0;
  constexpr double longest = 900.0;
  if (size < shortest || size > longest) {
    refuse(
        fmt::format("mesh: spans {:.3g}: no femur in millimetres ({} to {}); scale the mesh", size, shortest, longest));
  }
}

features::HeadSphere head_of(const Mesh& bone) {
  const auto head = features::head_sphere(bone);
  if (!head || head->coverage < features::least_head_coverage) {
    refuse(
        fmt::format("mesh: no head was found: no sphere of a radius of {} to {} mm is covered to {:.0f} % (at most "
                    "{:.0f} %); give landmarks",
                    features::smallest_head, features::largest_head, 100.0 * features::least_head_coverage,
                    head ? 100.0 * head->coverage : 0.0));
  }
  return *head;
}

/// Bones cut below the lesser trochanter have a longer shaft than that; stems have none.
void check_shaft(const features::ShaftAxis& shaft, const features::HeadSphere& head) {
  const double length = shaft.proximal - shaft.distal;
  if (length >= 2.0 * head.radius) return;
  refuse(
      fmt::format("mesh: its shaft is {:.0f} mm long, less than its head is wide ({:.0f} mm): no femur; give landmarks",
                  length, 2.0 * head.radius));
}

/// The part of v across the direction, of length 1.
Vector3d across(const Vector3d& v, const Vector3d& direction) {
  return (v - direction.dot(v) * direction).normalized();
}

/// The direction from the head along a neck of usual inclination.
Vector3d usual_neck(const features::ShaftAxis& shaft, const Vector3d& lateral) {
  constexpr double usual_ccd = 2.18;  // 125 degrees
  return (std::cos(usual_ccd) * shaft.direction + std::sin(usual_ccd) * lateral).normalized();
}

/// Seen from above, ahead is a quarter turn from the medial direction: to the left of the left femur's.
Vector3d ahead(const features::ShaftAxis& shaft, const Vector3d& medial, Side side) {
  return shaft.direction.cross(medial) * (side == Side::left ? 1.0 : -1.0);
}

void add_condyles(const Mesh& bone, const features::ShaftAxis& shaft, const Vector3d& medial, DetectedFemur& found) {
  const std::vector<Vector3d> distal = features::distal_end(bone, shaft);
  if (distal.empty()) {
    found.notes.emplace_back("condyles: none, the mesh ends with the shaft: no version, no length, no frame");
    return;
  }
  const bool is_left = features::excess(distal, shaft, ahead(shaft, medial, Side::right)) > 0.0;
  const Side seen = is_left ? Side::left : Side::right;
  const char* const name = is_left ? "left" : "right";
  if (found.side && *found.side != seen)
    refuse(
        fmt::format("mesh: looks like a {} femur: its condyles reach farther to that side's back; give `side` {}, or "
                    "landmarks",
                    name, name));
  found.side = seen;
  const features::Condyles condyles = features::condyles(distal, shaft, medial, -ahead(shaft, medial, seen));
  found.landmarks.medial_posterior_condyle = point_of(condyles.medial_posterior);
  found.landmarks.lateral_posterior_condyle = point_of(condyles.lateral_posterior);
  found.landmarks.medial_epicondyle = point_of(condyles.medial_epicondyle);
  found.landmarks.lateral_epicondyle = point_of(condyles.lateral_epicondyle);
  found.notes.push_back(fmt::format("side: {}, as its condyles reach farther back than ahead", name));
  found.notes.emplace_back("condyles: the points it lies on, seen along the shaft; the most prominent to each side");
}

}  // namespace

DetectedFemur detect_femur(const Mesh& mesh, std::optional<Side> side) {
  check_size(mesh);
  const Mesh bone = one_bone(mesh);
  const Vector3d axis = long_axis(bone);
  const features::HeadSphere head = head_of(bone);
  const auto shaft = features::shaft_axis(bone, head.centre, head.radius, towards_head(bone, axis, head.centre));
  if (!shaft) refuse("mesh: no shaft was found below the head; give landmarks");
  check_shaft(*shaft, head);
  const Vector3d medial = across(head.centre - shaft->point, shaft->direction);
  const auto neck = features::neck_section(bone, head.centre, head.radius, usual_neck(*shaft, -medial));
  if (!neck) refuse("mesh: no neck was found between head and shaft; give landmarks");
  features::check_head_and_neck(head, *neck);

  DetectedFemur found{.landmarks = {}, .side = side, .notes = {}};
  found.landmarks.head_centre = point_of(head.centre);
  found.landmarks.head_radius = head.radius;
  found.landmarks.neck_centre = point_of(neck->centre);
  found.landmarks.shaft_distal = point_of(shaft->point + shaft->distal * shaft->direction);
  found.landmarks.shaft_proximal = point_of(shaft->point + shaft->proximal * shaft->direction);
  found.notes.push_back(fmt::format("head: sphere of least squares, {:.0f} % of it covered", 100.0 * head.coverage));
  found.notes.push_back(fmt::format("neck: section of least perimeter ({:.1f} mm), {:.1f} mm from the head's centre",
                                    neck->perimeter, neck->distance));
  found.notes.push_back(
      fmt::format("shaft: line through the centroids of sections over {:.0f} mm", shaft->proximal - shaft->distal));
  add_condyles(bone, *shaft, medial, found);
  features::check_proportions(found.landmarks, found.side);
  return found;
}

}  // namespace verisq

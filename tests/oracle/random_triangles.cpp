/// The constructions of the random triangles, in the solid's own frame.
#include "tests/oracle/random_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

namespace {

[[nodiscard]] Point moved(const Point& x, const Point& direction, double distance) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}

/// A point and an orthonormal frame at it.
struct Site {
  Point point;
  Point normal;
  Point tangent;
  Point binormal;

  /// Turned from the first tangent by `angle`.
  [[nodiscard]] Point across(double angle) const {
    return moved(scaled(tangent, std::cos(angle)), binormal, std::sin(angle));
  }
};

class Construction {
 public:
  Construction(RandomCases& random, const Superquadric& superquadric)
      : random_(random),
        superquadric_(superquadric),
        size_(*std::max_element(superquadric.semi_axes.begin(), superquadric.semi_axes.end())) {}

  [[nodiscard]] Triangle operator()(TriangleFamily family) {
    const double usual_gap = size_ * random_.log_uniform(1e-9, 3);
    const double usual_extent = size_ * random_.log_uniform(1e-3, 10);
    switch (family) {
      case TriangleFamily::face: return face(site(usual_gap), usual_extent);
      case TriangleFamily::edge: return edge(site(usual_gap), usual_extent);
      case TriangleFamily::vertex: return vertex(site(usual_gap), usual_extent);
      case TriangleFamily::needle: return needle(site(usual_gap), usual_extent);
      case TriangleFamily::large: return face(site(usual_gap), size_ * random_.log_uniform(10, 1e4));
      case TriangleFamily::small: return contact(site(usual_gap), size_ * random_.log_uniform(1e-9, 1e-3));
      case TriangleFamily::touching: return contact(site(size_ * 1e-15 * random_.uniform(-1, 1)), usual_extent);
      case TriangleFamily::penetrating: return contact(site(-size_ * random_.log_uniform(1e-9, 1)), usual_extent);
      case TriangleFamily::far: return contact(site(size_ * random_.log_uniform(10, 1e4)), usual_extent);
      case TriangleFamily::aligned: return aligned();
      case TriangleFamily::anywhere: break;
    }
    return {anywhere(), anywhere(), anywhere()};
  }

 private:
  [[nodiscard]] Site site(double gap) {
    const BoundaryPoint contact = random_.boundary_point(superquadric_);
    const Point n = contact.normal;
    const Point other = random_.direction();
    Point tangent = moved(other, n, -dot(other, n));
    tangent = scaled(tangent, 1 / length(tangent));
    const Point binormal{n[1] * tangent[2] - n[2] * tangent[1], n[2] * tangent[0] - n[0] * tangent[2],
                         n[0] * tangent[1] - n[1] * tangent[0]};
    return {moved(contact.point, n, gap), n, tangent, binormal};
  }

  [[nodiscard]] Triangle contact(const Site& site, double extent) {
    switch (random_.choice(3)) {
      case 0: return face(site, extent);
      case 1: return edge(site, extent);
      default: return vertex(site, extent);
    }
  }

  [[nodiscard]] Triangle face(const Site& site, double extent) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi / 3 * (static_cast<double>(k) + random_.uniform(-0.2, 0.2));
      corners[k] = moved(site.point, site.across(angle), extent * random_.uniform(0.1, 1));
    }
    return corners;
  }

  /// Up to 90 degrees away from the normal: farther out than the site.
  [[nodiscard]] Point outward(const Site& site, double turn, double extent) {
    const double angle = random_.uniform(0, std::numbers::pi / 2);
    const Point direction = moved(scaled(site.normal, std::cos(angle)), site.across(turn), std::sin(angle));
    return moved(site.point, direction, extent * random_.uniform(0.1, 1));
  }

  [[nodiscard]] Triangle edge(const Site& site, double extent) {
    return {moved(site.point, site.tangent, extent * random_.uniform(0.01, 1)),
            moved(site.point, site.tangent, -extent * random_.uniform(0.01, 1)),
            outward(site, std::numbers::pi / 2, extent)};
  }

  [[nodiscard]] Triangle vertex(const Site& site, double extent) {
    const double turn = random_.uniform(0, 2 * std::numbers::pi);
    return {site.point, outward(site, turn, extent), outward(site, turn + random_.uniform(-3, 3), extent)};
  }

  [[nodiscard]] Triangle needle(const Site& site, double extent) {
    Triangle corners = edge(site, extent);
    switch (random_.choice(3)) {
      case 0: corners[2] = corners[random_.choice(2)]; break;
      case 1: corners[2] = moved(corners[0], site.tangent, -extent * random_.uniform(-1, 1)); break;
      default: corners[2] = moved(corners[0], random_.direction(), extent * random_.log_uniform(1e-16, 1e-6)); break;
    }
    return corners;
  }

  [[nodiscard]] Triangle aligned() {
    const std::size_t axis = random_.choice(3);
    const double height = random_.choice(4) == 0 ? superquadric_.semi_axes[axis]
                                                 : superquadric_.semi_axes[axis] * (1 + random_.log_uniform(1e-9, 3));
    Triangle corners{anywhere(), anywhere(), anywhere()};
    for (Point& corner : corners) corner[axis] = height;
    return corners;
  }

  [[nodiscard]] Point anywhere() {
    Point point;
    for (double& coordinate : point) coordinate = 3 * size_ * random_.uniform(-1, 1);
    return point;
  }

  RandomCases& random_;
  const Superquadric& superquadric_;
  double size_;
};

}  // namespace

std::string_view to_string(TriangleFamily family) {
  switch (family) {
    case TriangleFamily::face: return "face";
    case TriangleFamily::edge: return "edge";
    case TriangleFamily::vertex: return "vertex";
    case TriangleFamily::needle: return "needle";
    case TriangleFamily::large: return "large";
    case TriangleFamily::small: return "small";
    case TriangleFamily::touching: return "touching";
    case TriangleFamily::penetrating: return "penetrating";
    case TriangleFamily::far: return "far";
    case TriangleFamily::aligned: return "aligned";
    case TriangleFamily::anywhere: break;
  }
  return "anywhere";
}

RandomTriangle random_triangle(RandomCases& random, const Primitive& solid) {
  const TriangleFamily family = triangle_families[random.choice(triangle_families.size())];
  Triangle triangle = Construction(random, solid.superquadric)(family);
  std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(random.choice(3)), triangle.end());
  const PosedSolid posed(solid.superquadric, solid.pose);
  for (Point& corner : triangle) corner = rounded(posed.from_own_frame(widened(corner)));
  return {triangle, family};
}

}  // namespace verisq::oracle

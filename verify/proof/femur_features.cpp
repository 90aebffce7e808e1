/// A femur's features, enclosed, and their check.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/model.hpp>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

// Balls in which landmarks lie, and the cones of the directions between them.

// T is the type of the ends: double or Real.

/// The exact point. Precondition: finite.
template <class T>
Vector3<T> exact(const Point& x) {
  return {T(x[0]), T(x[1]), T(x[2])};
}

/// All points within `radius` of a centre.
template <class T>
struct LandmarkBall {
  Vector3<T> centre;
  BasicInterval<T> radius;
};

/// The middle of the segments between the points of two balls.
template <class T>
LandmarkBall<T> middle_of(const LandmarkBall<T>& a, const LandmarkBall<T>& b) {
  const BasicInterval<T> half(T(0.5));
  return {(a.centre + b.centre) * half, (a.radius + b.radius) * half};
}

/// All vectors within `reach` of a centre: the differences of the points of two balls.
template <class T>
struct VectorBall {
  Vector3<T> centre;
  BasicInterval<T> reach;
};

template <class T>
VectorBall<T> difference(const LandmarkBall<T>& to, const LandmarkBall<T>& from) {
  return {to.centre - from.centre, to.radius + from.radius};
}

/// asin of the part of x in [0, 1], pi / 2 beyond 1; the angle whose sine is at most x.
template <class T>
BasicInterval<T> arcsine(const BasicInterval<T>& x) {
  const BasicInterval<T> one(1);
  if (x.upper() >= T(1)) return pi<T>() / BasicInterval<T>(2);
  return atan(x / sqrt((one - x) * (one + x)));
}

/// In radians: no vector of the ball tilts farther from the direction of its centre, and some vectors tilt as far. If
/// the ball contains 0, nothing below pi is proven.
template <class T>
BasicInterval<T> tilt(const VectorBall<T>& v) {
  const BasicInterval<T> size = length(v.centre);
  if (v.reach.upper() >= size.lower()) return pi<T>();
  return arcsine(v.reach / size);
}

/// The angle between two vectors, in [0, pi].
template <class T>
BasicInterval<T> angle_between(const Vector3<T>& a, const Vector3<T>& b) {
  return polar_angle(a.dot(b), length(cross(a, b)));
}

}  // namespace
}  // namespace verisq::verify

namespace verisq {
namespace {

constexpr const char* neck_axis =
    "neck axis: from the centre of the narrowest section of the neck to the head's centre";

double rounded(double x, verify::Direction /*direction*/) {
  return x;
}

double rounded(const verify::Real& x, verify::Direction direction) {
  return x.to_double(direction);
}

template <class T>
Enclosure enclosure(const verify::BasicInterval<T>& x) {
  return {rounded(x.lower(), verify::Direction::down), rounded(x.upper(), verify::Direction::up)};
}

/// Adds the feature, or why it is missing.
class Findings {
 public:
  template <class Interval>
  void add(const char* name, const std::string& method, FeatureUnit unit, const std::optional<Interval>& value,
           const char* wanted) {
    if (value) {
      found_.features.push_back({name, method, unit, enclosure(*value)});
    } else {
      const std::string sentence = fmt::format("{}: needs {}", name, wanted);
      if (std::ranges::find(found_.missing, sentence) == found_.missing.end()) found_.missing.push_back(sentence);
    }
  }
  template <class Interval>
  void length(const char* name, const std::string& method, const std::optional<Interval>& value, const char* wanted) {
    add(name, method, FeatureUnit::length, value, wanted);
  }
  template <class Interval>
  void degrees(const char* name, const std::string& method, const std::optional<Interval>& value, const char* wanted) {
    add(name, method, FeatureUnit::degrees, value, wanted);
  }

  FemurFeatures take() { return std::move(found_); }
  void set(const FemurFrame& frame) { found_.frame = frame; }
  void miss(const std::string& what) { found_.missing.push_back(what); }

 private:
  FemurFeatures found_;
};

/// The geometry, with ends of the type T: double or Real.
template <class T>
struct FemurGeometry {
  using Interval = verify::BasicInterval<T>;
  using IntervalVector3 = verify::Vector3<T>;
  using LandmarkBall = verify::LandmarkBall<T>;
  using VectorBall = verify::VectorBall<T>;

  static Interval in_degrees(const Interval& radians) { return radians * (Interval(T(180.0)) / verify::pi<T>()); }

  static Interval least_and_most(const Interval& x, const T& least, const T& most) {
    return {std::clamp(x.lower(), least, most), std::clamp(x.upper(), least, most)};
  }

  static Interval within(const Interval& centre, const Interval& reach) {
    return {(centre - reach).lower(), (centre + reach).upper()};
  }

  /// A straight line through the points of two balls, and how far it tilts.
  struct Axis {
    LandmarkBall from;
    LandmarkBall to;
    VectorBall direction;
    Interval tilt;

    Axis(const LandmarkBall& start, const LandmarkBall& end)
        : from(start), to(end), direction(difference(end, start)), tilt(verify::tilt(direction)) {}

    /// Returns whether its direction is known at all: to less than a quarter of a turn.
    [[nodiscard]] bool known() const { return tilt.upper() < T(1.57); }
  };

  /// The angle between two axes, in space: each tilts it at most by its own tilt, by the triangle inequality on the
  /// sphere, with equality where both tilt in their common plane.
  static Interval angle(const Axis& a, const Axis& b, bool b_reversed) {
    const IntervalVector3 other = b_reversed ? -b.direction.centre : b.direction.centre;
    const Interval middle = verify::angle_between(a.direction.centre, other);
    return least_and_most(in_degrees(within(middle, a.tilt + b.tilt)), T(0), T(180));
  }

  /// The largest change of the azimuth of v about the axis. Let R turn the tilted axis back by t <= tilt, about a line
  /// across it. Then the projection across the axis moves by at most the ball's reach, and by R at most by |v_along|
  /// sin t + |v_across| (1 - cos t).
  static Interval azimuth_change(const VectorBall& v, const Axis& about) {
    const IntervalVector3& s = about.direction.centre;
    const Interval size = verify::length(s);
    const Interval along = abs(v.centre.dot(s)) / size;
    const Interval across = verify::length(verify::cross(v.centre, s)) / size;
    const Interval moved = v.reach + along * sin(about.tilt) + across * (Interval(T(1.0)) - cos(about.tilt));
    if (!(moved.upper() < across.lower())) return verify::pi<T>();
    return verify::arcsine(moved / across);
  }

  /// The angle from `first` to `second` about the axis, in (-180, 180] degrees; nothing if it may be any angle.
  static std::optional<Interval> azimuth(const VectorBall& first, const VectorBall& second, const Axis& about) {
    const IntervalVector3& s = about.direction.centre;
    const IntervalVector3 a = verify::cross(first.centre, s);
    const IntervalVector3 b = verify::cross(second.centre, s);
    const Interval sine = verify::length(s) * s.dot(verify::cross(first.centre, second.centre));
    const Interval change = azimuth_change(first, about) + azimuth_change(second, about);
    const Interval found = in_degrees(within(verify::polar_angle(a.dot(b), sine), change));
    if (found.lower() <= T(-180) || found.upper() > T(180)) return std::nullopt;
    return found;
  }

  /// The foot of a point on an axis through D and P, as t in D + t (P - D).
  struct Foot {
    Interval at;        ///< of the centres' axis and point
    Interval wherever;  ///< of any line and point of the balls
  };

  static Foot foot(const LandmarkBall& point, const Axis& axis) {
    const VectorBall to_point = difference(point, axis.from);
    const IntervalVector3& s = axis.direction.centre;
    const Interval size = verify::length(s);
    const Interval product = to_point.centre.dot(s);
    const Interval product_reach = verify::length(to_point.centre) * axis.direction.reach + size * to_point.reach +
                                   to_point.reach * axis.direction.reach;
    return {product / square(size), within(product, product_reach) / square(within(size, axis.direction.reach))};
  }

  /// The distance of the centres' axis and point.
  static Interval middle_distance(const LandmarkBall& point, const Axis& axis) {
    const IntervalVector3& s = axis.direction.centre;
    return verify::length(verify::cross(difference(point, axis.from).centre, s)) / verify::length(s);
  }

  /// The distance of a point from an axis through D and P. Let t be the place of its foot, D + t (P - D). Any line of
  /// the balls lies within r_D |1 - t| + r_P |t| of this one at t: that and the point's own radius bound the rise. With
  /// the roles exchanged, and t on the other line, the same numbers bound the fall.
  static Interval distance(const LandmarkBall& point, const Axis& axis) {
    const auto shift = [&](const Interval& t) {
      return point.radius + axis.from.radius * abs(Interval(T(1.0)) - t) + axis.to.radius * abs(t);
    };
    const Foot at = foot(point, axis);
    const Interval middle = middle_distance(point, axis);
    return {std::max(T(0.0), (middle - shift(at.wherever)).lower()), (middle + shift(at.at)).upper()};
  }

  /// The largest turn, over the balls, of the direction e from the axis to the point, across the axis. Seen from P it
  /// is the direction of the projection of v = point - P across the axis. The projection is off by no more than v is,
  /// plus |v| sin(tilt), since projections across two directions differ by the sine of their angle.
  static Interval turn_of_perpendicular(const LandmarkBall& point, const Axis& axis) {
    const VectorBall v = difference(point, axis.to);
    const Interval off = v.reach + verify::length(v.centre) * sin(axis.tilt);
    const Interval across = middle_distance(point, axis);
    if (!(off.upper() < across.lower())) return verify::pi<T>();
    return verify::arcsine(off / across);
  }

  /// The perpendicular of the centres, of any length but 0.
  static IntervalVector3 perpendicular(const LandmarkBall& point, const Axis& axis) {
    const IntervalVector3& s = axis.direction.centre;
    return verify::cross(s, verify::cross(difference(point, axis.to).centre, s));
  }

  /// The distance of one point from an axis minus the distance of another. They share the axis: the derivatives, -(1 -
  /// t) e in D and -t e in P, nearly cancel. By the mean value theorem the difference is off the centres' difference by
  /// no more than r_D |(1 - t) e - (1 - t') e'| + r_P |t e - t' e'| + r + r'. Each term is bounded over all lines of
  /// the balls, with |t e - t' e'| <= |t - t'| + |t'| |e - e'|.
  static Interval difference_of_distances(const LandmarkBall& point, const LandmarkBall& other, const Axis& axis) {
    const Interval apart = distance(point, axis) - distance(other, axis);
    const Interval turns = turn_of_perpendicular(point, axis) + turn_of_perpendicular(other, axis);
    if (!(turns.upper() < T(1.5))) return apart;
    const Interval angle = verify::angle_between(perpendicular(point, axis), perpendicular(other, axis)) + turns;
    const Interval chord(std::min(T(2.0), angle.upper()));  // |e - e'| is at most their angle
    const Interval t = foot(point, axis).wherever;
    const Interval t_other = foot(other, axis).wherever;
    const Interval feet = abs(t - t_other);
    const Interval of_axis = axis.from.radius * (feet + abs(Interval(T(1.0)) - t_other) * chord) +
                             axis.to.radius * (feet + abs(t_other) * chord);
    const Interval by_derivatives =
        within(middle_distance(point, axis) - middle_distance(other, axis), of_axis + point.radius + other.radius);
    return {std::max(apart.lower(), by_derivatives.lower()), std::min(apart.upper(), by_derivatives.upper())};
  }

  static Interval distance(const LandmarkBall& a, const LandmarkBall& b) {
    const VectorBall apart = difference(a, b);
    const Interval found = within(verify::length(apart.centre), apart.reach);
    return {std::max(T(0.0), found.lower()), found.upper()};
  }

  /// How far v reaches along the axis. If the axis tilts by t, this changes by at most |v_across| sin t + |v_along| (1
  /// - cos t).
  static Interval extent(const VectorBall& v, const Axis& axis) {
    const IntervalVector3& s = axis.direction.centre;
    const Interval size = verify::length(s);
    const Interval along = v.centre.dot(s) / size;
    const Interval across = verify::length(verify::cross(v.centre, s)) / size;
    return within(along, v.reach + across * sin(axis.tilt) + abs(along) * (Interval(T(1.0)) - cos(axis.tilt)));
  }

  /// The available landmarks.
  class Femur {
   public:
    Femur(const FemurLandmarks& landmarks, std::optional<Side> side, double radius)
        : landmarks_(landmarks), side_(side), radius_(radius) {
      if (!(radius >= 0.0) || !std::isfinite(radius))
        throw Error(ErrorKind::input, fmt::format("landmark radius = {}: must be finite and not negative", radius));
      for (const auto& [name, point] : named_landmarks) check(name, landmarks.*point);
      const std::optional<double>& head_radius = landmarks.head_radius;
      if (head_radius && !(std::isfinite(*head_radius) && *head_radius > 0.0))
        throw Error(ErrorKind::input, fmt::format("head_radius = {}: must be finite and positive", *head_radius));
    }

    [[nodiscard]] std::optional<LandmarkBall> ball(std::optional<Point> FemurLandmarks::*point) const {
      const std::optional<Point>& at = landmarks_.*point;
      if (!at) return std::nullopt;
      return LandmarkBall{verify::exact<T>(*at), Interval(T(radius_))};
    }

    /// The axis; nothing if a point is missing or if both points may be the same.
    [[nodiscard]] std::optional<Axis> axis(std::optional<Point> FemurLandmarks::*from,
                                           std::optional<Point> FemurLandmarks::*to) const {
      const std::optional<LandmarkBall> start = ball(from);
      const std::optional<LandmarkBall> end = ball(to);
      if (!start || !end) return std::nullopt;
      const Axis found(*start, *end);
      if (!found.known()) return std::nullopt;
      return found;
    }

    [[nodiscard]] std::optional<Axis> neck() const {
      return axis(&FemurLandmarks::neck_centre, &FemurLandmarks::head_centre);
    }
    [[nodiscard]] std::optional<Axis> shaft() const {
      return axis(&FemurLandmarks::shaft_distal, &FemurLandmarks::shaft_proximal);
    }
    [[nodiscard]] std::optional<Axis> posterior_condyles() const {
      return axis(&FemurLandmarks::lateral_posterior_condyle, &FemurLandmarks::medial_posterior_condyle);
    }
    [[nodiscard]] std::optional<Axis> epicondyles() const {
      return axis(&FemurLandmarks::lateral_epicondyle, &FemurLandmarks::medial_epicondyle);
    }
    [[nodiscard]] std::optional<LandmarkBall> knee() const {
      const std::optional<LandmarkBall> medial = ball(&FemurLandmarks::medial_epicondyle);
      const std::optional<LandmarkBall> lateral = ball(&FemurLandmarks::lateral_epicondyle);
      if (!medial || !lateral) return std::nullopt;
      return middle_of(*medial, *lateral);
    }

    [[nodiscard]] std::optional<Side> side() const { return side_; }
    [[nodiscard]] double radius() const { return radius_; }
    [[nodiscard]] const FemurLandmarks& landmarks() const { return landmarks_; }

   private:
    static void check(const char* name, const std::optional<Point>& at) {
      if (!at || std::ranges::all_of(*at, [](double x) { return std::isfinite(x); })) return;
      throw Error(ErrorKind::input, fmt::format("{} = {}, {}, {}: must be finite", name, (*at)[0], (*at)[1], (*at)[2]));
    }

    const FemurLandmarks& landmarks_;
    std::optional<Side> side_;
    double radius_;
  };

  /// The angle between the medial directions of both; `line` leads from lateral to medial. Ahead of the line is
  /// positive. About the shaft, which points upward, this is the positive sense for the left femur and the negative one
  /// for the right.
  static std::optional<Interval> version(const std::optional<Axis>& line, const std::optional<VectorBall>& neck,
                                         const std::optional<Axis>& shaft, std::optional<Side> side) {
    if (!line || !neck || !shaft || !side) return std::nullopt;
    const std::optional<Interval> found = azimuth(line->direction, *neck, *shaft);
    if (!found || side == Side::left) return found;
    return -*found;
  }

  static std::optional<VectorBall> direction_of(const std::optional<Axis>& axis) {
    if (!axis) return std::nullopt;
    return axis->direction;
  }

  static void add_versions(const Femur& femur, Findings& findings) {
    const auto shaft = femur.shaft();
    const auto neck = direction_of(femur.neck());
    std::optional<VectorBall> from_shaft;
    if (const auto head = femur.ball(&FemurLandmarks::head_centre); head && shaft)
      from_shaft = difference(*head, shaft->from);
    const auto condyles = femur.posterior_condyles();
    const auto epicondyles = femur.epicondyles();
    findings.degrees("version", "neck axis against the posterior condylar line, seen along the shaft axis",
                     version(condyles, neck, shaft, femur.side()), "neck, shaft, posterior condyles and the side");
    findings.degrees("version", "neck axis against the transepicondylar line, seen along the shaft axis",
                     version(epicondyles, neck, shaft, femur.side()), "neck, shaft, epicondyles and the side");
    findings.degrees("version", "shaft axis to head's centre against the posterior condylar line",
                     version(condyles, from_shaft, shaft, femur.side()),
                     "head, shaft, posterior condyles and the side");
  }

  /// An axis of the frame: of the centres, of any length, and how far it tilts over the balls.
  struct TiltedVector {
    IntervalVector3 centre;
    Interval tilt;
  };

  /// In degrees: no choice of landmarks gives an axis that tilts farther from the direction. Precondition: the
  /// direction is not 0.
  static double tilt_from(const Point& direction, const TiltedVector& axis) {
    const Interval between = verify::angle_between(axis.centre, verify::exact<T>(direction));
    return enclosure(in_degrees(axis.tilt + between)).hi;
  }

  /// Rounded to nearest; the tilt counts that, too.
  static FrameAxis frame_axis(const TiltedVector& axis) {
    const IntervalVector3& v = axis.centre;
    const Interval size = verify::length(v);
    Point direction{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Enclosure x = enclosure(v[i] / size);
      direction[i] = 0.5 * (x.lo + x.hi);
    }
    return {direction, tilt_from(direction, axis)};
  }

  /// The tilt of z' consists of the effect of y's tilt on z and of the change of azimuth about y; likewise for x'.
  static std::optional<std::array<TiltedVector, 3>> frame_of(const Femur& femur) {
    const auto knee = femur.knee();
    const auto head = femur.ball(&FemurLandmarks::head_centre);
    const auto line = femur.epicondyles();
    if (!knee || !head || !line || !femur.side()) return std::nullopt;
    const Axis y(*knee, *head);
    if (!y.known()) return std::nullopt;
    VectorBall to_the_right = line->direction;  // to medial, which is the left femur's right
    if (femur.side() == Side::right) to_the_right.centre = -to_the_right.centre;
    const Interval change = azimuth_change(to_the_right, y);
    if (change.upper() >= T(3.0)) return std::nullopt;
    const IntervalVector3& up = y.direction.centre;
    const IntervalVector3 ahead = verify::cross(up, to_the_right.centre);
    const IntervalVector3 right = verify::cross(ahead, up);
    return std::array<TiltedVector, 3>{{{ahead, y.tilt + change}, {up, y.tilt}, {right, y.tilt + change}}};
  }

  static std::optional<Interval> angle_of(const std::optional<Axis>& a, const std::optional<Axis>& b, bool b_reversed) {
    if (!a || !b) return std::nullopt;
    return angle(*a, *b, b_reversed);
  }

  static std::optional<Interval> distance_of(const std::optional<LandmarkBall>& point,
                                             const std::optional<Axis>& axis) {
    if (!point || !axis) return std::nullopt;
    return distance(*point, *axis);
  }

  static std::optional<Interval> distance_of(const std::optional<LandmarkBall>& a,
                                             const std::optional<LandmarkBall>& b) {
    if (!a || !b) return std::nullopt;
    return distance(*a, *b);
  }

  static std::optional<Axis> mechanical_axis(const Femur& femur) {
    const auto knee = femur.knee();
    const auto head = femur.ball(&FemurLandmarks::head_centre);
    if (!knee || !head) return std::nullopt;
    const Axis axis(*knee, *head);
    if (!axis.known()) return std::nullopt;
    return axis;
  }

  static FemurFeatures femur_features(const FemurLandmarks& landmarks, std::optional<Side> side,
                                      double landmark_radius) {
    const Femur femur(landmarks, side, landmark_radius);
    Findings findings;
    const auto head = femur.ball(&FemurLandmarks::head_centre);
    const auto shaft = femur.shaft();
    std::optional<Interval> radius;
    if (landmarks.head_radius) {
      const Interval found = within(Interval(T(*landmarks.head_radius)), Interval(T(landmark_radius)));
      radius = Interval(std::max(T(0.0), found.lower()), found.upper());
    }
    findings.length("head_radius", "sphere of the head", radius, "the head's radius");
    findings.degrees("ccd", fmt::format("{}; against the shaft axis, in space", neck_axis),
                     angle_of(femur.neck(), shaft, true), "neck and shaft");
    findings.length("offset", "head's centre to the shaft axis", distance_of(head, shaft), "head and shaft");
    add_versions(femur, findings);
    findings.length("length", "head's centre to the middle of the epicondyles", distance_of(head, femur.knee()),
                    "head and epicondyles");
    findings.length(
        "epicondylar_width", "distance of the epicondyles",
        distance_of(femur.ball(&FemurLandmarks::medial_epicondyle), femur.ball(&FemurLandmarks::lateral_epicondyle)),
        "epicondyles");
    findings.degrees("anatomical_mechanical_angle",
                     "shaft axis against the line from the middle of the epicondyles to the head's centre, in space",
                     angle_of(mechanical_axis(femur), shaft, false), "head, shaft and epicondyles");
    if (const auto frame = frame_of(femur)) {
      const auto& [x, y, z] = *frame;
      findings.set({*landmarks.head_centre, frame_axis(x), frame_axis(y), frame_axis(z)});
    } else {
      findings.miss("frame (ISB): needs head, epicondyles and the side");
    }
    return findings.take();
  }

  static FemurFeatures implant_changes(const FemurLandmarks& bone, std::optional<Side> side, double landmark_radius,
                                       const FemurLandmarks& implant) {
    const Femur femur(bone, side, landmark_radius);
    const Femur posed_implant(implant, side, 0.0);
    Findings findings;
    const auto new_head = posed_implant.ball(&FemurLandmarks::head_centre);
    const auto new_neck = posed_implant.neck();
    const auto head = femur.ball(&FemurLandmarks::head_centre);
    const auto shaft = femur.shaft();
    std::optional<Interval> offset;
    std::optional<Interval> length;
    if (new_head && head && shaft) {
      offset = difference_of_distances(*new_head, *head, *shaft);
      length = extent(difference(*new_head, *head), *shaft);
    }
    const std::optional<Interval> new_ccd = angle_of(new_neck, shaft, true);
    const std::optional<Interval> ccd = angle_of(femur.neck(), shaft, true);
    std::optional<Interval> ccd_change;
    if (new_ccd && ccd) ccd_change = *new_ccd - *ccd;
    findings.length("offset_change", "distance of the head's centre from the bone's shaft axis, implant less bone",
                    offset, "the heads of bone and implant, the bone's shaft");
    findings.length(
        "length_change",
        "head's centre along the bone's shaft axis, implant less bone; the leg's, where the socket's centre "
        "stays in place",
        length, "the heads of bone and implant, the bone's shaft");
    findings.length("head_distance", "the implant's head's centre from the bone's", distance_of(new_head, head),
                    "the heads of bone and implant");
    findings.degrees("version_change", "neck axes seen along the bone's shaft axis, implant less bone; positive: ahead",
                     version(femur.neck(), direction_of(new_neck), shaft, side),
                     "the necks of bone and implant, the bone's shaft and the side");
    findings.degrees("ccd_change", "neck axes against the bone's shaft axis, in space, implant less bone", ccd_change,
                     "the necks of bone and implant, the bone's shaft");
    findings.degrees("implant_ccd", "the implant's neck axis against the bone's shaft axis, in space", new_ccd,
                     "the bone's shaft and the implant's neck");
    if (implant.shaft_proximal && implant.shaft_distal) {
      findings.degrees("implant_tilt", "the implant's shaft axis against the bone's shaft axis, in space",
                       angle_of(posed_implant.shaft(), shaft, false), "the shafts of bone and implant");
    }
    return findings.take();
  }
};

}  // namespace

FemurFeatures femur_features(const FemurLandmarks& landmarks, std::optional<Side> side, double landmark_radius) {
  return FemurGeometry<double>::femur_features(landmarks, side, landmark_radius);
}

FemurFeatures implant_changes(const FemurLandmarks& bone, std::optional<Side> side, double landmark_radius,
                              const FemurLandmarks& implant) {
  return FemurGeometry<double>::implant_changes(bone, side, landmark_radius, implant);
}

namespace {

// The same in 127-bit intervals, each end rounded outward to binary64, for comparison with claims.
using PreciseGeometry = FemurGeometry<verify::Real>;

/// For each of the frame's axes x, y, z: the largest angle in degrees by which the axis tilts from a direction. Nothing
/// if the landmarks determine no frame. Precondition: finite, not 0.
std::optional<std::array<double, 3>> precise_tilts(const FeatureClaims& claims,
                                                   const std::array<Point, 3>& directions) {
  const PreciseGeometry::Femur femur(claims.landmarks, claims.side, claims.landmark_radius);
  const auto frame = PreciseGeometry::frame_of(femur);
  if (!frame) return std::nullopt;
  std::array<double, 3> tilts{};
  for (std::size_t i = 0; i < tilts.size(); ++i) tilts[i] = PreciseGeometry::tilt_from(directions[i], (*frame)[i]);
  return tilts;
}

constexpr Finding nothing_known{Verdict::unproved, {-infinity, infinity}};

std::vector<Finding> judged(const std::vector<Feature>& claims, const FemurFeatures& proven) {
  std::vector<Finding> findings;
  for (const Feature& claim : claims) {
    const auto same = std::ranges::find_if(proven.features, [&](const Feature& known) {
      return known.name == claim.name && known.method == claim.method && known.unit == claim.unit;
    });
    const bool is_known = same != proven.features.end();
    findings.push_back(is_known ? verify::judged(claim.value, same->value, same->value) : nothing_known);
  }
  return findings;
}

/// The origin of the frame is the head's centre itself.
std::array<Finding, 3> judged(const FemurFrame& claim, const FeatureClaims& claims) {
  std::array<Finding, 3> findings{nothing_known, nothing_known, nothing_known};
  const std::array axes{&claim.x, &claim.y, &claim.z};
  const auto has_direction = [](const FrameAxis* axis) {
    const auto& [x, y, z] = axis->direction;
    return verify::usable({x, y, z});
  };
  if (claims.landmarks.head_centre != claim.origin || !std::ranges::all_of(axes, has_direction)) return findings;
  const auto tilts = precise_tilts(claims, {claim.x.direction, claim.y.direction, claim.z.direction});
  for (std::size_t i = 0; tilts && i < axes.size(); ++i) {
    const double tilt = (*tilts)[i];
    findings[i] = {tilt <= axes[i]->tilt_degrees ? Verdict::proved : Verdict::unproved, {0.0, tilt}};
  }
  return findings;
}

}  // namespace

std::vector<Finding> FeatureFindings::all() const {
  std::vector<Finding> result = features;
  if (frame) result.insert(result.end(), frame->begin(), frame->end());
  result.insert(result.end(), changes.begin(), changes.end());
  return result;
}

FeatureFindings check(const FeatureClaims& claims) {
  const auto& [landmarks, side, radius, features, frame, implant, changes] = claims;
  const FemurFeatures proven = PreciseGeometry::femur_features(landmarks, side, radius);
  FeatureFindings findings{judged(features, proven), {}, std::vector<Finding>(changes.size(), nothing_known)};
  if (frame) findings.frame = judged(*frame, claims);
  if (implant) findings.changes = judged(changes, PreciseGeometry::implant_changes(landmarks, side, radius, *implant));
  return findings;
}

}  // namespace verisq

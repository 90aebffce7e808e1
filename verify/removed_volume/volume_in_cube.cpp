/// Tetrahedra are cut in two, exactly: a point at the share s of an edge, s a binary64 number, divides the volume s to
/// 1 - s, and a function that is linear on the tetrahedron has a value there that lies at the same share between those
/// at the edge's ends. So no coordinates are needed, nor does rounding move anything: which share is taken decides only
/// how much is left between what surely lies in a set and what surely does not.
#include "verify/removed_volume/volume_in_cube.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {
namespace {

/// So that no cube costs more than a moment: one that is cut into more is bounded by nothing or all of it.
constexpr std::size_t most_tetrahedra = 4096;
/// Cuts lie that little short of where the function vanishes: on this side of it, whatever the rounding.
constexpr double just_short = 1.0 - 0x1p-48;

struct Tetrahedron {
  Interval volume;
  std::array<std::uint32_t, 4> corners;
};

/// What of a set is wanted: tetrahedra that surely lie in it, or those that may.
enum class Wanted : std::uint8_t { surely, maybe };

/// Cuts the cube at functions until each tetrahedron surely lies in the set, surely does not, or is thin.
class Dissection {
 public:
  Dissection(double half_width, Wanted wanted) : half_width_(half_width), wanted_(wanted) {}

  /// A bound from below of `surely`, from above of `maybe`.
  double operator()(const PartOfCube& part) {
    if (!take_what_matters(part)) return 0.0;
    cut_cube_into_six();
    for (const auto& [first, last] : unions_) {
      if (!keep_union(first, last)) return wanted_ == Wanted::surely ? 0.0 : volume_of_cube(half_width_).upper();
    }
    return volume();
  }

 private:
  enum class Place : std::uint8_t { before, on, beyond };
  struct Piece {
    Tetrahedron tetrahedron;
    std::array<Place, 4> places;
  };

  /// Where this is not positive, a point is surely in the part (`surely`), or surely not in its inside (`maybe`).
  [[nodiscard]] double decisive(const Interval& height) const {
    return wanted_ == Wanted::surely ? height.upper() : -height.lower();
  }

  /// Functions that are decided for the whole cube need no cuts. False where the set is empty.
  bool take_what_matters(const PartOfCube& part) {
    for (const UnionOfParts& whole : part) {
      const std::size_t first = functions_.size();
      bool all = false;
      for (const CornerHeights& heights : whole) {
        const auto decided =
            std::ranges::count_if(heights, [&](const Interval& height) { return decisive(height) <= 0.0; });
        const bool holds_all = wanted_ == Wanted::surely ? decided == 8 : decided == 0;
        const bool holds_nothing = wanted_ == Wanted::surely ? decided == 0 : decided == 8;
        all = all || holds_all;
        if (!holds_nothing) functions_.push_back(&heights);
      }
      if (all) {
        functions_.resize(first);
        continue;
      }
      if (functions_.size() == first) return false;
      unions_.emplace_back(first, functions_.size());
    }
    return true;
  }

  /// From the corner 0 to the corner 7 along the axes, in each of their orders.
  void cut_cube_into_six() {
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (const CornerHeights* function : functions_) heights_.push_back((*function)[corner]);
    const Interval sixth = volume_of_cube(half_width_) / Interval(6);
    std::array<std::uint32_t, 3> axes{0, 1, 2};
    do {
      const std::uint32_t first = 1U << axes[0];
      tetrahedra_.push_back({sixth, {0, first, first | 1U << axes[1], 7}});
    } while (std::ranges::next_permutation(axes).found);
  }

  /// Of each tetrahedron what lies in one of the parts. False where that takes too many.
  bool keep_union(std::size_t first, std::size_t last) {
    std::vector<Tetrahedron> kept;
    std::vector<Tetrahedron> rest = std::move(tetrahedra_);
    for (std::size_t function = first; function < last; ++function) {
      std::vector<Tetrahedron> decided;
      std::vector<Tetrahedron> others;
      for (const Tetrahedron& whole : rest) split(whole, function, decided, others);
      if (wanted_ == Wanted::maybe) std::swap(decided, others);
      kept.insert(kept.end(), decided.begin(), decided.end());
      rest = std::move(others);
      if (kept.size() + rest.size() > most_tetrahedra) return false;
    }
    tetrahedra_ = std::move(kept);
    return true;
  }

  [[nodiscard]] const Interval& height(std::uint32_t corner, std::size_t function) const {
    return heights_[corner * functions_.size() + function];
  }

  /// Into tetrahedra of which all corners are decided, where a linear function is decided everywhere, and others.
  void split(const Tetrahedron& whole, std::size_t function, std::vector<Tetrahedron>& decided,
             std::vector<Tetrahedron>& others) {
    Piece start{whole, {}};
    for (std::size_t k = 0; k < 4; ++k) {
      start.places[k] = decisive(height(whole.corners[k], function)) <= 0.0 ? Place::before : Place::beyond;
    }
    pieces_.assign(1, start);
    while (!pieces_.empty()) {
      Piece piece = pieces_.back();
      pieces_.pop_back();
      const auto* const before = std::ranges::find(piece.places, Place::before);
      const auto* const beyond = std::ranges::find(piece.places, Place::beyond);
      if (beyond == piece.places.end()) {
        decided.push_back(piece.tetrahedron);
      } else if (before == piece.places.end()) {
        others.push_back(piece.tetrahedron);
      } else {
        cut(piece, static_cast<std::size_t>(before - piece.places.begin()),
            static_cast<std::size_t>(beyond - piece.places.begin()), function);
      }
    }
  }

  /// At a point of the edge from a decided corner that is decided itself, as near to where the function vanishes as may
  /// be; nowhere where that is the corner itself.
  void cut(Piece& piece, std::size_t from, std::size_t to, std::size_t function) {
    const std::uint32_t a = piece.tetrahedron.corners[from];
    const std::uint32_t b = piece.tetrahedron.corners[to];
    const double at_a = decisive(height(a, function));
    const double share = just_short * (at_a / (at_a - decisive(height(b, function))));
    if (!(share > 0.0 && share < 1.0) || !add_corner(a, b, share, function)) {
      piece.places[from] = Place::on;
      pieces_.push_back(piece);
      return;
    }
    const auto corner = static_cast<std::uint32_t>(heights_.size() / functions_.size() - 1);
    const Interval s(share);
    Piece near = piece;
    near.tetrahedron.corners[to] = corner;
    near.tetrahedron.volume = piece.tetrahedron.volume * s;
    near.places[to] = Place::on;
    piece.tetrahedron.corners[from] = corner;
    piece.tetrahedron.volume = piece.tetrahedron.volume * (Interval(1) - s);
    piece.places[from] = Place::on;
    pieces_.push_back(near);
    pieces_.push_back(piece);
  }

  /// False, and none, where it is not decided.
  bool add_corner(std::uint32_t a, std::uint32_t b, double share, std::size_t function) {
    const Interval s(share);
    const Interval rest = Interval(1) - s;
    const auto between = [&](std::size_t k) { return rest * height(a, k) + s * height(b, k); };
    if (!(decisive(between(function)) <= 0.0)) return false;
    for (std::size_t k = 0; k < functions_.size(); ++k) heights_.push_back(between(k));
    return true;
  }

  [[nodiscard]] double volume() const {
    double sum = 0.0;
    for (const Tetrahedron& tetrahedron : tetrahedra_) {
      const Interval& volume = tetrahedron.volume;
      sum = wanted_ == Wanted::surely ? add(sum, volume.lower(), Direction::down)
                                      : add(sum, volume.upper(), Direction::up);
    }
    return sum;
  }

  double half_width_;
  Wanted wanted_;
  std::vector<const CornerHeights*> functions_;              // those of one union after those of the other
  std::vector<std::pair<std::size_t, std::size_t>> unions_;  // first and last + 1 of them
  std::vector<Interval> heights_;                            // of each corner the values of all functions
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Piece> pieces_;  // of one tetrahedron, kept to save allocations
};

}  // namespace

CornerHeights linear_heights(const Interval& at_centre, const Vector3<double>& rise) {
  CornerHeights heights;
  for (std::size_t k = 0; k < 8; ++k) {
    heights[k] = at_centre;
    for (std::size_t i = 0; i < 3; ++i) heights[k] += (k >> i & 1U) != 0 ? rise[i] : -rise[i];
  }
  return heights;
}

CornerHeights negative(const CornerHeights& heights) {
  CornerHeights result;
  std::ranges::transform(heights, result.begin(), [](const Interval& height) { return -height; });
  return result;
}

void leave_nothing(BracketedPart& part) {
  part.inner.emplace_back();
  part.outer.emplace_back();
}

void leave_unknown(BracketedPart& part) {
  part.inner.emplace_back();
}

Interval volume_of_cube(double half_width) {
  const Interval edge = Interval(2) * Interval(half_width);
  return edge * edge * edge;
}

Enclosure volume_in_cube(double half_width, const BracketedPart& part) {
  const double all = volume_of_cube(half_width).upper();
  return {std::max(0.0, Dissection(half_width, Wanted::surely)(part.inner)),
          std::min(all, Dissection(half_width, Wanted::maybe)(part.outer))};
}

}  // namespace verisq::verify

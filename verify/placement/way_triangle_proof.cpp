/// Follows the divisions of a proof, cell by cell: those that are not divided make up the triangle and the way.
#include "verify/placement/way_triangle_proof.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "verify/placement/middle_of_way.hpp"
#include "verify/placement/quartered_triangle.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

class Walk {
 public:
  Walk(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
       const std::array<double, 3>& at_vertices, const WayTriangle& proof)
      : solids_(solids), at_vertices_(at_vertices), proof_(proof), pieces_(path, whole), open_{pieces_.whole()} {}

  [[nodiscard]] double follow() {
    for (const WayCell letter : proof_.cells) {
      if (open_.empty() || least_ == -infinity) return -infinity;
      const WayPiece piece = open_.back();
      open_.pop_back();
      if (!take(letter, piece)) return -infinity;
    }
    return open_.empty() ? least_ : -infinity;
  }

 private:
  /// False where the letter says nothing of such a piece.
  [[nodiscard]] bool take(WayCell letter, const WayPiece& piece) {
    switch (letter) {
      case WayCell::by_vertices: least_ = std::min(least_, pieces_.least_on(piece, at_vertices_)); return true;
      case WayCell::moved:
        if (used_ == proof_.moved.size()) return false;
        least_ = std::min(least_, lower_end(solids_, pieces_.prism_of(piece), proof_.moved[used_++]));
        return true;
      case WayCell::quartered: return quarter(piece);
      case WayCell::halved: return halve(piece);
    }
    return false;
  }

  /// What comes first is put last.
  [[nodiscard]] bool quarter(const WayPiece& piece) {
    if (piece.quarterings == most_quarterings) return false;
    const std::array<Triangle, 4> parts = quarters(piece.corners);
    for (std::size_t i = 4; i-- > 0;) open_.push_back({parts[i], piece.begin, piece.end, piece.quarterings + 1});
    return true;
  }

  [[nodiscard]] bool halve(const WayPiece& piece) {
    const double middle = middle_of_way(piece.begin, piece.end);
    if (!(piece.begin < middle && middle < piece.end)) return false;
    open_.push_back({piece.corners, middle, piece.end, piece.quarterings});
    open_.push_back({piece.corners, piece.begin, middle, piece.quarterings});
    return true;
  }

  std::span<const PosedSuperquadric> solids_;
  const std::array<double, 3>& at_vertices_;
  const WayTriangle& proof_;
  PiecesOnWay pieces_;
  std::vector<WayPiece> open_;
  std::size_t used_ = 0;  ///< of the moved cells
  double least_ = infinity;
};

}  // namespace

PiecesOnWay::PiecesOnWay(const RigidPath& path, const Triangle& whole)
    : path_(path), whole_(whole), off_(quartering_error(whole)) {}

Moment PiecesOnWay::moment(const Point& corner, double time) {
  auto found = poses_.find(time);
  if (found == poses_.end()) found = poses_.emplace(time, path_.nearest_pose(time)).first;
  return {time, RigidPath::local_point(found->second, corner)};
}

WayPrism PiecesOnWay::prism_of(const WayPiece& piece) {
  const auto way = [&](std::size_t i) {
    const Point& corner = piece.corners[i];
    return chord_of(path_, corner, moment(corner, piece.begin), moment(corner, piece.end));
  };
  return {{way(0), way(1), way(2)}, piece.quarterings == 0 ? 0.0 : off_};
}

double PiecesOnWay::least_on(const WayPiece& piece, const std::array<double, 3>& at_vertices) const {
  if (piece.quarterings == 0) return verify::least_on(whole_, at_vertices);
  return verify::least_on(piece.corners, off_, whole_, at_vertices);
}

double least_on(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
                const std::array<double, 3>& at_vertices, const WayTriangle& proof) {
  return Walk(path, solids, whole, at_vertices, proof).follow();
}

}  // namespace verisq::verify

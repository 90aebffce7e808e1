/// What proves an enclosure again, without device, solver or search (docs/mathematics.md §2): a few vectors a point.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// A vector v that bounds the signed distance of a point q to one primitive K, whatever v is: from below by
/// (v·q - h(v)) / |v| with K's support function h, because K lies in the half-space {v·x <= h(v)}; from above by
/// |q - b|, where b is the last point of K on the ray from K's centre (its focus, of a tapered one) through q - v. Both
/// are tight where v points along the gradient of the distance and, for q outside, is as long as the distance: b is
/// then the closest point. Given in the primitive's own frame, so that no rotation rounds it: in a flat solid the bound
/// would feel that. What it proves of a bent primitive Checker says.
struct Normal {
  std::uint32_t primitive;  ///< index in Model::primitives
  std::array<double, 3> vector;

  [[nodiscard]] bool operator==(const Normal&) const = default;
};

/// The certificate of one enclosure [lo, hi] of the signed distance of a point q to a solid, or of the distance of a
/// triangle (0 where it meets the union).
///
/// Of a point and a union of primitives:
/// Lower end: with lo > 0, every primitive is farther than lo, by one of `normals` or by its bounding sphere. With
/// lo <= 0, `escape` is a point outside all primitives that is no farther than -lo from q; in a model of a single
/// primitive a normal serves as well.
/// Upper end: by one of `normals`; with hi < 0, the ball of radius -hi about q lies inside the primitive of the first
/// normal, which is proven by covering the ball with cones (the branch and bound needs no more than the radius), or by
/// `cover`.
///
/// Of a point and any model, also of set operations: `witness` is a point inside, no farther than hi from q where that
/// is not negative, `escape` one outside, no farther than -lo where lo is not positive. With lo > 0, or hi < 0, `cover`
/// divides the cube about the ball of radius lo, or -hi, about q into cells of which each is proven to hold nothing of
/// the solid, or of its complement, in the ball (docs/mathematics.md §28): in preorder true for a cell that is halved
/// across the first of its longest edges, false for one that is not. `normals` tell on which side of their primitives
/// the whole ball lies.
///
/// Of a triangle with corners t_i and a union: a normal v proves the lower end (min_i v·t_i - h(v)) / |v| for its
/// primitive, unless that is bent; the upper end is that of the point q = t_0 + w_1 (t_1 - t_0) + w_2 (t_2 - t_0) by
/// the first normal, w being `weights`; 0 where q is in the first normal's primitive. Of a triangle and any model:
/// `witness` is a point inside, no farther than hi from q, any where q itself lies inside, and `cover` is that of the
/// box about all points nearer to the triangle than lo.
struct Certificate {
  std::vector<Normal> normals;                        ///< the first is that of the primitive that decides hi
  std::optional<Point> escape;                        ///< of a point only
  std::optional<std::array<double, 2>> weights = {};  ///< of a triangle only; they prove nothing unless w_1, w_2 >= 0
                                                      ///< and w_1 + w_2 <= 1 exactly
  std::optional<Point> witness = {};
  std::vector<bool> cover = {};  ///< empty where there is none

  [[nodiscard]] bool operator==(const Certificate&) const = default;
};

struct CertifiedEnclosure {
  Enclosure distance;
  Certificate certificate;
};

}  // namespace verisq

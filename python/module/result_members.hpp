/// How many members the library's results have, and what they are made of: what pickling asks for.
#pragma once

#include <cstddef>
#include <verisq/certificate.hpp>
#include <verisq/closest_point.hpp>
#include <verisq/closest_points.hpp>
#include <verisq/deviation_certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/features.hpp>
#include <verisq/map.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/model.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/pair_certificate.hpp>

#include "python/module/pickling.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<Enclosure> = 2;

// Models

template <>
inline constexpr std::size_t member_count<Superquadric> = 3;
template <>
inline constexpr std::size_t member_count<Pose> = 2;
template <>
inline constexpr std::size_t member_count<Bend> = 2;
template <>
inline constexpr std::size_t member_count<Primitive> = 4;
template <>
inline constexpr std::size_t member_count<SetExpression> = 3;
template <>
inline constexpr std::size_t member_count<Model> = 3;

// Maps

template <>
inline constexpr std::size_t member_count<MapResult> = 2;
template <>
inline constexpr std::size_t member_count<MapSummary> = 14;
template <>
inline constexpr std::size_t member_count<Normal> = 2;
template <>
inline constexpr std::size_t member_count<Certificate> = 5;
template <>
inline constexpr std::size_t member_count<ClosestPoint> = 5;
template <>
inline constexpr std::size_t member_count<ClosestPointSummary> = 5;
template <>
inline constexpr std::size_t member_count<ClosestPoints> = 3;
template <>
inline constexpr std::size_t member_count<PointOnTriangle> = 2;
template <>
inline constexpr std::size_t member_count<MeshClearance> = 8;

// Certificates of two models

template <>
inline constexpr std::size_t member_count<Separation> = 5;
template <>
inline constexpr std::size_t member_count<SectionPlane> = 3;
template <>
inline constexpr std::size_t member_count<DividedSeparation> = 4;
template <>
inline constexpr std::size_t member_count<EnclosingBall> = 5;
template <>
inline constexpr std::size_t member_count<SurroundedPrimitive> = 3;
template <>
inline constexpr std::size_t member_count<PairCertificate> = 8;

// Certificates of distances from triangles

template <>
inline constexpr std::size_t member_count<CertifiedEnclosure> = 2;
template <>
inline constexpr std::size_t member_count<TriangleProof> = 2;
template <>
inline constexpr std::size_t member_count<CertifiedPoint> = 2;
template <>
inline constexpr std::size_t member_count<SurfaceCover> = 3;

// Features of femurs

template <>
inline constexpr std::size_t member_count<Feature> = 4;
template <>
inline constexpr std::size_t member_count<FrameAxis> = 2;
template <>
inline constexpr std::size_t member_count<FemurFrame> = 4;
template <>
inline constexpr std::size_t member_count<FemurFeatures> = 3;

}  // namespace verisq::python

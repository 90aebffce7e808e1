/// The fuzz targets: each hands arbitrary bytes to one reader and checks that the reader keeps its promises.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace verisq::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Each returns when the reader either delivers what its public header promises or refuses the bytes with a
/// verisq::Error(input) of one line. A broken promise leaves as BrokenPromise, any other exception as it is.
void stl(Bytes bytes);
void obj(Bytes bytes);
void ply(Bytes bytes);
void off(Bytes bytes);
void vtp(Bytes bytes);
void vtk(Bytes bytes);
void model(Bytes bytes);
void points(Bytes bytes);
void points_npy(Bytes bytes);
void poses(Bytes bytes);
void map_csv(Bytes bytes);
void map_vtp(Bytes bytes);
void stance_model(Bytes bytes);
void landmarks(Bytes bytes);
void nrrd(Bytes bytes);
void nifti(Bytes bytes);
void certificate(Bytes bytes);

struct Target {
  std::string_view name;  ///< also of its seeds' folder in tests/fuzz/corpus
  void (*run)(Bytes);
};

inline constexpr std::array targets{
    Target{"stl", stl},
    Target{"obj", obj},
    Target{"ply", ply},
    Target{"off", off},
    Target{"vtp", vtp},
    Target{"vtk", vtk},
    Target{"model", model},
    Target{"points", points},
    Target{"poses", poses},
    Target{"points_npy", points_npy},
    Target{"map_csv", map_csv},
    Target{"map_vtp", map_vtp},
    Target{"stance_model", stance_model},
    Target{"landmarks", landmarks},
    Target{"nrrd", nrrd},
    Target{"nifti", nifti},
    Target{"certificate", certificate},
};

}  // namespace verisq::fuzz

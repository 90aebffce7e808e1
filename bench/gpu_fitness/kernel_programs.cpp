/// This file lists the programs as host/batches, host/fit and host/octree build them.
#include "bench/gpu_fitness/kernel_programs.hpp"

#include <verisq/files.hpp>

#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::bench {

std::vector<KernelProgram> kernel_programs(const std::string& examples) {
  const Model solid = read_model(examples + "/bent_stem.json");
  const Model tapered = read_model(examples + "/bent_tapered_stem.json");
  return {
      {"points", std::string(kernels::embedded_point_sources()), ""},
      {"tapered points", std::string(kernels::embedded_tapered_sources()),
       "-Dpoint_distance=tapered_point_distance -Dinterior_depth=tapered_interior_depth"},  // names of those of points
      {"points in one step", std::string(kernels::embedded_point_map()), ""},
      {"tapered points in one step", std::string(kernels::embedded_tapered_point_map()),
       "-Dpoint_map=tapered_point_map"},
      {"triangles", std::string(kernels::embedded_triangle_sources()), ""},
      {"pairs", std::string(kernels::embedded_pair_sources()), ""},
      {"fit", std::string(kernels::embedded_pose_objective_sources()), ""},
      {"solid", device::solid_source(solid), ""},
      {"tapered solid", device::solid_source(tapered),
       "-Dbent_distance=tapered_bent_distance -Dset_bounds=tapered_set_bounds -Dset_feet=tapered_set_feet "
       "-Dsolid_distance=tapered_solid_distance"},
      {"octree", device::model_source(solid, kernels::embedded_octree()), ""},
      {"octree of tapered ones", device::model_source(tapered, kernels::embedded_octree()),
       "-Dsplit_cubes=tapered_split_cubes"}};
}

}  // namespace verisq::bench

/// Octrees: cubes proven inside or outside, and the volume between them.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/device.hpp>
#include <verisq/octree.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

struct PythonOctree {
  OctreeSummary summary;
  std::vector<OctreeCube> cubes;
  bool complete;
};

PythonOctree octree(const PythonModel& model, const std::optional<int>& depth, const std::optional<double>& tolerance,
                    const std::optional<std::size_t>& budget, const std::string& device,
                    const std::optional<double>& time_limit) {
  check_time_limit(time_limit);
  if (depth && tolerance) throw py::value_error("give either depth or tolerance");
  const Model& exact = model.exact("octree");
  Interruption interruption;
  Deadline limit(time_limit, interruption.poll());
  limit.start();
  OctreeOptions options{.device = device, .interrupted = limit.stop()};
  if (depth) options.depth = *depth;
  if (tolerance) {
    check_length(*tolerance, "tolerance");
    options.tolerance = *tolerance;
    options.depth = deepest_octree_level;
  }
  if (budget) options.budget = *budget;
  PythonOctree result{};
  result.summary = without_lock(interruption, [&] {
    return OctreeBuilder(exact, options).build([&](std::span<const OctreeCube> cubes) {
      result.cubes.insert(result.cubes.end(), cubes.begin(), cubes.end());
    });
  });
  result.complete = !result.summary.interrupted && !result.summary.budget_hit &&
                    (!tolerance || verified(result.summary.volume, *tolerance));
  return result;
}

/// One number a cube.
template <class Number, class Of>
py::array_t<Number> column(const PythonOctree& self, const Of& of) {
  py::array_t<Number> result(static_cast<py::ssize_t>(self.cubes.size()));
  Number* next = result.mutable_data();
  for (const OctreeCube& cube : self.cubes) *next++ = of(cube);
  return result;
}

py::array_t<double> lower_corners(const PythonOctree& self) {
  py::array_t<double> result(std::vector<py::ssize_t>{static_cast<py::ssize_t>(self.cubes.size()), 3});
  double* next = result.mutable_data();
  for (const OctreeCube& cube : self.cubes) {
    for (const double coordinate : lower_corner(self.summary.root, cube)) *next++ = coordinate;
  }
  return result;
}

py::array_t<std::uint64_t> levels(const PythonOctree& self) {
  const std::vector<OctreeLevel>& levels = self.summary.levels;
  py::array_t<std::uint64_t> result(std::vector<py::ssize_t>{static_cast<py::ssize_t>(levels.size()), 3});
  std::uint64_t* next = result.mutable_data();
  for (const OctreeLevel& level : levels) {
    for (const std::uint64_t count : {level.white, level.gray, level.black}) *next++ = count;
  }
  return result;
}

void save(const PythonOctree& self, const std::filesystem::path& path, bool white) {
  const py::gil_scoped_release released;
  OctreeWriter writer(path, white ? WhiteCubes::written : WhiteCubes::left_out);
  writer.append(self.cubes);
  writer.finish(self.summary.root);
}

bool is_proved(const PythonOctree& self, const PythonModel& model) {
  const OctreeChecker checker(model.exact("octree"), self.summary.root, self.cubes);
  return without_lock([&](const Interrupted& interrupted) {
    return std::ranges::all_of(
        checker.cubes(), [&](const ColouredCube& cube) { return !interrupted() && checker.proves(cube, interrupted); });
  });
}

std::string representation(const PythonOctree& self) {
  const Enclosure& volume = self.summary.volume;
  return fmt::format("<verisq.Octree: {} cubes, volume in [{}, {}]>", self.cubes.size(), volume.lo, volume.hi);
}

void declare_class_of_octrees(py::module_& module) {
  const auto of_summary = [](auto OctreeSummary::*member) {
    return [member](const PythonOctree& self) { return self.summary.*member; };
  };
  py::class_<PythonOctree>(module, "Octree",
                           "What octree() proves: cubes, in no particular order, that are together a cube around the\n"
                           "model. Arrays are made anew at each access; cube i is row i of all of them.")
      .def_property_readonly("volume", of_summary(&OctreeSummary::volume),
                             "Enclosure of the solid's volume, in cubic model units: exact sums of cubes.")
      .def_property_readonly("lower", lower_corners, "float64 (N, 3): lower corners, exact, in model units.")
      .def_property_readonly(
          "edge",
          [](const PythonOctree& self) {
            return column<double>(self, [&](const OctreeCube& cube) { return edge(self.summary.root, cube.level); });
          },
          "float64 (N,): lengths of edges, exact, in model units.")
      .def_property_readonly(
          "level",
          [](const PythonOctree& self) {
            return column<std::uint8_t>(self, [](const OctreeCube& cube) { return cube.level; });
          },
          "uint8 (N,): how often the cube around the model was halved.")
      .def_property_readonly(
          "colour",
          [](const PythonOctree& self) {
            return column<std::uint8_t>(self,
                                        [](const OctreeCube& cube) { return static_cast<std::uint8_t>(cube.colour); });
          },
          "uint8 (N,): values of CubeColour.")
      .def_property_readonly("levels", levels,
                             "uint64 (L, 3): of each level, the root's first, how many of its cubes were not split: "
                             "outside,\nundecided, inside.")
      .def_property_readonly(
          "root_centre", [](const PythonOctree& self) { return self.summary.root.centre; },
          "Of the cube around the model, in model units.")
      .def_property_readonly(
          "root_half_width", [](const PythonOctree& self) { return self.summary.root.half_width; },
          "Half its edge, a power of two.")
      .def_readonly("complete", &PythonOctree::complete,
                    "Whether the depth is reached, or the volume enclosed to the tolerance.")
      .def_property_readonly("budget_hit", of_summary(&OctreeSummary::budget_hit),
                             "Whether cubes stayed undecided for want of room.")
      .def_property_readonly("out_of_time", of_summary(&OctreeSummary::interrupted), "Whether time_limit ended it.")
      .def_property_readonly("device", of_summary(&OctreeSummary::device), "The device's name, or \"host\".")
      .def_property_readonly("notice", of_summary(&OctreeSummary::notice),
                             "Why a device was passed over; empty when nothing is to be said.")
      .def("save", save, py::arg("path"), py::kw_only(), py::arg("white") = false,
           "save(path, *, white=False)\n\nWrites a .vtu, as `verisq octree -o`; with white the cubes outside, too.")
      .def("is_proved", is_proved, py::arg("model"),
           "is_proved(model) -> bool\n\nWhether every cube is proven again to lie inside or outside that model, by "
           "MPFR\n"
           "alone, and with them the volume: as `verisq check --octree`.")
      .def("__len__", [](const PythonOctree& self) { return self.cubes.size(); })
      .def("__repr__", representation)
      .def(pickled<PythonOctree>());
}

}  // namespace

void declare_octrees(py::module_& module) {
  declare_class_of_octrees(module);
  module.def("octree", octree, py::arg("model"), py::kw_only(), py::arg("depth") = py::none(),
             py::arg("tolerance") = py::none(), py::arg("budget") = py::none(), py::arg("device") = "auto",
             py::arg("time_limit") = py::none(),
             "octree(model, *, depth=None, tolerance=None, budget=None, device=\"auto\", time_limit=None) -> Octree\n\n"
             "Cubes proven inside or outside the model, and its volume between those inside and all that are not\n"
             "outside.\n\n"
             "depth: cubes are split up to this level, 0 to 20 (default 7). Or\n"
             "tolerance: until the volume's enclosure is at most so wide, in cubic model units.\n"
             "budget: most undecided cubes of a level (default 4194304): bounds the memory.\n"
             "time_limit: in seconds; then all that is left stays undecided.\n\n"
             "Raises ValueError for both depth and tolerance, Error for models with intervals, options out of range,\n"
             "and as `verisq octree` does.");
}

}  // namespace verisq::python

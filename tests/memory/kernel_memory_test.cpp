/// The kernels' memory accesses on Oclgrind, launched here on buffers that are exact and not initialised: no access
/// beyond a buffer or an array, no read of what was never written, no data race. (On the host's buffers its search for
/// uninitialised values is of no use: Oclgrind 21.10 takes a buffer that clEnqueueFillBuffer filled for one that nobody
/// wrote.)
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "host/device/sample_operations.hpp"
#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_triangles.hpp"

namespace verisq::device {
namespace {

using ::testing::HasSubstr;

constexpr const char* simulator = "/usr/lib/oclgrind/liboclgrind-rt-icd.so";  // Debian's package oclgrind

/// Launches on buffers of exactly the size that they need, so that oclgrind sees the first access beyond; what kernels
/// are to write is not initialised.
class KernelRun {
 public:
  KernelRun(const cl::Context& context, const cl::Device& device, const cl::Program& program, int width)
      : queries_(groups * static_cast<std::size_t>(width)),
        context_(context),
        queue_(context, device),
        program_(program) {
    std::vector<PrimitiveParameters> parameters;
    for (const Primitive& primitive : model.primitives)
      parameters.push_back(primitive_parameters(primitive, scale_exponent(model)));
    primitives_ = cl::Buffer(context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                             parameters.size() * sizeof(PrimitiveParameters), parameters.data());
  }

  /// A map of points, as host/device/query_batches.cpp has it made.
  void map() {
    const auto coordinates = point_columns();
    const Distances distances = distances_of(coordinates, primitives_);
    const auto of_union = outputs<5>(queries_);  // ends and escape
    launch("union_distance", cl_ulong{groups}, cl_ulong{queries_}, coordinates, primitives_, count,
           distances.of_primitives, of_union);
    rows_of(coordinates, {of_union[0], of_union[1]});
    queue_.finish();
  }

  /// Distances of points to tapered primitives: the first kernels of a map, in the program of those.
  void tapered_points() {
    const auto coordinates = point_columns();
    const cl::Buffer parameters = tapered_primitives();
    const Distances distances = distances_of(coordinates, parameters);
    queue_.finish();
  }

  /// Points on their way from the caller's memory, as host/device/point_pipe.cpp has them read: one fewer than fill
  /// the vectors.
  void columns() {
    const cl_ulong size = queries_ - 1;
    const cl_ulong stride = 3;
    const cl::Buffer memory = written(std::vector<double>(3 * size, 0.5));
    const std::vector<cl_uint> none{0};
    const cl::Buffer refused(context_, CL_MEM_READ_WRITE, sizeof(cl_uint));
    queue_.enqueueWriteBuffer(refused, CL_TRUE, 0, sizeof(cl_uint), none.data());
    const auto coordinates = outputs<3>(queries_);
    launch("point_columns", size, cl_uint{2}, 0.25, memory, memory, memory, cl_ulong{0}, cl_ulong{1}, cl_ulong{2},
           stride, stride, stride, coordinates, refused);
    queue_.finish();
  }

  /// A map in one step, as host/device/point_pipe.cpp has it made.
  void map_at_once() {
    constexpr std::size_t row_bytes = 24;
    constexpr std::size_t sums_bytes = 48;
    const cl_ulong size = queries_ - 1;
    const cl_ulong point_stride = 3;
    const cl_ulong stride = row_bytes / sizeof(double);
    const cl::Buffer points = written(std::vector<double>(3 * size, 0.7));
    const std::vector<cl_uint> none{0};
    const cl::Buffer refused(context_, CL_MEM_READ_WRITE, sizeof(cl_uint));
    queue_.enqueueWriteBuffer(refused, CL_TRUE, 0, sizeof(cl_uint), none.data());
    const cl::Buffer memory(context_, CL_MEM_READ_WRITE, row_bytes * size);
    const cl::Buffer sums(context_, CL_MEM_READ_WRITE, sums_bytes * work_items / work_group);
    launch("point_map", size, cl_uint{1}, 0.25, 4.0, tolerance, 1e-9, 1e-12, 1.0, primitives_, points, points, points,
           cl_ulong{0}, cl_ulong{1}, cl_ulong{2}, point_stride, point_stride, point_stride, memory, memory, memory,
           cl_ulong{0}, cl_ulong{1}, cl_ulong{2 * sizeof(double)}, stride, stride, cl_ulong{row_bytes}, refused, sums,
           cl::Local(work_group * sums_bytes));
    queue_.finish();
  }

  /// A map of triangles, as host/device/query_batches.cpp has it made.
  void triangles() {
    const cl::Buffer corners = written(triangle_numbers());
    const cl::Buffer nearest = numbers(queries_);
    const auto of_primitives = outputs<7>(queries_ * model.primitives.size());
    for (cl_uint index = 0; index < model.primitives.size(); ++index)
      launch("triangle_distance", cl_ulong{groups}, cl_ulong{queries_}, corners, primitives_, index, nearest,
             views(of_primitives, index));
    launch("triangle_union_distance", cl_ulong{groups}, cl_ulong{queries_}, count, of_primitives[0], of_primitives[1],
           outputs<2>(queries_));
    queue_.finish();
  }

  /// The distances of the model's first primitive to the others in many poses, as host/device/query_batches.cpp has
  /// them computed.
  void pairs() {
    const cl::Buffer poses = written(pose_numbers());
    const auto ends = outputs<2>(queries_);
    for (cl_uint b = 1; b < count; ++b)
      launch("pair_distance", cl_ulong{groups}, cl_ulong{queries_}, poses, primitives_, cl_uint{0}, b,
             cl_uint{b == 1 ? 1U : 0U}, ends);
    queue_.finish();
  }

  /// A combined solid, as host/device/solid_batch.cpp has it mapped; those that are not bent are bent by nothing.
  void solids() {
    const auto coordinates = point_columns();
    const cl::Buffer parameters = box_primitives();
    const std::size_t primitives = solid_model().primitives.size();
    const cl::Buffer listed(context_, CL_MEM_READ_WRITE, queries_ * sizeof(cl_uint));
    const auto of_primitives = outputs<5>(queries_ * primitives);
    for (cl_uint index = 0; index < primitives; ++index)
      launch("bent_distance", cl_ulong{groups}, groups_per_block, coordinates, parameters, index, listed,
             views(of_primitives, index));
    const auto ends = outputs<2>(queries_);
    const auto edges = outputs<5>(queries_);  // other terms, numbers, feet
    const auto centres = outputs<3>(queries_ * primitives);
    const auto wanted_balls = outputs<1>(queries_ * primitives);
    launch("set_feet", cl_ulong{groups}, cl_ulong{queries_}, coordinates, parameters, tolerance, of_primitives, ends,
           edges, centres, wanted_balls);
    const cl::Buffer ball_his = written(std::vector<double>(queries_ * primitives, -0.1));
    launch("set_bounds", cl_ulong{groups}, cl_ulong{queries_}, coordinates, parameters, edges, centres, ball_his, ends);
    const std::array<double, 4> root{0.0, 0.0, 0.0, 4.0};  // centre and half-width
    launch("solid_distance", cl_ulong{searches}, cl_ulong{queries_}, coordinates, parameters, root[0], root[1], root[2],
           root[3], tolerance, rounds, of_primitives, ends);
    queue_.finish();
  }

  /// The objective of a fit for some candidates and the distances of the first, as host/plan/pose_objective.cpp has
  /// them computed.
  void pose_objective() {
    const auto coordinates = point_columns();
    const cl::Buffer weights = written(std::vector<double>(queries_, 0.5));
    const cl::Buffer pivots = written(std::vector<double>(std::size_t{3} * candidates, 0.25));
    const cl::Buffer parameters = scaled_primitives();
    const cl::Buffer partials = numbers(std::size_t{candidates} * slices * columns_of_candidate);
    launch("pose_objective", candidates, slices, cl_uint{groups}, coordinates, weights, parameters, count, pivots, 0.1,
           0.5, 0.01, 0.02, partials);
    const cl::Buffer sums = numbers(std::size_t{candidates} * blocks * columns_of_candidate);
    launch("sum_slices", candidates, slices, columns_of_candidate, slices_of_block, partials, sums);
    launch("sum_slices", candidates, blocks, columns_of_candidate, slices_of_block, sums, partials);
    launch("pose_distance", cl_uint{groups}, cl_ulong{queries_}, coordinates, parameters, count, numbers(8 * queries_));
    queue_.finish();
  }

  /// A bent solid minus another, united with what that has in common with a third: edges of intersections, and of what
  /// is cut away.
  [[nodiscard]] static Model solid_model() {
    const auto node = [](SetOperation operation, std::uint32_t first, std::uint32_t second) {
      SetExpression made{{}, operation, 0};
      for (const std::uint32_t i : {first, second}) made.operands.push_back({{}, SetOperation::unite, i});
      return made;
    };
    SetExpression tree{{}, SetOperation::unite, 0};
    tree.operands = {node(SetOperation::subtract, 0, 1), node(SetOperation::intersect, 1, 2)};
    Model all{"", model.primitives, tree};
    all.primitives[0].bend = Bend{0.3, 20.0};
    all.primitives[0].superquadric.exponents = {1.0, 0.8};  // depths are bounded up to 1
    all.primitives[2].pose.translation = {1.2, 0.3, 0.0};
    return all;
  }

 private:
  static constexpr std::size_t searches = 5;
  static constexpr cl_uint candidates = 2;
  static constexpr cl_uint slices = 3;
  static constexpr cl_uint slices_of_block = 2;
  static constexpr cl_uint blocks = 2;
  static constexpr cl_uint columns_of_candidate = 18;  // 9 and three a primitive
  static constexpr cl_uint rounds = 6;                 // each takes a simulator tens of milliseconds
  static constexpr std::size_t groups = 13;
  static constexpr cl_uint groups_per_block = 4;
  static constexpr std::size_t work_items = 80;  // more than there is work: some have nothing to do
  static constexpr std::size_t work_group = 8;
  static constexpr std::size_t scratch_per_point = 12;  // SCRATCH_SIZE in kernels/interior_depth.cl
  static constexpr double tolerance = 1e-3;

  // The last is far away: triangles pass it over.
  inline static const Model model{"",
                                  {{"one", {{1.0, 1.5, 0.6}, {1.0, 1.2}}, {}},
                                   {"other", {{0.4, 1.0, 1.2}, {0.5, 1.8}}, {{1.0, 0.0, 0.0}, {1.0, 1.0, 1.0, 1.0}}},
                                   {"far", {{0.4, 0.5, 0.6}, {1.0, 1.0}}, {{0.0, 90.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}}}};
  static constexpr cl_uint count = 3;

  [[nodiscard]] cl::Buffer numbers(std::size_t size) const {
    return {context_, CL_MEM_READ_WRITE, size * sizeof(double)};
  }

  template <std::size_t columns>
  [[nodiscard]] std::array<cl::Buffer, columns> outputs(std::size_t size) const {
    std::array<cl::Buffer, columns> all;
    for (cl::Buffer& column : all) column = numbers(size);
    return all;
  }

  // Of one primitive.
  template <std::size_t columns>
  [[nodiscard]] std::array<cl::Buffer, columns> views(std::array<cl::Buffer, columns> all, std::size_t index) const {
    const cl_buffer_region region{index * queries_ * sizeof(double), queries_ * sizeof(double)};
    for (cl::Buffer& column : all)
      column = column.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region);
    return all;
  }

  [[nodiscard]] cl::Buffer written(const std::vector<double>& values) const {
    cl::Buffer buffer = numbers(values.size());
    queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(double), values.data());
    return buffer;
  }

  /// As host/device/point_pipe.cpp has them written: as std::vector<MapResult> lies in memory.
  void rows_of(const std::array<cl::Buffer, 3>& coordinates, const std::array<cl::Buffer, 2>& ends) {
    constexpr std::size_t row_bytes = 24;
    constexpr std::size_t sums_bytes = 48;
    const cl_ulong size = queries_ - 1;
    const cl_ulong stride = row_bytes / sizeof(double);
    const cl::Buffer memory(context_, CL_MEM_READ_WRITE, row_bytes * size);
    const cl::Buffer sums(context_, CL_MEM_READ_WRITE, sums_bytes * work_items / work_group);
    launch("point_rows", size, cl_uint{1}, 0.25, 4.0, tolerance, 1e-9, 1e-12, 1.0, coordinates, ends, memory, memory,
           memory, cl_ulong{0}, cl_ulong{1}, cl_ulong{2 * sizeof(double)}, stride, stride, cl_ulong{row_bytes}, sums,
           cl::Local(work_group * sums_bytes));
  }

  // Of points to each primitive, with what their kernels need besides: Oclgrind takes what later buffers hold in its
  // place for uninitialised.
  struct Distances {
    cl::Buffer nearest, listed, scratch;
    std::array<cl::Buffer, 5> of_primitives;
  };

  [[nodiscard]] Distances distances_of(const std::array<cl::Buffer, 3>& coordinates, const cl::Buffer& primitives) {
    Distances distances{numbers(queries_),
                        {context_, CL_MEM_READ_WRITE, queries_ * sizeof(cl_uint)},
                        numbers(queries_ * scratch_per_point),
                        outputs<5>(queries_ * model.primitives.size())};
    for (cl_uint index = 0; index < model.primitives.size(); ++index) {
      const auto own = views(distances.of_primitives, index);
      launch("point_distance", cl_ulong{groups}, groups_per_block, coordinates, primitives, index, distances.listed,
             distances.nearest, own);
      launch("interior_depth", cl_ulong{groups}, groups_per_block, coordinates, primitives, index, tolerance,
             distances.scratch, own);
    }
    return distances;
  }

  // Wider at either end.
  [[nodiscard]] cl::Buffer tapered_primitives() const {
    std::vector<PrimitiveParameters> parameters;
    for (Primitive primitive : model.primitives) {
      primitive.superquadric.taper = parameters.empty() ? 4.0 : 0.3;
      parameters.push_back(primitive_parameters(primitive, scale_exponent(model)));
    }
    return {context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof(PrimitiveParameters),
            parameters.data()};
  }

  [[nodiscard]] cl::Buffer box_primitives() const {
    std::vector<BoxPrimitiveParameters> parameters;
    for (const Primitive& primitive : solid_model().primitives)
      parameters.push_back(box_primitive_parameters(primitive, scale_exponent(model)));
    return {context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof(BoxPrimitiveParameters),
            parameters.data()};
  }

  // Of the candidates, which are equal. In the unit of the model: the kernel's scaling is no matter of memory.
  [[nodiscard]] cl::Buffer scaled_primitives() const {
    struct ScaledPrimitive {
      PrimitiveParameters parameters;
      double unit;
    };
    std::vector<ScaledPrimitive> all;
    for (cl_uint n = 0; n < candidates; ++n)
      for (const Primitive& primitive : model.primitives) all.push_back({primitive_parameters(primitive, 0), 1.0});
    return {context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, all.size() * sizeof(ScaledPrimitive), all.data()};
  }

  // On all sides of the surfaces of the first two.
  [[nodiscard]] std::array<cl::Buffer, 3> point_columns() const {
    oracle::RandomCases random(1);
    std::array<std::vector<double>, 3> columns;
    for (std::size_t i = 0; i < queries_; ++i) {
      const Point point = random.point(model.primitives[i % 2]).point;
      for (std::size_t k = 0; k < 3; ++k) columns[k].push_back(point[k]);
    }
    return {written(columns[0]), written(columns[1]), written(columns[2])};
  }

  [[nodiscard]] std::vector<double> triangle_numbers() const {
    oracle::RandomCases random(1);
    std::vector<double> columns(9 * queries_);
    for (std::size_t i = 0; i < queries_; ++i) {
      const Triangle triangle = oracle::random_triangle(random, model.primitives[i % 2]).triangle;
      for (std::size_t c = 0; c < 9; ++c) columns[c * queries_ + i] = triangle[c / 3][c % 3];
    }
    return columns;
  }

  [[nodiscard]] std::vector<double> pose_numbers() const {
    oracle::RandomCases random(1);
    std::vector<double> columns(12 * queries_);
    for (std::size_t i = 0; i < queries_; ++i) {
      std::array<double, 4> quaternion;
      for (double& component : quaternion) component = random.uniform(-1.0, 1.0);
      const std::array<double, 9> rotation = rotation_matrix(quaternion);
      for (std::size_t c = 0; c < 9; ++c) columns[c * queries_ + i] = rotation[c];
      for (std::size_t c = 9; c < 12; ++c) columns[c * queries_ + i] = random.uniform(-3.0, 3.0);
    }
    return columns;
  }

  template <class... Arguments>
  void launch(const char* name, const Arguments&... arguments) {
    cl::Kernel kernel(program_, name);
    cl_uint next = 0;
    (set(kernel, next, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(work_items), cl::NDRange(work_group));
    queue_.finish();  // the kernel does not keep the buffers that it was given
  }

  template <class Argument>
  static void set(cl::Kernel& kernel, cl_uint& next, const Argument& argument) {
    kernel.setArg(next++, argument);
  }
  template <std::size_t size>
  static void set(cl::Kernel& kernel, cl_uint& next, const std::array<cl::Buffer, size>& buffers) {
    for (const cl::Buffer& buffer : buffers) kernel.setArg(next++, buffer);
  }

  std::size_t queries_;
  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Program program_;
  cl::Buffer primitives_;
};

class KernelMemoryTest : public ::testing::TestWithParam<int> {
 protected:
  // The loader of OpenCL takes oclgrind for the only device. (`oclgrind PROGRAM` would preload a loader of its own,
  // which a program that opens libOpenCL itself does not see.) To be set before the first call of OpenCL.
  void SetUp() override {
    ASSERT_TRUE(std::filesystem::exists(simulator)) << simulator << " is missing: install the Debian package oclgrind";
    set("OCL_ICD_VENDORS", simulator);
    set("OCLGRIND_LOG", log_);
    set("OCLGRIND_CHECK_API", "1");
    set("OCLGRIND_DATA_RACES", "1");
    set("OCLGRIND_UNINITIALIZED", "1");
    set("OCLGRIND_MAX_ERRORS", "1000000");  // after so many in a process it says nothing any more
  }

  static void set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }

  /// What `use(context, device, program)` makes oclgrind report.
  template <class Use>
  [[nodiscard]] std::string reported(const std::string& sources, const Use& use) const {
    std::vector<cl::Platform> platforms;
    cl::Platform::get(&platforms);
    std::vector<cl::Device> devices;
    platforms.at(0).getDevices(CL_DEVICE_TYPE_ALL, &devices);
    EXPECT_EQ(devices.at(0).getInfo<CL_DEVICE_NAME>(), "Oclgrind Simulator");
    const cl::Context context(devices[0]);
    const cl::Program program(context, sources);
    program.build({devices[0]}, fmt::format("-cl-std=CL1.2 -DINLINED -DVECTOR_WIDTH={}", GetParam()).c_str());
    use(context, devices[0], program);
    return folder_.contents("oclgrind.log");
  }

  /// The triangle kernels with calls: inlining them leaves an intrinsic (llvm.experimental.noalias.scope.decl) that
  /// Oclgrind 21.10 does not know.
  static std::string triangle_sources() {
    return broken(kernels::embedded_triangle_sources(), "static __attribute__((always_inline))",
                  "static __attribute__((noinline))");
  }

  /// Likewise.
  static std::string pose_objective_sources() {
    return broken(kernels::embedded_pose_objective_sources(), "static __attribute__((always_inline))",
                  "static __attribute__((noinline))");
  }

  /// Likewise.
  static std::string solid_sources() {
    return broken(solid_source(KernelRun::solid_model()), "static __attribute__((always_inline))",
                  "static __attribute__((noinline))");
  }

  /// Of one of the runs above.
  [[nodiscard]] std::string reported_of(void (KernelRun::*run)(), std::string_view sources) const {
    return reported(std::string(sources),
                    [run](const cl::Context& context, const cl::Device& device, const cl::Program& program) {
                      (KernelRun(context, device, program, GetParam()).*run)();
                    });
  }

  /// The kernels with one text replaced.
  static std::string broken(std::string_view kernels, std::string_view text, std::string_view replacement) {
    std::string sources(kernels);
    const std::size_t at = sources.find(text);
    EXPECT_NE(at, std::string::npos) << "the kernels no longer contain " << text;
    return sources.replace(at, text.size(), replacement);
  }

  const testing::TemporaryFolder folder_;
  const std::string log_ = folder_ / "oclgrind.log";
};

TEST_P(KernelMemoryTest, FindsNothingInAMap) {
  EXPECT_EQ(reported_of(&KernelRun::map, kernels::embedded_point_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInDistancesToTaperedPrimitives) {
  EXPECT_EQ(reported_of(&KernelRun::tapered_points, kernels::embedded_tapered_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInColumnsOfPoints) {
  EXPECT_EQ(reported_of(&KernelRun::columns, kernels::embedded_point_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInAMapInOneStep) {
  EXPECT_EQ(reported_of(&KernelRun::map_at_once, kernels::embedded_point_map()), "");
}

TEST_P(KernelMemoryTest, FindsARowOfOneStepBeyondTheEnd) {
  EXPECT_THAT(
      reported_of(&KernelRun::map_at_once, broken(kernels::embedded_point_map(), "if (first >= size) break;", "")),
      HasSubstr("Invalid"));
}

TEST_P(KernelMemoryTest, FindsARowBeyondTheEnd) {
  constexpr std::string_view guard = "if (first >= size) break;\n    const vector3 point";
  EXPECT_THAT(reported_of(&KernelRun::map, broken(kernels::embedded_point_sources(), guard, "const vector3 point")),
              HasSubstr("Invalid write"));
}

TEST_P(KernelMemoryTest, FindsNothingInAMapOfTriangles) {
  EXPECT_EQ(reported_of(&KernelRun::triangles, triangle_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInPairs) {
  EXPECT_EQ(reported_of(&KernelRun::pairs, kernels::embedded_pair_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInAMapOfSolids) {
  EXPECT_EQ(reported_of(&KernelRun::solids, solid_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInTheObjectiveOfAFit) {
  EXPECT_EQ(reported_of(&KernelRun::pose_objective, pose_objective_sources()), "");
}

TEST_P(KernelMemoryTest, FindsNothingInTheSelfTest) {
  const auto use = [](const cl::Context& context, const cl::Device& device, const cl::Program& program) {
    EXPECT_EQ(self_test(context, device, program, GetParam()), "");
  };
  EXPECT_EQ(reported(self_test_sources(), use), "");
}

// What the silence above rests on: oclgrind speaks where something is wrong.

TEST_P(KernelMemoryTest, FindsAnAccessBeyondTheBuffers) {
  const auto unguarded = [](std::string_view kernels, std::string_view next) {
    const std::string guard = "if (group >= groups) return;\n  ";
    return broken(kernels, guard + std::string(next), next);
  };
  EXPECT_THAT(
      reported_of(&KernelRun::map, broken(kernels::embedded_point_sources(), "min(first + groups_per_block, groups)",
                                          "min(first + groups_per_block, groups + 1)")),
      HasSubstr("Invalid read"));
  EXPECT_THAT(reported_of(&KernelRun::triangles, unguarded(triangle_sources(), "MODEL_SPACE const superquadric* s")),
              HasSubstr("Invalid read"));
  EXPECT_THAT(reported_of(&KernelRun::pairs,
                          unguarded(kernels::embedded_pair_sources(), "MODEL_SPACE const superquadric* solid_a")),
              HasSubstr("Invalid read"));
  EXPECT_THAT(reported_of(&KernelRun::solids, broken(solid_sources(), "min(first + groups_per_block, groups) - first",
                                                     "min(first + groups_per_block, groups + 1) - first")),
              HasSubstr("Invalid read"));
  EXPECT_THAT(
      reported_of(&KernelRun::solids, broken(solid_sources(), "if (index >= count || his[index]", "if (his[index]")),
      HasSubstr("Invalid read"));
}

TEST_P(KernelMemoryTest, FindsAnAccessBeyondTheBuffersOfTaperedPrimitives) {
  EXPECT_THAT(reported_of(&KernelRun::tapered_points,
                          broken(kernels::embedded_tapered_sources(), "min(first + groups_per_block, groups)",
                                 "min(first + groups_per_block, groups + 1)")),
              HasSubstr("Invalid read"));
}

// Tests of their own: oclgrind falls silent after 1000 errors of a process.
TEST_P(KernelMemoryTest, FindsAnAccessBeyondTheBuffersOfEdges) {
  constexpr std::string_view next = "const real edge = LOAD(group, edges);";
  const std::string guard = "if (group >= groups) return;\n  ";
  EXPECT_THAT(reported_of(&KernelRun::solids, broken(solid_sources(), guard + std::string(next), next)),
              HasSubstr("Invalid read"));
}

TEST_P(KernelMemoryTest, FindsAnEdgeOfNoPrimitive) {
  EXPECT_THAT(reported_of(&KernelRun::solids,
                          broken(solid_sources(), "MASK(term.literal >= 0) & MASK(open >= 0)", "MASK(open >= 0)")),
              HasSubstr("Invalid read"));
}

TEST_P(KernelMemoryTest, FindsAnAccessBeyondTheBuffersOfTheObjective) {
  EXPECT_THAT(reported_of(&KernelRun::pose_objective,
                          broken(pose_objective_sources(), "if (item >= (ulong)candidates * slices) return;\n", "")),
              HasSubstr("Invalid read"));
}

TEST_P(KernelMemoryTest, FindsAReadOfWhatWasNotWritten) {
  EXPECT_THAT(reported_of(&KernelRun::map,
                          broken(kernels::embedded_point_sources(), "  STORE(known.hi, group, columns.his);\n", "")),
              HasSubstr("ninitialized"));
  EXPECT_THAT(
      reported_of(&KernelRun::triangles, broken(triangle_sources(), "    STORE(REAL(INFINITY), group, his);\n", "")),
      HasSubstr("ninitialized"));
  EXPECT_THAT(reported_of(&KernelRun::pairs,
                          broken(kernels::embedded_pair_sources(), "STORE(fmin(known_lo, lo), group, los);", "")),
              HasSubstr("ninitialized"));
  EXPECT_THAT(
      reported_of(&KernelRun::solids, broken(solid_sources(), "  STORE(REAL(INFINITY), group, columns.his);\n", "")),
      HasSubstr("ninitialized"));
  EXPECT_THAT(
      reported_of(&KernelRun::solids, broken(solid_sources(), "  STORE(REAL(NO_EDGE), group, out.edges);\n", "")),
      HasSubstr("ninitialized"));
  EXPECT_THAT(reported_of(&KernelRun::pose_objective,
                          broken(pose_objective_sources(), "  sums[BOUND] = sum_of_lanes(bound);\n", "")),
              HasSubstr("ninitialized"));
}

TEST_P(KernelMemoryTest, FindsADataRace) {
  EXPECT_THAT(reported_of(&KernelRun::map, broken(kernels::embedded_point_sources(), "STORE(hi, group, union_his)",
                                                  "STORE(hi, 0, union_his)")),
              HasSubstr("data race"));
}

INSTANTIATE_TEST_SUITE_P(Widths, KernelMemoryTest, ::testing::Values(1, 4),
                         [](const auto& test) { return fmt::format("Width{}", test.param); });

}  // namespace
}  // namespace verisq::device

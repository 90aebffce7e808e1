/// Defines the OpenCL functions that the C++ bindings call; each hands its arguments to the function of the same name
/// in the machine's OpenCL library, which is opened at the first call.
///
/// An application that links this library and OpenCL itself gets one definition of each name: ours or OpenCL's, as its
/// linker finds them. Both end in OpenCL's, because dlsym searches the opened library and not the program. The names
/// are hidden, so that no shared library, an OpenCL driver least of all, is bound to ours.
#include "host/opencl/opencl_library.hpp"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>
#include <dlfcn.h>

#include <tuple>
#include <type_traits>

namespace verisq::device {
namespace {

/// Never closed: drivers keep threads of their own, which may outlive every object of the program.
struct Library {
  void* handle;  ///< null when there is none
  std::string failure;
};

Library open_library() {
  std::string failure;
  for (const char* name : {"libOpenCL.so.1", "libOpenCL.so"}) {
    if (void* const handle = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return {handle, {}};
    if (failure.empty()) failure = dlerror();
  }
  return {nullptr, failure};
}

const Library& library() {
  static const Library opened = open_library();
  return opened;
}

/// What a function reports when the library or the function is missing; as its result or, where that is an object,
/// through its last argument. It is what OpenCL's own loader says on a machine without drivers.
template <typename Result, typename... Arguments>
Result not_found(Arguments... arguments) {
  if constexpr (std::is_same_v<Result, cl_int>) {
    return CL_PLATFORM_NOT_FOUND_KHR;
  } else {
    cl_int* const error = std::get<sizeof...(arguments) - 1>(std::tuple(arguments...));
    if (error != nullptr) *error = CL_PLATFORM_NOT_FOUND_KHR;
    return nullptr;
  }
}

/// `own` is our function of that name: it tells the type, and makes one static pointer a function.
template <auto own, typename... Arguments>
auto forward(const char* name, Arguments... arguments) {
  static const auto function =
      library().handle == nullptr ? nullptr : reinterpret_cast<decltype(own)>(dlsym(library().handle, name));
  if (function == nullptr) return not_found<std::invoke_result_t<decltype(own), Arguments...>>(arguments...);
  return function(arguments...);
}

}  // namespace

std::string missing_opencl_library() {
  return library().failure;
}

}  // namespace verisq::device

using verisq::device::forward;

// Signatures of CL/cl.h (whose CL_API_ENTRY and CL_API_CALL are empty where there is dlopen). The compiler compares
// them, because functions with C linkage cannot be overloaded.
#pragma GCC visibility push(hidden)

cl_int clGetPlatformIDs(cl_uint capacity, cl_platform_id* platforms, cl_uint* count) {
  return forward<clGetPlatformIDs>(__func__, capacity, platforms, count);
}
cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info key, size_t capacity, void* value, size_t* size) {
  return forward<clGetPlatformInfo>(__func__, platform, key, capacity, value, size);
}

cl_int clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint capacity, cl_device_id* devices,
                      cl_uint* count) {
  return forward<clGetDeviceIDs>(__func__, platform, type, capacity, devices, count);
}
cl_int clGetDeviceInfo(cl_device_id device, cl_device_info key, size_t capacity, void* value, size_t* size) {
  return forward<clGetDeviceInfo>(__func__, device, key, capacity, value, size);
}
cl_int clRetainDevice(cl_device_id device) {
  return forward<clRetainDevice>(__func__, device);
}
cl_int clReleaseDevice(cl_device_id device) {
  return forward<clReleaseDevice>(__func__, device);
}

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* devices,
                           void (*notify)(const char*, const void*, size_t, void*), void* user, cl_int* error) {
  return forward<clCreateContext>(__func__, properties, count, devices, notify, user, error);
}
cl_int clRetainContext(cl_context context) {
  return forward<clRetainContext>(__func__, context);
}
cl_int clReleaseContext(cl_context context) {
  return forward<clReleaseContext>(__func__, context);
}

cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device, cl_command_queue_properties properties,
                                      cl_int* error) {
  return forward<clCreateCommandQueue>(__func__, context, device, properties, error);
}
cl_int clFlush(cl_command_queue queue) {
  return forward<clFlush>(__func__, queue);
}
cl_int clFinish(cl_command_queue queue) {
  return forward<clFinish>(__func__, queue);
}
cl_int clRetainCommandQueue(cl_command_queue queue) {
  return forward<clRetainCommandQueue>(__func__, queue);
}
cl_int clReleaseCommandQueue(cl_command_queue queue) {
  return forward<clReleaseCommandQueue>(__func__, queue);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
  return forward<clCreateBuffer>(__func__, context, flags, size, host, error);
}
cl_mem clCreateSubBuffer(cl_mem buffer, cl_mem_flags flags, cl_buffer_create_type type, const void* info,
                         cl_int* error) {
  return forward<clCreateSubBuffer>(__func__, buffer, flags, type, info, error);
}
cl_int clRetainMemObject(cl_mem object) {
  return forward<clRetainMemObject>(__func__, object);
}
cl_int clReleaseMemObject(cl_mem object) {
  return forward<clReleaseMemObject>(__func__, object);
}

cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** texts, const size_t* sizes,
                                     cl_int* error) {
  return forward<clCreateProgramWithSource>(__func__, context, count, texts, sizes, error);
}
cl_program clCreateProgramWithBinary(cl_context context, cl_uint count, const cl_device_id* devices,
                                     const size_t* sizes, const unsigned char** binaries, cl_int* errors,
                                     cl_int* error) {
  return forward<clCreateProgramWithBinary>(__func__, context, count, devices, sizes, binaries, errors, error);
}
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void (*notify)(cl_program, void*), void* user) {
  return forward<clBuildProgram>(__func__, program, count, devices, options, notify, user);
}
cl_int clGetProgramInfo(cl_program program, cl_program_info key, size_t capacity, void* value, size_t* size) {
  return forward<clGetProgramInfo>(__func__, program, key, capacity, value, size);
}
cl_int clGetProgramBuildInfo(cl_program program, cl_device_id device, cl_program_build_info key, size_t capacity,
                             void* value, size_t* size) {
  return forward<clGetProgramBuildInfo>(__func__, program, device, key, capacity, value, size);
}
cl_int clRetainProgram(cl_program program) {
  return forward<clRetainProgram>(__func__, program);
}
cl_int clReleaseProgram(cl_program program) {
  return forward<clReleaseProgram>(__func__, program);
}

cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* error) {
  return forward<clCreateKernel>(__func__, program, name, error);
}
cl_int clGetKernelInfo(cl_kernel kernel, cl_kernel_info key, size_t capacity, void* value, size_t* size) {
  return forward<clGetKernelInfo>(__func__, kernel, key, capacity, value, size);
}
cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value) {
  return forward<clSetKernelArg>(__func__, kernel, index, size, value);
}
cl_int clRetainKernel(cl_kernel kernel) {
  return forward<clRetainKernel>(__func__, kernel);
}
cl_int clReleaseKernel(cl_kernel kernel) {
  return forward<clReleaseKernel>(__func__, kernel);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                           void* target, cl_uint count, const cl_event* awaited, cl_event* event) {
  return forward<clEnqueueReadBuffer>(__func__, queue, buffer, blocking, offset, size, target, count, awaited, event);
}
cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                            const void* source, cl_uint count, const cl_event* awaited, cl_event* event) {
  return forward<clEnqueueWriteBuffer>(__func__, queue, buffer, blocking, offset, size, source, count, awaited, event);
}
cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t pattern_size,
                           size_t offset, size_t size, cl_uint count, const cl_event* awaited, cl_event* event) {
  return forward<clEnqueueFillBuffer>(__func__, queue, buffer, pattern, pattern_size, offset, size, count, awaited,
                                      event);
}
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                              const size_t* size, const size_t* group_size, cl_uint count, const cl_event* awaited,
                              cl_event* event) {
  return forward<clEnqueueNDRangeKernel>(__func__, queue, kernel, dimensions, offset, size, group_size, count, awaited,
                                         event);
}

cl_int clGetEventProfilingInfo(cl_event event, cl_profiling_info key, size_t capacity, void* value, size_t* size) {
  return forward<clGetEventProfilingInfo>(__func__, event, key, capacity, value, size);
}
cl_int clRetainEvent(cl_event event) {
  return forward<clRetainEvent>(__func__, event);
}
cl_int clReleaseEvent(cl_event event) {
  return forward<clReleaseEvent>(__func__, event);
}

#pragma GCC visibility pop

/// Defines the OpenCL functions that the C++ bindings call; each hands its arguments to the function of the same name
/// in the machine's OpenCL library, which is opened at the first call.
///
/// An application that links this library and OpenCL itself gets one definition of each name: ours or OpenCL's, as its
/// linker finds them. Both end in OpenCL's, because dlsym searches the opened library and not the program. The names
/// are hidden, so that no shared library, an OpenCL driver least of all, is bound to ours.
#include "host/device/opencl_library.hpp"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>
#include <dlfcn.h>

#include <atomic>
#include <tuple>
#include <type_traits>

namespace verisq::device {
namespace {

/// Never closed: drivers keep threads of their own, which may outlive every object of the program.
struct Library {
  void* handle;  ///< null when there is none
  std::string failure;
};

// OpenCL's functions have no argument that could carry it.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): for that reason
std::atomic<void (*)()> context_hook{nullptr};

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

/// The error that a function reports if the library or the function is missing: as its result or, if that is an object,
/// through its last argument. OpenCL's own loader reports the same on a machine without drivers.
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

/// `own` is our function of that name: it determines the type, and gives each function its own static pointer.
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

void before_each_context(void (*hook)()) {
  context_hook = hook;
}

}  // namespace verisq::device

using verisq::device::forward;

// Signatures and names of CL/cl.h (whose CL_API_ENTRY and CL_API_CALL are empty where there is dlopen). The compiler
// compares them, because functions with C linkage cannot be overloaded.
#pragma GCC visibility push(hidden)

cl_int clGetPlatformIDs(cl_uint num_entries, cl_platform_id* platforms, cl_uint* num_platforms) {
  return forward<clGetPlatformIDs>(__func__, num_entries, platforms, num_platforms);
}
cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info param_name, size_t param_value_size,
                         void* param_value, size_t* param_value_size_ret) {
  return forward<clGetPlatformInfo>(__func__, platform, param_name, param_value_size, param_value,
                                    param_value_size_ret);
}

cl_int clGetDeviceIDs(cl_platform_id platform, cl_device_type device_type, cl_uint num_entries, cl_device_id* devices,
                      cl_uint* num_devices) {
  return forward<clGetDeviceIDs>(__func__, platform, device_type, num_entries, devices, num_devices);
}
cl_int clGetDeviceInfo(cl_device_id device, cl_device_info param_name, size_t param_value_size, void* param_value,
                       size_t* param_value_size_ret) {
  return forward<clGetDeviceInfo>(__func__, device, param_name, param_value_size, param_value, param_value_size_ret);
}
cl_int clRetainDevice(cl_device_id device) {
  return forward<clRetainDevice>(__func__, device);
}
cl_int clReleaseDevice(cl_device_id device) {
  return forward<clReleaseDevice>(__func__, device);
}

cl_context clCreateContext(const cl_context_properties* properties, cl_uint num_devices, const cl_device_id* devices,
                           void (*pfn_notify)(const char*, const void*, size_t, void*), void* user_data,
                           cl_int* errcode_ret) {
  if (const auto hook = verisq::device::context_hook.load()) hook();
  return forward<clCreateContext>(__func__, properties, num_devices, devices, pfn_notify, user_data, errcode_ret);
}
cl_int clRetainContext(cl_context context) {
  return forward<clRetainContext>(__func__, context);
}
cl_int clReleaseContext(cl_context context) {
  return forward<clReleaseContext>(__func__, context);
}

cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device, cl_command_queue_properties properties,
                                      cl_int* errcode_ret) {
  return forward<clCreateCommandQueue>(__func__, context, device, properties, errcode_ret);
}
cl_int clFlush(cl_command_queue command_queue) {
  return forward<clFlush>(__func__, command_queue);
}
cl_int clFinish(cl_command_queue command_queue) {
  return forward<clFinish>(__func__, command_queue);
}
cl_int clRetainCommandQueue(cl_command_queue command_queue) {
  return forward<clRetainCommandQueue>(__func__, command_queue);
}
cl_int clReleaseCommandQueue(cl_command_queue command_queue) {
  return forward<clReleaseCommandQueue>(__func__, command_queue);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host_ptr, cl_int* errcode_ret) {
  return forward<clCreateBuffer>(__func__, context, flags, size, host_ptr, errcode_ret);
}
cl_mem clCreateSubBuffer(cl_mem buffer, cl_mem_flags flags, cl_buffer_create_type buffer_create_type,
                         const void* buffer_create_info, cl_int* errcode_ret) {
  return forward<clCreateSubBuffer>(__func__, buffer, flags, buffer_create_type, buffer_create_info, errcode_ret);
}
cl_int clRetainMemObject(cl_mem memobj) {
  return forward<clRetainMemObject>(__func__, memobj);
}
cl_int clReleaseMemObject(cl_mem memobj) {
  return forward<clReleaseMemObject>(__func__, memobj);
}

cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** strings, const size_t* lengths,
                                     cl_int* errcode_ret) {
  return forward<clCreateProgramWithSource>(__func__, context, count, strings, lengths, errcode_ret);
}
cl_program clCreateProgramWithBinary(cl_context context, cl_uint num_devices, const cl_device_id* device_list,
                                     const size_t* lengths, const unsigned char** binaries, cl_int* binary_status,
                                     cl_int* errcode_ret) {
  return forward<clCreateProgramWithBinary>(__func__, context, num_devices, device_list, lengths, binaries,
                                            binary_status, errcode_ret);
}
cl_int clBuildProgram(cl_program program, cl_uint num_devices, const cl_device_id* device_list, const char* options,
                      void (*pfn_notify)(cl_program, void*), void* user_data) {
  return forward<clBuildProgram>(__func__, program, num_devices, device_list, options, pfn_notify, user_data);
}
cl_int clGetProgramInfo(cl_program program, cl_program_info param_name, size_t param_value_size, void* param_value,
                        size_t* param_value_size_ret) {
  return forward<clGetProgramInfo>(__func__, program, param_name, param_value_size, param_value, param_value_size_ret);
}
cl_int clGetProgramBuildInfo(cl_program program, cl_device_id device, cl_program_build_info param_name,
                             size_t param_value_size, void* param_value, size_t* param_value_size_ret) {
  return forward<clGetProgramBuildInfo>(__func__, program, device, param_name, param_value_size, param_value,
                                        param_value_size_ret);
}
cl_int clRetainProgram(cl_program program) {
  return forward<clRetainProgram>(__func__, program);
}
cl_int clReleaseProgram(cl_program program) {
  return forward<clReleaseProgram>(__func__, program);
}

cl_kernel clCreateKernel(cl_program program, const char* kernel_name, cl_int* errcode_ret) {
  return forward<clCreateKernel>(__func__, program, kernel_name, errcode_ret);
}
cl_int clGetKernelInfo(cl_kernel kernel, cl_kernel_info param_name, size_t param_value_size, void* param_value,
                       size_t* param_value_size_ret) {
  return forward<clGetKernelInfo>(__func__, kernel, param_name, param_value_size, param_value, param_value_size_ret);
}
cl_int clSetKernelArg(cl_kernel kernel, cl_uint arg_index, size_t arg_size, const void* arg_value) {
  return forward<clSetKernelArg>(__func__, kernel, arg_index, arg_size, arg_value);
}
cl_int clRetainKernel(cl_kernel kernel) {
  return forward<clRetainKernel>(__func__, kernel);
}
cl_int clReleaseKernel(cl_kernel kernel) {
  return forward<clReleaseKernel>(__func__, kernel);
}

cl_int clEnqueueReadBuffer(cl_command_queue command_queue, cl_mem buffer, cl_bool blocking_read, size_t offset,
                           size_t size, void* ptr, cl_uint num_events_in_wait_list, const cl_event* event_wait_list,
                           cl_event* event) {
  return forward<clEnqueueReadBuffer>(__func__, command_queue, buffer, blocking_read, offset, size, ptr,
                                      num_events_in_wait_list, event_wait_list, event);
}
cl_int clEnqueueWriteBuffer(cl_command_queue command_queue, cl_mem buffer, cl_bool blocking_write, size_t offset,
                            size_t size, const void* ptr, cl_uint num_events_in_wait_list,
                            const cl_event* event_wait_list, cl_event* event) {
  return forward<clEnqueueWriteBuffer>(__func__, command_queue, buffer, blocking_write, offset, size, ptr,
                                       num_events_in_wait_list, event_wait_list, event);
}
cl_int clEnqueueFillBuffer(cl_command_queue command_queue, cl_mem buffer, const void* pattern, size_t pattern_size,
                           size_t offset, size_t size, cl_uint num_events_in_wait_list, const cl_event* event_wait_list,
                           cl_event* event) {
  return forward<clEnqueueFillBuffer>(__func__, command_queue, buffer, pattern, pattern_size, offset, size,
                                      num_events_in_wait_list, event_wait_list, event);
}
void* clEnqueueMapBuffer(cl_command_queue command_queue, cl_mem buffer, cl_bool blocking_map, cl_map_flags map_flags,
                         size_t offset, size_t size, cl_uint num_events_in_wait_list, const cl_event* event_wait_list,
                         cl_event* event, cl_int* errcode_ret) {
  return forward<clEnqueueMapBuffer>(__func__, command_queue, buffer, blocking_map, map_flags, offset, size,
                                     num_events_in_wait_list, event_wait_list, event, errcode_ret);
}
cl_int clEnqueueUnmapMemObject(cl_command_queue command_queue, cl_mem memobj, void* mapped_ptr,
                               cl_uint num_events_in_wait_list, const cl_event* event_wait_list, cl_event* event) {
  return forward<clEnqueueUnmapMemObject>(__func__, command_queue, memobj, mapped_ptr, num_events_in_wait_list,
                                          event_wait_list, event);
}
cl_int clEnqueueNDRangeKernel(cl_command_queue command_queue, cl_kernel kernel, cl_uint work_dim,
                              const size_t* global_work_offset, const size_t* global_work_size,
                              const size_t* local_work_size, cl_uint num_events_in_wait_list,
                              const cl_event* event_wait_list, cl_event* event) {
  return forward<clEnqueueNDRangeKernel>(__func__, command_queue, kernel, work_dim, global_work_offset,
                                         global_work_size, local_work_size, num_events_in_wait_list, event_wait_list,
                                         event);
}

cl_int clGetEventProfilingInfo(cl_event event, cl_profiling_info param_name, size_t param_value_size, void* param_value,
                               size_t* param_value_size_ret) {
  return forward<clGetEventProfilingInfo>(__func__, event, param_name, param_value_size, param_value,
                                          param_value_size_ret);
}
cl_int clRetainEvent(cl_event event) {
  return forward<clRetainEvent>(__func__, event);
}
cl_int clReleaseEvent(cl_event event) {
  return forward<clReleaseEvent>(__func__, event);
}

#pragma GCC visibility pop

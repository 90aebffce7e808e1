/// The OpenCL sources as one text, in the order of their layers; generated at build time.
#pragma once

#include <string_view>

namespace verisq::kernels {

[[nodiscard]] std::string_view embedded_sources();

}  // namespace verisq::kernels

/// The header of a `.npy` file, which describes its array (NumPy, numpy.lib.format, versions 1.0, 2.0 and 3.0).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/files/input_file.hpp"

namespace verisq {

/// The first bytes of every such file.
inline constexpr std::string_view npy_magic = "\x93NUMPY";

struct NpyHeader {
  std::string descr;  ///< the type of the elements: "<f8"
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

/// Takes the header from the front of the file. Throws Error(input) naming file, byte and value for an invalid header,
/// and for arrays whose elements have fields or are Python objects.
[[nodiscard]] NpyHeader read_npy_header(InputFile& file);

/// The header, version 1.0, of `rows` elements in a row; `descr` is a Python literal of their type. Its length depends
/// on the literal alone, so that a header can be written again when the number of rows is known.
[[nodiscard]] std::string npy_header(std::string_view descr, std::uint64_t rows);

}  // namespace verisq

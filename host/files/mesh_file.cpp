/// Picks the reader of a mesh by the extension of its file.
#include <fmt/format.h>

#include <new>
#include <verisq/error.hpp>
#include <verisq/mesh_file.hpp>

#include "host/files/mesh_formats.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

using Reader = Mesh (*)(InputFile&);

/// Null where there is none.
Reader reader_for(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".stl") return read_stl;
  if (extension == ".obj") return read_obj;
  if (extension == ".ply") return read_ply;
  if (extension == ".off") return read_off;
  return nullptr;
}

}  // namespace

bool is_mesh_name(const std::filesystem::path& path) {
  return reader_for(path) != nullptr;
}

Mesh read_mesh(const std::filesystem::path& path) {
  const Reader read = reader_for(path);
  if (read == nullptr) {
    throw Error(ErrorKind::input, fmt::format("{}: unknown mesh format {}: known are .stl, .obj, .ply, .off",
                                              path.string(), in_quotes(path.extension().string())));
  }
  InputFile file(path);
  if (file.size() == 0) file.fail_whole("not a regular file: a mesh needs a known size");
  try {
    return read(file);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failure, fmt::format("{}: not enough memory for this mesh", path.string()));
  }
}

}  // namespace verisq

/// One writer for each mesh format.
#pragma once

#include <verisq/mesh.hpp>

#include "host/files/output_file.hpp"

namespace verisq {

/// Preconditions, of all: finite coordinates, indices in range.
void write_ply(OutputFile& file, const Mesh& mesh);
void write_off(OutputFile& file, const Mesh& mesh);
void write_obj(OutputFile& file, const Mesh& mesh);

/// Precondition: each coordinate is a binary32 number.
void write_stl(OutputFile& file, const Mesh& mesh);

}  // namespace verisq

/// Whether rows of a map go where its queries, or other rows, lie.
#pragma once

#include "verisq/columns.hpp"

namespace verisq {

/// Throws Error(input) where a value of a row may share memory with a coordinate or with another value of a row: rows
/// are written while coordinates are read. Columns that interleave, like those of one record, lie apart where their
/// strides are the same. Precondition: as many rows as points.
void require_apart(const PointColumns& points, const ResultColumns& rows);

}  // namespace verisq

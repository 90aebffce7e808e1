/// The hash table behind the merging of equal STL corners.
#include "host/files/vertex_merger.hpp"

#include <bit>
#include <limits>

namespace verisq {
namespace {

// No vertex has this index: MeshBuilder stops one short of it.
constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t first_slots = 1024;

/// Steele, Lea, Flood: SplitMix64's finaliser (OOPSLA 2014), after each coordinate.
std::uint64_t hash(const Point& point) {
  std::uint64_t h = 0;
  for (const double coordinate : point) {
    h += std::bit_cast<std::uint64_t>(coordinate + 0.0) + 0x9e3779b97f4a7c15U;  // + 0.0 turns -0.0 into 0.0
    h = (h ^ (h >> 30U)) * 0xbf58476d1ce4e5b9U;
    h = (h ^ (h >> 27U)) * 0x94d049bb133111ebU;
    h ^= h >> 31U;
  }
  return h;
}

}  // namespace

VertexMerger::VertexMerger(MeshBuilder& builder) : builder_(builder), slots_(first_slots, empty) {}

/// The slot of the vertex equal to `point`, or the empty slot where it belongs (linear probing).
std::size_t VertexMerger::slot_of(const Point& point) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash(point) & mask;
  while (slots_[slot] != empty && builder_.mesh().vertices[slots_[slot]] != point) slot = (slot + 1) & mask;
  return slot;
}

std::uint32_t VertexMerger::index_of(const Point& point) {
  const std::size_t slot = slot_of(point);
  if (slots_[slot] != empty) return slots_[slot];
  const std::uint32_t index = builder_.add_vertex(point);
  slots_[slot] = index;
  if (2 * builder_.mesh().vertices.size() > slots_.size()) grow();
  return index;
}

void VertexMerger::grow() {
  slots_.assign(2 * slots_.size(), empty);
  for (std::uint32_t index = 0; index < builder_.mesh().vertices.size(); ++index) {
    slots_[slot_of(builder_.mesh().vertices[index])] = index;
  }
}

}  // namespace verisq

/// Link by link.
#include "host/files/through_links.hpp"

namespace verisq {

std::filesystem::path through_links(std::filesystem::path name) {
  while (std::filesystem::is_symlink(name)) {
    const std::filesystem::path next = std::filesystem::read_symlink(name);
    name = name.parent_path() / next;  // `next` alone where it is absolute
  }
  return name;
}

}  // namespace verisq

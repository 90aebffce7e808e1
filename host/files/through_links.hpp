/// Where an output's name leads to.
#pragma once

#include <filesystem>

namespace verisq {

/// Through all symbolic links, whether there is a file or not. Precondition: they do not lead in circles.
[[nodiscard]] std::filesystem::path through_links(std::filesystem::path name);

}  // namespace verisq

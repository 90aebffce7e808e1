/// This file implements the cache: one file a key, its first line the key itself, so that hash collisions are harmless.
#include "host/device/cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <system_error>

namespace verisq::device {
namespace {

std::optional<std::filesystem::path> cache_directory() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    return std::filesystem::path(cache) / "verisq";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "verisq";
  return std::nullopt;
}

std::optional<std::filesystem::path> file_of(std::string_view key) {
  const auto directory = cache_directory();
  if (!directory) return std::nullopt;
  return *directory / fmt::format("{:016x}", std::hash<std::string_view>{}(key));
}

std::string header(std::string_view key) {
  return fmt::format("{}\n", key.size()) + std::string(key);
}

}  // namespace

std::optional<std::string> cached(std::string_view key) {
  const auto path = file_of(key);
  if (!path) return std::nullopt;
  std::ifstream file(*path, std::ios::binary);
  if (!file) return std::nullopt;
  std::ostringstream text;
  text << file.rdbuf();
  const std::string whole = std::move(text).str();
  const std::string expected = header(key);
  if (whole.compare(0, expected.size(), expected) != 0) return std::nullopt;
  return whole.substr(expected.size());
}

void store_in_cache(std::string_view key, std::string_view content) {
  const auto path = file_of(key);
  if (!path) return;
  std::error_code ignored;
  std::filesystem::create_directories(path->parent_path(), ignored);
  // Written aside and renamed: another process never sees half a file.
  const std::filesystem::path temporary = fmt::format("{}.{}", path->string(), ::getpid());
  {
    std::ofstream file(temporary, std::ios::binary);
    file << header(key) << content;
    if (!file) {
      std::filesystem::remove(temporary, ignored);
      return;
    }
  }
  std::filesystem::rename(temporary, *path, ignored);
  if (ignored) std::filesystem::remove(temporary, ignored);
}

}  // namespace verisq::device

/// The cache of device.hpp.
#include <fmt/format.h>

#include <boost/crc.hpp>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string_view>
#include <system_error>

#include "host/device/device.hpp"

namespace verisq::device {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view being_written = ".partial";
// Files are written in less than a second: an older one was left by a process that was killed.
constexpr std::chrono::hours abandoned_after{1};

std::optional<fs::path> cache_directory() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    return fs::path(cache) / "verisq";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return fs::path(home) / ".cache" / "verisq";
  return std::nullopt;
}

std::optional<fs::path> file_of(std::string_view key) {
  const auto directory = cache_directory();
  if (!directory) return std::nullopt;
  return *directory / fmt::format("{:016x}", checksum(key));
}

std::string header(std::size_t key_length, std::size_t content_length, std::string_view key_and_content) {
  return fmt::format("verisq cache, key {} bytes, content {} bytes, CRC-64 {:016x}\n", key_length, content_length,
                     checksum(key_and_content));
}

std::string framed(std::string_view key, std::string_view content) {
  const std::string both = std::string(key).append(content);
  return header(key.size(), content.size(), both) + both;
}

// The contents of an intact file.
struct Entry {
  std::string key;
  std::string content;
};

std::optional<Entry> intact_entry(const std::string& whole) {
  const std::size_t end_of_header = whole.find('\n') + 1;  // 0 where there is none
  const std::string body = whole.substr(end_of_header);
  // The header is compared, not parsed: only the length of the key is not known otherwise.
  const std::string_view before_length = "verisq cache, key ";
  if (!whole.starts_with(before_length)) return std::nullopt;
  const std::size_t key_length = std::strtoull(whole.c_str() + before_length.size(), nullptr, 10);
  if (key_length > body.size()) return std::nullopt;
  if (whole.substr(0, end_of_header) != header(key_length, body.size() - key_length, body)) return std::nullopt;
  return Entry{body.substr(0, key_length), body.substr(key_length)};
}

// The size is that of the open file: a moment later the path may lead to another file, of another process.
std::optional<std::string> bytes_of(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_regular_file(path, failed)) return std::nullopt;  // a pipe would be waited for
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;  // another process removed it
  std::string bytes(static_cast<std::size_t>(file.tellg()), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return std::nullopt;
  return bytes;
}

// A failed write, by a full disk or a file-size limit, may only appear when the file is closed.
bool write(const fs::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  return static_cast<bool>(file);
}

// Finished files have no extension.
void remove_abandoned_files(const fs::path& directory) {
  const auto now = fs::file_time_type::clock::now();
  std::error_code failed;
  for (fs::directory_iterator entry(directory, failed), end; !failed && entry != end; entry.increment(failed)) {
    std::error_code ignored;
    const auto written = entry->last_write_time(ignored);
    if (ignored || !entry->path().has_extension() || now - written < abandoned_after) continue;
    fs::remove(entry->path(), ignored);
  }
}

}  // namespace

std::optional<std::string> cached(std::string_view key) {
  const auto path = file_of(key);
  if (!path) return std::nullopt;
  const auto whole = bytes_of(*path);
  if (!whole) return std::nullopt;
  auto entry = intact_entry(*whole);
  if (!entry) {
    std::error_code ignored;
    fs::remove(*path, ignored);
    return std::nullopt;
  }
  if (entry->key != key) return std::nullopt;
  return std::move(entry->content);
}

void store_in_cache(std::string_view key, std::string_view content) {
  const auto path = file_of(key);
  if (!path) return;
  std::error_code failed;
  fs::create_directories(path->parent_path(), failed);
  // Written aside and renamed: another process never sees half a file, nor two threads one another's.
  fs::path temporary = *path;
  temporary += fmt::format(".{:08x}{}", std::random_device{}(), being_written);
  const bool written = write(temporary, framed(key, content));
  if (written) fs::rename(temporary, *path, failed);
  if (!written || failed) fs::remove(temporary, failed);
  remove_abandoned_files(path->parent_path());
}

std::uint64_t checksum(std::string_view bytes) {
  boost::crc_optimal<64, 0x42F0E1EBA9EA3693, ~std::uint64_t{0}, ~std::uint64_t{0}, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

namespace {

// Outcomes as the cache keeps them: nothing that a damaged or empty file might say by accident.
constexpr std::string_view passed = "passed";
constexpr std::string_view failed = "failed: ";

std::optional<std::string> remembered(const std::string& key) {
  const auto outcome = cached(key);
  if (!outcome) return std::nullopt;
  if (*outcome == passed) return "";
  if (outcome->starts_with(failed)) return outcome->substr(failed.size());
  return std::nullopt;
}

}  // namespace

std::string remembered_failure(const std::string& key, const std::function<std::string()>& tried) {
  if (key.empty()) return tried();
  if (auto failure = remembered(key)) return *std::move(failure);
  std::string failure = tried();
  store_in_cache(key, failure.empty() ? std::string(passed) : std::string(failed) + failure);
  return failure;
}

}  // namespace verisq::device

#include "lab/evaluate/cache.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <vector>

#include "core/crc32.hpp"
#include "io/file.hpp"
#include "lab/evaluate/content_hash.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kLargestFile = std::size_t{64} << 20;

/// The first line of a file whose other bytes are these: tells damage.
std::string head_of(std::string_view body) {
  return fmt::format("sweepcast-result 1 {:08x}\n", crc32(std::as_bytes(std::span(body))));
}

}  // namespace

Result<ResultCache> ResultCache::open(std::filesystem::path folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return io_failure(folder, "cannot be made", error.value());
  return ResultCache(std::move(folder));
}

std::filesystem::path ResultCache::file_of(std::string_view key) const {
  return folder_ / (ContentHash().add(key).hex() + ".result");
}

ResultCache::State ResultCache::load(std::string_view key, nlohmann::ordered_json& value) const {
  value = nullptr;
  std::vector<std::byte> bytes;
  if (const Status read = read_file(file_of(key), kLargestFile, bytes); !read) {
    return read.error().code == ErrorCode::not_found ? State::absent : State::damaged;
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t line = text.find('\n');
  if (line == std::string_view::npos) return State::damaged;
  const std::string_view body = text.substr(line + 1);
  if (text.substr(0, line + 1) != head_of(body)) return State::damaged;
  const auto parsed = nlohmann::ordered_json::parse(body, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("key") || !parsed.contains("value")) {
    return State::damaged;
  }
  if (parsed["key"] != key) return State::absent;  // another one's, of the same hash
  value = parsed["value"];
  return State::found;
}

Status ResultCache::store(std::string_view key, const nlohmann::ordered_json& value) const {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  const nlohmann::ordered_json result{{"key", key}, {"value", value}};
  const std::string body = result.dump(1, ' ', false, kReplace) + "\n";
  const std::string text = head_of(body) + body;
  return write_file(file_of(key), std::as_bytes(std::span(text)));
}

}  // namespace sweepcast::lab

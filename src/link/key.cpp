#include "link/key.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>

#include "io/file.hpp"

namespace sweepcast {
namespace {

constexpr std::string_view kLineBegin = "sweepcast-key-1 ";
constexpr std::size_t kLargestKeyFile = std::size_t{1} << 20;
constexpr std::size_t kMostKeys = 4096;

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string text(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), bytes.data(), bytes.size());
  text.pop_back();
  return text;
}

tl::unexpected<Error> bad_line(const std::filesystem::path& path, std::size_t line,
                               const std::string& what) {
  return fail(ErrorCode::corrupt, path.string() + ": line " + std::to_string(line) + " " + what +
                                      "; make keys with `sweepcast keygen`");
}

/// "sweepcast-key-1 ROBOT 64-HEXADECIMAL-DIGITS".
Result<LinkKey> parse_line(const std::filesystem::path& path, std::size_t number,
                           std::string_view line) {
  if (line.substr(0, kLineBegin.size()) != kLineBegin) {
    return bad_line(path, number, "is no key: it does not begin with sweepcast-key-1");
  }
  line.remove_prefix(kLineBegin.size());
  const std::size_t space = line.find(' ');
  LinkKey key;
  key.robot = std::string(line.substr(0, space));
  if (!is_link_name(key.robot)) return bad_line(path, number, "has no valid robot's name");
  const std::string_view digits =
      space == std::string_view::npos ? std::string_view() : line.substr(space + 1);
  std::size_t size = 0;
  const char* end = nullptr;
  const bool sound = sodium_hex2bin(key.secret.data(), key.secret.size(), digits.data(),
                                    digits.size(), nullptr, &size, &end) == 0;
  if (!sound || size != key.secret.size() || end != digits.data() + digits.size()) {
    return bad_line(path, number, "has no secret of 64 hexadecimal digits");
  }
  return key;
}

/// Secrets that others can read are none.
Status check_private(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) {
    if (errno == ENOENT) {
      return fail(ErrorCode::not_found,
                  path.string() + ": no such key file; make one with `sweepcast keygen`");
    }
    return io_failure(path, "cannot be read", errno);
  }
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) == 0) return {};
  return fail(ErrorCode::invalid_argument,
              path.string() +
                  ": others than its owner may use this key file; chmod 600 it, and "
                  "make new keys if somebody could have read it");
}

}  // namespace

bool is_link_name(std::string_view name) noexcept {
  constexpr std::size_t kLongest = 64;
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  return !name.empty() && name.size() <= kLongest && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

Result<LinkKey> make_link_key(std::string_view robot) {
  if (!is_link_name(robot)) {
    return fail(ErrorCode::invalid_argument,
                "a robot's name is 1 to 64 letters, digits, dots, dashes and underscores, and "
                "begins with no dot");
  }
  if (Status status = link::prepare_crypto(); !status) return tl::unexpected(status.error());
  LinkKey key;
  key.robot = std::string(robot);
  randombytes_buf(key.secret.data(), key.secret.size());
  return key;
}

Status write_link_key(const std::filesystem::path& path, const LinkKey& key) {
  constexpr mode_t kOwnerOnly = S_IRUSR | S_IWUSR;
  FileHandle file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly));
  if (file.get() < 0 && errno == EEXIST) {
    return fail(ErrorCode::io, path.string() +
                                   ": exists already, and a key is never overwritten; choose "
                                   "another name (key files may be joined with cat)");
  }
  if (file.get() < 0) return io_failure(path, "cannot be written", errno);
  const std::string line = std::string(kLineBegin) + key.robot + " " + to_hex(key.secret) + "\n";
  int reason = write_all(file.get(), std::as_bytes(std::span(line)));
  if (reason == 0 && !file.close()) reason = EIO;
  if (reason == 0) return {};
  ::unlink(path.c_str());
  return io_failure(path, "cannot be written", reason);
}

Result<std::vector<LinkKey>> read_link_keys(const std::filesystem::path& path) {
  if (Status status = check_private(path); !status) return tl::unexpected(status.error());
  std::vector<std::byte> bytes;
  if (Status status = read_file(path, kLargestKeyFile, bytes); !status) {
    return tl::unexpected(status.error());
  }
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<LinkKey> keys;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.front() == '#') continue;
    auto key = parse_line(path, number, line);
    if (!key) return tl::unexpected(key.error());
    const auto same = [&](const LinkKey& other) { return other.robot == key->robot; };
    if (std::any_of(keys.begin(), keys.end(), same)) {
      return bad_line(path, number, "has a second key of robot " + key->robot);
    }
    if (keys.size() == kMostKeys) return bad_line(path, number, "is the 4097th key");
    keys.push_back(std::move(*key));
  }
  if (keys.empty()) return bad_line(path, 1, "is missing: the file holds no key");
  return keys;
}

namespace link {

Status prepare_crypto() {
  if (sodium_init() >= 0) return {};
  return fail(ErrorCode::unsupported, "this system gives no random numbers; see random(4)");
}

Challenge draw_challenge() {
  Challenge challenge;
  randombytes_buf(challenge.data(), challenge.size());
  return challenge;
}

namespace {

void add_text(crypto_generichash_state& state, std::string_view text) {
  crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(text.data()),
                            text.size());
}

/// `label` names the purpose; both challenges have fixed sizes, and the name comes last.
LinkSecret derive(const LinkKey& key, std::string_view label, std::span<const std::uint8_t> salt) {
  crypto_generichash_state state;
  LinkSecret out{};
  crypto_generichash_init(&state, key.secret.data(), key.secret.size(), out.size());
  add_text(state, label);
  crypto_generichash_update(&state, salt.data(), salt.size());
  add_text(state, key.robot);
  crypto_generichash_final(&state, out.data(), out.size());
  return out;
}

}  // namespace

SessionKeys derive_session(const LinkKey& key, const Challenge& sender, const Challenge& receiver) {
  std::array<std::uint8_t, 2 * sizeof(Challenge)> both{};
  const auto middle = std::copy(sender.begin(), sender.end(), both.begin());
  std::copy(receiver.begin(), receiver.end(), middle);
  return {derive(key, "sweepcast link 1 to receiver", both),
          derive(key, "sweepcast link 1 to sender  ", both)};
}

std::string passphrase(const LinkKey& key) {
  return to_hex(derive(key, "sweepcast link 1 srt", {}));
}

}  // namespace link
}  // namespace sweepcast

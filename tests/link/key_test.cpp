#include "link/key.hpp"

#include <sys/stat.h>

#include <cctype>
#include <filesystem>
#include <fstream>

#include "link/support.hpp"

namespace sweepcast::test {
namespace {

namespace fs = std::filesystem;

class KeyFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = fs::temp_directory_path() / "sweepcast-key-XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& text) const {
    const fs::path path = folder_ / "keys";
    std::ofstream(path) << text;
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
    return path;
  }
  void expect_refused(const fs::path& path, ErrorCode code, const std::string& words) const {
    const auto keys = read_link_keys(path);
    ASSERT_FALSE(keys) << words;
    EXPECT_EQ(keys.error().code, code);
    EXPECT_NE(keys.error().message.find(words), std::string::npos) << keys.error().message;
  }

  fs::path folder_;
};

TEST_F(KeyFile, ComesBackAndIsPrivate) {
  const auto key = make_link_key("rover-1");
  ASSERT_TRUE(key);
  EXPECT_NE(key->secret, make_link_key("rover-1")->secret);
  const fs::path path = folder_ / "key";
  ASSERT_TRUE(write_link_key(path, *key));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const auto keys = read_link_keys(path);
  ASSERT_TRUE(keys);
  ASSERT_EQ(keys->size(), 1U);
  EXPECT_EQ(keys->front().robot, "rover-1");
  EXPECT_EQ(keys->front().secret, key->secret);
  EXPECT_FALSE(write_link_key(path, *key));  // never overwritten
}

TEST_F(KeyFile, ReadsJoinedFilesAndRefusesOthers) {
  const std::string digits(64, 'a');
  const std::string rover = "sweepcast-key-1 rover " + digits + "\n";
  const auto keys = read_link_keys(
      write("# two robots\n" + rover + "\nsweepcast-key-1 mole " + std::string(64, '5') + "\n"));
  ASSERT_TRUE(keys);
  ASSERT_EQ(keys->size(), 2U);
  EXPECT_EQ((*keys)[1].robot, "mole");
  EXPECT_EQ((*keys)[1].secret[31], 0x55);
  expect_refused(write(rover + rover), ErrorCode::corrupt, "line 2 has a second key");
  expect_refused(write(""), ErrorCode::corrupt, "holds no key");
  expect_refused(write("key"), ErrorCode::corrupt, "line 1 is no key");
  expect_refused(write("sweepcast-key-1 ../x " + digits), ErrorCode::corrupt, "valid robot");
  for (const std::string& bad :
       {digits.substr(1), digits + "a", "g" + digits.substr(1), std::string()}) {
    expect_refused(write("sweepcast-key-1 rover " + bad), ErrorCode::corrupt, "64 hexadecimal");
  }
  expect_refused(folder_ / "none", ErrorCode::not_found, "keygen");
}

TEST_F(KeyFile, RefusesWhatOthersMayUse) {
  const fs::path path = write("sweepcast-key-1 rover " + std::string(64, 'a') + "\n");
  for (const auto more : {fs::perms::group_read, fs::perms::others_read, fs::perms::group_write}) {
    fs::permissions(path, fs::perms::owner_read | more);
    expect_refused(path, ErrorCode::invalid_argument, "chmod 600");
  }
}

TEST(LinkName, AllowsWhatIsSafeInAPath) {
  for (const char* name : {"a", "rover-1", "R2.D2_x", "0"}) EXPECT_TRUE(is_link_name(name)) << name;
  for (const char* name : {"", ".", "..", ".a", "a/b", "a b", "a\n", "\xc3\xa4", "a\\b"}) {
    EXPECT_FALSE(is_link_name(name)) << name;
  }
  EXPECT_TRUE(is_link_name(std::string(64, 'x')));
  EXPECT_FALSE(is_link_name(std::string(65, 'x')));
  EXPECT_FALSE(make_link_key("a/b"));
}

// Computed with Python's hashlib.
TEST(LinkKeys, AreDerivedAsTheFormatSays) {
  link::Challenge sender{}, receiver{};
  for (std::uint8_t i = 0; i < 16; ++i) {
    sender[i] = i;
    receiver[i] = static_cast<std::uint8_t>(100 + i);
  }
  const LinkKey key = counting_key("rover-1");
  const link::SessionKeys keys = link::derive_session(key, sender, receiver);
  EXPECT_EQ(hex(std::as_bytes(std::span(keys.to_receiver))),
            "99758c9311dbb4a44f8f9c451b7416f7e13ca8bd56c1e1e7d7ce71a8c582f109");
  EXPECT_EQ(hex(std::as_bytes(std::span(keys.to_sender))),
            "a56ad0bed92526941a3506d7bee988e55decd4b4f91ad48731bd06c7f76394f2");
  EXPECT_EQ(link::passphrase(key),
            "c9c78e27c45256eef252f74d1f3d4810d77030f8bf274bfd00a0df03fa4ece6a");
  EXPECT_NE(link::derive_session(key, receiver, sender).to_receiver, keys.to_receiver);
}

}  // namespace
}  // namespace sweepcast::test

// view, and receive --view, run as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>

#include "apps/tool_fixture.hpp"
#include "view/web_client.hpp"

namespace sweepcast::test {
namespace {

class ViewTool : public ToolTest {
 protected:
  /// Starts a server on a free port as $V, and sets `PORT` for the rest of the line. What an
  /// earlier one has told of itself is wiped first: the new one may be slower than the shell.
  static std::string viewing(const std::string& arguments) {
    return ": >url; \"$SWEEPCAST\" view " + arguments +
           " --port 0 >url 2>note & V=$!; until grep -q http url; do kill -0 $V || exit 9; done; "
           "PORT=$(sed -n 's/.*:\\([0-9]*\\)$/\\1/p' url); ";
  }
  /// Prints the answer to a GET.
  static std::string get(const std::string& target) {
    return "bash -c 'exec 3<>/dev/tcp/127.0.0.1/'$PORT'; printf \"GET " + target +
           " HTTP/1.1\\r\\nHost: localhost\\r\\nConnection: close\\r\\n\\r\\n\" >&3; cat <&3'; ";
  }
  static constexpr const char* kEnd = "kill -TERM $V; wait $V; echo end $?";
};

TEST_F(ViewTool, ShowsARecordingUntilItIsToldToStop) {
  make_recording(3);
  const Outcome outcome =
      shell(viewing("room.sweep --original sweeps") + get("/healthz") + get("/original/2") + kEnd);
  EXPECT_EQ(outcome.out.substr(0, 15), "HTTP/1.1 200 OK") << outcome.out;
  EXPECT_NE(outcome.out.find("X-Fields: x y z intensity"), std::string::npos);
  EXPECT_NE(outcome.out.find(read("sweeps/000002.bin")), std::string::npos);
  EXPECT_NE(outcome.out.find("end 0\n"), std::string::npos) << outcome.out;
  EXPECT_EQ(read("url").substr(0, 17), "http://127.0.0.1:");
  EXPECT_EQ(read("note"), "");
}

TEST_F(ViewTool, ShowsFoldersOfRecordingsAndOfClouds) {
  make_recording(2);
  std::filesystem::create_directories(path("got/rover"));
  std::filesystem::copy_file(path("room.sweep"), path("got/rover/roof.sweep"));
  for (const char* input : {"got", "sweeps"}) {
    const Outcome outcome = shell(viewing(input) + get("/healthz") + kEnd);
    EXPECT_EQ(outcome.out.substr(0, 15), "HTTP/1.1 200 OK") << input << outcome.out;
    EXPECT_NE(outcome.out.find("end 0\n"), std::string::npos) << outcome.out;
  }
  EXPECT_NE(read("note").find("0.01 m"), std::string::npos) << read("note");
}

TEST_F(ViewTool, RefusesWhatIsUnsafeOrNotThere) {
  make_recording(1);
  expect_failure(run("view room.sweep --port 0 --address 0.0.0.0"), 1, {"0.0.0.0", "token"});
  expect_failure(run("view room.sweep --port 0 --token 'a b'"), 1, {"token", "letters"});
  expect_failure(run("view nothing.sweep --port 0"), 1, {"nothing.sweep"});
  expect_failure(run("view room.sweep --port 0 --original nowhere"), 1, {"nowhere"});
  expect_failure(run("view sweeps --port 0 --original sweeps"), 1, {"sweeps", "--original"});
  expect_failure(run("view room.sweep --port 70000"), 2, {"--port"});
  const Outcome locked = shell(viewing("room.sweep --token s3cret --address 0.0.0.0") + get("/") +
                               get("/?token=s3cret") + kEnd);
  EXPECT_EQ(locked.out.substr(0, 12), "HTTP/1.1 401") << locked.out;
  EXPECT_NE(locked.out.find("HTTP/1.1 200 OK"), std::string::npos);
}

TEST_F(ViewTool, ReceivingIsShown) {
  if (run("receive --help").err.find("not in this build") != std::string::npos) {
    GTEST_SKIP() << "this build has no live link";
  }
  ASSERT_EQ(run("keygen k --robot rover").exit_status, 0);
  const Outcome outcome = shell(
      "\"$SWEEPCAST\" receive --listen 0 --keys k -o got --view 0 2>note & V=$!; "
      "until grep -q listening note; do kill -0 $V || exit 9; done; "
      "PORT=$(sed -n 's/.*viewing at .*:\\([0-9]*\\)$/\\1/p' note); " +
      get("/healthz") + kEnd);
  EXPECT_EQ(outcome.out.substr(0, 15), "HTTP/1.1 200 OK") << outcome.out << read("note");
  EXPECT_NE(outcome.out.find("end 0\n"), std::string::npos) << outcome.out;
  expect_failure(run("receive --listen 0 --keys k -o got --view 0.0.0.0:0"), 1,
                 {"0.0.0.0", "token"});
  expect_failure(run("receive --listen 0 --keys k -o got --view x"), 2, {"--view"});
}

/// The next status whose robot is as `wanted` says; null where the connection ends.
nlohmann::json next_robot(WebClient& client,
                          const std::function<bool(const nlohmann::json&)>& wanted) {
  for (;;) {
    const Received got = client.read();
    if (!got.is_open) return nullptr;
    if (!got.is_text) continue;
    const auto message = nlohmann::json::parse(got.bytes, nullptr, false);
    if (message["kind"] != "status" || message["robots"].empty()) continue;
    if (wanted(message["robots"][0])) return message["robots"][0];
  }
}

TEST_F(ViewTool, AnOperatorsLevelIsSentUntilItIsTakenBack) {
  if (run("receive --help").err.find("not in this build") != std::string::npos) {
    GTEST_SKIP() << "this build has no live link";
  }
  make_recording(3);
  ASSERT_EQ(run("keygen k --robot rover").exit_status, 0);
  ASSERT_EQ(run("encode sweeps -o finer.sweep --level 1 --fields xyz").exit_status, 0);
  ASSERT_EQ(shell("mkfifo viewing gate").exit_status, 0);
  auto outcome = std::async(std::launch::async, [this] {
    return shell(
        "\"$SWEEPCAST\" receive --listen 0 --keys k -o got --view 0 --json >report 2>note & R=$!; "
        "until grep -q listening note; do kill -0 $R || exit 9; done; "
        "PORT=$(sed -n 's/.*listening at .*:\\([0-9]*\\)$/\\1/p' note); "
        "\"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k --loop --strategy fixed:1 "
        "--allow-override >/dev/null & S=$!; "
        "sed -n 's/.*viewing at .*:\\([0-9]*\\)$/\\1/p' note >viewing; cat gate; "
        "kill -TERM $S; wait $S; echo $?; kill -TERM $R; wait $R; echo $?");
  });
  WebClient client;
  const int port = std::stoi(read("viewing"));
  EXPECT_EQ(client.connect(static_cast<std::uint16_t>(port), "/live", "sweepcast.view.v1"), 101);
  const auto level_is = [&](std::optional<int> override_level, int level) {
    return !next_robot(client, [&](const auto& robot) {
              return robot["can_override"] == true && robot["level"] == level &&
                     robot["override"].is_number() == override_level.has_value();
            }).is_null();
  };
  EXPECT_TRUE(level_is({}, 1));
  client.send(R"({"kind":"override","robot":"rover","level":5})");
  EXPECT_TRUE(level_is(5, 5));
  client.send(R"({"kind":"override","robot":"rover","level":null})");
  EXPECT_TRUE(level_is({}, 1));
  write("gate", "");
  EXPECT_EQ(outcome.get().out, "0\n0\n") << read("note");

  const auto told = nlohmann::json::parse(read("report"), nullptr, false)["robots"]["rover"];
  EXPECT_EQ(told["level"], 1);
  EXPECT_TRUE(told["qoe"].is_number());
  const auto sizes = [&](const std::string& file) {
    std::vector<int> all;
    const auto info = run("info " + file + " --json").json();
    for (const auto& frame : info["frames"]) all.push_back(frame["bytes"].get<int>());
    return all;
  };
  const auto finer = sizes("finer.sweep");
  const int least = *std::min_element(finer.begin(), finer.end());
  const auto got = sizes("got/rover/lidar.sweep");
  ASSERT_FALSE(got.empty());
  EXPECT_GE(got.front(), least);
  EXPECT_LT(*std::min_element(got.begin(), got.end()), least);
  EXPECT_GE(got.back(), least);
}

TEST_F(ViewTool, FoxglovesOwnClientUnderstandsIt) {
  const std::string folder = SWEEPCAST_FOXGLOVE_TEST;
  if (shell("node --version").exit_status != 0 ||
      !std::filesystem::exists(folder + "/node_modules/@foxglove/ws-protocol")) {
    GTEST_SKIP() << "Foxglove's client is not there; apt-get install nodejs npm, then npm ci in "
                 << folder;
  }
  make_recording(3);
  ASSERT_EQ(run("decode room.sweep -o clouds").exit_status, 0);
  const std::string client = "node '" + folder + "/client.mjs' $PORT ";
  const Outcome outcome = shell(viewing("room.sweep --token s3cret") + client +
                                "foxglove.websocket.v1 clouds s3cret; " + client +
                                "foxglove.sdk.v1 clouds s3cret; " + kEnd);
  EXPECT_EQ(outcome.out, "3 clouds\n3 clouds\nend 0\n") << outcome.err;
}

}  // namespace
}  // namespace sweepcast::test

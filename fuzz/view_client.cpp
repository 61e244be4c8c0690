// What clients of the viewer send: the first byte says whether the rest is a request's heads, or
// messages of the page's or of Foxglove's protocol, a line each. No client may make the server hold
// more than little, or end it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "view/foxglove_client.hpp"
#include "view/page_client.hpp"
#include "view/routes.hpp"

namespace {

using namespace sweepcast;
using namespace sweepcast::view;

/// Frames that are none, so that nothing is decoded here.
class NoFrames : public Recording {
 public:
  [[nodiscard]] std::uint32_t size() const override { return 7; }
  [[nodiscard]] std::vector<Stream> streams() const override { return {{0, "rover", "roof"}}; }
  [[nodiscard]] std::uint8_t stream_of(std::uint32_t /*index*/) const override { return 0; }
  [[nodiscard]] bool has_original(std::uint32_t index) const override { return index == 3; }
  [[nodiscard]] Status original(std::uint32_t /*index*/, PointCloud& cloud) override {
    cloud.resize_xyz(2);
    return {};
  }

 private:
  [[nodiscard]] Result<SharedSweep> make(std::uint32_t index) override {
    if (index == 5) return fail(ErrorCode::corrupt, "damaged");
    auto sweep = std::make_shared<Sweep>();
    sweep->index = index;
    sweep->frame = std::make_shared<const Bytes>(8);
    return sweep;
  }
};

std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

void talk(Client& client, std::string_view rest, Clock::time_point now) {
  constexpr int kMostMessages = 64;
  while (!rest.empty()) {
    const bool is_text = rest.front() != '\x01';
    if (!client.take(take_line(rest), is_text, now)) return;
    now += std::chrono::milliseconds(37);
    int messages = 0;
    while (client.next(now)) {
      if (++messages > kMostMessages) std::abort();
    }
    if (const auto due = client.due(now); due && *due <= now) std::abort();
  }
}

void ask(std::string_view rest, Recording& recording) {
  Request request;
  for (std::string_view* part :
       {&request.from.target, &request.from.host, &request.from.origin, &request.from.authorization,
        &request.from.cookie, &request.subprotocols}) {
    *part = take_line(rest);
  }
  request.method = "GET";
  const AccessRules locked{"s3cret", true, 8080, {}};
  for (const AccessRules& rules : {AccessRules{}, locked}) {
    if (answer(request, rules, &recording).status == 0) std::abort();
    (void)choose_upgrade(request, rules);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  const Clock::time_point now{std::chrono::seconds(1000)};
  NoFrames recording;
  const Show show{false, "roof", 10.0, 7, true, recording.streams()};
  switch (data[0]) {
    case 'r':
      ask(rest, recording);
      break;
    case 'p': {
      PageClient client(show, &recording, now, [](const std::string& robot, auto level) {
        if (level && *level > 5) std::abort();
        return robot == "rover";
      });
      talk(client, rest, now);
      break;
    }
    default: {
      FoxgloveClouds clouds;
      FoxgloveClient client(show, &recording, clouds, now);
      talk(client, rest, now);
    }
  }
  return 0;
}

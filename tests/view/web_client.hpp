// A client of the viewer's server: plain HTTP, and WebSocket. Waits as long as it takes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace sweepcast::test {

/// Sends the bytes to a port of this machine and returns all that comes back until the other side
/// closes.
std::string ask(std::uint16_t port, const std::string& request);

/// The status of a GET with further heads ("Name: value\r\n"); 0 where there is no answer.
int get_status(std::uint16_t port, const std::string& target, const std::string& heads = "");

struct Received {
  bool is_open = false;  ///< false: the other side closed, `bytes` is its reason
  bool is_text = false;
  std::string bytes;
};

class WebClient {
 public:
  /// 101 where the WebSocket is open; else the answer's status, 0 where there is none.
  int connect(std::uint16_t port, const std::string& target, const std::string& subprotocol,
              const std::string& origin = "");
  WebClient();
  WebClient(WebClient&&) noexcept;
  ~WebClient();

  void send(const std::string& text);
  [[nodiscard]] Received read();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast::test

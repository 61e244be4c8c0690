#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <optional>

#include "view/sessions.hpp"

namespace sweepcast::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::chrono::seconds kHandshakeTime{15};
constexpr std::chrono::seconds kSilenceTime{60};  ///< of a client, pings notwithstanding
constexpr std::chrono::seconds kWriteTime{60};    ///< of one message
constexpr std::size_t kMostMessage = 16384;       ///< bytes that a client may send at a time

class WebSocketSession : public Attendee, public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, const Upgrade& upgrade, Hub& hub,
                   std::shared_ptr<void> place)
      : place_(std::move(place)),
        hub_(hub),
        client_(hub.make_client(upgrade, Clock::now())),
        socket_(std::move(stream)),
        timer_(socket_.get_executor()) {
    websocket::stream_base::timeout times{kHandshakeTime, kSilenceTime, true};
    socket_.set_option(times);
    socket_.set_option(websocket::stream_base::decorator(
        [name = upgrade.subprotocol](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol,
                       beast::string_view(name.data(), name.size()));
        }));
    socket_.read_message_max(kMostMessage);
    socket_.auto_fragment(false);  // what is sent is not copied
  }
  ~WebSocketSession() override { hub_.leave(*this); }
  WebSocketSession(const WebSocketSession&) = delete;
  WebSocketSession& operator=(const WebSocketSession&) = delete;

  void run(UpgradeRequest request) {
    request_ = std::move(request);
    socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->request_ = {};
      self->is_open_ = true;
      self->hub_.attend(*self);
      self->read();
      self->pump();
    });
  }

  [[nodiscard]] Client& client() override { return *client_; }
  void wake() override { pump(); }
  void tick(Clock::time_point now) override {
    const bool is_stuck = is_writing_ && now - write_began_ > kWriteTime;
    if (is_stuck) beast::get_lowest_layer(socket_).close();
  }

 private:
  void read() {
    socket_.async_read(buffer_,
                       [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
                         if (error) {
                           self->end();
                         } else {
                           self->take();
                         }
                       });
  }

  void take() {
    const auto bytes = buffer_.cdata();
    const Status taken = client_->take({static_cast<const char*>(bytes.data()), bytes.size()},
                                       socket_.got_text(), Clock::now());
    buffer_.consume(buffer_.size());
    if (!taken) {
      refuse(taken.error().message);
      return;
    }
    pump();
    read();
  }

  /// Ends the connection, with the reason; at most 123 bytes of it fit.
  void refuse(const std::string& why) {
    is_open_ = false;
    timer_.cancel();
    const websocket::close_reason reason(websocket::close_code::policy_error,
                                         beast::string_view(why).substr(0, 123));
    socket_.async_close(reason, [self = shared_from_this()](beast::error_code /*error*/) {});
  }

  void end() {
    is_open_ = false;
    timer_.cancel();
  }

  /// Sends what there is to send, one message at a time: while one is on its way, the client's
  /// newer sweeps take the place of those that wait.
  void pump() {
    if (!is_open_ || is_writing_) return;
    const auto now = Clock::now();
    out_ = client_->next(now);
    if (!out_) {
      wait(client_->due(now));
      return;
    }
    is_writing_ = true;
    write_began_ = now;
    socket_.text(out_->is_text);
    const Bytes none;
    const Bytes& body = out_->body ? *out_->body : none;
    const std::array<boost::asio::const_buffer, 2> buffers{
        boost::asio::const_buffer(out_->head.data(), out_->head.size()),
        boost::asio::const_buffer(body.data(), body.size())};
    socket_.async_write(
        buffers, [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
          self->is_writing_ = false;
          self->out_.reset();
          if (error) {
            self->end();
          } else {
            self->pump();
          }
        });
  }

  void wait(std::optional<Clock::time_point> until) {
    if (!until) return;
    timer_.expires_at(*until);
    timer_.async_wait([self = weak_from_this()](beast::error_code error) {
      const auto session = self.lock();
      if (!error && session) session->pump();
    });
  }

  std::shared_ptr<void> place_;
  Hub& hub_;
  std::unique_ptr<Client> client_;
  websocket::stream<beast::tcp_stream> socket_;
  boost::asio::steady_timer timer_;
  UpgradeRequest request_;
  beast::flat_buffer buffer_;
  std::optional<Message> out_;  ///< on its way
  Clock::time_point write_began_;
  bool is_open_ = false;
  bool is_writing_ = false;
};

}  // namespace

void serve_websocket(beast::tcp_stream stream, UpgradeRequest request, const Upgrade& upgrade,
                     Hub& hub, std::shared_ptr<void> place) {
  std::make_shared<WebSocketSession>(std::move(stream), upgrade, hub, std::move(place))
      ->run(std::move(request));
}

}  // namespace sweepcast::view

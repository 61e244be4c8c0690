#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <optional>

#include "view/sessions.hpp"

namespace sweepcast::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::chrono::seconds kRequestTime{15};  ///< to ask, and to take the answer
constexpr std::chrono::seconds kAnswerTime{60};
constexpr std::uint32_t kMostHeadBytes = 8192;

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

Request request_of(const UpgradeRequest& request) {
  const auto head = [&](http::field name) { return view_of(request[name]); };
  return {view_of(request.method_string()),
          {view_of(request.target()), head(http::field::host), head(http::field::origin),
           head(http::field::authorization), head(http::field::cookie)},
          head(http::field::sec_websocket_protocol)};
}

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(boost::asio::ip::tcp::socket socket, Hub& hub, std::shared_ptr<void> place)
      : place_(std::move(place)),
        stream_(std::move(socket)),
        buffer_(std::size_t{2} * kMostHeadBytes),
        hub_(hub) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeadBytes);
    stream_.expires_after(kRequestTime);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
                       if (!error) self->take();
                     });
  }

 private:
  using Response = http::response<http::span_body<const char>>;

  void take() {
    const UpgradeRequest& request = parser_->get();
    if (!beast::websocket::is_upgrade(request)) {
      write(answer(request_of(request), hub_.rules(), hub_.recording()), request.keep_alive());
      return;
    }
    auto upgrade = choose_upgrade(request_of(request), hub_.rules());
    if (!upgrade) {
      write(std::move(upgrade.error()), false);
      return;
    }
    stream_.expires_never();
    serve_websocket(std::move(stream_), parser_->release(), *upgrade, hub_, std::move(place_));
  }

  void write(Answer made, bool keep_alive) {
    const UpgradeRequest& request = parser_->get();
    answer_ = std::move(made);
    response_.emplace(static_cast<http::status>(answer_.status), request.version());
    for (const auto& [name, value] : answer_.heads) {
      response_->insert(beast::string_view(name.data(), name.size()), value);
    }
    response_->keep_alive(keep_alive);
    response_->content_length(answer_.body.size());
    if (request.method() != http::verb::head) {
      response_->body() = {answer_.body.data(), answer_.body.size()};
    }
    stream_.expires_after(kAnswerTime);
    http::async_write(
        stream_, *response_,
        [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t /*bytes*/) {
          self->answer_ = {};
          if (!error && keep_alive) self->read();
          if (!error && !keep_alive) self->close();
        });
  }

  void close() {
    beast::error_code ignored;
    stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  }

  std::shared_ptr<void> place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  Hub& hub_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  Answer answer_;
  std::optional<Response> response_;
};

}  // namespace

void serve_http(boost::asio::ip::tcp::socket socket, Hub& hub, std::shared_ptr<void> place) {
  std::make_shared<HttpSession>(std::move(socket), hub, std::move(place))->read();
}

}  // namespace sweepcast::view

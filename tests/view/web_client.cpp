#include "view/web_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace sweepcast::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;

tcp::endpoint here(std::uint16_t port) {
  return {asio::ip::address_v4::loopback(), port};
}

}  // namespace

std::string ask(std::uint16_t port, const std::string& request) {
  asio::io_context context;
  tcp::socket socket(context);
  boost::system::error_code error;
  std::string reply;
  socket.connect(here(port), error);
  if (!error) asio::write(socket, asio::buffer(request), error);
  asio::read(socket, asio::dynamic_buffer(reply), error);  // ends with an error: end of file
  return reply;
}

int get_status(std::uint16_t port, const std::string& target, const std::string& heads) {
  const std::string reply = ask(port, "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + heads +
                                          "Connection: close\r\n\r\n");
  return reply.size() < 12 ? 0 : std::stoi(reply.substr(9, 3));
}

struct WebClient::State {
  asio::io_context context;
  beast::websocket::stream<tcp::socket> socket{context};
};

WebClient::WebClient() : state_(std::make_unique<State>()) {}
WebClient::WebClient(WebClient&&) noexcept = default;
WebClient::~WebClient() = default;

int WebClient::connect(std::uint16_t port, const std::string& target,
                       const std::string& subprotocol, const std::string& origin) {
  namespace http = beast::http;
  boost::system::error_code error;
  state_->socket.next_layer().connect(here(port), error);
  state_->socket.set_option(
      beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
        request.set(http::field::sec_websocket_protocol, subprotocol);
        if (!origin.empty()) request.set(http::field::origin, origin);
      }));
  state_->socket.read_message_max(std::size_t{64} << 20);
  beast::websocket::response_type response;
  if (!error) {
    state_->socket.handshake(response, "localhost:" + std::to_string(port), target, error);
  }
  if (!error) return response[http::field::sec_websocket_protocol] == subprotocol ? 101 : 0;
  return get_status(port, target,
                    "Upgrade: websocket\r\nConnection: upgrade\r\nSec-WebSocket-Version: 13\r\n"
                    "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: " +
                        subprotocol + (origin.empty() ? "" : "\r\nOrigin: " + origin) + "\r\n");
}

void WebClient::send(const std::string& text) {
  boost::system::error_code ignored;
  state_->socket.text(true);
  state_->socket.write(asio::buffer(text), ignored);
}

Received WebClient::read() {
  beast::flat_buffer buffer;
  boost::system::error_code error;
  state_->socket.read(buffer, error);
  if (error) return {false, true, std::string(state_->socket.reason().reason.c_str())};
  const auto bytes = buffer.cdata();
  return {true, state_->socket.got_text(), {static_cast<const char*>(bytes.data()), bytes.size()}};
}

}  // namespace sweepcast::test

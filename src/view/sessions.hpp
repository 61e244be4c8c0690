// Connections of the viewer's server. Includes Boost.Beast: for few files only.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <memory>

#include "view/hub.hpp"

namespace sweepcast::view {

using UpgradeRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// Reads requests from a connection and answers them, until the other side ends it, is silent for
/// too long, or asks for a WebSocket. `place` is given back with the connection. The connection
/// lives as long as it has something to wait for; `hub` outlives it.
void serve_http(boost::asio::ip::tcp::socket socket, Hub& hub, std::shared_ptr<void> place);

/// Goes on as a WebSocket, after `request` asked for it.
void serve_websocket(boost::beast::tcp_stream stream, UpgradeRequest request,
                     const Upgrade& upgrade, Hub& hub, std::shared_ptr<void> place);

}  // namespace sweepcast::view

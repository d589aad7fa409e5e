#pragma once
#include <memory>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "peerd/view/gateway/gateway_state.hpp"

namespace peerd::gateway {

// Turns a connection into a WebSocket, as its request asks, and serves it until its client or silence ends it.
void serve_live(const std::shared_ptr<GatewayState>& state, boost::asio::ip::tcp::socket socket,
                boost::beast::http::request<boost::beast::http::string_body> upgrade);

}  // namespace peerd::gateway

#pragma once
#include <memory>

#include <boost/asio/ip/tcp.hpp>

#include "peerd/view/gateway/gateway_state.hpp"

namespace peerd::gateway {

// Serves HTTP/1.1 on a connection that has just been taken, until its client, a refusal or silence ends it, or it
// becomes a WebSocket. `refused`: its first request is answered with that whatever it is.
void serve_http(const std::shared_ptr<GatewayState>& state, boost::asio::ip::tcp::socket socket);

// Answers that there are too many connections, as far as the socket takes it at once, and closes.
void refuse_connection(GatewayState& state, boost::asio::ip::tcp::socket socket);

}  // namespace peerd::gateway

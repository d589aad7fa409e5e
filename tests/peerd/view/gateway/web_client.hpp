#pragma once
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "tests/peerd/view/gateway/served_peer.hpp"

namespace peerd::testing_support {

// A client that waits for what it reads, 10 s at most.
class WebClient {
 public:
  using Response = boost::beast::http::response<boost::beast::http::string_body>;
  using Headers = std::vector<std::pair<std::string, std::string>>;

  explicit WebClient(const ServedPeer& peer) : host_(peer.host()), socket_(io_) {
    socket_.connect({boost::asio::ip::address_v4::loopback(), peer.port()});
    const timeval patience{10, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  }

  // Sends bytes as they are; false: the peer has closed the connection.
  bool send(const std::string& bytes) {
    boost::system::error_code failed;
    boost::asio::write(socket_, boost::asio::buffer(bytes), failed);
    return !failed;
  }
  // The next response; status 0 where there is none.
  Response receive() {
    Response response;
    boost::system::error_code failed;
    boost::beast::http::response_parser<boost::beast::http::string_body> parser;
    parser.body_limit(std::size_t{64} << 20);
    boost::beast::http::read(socket_, in_, parser, failed);
    if (failed) {
      response.result(0);
      return response;
    }
    return parser.release();
  }
  // All bytes until the peer closes the connection; none where it does not.
  std::optional<std::string> receive_all() {
    std::string all;
    char part[4096];
    for (;;) {
      boost::system::error_code failed;
      const std::size_t size = socket_.read_some(boost::asio::buffer(part), failed);
      all.append(part, size);
      if (failed == boost::asio::error::would_block || failed == boost::asio::error::try_again) return std::nullopt;
      if (failed) return all;
    }
  }
  Response request(const std::string& method, const std::string& target, const Headers& headers = {},
                   const std::string& body = {}) {
    std::string text = method + ' ' + target + " HTTP/1.1\r\n";
    bool has_host = false;
    for (const auto& [name, value] : headers) {
      has_host |= name == "Host";
      text += name + ": " + value + "\r\n";
    }
    if (!has_host) text += "Host: " + host_ + "\r\n";
    if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    return send(text + "\r\n" + body) ? receive() : Response{};
  }
  Response get(const std::string& target, const Headers& headers = {}) { return request("GET", target, headers); }
  // Without a token the request has none.
  Response post(const nlohmann::json& body, const std::string& token = {}) {
    Headers headers;
    if (!token.empty()) headers.emplace_back("Authorization", "Bearer " + token);
    return request("POST", "/api/v1/request", headers, body.dump());
  }
  boost::asio::ip::tcp::socket& socket() { return socket_; }
  [[nodiscard]] const std::string& host() const { return host_; }

 private:
  boost::asio::io_context io_;
  std::string host_;
  boost::asio::ip::tcp::socket socket_;
  boost::beast::flat_buffer in_;
};

// A WebSocket to a peer.
class LiveClient {
 public:
  // `shows_token`: it may change something.
  LiveClient(const ServedPeer& peer, bool shows_token) : LiveClient(peer) {
    if (!shows_token) return;
    EXPECT_EQ(ask({{"do", "token"}, {"token", ServedPeer::kToken}})["ok"], true);
  }
  explicit LiveClient(const ServedPeer& peer) : client_(peer), stream_(client_.socket()) {
    stream_.read_message_max(std::size_t{64} << 20);
    stream_.handshake(client_.host(), "/api/v1/live");
  }

  void send(const nlohmann::json& message) { send_text(message.dump()); }
  void send_text(const std::string& text) {
    stream_.text(true);
    stream_.write(boost::asio::buffer(text));
  }
  // The next message; events and frames that come before a reply are kept for later.
  nlohmann::json ask(nlohmann::json request) {
    request["seq"] = ++sequence_;
    send(request);
    for (int tries = 0; tries < 100'000; ++tries) {
      if (!read()) return nullptr;
      if (!stream_.got_text()) {
        frames_.push_back(last_);
        continue;
      }
      auto message = nlohmann::json::parse(last_);
      if (message.contains("seq") && message["seq"] == sequence_) return message;
      texts_.push_back(std::move(message));
    }
    return nullptr;
  }
  // The next line that is no reply.
  nlohmann::json next_event() {
    while (texts_.empty()) {
      if (!read()) return nullptr;
      stream_.got_text() ? texts_.push_back(nlohmann::json::parse(last_)) : frames_.push_back(last_);
    }
    auto event = std::move(texts_.front());
    texts_.erase(texts_.begin());
    return event;
  }
  std::string next_frame() {
    while (frames_.empty()) {
      if (!read()) return {};
      stream_.got_text() ? texts_.push_back(nlohmann::json::parse(last_)) : frames_.push_back(last_);
    }
    auto frame = std::move(frames_.front());
    frames_.erase(frames_.begin());
    return frame;
  }
  // False: the connection is over, or silent for 10 s.
  bool read() {
    boost::beast::flat_buffer in;
    boost::system::error_code failed;
    stream_.read(in, failed);
    last_ = boost::beast::buffers_to_string(in.data());
    return !failed;
  }
  [[nodiscard]] boost::beast::websocket::stream<boost::asio::ip::tcp::socket&>& stream() { return stream_; }
  [[nodiscard]] WebClient& client() { return client_; }

 private:
  WebClient client_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket&> stream_;
  int sequence_ = 0;
  std::string last_;
  std::vector<nlohmann::json> texts_;
  std::vector<std::string> frames_;
};

}  // namespace peerd::testing_support

#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/time.hpp"

namespace peerd::snapshot {

// A TCP connection over which both sides send frames: four bytes, the least significant first, say how long one is.
// Handlers keep the stream alive until they have been called. After close() none is.
class FramedStream : public std::enable_shared_from_this<FramedStream> {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  // Called with the content of the next frame.
  using OnFrame = std::function<void(std::string frame)>;
  using OnDone = std::function<void()>;
  // Called once, with the reason in a few words: the other side has closed, sends too long a frame, or was silent for
  // too long.
  using OnFailure = std::function<void(const std::string& why)>;

  // Each read and each write has to end within `patience`.
  FramedStream(Socket socket, std::size_t frame_max_bytes, Duration patience, OnFailure on_failure);

  void connect(const boost::asio::ip::tcp::endpoint& to, OnDone done);
  // One read and one write may be under way at a time.
  void read(OnFrame on_frame);
  void write(const std::string& content, OnDone done);
  void close();

 private:
  // A handler that calls `next` unless there was an error or the stream is closed.
  template <class Next>
  auto guarded(Next next);
  void read_content(OnFrame on_frame);
  void fail(const std::string& why);
  void await();

  Socket socket_;
  std::size_t frame_max_bytes_;
  Duration patience_;
  OnFailure on_failure_;
  boost::asio::steady_timer deadline_;
  int under_way_ = 0;  // reads and writes
  bool over_ = false;
  std::array<unsigned char, 4> head_{};
  std::string in_, out_;
};

}  // namespace peerd::snapshot

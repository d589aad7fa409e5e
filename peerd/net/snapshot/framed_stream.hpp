#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/time.hpp"
#include "peerd/net/seal/stream_seal.hpp"

namespace peerd::snapshot {

// A TCP connection over which both sides send frames: four bytes, the least significant first, say how long one is.
// With a seal the first frame of each side is its hello, and all others are sealed; the client's comes first. Handlers
// keep the stream alive until they have been called. After close() none is.
class FramedStream : public std::enable_shared_from_this<FramedStream> {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  // Called with the content of the next frame.
  using OnFrame = std::function<void(std::string frame)>;
  using OnDone = std::function<void()>;
  // A server says one of these in place of its hello, and closes the connection. The byte is all of the frame.
  enum class Refused : char { kOtherKey = 1, kNoPlace = 2 };
  enum class Proof : std::uint8_t { kWith, kWithout };  // in the client's hello; older servers take none
  // Called once, with the reason in a few words: the other side has closed, sends too long a frame or one that is not
  // opened, or was silent for too long.
  using OnFailure = std::function<void(const std::string& why)>;

  // Each read and each write has to end within `patience`.
  FramedStream(Socket socket, std::size_t frame_max_bytes, Duration patience, OnFailure on_failure,
               std::optional<seal::StreamSeal> seal);

  // To be called first by who connects.
  void connect(const boost::asio::ip::tcp::endpoint& to, OnDone done, Proof proof = Proof::kWith);
  // To be called first by a server with a key: the first frame of the other side, of which nothing is known, and which
  // is short.
  void read_hello(OnFrame on_frame);
  // Seals the connection from then on. The hello is what read_hello() has read.
  void answer_hello(seal::StreamSeal seal, const std::string& hello, OnDone done);
  // Closes the connection of a client that has sent that hello. One whose hello has a proof is told why before. An
  // older client, which sends none, would take the byte for the answer of an open peer.
  void refuse(Refused why, std::string_view hello);
  // Each read and each write that begins from now on has to end within that time.
  void set_patience(Duration patience) { patience_ = patience; }
  // One read and one write may be under way at a time.
  void read(OnFrame on_frame);
  void write(const std::string& content, OnDone done);
  void close();
  // The other side's address; unspecified where the connection is over.
  [[nodiscard]] boost::asio::ip::address remote() const;
  // The server's reason, where it has said one.
  [[nodiscard]] std::optional<Refused> refused() const { return refused_; }
  // It is sealed, and nothing that the other side has sent was opened: that may have another key, or none.
  [[nodiscard]] bool is_unproven() const { return seal_ && !is_proven_; }
  // It is sealed, and the other side has begun with something else than a key: that is open.
  [[nodiscard]] bool is_open_there() const { return is_open_there_; }

 private:
  // A handler that calls `next` unless there was an error or the stream is closed.
  template <class Next>
  auto guarded(Next next);
  void begin(Proof proof, OnDone done);
  void read_frame(std::size_t max_bytes, OnFrame on_frame);
  void read_content(std::size_t max_bytes, OnFrame on_frame);
  void write_frame(std::string_view content, OnDone done);
  void fail(const std::string& why);
  void await();

  Socket socket_;
  std::size_t frame_max_bytes_;
  Duration patience_;
  OnFailure on_failure_;
  std::optional<seal::StreamSeal> seal_;
  boost::asio::steady_timer deadline_;
  int under_way_ = 0;  // reads and writes
  bool over_ = false, is_proven_ = false, is_open_there_ = false;
  std::optional<Refused> refused_;
  std::array<unsigned char, 4> head_{};
  std::string in_, out_;
};

}  // namespace peerd::snapshot

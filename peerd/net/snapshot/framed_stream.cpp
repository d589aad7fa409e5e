#include "peerd/net/snapshot/framed_stream.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/completion_condition.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "peerd/net/os/close_on_exec.hpp"

namespace peerd::snapshot {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// The first frame that a server reads, of whoever has connected: a hello with its proof, or the first request of an
// open peer.
constexpr std::size_t kFirstFrameMax_bytes = 256;

}  // namespace

FramedStream::FramedStream(Socket socket, std::size_t frame_max_bytes, Duration patience, OnFailure on_failure,
                           std::optional<seal::StreamSeal> seal)
    : socket_(std::move(socket)),
      frame_max_bytes_(frame_max_bytes),
      patience_(patience),
      on_failure_(std::move(on_failure)),
      seal_(std::move(seal)),
      deadline_(socket_.get_executor()) {}

template <class Next>
auto FramedStream::guarded(Next next) {
  ++under_way_;
  await();
  return [self = shared_from_this(), next = std::move(next)](const error_code& error, std::size_t = 0) {
    if (self->over_) return;
    if (--self->under_way_ == 0) self->deadline_.cancel();
    if (error) return self->fail(error == asio::error::eof ? "the connection was closed" : error.message());
    next();
  };
}

void FramedStream::connect(const asio::ip::tcp::endpoint& to, OnDone done, Proof proof) {
  error_code failed;
  socket_.open(to.protocol(), failed);
  net::close_on_exec(socket_);
  if (failed) return fail(failed.message());
  socket_.async_connect(to, guarded([this, proof, done = std::move(done)] { begin(proof, done); }));
}

void FramedStream::begin(Proof proof, OnDone done) {
  if (!seal_) return done();
  const auto& hello = seal_->hello();
  const std::string own = proof == Proof::kWith ? seal_->proven_hello() : std::string(hello.begin(), hello.end());
  write_frame(own, [this, done = std::move(done)] {
    // An open peer does not understand the hello and answers by a sentence, so that more than a key has to be read.
    read_frame(std::max(frame_max_bytes_, seal::StreamSeal::kHello_bytes), [this, done](const std::string& others) {
      if (seal_->take_hello(others)) return done();
      if (others == std::string{static_cast<char>(Refused::kOtherKey)}) refused_ = Refused::kOtherKey;
      if (others == std::string{static_cast<char>(Refused::kNoPlace)}) refused_ = Refused::kNoPlace;
      is_open_there_ = !refused_ && others.size() != seal::StreamSeal::kHello_bytes;
      fail("its first frame is no key: one side of the connection is open");
    });
  });
}

void FramedStream::read_hello(OnFrame on_frame) { read_frame(kFirstFrameMax_bytes, std::move(on_frame)); }

// An open side is answered, too: by the hello it sees that this one is sealed.
void FramedStream::answer_hello(seal::StreamSeal seal, const std::string& hello, OnDone done) {
  assert(!seal_);
  seal_ = std::move(seal);
  const bool is_key = seal_->take_hello(std::string_view(hello).substr(
      0, seal::StreamSeal::has_proof(hello) ? seal::StreamSeal::kHello_bytes : hello.size()));
  const auto& own = seal_->hello();
  write_frame({reinterpret_cast<const char*>(own.data()), own.size()}, [this, is_key, done = std::move(done)] {
    if (!is_key) return fail("its first frame is no key: one side of the connection is open");
    done();
  });
}

void FramedStream::refuse(Refused why, std::string_view hello) {
  if (!seal::StreamSeal::has_proof(hello)) {
    // Later, as whoever refuses may not expect the handler of failures yet.
    return asio::post(socket_.get_executor(), [self = shared_from_this()] { self->fail("it was refused"); });
  }
  write_frame(std::string{static_cast<char>(why)}, [this] { fail("it was refused"); });
}

void FramedStream::read(OnFrame on_frame) {
  if (!seal_) return read_frame(frame_max_bytes_, std::move(on_frame));
  read_frame(frame_max_bytes_ + seal::StreamSeal::kAdded_bytes,
             [this, on_frame = std::move(on_frame)](const std::string& sealed) {
               auto frame = seal_->open(sealed);
               if (!frame) return fail("a frame is not opened by this peer's key");
               is_proven_ = true;
               on_frame(*std::move(frame));
             });
}

void FramedStream::read_frame(std::size_t max_bytes, OnFrame on_frame) {
  asio::async_read(socket_, asio::buffer(head_),
                   guarded([this, max_bytes, on_frame = std::move(on_frame)] { read_content(max_bytes, on_frame); }));
}

void FramedStream::read_content(std::size_t max_bytes, OnFrame on_frame) {
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < head_.size(); ++i) size |= std::uint32_t{head_[i]} << (8 * i);
  if (size > max_bytes) return fail("a frame is too long");
  in_.clear();  // it grows as bytes come, so that a size alone costs no memory
  asio::async_read(socket_, asio::dynamic_buffer(in_, size), asio::transfer_exactly(size),
                   guarded([this, on_frame = std::move(on_frame)] { on_frame(std::exchange(in_, {})); }));
}

void FramedStream::write(const std::string& content, OnDone done) {
  if (seal_) return write_frame(seal_->seal(content), std::move(done));
  write_frame(content, std::move(done));
}

void FramedStream::write_frame(std::string_view content, OnDone done) {
  assert(content.size() <= UINT32_MAX);
  out_.clear();
  for (int shift = 0; shift < 32; shift += 8) out_ += static_cast<char>(content.size() >> shift & 0xff);
  out_ += content;
  asio::async_write(socket_, asio::buffer(out_), guarded(std::move(done)));
}

asio::ip::address FramedStream::remote() const {
  error_code over;
  const auto at = socket_.remote_endpoint(over);
  return over ? asio::ip::address() : at.address();
}

void FramedStream::close() {
  over_ = true;
  error_code ignored;
  socket_.close(ignored);
  deadline_.cancel();
}

void FramedStream::fail(const std::string& why) {
  if (over_) return;
  close();
  on_failure_(why);
}

void FramedStream::await() {
  deadline_.expires_after(patience_);
  deadline_.async_wait([self = weak_from_this()](const error_code& cancelled) {
    const auto stream = self.lock();
    if (!cancelled && stream != nullptr) stream->fail("nothing came for too long");
  });
}

}  // namespace peerd::snapshot

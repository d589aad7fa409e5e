#include "peerd/view/gateway/gzip.hpp"

#include <zlib.h>

#include <array>
#include <cassert>

namespace peerd::gateway {
namespace {

constexpr int kGzip = 16;  // zlib's way to ask for gzip's header

}  // namespace

std::string gunzip(std::string_view packed) {
  z_stream stream{};
  [[maybe_unused]] int state = inflateInit2(&stream, MAX_WBITS + kGzip);
  assert(state == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // which zlib only reads
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string bytes;
  std::array<char, 65'536> part{};
  do {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = part.size();
    state = inflate(&stream, Z_NO_FLUSH);
    assert(state == Z_OK || state == Z_STREAM_END);
    bytes.append(part.data(), part.size() - stream.avail_out);
  } while (state == Z_OK);
  inflateEnd(&stream);
  return bytes;
}

}  // namespace peerd::gateway

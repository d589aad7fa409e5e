#include "core/vrml/gzip.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>

namespace peerd {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::expected<std::string, std::string> gunzip(std::string_view bytes, std::size_t max_bytes, std::string_view advice) {
  const auto too_large = [&] {
    return "it unpacks to more than " + std::to_string(max_bytes) + " bytes" + std::string(advice);
  };
  constexpr std::string_view kCut = "the gzip file ends in the middle";
  z_stream stream{};
  constexpr int kGzipOnly = 15 + 16;  // window bits, as zlib.h has it
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) return std::unexpected("zlib cannot start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);

  std::string out;
  constexpr std::size_t kLargestChunk = std::numeric_limits<uInt>::max() / 2;
  // A byte of deflated data stands for at most 1,032 bytes; most stand for fewer than 8.
  std::size_t next = std::min(8 * bytes.size() + 64, max_bytes);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  std::size_t left = bytes.size();
  while (true) {
    const std::size_t before = out.size();
    const std::size_t room = std::min({next, kLargestChunk, max_bytes + 1 - before});
    if (room == 0) return std::unexpected(too_large());
    out.resize(before + room);
    const std::size_t feed = std::min(left, kLargestChunk);
    stream.avail_in = static_cast<uInt>(feed);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(room);
    const int result = inflate(&stream, Z_NO_FLUSH);
    left -= feed - stream.avail_in;
    out.resize(before + room - stream.avail_out);
    if (result == Z_STREAM_END) {
      // Another member may follow. Zeros that pad to the end of a block, as tapes have them, and other bytes don't
      // count.
      if (left < 2 || !is_gzip(bytes.substr(bytes.size() - left))) break;
      if (inflateReset(&stream) != Z_OK) return std::unexpected("zlib cannot go on");
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      return std::unexpected(std::string("the gzip file is damaged: ") +
                             (stream.msg != nullptr ? stream.msg : "unknown"));
    } else if (left == 0 && (result == Z_BUF_ERROR || stream.avail_out > 0)) {
      return std::unexpected(std::string(kCut));
    }
    next = std::max<std::size_t>(out.size() / 2, 4096);
  }
  if (out.size() > max_bytes) return std::unexpected(too_large());
  out.shrink_to_fit();
  return out;
}

}  // namespace peerd

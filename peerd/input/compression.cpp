#include "peerd/input/compression.hpp"

#include <zstd.h>

#include <cassert>

namespace peerd {
namespace {

// The fastest of zstd's ordinary levels: VRML texts become a fifth, and a higher level gains a tenth of that.
constexpr int kLevel = 1;
// A block of a frame takes at least four bytes and unpacks to at most so many (RFC 8878, 3.1.1.2): a frame that says
// that it has more lies, and gets no memory for it.
constexpr unsigned long long kBlock_bytes = ZSTD_BLOCKSIZE_MAX, kBlockLeast_bytes = 4;

}  // namespace

std::string compress(std::string_view bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kLevel);
  assert(ZSTD_isError(size) == 0);  // the bound is of zstd itself
  frame.resize(size);
  return frame;
}

std::expected<std::string, std::string> decompress(std::string_view frame, std::size_t most) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) {
    return std::unexpected("it is no frame of zstd that says its size");
  }
  if (size > most) return std::unexpected("it would unpack to more than " + std::to_string(most) + " bytes");
  if (size > kBlock_bytes * (frame.size() / kBlockLeast_bytes + 1))
    return std::unexpected("it says that it is longer than it can be");
  if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size()) {
    return std::unexpected("it is cut short, or something follows it");
  }
  std::string bytes(size, '\0');
  const std::size_t got = ZSTD_decompress(bytes.data(), bytes.size(), frame.data(), frame.size());
  if (ZSTD_isError(got) != 0) return std::unexpected(std::string("it is damaged: ") + ZSTD_getErrorName(got));
  if (got != size) return std::unexpected("it is shorter than it says");
  return bytes;
}

}  // namespace peerd

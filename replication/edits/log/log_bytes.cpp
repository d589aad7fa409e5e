#include "replication/edits/log/log_bytes.hpp"

#include <zstd.h>

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

// zstd's default level.
constexpr int kLevel = 3;

}  // namespace

std::span<const std::byte> LogBytes::Unpacked::operator()(std::span<const std::byte> frame) {
  auto entry = std::ranges::find(entries_, frame.data(), &Entry::frame);
  if (entry == entries_.end()) {
    --entry;  // the one that was not used for longest
    entry->frame = frame.data();
    entry->bytes.resize(kBlock_bytes);
    [[maybe_unused]] const std::size_t size =
        ZSTD_decompress(entry->bytes.data(), kBlock_bytes, frame.data(), frame.size());
    assert(size == kBlock_bytes);  // it was packed here
  }
  std::rotate(entries_.begin(), entry, std::next(entry));
  return entries_.front().bytes;
}

void LogBytes::append(std::span<const std::byte> bytes) { last_.insert(last_.end(), bytes.begin(), bytes.end()); }

void LogBytes::pack(std::uint64_t final) {
  assert(final >= packed_size() && final <= size());
  const std::size_t blocks = (final - packed_size()) / kBlock_bytes;
  if (blocks < 2) return;  // the newest bytes are those that are asked for
  std::vector<std::byte> frame(ZSTD_compressBound(kBlock_bytes));
  for (std::size_t block = 0; block + 1 < blocks; ++block) {
    const auto bytes = std::span(last_).subspan(block * kBlock_bytes, kBlock_bytes);
    const std::size_t size = ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kLevel);
    assert(ZSTD_isError(size) == 0);  // the bound is of zstd itself
    Frame& packed =
        frames_.emplace_back(std::make_unique_for_overwrite<std::byte[]>(size), static_cast<std::uint32_t>(size));
    std::copy_n(frame.begin(), size, packed.bytes.get());
  }
  last_ = std::vector(last_.begin() + static_cast<std::ptrdiff_t>((blocks - 1) * kBlock_bytes), last_.end());
}

void LogBytes::cut(std::uint64_t size) {
  assert(size >= packed_size() && size <= this->size());
  last_.resize(size - packed_size());
}

std::span<const std::byte> LogBytes::rest(std::uint64_t from) const {
  assert(from >= packed_size() && from <= size());
  return std::span(last_).subspan(from - packed_size());
}

std::vector<std::byte> LogBytes::copy(std::uint64_t from, std::uint64_t to, Unpacked& unpacked) const {
  assert(from <= to && to <= size());
  std::vector<std::byte> bytes;
  bytes.reserve(to - from);
  while (from < to) {
    const std::size_t block = from / kBlock_bytes;
    const bool is_packed = block < frames_.size();
    const auto held = is_packed ? unpacked({frames_[block].bytes.get(), frames_[block].size}) : std::span(last_);
    const std::uint64_t begin = is_packed ? block * kBlock_bytes : packed_size();
    const std::uint64_t end = std::min<std::uint64_t>(to, begin + held.size());
    const auto part = held.subspan(from - begin, end - from);
    bytes.insert(bytes.end(), part.begin(), part.end());
    from = end;
  }
  return bytes;
}

}  // namespace peerd::replication

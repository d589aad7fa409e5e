#include "replication/wire/operation_lists.hpp"

#include <cassert>

#include "replication/wire/varint.hpp"

namespace peerd::replication {
namespace {

void append_varint(std::uint64_t value, std::string& bytes) {
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<char>((value & 127) | 128));
  bytes.push_back(static_cast<char>(value));
}

std::size_t varint_bytes(std::uint64_t value) {
  std::size_t count = 1;
  for (; value >= 128; value >>= 7) ++count;
  return count;
}

[[nodiscard]] bool take_author(BitReader& in, AuthorId& author) {
  return take_varint(in, author.value) && author != kNoAuthor && author.value <= kAuthorMax;
}

// The beginning of a range, and its size, which is > 0.
[[nodiscard]] bool take_extent(BitReader& in, std::uint64_t& from, std::uint64_t& size) {
  return take_varint(in, from) && take_varint(in, size) && size > 0 && from <= kLogMax_bytes &&
         size <= kLogMax_bytes - from;
}

}  // namespace

std::string packed(std::span<const LogLength> logs) {
  std::string bytes;
  std::uint32_t last = 0;
  for (const LogLength& log : logs) {
    assert(log.author.value > last && log.bytes > 0 && log.bytes <= kLogMax_bytes);
    append_varint(log.author.value - last, bytes);
    append_varint(log.bytes, bytes);
    last = log.author.value;
  }
  return bytes;
}

bool take_logs(std::string_view bytes, std::vector<LogLength>& logs) {
  BitReader in(std::as_bytes(std::span(bytes)));
  std::uint32_t last = 0;
  while (in.size_bytes() < bytes.size()) {
    std::uint32_t more = 0;
    std::uint64_t length = 0;
    if (logs.size() == kLogLengthsMax || !take_varint(in, more) || !take_varint(in, length) || !in.good()) return false;
    if (more == 0 || more > kAuthorMax - last || length == 0 || length > kLogMax_bytes) return false;
    last += more;
    logs.push_back({AuthorId{last}, length});
  }
  return true;
}

std::string packed(std::span<const OperationPart> parts) {
  std::string bytes;
  for (const OperationPart& part : parts) {
    assert(part.author != kNoAuthor && !part.bytes.empty());
    append_varint(part.author.value, bytes);
    append_varint(part.from, bytes);
    append_varint(part.bytes.size(), bytes);
    bytes.append(reinterpret_cast<const char*>(part.bytes.data()), part.bytes.size());
  }
  return bytes;
}

bool take_parts(std::string_view bytes, std::vector<OperationPart>& parts) {
  std::span<const std::byte> rest = std::as_bytes(std::span(bytes));
  while (!rest.empty()) {
    if (parts.size() == kOperationPartsMax) return false;
    OperationPart& part = parts.emplace_back();
    BitReader in(rest);
    std::uint64_t size = 0;
    if (!take_author(in, part.author) || !take_extent(in, part.from, size) || !in.good()) return false;
    rest = rest.subspan(in.size_bytes());
    if (size > rest.size()) return false;
    part.bytes.assign(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
    rest = rest.subspan(size);
  }
  return true;
}

std::string packed(std::span<const OperationRange> ranges) {
  std::string bytes;
  for (const OperationRange& range : ranges) {
    assert(range.author != kNoAuthor && range.from < range.to);
    append_varint(range.author.value, bytes);
    append_varint(range.from, bytes);
    append_varint(range.to - range.from, bytes);
  }
  return bytes;
}

bool take_ranges(std::string_view bytes, std::vector<OperationRange>& ranges) {
  BitReader in(std::as_bytes(std::span(bytes)));
  while (in.size_bytes() < bytes.size()) {
    if (ranges.size() == kOperationRangesMax) return false;
    OperationRange& range = ranges.emplace_back();
    std::uint64_t size = 0;
    if (!take_author(in, range.author) || !take_extent(in, range.from, size) || !in.good()) return false;
    range.to = range.from + size;
  }
  return true;
}

std::size_t encoded_size_bytes(AuthorId before, const LogLength& log) {
  assert(before < log.author);
  return varint_bytes(log.author.value - before.value) + varint_bytes(log.bytes);
}

std::size_t part_header_bytes(const OperationRange& of_part) { return encoded_size_bytes(of_part); }

std::size_t encoded_size_bytes(const OperationRange& range) {
  assert(range.from < range.to);
  return varint_bytes(range.author.value) + varint_bytes(range.from) + varint_bytes(range.to - range.from);
}

}  // namespace peerd::replication

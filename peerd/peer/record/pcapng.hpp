#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"

namespace peerd::record {

// The blocks of a pcapng file (draft-ietf-opsawg-pcapng) that a capture needs: one section, its interfaces, packets.
//
//   0           4            8                               length - 4    length
//   +-----------+------------+- - - - - - - - - - - - - - - - - -+-----------+
//   | type      | length     | body, options, all multiples of 4 | length    |
//   +-----------+------------+- - - - - - - - - - - - - - - - - -+-----------+
//
// Each number is in the writer's byte order, which the magic number of the section header shows.

enum class LinkType : std::uint16_t {
  kRawIp = 101,  // a packet begins with its IPv4 or IPv6 header
  kUser0 = 147,  // reserved for private use
};

enum class Direction : std::uint8_t { kUnknown = 0, kIn = 1, kOut = 2 };

// Writes in this machine's byte order, with times in nanoseconds since 1970. The state of the stream shows write
// errors.
class PcapngWriter {
 public:
  // Writes the section header.
  PcapngWriter(std::ostream& out, std::string_view program, std::string_view comment);
  // Interfaces count from 0, in the order of these calls.
  void interface(LinkType link, std::string_view name, std::string_view description);
  // `at` is not before 1970.
  void packet(std::uint32_t interface, HostTime at, Direction direction, std::span<const std::byte> bytes);

 private:
  void block(std::uint32_t type);  // writes body_ as a block, and empties it

  std::ostream& out_;
  std::vector<std::byte> body_;
};

struct PcapngPacket {
  LinkType link;  // of the packet's interface; any number, not only the enumerators
  HostTime at;
  Direction direction;
  std::span<const std::byte> bytes;
};

// Reads files of either byte order, of one section, with times in nanoseconds. It skips unknown blocks and options. The
// file is hostile input.
class PcapngReader {
 public:
  // `file` outlives the reader and the packets.
  explicit PcapngReader(std::span<const std::byte> file) : rest_(file), size_bytes_(file.size()) {}
  // Returns the next packet, and none at the end. The error, one sentence, says where and why the file is unreadable.
  [[nodiscard]] std::expected<std::optional<PcapngPacket>, std::string> next();
  // After the end: whether the file stops inside of a block, because its writer was stopped. Whole blocks count.
  [[nodiscard]] bool cut_off() const { return cut_off_; }

 private:
  using Body = std::span<const std::byte>;
  using Done = std::expected<void, std::string>;
  [[nodiscard]] std::uint32_t number32(Body bytes, std::size_t at) const;
  [[nodiscard]] std::uint16_t number16(Body bytes, std::size_t at) const;
  [[nodiscard]] std::string where(const std::string& what) const;
  Done take_section(Body body);
  Done take_interface(Body body);
  std::expected<PcapngPacket, std::string> take_packet(Body body) const;
  // Calls take(code, value) for each option until the end of options.
  template <class Take>
  Done take_options(Body options, Take take) const;

  std::span<const std::byte> rest_;
  std::size_t size_bytes_;
  std::size_t block_at_ = 0;
  bool in_section_ = false, swapped_ = false, cut_off_ = false;
  std::vector<LinkType> links_;
};

}  // namespace peerd::record

#include "peerd/peer/record/pcapng.hpp"

#include <bit>
#include <cassert>
#include <cstring>
#include <limits>
#include <ostream>

namespace peerd::record {
namespace {

constexpr std::uint32_t kSectionHeader = 0x0A0D0D0A, kInterface = 1, kEnhancedPacket = 6;
constexpr std::uint32_t kMagic = 0x1A2B3C4D;
constexpr std::uint16_t kMajorVersion = 1;
// The codes of options, which depend on the block.
constexpr std::uint16_t kEndOfOptions = 0, kComment = 1;
constexpr std::uint16_t kSectionProgram = 4;
constexpr std::uint16_t kInterfaceName = 2, kInterfaceDescription = 3, kTimeResolution = 9;
constexpr std::uint16_t kPacketFlags = 2;
constexpr std::byte kNanoseconds{9};  // 10^-9
constexpr std::size_t kBlockFrame_bytes = 12;
constexpr std::size_t kPadding_bytes = 4;  // blocks, options and packets begin at multiples

constexpr std::size_t padded(std::size_t size_bytes) {
  return (size_bytes + kPadding_bytes - 1) / kPadding_bytes * kPadding_bytes;
}

// ---- writing ----

template <class Number>
void put(std::vector<std::byte>& out, Number value) {
  const auto bytes = std::bit_cast<std::array<std::byte, sizeof value>>(value);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void put_padded(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
  out.resize(padded(out.size()));
}

void put_option(std::vector<std::byte>& out, std::uint16_t code, std::span<const std::byte> value) {
  value = value.first(std::min<std::size_t>(value.size(), std::numeric_limits<std::uint16_t>::max()));
  put(out, code);
  put(out, static_cast<std::uint16_t>(value.size()));
  put_padded(out, value);
}

void put_option(std::vector<std::byte>& out, std::uint16_t code, std::string_view text) {
  if (!text.empty()) put_option(out, code, std::as_bytes(std::span(text)));
}

void end_options(std::vector<std::byte>& out) { put(out, std::uint32_t{kEndOfOptions}); }

}  // namespace

PcapngWriter::PcapngWriter(std::ostream& out, std::string_view program, std::string_view comment) : out_(out) {
  put(body_, kMagic);
  put(body_, kMajorVersion);
  put(body_, std::uint16_t{0});                           // minor
  put(body_, std::numeric_limits<std::uint64_t>::max());  // the section's length is unspecified
  put_option(body_, kSectionProgram, program);
  put_option(body_, kComment, comment);
  end_options(body_);
  block(kSectionHeader);
}

void PcapngWriter::interface(LinkType link, std::string_view name, std::string_view description) {
  put(body_, static_cast<std::uint16_t>(link));
  put(body_, std::uint16_t{0});
  put(body_, std::uint32_t{0});  // packets are not truncated
  put_option(body_, kInterfaceName, name);
  put_option(body_, kInterfaceDescription, description);
  put_option(body_, kTimeResolution, std::span(&kNanoseconds, 1));
  end_options(body_);
  block(kInterface);
}

void PcapngWriter::packet(std::uint32_t interface, HostTime at, Direction direction, std::span<const std::byte> bytes) {
  assert(at >= HostTime{} && bytes.size() <= std::numeric_limits<std::uint32_t>::max());
  const auto ns = static_cast<std::uint64_t>(at.time_since_epoch().count());
  const auto size = static_cast<std::uint32_t>(bytes.size());
  put(body_, interface);
  put(body_, static_cast<std::uint32_t>(ns >> 32));
  put(body_, static_cast<std::uint32_t>(ns));
  put(body_, size);  // captured length
  put(body_, size);  // original length
  put_padded(body_, bytes);
  if (direction != Direction::kUnknown) {
    const auto flags = static_cast<std::uint32_t>(direction);
    put_option(body_, kPacketFlags, std::as_bytes(std::span(&flags, 1)));
    end_options(body_);
  }
  block(kEnhancedPacket);
}

void PcapngWriter::block(std::uint32_t type) {
  const auto length = static_cast<std::uint32_t>(body_.size() + kBlockFrame_bytes);
  const std::array<std::uint32_t, 2> head{type, length};
  out_.write(reinterpret_cast<const char*>(head.data()), sizeof head);
  out_.write(reinterpret_cast<const char*>(body_.data()), static_cast<std::streamsize>(body_.size()));
  out_.write(reinterpret_cast<const char*>(&length), sizeof length);
  body_.clear();
}

// ---- reading ----

std::uint32_t PcapngReader::number32(Body bytes, std::size_t at) const {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.subspan(at, sizeof value).data(), sizeof value);
  return swapped_ ? __builtin_bswap32(value) : value;
}

std::uint16_t PcapngReader::number16(Body bytes, std::size_t at) const {
  std::uint16_t value = 0;
  std::memcpy(&value, bytes.subspan(at, sizeof value).data(), sizeof value);
  return swapped_ ? __builtin_bswap16(value) : value;
}

std::string PcapngReader::where(const std::string& what) const {
  return "at byte " + std::to_string(block_at_) + ": " + what;
}

template <class Take>
PcapngReader::Done PcapngReader::take_options(Body options, Take take) const {
  while (!options.empty()) {
    if (options.size() < 4) return std::unexpected(where("an option is cut short"));
    const std::uint16_t code = number16(options, 0);
    const std::size_t size = number16(options, 2);
    if (code == kEndOfOptions) return {};
    options = options.subspan(4);
    if (padded(size) > options.size()) return std::unexpected(where("an option is longer than its block"));
    if (auto done = take(code, options.first(size)); !done) return done;
    options = options.subspan(padded(size));
  }
  return {};
}

// next() has found the byte order, which it needs for the block's length.
PcapngReader::Done PcapngReader::take_section(Body body) {
  if (in_section_) return std::unexpected(where("a second section begins: two files have been joined"));
  if (body.size() < 16) return std::unexpected(where("the section header is too short"));
  if (number16(body, 4) != kMajorVersion) {
    return std::unexpected(where("pcapng of version " + std::to_string(number16(body, 4)) + ", not 1"));
  }
  in_section_ = true;
  return {};
}

PcapngReader::Done PcapngReader::take_interface(Body body) {
  if (body.size() < 8) return std::unexpected(where("an interface's block is too short"));
  bool nanoseconds = false;
  const auto done = take_options(body.subspan(8), [&](std::uint16_t code, Body value) -> Done {
    if (code == kTimeResolution) nanoseconds = value.size() == 1 && value[0] == kNanoseconds;
    return {};
  });
  if (!done) return done;
  if (!nanoseconds) return std::unexpected(where("an interface's times are not in nanoseconds"));
  links_.push_back(static_cast<LinkType>(number16(body, 0)));
  return {};
}

std::expected<PcapngPacket, std::string> PcapngReader::take_packet(Body body) const {
  constexpr std::size_t kFixed_bytes = 20;
  if (body.size() < kFixed_bytes) return std::unexpected(where("a packet's block is too short"));
  const std::uint32_t interface = number32(body, 0);
  const std::uint64_t ns = std::uint64_t{number32(body, 4)} << 32 | number32(body, 8);
  const std::size_t size = number32(body, 12);
  if (interface >= links_.size()) return std::unexpected(where("a packet of an interface that was not described"));
  if (ns > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    return std::unexpected(where("a packet's time is beyond the year 2262"));
  }
  if (size > body.size() - kFixed_bytes || padded(size) > body.size() - kFixed_bytes) {
    return std::unexpected(where("a packet is longer than its block"));
  }
  if (size != number32(body, 16)) return std::unexpected(where("a packet was captured in part"));
  PcapngPacket packet{links_[interface], HostTime{Duration{static_cast<std::int64_t>(ns)}}, Direction::kUnknown,
                      body.subspan(kFixed_bytes, size)};
  const auto done =
      take_options(body.subspan(kFixed_bytes + padded(size)), [&](std::uint16_t code, Body value) -> Done {
        if (code != kPacketFlags) return {};
        if (value.size() != 4) return std::unexpected(where("a packet's flags are not 4 bytes"));
        const std::uint32_t direction = number32(value, 0) & 3;
        if (direction != 3) packet.direction = static_cast<Direction>(direction);
        return {};
      });
  if (!done) return std::unexpected(done.error());
  return packet;
}

std::expected<std::optional<PcapngPacket>, std::string> PcapngReader::next() {
  while (!rest_.empty()) {
    block_at_ = size_bytes_ - rest_.size();
    if (rest_.size() < kBlockFrame_bytes) {
      if (!in_section_) return std::unexpected(where("this is no pcapng file"));
      break;
    }
    const std::uint32_t type = number32(rest_, 0);
    if (type == kSectionHeader) {  // this number is the same in both byte orders
      const std::uint32_t magic = number32(rest_, 8);
      if (magic == __builtin_bswap32(kMagic)) {
        swapped_ = !swapped_;
      } else if (magic != kMagic) {
        return std::unexpected(where("this is no pcapng file"));
      }
    } else if (!in_section_) {
      return std::unexpected(where("this is no pcapng file"));
    }
    const std::size_t length = number32(rest_, 4);
    if (length < kBlockFrame_bytes || length % kPadding_bytes != 0) {
      return std::unexpected(where("a block of " + std::to_string(length) + " bytes"));
    }
    if (length > rest_.size()) break;
    if (number32(rest_, length - 4) != length) return std::unexpected(where("a block's two lengths differ"));
    const Body body = rest_.subspan(8, length - kBlockFrame_bytes);
    rest_ = rest_.subspan(length);
    if (type == kEnhancedPacket) {
      auto packet = take_packet(body);
      if (!packet) return std::unexpected(packet.error());
      return *packet;
    }
    Done done;
    if (type == kSectionHeader) done = take_section(body);
    if (type == kInterface) done = take_interface(body);
    if (!done) return std::unexpected(done.error());
  }
  cut_off_ = !rest_.empty();
  rest_ = {};
  return std::nullopt;
}

}  // namespace peerd::record

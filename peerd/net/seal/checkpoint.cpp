#include "peerd/net/seal/checkpoint.hpp"

#include <sodium.h>

#include <algorithm>
#include <optional>

#include "peerd/net/keys/little_endian.hpp"

namespace peerd::seal {
namespace {

// Which counters a checkpoint has prints of, and how long these are: all, or, where there are many, as many as two bits
// each leave room for, evenly spread from where the salt says.
class Layout {
 public:
  explicit Layout(const Checkpoint& checkpoint)
      : stride_((checkpoint.covers + kPrintsMax - 1) / kPrintsMax),
        begin_(stride_ == 0 ? 0 : checkpoint.salt % stride_),
        bits_(checkpoint.covers == 0 ? 0 : std::clamp<std::size_t>(kBits / checkpoint.covers, kBitsLeast, kBitsMost)) {
    keys::put(checkpoint.salt, std::span(key_).first<8>());
  }

  // The place of the print of a datagram, the n-th of those that are covered; none: it has none.
  [[nodiscard]] std::optional<std::size_t> place(std::uint64_t n) const {
    if (n % stride_ != begin_) return std::nullopt;
    const std::size_t at = static_cast<std::size_t>(n / stride_) * bits_;
    return at + bits_ <= kBits ? std::optional(at) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t print(const NumberedTag& datagram) const {
    std::array<std::uint8_t, 16> bytes{};
    keys::put(datagram.counter, std::span(bytes).first<8>());
    keys::put(datagram.tag, std::span(bytes).last<8>());
    std::array<std::uint8_t, crypto_shorthash_BYTES> hash{};
    crypto_shorthash(hash.data(), bytes.data(), bytes.size(), key_.data());
    return keys::get(hash) & ((std::uint64_t{1} << bits_) - 1);
  }
  [[nodiscard]] std::uint64_t read(const Checkpoint& from, std::size_t at) const {
    std::uint64_t print = 0;
    for (std::size_t i = 0; i < bits_; ++i) {
      print |= std::uint64_t{(from.prints.at((at + i) / 8) >> ((at + i) % 8)) & 1u} << i;
    }
    return print;
  }
  void write(std::uint64_t print, Checkpoint& to, std::size_t at) const {
    for (std::size_t i = 0; i < bits_; ++i) {
      to.prints.at((at + i) / 8) |= static_cast<std::uint8_t>(((print >> i) & 1) << ((at + i) % 8));
    }
  }

 private:
  static constexpr std::size_t kBits = 8 * Checkpoint::kPrints_bytes, kBitsLeast = 2, kBitsMost = 16;
  static constexpr std::uint64_t kPrintsMax = kBits / kBitsLeast;

  std::uint64_t stride_, begin_;
  std::size_t bits_;
  std::array<std::uint8_t, crypto_shorthash_KEYBYTES> key_{};
};

}  // namespace

NumberedTag numbered(std::uint64_t counter, Tag tag) { return {counter, keys::get(tag.first<8>())}; }

void SentDatagrams::note(std::uint64_t counter, Tag tag) {
  if (tags_.empty()) tags_.resize(kKept);
  tags_[counter % kKept] = numbered(counter, tag).tag;
  count_ = counter;
}

bool SentDatagrams::contains(const NumberedTag& datagram) const {
  if (datagram.counter == 0 || datagram.counter > count_ || datagram.counter + kKept <= count_) return false;
  return tags_[datagram.counter % kKept] == datagram.tag;
}

Checkpoint SentDatagrams::checkpoint() {
  Checkpoint checkpoint;
  checkpoint.covers = static_cast<std::uint32_t>(std::min<std::uint64_t>(count_ - before_last_, kKept));
  randombytes_buf(&checkpoint.salt, sizeof(checkpoint.salt));
  before_last_ = last_;
  last_ = count_;
  if (checkpoint.covers == 0) return checkpoint;
  const Layout layout(checkpoint);
  const std::uint64_t first = count_ - checkpoint.covers + 1;
  for (std::uint64_t n = 0; n < checkpoint.covers; ++n) {
    const auto place = layout.place(n);
    if (place) layout.write(layout.print({first + n, tags_[(first + n) % kKept]}), checkpoint, *place);
  }
  return checkpoint;
}

void HeardDatagrams::note(const NumberedTag& datagram, HostTime at) {
  if (heard_.size() >= kKept) heard_.erase(heard_.begin(), heard_.begin() + kKept / 2);
  heard_.push_back({datagram, at});
}

std::size_t HeardDatagrams::forged(const Checkpoint& checkpoint, std::uint64_t sent, HostTime now) {
  const std::uint64_t before = sent - std::min<std::uint64_t>(checkpoint.covers, sent);
  const Layout layout(checkpoint);
  const auto is_forged = [&](const Heard& heard) {
    const std::uint64_t counter = heard.datagram.counter;
    if (counter > sent) return heard.at + kAhead < now;
    if (counter <= before) return false;
    const auto place = layout.place(counter - before - 1);
    return place && layout.print(heard.datagram) != layout.read(checkpoint, *place);
  };
  const std::size_t forged = std::erase_if(heard_, is_forged);
  std::erase_if(heard_, [&](const Heard& heard) { return heard.datagram.counter <= before; });
  return forged;
}

}  // namespace peerd::seal

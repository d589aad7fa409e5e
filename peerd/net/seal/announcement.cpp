#include "peerd/net/seal/announcement.hpp"

#include <algorithm>
#include <cassert>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/keys/little_endian.hpp"
#include "peerd/net/os/datagram_limits.hpp"
#include "peerd/net/seal/nonce_seal.hpp"

namespace peerd::seal {
namespace {

constexpr std::string_view kAnnouncementUse = "announcement";
constexpr std::size_t kAnnouncedPeer_bytes = 4;
constexpr std::size_t kClear_bytes =
    1 + kAnnouncedPeer_bytes;  // the first bytes, which are authenticated and not encrypted
// The contents: fields of these sizes in this order, the names, the signature.
constexpr std::size_t kBoot_bytes = std::tuple_size_v<BootId>, kAnnouncedNumber_bytes = 8, kSent_bytes = 8,
                      kFlags_bytes = 1;
constexpr std::size_t kPrintSalt_bytes = 8, kCovers_bytes = 4;
constexpr std::size_t kFixed_bytes = kBoot_bytes + kAnnouncedNumber_bytes + kSent_bytes + kFlags_bytes +
                                     keys::PublicKey::kBytes + kPrintSalt_bytes + kCovers_bytes +
                                     Checkpoint::kPrints_bytes;
constexpr std::size_t kName_bytes = Named::kBytes + 1;
constexpr std::size_t kLeast_bytes =
    kClear_bytes + kFixed_bytes + keys::PublicKey::kSignature_bytes + kNonceSealAdded_bytes;
static_assert(kLeast_bytes + kNamesMax * kName_bytes <= kAnnouncementMax_bytes);
static_assert(kAnnouncementMax_bytes + net::kRegionHeaderBytes + net::kRelayHeaderBytes <= net::kSentDatagramMax_bytes);
static_assert(kLeast_bytes + (kNamesMax + 1) * kName_bytes > kAnnouncementMax_bytes);
constexpr std::uint8_t kSignsAll = 1;

// Writes fields one after the other.
class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_(out) {}
  void number(std::uint64_t number, std::size_t bytes) {
    out_.resize(out_.size() + bytes);
    keys::put(number, std::span(out_).last(bytes));
  }
  void bytes(std::span<const std::uint8_t> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

 private:
  std::vector<std::uint8_t>& out_;
};

// Reads fields that are known to be there.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> in) : in_(in) {}
  std::uint64_t number(std::size_t bytes) { return keys::get(take(bytes)); }
  template <std::size_t kSize>
  void bytes(std::array<std::uint8_t, kSize>& out) {
    std::ranges::copy(take(kSize), out.begin());
  }
  [[nodiscard]] bool is_at_end() const { return in_.empty(); }

 private:
  std::span<const std::uint8_t> take(std::size_t bytes) {
    const auto taken = in_.first(bytes);
    in_ = in_.subspan(bytes);
    return taken;
  }
  std::span<const std::uint8_t> in_;
};

// A signature is for one session: an announcement to another one is none to this one.
std::vector<std::uint8_t> with_session(std::vector<std::uint8_t> text, const keys::SymmetricKey& announcing) {
  const keys::SymmetricKey session = announcing.derived("signatures", {});
  text.insert(text.end(), session.data(), session.data() + keys::SymmetricKey::kBytes);
  return text;
}

}  // namespace

Named name_of(const BootId& boot, std::uint8_t flags) {
  Named name;
  std::copy_n(boot.begin(), Named::kBytes, name.boot.begin());
  name.flags = flags;
  return name;
}

keys::SymmetricKey announcing_key(const keys::SymmetricKey& session) { return session.derived("announcement", {}); }

std::vector<std::byte> seal_announcement(const Announcement& says, std::uint8_t kind,
                                         const keys::SymmetricKey& announcing, const keys::Identity& by) {
  std::vector<std::uint8_t> text;
  Writer write(text);
  write.number(kind, 1);
  write.number(says.sender.value, kAnnouncedPeer_bytes);
  write.bytes(says.boot);
  write.number(says.number, kAnnouncedNumber_bytes);
  write.number(says.sent, kSent_bytes);
  write.number(says.signs_all ? kSignsAll : 0, kFlags_bytes);
  write.bytes(says.key.bytes());
  write.number(says.checkpoint.salt, kPrintSalt_bytes);
  write.number(says.checkpoint.covers, kCovers_bytes);
  write.bytes(says.checkpoint.prints);
  for (const Named& name : std::span(says.names).first(std::min(kNamesMax, says.names.size()))) {
    write.bytes(name.boot);
    write.number(name.flags, 1);
  }
  write.bytes(by.sign(kAnnouncementUse, with_session(text, announcing)));
  auto announcement = seal_by_nonce(text, kClear_bytes, announcing);
  assert(announcement.size() <= kAnnouncementMax_bytes);
  return announcement;
}

std::optional<OpenedAnnouncement> OpenedAnnouncement::open(std::span<const std::byte> sealed,
                                                           const keys::SymmetricKey& announcing) {
  if (sealed.size() < kLeast_bytes || sealed.size() > kAnnouncementMax_bytes) return std::nullopt;
  auto text = open_by_nonce(sealed, kClear_bytes, announcing);
  if (!text) return std::nullopt;
  const std::size_t signed_bytes = text->size() - keys::PublicKey::kSignature_bytes;
  if ((signed_bytes - kClear_bytes - kFixed_bytes) % kName_bytes != 0) return std::nullopt;

  OpenedAnnouncement opened;
  std::ranges::copy(std::span(*text).subspan(signed_bytes), opened.signature_.begin());
  text->resize(signed_bytes);
  Announcement& says = opened.says_;
  Reader read{std::span(*text).subspan(1)};
  says.sender = PeerId{static_cast<std::uint32_t>(read.number(kAnnouncedPeer_bytes))};
  read.bytes(says.boot);
  says.number = read.number(kAnnouncedNumber_bytes);
  says.sent = read.number(kSent_bytes);
  says.signs_all = (read.number(kFlags_bytes) & kSignsAll) != 0;
  std::array<std::uint8_t, keys::PublicKey::kBytes> key{};
  read.bytes(key);
  says.key = keys::PublicKey(key);
  says.checkpoint.salt = read.number(kPrintSalt_bytes);
  says.checkpoint.covers = static_cast<std::uint32_t>(read.number(kCovers_bytes));
  read.bytes(says.checkpoint.prints);
  while (!read.is_at_end()) {
    Named& name = says.names.emplace_back();
    read.bytes(name.boot);
    name.flags = static_cast<std::uint8_t>(read.number(1));
  }
  opened.signed_ = with_session(*std::move(text), announcing);
  return opened;
}

bool OpenedAnnouncement::is_signed() const { return says_.key.has_signed(kAnnouncementUse, signed_, signature_); }

}  // namespace peerd::seal

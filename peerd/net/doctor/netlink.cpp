#include "peerd/net/doctor/netlink.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <vector>

namespace peerd::doctor {
namespace {

// The kernel answers a dump in parts of at most so many bytes (NLMSG_GOODSIZE), unless a larger buffer is offered.
constexpr std::size_t kPart_bytes = 32 * 1024;

constexpr std::size_t aligned(std::size_t size) { return (size + NLMSG_ALIGNTO - 1) & ~std::size_t{NLMSG_ALIGNTO - 1}; }

struct Socket {
  explicit Socket(int family) : fd(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, family)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd >= 0) close(fd);
  }
  int fd;
};

std::vector<std::byte> request(std::uint16_t type, std::span<const std::byte> body) {
  nlmsghdr header{};
  header.nlmsg_len = static_cast<std::uint32_t>(NLMSG_HDRLEN + body.size());
  header.nlmsg_type = type;
  header.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  std::vector<std::byte> bytes(header.nlmsg_len);
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!body.empty()) std::memcpy(bytes.data() + NLMSG_HDRLEN, body.data(), body.size());
  return bytes;
}

}  // namespace

std::string_view Attribute::text() const {
  const std::string_view all(reinterpret_cast<const char*>(value.data()), value.size());
  return all.substr(0, all.find('\0'));
}

void for_each_attribute(std::span<const std::byte> bytes, const std::function<void(const Attribute&)>& each) {
  while (bytes.size() >= sizeof(nlattr)) {
    nlattr header;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.nla_len < sizeof header || header.nla_len > bytes.size()) return;
    each({static_cast<std::uint16_t>(header.nla_type & NLA_TYPE_MASK),
          bytes.subspan(sizeof header, header.nla_len - sizeof header)});
    bytes = bytes.subspan(std::min(bytes.size(), aligned(header.nla_len)));
  }
}

std::expected<void, int> dump(int family, std::uint16_t type, std::span<const std::byte> body,
                              const std::function<void(std::uint16_t, std::span<const std::byte>)>& each) {
  const Socket socket(family);
  if (socket.fd < 0) return std::unexpected(errno);
  const auto asked = request(type, body);
  if (::send(socket.fd, asked.data(), asked.size(), 0) < 0) return std::unexpected(errno);
  std::vector<std::byte> part(kPart_bytes);
  for (;;) {
    const ssize_t size = recv(socket.fd, part.data(), part.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return std::unexpected(errno);
    std::span<const std::byte> rest(part.data(), static_cast<std::size_t>(size));
    if (rest.empty()) return std::unexpected(EIO);
    while (rest.size() >= sizeof(nlmsghdr)) {
      nlmsghdr header;
      std::memcpy(&header, rest.data(), sizeof header);
      if (header.nlmsg_len < NLMSG_HDRLEN || header.nlmsg_len > rest.size()) return std::unexpected(EIO);
      const auto content = rest.subspan(NLMSG_HDRLEN, header.nlmsg_len - NLMSG_HDRLEN);
      if (header.nlmsg_type == NLMSG_DONE) return {};
      if (header.nlmsg_type == NLMSG_ERROR) {
        int error = -EIO;
        if (content.size() >= sizeof error) std::memcpy(&error, content.data(), sizeof error);
        return std::unexpected(-error);
      }
      each(header.nlmsg_type, content);
      rest = rest.subspan(std::min(rest.size(), aligned(header.nlmsg_len)));
    }
  }
}

}  // namespace peerd::doctor

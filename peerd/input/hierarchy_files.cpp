#include "peerd/input/hierarchy_files.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include "collision/tree/hierarchy_file.hpp"
#include "peerd/input/world_file.hpp"

namespace peerd {
namespace {

std::string last_error() { return std::strerror(errno); }

// The path is judged by its name alone: a link in the world's folder may lead out of it, if its owner wants that.
std::expected<std::filesystem::path, std::string> path_in_folder_of(const std::filesystem::path& world,
                                                                    std::string_view url) {
  const auto named = local_path(url);
  if (!named) return std::unexpected("it is no file of this machine");
  const std::filesystem::path within = named->lexically_normal();
  if (within.is_absolute() || within.empty() || *within.begin() == "..") {
    return std::unexpected("it is not in the folder of the world");
  }
  return world.parent_path() / within;
}

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

std::expected<std::optional<collision::MappedFile>, std::string> map(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) {
    if (errno == ENOENT) return std::nullopt;
    return std::unexpected(last_error());
  }
  struct ::stat status {};
  if (::fstat(file.get(), &status) != 0) return std::unexpected(last_error());
  if (!S_ISREG(status.st_mode)) return std::unexpected("it is no regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return std::unexpected("it is empty");
  void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (address == MAP_FAILED) return std::unexpected(last_error());
  const std::shared_ptr<const void> owner(address, [size](void* a) { ::munmap(a, size); });
  return collision::MappedFile{owner, {static_cast<const std::byte*>(address), size}};
}

bool is_hierarchy_file(const std::filesystem::path& path) {
  std::array<char, collision::kHierarchyMagic.size()> magic{};
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // opening a pipe would wait for its writer
  std::ifstream in(path, std::ios::binary);
  return in.read(magic.data(), magic.size()) &&
         std::string_view(magic.data(), magic.size()) == collision::kHierarchyMagic;
}

}  // namespace

collision::HierarchyLoader mapped_hierarchies(const std::filesystem::path& world) {
  return [world](std::string_view url) -> std::expected<std::optional<collision::MappedFile>, std::string> {
    const auto path = path_in_folder_of(world, url);
    if (!path) return std::unexpected(path.error());
    return map(*path);
  };
}

std::expected<std::filesystem::path, std::string> write_hierarchy_file(const std::filesystem::path& world,
                                                                       std::string_view url, std::string_view bytes) {
  const auto path = path_in_folder_of(world, url);
  if (!path) return std::unexpected(path.error());
  std::error_code error;
  if (std::filesystem::exists(*path, error) && !is_hierarchy_file(*path)) {
    return std::unexpected("there is another file of that name");
  }
  std::string temporary = path->string() + ".XXXXXX";
  const Descriptor file(::mkostemp(temporary.data(), O_CLOEXEC));
  if (file.get() < 0) return std::unexpected(last_error());
  const auto fail = [&] {
    std::string why = last_error();
    ::unlink(temporary.c_str());
    return std::unexpected(std::move(why));
  };
  while (!bytes.empty()) {
    const ::ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  // mkostemp gives the new file to its owner alone, but files of a world are for everybody.
  if (::fchmod(file.get(), 0644) != 0 || ::rename(temporary.c_str(), path->c_str()) != 0) return fail();
  return *path;
}

}  // namespace peerd

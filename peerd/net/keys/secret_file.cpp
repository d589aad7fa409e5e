#include "peerd/net/keys/secret_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include <sodium.h>
#include <spdlog/fmt/fmt.h>

namespace peerd::keys {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOthers = S_IRWXG | S_IRWXO;

std::string why(int error) { return std::generic_category().message(error); }

// A descriptor that is closed where it ends.
class File {
 public:
  File(const fs::path& path, int flags) : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, S_IRUSR | S_IWUSR)) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (is_open()) ::close(descriptor_);
  }
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

// 0, or an errno.
int write_whole(const fs::path& path, std::string_view text) {
  const File file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.is_open()) return errno;
  while (!text.empty()) {
    const ssize_t written = ::write(file.get(), text.data(), text.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(file.get()) == 0 ? 0 : errno;
}

// Gives the line to the file unless another process has been faster. 0, or an errno.
int make_file(const fs::path& file, const std::string& line) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) return failed.value();
  fs::path draft = file;
  draft += fmt::format(".{}.{}", ::getpid(), randombytes_random());  // each thread has its own
  int error = write_whole(draft, line);
  if (error == 0 && ::link(draft.c_str(), file.c_str()) != 0 && errno != EEXIST) error = errno;
  ::unlink(draft.c_str());
  return error;
}

}  // namespace

InputError wrong_secret(const fs::path& file, const std::string& what, const std::string& predicate, int code) {
  return {"error: the " + what + " " + file.string() + " " + predicate, code};
}

Result<SecretText> read_private_line(const fs::path& file, const std::string& what) {
  const File opened(file, O_RDONLY);
  const auto refused = [&](const std::string& predicate, int code = 2) {
    return std::unexpected(wrong_secret(file, what, predicate, code));
  };
  if (!opened.is_open()) return refused("cannot be read: " + why(errno), kSystemFailed);
  struct stat found {};
  if (::fstat(opened.get(), &found) != 0) return refused("cannot be read: " + why(errno), kSystemFailed);
  if (!S_ISREG(found.st_mode)) return refused("is no file");
  if ((found.st_mode & kOthers) != 0) {
    return refused("may be read by other users of this computer; chmod 600 mends that");
  }
  SecretText text;
  bool ends_line = false;
  for (char c = 0;;) {
    const ssize_t size = ::read(opened.get(), &c, 1);
    if (size < 0) return refused("cannot be read: " + why(errno), kSystemFailed);
    if (size == 0) return text;
    // The end of a line counts where something follows it.
    if ((ends_line && !text.append('\n')) || (c != '\n' && !text.append(c))) return refused("is too long");
    ends_line = c == '\n';
  }
}

Result<void> make_private_line(const fs::path& file, const std::string& what, std::string line) {
  const int error = make_file(file, line);
  sodium_memzero(line.data(), line.size());
  if (error != 0) return std::unexpected(wrong_secret(file, what, "cannot be made: " + why(error), kSystemFailed));
  return {};
}

}  // namespace peerd::keys

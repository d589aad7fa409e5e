#include "peerd/keys/secret_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include <sodium.h>
#include <spdlog/fmt/fmt.h>

namespace peerd::seal {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOthers = S_IRWXG | S_IRWXO;
constexpr int kFailed = 3;

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
int make_file(const fs::path& file, std::string line) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) return failed.value();
  fs::path draft = file;
  line += '\n';
  draft += fmt::format(".{}.{}", ::getpid(), randombytes_random());  // each thread has its own
  int error = write_whole(draft, line);
  sodium_memzero(line.data(), line.size());
  if (error == 0 && ::link(draft.c_str(), file.c_str()) != 0 && errno != EEXIST) error = errno;
  ::unlink(draft.c_str());
  return error;
}

}  // namespace

Secret::Secret(std::string text) : text_(std::move(text)) {}

Secret::~Secret() { sodium_memzero(text_.data(), text_.size()); }

InputError SecretFile::wrong(const std::string& predicate, int code) const {
  return InputError{"error: the " + what + " " + path.string() + " " + predicate, code};
}

Result<Secret> read_secret(const SecretFile& file) {
  const auto wrong = [&](const std::string& predicate, int code = kFailed) {
    return std::unexpected(file.wrong(predicate, code));
  };
  const File opened(file.path, O_RDONLY);
  if (!opened.is_open()) return wrong("cannot be read: " + why(errno));
  struct stat found {};
  if (::fstat(opened.get(), &found) != 0) return wrong("cannot be read: " + why(errno));
  if (!S_ISREG(found.st_mode)) return wrong("is no file", 2);
  if ((found.st_mode & kOthers) != 0) {
    return wrong("may be read by other users of this computer; chmod 600 mends that", 2);
  }
  std::string text(kSecretMax_bytes + 1, '\0');
  const ssize_t size = ::read(opened.get(), text.data(), text.size());
  if (size < 0) return wrong("cannot be read: " + why(errno));
  Secret secret(std::move(text));
  secret.cut(static_cast<std::size_t>(size));
  return secret;
}

Result<void> make_secret(const SecretFile& file, const Secret& line) {
  const int error = make_file(file.path, std::string(line.line()));
  if (error != 0) return std::unexpected(file.wrong("cannot be made: " + why(error), kFailed));
  return {};
}

}  // namespace peerd::seal

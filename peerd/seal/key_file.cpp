#include "peerd/seal/key_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <sodium.h>
#include <spdlog/fmt/fmt.h>

#include "peerd/input/user_folder.hpp"

namespace peerd::seal {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOthers = S_IRWXG | S_IRWXO;
constexpr int kFailed = 3;

std::unexpected<InputError> wrong(const fs::path& file, const std::string& why, int code = kFailed,
                                  const std::string& what = "key") {
  return std::unexpected(InputError{"error: the " + what + " " + file.string() + " " + why, code});
}
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

// Gives the key to the file unless another process has been faster. 0, or an errno.
int make_file(const fs::path& file, const SymmetricKey& key) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) return failed.value();
  fs::path draft = file;
  std::string text = key.text() + "\n";
  draft += fmt::format(".{}.{}", ::getpid(), randombytes_random());  // each thread has its own
  int error = write_whole(draft, text);
  sodium_memzero(text.data(), text.size());
  if (error == 0 && ::link(draft.c_str(), file.c_str()) != 0 && errno != EEXIST) error = errno;
  ::unlink(draft.c_str());
  return error;
}

}  // namespace

std::optional<fs::path> default_key_file(const std::string& world) {
  const auto settings = user_folder("XDG_CONFIG_HOME", ".config");
  if (!settings) return std::nullopt;
  std::string name = world;
  std::ranges::replace(name, '/', '_');
  return *settings / "peerd" / "keys" / (name + ".key");
}

Result<fs::path> chosen_key_file(const fs::path& said, const std::string& world) {
  if (!said.empty()) return said;
  if (auto own = default_key_file(world)) return *std::move(own);
  return std::unexpected(InputError{"error: this user has no home for a key: say --key FILE, or --open", 2});
}

Result<SecretText> read_private_line(const fs::path& file, const std::string& what) {
  const File opened(file, O_RDONLY);
  const auto refused = [&](const std::string& why, int code = 2) { return wrong(file, why, code, what); };
  if (!opened.is_open()) return refused("cannot be read: " + why(errno), kFailed);
  struct stat found {};
  if (::fstat(opened.get(), &found) != 0) return refused("cannot be read: " + why(errno), kFailed);
  if (!S_ISREG(found.st_mode)) return refused("is no file");
  if ((found.st_mode & kOthers) != 0) {
    return refused("may be read by other users of this computer; chmod 600 mends that");
  }
  SecretText text;
  bool ends_line = false;
  for (char c = 0;;) {
    const ssize_t size = ::read(opened.get(), &c, 1);
    if (size < 0) return refused("cannot be read: " + why(errno), kFailed);
    if (size == 0) return text;
    // The end of a line counts where something follows it.
    if ((ends_line && !text.append('\n')) || (c != '\n' && !text.append(c))) return refused("is too long");
    ends_line = c == '\n';
  }
}

Result<SymmetricKey> read_key(const fs::path& file) {
  const auto line = read_private_line(file, "key");
  if (!line) return std::unexpected(line.error());
  const auto key = SymmetricKey::of_text(line->view());
  if (!key) return wrong(file, "has no key", 2);
  return *key;
}

Result<SymmetricKey> read_or_make_key(const fs::path& file) {
  std::error_code failed;
  if (!fs::exists(file, failed) && !failed) {
    if (const int error = make_file(file, SymmetricKey::random()); error != 0)
      return wrong(file, "cannot be made: " + why(error));
  }
  return read_key(file);
}

Result<void> keep_key(const fs::path& file, const SymmetricKey& key) {
  if (const int error = make_file(file, key); error != 0) return wrong(file, "cannot be made: " + why(error));
  const auto kept = read_key(file);
  if (!kept) return std::unexpected(kept.error());
  if (*kept != key) {
    return wrong(file, "is another one than that of the invitation, of another world of this name; move that file away",
                 2);
  }
  return {};
}

}  // namespace peerd::seal

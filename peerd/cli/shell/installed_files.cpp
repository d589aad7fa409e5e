#include "peerd/cli/shell/installed_files.hpp"

#include <algorithm>
#include <system_error>

namespace peerd {

namespace fs = std::filesystem;

InstalledFiles InstalledFiles::of_this_program(const fs::path& from_program) {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return InstalledFiles({});
  const fs::path folder = fs::weakly_canonical(program.parent_path() / from_program, failed);
  return InstalledFiles(!failed && fs::is_directory(folder, failed) ? folder : fs::path());
}

std::optional<fs::path> InstalledFiles::find(const std::string& word, const std::vector<std::string_view>& folders,
                                             std::string_view extension) const {
  std::error_code failed;
  if (folder_.empty() || word.empty() || word == "-" || word.find('/') != std::string::npos) return std::nullopt;
  if (fs::exists(word, failed)) return std::nullopt;
  for (const std::string_view folder : folders) {
    const fs::path with_word = folder_ / folder / word;
    for (const fs::path& file : {with_word, fs::path(with_word.string() + std::string(extension))}) {
      if (fs::is_regular_file(file, failed)) return file;
    }
  }
  return std::nullopt;
}

std::vector<fs::path> InstalledFiles::all(std::string_view folder, std::string_view extension) const {
  std::vector<fs::path> files;
  std::error_code failed;
  if (folder_.empty()) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / folder, failed)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

CLI::Validator InstalledFiles::or_installed(std::vector<std::string_view> folders, std::string_view extension) const {
  const auto replace = [files = *this, folders = std::move(folders), extension](std::string& word) {
    if (const auto found = files.find(word, folders, extension)) word = found->string();
    return std::string();
  };
  return {replace, ""};
}

}  // namespace peerd

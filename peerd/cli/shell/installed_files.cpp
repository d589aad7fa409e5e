#include "peerd/cli/shell/installed_files.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

namespace peerd {

namespace fs = std::filesystem;

namespace {

// The folder of a build's sources that is installed as PREFIX/share/peerd; empty where the program is in no build.
fs::path configs_of_build(const fs::path& build) {
  constexpr std::string_view kSources = "CMAKE_HOME_DIRECTORY:INTERNAL=";
  std::ifstream cache(build / "CMakeCache.txt");
  for (std::string line; std::getline(cache, line);) {
    if (line.starts_with(kSources)) return fs::path(line.substr(kSources.size())) / "configs";
  }
  return {};
}

}  // namespace

InstalledFiles InstalledFiles::of_this_program(const fs::path& from_program) {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return InstalledFiles({});
  const fs::path folder = fs::weakly_canonical(program.parent_path() / from_program, failed);
  if (!failed && fs::is_directory(folder, failed)) return InstalledFiles(folder);
  const fs::path configs = configs_of_build(program.parent_path().parent_path());
  return InstalledFiles(fs::is_directory(configs, failed) ? configs : fs::path());
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

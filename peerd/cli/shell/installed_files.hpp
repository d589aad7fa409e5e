#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace peerd {

// The files that are installed beside the program: PREFIX/share/peerd, wherever the program has been put. Its scenarios
// and worlds are found by their names. A program that has been built and not installed has those of its sources.
class InstalledFiles {
 public:
  // `from_program` leads from the program's folder to that of the files, such as ../share/peerd.
  [[nodiscard]] static InstalledFiles of_this_program(const std::filesystem::path& from_program);
  // Empty: there are none.
  explicit InstalledFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // The installed file that a word names, in the first of `folders` that has one, with the extension or without it.
  // None: the word has a slash or names something in the folder that one is in, so it means that; or there is none.
  [[nodiscard]] std::optional<std::filesystem::path> find(const std::string& word,
                                                          const std::vector<std::string_view>& folders,
                                                          std::string_view extension) const;

  // The installed files of one folder with that extension, by name.
  [[nodiscard]] std::vector<std::filesystem::path> all(std::string_view folder, std::string_view extension) const;

  // For CLI::Option::transform(): a word that names an installed file becomes its path.
  [[nodiscard]] CLI::Validator scenario() const { return or_installed({"scenarios"}, ".toml"); }
  [[nodiscard]] CLI::Validator settings() const { return or_installed({"baselines", ""}, ".toml"); }
  [[nodiscard]] CLI::Validator world() const { return or_installed({"worlds"}, ".wrl"); }

 private:
  [[nodiscard]] CLI::Validator or_installed(std::vector<std::string_view> folders, std::string_view extension) const;

  std::filesystem::path folder_;
};

}  // namespace peerd

#include "core/formats/draft/reading.hpp"

#include <memory>
#include <utility>

#include "core/formats/draft/base64.hpp"

namespace peerd::formats {

std::expected<std::string_view, std::string> Reading::load(std::string_view url, TextKind kind) {
  if (const auto known = loaded_.find(url); known != loaded_.end()) return known->second;
  if (!options.load) return std::unexpected("no other file is read here");
  if (reads_too_much_) return std::unexpected(std::string(kTooManyValues));
  std::expected<LoadedFile, std::string> file = options.load(url, problems.name_of(begin_));
  if (!file) return std::unexpected(file.error());
  if (const auto known = loaded_.find(file->name); known != loaded_.end()) {
    // One file has many URLs, and reading it for each of them costs time.
    reads_too_much_ = !take(Asked::kValues, file->bytes.size() / 4);
    if (reads_too_much_) return std::unexpected(std::string(kTooManyValues));
    return loaded_.emplace(url, known->second).first->second;
  }
  const std::uint64_t left = options.limits.text_bytes - std::min(problems.bytes(), options.limits.text_bytes);
  if (file->bytes.size() > left) return std::unexpected("the files of this world are together too large");
  Source source{file->name, {}, std::make_shared<const std::string>(std::move(file->bytes)), kind};
  source.text = *source.owned;
  const std::string_view bytes = source.text;
  if (!problems.open(std::move(source))) return std::unexpected("the files of this world are together too large");
  loaded_.emplace(url, bytes);
  loaded_.emplace(std::move(file->name), bytes);
  return bytes;
}

void Reading::lose(std::string_view what, std::string_view place) {
  const auto [it, is_new] = losses_.try_emplace(std::string(what));
  if (is_new) it->second.place = place;
  ++it->second.count;
}

void Reading::report_losses() {
  for (const auto& [what, loss] : losses_) {
    const std::size_t others = loss.count - 1;
    const std::string more = others == 0   ? ""
                             : others == 1 ? " and one other place"
                                           : " and " + std::to_string(others) + " other places";
    warn(0, loss.place + more + ": " + what);
  }
  losses_.clear();
}

std::expected<std::string, std::string> Reading::load_image(std::string_view url) {
  const auto bytes = load(url, TextKind::kBinary);
  if (!bytes) return std::unexpected(bytes.error());
  if (!take(Asked::kValues, bytes->size() / 3)) return std::unexpected(std::string(kTooManyValues));
  return image_url(*bytes);
}

}  // namespace peerd::formats

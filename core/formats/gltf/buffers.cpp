#include "core/formats/gltf/buffers.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/formats/draft/base64.hpp"

namespace peerd::formats::gltf {
namespace {

using Json = nlohmann::json;

std::string place(const char* list, std::size_t index) {
  return std::string(list) + "/" + std::to_string(index) + ": ";
}

// Takes the data: URIs out of a JSON text, for one may be most of a file and is not to be copied with the rest. The
// number N stands for the N-th of them: the uri of a file is never a number (property_kinds.hpp).
std::string without_data_urls(std::string_view json, std::vector<std::string_view>& urls) {
  std::string out;
  for (std::size_t at = 0; at < json.size();) {
    const std::size_t begin = std::min(json.find('"', at), json.size());
    std::size_t end = begin;  // of the string behind the quote
    do {
      end = std::min(json.find('"', end + 1), json.size());
    } while (end < json.size() && json[end - 1] == '\\');
    const std::string_view text = json.substr(std::min(begin + 1, json.size()), end > begin ? end - begin - 1 : 0);
    const std::size_t behind = json.find_first_not_of(" \t\r\n", std::min(end + 1, json.size()));
    const bool is_key = behind != std::string_view::npos && json[behind] == ':';
    const bool taken = text.starts_with("data:") && text.find('\\') == std::string_view::npos && !is_key;
    out += json.substr(at, begin - at);
    out += taken ? std::to_string(urls.size()) : std::string(json.substr(begin, end + 1 - begin));
    if (taken) urls.push_back(text);
    at = end + 1;
  }
  return out;
}

// Returns the objects of a list; nothing where it is none.
std::optional<Json> objects_of(std::string_view json, std::vector<std::string_view>& urls) {
  if (json.empty()) return Json::array();
  Json list = Json::parse(without_data_urls(json, urls), nullptr, false);
  if (!list.is_array()) return std::nullopt;
  for (const Json& one : list) {
    if (!one.is_object()) return std::nullopt;
  }
  return list;
}

std::string text_of(const Json& object, const char* key) {
  const auto it = object.find(key);
  return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

// Returns the URI of an object. A long one was taken out of the JSON and stands in `urls`; another is copied to `text`,
// which the result points into.
std::string_view uri_of(const Json& object, const std::vector<std::string_view>& urls, std::string& text) {
  text = text_of(object, "uri");
  const auto it = object.find("uri");
  if (it == object.end() || !it->is_number_unsigned()) return text;
  const auto number = it->get<std::uint64_t>();
  return number < urls.size() ? urls[number] : text;
}

}  // namespace

bool Buffers::read(std::string_view json, std::string_view binary, Reading& reading) {
  std::vector<std::string_view> urls;
  const auto list = objects_of(json, urls);
  if (!list) return reading.fail(0, "buffers: it is no list of objects");
  for (const Json& object : *list) {
    const std::string where = place("buffers", bytes_.size());
    const auto length = object.find("byteLength");
    if (length == object.end() || !length->is_number_unsigned()) return reading.fail(0, where + "it has no byteLength");
    const auto wanted = length->get<std::uint64_t>();
    std::string text;
    const std::string_view uri = uri_of(object, urls, text);
    std::string_view bytes;
    if (uri.empty()) {
      // A buffer without bytes is good glTF: an extension may give it some. What is read from it is an error there.
      if (!bytes_.empty() || binary.empty()) {
        reading.lose("it has no bytes: it has no uri, and the file no chunk for it",
                     "buffers/" + std::to_string(bytes_.size()));
        bytes_.emplace_back();
        continue;
      }
      bytes = binary;
    } else if (uri.starts_with("data:")) {
      auto decoded = bytes_of_data_url(uri);
      if (!decoded) return reading.fail(0, where + "its data: URI cannot be decoded");
      bytes = decoded_.emplace_back(std::move(*decoded));
    } else {
      const auto loaded = reading.load(uri, TextKind::kBinary);
      if (!loaded) return reading.fail(0, where + vrml::quoted(uri) + ": " + loaded.error());
      bytes = *loaded;
    }
    if (bytes.size() < wanted) {
      return reading.fail(
          0, where + "it must have " + std::to_string(wanted) + " bytes, and has " + std::to_string(bytes.size()));
    }
    bytes_.push_back(bytes.substr(0, wanted));
  }
  return true;
}

bool read_images(std::string_view json, Reading& reading, std::vector<ImageSource>& images) {
  std::vector<std::string_view> urls;
  const auto list = objects_of(json, urls);
  if (!list) return reading.fail(0, "images: it is no list of objects");
  for (const Json& object : *list) {
    std::string text;
    const std::string uri(uri_of(object, urls, text));
    ImageSource& image = images.emplace_back(ImageSource{uri, text_of(object, "mimeType"), -1});
    const auto view = object.find("bufferView");
    if (view == object.end()) continue;
    if (!view->is_number_unsigned() || view->get<std::uint64_t>() > std::numeric_limits<int>::max()) {
      return reading.fail(0, place("images", images.size() - 1) + "its bufferView is no index");
    }
    image.buffer_view = view->get<int>();
  }
  return true;
}

std::optional<std::string_view> bytes_of_view(const tinygltf::Model& model, const Buffers& buffers, int view) {
  if (view < 0 || static_cast<std::size_t>(view) >= model.bufferViews.size()) return std::nullopt;
  const tinygltf::BufferView& found = model.bufferViews[static_cast<std::size_t>(view)];
  if (found.buffer < 0 || static_cast<std::size_t>(found.buffer) >= buffers.count()) return std::nullopt;
  const std::string_view bytes = buffers[static_cast<std::size_t>(found.buffer)];
  if (found.byteOffset > bytes.size() || found.byteLength > bytes.size() - found.byteOffset) return std::nullopt;
  return bytes.substr(found.byteOffset, found.byteLength);
}

}  // namespace peerd::formats::gltf
